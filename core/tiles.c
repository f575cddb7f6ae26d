/* SPDX-License-Identifier: Zlib */
/* Host-made tile lists: which lights touch which tile of the L-buffer. */
#include <string.h>
#include "core/light.h"
#include "core/vec.h"

struct span { uint32_t x0, x1, y0, y1; };   /* tiles, ends included          */

static uint32_t tile_at(float texel, uint32_t tile, uint32_t n)
{
    float t = floorf(texel / (float)tile);
    return t <= 0 ? 0 : t >= (float)(n - 1) ? n - 1 : (uint32_t)t;
}

static struct span sphere_span(const struct hl_tile_grid *g,
                               const struct hl_lit_sphere *s)
{
    const struct hl_span *q = &g->span;
    float sx = q->w * 0.5f / q->tan_x, cx = q->w * 0.5f + q->jx;
    float sy = q->h * 0.5f / q->tan_y, cy = q->h * 0.5f + q->jy;
    struct span p = { tile_at(cx + s->x0 * sx, g->tile, g->nx),
                      tile_at(cx + s->x1 * sx, g->tile, g->nx),
                      tile_at(cy - s->y1 * sy, g->tile, g->ny),
                      tile_at(cy - s->y0 * sy, g->tile, g->ny) };
    return p;
}

/* Slopes of a tile's left and right (or upper and lower) edges. */
static void tile_slopes(const struct hl_tile_grid *g, uint32_t tx, uint32_t ty,
                        float x[2], float y[2])
{
    for (uint32_t i = 0; i < 2; i++) {
        float px = ((float)((tx + i) * g->tile) - g->span.jx) / g->span.w;
        float py = ((float)((ty + i) * g->tile) - g->span.jy) / g->span.h;
        x[i] = (px * 2.0f - 1.0f) * g->span.tan_x;
        y[i] = (1.0f - py * 2.0f) * g->span.tan_y;
    }
}

/* Does the sphere reach into the tile's part of the view volume between its
 * depths? The part is bounded by a box: exact enough where depths are near
 * each other, and never wrong. */
static bool reaches(const struct hl_tile_grid *g,
                    const struct hl_lit_sphere *s, uint32_t tx, uint32_t ty)
{
    uint32_t t = ty * g->nx + tx;
    if (!g->z0)
        return true;
    float z0 = g->z0[t], z1 = g->z1[t];
    if (z0 > z1)
        return false;
    if (s->radius < 0)
        return true;
    float x[2], y[2];
    tile_slopes(g, tx, ty, x, y);
    float x0 = x[0] * (x[0] < 0 ? z1 : z0), x1 = x[1] * (x[1] > 0 ? z1 : z0);
    float y1 = y[0] * (y[0] > 0 ? z1 : z0), y0 = y[1] * (y[1] < 0 ? z1 : z0);
    float dx = hl_outside(s->view.x, x0, x1);
    float dy = hl_outside(s->view.y, y0, y1);
    float dz = hl_outside(-s->view.z, z0, z1);
    return dx * dx + dy * dy + dz * dz < s->radius * s->radius;
}

/* With refs NULL count into first[t + 1], else write through cursors. */
static void visit(const struct hl_tile_grid *g, const struct hl_lit_sphere *s,
                  uint32_t i, uint32_t *first, uint32_t *refs)
{
    struct span p = sphere_span(g, s);
    for (uint32_t ty = p.y0; ty <= p.y1; ty++)
        for (uint32_t tx = p.x0; tx <= p.x1; tx++) {
            if (!reaches(g, s, tx, ty))
                continue;
            uint32_t t = ty * g->nx + tx;
            if (refs)
                refs[first[t]++] = i;
            else
                first[t + 1]++;
        }
}

