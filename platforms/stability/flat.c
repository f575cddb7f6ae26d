/* SPDX-License-Identifier: Zlib */
#include "platforms/stability/flat.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

/* Twice the arc tangent of a half: the picture is as high as far away. */
#define VFOV 53.13010235415598

bool hls_broken(struct hls_lab *lab, const char *line)
{
    size_t n = strlen(line) < sizeof lab->note ? strlen(line)
                                               : sizeof lab->note - 1;
    memcpy(lab->note, line, n);
    lab->note[n] = 0;
    hlc_fail(0, "stability: %s", lab->note);
    return false;
}

void hls_flat_begin(struct hls_flat *f, uint32_t width, uint32_t height)
{
    struct hlh_v3 down = { 0, 0, -1 }, white = { 1, 1, 1 };
    memset(f, 0, sizeof *f);
    f->width = width;
    f->height = height;
    hlh_build_begin(&f->b, &f->scene, 1);
    hlh_build_camera(&f->b, hlh_v3(0, 0, height), hlh_v3(0, 0, 0), VFOV);
    hlh_build_directional(&f->b, down, white);
}

void hls_flat_piece(struct hls_flat *f, const double middle[2],
                    const double a[2], const double b[2], double back,
                    double light)
{
    double s = 1 + back, z = -back * f->height;
    double x = (middle[0] - f->width / 2.0) * s;
    double y = (f->height / 2.0 - middle[1]) * s;
    struct hlh_v3 u = { 2 * a[0] * s, -2 * a[1] * s, 0 };
    struct hlh_v3 v = { 2 * b[0] * s, -2 * b[1] * s, 0 };
    if (u.x * v.y < u.y * v.x) {       /* to the camera                      */
        struct hlh_v3 w = u;
        u = v;
        v = w;
    }
    uint32_t first = f->b.n_vertices;
    hlh_add_patch(&f->b, hlh_v3(x - (u.x + v.x) / 2, y - (u.y + v.y) / 2, z),
                  u, v, 1, 1);
    for (uint32_t i = first; i < f->b.n_vertices; i++) {
        float *n = f->b.vertices[i].normal;
        n[0] = (float)sqrt(1 - light * light);
        n[1] = 0;
        n[2] = (float)light;
    }
}

void hls_flat_object(struct hls_flat *f, double grey, double alpha)
{
    uint32_t m = hlh_build_material(&f->b, "flat", hlh_v3(grey, grey, grey),
                                    1, 0);
    if (alpha < 1) {
        struct hlh_material *material = hlh_build_last_material(&f->b);
        material->base_color[3] = (float)alpha;
        material->alpha = HLH_ALPHA_BLEND;
    }
    hlh_build_object_at_origin(&f->b, hlh_build_mesh(&f->b, "flat", m));
}

void hls_flat_light(struct hls_flat *f, double color)
{
    for (uint32_t i = 0; i < f->scene.n_lights; i++)
        for (int k = 0; k < 3; k++)
            f->scene.lights[i].color[k] = (float)color;
}

bool hls_flat_end(struct hls_flat *f, struct hls_lab *lab,
                  const struct hlc_options *o)
{
    struct hlh_error error = { "out of memory" };
    free(f->b.vertices);
    free(f->b.indices);
    f->scene.name = hlh_strdup("stability");
    if (!f->b.failed && f->scene.name &&
        hlh_scene_finish(&f->scene, "stability", true, &error))
        return hls_lab_scene(lab, &f->scene, o) ||
               hls_broken(lab, "no stage to draw on");
    hlh_scene_free(&f->scene);
    return hls_broken(lab, error.text);
}

struct hlc_options hls_flat_options(const struct hls_lab *lab, uint32_t width,
                                    uint32_t height, uint32_t eighths)
{
    struct hlc_options o = *lab->o;
    o.width = width;
    o.height = height;
    o.samples = 1;
    o.light_width = width * eighths / 8;
    o.light_height = height * eighths / 8;
    o.pipeline = HL_PIPELINE_INFERRED;
    o.no_specular = true;
    return o;
}

static bool open_shot(struct hlc_shot *shot, struct hls_lab *lab,
                      const struct hlc_options *o)
{
    char line[HLC_PLAN_LINE];
    return hlc_shot_open(shot, &lab->stage, o, NULL, NULL, line) ==
               HLC_DONE || hls_broken(lab, line);
}

bool hls_flat_draw(struct hlh_picture *out, struct hls_lab *lab,
                   const struct hlc_options *o)
{
    struct hlc_shot shot;
    memset(out, 0, sizeof *out);
    if (!open_shot(&shot, lab, o))
        return false;
    enum hl_result r = hlc_shot_draw(&shot, NULL);
    r = r == HL_OK ? hlc_shot_read(&shot, out) : r;
    hlc_shot_close(&shot);
    return r == HL_OK || hls_broken(lab, hl_result_name(r));
}

bool hls_flat_inspect(void **out, enum hl_inspect what, struct hls_lab *lab,
                      const struct hlc_options *o)
{
    struct hlc_shot shot;
    uint32_t width, height;
    *out = NULL;
    if (!open_shot(&shot, lab, o))
        return false;
    enum hl_result r = hlc_shot_draw(&shot, NULL);
    r = r == HL_OK ? hlc_shot_inspect(&shot, what, out, &width, &height) : r;
    hlc_shot_close(&shot);
    return r == HL_OK || hls_broken(lab, hl_result_name(r));
}
