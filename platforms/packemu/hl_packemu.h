/* SPDX-License-Identifier: Zlib */
#ifndef HL_PACKEMU_H
#define HL_PACKEMU_H
/* A software device that keeps its memory as a console does, by the profile
 * it is opened with (hl_device_desc.profile; NULL: ideal formats). C99 and
 * the C library only. Every frame has the same bytes on any machine, compiler
 * and number of threads. */
#include "hal/backend.h"

extern const struct hl_backend hl_backend_packemu;

/* hl_device_desc.native of this backend; optional. */
struct hl_packemu_native {
    uint32_t threads;        /* 0: one a processor; 1: the caller's alone    */
};

/* The bytes that a texture's memory (not EDRAM) holds, in the machine's
 * order: level 0, rows tight. NULL when the handle is stale. Valid until the
 * texture is written, drawn to or destroyed. */
const uint8_t *hl_packemu_memory(struct hl_device *, hl_tex, size_t *bytes);

/* ---- fragment stages of an embedder's own: hl_code.kernel --------------- */

/* Varyings, one float each; those of mesh stages (shaders/shared/block.h). */
enum hl_pe_vary {
    HL_PE_ID,                            /* flat: region id                  */
    HL_PE_NX, HL_PE_NY, HL_PE_NZ,        /* HL_VARY_NORMAL                   */
    HL_PE_U, HL_PE_V,                    /* HL_VARY_UV                       */
    HL_PE_TX, HL_PE_TY, HL_PE_TZ, HL_PE_TW,  /* HL_VARY_TANGENT              */
    HL_PE_R, HL_PE_G, HL_PE_B, HL_PE_A,  /* HL_VARY_COLOR                    */
    HL_PE_PX, HL_PE_PY, HL_PE_PZ,        /* HL_VARY_POSITION                 */
    HL_PE_MX, HL_PE_MY, HL_PE_MW,        /* HL_VARY_MOTION: clip now ...     */
    HL_PE_LX, HL_PE_LY, HL_PE_LW,        /* ... and of the last frame        */
    HL_PE_VARY_COUNT
};

enum { HL_PE_BATCH = 128, HL_PE_OUTPUTS = 4 };

/* Fragments of one draw, any n of its pixels; arrays are readable to their
 * ends, so that a loop may run over all HL_PE_BATCH of them. */
struct hl_pe_fragments {
    uint32_t n;
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];   /* pixel; its centre is + 0.5  */
    float z[HL_PE_BATCH];                     /* 1 / gl_FragCoord.w          */
    float dzdx[HL_PE_BATCH], dzdy[HL_PE_BATCH]; /* of z, by quad differences;
                                               * set where the stage asks    */
    float vary[HL_PE_VARY_COUNT][HL_PE_BATCH];
    float duv[4][HL_PE_BATCH];                /* du/dx dv/dx du/dy dv/dy; the
                                               * same                        */
    /* Pixels from the centre to where z and varyings were taken, of built-in
     * stages that read at centroids; anything at all for others, whose z and
     * varyings are the centre's. */
    float off_x[HL_PE_BATCH], off_y[HL_PE_BATCH];
    uint8_t back[HL_PE_BATCH];                /* 1: a back face              */
    uint8_t discard[HL_PE_BATCH];             /* the stage sets 1 to discard */
    /* What the stage writes: colour target, channel, fragment. Integer
     * targets take the bits of a uint32_t. */
    float color[HL_PE_OUTPUTS][4][HL_PE_BATCH];
};

struct pe_draw;              /* resources of a draw: platforms/packemu/pe.h  */

/* hl_code.kernel points at one of these, cast to void (*)(void). */
struct hl_pe_stage {
    void (*shade)(const struct pe_draw *, struct hl_pe_fragments *);
    bool slope;              /* wants dzdx, dzdy                             */
    bool uv_slope;           /* wants duv                                    */
    bool discards;           /* may set discard                              */
};
/* Uniform range of a slot, at least `bytes` long, or NULL. */
const void *hl_pe_uniform(const struct pe_draw *, uint32_t slot, size_t bytes);
/* Light of the inferred pipeline for all fragments (hl_read_lights of
 * shaders/inferred.glsl): out[0..2] diffuse, [3..5] specular. */
void hl_pe_read_lights(const struct pe_draw *, const struct hl_pe_fragments *,
                       float out[6][HL_PE_BATCH]);
/* Texture of a slot at (u, v)[i], level from the fragments' duv. */
void hl_pe_sample(const struct pe_draw *, uint32_t slot,
                  const struct hl_pe_fragments *, const float *u,
                  const float *v, float out[4][HL_PE_BATCH]);
#endif
