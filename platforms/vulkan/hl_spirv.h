/* SPDX-License-Identifier: Zlib */
#ifndef HL_SPIRV_H
#define HL_SPIRV_H
/* Built-in stages as Vulkan SPIR-V, made at build time by shaders/embed.sh. */
#include "hal/hal.h"

struct hl_spirv { const uint32_t *words; size_t bytes; };
extern const struct hl_spirv hl_spirv[HL_SHADER_COUNT];
#endif
