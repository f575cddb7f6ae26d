/* SPDX-License-Identifier: Zlib */
/* Buffers, views and accessors: every byte that an accessor can reach is
 * proved to lie in its buffer before any is read. Sizes come from JSON as
 * integers below 2^53, counts below 2^32 and strides below 256, so that no
 * 64-bit sum or product here can wrap. Alignment is not asked for: elements
 * are read byte by byte. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"

#define SIZE_MOST ((uint64_t)1 << 53)
/* Elements of accessors that need memory of their own (sparse, or without a
 * view): a few bytes of JSON must not ask for gigabytes. */
#define DENSE_LIMIT ((uint64_t)1 << 22)

static bool missing(struct gltf *g, const char *where, const char *key)
{
    return hlh_fail(g->error, g->file, "%s.%s: is missing", where, key);
}

static bool check_buffer(struct gltf *g, uint32_t i)
{
    const cJSON *item = g->list[GLTF_BUFFERS].item[i];
    struct gltf_bytes *b = &g->buffer[i];
    uint64_t length = 0;
    const char *uri;
    size_t size;
    char where[48];
    snprintf(where, sizeof where, "buffers[%u]", (unsigned)i);
    if (!gltf_integer(g, item, where, "byteLength", 1, SIZE_MOST, &length) ||
        !gltf_string(g, item, where, "uri", &uri))
        return false;
    if (!length)
        return missing(g, where, "byteLength");
    if (uri) {
        if (!gltf_fetch(g, uri, where, &g->owned[i], &size))
            return false;
        b->at = (const uint8_t *)g->owned[i];
    } else if (i == 0 && g->bin) {
        b->at = g->bin;
        size = g->bin_size;
    } else {
        return hlh_fail(g->error, g->file, "%s: has neither a uri nor the "
                        "GLB's binary chunk", where);
    }
    if (length > size)
        return hlh_fail(g->error, g->file, "%s.byteLength: is %llu, but there "
                        "are only %zu bytes", where,
                        (unsigned long long)length, size);
    b->size = length;
    return true;
}

static bool check_view(struct gltf *g, uint32_t i)
{
    const cJSON *item = g->list[GLTF_VIEWS].item[i];
    struct gltf_bytes *v = &g->view[i];
    uint64_t offset = 0, length = 0, stride = 0;
    uint32_t buffer;
    char where[48];
    snprintf(where, sizeof where, "bufferViews[%u]", (unsigned)i);
    if (!gltf_index(g, item, where, "buffer", GLTF_BUFFERS, &buffer) ||
        !gltf_integer(g, item, where, "byteOffset", 0, SIZE_MOST, &offset) ||
        !gltf_integer(g, item, where, "byteLength", 1, SIZE_MOST, &length) ||
        !gltf_integer(g, item, where, "byteStride", 4, 252, &stride))
        return false;
    if (buffer == HLH_NONE)
        return missing(g, where, "buffer");
    if (!length)
        return missing(g, where, "byteLength");
    if (stride % 4)
        return hlh_fail(g->error, g->file, "%s.byteStride: is %u, not a "
                        "multiple of 4", where, (unsigned)stride);
    if (offset + length > g->buffer[buffer].size)
        return hlh_fail(g->error, g->file, "%s: ends at byte %llu of "
                        "buffers[%u], which has %llu", where,
                        (unsigned long long)(offset + length),
                        (unsigned)buffer,
                        (unsigned long long)g->buffer[buffer].size);
    v->at = g->buffer[buffer].at + offset;
    v->size = length;
    v->stride = (uint32_t)stride;
    return true;
}

static uint32_t component_size(uint32_t type)
{
    return type == GLTF_I8 || type == GLTF_U8 ? 1
           : type == GLTF_I16 || type == GLTF_U16 ? 2 : 4;
}

static bool component_type(struct gltf *g, const cJSON *item,
                           const char *where, uint32_t *out)
{
    uint64_t type = 0;
    if (!gltf_integer(g, item, where, "componentType", GLTF_I8, GLTF_F32,
                      &type))
        return false;
    if (!type)
        return missing(g, where, "componentType");
    if (type == 5124)
        return hlh_fail(g->error, g->file, "%s.componentType: is 5124, which "
                        "glTF does not have", where);
    *out = (uint32_t)type;
    return true;
}

/* Components, and bytes an element: columns of matrices start at multiples of
 * four bytes. */
