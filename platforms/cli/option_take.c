/* SPDX-License-Identifier: Zlib */
/* Values of options, by the kind of their row. */
#include <stdio.h>
#include <string.h>
#include "hal/hal.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/option.h"
#include "platforms/cli/value.h"
#include "platforms/platforms.h"

static int bad(const struct hlc_option *r, const char *value, const char *what)
{
    return hlc_fail(HLC_BAD, "--%s %s: %s", r->name, value, what);
}

static int take_count(void *at, const struct hlc_option *r, const char *value)
{
    uint32_t v;
    if (!hlc_read_count(&v, value) || v < r->low || v > r->high)
        return hlc_fail(HLC_BAD, "--%s %s: must be a whole number from %g to "
                        "%g", r->name, value, r->low, r->high);
    memcpy(at, &v, sizeof v);
    return 0;
}

static int take_real(void *at, const struct hlc_option *r, const char *value)
{
    double v;
    if (!hlc_read_real(&v, value) || v < r->low || v > r->high)
        return hlc_fail(HLC_BAD, "--%s %s: must be a number from %g to %g",
                        r->name, value, r->low, r->high);
    memcpy(at, &v, sizeof v);
    return 0;
}

/* at: width and height, one behind the other. */
static int take_size(void *at, const struct hlc_option *r, const char *value)
{
    uint32_t v[2];
    if (!hlc_read_size(&v[0], &v[1], value) || !v[0] || !v[1])
        return bad(r, value, "must be WxH, whole numbers from 1");
    if (v[0] > HLC_SIZE_MAX || v[1] > HLC_SIZE_MAX)
        return hlc_fail(HLC_BAD, "--%s %s: the limit is %d a side", r->name,
                        value, HLC_SIZE_MAX);
    memcpy(at, v, sizeof v);
    return 0;
}

static int take_color(double *out, bool *has, const struct hlc_option *r,
                      const char *value)
{
    double v[3];
    if (!hlc_read_reals(v, 3, value))
        return bad(r, value, "must be three numbers r,g,b");
    for (int i = 0; i < 3; i++)
        if (v[i] < 0 || v[i] > HLC_FLOAT_RANGE)
            return bad(r, value, "must be from 0 to 1e9");
    memcpy(out, v, sizeof v);
    *has = true;
    return 0;
}

static int take_camera(struct hlc_options *o, const struct hlc_option *r,
                       const char *value)
{
    double v[7];
    bool same = true;
    if (!hlc_read_reals(v, 7, value))
        return bad(r, value, "must be seven numbers ex,ey,ez,tx,ty,tz,vfov");
    for (int i = 0; i < 6; i++)
        if (v[i] < -HLC_FLOAT_RANGE || v[i] > HLC_FLOAT_RANGE)
            return bad(r, value, "positions must be within 1e9");
    if (v[6] <= 0 || v[6] >= 180)
        return bad(r, value, "vfov must be above 0 and below 180 degrees");
    for (int i = 0; i < 3; i++)
        same = same && (float)v[i] == (float)v[i + 3];
    if (same)
        return bad(r, value, "eye and target are one point");
    memcpy(o->eye, v, sizeof o->eye);
    memcpy(o->target, v + 3, sizeof o->target);
    o->vfov = v[6];
    o->has_camera = true;
    return 0;
}

/* Names of the backends in this build, "vulkan, null". */
static void backend_names(char *out, size_t bytes)
{
    size_t used = 0;
    out[0] = 0;
    for (uint32_t i = 0; hl_platform(i) && used < bytes; i++)
        used += (size_t)snprintf(out + used, bytes - used, "%s%s",
                                 i ? ", " : "", hl_platform(i)->name);
}

static int take_backend(struct hlc_options *o, const struct hlc_option *r,
                        const char *value)
{
    char names[128];
    if (hl_platform_find(value)) {
        o->backend = value;
        return 0;
    }
    backend_names(names, sizeof names);
    return hlc_fail(HLC_NO_DEVICE, "--backend %s: %s; this build has %s",
                    value, hlc_read_word(value, r->value) < 0
                    ? "no such backend" : "not built in", names);
}

static int take_format(void *at, const struct hlc_option *r,
                       const char *value)
{
    for (int i = HL_FORMAT_NONE + 1; i < HL_FORMAT_COUNT; i++)
        if (!strcmp(hl_format_info((enum hl_format)i)->name, value)) {
            enum hl_format format = (enum hl_format)i;
            memcpy(at, &format, sizeof format);
            return 0;
        }
    return bad(r, value, "no such format; see 'halflight devices --json -'");
}

