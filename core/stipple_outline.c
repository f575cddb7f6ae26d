/* SPDX-License-Identifier: Zlib */
/* What a box covers on the screen, and whether two outlines meet. In double:
 * a corner near the eye lies far outside the screen. */
#include "core/stipple_work.h"
#include "core/light.h"
#include "core/vec.h"

/* 8 corners and 12 edges that may cross a plane; each of four cuts adds a
 * corner for two of the polygon's, even if rounding spoils convexity:
 * 20 * 1.5^4 = 101.25. */
enum { BOX_POINTS = 8 + 12, MAX_POINTS = 102 };
#define SLACK (1.0f / 16)    /* texels: float rounding of host and device    */

struct point { double x, y; };
struct polygon { uint32_t n; struct point at[MAX_POINTS]; };

static bool finite_number(float x) { return x - x == 0; }

bool hl_stipple_outline_good(const struct hl_stipple_outline *o)
{
    if (o->n_corners < 3 || o->n_corners > HL_STIPPLE_CORNERS)
        return false;
    for (uint32_t i = 0; i < o->n_corners; i++)
        if (!finite_number(o->x[i]) || !finite_number(o->y[i]))
            return false;
    return true;
}

/* ---- two outlines ---------------------------------------------------- */

/* Twice the area: positive when corners run from x to y. */
static double turned_area(const struct hl_stipple_outline *o)
{
    double sum = 0;
    for (uint32_t i = 0, j = o->n_corners - 1; i < o->n_corners; j = i++)
        sum += (double)o->x[j] * (double)o->y[i] -
               (double)o->x[i] * (double)o->y[j];
    return sum;
}

double hl_stipple_area(const struct hl_stipple_outline *o)
{
    double twice = turned_area(o);
    return (twice < 0 ? -twice : twice) * 0.5;
}

/* True when all of b lies more than `gap` beyond an edge of a. Beyond is
 * measured along the edge's normal, times the edge's length. */
static bool parts(const struct hl_stipple_outline *a,
                  const struct hl_stipple_outline *b, double gap)
{
    double turn = turned_area(a) < 0 ? -1 : 1;
    for (uint32_t i = 0, j = a->n_corners - 1; i < a->n_corners; j = i++) {
        double ex = turn * ((double)a->x[i] - (double)a->x[j]);
        double ey = turn * ((double)a->y[i] - (double)a->y[j]);
        double limit = gap * gap * (ex * ex + ey * ey);
        uint32_t k = 0;
        for (; k < b->n_corners; k++) {
            double d = ((double)b->x[k] - (double)a->x[i]) * ey -
                       ((double)b->y[k] - (double)a->y[i]) * ex;
            if (!(d > 0 && d * d > limit))
                break;
        }
        if (k == b->n_corners)
            return true;
    }
    return false;
}

bool hl_stipple_outlines_meet(const struct hl_stipple_outline *a,
                              const struct hl_stipple_outline *b, float margin)
{
    /* Each may be off by the slack. */
    double gap = (double)margin + 2 * (double)SLACK;
    return !parts(a, b, gap) && !parts(b, a, gap);
}

/* ---- a box ----------------------------------------------------------- */

/* Corners in front of the near plane and where edges cross it, as slopes
 * x / z, y / z (y down). */
static void project_box(struct polygon *out, const hl_vec3 v[8], double near)
{
    out->n = 0;
    for (uint32_t i = 0; i < 8; i++) {
        double z = -(double)v[i].z;
        if (z >= near) {
            out->at[out->n].x = (double)v[i].x / z;
            out->at[out->n++].y = -(double)v[i].y / z;
        }
        for (uint32_t bit = 1; bit < 8; bit <<= 1) {
            const hl_vec3 *b = &v[i | bit];
            double w = -(double)b->z, t = (near - z) / (w - z);
            if (i & bit || (z >= near) == (w >= near))
                continue;
            out->at[out->n].x = ((double)v[i].x +
                t * ((double)b->x - (double)v[i].x)) / near;
            out->at[out->n++].y = -((double)v[i].y +
                t * ((double)b->y - (double)v[i].y)) / near;
        }
    }
}

static bool before(struct point a, struct point b)
{
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

/* Does o, a, b turn left by a true corner? */
static bool turns(struct point o, struct point a, struct point b)
{
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x) > 0;
}

static uint32_t half_hull(struct point *out, const struct point *in,
                          uint32_t n, bool back)
{
    uint32_t m = 0;
    for (uint32_t i = 0; i < n; i++) {
        struct point p = in[back ? n - 1 - i : i];
        while (m >= 2 && !turns(out[m - 2], out[m - 1], p))
            m--;
        out[m++] = p;
    }
    return m - 1;            /* the last begins the other half               */
}

/* Andrew, "Another efficient algorithm for convex hulls in two dimensions",
 * 1979. */
