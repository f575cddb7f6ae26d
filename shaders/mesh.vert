#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Every mesh pass: position alone, or with what the pass needs. The position
 * is one expression and invariant, so that passes with an equal test meet. */
#include "shaders/shared/block.h"
#include "shaders/shared/pack.h"

layout(location = HL_ATTR_POSITION) in vec3 in_position;
invariant gl_Position;
#if defined(HL_WITH_ID) || defined(HL_WITH_TANGENT)
layout(location = HL_ATTR_TANGENT) in vec4 in_tangent;
#endif
#ifdef HL_WITH_ID
layout(location = 0) flat out float v_id;
#endif
#ifdef HL_WITH_NORMAL
layout(location = HL_ATTR_NORMAL) in vec3 in_normal;
layout(location = 1) out vec3 v_normal;
#endif
#ifdef HL_WITH_TANGENT
layout(location = 2) out vec4 v_tangent;
#endif
#ifdef HL_WITH_UV
layout(location = HL_ATTR_UV) in vec2 in_uv;
layout(location = HL_ATTR_COLOR) in vec4 in_color;
layout(location = 3) out vec2 v_uv;
layout(location = 4) out vec4 v_color;
#endif

void main()
{
    gl_Position = hl_object.clip * vec4(in_position, 1.0);
#ifdef HL_WITH_ID
    v_id = hl_object.ids.x + hl_tangent_w_group(in_tangent.w);
#endif
#ifdef HL_WITH_NORMAL
    /* Normalised at the vertex; a singular matrix leaves zero, not NaN. */
    vec3 n = mat3(hl_object.normal) * in_normal;
    float n2 = dot(n, n);
    v_normal = n2 > 0.0 ? n * inversesqrt(n2) : vec3(0.0);
#endif
#ifdef HL_WITH_TANGENT
    v_tangent = vec4(mat3(hl_object.tangent) * in_tangent.xyz,
                     hl_tangent_w_sign(in_tangent.w));
#endif
#ifdef HL_WITH_UV
    v_uv = in_uv;
    v_color = in_color;
#endif
}
