/* SPDX-License-Identifier: Zlib */
/* The device: opening, what it can do, buffers, time, the backend's table. */
#include "hal/text.h"
#include "platforms/packemu/pe_memory.h"

static enum hl_result pe_list(const struct hl_hooks *hooks,
                              struct hl_device_info *out, uint32_t max,
                              uint32_t *n)
{
    (void)hooks;
    *n = 1;
    if (max > 0) {
        memset(out, 0, sizeof *out);
        strcpy(out->name, "packemu");
        strcpy(out->driver, "halflight packemu");
        out->kind = HL_DEVICE_CPU;
    }
    return HL_OK;
}

/* ---- what it can do ------------------------------------------------------ */

static bool listed(const enum hl_format list[HL_PROFILE_NO_BLEND],
                   enum hl_format format)
{
    for (int i = 0; i < HL_PROFILE_NO_BLEND && list[i]; i++)
        if (list[i] == format)
            return true;
    return false;
}

static bool xenos_alone(enum hl_format f)
{
    return f == HL_FORMAT_RG16_FIXED32 || f == HL_FORMAT_RGBA16_FIXED32 ||
           f == HL_FORMAT_RGB10A2_FLOAT || f == HL_FORMAT_D24_FLOAT_S8;
}

/* Neither console draws to normalised 16-bit numbers; RSX has no target of
 * two 16-bit channels at all. */
static bool no_target(const struct hl_profile *p, enum hl_format f)
{
    const struct hl_format_info *i = hl_format_info(f);
    bool xenos = p->edram_tiles > 0, rsx = !xenos && p->big_endian;
    bool norm16 = i->bits[0] == 16 && (i->kind == HL_KIND_UNORM ||
                                       i->kind == HL_KIND_SNORM);
    return (norm16 && (xenos || rsx)) || (f == HL_FORMAT_RG16_FLOAT && rsx);
}

/* What the machine would do if no profile forbade it: hal.c takes away what
 * the profile's lists say. */
static struct hl_format_caps format_caps(const struct hl_profile *p,
                                         enum hl_format f)
{
    enum hl_format_kind kind = hl_format_info(f)->kind;
    int use = HL_USE_SAMPLED | HL_USE_TARGET, samples = 1 | 2 | 4 | 8;
    if (xenos_alone(f) && !p->edram_tiles)
        return (struct hl_format_caps){ 0, 0 };
    if (kind != HL_KIND_DEPTH && kind != HL_KIND_UINT)
        use |= HL_USE_LINEAR | HL_USE_BLEND;
    if (kind == HL_KIND_UINT && p->float_taps)
        use = HL_USE_TARGET;
    /* Xenos averages samples of formats that it can blend. */
    if (p->edram_tiles && listed(p->no_blend, f))
        samples = 1;
    if (no_target(p, f)) {
        use &= ~(HL_USE_TARGET | HL_USE_BLEND);
        samples = 0;
    }
    return (struct hl_format_caps){ (uint8_t)use, (uint8_t)samples };
}

/* Measured with two threads and AVX2, frames of 1280 x 720 lit at 800 x 450
 * of five built-in scenes, as ratios of the passes of one frame, so that a
 * busy machine changes little; then scaled to an idle AMD EPYC. A light:
 * rectangles of 1, 8 and 16 a batch, whose difference in lights and in blends
 * gives 1.25 to 1.3 and, for blend, pixel and two fetches, 3 to 6; a gathered
 * one: lists with and without depth bounds, 1.3 to 1.5 a light more and 3 to 7
 * a texel at no light. Fetches: material passes, 10 for a pixel and eight of
 * them. Triangles: geometry of 175,152 and of 56,700. Draws: of 1,000 objects
 * and of 100. Reading back: frames less their passes. Waiting: the smallest
 * pass. Flat varyings are read as uniforms are. */
