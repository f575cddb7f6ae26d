/* SPDX-License-Identifier: Zlib */
/* Names of what a plan holds, and the plan as a page of text. */
#include <string.h>
#include "platforms/cli/plan_text.h"

#define COUNT(a) (sizeof (a) / sizeof (a)[0])
#define PICK(names, i) \
    ((size_t)(i) < COUNT(names) && (names)[i] ? (names)[i] : "?")

/* ---- names -------------------------------------------------------------- */

const char *hlc_pipeline_name(enum hl_pipeline p)
{
    static const char *const names[HL_PIPELINE_COUNT] = {
        "auto", "forward", "forward-multipass", "inferred" };
    return PICK(names, p);
}

const char *hlc_role_name(enum hl_role r)
{
    static const char *const names[HL_ROLE_COUNT] = {
        "none", "normal", "dsf", "exponent", "light_depth", "light", "color",
        "depth", "resolved", "depth_copy", "motion", "shadow_map" };
    return PICK(names, r);
}

const char *hlc_pass_name(enum hl_pass_role r)
{
    static const char *const names[HL_PASS_ROLE_COUNT] = {
        "none", "geometry", "light", "material", "forward", "blended",
        "depth_copy", "shadow_map", "shadowed" };
    return PICK(names, r);
}

const char *hlc_light_path_name(enum hl_light_path p)
{
    static const char *const names[] = { "auto", "rects", "tiles", "lists",
                                         "volumes" };
    return PICK(names, p);
}

const char *hlc_translucency_name(enum hl_translucency t)
{
    static const char *const names[] = { "auto", "forward", "2x2", "4x4" };
    return PICK(names, t);
}

const char *hlc_stipple_name(enum hl_stipple_mode m)
{
    static const char *const names[] = { "best", "user", "depth",
                                         "depth-free" };
    return PICK(names, m);
}

const char *hlc_shadows_name(enum hl_shadows s)
{
    static const char *const names[] = { "none", "volumes", "maps" };
    return PICK(names, s);
}

const char *hlc_dsf_name(uint32_t dsf)
{
    static const char *const names[] = { "off", "slope", "constant", "exact",
                                         "dark" };
    return PICK(names, dsf);
}

const char *hlc_specular_name(uint32_t specular)
{
    static const char *const names[] = { "none", "constant", "channel" };
    return PICK(names, specular);
}

const char *hlc_falloff_name(uint32_t falloff)
{
    static const char *const names[] = { "none", "smooth", "inverse_square",
                                         "both" };
    return PICK(names, falloff);
}

const char *hlc_blend_name(enum hl_blend b)
{
    static const char *const names[] = { "off", "add", "over", "add_alpha",
                                         "max", "shift" };
    return PICK(names, b);
}

const char *hlc_compare_name(enum hl_compare c)
{
    static const char *const names[] = {
        "off", "never", "less", "less_equal", "equal", "greater_equal",
        "greater", "always" };
    return PICK(names, c);
}

const char *hlc_repeat_name(enum hl_repeat r)
{
    static const char *const names[] = { "once", "per_tile", "per_lights",
                                         "per_object_lights",
                                         "per_shadow_light" };
    return PICK(names, r);
}

const char *hlc_error_unit(enum hl_role r)
{
    static const char *const units[HL_ROLE_COUNT] = {
        "", "degrees", "metres", "relative", "", "relative", "relative", "",
        "", "", "", "" };
    return PICK(units, r);
}

const char *hlc_two16_name(uint32_t two16)
{
    static const char *const names[] = { "unorm", "signed", "fixed32",
                                         "bytes", "bytes_argb" };
    return PICK(names, two16);
}

const char *hlc_depth_read_name(uint32_t depth_read)
{
    static const char *const names[] = { "float", "barg" };
    return PICK(names, depth_read);
}

const char *hlc_half_pixel_name(enum hl_half_pixel h)
{
    static const char *const names[] = { "auto", "none", "state", "vertex" };
    return PICK(names, h);
}

const char *hlc_decals_name(enum hl_decals d)
{
    static const char *const names[] = { "none", "blend_normals",
                                         "alpha_objects" };
    return PICK(names, d);
}

const char *hlc_number_name(uint32_t number)
{
    static const char *const names[] = { "unsigned", "signed" };
    return PICK(names, number);
}

const char *hlc_endian_name(uint32_t endian)
{
    static const char *const names[] = { "none", "8in16", "8in32", "16in32" };
    return PICK(names, endian);
}

bool hlc_is_native(const struct hl_plan *p)
{
    return !p->profile[0] || !strcmp(p->profile, "native");
}

