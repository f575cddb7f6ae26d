/* SPDX-License-Identifier: Zlib */
/* Light volumes that the near or far plane cuts, or in which the camera is:
 * the light goes out or is added twice. Two rows: the camera goes through a
 * volume; planes come to cut it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { W = 96, H = 64 };

#define TAN_HALF 0.75        /* of the vertical field of view                */
#define WIDE 0.6             /* half the corridor's width and height, m      */
#define LONG 6.0             /* half its length                              */

static const double eye_at[2] = { 0.11, 0.07 };

struct own {
    struct hls_drawn drawn;      /* first, for hls_rig_close                 */
};

/* A corridor along z around a light of radius 1 at the origin, whose sphere
 * passes through all four walls. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hlc_options o;
    struct hls_rig rig;
    struct own *w = lab->data = calloc(1, sizeof *w);
    if (!w)
        return hls_rig_fail("volume", HL_ERR_MEMORY);
    (void)c;
    (void)skip;
    hls_rig_options(&o, lab, W, H);
    o.light_path = HL_LIGHT_PATH_VOLUMES;
    o.volume_texels = 1;
    hls_rig_begin(&rig, 3, 60);
    hlh_add_box(&rig.b, hlh_v3(0, 0, 0), hlh_v3(WIDE, WIDE, LONG), 1, true);
    hls_rig_object(&rig, 0);
    hlh_build_light(&rig.b, hlh_v3(0, 0, 0), 1, hlh_v3(1, 1, 1));
    w->drawn.made = hls_rig_end(&rig, lab, &o) &&
                    hls_rig_shot(&w->drawn.shot, lab, &o);
    return w->drawn.made;
}

/* ---- what is right ------------------------------------------------------ */

/* Light at the texel by design 4: smooth falloff, N.L. *depth is where the
 * wall is, *d how far that is from the light. */
static double truth(double *depth, double *d, double z, uint32_t i)
{
    double ray[3] = { ((i % W + 0.5) / W * 2 - 1) * TAN_HALF * W / H,
                      (1 - (i / W + 0.5) / H * 2) * TAN_HALF, -1 };
    double eye[3] = { eye_at[0], eye_at[1], z }, t = INFINITY, n_l = 0;
    double d2 = 0;
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        double wall = k < 2 ? WIDE : LONG;
        double to = ((ray[k] < 0 ? -wall : wall) - eye[k]) / ray[k];
        if (ray[k] != 0 && to < t) {
            t = to;
            axis = k;
        }
    }
    for (int k = 0; k < 3; k++) {
        double at = eye[k] + t * ray[k];
        d2 += at * at;
        n_l = k == axis ? fabs(at) : n_l;
    }
    *depth = t;
    *d = sqrt(d2);
    return *d < 1 ? (1 - d2) * (1 - d2) * n_l / *d : 0;
}

/* Wrong: lit outside of the sphere, dark inside, or by another value; within
 * 1 % of the sphere light is too weak for steps of 10^-4 to tell, and within
 * 1 % of a plane a wall may be cut off or not. 5 % of the value and 0.002
 * cover the depth's and normal's steps (0.1 %) and the L-buffer's. */
static bool is_wrong(double light, double z, const struct hl_camera *c,
                     uint32_t i)
{
    double depth, d, right = truth(&depth, &d, z, i);
    double near = (double)c->near, far = (double)c->far;
    if (fabs(depth / near - 1) < 0.01 || depth > 0.99 * far)
        return false;
    if (depth < near)
        right = 0;
    bool dark = !(light > 0), inside = right > 0;
    if (fabs(d - 1) > 0.01 && dark == inside)
        return true;
    return !(fabs(light - right) <= 0.05 * right + 0.002);
}

static bool count(double *m, double z, double near, double far,
                  struct hls_lab *lab)
{
    struct own *w = lab->data;
    struct hlc_texels t;
    float v[4], eye[3] = { (float)eye_at[0], (float)eye_at[1], (float)z };
    float target[3] = { eye[0], eye[1], eye[2] - 1 };
    hl_camera_look_at(&w->drawn.shot.frame.camera, eye, target,
                      73.739795291688043f, (float)near, (float)far);
    if (!hls_rig_texels(&t, &w->drawn.shot, HL_ROLE_LIGHT))
        return false;
    *m = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        hlc_texel(v, &t, i);
        *m += is_wrong((double)v[1] * (double)w->drawn.shot.plan.light_scale, z,
                       &w->drawn.shot.frame.camera, i);
    }
    hlc_texels_free(&t);
    if (w->drawn.shot.stats.light_volumes)
        snprintf(lab->note, sizeof lab->note, "through stencil volumes");
    return true;
}

/* ---- the rows ----------------------------------------------------------- */

/* arg: near plane. */
static bool travel(double *m, double p, const struct hls_case *c,
                   struct hls_lab *lab)
{
    return count(m, p, c->arg[0], 20, lab);
}

static const struct hls_case travels[] = {
    { "through", "near plane at R/100", 2, -2, 0, false, NAN, NAN,
      "none: depth-fail holds wherever the eye is", { 0.01 } },
    { "through-thick", "near plane at R/2", 2, -2, 0, false, NAN, NAN,
      "none: depth-fail holds wherever the eye is", { 0.5 } },
};

const struct hls_row hls_row_volume = {
    "volume", "A light goes out, or counts twice, around the eye",
    "34, 37 (Lengyel; Kircher, Lawrance 2009, section 2.2)",
    "camera from the centre", "radii", "wrong L texels", HLS_LINEAR, travels,
    sizeof travels / sizeof *travels, begin, hls_rig_close, travel
};

/* arg: the eye's z, the plane: 0 near, 1 far. */
static bool cut(double *m, double p, const struct hls_case *c,
                struct hls_lab *lab)
{
    bool far = c->arg[1] > 0;
    return count(m, c->arg[0], far ? 0.01 : p, far ? p : 20, lab);
}

static const struct hls_case cuts[] = {
    { "near-inside", "near plane, the eye inside", 0.001, 1, 0, false, NAN,
      NAN, "none: depth-fail counts behind what is seen", { 0.4, 0 } },
    { "near-before", "near plane, the eye before the volume", 0.001, 1, 0,
      false, NAN, NAN, "none: depth-fail counts behind what is seen",
      { 1.3, 0 } },
    { "far-behind", "far plane, the eye before the volume", 8, 0.3, 0, false,
      NAN, NAN, "none: volumes end at no far plane", { 1.3, 1 } },
};

const struct hls_row hls_row_near = {
    "near", "A light volume that the near or far plane cuts goes out",
    "34, 35 (Lengyel; Kircher, Lawrance 2009, section 2.2)",
    "distance of the plane", "radii", "wrong L texels", HLS_LOG, cuts,
    sizeof cuts / sizeof *cuts, begin, hls_rig_close, cut
};
