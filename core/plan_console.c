/* SPDX-License-Identifier: Zlib */
/* What a profile rules: formats and how their numbers are kept, scales,
 * depth that is read, pixel centres, decals. K = Kircher, Lawrance 2009. */
#include <string.h>
#include "core/pipe.h"
#include "core/vec.h"

/* ---- rows --------------------------------------------------------------- */

static bool holds_here(const struct hl_profile_format *row,
                       const struct hl_caps *caps)
{
    return row->on == HL_ON_ANY ||
           (row->on == HL_ON_CONSOLE) == caps->console_memory;
}

const struct hl_profile_format *
hl_plan_row(const struct hl_caps *caps, const struct hl_profile_format *list,
            enum hl_format asked, int use, uint32_t samples)
{
    for (int i = 0; i < HL_PROFILE_FORMATS && list[i].format; i++)
        if (holds_here(&list[i], caps) &&
            (asked == HL_FORMAT_NONE || list[i].format == asked) &&
            hl_format_usable(caps, list[i].format, use, samples))
            return &list[i];
    return NULL;
}

static bool listed(const struct hl_profile_format *l, enum hl_format f)
{
    bool is = false;
    for (int i = 0; i < HL_PROFILE_FORMATS && l[i].format; i++)
        is |= l[i].format == f;
    return is;
}

/* With a BRDF beside it the exponent is of a pair's format. */
static const struct hl_profile_format *list_of(const struct hl_profile *p,
                                               enum hl_role role,
                                               enum hl_format format)
{
    switch (role) {
    case HL_ROLE_NORMAL: case HL_ROLE_DSF: case HL_ROLE_MOTION:
        return p->two16;
    case HL_ROLE_EXPONENT:
        return listed(p->scalar, format) ? p->scalar : p->two16;
    case HL_ROLE_LIGHT: return p->light;
    case HL_ROLE_COLOR: case HL_ROLE_RESOLVED: return p->color;
    case HL_ROLE_LIGHT_DEPTH: case HL_ROLE_DEPTH: case HL_ROLE_SHADOW_MAP:
        return p->depth;
    default: return NULL;
    }
}

/* A stand-in stands for the list's first row of the console itself. */
enum hl_format hl_plan_console_format(const struct hl_caps *caps,
                                      const struct hl_plan_target *t)
{
    const struct hl_profile_format *l = list_of(&caps->profile, t->role,
                                                t->format);
    bool stand_in = false;
    for (int i = 0; l && i < HL_PROFILE_FORMATS && l[i].format; i++)
        stand_in |= l[i].on == HL_ON_STAND_IN && l[i].format == t->format &&
                    !caps->console_memory;
    for (int i = 0; stand_in && i < HL_PROFILE_FORMATS && l[i].format; i++)
        if (l[i].on == HL_ON_CONSOLE)
            return l[i].format;
    return t->format;
}

void hl_plan_keep(struct hl_plan *p, struct hl_plan_target *t,
                  const struct hl_caps *caps,
                  const struct hl_profile_format *row, bool read)
{
    if (!row)
        return;
    t->sample_as = read ? row->sample_as : HL_FORMAT_NONE;
    if (caps->console_memory)
        t->console = row->console;
    /* A remap is of the texture that it is sampled as. */
    if (!read && row->sample_as != HL_FORMAT_NONE)
        t->console.remap = 0;
    enum hl_format console = hl_plan_console_format(caps, t);
    if (console != t->format && t->role != HL_ROLE_DSF &&
        t->role != HL_ROLE_MOTION && t->role != HL_ROLE_RESOLVED &&
        t->role != HL_ROLE_DEPTH)
        hl_plan_why(p, HL_WHY_STAND_IN, (float)t->format, (float)console,
                    (float)t->role, 0);
}

/* ---- the machine -------------------------------------------------------- */

/* Only one of state and vertices may shift, or pictures are half a pixel off
 * the other way (K 5.1). */
static enum hl_refusal pixel_centers(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    bool integer = ask->caps->profile.integer_centers;
    enum hl_half_pixel asked = ask->n.half_pixel;
    if (!integer || !ask->caps->console_memory) {
        if (asked == HL_HALF_PIXEL_STATE || asked == HL_HALF_PIXEL_VERTEX)
            return HL_REFUSED_HALF_PIXEL;
        if (integer)
            hl_plan_why(p, HL_WHY_HALF_PIXEL_HERE, 0, 0, 0, 0);
        return HL_REFUSED_NOTHING;
    }
    p->half_pixel = asked == HL_HALF_PIXEL_AUTO ? HL_HALF_PIXEL_STATE : asked;
    hl_plan_why(p, p->half_pixel == HL_HALF_PIXEL_STATE
                   ? HL_WHY_HALF_PIXEL_STATE
                   : p->half_pixel == HL_HALF_PIXEL_VERTEX
                   ? HL_WHY_HALF_PIXEL_VERTEX : HL_WHY_HALF_PIXEL_NONE,
                0, 0, 0, 0);
    return HL_REFUSED_NOTHING;
}

