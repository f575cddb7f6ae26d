/* SPDX-License-Identifier: Zlib */
#ifndef FRAME_KIT_H
#define FRAME_KIT_H
/* Small scenes in code on a device, and the renderer run on them. */
#include "tests/check.h"

enum { FK_ITEMS = 64, FK_LIGHTS = 128, FK_W = 160, FK_H = 90 };

struct fk_vertex {
    float position[3], normal[3], tangent[4], uv[2];
    uint8_t color[4];
};

/* Surfaces of the kit, by index. */
enum fk_surface {
    FK_PLAIN, FK_MIRRORED, FK_TWO_SIDED, FK_FULL, FK_MASKED, FK_BLENDED,
    FK_SURFACES
};

struct fk_scene {
    struct ck_machine *m;
    struct hl_surface surface[FK_SURFACES];
    struct hl_material material[FK_ITEMS];
    struct hl_item item[FK_ITEMS];
    struct hl_light light[FK_LIGHTS];
    struct hl_frame frame;
    struct hl_needs needs;       /* of fk_plan; set choices here             */
    hl_buf vertex, index;        /* quad, box, ball                          */
    uint32_t next_id;
};

/* An empty scene of FK_W x FK_H: camera at (0, 0, 10) looking down -z, 60
 * degrees, near 0.1, far 100. */
void fk_begin(struct fk_scene *s, struct ck_machine *m);
void fk_end(struct fk_scene *s);

enum fk_mesh { FK_QUAD, FK_BOX, FK_BALL };   /* quad: 2 x 2, facing +z; box
                                              * side 2; ball radius 1        */
/* An item with its own white rough material without specular. */
struct hl_item *fk_add(struct fk_scene *s, enum fk_mesh mesh,
                       enum fk_surface surface, float x, float y, float z,
                       float scale);
struct hl_material *fk_material(struct fk_scene *s, const struct hl_item *it);
/* A white smooth point light. */
struct hl_light *fk_light(struct fk_scene *s, float x, float y, float z,
                          float radius);
/* Floor, wall, boxes, balls and n coloured lights, all seen. */
void fk_room(struct fk_scene *s, uint32_t n_lights, uint64_t *seed);

/* Measure the needs and plan by the device's caps (or *caps). */
void fk_plan(struct hl_plan *out, struct fk_scene *s,
             enum hl_pipeline pipeline);

/* A renderer and its memory. */
struct fk_run {
    struct fk_scene *scene;
    struct hl_plan plan;
    struct hl_renderer_desc desc;
    struct hl_renderer *r;
    struct hl_frame_stats stats;
    void *memory;
};
/* Plan as above and create; the desc may be changed between the two. */
void fk_prepare(struct fk_run *run, struct fk_scene *s,
                enum hl_pipeline pipeline);
enum hl_result fk_create(struct fk_run *run);
void fk_destroy(struct fk_run *run);
/* Draw once and read a target back as RGBA floats, malloc'd. */
float *fk_read(struct fk_run *run, enum hl_role role);
/* All in one: HL_ROLE_NONE reads the finished frame. */
float *fk_draw(struct fk_scene *s, enum hl_pipeline pipeline,
               enum hl_role role);

/* Pixel x, y of a picture FK_W wide. */
static inline const float *fk_at(const float *picture, int x, int y)
{ return picture + (y * FK_W + x) * 4; }

/* Largest |a - b| of the three colours of n pixels (alpha is no part of a
 * frame); INFINITY where one is NaN. */
double fk_difference(const float *a, const float *b, size_t n);
#endif
