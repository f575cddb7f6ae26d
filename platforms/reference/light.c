/* SPDX-License-Identifier: Zlib */
/* Lights: attenuation (design section 4), the tree of their spheres, and the
 * two sums D and S at a point. */
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/internal.h"

static bool can_light(const struct hlh_light *l)
{
    if (l->kind != HLH_LIGHT_DIRECTIONAL && !(l->radius > 0))
        return false;
    return l->color[0] != 0 || l->color[1] != 0 || l->color[2] != 0;
}

static struct hlr_light light_of(const struct hlh_light *l)
{
    struct hlr_light out = { .kind = l->kind, .falloff = l->falloff,
                             .shadow = l->shadow };
    double r = (double)l->radius;
    double inner = cos((double)l->inner_angle);
    double outer = cos((double)l->outer_angle);
    out.position = v3_of(l->position);
    out.axis = unit3(v3_of(l->direction));
    out.radius2 = r * r;
    out.cone_scale = 1 / (inner - outer > 0.001 ? inner - outer : 0.001);
    out.cone_offset = -outer * out.cone_scale;
    for (int k = 0; k < 3; k++)
        out.color[k] = (double)l->color[k];
    return out;
}

/* Boxes a little larger than the spheres: a light that the tree leaves out
 * must be one whose attenuation is 0 after every rounding. */
static struct hlr_box sphere_box(const struct hlh_light *l)
{
    struct hlr_box box;
    double r = (double)l->radius;
    for (int k = 0; k < 3; k++) {
        double c = (double)l->position[k];
        double pad = 1e-12 * (fabs(c) + r);
        box.lo[k] = c - r - pad;
        box.hi[k] = c + r + pad;
    }
    return box;
}

bool hlr_lights_make(struct hlr_lights *out, const struct hlh_scene *scene)
{
    size_t n = (size_t)scene->n_lights + 1;
    memset(out, 0, sizeof *out);
    struct hlr_box *boxes = calloc(n, sizeof *boxes);
    out->light = calloc(n, sizeof *out->light);
    out->local = calloc(n, sizeof *out->local);
    out->always = calloc(n, sizeof *out->always);
    bool ok = boxes && out->light && out->local && out->always;
    for (uint32_t i = 0; ok && i < scene->n_lights; i++) {
        const struct hlh_light *l = &scene->lights[i];
        if (!can_light(l))
            continue;
        if (l->kind == HLH_LIGHT_DIRECTIONAL) {
            out->always[out->n_always++] = out->n;
        } else {
            boxes[out->n_local] = sphere_box(l);
            out->local[out->n_local++] = out->n;
        }
        out->light[out->n++] = light_of(l);
    }
    ok = ok && hlr_bvh_build(&out->tree, boxes, out->n_local);
    free(boxes);
    if (!ok)
        hlr_lights_free(out);
    return ok;
}

void hlr_lights_free(struct hlr_lights *lights)
{
    free(lights->light);
    free(lights->local);
    free(lights->always);
    hlr_bvh_free(&lights->tree);
    memset(lights, 0, sizeof *lights);
}

/* a of section 4, and L. 0 for a light at the point itself. */
static double attenuation(struct v3 *l, const struct hlr_light *light,
                          struct v3 at)
{
    if (light->kind == HLH_LIGHT_DIRECTIONAL) {
        *l = mul3(light->axis, -1);
        return 1;
    }
    struct v3 to = sub3(light->position, at);
    double d2 = dot3(to, to);
    if (d2 >= light->radius2 || d2 == 0)
        return 0;
    *l = mul3(to, 1 / sqrt(d2));
    double q = d2 / light->radius2, a;
    if (light->falloff == HLH_FALLOFF_SMOOTH)
        a = (1 - q) * (1 - q);
    else
        a = (1 - q * q) / (d2 > 0.01 * 0.01 ? d2 : 0.01 * 0.01);
    if (light->kind == HLH_LIGHT_SPOT) {
        double cone = clamp(-dot3(*l, light->axis) * light->cone_scale +
                            light->cone_offset, 0, 1);
        a *= cone * cone;
    }
    return a;
}

struct point {
    const struct hlr_prepared *p;
    const struct hlr_surface *s;
    const struct hlr_options *o;
    struct v3 view;
};

