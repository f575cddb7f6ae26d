/* SPDX-License-Identifier: Zlib */
/* Depth and stencil tests, on codes that order as depths do. */
#include "platforms/packemu/pe_pass.h"

static inline bool passes(enum hl_compare c, uint32_t a, uint32_t b)
{
    switch (c) {
    case HL_COMPARE_NEVER: return false;
    case HL_COMPARE_LESS: return a < b;
    case HL_COMPARE_LESS_EQUAL: return a <= b;
    case HL_COMPARE_EQUAL: return a == b;
    case HL_COMPARE_GREATER_EQUAL: return a >= b;
    case HL_COMPARE_GREATER: return a > b;
    default: return true;
    }
}

/* ---- depth alone --------------------------------------------------------- */

/* Constant arguments: a loop is compiled for each pair of them. In order,
 * since a pixel may come twice. */
static inline uint32_t test_loop(enum hl_compare c, bool write,
                                 uint32_t *depth, const uint16_t *at,
                                 const uint32_t *codes, uint32_t n,
                                 uint16_t *pass)
{
    uint32_t k = 0;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *d = &depth[at[i]], old = *d;
        bool p = passes(c, codes[i], old);
        if (write)
            *d = p ? codes[i] : old;
        pass[k] = (uint16_t)i;
        k += p;
    }
    return k;
}

#define LOOP(name)                                                         \
    case HL_COMPARE_##name:                                                \
        return write ? test_loop(HL_COMPARE_##name, true, t->depth, at,    \
                                 codes, n, pass)                           \
                     : test_loop(HL_COMPARE_##name, false, t->depth, at,   \
                                 codes, n, pass)

uint32_t pe_depth_test(const struct pe_test *t, bool write,
                       const uint16_t *at, const uint32_t *codes, uint32_t n,
                       uint16_t *pass)
{
    switch (t->compare) {
    case HL_COMPARE_OFF: break;
    LOOP(NEVER);
    LOOP(LESS);
    LOOP(LESS_EQUAL);
    LOOP(EQUAL);
    LOOP(GREATER_EQUAL);
    LOOP(GREATER);
    LOOP(ALWAYS);
    }
    return test_loop(HL_COMPARE_ALWAYS, false, t->depth, at, codes, n, pass);
}

/* ---- stencil and samples ------------------------------------------------- */

static uint8_t stencil_op(enum hl_stencil_op op, uint8_t old,
                          uint8_t reference)
{
    switch (op) {
    case HL_STENCIL_KEEP: return old;
    case HL_STENCIL_ZERO: return 0;
    case HL_STENCIL_REPLACE: return reference;
    case HL_STENCIL_INCREMENT: return (uint8_t)(old + (old < 255));
    case HL_STENCIL_DECREMENT: return (uint8_t)(old - (old > 0));
    case HL_STENCIL_INCREMENT_WRAP: return (uint8_t)(old + 1);
    case HL_STENCIL_DECREMENT_WRAP: return (uint8_t)(old - 1);
    case HL_STENCIL_INVERT: return (uint8_t)~old;
    }
    return old;
}

/* hal.h: reference against stored, both masked. */
static bool stencil_passes(const struct hl_stencil *s,
                           const struct hl_stencil_face *f, uint8_t old)
{
    return passes(f->test, s->reference & s->read_mask, old & s->read_mask);
}

static void stencil_write(const struct hl_stencil *s, enum hl_stencil_op op,
                          uint8_t *stored)
{
    uint8_t made = stencil_op(op, *stored, s->reference);
    *stored = (uint8_t)((*stored & ~s->write_mask) | (made & s->write_mask));
}

/* One sample: stencil test, depth test, stencil operation, depth write. */
static bool test_one(const struct pe_test *t, uint32_t at, uint32_t code,
                     bool back)
{
    const struct hl_stencil_face *f = back ? &t->stencil.back
                                           : &t->stencil.front;
    bool depth;
    if (!stencil_passes(&t->stencil, f, t->stencils[at])) {
        stencil_write(&t->stencil, f->fail, &t->stencils[at]);
        return false;
    }
    depth = t->compare == HL_COMPARE_OFF ||
            passes(t->compare, code, t->depth[at]);
    stencil_write(&t->stencil, depth ? f->pass : f->depth_fail,
                  &t->stencils[at]);
    if (depth && t->write)
        t->depth[at] = code;
    return depth;
}

/* Depth alone, constant arguments as above. */
static inline void sample_loop(enum hl_compare c, const struct pe_test *t,
                               uint32_t s, const uint16_t *at,
                               const uint32_t *codes, uint32_t n,
                               uint8_t *cover)
{
    uint32_t *depth = t->depth + s, samples = t->samples;
    bool write = t->write;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *d = &depth[at[i] * samples], old = *d;
        bool covered = cover[i] >> s & 1;
        bool p = covered & passes(c, codes[i], old);
        *d = (p & write) ? codes[i] : old;
        cover[i] = (uint8_t)(cover[i] & ~((uint32_t)!p << s));
    }
}

#define SAMPLES(name)                                                      \
    case HL_COMPARE_##name:                                                \
        sample_loop(HL_COMPARE_##name, t, s, at, codes, n, cover);         \
        break

static void depth_samples(const struct pe_test *t, uint32_t s,
                          const uint16_t *at, const uint32_t *codes,
                          uint32_t n, uint8_t *cover)
{
    switch (t->compare) {
    case HL_COMPARE_OFF: break;
    SAMPLES(NEVER);
    SAMPLES(LESS);
    SAMPLES(LESS_EQUAL);
    SAMPLES(EQUAL);
    SAMPLES(GREATER_EQUAL);
    SAMPLES(GREATER);
    SAMPLES(ALWAYS);
    }
}

void pe_sample_test(const struct pe_test *t, uint32_t s, const uint16_t *at,
                    const uint32_t *codes, const uint8_t *back, uint32_t n,
                    uint8_t *cover)
{
    uint8_t bit = (uint8_t)(1u << s);
    if (!t->stencil_on) {
        depth_samples(t, s, at, codes, n, cover);
        return;
    }
    for (uint32_t i = 0; i < n; i++)
        if (cover[i] & bit &&
            !test_one(t, at[i] * t->samples + s, codes[i], back[i]))
            cover[i] = (uint8_t)(cover[i] & ~bit);
}
