/* SPDX-License-Identifier: Zlib */
/* The "plan" object of docs/json.md. */
#include "platforms/cli/json.h"
#include "platforms/cli/plan_text.h"

static void text(cJSON *object, const char *key, const char *value)
{
    cJSON_AddStringToObject(object, key, value);
}

/* null where the device keeps memory as it likes. */
static void add_console(cJSON *j, const struct hl_plan_target *t)
{
    const struct hl_console *c = &t->console;
    char word[8];
    hlc_json_uint(j, "edram_tiles", t->edram_tiles);
    if (!c->edram_tile && !c->color_exp_bias && !c->resolve_exp_bias &&
        !c->resolve_number && !c->endian && !c->remap) {
        cJSON_AddNullToObject(j, "console");
        return;
    }
    cJSON *o = cJSON_AddObjectToObject(j, "console");
    if (c->edram_tile)
        hlc_json_uint(o, "edram_first", c->edram_tile - 1u);
    else
        cJSON_AddNullToObject(o, "edram_first");
    cJSON_AddNumberToObject(o, "color_exp_bias", c->color_exp_bias);
    cJSON_AddNumberToObject(o, "resolve_exp_bias", c->resolve_exp_bias);
    text(o, "resolve_number", hlc_number_name(c->resolve_number));
    text(o, "endian", hlc_endian_name(c->endian));
    snprintf(word, sizeof word, "0x%04X", c->remap ? c->remap : 0xAAE4u);
    text(o, "remap", word);
}

static cJSON *target_json(const struct hl_plan_target *t)
{
    cJSON *j = cJSON_CreateObject();
    const char *unit = hlc_error_unit(t->role);
    text(j, "role", hlc_role_name(t->role));
    text(j, "format", hl_format_info(t->format)->name);
    if (t->sample_as == HL_FORMAT_NONE)
        cJSON_AddNullToObject(j, "sample_as");
    else
        text(j, "sample_as", hl_format_info(t->sample_as)->name);
    hlc_json_size(j, "size", t->width, t->height);
    hlc_json_uint(j, "samples", t->samples);
    hlc_json_uint(j, "bytes", t->bytes);
    cJSON *readers = cJSON_AddArrayToObject(j, "read_by");
    for (int r = 1; r < HL_PASS_ROLE_COUNT; r++)
        if (t->read_by >> r & 1u)
            cJSON_AddItemToArray(readers, cJSON_CreateString(
                                 hlc_pass_name((enum hl_pass_role)r)));
    add_console(j, t);
    if (!unit[0]) {
        cJSON_AddNullToObject(j, "error");
        cJSON_AddNullToObject(j, "error_unit");
        return j;
    }
    hlc_json_real(j, "error", (double)t->error, 6);
    text(j, "error_unit", unit);
    return j;
}

static cJSON *pass_json(const struct hl_plan_pass *p)
{
    cJSON *j = cJSON_CreateObject();
    text(j, "role", hlc_pass_name(p->role));
    text(j, "repeat", hlc_repeat_name(p->repeat));
    cJSON *color = cJSON_AddArrayToObject(j, "color");
    for (size_t i = 0; i < sizeof p->color / sizeof p->color[0]; i++)
        if (p->color[i] != HL_ROLE_NONE)
            cJSON_AddItemToArray(color, cJSON_CreateString(
                                 hlc_role_name(p->color[i])));
    if (p->depth == HL_ROLE_NONE)
        cJSON_AddNullToObject(j, "depth");
    else
        text(j, "depth", hlc_role_name(p->depth));
    cJSON_AddBoolToObject(j, "depth_read_only", p->depth_read_only);
    text(j, "depth_test", hlc_compare_name(p->depth_test));
    cJSON_AddBoolToObject(j, "depth_write", p->depth_write);
    text(j, "blend", hlc_blend_name(p->blend));
    hlc_json_uint(j, "lights_a_draw", p->lights_a_draw);
    return j;
}

static cJSON *reason_json(const struct hl_plan *p, uint32_t i)
{
    char sentence[256];
    double args[4];
    cJSON *j = cJSON_CreateObject();
    hlc_reason_text(p, i, sentence, sizeof sentence);
    for (int k = 0; k < 4; k++)
        args[k] = (double)p->reason[i].arg[k];
    text(j, "id", hlc_reason_name(p->reason[i].why));
    text(j, "text", sentence);
    text(j, "section", hlc_reason_section(p->reason[i].why));
    hlc_json_reals(j, "args", args, 4, 9);
    return j;
}