static const struct hl_cost_model cost = {
    .draw_ns = 1500.0f, .vertex_ns = 25.0f, .pixel_ns = 2.8f,
    .fetch_ns = 0.95f, .blend_ns = 0.5f, .light_ns = 1.3f,
    .light_flat_ns = 1.3f, .light_gather_ns = 1.4f, .readback_ns = 1.4f,
    .sync_ns = 20000.0f
};

static void make_caps(const struct pe_state *s, struct hl_caps *c)
{
    const struct hl_profile *p = &s->profile;
    struct hl_text driver = hl_text_begin(c->driver, sizeof c->driver);
    uint32_t threads = pe_pool_threads(s->threads);
    strcpy(c->backend, "packemu");
    strcpy(c->device, "packemu");
    hl_text_str(&driver, "halflight packemu, ");
    hl_text_uint(&driver, threads);
    hl_text_str(&driver, threads == 1 ? " thread" : " threads");
    c->kind = HL_DEVICE_CPU;
    c->max_tex_dim = 16384;
    c->max_colors = HL_PE_OUTPUTS;
    c->max_uniform_bytes = 65536;
    c->max_storage_bytes = 1u << 27;
    c->uniform_align = 16;
    c->storage_align = 16;
    c->samples = 1 | 2 | 4 | 8;
    c->timestamps = pe_clock_ms() > 0;
    c->clip_zero_to_one = true;
    for (int i = 1; i < HL_FORMAT_COUNT; i++)
        c->format[i] = format_caps(p, (enum hl_format)i);
    c->cost = cost;
    c->console_memory = s->console;
}

/* ---- opening ------------------------------------------------------------- */

static void pe_close(void *state)
{
    struct pe_state *s = state;
    struct hl_device *d = s->device;
    if (s->threads)
        pe_pool_close(s->threads);
    pe_pass_free(s);
    hl_bk_free(d, s->buf);
    hl_bk_free(d, s->tex);
    hl_bk_free(d, s->prog);
    hl_bk_free(d, s->edram);
    hl_bk_free(d, s->timing);
    hl_bk_free(d, s->done);
}

static void take_profile(struct pe_state *s, const struct hl_profile *p)
{
    strcpy(s->profile.name, "native");
    if (!p)
        return;
    s->profile = *p;
    s->console = strcmp(p->name, "native") != 0;
}

static bool open_memory(struct pe_state *s, const struct hl_device_desc *desc)
{
    const struct hl_profile *p = &s->profile;
    struct hl_device *d = s->device;
    const struct hl_packemu_native *native = desc->native;
    s->max_tex = desc->max_textures;
    s->buf = hl_bk_alloc(d, desc->max_buffers * sizeof *s->buf);
    s->tex = hl_bk_alloc(d, desc->max_textures * sizeof *s->tex);
    s->prog = hl_bk_alloc(d, desc->max_programs * sizeof *s->prog);
    if (p->edram_tiles)
        s->edram = hl_bk_alloc(d, (size_t)p->edram_tiles *
                                  p->edram_tile_width * p->edram_tile_height *
                                  sizeof *s->edram);
    s->threads = pe_pool_open(d, native ? native->threads : 0);
    return s->buf && s->tex && s->prog && s->threads &&
           (s->edram || !p->edram_tiles);
}

/* Half tiles have whole pixels of up to four words. */
static bool tiles_fit(const struct hl_profile *p)
{
    return p->edram_tiles == 0 ||
           (p->edram_tiles <= 65536 && p->edram_tile_width <= 4096 &&
            p->edram_tile_height <= 4096 && p->edram_tile_width % 8 == 0 &&
            p->edram_tile_width > 0 && p->edram_tile_height > 0);
}

/* Is the only device wanted: index 0, or by a part of its name? */
static bool wanted(const char *want)
{
    const char *rest = want ? want : "";
    while (*rest == '0')
        rest++;
    return !*rest || hl_bk_name_has("packemu", want);
}

