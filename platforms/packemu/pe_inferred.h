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

/* Of taps 00, 10, 01, 11: depths in steps of far / 65535, and ids. */
struct pe_dsf {
    float depth[4][HL_PE_BATCH], id[4][HL_PE_BATCH];
};

static inline bool pe_has_words(const struct pe_view *v)
{
    return v->texture &&
           hl_format_info(v->texture->view)->kind == HL_KIND_UINT;
}

/* pe_taps.c */
/* Where pixels lie among the centres of the L-buffer's texels, and their view
 * depths there, metres. */
void pe_light_pixels(const struct pe_draw *, const struct hl_pe_fragments *,
                     float *x, float *y);
void pe_pixel_depths(const struct pe_draw *, const struct hl_pe_fragments *,
                     float *z);

/* A texel's number; far outside of any texture it stays there. Lanes beyond n
 * hold anything at all. */
static inline int32_t pe_texel(float x)
{
    x = x > -65536.0f ? x : -65536.0f;
    return (int32_t)(x < 65536.0f ? x : 65536.0f);
}

void pe_find_taps(const struct pe_draw *, const struct hl_pe_fragments *,
                  struct pe_taps *);
void pe_read_dsf(const struct pe_draw *, const struct pe_taps *, uint32_t n,
                 struct pe_dsf *);
/* For taps within so many texels of the pixel on either axis. */
void pe_thresholds(const struct pe_draw *, const struct hl_pe_fragments *,
                   float distance_texels, float *out);
/* Acceptance, 0 or 1, of taps 00, 10, 01, 11. */
void pe_accept_taps(const struct pe_draw *, const struct hl_pe_fragments *,
                    const struct pe_taps *, float out[4][HL_PE_BATCH]);
void pe_accept(const struct pe_draw *, const struct hl_pe_fragments *,
               const struct pe_dsf *, float distance_texels,
               float out[4][HL_PE_BATCH]);
/* Texels one by one, each clamped: n of the DSF; n of the L-buffer. */
void pe_fetch_dsf(const struct pe_draw *, const int32_t *x, const int32_t *y,
                  uint32_t n, float *depth, float *id);
/* pe_inferred.c */
void pe_fetch_light(const struct pe_draw *, const int32_t *x,
                    const int32_t *y, uint32_t n, float out[4][HL_PE_BATCH]);

/* pe_fill.c */
/* Light of opaque fragments, in place, where acceptance `a` is 0 of all. */
void pe_fill_light(const struct pe_draw *, const struct hl_pe_fragments *,
                   const struct pe_dsf *, float a[4][HL_PE_BATCH],
                   float out[4][HL_PE_BATCH]);
/* Light of translucent fragments from samples of their pattern. */
void pe_stippled_light(const struct pe_draw *, const struct hl_pe_fragments *,
                       float out[4][HL_PE_BATCH]);
#endif
