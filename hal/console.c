/* SPDX-License-Identifier: Zlib */
/* Consoles: the rules of a profile laid on a device, and what a texture may
 * ask of a console's memory. */
#include <string.h>
#include "hal/device.h"

/* ---- profiles ----------------------------------------------------------- */

/* Where a target lies in EDRAM is the plan's to say. */
static bool formats_known(const struct hl_profile_format *f)
{
    for (int i = 0; i < HL_PROFILE_FORMATS; i++)
        if ((unsigned)f[i].format >= HL_FORMAT_COUNT ||
            (unsigned)f[i].sample_as >= HL_FORMAT_COUNT ||
            f[i].console.edram_tile)
            return false;
    return true;
}

/* Also false for a NaN. */
static bool ranges_good(const struct hl_profile_format *f)
{
    for (int i = 0; i < HL_PROFILE_FORMATS; i++)
        if (!(f[i].range >= 0 && f[i].range <= 65536) ||
            !(f[i].sampled >= 0 && f[i].sampled <= 65536) ||
            (f[i].range > 0 && !(f[i].sampled > 0)))
            return false;
    return true;
}

static bool ends(const char *name, size_t room)
{
    size_t n = 0;
    while (n < room && name[n])
        n++;
    return n < room;
}

const char *hl_profile_fault(const struct hl_profile *p)
{
    if (!ends(p->name, sizeof p->name))
        return "its name is not terminated";
    if (!formats_known(p->two16) || !formats_known(p->scalar) ||
        !formats_known(p->light) || !formats_known(p->color) ||
        !formats_known(p->depth))
        return "a list names a format that does not exist, or an EDRAM tile";
    for (int i = 0; i < HL_PROFILE_NO_BLEND; i++)
        if ((unsigned)p->no_blend[i] >= HL_FORMAT_COUNT)
            return "no_blend names a format that does not exist";
    if (!ranges_good(p->light) || !ranges_good(p->color))
        return "a format's range or what it samples as is not 0 to 65,536";
    if (!(p->id_steps >= 0 && p->id_steps <= 65536))
        return "id_steps is not 0 to 65,536";
    if (p->samples && !(p->samples & 1))
        return "samples lacks 1";
    /* hl_console.edram_tile counts from 1 in 16 bits. */
    if (p->edram_tiles > 0xffff ||
        (p->edram_tiles && (!p->edram_tile_width || !p->edram_tile_height)))
        return "edram_tiles is too large or its tiles have no size";
    return NULL;
}

enum hl_result hl_profile_check(struct hl_device *d,
                                const struct hl_profile *p)
{
    const char *why = !p ? NULL : !p->name[0] ? "its name is empty"
                                              : hl_profile_fault(p);
    return why ? hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                           "hl_device_desc.profile", why) : HL_OK;
}

void hl_profile_apply(struct hl_caps *c, const struct hl_profile *asked)
{
    struct hl_profile *p = &c->profile;
    if (asked)
        *p = *asked;
    else if (!p->name[0])
        memcpy(p->name, "native", sizeof "native");
    /* What stands in for a console's format may blend as that one does. */
    for (int i = 0; i < HL_PROFILE_NO_BLEND && c->console_memory; i++)
        c->format[p->no_blend[i]].use &= (uint8_t)~HL_USE_BLEND;
    if (!p->samples)
        return;
    c->samples &= p->samples;
    for (int i = 0; i < HL_FORMAT_COUNT; i++)
        c->format[i].samples &= (uint8_t)p->samples;
}

/* ---- textures ----------------------------------------------------------- */

/* Samples as Xenos lays them: two are tall, four are square (spec/consoles
 * 1.1). */
