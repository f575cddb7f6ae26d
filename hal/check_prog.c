/* SPDX-License-Identifier: Zlib */
/* What hl_prog_create refuses; zeros become defaults here. */
#include "hal/device.h"

static bool stage_empty(const struct hl_stage *s)
{
    return s->builtin == HL_SHADER_NONE && !s->code;
}

static bool is_depth(enum hl_format format)
{
    return hl_format_info(format)->kind == HL_KIND_DEPTH;
}

/* ---- targets ------------------------------------------------------------ */

static enum hl_result check_color(struct hl_device *d,
                                  const struct hl_prog_desc *p, uint32_t i)
{
    if ((unsigned)p->color[i] >= HL_FORMAT_COUNT || is_depth(p->color[i]))
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_FORMAT,
                                "hl_prog_desc.color", i,
                                " is not a colour format");
    const struct hl_format_caps *f = &d->caps.format[p->color[i]];
    int need = HL_USE_TARGET;
    if (p->blend != HL_BLEND_OFF)
        need |= HL_USE_BLEND;
    if ((f->use & need) != need || !(f->samples & p->samples))
        return hl_refuse(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                         hl_format_info(p->color[i])->name,
                         "not a target with this blend or sample count");
    if (p->color[i] != p->color[0] && d->caps.console_memory &&
        d->caps.profile.one_mrt_format)
        return hl_refuse_number(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                                "hl_prog_desc.color", i,
                                " has another format than color 0, this"
                                " console has one for all");
    return HL_OK;
}

static enum hl_result check_targets(struct hl_device *d,
                                    const struct hl_prog_desc *p)
{
    if (p->n_colors > HL_MAX_COLORS || p->n_colors > d->caps.max_colors)
        return hl_refuse_number(d, HL_ERR_UNSUPPORTED, HL_MSG_ARGUMENT,
                                "hl_prog_desc.n_colors", p->n_colors,
                                " is more than the device has");
    if (p->samples & (p->samples - 1) || !(d->caps.samples & p->samples))
        return hl_refuse_number(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                                "hl_prog_desc.samples", p->samples,
                                " is not a sample count of this device");
    for (uint32_t i = 0; i < p->n_colors; i++) {
        enum hl_result r = check_color(d, p, i);
        if (r != HL_OK)
            return r;
    }
    if (p->depth == HL_FORMAT_NONE)
        return HL_OK;
    if (!is_depth(p->depth))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_FORMAT,
                         "hl_prog_desc.depth", "not a depth format");
    const struct hl_format_caps *z = &d->caps.format[p->depth];
    if (!(z->use & HL_USE_TARGET) || !(z->samples & p->samples))
        return hl_refuse(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                         hl_format_info(p->depth)->name,
                         "not a target with this sample count");
    return HL_OK;
}

/* ---- state -------------------------------------------------------------- */

static bool stencil_on(const struct hl_stencil *s)
{
    return s->front.test != HL_COMPARE_OFF || s->back.test != HL_COMPARE_OFF;
}

static bool face_keeps(const struct hl_stencil_face *f)
{
    return f->fail == HL_STENCIL_KEEP && f->depth_fail == HL_STENCIL_KEEP &&
           f->pass == HL_STENCIL_KEEP;
}

bool hl_stencil_writes(const struct hl_stencil *s)
{
    return !face_keeps(&s->front) || !face_keeps(&s->back);
}

static bool face_known(const struct hl_stencil_face *f)
{
    return (unsigned)f->test <= HL_COMPARE_ALWAYS &&
           (unsigned)f->fail <= HL_STENCIL_INVERT &&
           (unsigned)f->depth_fail <= HL_STENCIL_INVERT &&
           (unsigned)f->pass <= HL_STENCIL_INVERT;
}

/* Every enum is an index into some backend's table. */
static enum hl_result check_enums(struct hl_device *d,
                                  const struct hl_prog_desc *p)
{
    const char *bad = (unsigned)p->blend > HL_BLEND_SHIFT
          ? "hl_prog_desc.blend"
        : (unsigned)p->depth_test > HL_COMPARE_ALWAYS
          ? "hl_prog_desc.depth_test"
        : (unsigned)p->cull > HL_CULL_FRONT ? "hl_prog_desc.cull"
        : (unsigned)p->topology > HL_TOPOLOGY_LINES ? "hl_prog_desc.topology"
        : !face_known(&p->stencil.front) || !face_known(&p->stencil.back)
          ? "hl_prog_desc.stencil" : NULL;
    if (bad)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, bad,
                         "not one of its enum");
    for (int i = 0; i < HL_MAX_ATTRS; i++) {
        const struct hl_attr *a = &p->layout.attr[i];
        if (a->format != HL_ATTR_NONE &&
            ((unsigned)a->format > HL_ATTR_F16X4 ||
             a->stream >= HL_MAX_STREAMS))
            return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                    "hl_prog_desc.layout.attr", (uint64_t)i,
                                    " names a format or stream that does not"
                                    " exist");
    }
    return HL_OK;
}

/* A face whose test is off passes and keeps. */
static bool fill_face(struct hl_stencil_face *f)
{
    if (f->test != HL_COMPARE_OFF)
        return true;
    f->test = HL_COMPARE_ALWAYS;
    return face_keeps(f);
}

static enum hl_result check_stencil(struct hl_device *d,
                                    struct hl_prog_desc *p)
{
    struct hl_stencil *s = &p->stencil;
    if (!stencil_on(s) && !hl_stencil_writes(s))
        return HL_OK;
    if (!fill_face(&s->front) || !fill_face(&s->back))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.stencil",
                         "operations need a test (HL_COMPARE_ALWAYS)");
    if (hl_format_info(p->depth)->bits[1] == 0 || !is_depth(p->depth))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.stencil",
                         "needs a depth format with stencil");
    s->read_mask = s->read_mask ? s->read_mask : 255;
    s->write_mask = s->write_mask ? s->write_mask : 255;
    return HL_OK;
}

static enum hl_result check_state(struct hl_device *d,
                                  const struct hl_prog_desc *p)
{
    if (p->depth_test == HL_COMPARE_OFF && p->depth_write)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.depth_write",
                         "needs a depth test (HL_COMPARE_ALWAYS)");
    /* x - x is 0 for finite numbers alone. */
    if (p->blend == HL_BLEND_SHIFT &&
        !(p->blend_constant - p->blend_constant == 0))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.blend_constant", "not finite");
    return check_enums(d, p);
}

enum hl_result hl_check_prog(struct hl_device *d, struct hl_prog_desc *p)
{
    if (p->samples == 0)
        p->samples = 1;
    if (stage_empty(&p->vertex))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.vertex", "no stage");
    if (stage_empty(&p->fragment) && p->n_colors > 0 && !p->no_color_write)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc.fragment", "colours but no stage");
    if ((unsigned)p->vertex.builtin >= HL_SHADER_COUNT ||
        (unsigned)p->fragment.builtin >= HL_SHADER_COUNT)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_prog_desc", "no such built-in stage");
    if (p->n_specs > HL_MAX_SPECS)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_prog_desc.n_specs", p->n_specs,
                                " is too many");
    enum hl_result r = check_state(d, p);
    if (r == HL_OK)
        r = check_targets(d, p);
    return r == HL_OK ? check_stencil(d, p) : r;
}
