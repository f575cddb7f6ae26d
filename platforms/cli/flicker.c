/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/flicker.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hlc_flicker_begin(struct hlc_flicker *f, uint32_t width, uint32_t height)
{
    size_t n = (size_t)width * height * 3;
    memset(f, 0, sizeof *f);
    f->width = width;
    f->height = height;
    f->error = calloc(n ? n : 1, sizeof *f->error);
    f->before = calloc(n ? n : 1, sizeof *f->before);
    if (f->error && f->before)
        return true;
    hlc_flicker_end(f);
    return false;
}

void hlc_flicker_end(struct hlc_flicker *f)
{
    free(f->error);
    free(f->before);
    memset(f, 0, sizeof *f);
}

/* Moves of less than a pixel: the four around lie within the border. */
static float error_at(const struct hlc_flicker *f, float x, float y, int c)
{
    float fx = x - floorf(x), fy = y - floorf(y);
    size_t x0 = (size_t)floorf(x), y0 = (size_t)floorf(y);
    size_t row = 3 * (size_t)f->width;
    const float *p = f->before + y0 * row + 3 * x0 + c;
    return (p[0] * (1 - fx) + p[3] * fx) * (1 - fy) +
           (p[row] * (1 - fx) + p[row + 3] * fx) * fy;
}

/* Pixels whose way back leads into the picture: a border is left out. */
static void add_changes(struct hlc_flicker *f, float dx, float dy)
{
    double sum = 0;
    uint32_t w = f->width, h = f->height;
    if (w < 4 || h < 4)
        return;
    for (uint32_t y = 1; y < h - 2; y++)
        for (uint32_t x = 1; x < w - 2; x++)
            for (int c = 0; c < 3; c++) {
                float was = error_at(f, (float)x - dx, (float)y - dy, c);
                float now = f->error[((size_t)y * w + x) * 3 + (size_t)c];
                double d = (double)fabsf(now - was);
                sum += d;
                f->worst = fmax(f->worst, d);
            }
    f->sum += sum / ((double)(w - 3) * (h - 3) * 3);
}

void hlc_flicker_add(struct hlc_flicker *f, const float *rgb,
                     const float *reference, const float jitter[2])
{
    size_t n = (size_t)f->width * f->height * 3;
    float *e = f->before;
    f->before = f->error;
    f->error = e;
    for (size_t i = 0; i < n; i++) {
        e[i] = rgb[i] - reference[i];
        f->square += (double)e[i] * (double)e[i];
        f->worst_error = fmax(f->worst_error, (double)fabsf(e[i]));
    }
    if (f->frames++ > 0)
        add_changes(f, jitter[0] - f->jitter[0], jitter[1] - f->jitter[1]);
    memcpy(f->jitter, jitter, sizeof f->jitter);
}

double hlc_flicker_f(const struct hlc_flicker *f)
{
    return f->frames > 1 ? f->sum / (f->frames - 1) : 0;
}

double hlc_flicker_rms(const struct hlc_flicker *f)
{
    double n = (double)f->width * f->height * 3 * f->frames;
    return n > 0 ? sqrt(f->square / n) : 0;
}

static float to_and_fro(double x)
{
    double turn = x - 4 * floor(x / 4);      /* 0..4: 0, 1, 0, -1            */
    return (float)(turn < 1 ? turn : turn < 3 ? 2 - turn : turn - 4);
}

void hlc_flicker_jitter(float out[2], uint32_t t, uint32_t steps)
{
    out[0] = to_and_fro((double)t / steps);
    out[1] = to_and_fro(t * 0.6 / steps);
}
