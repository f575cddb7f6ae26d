/* SPDX-License-Identifier: Zlib */
/* shaders/light.frag: the light pass, over rectangles of texels, or over
 * fragments where something else than a rectangle is drawn. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_lights.h"

/* A draw's constants. */
struct pass {
    const struct pe_draw *draw;
    const struct hl_frame_block *frame;
    uint32_t kinds, falloff, two16;
    enum pe_lit_specular what;
    bool barg, channel, brdfs;
    bool map;                    /* the one light has a shadow map           */
    float out;
};

/* G-buffer texels of a run as sampled, and where they lie. */
struct texels {
    float x[PE_LIGHT_RUN], y[PE_LIGHT_RUN];          /* pixel centres        */
    float depth[3][PE_LIGHT_RUN];                    /* 1 channel, or BARG 3 */
    float normal[2][PE_LIGHT_RUN];
    float code[PE_LIGHT_RUN], brdf[PE_LIGHT_RUN];    /* exponent, its pair's */
};

static struct pass begin(const struct pe_draw *d)
{
    struct pass p;
    uint32_t specular = pe_spec_uint(d, HL_SPEC_SPECULAR);
    p.draw = d;
    p.frame = pe_frame(d);
    p.kinds = pe_spec_uint(d, HL_SPEC_KINDS);
    p.falloff = pe_spec_uint(d, HL_SPEC_FALLOFF);
    p.two16 = pe_spec_uint(d, HL_SPEC_TWO16);
    p.what = specular ? PE_LIT_LUMINANCE : PE_LIT_NONE;
    p.channel = specular == HL_SPECULAR_CHANNEL;
    p.brdfs = pe_spec_uint(d, HL_SPEC_BRDFS) != 0;
    p.barg = pe_spec_uint(d, HL_SPEC_DEPTH_READ) == HL_DEPTH_READ_BARG;
    p.out = pe_spec_float(d, HL_SPEC_LIGHT_OUT);
    p.map = false;
    return p;
}

/* ---- the G-buffer -------------------------------------------------------- */

static void depths(const struct pass *p, struct texels *t, uint32_t n)
{
    for (uint32_t i = 0; p->barg && i < n; i++)
        t->depth[0][i] = hl_depth_barg(hl_v3(t->depth[0][i], t->depth[1][i],
                                             t->depth[2][i]));
}

static void positions(const struct pass *p, const struct texels *t,
                      struct pe_lit_run *r)
{
    hl_vec4 ray = p->frame->ray_light;
    float a = p->frame->depth.x, b = p->frame->depth.y;
    for (uint32_t i = 0; i < r->n; i++) {
        float z = a / (t->depth[0][i] + b);
        r->px[i] = (t->x[i] * ray.x + ray.z) * z;
        r->py[i] = (t->y[i] * ray.y + ray.w) * z;
        r->pz[i] = -z;
    }
}

static void normals(const struct pass *p, struct texels *t,
                    struct pe_lit_run *r)
{
    float *x = t->normal[0], *y = t->normal[1];
    for (uint32_t i = 0; i < r->n && p->two16 != HL_TWO16_UNORM; i++) {
        hl_vec2 e = hl_two16_decode(p->two16, hl_v2(x[i], y[i]));
        x[i] = e.x;
        y[i] = e.y;
    }
    for (uint32_t i = 0; i < r->n; i++) {
        hl_vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(x[i]),
                                           hl_unorm_to_snorm(y[i])));
        r->nx[i] = n.x;
        r->ny[i] = n.y;
        r->nz[i] = n.z;
    }
}

/* Pairs of exponent and BRDF to codes and indices, which the sums read; after
 * pe_lit_begin. */
static void brdfs(const struct pass *p, struct texels *t,
                  struct pe_lit_run *r)
{
    r->brdfs = true;
    for (uint32_t i = 0; i < r->n; i++) {
        hl_vec2 pair = hl_two16_decode(p->two16, hl_v2(t->code[i],
                                                       t->brdf[i]));
        t->code[i] = pair.x;
        r->brdf[i] = hl_brdf_decode(pair.y);
    }
}

static void exponents(const struct pass *p, const struct texels *t,
                      struct pe_lit_run *r)
{
    float half = p->frame->misc.x * 0.5f;
    for (uint32_t i = 0; i < r->n; i++)
        r->half_n[i] = p->channel ? hl_exponent_decode(t->code[i]) * 0.5f
                                  : half;
}