static bool element_type(struct gltf *g, const cJSON *item, const char *where,
                         uint32_t size, uint32_t *components, uint32_t *bytes)
{
    static const struct {
        const char *name;
        uint32_t rows, columns;
    } types[] = {{"SCALAR", 1, 1}, {"VEC2", 2, 1}, {"VEC3", 3, 1},
                 {"VEC4", 4, 1}, {"MAT2", 2, 2}, {"MAT3", 3, 3},
                 {"MAT4", 4, 4}};
    const char *name;
    if (!gltf_string(g, item, where, "type", &name))
        return false;
    if (!name)
        return missing(g, where, "type");
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, name) == 0) {
            uint32_t column = types[i].rows * size;
            if (types[i].columns > 1)
                column = (column + 3) / 4 * 4;
            *components = types[i].rows * types[i].columns;
            *bytes = column * types[i].columns;
            return true;
        }
    return hlh_fail(g->error, g->file, "%s.type: is \"%.20s\"", where, name);
}

/* Elements of `bytes` each, `stride` apart, within view from offset on. */
static bool check_range(struct gltf *g, const char *where, uint32_t view,
                        uint64_t offset, uint64_t count, uint64_t stride,
                        uint64_t bytes)
{
    uint64_t end = offset + (count - 1) * stride + bytes;
    if (end <= g->view[view].size)
        return true;
    return hlh_fail(g->error, g->file, "%s: ends at byte %llu of "
                    "bufferViews[%u], which has %llu", where,
                    (unsigned long long)end, (unsigned)view,
                    (unsigned long long)g->view[view].size);
}

/* The view and offset of accessor.sparse.indices or .values. */
static bool sparse_part(struct gltf *g, const cJSON *sparse, const char *key,
                        const char *where, const cJSON **part,
                        uint32_t *view, uint64_t *offset)
{
    *offset = 0;
    if (!gltf_object(g, sparse, where, key, part))
        return false;
    if (!*part)
        return missing(g, where, key);
    if (!gltf_index(g, *part, where, "bufferView", GLTF_VIEWS, view) ||
        !gltf_integer(g, *part, where, "byteOffset", 0, SIZE_MOST, offset))
        return false;
    return *view != HLH_NONE || missing(g, where, "bufferView");
}

static uint32_t read_unsigned(const uint8_t *at, uint32_t type)
{
    switch (type) {
    case GLTF_U8:
        return at[0];
    case GLTF_U16:
        return at[0] | (uint32_t)at[1] << 8;
    default:
        return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
               (uint32_t)at[3] << 24;
    }
}

static bool is_unsigned(uint32_t type)
{
    return type == GLTF_U8 || type == GLTF_U16 || type == GLTF_U32;
}

/* The accessor's elements, packed, in memory of their own. */
static bool make_dense(struct gltf *g, struct gltf_accessor *a,
                       const char *where, uint32_t bytes)
{
    if (a->count > DENSE_LIMIT || (uint64_t)a->count * 2 > g->elements_left)
        return hlh_fail(g->error, g->file, "%s.count: %u elements are too "
                        "many for a sparse accessor", where,
                        (unsigned)a->count);
    g->elements_left -= (uint64_t)a->count * 2;
    a->dense = hlh_alloc_zero(a->count, bytes);
    if (!a->dense)
        return gltf_memory(g);
    for (uint32_t i = 0; a->at && i < a->count; i++)
        memcpy(a->dense + (size_t)i * bytes, a->at + (size_t)i * a->stride,
               bytes);
    a->at = a->dense;
    a->stride = bytes;
    return true;
}

static bool apply_sparse(struct gltf *g, struct gltf_accessor *a,
                         const cJSON *sparse, const char *where,
                         uint32_t bytes)
{
    const cJSON *indices, *values;
    uint64_t count = 0, at_indices, at_values;
    uint32_t index_view, value_view, type = 0, size;
    if (!gltf_integer(g, sparse, where, "count", 1, a->count, &count) ||
        !sparse_part(g, sparse, "indices", where, &indices, &index_view,
                     &at_indices) ||
        !sparse_part(g, sparse, "values", where, &values, &value_view,
                     &at_values) ||
        !component_type(g, indices, where, &type))
        return false;
    if (!count)
        return missing(g, where, "count");
    if (!is_unsigned(type))
        return hlh_fail(g->error, g->file, "%s.indices.componentType: is %u, "
                        "not an unsigned type", where, (unsigned)type);
    size = component_size(type);
    if (!check_range(g, where, index_view, at_indices, count, size, size) ||
        !check_range(g, where, value_view, at_values, count, bytes, bytes))
        return false;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t to = read_unsigned(g->view[index_view].at + at_indices +
                                    i * size, type);
        if (to >= a->count)
            return hlh_fail(g->error, g->file, "%s.indices: element %u is %u, "
                            "but the accessor has %u", where, (unsigned)i,
                            (unsigned)to, (unsigned)a->count);
        memcpy(a->dense + (size_t)to * bytes,
               g->view[value_view].at + at_values + i * bytes, bytes);
    }
    return true;
}

