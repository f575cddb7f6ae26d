/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/shadow_kit.h"

int sv_setup(void **state)
{
    struct sv_rig *r = calloc(1, sizeof *r);
    if (!r)
        return -1;
    r->hooks = mk_hooks(&r->memory);
    r->random = mk_seed();
    r->parts = HL_SHADOW_CLOSED;
    *state = r;
    return 0;
}

void sv_drop(struct sv_rig *r)
{
    hl_shadow_mesh_free(&r->mesh, &r->hooks);
    mk_free(&r->input);
    free(r->indices);
    free(r->scratch);
    r->indices = r->scratch = NULL;
}

int sv_teardown(void **state)
{
    struct sv_rig *r = *state;
    sv_drop(r);
    assert_int_equal(r->memory.n_live, 0);
    free(r);
    return 0;
}

void sv_prepare(struct sv_rig *r)
{
    struct hl_shadow_mesh_desc d = {r->input.position, 0, r->input.indices,
                                    r->input.n_indices, r->input.n_vertices};
    hl_shadow_mesh_free(&r->mesh, &r->hooks);
    assert_int_equal(hl_shadow_mesh_prepare(&r->mesh, &r->hooks, &d), HL_OK);
    free(r->indices);
    free(r->scratch);
    unsigned most = HL_SHADOW_CLOSED | HL_SHADOW_TWO_SIDED;
    r->indices = malloc(4 * (size_t)hl_shadow_max_indices(&r->mesh, most) + 4);
    r->scratch = malloc(hl_shadow_scratch(&r->mesh));
    assert_non_null(r->indices);
    assert_non_null(r->scratch);
}

void sv_cast(struct sv_rig *r)
{
    uint32_t room = hl_shadow_max_indices(&r->mesh, r->parts);
    r->indices[room] = 0xABCDEF01u;
    assert_int_equal(
        hl_shadow_volume_write(&r->counts, r->indices, room, r->scratch,
                               hl_shadow_scratch(&r->mesh), &r->mesh,
                               r->light, r->parts), HL_OK);
    assert_int_equal(r->indices[room], 0xABCDEF01u);
    r->n = r->counts.n_front + r->counts.n_sides + r->counts.n_back;
    assert_true(r->n <= room);
}

void sv_random_light(struct sv_rig *r, float w)
{
    for (int i = 0; i < 3; i++)
        r->light[i] = (float)ck_between(&r->random, -3, 3);
    r->light[3] = w;
}

/* ---- vectors ---------------------------------------------------------- */