uint64_t hl_edram_tiles(const struct hl_profile *p, enum hl_format format,
                        uint32_t width, uint32_t height, uint32_t samples)
{
    if (!p->edram_tiles)
        return 0;
    uint64_t w = (uint64_t)width * (samples >= 4 ? 2 : 1);
    uint64_t h = (uint64_t)height * (samples >= 2 ? 2 : 1);
    bool wide = hl_format_info(format)->bytes > 4;
    return (w + p->edram_tile_width - 1) / p->edram_tile_width *
           ((h + p->edram_tile_height - 1) / p->edram_tile_height) *
           (wide ? 2 : 1);
}

static const char *edram_fault(const struct hl_profile *p,
                               const struct hl_tex_desc *t)
{
    if (t->console.edram_tile == 0)
        return NULL;
    if (t->console.edram_tile > p->edram_tiles)
        return "edram_tile is past the EDRAM";
    if (!(t->usage & HL_TEX_TARGET))
        return "edram_tile is for targets";
    /* A surface may run over the EDRAM's end and on at its start. */
    if (hl_edram_tiles(p, t->format, t->width, t->height, t->samples) >
        p->edram_tiles)
        return "the target is larger than the EDRAM";
    return NULL;
}

static const char *resolve_fault(const struct hl_profile *p,
                                 const struct hl_console *c)
{
    if (!c->color_exp_bias && !c->resolve_exp_bias && !c->resolve_number &&
        !c->endian)
        return NULL;
    if (!p->resolve_to_read)
        return "this console does not resolve";
    /* Both are fields of 6 bits with a sign (spec/consoles 1.3, 1.4). */
    if (c->color_exp_bias < -32 || c->color_exp_bias > 31 ||
        c->resolve_exp_bias < -32 || c->resolve_exp_bias > 31)
        return "an exponent bias is not in -32..31";
    if (c->resolve_number > HL_NUMBER_SIGNED ||
        c->endian > HL_ENDIAN_16IN32)
        return "resolve_number or endian is not one of its enum";
    return NULL;
}

/* Remap words of pairs other than these, and remaps of floating point, are
 * reported to stop the machine (spec/consoles 2.4). */
static const char *remap_fault(const struct hl_profile *p,
                               const struct hl_tex_desc *t)
{
    uint32_t word = t->console.remap, low = word & 0xff;
    const struct hl_format_info *f = hl_format_info(t->sample_as);
    if (word == 0)
        return NULL;
    if (!p->big_endian || p->resolve_to_read)
        return "this console does not remap";
    for (int i = 8; i < 16; i += 2)
        if ((word >> i & 3) == 3)
            return "remap has a type that is not zero, one or remap";
    if (f->kind == HL_KIND_FLOAT && word != 0xAAE4)
        return "remap of a floating point format";
    if (f->channels == 2 && f->bits[0] == 16 && low != 0xE4 && low != 0x4E &&
        low != 0xEE && low != 0x44)
        return "remap of a 16-bit pair is not E4, 4E, EE or 44";
    return NULL;
}

enum hl_result hl_console_check(struct hl_device *d,
                                const struct hl_tex_desc *t)
{
    const struct hl_console *c = &t->console;
    const struct hl_profile *p = &d->caps.profile;
    bool any = c->edram_tile || c->color_exp_bias || c->resolve_exp_bias ||
               c->resolve_number || c->endian || c->remap;
    const char *why = NULL;
    if (any && !d->caps.console_memory)
        why = "this device does not keep memory as a console does";
    if (!why)
        why = edram_fault(p, t);
    if (!why)
        why = resolve_fault(p, c);
    if (!why)
        why = remap_fault(p, t);
    return why ? hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                           "hl_tex_desc.console", why) : HL_OK;
}

bool hl_depth_as_color(const struct hl_caps *c, const struct hl_tex_desc *t)
{
    const struct hl_profile_format *f = c->profile.depth;
    if (!c->console_memory)
        return false;
    for (int i = 0; i < HL_PROFILE_FORMATS; i++)
        if (f[i].format == t->format && f[i].sample_as == t->sample_as)
            return true;
    return false;
}
