/* SPDX-License-Identifier: Zlib */
#ifndef HL_STIPPLE_CELL_H
#define HL_STIPPLE_CELL_H
/* Which texel of a 2 x 2 or 4 x 4 block of the L-buffer a stipple pattern
 * owns (K 4). Ordered dither: patterns that are used first lie as far apart
 * as they can, so that opaque surfaces below few layers lose texels evenly.
 * Pattern 0 is left to opaque surfaces. */
#include "shaders/shared/lang.h"

/* Offset of pattern p (0..3, 0..15) in a block of `side` 2 or 4 texels. */
HL_FN hl_vec2 hl_stipple_cell(uint p, uint side)
{
    uint a = p & 1u;
    uint b = (p >> 1) & 1u;
    uint x = a ^ b;
    uint y = a;
    if (side == 4u) {
        uint c = (p >> 2) & 1u;
        uint d = (p >> 3) & 1u;
        x = x * 2u + (c ^ d);
        y = y * 2u + c;
    }
    return hl_v2(hl_float(x), hl_float(y));
}
#endif
