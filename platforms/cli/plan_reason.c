/* SPDX-License-Identifier: Zlib */
/* Why a plan is what it is, in sentences. K is the inferred lighting paper,
 * Kircher and Lawrance 2009. */
#include <string.h>
#include "platforms/cli/plan_text.h"

/* In `text` a mark and a digit stand for an argument: #0 a whole number, $0
 * a number, =0 a number or "-" where it is 0, %0 a share in percent, @0 a
 * format, &0 a pipeline, ~0 a light path, ^0 a target, *0 a pass, !0 a word
 * in hexadecimal. */
struct row { const char *name, *section, *text; };

static const struct row rows[HL_WHY_COUNT] = {
    [HL_WHY_NONE] = { "none", "", "" },
    [HL_WHY_PIPELINE_ASKED] = { "pipeline_asked", "", "&0 was asked for" },
    [HL_WHY_PIPELINE_CHEAPEST] = { "pipeline_cheapest", "K 6, 7.1",
        "&0 is the cheapest pipeline: predicted =1 ms, the next one =2 ms" },
    [HL_WHY_LIGHT_SIZE_ASKED] = { "light_size_asked", "K 2.2",
        "a light buffer of #0 x #1 under #2 x #3 was asked for" },
    [HL_WHY_LIGHT_SIZE_DEFAULT] = { "light_size_default", "K 6, fig. 9",
        "the light buffer has #0 x #1 texels under #2 x #3 pixels, the "
        "paper's five eighths a side" },
    [HL_WHY_NORMAL_FORMAT] = { "normal_format", "K 2.1, eq. 1-3",
        "normals are two components in @0, at most $1 degrees off where they "
        "face the viewer" },
    [HL_WHY_DSF_FORMAT] = { "dsf_format", "K 2.1, 3",
        "depth and region id for the filter are in @0: depth up to $2 m, at "
        "most $1 m off" },
    [HL_WHY_EXPONENT_NONE] = { "exponent_none", "",
        "no material is specular, so no highlight is computed" },
    [HL_WHY_EXPONENT_CONSTANT] = { "exponent_constant", "",
        "the specular exponent is $0 for all materials and takes no channel" },
    [HL_WHY_EXPONENT_CHANNEL] = { "exponent_channel", "K 2.1",
        "specular exponents differ, so they are stored in @0, at most %1 "
        "off" },
    [HL_WHY_PATH_ASKED] = { "path_asked", "K 2.2",
        "light path ~0 was asked for; predicted ms: rects =1, tiles =2, "
        "lists =3" },
    [HL_WHY_PATH_CHEAPEST] = { "path_cheapest", "K 2.2",
        "light path ~0 is the cheapest; predicted ms: rects =1, tiles =2, "
        "lists =3" },
    [HL_WHY_TILE_DEPTH] = { "tile_depth", "",
        "reading depth back costs less than the lights that its bounds of "
        "each #0 x #0 tile leave out" },
    [HL_WHY_LIGHT_FORMAT_ASKED] = { "light_format_asked", "K 2.2",
        "@0 was asked for the light buffer: after #1 blends at most %2 off, "
        "1 stands for $3" },
    [HL_WHY_LIGHT_FORMAT_ERROR] = { "light_format_error", "K 2.2",
        "@0 keeps the light buffer's sum good enough: after #1 blends at "
        "most %2 off, 1 stands for $3" },
    [HL_WHY_LIGHT_FORMAT_DARK] = { "light_format_dark", "",
        "half a step of @0, where 1 stands for $3, would be $1 codes of 255 "
        "in the dark, past $2: it is not taken" },
    [HL_WHY_LIGHT_ALPHA] = { "light_alpha", "K 2.2",
        "@0 has #1 bits of alpha: specular light comes in steps of $2" },
    [HL_WHY_COLOR_FORMAT] = { "color_format", "",
        "the frame is in @0: after #1 blends at most %2 off, where the need "
        "is $3 codes of 255" },
    [HL_WHY_DSF_OFF] = { "dsf_off", "K 3, fig. 3",
        "the filter was asked to be off: light is interpolated across "
        "edges" },
    [HL_WHY_DSF_SLOPE] = { "dsf_slope", "K 3",
        "the filter's depth threshold follows the surface's slope, times $0, "
        "plus $1 of the depth and a step of $2 m; a constant one rejects "
        "tilted surfaces" },
    [HL_WHY_DSF_CONSTANT] = { "dsf_constant", "K 3",
        "the filter has the paper's one threshold, $0 of the depth, as asked" },
    [HL_WHY_DSF_EXACT] = { "dsf_exact", "K 3",
        "the light buffer is as large as the frame: one fetch, no filter" },
    [HL_WHY_DEPTH_REVERSED] = { "depth_reversed", "",
        "depth is floating point with near at 1, so that its error is one "
        "share of the distance everywhere" },
    [HL_WHY_SAMPLES] = { "samples", "K 3",
        "#0 samples a pixel; materials run once a pixel, light is not "
        "multisampled" },
    [HL_WHY_BLENDED_FORWARD] = { "blended_forward", "K 1.1",
        "translucent surfaces are drawn last and forward, back to front" },
    [HL_WHY_SCISSOR] = { "scissor", "K 2.2",
        "each light's draws are cut to the rectangle it reaches" },
    [HL_WHY_NO_SCISSOR] = { "no_scissor", "K 2.2",
        "each light draws its objects whole, as asked" },
    [HL_WHY_NO_LIGHTS] = { "no_lights", "K 7.1",
        "there are no lights, only ambient and emission" },
    [HL_WHY_STAND_IN] = { "stand_in", "",
        "@0 stands in for the console's @1 (^2)" },
    [HL_WHY_TWO16_FIXED32] = { "two16_fixed32", "K 5.1",
        "0..1 is written as 64 v - 32 to @0 and resolved by 2 to the $3 as "
        "signed numbers, read as s / 2 + 1 / 2: #1 codes, where 0..1 as it "
        "is would have #2" },
    [HL_WHY_TWO16_SIGNED] = { "two16_signed", "K 5.1",
        "0..1 is written as 2 v - 1 to @0 and read as s / 2 + 1 / 2: the "
        "65535 codes of the console's texture" },
    [HL_WHY_TWO16_BYTES_ARGB] = { "two16_bytes_argb", "K 5.2",
        "no target has two 16-bit channels: two numbers are written as the "
        "four bytes of @0 and read as @1 by remap !2" },
    [HL_WHY_TWO16_BYTES] = { "two16_bytes", "K 5.2",
        "no target has two 16-bit channels: two numbers are written as the "
        "four bytes of @0, low first, and read as @1" },
    [HL_WHY_ID_STEPS] = { "id_steps", "K 5.1",
        "ids are stored as id / #0: signed codes have a step less, and with "
        "65535 two ids would share the middle one" },
    [HL_WHY_MRT_FORMAT] = { "mrt_format", "K 5.2",
        "all colour targets of the geometry pass are @0: this machine has one "
        "format for all of them" },
    [HL_WHY_FLOAT_TAPS] = { "float_taps", "K 3",
        "the filter's taps are sampled as numbers: this machine cannot read "
        "texels as words" },
    [HL_WHY_LIGHT_FORMAT_PROFILE] = { "light_format_profile", "K 2.2, 5",
        "the light buffer is in @0, the profile's choice: after #1 blends at "
        "most %2 off, 1 stands for $3" },
    [HL_WHY_NO_BLEND] = { "no_blend", "K 2.2",
        "lights are added by blending, which @0 cannot here and @1 can" },
    [HL_WHY_LIGHT_RANGE] = { "light_range", "K 2.2",
        "light up to $0 fits the fixed range: it is written times $1, and a "
        "step of it is $2" },
    [HL_WHY_LIGHT_PEAK_CUT] = { "light_peak_cut", "",
        "inverse square lights reach $0 a centimetre away, steps would be "
        "$1: the range ends at $2 instead, reached $3 m away; what is "
        "brighter is stored as that" },
    [HL_WHY_LIGHT_PEAK_DEFAULT] = { "light_peak_default", "",
        "how bright the light gets is not known: $0 is taken for the fixed "
        "range, brighter light is stored as that" },
    [HL_WHY_COLOR_STEP] = { "color_step", "",
        "below $0 the frame's step is $1, up to $2 codes of 255 in the dark" },
    [HL_WHY_DEPTH_BARG] = { "depth_barg", "K 5.2",
        "depth in @0 is read as @1 by remap !2 (BARG), its three bytes put "
        "together exactly as the precise fetch does" },
    [HL_WHY_DEPTH_PLAIN] = { "depth_plain", "K 5.2",
        "depth in @0 is sampled as depth: the console's remap is not needed "
        "here" },
    [HL_WHY_DEPTH_IN_PLACE] = { "depth_in_place", "K 5",
        "nothing tests depth while it is read, so @0 is read in place by a "
        "view of its depth, without a copy" },
    [HL_WHY_DEPTH_READ_ONLY] = { "depth_read_only", "K 2.2",
        "the light pass tests @0 read only while it reads it" },
    [HL_WHY_DEPTH_COPY] = { "depth_copy", "K 5",
        "the light pass tests depth while it reads it, which this machine "
        "does with a copy only: a pass writes one in @0" },
    [HL_WHY_HALF_PIXEL_STATE] = { "half_pixel_state", "K 5.1",
        "pixel centres are at integers: the half pixel offset state puts "
        "them at halves" },
    [HL_WHY_HALF_PIXEL_VERTEX] = { "half_pixel_vertex", "K 5.1",
        "pixel centres are at integers: vertex stages shift by half a pixel "
        "of the target that they draw to, and the state stays off" },
    [HL_WHY_HALF_PIXEL_NONE] = { "half_pixel_none", "K 5.1",
        "pixel centres are at integers and stay there, as asked: pictures "
        "are half a pixel off" },
    [HL_WHY_HALF_PIXEL_HERE] = { "half_pixel_here", "K 5.1",
        "pixel centres are at halves on this machine: nothing shifts for the "
        "console's" },
    [HL_WHY_DECALS_BLEND] = { "decals_blend", "K 5.2",
        "decals are blended into the normals in @0" },
    [HL_WHY_DECALS_PACKED] = { "decals_packed", "K 5.2",
        "normals are packed in all channels of @0 and cannot be blended: "
        "decals are translucent objects" },
    [HL_WHY_DECALS_NO_BLEND] = { "decals_no_blend", "K 5.2",
        "@0 of the normals cannot be blended here: decals are translucent "
        "objects" },
    [HL_WHY_DECALS_FORWARD] = { "decals_forward", "K 5.2",
        "there is no target of normals: decals are translucent objects" },
    [HL_WHY_RESOLVE] = { "resolve", "K 5.1",
        "^0 is resolved from EDRAM after the *1 pass, before the *2 pass "
        "reads it: #3 bytes" },
    [HL_WHY_EDRAM_RESIDENT] = { "edram_resident", "K 5.1",
        "what the geometry and light passes draw to stays in EDRAM together, "
        "nothing shared: #0 of #1 tiles, light #2, light_depth #3" },
    [HL_WHY_EDRAM_SHARED] = { "edram_shared", "K 5.1",
        "with nothing shared EDRAM would hold #0 of #1 tiles: light shares "
        "with G-buffers that are resolved by then, never with light_depth; "
        "#2 at most are in use" },
    [HL_WHY_EDRAM_FRAME] = { "edram_frame", "K 5.1",
        "the frame's colour and depth take #0 of #1 tiles, in passes of their "
        "own" },
    [HL_WHY_LIGHT_SIZE_EDRAM] = { "light_size_edram", "K 5.1",
        "the light buffer has #0 x #1 texels: the largest of the frame's "
        "aspect that EDRAM holds, where five eighths a side would be #2 x "
        "#3" },
    [HL_WHY_EDRAM_SET] = { "edram_set", "K 5.1",
        "normals, DSF and depth take #0 tiles, #1 with the light buffer, and "
        "further channels #2 more" },
    [HL_WHY_EDRAM_SURFACE] = { "edram_surface", "K 5.1",
        "^0 #2 x #3 takes #1 tiles" },
    [HL_WHY_EDRAM_SUM] = { "edram_sum", "K 5.1",
        "the *0 pass needs #1 tiles of EDRAM at once, which has #2" },
    [HL_WHY_EDRAM_FITS] = { "edram_fits", "K 5.1",
        "a light buffer of #0 x #1 fits (#2 tiles, light shares)" },
    [HL_WHY_EDRAM_FITS_RESIDENT] = { "edram_fits_resident", "K 5.1",
        "#0 x #1 fits with nothing shared (#2 tiles)" },
    [HL_WHY_EDRAM_TILING] = { "edram_tiling", "K 5.1",
        "predicated tiling would draw the pass #0 times, for rectangles of "
        "#1 x #2 (#3 tiles each)" },
    [HL_WHY_NOT_BLENDABLE] = { "not_blendable", "K 2.2",
        "@0 cannot be blended here" },
    [HL_WHY_STIPPLED] = { "stippled", "K 4",
        "translucent surfaces are stippled into the G-buffer by blocks of #0 x "
        "#0 texels and lit with all else: predicted =2 ns a translucent pixel, "
        "=1 drawn forward" },
    [HL_WHY_STIPPLE_LAYERS] = { "stipple_layers", "K 4",
        "up to #0 translucent objects lie over a pixel, and #1 have a pattern "
        "there; what has none is lit forward" },
    [HL_WHY_STIPPLE_FILTER] = { "stipple_filter", "K 4",
        "a translucent pixel weighs the four samples of its pattern by a small "
        "cone" },
    [HL_WHY_SHADOW_VOLUMES] = { "shadow_volumes", "K 1, 4",
        "lights that cast shadows: #0, by stencil volumes, depth-fail; what is "
        "opaque and what is stippled are lit alike" },
    [HL_WHY_SHADOW_MAPS] = { "shadow_maps", "K 1, 4",
        "lights that cast shadows: #0, by maps of depth, #1 a light; what is "
        "opaque and what is stippled are lit alike" },
    [HL_WHY_SHADOW_SIZE] = { "shadow_size", "",
        "a shadow map has #0 texels a side where #1 were wanted; the target is "
        "#2 x #3" },
    [HL_WHY_INFINITE_FAR] = { "infinite_far", "",
        "the projection ends at no far plane: it would cut stencil volumes "
        "open" },
    [HL_WHY_VOLUME_TEXELS] = { "volume_texels", "K 2.2",
        "lights whose rectangle has fewer than #0 texels are drawn without a "
        "stencil volume" },
    [HL_WHY_FILL] = { "fill", "K 3",
        "a pixel whose taps are all rejected reads the nearest sample of its "
        "own surface within two texels, else all four by nearness in depth" },
    [HL_WHY_FETCH] = { "fetch", "K 7.1",
        "light is fetched filtered where no tap is rejected, else by four "
        "taps: predicted =2 ns a pixel, four always =1" },
    [HL_WHY_CENTROID] = { "centroid", "K 3",
        "the multisampled material pass interpolates at the centroid of what "
        "a surface covers, so that light is read where it is" },
    [HL_WHY_MOTION] = { "motion", "",
        "screen motion since the last frame is stored in @0" },
    [HL_WHY_BRDFS] = { "brdfs", "K 2.1",
        "materials differ in how they reflect: @0 has which in its second "
        "number" },
    [HL_WHY_NO_LIGHT_PASS] = { "no_light_pass", "K 7.1",
        "there is no light to sum: the light pass is left out" },
    [HL_WHY_BUDGET_ERROR] = { "budget_error", "",
        "of #3 plans the cheapest within an error of $0 codes: predicted $1 "
        "codes, $2 ms" },
    [HL_WHY_BUDGET_COST] = { "budget_cost", "",
        "of #3 plans the most accurate within $0 ms: predicted $1 ms, $2 "
        "codes" },
    [HL_WHY_PIPELINE_BUDGET] = { "pipeline_budget", "",
        "&0 keeps to the budget best" },
    [HL_WHY_LIGHT_SIZE_BUDGET] = { "light_size_budget", "",
        "the light buffer has #0 x #1 texels under #2 x #3 pixels: the size "
        "that keeps to the budget best" },
    [HL_WHY_LIGHT_FORMAT_BUDGET] = { "light_format_budget", "K 2.2",
        "@0 keeps to the budget best: after #1 blends at most %2 off, 1 "
        "stands for $3" },
    [HL_WHY_BUDGET_MISSED] = { "budget_missed", "",
        "the best plans come to $2 codes and $3 ms" },
};

