/* SPDX-License-Identifier: Zlib */
#ifndef HL_EXACT_H
#define HL_EXACT_H
/* Functions whose bits are the same on every machine: + - * / and sqrt of
 * doubles alone, which IEEE 754 fixes, where mathematics libraries differ in
 * last digits, by processor even. Within 1e-14 of the true value, relative,
 * in the ranges stated; outside of them some number. */

double hl_exact_cos(double x);   /* |x| <= 16; absolute near its zeros       */
double hl_exact_tan(double x);   /* 0 <= x < pi / 2                          */
double hl_exact_asin(double x);  /* 0 <= x <= 1                              */
double hl_exact_exp2(double x);  /* |x| <= 1000                              */
double hl_exact_log2(double x);  /* normal, positive; absolute near 1        */
#endif
