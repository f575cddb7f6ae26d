/* SPDX-License-Identifier: Zlib */
#ifndef HL_DEVICE_H
#define HL_DEVICE_H
/* Private to hal: a device, its handle pools and how arguments are refused. */
#include "hal/backend.h"

/* Slots of one kind of object. A slot whose generation has run through is
 * retired, never wrapped, so that no stale handle can come alive again. */
struct hl_pool {
    uint16_t *generation;    /* of the live object, or of the next one       */
    uint8_t *live;
    uint32_t *free_slot;
    uint32_t n_free, n_used, max;
};

enum { HL_POOL_BUF, HL_POOL_TEX, HL_POOL_PROG, HL_POOL_COUNT };

struct hl_buf_state { size_t bytes; uint32_t usage; };
struct hl_prog_state {
    enum hl_format color[HL_MAX_COLORS];
    enum hl_format depth;
    uint32_t n_colors, samples;
    uint32_t streams;        /* bits: streams that the layout reads          */
    bool depth_write;        /* depth or stencil                             */
};

struct hl_device {
    const struct hl_backend *backend;
    void *state;
    struct hl_hooks hooks;
    hl_log_fn log;
    void *log_user;
    struct hl_device_desc desc;
    struct hl_caps caps;
    struct hl_pool pool[HL_POOL_COUNT];
    struct hl_buf_state *bufs;
    struct hl_tex_desc *texs;
    struct hl_prog_state *progs;
    struct hl_bk_draw *draws;      /* scratch of pass_run, grows             */
    uint32_t max_draws;
    uint32_t validation_errors;
    bool lost;
    struct hl_counts counts;
};

/* Slot of a live handle, or HL_NO_SLOT. */
uint32_t hl_pool_find(const struct hl_pool *, uint32_t handle);
/* Log `what` and `why`, give back the result. */
enum hl_result hl_refuse(struct hl_device *, enum hl_result, enum hl_log_id,
                         const char *what, const char *why);
/* The same with a number between. */
enum hl_result hl_refuse_number(struct hl_device *, enum hl_result,
                                enum hl_log_id, const char *what,
                                uint64_t number, const char *why);

/* check_prog.c: refuse, or fill the zeros with their defaults. */
enum hl_result hl_check_prog(struct hl_device *, struct hl_prog_desc *);
bool hl_stencil_writes(const struct hl_stencil *);
/* console.c. p NULL is good. */
enum hl_result hl_profile_check(struct hl_device *,
                                const struct hl_profile *p);
/* Keep `asked`, or what the backend said, or "native"; lay its rules on the
 * caps. */
void hl_profile_apply(struct hl_caps *, const struct hl_profile *asked);
enum hl_result hl_console_check(struct hl_device *,
                                const struct hl_tex_desc *);
/* May a depth texture be sampled as its desc's sample_as? */
bool hl_depth_as_color(const struct hl_caps *, const struct hl_tex_desc *);
#endif
