/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/value.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Digits of text, to a length; strtoul would take signs and blanks. */
static bool read_digits(uint32_t *out, const char *text, size_t n)
{
    uint64_t v = 0;
    if (n == 0 || n > 10)
        return false;
    for (size_t i = 0; i < n; i++) {
        if (text[i] < '0' || text[i] > '9')
            return false;
        v = v * 10 + (uint64_t)(text[i] - '0');
    }
    if (v > UINT32_MAX)
        return false;
    *out = (uint32_t)v;
    return true;
}

bool hlc_read_count(uint32_t *out, const char *text)
{
    return read_digits(out, text, strlen(text));
}

bool hlc_read_size(uint32_t *width, uint32_t *height, const char *text)
{
    const char *x = strchr(text, 'x');
    return x && read_digits(width, text, (size_t)(x - text)) &&
           hlc_read_count(height, x + 1);
}

/* The number that text begins with; *end is where it stops. */
static bool read_part(double *out, const char *text, const char **end)
{
    size_t n = strspn(text, "0123456789+-.eE");
    char *stop;
    if (n == 0)
        return false;
    *out = strtod(text, &stop);
    *end = stop;
    return stop == text + n && isfinite(*out);
}

bool hlc_read_real(double *out, const char *text)
{
    return hlc_read_reals(out, 1, text);
}

bool hlc_read_reals(double *out, int n, const char *text)
{
    for (int i = 0; i < n; i++) {
        if (!read_part(&out[i], text, &text))
            return false;
        if (*text != (i + 1 < n ? ',' : 0))
            return false;
        text++;
    }
    return true;
}

int hlc_read_word(const char *text, const char *words)
{
    size_t length = strlen(text);
    for (int i = 0;; i++) {
        size_t n = strcspn(words, "|");
        if (n == length && memcmp(text, words, n) == 0)
            return i;
        if (!words[n])
            return -1;
        words += n + 1;
    }
}
