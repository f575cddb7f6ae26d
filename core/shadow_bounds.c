/* SPDX-License-Identifier: Zlib */
/* Which shadows the camera can see, and which it stands in: planes between a
 * box, a light and what the camera sees. */
#include <math.h>
#include "core/mesh_work.h"
#include "core/shadow_volume.h"

/* Boxes, matrices and a GPU's near plane come from a handful of float
 * roundings, a few 2^-24 of the largest coordinate that took part: planes
 * keep away from what they separate by far more than that. */
#define SLOP (1.0 / 262144.0)


struct source {
    double at[3];            /* position, or toward the light                */
    bool parallel;
    double size;             /* its largest coordinate, 0 for a direction    */
};
struct bounds { double min[3], max[3], size; };

static double greater(double a, double b)
{
    return a > b ? a : b;
}

static double largest(const double v[3])
{
    return greater(greater(fabs(v[0]), fabs(v[1])), fabs(v[2]));
}

static struct source source_of(const struct hl_light *l)
{
    struct source s;
    s.parallel = l->kind == HL_DIRECTIONAL;
    for (int i = 0; i < 3; i++)
        s.at[i] = s.parallel ? -(double)l->direction[i]
                             : (double)l->position[i];
    s.size = s.parallel ? 0 : largest(s.at);
    return s;
}

static struct bounds bounds_of(const struct hl_box *b)
{
    struct bounds out = {{(double)b->min.x, (double)b->min.y,
                          (double)b->min.z},
                         {(double)b->max.x, (double)b->max.y,
                          (double)b->max.z}, 0};
    out.size = greater(largest(out.min), largest(out.max));
    return out;
}

static bool usable(const struct hl_box *b, const struct hl_light *l)
{
    const float box[6] = {b->min.x, b->min.y, b->min.z,
                          b->max.x, b->max.y, b->max.z};
    return hl_mesh_finite(box, 6) &&
           hl_mesh_finite(l->kind == HL_DIRECTIONAL ? l->direction
                                                    : l->position, 3);
}

static void box_span(const double axis[3], const struct bounds *b, double *low,
                     double *high)
{
    *low = *high = 0;
    for (int i = 0; i < 3; i++) {
        double s = axis[i] * b->min[i], t = axis[i] * b->max[i];
        *low += s < t ? s : t;
        *high += s < t ? t : s;
    }
}

static double sum_of_magnitudes(const double v[3])
{
    return fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
}

/* ---- what the camera sees --------------------------------------------- */

/* Plane i of the view volume in world space, its inside positive. */
static void view_plane(double plane[4], const struct hl_camera *cam,
                       float aspect, int i)
{
    double ty = (double)cam->tan_half_y, tx = ty * (double)aspect;
    const double view[6][4] = {
        {1, 0, -tx, 0}, {-1, 0, -tx, 0}, {0, 1, -ty, 0}, {0, -1, -ty, 0},
        {0, 0, -1, -(double)cam->near}, {0, 0, 1, (double)cam->far}};
    for (int c = 0; c < 4; c++) {
        plane[c] = c == 3 ? view[i][3] : 0;
        for (int r = 0; r < 3; r++)
            plane[c] += view[i][r] * (double)cam->view[4 * c + r];
    }
}

/* The box is outside, and away from the light is farther outside: a plane's
 * distance along a ray from the light changes the way it changed between the
 * light and the box. */
static bool plane_hides(const double plane[4], const struct bounds *b,
                        const struct source *s)
{
    double low, high, light = hl_mesh_dot(plane, s->at);
    double slop = SLOP * (sum_of_magnitudes(plane) * (b->size + s->size) +
                          fabs(plane[3]));
    box_span(plane, b, &low, &high);
    if (!(high + plane[3] < -slop))
        return false;
    if (s->parallel)
        return light >= SLOP * sum_of_magnitudes(plane) * largest(s->at);
    return light - high >= slop;
}

/* The light's reach ends before the box. */
static bool out_of_reach(const struct bounds *b, const struct source *s,
                         float radius)
{
    double d2 = 0, r = (double)radius + SLOP * (b->size + s->size);
    for (int i = 0; i < 3; i++) {
        double below = b->min[i] - s->at[i], above = s->at[i] - b->max[i];
        double d = greater(greater(below, above), 0);
        d2 += d * d;
    }
    return !s->parallel && d2 > r * r;
}