/* What only the inferred pipeline has; null for the others. */
static void add_light(cJSON *j, const struct hl_plan *p)
{
    if (p->pipeline != HL_PIPELINE_INFERRED) {
        cJSON_AddNullToObject(j, "light_size");
        cJSON_AddNullToObject(j, "light");
        cJSON_AddNullToObject(j, "dsf");
        return;
    }
    hlc_json_size(j, "light_size", p->light_width, p->light_height);
    cJSON *light = cJSON_AddObjectToObject(j, "light");
    text(light, "path", hlc_light_path_name(p->light_path));
    hlc_json_uint(light, "batch", p->batch);
    hlc_json_uint(light, "tile", p->tile);
    cJSON_AddBoolToObject(light, "tile_depth", p->tile_depth);
    hlc_json_real(light, "scale", (double)p->light_scale, 9);
    hlc_json_real(light, "out", (double)p->light_out, 9);
    cJSON *dsf = cJSON_AddObjectToObject(j, "dsf");
    text(dsf, "mode", hlc_dsf_name(p->dsf));
    hlc_json_real(dsf, "k", (double)p->dsf_k, 6);
    hlc_json_real(dsf, "c", (double)p->dsf_c, 6);
    hlc_json_real(dsf, "tau", (double)p->dsf_tau, 6);
    text(dsf, "fill", p->fill == HL_FILL_NEAREST ? "nearest"
                      : p->fill == HL_FILL_DEPTH ? "depth" : "bilinear");
    text(dsf, "fetch", p->dsf_bilinear ? "bilinear" : "gather");
    cJSON_AddBoolToObject(dsf, "centroid", p->centroid);
}

/* null where the plan has nothing translucent, stippled or shadowed. */
static void add_features(cJSON *j, const struct hl_plan *p)
{
    if (p->translucency == HL_TRANSLUCENCY_AUTO)
        cJSON_AddNullToObject(j, "translucency");
    else
        text(j, "translucency", hlc_translucency_name(p->translucency));
    if (p->stipple == 0) {
        cJSON_AddNullToObject(j, "stipple");
    } else {
        cJSON *s = cJSON_AddObjectToObject(j, "stipple");
        hlc_json_uint(s, "side", p->stipple);
        text(s, "mode", hlc_stipple_name(p->stipple_mode));
        text(s, "filter", p->stipple_cone ? "cone" : "bilinear");
    }
    if (p->shadows == HL_SHADOWS_NONE) {
        cJSON_AddNullToObject(j, "shadows");
    } else {
        cJSON *s = cJSON_AddObjectToObject(j, "shadows");
        text(s, "kind", hlc_shadows_name(p->shadows));
        hlc_json_uint(s, "size", p->shadows == HL_SHADOWS_MAPS
                                 ? p->shadow_size : 0);
    }
    cJSON_AddBoolToObject(j, "infinite_far", p->infinite_far);
    hlc_json_uint(j, "volume_texels", p->volume_texels);
    cJSON_AddBoolToObject(j, "motion", p->motion);
    cJSON_AddBoolToObject(j, "brdfs", p->brdfs);
}

static void add_settings(cJSON *j, const struct hl_plan *p)
{
    text(j, "specular", hlc_specular_name(p->specular));
    if (p->specular == HL_SPECULAR_CONSTANT &&
        p->pipeline == HL_PIPELINE_INFERRED)
        hlc_json_real(j, "exponent", (double)p->exponent, 6);
    else
        cJSON_AddNullToObject(j, "exponent");
    text(j, "falloff", hlc_falloff_name(p->falloff));
    cJSON_AddBoolToObject(j, "cones", p->kinds != 0);
    cJSON_AddBoolToObject(j, "scissor", p->scissor);
    cJSON_AddBoolToObject(j, "reversed_depth", p->reversed_depth);
    hlc_json_real(j, "far", (double)p->far, 9);
    text(j, "two16", hlc_two16_name(p->two16));
    hlc_json_real(j, "id_steps", (double)p->id_steps, 9);
    cJSON_AddBoolToObject(j, "float_taps", p->float_taps);
    text(j, "depth_read", hlc_depth_read_name(p->depth_read));
    text(j, "half_pixel", hlc_half_pixel_name(p->half_pixel));
    text(j, "decals", hlc_decals_name(p->decals));
    add_features(j, p);
    hlc_json_uint(j, "edram_tiles", p->edram_tiles);
    hlc_json_real(j, "bytes_per_pixel", (double)p->bytes_per_pixel, 6);
    hlc_json_real(j, "moved_per_pixel", (double)p->moved_per_pixel, 6);
    hlc_json_real(j, "light_error", (double)p->light_error, 6);
    hlc_json_real(j, "cost_ms", (double)p->cost_ms, 6);
    hlc_json_real(j, "error_codes", (double)p->error_codes, 6);
}

cJSON *hlc_plan_json(const struct hl_plan *p)
{
    cJSON *j = cJSON_CreateObject();
    if (!j)
        return NULL;
    text(j, "pipeline", hlc_pipeline_name(p->pipeline));
    text(j, "profile", p->profile);
    hlc_json_size(j, "size", p->width, p->height);
    hlc_json_uint(j, "samples", p->samples);
    add_light(j, p);
    cJSON *targets = cJSON_AddArrayToObject(j, "targets");
    for (uint32_t i = 0; i < p->n_targets; i++)
        cJSON_AddItemToArray(targets, target_json(&p->target[i]));
    cJSON *passes = cJSON_AddArrayToObject(j, "passes");
    for (uint32_t i = 0; i < p->n_passes; i++)
        cJSON_AddItemToArray(passes, pass_json(&p->pass[i]));
    add_settings(j, p);
    cJSON *reasons = cJSON_AddArrayToObject(j, "reasons");
    for (uint32_t i = 0; i < p->n_reasons; i++)
        cJSON_AddItemToArray(reasons, reason_json(p, i));
    return j;
}