static void surface_points(const struct pass *p, struct texels *t,
                           struct pe_lit_run *r, uint32_t n)
{
    r->n = PE_LANES(n);
    depths(p, t, r->n);
    positions(p, t, r);
    normals(p, t, r);
    pe_lit_begin(r);
    if (p->brdfs)
        brdfs(p, t, r);
    exponents(p, t, r);
}

/* Sums to what is stored; `a` in place. */
static void scale(float *a, uint32_t n, float out)
{
    for (uint32_t i = 0; i < n; i++)
        a[i] = hl_min(a[i] * out, HL_HALF_MAX);
}

static void shade(const struct pass *p, struct texels *t,
                  struct pe_lit_run *r, uint32_t n, struct pe_lit_list list)
{
    surface_points(p, t, r, n);
    pe_lit_add(r, p->what, p->kinds, p->falloff, list.light, list.count);
    if (p->map)
        pe_shadow(p->draw, r, n);
    for (int c = 0; c < 3; c++)
        scale(r->diffuse[c], r->n, p->out);
    scale(r->specular[0], r->n, p->out);
}

/* ---- rectangles ---------------------------------------------------------- */

/* Texels (x, y) ... (x + n - 1, y) into lanes from `at`. */
static void fetch_row(const struct pass *p, struct texels *t, int32_t x,
                      int32_t y, uint32_t n, uint32_t at)
{
    const struct pe_view *v = p->draw->view;
    bool b = p->barg;
    float *depth[4] = { t->depth[0] + at, b ? t->depth[1] + at : NULL,
                        b ? t->depth[2] + at : NULL, NULL };
    float *normal[4] = { t->normal[0] + at, t->normal[1] + at, NULL, NULL };
    float *code[4] = { t->code + at, p->brdfs ? t->brdf + at : NULL, NULL,
                       NULL };
    pe_fetch_row(&v[HL_TEX_DEPTH], x, y, n, depth);
    pe_fetch_row(&v[HL_TEX_NORMAL], x, y, n, normal);
    if (p->channel || p->brdfs)
        pe_fetch_row(&v[HL_TEX_EXPONENT], x, y, n, code);
    for (uint32_t i = 0; i < n; i++) {
        t->x[at + i] = (float)(x + (int32_t)i) + 0.5f;
        t->y[at + i] = (float)y + 0.5f;
    }
}

/* Part `r` of a rectangle whose corner is (x0, y0), under no light. */
static void dark_part(const struct hl_rect *r, int32_t x0, int32_t y0,
                      float (*out)[PE_BIN * PE_BIN])
{
    for (int c = 0; c < 4; c++)
        for (int32_t y = r->y - y0; y < r->y - y0 + r->height; y++)
            memset(out[c] + y * PE_BIN + r->x - x0, 0,
                   (size_t)r->width * sizeof(float));
}

/* All under one list. */
static void light_part(const struct pass *p, const struct hl_rect *r,
                       int32_t x0, int32_t y0, struct pe_lit_list list,
                       float (*out)[PE_BIN * PE_BIN])
{
    struct texels t;
    struct pe_lit_run run;
    uint32_t w = (uint32_t)r->width;
    int32_t rows = (int32_t)(PE_LIGHT_RUN / w);
    if (list.count == 0) {
        dark_part(r, x0, y0, out);
        return;
    }
    memset(&t, 0, sizeof t);
    for (int32_t y = 0; y < r->height; y += rows) {
        int32_t n = r->height - y < rows ? r->height - y : rows;
        for (int32_t j = 0; j < n; j++)
            fetch_row(p, &t, r->x, r->y + y + j, w, (uint32_t)j * w);
        shade(p, &t, &run, (uint32_t)n * w, list);
        for (int32_t j = 0; j < n; j++) {
            size_t at = (size_t)((r->y - y0 + y + j) * PE_BIN + r->x - x0);
            size_t from = (size_t)j * w, bytes = w * sizeof(float);
            for (int c = 0; c < 3; c++)
                memcpy(out[c] + at, run.diffuse[c] + from, bytes);
            memcpy(out[3] + at, run.specular[0] + from, bytes);
        }
    }
}

void pe_light_batch_rect(const struct pe_draw *d, const struct hl_rect *r,
                         float (*out)[PE_BIN * PE_BIN])
{
    struct pass p = begin(d);
    light_part(&p, r, r->x, r->y, pe_lit_batch(d), out);
}

