/* SPDX-License-Identifier: Zlib */
/* Triangles that are none: without area, with an index twice, with a vertex
 * that is no number. Drawn, they must leave the picture that is drawn without
 * them; prepared, each must be found, and cost no more than a good one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "core/mesh.h"
#include "platforms/stability/rig.h"

enum { CELLS = 16, TRIANGLES = CELLS * CELLS * 2, SIDE = 64 };
enum what { DRAWN, PREPARED, STEPS, BYTES };
enum kind { WHOLE, REPEATED, POINT, LINE, NOT_A_NUMBER, INFINITE };

/* ---- a mesh ------------------------------------------------------------- */

/* Squares from -1 to 1, each vertex its triangle's own. */
struct mesh {
    float (*position)[3];
    uint32_t *index;
    uint32_t n, n_vertices;      /* n: triangles                             */
};

static void mesh_free(struct mesh *m)
{
    free(m->position);
    free(m->index);
}

static bool mesh_make(struct mesh *m, uint32_t cells)
{
    static const uint8_t corner[6] = { 0, 1, 3, 0, 3, 2 };
    m->n = cells * cells * 2;
    m->n_vertices = 3 * m->n;
    m->position = malloc(sizeof *m->position * m->n * 3);
    m->index = malloc(sizeof *m->index * m->n * 3);
    if (!m->position || !m->index) {
        mesh_free(m);
        return hls_rig_fail("degenerate", HL_ERR_MEMORY);
    }
    for (uint32_t i = 0; i < m->n * 3; i++) {
        uint32_t cell = i / 6, k = corner[i % 6];
        m->position[i][0] = (float)(cell % cells + (k & 1)) * 2 /
                            (float)cells - 1;
        m->position[i][1] = (float)(cell / cells + (k >> 1)) * 2 /
                            (float)cells - 1;
        m->position[i][2] = 0;
        m->index[i] = i;
    }
    return true;
}

static void break_triangle(struct mesh *m, uint32_t t, enum kind kind)
{
    float (*p)[3] = m->position + (size_t)3 * t;
    switch (kind) {
    case REPEATED:
        m->index[3 * t + 1] = m->index[3 * t];
        return;
    case POINT:
        memcpy(p[1], p[0], sizeof *p);
        memcpy(p[2], p[0], sizeof *p);
        return;
    case LINE:                   /* its middle: exact                        */
        for (int k = 0; k < 3; k++)
            p[2][k] = (p[0][k] + p[1][k]) / 2;
        return;
    case NOT_A_NUMBER:
        p[1][0] = (float)NAN;
        return;
    case INFINITE:
        p[2][1] = (float)INFINITY;
        return;
    default:
        return;
    }
}

/* Evenly spread, and those of a smaller share among them: the base-2 van der
 * Corput sequence. */
static bool chosen(uint32_t t, double share)
{
    double x = 0;
    for (double bit = 0.5; t; t >>= 1, bit /= 2)
        x += t & 1 ? bit : 0;
    return x < share;
}

static uint32_t break_share(struct mesh *m, double share, enum kind kind)
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < m->n; t++)
        if (chosen(t, share)) {
            break_triangle(m, t, kind);
            n++;
        }
    return n;
}

/* ---- drawn -------------------------------------------------------------- */

static bool put_buffer(hl_buf *out, struct hl_device *d, uint32_t usage,
                       const void *data, size_t bytes)
{
    struct hl_buf_desc b = { "mesh", bytes, usage, false, data };
    enum hl_result r = hl_buf_create(d, out, &b);
    return r == HL_OK || hls_rig_fail("degenerate", r);
}

/* The item's mesh becomes m: bridge_mesh.c's streams of positions, tangents
 * and normals. */
static bool upload(hl_buf buf[4], struct hl_item *it, const struct mesh *m,
                   struct hl_device *d)
{
    static const float tangent[4] = { 1, 0, 0, 1 }, normal[3] = { 0, 0, 1 };
    size_t n = m->n_vertices;
    float (*t)[4] = malloc(n * sizeof *t), (*z)[3] = malloc(n * sizeof *z);
    bool ok = t && z;
    for (size_t i = 0; ok && i < n; i++) {
        memcpy(t[i], tangent, sizeof *t);
        memcpy(z[i], normal, sizeof *z);
    }
    ok = ok && put_buffer(&buf[0], d, HL_BUF_VERTEX, m->position,
                          n * sizeof *m->position) &&
         put_buffer(&buf[1], d, HL_BUF_VERTEX, t, n * sizeof *t) &&
         put_buffer(&buf[2], d, HL_BUF_VERTEX, z, n * sizeof *z) &&
         put_buffer(&buf[3], d, HL_BUF_INDEX, m->index,
                    (size_t)m->n * sizeof(uint32_t[3]));
    free(t);
    free(z);
    for (int i = 0; i < 3; i++)
        it->vertex[i] = buf[i];
    it->index = buf[3];
    it->index16 = false;
    it->first = 0;
    it->base_vertex = 0;
    return ok;
}