enum hl_refusal hl_plan_profile(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_profile *c = &ask->caps->profile;
    size_t room = sizeof p->profile - 1;
    memcpy(p->profile, c->name[0] ? c->name : "native",
           c->name[0] ? room : sizeof "native");
    p->id_steps = c->id_steps > 0 ? c->id_steps : 65535.0f;
    p->float_taps = c->float_taps;
    return pixel_centers(p, ask);
}

/* ---- G-buffer ----------------------------------------------------------- */

void hl_plan_two16(struct hl_plan *p, const struct hl_ask *ask,
                   const struct hl_profile_format *row)
{
    static const enum hl_reason whys[] = {
        [HL_TWO16_UNORM] = HL_WHY_NONE,
        [HL_TWO16_SIGNED] = HL_WHY_TWO16_SIGNED,
        [HL_TWO16_FIXED32] = HL_WHY_TWO16_FIXED32,
        [HL_TWO16_BYTES] = HL_WHY_TWO16_BYTES,
        [HL_TWO16_BYTES_ARGB] = HL_WHY_TWO16_BYTES_ARGB,
    };
    if (!row)
        return;
    p->two16 = row->two16;
    enum hl_reason why = row->two16 < sizeof whys / sizeof *whys
                         ? whys[row->two16] : HL_WHY_NONE;
    /* Written as 0..1 into -32..32, codes 0 to 1024 would be all. */
    if (why == HL_WHY_TWO16_FIXED32)
        hl_plan_why(p, why, (float)row->format, 65535, 1025,
                    row->console.resolve_exp_bias);
    else if (why != HL_WHY_NONE)
        hl_plan_why(p, why, (float)row->format, (float)row->sample_as,
                    row->console.remap, 0);
    if (p->id_steps != 65535.0f)
        hl_plan_why(p, HL_WHY_ID_STEPS, p->id_steps, 0, 0, 0);
    if (ask->caps->profile.one_mrt_format)
        hl_plan_why(p, HL_WHY_MRT_FORMAT, (float)row->format, 0, 0, 0);
}

/* ---- depth -------------------------------------------------------------- */

static enum hl_refusal add_copy(struct hl_plan *p, const struct hl_ask *ask,
                                struct hl_plan_target *depth)
{
    if (!hl_format_usable(ask->caps, HL_FORMAT_R32_FLOAT,
                          HL_USE_TARGET | HL_USE_SAMPLED, 1))
        return HL_REFUSED_DEPTH_FORMAT;
    depth->read_by = 1u << HL_PASS_DEPTH_COPY;
    struct hl_plan_target *t =
        hl_plan_add_target(p, HL_ROLE_DEPTH_COPY, HL_FORMAT_R32_FLOAT,
                           p->light_width, p->light_height, 1);
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_add_pass(p, HL_PASS_DEPTH_COPY)->color[0] = HL_ROLE_DEPTH_COPY;
    hl_plan_why(p, HL_WHY_DEPTH_COPY, (float)t->format, 0, 0, 0);
    return HL_REFUSED_NOTHING;
}

/* K 5 has Direct3D 10 copy depth always. A view reads it where nothing tests
 * it meanwhile, so the copy is made where something does; and where a stencil
 * beside it is written, since OpenGL leaves open what is read then. */
enum hl_refusal hl_plan_depth_read(struct hl_plan *p,
                                   const struct hl_ask *ask)
{
    const struct hl_profile *c = &ask->caps->profile;
    bool stencil = hl_plan_stencil(p, ask);
    bool bound = ask->n.light_depth_bound || stencil;
    /* What is sampled there is the copy that a resolve made before. */
    bool apart = c->resolve_to_read && ask->caps->console_memory;
    struct hl_plan_target *t = p->target;
    while (t->role != HL_ROLE_LIGHT_DEPTH)
        t++;
    if (p->depth_read == HL_DEPTH_READ_BARG)
        hl_plan_why(p, HL_WHY_DEPTH_BARG, (float)t->format,
                    (float)t->sample_as, t->console.remap, 0);
    else if (c->depth[0].on == HL_ON_CONSOLE && c->depth[0].depth_read)
        hl_plan_why(p, HL_WHY_DEPTH_PLAIN, (float)t->format, 0, 0, 0);
    if ((c->depth_copy_if_bound && bound) || (stencil && !apart))
        return add_copy(p, ask, t);
    if (c->depth_copy_if_bound)
        hl_plan_why(p, HL_WHY_DEPTH_IN_PLACE, (float)t->format, 0, 0, 0);
    else if (bound && !c->resolve_to_read)
        hl_plan_why(p, HL_WHY_DEPTH_READ_ONLY, (float)t->format, 0, 0, 0);
    return HL_REFUSED_NOTHING;
}

/* ---- light -------------------------------------------------------------- */

/* An L-buffer of fixed range needs a peak. Where it is not known: 32 times
 * white, with steps of a quarter of an 8-bit code of white. Light of inverse
 * square lights is 10^4 times their intensity a centimetre away, where
 * nothing is seen: 0.25 m away it is 16 times. Nearer it may be cut, and
 * below 32 it never is. */
