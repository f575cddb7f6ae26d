/* SPDX-License-Identifier: Zlib */
/* The container (GLB 2.0 or bare JSON), the JSON text, and the document's
 * top: version, required extensions, lists. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"
#include "platforms/host/image.h"
#include "platforms/host/scene_file.h"

enum { GLB_JSON = 0x4e4f534a, GLB_BIN = 0x004e4942 };

static uint32_t read32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 |
           (uint32_t)b[3] << 24;
}

/* Chunk n at byte *at of a file of `end` bytes: JSON is the first, BIN may be
 * the second, others are skipped as the format says. */
static bool glb_chunk(struct gltf *g, unsigned n, size_t end, size_t *at)
{
    uint32_t size, kind;
    if (end - *at < 8)
        return hlh_fail(g->error, g->file, "GLB chunk %u: is truncated: its "
                        "header needs 8 bytes, %zu are left", n, end - *at);
    size = read32(g->text + *at);
    kind = read32(g->text + *at + 4);
    *at += 8;
    if (size > end - *at)
        return hlh_fail(g->error, g->file, "GLB chunk %u: has %lu bytes by "
                        "its header, %zu are left", n, (unsigned long)size,
                        end - *at);
    if (n == 0 && kind != GLB_JSON)
        return hlh_fail(g->error, g->file, "GLB chunk 0: is not JSON");
    if (n == 0) {
        g->json = g->text + *at;
        g->json_size = size;
    } else if (n == 1 && kind == GLB_BIN) {
        g->bin = (const uint8_t *)g->text + *at;
        g->bin_size = size;
    }
    *at += size;
    return true;
}

static bool open_glb(struct gltf *g)
{
    size_t at = 12, end;
    if (g->size < 12)
        return hlh_fail(g->error, g->file, "GLB header: is truncated: 12 "
                        "bytes needed, the file has %zu", g->size);
    if (read32(g->text + 4) != 2)
        return hlh_fail(g->error, g->file, "GLB header: version %lu, only 2 "
                        "is supported", (unsigned long)read32(g->text + 4));
    end = read32(g->text + 8);
    if (end > g->size)
        return hlh_fail(g->error, g->file, "GLB header: the file is "
                        "truncated: %zu bytes of %zu", g->size, end);
    if (end < 20)
        return hlh_fail(g->error, g->file, "GLB header: a length of %zu "
                        "leaves no room for a chunk", end);
    for (unsigned n = 0; at < end; n++)
        if (!glb_chunk(g, n, end, &at))
            return false;
    return true;
}

static bool parse_json(struct gltf *g)
{
    const char *end = NULL;
    g->root = cJSON_ParseWithLengthOpts(g->json, g->json_size, &end, 0);
    if (!g->root)
        return hlh_fail(g->error, g->file, "JSON: is broken at byte %zu",
                        end ? (size_t)(end - g->json) : (size_t)0);
    for (; end < g->json + g->json_size; end++)
        if (!strchr(" \t\r\n", *end))            /* strchr finds 0 too */
            return hlh_fail(g->error, g->file, "JSON: goes on after its end, "
                            "at byte %zu", (size_t)(end - g->json));
    if (!cJSON_IsObject(g->root))
        return hlh_fail(g->error, g->file, "JSON: is not an object");
    return true;
}

static bool check_version(struct gltf *g)
{
    const cJSON *asset;
    const char *version, *least;
    if (!gltf_object(g, g->root, "", "asset", &asset))
        return false;
    if (!asset)
        return hlh_fail(g->error, g->file, "asset: is missing");
    if (!gltf_string(g, asset, "asset", "version", &version) ||
        !gltf_string(g, asset, "asset", "minVersion", &least))
        return false;
    if (!version || strncmp(version, "2.", 2) != 0)
        return hlh_fail(g->error, g->file, "asset.version: is \"%.20s\", only "
                        "2.x is supported", version ? version : "");
    if (least && strcmp(least, "2.0") != 0)
        return hlh_fail(g->error, g->file, "asset.minVersion: is \"%.20s\", "
                        "only 2.0 is supported", least);
    return true;
}

/* Extensions that may be required: those read, and those of materials, which
 * refine a surface that stands without them. */