static bool picture_of(struct hlh_picture *out, const struct mesh *m,
                       struct hls_lab *lab)
{
    struct hlc_shot *shot = lab->data;
    struct hl_device *d = lab->stage.machine.device;
    struct hl_item it = lab->stage.world.items[0];
    hl_buf buf[4] = { { 0 }, { 0 }, { 0 }, { 0 } };
    bool ok = upload(buf, &it, m, d);
    it.count = m->n * 3;
    shot->frame.items = &it;
    ok = ok && hls_rig_picture(out, shot);
    for (int i = 0; i < 4; i++)
        hl_buf_destroy(d, &buf[i]);
    return ok;
}

/* Pixels that differ from the picture of the good triangles alone. */
static bool drawn(double *m, double share, enum kind kind,
                  struct hls_lab *lab)
{
    struct mesh broken, good;
    struct hlh_picture a = { 0, 0, NULL, true }, b = a;
    if (!mesh_make(&broken, CELLS))
        return false;
    break_share(&broken, share, kind);
    if (!mesh_make(&good, CELLS)) {
        mesh_free(&broken);
        return false;
    }
    uint32_t n = 0;
    for (uint32_t t = 0; t < good.n; t++)
        if (!chosen(t, share))
            memmove(&good.index[3 * n++], &good.index[3 * t],
                    sizeof(uint32_t[3]));
    good.n = n;
    bool ok = picture_of(&a, &broken, lab);
    if (ok && n) {
        ok = picture_of(&b, &good, lab);
    } else if (ok) {             /* nothing: the background, black           */
        b.rgb = calloc((size_t)a.width * a.height * 3, sizeof(float));
        ok = b.rgb != NULL;
    }
    *m = 0;
    for (uint32_t i = 0; ok && i < a.width * a.height; i++)
        *m += memcmp(a.rgb + 3 * i, b.rgb + 3 * i, sizeof(float[3])) != 0;
    free(a.rgb);
    free(b.rgb);
    mesh_free(&broken);
    mesh_free(&good);
    return ok;
}

/* ---- prepared ----------------------------------------------------------- */

static void *take(void *user, size_t bytes)
{
    *(double *)user += (double)bytes;
    return malloc(bytes);
}

static void give(void *user, void *p)
{
    (void)user;
    free(p);
}

struct work { double steps, bytes; uint32_t found, groups; };

static bool prepare(struct work *out, const struct mesh *m)
{
    double bytes = 0;
    struct hl_hooks hooks = { take, give, &bytes };
    struct hl_mesh_prep prep;
    struct hl_mesh_desc d;
    memset(&d, 0, sizeof d);
    d.positions = m->position;
    d.n_vertices = m->n_vertices;
    d.n_indices = m->n * 3;
    d.indices = m->index;
    enum hl_result r = hl_mesh_prepare(&prep, &hooks, &d);
    if (r != HL_OK)
        return hls_rig_fail("degenerate", r);
    *out = (struct work){ (double)prep.stats.n_steps, bytes,
                          prep.stats.n_degenerate + prep.stats.n_non_finite,
                          prep.n_groups };
    hl_mesh_prep_free(&prep, &hooks);
    return true;
}

/* Steps against the whole mesh's, %; infinite where not all are found. */
static bool prepared(double *m, double share, enum kind kind)
{
    struct mesh mesh;
    struct work whole = { 0, 0, 0, 0 }, w = { 0, 0, 0, 0 };
    if (!mesh_make(&mesh, CELLS))
        return false;
    bool ok = prepare(&whole, &mesh);
    uint32_t n = break_share(&mesh, share, kind);
    ok = ok && prepare(&w, &mesh);
    mesh_free(&mesh);
    *m = w.found == n ? 100 * w.steps / whole.steps : INFINITY;
    return ok;
}

/* ---- a million ---------------------------------------------------------- */

enum { FEW = 1000 };

