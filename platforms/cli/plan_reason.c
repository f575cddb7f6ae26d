/* SPDX-License-Identifier: Zlib */
/* Why a plan is what it is, in sentences. K is the inferred lighting paper,
 * Kircher and Lawrance 2009. */
#include <string.h>
#include "platforms/cli/plan_text.h"

/* In `text` a mark and a digit stand for an argument: #0 a whole number, $0
 * a number, =0 a number or "-" where it is 0, %0 a share in percent, @0 a
 * format, &0 a pipeline, ~0 a light path. */
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
};

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
    return strchr("#$=%@&~", t[0]) && t[1] >= '0' && t[1] <= '3';
}

void hlc_reason_text(const struct hl_plan *plan, uint32_t i, char *out,
                     size_t bytes)
{
    const struct hl_plan_reason *reason = &plan->reason[i];
    const char *t = row_of(reason->why)->text;
    size_t used = 0;
    if (bytes == 0)
        return;
    /* Forward shading reads each material; nothing is shared or stored. */
    if (reason->why == HL_WHY_EXPONENT_CONSTANT &&
        plan->pipeline != HL_PIPELINE_INFERRED)
        t = "each material's own specular exponent is shaded with";
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
        "the device has no 2 x 16-bit target for normals and ids",
        "the device has no floating point colour target as needed",
        "the light buffer cannot have that format, or its range is unknown",
        "the device has no depth target as needed",
        "light lists need storage buffers, which the device has not",
        "a number is out of its range",
        "no pipeline can be drawn on the device",
    };
    return text[(unsigned)why < HL_REFUSED_COUNT ? why : 0];
}
