/* SPDX-License-Identifier: Zlib */
/* The camera, the frame of a world, and what that frame needs. */
#include <math.h>
#include <string.h>
#include "platforms/cli/bridge.h"

/* ---- camera ------------------------------------------------------------ */

struct axes { double right[3], up[3], forward[3]; };

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool normalise(double v[3])
{
    double n = sqrt(dot(v, v));
    for (int k = 0; k < 3 && n > 0; k++)
        v[k] /= n;
    return n > 0;
}

/* Directions less than this apart are parallel: sine of the angle. */
#define PARALLEL 1e-6

/* The file's up, else y, else -z: the first that the view is not along. */
static bool axes_of(struct axes *out, const struct hlh_camera *c)
{
    double ups[3][3] = { { c->up[0], c->up[1], c->up[2] }, { 0, 1, 0 },
                         { 0, 0, -1 } };
    for (int k = 0; k < 3; k++)
        out->forward[k] = (double)c->target[k] - (double)c->eye[k];
    if (!normalise(out->forward))
        return false;
    for (int i = 0; i < 3; i++) {
        normalise(ups[i]);
        cross(out->right, out->forward, ups[i]);
        if (dot(out->right, out->right) > PARALLEL * PARALLEL)
            break;
    }
    normalise(out->right);
    cross(out->up, out->right, out->forward);
    return true;
}

/* hl_camera_look_at takes no up of a file's own; in double, as eyes far from
 * the origin lose digits. */
static void set_view(struct hl_camera *out, const struct axes *a,
                     const float eye[3])
{
    double e[3] = { eye[0], eye[1], eye[2] };
    for (int k = 0; k < 3; k++) {
        out->view[4 * k] = (float)a->right[k];
        out->view[4 * k + 1] = (float)a->up[k];
        out->view[4 * k + 2] = (float)-a->forward[k];
        out->view[4 * k + 3] = 0;
    }
    out->view[12] = (float)-dot(a->right, e);
    out->view[13] = (float)-dot(a->up, e);
    out->view[14] = (float)dot(a->forward, e);
    out->view[15] = 1;
}

static void depths_of(double *low, double *high, const struct axes *a,
                      const struct hlh_scene *s)
{
    for (int i = 0; i < 8; i++) {
        double z = 0;
        for (int k = 0; k < 3; k++) {
            float corner = i >> k & 1 ? s->bounds_max[k] : s->bounds_min[k];
            z += ((double)corner - (double)s->camera.eye[k]) * a->forward[k];
        }
        *low = i == 0 || z < *low ? z : *low;
        *high = i == 0 || z > *high ? z : *high;
    }
}

bool hlc_view(struct hl_camera *out, const struct hlh_scene *scene,
              double near, double far, bool fine_depth)
{
    struct axes a;
    double low = 0, high = 0, margin = 1e-3;
    if (!axes_of(&a, &scene->camera))
        return false;
    depths_of(&low, &high, &a, scene);
    double reach = high > 0 ? high * (1 + margin) : 1;
    if (!(far > 0))
        far = near >= reach ? 2 * near : reach;
    if (!(near > 0)) {
        double least = fmin(far, reach) * (fine_depth ? 1e-5 : 1e-3);
        near = fmax(low * (1 - margin), least);
    }
    if (near >= far)
        near = far / 2;
    if (hl_camera_look_at(out, scene->camera.eye, scene->camera.target,
                          scene->camera.vfov, (float)near,
                          (float)far) != HL_OK)
        return false;
    set_view(out, &a, scene->camera.eye);
    return true;
}

/* ---- frame and needs --------------------------------------------------- */

void hlc_frame(struct hl_frame *out, const struct hlc_world *world,
               const struct hl_camera *camera)
{
    memset(out, 0, sizeof *out);
    out->camera = *camera;
    out->items = world->items;
    out->n_items = world->n_items;
    out->lights = world->lights;
    out->n_lights = world->n_lights;
    memcpy(out->ambient, world->scene->ambient, sizeof out->ambient);
    memcpy(out->background, world->scene->background, sizeof out->background);
}

static uint32_t fits32(uint64_t n)
{
    return n < UINT32_MAX ? (uint32_t)n : UINT32_MAX;
}

static void needs_of_features(struct hl_needs *out,
                              const struct hlc_options *o)
{
    out->shadows = o->shadows;
    out->shadow_size = o->shadow_size;
    out->volume_texels = o->volume_texels;
    out->translucency = o->translucency;
    out->stipple_mode = o->stipple_mode;
    out->stipple_filter = o->stipple_filter;
    out->fill = o->fill;
    out->fetch = o->fetch;
    out->motion = o->motion;
    out->no_centroid = o->no_centroid;
}

static void count_features(struct hl_needs *out,
                           const struct hlc_world *world)
{
    out->n_shadow_lights = 0;
    for (uint32_t i = 0; i < world->n_lights; i++) {
        out->n_shadow_lights += world->lights[i].shadow;
        out->shadow_points |= world->lights[i].shadow &&
                              world->lights[i].kind == HL_POINT;
    }
    /* Zero would be an unknown number to the planner. */
    if (out->n_shadow_lights == 0)
        out->shadows = HL_SHADOWS_NONE;
    for (uint32_t i = 0; i < world->scene->n_materials; i++)
        out->brdfs |= world->materials[i].brdf != HL_BRDF_BLINN_PHONG;
}

void hlc_needs(struct hl_needs *out, const struct hlc_world *world,
               const struct hl_frame *frame, const struct hlc_options *o)
{
    memset(out, 0, sizeof *out);
    out->width = o->width;
    out->height = o->height;
    out->light_width = o->light_width;
    out->light_height = o->light_height;
    out->samples = o->samples;
    out->far = frame->camera.far;
    out->budget_codes = o->has_max_error ? (float)o->max_error : 0;
    out->budget_ms = (float)o->max_cost;
    out->light_path = o->light_path;
    out->batch = o->light_batch;
    out->tile = o->tile;
    out->no_tile_depth = o->no_tile_depth;
    out->no_scissor = o->no_scissor;
    out->dsf = o->dsf;
    out->dsf_k = (float)o->dsf_k;
    out->dsf_c = (float)o->dsf_c;
    out->dsf_tau = (float)o->dsf_tau;
    out->light_format = o->light_format;
    out->normal_format = o->normal_format;
    out->half_pixel = o->half_pixel;
    needs_of_features(out, o);
    hl_needs_measure(out, frame, world->surfaces,
                     (float)o->width / (float)o->height);
    out->n_regions = fits32(world->ids.regions);
    count_features(out, world);
}
