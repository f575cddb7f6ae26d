/* SPDX-License-Identifier: Zlib */
#ifndef HLC_VALUE_H
#define HLC_VALUE_H
/* Values of options, read strictly: the whole text must be the value. Blanks,
 * hexadecimal, "nan", "inf" and what overflows a double are refused. */
#include <stdbool.h>
#include <stdint.h>

bool hlc_read_count(uint32_t *out, const char *text);  /* decimal digits     */
bool hlc_read_real(double *out, const char *text);
/* Exactly n numbers with commas between them. */
bool hlc_read_reals(double *out, int n, const char *text);
/* "1280x720" */
bool hlc_read_size(uint32_t *width, uint32_t *height, const char *text);
/* Index of text in "one|two|three", -1 when it is none of them. */
int hlc_read_word(const char *text, const char *words);
#endif
