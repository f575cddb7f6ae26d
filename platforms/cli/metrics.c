/* SPDX-License-Identifier: Zlib */
/* Measures of single pixels; flip.c and ssim.c look at neighbourhoods. */
#include "platforms/cli/metrics.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- percentiles -------------------------------------------------------- */

/* Hoare's selection: values[k] becomes what sorting would put there. */
static float select_kth(float *v, size_t n, size_t k)
{
    size_t low = 0, high = n - 1;
    while (low < high) {
        float pivot = v[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (v[i] < pivot)
                i++;
            while (v[j] > pivot)
                j--;
            if (i >= j)
                break;
            float t = v[i];
            v[i++] = v[j];
            v[j--] = t;
        }
        if (k <= j)
            high = j;
        else
            low = j + 1;
    }
    return v[k];
}

float hlc_percentile(float *values, size_t n, double share)
{
    double rank = ceil(share * (double)n);
    size_t k = rank >= 1 ? (size_t)rank - 1 : 0;
    return select_kth(values, n, k < n ? k : n - 1);
}

/* ---- edges -------------------------------------------------------------- */

enum { EDGE_REACH = 2 };

static bool on_edge(const uint32_t *ids, size_t w, size_t h, size_t x,
                    size_t y)
{
    const uint32_t *p = ids + y * w + x;
    return (x > 0 && p[-1] != *p) || (x + 1 < w && p[1] != *p) ||
           (y > 0 && *(p - w) != *p) || (y + 1 < h && p[w] != *p);
}

/* A square dilation is one along rows, then one along columns. */
static void widen(uint8_t *dst, const uint8_t *src, size_t n, size_t stride)
{
    for (size_t i = 0; i < n; i++) {
        size_t from = i < EDGE_REACH ? 0 : i - EDGE_REACH;
        size_t to = i + EDGE_REACH < n ? i + EDGE_REACH : n - 1;
        uint8_t any = 0;
        for (size_t k = from; k <= to; k++)
            any |= src[k * stride];
        dst[i * stride] = any;
    }
}

bool hlc_edge_mask(uint8_t *mask, const uint32_t *ids, uint32_t width,
                   uint32_t height)
{
    size_t w = width, h = height;
    uint8_t *rows = malloc(w * h);
    if (!rows)
        return false;
    for (size_t y = 0; y < h; y++)
        for (size_t x = 0; x < w; x++)
            mask[y * w + x] = on_edge(ids, w, h, x, y);
    for (size_t y = 0; y < h; y++)
        widen(rows + y * w, mask + y * w, w, 1);
    for (size_t x = 0; x < w; x++)
        widen(mask + x, rows + x, h, w);
    free(rows);
    return true;
}

/* ---- codes -------------------------------------------------------------- */

/* Linear values at which the 8-bit sRGB code (IEC 61966-2-1, rounded to
 * nearest) goes up by one: bound[c] is where c ends. */
static void code_bounds(float bound[255])
{
    for (int c = 0; c < 255; c++) {
        double v = (c + 0.5) / 255.0;
        bound[c] = (float)(v <= 0.04045 ? v / 12.92
                                        : pow((v + 0.055) / 1.055, 2.4));
    }
}