static bool shadowed(const struct point *at, const struct hlr_light *light,
                     struct v3 l)
{
    bool endless = light->kind == HLH_LIGHT_DIRECTIONAL;
    struct v3 to = endless ? l : sub3(light->position, at->s->position);
    return at->o->shadows && light->shadow &&
           hlr_hidden(at->p, at->s->position, to, endless, at->s->tri,
                      at->o->brute_force);
}

static double smoothstep(double x)
{
    double t = clamp(x, 0, 1);
    return t * t * (3 - 2 * t);
}

/* N.L, or of skin lambSkinDusk (Engel, "Light Pre-Pass", appendix) with a
 * roll-off of 0.2: light that entered beside the terminator is added. */
static double diffuse_weight(enum hlh_brdf brdf, double nl)
{
    double lambert = nl > 0 ? nl : 0;
    if (brdf != HLH_BRDF_SKIN)
        return lambert;
    double more = smoothstep((nl + 0.2) / 1.2) - smoothstep(nl);
    return lambert + (more > 0 ? more : 0);
}

static void add_light(struct hlr_light_sum *sum, const struct hlr_light *light,
                      const struct point *at)
{
    const struct hlr_surface *s = at->s;
    struct v3 l;
    double a = attenuation(&l, light, s->position);
    if (!(a > 0))
        return;
    sum->n++;
    double nl = dot3(s->normal, l);
    double weight = diffuse_weight(s->brdf, nl);
    if (!(weight > 0) || shadowed(at, light, l))
        return;
    double nh = dot3(s->normal, unit3(add3(l, at->view)));
    double glint = nl > 0 && nh > 0 ? nl * pow(nh, s->exponent) : 0;
    for (int k = 0; k < 3; k++) {
        double e = light->color[k] * a;
        sum->d[k] += e * weight;
        sum->s[k] += e * glint;
    }
}

static bool holds(const struct hlr_box *b, struct v3 p)
{
    return p.x >= b->lo[0] && p.x <= b->hi[0] && p.y >= b->lo[1] &&
           p.y <= b->hi[1] && p.z >= b->lo[2] && p.z <= b->hi[2];
}

static void reach(uint64_t *reached, const struct hlr_lights *lights,
                  struct v3 p)
{
    uint32_t stack[HLR_BVH_STACK], n = 0;
    if (lights->tree.n_nodes)
        stack[n++] = 0;
    while (n > 0) {
        const struct hlr_node *node = &lights->tree.nodes[stack[--n]];
        if (!holds(&node->box, p))
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            uint32_t l = lights->local[lights->tree.order[node->first + i]];
            reached[l / 64] |= UINT64_C(1) << l % 64;
        }
        if (!node->count) {
            stack[n++] = node->first;
            stack[n++] = node->first + 1;
        }
    }
}

static uint32_t lowest_bit(uint64_t x)
{
    uint32_t n = 0;
    for (uint32_t half = 32; half; half /= 2)
        if (!(x & ((UINT64_C(1) << half) - 1))) {
            x >>= half;
            n += half;
        }
    return n;
}

/* The tree's lights are added in scene order, as without the tree: those that
 * it leaves out would have added nothing, so both ways give the same bits. */
void hlr_light_sum(struct hlr_light_sum *out, const struct hlr_prepared *p,
                   const struct hlr_surface *surface, struct v3 view,
                   const struct hlr_options *options,
                   struct hlr_scratch *scratch)
{
    const struct hlr_lights *lights = &p->lights;
    const struct point at = { p, surface, options, view };
    uint64_t *reached = scratch->reached;
    memset(out, 0, sizeof *out);
    if (options->brute_force) {
        for (uint32_t i = 0; i < lights->n; i++)
            add_light(out, &lights->light[i], &at);
        return;
    }
    for (uint32_t i = 0; i < lights->n_always; i++)
        reached[lights->always[i] / 64] |=
            UINT64_C(1) << lights->always[i] % 64;
    reach(reached, lights, surface->position);
    for (uint32_t w = 0; w < (lights->n + 63) / 64; w++) {
        for (uint64_t bits = reached[w]; bits; bits &= bits - 1) {
            uint32_t i = w * 64 + lowest_bit(bits);
            add_light(out, &lights->light[i], &at);
        }
        reached[w] = 0;
    }
}