static void hull(struct polygon *p)
{
    struct point out[2 * BOX_POINTS];
    uint32_t n;
    for (uint32_t i = 1; i < p->n; i++) {
        struct point moved = p->at[i];
        uint32_t k = i;
        for (; k > 0 && before(moved, p->at[k - 1]); k--)
            p->at[k] = p->at[k - 1];
        p->at[k] = moved;
    }
    n = half_hull(out, p->at, p->n, false);
    n += half_hull(out + n, p->at, p->n, true);
    p->n = n;
    for (uint32_t i = 0; i < n; i++)
        p->at[i] = out[i];
}

/* Keeps what has nx x + ny y <= limit (Sutherland and Hodgman, "Reentrant
 * polygon clipping", 1974): at most one corner more. */
static void clip(struct polygon *p, double nx, double ny, double limit)
{
    struct polygon in = *p;
    p->n = 0;
    for (uint32_t i = 0, j = in.n - 1; i < in.n; j = i++) {
        struct point a = in.at[j], b = in.at[i];
        double da = nx * a.x + ny * a.y - limit;
        double db = nx * b.x + ny * b.y - limit;
        double t = da / (da - db);
        if ((da > 0) != (db > 0)) {
            p->at[p->n].x = a.x + t * (b.x - a.x);
            p->at[p->n++].y = a.y + t * (b.y - a.y);
        }
        if (db <= 0)
            p->at[p->n++] = b;
    }
}

static void corners_of(hl_vec3 out[8], const float world[16],
                       const float view[16], const float min[3],
                       const float max[3])
{
    for (uint32_t i = 0; i < 8; i++) {
        hl_vec3 c = hl_v3(i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1],
                          i & 4 ? max[2] : min[2]);
        out[i] = hl_transform_point(view, hl_transform_point(world, c));
    }
}

static bool all_finite(const hl_vec3 v[8])
{
    for (int i = 0; i < 8; i++)
        if (!finite_number(v[i].x) || !finite_number(v[i].y) ||
            !finite_number(v[i].z))
            return false;
    return true;
}

static struct polygon whole(double x, double y)
{
    struct polygon p = { 4, {{-x, -y}, {x, -y}, {x, y}, {-x, y}} };
    return p;
}

/* Texels that are drawn beyond the picture's edges. Jitter moves a picture by
 * at most a frame pixel, and outlines do not follow it, so that patterns stay
 * the same from frame to frame: whole texels on all sides allow for what it
 * brings in, so that this does not change with it either. */
static void past_edges(const struct hl_span *s, double *x, double *y)
{
    float jx = hl_max(s->jx, -s->jx), jy = hl_max(s->jy, -s->jy);
    double most = (double)ceilf(hl_max(jx, jy));
    *x = (double)s->cols - (double)s->w + most;
    *y = (double)s->rows - (double)s->h + most;
}

bool hl_stipple_project(struct hl_stipple_outline *out, const float world[16],
                        const float min[3], const float max[3],
                        const struct hl_camera *camera,
                        const struct hl_span *span)
{
    double w = (double)span->w, h = (double)span->h;
    double tan_x = (double)span->tan_x, tan_y = (double)span->tan_y;
    double right, bottom, edge_x, edge_y;
    struct polygon p;
    hl_vec3 v[8];
    if (span->cols == 0 || span->rows == 0)
        return false;
    past_edges(span, &right, &bottom);
    edge_x = tan_x * (1 + 2 * right / w);
    edge_y = tan_y * (1 + 2 * bottom / h);
    corners_of(v, world, camera->view, min, max);
    if (!all_finite(v))
        return false;
    project_box(&p, v, (double)camera->near);
    if (p.n < 3)
        return false;
    hull(&p);
    clip(&p, 1, 0, edge_x);
    clip(&p, -1, 0, edge_x);
    clip(&p, 0, 1, edge_y);
    clip(&p, 0, -1, edge_y);
    if (p.n < 3)
        return false;
    /* Of 10 corners and 4 cuts there are 14, unless rounding made more:
     * conservatively the whole target. */
    if (p.n > HL_STIPPLE_CORNERS)
        p = whole(edge_x, edge_y);
    out->n_corners = p.n;
    for (uint32_t i = 0; i < p.n; i++) {
        out->x[i] = (float)((1 + p.at[i].x / tan_x) * 0.5 * w);
        out->y[i] = (float)((1 + p.at[i].y / tan_y) * 0.5 * h);
    }
    return true;
}

void hl_stipple_bound(struct hl_stipple_object *object,
                      const struct hl_stipple_outline *o)
{
    object->x0 = object->x1 = o->x[0];
    object->y0 = object->y1 = o->y[0];
    for (uint32_t i = 1; i < o->n_corners; i++) {
        object->x0 = hl_min(object->x0, o->x[i]);
        object->x1 = hl_max(object->x1, o->x[i]);
        object->y0 = hl_min(object->y0, o->y[i]);
        object->y1 = hl_max(object->y1, o->y[i]);
    }
    object->x0 -= SLACK;
    object->y0 -= SLACK;
    object->x1 += SLACK;
    object->y1 += SLACK;
    object->outline = o;
}
