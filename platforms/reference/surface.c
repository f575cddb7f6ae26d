/* SPDX-License-Identifier: Zlib */
/* What lies at a hit: interpolated attributes, textures, the normal, and the
 * terms of design section 4. */
#include <string.h>
#include "platforms/reference/internal.h"

struct corners {
    const struct hlr_instance *instance;
    const struct hlh_material *material;
    const struct hlh_vertex *v[3];
    struct v3 face;              /* world, outward, not unit                 */
};

static void corners_of(struct corners *out, const struct hlr_prepared *p,
                       const struct hlr_hit *hit)
{
    const struct hlr_tri *tri = hit->tri;
    out->instance = &p->instances[tri->object];
    out->material = out->instance->material;
    const struct hlh_mesh *mesh = out->instance->mesh;
    for (uint32_t k = 0; k < 3; k++)
        out->v[k] = &mesh->vertices[mesh->indices[3 * tri->prim + k]];
    out->face = cross3(sub3(tri->p[1], tri->p[0]), sub3(tri->p[2], tri->p[0]));
    if (tri->mirrored)
        out->face = mul3(out->face, -1);
}

static double mixed(const double b[3], float p, float q, float r)
{
    return b[0] * (double)p + b[1] * (double)q + b[2] * (double)r;
}

/* How the weights of corners 1 and 2 change while the ray turns by `turn`
 * and stays on the triangle's plane. */
static void weight_change(double out[2], const struct hlr_ray *ray,
                          const struct hlr_hit *hit, struct v3 turn)
{
    const struct v3 *p = hit->tri->p;
    struct v3 e1 = sub3(p[1], p[0]), e2 = sub3(p[2], p[0]);
    struct v3 n = cross3(e1, e2);
    double dt = -hit->t * dot3(n, turn) / dot3(n, ray->d);
    struct v3 dp = add3(mul3(turn, hit->t), mul3(ray->d, dt));
    out[0] = dot3(cross3(dp, e2), n) / dot3(n, n);
    out[1] = dot3(cross3(e1, dp), n) / dot3(n, n);
}

static void uv_of(struct hlr_uv *out, const struct corners *c,
                  const struct hlr_ray *ray, const struct hlr_hit *hit)
{
    const float *a = c->v[0]->uv, *b = c->v[1]->uv, *d = c->v[2]->uv;
    double x[2], y[2];
    double u1 = (double)b[0] - (double)a[0], u2 = (double)d[0] - (double)a[0];
    double v1 = (double)b[1] - (double)a[1], v2 = (double)d[1] - (double)a[1];
    weight_change(x, ray, hit, ray->ddx);
    weight_change(y, ray, hit, ray->ddy);
    out->u = mixed(hit->b, a[0], b[0], d[0]);
    out->v = mixed(hit->b, a[1], b[1], d[1]);
    out->dudx = u1 * x[0] + u2 * x[1];
    out->dvdx = v1 * x[0] + v2 * x[1];
    out->dudy = u1 * y[0] + u2 * y[1];
    out->dvdy = v1 * y[0] + v2 * y[1];
}

/* False and out untouched without a texture. */
static bool sample(double out[4], const struct hlr_prepared *p,
                   const struct hlh_texture *t, bool srgb,
                   const struct hlr_uv *uv)
{
    if (t->image < 0)
        return false;
    const struct hlr_chain *chain = &p->chains[2 * t->image + (srgb ? 0 : 1)];
    hlr_chain_sample(out, chain, &p->tables, t, uv);
    return true;
}

static void base_of(double out[4], const struct hlr_prepared *p,
                    const struct corners *c, const struct hlr_hit *hit,
                    const struct hlr_uv *uv)
{
    double texel[4] = { 1, 1, 1, 1 };
    sample(texel, p, &c->material->base_texture, true, uv);
    for (int k = 0; k < 4; k++)
        out[k] = (double)c->material->base_color[k] * texel[k] *
                 mixed(hit->b, c->v[0]->color[k], c->v[1]->color[k],
                       c->v[2]->color[k]);
}

double hlr_alpha(const struct hlr_prepared *p, const struct hlr_ray *ray,
                 const struct hlr_hit *hit)
{
    struct corners c;
    struct hlr_uv uv;
    double base[4];
    corners_of(&c, p, hit);
    uv_of(&uv, &c, ray, hit);
    base_of(base, p, &c, hit, &uv);
    return base[3];
}

static struct v3 vertex_normal(const struct corners *c, int k)
{
    struct v3 n = unit3(transform3(c->instance->normal,
                                   v3_of(c->v[k]->normal)));
    return dot3(n, n) > 0 ? n : unit3(c->face);
}