enum { PEAK_DEFAULT = 32, PEAK_NEAR = 625 };

static float peak_of(struct hl_plan *p, const struct hl_ask *ask, float steps)
{
    float peak = ask->n.peak;
    if (peak <= 0) {
        hl_plan_why(p, HL_WHY_LIGHT_PEAK_DEFAULT, PEAK_DEFAULT, 0, 0, 0);
        return PEAK_DEFAULT;
    }
    float cut = peak / PEAK_NEAR;
    cut = cut > PEAK_DEFAULT ? cut : PEAK_DEFAULT;
    if (!(ask->n.lights & HL_LIGHTS_INVERSE_SQUARE) || cut >= peak)
        return peak;
    hl_plan_why(p, HL_WHY_LIGHT_PEAK_CUT, peak, peak / steps, cut,
                0.01f * sqrtf(peak / cut));
    return cut;
}

float hl_plan_light_range(struct hl_plan *p, const struct hl_ask *ask,
                          const struct hl_profile_format *row,
                          uint32_t blends)
{
    float steps = row->range / hl_fixed_step(row->format);
    float peak = peak_of(p, ask, steps);
    /* A smaller peak would make a scale that is no number. */
    peak = peak > 1e-30f ? peak : 1e-30f;
    p->light_out = row->range / peak;
    p->light_scale = peak / row->sampled;
    hl_plan_why(p, HL_WHY_LIGHT_RANGE, peak, p->light_out, peak / steps,
                p->light_scale);
    return hl_range_error(row->format, row->range, blends);
}

/* ---- decals ------------------------------------------------------------- */

/* A pass blends all of its targets or none: whatever else the geometry pass
 * writes is blended too, with nothing. NONE: all of them can be. */
static enum hl_format not_blended(const struct hl_plan *p,
                                  const struct hl_ask *ask)
{
    for (uint32_t i = 0; i < p->n_targets; i++) {
        const struct hl_plan_target *t = &p->target[i];
        bool written = t->role == HL_ROLE_NORMAL || t->role == HL_ROLE_DSF ||
                       t->role == HL_ROLE_EXPONENT ||
                       t->role == HL_ROLE_MOTION;
        if (written && !hl_format_usable(ask->caps, t->format, HL_USE_BLEND,
                                         1))
            return t->format;
    }
    return HL_FORMAT_NONE;
}

void hl_plan_decals(struct hl_plan *p, const struct hl_ask *ask,
                    enum hl_format normal)
{
    if (!ask->n.decals)
        return;
    enum hl_format cannot = not_blended(p, ask);
    enum hl_reason why = HL_WHY_DECALS_BLEND;
    if (normal == HL_FORMAT_NONE)
        why = HL_WHY_DECALS_FORWARD;
    else if (ask->caps->profile.packed_normals)
        why = HL_WHY_DECALS_PACKED;
    else if (cannot != HL_FORMAT_NONE) {
        why = HL_WHY_DECALS_NO_BLEND;
        normal = cannot;
    }
    p->decals = why == HL_WHY_DECALS_BLEND ? HL_DECALS_BLEND_NORMALS
                                           : HL_DECALS_ALPHA_OBJECTS;
    hl_plan_why(p, why, (float)normal, 0, 0, 0);
}

/* Steps from 0 to 1 of a channel of a 16-bit pair. */
float hl_plan_pair_steps(uint32_t two16)
{
    return two16 == HL_TWO16_SIGNED || two16 == HL_TWO16_FIXED32 ? 65534.0f
                                                                 : 65535.0f;
}

/* ---- resolves ----------------------------------------------------------- */

static enum hl_pass_role last_writer(const struct hl_plan *p,
                                     enum hl_role role)
{
    enum hl_pass_role last = HL_PASS_NONE;
    for (uint32_t i = 0; i < p->n_passes; i++) {
        const struct hl_plan_pass *s = &p->pass[i];
        if ((s->depth == role && s->depth_write) ||
            hl_pass_colors(s, role))
            last = s->role;
    }
    return last;
}

double hl_plan_resolves(struct hl_plan *p, const struct hl_ask *ask)
{
    double bytes = 0;
    if (!ask->caps->profile.resolve_to_read)
        return 0;
    for (uint32_t i = 0; i < p->n_targets; i++) {
        const struct hl_plan_target *t = &p->target[i];
        enum hl_pass_role reader = HL_PASS_NONE;
        for (int r = HL_PASS_ROLE_COUNT - 1; r > 0; r--)
            reader = t->read_by >> r & 1u ? (enum hl_pass_role)r : reader;
        if (reader == HL_PASS_NONE)
            continue;
        hl_plan_why(p, HL_WHY_RESOLVE, (float)t->role,
                    (float)last_writer(p, t->role), (float)reader,
                    (float)t->bytes);
        bytes += (double)t->bytes;
    }
    return bytes;
}
