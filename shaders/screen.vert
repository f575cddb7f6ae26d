#version 450
/* SPDX-License-Identifier: Zlib */
/* One triangle that covers the target; the scissor cuts it to size. Depth
 * 0.5 keeps it inside both depth conventions. */
void main()
{
    vec2 p = vec2((gl_VertexIndex & 1) * 4 - 1, (gl_VertexIndex & 2) * 2 - 1);
    gl_Position = vec4(p, 0.5, 1.0);
}
