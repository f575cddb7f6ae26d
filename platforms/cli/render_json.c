/* SPDX-License-Identifier: Zlib */
/* The JSON of render; docs/json.md says what each key means. */
#include <string.h>
#include "platforms/cli/json.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/render.h"

/* cJSON adds to a NULL object without harm; the emission then fails. */
static cJSON *object(cJSON *in, const char *key)
{
    return cJSON_AddObjectToObject(in, key);
}

static void text(cJSON *in, const char *key, const char *value)
{
    cJSON_AddStringToObject(in, key, value ? value : "");
}

static void put_machine(cJSON *tree, const struct hlc_render *r)
{
    bool reference = r->o->reference;
    const struct hl_caps *caps = &r->stage.machine.caps;
    const struct hl_plan *p = &r->shot.plan;
    text(tree, "backend", reference ? "reference" : caps->backend);
    text(tree, "device", reference ? "host" : caps->device);
    text(tree, "driver", reference ? "" : caps->driver);
    text(tree, "profile", reference ? "native" : p->profile);
    text(tree, "pipeline", reference ? "reference"
                                     : hlc_pipeline_name(p->pipeline));
    if (!reference) {
        cJSON_AddItemToObject(tree, "plan", hlc_plan_json(p));
        return;
    }
    hlc_json_uint(tree, "threads", r->threads);
    cJSON_AddNullToObject(tree, "plan");
}

static void put_spread(cJSON *tree, const char *key,
                       const struct hlc_spread *s)
{
    cJSON *o = object(tree, key);
    const double v[3] = { s->median, s->min, s->max };
    const char *const names[3] = { "median", "min", "max" };
    for (int i = 0; i < 3; i++) {
        if (s->n)
            hlc_json_real(o, names[i], v[i], 5);
        else
            cJSON_AddNullToObject(o, names[i]);
    }
    hlc_json_uint(o, "n", s->n);
}

static void put_times(cJSON *tree, const struct hlc_render *r)
{
    put_spread(tree, "frame_ms", &r->frame_ms);
    if (!r->o->reference) {
        put_spread(tree, "record_ms", &r->record_ms);
        hlc_json_real(tree, "first_frame_ms", r->first_ms, 5);
    }
    cJSON *passes = cJSON_AddArrayToObject(tree, "passes");
    for (uint32_t i = 0; i < r->n_passes; i++) {
        cJSON *p = cJSON_CreateObject();
        text(p, "name", r->passes[i].name);
        hlc_json_real(p, "ms", r->passes[i].ms, 5);
        cJSON_AddItemToArray(passes, p);
    }
}

/* Of the shading pass: L-buffer texels for the inferred pipeline. */
static double shaded_pixels(const struct hlc_render *r)
{
    if (r->inside.lights)
        return (double)r->inside.lights_width * r->inside.lights_height;
    return (double)r->o->width * r->o->height;
}

