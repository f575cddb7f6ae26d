/* SPDX-License-Identifier: Zlib */
/* Lights in view space and their bounds on the screen. */
#include <string.h>
#include "core/exact.h"
#include "core/light.h"
#include "core/vec.h"

static bool finite3(const float v[3])
{
    return v[0] - v[0] == 0 && v[1] - v[1] == 0 && v[2] - v[2] == 0;
}

const char *hl_light_check(const struct hl_light *l)
{
    if ((unsigned)l->kind > HL_DIRECTIONAL)
        return "kind";
    if ((unsigned)l->falloff > HL_INVERSE_SQUARE)
        return "falloff";
    if (!finite3(l->color) || l->color[0] < 0 || l->color[1] < 0 ||
        l->color[2] < 0)
        return "color";
    if (l->kind != HL_DIRECTIONAL && !finite3(l->position))
        return "position";
    if (l->kind != HL_DIRECTIONAL && !(l->radius >= 0 && l->radius < 1e30f))
        return "radius";
    if (l->kind != HL_POINT && (!finite3(l->direction) ||
                                hl_length3(hl_load3(l->direction)) < 0.5f))
        return "direction";
    if (l->kind == HL_SPOT &&
        !(l->inner >= 0 && l->outer >= l->inner && l->outer <= 3.1416f))
        return "inner, outer";
    return NULL;
}

float hl_light_peak(const struct hl_light *l)
{
    float c = l->color[0] > l->color[1] ? l->color[0] : l->color[1];
    c = c > l->color[2] ? c : l->color[2];
    /* Inverse square: 1 / 0.01^2 at the centre. */
    return l->kind != HL_DIRECTIONAL && l->falloff == HL_INVERSE_SQUARE
           ? c * 1e4f : c;
}

/* Slopes of the two tangents from the origin to a circle of radius r at
 * (c, z), z > r: the tangent points' directions turned by asin(r / d). */
static void tangents(float c, float z, float r, float *low, float *high)
{
    float t = sqrtf(c * c + z * z - r * r);
    *low = (c * t - z * r) / (z * t + c * r);
    *high = (c * t + z * r) / (z * t - c * r);
}

static void everywhere(struct hl_lit_sphere *s, float tan_x, float tan_y)
{
    s->x0 = -tan_x;
    s->x1 = tan_x;
    s->y0 = -tan_y;
    s->y1 = tan_y;
}

/* False: outside the view volume. */
static bool bound(struct hl_lit_sphere *s, const struct hl_camera *cam,
                  float tan_x, float tan_y)
{
    float z = -s->view.z, r = s->radius;
    s->z0 = z - r > cam->near ? z - r : cam->near;
    s->z1 = z + r < cam->far ? z + r : cam->far;
    if (s->z0 > s->z1)
        return false;
    /* Reaches the camera's plane: no tangents, bounds are the screen. The
     * 1e-3 keeps the square root away from cancellation. */
    if (z <= r * 1.001f) {
        everywhere(s, tan_x, tan_y);
        return true;
    }
    tangents(s->view.x, z, r, &s->x0, &s->x1);
    tangents(s->view.y, z, r, &s->y0, &s->y1);
    return s->x0 < tan_x && s->x1 > -tan_x && s->y0 < tan_y && s->y1 > -tan_y;
}

uint32_t hl_lights_view(struct hl_lit_sphere *out,
                        const struct hl_light *lights, uint32_t n_lights,
                        const struct hl_camera *cam, float aspect)
{
    float tan_y = cam->tan_half_y, tan_x = tan_y * aspect;
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_lights; i++) {
        const struct hl_light *l = &lights[i];
        struct hl_lit_sphere *s = &out[n];
        bool parallel = l->kind == HL_DIRECTIONAL;
        if (l->color[0] + l->color[1] + l->color[2] <= 0 ||
            (!parallel && l->radius <= 0))
            continue;
        memset(s, 0, sizeof *s);
        s->light = i;
        s->radius = parallel ? -1.0f : l->radius;
        s->z0 = cam->near;
        s->z1 = cam->far;
        everywhere(s, tan_x, tan_y);
        if (!parallel) {
            s->world = hl_load3(l->position);
            s->view = hl_transform_point(cam->view, s->world);
            if (!bound(s, cam, tan_x, tan_y))
                continue;
        }
        n++;
    }
    return n;
}

static int32_t clamp_int(float x, float high)
{
    return (int32_t)(x < 0 ? 0 : x > high ? high : x);
}

struct hl_span hl_span_whole(uint32_t w, uint32_t h,
                             const struct hl_camera *cam, float aspect)
{
    struct hl_span s;
    memset(&s, 0, sizeof s);
    s.w = (float)w;
    s.h = (float)h;
    s.cols = w;
    s.rows = h;
    s.tan_y = cam->tan_half_y;
    s.tan_x = cam->tan_half_y * aspect;
    return s;
}