static double det(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

double sv_length(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static void towards(double out[3], const double from[3], const float to[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)to[i] - from[i];
}

/* ---- oracle: how often the volume winds about a point ------------------ */

/* Element of the vertex buffer as seen from q: where it is, or for a twin
 * the direction that it went to. */
static void seen_from(const struct sv_rig *r, uint32_t element,
                      const double q[3], double out[3])
{
    const float *v = &r->mesh.vertices[4 * (size_t)element];
    for (int i = 0; i < 3; i++)
        out[i] = v[3] != 0 ? (double)v[i] - q[i]
                           : (double)v[i] * (double)r->light[3] -
                                 (double)r->light[i];
}

/* Below this share of the product of its vectors' lengths a determinant's
 * sign is not trusted: double rounding gives some 1e-15 of it. */
static const double DOUBT = 1e-9;

static double doubt(double v[3][3])
{
    return DOUBT * sv_length(v[0]) * sv_length(v[1]) * sv_length(v[2]);
}

/* The ray q + t ray crosses the triangle when it lies in the cone of the
 * corners as seen from q, for twins too: the cone does not ask how far away
 * they are. Out of the volume + 1, into it -1. False: too near an edge. */
static bool crossing(const struct sv_rig *r, const uint32_t *t,
                     const double q[3], const double ray[3], int *sum)
{
    double v[3][3], at[3], whole;
    int above = 0, below = 0, near = 0;
    for (int i = 0; i < 3; i++)
        seen_from(r, t[i], q, v[i]);
    for (int i = 0; i < 3; i++) {
        double *a = v[(i + 1) % 3], *b = v[(i + 2) % 3];
        double size = DOUBT * sv_length(ray) * sv_length(a) * sv_length(b);
        at[i] = det(ray, a, b);
        near += fabs(at[i]) <= size;
        above += at[i] > size;
        below += at[i] < -size;
    }
    if (above > 0 && below > 0)
        return true;
    whole = det(v[0], v[1], v[2]);
    if (near > 0 || fabs(whole) <= doubt(v))
        return false;
    if ((whole > 0) == (above > 0))
        *sum += whole > 0 ? 1 : -1;
    return true;
}

static bool winding(struct sv_rig *r, const double q[3], int *sum)
{
    double ray[3];
    for (int i = 0; i < 3; i++)
        ray[i] = ck_between(&r->random, -1, 1);
    *sum = 0;
    for (uint32_t k = 0; k < r->n; k += 3)
        if (!crossing(r, &r->indices[k], q, ray, sum))
            return false;
    return true;
}

/* ---- oracle: faces between a point and the light ----------------------- */

static bool input_triangle(const struct mk_mesh *m, uint32_t t, float p[3][3])
{
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t v = m->indices[3 * t + i];
        if (v >= m->n_vertices)
            return false;
        memcpy(p[i], &m->position[3 * v], sizeof p[i]);
        if (!isfinite(p[i][0]) || !isfinite(p[i][1]) || !isfinite(p[i][2]))
            return false;
    }
    return true;
}

/* Adds the face when the way from q to the light goes through it, out of its
 * front. False: too near its edge or plane to say. */
static bool between(const struct sv_rig *r, float p[3][3], const double q[3],
                    int *sum)
{
    double v[3][3], way[3], at[3], whole, scale;
    int above = 0, below = 0, sign;
    for (int i = 0; i < 3; i++) {
        towards(v[i], q, p[i]);
        way[i] = (double)r->light[i] - (double)r->light[3] * q[i];
    }
    for (int i = 0; i < 3; i++) {
        double *a = v[(i + 1) % 3], *b = v[(i + 2) % 3];
        double size = DOUBT * sv_length(way) * sv_length(a) * sv_length(b);
        at[i] = det(way, a, b);
        above += at[i] > size;
        below += at[i] < -size;
    }
    if (above > 0 && below > 0)
        return true;
    if (above < 3 && below < 3) {
        double a[3], b[3];
        for (int i = 0; i < 3; i++) {
            a[i] = v[1][i] - v[0][i];
            b[i] = v[2][i] - v[0][i];
        }
        const double n[3] = {a[1] * b[2] - a[2] * b[1],
                             a[2] * b[0] - a[0] * b[2],
                             a[0] * b[1] - a[1] * b[0]};
        return sv_length(n) == 0; /* no area hides nothing */
    }
    /* q + s way lies in the plane at s = whole / (sum of at). */
    sign = above == 3 ? 1 : -1;
    whole = det(v[0], v[1], v[2]);
    scale = at[0] + at[1] + at[2];
    if (fabs(whole) <= doubt(v) ||
        (r->light[3] != 0 && fabs(whole - scale) <= DOUBT * fabs(scale)))
        return false;
    if (whole / scale > 0 && (r->light[3] == 0 || whole / scale < 1))
        *sum += r->parts & HL_SHADOW_TWO_SIDED ? 1 : sign > 0;
    return true;
}

static bool hidden_by(const struct sv_rig *r, const double q[3], int *sum)
{
    *sum = 0;
    for (uint32_t t = 0; t < r->input.n_indices / 3; t++) {
        float p[3][3];
        if (input_triangle(&r->input, t, p) && !between(r, p, q, sum))
            return false;
    }
    return true;
}

/* ---- the two compared -------------------------------------------------- */

/* Anywhere, or on a way from the light through a face. */
static void random_point(struct sv_rig *r, double q[3])
{
    uint32_t t = mk_below(&r->random, r->input.n_indices / 3);
    float p[3][3];
    double at = ck_between(&r->random, 0.2, 3), weight[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        q[i] = ck_between(&r->random, -3, 3);
        sum += weight[i] = ck_between(&r->random, 0.01, 1);
    }
    if (mk_below(&r->random, 3) == 0 || !input_triangle(&r->input, t, p))
        return;
    for (int i = 0; i < 3; i++) {
        double c = 0, l = (double)r->light[i];
        for (int k = 0; k < 3; k++)
            c += (double)p[k][i] * weight[k] / sum;
        q[i] = r->light[3] != 0 ? l + (c - l) * at : c - l * (at - 1);
    }
}

static void compare_points(struct sv_rig *r, uint32_t n, struct sv_seen *seen)
{
    for (uint32_t i = 0; i < n; i++) {
        double q[3];
        int wound, hidden;
        random_point(r, q);
        if (!winding(r, q, &wound) || !hidden_by(r, q, &hidden))
            continue;
        if (wound != hidden)
            fail_msg("light %g %g %g %g: the volume winds %d times about "
                     "%g %g %g, which %d faces hide",
                     (double)r->light[0], (double)r->light[1],
                     (double)r->light[2], (double)r->light[3], wound, q[0],
                     q[1], q[2], hidden);
        seen->tried++;
        seen->in_shadow += hidden > 0;
        seen->deeper += hidden > 1;
    }
}

/* Net directed edges of triangles; twins are one point where they are. The
 * sum of their magnitudes is 0 for a closed chain. */
struct net { uint32_t a, b; int sign; };

static int by_ends(const void *x, const void *y)
{
    const struct net *s = x, *t = y;
    if (s->a != t->a)
        return s->a < t->a ? -1 : 1;
    return s->b < t->b ? -1 : s->b > t->b;
}

static uint32_t boundary(const struct sv_rig *r, const uint32_t *index,
                         uint32_t n)
{
    struct net *net = malloc((n + 1) * sizeof *net);
    uint32_t sum = 0;
    assert_non_null(net);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t a = index[k], b = index[k % 3 == 2 ? k - 2 : k + 1];
        if (r->light[3] == 0 && a & 1)
            a = 1;
        if (r->light[3] == 0 && b & 1)
            b = 1;
        net[k] = (struct net){a < b ? a : b, a < b ? b : a, a < b ? 1 : -1};
    }
    qsort(net, n, sizeof *net, by_ends);
    for (uint32_t k = 0; k < n;) {
        int sign = 0;
        uint32_t from = k;
        for (; k < n && by_ends(&net[from], &net[k]) == 0; k++)
            sign += net[k].sign;
        sum += (uint32_t)abs(sign);
    }
    free(net);
    return sum;
}

