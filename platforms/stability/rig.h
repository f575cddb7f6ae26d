/* SPDX-License-Identifier: Zlib */
#ifndef HLS_RIG_H
#define HLS_RIG_H
/* What rows build their scenes with: plain walls under given lights, seen
 * from +z, so that world and view axes are the same. */
#include "platforms/cli/readback.h"
#include "platforms/host/builder.h"
#include "platforms/stability/stability.h"

/* Of a file of rows: hls_rig_begin, shapes, hls_rig_end. */
struct hls_rig {
    struct hlh_scene scene;
    struct hlh_builder b;
};

/* An empty scene with one matte material, 0, and a camera at (0, 0, eye) that
 * looks to the origin. */
void hls_rig_begin(struct hls_rig *, double eye, double vfov);
/* Close the mesh in hand as one object at the origin. */
void hls_rig_object(struct hls_rig *, uint32_t material);
/* A wall from -half to half on x and y at z, seen from +z, as an object. */
void hls_rig_wall(struct hls_rig *, uint32_t material, double half, double z);
/* The same with a shading normal that leans by x and y to 1. */
void hls_rig_lean(struct hls_rig *, uint32_t material, double half, double z,
                  double x, double y);
/* Finish the scene, and *out (zeroed on failure, with a line printed) is what
 * the rig built. The rig is empty then. */
bool hls_rig_take(struct hlh_scene *out, struct hls_rig *);
/* The same as the lab's stage. */
bool hls_rig_end(struct hls_rig *, struct hls_lab *,
                 const struct hlc_options *);

/* The lab's options for pictures of w x h pixels by the inferred pipeline, with
 * an L-buffer of that size; pipeline, sizes and light path of the command line
 * are not taken over, samples are 1. */
void hls_rig_options(struct hlc_options *, const struct hls_lab *,
                     uint32_t w, uint32_t h);

/* What a row with one shot has in lab->data, as its first member. */
struct hls_drawn {
    struct hlc_shot shot;
    bool made;                   /* the shot is open                         */
};
/* Close it and free lab->data (may be NULL): a row's close. */
void hls_rig_close(struct hls_lab *);

/* Material of pane i of any number, alpha blended. */
uint32_t hls_rig_glass(struct hls_rig *, int i, double alpha);
/* Pane i over a wall: its normal leans by i, so that light that got to another
 * layer shows. */
void hls_rig_pane(struct hls_rig *, uint32_t material, int i, double half,
                  double z);
/* Two lights of unlike colours before a wall at z 0. */
void hls_rig_lights(struct hls_rig *);

/* As hlc_shot_open, with a printed line. */
bool hls_rig_shot(struct hlc_shot *, struct hls_lab *,
                  const struct hlc_options *);
/* What the rig built in place of the stage's scene, which the shot goes on
 * drawing with its own plan, programs and camera: kinds of surface and counts
 * must be within those of the scene that it was made for. */
bool hls_rig_swap(struct hlc_shot *, struct hls_rig *,
                  const struct hlc_options *);
/* As hlc_shot_draw; then a target's texels, or the finished picture. False
 * with a printed line. */
bool hls_rig_texels(struct hlc_texels *, struct hlc_shot *, enum hl_role);
bool hls_rig_picture(struct hlh_picture *, struct hlc_shot *);
/* "row: what: result" on stderr; false. */
bool hls_rig_fail(const char *what, enum hl_result);
#endif