static bool extension_known(const char *name)
{
    static const char material[] = "KHR_materials_";
    if (strcmp(name, "KHR_materials_pbrSpecularGlossiness") == 0)
        return false;
    return strcmp(name, "KHR_lights_punctual") == 0 ||
           strcmp(name, "KHR_texture_transform") == 0 ||
           strcmp(name, "KHR_mesh_quantization") == 0 ||
           strncmp(name, material, sizeof material - 1) == 0;
}

static bool check_extensions(struct gltf *g)
{
    const cJSON *required, *item;
    unsigned i = 0;
    if (!gltf_array(g, g->root, "", "extensionsRequired", &required))
        return false;
    cJSON_ArrayForEach(item, required) {
        if (!cJSON_IsString(item) || !item->valuestring)
            return hlh_fail(g->error, g->file, "extensionsRequired[%u]: is "
                            "not a string", i);
        if (!extension_known(item->valuestring))
            return hlh_fail(g->error, g->file, "extensionsRequired[%u]: the "
                            "file needs %.80s, which is not supported", i,
                            item->valuestring);
        i++;
    }
    return true;
}

static bool index_list(struct gltf *g, const cJSON *parent, enum gltf_list l)
{
    struct gltf_items *items = &g->list[l];
    const cJSON *array, *item;
    const char *name = gltf_list_name(l);
    uint32_t n = 0;
    if (!gltf_array(g, parent, "", name, &array))
        return false;
    cJSON_ArrayForEach(item, array) {
        if (!cJSON_IsObject(item))
            return hlh_fail(g->error, g->file, "%s[%u]: is not an object",
                            name, (unsigned)n);
        n++;
    }
    items->item = hlh_alloc(n, sizeof *items->item);
    if (!items->item)
        return gltf_memory(g);
    cJSON_ArrayForEach(item, array)
        items->item[items->n++] = item;
    return true;
}

static bool index_lists(struct gltf *g)
{
    const cJSON *lights;
    for (int l = 0; l < GLTF_LIGHTS; l++)
        if (!index_list(g, g->root, (enum gltf_list)l))
            return false;
    if (!gltf_extension(g, g->root, "extensions", "KHR_lights_punctual",
                        &lights))
        return false;
    return index_list(g, lights, GLTF_LIGHTS);
}

bool gltf_open(struct gltf *g)
{
    if (!hlh_file_read(&g->text, &g->size, g->file, g->error))
        return false;
    g->json = g->text;
    g->json_size = g->size;
    if (hlh_path_is(g->file, "glb") &&
        (g->size < 4 || memcmp(g->text, "glTF", 4) != 0))
        return hlh_fail(g->error, g->file, "GLB header: does not start with "
                        "\"glTF\"");
    if (g->size >= 4 && memcmp(g->text, "glTF", 4) == 0 && !open_glb(g))
        return false;
    return parse_json(g) && check_version(g) && check_extensions(g) &&
           index_lists(g);
}

static void release(struct gltf *g)
{
    for (uint32_t i = 0; g->owned && i < g->list[GLTF_BUFFERS].n; i++)
        free(g->owned[i]);
    for (uint32_t i = 0; g->accessor && i < g->list[GLTF_ACCESSORS].n; i++)
        free(g->accessor[i].dense);
    free(g->owned);
    free(g->buffer);
    free(g->view);
    free(g->accessor);
    free(g->uv);
    free(g->image);
    free(g->range);
    for (int l = 0; l < GLTF_N_LISTS; l++)
        free(g->list[l].item);
    cJSON_Delete(g->root);
    free(g->text);
}

bool hlh_gltf_load(struct hlh_scene *out, const char *path,
                   struct hlh_error *error)
{
    struct gltf g = {0};
    bool ok;
    g.file = path;
    g.error = error;
    g.scene = out;
    g.default_material = HLH_NONE;
    g.bytes_left = (uint64_t)1 << 31;
    g.pixels_left = (uint64_t)1 << 28;
    g.elements_left = (uint64_t)1 << 26;
    ok = gltf_open(&g) && gltf_check_access(&g) && gltf_check_lights(&g) &&
         gltf_check_cameras(&g) && gltf_load_materials(&g) &&
         gltf_load_meshes(&g) && gltf_load_nodes(&g);
    release(&g);
    return ok;
}
