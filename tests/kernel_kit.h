/* SPDX-License-Identifier: Zlib */
#ifndef KERNEL_KIT_H
#define KERNEL_KIT_H
/* One draw of packemu put together by hand, so that a kernel can be called
 * with known varyings and read back to the bit. Nothing is rasterised. */
#include "shaders/shared/block.h"
#include "tests/packemu_kit.h"

struct kk {
    struct ck_machine machine;
    struct pe_draw draw;
    struct pe_program program;
    struct hl_frame_block frame;
    struct hl_object_block object;
    struct hl_material_block material;
    hl_vec4 lights[HL_BATCH_MAX * HL_LIGHT_VEC4S];
    struct hl_pe_fragments in;
    uint64_t seed;
};

/* A device, no textures, uniform blocks bound, the constants' defaults. */
void kk_open(struct kk *k);
void kk_close(struct kk *k);
/* Texture `slot` of w x h texels from host memory. */
void kk_texture(struct kk *k, uint32_t slot, enum hl_format format,
                enum hl_format sample_as, uint32_t w, uint32_t h,
                const void *texels);
/* The row of a stage becomes the program's; its kernel is called on k->in. */
void kk_shade(struct kk *k, enum hl_shader fragment);
/* Random: in [low, high), and a unit vector. No two calls in one expression:
 * their order is the compiler's choice. */
float kk_between(struct kk *k, float low, float high);
hl_vec4 kk_vec4(struct kk *k, float low, float high);
hl_vec3 kk_direction(struct kk *k);
/* n fragments on w x h pixels, all of their inputs random but plausible:
 * normals not of unit length, tangents, colours 0..1, positions in front. */
void kk_fragments(struct kk *k, uint32_t n, int32_t w, int32_t h);
/* Lights of block.h's layout for `kinds`, near what kk_fragments gives. */
void kk_lights(struct kk *k, hl_vec4 *out, uint32_t n, uint32_t kinds);
/* Fragment i of a target is `want` to the bit (0 and -0 are one). */
void kk_texel(const struct kk *k, int target, uint32_t i, hl_vec4 want);
#endif
