/* SPDX-License-Identifier: Zlib */
/* render: one picture of a scene, or timed ones, and what is known of it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/probe.h"
#include "platforms/cli/render.h"
#include "platforms/host/util.h"

/* ---- before ------------------------------------------------------------ */

static bool check_outputs(const struct hlc_options *o, struct hlh_error *error)
{
    const char *path[] = { o->out, o->hdr, o->json, o->ids };
    enum { N = sizeof path / sizeof *path };
    for (int i = 0; i < N; i++) {
        if (!hlc_output_check(path[i], error))
            return false;
        for (int k = 0; k < i; k++)
            if (path[i] && path[k] && strcmp(path[i], path[k]) == 0)
                return hlh_fail(error, path[i], "named for two outputs");
    }
    return hlc_output_check_folder(o->dump, error);
}

/* ---- after ------------------------------------------------------------- */

static void count_non_finite(struct hlc_render *r)
{
    size_t n = (size_t)r->picture.width * r->picture.height;
    for (size_t i = 0; i < n; i++) {
        const float *p = r->picture.rgb + 3 * i;
        r->non_finite += !(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]));
    }
}

static bool noted(struct hlc_outputs *files, const char *path, bool ok)
{
    if (ok)
        hlc_outputs_add(files, path);
    return ok;
}

static bool write_files(struct hlc_render *r, struct hlc_outputs *files,
                        struct hlh_error *error)
{
    const struct hlc_options *o = r->o;
    const struct hlh_picture *p = &r->picture;
    return (!o->out || noted(files, o->out, hlh_picture_write_png(
                                 p, o->exposure, o->out, error))) &&
           (!o->hdr || noted(files, o->hdr, hlh_picture_write_pfm(
                                 p, o->hdr, error))) &&
           (!o->ids || noted(files, o->ids, hlh_ids_write_png(
                                 r->inside.ids, p->width, p->height, o->ids,
                                 error))) &&
           (!o->dump || hlc_dump(r, files, error)) &&
           (!o->json || noted(files, o->json, hlc_render_json(r, error)));
}

static void print_time(const struct hlc_render *r)
{
    const struct hlc_spread *f = &r->frame_ms;
    if (r->o->reference)
        printf("drawn in %.2f s on %u threads\n", f->median / 1000,
               r->threads);
    else if (f->n)
        printf("frame %.2f ms (median of %u; %.2f to %.2f)\n", f->median,
               f->n, f->min, f->max);
    for (uint32_t i = 0; i < r->n_passes; i++)
        printf("%s%s %.2f ms%s", i ? ", " : "  ", r->passes[i].name,
               r->passes[i].ms, i + 1 < r->n_passes ? "" : "\n");
}

static void print_where(const struct hlc_render *r)
{
    const struct hl_plan *p = &r->shot.plan;
    const struct hl_caps *caps = &r->stage.machine.caps;
    if (r->o->reference) {
        printf("reference renderer, %u x %u\n", r->o->width, r->o->height);
        return;
    }
    printf("%s, %u x %u", hlc_pipeline_name(p->pipeline), p->width,
           p->height);
    if (p->samples > 1)
        printf(", %u samples", p->samples);
    if (p->light_width)
        printf(", lit at %u x %u", p->light_width, p->light_height);
    printf(", on %s (%s)\n", caps->device, caps->backend);
}

static void print_summary(const struct hlc_render *r)
{
    const struct hlc_options *o = r->o;
    const char *path[] = { o->out, o->hdr, o->ids, o->json, o->dump };
    const struct hlh_scene *s = &r->stage.scene;
    printf("%s: %u objects, %llu triangles, %u lights\n", s->name,
           s->n_objects, (unsigned long long)s->n_triangles, s->n_lights);
    print_where(r);
    print_time(r);
    if (r->non_finite)
        printf("%llu pixels are not finite\n",
               (unsigned long long)r->non_finite);
    for (size_t i = 0; i < sizeof path / sizeof *path; i++)
        if (path[i])
            printf("wrote %s\n", path[i]);
}

/* ---- the command ------------------------------------------------------- */

static int draw_and_write(struct hlc_render *r, struct hlc_outputs *files)
{
    struct hlh_error error;
    int code = r->o->reference ? hlc_render_reference(r)
                               : hlc_render_device(r);
    if (code != HLC_DONE)
        return code;
    count_non_finite(r);
    if (!write_files(r, files, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    if (!r->o->json || strcmp(r->o->json, "-"))
        print_summary(r);
    return HLC_DONE;
}

int hlc_cmd_render(const struct hlc_options *o)
{
    struct hlh_error error;
    struct hlc_outputs files = { NULL, 0, NULL };
    struct hlc_render *r = calloc(1, sizeof *r);
    if (!r)
        return hlc_fail(HLC_BAD, "out of memory");
    r->o = o;
    r->probe = hlc_probe_wanted(o) ? hlc_probe_measure : NULL;
    int code = HLC_DONE;
    if (!check_outputs(o, &error) ||
        !hlc_scene_open(&r->stage.scene, o, &error))
        code = hlc_fail(HLC_BAD, "%s", error.text);
    if (code == HLC_DONE) {
        code = draw_and_write(r, &files);
        hlc_outputs_end(&files, code != HLC_DONE);
        hlc_render_device_free(r);
        hlh_picture_free(&r->picture);
        free(r->inside.ids);
        free(r->inside.lights);
        free(r->inside.rejects);
        free(r->inside.stipple);
    }
    free(r);
    return code;
}