bool hl_shadow_reaches(const struct hl_box *box, const struct hl_light *l,
                       const struct hl_camera *cam, float aspect)
{
    struct bounds b = bounds_of(box);
    struct source s = source_of(l);
    if (!usable(box, l))
        return true;
    if (out_of_reach(&b, &s, l->radius))
        return false;
    for (int i = 0; i < 6; i++) {
        double plane[4];
        view_plane(plane, cam, aspect, i);
        if (plane_hides(plane, &b, &s))
            return false;
    }
    return true;
}

/* ---- the near rectangle ------------------------------------------------ */

/* What lies between the near rectangle and the light: a pyramid, or a prism
 * without end. */
struct wedge { double corner[4][3]; struct source light; double size; };

static struct wedge wedge_of(const struct hl_camera *cam, float aspect,
                             const struct source *s)
{
    struct wedge w;
    double y = (double)cam->near * (double)cam->tan_half_y;
    double x = y * (double)aspect;
    const double view[4][3] = {{-x, -y, -(double)cam->near},
                               {x, -y, -(double)cam->near},
                               {x, y, -(double)cam->near},
                               {-x, y, -(double)cam->near}};
    w.light = *s;
    w.size = s->size;
    for (int i = 0; i < 4; i++) {
        /* The view matrix is rigid: its inverse is its transpose. */
        for (int c = 0; c < 3; c++) {
            w.corner[i][c] = 0;
            for (int r = 0; r < 3; r++)
                w.corner[i][c] += (double)cam->view[4 * c + r] *
                                  (view[i][r] - (double)cam->view[12 + r]);
        }
        w.size = greater(w.size, largest(w.corner[i]));
    }
    for (int r = 0; r < 3; r++) /* lost digits of a camera far away */
        w.size = greater(w.size, fabs((double)cam->view[12 + r]));
    return w;
}

/* Box and wedge lie on different sides of a plane across the axis. */
static bool apart(const double axis[3], const struct wedge *w,
                  const struct bounds *b)
{
    double size = sum_of_magnitudes(axis);
    double low, high, light = hl_mesh_dot(axis, w->light.at);
    double wedge_low = hl_mesh_dot(axis, w->corner[0]);
    double wedge_high = wedge_low;
    double slop = SLOP * size * greater(b->size, w->size);
    bool under = false, over = false; /* without end that way */
    box_span(axis, b, &low, &high);
    for (int i = 1; i < 4; i++) {
        double d = hl_mesh_dot(axis, w->corner[i]);
        wedge_low = d < wedge_low ? d : wedge_low;
        wedge_high = greater(d, wedge_high);
    }
    if (w->light.parallel) {
        /* An axis across the light computed in double: its slope is none as
         * far as the box is, and slop covers it. */
        double flat = 1e-9 * size * largest(w->light.at);
        under = light < -flat;
        over = light > flat;
    } else {
        wedge_low = light < wedge_low ? light : wedge_low;
        wedge_high = greater(light, wedge_high);
    }
    return (!over && low - wedge_high > slop) ||
           (!under && wedge_low - high > slop);
}

/* Axis i: the box's own, the near plane's, those of the wedge's sides. */
static void wedge_axis(double axis[3], const struct wedge *w,
                       const struct hl_camera *cam, int i)
{
    double edge[3], out[3];
    const double *a, *b;
    for (int c = 0; c < 3; c++)
        axis[c] = i == 3 ? (double)cam->view[4 * c + 2] : c == i;
    if (i < 4)
        return;
    a = w->corner[i - 4];
    b = w->corner[(i - 3) % 4];
    for (int c = 0; c < 3; c++) {
        edge[c] = b[c] - a[c];
        out[c] = w->light.at[c] - (w->light.parallel ? 0 : a[c]);
    }
    hl_mesh_cross(axis, edge, out);
}

bool hl_shadow_near_clipped(const struct hl_box *box, const struct hl_light *l,
                            const struct hl_camera *cam, float aspect)
{
    struct bounds b = bounds_of(box);
    struct source s = source_of(l);
    struct wedge w = wedge_of(cam, aspect, &s);
    if (!usable(box, l))
        return true;
    for (int i = 0; i < 8; i++) {
        double axis[3];
        wedge_axis(axis, &w, cam, i);
        if (apart(axis, &w, &b))
            return false;
    }
    return true;
}
