/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "tests/packemu_kit.h"

void pk_open(struct ck_machine *m, const struct hl_profile *profile)
{
    static const struct hl_packemu_native one_thread = { 1 };
    memset(m, 0, sizeof *m);
    m->backend = &hl_backend_packemu;
    struct hl_device_desc d = ck_desc(m);
    d.profile = profile;
    d.native = &one_thread;
    if (hl_device_open(&m->device, m->backend, &d) != HL_OK)
        fail_msg("packemu: %s", m->last);
}

struct pe_state *pk_state(const struct ck_machine *m)
{
    return m->device->state;
}

uint32_t pk_slot(hl_tex tex)
{
    return tex.id & 0xffff;
}

struct pe_texture *pk_texture(const struct ck_machine *m, hl_tex tex)
{
    return &pk_state(m)->tex[pk_slot(tex)];
}

struct hl_tex_desc pk_desc(enum hl_format format, uint32_t w, uint32_t h,
                           uint32_t samples)
{
    struct hl_tex_desc d;
    memset(&d, 0, sizeof d);
    d.format = format;
    d.width = w;
    d.height = h;
    d.samples = samples;
    d.usage = HL_TEX_SAMPLED | HL_TEX_READBACK;
    if (samples)
        d.usage |= HL_TEX_TARGET;
    return d;
}

hl_tex pk_make(struct ck_machine *m, const struct hl_tex_desc *desc)
{
    hl_tex t;
    if (hl_tex_create(m->device, &t, desc) != HL_OK)
        fail_msg("%s: %s", hl_format_info(desc->format)->name, m->last);
    return t;
}

static struct hl_rect whole(const struct ck_machine *m, hl_tex t)
{
    const struct hl_tex_desc *d = &pk_texture(m, t)->desc;
    return (struct hl_rect){ 0, 0, (int32_t)d->width, (int32_t)d->height };
}

void pk_draw(struct ck_machine *m, hl_tex target, hl_tex resolve,
             const uint32_t *words)
{
    const struct hl_rect rect = whole(m, target);
    struct hl_bk_pass p;
    memset(&p, 0, sizeof p);
    p.n_colors = 1;
    p.color[0].slot = pk_slot(target);
    p.color[0].resolve = resolve.id ? pk_slot(resolve) : HL_NO_SLOT;
    p.depth.slot = HL_NO_SLOT;
    pe_store_color(pk_state(m), pk_slot(target), &rect, words);
    pe_resolve(pk_state(m), &p, &rect);
}

void pk_draw_depth(struct ck_machine *m, hl_tex target, const float *depth,
                   const uint8_t *stencil)
{
    const struct hl_tex_desc *d = &pk_texture(m, target)->desc;
    const struct hl_rect rect = whole(m, target);
    uint32_t codes[4096], n = d->width * d->height * d->samples;
    struct hl_bk_pass p;
    memset(&p, 0, sizeof p);
    p.depth.slot = pk_slot(target);
    p.depth.resolve = HL_NO_SLOT;
    assert_true(n <= 4096);
    pe_depth_encode(d->format, depth, n, codes);
    pe_store_depth(pk_state(m), pk_slot(target), &rect, codes, stencil);
    pe_resolve(pk_state(m), &p, &rect);
}

void pk_assert_bytes(struct ck_machine *m, hl_tex t, const uint8_t *want,
                     size_t n)
{
    size_t bytes;
    const uint8_t *memory = hl_packemu_memory(m->device, t, &bytes);
    assert_non_null(memory);
    assert_int_equal(bytes, n);
    assert_memory_equal(memory, want, n);
}

struct pe_view pk_view(const struct ck_machine *m, hl_tex tex)
{
    struct pe_view v = { pk_texture(m, tex), pk_state(m), 0, 0, 0 };
    return v;
}
