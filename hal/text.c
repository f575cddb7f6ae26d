/* SPDX-License-Identifier: Zlib */
#include "hal/text.h"

struct hl_text hl_text_begin(char *buffer, size_t bytes)
{
    struct hl_text t = { buffer, bytes };
    if (bytes > 0)
        buffer[0] = 0;
    return t;
}

void hl_text_str(struct hl_text *t, const char *s)
{
    while (*s && t->left > 1) {
        *t->at++ = *s++;
        t->left--;
    }
    if (t->left > 0)
        *t->at = 0;
}

void hl_text_uint(struct hl_text *t, uint64_t v)
{
    char digits[24];
    char *p = digits + sizeof digits - 1;
    *p = 0;
    do {
        *--p = (char)('0' + v % 10);
        v /= 10;
    } while (v);
    hl_text_str(t, p);
}

void hl_text_real(struct hl_text *t, double v, int decimals)
{
    if (v != v) {
        hl_text_str(t, "nan");
        return;
    }
    if (v < 0) {
        hl_text_str(t, "-");
        v = -v;
    }
    if (v > 1e18) {
        hl_text_str(t, v > 1e300 ? "inf" : "over 1e18");
        return;
    }
    uint64_t scale = 1;
    for (int i = 0; i < decimals && i < 9; i++)
        scale *= 10;
    uint64_t whole = (uint64_t)v;
    uint64_t part = (uint64_t)((v - (double)whole) * (double)scale + 0.5);
    if (part >= scale) {
        whole++;
        part -= scale;
    }
    hl_text_uint(t, whole);
    if (scale == 1)
        return;
    hl_text_str(t, ".");
    for (uint64_t s = scale / 10; s > part && s > 1; s /= 10)
        hl_text_str(t, "0");
    hl_text_uint(t, part);
}
