/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "core/exact.h"
#include "core/shadow_map.h"
#include "core/vec.h"

/* ---- small -------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void widen(double out[3], const float v[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)v[i];
}

static void unit(double v[3])
{
    double l = sqrt(dot(v, v));
    for (int i = 0; i < 3 && l > 0; i++)
        v[i] /= l;
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

/* ---- spheres ------------------------------------------------------------ */

/* k: slope of the corners. Either the far corners decide, or near and far
 * ones lie on the sphere. */
void hl_shadow_frustum(struct hl_shadow_sphere *out,
                       const struct hl_camera *cam, double aspect)
{
    double n = (double)cam->near, f = (double)cam->far;
    double t = (double)cam->tan_half_y;
    double k2 = t * t * (1 + aspect * aspect);
    double z = f, r2 = f * f * k2;
    if (k2 * (f + n) < f - n) {
        z = 0.5 * (f + n) * (1 + k2);
        r2 = (f - z) * (f - z) + f * f * k2;
    }
    out->radius = sqrt(r2);
    /* The view's third row points back; eye = -R^T t. */
    for (int i = 0; i < 3; i++) {
        const float *c = cam->view + 4 * i;
        double eye = 0;
        for (int k = 0; k < 3; k++)
            eye -= (double)c[k] * (double)cam->view[12 + k];
        out->center[i] = eye - z * (double)c[2];
    }
}

static double round_up(double r)
{
    double octave = 1;
    if (!(r > 1e-6 && r < 1e30))
        return r < 1e30 ? 1e-6 : 1e30;
    while (octave > r)
        octave *= 0.5;
    while (octave * 2 <= r)
        octave *= 2;
    return ceil(r / octave * 16) / 16 * octave;
}

void hl_shadow_around(struct hl_shadow_sphere *out, const struct hl_box *b)
{
    hl_vec3 d = hl_sub3(b->max, b->min), s = hl_add3(b->min, b->max);
    double x = (double)d.x, y = (double)d.y, z = (double)d.z;
    out->center[0] = (double)s.x * 0.5;
    out->center[1] = (double)s.y * 0.5;
    out->center[2] = (double)s.z * 0.5;
    out->radius = round_up(0.5 * sqrt(x * x + y * y + z * z));
}

/* Lowest value in the box of w . (world axes) - at. */
static double lowest(const double w[3], double at, const struct hl_box *b)
{
    const float min[3] = { b->min.x, b->min.y, b->min.z };
    const float max[3] = { b->max.x, b->max.y, b->max.z };
    double low = -at;
    for (int i = 0; i < 3; i++)
        low += w[i] * (double)(w[i] > 0 ? min[i] : max[i]);
    return low;
}

/* ---- fitting ------------------------------------------------------------ */

/* c along the light, a as level as can be: of the direction alone, so that
 * texels do not turn. */
static void look_along(struct hl_shadow_map *m, const float direction[3])
{
    double *a = m->axis[0], *b = m->axis[1], *c = m->axis[2];
    double up[3] = { 0, 1, 0 };
    widen(c, direction);
    unit(c);
    if (c[0] * c[0] + c[2] * c[2] < 1e-6) {
        up[1] = 0;
        up[2] = 1;
    }
    cross(a, up, c);
    unit(a);
    cross(b, c, a);
}

/* Where fixed point is coarse, c may not begin near the light: a step of
 * depth at distance far is far^2 / (near 2^bits), a 1/64 part of a texel's
 * width or less of maps up to 1,024 texels. */
static double near_share(const struct hl_shadow_target *t)
{
    return t->bits && t->bits < 24 ? 1.0 / 64 : 1.0 / 1024;
}

static void from_light(struct hl_shadow_map *m, const struct hl_light *l)
{
    double p[3];
    widen(p, l->position);
    for (int i = 0; i < 3; i++)
        m->origin[i] = dot(m->axis[i], p);
    m->far = (double)l->radius;
    m->near = m->far * near_share(&m->target);
}

static double half_map(const struct hl_shadow_target *t)
{
    return 0.5 * t->side - (double)HL_SHADOW_BORDER;
}

static void fit_point(struct hl_shadow_map *m, const struct hl_light *l)
{
    if (m->target.faces != 6)
        return;
    m->kind = HL_MAP_POINT;
    for (int i = 0; i < 3; i++)
        m->axis[i][i] = 1;
    m->scale = half_map(&m->target);
    from_light(m, l);
}