static bool work_of(struct work *w, uint32_t *n, double triangles,
                    enum kind kind)
{
    struct mesh mesh;
    if (!mesh_make(&mesh, (uint32_t)floor(sqrt(triangles / 2) + 0.5)))
        return false;
    break_share(&mesh, 0.5, kind);
    bool ok = prepare(w, &mesh);
    *n = mesh.n;
    mesh_free(&mesh);
    return ok;
}

/* Of work(p) ~ p^e: |e - 1|, %. */
static bool exponent(double *m, double p, const struct hls_case *c)
{
    struct work few, w;
    uint32_t n0, n;
    if (!work_of(&few, &n0, FEW, (enum kind)c->arg[1]) ||
        !work_of(&w, &n, p, (enum kind)c->arg[1]))
        return false;
    double ratio = c->arg[0] == (double)STEPS ? w.steps / few.steps
                                              : w.bytes / few.bytes;
    double more = log((double)n / n0);
    *m = more > 0 ? 100 * fabs(log(ratio) / more - 1) : 0;
    return true;
}

/* ---- the row ------------------------------------------------------------ */

static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct hlc_options o;
    (void)skip;
    if (c->arg[0] != (double)DRAWN)
        return true;
    hls_rig_options(&o, lab, SIDE, SIDE);
    hls_rig_begin(&rig, 2, 60);
    hls_rig_wall(&rig, 0, 1, 0);
    hlh_build_light(&rig.b, hlh_v3(0.2, 0.1, 1), 5, hlh_v3(1, 0.5, 0.25));
    struct hlc_shot *shot = calloc(1, sizeof *shot);
    lab->data = shot;
    return shot && hls_rig_end(&rig, lab, &o) && hls_rig_shot(shot, lab, &o);
}

static void end(struct hls_lab *lab)
{
    if (lab->data)
        hlc_shot_close(lab->data);
    free(lab->data);
    lab->data = NULL;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    if (c->arg[0] == (double)DRAWN)
        return drawn(m, p, (enum kind)c->arg[1], lab);
    if (c->arg[0] == (double)PREPARED)
        return prepared(m, p, (enum kind)c->arg[1]);
    /* The sweep is of shares: 10^3 to 10^6 triangles. */
    return exponent(m, FEW * pow(1000, p), c);
}

#define NOTHING "none: what covers no pixel's centre draws none"
#define DROPPED "none: not above 2.5 : 1.5 probes, all misses (half full)"
#define HASHED "none: expected O(n) by hashing (core/mesh.h)"

static const struct hls_case cases[] = {
    { "repeated", "an index twice, drawn", 0, 1, 0, false, NAN, NAN, NOTHING,
      { DRAWN, REPEATED, 0, 0 } },
    { "point", "three equal corners, drawn", 0, 1, 0, false, NAN, NAN,
      NOTHING, { DRAWN, POINT, 0, 0 } },
    { "line", "corners on a line, drawn", 0, 1, 0, false, NAN, NAN, NOTHING,
      { DRAWN, LINE, 0, 0 } },
    { "nan", "a corner that is no number, drawn", 0, 1, 0, false, NAN, NAN,
      NOTHING, { DRAWN, NOT_A_NUMBER, 0, 0 } },
    { "infinite", "a corner at infinity, drawn", 0, 1, 0, false, NAN, NAN,
      NOTHING, { DRAWN, INFINITE, 0, 0 } },
    { "groups-line", "on a line, prepared: steps, %", 0, 1, 167, false, NAN,
      NAN, DROPPED, { PREPARED, LINE, 0, 0 } },
    { "groups-nan", "no number, prepared: steps, %", 0, 1, 167, false, NAN,
      NAN, DROPPED, { PREPARED, NOT_A_NUMBER, 0, 0 } },
    { "steps", "10^(3 + 3 p) triangles: |e - 1| of steps, %", 0.3, 1, 20, false,
      NAN, NAN, HASHED, { STEPS, WHOLE, 0, 0 } },
    { "steps-line", "the same, half of them broken", 0.3, 1, 20, false, NAN,
      NAN, HASHED, { STEPS, LINE, 0, 0 } },
    { "bytes", "10^(3 + 3 p) triangles: |e - 1| of memory, %", 0.3, 1, 20,
      false, NAN, NAN, HASHED, { BYTES, WHOLE, 0, 0 } },
};

const struct hls_row hls_row_degenerate = {
    "degenerate", "Triangles without area or with broken corners",
    "conformance c; core/mesh.h", "share broken", "of all",
    "pixels that differ, or %", HLS_LINEAR, cases,
    sizeof cases / sizeof *cases, begin, end, measure
};
