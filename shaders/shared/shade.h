/* SPDX-License-Identifier: Zlib */
#ifndef HL_SHADE_H
#define HL_SHADE_H
/* The light and surface model: attenuation, Blinn-Phong and the glTF
 * material. Pure functions; the sums over lights are the callers'. */
#include "shaders/shared/lang.h"

/* Smooth falloff max(0, 1 - (d/r)^2)^2; d2 = d^2, inv_r2 = 1 / r^2. */
HL_FN float hl_falloff_smooth(float d2, float inv_r2)
{
    float t = hl_max(0.0f, 1.0f - d2 * inv_r2);
    return t * t;
}

/* Inverse square with glTF's window: clamp(1 - (d/r)^4) / max(d, 0.01)^2. */
HL_FN float hl_falloff_inverse_square(float d2, float inv_r2)
{
    float q = d2 * inv_r2;
    return hl_clamp01(1.0f - q * q) / hl_max(d2, 1e-4f);
}

/* glTF's cone: s = 1 / max(0.001, cos inner - cos outer), o = -cos outer s. */
HL_FN float hl_spot(float cos_angle, float scale, float offset)
{
    float t = hl_clamp01(cos_angle * scale + offset);
    return t * t;
}

/* Diffuse weight of skin (core/scene.h HL_BRDF_SKIN): max(N.L, 0) and, beside
 * the terminator, light that entered elsewhere: lambSkinDusk of Engel, "Light
 * Pre-Pass", appendix:
 *   max(0, smoothstep(-r, 1, N.L) - smoothstep(0, 1, N.L)).
 * The roll-off r is fixed, not a material's, since the light pass knows of a
 * texel only which BRDF it has. 0.2: the dark side glows to 11.5 degrees past
 * the terminator, by 0.074 at it. Within 0..1 for N.L within -1..1, so bounds
 * of summed light hold; 1 at 1, 0 from -r down. */
#define HL_SKIN_ROLL_OFF 0.2f
#define HL_BRDF_SKIN_INDEX 1 /* enum hl_brdf, for stages                     */
HL_FN float hl_diffuse_skin(float ndl)
{
    float a = hl_clamp01((ndl + HL_SKIN_ROLL_OFF) *
                         (1.0f / (1.0f + HL_SKIN_ROLL_OFF)));
    float b = hl_clamp01(ndl);
    float wide = a * a * (3.0f - 2.0f * a);
    float narrow = b * b * (3.0f - 2.0f * b);
    return hl_max(ndl, 0.0f) + hl_max(wide - narrow, 0.0f);
}

/* max(N.H, 0)^n. */
HL_FN float hl_specular(float ndh, float n)
{
    return hl_pow(hl_max(ndh, 0.0f), n);
}

/* Rec. 709 luminance of linear RGB. */
HL_FN float hl_luminance(hl_vec3 c)
{
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/* Specular intensity back to colour (K 2.2): S = ks alpha D / lum(D). */
HL_FN float hl_specular_scale(hl_vec3 diffuse, float intensity)
{
    float l = hl_luminance(diffuse);
    return l > 0.0f ? intensity / l : 0.0f;
}

/* alpha = max(roughness, 0.089)^2, n = clamp(2 / alpha^2 - 2, 1, 256). */
HL_FN float hl_roughness_exponent(float roughness)
{
    float r = hl_max(roughness, 0.089f);
    float a = r * r;
    return hl_min(hl_max(2.0f / (a * a) - 2.0f, 1.0f), 256.0f);
}
HL_FN hl_vec3 hl_material_albedo(hl_vec3 base, float metallic)
{
    return hl_scale3(base, 1.0f - metallic);
}
/* mix(0.04, base, metallic) (n + 8) / 8. */
HL_FN hl_vec3 hl_material_specular(hl_vec3 base, float metallic, float n)
{
    float k = (n + 8.0f) * 0.125f;
    float d = 0.04f * (1.0f - metallic);
    return hl_v3((d + base.x * metallic) * k, (d + base.y * metallic) * k,
                 (d + base.z * metallic) * k);
}
#endif
