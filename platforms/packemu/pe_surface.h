/* SPDX-License-Identifier: Zlib */
#ifndef PE_SURFACE_H
#define PE_SURFACE_H
/* shaders/surface.glsl: the surface under fragments of a mesh pass. `full`
 * as HL_FULL: varyings and textures, else the material's factors alone.
 * Include pe_kernel.h first. */

struct pe_surface {
    float albedo[3][HL_PE_BATCH];
    float specular[3][HL_PE_BATCH];
    float base[3][HL_PE_BATCH];      /* e + rho A                            */
    float exponent[HL_PE_BATCH];
    float alpha[HL_PE_BATCH];
};

/* Also discards what the mask cuts away. */
void pe_read_surface(const struct pe_draw *, struct hl_pe_fragments *,
                     bool full, struct pe_surface *);
/* Unit view-space normals. */
void pe_read_normal(const struct pe_draw *, const struct hl_pe_fragments *,
                    bool full, float out[3][HL_PE_BATCH]);
/* Alpha alone. */
void pe_surface_alpha(const struct pe_draw *, const struct hl_pe_fragments *,
                      bool full, float *out);
/* Sets every discard: 0 or, of textured stages by HL_SPEC_MASK, by alpha. */
void pe_alpha_test(const struct pe_draw *, struct hl_pe_fragments *,
                   bool full);
/* shaders/stipple.glsl: discards too what is not on the object's pattern. */
void pe_stipple_test(const struct pe_draw *, struct hl_pe_fragments *);
/* The exponent's code for the G-buffer. */
void pe_exponent_code(const struct pe_draw *, const struct hl_pe_fragments *,
                      bool full, float *out);
#endif