static int code_of(const float bound[255], float value)
{
    int low = 0, high = 255;
    while (low < high) {
        int middle = (low + high) / 2;
        if (value >= bound[middle])
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static double share_within_one(const float *test, const float *reference,
                               size_t n_pixels)
{
    float bound[255];
    size_t good = 0;
    code_bounds(bound);
    for (size_t i = 0; i < n_pixels; i++) {
        bool within = true;
        for (size_t c = 3 * i; c < 3 * i + 3; c++)
            within = within && abs(code_of(bound, test[c]) -
                                   code_of(bound, reference[c])) <= 1;
        good += within;
    }
    return (double)good / (double)n_pixels;
}

static double code_unrounded(double v)
{
    v = v < 0 ? 0 : v > 1 ? 1 : v;
    return 255.0 * (v <= 0.0031308 ? 12.92 * v
                                   : 1.055 * pow(v, 1 / 2.4) - 0.055);
}

double hlc_rms_codes(const struct hlh_picture *a, const struct hlh_picture *b)
{
    size_t n = (size_t)a->width * a->height * 3;
    double squares = 0;
    for (size_t i = 0; i < n; i++) {
        /* Most pixels of two plans are equal, and powers are slow. */
        if (a->rgb[i] == b->rgb[i])
            continue;
        double e = code_unrounded((double)a->rgb[i]) -
                   code_unrounded((double)b->rgb[i]);
        squares += e * e;
    }
    return sqrt(squares / (double)n);
}

/* ---- errors ------------------------------------------------------------- */

static double peak_of(const float *reference, size_t n)
{
    double peak = 0;
    for (size_t i = 0; i < n; i++)
        peak = (double)reference[i] > peak ? (double)reference[i] : peak;
    return peak > 0 ? peak : 1.0;
}

/* Fills the sums, and error[i] = |e|. */
static void sum_errors(struct hlc_metrics *out, float *error,
                       const float *test, const float *reference, size_t n)
{
    double squares = 0, relative = 0, absolute = 0, max = 0;
    for (size_t i = 0; i < n; i++) {
        double r = (double)reference[i], e = (double)test[i] - r;
        double a = fabs(e);
        squares += e * e;
        relative += e * e / (r * r + 0.01);
        absolute += a;
        max = a > max ? a : max;
        error[i] = (float)a;
    }
    out->peak = peak_of(reference, n);
    out->psnr = squares > 0
                ? 10.0 * log10(out->peak * out->peak / (squares / (double)n))
                : (double)INFINITY;
    out->relmse = relative / (double)n;
    out->mae = absolute / (double)n;
    out->max = max;
}

static void sum_edges(struct hlc_metrics *out, const float *error,
                      const uint8_t *mask, size_t n_pixels)
{
    double sum[2] = { 0, 0 };
    uint64_t n[2] = { 0, 0 };
    for (size_t i = 0; i < n_pixels; i++) {
        const float *e = error + 3 * i;
        sum[mask[i]] += (double)e[0] + (double)e[1] + (double)e[2];
        n[mask[i]]++;
    }
    out->edge_pixels = n[1];
    out->edge_mae = n[1] ? sum[1] / (3.0 * (double)n[1]) : (double)NAN;
    out->rest_mae = n[0] ? sum[0] / (3.0 * (double)n[0]) : (double)NAN;
}

static bool measure_edges(struct hlc_metrics *out, const float *error,
                          const uint32_t *ids, uint32_t width, uint32_t height)
{
    size_t n = (size_t)width * height;
    out->edge_pixels = 0;
    out->edge_mae = out->rest_mae = (double)NAN;
    if (!ids)
        return true;
    uint8_t *mask = malloc(n);
    bool ok = mask && hlc_edge_mask(mask, ids, width, height);
    if (ok)
        sum_edges(out, error, mask, n);
    free(mask);
    return ok;
}

static bool measure_flip(struct hlc_metrics *out, float *map,
                         const struct hlh_picture *test,
                         const struct hlh_picture *reference)
{
    size_t n = (size_t)test->width * test->height;
    double sum = 0;
    if (!hlc_flip_map(map, test, reference))
        return false;
    for (size_t i = 0; i < n; i++)
        sum += (double)map[i];
    out->flip = sum / (double)n;
    out->flip_p99 = (double)hlc_percentile(map, n, 0.99);
    return true;
}

bool hlc_metrics_measure(struct hlc_metrics *out,
                         const struct hlh_picture *test,
                         const struct hlh_picture *reference,
                         const uint32_t *ids)
{
    size_t n_pixels = (size_t)test->width * test->height, n = n_pixels * 3;
    float *error = malloc(n * sizeof *error);
    memset(out, 0, sizeof *out);
    if (!error)
        return false;
    sum_errors(out, error, test->rgb, reference->rgb, n);
    bool ok = measure_edges(out, error, ids, test->width, test->height);
    out->p999 = (double)hlc_percentile(error, n, 0.999);
    out->rms_codes = hlc_rms_codes(test, reference);
    out->within_1_255 = share_within_one(test->rgb, reference->rgb, n_pixels);
    /* The errors are done with: their room takes the map. */
    ok = ok && measure_flip(out, error, test, reference) &&
         hlc_ssim(&out->ssim, test, reference);
    free(error);
    return ok;
}