/* Of those that decide between two ways, the other: argument 0 is 0. */
static const char *other_way(enum hl_reason why)
{
    switch (why) {
    case HL_WHY_STIPPLE_FILTER:
        return "a translucent pixel weighs the four samples of its pattern "
               "bilinearly";
    case HL_WHY_FETCH:
        return "light is fetched by four taps: predicted =1 ns a pixel, "
               "filtered where none is rejected =2";
    case HL_WHY_CENTROID:
        return "the multisampled material pass interpolates at pixel centres, "
               "as asked: edges may read light from beside their surface";
    default:
        return NULL;
    }
}

/* Takes a channel all the same, for BRDFs' sake. */
static const char *exponent_text(const struct hl_plan *p, const char *none)
{
    return p->pipeline != HL_PIPELINE_INFERRED
           ? "each material's own specular exponent is shaded with"
           : hl_plan_target(p, HL_ROLE_EXPONENT)
           ? "the specular exponent is $0 for all materials: the light pass "
             "reads none" : none;
}

static const char *fill_text(enum hl_fill fill, const char *nearest)
{
    return fill == HL_FILL_BILINEAR
           ? "a pixel whose taps are all rejected reads all four of them, as "
             "published"
           : fill == HL_FILL_DEPTH
           ? "a pixel whose taps are all rejected reads all four by nearness "
             "in depth; to look further would cost every pixel $1 of $2 ns"
           : nearest;
}

