/* SPDX-License-Identifier: Zlib */
/* KHR_lights_punctual and cameras. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "platforms/host/gltf.h"

#define PI 3.14159265358979323846
/* Room for exporters that write pi / 2 as a float. */
#define ANGLE_SLACK 1e-6
/* Squares and products of these stay within a float. */
#define POSITION_LIMIT 1e12
#define RADIUS_LIMIT 1e18
#define COLOR_LIMIT 1e30

struct light {
    enum hlh_light_kind kind;
    double color[3], intensity, range, inner, outer;
    bool has_range, shadow, smooth;
};

static bool read_spot(struct gltf *g, const cJSON *item, const char *where,
                      struct light *l)
{
    const cJSON *spot;
    l->inner = 0;
    l->outer = PI / 4;
    if (!gltf_object(g, item, where, "spot", &spot) ||
        !gltf_number(g, spot, where, "innerConeAngle", &l->inner) ||
        !gltf_number(g, spot, where, "outerConeAngle", &l->outer))
        return false;
    if (!(l->inner >= 0 && l->inner <= l->outer &&
          l->outer <= PI / 2 + ANGLE_SLACK))
        return hlh_fail(g->error, g->file, "%s.spot: angles are %g and %g, "
                        "not 0 <= inner <= outer <= pi/2", where, l->inner,
                        l->outer);
    return true;
}

static bool read_kind(struct gltf *g, const cJSON *item, const char *where,
                      enum hlh_light_kind *kind)
{
    const char *type;
    if (!gltf_string(g, item, where, "type", &type))
        return false;
    if (type && strcmp(type, "point") == 0)
        *kind = HLH_LIGHT_POINT;
    else if (type && strcmp(type, "spot") == 0)
        *kind = HLH_LIGHT_SPOT;
    else if (type && strcmp(type, "directional") == 0)
        *kind = HLH_LIGHT_DIRECTIONAL;
    else
        return hlh_fail(g->error, g->file, "%s.type: is \"%.20s\", not point, "
                        "spot or directional", where, type ? type : "");
    return true;
}

static bool read_light(struct gltf *g, uint32_t i, struct light *l)
{
    const cJSON *item = g->list[GLTF_LIGHTS].item[i];
    char where[64];
    snprintf(where, sizeof where,
             "extensions.KHR_lights_punctual.lights[%u]", (unsigned)i);
    memset(l, 0, sizeof *l);
    l->color[0] = l->color[1] = l->color[2] = l->intensity = 1;
    l->has_range = cJSON_GetObjectItemCaseSensitive(item, "range") != NULL;
    if (!read_kind(g, item, where, &l->kind) ||
        !gltf_numbers(g, item, where, "color", l->color, 3) ||
        !gltf_number(g, item, where, "intensity", &l->intensity) ||
        !gltf_number(g, item, where, "range", &l->range))
        return false;
    for (int k = 0; k < 3; k++)
        if (l->color[k] < 0)
            return hlh_fail(g->error, g->file, "%s.color: is negative: %g",
                            where, l->color[k]);
    if (l->intensity < 0)
        return hlh_fail(g->error, g->file, "%s.intensity: is negative: %g",
                        where, l->intensity);
    if (l->range < 0)
        return hlh_fail(g->error, g->file, "%s.range: is negative: %g", where,
                        l->range);
    for (int k = 0; k < 3; k++)
        if (!(l->color[k] * l->intensity <= COLOR_LIMIT))
            return hlh_fail(g->error, g->file, "%s: is brighter than 1e30",
                            where);
    if (l->range > RADIUS_LIMIT)
        return hlh_fail(g->error, g->file, "%s.range: is beyond 1e18", where);
    const cJSON *falloff = gltf_extra(item, "falloff");
    l->shadow = cJSON_IsTrue(gltf_extra(item, "shadow"));
    l->smooth = cJSON_IsString(falloff) && falloff->valuestring &&
                strcmp(falloff->valuestring, "smooth") == 0;
    return l->kind != HLH_LIGHT_SPOT || read_spot(g, item, where, l);
}

bool gltf_check_lights(struct gltf *g)
{
    struct light l;
    for (uint32_t i = 0; i < g->list[GLTF_LIGHTS].n; i++)
        if (!read_light(g, i, &l))
            return false;
    return true;
}

/* The world direction of the node's axis (column 0 to 2), times sign. */
static bool axis(struct gltf *g, const double world[16], int column,
                 double sign, const char *where, float out[3])
{
    const double *v = world + 4 * column;
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0))
        return hlh_fail(g->error, g->file, "%s: is scaled to nothing, so that "
                        "its light or camera has no direction", where);
    /* What is unit to a float's rounding stays as it is, so that a direction
     * that was written reads back bit for bit. */
    if (fabs(length - 1) < 4.4e-7)
        length = 1;
    for (int k = 0; k < 3; k++)
        out[k] = (float)(sign * v[k] / length);
    return true;
}

