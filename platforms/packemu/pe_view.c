/* SPDX-License-Identifier: Zlib */
/* How a texture's bytes lie, and how shaders see them: byte orders, the
 * number that a resolve makes, the PlayStation 3's remap word. */
#include "platforms/packemu/pe_memory.h"

enum { IDENTITY_REMAP = 0xaae4 };

/* RSX is big-endian; vectors of 16- and 32-bit numbers lie in order, first
 * channel first, which of four-channel ones is assumed. */
static enum pe_order rsx_order(enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    if (format == HL_FORMAT_RGBA8_UNORM || format == HL_FORMAT_RGBA8_SRGB)
        return PE_ORDER_ARGB;
    return f->bits[0] == 8 ? PE_ORDER_NONE
           : f->bits[0] == 16 ? PE_ORDER_8IN16 : PE_ORDER_8IN32;
}

static bool rsx(const struct pe_state *s)
{
    return s->profile.big_endian && s->profile.edram_tiles == 0;
}

/* A Y16_X16 texel holds Y first, which is our first channel. Each row: what
 * 0xE4 and its like give for A, R, G, B. */
static bool pair_remap(uint32_t low, uint8_t from[4])
{
    static const struct { uint8_t low, from[4]; } rows[] = {
        { 0xe4, { 1, 0, 1, 0 } }, { 0x4e, { 0, 1, 0, 1 } },
        { 0xee, { 1, 1, 1, 1 } }, { 0x44, { 0, 0, 0, 0 } },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].low == low) {
            memcpy(from, rows[i].from, 4);
            return true;
        }
    return false;
}

/* Planes by A, R, G, B of an A8R8G8B8 texel. */
static bool byte_remap(uint32_t low, uint8_t from[4])
{
    static const uint8_t plane[4] = { 3, 0, 1, 2 };
    for (uint32_t c = 0; c < 4; c++)
        from[c] = plane[low >> 2 * c & 3];
    return true;
}

/* False: the machine hangs or refuses. */
static bool make_remap(struct pe_texture *t)
{
    static const uint8_t plane[4] = { 3, 0, 1, 2 };
    uint32_t word = t->desc.console.remap ? t->desc.console.remap
                                          : IDENTITY_REMAP;
    uint8_t from[4];
    bool pair = t->view == HL_FORMAT_RG16_UNORM ||
                t->view == HL_FORMAT_RG16_SNORM;
    bool bytes = t->view == HL_FORMAT_RGBA8_UNORM ||
                 t->view == HL_FORMAT_RGBA8_SRGB;
    if (!pair && !bytes)
        return word == IDENTITY_REMAP;
    if (!(pair ? pair_remap(word & 255, from) : byte_remap(word & 255, from)))
        return false;
    for (uint32_t c = 0; c < 4; c++) {
        uint32_t type = word >> (8 + 2 * c) & 3;
        if (type == 3)
            return false;
        t->remap[plane[c]] = type == 2 ? from[c] : (uint8_t)(4 + type);
    }
    t->remapped = t->remap[0] != 0 || t->remap[1] != 1 || t->remap[2] != 2 ||
                  t->remap[3] != 3;
    return true;
}

/* Only the fixed-point formats have another number in memory: unsigned or
 * signed 16_16 of range 0..1 or -1..1. */
static bool make_stored(struct pe_texture *t)
{
    enum hl_format f = t->desc.format;
    bool is_signed = t->desc.console.resolve_number == HL_NUMBER_SIGNED;
    t->stored = f;
    if (f == HL_FORMAT_RG16_FIXED32)
        t->stored = is_signed ? HL_FORMAT_RG16_SNORM : HL_FORMAT_RG16_UNORM;
    else if (f == HL_FORMAT_RGBA16_FIXED32)
        t->stored = is_signed ? HL_FORMAT_RGBA16_SNORM
                              : HL_FORMAT_RGBA16_UNORM;
    else
        return !is_signed;
    return true;
}

static enum hl_result refuse(struct pe_state *s, const struct pe_texture *t,
                             const char *why)
{
    hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_FORMAT,
              hl_format_info(t->desc.sample_as)->name, ": ", why);
    return HL_ERR_UNSUPPORTED;
}

enum hl_result pe_view_make(struct pe_state *s, struct pe_texture *t)
{
    const struct hl_console *c = &t->desc.console;
    if (!make_stored(t))
        return refuse(s, t, "console.resolve_number signed is kept for the"
                            " fixed-point formats alone");
    t->view = t->desc.sample_as == t->desc.format ? t->stored
                                                  : t->desc.sample_as;
    t->order = t->view_order = PE_ORDER_NONE;
    if (s->profile.edram_tiles)
        t->order = t->view_order = c->endian;
    if (!rsx(s))
        return HL_OK;
    t->order = (uint8_t)rsx_order(t->stored);
    t->view_order = (uint8_t)rsx_order(t->view);
    if (!make_remap(t))
        return refuse(s, t, "console.remap is not one that this format of"
                            " RSX takes");
    return HL_OK;
}
