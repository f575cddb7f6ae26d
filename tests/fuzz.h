/* SPDX-License-Identifier: Zlib */
#ifndef FUZZ_H
#define FUZZ_H
/* What the fuzzers share. A program is one of them and libFuzzer's main, or
 * fuzz_main.c. A run's input is consumed from its begin; past its end all is
 * zero. What must hold is checked by FZ_CHECK, which ends the process. */
#include <stdio.h>
#include <stdlib.h>
#include "hal/caps.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FZ_CHECK(c)                                                        \
    do {                                                                   \
        if (!(c)) {                                                        \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #c); \
            abort();                                                       \
        }                                                                  \
    } while (0)

struct fz { const uint8_t *at, *end; };

static inline uint32_t fz_byte(struct fz *f)
{
    return f->at < f->end ? *f->at++ : 0;
}
static inline uint32_t fz_word(struct fz *f)
{
    uint32_t low = fz_byte(f), high = fz_byte(f);
    low |= high << 8;
    high = fz_byte(f);
    return low | high << 16 | fz_byte(f) << 24;
}
/* 0..n-1, n from 1 to 65,536. */
static inline uint32_t fz_below(struct fz *f, uint32_t n)
{
    uint32_t low = fz_byte(f);
    return (n > 256 ? low | fz_byte(f) << 8 : low) % n;
}
static inline bool fz_bool(struct fz *f) { return fz_byte(f) & 1; }

/* Numbers that people give, numbers that nobody should, any bits. */
float fz_number(struct fz *f);
/* Counts: small, powers of two and their neighbours, anything. */
uint32_t fz_count(struct fz *f);
/* A choice of n values; seldom one beyond them. */
uint32_t fz_choice(struct fz *f, uint32_t n);

/* A console: one of ours, or with members changed. keep: only what
 * hl_device_open takes. */
void fz_profile(struct fz *f, struct hl_profile *out, bool keep);
/* A machine with that profile. */
void fz_caps(struct fz *f, struct hl_caps *out, bool keep);
#endif