static bool check_accessor(struct gltf *g, uint32_t i)
{
    const cJSON *item = g->list[GLTF_ACCESSORS].item[i], *sparse;
    struct gltf_accessor *a = &g->accessor[i];
    uint64_t offset = 0, count = 0;
    uint32_t view, bytes = 0;
    char where[48];
    snprintf(where, sizeof where, "accessors[%u]", (unsigned)i);
    if (!gltf_index(g, item, where, "bufferView", GLTF_VIEWS, &view) ||
        !gltf_integer(g, item, where, "byteOffset", 0, SIZE_MOST, &offset) ||
        !gltf_integer(g, item, where, "count", 1, UINT32_MAX - 1, &count) ||
        !gltf_bool(g, item, where, "normalized", &a->normalized) ||
        !component_type(g, item, where, &a->type) ||
        !element_type(g, item, where, component_size(a->type),
                      &a->components, &bytes) ||
        !gltf_object(g, item, where, "sparse", &sparse))
        return false;
    if (!count)
        return missing(g, where, "count");
    a->count = (uint32_t)count;
    a->stride = bytes;
    if (view != HLH_NONE) {
        if (g->view[view].stride)
            a->stride = g->view[view].stride;
        if (a->stride < bytes)
            return hlh_fail(g->error, g->file, "%s: elements of %u bytes are "
                            "%u apart by bufferViews[%u].byteStride", where,
                            (unsigned)bytes, (unsigned)a->stride,
                            (unsigned)view);
        if (!check_range(g, where, view, offset, count, a->stride, bytes))
            return false;
        a->at = g->view[view].at + offset;
    } else if (count > DENSE_LIMIT) {
        return hlh_fail(g->error, g->file, "%s.count: %llu elements without a "
                        "bufferView are too many", where,
                        (unsigned long long)count);
    }
    if (!sparse)
        return true;
    if (!make_dense(g, a, where, bytes))
        return false;
    snprintf(where, sizeof where, "accessors[%u].sparse", (unsigned)i);
    return apply_sparse(g, a, sparse, where, bytes);
}

bool gltf_check_access(struct gltf *g)
{
    uint32_t n_buffers = g->list[GLTF_BUFFERS].n;
    uint32_t n_views = g->list[GLTF_VIEWS].n;
    uint32_t n_accessors = g->list[GLTF_ACCESSORS].n;
    g->owned = hlh_alloc_zero(n_buffers, sizeof *g->owned);
    g->buffer = hlh_alloc_zero(n_buffers, sizeof *g->buffer);
    g->view = hlh_alloc_zero(n_views, sizeof *g->view);
    g->accessor = hlh_alloc_zero(n_accessors, sizeof *g->accessor);
    if (!g->owned || !g->buffer || !g->view || !g->accessor)
        return gltf_memory(g);
    for (uint32_t i = 0; i < n_buffers; i++)
        if (!check_buffer(g, i))
            return false;
    for (uint32_t i = 0; i < n_views; i++)
        if (!check_view(g, i))
            return false;
    for (uint32_t i = 0; i < n_accessors; i++)
        if (!check_accessor(g, i))
            return false;
    return true;
}

static float read_component(const uint8_t *at, uint32_t type, bool normalized)
{
    uint32_t u = read_unsigned(at, type == GLTF_I8 ? GLTF_U8
                                   : type == GLTF_I16 ? GLTF_U16 : type);
    float f;
    switch (type) {
    case GLTF_F32:
        memcpy(&f, &u, sizeof f);
        return f;
    case GLTF_I8:
        f = (float)(u < 128 ? (int)u : (int)u - 256);
        return !normalized ? f : f < -127 ? -1 : f / 127;
    case GLTF_I16:
        f = (float)(u < 32768 ? (int)u : (int)u - 65536);
        return !normalized ? f : f < -32767 ? -1 : f / 32767;
    case GLTF_U8:
        return normalized ? (float)u / 255 : (float)u;
    case GLTF_U16:
        return normalized ? (float)u / 65535 : (float)u;
    default:
        return (float)u;
    }
}

void gltf_read(const struct gltf_accessor *a, uint32_t i, float *out)
{
    uint32_t size = component_size(a->type);
    for (uint32_t k = 0; k < a->components; k++)
        out[k] = a->at ? read_component(a->at + (size_t)i * a->stride +
                                            (size_t)k * size,
                                        a->type, a->normalized)
                       : 0;
}

uint32_t gltf_read_index(const struct gltf_accessor *a, uint32_t i)
{
    return a->at ? read_unsigned(a->at + (size_t)i * a->stride, a->type) : 0;
}
