/* SPDX-License-Identifier: Zlib */
/* Tangents from uvs. A frame is what corners share that agree in position,
 * normal, uv and handedness; its tangent is the sum over its corners of the
 * triangle's unit dP/du, projected into the normal's plane, normalised and
 * weighted by the angle of the corner, so that how a polygon was cut into
 * triangles does not show. */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"

enum { HAND_RIGHT = 0, HAND_LEFT = 1, HAND_FREE = 2, FRAME_WORDS = 5 };

/* Sums shorter than this share of their weights have cancelled: what is left
 * is rounding, float uvs being good to 6e-8. */
#define CANCELLED 1e-6

/* ---- triangles ------------------------------------------------------- */

struct uv_face {
    double edge[3][3];       /* unit, from corner i to corner i + 1          */
    double normal[3];        /* unit, by winding                             */
    double tangent[3];       /* unit dP/du                                   */
    bool mirrored;           /* uv area is negative                          */
};

static void read_uv(const struct hl_mesh_work *work, size_t corner,
                    float out[2])
{
    hl_mesh_read(out, work->desc.uvs, work->desc.uv_stride,
                 work->corner[corner], 2);
}

/* dP/du = (e1 dv2 - e2 dv1) / det, of which only the direction is wanted.
 * False when the uvs are not finite or span no area. */
static bool face_tangent(struct uv_face *face, const double e1[3],
                         const double e2[3], const float uv[6])
{
    double u1 = (double)uv[2] - (double)uv[0];
    double v1 = (double)uv[3] - (double)uv[1];
    double u2 = (double)uv[4] - (double)uv[0];
    double v2 = (double)uv[5] - (double)uv[1];
    double det = u1 * v2 - u2 * v1, sign = det < 0 ? -1 : 1;
    if (det == 0 || !hl_mesh_finite(uv, 6))
        return false;
    face->mirrored = det < 0;
    for (int i = 0; i < 3; i++)
        face->tangent[i] = sign * (e1[i] * v2 - e2[i] * v1);
    (void)hl_mesh_normalise(face->tangent); /* edges are independent */
    return true;
}

static bool read_face(const struct hl_mesh_work *work, uint32_t triangle,
                      struct uv_face *face)
{
    float p[3][3], uv[6];
    double e1[3], e2[3];
    hl_mesh_triangle(work, triangle, p);
    for (size_t i = 0; i < 3; i++)
        read_uv(work, 3 * (size_t)triangle + i, &uv[2 * i]);
    hl_mesh_edge(e1, p[0], p[1]);
    hl_mesh_edge(e2, p[0], p[2]);
    if (!face_tangent(face, e1, e2, uv))
        return false;
    hl_mesh_cross(face->normal, e1, e2);
    (void)hl_mesh_normalise(face->normal);
    for (int i = 0; i < 3; i++) {
        hl_mesh_edge(face->edge[i], p[i], p[(i + 1) % 3]);
        (void)hl_mesh_normalise(face->edge[i]);
    }
    return true;
}

/* cross(n, T) points along dP/dv where the uv area is positive and n is on
 * the side that the winding faces; each of the two turned over turns it. */
static uint32_t hand_of(const struct hl_mesh_work *work,
                        const struct uv_face *face, uint32_t normal)
{
    double n[3];
    hl_mesh_unit_normal(work, normal, n);
    bool behind = hl_mesh_dot(n, face->normal) < 0;
    bool left = (face->mirrored != behind) != work->desc.v_down;
    return left ? HAND_LEFT : HAND_RIGHT;
}

/* ---- frames ---------------------------------------------------------- */

static void frame_key(const struct hl_mesh_work *work, size_t corner,
                      uint32_t hand, uint32_t key[FRAME_WORDS])
{
    float uv[2];
    read_uv(work, corner, uv);
    key[0] = work->corner_position[corner];
    key[1] = work->corner_normal[corner];
    hl_mesh_float_key(&key[2], uv, 2);
    key[4] = hand;
}

static enum hl_result find_sure_frames(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    for (uint32_t t = 0; t < work->n_triangles && result == HL_OK; t++) {
        struct uv_face face;
        bool sure = read_face(work, t, &face);
        for (size_t i = 0, c = 3 * (size_t)t; i < 3; i++, c++) {
            uint32_t key[FRAME_WORDS];
            work->corner_frame[c] = HL_MESH_NONE;
            if (!sure)
                continue;
            frame_key(work, c, hand_of(work, &face, work->corner_normal[c]),
                      key);
            work->corner_frame[c] = hl_weld_add(&work->frames, key, &result);
        }
    }
    return result;
}

/* A corner of a triangle without a tangent of its own takes a neighbour's
 * frame, the right-handed one first. */
static enum hl_result find_free_frames(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    size_t n_corners = 3 * (size_t)work->n_triangles;
    for (size_t c = 0; c < n_corners && result == HL_OK; c++) {
        uint32_t key[FRAME_WORDS], *frame = &work->corner_frame[c];
        if (*frame != HL_MESH_NONE)
            continue;
        frame_key(work, c, HAND_RIGHT, key);
        *frame = hl_weld_find(&work->frames, key);
        if (*frame != HL_MESH_NONE)
            continue;
        key[4] = HAND_LEFT;
        *frame = hl_weld_find(&work->frames, key);
        if (*frame != HL_MESH_NONE)
            continue;
        key[4] = HAND_FREE;
        *frame = hl_weld_add(&work->frames, key, &result);
    }
    return result;
}

