/* SPDX-License-Identifier: Zlib */
#ifndef HL_BACKEND_H
#define HL_BACKEND_H
/* What one platform provides; only hal.c calls it. Every argument has been
 * checked and every zero in a desc replaced by its default, so a backend
 * validates nothing and reports only what its caller could not foresee:
 * memory exhausted, device lost, something its driver refused after all.
 * Slots are 0..max-1 as stated at open; a backend keeps its own arrays by
 * slot. platforms/null is a complete example. */
#include "hal/hal.h"

#define HL_NO_SLOT 0xffffffffu

/* A draw whose handles have become slots. */
struct hl_bk_range { uint32_t slot, offset, bytes; };  /* HL_NO_SLOT: none   */
struct hl_bk_texture { uint32_t slot; uint8_t filter, wrap_u, wrap_v; };
struct hl_bk_draw {
    uint32_t prog;
    uint32_t vertex[HL_MAX_STREAMS];
    uint32_t index;
    bool index16;
    uint32_t first, count, instances;
    int32_t base_vertex;
    struct hl_bk_range uniform[HL_MAX_UNIFORMS];
    struct hl_bk_range storage[HL_MAX_STORAGE];
    struct hl_bk_texture texture[HL_MAX_TEXTURES]; /* no slot: white         */
    uint32_t n_textures;
    struct hl_rect scissor;  /* clipped to the target; empty ones never come */
};
struct hl_bk_target {
    uint32_t slot, resolve;  /* resolve HL_NO_SLOT: none                     */
    enum hl_load load;
    bool discard;
    float clear[4];
};
struct hl_bk_pass {
    const char *label;       /* "" at least                                  */
    struct hl_bk_target color[HL_MAX_COLORS];
    uint32_t n_colors;
    struct hl_bk_target depth;          /* slot HL_NO_SLOT: none             */
    bool depth_read_only;
    bool half_pixel_offset;  /* only where caps.profile.integer_centers      */
    uint32_t width, height, samples;
};

/* Draws come one at a time, so that no array of them has to be built. */
struct hl_backend {
    const char *name;
    uint32_t version;        /* HL_VERSION                                   */
    size_t state_bytes;      /* of the private state hal.c allocates, zeroed */

    enum hl_result (*list)(const struct hl_hooks *, struct hl_device_info *,
                           uint32_t max, uint32_t *n);
    /* Fill caps, all but the profile that the desc gives, whose rules hal.c
     * applies. The desc stays valid until close. */
    enum hl_result (*open)(void *state, struct hl_device *,
                           const struct hl_device_desc *, struct hl_caps *);
    void (*close)(void *state);
    enum hl_result (*buf_create)(void *state, uint32_t slot,
                                 const struct hl_buf_desc *);
    enum hl_result (*buf_write)(void *state, uint32_t slot, size_t offset,
                                const void *data, size_t bytes);
    enum hl_result (*tex_create)(void *state, uint32_t slot,
                                 const struct hl_tex_desc *);
    enum hl_result (*tex_write)(void *state, uint32_t slot, uint32_t mip,
                                const void *data, size_t bytes);
    enum hl_result (*tex_read)(void *state, uint32_t slot, void *out,
                               size_t bytes);
    enum hl_result (*prog_create)(void *state, uint32_t slot,
                                  const struct hl_prog_desc *);
    /* Kind of object: 'b' buffer, 't' texture, 'p' program. */
    void (*destroy)(void *state, char kind, uint32_t slot);
    enum hl_result (*pass_run)(void *state, const struct hl_bk_pass *,
                               const struct hl_bk_draw *draws,
                               uint32_t n_draws);
    enum hl_result (*submit)(void *state, bool wait);
    uint32_t (*timings)(void *state, struct hl_timing *out, uint32_t max);
};

/* For backends: memory by the device's hooks, the device's log, and the
 * counter behind hl_device_validation_errors. */
void *hl_bk_alloc(struct hl_device *, size_t bytes);   /* zeroed             */
void hl_bk_free(struct hl_device *, void *);
/* Grow the array kept in *array (NULL with *max 0 at first) to at least `need`
 * items, contents kept; false: out of memory, nothing changed. */
bool hl_bk_grow(struct hl_device *, void *array, uint32_t *max, uint32_t need,
                size_t item);
/* For functions that a backend offers besides: its state, and the slot of a
 * texture, where the device is `backend`'s and the handle live; else NULL. */
void *hl_bk_texture(struct hl_device *, const struct hl_backend *backend,
                    hl_tex, uint32_t *slot);
/* text is joined from up to three parts (NULL ends). */
void hl_bk_log(struct hl_device *, enum hl_log_level, enum hl_log_id,
               const char *a, const char *b, const char *c);
/* Does a device's name have that part, ASCII letters of either case alike?
 * hl_device_desc.device by name. */
bool hl_bk_name_has(const char *name, const char *part);
void hl_bk_validation_error(struct hl_device *, const char *text);
#endif
