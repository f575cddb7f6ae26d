/* SPDX-License-Identifier: Zlib */
/* Camera rays, the ray-triangle test, and the walk through the tree. */
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/internal.h"

/* Up is y, or -z when looking straight up or down (design section 4). */
static struct v3 camera_right(struct v3 forward, struct v3 up)
{
    static const double parallel = 1e-6;
    struct v3 r = cross3(forward, unit3(up));
    if (!(dot3(r, r) > parallel * parallel))
        r = cross3(forward, v3(0, 1, 0));
    if (!(dot3(r, r) > parallel * parallel))
        r = cross3(forward, v3(0, 0, -1));
    return unit3(r);
}

bool hlr_camera_make(struct hlr_camera *out, const struct hlh_camera *camera,
                     const struct hlr_options *options)
{
    static const double radians = 3.14159265358979323846 / 180;
    double w = options->width, h = options->height;
    struct v3 eye = v3_of(camera->eye);
    struct v3 f = unit3(sub3(v3_of(camera->target), eye));
    double tangent = tan(0.5 * (double)camera->vfov * radians);
    if (!(dot3(f, f) > 0) || !(tangent > 0) || !isfinite(tangent))
        return false;
    struct v3 right = camera_right(f, v3_of(camera->up));
    struct v3 up = cross3(right, f);
    struct v3 across = mul3(right, tangent * w / h);
    out->eye = eye;
    out->right = mul3(across, 2 / w);
    out->down = mul3(up, -2 * tangent / h);
    out->corner = add3(sub3(f, across), mul3(up, tangent));
    out->corner = sub3(out->corner, add3(mul3(out->right, options->jitter[0]),
                                         mul3(out->down, options->jitter[1])));
    out->near = options->near;
    out->far = options->far > 0 ? options->far : HUGE_VAL;
    return true;
}

void hlr_camera_ray(struct hlr_ray *out, const struct hlr_camera *camera,
                    double x, double y)
{
    struct v3 d = add3(camera->corner, add3(mul3(camera->right, x),
                                            mul3(camera->down, y)));
    *out = (struct hlr_ray){ .o = camera->eye, .d = d,
        .ddx = camera->right, .ddy = camera->down,
        .o_ = { camera->eye.x, camera->eye.y, camera->eye.z },
        .d_ = { d.x, d.y, d.z },
        .near = camera->near, .far = camera->far };
    hlr_ray_shear(out);
}

void hlr_ray_shear(struct hlr_ray *out)
{
    /* 1e-200 for 0: 0 times its inverse is 0, where 0 times Inf is NaN. */
    for (int k = 0; k < 3; k++) {
        out->inv[k] = 1 / (fabs(out->d_[k]) > 1e-200 ? out->d_[k] : 1e-200);
        if (fabs(out->d_[k]) > fabs(out->d_[out->kz]))
            out->kz = k;
    }
    out->kx = (out->kz + 1) % 3;
    out->ky = (out->kz + 2) % 3;
    /* Swapped for a ray that runs backwards, so that winding keeps its sign. */
    if (out->d_[out->kz] < 0) {
        int k = out->kx;
        out->kx = out->ky;
        out->ky = k;
    }
    out->sz = 1 / out->d_[out->kz];
    out->sx = out->d_[out->kx] * out->sz;
    out->sy = out->d_[out->ky] * out->sz;
}

struct sheared { double x, y, z; };

static struct sheared shear(const struct hlr_ray *r, const struct v3 *p)
{
    double q[3] = { p->x - r->o_[0], p->y - r->o_[1], p->z - r->o_[2] };
    double z = q[r->kz];
    return (struct sheared){ q[r->kx] - r->sx * z, q[r->ky] - r->sy * z, z };
}

/* Twice the area of the ray's point, a and b. Exactly negated by a swap of a
 * and b (the same two products, without contraction), so two triangles that
 * run through their edge in opposite directions agree on its sides. */
static double edge(const struct sheared *a, const struct sheared *b)
{
    return a->x * b->y - a->y * b->x;
}

/* An edge through the ray belongs to the triangle that has it run this way:
 * the top-left rule, in the ray's own plane. */
