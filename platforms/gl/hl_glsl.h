/* SPDX-License-Identifier: Zlib */
#ifndef HL_GLSL_H
#define HL_GLSL_H
/* Built-in stages as GLSL 4.50 for OpenGL, made at build time by
 * shaders/embed.sh: Vulkan SPIR-V never reaches GL, which would link it
 * without a word and draw nonsense. */
#include "hal/hal.h"

extern const char *const hl_glsl[HL_SHADER_COUNT];
#endif
