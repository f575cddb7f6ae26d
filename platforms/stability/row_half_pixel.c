/* SPDX-License-Identifier: Zlib */
/* A ramp of light, moved by parts of a pixel: how far a picture is found to be
 * from the reference renderer's, which stays, by least squares. What puts light
 * beside its surface, as the pixel centres of Direct3D 9 do, moves the place
 * where that is nothing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/reference.h"
#include "platforms/stability/flat.h"

enum { SIDE = 64, BORDER = 8 };

enum { AXIS, MEASURE, CENTRES };                   /* hls_case.arg           */
enum { SHIFT, MISS, CODES };                       /* of MEASURE             */
enum { AS_ASKED, NOBODY, STATE, VERTEX };          /* of CENTRES             */

/* Light at the two ends, BORDER pixels outside of the picture; it also changes
 * a little the other way, or all of a column would be rounded alike. */
#define LOW 0.2
#define HIGH 0.9
#define OTHER 0.05

static void ramp(struct hls_flat *f, int axis)
{
    double half = f->width / 2.0, reach = half + BORDER;
    double middle[2] = { half, half }, a[2] = { reach, 0 }, b[2] = { 0, reach };
    hls_flat_piece(f, middle, a, b, 0, 1);
    for (uint32_t i = 0; i < f->b.n_vertices; i++) {
        struct hlh_vertex *v = &f->b.vertices[i];
        float at = axis ? -v->position[1] : v->position[0];
        float other = axis ? v->position[0] : v->position[1];
        double light = (at < 0 ? LOW : HIGH) + (other < 0 ? -OTHER : OTHER);
        v->normal[0] = (float)sqrt(1 - light * light);
        v->normal[2] = (float)light;
    }
    hls_flat_object(f, 1, 1);
}

/* Steps of the reference's red from pixel to pixel, and red itself: what a
 * small move right, one down and a change of brightness add to it. */
static void directions(double d[3], const float *q, uint32_t side, size_t i)
{
    d[0] = -((double)q[i + 3] - (double)q[i - 3]) / 2;
    d[1] = -((double)q[i + 3 * side] - (double)q[i - 3 * side]) / 2;
    d[2] = (double)q[i];
}

