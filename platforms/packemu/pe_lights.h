/* SPDX-License-Identifier: Zlib */
#ifndef PE_LIGHTS_H
#define PE_LIGHTS_H
/* Sums over lights (shaders/lights.glsl) on a run of surface points, lights
 * outside and points inside. Include pe_kernel.h first. */

enum { PE_LIGHT_RUN = 128 };

struct pe_lit_run {
    float px[PE_LIGHT_RUN], py[PE_LIGHT_RUN], pz[PE_LIGHT_RUN]; /* position  */
    float nx[PE_LIGHT_RUN], ny[PE_LIGHT_RUN], nz[PE_LIGHT_RUN]; /* normal    */
    float vx[PE_LIGHT_RUN], vy[PE_LIGHT_RUN], vz[PE_LIGHT_RUN]; /* to viewer */
    float half_n[PE_LIGHT_RUN];      /* exponent / 2                         */
    float brdf[PE_LIGHT_RUN];        /* enum hl_brdf; read where `brdfs`     */
    float diffuse[3][PE_LIGHT_RUN];  /* D                                    */
    float specular[3][PE_LIGHT_RUN]; /* S / ks in colour, or its luminance
                                      * in the first                         */
    uint32_t n;                      /* whole vectors: PE_LANES              */
    bool brdfs;                      /* HL_SPEC_BRDFS                        */
};

/* What is summed beside D. */
enum pe_lit_specular { PE_LIT_NONE, PE_LIT_LUMINANCE, PE_LIT_COLOR,
                       PE_LIT_COUNT };

/* The directions to the viewer from px, py, pz, sums of zero, and no BRDFS:
 * what has them sets both fields after. */
void pe_lit_begin(struct pe_lit_run *);
/* Add `count` lights of shaders/shared/block.h's layout; kinds, falloff: the
 * program's constants. */
void pe_lit_add(struct pe_lit_run *, enum pe_lit_specular, uint32_t kinds,
                uint32_t falloff, const hl_vec4 *light, uint32_t count);

/* Dim the sums of the first n points, under one light, by its shadow map. */
void pe_shadow(const struct pe_draw *, struct pe_lit_run *, uint32_t n);

/* Lights of a draw: those of uniform slot 3, or `count` from element `first`
 * of the list, less what lies beyond the buffer. */
struct pe_lit_list { const hl_vec4 *light; uint32_t count; };
struct pe_lit_list pe_lit_batch(const struct pe_draw *);
struct pe_lit_list pe_lit_list(const struct pe_draw *, uint32_t first,
                               uint32_t count);
#endif
