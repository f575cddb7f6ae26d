/* SPDX-License-Identifier: Zlib */
/* Programs: which kernels, and what their specialisation constants are. */
#include <string.h>
#include "platforms/packemu/pe.h"
#include "shaders/shared/block.h"

static enum hl_result lacks(struct pe_state *s, const struct hl_prog_desc *d,
                            const char *what)
{
    hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_BACKEND,
              d->label ? d->label : "program", ": packemu has no ", what);
    return HL_ERR_UNSUPPORTED;
}

/* ---- specialisation constants ------------------------------------------- */

/* What layout(constant_id) gives in shaders; ids not here begin as 0. */
static void set_defaults(union pe_spec *spec)
{
    memset(spec, 0, HL_MAX_SPECS * sizeof *spec);
    spec[HL_SPEC_FALLOFF].u = 1;
    spec[HL_SPEC_BATCH].u = 8;
    spec[HL_SPEC_DSF].u = HL_DSF_SLOPE;
    spec[HL_SPEC_BASE].u = 1;
    spec[HL_SPEC_LIGHT_WIDTH].f = 1.0f;
    spec[HL_SPEC_LIGHT_HEIGHT].f = 1.0f;
    spec[HL_SPEC_RATIO_X].f = 1.0f;
    spec[HL_SPEC_RATIO_Y].f = 1.0f;
    spec[HL_SPEC_DSF_K].f = 1.5f;
    spec[HL_SPEC_DSF_C].f = 0.001f;
    spec[HL_SPEC_DSF_TAU].f = 0.01f;
    spec[HL_SPEC_LIGHT_SCALE].f = 1.0f;
    spec[HL_SPEC_ID_STEPS].f = 65535.0f;
    spec[HL_SPEC_LIGHT_OUT].f = 1.0f;
    spec[HL_SPEC_MAP_SIZE].f = 1.0f;
    spec[HL_SPEC_MAP_KIND].u = HL_MAP_CONE;
}

static void take_specs(union pe_spec *spec, const struct hl_prog_desc *d)
{
    set_defaults(spec);
    /* Ids past the array are of no stage here, as a driver would say. */
    for (uint32_t i = 0; i < d->n_specs; i++)
        if (d->spec[i].id < HL_MAX_SPECS)
            spec[d->spec[i].id].u = d->spec[i].value;
}

/* ---- stages -------------------------------------------------------------- */

static bool covers_screen(enum hl_shader s)
{
    return s == HL_SHADER_SCREEN_VERT || s == HL_SHADER_SCREEN_FLAT_VERT;
}

static bool take_vertex(struct pe_program *p)
{
    enum hl_shader s = p->desc.vertex.builtin;
    p->vertex = &pe_vertex_kernels[s];
    return s != HL_SHADER_NONE && (p->vertex->run || covers_screen(s));
}

/* hl_code.kernel is a struct hl_pe_stage cast to a function pointer; bytes
 * are copied, since ISO C has no cast back to an object pointer. */
static bool take_code(struct pe_program *p, const struct hl_code *code)
{
    const struct hl_pe_stage *stage = NULL;
    if (sizeof stage != sizeof code->kernel || !code->kernel)
        return false;
    memcpy(&stage, &code->kernel, sizeof stage);
    p->fragment.stage = *stage;
    p->fragment.vary = 0xffffffffu;
    return stage->shade != NULL;
}

static bool take_fragment(struct pe_program *p)
{
    const struct hl_stage *s = &p->desc.fragment;
    memset(&p->fragment, 0, sizeof p->fragment);
    if (s->builtin != HL_SHADER_NONE) {
        p->fragment = pe_fragment_kernels[s->builtin];
        return p->fragment.stage.shade != NULL;
    }
    return !s->code || take_code(p, s->code);
}

/* What built-in stages do only for some constants. */
static void narrow(struct pe_program *p)
{
    struct hl_pe_stage *s = &p->fragment.stage;
    if (p->desc.fragment.builtin == HL_SHADER_NONE)
        return;
    bool stippled = p->fragment.stipples && p->spec[HL_SPEC_STIPPLE].u != 0;
    s->discards = stippled ||
                  (s->discards && p->spec[HL_SPEC_MASK].u != 0);
    s->uv_slope = s->uv_slope && (p->spec[HL_SPEC_TEXTURES].u != 0 ||
                                  p->spec[HL_SPEC_MASK].u != 0);
    s->slope = s->slope && p->spec[HL_SPEC_DSF].u == HL_DSF_SLOPE;
}

/* Rows with HL_CENTROID, where one sample does not make it the centre. */
static bool at_centroid(const struct hl_prog_desc *d)
{
    switch (d->fragment.builtin) {
    case HL_SHADER_MATERIAL_PLAIN_CENTROID_FRAG:
    case HL_SHADER_MATERIAL_FULL_CENTROID_FRAG:
    case HL_SHADER_MATERIAL_PLAIN_FILTER_CENTROID_FRAG:
    case HL_SHADER_MATERIAL_FULL_FILTER_CENTROID_FRAG:
    case HL_SHADER_MATERIAL_PLAIN_TAPS_CENTROID_FRAG:
    case HL_SHADER_MATERIAL_FULL_TAPS_CENTROID_FRAG:
        return d->samples > 1;
    default:
        return false;
    }
}

static void list_varyings(struct pe_program *p)
{
    uint32_t both = p->vertex->vary & p->fragment.vary;
    if (p->fragment.stage.uv_slope)
        both |= p->vertex->vary & (1u << HL_PE_U | 1u << HL_PE_V);
    p->n_vary = 0;
    if (!p->fragment.stage.shade || !p->vertex->run)
        return;
    for (uint32_t i = 0; i < HL_PE_VARY_COUNT; i++)
        if (both >> i & 1)
            p->vary[p->n_vary++] = (uint8_t)i;
}

enum hl_result pe_prog_create(void *state, uint32_t slot,
                              const struct hl_prog_desc *desc)
{
    struct pe_state *s = state;
    struct pe_program p;
    memset(&p, 0, sizeof p);
    p.desc = *desc;
    if (!take_vertex(&p))
        return lacks(s, desc, "kernel of this vertex stage");
    if (!take_fragment(&p))
        return lacks(s, desc, "kernel of this fragment stage");
    if (desc->n_colors > HL_PE_OUTPUTS)
        return lacks(s, desc, "more than four colour targets");
    take_specs(p.spec, desc);
    narrow(&p);
    p.centroid = at_centroid(desc);
    list_varyings(&p);
    /* Borrowed for the call only. */
    p.desc.label = NULL;
    p.desc.vertex.code = p.desc.fragment.code = NULL;
    if (!p.desc.stencil.read_mask)
        p.desc.stencil.read_mask = 255;
    if (!p.desc.stencil.write_mask)
        p.desc.stencil.write_mask = 255;
    s->prog[slot] = p;
    return HL_OK;
}
