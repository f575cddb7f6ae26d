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
