/* SPDX-License-Identifier: Zlib */
#ifndef HLT_AXIS_H
#define HLT_AXIS_H
/* A logarithmic axis with marks that are round numbers. */
#include <stdbool.h>
#include <stdint.h>

enum { HLT_TICKS = 16, HLT_TICK_TEXT = 16 };

struct hlt_axis {
    double low, high;            /* values at its ends                       */
    double from, to;             /* pixels of them                           */
    double zero;                 /* where a value of 0 is drawn; 0: nowhere  */
    uint32_t n;
    double tick[HLT_TICKS];      /* in [low, high], ascending                */
    char text[HLT_TICKS][HLT_TICK_TEXT];
};

/* Over [low, high], both above 0, with some air at both ends. decibels: the
 * values are 10^(-dB / 20), and the marks say dB. zero: room for values of 0 at
 * the low end. */
void hlt_axis_make(struct hlt_axis *out, double low, double high, double from,
                   double to, bool decibels, bool zero);
double hlt_axis_pixel(const struct hlt_axis *, double value);
#endif