static void fit_spot(struct hl_shadow_map *m, const struct hl_light *l)
{
    double t = hl_exact_tan((double)l->outer);
    m->kind = HL_MAP_CONE;
    look_along(m, l->direction);
    m->scale = half_map(&m->target) / (t > 1e-3 ? t : 1e-3);
    from_light(m, l);
}

/* From the first caster on to the last thing that is seen. */
static void span_parallel(struct hl_shadow_map *m,
                          const struct hl_shadow_scene *s)
{
    const double *c = m->axis[2];
    double mid = dot(c, s->seen.center), low = mid - s->seen.radius;
    bool any = s->casters.min.x <= s->casters.max.x;
    double first = lowest(c, 0, &s->casters);
    m->origin[2] = mid;
    m->near = (any && first < low ? first : low) - mid - 1e-3;
    m->far = s->seen.radius + 1e-3;
}

static void fit_parallel(struct hl_shadow_map *m, const struct hl_light *l,
                         const struct hl_shadow_scene *s)
{
    m->kind = HL_MAP_PARALLEL;
    look_along(m, l->direction);
    /* Half a texel to either side for the step to whole ones. */
    m->scale = (half_map(&m->target) - 0.5) /
               (s->seen.radius > 1e-6 ? s->seen.radius : 1e-6);
    for (int i = 0; i < 2; i++)
        m->origin[i] = floor(dot(m->axis[i], s->seen.center) * m->scale + 0.5)
                       / m->scale;
    span_parallel(m, s);
}

void hl_shadow_fit(struct hl_shadow_map *m, const struct hl_light *l,
                   const struct hl_shadow_target *t,
                   const struct hl_shadow_scene *scene)
{
    memset(m, 0, sizeof *m);
    m->target = *t;
    m->kind = HL_MAP_NONE;
    if (l->kind == HL_DIRECTIONAL)
        fit_parallel(m, l, scene);
    else if (l->kind == HL_SPOT && l->outer < HL_SHADOW_WIDE)
        fit_spot(m, l);
    else
        fit_point(m, l);
}

uint32_t hl_shadow_faces(const struct hl_shadow_map *m)
{
    return m->kind == HL_MAP_NONE ? 0 : m->kind == HL_MAP_POINT ? 6 : 1;
}

/* ---- faces -------------------------------------------------------------- */

/* Axes of a face in the world, and where its space begins along them. */
struct face { double axis[3][3], origin[3]; };

/* hl_shadow_turn of the light's axes. */
static void face_of(struct face *f, const struct hl_shadow_map *m,
                    uint32_t face)
{
    int first = m->kind == HL_MAP_POINT ? (int)(face / 2 + 1) % 3 : 0;
    double sign = m->kind == HL_MAP_POINT && face % 2 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        int k = (first + i) % 3;
        double s = i == 1 ? 1 : sign;
        for (int j = 0; j < 3; j++)
            f->axis[i][j] = s * m->axis[k][j];
        f->origin[i] = s * m->origin[k];
    }
}

/* Slope, or metres, at the map's edge. */
static double edge(const struct hl_shadow_map *m)
{
    return 0.5 * m->target.side / m->scale;
}

/* Inside of every plane: near <= c <= far, |a| and |b| <= edge (c). */
bool hl_shadow_touches(const struct hl_shadow_map *m, uint32_t face,
                       const struct hl_box *b)
{
    struct face f;
    face_of(&f, m, face);
    bool parallel = m->kind == HL_MAP_PARALLEL;
    double e = edge(m), back[3];
    for (int i = 0; i < 3; i++)
        back[i] = -f.axis[2][i];
    if (lowest(f.axis[2], f.origin[2], b) > m->far ||
        -lowest(back, -f.origin[2], b) < m->near)
        return false;
    for (int k = 0; k < 4; k++) {
        double s = k & 1 ? -1 : 1, w[3], at = s * f.origin[k >> 1];
        for (int i = 0; i < 3; i++)
            w[i] = s * f.axis[k >> 1][i] - (parallel ? 0 : e * f.axis[2][i]);
        at -= parallel ? 0 : e * f.origin[2];
        if (lowest(w, at, b) > (parallel ? e : 0))
            return false;
    }
    return true;
}

/* Depth as stored is x / c + y, or x c + y in parallel light. */
static void depth_terms(const struct hl_shadow_map *m, double *x, double *y)
{
    double n = m->near, f = m->far, d = f - n;
    bool r = m->target.reversed;
    if (m->kind == HL_MAP_PARALLEL) {
        *x = (r ? -1 : 1) / d;
        *y = (r ? f : -n) / d;
    } else {
        *x = (r ? 1 : -1) * n * f / d;
        *y = (r ? -n : f) / d;
    }
}

