/* SPDX-License-Identifier: Zlib */
/* Images, samplers, textures and materials. struct hlh_mesh has one set of
 * texture coordinates, so a material's TEXCOORD set and KHR_texture_transform
 * are baked into each mesh that uses it. Where its textures differ in these,
 * the base colour's count (else the first there is, in the order metallic-
 * roughness, normal, emission): one set cannot serve both. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"
#include "platforms/host/image_png.h"
#include "platforms/host/scene_clean.h"

/* Slack for factors that an exporter rounded past 1. */
#define FACTOR_SLACK 1e-5

static bool load_image(struct gltf *g, uint32_t i)
{
    const cJSON *item = g->list[GLTF_IMAGES].item[i];
    struct hlh_scene *s = g->scene;
    struct hlh_image image, *slot;
    const char *uri;
    char *bytes = NULL, *name, where[48];
    const void *at;
    struct hlh_error inner;
    size_t size;
    uint32_t view;
    bool ok;
    snprintf(where, sizeof where, "images[%u]", (unsigned)i);
    if (!gltf_string(g, item, where, "uri", &uri) ||
        !gltf_index(g, item, where, "bufferView", GLTF_VIEWS, &view))
        return false;
    if (!uri && view == HLH_NONE)
        return hlh_fail(g->error, g->file, "%s: has neither a uri nor a "
                        "bufferView", where);
    if (uri && !gltf_fetch(g, uri, where, &bytes, &size))
        return false;
    at = bytes;
    if (!uri) {
        at = g->view[view].at;
        size = (size_t)g->view[view].size;
    }
    ok = hlh_image_decode_limited(&image, at, size, g->pixels_left, NULL,
                                  &inner);
    free(bytes);
    if (!ok)
        return hlh_fail(g->error, g->file, "%s: %s", where, inner.text);
    g->pixels_left -= (uint64_t)image.width * image.height;
    name = gltf_name(item, "image", i);
    slot = name ? hlh_push(&s->images, &s->n_images, sizeof *slot) : NULL;
    free(image.name);
    if (!slot) {
        free(name);
        free(image.rgba);
        return gltf_memory(g);
    }
    image.name = name;
    *slot = image;
    g->image[i] = s->n_images - 1;
    return true;
}

static bool wrap(struct gltf *g, const cJSON *sampler, const char *where,
                 const char *key, enum hlh_wrap *out)
{
    uint64_t value = 10497;
    if (!gltf_integer(g, sampler, where, key, 0, UINT32_MAX, &value))
        return false;
    if (value != 10497 && value != 33071 && value != 33648)
        return hlh_fail(g->error, g->file, "%s.%s: is %llu, not 10497, 33071 "
                        "or 33648", where, key, (unsigned long long)value);
    *out = value == 33071 ? HLH_WRAP_CLAMP
           : value == 33648 ? HLH_WRAP_MIRROR : HLH_WRAP_REPEAT;
    return true;
}

/* out->image is the file's index until load_images. */
static bool load_texture(struct gltf *g, uint32_t i, struct hlh_texture *out)
{
    const cJSON *item = g->list[GLTF_TEXTURES].item[i];
    uint32_t image, sampler;
    char where[48];
    snprintf(where, sizeof where, "textures[%u]", (unsigned)i);
    if (!gltf_index(g, item, where, "source", GLTF_IMAGES, &image) ||
        !gltf_index(g, item, where, "sampler", GLTF_SAMPLERS, &sampler))
        return false;
    if (image == HLH_NONE)
        return hlh_fail(g->error, g->file, "%s: names no PNG or JPEG image",
                        where);
    g->image[image] = 0;
    out->image = (int32_t)image;
    if (sampler == HLH_NONE)
        return true;
    item = g->list[GLTF_SAMPLERS].item[sampler];
    snprintf(where, sizeof where, "samplers[%u]", (unsigned)sampler);
    return wrap(g, item, where, "wrapS", &out->wrap_u) &&
           wrap(g, item, where, "wrapT", &out->wrap_v);
}

