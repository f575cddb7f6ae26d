/* SPDX-License-Identifier: Zlib */
#include "tests/fuzz.h"
#include <math.h>
#include <string.h>
#include "platforms/profiles/hl_profiles.h"
#include "shaders/shared/pack.h"

float fz_number(struct fz *f)
{
    static const float odd[] = { 0, -0.0f, 1, -1, 0.5f, 1e-38f, 1e-45f,
                                 65504, 65536, 3.4e38f, NAN, INFINITY,
                                 -INFINITY, 1e10f, 32, 1.0f / 255 };
    uint32_t how = fz_byte(f), bits;
    float x;
    if (how < 100)
        return (float)fz_below(f, 1024) / 16;
    if (how < 160)
        return (float)fz_below(f, 65536);
    if (how < 220)
        return odd[how % 16];
    bits = fz_word(f);
    memcpy(&x, &bits, sizeof x);
    return x;
}

uint32_t fz_count(struct fz *f)
{
    uint32_t how = fz_byte(f);
    if (how < 120)
        return fz_below(f, 64);
    if (how < 180)
        return fz_below(f, 2048);
    if (how < 230)
        return (1u << how % 32) - how / 32 % 3;
    return fz_word(f);
}

uint32_t fz_choice(struct fz *f, uint32_t n)
{
    uint32_t i = fz_byte(f);
    return i < 250 ? i % n : i == 250 ? n : i == 251 ? n + 1 : fz_word(f);
}

static void change_format(struct fz *f, struct hl_profile_format *p, bool keep)
{
    uint32_t n = HL_FORMAT_COUNT;
    p->format = (enum hl_format)(keep ? fz_below(f, n) : fz_choice(f, n));
    p->sample_as = (enum hl_format)(fz_bool(f) ? 0 : keep ? fz_below(f, n)
                                                          : fz_choice(f, n));
    p->on = (uint8_t)fz_below(f, keep ? 3 : 256);
    p->two16 = (uint8_t)fz_below(f, keep ? 5 : 256);
    p->depth_read = (uint8_t)fz_below(f, keep ? 4 : 256);
    p->range = keep ? (float)fz_below(f, 1024) / 16 : fz_number(f);
    p->sampled = keep ? (float)(fz_below(f, 255) + 1) / 16 : fz_number(f);
    p->console.edram_tile = (uint16_t)(keep ? 0 : fz_below(f, 3));
    p->console.color_exp_bias = (int8_t)(int)fz_byte(f);
    p->console.resolve_exp_bias = (int8_t)(int)fz_byte(f);
    p->console.resolve_number = (uint8_t)fz_below(f, keep ? 2 : 256);
    p->console.endian = (uint8_t)fz_below(f, keep ? 4 : 256);
    p->console.remap = (uint16_t)fz_below(f, 65536);
}

static void change_flags(struct fz *f, struct hl_profile *p)
{
    p->resolve_to_read = fz_bool(f);
    p->float_taps = fz_bool(f);
    p->one_mrt_format = fz_bool(f);
    p->packed_normals = fz_bool(f);
    p->depth_copy_if_bound = fz_bool(f);
    p->integer_centers = fz_bool(f);
    p->big_endian = fz_bool(f);
}

static void change(struct fz *f, struct hl_profile *p, bool keep)
{
    struct hl_profile_format *lists[] = { p->two16, p->scalar, p->light,
                                          p->color, p->depth };
    switch (fz_below(f, 6)) {
    case 0:
        change_format(f, &lists[fz_below(f, 5)][fz_below(
                          f, HL_PROFILE_FORMATS)], keep);
        break;
    case 1:
        p->no_blend[fz_below(f, HL_PROFILE_NO_BLEND)] =
            (enum hl_format)(keep ? fz_below(f, HL_FORMAT_COUNT)
                                  : fz_choice(f, HL_FORMAT_COUNT));
        break;
    case 2:
        p->id_steps = keep ? (float)fz_below(f, 65536) : fz_number(f);
        break;
    case 3: p->samples = fz_below(f, 16) | (keep ? 1u : 0u); break;
    case 4:
        p->edram_tiles = keep ? fz_below(f, 65536) : fz_count(f);
        p->edram_tile_width = fz_below(f, 256) + (keep ? 1u : 0u);
        p->edram_tile_height = fz_below(f, 64) + (keep ? 1u : 0u);
        break;
    default: change_flags(f, p); break;
    }
}

void fz_profile(struct fz *f, struct hl_profile *out, bool keep)
{
    uint32_t n = 0, changes;
    while (hl_profile_at(n))
        n++;
    *out = *hl_profile_at(fz_below(f, n));
    changes = fz_byte(f);
    changes = changes < 64 ? 0 : changes % 8;
    for (uint32_t i = 0; i < changes; i++)
        change(f, out, keep);
    if (!keep && fz_byte(f) == 255)
        memset(out->name, 'x', sizeof out->name);
}

/* keep: what a calibration measures. */
static void fz_error_model(struct fz *f, struct hl_error_model *m, bool keep)
{
    float *number[] = { &m->full, &m->half, &m->eight, &m->margin };
    if (fz_bool(f))
        return;
    for (int i = 0; i < 9; i++)
        m->eighths[i] = keep ? (float)fz_below(f, 64) / 16 : fz_number(f);
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        *number[i] = keep ? (float)fz_below(f, 256) / 16 : fz_number(f);
}

void fz_caps(struct fz *f, struct hl_caps *c, bool keep)
{
    bool whole = fz_bool(f);
    memset(c, 0, sizeof *c);
    strcpy(c->backend, "fuzz");
    c->max_tex_dim = keep ? 16384 : fz_count(f);
    c->max_colors = whole ? 8 : fz_below(f, 9);
    c->max_uniform_bytes = keep ? 65536 : fz_count(f);
    c->max_storage_bytes = fz_bool(f) ? 1u << 27 : fz_count(f);
    c->uniform_align = c->storage_align = 1u << fz_below(f, 9);
    c->samples = fz_below(f, 16) | 1u;
    c->clip_zero_to_one = fz_bool(f);
    c->console_memory = fz_bool(f);
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        c->format[i].use = (uint8_t)(whole || fz_bool(f) ? 15
                                     : fz_below(f, 16));
        c->format[i].samples = (uint8_t)(whole || fz_bool(f) ? 15
                                         : fz_below(f, 16) | 1);
    }
    float *cost[] = { &c->cost.draw_ns, &c->cost.vertex_ns, &c->cost.pixel_ns,
                      &c->cost.fetch_ns, &c->cost.blend_ns, &c->cost.light_ns,
                      &c->cost.light_flat_ns, &c->cost.light_gather_ns,
                      &c->cost.readback_ns, &c->cost.sync_ns };
    for (size_t i = 0; i < sizeof cost / sizeof *cost; i++)
        *cost[i] = (float)fz_below(f, 4096);
    fz_profile(f, &c->profile, keep);
    fz_error_model(f, &c->error, keep);
}