/* ---- the page ----------------------------------------------------------- */

static void print_head(FILE *out, const struct hl_plan *p)
{
    fprintf(out, "pipeline %s: %ux%u", hlc_pipeline_name(p->pipeline),
            (unsigned)p->width, (unsigned)p->height);
    if (p->light_width)
        fprintf(out, ", light %ux%u", (unsigned)p->light_width,
                (unsigned)p->light_height);
    fprintf(out, ", %u sample%s a pixel%s%s\n", (unsigned)p->samples,
            p->samples == 1 ? "" : "s",
            hlc_is_native(p) ? "" : ", profile ",
            hlc_is_native(p) ? "" : p->profile);
    fprintf(out, "predicted: %.3g ms, %.4g bytes a pixel held, %.4g moved, "
            "light %.2g %% off\n", (double)p->cost_ms,
            (double)p->bytes_per_pixel, (double)p->moved_per_pixel,
            100.0 * (double)p->light_error);
}

static void print_readers(FILE *out, uint32_t read_by)
{
    for (int r = 1; r < HL_PASS_ROLE_COUNT; r++)
        if (read_by >> r & 1u)
            fprintf(out, ", read by %s",
                    hlc_pass_name((enum hl_pass_role)r));
}

static void print_console(FILE *out, const struct hl_plan_target *t)
{
    const struct hl_console *c = &t->console;
    if (c->edram_tile)
        fprintf(out, ", EDRAM %u-%u", c->edram_tile - 1u,
                (unsigned)(c->edram_tile - 1u + t->edram_tiles - 1u));
    else if (t->edram_tiles)
        fprintf(out, ", EDRAM %u tiles", (unsigned)t->edram_tiles);
    if (c->color_exp_bias)
        fprintf(out, ", written x 2^%d", c->color_exp_bias);
    if (c->resolve_exp_bias || c->resolve_number)
        fprintf(out, ", resolved x 2^%d %s", c->resolve_exp_bias,
                hlc_number_name(c->resolve_number));
    if (c->endian)
        fprintf(out, ", endian %s", hlc_endian_name(c->endian));
    if (c->remap)
        fprintf(out, ", remap 0x%04X", c->remap);
}

static void print_target(FILE *out, const struct hl_plan_target *t)
{
    char size[32];
    const char *unit = hlc_error_unit(t->role);
    snprintf(size, sizeof size, "%ux%u", (unsigned)t->width,
             (unsigned)t->height);
    fprintf(out, "  %-12s %-14s %-11s x%u %11llu bytes",
            hlc_role_name(t->role), hl_format_info(t->format)->name, size,
            (unsigned)t->samples, (unsigned long long)t->bytes);
    print_readers(out, t->read_by);
    if (t->sample_as != HL_FORMAT_NONE)
        fprintf(out, " as %s", hl_format_info(t->sample_as)->name);
    if (unit[0] && t->error > 0)
        fprintf(out, ", error %.3g %s", (double)t->error, unit);
    print_console(out, t);
    fprintf(out, "\n");
}

static void print_pass(FILE *out, const struct hl_plan_pass *p)
{
    fprintf(out, "  %-9s %-18s to", hlc_pass_name(p->role),
            hlc_repeat_name(p->repeat));
    for (size_t i = 0; i < COUNT(p->color); i++)
        if (p->color[i] != HL_ROLE_NONE)
            fprintf(out, " %s", hlc_role_name(p->color[i]));
    if (p->color[0] == HL_ROLE_NONE)
        fprintf(out, " no color");
    if (p->depth != HL_ROLE_NONE)
        fprintf(out, ", depth %s %s%s", hlc_role_name(p->depth),
                hlc_compare_name(p->depth_test),
                p->depth_write ? " write"
                : p->depth_read_only ? " read only" : "");
    if (p->blend != HL_BLEND_OFF)
        fprintf(out, ", blend %s", hlc_blend_name(p->blend));
    if (p->lights_a_draw)
        fprintf(out, ", %u lights a draw", (unsigned)p->lights_a_draw);
    fprintf(out, "\n");
}

