#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Light evaluations a pixel: drawn in place of a shading pass with additive
 * blending when statistics are asked for. */
#include "shaders/shared/block.h"
#ifdef HL_TILES
layout(set = 2, binding = HL_SLOT_TILES, std430) readonly buffer hl_tile_block {
    uvec2 tile[];
} hl_tiles;
#endif
layout(location = 0) out vec4 out_count;

void main()
{
#ifdef HL_TILES
    ivec2 t = ivec2(gl_FragCoord.xy) / int(hl_frame.misc.y);
    float n = float(hl_tiles.tile[t.y * int(hl_frame.misc.z) + t.x].y);
#else
    float n = hl_lights.data[0].x;
#endif
    out_count = vec4(n, 0.0, 0.0, 1.0);
}
