/* SPDX-License-Identifier: Zlib */
/* Textures: full mip chains, each level the box average of the one above in
 * linear light, stored in 8 bits again. Sizes halve downwards, so a texel of
 * an odd level covers parts of texels: averages are by area. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge_parts.h"

enum { GUESSES = 4096, SPAN = 3 };

/* Code to value, and the values where rounding goes to the next code. */
struct tables {
    double value[2][256];            /* [1]: sRGB                            */
    double step[255];
    uint8_t guess[GUESSES + 1];      /* lower bound of the code              */
};

/* IEC 61966-2-1. */
static double srgb_to_linear(double s)
{
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

static void make_tables(struct tables *t)
{
    for (int i = 0; i < 256; i++) {
        t->value[0][i] = i / 255.0;
        t->value[1][i] = srgb_to_linear(i / 255.0);
    }
    for (int i = 0; i < 255; i++)
        t->step[i] = srgb_to_linear((i + 0.5) / 255);
    int code = 0;
    for (int i = 0; i <= GUESSES; i++) {
        while (code < 255 && t->step[code] <= (double)i / GUESSES)
            code++;
        t->guess[i] = (uint8_t)code;
    }
}

static uint8_t encode(const struct tables *t, double v, bool srgb)
{
    if (!srgb)
        return (uint8_t)floor(v * 255 + 0.5);
    unsigned code = t->guess[(int)(v * GUESSES)];
    while (code < 255 && t->step[code] <= v)
        code++;
    return (uint8_t)code;
}

/* ---- one level --------------------------------------------------------- */

struct level { uint32_t width, height; uint8_t *rgba; };

/* Texels of the level above under a texel, with weights in units of 1 / `to`
 * texel: at most three, as from / to <= 2 + 1 / to. */
struct span { uint32_t at, n; double weight[SPAN]; };

static struct span span_of(uint64_t i, uint64_t from, uint64_t to)
{
    struct span s = { (uint32_t)(i * from / to), 0, { 0 } };
    uint64_t end = (i + 1) * from;
    for (uint64_t x = s.at; x * to < end && s.n < SPAN; x++) {
        uint64_t lo = x * to > i * from ? x * to : i * from;
        uint64_t hi = (x + 1) * to < end ? (x + 1) * to : end;
        s.weight[s.n++] = (double)(hi - lo);
    }
    return s;
}

static void average(uint8_t out[4], const struct level *from,
                    const struct span *x, const struct span *y, double area,
                    bool srgb, const struct tables *t)
{
    double sum[4] = { 0 };
    for (uint32_t j = 0; j < y->n; j++) {
        const uint8_t *p = from->rgba +
                           4 * ((size_t)(y->at + j) * from->width + x->at);
        for (uint32_t i = 0; i < x->n; i++, p += 4) {
            double weight = x->weight[i] * y->weight[j];
            for (int k = 0; k < 3; k++)
                sum[k] += weight * t->value[srgb][p[k]];
            sum[3] += weight * t->value[0][p[3]];
        }
    }
    for (int k = 0; k < 4; k++)
        out[k] = encode(t, sum[k] / area, srgb && k < 3);
}

static bool halve(struct level *level, bool srgb, const struct tables *t)
{
    struct level to = { level->width > 1 ? level->width / 2 : 1,
                        level->height > 1 ? level->height / 2 : 1, NULL };
    double area = (double)level->width * level->height;
    struct span *columns = malloc(to.width * sizeof *columns);
    to.rgba = malloc(4 * (size_t)to.width * to.height);
    if (!columns || !to.rgba) {
        free(columns);
        free(to.rgba);
        return false;
    }
    for (uint32_t x = 0; x < to.width; x++)
        columns[x] = span_of(x, level->width, to.width);
    uint8_t *at = to.rgba;
    for (uint32_t y = 0; y < to.height; y++) {
        struct span row = span_of(y, level->height, to.height);
        for (uint32_t x = 0; x < to.width; x++, at += 4)
            average(at, level, &columns[x], &row, area, srgb, t);
    }
    free(columns);
    free(level->rgba);
    *level = to;
    return true;
}

/* ---- a texture --------------------------------------------------------- */

static uint32_t levels_of(uint32_t width, uint32_t height)
{
    uint32_t n = 1;
    for (; width > 1 || height > 1; n++) {
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
    return n;
}

static bool write_levels(struct hlc_bridge *b, struct level *level, hl_tex tex,
                         uint32_t n, bool srgb, const struct tables *t)
{
    for (uint32_t mip = 0; mip < n; mip++) {
        size_t bytes = 4 * (size_t)level->width * level->height;
        if (mip > 0 && !halve(level, srgb, t))
            return hlc_bridge_fail(b, "mip levels", HL_ERR_MEMORY);
        bytes = 4 * (size_t)level->width * level->height;
        enum hl_result r = hl_tex_write(b->world->device, tex, mip,
                                        level->rgba, bytes);
        if (r != HL_OK)
            return hlc_bridge_fail(b, "texture", r);
        b->world->bytes += bytes;
    }
    return true;
}

/* An image larger than the device takes begins at its first level that
 * fits: what is drawn small enough looks the same. */
static bool upload(struct hlc_bridge *b, uint32_t image, bool srgb,
                   const struct tables *t)
{
    const struct hlh_image *source = &b->scene->images[image];
    const struct hl_caps *caps = hl_device_caps(b->world->device);
    struct level level = { source->width, source->height, NULL };
    size_t bytes = 4 * (size_t)source->width * source->height;
    level.rgba = malloc(bytes);
    bool ok = level.rgba != NULL;
    if (ok)
        memcpy(level.rgba, source->rgba, bytes);
    while (ok && (level.width > caps->max_tex_dim ||
                  level.height > caps->max_tex_dim))
        ok = halve(&level, srgb, t);
    struct hl_tex_desc d;
    memset(&d, 0, sizeof d);
    d.label = source->name;
    d.format = srgb ? HL_FORMAT_RGBA8_SRGB : HL_FORMAT_RGBA8_UNORM;
    d.width = level.width;
    d.height = level.height;
    d.mips = levels_of(level.width, level.height);
    d.usage = HL_TEX_SAMPLED;
    enum hl_result r = ok ? HL_OK : HL_ERR_MEMORY;
    hl_tex *tex = &b->world->textures[2 * (size_t)image + !srgb];
    if (r == HL_OK)
        r = hl_tex_create(b->world->device, tex, &d);
    if (r == HL_OK)
        ok = write_levels(b, &level, *tex, d.mips, srgb, t);
    else
        ok = hlc_bridge_fail(b, source->name, r);
    free(level.rgba);
    return ok;
}

/* ---- which ------------------------------------------------------------- */

static void want(bool *wanted, const struct hlh_texture *t, bool linear)
{
    wanted[2 * (size_t)t->image + linear] = true;
}

static void find_wanted(bool *wanted, const struct hlc_bridge *b)
{
    for (uint32_t i = 0; i < b->scene->n_meshes; i++) {
        const struct hlc_part *p = &b->parts[i];
        const struct hlh_material *m =
            &b->scene->materials[b->scene->meshes[i].material];
        if (!p->used)
            continue;
        if (p->textures & HL_TEXTURED_BASE)
            want(wanted, &m->base_texture, false);
        if (p->textures & HL_TEXTURED_METAL_ROUGH)
            want(wanted, &m->metal_rough_texture, true);
        if (p->textures & HL_TEXTURED_NORMAL)
            want(wanted, &m->normal_texture, true);
        if (p->textures & HL_TEXTURED_EMISSION)
            want(wanted, &m->emission_texture, false);
    }
}

bool hlc_textures_upload(struct hlc_bridge *b)
{
    size_t n = 2 * (size_t)b->scene->n_images;
    bool *wanted = calloc(n + 1, sizeof *wanted);
    struct tables *t = malloc(sizeof *t);
    b->world->textures = calloc(n + 1, sizeof *b->world->textures);
    bool ok = wanted && t && b->world->textures;
    if (!ok)
        hlc_bridge_fail(b, "textures", HL_ERR_MEMORY);
    if (ok) {
        make_tables(t);
        find_wanted(wanted, b);
    }
    for (uint32_t i = 0; ok && i < b->scene->n_images; i++)
        for (int linear = 0; linear < 2 && ok; linear++)
            if (wanted[2 * (size_t)i + (size_t)linear])
                ok = upload(b, i, !linear, t);
    free(wanted);
    free(t);
    return ok;
}