static struct hlr_tangent tangent_of(const struct corners *c,
                                     const struct hlr_hit *hit)
{
    struct hlr_tangent out = { { 0, 0, 0 }, 0 };
    const struct hlr_tangent *made = c->instance->tangents;
    for (uint32_t k = 0; k < 3; k++) {
        struct hlr_tangent t;
        if (made) {
            t = made[3 * hit->tri->prim + k];
        } else {
            t.t = v3_of(c->v[k]->tangent);
            t.w = (double)c->v[k]->tangent[3];
        }
        out.t = add3(out.t, mul3(t.t, hit->b[k]));
        out.w += hit->b[k] * t.w;
    }
    out.t = unit3(transform3(c->instance->linear, out.t));
    out.w = (out.w < 0) != c->instance->mirrored ? -1 : 1;
    return out;
}

static struct v3 mapped(const struct hlr_prepared *p, const struct corners *c,
                        const struct hlr_hit *hit, const struct hlr_uv *uv,
                        struct v3 n)
{
    const struct hlh_material *m = c->material;
    double texel[4];
    struct hlr_tangent t = tangent_of(c, hit);
    if (!(dot3(t.t, t.t) > 0))
        return n;
    if (!sample(texel, p, &m->normal_texture, false, uv))
        return n;
    double x = (2 * texel[0] - 1) * (double)m->normal_scale;
    double y = (2 * texel[1] - 1) * (double)m->normal_scale;
    double z = 2 * texel[2] - 1;
    struct v3 b = mul3(cross3(n, t.t), t.w);
    struct v3 out = unit3(add3(add3(mul3(t.t, x), mul3(b, y)), mul3(n, z)));
    return dot3(out, out) > 0 ? out : n;
}

static struct v3 normal_of(const struct hlr_prepared *p,
                           const struct corners *c, const struct hlr_hit *hit,
                           const struct hlr_uv *uv, bool normal_maps)
{
    struct v3 n = unit3(mix3(hit->b, vertex_normal(c, 0), vertex_normal(c, 1),
                             vertex_normal(c, 2)));
    if (!(dot3(n, n) > 0))
        n = unit3(c->face);
    if (normal_maps && c->material->normal_texture.image >= 0)
        n = mapped(p, c, hit, uv, n);
    return hit->back ? mul3(n, -1) : n;
}

static void terms_of(struct hlr_surface *out, const struct hlr_prepared *p,
                     const struct corners *c, const double base[4])
{
    const struct hlh_material *m = c->material;
    double mr[4] = { 1, 1, 1, 1 }, glow[4] = { 1, 1, 1, 1 };
    sample(mr, p, &m->metal_rough_texture, false, &out->uv);
    sample(glow, p, &m->emission_texture, true, &out->uv);
    double roughness = (double)m->roughness * mr[1];
    double metallic = (double)m->metallic * mr[2];
    double alpha = roughness > 0.089 ? roughness * roughness : 0.089 * 0.089;
    out->exponent = clamp(2 / (alpha * alpha) - 2, 1, 256);
    for (int k = 0; k < 3; k++) {
        double f0 = 0.04 + (base[k] - 0.04) * metallic;
        out->rho[k] = base[k] * (1 - metallic);
        out->ks[k] = f0 * (out->exponent + 8) / 8;
        out->emission[k] = (double)m->emission[k] * glow[k];
    }
}

void hlr_surface(struct hlr_surface *out, const struct hlr_prepared *p,
                 const struct hlr_ray *ray, const struct hlr_hit *hit,
                 const struct hlr_options *options)
{
    struct corners c;
    double base[4];
    corners_of(&c, p, hit);
    memset(out, 0, sizeof *out);
    uv_of(&out->uv, &c, ray, hit);
    base_of(base, p, &c, hit, &out->uv);
    out->alpha = hlr_is_blended(c.material) ? base[3] : 1;
    out->brdf = c.material->brdf;
    out->tri = hit->tri;
    out->position = mix3(hit->b, hit->tri->p[0], hit->tri->p[1],
                         hit->tri->p[2]);
    out->normal = normal_of(p, &c, hit, &out->uv, options->normal_maps);
    if (c.material->base_texture.image >= 0)
        out->lambda = hlr_chain_lambda(
            &p->chains[2 * c.material->base_texture.image], &out->uv);
    terms_of(out, p, &c, base);
    if (options->no_specular)
        memset(out->ks, 0, sizeof out->ks);
}
