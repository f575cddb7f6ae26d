/* SPDX-License-Identifier: Zlib */
#ifndef PE_INFERRED_H
#define PE_INFERRED_H
/* shaders/inferred.glsl: the four taps about a pixel and what the DSF makes
 * of them. Whether they come as words or as numbers (HL_FLOAT_TAPS) is read
 * from the views. Include pe_kernel.h first. */

/* Corner texel and fraction; of n lanes as they are, not of whole vectors. */
struct pe_taps {
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    float fx[HL_PE_BATCH], fy[HL_PE_BATCH];
};

void pe_find_taps(const struct pe_draw *, const struct hl_pe_fragments *,
                  struct pe_taps *);
/* Acceptance, 0 or 1, of taps 00, 10, 01, 11. */
void pe_accept_taps(const struct pe_draw *, const struct hl_pe_fragments *,
                    const struct pe_taps *, float out[4][HL_PE_BATCH]);
#endif
