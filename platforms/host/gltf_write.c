/* SPDX-License-Identifier: Zlib */
/* A scene as GLB. One glTF mesh of one primitive per mesh, one node per
 * object, light and camera: reading back keeps every order. */
#include "platforms/host/gltf_write.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image_png.h"

#define PI 3.14159265358979323846

struct writer {
    const struct hlh_scene *scene;
    struct hlh_buffer json, bin, views, accessors;
    uint32_t n_views, n_accessors;
};

static void print_string(struct hlh_buffer *b, const char *s)
{
    hlh_buffer_add(b, "\"", 1);
    for (; s && *s; s++)
        if (*s == '"' || *s == '\\')
            hlh_buffer_print(b, "\\%c", *s);
        else if ((unsigned char)*s < 32)
            hlh_buffer_print(b, "\\u%04x", (unsigned)*s);
        else
            hlh_buffer_add(b, s, 1);
    hlh_buffer_add(b, "\"", 1);
}

static void print_floats(struct hlh_buffer *b, const char *key, const float *v,
                         int n)
{
    hlh_buffer_print(b, "\"%s\":[", key);
    for (int i = 0; i < n; i++)
        hlh_buffer_print(b, "%s%.9g", i ? "," : "", v[i]);
    hlh_buffer_print(b, "]");
}

/* ", " between the items of a list. */
static void comma(struct hlh_buffer *b, uint32_t i)
{
    if (i)
        hlh_buffer_print(b, ",\n");
}

static uint32_t add_view(struct writer *w, size_t start, unsigned target)
{
    comma(&w->views, w->n_views);
    hlh_buffer_print(&w->views, "{\"buffer\":0,\"byteOffset\":%zu,"
                     "\"byteLength\":%zu", start, w->bin.size - start);
    if (target)
        hlh_buffer_print(&w->views, ",\"target\":%u", target);
    hlh_buffer_print(&w->views, "}");
    while (w->bin.size % 4 && !w->bin.failed)
        hlh_buffer_add(&w->bin, "", 1);
    return w->n_views++;
}

static void add_word(struct hlh_buffer *b, uint32_t u)
{
    const unsigned char bytes[4] = {
        (unsigned char)u, (unsigned char)(u >> 8), (unsigned char)(u >> 16),
        (unsigned char)(u >> 24)};
    hlh_buffer_add(b, bytes, sizeof bytes);
}

static void add_floats(struct hlh_buffer *b, const float *v, int n)
{
    for (int i = 0; i < n; i++) {
        uint32_t u;
        memcpy(&u, &v[i], sizeof u);
        add_word(b, u);
    }
}

static uint32_t add_accessor(struct writer *w, uint32_t view, unsigned type,
                             const char *shape, uint32_t count)
{
    comma(&w->accessors, w->n_accessors);
    hlh_buffer_print(&w->accessors, "{\"bufferView\":%u,\"componentType\":%u,"
                     "\"type\":\"%s\",\"count\":%u}", (unsigned)view, type,
                     shape, (unsigned)count);
    return w->n_accessors++;
}

/* The attribute that lies `offset` floats into struct hlh_vertex. */
static uint32_t add_attribute(struct writer *w, const struct hlh_mesh *mesh,
                              size_t offset, int n)
{
    static const char *const shape[] = {"VEC2", "VEC3", "VEC4"};
    size_t start = w->bin.size;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const char *v = (const char *)&mesh->vertices[i] + offset;
        add_floats(&w->bin, (const float *)(const void *)v, n);
    }
    return add_accessor(w, add_view(w, start, 34962), 5126, shape[n - 2],
                        mesh->n_vertices);
}

/* glTF wants POSITION's bounds. */
static uint32_t add_positions(struct writer *w, const struct hlh_mesh *mesh)
{
    float low[3], high[3];
    uint32_t accessor = add_attribute(w, mesh, offsetof(struct hlh_vertex,
                                                        position), 3);
    memcpy(low, mesh->vertices[0].position, sizeof low);
    memcpy(high, low, sizeof high);
    for (uint32_t i = 1; i < mesh->n_vertices; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], mesh->vertices[i].position[k]);
            high[k] = fmaxf(high[k], mesh->vertices[i].position[k]);
        }
    if (w->accessors.failed)
        return accessor;
    w->accessors.size--;                         /* its closing brace */
    hlh_buffer_print(&w->accessors, ",");
    print_floats(&w->accessors, "min", low, 3);
    hlh_buffer_print(&w->accessors, ",");
    print_floats(&w->accessors, "max", high, 3);
    hlh_buffer_print(&w->accessors, "}");
    return accessor;
}