uint32_t hl_tiles_fill(const struct hl_tile_grid *g,
                       const struct hl_lit_sphere *s, uint32_t n,
                       uint32_t *first, uint32_t *refs, uint32_t max_refs)
{
    uint32_t tiles = g->nx * g->ny;
    memset(first, 0, (tiles + 1) * sizeof *first);
    for (uint32_t i = 0; i < n; i++)
        visit(g, &s[i], i, first, NULL);
    uint64_t total = 0;
    for (uint32_t t = 0; t < tiles; t++)
        total += first[t + 1];
    if (total > max_refs)
        return total > 0xffffffffu ? 0xffffffffu : (uint32_t)total;
    for (uint32_t t = 0; t < tiles; t++)
        first[t + 1] += first[t];
    /* first[t] serves as tile t's cursor and ends as first[t + 1]. */
    for (uint32_t i = 0; i < n; i++)
        visit(g, &s[i], i, first, refs);
    for (uint32_t t = tiles; t > 0; t--)
        first[t] = first[t - 1];
    first[0] = 0;
    return (uint32_t)total;
}

static void tile_depth(float *z0, float *z1, const float *d, uint32_t w,
                       uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1,
                       float clear)
{
    float low = 2.0f, high = -2.0f;
    for (uint32_t y = y0; y < y1; y++) {
        const float *row = d + (size_t)y * w;
        for (uint32_t x = x0; x < x1; x++) {
            bool back = row[x] == clear;
            float a = back ? 2.0f : row[x], b = back ? -2.0f : row[x];
            low = a < low ? a : low;
            high = b > high ? b : high;
        }
    }
    *z0 = low;
    *z1 = high;
}

void hl_tiles_depth(float *z0, float *z1, const struct hl_tile_grid *g,
                    const float *d, uint32_t width, float a, float b,
                    float clear)
{
    uint32_t w = g->span.cols, h = g->span.rows, tile = g->tile;
    for (uint32_t ty = 0; ty < g->ny; ty++)
        for (uint32_t tx = 0; tx < g->nx; tx++) {
            uint32_t x0 = tx * tile, y0 = ty * tile;
            uint32_t x1 = x0 + tile < w ? x0 + tile : w;
            uint32_t y1 = y0 + tile < h ? y0 + tile : h;
            float low, high;
            tile_depth(&low, &high, d, width, x0, x1, y0, y1, clear);
            uint32_t t = ty * g->nx + tx;
            z0[t] = 1.0f;
            z1[t] = 0.0f;
            if (low > high)
                continue;
            /* z falls or rises with d, by the depth convention; a share of
             * 1e-5 covers the rounding of the shader's own division. */
            float p = a / (low + b), q = a / (high + b);
            z0[t] = (p < q ? p : q) * 0.99999f;
            z1[t] = (p < q ? q : p) * 1.00001f;
        }
}

float hl_tiles_peak(const struct hl_tile_grid *g, const uint32_t *first,
                    const uint32_t *refs, const struct hl_lit_sphere *s,
                    const struct hl_light *lights)
{
    float peak = 0;
    for (uint32_t t = 0; t < g->nx * g->ny; t++) {
        float sum = 0;
        for (uint32_t i = first[t]; i < first[t + 1]; i++)
            sum += hl_light_peak(&lights[s[refs[i]].light]);
        peak = sum > peak ? sum : peak;
    }
    return peak;
}

void hl_peak_begin(struct hl_peak_grid *g, const struct hl_camera *cam,
                   float aspect)
{
    memset(g, 0, sizeof *g);
    g->span = hl_span_whole(HL_PEAK_X, HL_PEAK_Y, cam, aspect);
}

bool hl_peak_add(struct hl_peak_grid *g, const struct hl_lit_sphere *s,
                 const struct hl_light *light)
{
    struct hl_rect b;
    float peak = hl_light_peak(light);
    if (!hl_sphere_rect(&b, s, &g->span))
        return false;
    for (int32_t y = b.y; y < b.y + b.height; y++)
        for (int32_t x = b.x; x < b.x + b.width; x++)
            g->sum[y * HL_PEAK_X + x] += peak;
    return true;
}

float hl_peak_of(const struct hl_peak_grid *g)
{
    float peak = 0;
    for (int i = 0; i < HL_PEAK_X * HL_PEAK_Y; i++)
        peak = g->sum[i] > peak ? g->sum[i] : peak;
    return peak;
}