static const struct row *row_of(enum hl_reason why)
{
    return &rows[(unsigned)why < HL_WHY_COUNT ? why : HL_WHY_NONE];
}

const char *hlc_reason_name(enum hl_reason why) { return row_of(why)->name; }

const char *hlc_reason_section(enum hl_reason why)
{
    return row_of(why)->section;
}

static void argument(char *out, size_t bytes, char mark, float value)
{
    double v = (double)value;
    switch (mark) {
    case '#': snprintf(out, bytes, "%.0f", v); break;
    case '$': snprintf(out, bytes, "%.3g", v); break;
    case '%': snprintf(out, bytes, "%.3g %%", v * 100.0); break;
    case '=':
        if (v > 0)
            snprintf(out, bytes, "%.3g", v);
        else
            snprintf(out, bytes, "-");
        break;
    case '@':
        snprintf(out, bytes, "%s",
                 hl_format_info((enum hl_format)(int)value)->name);
        break;
    case '^':
        snprintf(out, bytes, "%s", hlc_role_name((enum hl_role)(int)value));
        break;
    case '*':
        snprintf(out, bytes, "%s",
                 hlc_pass_name((enum hl_pass_role)(int)value));
        break;
    case '!': snprintf(out, bytes, "0x%04X", (unsigned)(int)value); break;
    case '&':
        snprintf(out, bytes, "%s",
                 hlc_pipeline_name((enum hl_pipeline)(int)value));
        break;
    default:
        snprintf(out, bytes, "%s",
                 hlc_light_path_name((enum hl_light_path)(int)value));
        break;
    }
}

