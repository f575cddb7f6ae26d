/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "platforms/cli/readback.h"
#include "platforms/reference/reference.h"
#include "tests/image_kit.h"

/* ---- scene ------------------------------------------------------------ */

static void draw_reference(struct ik_stage *s, uint32_t w, uint32_t h,
                           uint32_t samples)
{
    struct hlr_options o = { .width = w, .height = h, .samples = samples,
                             .normal_maps = true };
    free(s->reference.rgb);
    free(s->ids);
    s->reference.width = w;
    s->reference.height = h;
    s->reference.linear = true;
    s->reference.rgb = malloc((size_t)w * h * 12);
    s->ids = malloc((size_t)w * h * 4);
    assert_non_null(s->reference.rgb);
    assert_non_null(s->ids);
    assert_true(hlr_render(s->reference.rgb, s->ids, &s->scene, &o, NULL));
}

void ik_begin(struct ik_stage *s, struct ck_machine *m, const char *scene,
              uint32_t w, uint32_t h, const struct hlc_world_options *world)
{
    struct hlc_world_options none = { 0 };
    struct hlh_error error;
    struct hl_camera camera;
    memset(s, 0, sizeof *s);
    s->m = m;
    s->options.width = w;
    s->options.height = h;
    if (!hlh_scene_builtin(&s->scene, scene, &error) ||
        !hlc_world_create(&s->world, m->device, &s->scene,
                          world ? world : &none, &error))
        fail_msg("%s: %s", scene, error.text);
    assert_true(hlc_view(&camera, &s->scene, 0, 0, true));
    hlc_frame(&s->frame, &s->world, &camera);
    draw_reference(s, w, h, 1);
}

void ik_smooth_reference(struct ik_stage *s)
{
    draw_reference(s, s->reference.width, s->reference.height, 4);
}

void ik_end(struct ik_stage *s)
{
    hlc_world_free(&s->world);
    hlh_scene_free(&s->scene);
    free(s->reference.rgb);
    free(s->ids);
}

/* ---- pictures --------------------------------------------------------- */

static struct hlh_picture take(struct hl_device *d, hl_tex tex)
{
    struct hlh_picture p = { .linear = true };
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, d, tex), HL_OK);
    p.width = t.width;
    p.height = t.height;
    size_t n = (size_t)p.width * p.height;
    p.rgb = malloc(n * 12);
    assert_non_null(p.rgb);
    for (size_t i = 0; i < n; i++) {
        float v[4];
        hlc_texel(v, &t, i);
        memcpy(p.rgb + i * 3, v, 12);
    }
    hlc_texels_free(&t);
    return p;
}

struct hlh_picture ik_draw(struct ik_stage *s, enum hl_pipeline pipeline,
                           void (*look)(struct ik_stage *,
                                        struct hl_renderer *, void *),
                           void *user)
{
    struct hl_needs needs;
    struct hl_device *d = s->m->device;
    hlc_needs(&needs, &s->world, &s->frame, &s->options);
    assert_int_equal(hl_plan_make(&s->plan, pipeline, &needs,
                                  hl_device_caps(d), NULL), HL_OK);
    struct hl_renderer_desc desc = {
        .plan = &s->plan, .surfaces = s->world.surfaces,
        .n_surfaces = s->world.n_surfaces, .max_items = s->world.n_items,
        .max_lights = s->world.n_lights, .readback = true };
    void *memory = malloc(hl_renderer_bytes(&desc));
    struct hl_renderer *r;
    assert_non_null(memory);
    assert_int_equal(hl_renderer_create(&r, d, &desc, memory), HL_OK);
    assert_int_equal(hl_frame_draw(r, &s->frame, NULL), HL_OK);
    assert_int_equal(hl_submit(d, true), HL_OK);
    struct hlh_picture p = take(d, hl_renderer_output(r));
    if (look)
        look(s, r, user);
    hl_renderer_destroy(&r);
    free(memory);
    return p;
}

struct hlc_metrics ik_compare(struct ik_stage *s, struct hlh_picture *picture,
                              const char *name)
{
    struct hlc_metrics m;
    assert_true(hlc_metrics_measure(&m, picture, &s->reference, s->ids));
    print_message("%s: within 1/255 %.3f %%, PSNR %.2f dB, mean error %.2e"
                  " (edges %.2e), largest %.3f, FLIP %.4f\n", name,
                  m.within_1_255 * 100, m.psnr, m.mae, m.edge_mae, m.max,
                  m.flip);
    return m;
}

/* ---- failures --------------------------------------------------------- */

static void write_one(const struct hlh_picture *p, const char *name,
                      const char *kind)
{
    struct hlh_error error;
    char path[300];
    snprintf(path, sizeof path, "build/fail/%s%s.png", name, kind);
    for (char *c = path; *c; c++)
        if (*c == ' ' || *c == ',')
            *c = '_';
    if (!hlh_picture_write_png(p, 0, path, &error))
        print_error("%s\n", error.text);
    else
        print_error("wrote %s\n", path);
}

void ik_judge(struct ik_stage *s, struct hlh_picture *picture,
              const char *name, bool ok)
{
    if (!ok) {
        mkdir("build", 0777);
        mkdir("build/fail", 0777);
        write_one(picture, name, "");
        write_one(&s->reference, name, ".reference");
        size_t n = (size_t)picture->width * picture->height * 3;
        for (size_t i = 0; i < n; i++)
            picture->rgb[i] = 16 * fabsf(picture->rgb[i] -
                                         s->reference.rgb[i]);
        write_one(picture, name, ".difference");
    }
    free(picture->rgb);
    picture->rgb = NULL;
    if (!ok)
        fail_msg("%s is not what it should be", name);
}
