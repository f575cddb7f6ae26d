/* SPDX-License-Identifier: Zlib */
#ifndef RASTER_KIT_H
#define RASTER_KIT_H
/* packemu drawing triangles that a test states in pixels: x right, y down,
 * the corner of the first pixel at 0, 0; z is depth. Sizes are powers of two,
 * so that positions that are multiples of 1/256 arrive unrounded. */
#include "platforms/packemu/hl_packemu.h"
#include "platforms/packemu/pe.h"
#include "tests/check.h"

struct rk_vertex {
    float p[3], normal[3], tangent[4], uv[2], color[4];
};

enum { RK_DRAWS = 64 };

struct rk {
    struct ck_machine m;
    struct hl_device *d;
    uint32_t w, h, samples;
    hl_tex color, depth, resolved;       /* RGBA32_FLOAT; D24_UNORM_S8       */
    hl_buf pixels;                       /* object block: pixels to clip     */
    struct hl_prog_desc desc;            /* of the next draws; blend ADD     */
    struct hl_draw draw[RK_DRAWS];
    uint32_t n;
    struct hl_pass pass;                 /* clears to 0, depth 1, stencil 0  */
    float *out;                          /* 4 a pixel, of the last run       */
};

/* Stages: one and the next is which output channel has what. */
extern const struct hl_code rk_ones;     /* 1 1 1 1                          */
extern const struct hl_code rk_color;    /* the vertex colour                */
extern const struct hl_code rk_depths;   /* z, dz/dx, dz/dy, region id       */
extern const struct hl_code rk_uv;       /* u, v, back, 1                    */

void rk_open(struct rk *r, uint32_t threads, uint32_t w, uint32_t h,
             uint32_t samples);
void rk_open_profile(struct rk *r, const struct hl_profile *profile,
                     uint32_t w, uint32_t h);
void rk_close(struct rk *r);
/* A vertex at a pixel position, colour and all else 0, id 0. */
struct rk_vertex rk_at(float x, float y, float z);
hl_buf rk_buffer(struct rk *r, const void *data, size_t bytes, uint32_t usage);
/* A draw of desc with `stage`; indices NULL: of all vertices in order. The
 * stage NULL: no colours. Give back the draw to change it. */
struct hl_draw *rk_add(struct rk *r, const struct hl_code *stage,
                       const struct rk_vertex *v, uint32_t n,
                       const uint32_t *indices, uint32_t n_indices);
/* A draw of screen.vert. */
struct hl_draw *rk_screen(struct rk *r, const struct hl_code *stage);
/* Run what was added and read; then there are no draws again, and their
 * programs, vertices and indices are gone. */
const float *rk_run(struct rk *r);
/* Channel of a pixel of the last run. */
float rk_px(const struct rk *r, uint32_t x, uint32_t y, uint32_t channel);
#endif