static int take_max_error(struct hlc_options *o, const struct hlc_option *r,
                          const char *value)
{
    bool compare = o->command == HLC_COMPARE;
    struct hlc_option range = *r;
    range.low = compare ? 0 : 1e-3;
    range.high = compare ? 1e30 : 255;
    o->has_max_error = true;
    return take_real(&o->max_error, &range, value);
}

static int take_min_psnr(struct hlc_options *o, const struct hlc_option *r,
                         const char *value)
{
    struct hlc_option range = *r;
    range.low = -1000;
    range.high = 1000;
    o->has_min_psnr = true;
    return take_real(&o->min_psnr, &range, value);
}

static int take_jitter(struct hlc_options *o, const struct hlc_option *r,
                       const char *value)
{
    double v[2];
    if (!hlc_read_reals(v, 2, value) || v[0] < -1 || v[0] > 1 || v[1] < -1 ||
        v[1] > 1)
        return bad(r, value, "must be two numbers x,y from -1 to 1");
    memcpy(o->jitter, v, sizeof v);
    return 0;
}

/* A value that is one of the words of the row's own text. */
static int take_word(struct hlc_options *o, const struct hlc_option *r,
                     const char *value)
{
    int i = hlc_read_word(value, r->value);
    if (i < 0)
        return hlc_fail(HLC_BAD, "--%s %s: must be one of %s", r->name, value,
                        r->value);
    switch (r->kind) {
    case PROFILE: o->profile = value; return 0;
    case HALF_PIXEL: o->half_pixel = (enum hl_half_pixel)i; return 0;
    case PIPELINE:
        o->reference = i == HL_PIPELINE_COUNT;
        o->pipeline = o->reference ? HL_PIPELINE_AUTO : (enum hl_pipeline)i;
        return 0;
    case GL_CONTEXT: o->gl_context = i ? "egl" : "osmesa"; return 0;
    case SAMPLES: o->samples = 1u << i; return 0;
    case LIGHTS_MODE: o->lights_replace = i == 1; return 0;
    case DSF: o->dsf = (enum hl_dsf)i; return 0;
    case LIGHT_PATH: o->light_path = (enum hl_light_path)i; return 0;
    case TILE_DEPTH: o->no_tile_depth = i == 1; return 0;
    case SCISSOR: o->no_scissor = i == 1; return 0;
    case SHADOWS:
        o->has_shadows = true;
        o->shadows = (enum hl_shadows)i;
        return 0;
    case SHADOW_LIGHTS: o->shadow_lights_all = i == 0; return 0;
    case TRANSLUCENCY: o->translucency = (enum hl_translucency)i; return 0;
    case STIPPLE: o->stipple_mode = (enum hl_stipple_mode)i; return 0;
    case STIPPLE_FILTER:
        o->stipple_filter = (enum hl_stipple_filter)i;
        return 0;
    case FILL: o->fill = (enum hl_fill)i; return 0;
    case FETCH: o->fetch = (enum hl_fetch)i; return 0;
    case CENTROID: o->no_centroid = i == 1; return 0;
    case MASK: o->mask = i ? HLC_MASK_BLEND : HLC_MASK_TEST; return 0;
    case IDS_SCHEME: o->ids_scheme = (enum hlc_ids_scheme)i; return 0;
    default: return bad(r, value, "is not read");
    }
}

int hlc_option_take(struct hlc_options *o, const struct hlc_option *r,
                    const char *value)
{
    char *at = (char *)o + r->at;
    switch (r->kind) {
    case FLAG: *(bool *)(void *)at = true; return 0;
    case TEXT: memcpy(at, &value, sizeof value); return 0;
    case COUNT: return take_count(at, r, value);
    case REAL: return take_real(at, r, value);
    case SIZE: return take_size(at, r, value);
    case BACKEND: return take_backend(o, r, value);
    case CAMERA: return take_camera(o, r, value);
    case AMBIENT: return take_color(o->ambient, &o->has_ambient, r, value);
    case BACKGROUND:
        return take_color(o->background, &o->has_background, r, value);
    case FORMAT: return take_format(at, r, value);
    case ROUNDS:
        o->has_rounds = true;
        return take_count(at, r, value);
    case MIN_PSNR: return take_min_psnr(o, r, value);
    case JITTER: return take_jitter(o, r, value);
    case MAX_ERROR: return take_max_error(o, r, value);
    default: return take_word(o, r, value);
    }
}