/* Angle of two unit vectors, within 1e-12, from sqrt and rational arithmetic
 * only: acos and atan2 differ between mathematics libraries. tan(angle / 4) =
 * |a - b| / (2 + |a + b|); two halvings bring the angle to pi / 16 at most,
 * where the arc tangent's series to the 15th power is exact to 7e-14. */
static double angle_of(const double a[3], const double b[3])
{
    double minus[3], plus[3], x, x2, sum = 0;
    for (int i = 0; i < 3; i++) {
        minus[i] = a[i] - b[i];
        plus[i] = a[i] + b[i];
    }
    x = sqrt(hl_mesh_dot(minus, minus)) / (2 + sqrt(hl_mesh_dot(plus, plus)));
    for (int i = 0; i < 2; i++)
        x = x / (1 + sqrt(1 + x * x));
    x2 = x * x;
    for (int i = 15; i > 0; i -= 2)
        sum = (i % 4 == 1 ? 1.0 : -1.0) / i + x2 * sum;
    return 16 * x * sum;
}

static void add_corner(struct hl_mesh_work *work, const struct uv_face *face,
                       size_t c)
{
    double n[3], t[3], back[3];
    double *sum = &work->frame_sum[4 * (size_t)work->corner_frame[c]];
    size_t i = c % 3;
    hl_mesh_unit_normal(work, work->corner_normal[c], n);
    double along = hl_mesh_dot(n, face->tangent);
    for (int k = 0; k < 3; k++) {
        t[k] = face->tangent[k] - along * n[k];
        back[k] = -face->edge[(i + 2) % 3][k];
    }
    double weight = angle_of(face->edge[i], back);
    sum[3] += weight;
    if (hl_mesh_normalise(t))
        for (int k = 0; k < 3; k++)
            sum[k] += weight * t[k];
}

static enum hl_result sum_tangents(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    work->frame_sum = hl_mem_new(&work->hooks, work->frames.n,
                                 4 * sizeof(double), &result);
    if (result != HL_OK)
        return result;
    memset(work->frame_sum, 0, work->frames.n * (4 * sizeof(double)));
    for (uint32_t t = 0; t < work->n_triangles; t++) {
        struct uv_face face;
        if (!read_face(work, t, &face))
            continue;
        for (size_t i = 0; i < 3; i++)
            add_corner(work, &face, 3 * (size_t)t + i);
    }
    return HL_OK;
}

enum hl_result hl_mesh_find_frames(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    if (!work->desc.uvs || work->desc.tangents || work->n_triangles == 0)
        return HL_OK;
    work->corner_frame = hl_mem_new(&work->hooks, work->n_triangles,
                                    3 * sizeof(uint32_t), &result);
    if (result == HL_OK)
        result = find_sure_frames(work);
    if (result == HL_OK)
        result = find_free_frames(work);
    if (result == HL_OK)
        result = sum_tangents(work);
    return result;
}

/* ---- output ---------------------------------------------------------- */

/* The axis that the normal is farthest from, turned into its plane. */
static void any_tangent(const double n[3], float out[4])
{
    double axis[3] = {0, 0, 0}, t[3];
    int least = fabs(n[1]) < fabs(n[0]);
    if (fabs(n[2]) < fabs(n[least]))
        least = 2;
    axis[least] = 1;
    hl_mesh_cross(t, n, axis);
    (void)hl_mesh_normalise(t);
    for (int i = 0; i < 3; i++)
        out[i] = (float)t[i];
    out[3] = 1;
}

static bool given_tangent(const struct hl_mesh_work *work, uint32_t vertex,
                          float out[4])
{
    float t[4];
    hl_mesh_read(t, work->desc.tangents, work->desc.tangent_stride, vertex, 4);
    if (!hl_mesh_direction(t))
        return false;
    memcpy(out, t, 3 * sizeof *out);
    out[3] = t[3] < 0 ? -1.0f : 1.0f;
    return true;
}

static bool summed_tangent(const struct hl_mesh_work *work, uint32_t frame,
                           float out[4])
{
    uint32_t hand = work->frames.keys[FRAME_WORDS * (size_t)frame + 4];
    const double *sum = &work->frame_sum[4 * (size_t)frame];
    double t[3] = {sum[0], sum[1], sum[2]}, least = CANCELLED * sum[3];
    if (hl_mesh_dot(t, t) <= least * least)
        return false;
    (void)hl_mesh_normalise(t);
    for (int i = 0; i < 3; i++)
        out[i] = (float)t[i];
    out[3] = hand == HAND_LEFT ? -1.0f : 1.0f;
    return true;
}

bool hl_mesh_tangent(const struct hl_mesh_work *work, const uint32_t *vertex,
                     float out[4])
{
    double n[3];
    bool found = work->desc.tangents ? given_tangent(work, vertex[0], out)
                                     : summed_tangent(work, vertex[3], out);
    if (found)
        return true;
    hl_mesh_unit_normal(work, vertex[2], n);
    any_tangent(n, out);
    return false;
}
