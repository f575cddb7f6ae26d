/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/count.h"
#include <stdlib.h>
#include <string.h>

/* ---- counting ----------------------------------------------------------- */

static bool is(const struct hl_timing *t, const char *label)
{
    return !strcmp(t->label, label);
}

static void note(struct hlt_counts *c, struct hl_device *d)
{
    struct hl_timing t[64];
    uint32_t n = hl_timings(d, t, 64);
    for (uint32_t i = 0; i < n && i < 64; i++) {
        bool lit = is(&t[i], "light") || is(&t[i], "shadowed light");
        c->geometry += is(&t[i], "geometry") ? t[i].fragments : 0;
        c->light += lit ? t[i].fragments : 0;
        c->light_blends += lit ? t[i].blended : 0;
        c->material += is(&t[i], "material") ? t[i].fragments : 0;
        c->forward += is(&t[i], "forward") ? t[i].fragments : 0;
        c->blended += is(&t[i], "blended") ? t[i].fragments : 0;
        c->color_blends += is(&t[i], "forward") || is(&t[i], "blended")
                           ? t[i].blended : 0;
    }
}

static enum hl_result inspected_lights(uint64_t *sum,
                                       const struct hlc_shot *shot)
{
    uint32_t w, h;
    void *data = NULL;
    enum hl_result r = hlc_shot_inspect(shot, HL_INSPECT_LIGHTS, &data, &w,
                                        &h);
    for (size_t i = 0; r == HL_OK && i < (size_t)w * h; i++) {
        float lights;
        memcpy(&lights, (char *)data + i * sizeof lights, sizeof lights);
        *sum += (uint64_t)lights;
    }
    free(data);
    return r;
}

/* A background pixel is 0, one that rejected no tap is 1. */
static enum hl_result inspected_taps(struct hlt_counts *c,
                                     const struct hlc_shot *shot)
{
    uint32_t w, h;
    void *data = NULL;
    enum hl_result r = hlc_shot_inspect(shot, HL_INSPECT_REJECTS, &data, &w,
                                        &h);
    for (size_t i = 0; r == HL_OK && i < (size_t)w * h; i++) {
        uint8_t taps = ((const uint8_t *)data)[i];
        c->rejecting += taps > 1;
        c->lost += taps > 4;
    }
    free(data);
    return r;
}

static bool filters(const struct hl_plan *p)
{
    return p->pipeline == HL_PIPELINE_INFERRED &&
           (p->dsf == HL_DSF_SLOPE || p->dsf == HL_DSF_CONSTANT);
}

/* Blended surfaces that are lit in their draws have all lights that touch
 * their object: the mean of all objects stands for it. */
static uint64_t drawn_lights(const struct hlt_counts *c,
                             const struct hlc_shot *s)
{
    const struct hl_plan *p = &s->plan;
    bool stippled = p->pipeline == HL_PIPELINE_INFERRED && p->stipple;
    uint64_t over = stippled ? 0 : (uint64_t)((double)c->blended *
                                   (double)s->needs.lights_per_object + 0.5);
    if (p->pipeline == HL_PIPELINE_FORWARD)
        return c->forward * p->batch + over;
    if (p->pipeline == HL_PIPELINE_FORWARD_MULTIPASS)
        return c->color_blends + over;
    return over;
}

static enum hl_result look_inside(struct hlt_counts *c,
                                  const struct hlc_shot *shot)
{
    enum hl_result r = HL_OK;
    c->lights = drawn_lights(c, shot);
    if (shot->plan.pipeline == HL_PIPELINE_INFERRED)
        r = inspected_lights(&c->lights, shot);
    if (r == HL_OK && filters(&shot->plan))
        r = inspected_taps(c, shot);
    return r;
}

enum hl_result hlt_count(struct hlt_counts *c, struct hlc_shot *shot)
{
    struct hl_device *device = shot->stage->machine.device;
    memset(c, 0, sizeof *c);
    if (strcmp(shot->stage->machine.caps.backend, "packemu"))
        return HL_ERR_INVALID;
    enum hl_result r = hl_submit(device, true);
    uint64_t before = hl_device_counts(device).triangles;
    if (r == HL_OK)
        r = hl_frame_draw(shot->renderer, &shot->frame, &shot->stats);
    /* Such a frame waits for its own depth, and what came before that is told
     * then or never. */
    if (r == HL_OK && shot->plan.tile_depth && shot->stats.lights > 0)
        note(c, device);
    if (r == HL_OK)
        r = hl_submit(device, true);
    if (r != HL_OK)
        return r;
    note(c, device);
    c->draws = shot->stats.draws;
    c->triangles = hl_device_counts(device).triangles - before;
    return look_inside(c, shot);
}