static enum hl_result pe_open(void *state, struct hl_device *device,
                              const struct hl_device_desc *desc,
                              struct hl_caps *caps)
{
    struct pe_state *s = state;
    s->device = device;
    if (!wanted(desc->device)) {
        hl_bk_log(device, HL_LOG_ERROR, HL_MSG_DEVICE,
                  "no packemu device is called ", desc->device, NULL);
        return HL_ERR_NO_DEVICE;
    }
    take_profile(s, desc->profile);
    if (!tiles_fit(&s->profile)) {
        hl_bk_log(device, HL_LOG_ERROR, HL_MSG_ARGUMENT,
                  "hl_device_desc.profile: an EDRAM tile's width is not a"
                  " multiple of 8, or EDRAM is too large", NULL, NULL);
        return HL_ERR_INVALID;
    }
    if (!open_memory(s, desc)) {
        hl_bk_log(device, HL_LOG_ERROR, HL_MSG_MEMORY,
                  "hl_device_open: no memory for packemu's tables", NULL,
                  NULL);
        pe_close(s);
        return HL_ERR_MEMORY;
    }
    make_caps(s, caps);
    return HL_OK;
}

/* ---- objects ------------------------------------------------------------- */

static enum hl_result pe_buf_create(void *state, uint32_t slot,
                                    const struct hl_buf_desc *desc)
{
    struct pe_state *s = state;
    struct pe_buffer *b = &s->buf[slot];
    b->memory = hl_bk_alloc(s->device, desc->bytes);
    if (!b->memory) {
        hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_MEMORY,
                  desc->label ? desc->label : "hl_buf_create",
                  ": no memory for the buffer", NULL);
        return HL_ERR_MEMORY;
    }
    b->bytes = desc->bytes;
    if (desc->data)
        memcpy(b->memory, desc->data, desc->bytes);
    return HL_OK;
}

static enum hl_result pe_buf_write(void *state, uint32_t slot, size_t offset,
                                   const void *data, size_t bytes)
{
    struct pe_state *s = state;
    memcpy(s->buf[slot].memory + offset, data, bytes);
    return HL_OK;
}

static void pe_destroy(void *state, char kind, uint32_t slot)
{
    struct pe_state *s = state;
    if (kind == 't') {
        pe_tex_destroy(s, slot);
    } else if (kind == 'b') {
        hl_bk_free(s->device, s->buf[slot].memory);
        memset(&s->buf[slot], 0, sizeof s->buf[slot]);
    } else {
        memset(&s->prog[slot], 0, sizeof s->prog[slot]);
    }
}

/* ---- time ---------------------------------------------------------------- */

/* Passes have run by now; what is left is whose times to show. */
enum hl_result pe_submit(void *state, bool wait)
{
    struct pe_state *s = state;
    if (wait) {
        struct hl_timing *timing = s->done;
        uint32_t max = s->max_done;
        s->done = s->timing;
        s->max_done = s->max_timings;
        s->n_submitted = s->n_timings;
        s->timing = timing;
        s->max_timings = max;
    }
    s->n_timings = 0;
    return HL_OK;
}

static uint32_t pe_timings(void *state, struct hl_timing *out, uint32_t max)
{
    const struct pe_state *s = state;
    for (uint32_t i = 0; i < s->n_submitted && i < max; i++)
        out[i] = s->done[i];
    return s->n_submitted;
}

const uint8_t *hl_packemu_memory(struct hl_device *d, hl_tex tex,
                                 size_t *bytes)
{
    uint32_t slot;
    const struct pe_state *s = hl_bk_texture(d, &hl_backend_packemu, tex,
                                             &slot);
    *bytes = 0;
    if (!s)
        return NULL;
    const struct pe_texture *t = &s->tex[slot];
    if (t->memory)
        *bytes = (size_t)t->desc.width * t->desc.height * t->samples *
                 hl_format_info(t->desc.format)->bytes;
    return t->memory;
}

const struct hl_backend hl_backend_packemu = {
    "packemu", HL_VERSION, sizeof(struct pe_state),
    pe_list, pe_open, pe_close, pe_buf_create, pe_buf_write, pe_tex_create,
    pe_tex_write, pe_tex_read, pe_prog_create, pe_destroy, pe_pass_run,
    pe_submit, pe_timings,
};