static void uv_default(struct gltf_uv *uv)
{
    memset(uv, 0, sizeof *uv);
    uv->scale[0] = uv->scale[1] = uv->cosine = 1;
}

static bool load_uv(struct gltf *g, const cJSON *info, const char *where,
                    struct gltf_uv *uv)
{
    const cJSON *transform;
    uint64_t set = 0;
    double rotation = 0;
    uv_default(uv);
    if (!gltf_integer(g, info, where, "texCoord", 0, 1000, &set) ||
        !gltf_extension(g, info, where, "KHR_texture_transform", &transform) ||
        !gltf_integer(g, transform, where, "texCoord", 0, 1000, &set) ||
        !gltf_numbers(g, transform, where, "offset", uv->offset, 2) ||
        !gltf_numbers(g, transform, where, "scale", uv->scale, 2) ||
        !gltf_number(g, transform, where, "rotation", &rotation))
        return false;
    uv->set = (uint32_t)set;
    uv->sine = sin(rotation);
    uv->cosine = cos(rotation);
    return true;
}

/* One textureInfo of a material; *uv is set by the first that is met. */
static bool texture_info(struct gltf *g, const cJSON *parent,
                         const char *material, const char *key,
                         struct hlh_texture *out, struct gltf_uv *uv,
                         bool *have_uv, const cJSON **info)
{
    struct gltf_uv own;
    uint32_t texture;
    char where[96];
    if (!gltf_object(g, parent, material, key, info))
        return false;
    if (!*info)
        return true;
    snprintf(where, sizeof where, "%s.%s", material, key);
    if (!gltf_index(g, *info, where, "index", GLTF_TEXTURES, &texture))
        return false;
    if (texture == HLH_NONE)
        return hlh_fail(g->error, g->file, "%s.index: is missing", where);
    if (!load_texture(g, texture, out) || !load_uv(g, *info, where, &own))
        return false;
    if (!*have_uv)
        *uv = own;
    *have_uv = true;
    return true;
}

static bool factors(struct gltf *g, const cJSON *item, const char *where,
                    const char *key, float *out, int n, double most)
{
    double v[4];
    for (int i = 0; i < n; i++)
        v[i] = out[i];
    if (n == 1 ? !gltf_number(g, item, where, key, v)
               : !gltf_numbers(g, item, where, key, v, n))
        return false;
    for (int i = 0; i < n; i++) {
        if (!(v[i] >= 0 && v[i] <= most + FACTOR_SLACK))
            return hlh_fail(g->error, g->file, "%s.%s: is %g, not from 0 to "
                            "%g", where, key, v[i], most);
        out[i] = (float)(v[i] > most ? most : v[i]);
    }
    return true;
}

static bool alpha_mode(struct gltf *g, const cJSON *item, const char *where,
                       struct hlh_material *m)
{
    const char *mode;
    if (!gltf_string(g, item, where, "alphaMode", &mode))
        return false;
    if (!mode || strcmp(mode, "OPAQUE") == 0)
        m->alpha = HLH_ALPHA_OPAQUE;
    else if (strcmp(mode, "MASK") == 0)
        m->alpha = HLH_ALPHA_MASK;
    else if (strcmp(mode, "BLEND") == 0)
        m->alpha = HLH_ALPHA_BLEND;
    else
        return hlh_fail(g->error, g->file, "%s.alphaMode: is \"%.20s\", not "
                        "OPAQUE, MASK or BLEND", where, mode);
    if (!factors(g, item, where, "alphaCutoff", &m->alpha_cutoff, 1, 1e30))
        return false;
    if (m->alpha != HLH_ALPHA_MASK)
        m->alpha_cutoff = 0.5f;
    return true;
}

static bool load_pbr(struct gltf *g, const cJSON *item, const char *material,
                     struct hlh_material *m, struct gltf_uv *uv, bool *have_uv)
{
    const cJSON *pbr, *info;
    char where[80];
    if (!gltf_object(g, item, material, "pbrMetallicRoughness", &pbr))
        return false;
    snprintf(where, sizeof where, "%s.pbrMetallicRoughness", material);
    return factors(g, pbr, where, "baseColorFactor", m->base_color, 4, 1) &&
           factors(g, pbr, where, "metallicFactor", &m->metallic, 1, 1) &&
           factors(g, pbr, where, "roughnessFactor", &m->roughness, 1, 1) &&
           texture_info(g, pbr, where, "baseColorTexture", &m->base_texture,
                        uv, have_uv, &info) &&
           texture_info(g, pbr, where, "metallicRoughnessTexture",
                        &m->metal_rough_texture, uv, have_uv, &info);
}

