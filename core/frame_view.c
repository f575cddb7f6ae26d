/* SPDX-License-Identifier: Zlib */
/* Where the camera's picture lies on the targets: the drawn part, jitter.
 *
 * A device's viewport is the whole target. A part is drawn by shrinking clip
 * space towards its corner, and a scissor keeps what lies outside of the view
 * out of the rest. Frame and L-buffer shrink by the same share, so texels a
 * pixel stay what they were: filters and stipple patterns need not know.
 *
 * Jitter moves meshes alone. Light rectangles, tiles, scissors and the
 * stipple lattice belong to texels; view rays take the jitter out again. */
#include <string.h>
#include "core/renderer.h"

/* What a pixel at the part's edge reads beyond it: taps lie one texel out,
 * the fill looks two away, a stippled surface's samples a block. */
static uint32_t reads_past(const struct hl_plan *p)
{
    return p->stipple > 2 ? p->stipple : 2;
}

/* Whole texels that cover `x`, and `past` more. */
static uint32_t covered(float x, uint32_t past, uint32_t most)
{
    uint32_t n = (uint32_t)x;
    n += (float)n < x;
    return n + past < most ? n + past : most;
}

static void set_spans(struct hl_renderer *r, const struct hl_frame *f)
{
    const struct hl_plan *p = &r->plan;
    uint32_t w = f->width ? f->width : p->width;
    uint32_t h = f->height ? f->height : p->height;
    float lw = (float)p->light_width, lh = (float)p->light_height;
    float fw = (float)p->width, fh = (float)p->height;
    struct hl_span *s = &r->frame_span;
    *s = hl_span_whole(w, h, &f->camera, 1);
    s->tan_x = f->camera.tan_half_y * (float)w / (float)h;
    s->jx = f->camera.jitter[0];
    s->jy = f->camera.jitter[1];
    struct hl_span *l = &r->span;
    *l = *s;
    l->w = lw * ((float)w / fw);
    l->h = lh * ((float)h / fh);
    l->jx = s->jx * (lw / fw);
    l->jy = s->jy * (lh / fh);
    l->cols = covered(l->w, reads_past(p), p->light_width);
    l->rows = covered(l->h, reads_past(p), p->light_height);
}

/* Share by which what is drawn reaches past the picture's edge. */
static float past(float n, float w, float j)
{
    float out = (j < 0 ? -j : j) + (n > w ? n - w : 0.0f);
    return w > 0 ? 2.0f * out / w : 0.0f;
}

static struct hl_rect cut(const struct hl_span *s, uint32_t width,
                          uint32_t height)
{
    struct hl_rect all = { 0, 0, 0, 0 };
    struct hl_rect part = { 0, 0, (int32_t)s->cols, (int32_t)s->rows };
    return s->cols == width && s->rows == height ? all : part;
}

void hl_view_set(struct hl_renderer *r, const struct hl_frame *f)
{
    const struct hl_plan *p = &r->plan;
    set_spans(r, f);
    const struct hl_span *s = &r->frame_span, *l = &r->span;
    r->frame_scissor = cut(s, p->width, p->height);
    r->light_scissor = cut(l, p->light_width, p->light_height);
    float x = past(0, s->w, s->jx), y = past(0, s->h, s->jy);
    float lx = past((float)l->cols, l->w, l->jx);
    float ly = past((float)l->rows, l->h, l->jy);
    x = 1 + (x > lx ? x : lx);
    y = 1 + (y > ly ? y : ly);
    r->wide = f->camera;
    r->wide.tan_half_y *= y;
    r->wide_aspect = s->w / s->h * (x / y);
    struct hl_tile_grid *g = &r->grid;
    g->span = *l;
    g->nx = (l->cols + g->tile - 1) / g->tile;
    g->ny = (l->rows + g->tile - 1) / g->tile;
}

/* Without a far plane points at infinity are stored as this less than the
 * clear value where that is 1 (Lengyel 2007): roundings there neither clip
 * them nor put them behind the background. It is four steps of 24 bits. */
#define AT_INFINITY (1.0 / 4194304.0)

/* Depth as stored is y + x / z: clip z of view (x, y, -z, 1) over z. */
static void depth_row(const struct hl_renderer *r, const struct hl_camera *c,
                      float *x, float *y)
{
    double n = (double)c->near, f = (double)c->far, last = 1 - AT_INFINITY;
    bool rev = r->plan.reversed_depth;
    if (r->plan.infinite_far) {
        *x = (float)(rev ? n : -n * last);
        *y = (float)(rev ? 0 : -last);
        return;
    }
    *x = (float)(rev ? n * f / (f - n) : -n * f / (f - n));
    *y = (float)(rev ? n / (f - n) : -f / (f - n));
}

/* Reversed and without a far plane, what is cleared to 0 would lie at
 * infinity, where no light can be computed: it goes 2^22 times as far as the
 * camera sees, which moves nothing that is seen by a step of floats. */
void hl_depth_terms(const struct hl_renderer *r, const struct hl_camera *c,
                    float *x, float *y)
{
    depth_row(r, c, x, y);
    if (r->plan.infinite_far && r->plan.reversed_depth)
        *y = (float)((double)c->near / ((double)c->far * 4194304.0));
}

void hl_view_to_clip(const struct hl_renderer *r, const struct hl_camera *c,
                     bool jittered, float out[16])
{
    const struct hl_span *s = &r->frame_span;
    float w = (float)r->plan.width, h = (float)r->plan.height;
    float sx = s->w / w, sy = s->h / h;
    float jx = jittered ? s->jx : 0, jy = jittered ? s->jy : 0;
    memset(out, 0, 16 * sizeof *out);
    out[0] = sx / (c->tan_half_y * s->w / s->h);
    out[5] = -sy / c->tan_half_y;
    /* x += w (s - 1 + 2 jitter / width), where w is -z. */
    out[8] = (w - s->w - 2 * jx) / w;
    out[9] = (h - s->h - 2 * jy) / h;
    depth_row(r, c, &out[14], &out[10]);
    out[11] = -1.0f;
}