static double determinant(double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Pixels by which p is moved along the axis against q. Brightness is fitted as
 * well: blending that truncates takes a share of all light. */
static double shift(const float *p, const float *q, uint32_t side, int axis)
{
    double m[3][3] = {{0}}, v[3] = {0}, d[3];
    for (uint32_t y = BORDER; y < side - BORDER; y++)
        for (uint32_t x = BORDER; x < side - BORDER; x++) {
            size_t i = 3 * ((size_t)y * side + x);
            directions(d, q, side, i);
            for (int j = 0; j < 3; j++) {
                v[j] += d[j] * ((double)p[i] - (double)q[i]);
                for (int k = 0; k < 3; k++)
                    m[j][k] += d[j] * d[k];
            }
        }
    double whole = determinant(m);
    for (int j = 0; j < 3; j++)
        m[j][axis] = v[j];
    return determinant(m) / whole;
}

static double code(float x)
{
    double v = fmin(fmax((double)x, 0), 1);
    return 255 * (v <= 0.0031308 ? 12.92 * v
                                 : 1.055 * pow(v, 1 / 2.4) - 0.055);
}

static double most_codes(const float *p, const float *q, uint32_t side)
{
    double most = 0;
    for (uint32_t y = BORDER; y < side - BORDER; y++)
        for (uint32_t x = BORDER; x < side - BORDER; x++) {
            size_t i = 3 * ((size_t)y * side + x);
            most = fmax(most, fabs(code(p[i]) - code(q[i])));
        }
    return most;
}

static struct hlc_options options(const struct hls_lab *lab,
                                  const struct hls_case *c, double p)
{
    static const enum hl_half_pixel who[] = { HL_HALF_PIXEL_AUTO,
        HL_HALF_PIXEL_NONE, HL_HALF_PIXEL_STATE, HL_HALF_PIXEL_VERTEX };
    struct hlc_options o = hls_flat_options(lab, SIDE, SIDE, 5);
    o.jitter[(int)c->arg[AXIS]] = p;
    if (c->arg[CENTRES] != AS_ASKED) {
        o.profile = "xbox360";
        o.half_pixel = who[(int)c->arg[CENTRES]];
    }
    return o;
}

static bool compare(double *m, const struct hlh_picture *p, double offset,
                    const struct hls_case *c, struct hls_lab *lab)
{
    struct hlr_options r = { .width = p->width, .height = p->height,
                             .no_specular = true, .threads = 1 };
    size_t n = (size_t)p->width * p->height * 3;
    float *q = malloc(n * sizeof *q);
    int axis = (int)c->arg[AXIS];
    bool ok = q && hlr_render(q, NULL, &lab->stage.scene, &r, NULL);
    if (ok && c->arg[MEASURE] == CODES)
        *m = most_codes(p->rgb, q, p->width);
    else if (ok)
        *m = shift(p->rgb, q, p->width, axis);
    if (ok && c->arg[MEASURE] == MISS)
        *m = fabs(*m - offset);
    free(q);
    return ok || hls_broken(lab, "no reference picture");
}

/* p: pixels that the picture is moved right or down. */
static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c, p);
    struct hls_flat f;
    struct hlh_picture picture;
    hls_flat_begin(&f, o.width, o.height);
    ramp(&f, (int)c->arg[AXIS]);
    if (!hls_flat_end(&f, lab, &o) || !hls_flat_draw(&picture, lab, &o))
        return false;
    bool ok = compare(m, &picture, p, c, lab);
    hlh_picture_free(&picture);
    return ok;
}

static bool open(struct hls_lab *lab, const struct hls_case *c,
                 const char **skip)
{
    if (c->arg[CENTRES] != AS_ASKED && strcmp(lab->o->backend, "packemu"))
        *skip = "needs a machine with integer pixel centres: packemu's xbox360";
    return true;
}

/* A shift of 0.02 pixels is what passes (packing and rounding of light are
 * below); the bisection adds as much. Left alone, integer centres put what the
 * L-buffer holds half an L texel off: 0.8 pixels at 5/8. The ramp's steepest
 * place rises by 2.17 codes a pixel (light linear in the normal, sRGB), and
 * rounding takes up to a fifth of a code (10 bits of light). */
#define ZERO(name, what, axis, centres) \
    { name, what, -1, 1, 0, false, -0.02, 0.04, \
      "light lies where its surface lies: 0", { axis, SHIFT, centres } }

static const struct hls_case cases[] = {
    ZERO("across", "shift found, x", 0, AS_ASKED),
    ZERO("down", "shift found, y", 1, AS_ASKED),
    ZERO("state", "the same, integer centres, offset state", 0, STATE),
    ZERO("vertex", "the same, by the vertex stage", 1, VERTEX),
    { "nobody", "the same, put right by nobody", -1, 1, 0, false, -0.82, -0.76,
      "half an L texel = 0.8 pixels", { 0, SHIFT, NOBODY } },
    { "miss", "shift found less shift put in", -1, 1, 0.02, false, NAN, NAN,
      "within 0.02 of a pixel at every offset", { 0, MISS } },
    { "code", "largest difference, 8-bit codes", 0, 1, 1, false, 0.37, 0.5,
      "1 code / 2.17 codes a pixel = 0.46", { 0, CODES } },
};

const struct hls_row hls_row_half_pixel = {
    "half_pixel", "Light is read half a pixel beside its surface",
    "K 5.1", "offset", "pixels", "shift found (pixels, codes)",
    HLS_LINEAR, cases, sizeof cases / sizeof *cases, open, NULL, measure
};