static void write_mesh(struct writer *w, const struct hlh_mesh *mesh)
{
    struct hlh_buffer *j = &w->json;
    size_t start;
    uint32_t view;
    hlh_buffer_print(j, "{\"name\":");
    print_string(j, mesh->name);
    hlh_buffer_print(j, ",\"primitives\":[{\"attributes\":{\"POSITION\":%u",
                     (unsigned)add_positions(w, mesh));
    hlh_buffer_print(j, ",\"NORMAL\":%u", (unsigned)add_attribute(
        w, mesh, offsetof(struct hlh_vertex, normal), 3));
    if (mesh->has_tangent)
        hlh_buffer_print(j, ",\"TANGENT\":%u", (unsigned)add_attribute(
            w, mesh, offsetof(struct hlh_vertex, tangent), 4));
    if (mesh->has_uv)
        hlh_buffer_print(j, ",\"TEXCOORD_0\":%u", (unsigned)add_attribute(
            w, mesh, offsetof(struct hlh_vertex, uv), 2));
    if (mesh->has_color)
        hlh_buffer_print(j, ",\"COLOR_0\":%u", (unsigned)add_attribute(
            w, mesh, offsetof(struct hlh_vertex, color), 4));
    start = w->bin.size;
    for (uint32_t i = 0; i < mesh->n_indices; i++)
        add_word(&w->bin, mesh->indices[i]);
    view = add_view(w, start, 34963);
    hlh_buffer_print(j, "},\"indices\":%u,\"material\":%u}]}",
                     (unsigned)add_accessor(w, view, 5125, "SCALAR",
                                            mesh->n_indices),
                     (unsigned)mesh->material);
}

static const struct hlh_texture *texture_of(const struct hlh_material *m,
                                            int slot)
{
    return slot == 0 ? &m->base_texture
           : slot == 1 ? &m->metal_rough_texture
           : slot == 2 ? &m->normal_texture : &m->emission_texture;
}

/* Textures are numbered material by material, slot by slot; *next counts. */
static void write_texture(struct hlh_buffer *j, const struct hlh_texture *t,
                          const char *key, uint32_t *next)
{
    if (t->image >= 0)
        hlh_buffer_print(j, ",\"%s\":{\"index\":%u}", key,
                         (unsigned)(*next)++);
}

/* Members that begin with a comma each, in an extras of ours; or nothing. */
static void write_extras(struct hlh_buffer *j, const char *members)
{
    if (members[0])
        hlh_buffer_print(j, ",\"extras\":{\"halflight\":{%s}}", members + 1);
}

static void write_material_extras(struct hlh_buffer *j,
                                  const struct hlh_material *m)
{
    char members[64];
    snprintf(members, sizeof members, "%s%s%s",
             m->fence ? ",\"fence\":true" : "",
             m->decal ? ",\"decal\":true" : "",
             m->brdf == HLH_BRDF_SKIN ? ",\"brdf\":1" : "");
    write_extras(j, members);
}

static void write_light_extras(struct hlh_buffer *j,
                               const struct hlh_light *l)
{
    char members[64];
    snprintf(members, sizeof members, "%s%s",
             l->shadow ? ",\"shadow\":true" : "",
             l->falloff == HLH_FALLOFF_SMOOTH ? ",\"falloff\":\"smooth\""
                                              : "");
    write_extras(j, members);
}

