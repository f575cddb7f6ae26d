/* SPDX-License-Identifier: Zlib */
#ifndef HL_LIGHT_H
#define HL_LIGHT_H
/* Lights on the host: checking, view space, bounds on the screen, and which
 * touch what. No device. Scratch is the caller's. */
#include "core/plan.h"
#include "core/scene.h"

/* A light of this frame. Bounds are slopes: x / z and y / z of view space,
 * y up, z the depth in front of the camera. */
struct hl_lit_sphere {
    hl_vec3 world, view;     /* centre                                       */
    float radius;            /* < 0: directional, everywhere                 */
    float z0, z1;            /* depths it spans, z0 >= near                  */
    float x0, x1, y0, y1;    /* slopes it spans                              */
    uint32_t light;          /* index into the frame's lights                */
};

struct hl_box { hl_vec3 min, max; };

/* First broken rule of a light, NULL when it is good: "radius", "color"... */
const char *hl_light_check(const struct hl_light *);

/* Most that a light can add to a channel of D or S at any point. */
float hl_light_peak(const struct hl_light *);

/* How the camera's picture lies on a target: pixel p, y down, sees slope
 * x = tan_x (2 (p.x - jx) / w - 1), y = tan_y (1 - 2 (p.y - jy) / h). w and h
 * may have fractions, where the picture ends inside a pixel; what is drawn
 * are cols x rows pixels from the target's corner, which may be a few more. */
struct hl_span {
    float w, h, jx, jy;      /* pixels                                       */
    float tan_x, tan_y;      /* slopes at the picture's right and upper edge */
    uint32_t cols, rows;
};

/* A picture that fills a target of w x h pixels; aspect = width / height of
 * what the camera sees, which may differ from w / h. No jitter. */
struct hl_span hl_span_whole(uint32_t w, uint32_t h, const struct hl_camera *,
                             float aspect);

/* Lights that can add anything to what the camera sees, in input order.
 * aspect = width / height. Returns how many were written to out (at most
 * n_lights). */
uint32_t hl_lights_view(struct hl_lit_sphere *out, const struct hl_light *,
                        uint32_t n_lights, const struct hl_camera *,
                        float aspect);

/* Pixels of a sphere's bounds, of those that are drawn; false: none. */
bool hl_sphere_rect(struct hl_rect *out, const struct hl_lit_sphere *,
                    const struct hl_span *);

/* World box of a model-space box. */
struct hl_box hl_box_world(const float world[16], const float min[3],
                           const float max[3]);
bool hl_sphere_touches_box(const struct hl_lit_sphere *, const struct hl_box *);
/* False when the box lies outside the camera's view volume. *z: nearest
 * depth of the box, for sorting. */
bool hl_box_visible(const struct hl_box *, const struct hl_camera *,
                    float aspect, float *z);

/* One light's vec4s for a uniform or list (block.h): HL_POINT_VEC4S of them,
 * or HL_LIGHT_VEC4S when kinds != 0. Returns how many. */
uint32_t hl_light_write(hl_vec4 *out, const struct hl_light *,
                        const struct hl_lit_sphere *, const float view[16],
                        uint32_t kinds);

/* ---- tiles ---------------------------------------------------------- */

struct hl_tile_grid {
    struct hl_span span;
    uint32_t tile;           /* texels a side                                */
    uint32_t nx, ny;         /* that cover span.cols x span.rows             */
    /* nx * ny nearest and farthest depths, metres; z0 > z1: nothing there.
     * NULL: not known. */
    const float *z0, *z1;
};

/* CPU tile lists (one index list for all tiles, tile t has
 * refs[first[t]] .. refs[first[t + 1] - 1]). first: nx * ny + 1 entries.
 * Returns the number of entries, which may exceed max_refs: then the lists
 * are unusable and the caller reports it. */
uint32_t hl_tiles_fill(const struct hl_tile_grid *,
                       const struct hl_lit_sphere *, uint32_t n,
                       uint32_t *first, uint32_t *refs, uint32_t max_refs);

/* Nearest and farthest depth a tile of a depth buffer d (rows of `width`
 * floats): z = a / (d + b); texels at the clear value are background. */
void hl_tiles_depth(float *z0, float *z1, const struct hl_tile_grid *,
                    const float *d, uint32_t width, float a, float b,
                    float clear);

/* Bound of summed light at any point: the largest sum, over the tiles'
 * lists, of the colours' largest channel times the largest attenuation. */
float hl_tiles_peak(const struct hl_tile_grid *, const uint32_t *first,
                    const uint32_t *refs, const struct hl_lit_sphere *,
                    const struct hl_light *);

/* The same without lists: on a coarse grid of the screen, each cell sums every
 * light whose bounds touch it. */
enum { HL_PEAK_X = 16, HL_PEAK_Y = 9 };
struct hl_peak_grid {
    struct hl_span span;
    float sum[HL_PEAK_X * HL_PEAK_Y];
};
void hl_peak_begin(struct hl_peak_grid *, const struct hl_camera *,
                   float aspect);
/* False: it touches none. */
bool hl_peak_add(struct hl_peak_grid *, const struct hl_lit_sphere *,
                 const struct hl_light *);
float hl_peak_of(const struct hl_peak_grid *);
#endif
