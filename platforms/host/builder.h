/* SPDX-License-Identifier: Zlib */
#ifndef HLH_BUILDER_H
#define HLH_BUILDER_H
/* Scenes made by code. Only + - * / and sqrt on IEEE numbers, an integer
 * generator and a sine of our own: equal bits on every machine. Shapes are
 * appended to the mesh in hand, which hlh_build_mesh then closes. Failure
 * (memory) sticks in failed and is checked once, at the end. */
#include "platforms/host/scene.h"

struct hlh_builder {
    struct hlh_scene *scene;
    uint64_t random;
    bool failed;
    struct hlh_material no_material;  /* what is changed when memory is out  */
    struct hlh_vertex *vertices;      /* of the mesh in hand                 */
    uint32_t n_vertices;
    uint32_t *indices;
    uint32_t n_indices;
};

struct hlh_v3 {
    double x, y, z;
};

void hlh_build_begin(struct hlh_builder *b, struct hlh_scene *scene,
                     uint32_t seed);

/* Uniform in [low, high); uniform integer in 0..n-1. One call a statement: C
 * leaves the order of a call's arguments open, and compilers differ. */
double hlh_random(struct hlh_builder *b, double low, double high);
uint32_t hlh_random_below(struct hlh_builder *b, uint32_t n);
/* Sine and cosine of turns (1 = a whole circle), |error| < 1e-14. */
void hlh_sincos(double turns, double *sine, double *cosine);
/* Hue 0..1 (red, yellow, green, ..), saturation 0..1, largest channel v. */
struct hlh_v3 hlh_hue(double hue, double saturation, double v);

uint32_t hlh_build_material(struct hlh_builder *b, const char *name,
                            struct hlh_v3 color, double roughness,
                            double metallic);
/* A square image of `side` texels, each filled by texel(rgba, x, y); -1 on
 * failure. */
int32_t hlh_build_image(struct hlh_builder *b, const char *name,
                        uint32_t side,
                        void (*texel)(uint8_t *, uint32_t, uint32_t));
/* The material just built, to be changed; a scratch one on failure. */
struct hlh_material *hlh_build_last_material(struct hlh_builder *b);
/* Close the mesh in hand; its index. */
uint32_t hlh_build_mesh(struct hlh_builder *b, const char *name,
                        uint32_t material);
/* Draw a mesh: scaled, turned about y by yaw turns, moved to at. */
void hlh_build_object(struct hlh_builder *b, uint32_t mesh, struct hlh_v3 at,
                      struct hlh_v3 scale, double yaw);
void hlh_build_object_at_origin(struct hlh_builder *b, uint32_t mesh);
void hlh_build_light(struct hlh_builder *b, struct hlh_v3 at, double radius,
                     struct hlh_v3 color);
/* The same as a spot that looks to `target`; half angles in radians. */
void hlh_build_spot(struct hlh_builder *b, struct hlh_v3 at,
                    struct hlh_v3 target, double radius, double inner,
                    double outer, struct hlh_v3 color);
void hlh_build_directional(struct hlh_builder *b, struct hlh_v3 direction,
                           struct hlh_v3 color);
/* The light just built casts shadows. */
void hlh_build_shadow(struct hlh_builder *b);
/* Somewhere in the box center +- spread, any hue; the others from ranges. */
struct hlh_light_range {
    struct hlh_v3 spread;
    double radius[2], saturation[2], brightness[2];
};
void hlh_build_random_light(struct hlh_builder *b, struct hlh_v3 center,
                            const struct hlh_light_range *range);
void hlh_build_camera(struct hlh_builder *b, struct hlh_v3 eye,
                      struct hlh_v3 target, double vfov);

/* Shapes, counter-clockwise from outside. around, along, cuts: how many
 * pieces an edge or circle is cut into, at least 3 around and 1 along. */

/* Patch a, a+u, a+u+v, a+v seen from where u x v points; texture coordinates
 * are metres. */
void hlh_add_patch(struct hlh_builder *b, struct hlh_v3 a, struct hlh_v3 u,
                   struct hlh_v3 v, uint32_t cuts_u, uint32_t cuts_v);
/* Hard-edged; inward turns it into a room. */
void hlh_add_box(struct hlh_builder *b, struct hlh_v3 center,
                 struct hlh_v3 half, uint32_t cuts, bool inward);
/* Smooth: a sphere of radius round swept along a box of half extents
 * half - round. Each face has cuts x cuts cells. */
void hlh_add_rounded_box(struct hlh_builder *b, struct hlh_v3 half,
                         double round, uint32_t cuts);
void hlh_add_sphere(struct hlh_builder *b, struct hlh_v3 center, double radius,
                    uint32_t around, uint32_t along);
/* Smooth side from p to q, radii r and s there (either may be 0 for a cone),
 * hard flat caps where caps. */
void hlh_add_tube(struct hlh_builder *b, struct hlh_v3 p, struct hlh_v3 q,
                  double r, double s, uint32_t around, uint32_t along,
                  bool caps);
/* About the y axis through center. */
void hlh_add_torus(struct hlh_builder *b, struct hlh_v3 center, double radius,
                   double tube, uint32_t around, uint32_t along);

static inline struct hlh_v3 hlh_v3(double x, double y, double z)
{
    struct hlh_v3 v = {x, y, z};
    return v;
}
static inline struct hlh_v3 hlh_mad(struct hlh_v3 a, struct hlh_v3 b, double s)
{
    return hlh_v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

/* One generator a scene, one file a family. */
void hlh_build_fig1(struct hlh_builder *b);
void hlh_build_fig7(struct hlh_builder *b);
void hlh_build_fig8(struct hlh_builder *b);
void hlh_build_fig9(struct hlh_builder *b);
void hlh_build_lidr(struct hlh_builder *b);
void hlh_build_thin(struct hlh_builder *b);
void hlh_build_many(struct hlh_builder *b);
void hlh_build_blades(struct hlh_builder *b);
/* Of blades, only layer k reflects: 0 the opaque, 1 the lowest pane. */
void hlh_build_blades_0(struct hlh_builder *b);
void hlh_build_blades_1(struct hlh_builder *b);
void hlh_build_blades_2(struct hlh_builder *b);
void hlh_build_blades_3(struct hlh_builder *b);
void hlh_build_glass(struct hlh_builder *b);
void hlh_build_shadows(struct hlh_builder *b);
void hlh_build_fence(struct hlh_builder *b);
void hlh_build_decals(struct hlh_builder *b);
void hlh_build_brdfs(struct hlh_builder *b);
#endif