static void write_material(struct hlh_buffer *j, const struct hlh_material *m,
                           uint32_t *next)
{
    static const char *const mode[] = {"OPAQUE", "MASK", "BLEND"};
    hlh_buffer_print(j, "{\"name\":");
    print_string(j, m->name);
    hlh_buffer_print(j, ",\"pbrMetallicRoughness\":{");
    print_floats(j, "baseColorFactor", m->base_color, 4);
    hlh_buffer_print(j, ",\"metallicFactor\":%.9g,\"roughnessFactor\":%.9g",
                     m->metallic, m->roughness);
    write_texture(j, &m->base_texture, "baseColorTexture", next);
    write_texture(j, &m->metal_rough_texture, "metallicRoughnessTexture",
                  next);
    hlh_buffer_print(j, "},");
    print_floats(j, "emissiveFactor", m->emission, 3);
    if (m->normal_texture.image >= 0)
        hlh_buffer_print(j, ",\"normalTexture\":{\"index\":%u,"
                         "\"scale\":%.9g}", (unsigned)(*next)++,
                         m->normal_scale);
    write_texture(j, &m->emission_texture, "emissiveTexture", next);
    hlh_buffer_print(j, ",\"alphaMode\":\"%s\"", mode[m->alpha]);
    if (m->alpha == HLH_ALPHA_MASK)
        hlh_buffer_print(j, ",\"alphaCutoff\":%.9g", m->alpha_cutoff);
    hlh_buffer_print(j, ",\"doubleSided\":%s",
                     m->double_sided ? "true" : "false");
    write_material_extras(j, m);
    hlh_buffer_print(j, "}");
}

/* Sampler 3 u + v wraps u and v by enum hlh_wrap. */
static void write_samplers(struct hlh_buffer *j)
{
    static const unsigned wrap[] = {10497, 33071, 33648};
    hlh_buffer_print(j, "],\n\"samplers\":[");
    for (uint32_t i = 0; i < 9; i++) {
        comma(j, i);
        hlh_buffer_print(j, "{\"magFilter\":9729,\"minFilter\":9987,"
                         "\"wrapS\":%u,\"wrapT\":%u}", wrap[i / 3],
                         wrap[i % 3]);
    }
}

static bool write_images(struct writer *w)
{
    const struct hlh_scene *s = w->scene;
    hlh_buffer_print(&w->json, "],\n\"images\":[");
    for (uint32_t i = 0; i < s->n_images; i++) {
        size_t start = w->bin.size;
        if (!hlh_png_encode(&w->bin, s->images[i].rgba, s->images[i].width,
                            s->images[i].height, PNG_COLOR_TYPE_RGBA, 8))
            return false;
        comma(&w->json, i);
        hlh_buffer_print(&w->json, "{\"mimeType\":\"image/png\","
                         "\"bufferView\":%u,\"name\":",
                         (unsigned)add_view(w, start, 0));
        print_string(&w->json, s->images[i].name);
        hlh_buffer_print(&w->json, "}");
    }
    return true;
}

static bool write_surfaces(struct writer *w)
{
    const struct hlh_scene *s = w->scene;
    struct hlh_buffer *j = &w->json;
    uint32_t next = 0;
    hlh_buffer_print(j, ",\n\"materials\":[");
    for (uint32_t i = 0; i < s->n_materials; i++) {
        comma(j, i);
        write_material(j, &s->materials[i], &next);
    }
    if (next) {
        hlh_buffer_print(j, "],\n\"textures\":[");
        next = 0;
        for (uint32_t i = 0; i < s->n_materials; i++)
            for (int slot = 0; slot < 4; slot++) {
                const struct hlh_texture *t =
                    texture_of(&s->materials[i], slot);
                if (t->image < 0)
                    continue;
                comma(j, next++);
                hlh_buffer_print(j, "{\"source\":%d,\"sampler\":%d}",
                                 (int)t->image,
                                 3 * (int)t->wrap_u + (int)t->wrap_v);
            }
        write_samplers(j);
        if (!write_images(w))
            return false;
    }
    hlh_buffer_print(j, "],\n\"meshes\":[");
    for (uint32_t i = 0; i < s->n_meshes; i++) {
        comma(j, i);
        write_mesh(w, &s->meshes[i]);
    }
    hlh_buffer_print(j, "]");
    return true;
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool unit(double v[3])
{
    double l = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(l > 1e-9))
        return false;
    for (int k = 0; k < 3; k++)
        v[k] /= l;
    return true;
}