static uint32_t columns(const struct hl_shadow_map *m)
{
    return m->target.faces == 6 ? 3 : 1;
}

static uint32_t rows(const struct hl_shadow_map *m)
{
    return m->target.faces == 6 ? 2 : 1;
}

/* No viewport: the map's part of the target is in the matrix. With w = c (1
 * in parallel light): texel = scale a + middle w, clip = 2 texel / size - w. */
void hl_shadow_clip(float out[16], const struct hl_shadow_map *m,
                    uint32_t face, const float world[16])
{
    struct face f;
    double x, y, side = m->target.side, row[4][4];
    double middle[2] = { (face % columns(m) + 0.5) * side,
                         (face / columns(m) + 0.5) * side };
    double size[2] = { columns(m) * side, rows(m) * side };
    bool parallel = m->kind == HL_MAP_PARALLEL;
    face_of(&f, m, face);
    depth_terms(m, &x, &y);
    for (int i = 0; i < 3; i++)
        row[3][i] = parallel ? 0 : f.axis[2][i];
    row[3][3] = parallel ? 1 : -f.origin[2];
    for (int k = 0; k < 2; k++) {
        double s = 2 * m->scale / size[k], t = 2 * middle[k] / size[k] - 1;
        for (int i = 0; i < 4; i++)
            row[k][i] = s * (i < 3 ? f.axis[k][i] : -f.origin[k]) +
                        t * row[3][i];
    }
    /* z = x + y c, or x c + y. */
    for (int i = 0; i < 4; i++) {
        double c = i < 3 ? f.axis[2][i] : -f.origin[2], one = i < 3 ? 0 : 1;
        row[2][i] = parallel ? x * c + y * one : x * one + y * c;
    }
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            double s = c == 3 ? row[r][3] : 0;
            for (int k = 0; k < 3; k++)
                s += row[r][k] * (double)world[c * 4 + k];
            out[c * 4 + r] = (float)s;
        }
}

struct hl_rect hl_shadow_rect(const struct hl_shadow_map *m, uint32_t face)
{
    int32_t side = (int32_t)m->target.side;
    struct hl_rect r = { (int32_t)(face % columns(m)) * side,
                         (int32_t)(face / columns(m)) * side, side, side };
    return r;
}

/* ---- what stages read --------------------------------------------------- */

/* A step of depth there and back: z moves by z^2 / a of it. Floats step by
 * 2^-21 of themselves and less (20e4), and z with them. What is computed from
 * it in 32 bits is half a dozen roundings. Along slanted rays a point moves
 * half as much again. */
struct hl_shadow_error hl_shadow_depth_error(uint32_t bits, float a)
{
    struct hl_shadow_error e = { 0, 1.5f / 1048576 };
    a = a < 0 ? -a : a;
    if (bits && bits < 32 && a > 0)
        e.x = 1.5f / ((float)(1u << bits) * a);
    return e;
}

/* p = R world + t, so light space = axis R^T (p - t) - origin. */
static void view_to_light(hl_mat4 *out, const struct hl_shadow_map *m,
                          const float view[16])
{
    float col[4][4] = { { 0 } };
    for (int i = 0; i < 3; i++) {
        double at = -m->origin[i];
        for (int k = 0; k < 3; k++) {
            double v = 0;
            for (int j = 0; j < 3; j++)
                v += m->axis[i][j] * (double)view[j * 4 + k];
            col[k][i] = (float)v;
            at -= v * (double)view[12 + k];
        }
        col[3][i] = (float)at;
    }
    col[3][3] = 1;
    memcpy(out, col, sizeof col);
}

void hl_shadow_block_write(struct hl_shadow_block *out,
                           const struct hl_shadow_map *m,
                           const struct hl_camera *cam,
                           struct hl_shadow_error e)
{
    double x = 0, y = 0;
    memset(out, 0, sizeof *out);
    if (m->kind == HL_MAP_NONE)
        return;
    depth_terms(m, &x, &y);
    view_to_light(&out->light, m, cam->view);
    out->map = hl_v4((float)m->scale, (float)(1 / m->scale),
                     m->target.reversed ? -1.0f : 1.0f, 0);
    out->depth = hl_v4((float)x, (float)y, (float)m->near, 0);
    out->error = hl_v4(e.x, e.y, 0, 0);
}
