/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"

/* Integers above this are no longer exact in a double. */
#define EXACT_LIMIT 9007199254740992.0

static const char *const list_names[GLTF_N_LISTS] = {
    "buffers", "bufferViews", "accessors", "meshes", "materials", "textures",
    "images", "samplers", "nodes", "scenes", "cameras", "lights"
};

const char *gltf_list_name(enum gltf_list list)
{
    return list_names[list];
}

bool gltf_memory(struct gltf *g)
{
    return hlh_fail(g->error, g->file, "out of memory");
}

static const cJSON *get(const cJSON *object, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(object, key);
}

static bool wrong(struct gltf *g, const char *where, const char *key,
                  const char *wanted)
{
    return hlh_fail(g->error, g->file, "%s%s%s: is not %s", where,
                    *where ? "." : "", key, wanted);
}

bool gltf_number(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, double *out)
{
    const cJSON *value = get(object, key);
    if (!value)
        return true;
    if (!cJSON_IsNumber(value) || !isfinite(value->valuedouble))
        return wrong(g, where, key, "a finite number");
    *out = value->valuedouble;
    return true;
}

bool gltf_numbers(struct gltf *g, const cJSON *object, const char *where,
                  const char *key, double *out, int n)
{
    const cJSON *array = get(object, key), *value;
    int i = 0;
    if (!array)
        return true;
    if (!cJSON_IsArray(array))
        return wrong(g, where, key, "an array");
    cJSON_ArrayForEach(value, array) {
        if (i < n && (!cJSON_IsNumber(value) || !isfinite(value->valuedouble)))
            return hlh_fail(g->error, g->file, "%s.%s[%d]: is not a finite "
                            "number", where, key, i);
        if (i < n)
            out[i] = value->valuedouble;
        i++;
    }
    if (i != n)
        return hlh_fail(g->error, g->file, "%s.%s: has %d numbers, not %d",
                        where, key, i, n);
    return true;
}

bool gltf_integer(struct gltf *g, const cJSON *object, const char *where,
                  const char *key, uint64_t low, uint64_t high, uint64_t *out)
{
    const cJSON *value = get(object, key);
    double v;
    if (!value)
        return true;
    if (!cJSON_IsNumber(value))
        return wrong(g, where, key, "a number");
    v = value->valuedouble;
    if (!(v >= 0 && v <= EXACT_LIMIT) || v != floor(v))
        return hlh_fail(g->error, g->file, "%s.%s: is %g, not a whole number "
                        "from 0", where, key, v);
    if ((uint64_t)v < low || (uint64_t)v > high)
        return hlh_fail(g->error, g->file, "%s.%s: is %.17g, not from %llu to "
                        "%llu", where, key, v, (unsigned long long)low,
                        (unsigned long long)high);
    *out = (uint64_t)v;
    return true;
}

bool gltf_index_value(struct gltf *g, const cJSON *value, const char *where,
                      const char *key, enum gltf_list list, uint32_t *out)
{
    double v;
    if (!cJSON_IsNumber(value))
        return wrong(g, where, key, "a number");
    v = value->valuedouble;
    if (!(v >= 0 && v < g->list[list].n) || v != floor(v))
        return hlh_fail(g->error, g->file, "%s%s%s: is %.17g, but there are "
                        "%u %s", where, *where ? "." : "", key, v,
                        (unsigned)g->list[list].n, list_names[list]);
    *out = (uint32_t)v;
    return true;
}

bool gltf_index(struct gltf *g, const cJSON *object, const char *where,
                const char *key, enum gltf_list list, uint32_t *out)
{
    const cJSON *value = get(object, key);
    *out = HLH_NONE;
    return !value || gltf_index_value(g, value, where, key, list, out);
}

bool gltf_bool(struct gltf *g, const cJSON *object, const char *where,
               const char *key, bool *out)
{
    const cJSON *value = get(object, key);
    if (!value)
        return true;
    if (!cJSON_IsBool(value))
        return wrong(g, where, key, "true or false");
    *out = cJSON_IsTrue(value);
    return true;
}

bool gltf_string(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, const char **out)
{
    const cJSON *value = get(object, key);
    *out = NULL;
    if (!value)
        return true;
    if (!cJSON_IsString(value) || !value->valuestring)
        return wrong(g, where, key, "a string");
    *out = value->valuestring;
    return true;
}

bool gltf_object(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, const cJSON **out)
{
    *out = get(object, key);
    if (*out && !cJSON_IsObject(*out))
        return wrong(g, where, key, "an object");
    return true;
}

bool gltf_array(struct gltf *g, const cJSON *object, const char *where,
                const char *key, const cJSON **out)
{
    *out = get(object, key);
    if (*out && !cJSON_IsArray(*out))
        return wrong(g, where, key, "an array");
    return true;
}

bool gltf_extension(struct gltf *g, const cJSON *object, const char *where,
                    const char *name, const cJSON **out)
{
    const cJSON *extensions;
    *out = NULL;
    if (!gltf_object(g, object, where, "extensions", &extensions))
        return false;
    return !extensions || gltf_object(g, extensions, where, name, out);
}

/* cJSON finds no member in NULL or in what is no object. */
const cJSON *gltf_extra(const cJSON *object, const char *key)
{
    const cJSON *extras = get(object, "extras");
    const cJSON *ours = cJSON_IsObject(extras) ? get(extras, "halflight")
                                               : NULL;
    return cJSON_IsObject(ours) ? get(ours, key) : NULL;
}

char *gltf_name(const cJSON *object, const char *kind, uint32_t i)
{
    const cJSON *name = get(object, "name");
    char text[64];
    if (cJSON_IsString(name) && name->valuestring && *name->valuestring)
        return hlh_strdup(name->valuestring);
    snprintf(text, sizeof text, "%s %u", kind, (unsigned)i);
    return hlh_strdup(text);
}