/* A matrix whose z axis is `z` unchanged, its y axis near `up`. */
static void write_frame(struct hlh_buffer *j, const double z[3],
                        const double up[3], const float at[3])
{
    double x[3], y[3];
    static const double other[2][3] = {{0, 0, -1}, {1, 0, 0}};
    cross(x, up, z);
    for (int i = 0; i < 2 && !unit(x); i++)
        cross(x, other[i], z);
    unit(x);
    cross(y, z, x);
    hlh_buffer_print(j, "\"matrix\":[%.17g,%.17g,%.17g,0,%.17g,%.17g,%.17g,0,"
                     "%.17g,%.17g,%.17g,0,%.9g,%.9g,%.9g,1]", x[0], x[1], x[2],
                     y[0], y[1], y[2], z[0], z[1], z[2], at[0], at[1], at[2]);
}

static void write_camera(struct hlh_buffer *j, const struct hlh_camera *c)
{
    double z[3], up[3];
    for (int k = 0; k < 3; k++) {
        z[k] = (double)c->eye[k] - c->target[k];
        up[k] = c->up[k];
    }
    if (!unit(z))
        z[2] = 1;
    hlh_buffer_print(j, "{\"name\":\"camera\",\"camera\":0,");
    write_frame(j, z, up, c->eye);
    hlh_buffer_print(j, "}");
}

/* The definition: colour x intensity is pi times c. */
static void write_light(struct hlh_buffer *j, const struct hlh_light *l)
{
    static const char *const kind[] = {"point", "spot", "directional"};
    double top = fmax(l->color[0], fmax(l->color[1], l->color[2]));
    double by = top > 0 ? top : 1;
    hlh_buffer_print(j, "{\"type\":\"%s\",\"intensity\":%.17g,"
                     "\"color\":[%.17g,%.17g,%.17g]", kind[l->kind], PI * top,
                     l->color[0] / by, l->color[1] / by, l->color[2] / by);
    if (l->kind != HLH_LIGHT_DIRECTIONAL && !l->range_derived)
        hlh_buffer_print(j, ",\"range\":%.9g", l->radius);
    if (l->kind == HLH_LIGHT_SPOT)
        hlh_buffer_print(j, ",\"spot\":{\"innerConeAngle\":%.9g,"
                         "\"outerConeAngle\":%.9g}", l->inner_angle,
                         l->outer_angle);
    write_light_extras(j, l);
    hlh_buffer_print(j, "}");
}

static void write_light_node(struct hlh_buffer *j, const struct hlh_light *l,
                             uint32_t i)
{
    static const double up[3] = {0, 1, 0};
    double z[3];
    for (int k = 0; k < 3; k++)
        z[k] = -(double)l->direction[k];
    hlh_buffer_print(j, "{\"extensions\":{\"KHR_lights_punctual\":{"
                     "\"light\":%u}},", (unsigned)i);
    if (l->kind == HLH_LIGHT_POINT)
        print_floats(j, "translation", l->position, 3);
    else
        write_frame(j, z, up, l->position);
    hlh_buffer_print(j, "}");
}

static void write_nodes(struct writer *w, uint32_t n_lights)
{
    const struct hlh_scene *s = w->scene;
    struct hlh_buffer *j = &w->json;
    uint32_t n = 0, light = 0;
    hlh_buffer_print(j, ",\n\"nodes\":[");
    for (uint32_t i = 0; i < s->n_objects; i++) {
        comma(j, n++);
        hlh_buffer_print(j, "{\"mesh\":%u,", (unsigned)s->objects[i].mesh);
        print_floats(j, "matrix", s->objects[i].world, 16);
        write_extras(j, s->objects[i].no_shadow ? ",\"no_shadow\":true" : "");
        hlh_buffer_print(j, "}");
    }
    for (uint32_t i = 0; n_lights && i < s->n_lights; i++) {
        if (hlh_light_in_csv(&s->lights[i]))
            continue;
        comma(j, n++);
        write_light_node(j, &s->lights[i], light++);
    }
    comma(j, n++);
    write_camera(j, &s->camera);
    hlh_buffer_print(j, "],\n\"scene\":0,\"scenes\":[{\"name\":");
    print_string(j, s->name);
    hlh_buffer_print(j, ",\"nodes\":[");
    for (uint32_t i = 0; i < n; i++)
        hlh_buffer_print(j, "%s%u", i ? "," : "", (unsigned)i);
    hlh_buffer_print(j, "]}]");
}