void sv_check_chain(const struct sv_rig *r)
{
    uint32_t each = r->light[3] == 0 ? 3 : 6;
    assert_int_equal(r->n % 3, 0);
    for (uint32_t k = 0; k < r->n; k++)
        assert_true(r->indices[k] < 2 * r->mesh.n_vertices);
    assert_int_equal(boundary(r, r->indices, r->n), 0);
    /* No quad more than the lit faces' boundary has edges. */
    assert_int_equal(boundary(r, r->indices, r->counts.n_front) * each,
                     r->counts.n_sides);
}

struct sv_seen sv_compare(struct sv_rig *r, uint32_t lights, uint32_t points)
{
    struct sv_seen seen = {0, 0, 0};
    sv_prepare(r);
    for (uint32_t i = 0; i < 2 * lights; i++) {
        sv_random_light(r, i % 2 ? 0.0f : 1.0f);
        r->parts = HL_SHADOW_CLOSED | (i % 8 > 5 ? HL_SHADOW_TWO_SIDED : 0);
        sv_cast(r);
        sv_check_chain(r);
        compare_points(r, points, &seen);
    }
    /* It is about shadows; a way through a triangle without area is one
     * along an edge, and in doubt. */
    assert_true(seen.tried > lights * points);
    assert_true(seen.in_shadow > seen.tried / 8);
    return seen;
}