static bool position(struct gltf *g, const double world[16],
                     const char *where, float out[3])
{
    for (int k = 0; k < 3; k++) {
        if (!(fabs(world[12 + k]) <= POSITION_LIMIT))
            return hlh_fail(g->error, g->file, "%s: its light or camera is "
                            "farther than 1e12 metres from the origin", where);
        out[k] = (float)world[12 + k];
    }
    return true;
}

bool gltf_add_light(struct gltf *g, uint32_t i, const double world[16],
                    const char *where)
{
    struct hlh_scene *s = g->scene;
    struct hlh_light *out;
    struct light l;
    double brightest = 0;
    if (!read_light(g, i, &l))
        return false;
    out = hlh_push(&s->lights, &s->n_lights, sizeof *out);
    if (!out)
        return gltf_memory(g);
    out->kind = l.kind;
    out->falloff = l.smooth ? HLH_FALLOFF_SMOOTH : HLH_FALLOFF_INVERSE_SQUARE;
    out->shadow = l.shadow;
    out->direction[1] = -1;
    for (int k = 0; k < 3; k++) {
        double c = l.color[k] * l.intensity;
        out->color[k] = (float)(c / PI);
        brightest = c > brightest ? c : brightest;
    }
    if (!position(g, world, where, out->position))
        return false;
    if (l.kind != HLH_LIGHT_POINT &&
        !axis(g, world, 2, -1, where, out->direction))
        return false;
    if (l.kind == HLH_LIGHT_SPOT) {
        out->inner_angle = (float)l.inner;
        out->outer_angle = (float)l.outer;
    }
    if (l.kind == HLH_LIGHT_DIRECTIONAL)
        return true;
    out->radius = (float)l.range;
    if (!l.has_range) {
        out->radius = (float)sqrt(256 * brightest);
        out->range_derived = true;
        s->lights_range_derived++;
    }
    return true;
}

/* *vfov is 0 for an orthographic camera, which is ignored. */
static bool read_camera(struct gltf *g, uint32_t i, double *vfov,
                        double *aspect)
{
    const cJSON *item = g->list[GLTF_CAMERAS].item[i], *perspective;
    const char *type;
    char where[48];
    *vfov = *aspect = 0;
    snprintf(where, sizeof where, "cameras[%u]", (unsigned)i);
    if (!gltf_string(g, item, where, "type", &type))
        return false;
    if (type && strcmp(type, "orthographic") == 0)
        return true;
    if (!type || strcmp(type, "perspective") != 0)
        return hlh_fail(g->error, g->file, "%s.type: is \"%.20s\", not "
                        "perspective or orthographic", where,
                        type ? type : "");
    if (!gltf_object(g, item, where, "perspective", &perspective) ||
        !gltf_number(g, perspective, where, "yfov", vfov) ||
        !gltf_number(g, perspective, where, "aspectRatio", aspect))
        return false;
    *vfov *= 180 / PI;
    if (!(*vfov >= 0.001 && *vfov <= 179.999))
        return hlh_fail(g->error, g->file, "%s.perspective.yfov: is %g "
                        "degrees, not from 0.001 to 179.999", where, *vfov);
    if (!(*aspect >= 0 && *aspect <= 1e4))
        return hlh_fail(g->error, g->file, "%s.perspective.aspectRatio: is "
                        "%g", where, *aspect);
    return true;
}

bool gltf_check_cameras(struct gltf *g)
{
    double vfov, aspect;
    for (uint32_t i = 0; i < g->list[GLTF_CAMERAS].n; i++)
        if (!read_camera(g, i, &vfov, &aspect))
            return false;
    return true;
}

bool gltf_add_camera(struct gltf *g, uint32_t i, const double world[16],
                     const char *where)
{
    struct hlh_camera *c = &g->scene->camera;
    double vfov, aspect, reach = 1;
    float forward[3];
    if (!read_camera(g, i, &vfov, &aspect))
        return false;
    if (!(vfov > 0) || c->vfov > 0)
        return true;
    if (!axis(g, world, 2, -1, where, forward) ||
        !axis(g, world, 1, 1, where, c->up) ||
        !position(g, world, where, c->eye))
        return false;
    /* As far as the eye is from the origin: far out, one metre would drown
     * in the target's rounding and turn the camera. */
    for (int k = 0; k < 3; k++)
        reach += fabs(world[12 + k]);
    for (int k = 0; k < 3; k++)
        c->target[k] = (float)(c->eye[k] + reach * forward[k]);
    c->vfov = (float)vfov;
    c->aspect = (float)aspect;
    return true;
}