static void write_lights(struct writer *w, uint32_t n_lights)
{
    const struct hlh_scene *s = w->scene;
    uint32_t n = 0;
    if (!n_lights)
        return;
    hlh_buffer_print(&w->json, ",\n\"extensionsUsed\":["
                     "\"KHR_lights_punctual\"],\"extensions\":{"
                     "\"KHR_lights_punctual\":{\"lights\":[");
    for (uint32_t i = 0; i < s->n_lights; i++) {
        if (hlh_light_in_csv(&s->lights[i]))
            continue;
        comma(&w->json, n++);
        write_light(&w->json, &s->lights[i]);
    }
    hlh_buffer_print(&w->json, "]}}");
}

static bool write_document(struct writer *w, uint32_t n_lights)
{
    struct hlh_buffer *j = &w->json;
    const struct hlh_camera *c = &w->scene->camera;
    hlh_buffer_print(j, "{\"asset\":{\"version\":\"2.0\",\"generator\":"
                     "\"halflight\"}");
    if (!write_surfaces(w))
        return false;
    hlh_buffer_print(j, ",\n\"cameras\":[{\"type\":\"perspective\","
                     "\"perspective\":{\"yfov\":%.17g,\"znear\":0.01",
                     c->vfov * (PI / 180));
    if (c->aspect > 0)
        hlh_buffer_print(j, ",\"aspectRatio\":%.9g", c->aspect);
    hlh_buffer_print(j, "}}]");
    write_nodes(w, n_lights);
    write_lights(w, n_lights);
    hlh_buffer_print(j, ",\n\"accessors\":[");
    hlh_buffer_add(j, w->accessors.bytes, w->accessors.size);
    hlh_buffer_print(j, "],\n\"bufferViews\":[");
    hlh_buffer_add(j, w->views.bytes, w->views.size);
    hlh_buffer_print(j, "],\n\"buffers\":[{\"byteLength\":%zu}]}",
                     w->bin.size);
    while (j->size % 4 && !j->failed)
        hlh_buffer_add(j, " ", 1);
    return !(j->failed || w->bin.failed || w->views.failed ||
             w->accessors.failed);
}

static bool encode(struct writer *w, struct hlh_buffer *out, const char *file,
                   struct hlh_error *error)
{
    const struct hlh_scene *s = w->scene;
    uint32_t n_lights = 0;
    uint64_t size;
    for (uint32_t i = 0; i < s->n_lights; i++)
        n_lights += !hlh_light_in_csv(&s->lights[i]);
    if (!write_document(w, n_lights))
        return hlh_fail(error, file, "out of memory");
    size = 28 + (uint64_t)w->json.size + w->bin.size;
    if (size > UINT32_MAX)
        return hlh_fail(error, file, "GLB: is larger than 4 GiB");
    hlh_buffer_add(out, "glTF", 4);
    add_word(out, 2);
    add_word(out, (uint32_t)size);
    add_word(out, (uint32_t)w->json.size);
    hlh_buffer_add(out, "JSON", 4);
    hlh_buffer_add(out, w->json.bytes, w->json.size);
    add_word(out, (uint32_t)w->bin.size);
    hlh_buffer_add(out, "BIN\0", 4);
    hlh_buffer_add(out, w->bin.bytes, w->bin.size);
    return !out->failed || hlh_fail(error, file, "out of memory");
}

bool hlh_glb_encode(struct hlh_buffer *out, const struct hlh_scene *scene,
                    const char *file, struct hlh_error *error)
{
    struct writer w = {0};
    bool ok;
    w.scene = scene;
    ok = encode(&w, out, file, error);
    hlh_buffer_free(&w.json);
    hlh_buffer_free(&w.bin);
    hlh_buffer_free(&w.views);
    hlh_buffer_free(&w.accessors);
    return ok;
}
