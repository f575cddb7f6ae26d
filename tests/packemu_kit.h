/* SPDX-License-Identifier: Zlib */
#ifndef PACKEMU_KIT_H
#define PACKEMU_KIT_H
/* packemu opened as one console or another, its private state in reach. */
#include "hal/device.h"
#include "platforms/packemu/pe_memory.h"
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

/* One thread. NULL: the machine's own rules. */
void pk_open(struct ck_machine *m, const struct hl_profile *profile);
struct pe_state *pk_state(const struct ck_machine *m);
struct pe_texture *pk_texture(const struct ck_machine *m, hl_tex tex);
uint32_t pk_slot(hl_tex tex);

/* A texture, sampled and read back; target where `samples` is not 0. */
struct hl_tex_desc pk_desc(enum hl_format format, uint32_t w, uint32_t h,
                           uint32_t samples);
hl_tex pk_make(struct ck_machine *m, const struct hl_tex_desc *desc);
/* Put words on a colour target as a pass would, and let the pass end. */
void pk_draw(struct ck_machine *m, hl_tex target, hl_tex resolve,
             const uint32_t *words);
void pk_draw_depth(struct ck_machine *m, hl_tex target, const float *depth,
                   const uint8_t *stencil);
/* Level 0's bytes in the machine's order. */
void pk_assert_bytes(struct ck_machine *m, hl_tex t, const uint8_t *want,
                     size_t n);
/* Nearest, clamped. */
struct pe_view pk_view(const struct ck_machine *m, hl_tex tex);
#endif
