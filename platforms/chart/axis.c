/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/axis.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Fewer marks do not tell a scale. */
enum { TICKS_MIN = 4 };
/* Octaves that an axis shows at least, and of air at each end for each of what
 * is shown. */
#define OCTAVES_MIN 0.25
#define AIR 0.07

double hlt_axis_pixel(const struct hlt_axis *a, double value)
{
    double share = log(value / a->low) / log(a->high / a->low);
    return a->from + share * (a->to - a->from);
}

static void add(struct hlt_axis *a, double value, const char *text)
{
    if (a->n == HLT_TICKS || value < a->low || value > a->high ||
        value <= a->zero * 1.0001)
        return;
    a->tick[a->n] = value;
    snprintf(a->text[a->n++], HLT_TICK_TEXT, "%s", text);
}

static void add_number(struct hlt_axis *a, double value)
{
    char text[HLT_TICK_TEXT];
    snprintf(text, sizeof text, "%.6g", value);
    add(a, value, text);
}

/* Multiples of 1, 2 or 5 of a power of ten: the widest steps that give enough
 * of them between two numbers. */
static double even_step(double low, double high)
{
    double step = pow(10, ceil(log10(high - low)));
    for (int k = 0; k < 12; k++) {
        if (floor(high / step) - ceil(low / step) + 1 >= TICKS_MIN)
            break;
        step /= k % 3 == 1 ? 2.5 : 2;
    }
    return step;
}

static void decibel_ticks(struct hlt_axis *a)
{
    double low = -20 * log10(a->high);
    double high = -20 * log10(a->zero > 0 ? a->zero : a->low);
    double step = even_step(low, high);
    for (double k = floor(high / step); k >= ceil(low / step); k--) {
        char text[HLT_TICK_TEXT];
        snprintf(text, sizeof text, "%.6g", k * step + 0.0);
        add(a, pow(10, -k * step / 20), text);
    }
}

/* Decades, or with 2 and 5 between, or more. */
static void decade_ticks(struct hlt_axis *a, const char *digits)
{
    a->n = 0;
    for (double d = floor(log10(a->low)); d <= log10(a->high); d++)
        for (const char *c = digits; *c; c++)
            add_number(a, (*c - '0') * pow(10, d));
}

static void number_ticks(struct hlt_axis *a)
{
    static const char *const digits[] = { "1", "13", "125", "123457" };
    for (size_t i = 0; i < sizeof digits / sizeof *digits; i++) {
        decade_ticks(a, digits[i]);
        if (a->n >= TICKS_MIN)
            return;
    }
    a->n = 0;
    double step = even_step(a->low, a->high);
    for (double k = ceil(a->low / step); k <= floor(a->high / step); k++)
        add_number(a, k * step);
}

void hlt_axis_make(struct hlt_axis *a, double low, double high, double from,
                   double to, bool decibels, bool zero)
{
    double octaves = log2(high / low);
    double more = (octaves < OCTAVES_MIN ? OCTAVES_MIN - octaves : 0) / 2 +
                  AIR * (octaves > OCTAVES_MIN ? octaves : OCTAVES_MIN);
    memset(a, 0, sizeof *a);
    a->low = low * exp2(-more);
    a->high = high * exp2(more);
    a->from = from;
    a->to = to;
    if (zero) {
        a->zero = a->low;
        a->low *= exp2(-more);
    }
    if (decibels)
        decibel_ticks(a);
    else
        number_ticks(a);
    if (zero && a->n < HLT_TICKS) {
        memmove(a->tick + 1, a->tick, a->n * sizeof *a->tick);
        memmove(a->text + 1, a->text, a->n * sizeof *a->text);
        a->tick[0] = a->zero;
        snprintf(a->text[0], HLT_TICK_TEXT, decibels ? "identical" : "0");
        a->n++;
    }
}