static void load_extras(const cJSON *item, struct hlh_material *m)
{
    const cJSON *brdf = gltf_extra(item, "brdf");
    m->fence = m->alpha == HLH_ALPHA_MASK &&
               cJSON_IsTrue(gltf_extra(item, "fence"));
    m->decal = cJSON_IsTrue(gltf_extra(item, "decal"));
    if (cJSON_IsNumber(brdf) && brdf->valuedouble == HLH_BRDF_SKIN)
        m->brdf = HLH_BRDF_SKIN;
}

static bool load_material(struct gltf *g, uint32_t i, struct hlh_material *m)
{
    const cJSON *item = g->list[GLTF_MATERIALS].item[i], *info, *normal;
    struct gltf_uv *uv = &g->uv[i];
    bool have_uv = false;
    double scale = 1;
    char where[48];
    snprintf(where, sizeof where, "materials[%u]", (unsigned)i);
    uv_default(uv);
    if (!load_pbr(g, item, where, m, uv, &have_uv) ||
        !texture_info(g, item, where, "normalTexture", &m->normal_texture, uv,
                      &have_uv, &normal) ||
        !texture_info(g, item, where, "emissiveTexture", &m->emission_texture,
                      uv, &have_uv, &info) ||
        !gltf_number(g, normal, where, "scale", &scale) ||
        !factors(g, item, where, "emissiveFactor", m->emission, 3, 1e30) ||
        !alpha_mode(g, item, where, m) ||
        !gltf_bool(g, item, where, "doubleSided", &m->double_sided))
        return false;
    if (!(fabs(scale) <= 1e30))
        return hlh_fail(g->error, g->file, "%s.normalTexture.scale: is %g",
                        where, scale);
    m->normal_scale = (float)scale;
    load_extras(item, m);
    return true;
}

static void renumber(const struct gltf *g, struct hlh_texture *t)
{
    if (t->image >= 0)
        t->image = (int32_t)g->image[t->image];
}

/* Those that textures of materials use, in the file's order. */
static bool load_images(struct gltf *g)
{
    for (uint32_t i = 0; i < g->list[GLTF_IMAGES].n; i++)
        if (g->image[i] != HLH_NONE && !load_image(g, i))
            return false;
    for (uint32_t i = 0; i < g->scene->n_materials; i++) {
        struct hlh_material *m = &g->scene->materials[i];
        renumber(g, &m->base_texture);
        renumber(g, &m->metal_rough_texture);
        renumber(g, &m->normal_texture);
        renumber(g, &m->emission_texture);
    }
    return true;
}

bool gltf_load_materials(struct gltf *g)
{
    uint32_t n_materials = g->list[GLTF_MATERIALS].n;
    uint32_t n_images = g->list[GLTF_IMAGES].n;
    g->uv = hlh_alloc((size_t)n_materials + 1, sizeof *g->uv);
    g->image = hlh_alloc(n_images, sizeof *g->image);
    if (!g->uv || !g->image)
        return gltf_memory(g);
    memset(g->image, 0xff, n_images * sizeof *g->image);
    uv_default(&g->uv[n_materials]);
    for (uint32_t i = 0; i < n_materials; i++) {
        struct hlh_scene *s = g->scene;
        struct hlh_material *m =
            hlh_push(&s->materials, &s->n_materials, sizeof *m);
        if (!m)
            return gltf_memory(g);
        hlh_material_default(m);
        m->name = gltf_name(g->list[GLTF_MATERIALS].item[i], "material", i);
        if (!m->name)
            return gltf_memory(g);
        if (!load_material(g, i, m))
            return false;
    }
    return load_images(g);
}