bool hl_sphere_rect(struct hl_rect *out, const struct hl_lit_sphere *s,
                    const struct hl_span *p)
{
    float sx = p->w * 0.5f / p->tan_x, cx = p->w * 0.5f + p->jx;
    float sy = p->h * 0.5f / p->tan_y, cy = p->h * 0.5f + p->jy;
    float fw = (float)p->cols, fh = (float)p->rows;
    /* A quarter texel more than the bounds: centres of texels are half a
     * texel in, so no lit centre is lost to rounding. */
    int32_t x0 = clamp_int(floorf(cx + s->x0 * sx - 0.25f), fw);
    int32_t x1 = clamp_int(ceilf(cx + s->x1 * sx + 0.25f), fw);
    int32_t y0 = clamp_int(floorf(cy - s->y1 * sy - 0.25f), fh);
    int32_t y1 = clamp_int(ceilf(cy - s->y0 * sy + 0.25f), fh);
    out->x = x0;
    out->y = y0;
    out->width = x1 - x0;
    out->height = y1 - y0;
    return x1 > x0 && y1 > y0;
}

struct hl_box hl_box_world(const float m[16], const float min[3],
                           const float max[3])
{
    hl_vec3 c = hl_v3((min[0] + max[0]) * 0.5f, (min[1] + max[1]) * 0.5f,
                      (min[2] + max[2]) * 0.5f);
    hl_vec3 e = hl_v3((max[0] - min[0]) * 0.5f, (max[1] - min[1]) * 0.5f,
                      (max[2] - min[2]) * 0.5f);
    hl_vec3 p = hl_transform_point(m, c);
    hl_vec3 r = hl_v3(
        fabsf(m[0]) * e.x + fabsf(m[4]) * e.y + fabsf(m[8]) * e.z,
        fabsf(m[1]) * e.x + fabsf(m[5]) * e.y + fabsf(m[9]) * e.z,
        fabsf(m[2]) * e.x + fabsf(m[6]) * e.y + fabsf(m[10]) * e.z);
    struct hl_box b = { hl_sub3(p, r), hl_add3(p, r) };
    return b;
}

bool hl_sphere_touches_box(const struct hl_lit_sphere *s,
                           const struct hl_box *b)
{
    if (s->radius < 0)
        return true;
    float x = hl_outside(s->world.x, b->min.x, b->max.x);
    float y = hl_outside(s->world.y, b->min.y, b->max.y);
    float z = hl_outside(s->world.z, b->min.z, b->max.z);
    return x * x + y * y + z * z < s->radius * s->radius;
}

bool hl_box_visible(const struct hl_box *b, const struct hl_camera *cam,
                    float aspect, float *z)
{
    const float lo[3] = { b->min.x, b->min.y, b->min.z };
    const float hi[3] = { b->max.x, b->max.y, b->max.z };
    struct hl_box v = hl_box_world(cam->view, lo, hi);
    float z0 = -v.max.z, z1 = -v.min.z;
    *z = z0;
    if (z1 < cam->near || z0 > cam->far)
        return false;
    /* Planes x = +-tan z: the box's corner nearest to each. */
    float tan_y = cam->tan_half_y, tan_x = tan_y * aspect;
    return v.min.x <= tan_x * z1 && -v.max.x <= tan_x * z1 &&
           v.min.y <= tan_y * z1 && -v.max.y <= tan_y * z1;
}

static void spot_terms(const struct hl_light *l, float *scale, float *offset)
{
    float ci = (float)hl_exact_cos((double)l->inner);
    float co = (float)hl_exact_cos((double)l->outer);
    float d = ci - co;
    *scale = 1.0f / (d > 0.001f ? d : 0.001f);
    *offset = -co * *scale;
}

uint32_t hl_light_write(hl_vec4 *out, const struct hl_light *l,
                        const struct hl_lit_sphere *s, const float view[16],
                        uint32_t kinds)
{
    float inv = s->radius > 0 ? 1.0f / (s->radius * s->radius) : 0.0f;
    out[0] = hl_v4(s->view.x, s->view.y, s->view.z, inv);
    out[1] = hl_v4(l->color[0], l->color[1], l->color[2],
                   l->falloff == HL_INVERSE_SQUARE ? 1.0f : 0.0f);
    if (kinds == 0)
        return HL_POINT_VEC4S;
    hl_vec3 dir = hl_v3(0, 0, -1);
    /* A point light is a cone that is 1 everywhere: cos * 0 + 1. */
    float scale = 0, offset = 1, parallel = 0;
    if (l->kind != HL_POINT)
        dir = hl_normalize3(hl_transform_dir(view, hl_load3(l->direction)));
    if (l->kind == HL_SPOT)
        spot_terms(l, &scale, &offset);
    if (l->kind == HL_DIRECTIONAL)
        parallel = 1;
    out[2] = hl_v4(dir.x, dir.y, dir.z, scale);
    out[3] = hl_v4(offset, parallel, 0, 0);
    return HL_LIGHT_VEC4S;
}
