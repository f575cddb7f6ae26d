/* SPDX-License-Identifier: Zlib */
/* Direct3D 9 machines without the state that moves pixel centres to halves:
 * there pixel (i, j) is sampled at the point (i, j) of the target. The scene
 * is moved half a pixel left and up, so that its (i + 1/2, j + 1/2) is what
 * is sampled. A pixel is 2 / width of clip x over w; y is down here, where
 * Direct3D 9's is up (its form: clip.x -= w / W, clip.y += w / H), so both
 * shifts are negative: -1 / width and -1 / height of the target. The branch
 * is on constants: without a shift nothing is left of it, which w * 0 would
 * not be. */
layout(constant_id = HL_SPEC_SHIFT_X) const float hl_spec_shift_x = 0.0;
layout(constant_id = HL_SPEC_SHIFT_Y) const float hl_spec_shift_y = 0.0;

vec4 hl_half_pixel(vec4 clip)
{
    if (hl_spec_shift_x != 0.0 || hl_spec_shift_y != 0.0)
        clip.xy += clip.w * vec2(hl_spec_shift_x, hl_spec_shift_y);
    return clip;
}