void pe_light_map_rect(const struct pe_draw *d, const struct hl_rect *r,
                       float (*out)[PE_BIN * PE_BIN])
{
    struct pass p = begin(d);
    p.map = true;
    light_part(&p, r, r->x, r->y, pe_lit_batch(d), out);
}

/* The list of tile (tx, ty); none where the buffer ends. */
static struct pe_lit_list tile_list(const struct pass *p, int32_t tx,
                                    int32_t ty)
{
    const uint32_t *tile = p->draw->storage[HL_SLOT_TILES];
    uint32_t i = (uint32_t)ty * pe_uint(p->frame->misc.z) + (uint32_t)tx;
    if (!tile || i >= p->draw->storage_bytes[HL_SLOT_TILES] / 8u)
        return pe_lit_list(p->draw, 0, 0);
    return pe_lit_list(p->draw, tile[2 * i], tile[2 * i + 1]);
}

static int32_t tile_size(const struct pass *p)
{
    int32_t size = pe_int(p->frame->misc.y);
    return size > 0 ? size : 1;
}

static int32_t least(int32_t a, int32_t b) { return a < b ? a : b; }

void pe_light_tiles_rect(const struct pe_draw *d, const struct hl_rect *r,
                         float (*out)[PE_BIN * PE_BIN])
{
    struct pass p = begin(d);
    int32_t size = tile_size(&p);
    int32_t right = r->x + r->width, bottom = r->y + r->height;
    struct hl_rect part = *r;
    for (; part.y < bottom; part.y += part.height) {
        int32_t ty = part.y / size;
        part.height = least((ty + 1) * size, bottom) - part.y;
        for (part.x = r->x; part.x < right; part.x += part.width) {
            int32_t tx = part.x / size;
            part.width = least((tx + 1) * size, right) - part.x;
            light_part(&p, &part, r->x, r->y, tile_list(&p, tx, ty), out);
        }
    }
}

/* ---- fragments ----------------------------------------------------------- */

static void fetch_one(const struct pass *p, struct texels *t, int32_t x,
                      int32_t y, uint32_t at)
{
    const struct pe_view *v = p->draw->view;
    float c[4];
    pe_fetch(&v[HL_TEX_DEPTH], 0, x, y, c);
    for (int k = 0; k < 3; k++)
        t->depth[k][at] = c[k];
    pe_fetch(&v[HL_TEX_NORMAL], 0, x, y, c);
    t->normal[0][at] = c[0];
    t->normal[1][at] = c[1];
    t->code[at] = t->brdf[at] = 0.0f;
    if (p->channel || p->brdfs) {
        pe_fetch(&v[HL_TEX_EXPONENT], 0, x, y, c);
        t->code[at] = c[0];
        t->brdf[at] = c[1];
    }
    t->x[at] = (float)x + 0.5f;
    t->y[at] = (float)y + 0.5f;
}

/* Fragments from..to-1, all under one list. */
static void light_fragments(const struct pass *p, struct hl_pe_fragments *f,
                            uint32_t from, uint32_t to,
                            struct pe_lit_list list)
{
    struct texels t;
    struct pe_lit_run run;
    size_t bytes = (to - from) * sizeof(float);
    memset(&t, 0, sizeof t);
    for (uint32_t i = from; i < to; i++)
        fetch_one(p, &t, f->x[i], f->y[i], i - from);
    shade(p, &t, &run, to - from, list);
    for (int c = 0; c < 3; c++)
        memcpy(f->color[0][c] + from, run.diffuse[c], bytes);
    memcpy(f->color[0][3] + from, run.specular[0], bytes);
}

void pe_light_batch(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    struct pass p = begin(d);
    light_fragments(&p, f, 0, f->n, pe_lit_batch(d));
}

void pe_light_map(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    struct pass p = begin(d);
    p.map = true;
    light_fragments(&p, f, 0, f->n, pe_lit_batch(d));
}

void pe_light_tiles(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    struct pass p = begin(d);
    int32_t size = tile_size(&p);
    for (uint32_t i = 0, j; i < f->n; i = j) {
        int32_t tx = f->x[i] / size, ty = f->y[i] / size;
        j = i + 1;
        while (j < f->n && f->x[j] / size == tx && f->y[j] / size == ty)
            j++;
        light_fragments(&p, f, i, j, tile_list(&p, tx, ty));
    }
}
