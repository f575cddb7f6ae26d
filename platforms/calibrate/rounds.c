/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "platforms/calibrate/calibrate.h"

/* ---- times -------------------------------------------------------------- */

static double busy_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Of a processor that draws: what it worked, all threads together. What else
 * runs on the machine does not come into it. */
static bool draw(struct hlk_frame *f, bool busy, double *ms)
{
    double start = busy_ms();
    bool ok = hlc_shot_draw(&f->shot, ms) == HL_OK;
    if (busy)
        *ms = busy_ms() - start;
    return ok;
}

/* In turn, so that what else the machine does is spread over all alike; every
 * second round backwards, or a frame would always follow the same one. */
bool hlk_time(struct hlk_frame *frame, uint32_t n, uint32_t rounds, bool busy)
{
    for (uint32_t r = 0; r <= rounds; r++)
        for (uint32_t k = 0; k < n; k++) {
            struct hlk_frame *f = &frame[r % 2 ? n - 1 - k : k];
            double ms = NAN;
            if (f->shot.renderer && !draw(f, busy, &ms))
                return false;
            if (r > 0)
                f->ms[r - 1] = ms;
        }
    return true;
}

static int by_size(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

struct hlk_value hlk_value_of(const double *v, uint32_t n)
{
    double sorted[HLK_ROUNDS];
    uint32_t k = 0;
    for (uint32_t i = 0; i < n && i < HLK_ROUNDS; i++)
        if (isfinite(v[i]))
            sorted[k++] = v[i];
    if (k == 0)
        return (struct hlk_value){ NAN, NAN, NAN, 0 };
    qsort(sorted, k, sizeof *sorted, by_size);
    double middle = (sorted[(k - 1) / 2] + sorted[k / 2]) / 2;
    return (struct hlk_value){ middle, sorted[k / 4], sorted[k - 1 - k / 4],
                               k };
}

/* Of n normal values the median deviates by 1.25 / root n of what one does,
 * and that is the quartiles' distance / 1.35. */
bool hlk_is_sure(const struct hlk_value *v)
{
    double one = (v->high - v->low) / 1.35;
    return v->n > 2 && v->median > 2 * 1.25 * one / sqrt(v->n);
}

/* ---- notes -------------------------------------------------------------- */

void hlk_note(struct hlk_notes *notes, const char *key, const char *format,
              ...)
{
    va_list args;
    uint32_t i = 0;
    while (i < notes->n && strcmp(notes->note[i].key, key))
        i++;
    if (i == HLK_NOTES)
        return;
    notes->n += i == notes->n;
    snprintf(notes->note[i].key, sizeof notes->note[i].key, "%s", key);
    va_start(args, format);
    vsnprintf(notes->note[i].text, sizeof notes->note[i].text, format, args);
    va_end(args);
}

const char *hlk_note_of(void *user, const char *key)
{
    const struct hlk_notes *notes = user;
    if (!key[0])
        return notes->head;
    for (uint32_t i = 0; i < notes->n; i++)
        if (!strcmp(notes->note[i].key, key))
            return notes->note[i].text;
    return NULL;
}

/* ---- values ------------------------------------------------------------- */

static float *slot(struct hl_caps *caps, const char *key)
{
    char name[HLC_CALIBRATION_KEY];
    float *value;
    for (uint32_t i = 0;
         (value = hlc_calibration_value(caps, i, name, NULL)) != NULL; i++)
        if (!strcmp(name, key))
            return value;
    return NULL;
}

void hlk_take(struct hl_caps *caps, struct hlk_notes *notes, const char *key,
              const double *v, uint32_t n, bool may_be_0)
{
    struct hlk_value x = hlk_value_of(v, n);
    float *to = slot(caps, key);
    bool is_format = !strncmp(key, "cost.format_", 12);
    if (x.n == 0) {
        if (!is_format)
            hlk_note(notes, key, "built-in: this machine draws no such "
                     "frame");
    } else if (hlk_is_sure(&x) || (may_be_0 && x.median >= 0)) {
        *to = (float)x.median;
        hlk_note(notes, key, "quartiles %.3g to %.3g of %u rounds", x.low,
                 x.high, (unsigned)x.n);
    } else {
        hlk_note(notes, key, "built-in: %.3g, %.3g to %.3g, does not tell "
                 "it from 0", x.median, x.low, x.high);
    }
}