/* ---- weighing ----------------------------------------------------------- */

static enum hl_format format_of(const struct hl_plan *p, enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    return t ? t->format : HL_FORMAT_NONE;
}

static double lit_ns(const struct hl_plan *p, const struct hl_cost_model *m)
{
    if (p->light_path == HL_LIGHT_PATH_LISTS &&
        p->pipeline == HL_PIPELINE_INFERRED)
        return (double)m->light_gather_ns;
    return (double)(p->light_flat ? m->light_flat_ns : m->light_ns);
}

/* Writing costs half of blending, which reads as well. */
static double write_ns(const struct hl_caps *caps, enum hl_format f)
{
    return 0.5 * hl_blend_ns(caps, f);
}

static double geometry_ns(const struct hl_plan *p, const struct hl_caps *caps)
{
    enum hl_format normal = format_of(p, HL_ROLE_NORMAL);
    double pair = write_ns(caps, HL_FORMAT_RG16_UNORM);
    double more = normal ? write_ns(caps, normal) - pair : 0;
    return 2 * (double)caps->cost.pixel_ns + more;
}

static double taps_ns(const struct hlt_counts *c, const struct hl_plan *p,
                      const struct hl_caps *caps)
{
    double light = hl_fetch_ns(caps, format_of(p, HL_ROLE_LIGHT));
    double pair = hl_fetch_ns(caps, format_of(p, HL_ROLE_DSF));
    /* A machine without a filter fetches four and weighs them (pipe_dsf.c). */
    double one = caps->kind == HL_DEVICE_CPU ? 10 : 1;
    double read = (double)(c->material + (p->stipple ? c->blended : 0));
    if (p->dsf == HL_DSF_DARK)
        return 0;
    if (p->dsf == HL_DSF_EXACT)
        return read * light;
    double ns = read * (p->dsf_bilinear ? one : 4) * light;
    if (p->dsf == HL_DSF_OFF)
        return ns;
    ns += read * 4 * pair;
    if (p->dsf_bilinear)
        ns += (double)c->rejecting * 4 * light;
    double untaken = (double)caps->cost.untaken;
    if (p->fill == HL_FILL_NEAREST)
        ns += ((1 - untaken) * (double)c->lost + untaken * read) *
              (16 * pair + light);
    return ns;
}

static double samples_ns(const struct hl_plan *p, const struct hl_caps *caps)
{
    enum hl_format color = format_of(p, HL_ROLE_COLOR);
    double pixels = (double)p->width * p->height;
    if (p->samples <= 1)
        return 0;
    return pixels * ((p->samples - 1) *
                     (write_ns(caps, color) +
                      write_ns(caps, format_of(p, HL_ROLE_DEPTH))) +
                     p->samples * hl_fetch_ns(caps, color));
}

double hlt_weigh(const struct hlt_counts *c, const struct hl_plan *p,
                 const struct hl_caps *caps)
{
    const struct hl_cost_model *m = &caps->cost;
    double pixel = (double)m->pixel_ns;
    enum hl_format light = format_of(p, HL_ROLE_LIGHT);
    double pairs = hl_fetch_ns(caps, format_of(p, HL_ROLE_NORMAL)) +
                   hl_fetch_ns(caps, format_of(p, HL_ROLE_DSF));
    double ns = (double)c->draws * (double)m->draw_ns +
                (double)c->triangles * (double)m->vertex_ns +
                (double)c->geometry * geometry_ns(p, caps) +
                (double)c->light * (pixel + pairs) +
                (double)(c->material + c->forward + c->blended) * pixel +
                (double)c->lights * lit_ns(p, m) +
                (double)c->light_blends * hl_blend_ns(caps, light) +
                (double)(c->light - c->light_blends) * write_ns(caps, light) +
                (double)c->color_blends *
                    hl_blend_ns(caps, format_of(p, HL_ROLE_COLOR));
    ns += p->pipeline == HL_PIPELINE_INFERRED ? taps_ns(c, p, caps) : 0;
    ns += samples_ns(p, caps);
    if (p->tile_depth)
        ns += (double)p->light_width * p->light_height *
              (double)m->readback_ns + (double)m->sync_ns;
    return ns;
}
