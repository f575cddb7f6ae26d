#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Every mesh pass: position alone, or with what the pass needs. The position
 * is one expression and invariant, so that passes with an equal test meet.
 * What is the same for a whole object goes down as flat varyings: a uniform
 * read in the fragment stage costs a software driver more. */
#include "shaders/shared/block.h"
#include "shaders/shared/pack.h"
#include "shaders/half_pixel.glsl"
#include "shaders/centroid.glsl"

layout(location = HL_ATTR_POSITION) in vec3 in_position;
invariant gl_Position;
#if defined(HL_WITH_ID) || defined(HL_WITH_TANGENT)
layout(location = HL_ATTR_TANGENT) in vec4 in_tangent;
#endif
#ifdef HL_WITH_ID
layout(location = HL_VARY_IDS) flat out vec4 v_ids;
#endif
#ifdef HL_WITH_NORMAL
layout(location = HL_ATTR_NORMAL) in vec3 in_normal;
layout(location = HL_VARY_NORMAL) out vec3 v_normal;
#endif
#ifdef HL_WITH_TANGENT
layout(location = HL_VARY_TANGENT) out vec4 v_tangent;
#endif
#ifdef HL_WITH_UV
layout(location = HL_ATTR_UV) in vec2 in_uv;
layout(location = HL_ATTR_COLOR) in vec4 in_color;
layout(location = HL_VARY_UV) HL_AT out vec2 v_uv;
layout(location = HL_VARY_COLOR) HL_AT out vec4 v_color;
#endif
#ifdef HL_WITH_PLAIN
layout(location = HL_VARY_ALBEDO) flat out vec4 v_albedo;
layout(location = HL_VARY_SPECULAR) flat out vec4 v_specular;
layout(location = HL_VARY_BASE) flat out vec4 v_base;
#endif
#ifdef HL_WITH_POSITION
layout(location = HL_VARY_POSITION) out vec3 v_position;
#endif
#ifdef HL_CENTROID
layout(location = HL_VARY_CLIP) centroid out vec3 v_clip;
#endif
#ifdef HL_MOTION
layout(set = 0, binding = HL_SLOT_MOTION, std140) uniform hl_motion_block {
    mat4 before, now;
} hl_motion;
layout(location = HL_VARY_MOTION) out vec3 v_motion[2];
#endif

void main()
{
    gl_Position = hl_half_pixel(hl_object.clip * vec4(in_position, 1.0));
#ifdef HL_WITH_ID
    v_ids = vec4(hl_object.ids.x + hl_tangent_w_group(in_tangent.w),
                 hl_object.flat_ids.x, hl_frame.depth.z, hl_frame.depth.w);
#endif
#ifdef HL_WITH_NORMAL
    /* Normalised at the vertex; a singular matrix leaves zero, not NaN. */
    vec3 n = mat3(hl_object.normal) * in_normal;
    float n2 = dot(n, n);
    v_normal = n2 > 0.0 ? n * inversesqrt(n2) : vec3(0.0);
#endif
#ifdef HL_WITH_TANGENT
    v_tangent = vec4(mat3(hl_object.model_view) * in_tangent.xyz,
                     hl_tangent_w_sign(in_tangent.w) * hl_object.flat_ids.y);
#endif
#ifdef HL_WITH_UV
    v_uv = in_uv;
    v_color = in_color;
#endif
#ifdef HL_WITH_PLAIN
    v_albedo = hl_material.albedo;
    v_specular = hl_material.specular;
    v_base = vec4(hl_material.emission.rgb +
                  hl_material.albedo.rgb * hl_frame.ambient.rgb, 0.0);
#endif
#ifdef HL_WITH_POSITION
    v_position = (hl_object.model_view * vec4(in_position, 1.0)).xyz;
#endif
#ifdef HL_CENTROID
    /* As before hl_half_pixel: the machine that asks for its shift undoes it,
     * so that this is where gl_FragCoord says the pixel is. */
    v_clip = (hl_object.clip * vec4(in_position, 1.0)).xyw;
#endif
#ifdef HL_MOTION
    v_motion[0] = (hl_motion.now * vec4(in_position, 1.0)).xyw;
    v_motion[1] = (hl_motion.before * vec4(in_position, 1.0)).xyw;
#endif
}
