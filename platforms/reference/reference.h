/* SPDX-License-Identifier: Zlib */
#ifndef HLR_REFERENCE_H
#define HLR_REFERENCE_H
/* The reference renderer: what a pixel of a scene is, by design section 4
 * read literally. Forward, in double precision, by casting one ray a sample;
 * nothing is quantised, batched or packed. It shares no code with core/ or
 * shaders/shared/, so that an error there cannot hide here.
 *
 * Where section 4 leaves room, this file decides:
 * - Camera: scene->camera, with aspect = width / height (camera.aspect is the
 *   file's wish and is not read). An up that is zero or parallel to the view
 *   becomes y, or -z when looking straight up or down.
 * - A sample that lies exactly on an edge shared by two triangles hits one of
 *   them. Equal depths: of opaque surfaces the first in scene order stays, of
 *   blended ones the later lies on top. A blended surface at the depth of an
 *   opaque one is hidden.
 * - Texture detail: lambda = log2 of the longer of the two texel-space
 *   footprint vectors of one pixel (the Vulkan formula), from the derivatives
 *   of the sample's own plane, whatever the number of samples.
 * - Mip levels: size max(1, floor(size / 2)); each texel is the average, by
 *   area and in linear light, of the texels of the level above that it
 *   covers; stored in 8 bits of the texture's own encoding, next made from
 *   what was stored. Alpha is averaged on its own.
 * - Tangents of a mesh without any: for each set of bit-equal vertices
 *   (position, normal, uv) and handedness, the sum over its triangles' corners
 *   of dP/du, projected off the normal and made unit, times the corner angle.
 *   glTF's v runs down and its green up, so w = +1 where the uv winding is
 *   opposite to the triangle's. T = the world matrix times the tangent,
 *   interpolated, then made unit; B = cross(N, T) w, turned over under a
 *   mirrored node, so that a mirrored bump is the mirror image of the bump.
 *   Where T vanishes, the interpolated normal stays.
 * - A directional light's radius is not read.
 * - Fences (hlh_material.fence) and decals are blended surfaces. A decal's
 *   normal is that of its own layer, not mixed into the one below.
 * - Shadows (options.shadows, lights with hlh_light.shadow): from each point
 *   one ray to the light; what is opaque, or masked (a fence too) and there by
 *   its alpha test (the texture's level 0), hides it from either side; what is
 *   blended, a decal or a no_shadow object does not. The triangle that the
 *   point lies on never does, nor what is nearer than 1e-7 of the largest of
 *   the point's coordinates: less than a float's step, so that a closed
 *   body's other faces count right up to their edges.
 * - HLH_BRDF_SKIN: in the diffuse term alone max(N.L, 0) becomes that plus
 *   max(0, smoothstep(-0.2, 1, N.L) - smoothstep(0, 1, N.L)).
 *
 * The same input gives the same bits for any number of threads. */
#include <stdbool.h>
#include <stdint.h>
#include "platforms/host/scene.h"

struct hlr_options {
    uint32_t width, height;      /* pixels, 1..65536; no default             */
    uint32_t samples;            /* 1, 2, 4 or 8 at the standard positions of
                                  * Vulkan and Direct3D; 0 = 1               */
    uint32_t grid;               /* n: n x n samples a pixel on a regular grid
                                  * in place of `samples`, up to 64; 0 = off */
    uint32_t threads;            /* at most 256; 0 = the processors online   */
    bool normal_maps;            /* false = as --no-normal-maps              */
    bool no_specular;            /* ks = 0 everywhere, as --no-specular      */
    bool ids_of_blended;         /* ids name the first surface of any kind;
                                  * false = the first that writes depth      */
    bool shadows;                /* lights with hlh_light.shadow cast them   */
    bool brute_force;            /* try every triangle and every light, for
                                  * the test of the trees: the same picture  */
    double near, far;            /* view depth that is drawn; 0 = no limit   */
    double jitter[2];            /* pixels that the picture moves right and
                                  * down, finite                             */
    /* Called now and then with the part done, 0..1, from any worker thread
     * but never from two at once; NULL = none. */
    void (*progress)(double fraction, void *user);
    void *user;
};

struct hlr_stats {
    double prepare_seconds, draw_seconds; /* wall                            */
    uint32_t threads;            /* that worked                              */
    uint64_t triangles;          /* in world space, all objects              */
    uint64_t samples;            /* rays cast for colour                     */
    uint64_t surfaces;           /* shaded: opaque hits and blended layers   */
    uint64_t light_evaluations;  /* lights of attenuation > 0 over surfaces  */
};

/* What one ray found. Everything is zero when nothing but background was
 * hit; colour is then the background. Terms are those of the nearest surface
 * that draws, blended or not; colour is the finished sample. */
struct hlr_probe {
    uint32_t id;                 /* 1 + object index, 0 = background         */
    uint32_t triangle;           /* in the object's mesh                     */
    uint32_t layers;             /* blended surfaces in front                */
    uint32_t lights;             /* of attenuation > 0                       */
    bool back_face;
    double depth;                /* along the view axis, metres              */
    double position[3];          /* world                                    */
    double normal[3];            /* world, as shaded: mapped, turned over    */
    double uv[2], lambda;        /* of the base texture's size; 0 without    */
    double alpha;                /* 1 when opaque or masked                  */
    double rho[3], ks[3], exponent, emission[3];
    double diffuse[3], specular[3]; /* D and S of section 4                  */
    double color[3];
};

/* A scene made ready: world triangles, trees, mip levels, tangents. Borrows
 * the scene, which must outlive it; the camera, ambient and background are
 * read when drawing and may change between, the rest may not. */
struct hlr_prepared;

/* NULL when memory is short or the scene holds what section 4 refuses (a
 * negative or non-finite light, an index out of range): *why, if given, is
 * then a static string. */
struct hlr_prepared *hlr_prepare(const struct hlh_scene *scene,
                                 const char **why);
void hlr_prepared_free(struct hlr_prepared *prepared);

/* Draw into rgb_out, width * height * 3 floats, linear, rows top to bottom,
 * and ids_out, width * height, or NULL: what the ray through the pixel's
 * centre meets, 1 + object index, 0 = background. False when the options are
 * out of range or memory is short; the outputs are then undefined. Safe to
 * call from several threads at once on one prepared scene. */
bool hlr_draw(float *rgb_out, uint32_t *ids_out,
              const struct hlr_prepared *prepared,
              const struct hlr_options *options, struct hlr_stats *stats);

/* Cast the one ray through (x, y) in pixels, centres at half integers; of the
 * options only width, height, normal_maps, no_specular, shadows, near, far,
 * jitter and brute_force count. False as hlr_draw. */
bool hlr_probe(struct hlr_probe *out, const struct hlr_prepared *prepared,
               const struct hlr_options *options, double x, double y);

/* Prepare, draw and free in one call. */
bool hlr_render(float *rgb_out, uint32_t *ids_out,
                const struct hlh_scene *scene,
                const struct hlr_options *options, struct hlr_stats *stats);
#endif