static bool owns(const struct sheared *a, const struct sheared *b, double sign)
{
    double dx = sign * (b->x - a->x), dy = sign * (b->y - a->y);
    return dy > 0 || (dy == 0 && dx > 0);
}

static bool inside(double e, const struct sheared *a, const struct sheared *b,
                   double sign)
{
    return sign * e > 0 || (e == 0 && owns(a, b, sign));
}

static bool tri_hit(struct hlr_hit *out, const struct hlr_ray *ray,
                    const struct hlr_tri *tri)
{
    struct sheared a = shear(ray, &tri->p[0]), b = shear(ray, &tri->p[1]);
    struct sheared c = shear(ray, &tri->p[2]);
    double u = edge(&b, &c), v = edge(&c, &a), w = edge(&a, &b);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
        return false;
    double det = u + v + w;
    if (det == 0)
        return false;
    double sign = det < 0 ? -1 : 1;
    if (!inside(u, &b, &c, sign) || !inside(v, &c, &a, sign) ||
        !inside(w, &a, &b, sign))
        return false;
    out->b[0] = u / det;
    out->b[1] = v / det;
    out->b[2] = w / det;
    out->t = (out->b[0] * a.z + out->b[1] * b.z + out->b[2] * c.z) * ray->sz;
    out->tri = tri;
    /* Seen along the ray, a counter-clockwise front has a negative area. */
    out->back = (det > 0) != tri->mirrored;
    return out->t > 0 && out->t >= ray->near && out->t <= ray->far;
}

static void push_layer(struct hlr_scratch *s, const struct hlr_hit *hit)
{
    if (s->n_layers == s->cap_layers) {
        uint32_t cap = s->cap_layers ? 2 * s->cap_layers : 64;
        void *grown = realloc(s->layers, cap * sizeof *s->layers);
        if (!grown) {
            s->failed = true;
            return;
        }
        s->layers = grown;
        s->cap_layers = cap;
    }
    s->layers[s->n_layers++] = *hit;
}

static void try_tri(struct hlr_hit *best, const struct hlr_prepared *p,
                    const struct hlr_ray *ray, const struct hlr_tri *tri,
                    struct hlr_scratch *scratch)
{
    struct hlr_hit hit;
    if (!tri_hit(&hit, ray, tri) || hit.t > best->t)
        return;
    const struct hlh_material *m = p->instances[tri->object].material;
    if (hit.back && !m->double_sided)
        return;
    if (hlr_is_blended(m)) {
        push_layer(scratch, &hit);
        return;
    }
    if (hit.t == best->t && best->tri && tri->index > best->tri->index)
        return;
    if (m->alpha == HLH_ALPHA_MASK &&
        !(hlr_alpha(p, ray, &hit) >= (double)m->alpha_cutoff))
        return;
    *best = hit;
}

/* Entry depth, or HUGE_VAL for a miss. Both ends give by 1e-12 of the depth:
 * thousands of times what the three roundings here and in tri_hit can make,
 * so no box hides a triangle that a search of all would find. */
static double box_entry(const struct hlr_ray *ray, const struct hlr_box *box)
{
    double in = 0, out = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        double a = (box->lo[k] - ray->o_[k]) * ray->inv[k];
        double b = (box->hi[k] - ray->o_[k]) * ray->inv[k];
        double lo = a < b ? a : b, hi = a < b ? b : a;
        in = lo > in ? lo : in;
        out = hi < out ? hi : out;
    }
    in *= 1 - 1e-12;
    return in <= out * (1 + 1e-12) ? in : HUGE_VAL;
}