static void put_feature_counts(cJSON *c, const struct hl_frame_stats *s)
{
    const struct { const char *key; uint32_t n; } row[] = {
        { "stippled", s->stippled }, { "unstippled", s->unstippled },
        { "stipple_conflicts", s->stipple_conflicts },
        { "stipple_changes", s->stipple_changes }, { "decals", s->decals },
        { "light_volumes", s->light_volumes },
        { "shadow_lights", s->shadow_lights },
        { "shadow_casters", s->shadow_casters },
        { "shadow_triangles", s->shadow_triangles },
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        hlc_json_uint(c, row[i].key, row[i].n);
}

static void put_counts(cJSON *tree, const struct hlc_render *r)
{
    cJSON *c = object(tree, "counts");
    const struct hl_frame_stats *s = &r->shot.stats;
    if (r->o->reference) {
        cJSON_AddNullToObject(c, "draws");
        cJSON_AddNullToObject(c, "blends");
        hlc_json_uint(c, "surfaces", r->surfaces);
    } else {
        hlc_json_uint(c, "draws", s->draws);
        hlc_json_uint(c, "blends", s->blends);
        hlc_json_uint(c, "items", s->items);
        hlc_json_uint(c, "items_culled", s->items_culled);
        hlc_json_uint(c, "lights", s->lights);
        hlc_json_uint(c, "lights_culled", s->lights_culled);
        hlc_json_uint(c, "light_refs", s->light_refs);
    }
    if (!r->o->reference)
        put_feature_counts(c, s);
    hlc_json_uint(c, "light_evaluations", r->light_evaluations);
    hlc_json_real(c, "lights_per_pixel_mean",
                  (double)r->light_evaluations / shaded_pixels(r), 9);
    /* Lights that a full list left out: none of today's pipelines drops one,
     * they refuse the frame instead. */
    hlc_json_uint(c, "overflow", 0);
    if (r->shot.plan.light_width) {
        hlc_json_real(c, "light_peak", (double)s->light_peak, 6);
        cJSON_AddBoolToObject(c, "light_may_clip", s->light_may_clip);
    }
    hlc_json_uint(tree, "non_finite_pixels", r->non_finite);
}

static void put_dsf(cJSON *tree, const struct hlc_render *r)
{
    double taps[5] = { 0 };
    size_t n = (size_t)r->picture.width * r->picture.height;
    if (!r->inside.rejects) {
        cJSON_AddNullToObject(tree, "dsf");
        return;
    }
    for (size_t i = 0; i < n; i++)
        if (r->inside.rejects[i] >= 1 && r->inside.rejects[i] <= 5)
            taps[r->inside.rejects[i] - 1]++;
    hlc_json_reals(object(tree, "dsf"), "taps_rejected", taps, 5, 10);
}

static void put_bytes(cJSON *tree, const struct hlc_render *r)
{
    uint64_t targets = 0;
    if (r->o->reference) {
        cJSON_AddNullToObject(tree, "bytes");
        cJSON_AddNullToObject(tree, "ids");
        cJSON_AddNullToObject(tree, "validation_errors");
        return;
    }
    cJSON *b = object(tree, "bytes");
    const struct hl_plan *p = &r->shot.plan;
    for (uint32_t i = 0; i < p->n_targets; i++)
        targets += p->target[i].bytes;
    hlc_json_uint(b, "targets", targets);
    hlc_json_real(b, "moved_per_pixel", (double)p->moved_per_pixel, 6);
    hlc_json_uint(b, "scene", r->stage.world.bytes);
    cJSON *ids = object(tree, "ids");
    text(ids, "scheme", r->stage.world.ids.scheme);
    hlc_json_uint(ids, "regions", r->stage.world.ids.regions);
    hlc_json_uint(ids, "highest", r->stage.world.ids.highest);
    hlc_json_uint(ids, "collisions", r->stage.world.ids.collisions);
    if (r->o->validation)
        hlc_json_uint(tree, "validation_errors", r->validation_errors);
    else
        cJSON_AddNullToObject(tree, "validation_errors");
}

bool hlc_render_json(const struct hlc_render *r, struct hlh_error *error)
{
    cJSON *tree = hlc_json_begin("render");
    bool device = !r->o->reference;
    uint32_t lw = device ? r->shot.plan.light_width : 0;
    uint32_t lh = device ? r->shot.plan.light_height : 0;
    hlc_json_scene(tree, &r->stage.scene, r->near, r->far);
    hlc_json_size(tree, "size", r->o->width, r->o->height);
    if (r->o->part_width)
        hlc_json_size(tree, "part", r->o->part_width, r->o->part_height);
    else
        cJSON_AddNullToObject(tree, "part");
    hlc_json_size(tree, "light_size", lw ? lw : r->o->width,
                  lh ? lh : r->o->height);
    hlc_json_uint(tree, "samples", r->o->supersample
                  ? (uint64_t)r->o->supersample * r->o->supersample
                  : r->o->samples);
    put_machine(tree, r);
    put_times(tree, r);
    put_counts(tree, r);
    put_dsf(tree, r);
    put_bytes(tree, r);
    bool ok = hlc_json_emit(tree, r->o->json, error);
    cJSON_Delete(tree);
    return ok;
}