static bool is_mark(const char *t)
{
    return strchr("#$=%@&~^*!", t[0]) && t[1] >= '0' && t[1] <= '3';
}

void hlc_reason_text(const struct hl_plan *plan, uint32_t i, char *out,
                     size_t bytes)
{
    const struct hl_plan_reason *reason = &plan->reason[i];
    const char *t = row_of(reason->why)->text;
    size_t used = 0;
    if (bytes == 0)
        return;
    if (other_way(reason->why) && !(reason->arg[0] > 0))
        t = other_way(reason->why);
    if (reason->why == HL_WHY_FILL)
        t = fill_text((enum hl_fill)(int)reason->arg[0], t);
    if (reason->why == HL_WHY_EXPONENT_CONSTANT)
        t = exponent_text(plan, t);
    if (reason->why == HL_WHY_NORMAL_FORMAT && reason->arg[2] > 0)
        t = "@0 was asked for normals: two components, at most $1 degrees off "
            "where they face the viewer";
    while (*t && used + 1 < bytes) {
        if (!is_mark(t)) {
            out[used++] = *t++;
            continue;
        }
        argument(out + used, bytes - used, t[0], reason->arg[t[1] - '0']);
        used += strlen(out + used);
        t += 2;
    }
    out[used] = 0;
}