/* Of features: a line only where the plan has it. */
static void print_features(FILE *out, const struct hl_plan *p)
{
    if (p->translucency != HL_TRANSLUCENCY_AUTO)
        fprintf(out, "  translucent surfaces %s",
                hlc_translucency_name(p->translucency));
    if (p->stipple)
        fprintf(out, ", patterns %s, %s filter",
                hlc_stipple_name(p->stipple_mode),
                p->stipple_cone ? "cone" : "bilinear");
    if (p->translucency != HL_TRANSLUCENCY_AUTO)
        fprintf(out, "\n");
    if (p->shadows != HL_SHADOWS_NONE)
        fprintf(out, "  shadows by %s", hlc_shadows_name(p->shadows));
    if (p->shadows == HL_SHADOWS_MAPS)
        fprintf(out, " of %u texels", (unsigned)p->shadow_size);
    if (p->shadows != HL_SHADOWS_NONE)
        fprintf(out, "\n");
    if (p->volume_texels)
        fprintf(out, "  light volumes from %u texels on\n",
                (unsigned)p->volume_texels);
    if (p->infinite_far || p->motion || p->brdfs)
        fprintf(out, " %s%s%s\n", p->infinite_far ? " no far plane" : "",
                p->motion ? " motion vectors" : "",
                p->brdfs ? " BRDF channel" : "");
}

/* Of a profile, and what it has in common with none. */
static void print_rules(FILE *out, const struct hl_plan *p)
{
    if (p->half_pixel != HL_HALF_PIXEL_AUTO)
        fprintf(out, "  half pixel %s\n", hlc_half_pixel_name(p->half_pixel));
    if (p->decals != HL_DECALS_NONE)
        fprintf(out, "  decals %s\n", hlc_decals_name(p->decals));
    if (p->edram_tiles)
        fprintf(out, "  EDRAM %u tiles at most\n", (unsigned)p->edram_tiles);
    if (hlc_is_native(p) || p->pipeline != HL_PIPELINE_INFERRED)
        return;
    fprintf(out, "  pairs %s, ids of %g steps, depth read %s, taps %s, light "
            "written x %.4g\n", hlc_two16_name(p->two16),
            (double)p->id_steps, hlc_depth_read_name(p->depth_read),
            p->float_taps ? "as numbers" : "as words",
            (double)p->light_out);
}

static void print_settings(FILE *out, const struct hl_plan *p)
{
    fprintf(out, "settings\n  specular %s", hlc_specular_name(p->specular));
    if (p->specular == HL_SPECULAR_CONSTANT &&
        p->pipeline == HL_PIPELINE_INFERRED)
        fprintf(out, " %.3g", (double)p->exponent);
    fprintf(out, ", falloff %s, %s, %s depth, far %.4g m\n",
            hlc_falloff_name(p->falloff),
            p->kinds ? "points and cones" : "points",
            p->reversed_depth ? "reversed" : "forward", (double)p->far);
    if (p->pipeline == HL_PIPELINE_FORWARD_MULTIPASS)
        fprintf(out, "  scissor %s\n", p->scissor ? "on" : "off");
    if (p->pipeline != HL_PIPELINE_INFERRED)
        return;
    fprintf(out, "  light path %s, batch %u, tile %u%s, scale %.4g\n",
            hlc_light_path_name(p->light_path), (unsigned)p->batch,
            (unsigned)p->tile, p->tile_depth ? " with depth" : "",
            (double)p->light_scale);
    fprintf(out, "  dsf %s, k %.3g, c %.3g, tau %.3g%s%s%s\n",
            hlc_dsf_name(p->dsf), (double)p->dsf_k, (double)p->dsf_c,
            (double)p->dsf_tau, p->fill == HL_FILL_NEAREST ? ", fill nearest"
            : p->fill == HL_FILL_DEPTH ? ", fill by depth" : "",
            p->dsf_bilinear ? ", filtered fetch" : "",
            p->centroid ? ", centroid" : "");
}

static void print_reasons(FILE *out, const struct hl_plan *p)
{
    bool cited = false;
    fprintf(out, "because\n");
    for (uint32_t i = 0; i < p->n_reasons; i++) {
        char text[256];
        const char *section = hlc_reason_section(p->reason[i].why);
        hlc_reason_text(p, i, text, sizeof text);
        fprintf(out, "  %s%s%s%s\n", text, section[0] ? " [" : "", section,
                section[0] ? "]" : "");
        cited = cited || section[0];
    }
    if (cited)
        fprintf(out, "K: Kircher and Lawrance 2009, Inferred Lighting\n");
}

void hl_plan_text(FILE *out, const struct hl_plan *plan)
{
    print_head(out, plan);
    fprintf(out, "targets\n");
    for (uint32_t i = 0; i < plan->n_targets; i++)
        print_target(out, &plan->target[i]);
    fprintf(out, "passes\n");
    for (uint32_t i = 0; i < plan->n_passes; i++)
        print_pass(out, &plan->pass[i]);
    print_settings(out, plan);
    print_features(out, plan);
    print_rules(out, plan);
    print_reasons(out, plan);
}
