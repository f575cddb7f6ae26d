/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <string.h>
#include "tests/kernel_kit.h"

static void bind(struct kk *k, uint32_t slot, const void *block, size_t bytes)
{
    k->draw.uniform[slot] = block;
    k->draw.uniform_bytes[slot] = (uint32_t)bytes;
}

static void set_specs(union pe_spec *s)
{
    s[HL_SPEC_FALLOFF].u = 1;
    s[HL_SPEC_BATCH].u = 8;
    s[HL_SPEC_BASE].u = 1;
    s[HL_SPEC_DSF].u = HL_DSF_SLOPE;
    s[HL_SPEC_RATIO_X].f = s[HL_SPEC_RATIO_Y].f = 1.0f;
    s[HL_SPEC_DSF_K].f = 1.5f;
    s[HL_SPEC_DSF_C].f = 0.001f;
    s[HL_SPEC_DSF_TAU].f = 0.01f;
    s[HL_SPEC_LIGHT_SCALE].f = s[HL_SPEC_LIGHT_OUT].f = 1.0f;
    s[HL_SPEC_ID_STEPS].f = 65535.0f;
}

void kk_open(struct kk *k)
{
    memset(k, 0, sizeof *k);
    pk_open(&k->machine, NULL);
    k->seed = mk_seed();
    k->draw.program = &k->program;
    bind(k, HL_SLOT_FRAME, &k->frame, sizeof k->frame);
    bind(k, HL_SLOT_OBJECT, &k->object, sizeof k->object);
    bind(k, HL_SLOT_MATERIAL, &k->material, sizeof k->material);
    bind(k, HL_SLOT_LIGHTS, k->lights, sizeof k->lights);
    for (int i = 0; i < HL_MAX_TEXTURES; i++)
        k->draw.view[i].state = pk_state(&k->machine);
    set_specs(k->program.spec);
}

void kk_close(struct kk *k)
{
    ck_close(&k->machine);
}

void kk_texture(struct kk *k, uint32_t slot, enum hl_format format,
                enum hl_format sample_as, uint32_t w, uint32_t h,
                const void *texels)
{
    struct hl_tex_desc d = pk_desc(format, w, h, 0);
    d.sample_as = sample_as;
    hl_tex t = pk_make(&k->machine, &d);
    size_t bytes = (size_t)w * h * hl_format_info(format)->bytes;
    assert_int_equal(hl_tex_write(k->machine.device, t, 0, texels, bytes),
                     HL_OK);
    k->draw.view[slot] = pk_view(&k->machine, t);
}

void kk_shade(struct kk *k, enum hl_shader fragment)
{
    k->program.fragment = pe_fragment_kernels[fragment];
    assert_non_null(k->program.fragment.stage.shade);
    k->program.fragment.stage.shade(&k->draw, &k->in);
}

float kk_between(struct kk *k, float low, float high)
{
    return low + mk_unit(&k->seed) * (high - low);
}

hl_vec4 kk_vec4(struct kk *k, float low, float high)
{
    hl_vec4 v;
    v.x = kk_between(k, low, high);
    v.y = kk_between(k, low, high);
    v.z = kk_between(k, low, high);
    v.w = kk_between(k, low, high);
    return v;
}

hl_vec3 kk_direction(struct kk *k)
{
    for (;;) {
        hl_vec4 v = kk_vec4(k, -1, 1);
        hl_vec3 d = hl_v3(v.x, v.y, v.z);
        float n = hl_dot3(d, d);
        if (n > 0.01f && n < 1)
            return hl_scale3(d, 1 / sqrtf(n));
    }
}

static void put3(float (*v)[HL_PE_BATCH], uint32_t i, hl_vec3 a)
{
    v[0][i] = a.x;
    v[1][i] = a.y;
    v[2][i] = a.z;
}

static void fragment(struct kk *k, uint32_t i, int32_t w, int32_t h)
{
    struct hl_pe_fragments *f = &k->in;
    float z = kk_between(k, 1, 9);
    f->x[i] = (int32_t)mk_below(&k->seed, (uint32_t)w);
    f->y[i] = (int32_t)mk_below(&k->seed, (uint32_t)h);
    f->z[i] = z;
    f->dzdx[i] = kk_between(k, -0.1f, 0.1f);
    f->dzdy[i] = kk_between(k, -0.1f, 0.1f);
    f->back[i] = mk_below(&k->seed, 2) != 0;
    f->vary[HL_PE_ID][i] = (float)(1 + mk_below(&k->seed, 4));
    hl_vec3 n = kk_direction(k);
    put3(&f->vary[HL_PE_NX], i, hl_scale3(n, kk_between(k, 0.5f, 1)));
    put3(&f->vary[HL_PE_TX], i, kk_direction(k));
    f->vary[HL_PE_TW][i] = mk_below(&k->seed, 2) ? 1.0f : -1.0f;
    for (int c = HL_PE_R; c <= HL_PE_A; c++)
        f->vary[c][i] = kk_between(k, 0, 1);
    f->vary[HL_PE_U][i] = kk_between(k, 0, 1);
    f->vary[HL_PE_V][i] = kk_between(k, 0, 1);
    hl_vec4 p = kk_vec4(k, -2, 2);
    put3(&f->vary[HL_PE_PX], i, hl_v3(p.x, p.y, -z));
}

void kk_fragments(struct kk *k, uint32_t n, int32_t w, int32_t h)
{
    /* Lanes beyond n: anything at all, so let it be NaN and huge numbers. */
    memset(&k->in, 255, sizeof k->in);
    memset(k->in.x, 127, sizeof k->in.x);
    k->in.n = n;
    for (uint32_t i = 0; i < n; i++)
        fragment(k, i, w, h);
}

void kk_lights(struct kk *k, hl_vec4 *out, uint32_t n, uint32_t kinds)
{
    for (uint32_t i = 0; i < n; i++) {
        float r = kk_between(k, 2, 8);
        hl_vec4 p = kk_vec4(k, -3, 3), c = kk_vec4(k, 0, 1);
        out[0] = hl_v4(p.x, p.y, p.z * 1.5f - 4.5f, 1 / (r * r));
        out[1] = hl_v4(c.x, c.y, c.z, (float)mk_below(&k->seed, 2));
        out += HL_POINT_VEC4S;
        if (!kinds)
            continue;
        hl_vec3 d = kk_direction(k);
        uint32_t kind = i % 3;       /* point, spot, directional             */
        out[0] = hl_v4(d.x, d.y, d.z, kind == 1 ? 1.5f : 0.0f);
        out[1] = hl_v4(kind == 1 ? -0.25f : 1.0f, kind == 2, 0, 0);
        out += 2;
    }
}

void kk_texel(const struct kk *k, int target, uint32_t i,
              hl_vec4 want)
{
    const float w[4] = { want.x, want.y, want.z, want.w };
    for (int c = 0; c < 4; c++)
        if (k->in.color[target][c][i] != w[c])
            fail_msg("target %d channel %d: %a, not %a", target, c,
                     (double)k->in.color[target][c][i], (double)w[c]);
}