const char *hlc_refusal_text(enum hl_refusal why)
{
    static const char *const text[HL_REFUSED_COUNT] = {
        "",
        "the size is 0 or above the device's largest texture",
        "the light buffer's size is above the device's largest texture",
        "the device has no targets of that many samples",
        "normals cannot have that format, or the device has no 2 x 16-bit "
        "target for them and ids",
        "the device has no floating point colour target as needed",
        "the light buffer cannot have that format, or its range is unknown",
        "the device has no depth target as needed",
        "light lists need storage buffers, which the device has not",
        "a number is out of its range",
        "no pipeline can be drawn on the device",
        "its targets do not fit the console's EDRAM",
        ("pixel centres are at halves here: neither state nor vertices shift "
         "them"),
        "forward pipelines have no shadows, and maps have a largest size",
        "motion vectors need the inferred pipeline and a colour target more",
        "no plan keeps to the budget",
    };
    return text[(unsigned)why < HL_REFUSED_COUNT ? why : 0];
}

static bool of_refusal(enum hl_reason why)
{
    return (why >= HL_WHY_EDRAM_SET && why <= HL_WHY_NOT_BLENDABLE) ||
           why == HL_WHY_BUDGET_MISSED;
}

void hlc_refusal_line(const struct hl_plan *refused, enum hl_refusal why,
                      char *out, size_t bytes)
{
    size_t used = (size_t)snprintf(out, bytes, "%s", hlc_refusal_text(why));
    const char *between = ": ";
    for (uint32_t i = 0; i < refused->n_reasons; i++) {
        char text[256];
        if (!of_refusal(refused->reason[i].why) || used >= bytes)
            continue;
        hlc_reason_text(refused, i, text, sizeof text);
        used += (size_t)snprintf(out + used, bytes - used, "%s%s", between,
                                 text);
        between = "; ";
    }
}
