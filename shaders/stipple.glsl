/* SPDX-License-Identifier: Zlib */
/* Translucent surfaces in passes at L-buffer size: a surface writes the
 * texels of its own pattern alone (K 4). */
#include "shaders/shared/block.h"
#include "shaders/shared/stipple.h"

layout(constant_id = HL_SPEC_STIPPLE) const uint hl_spec_stipple = 0u;

/* Drops fragments that are not on the object's pattern; nothing where the
 * program was made for opaque surfaces. */
void hl_stipple_test()
{
    if (hl_spec_stipple == 0u)
        return;
    vec2 cell = hl_stipple_cell(uint(hl_object.flat_ids.z), hl_spec_stipple);
    uvec2 at = uvec2(gl_FragCoord.xy) & uvec2(hl_spec_stipple - 1u);
    if (at != uvec2(cell))
        discard;
}
