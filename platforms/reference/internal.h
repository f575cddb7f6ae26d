/* SPDX-License-Identifier: Zlib */
#ifndef HLR_INTERNAL_H
#define HLR_INTERNAL_H
/* What the files of the reference renderer share: double vectors, the world
 * triangles, the trees and the prepared scene. Reading order: bvh.c, ray.c,
 * texture.c, tangent.c, light.c, surface.c, prepare.c, reference.c. */
#include <math.h>
#include "platforms/reference/reference.h"

struct v3 { double x, y, z; };

static inline struct v3 v3(double x, double y, double z)
{
    return (struct v3){ x, y, z };
}
static inline struct v3 v3_of(const float f[3])
{
    return v3((double)f[0], (double)f[1], (double)f[2]);
}
static inline struct v3 add3(struct v3 a, struct v3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct v3 sub3(struct v3 a, struct v3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct v3 mul3(struct v3 a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}
static inline double dot3(struct v3 a, struct v3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct v3 cross3(struct v3 a, struct v3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
              a.x * b.y - a.y * b.x);
}
/* Zero stays zero: the caller decides what stands in for it. */
static inline struct v3 unit3(struct v3 a)
{
    double n = sqrt(dot3(a, a));
    return n > 0 ? mul3(a, 1 / n) : v3(0, 0, 0);
}
static inline struct v3 mix3(const double b[3], struct v3 p, struct v3 q,
                             struct v3 r)
{
    return v3(b[0] * p.x + b[1] * q.x + b[2] * r.x,
              b[0] * p.y + b[1] * q.y + b[2] * r.y,
              b[0] * p.z + b[1] * q.z + b[2] * r.z);
}
static inline double clamp(double x, double lo, double hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* A tree of boxes over any things that have one (bvh.c). */
struct hlr_box { double lo[3], hi[3]; };
struct hlr_node {
    struct hlr_box box;
    uint32_t first;              /* leaf: into order; else the left child,
                                  * the right one follows it                 */
    uint32_t count;              /* things in a leaf, 0 = inner              */
};
struct hlr_bvh {
    struct hlr_node *nodes;      /* nodes[0] is the root                     */
    uint32_t *order;             /* things, leaf by leaf                     */
    uint32_t n_nodes;            /* 0 = nothing in it                        */
};
enum { HLR_BVH_STACK = 128 };    /* deeper than any tree that bvh.c builds   */

bool hlr_bvh_build(struct hlr_bvh *out, const struct hlr_box *boxes,
                   uint32_t n);
void hlr_bvh_free(struct hlr_bvh *bvh);

/* One triangle in world space, kept in the order of the tree's leaves. */
struct hlr_tri {
    struct v3 p[3];
    uint32_t index;              /* in scene order: decides equal depths     */
    uint32_t object;
    uint32_t prim;               /* triangle of the object's mesh            */
    bool mirrored;               /* its front is clockwise                   */
};

/* A ray with the constants of its sheared space (Woop, Benthin, Wald 2013,
 * "Watertight Ray/Triangle Intersection"). d has length 1 along the view
 * axis, so a ray parameter is a view depth. */
struct hlr_ray {
    struct v3 o, d;
    struct v3 ddx, ddy;          /* of d, a pixel to the right and down      */
    double o_[3], d_[3], inv[3]; /* as arrays; inv is never infinite         */
    int kx, ky, kz;
    double sx, sy, sz;
    double near, far;
};

struct hlr_hit {
    double t, b[3];              /* depth, weights of the three corners      */
    const struct hlr_tri *tri;   /* NULL = nothing                           */
    bool back;
};

struct hlr_camera {
    struct v3 eye, corner, right, down; /* d = corner + x right + y down     */
    double near, far;
};

/* The mip levels of one image in one encoding (texture.c). */
struct hlr_level { uint32_t width, height; const uint8_t *rgba; };
struct hlr_chain {
    struct hlr_level level[32];
    uint32_t n_levels;           /* 0 = not used by the scene                */
    uint8_t *store;              /* levels 1 and up; level 0 is the image's  */
    bool srgb;
};
struct hlr_tables { double srgb[256], unorm[256], step[255]; };
struct hlr_uv { double u, v, dudx, dvdx, dudy, dvdy; };

void hlr_tables_make(struct hlr_tables *out);
bool hlr_chain_build(struct hlr_chain *out, const struct hlh_image *image,
                     bool srgb, const struct hlr_tables *tables);
void hlr_chain_free(struct hlr_chain *chain);
double hlr_chain_lambda(const struct hlr_chain *chain,
                        const struct hlr_uv *uv);
void hlr_chain_sample(double out[4], const struct hlr_chain *chain,
                      const struct hlr_tables *tables,
                      const struct hlh_texture *wrap,
                      const struct hlr_uv *uv);

/* A tangent a corner of a mesh, 3 a triangle, in object space (tangent.c). */
struct hlr_tangent { struct v3 t; double w; };
bool hlr_tangents_make(struct hlr_tangent **out, const struct hlh_mesh *mesh);

struct hlr_light {
    struct v3 position, axis;
    double color[3];
    double radius2;
    double cone_scale, cone_offset;
    bool shadow;
    enum hlh_light_kind kind;
    enum hlh_falloff falloff;
};
struct hlr_lights {
    struct hlr_light *light;     /* in scene order, those that can light     */
    uint32_t n;
    uint32_t *local;             /* tree thing -> light: point and spot      */
    uint32_t *always;            /* directional                              */
    uint32_t n_local, n_always;
    struct hlr_bvh tree;
};
bool hlr_lights_make(struct hlr_lights *out, const struct hlh_scene *scene);
void hlr_lights_free(struct hlr_lights *lights);

/* One object's transform: points by `linear` and `origin`, normals by
 * `normal` (the cofactors with the determinant's sign: a positive multiple of
 * the inverse transpose that exists for flat scales too). */
struct hlr_instance {
    const struct hlh_mesh *mesh;
    const struct hlh_material *material;
    const struct hlr_tangent *tangents; /* NULL = the vertices' own          */
    struct v3 linear[3], normal[3];     /* columns                           */
    struct v3 origin;
    bool mirrored;
};

struct hlr_prepared {
    const struct hlh_scene *scene;
    struct hlr_tables tables;
    struct hlr_chain *chains;    /* 2 an image: sRGB, then linear            */
    struct hlr_tangent **tangents; /* one a mesh, NULL where none were made  */
    struct hlr_instance *instances; /* one an object                         */
    struct hlr_tri *tris;
    uint32_t n_tris;
    struct hlr_bvh tree;
    struct hlr_lights lights;
    double seconds;
};

/* Drawn over what is behind it, without depth. */
static inline bool hlr_is_blended(const struct hlh_material *m)
{
    return m->alpha == HLH_ALPHA_BLEND || m->fence || m->decal;
}

static inline struct v3 transform3(const struct v3 m[3], struct v3 p)
{
    return add3(add3(mul3(m[0], p.x), mul3(m[1], p.y)), mul3(m[2], p.z));
}

/* What one thread needs at hand; grows, never shrinks. */
struct hlr_scratch {
    uint64_t *reached;           /* one bit a light, clear between uses      */
    struct hlr_hit *layers;
    uint32_t n_layers, cap_layers;
    bool failed;                 /* memory ran out                           */
    uint64_t samples, surfaces, light_evaluations;
};
double hlr_now(void);            /* seconds, for the statistics only         */

bool hlr_camera_make(struct hlr_camera *out, const struct hlh_camera *camera,
                     const struct hlr_options *options);
/* Fill what follows from o, d. */
void hlr_ray_shear(struct hlr_ray *ray);
/* Whether anything that casts shadows is between `from`, a point of the
 * triangle `own`, and `from + to`. d is finite and not zero; `endless`: as
 * far as anything is (ray.c). */
bool hlr_hidden(const struct hlr_prepared *p, struct v3 from, struct v3 to,
                bool endless, const struct hlr_tri *own, bool brute);
void hlr_camera_ray(struct hlr_ray *out, const struct hlr_camera *camera,
                    double x, double y);

/* The nearest surface that writes depth; the blended ones before it are put
 * into scratch->layers, nearest first (ray.c). */
void hlr_trace(struct hlr_hit *out, const struct hlr_prepared *p,
               const struct hlr_ray *ray, bool brute,
               struct hlr_scratch *scratch);

/* Everything section 4 needs to know of one point (surface.c). */
struct hlr_surface {
    struct v3 position, normal;
    struct hlr_uv uv;
    double lambda, alpha;
    double rho[3], ks[3], emission[3], exponent;
    enum hlh_brdf brdf;
    const struct hlr_tri *tri;   /* that it lies on                          */
};
double hlr_alpha(const struct hlr_prepared *p, const struct hlr_ray *ray,
                 const struct hlr_hit *hit);
void hlr_surface(struct hlr_surface *out, const struct hlr_prepared *p,
                 const struct hlr_ray *ray, const struct hlr_hit *hit,
                 const struct hlr_options *options);

struct hlr_light_sum { double d[3], s[3]; uint32_t n; };
void hlr_light_sum(struct hlr_light_sum *out, const struct hlr_prepared *p,
                   const struct hlr_surface *surface, struct v3 view,
                   const struct hlr_options *options,
                   struct hlr_scratch *scratch);
#endif
