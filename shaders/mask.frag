#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* The alpha test alone: masked surfaces in a shadow map. */
#include "shaders/surface.glsl"

void main() { hl_alpha_test(hl_surface_alpha()); }