static void walk(struct hlr_hit *best, const struct hlr_prepared *p,
                 const struct hlr_ray *ray, struct hlr_scratch *scratch)
{
    struct { uint32_t node; double in; } stack[HLR_BVH_STACK];
    const struct hlr_node *nodes = p->tree.nodes;
    uint32_t n = 1;
    stack[0].node = 0;
    stack[0].in = box_entry(ray, &nodes[0].box);
    while (n > 0) {
        n--;
        if (!(stack[n].in <= best->t) || stack[n].in == HUGE_VAL)
            continue;
        const struct hlr_node *node = &nodes[stack[n].node];
        for (uint32_t i = 0; i < node->count; i++)
            try_tri(best, p, ray, &p->tris[node->first + i], scratch);
        if (node->count)
            continue;
        double l = box_entry(ray, &nodes[node->first].box);
        double r = box_entry(ray, &nodes[node->first + 1].box);
        uint32_t near = l <= r ? 0u : 1u;
        stack[n].node = node->first + 1 - near;
        stack[n++].in = near ? l : r;
        stack[n].node = node->first + near;
        stack[n++].in = near ? r : l;
    }
}

static int nearer(const void *a, const void *b)
{
    const struct hlr_hit *p = a, *q = b;
    if (p->t != q->t)
        return p->t < q->t ? -1 : 1;
    return p->tri->index > q->tri->index ? -1 : 1;
}

/* ---- shadows ------------------------------------------------------------ */

static bool hides(const struct hlr_prepared *p, const struct hlr_ray *ray,
                  const struct hlr_tri *tri, const struct hlr_tri *own)
{
    struct hlr_hit hit;
    const struct hlh_material *m = p->instances[tri->object].material;
    if (tri == own || m->alpha == HLH_ALPHA_BLEND || m->decal ||
        p->scene->objects[tri->object].no_shadow || !tri_hit(&hit, ray, tri))
        return false;
    return m->alpha != HLH_ALPHA_MASK ||
           hlr_alpha(p, ray, &hit) >= (double)m->alpha_cutoff;
}

static bool walk_hidden(const struct hlr_prepared *p,
                        const struct hlr_ray *ray, const struct hlr_tri *own)
{
    uint32_t stack[HLR_BVH_STACK], n = 0;
    if (p->tree.n_nodes)
        stack[n++] = 0;
    while (n > 0) {
        const struct hlr_node *node = &p->tree.nodes[stack[--n]];
        if (!(box_entry(ray, &node->box) <= ray->far))
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            if (hides(p, ray, &p->tris[node->first + i], own))
                return true;
        if (!node->count) {
            stack[n++] = node->first;
            stack[n++] = node->first + 1;
        }
    }
    return false;
}

/* d is made unit, so that near is metres. No change of d with the pixel:
 * masks are sampled at level 0. */
bool hlr_hidden(const struct hlr_prepared *p, struct v3 from, struct v3 to,
                bool endless, const struct hlr_tri *own, bool brute)
{
    double distance = sqrt(dot3(to, to));
    double most = fmax(fabs(from.x), fmax(fabs(from.y), fabs(from.z)));
    struct v3 d = mul3(to, 1 / distance);
    struct hlr_ray ray = { .o = from, .d = d,
        .o_ = { from.x, from.y, from.z }, .d_ = { d.x, d.y, d.z },
        .near = 1e-7 * most, .far = endless ? DBL_MAX : distance };
    hlr_ray_shear(&ray);
    if (!brute)
        return walk_hidden(p, &ray, own);
    for (uint32_t i = 0; i < p->n_tris; i++)
        if (hides(p, &ray, &p->tris[i], own))
            return true;
    return false;
}

void hlr_trace(struct hlr_hit *out, const struct hlr_prepared *p,
               const struct hlr_ray *ray, bool brute,
               struct hlr_scratch *scratch)
{
    memset(out, 0, sizeof *out);
    out->t = HUGE_VAL;
    scratch->n_layers = 0;
    if (brute)
        for (uint32_t i = 0; i < p->n_tris; i++)
            try_tri(out, p, ray, &p->tris[i], scratch);
    else if (p->tree.n_nodes)
        walk(out, p, ray, scratch);
    uint32_t n = 0;
    for (uint32_t i = 0; i < scratch->n_layers; i++)
        if (scratch->layers[i].t < out->t)
            scratch->layers[n++] = scratch->layers[i];
    scratch->n_layers = n;
    if (n > 1)
        qsort(scratch->layers, n, sizeof *scratch->layers, nearer);
}
