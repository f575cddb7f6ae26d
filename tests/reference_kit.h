/* SPDX-License-Identifier: Zlib */
#ifndef REFERENCE_KIT_H
#define REFERENCE_KIT_H
/* Small scenes in code, for the tests of the reference renderer. The camera
 * stands at (0, 0, 5), looks at the origin and sees 90 degrees, so that the
 * plane z = 0 shows x and y from -5 to 5 on a square image. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include "platforms/reference/reference.h"

enum { KIT_SIZE = 64, KIT_MESHES = 24, KIT_LIGHTS = 256 };

struct kit {
    struct hlh_scene scene;
    struct hlh_image images[4];
    struct hlh_material materials[16];
    struct hlh_mesh meshes[KIT_MESHES];
    struct hlh_object objects[KIT_MESHES];
    struct hlh_light lights[KIT_LIGHTS];
    struct hlr_options options;  /* KIT_SIZE squared, one sample             */
};

void kit_make(struct kit *k);
void kit_free(struct kit *k);
/* Black, rough, not metal, opaque, one-sided, no texture. */
struct hlh_material *kit_material(struct kit *k);
/* Vertices at 0, normal +z, white, no uv; an object at the origin is added. */
struct hlh_mesh *kit_mesh(struct kit *k, uint32_t n_vertices,
                          uint32_t n_indices);
/* x and y from -half to half at z, facing +z; uv 0..1, v down. */
struct hlh_mesh *kit_quad(struct kit *k, float half, float z);
/* Smooth, white, at the origin, pointing down -z, radius 1. */
struct hlh_light *kit_light(struct kit *k, enum hlh_light_kind kind);
/* Copies; returns the image's index. */
int32_t kit_image(struct kit *k, uint32_t width, uint32_t height,
                  const uint8_t *rgba);
/* The ray through (x, y, 0). */
struct hlr_probe kit_probe(const struct kit *k, double x, double y);
/* Pixels of a drawing by k->options, from malloc; ids may be NULL. */
float *kit_draw(const struct kit *k, uint32_t **ids);

/* |a - b| <= tolerance, or fail with both. */
void check_near(double a, double b, double tolerance, const char *what);
void check_near3(const double a[3], double x, double y, double z,
                 double tolerance, const char *what);

/* 0..1, the same on every machine (xorshift, Marsaglia 2003). */
double kit_random(uint32_t *state);
#endif
