/* SPDX-License-Identifier: Zlib */
/* Meshes: normal groups and tangents by core, then all meshes of a layout in
 * one set of buffers, so that draws differ in offsets and not in bindings. */
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge_parts.h"

enum { STREAMS = 4, INDEX16 = HLC_LAYOUTS * STREAMS, INDEX32 };

static const uint16_t strides[HLC_LAYOUTS][STREAMS] = {
    { 12, 16, 12, 0 }, { 12, 16, 12, 12 }, { 12, 16, 12, 24 }
};

void hlc_layout_describe(struct hl_vertex_layout *out, enum hlc_layout layout)
{
    memset(out, 0, sizeof *out);
    memcpy(out->stride, strides[layout], sizeof strides[layout]);
    out->attr[HL_ATTR_POSITION] = (struct hl_attr){ HL_ATTR_F32X3, 0, 0 };
    out->attr[HL_ATTR_TANGENT] = (struct hl_attr){ HL_ATTR_F32X4, 1, 0 };
    out->attr[HL_ATTR_NORMAL] = (struct hl_attr){ HL_ATTR_F32X3, 2, 0 };
    if (layout == HLC_LAYOUT_PLAIN)
        return;
    out->attr[HL_ATTR_UV] = (struct hl_attr){ HL_ATTR_F32X2, 3, 0 };
    out->attr[HL_ATTR_COLOR] = (struct hl_attr){
        layout == HLC_LAYOUT_COLORED ? HL_ATTR_F32X4 : HL_ATTR_U8X4_UNORM,
        3, 8
    };
}

/* ---- what a mesh needs ------------------------------------------------- */

/* A factor of zero leaves nothing of a texture. */
static uint32_t textures_of(const struct hlh_material *m,
                            const struct hlc_world_options *o)
{
    uint32_t bits = 0;
    if (m->base_texture.image >= 0)
        bits |= HL_TEXTURED_BASE;
    if (m->metal_rough_texture.image >= 0 &&
        (m->metallic > 0 || m->roughness > 0))
        bits |= HL_TEXTURED_METAL_ROUGH;
    if (m->normal_texture.image >= 0 && !o->no_normal_maps)
        bits |= HL_TEXTURED_NORMAL;
    if (m->emission_texture.image >= 0 &&
        (m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0))
        bits |= HL_TEXTURED_EMISSION;
    return bits;
}

static bool is_colored(const struct hlh_mesh *mesh)
{
    if (!mesh->has_color)
        return false;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        for (int k = 0; k < 4; k++)
            if (mesh->vertices[i].color[k] < 1 ||
                mesh->vertices[i].color[k] > 1)
                return true;
    return false;
}

static void classify(struct hlc_part *part, const struct hlh_mesh *mesh,
                     const struct hlh_material *m,
                     const struct hlc_world_options *o)
{
    bool colored = is_colored(mesh);
    bool constant = m->base_texture.image < 0 && !colored;
    bool masked = m->alpha == HLH_ALPHA_MASK && !m->decal;
    part->textures = textures_of(m, o);
    part->masked = masked && !constant;
    part->decal = m->decal;
    part->blended = !m->decal && (m->alpha == HLH_ALPHA_BLEND || m->fence);
    part->hidden = masked && constant && !m->fence &&
                   !(m->base_color[3] >= m->alpha_cutoff);
    part->layout = colored ? HLC_LAYOUT_COLORED
                   : part->textures || part->masked ? HLC_LAYOUT_FULL
                   : HLC_LAYOUT_PLAIN;
}

/* ---- preparation ------------------------------------------------------- */

static void find_bounds(struct hlc_part *part, const struct hlh_mesh *mesh)
{
    for (uint32_t i = 0; i < part->prep.n_vertices; i++) {
        const float *p = mesh->vertices[part->prep.source_vertex[i]].position;
        for (int k = 0; k < 3; k++) {
            if (i == 0 || p[k] < part->min[k])
                part->min[k] = p[k];
            if (i == 0 || p[k] > part->max[k])
                part->max[k] = p[k];
        }
    }
}

static bool prepare(struct hlc_bridge *b, uint32_t i)
{
    const struct hlh_mesh *mesh = &b->scene->meshes[i];
    struct hlc_part *part = &b->parts[i];
    struct hl_mesh_desc d;
    memset(&d, 0, sizeof d);
    classify(part, mesh, &b->scene->materials[mesh->material], b->options);
    d.positions = mesh->vertices->position;
    d.normals = mesh->vertices->normal;
    d.position_stride = d.normal_stride = sizeof *mesh->vertices;
    /* Tangents split vertices: only where a normal map reads them. glTF: v
     * runs down the image, green points up it. */
    if ((part->textures & HL_TEXTURED_NORMAL) && mesh->has_tangent) {
        d.tangents = mesh->vertices->tangent;
        d.tangent_stride = sizeof *mesh->vertices;
    } else if ((part->textures & HL_TEXTURED_NORMAL) && mesh->has_uv) {
        d.uvs = mesh->vertices->uv;
        d.uv_stride = sizeof *mesh->vertices;
        d.v_down = true;
    }
    d.indices = mesh->indices;
    d.n_indices = mesh->n_indices;
    d.n_vertices = mesh->n_vertices;
    enum hl_result r = hl_mesh_prepare(&part->prep, &b->hooks, &d);
    if (r != HL_OK)
        return hlc_bridge_fail(b, mesh->name, r);
    find_bounds(part, mesh);
    part->code = calloc(part->prep.n_groups ? part->prep.n_groups : 1,
                        sizeof *part->code);
    return part->code ? true : hlc_bridge_fail(b, mesh->name, HL_ERR_MEMORY);
}

bool hlc_parts_prepare(struct hlc_bridge *b)
{
    const struct hlh_scene *s = b->scene;
    b->parts = calloc(s->n_meshes ? s->n_meshes : 1, sizeof *b->parts);
    if (!b->parts)
        return hlc_bridge_fail(b, "meshes", HL_ERR_MEMORY);
    for (uint32_t i = 0; i < s->n_objects; i++)
        b->parts[s->objects[i].mesh].used = true;
    for (uint32_t i = 0; i < s->n_meshes; i++) {
        bool empty = s->meshes[i].n_indices == 0;
        b->parts[i].used = b->parts[i].used && !empty;
        if (b->parts[i].used && !prepare(b, i))
            return false;
        b->parts[i].used = b->parts[i].prep.n_indices > 0;
    }
    return true;
}

void hlc_parts_free(struct hlc_bridge *b)
{
    for (uint32_t i = 0; b->parts && i < b->scene->n_meshes; i++) {
        hl_mesh_prep_free(&b->parts[i].prep, &b->hooks);
        free(b->parts[i].code);
        free(b->parts[i].color);
    }
    free(b->parts);
    b->parts = NULL;
}

/* ---- vertices ---------------------------------------------------------- */

/* A file's tangent of zero stays zero, which leaves the interpolated normal
 * alone; core would take any direction across it. */
static void tangent_of(float out[4], const struct hlc_part *part,
                       const struct hlh_mesh *mesh, uint32_t i)
{
    const float *t = part->prep.tangent ? part->prep.tangent + 4 * (size_t)i
                                        : NULL;
    const float *file = mesh->vertices[part->prep.source_vertex[i]].tangent;
    bool none = !t || (mesh->has_tangent && file[0] == 0 && file[1] == 0 &&
                       file[2] == 0);
    for (int k = 0; k < 3; k++)
        out[k] = none ? 0 : t[k];
    out[3] = hl_mesh_pack_tangent_w(t ? t[3] : 1.0f,
                                    part->code[part->prep.group[i]]);
}

static void write_vertex(uint8_t *to, int stream, const struct hlc_part *part,
                         const struct hlh_mesh *mesh, uint32_t i)
{
    static const uint8_t white[4] = { 255, 255, 255, 255 };
    const struct hlh_vertex *v = &mesh->vertices[part->prep.source_vertex[i]];
    float tangent[4];
    if (stream == 0)
        memcpy(to, v->position, sizeof v->position);
    if (stream == 1) {
        tangent_of(tangent, part, mesh, i);
        memcpy(to, tangent, sizeof tangent);
    }
    if (stream == 2)
        memcpy(to, part->prep.normal + 3 * (size_t)i, 3 * sizeof(float));
    if (stream < 3)
        return;
    memcpy(to, v->uv, sizeof v->uv);
    if (part->layout == HLC_LAYOUT_COLORED)
        memcpy(to + sizeof v->uv, v->color, sizeof v->color);
    else
        memcpy(to + sizeof v->uv, white, sizeof white);
}

static bool make_buffer(struct hlc_bridge *b, uint32_t slot, const void *data,
                        size_t bytes, uint32_t usage)
{
    struct hl_buf_desc d;
    memset(&d, 0, sizeof d);
    d.label = "mesh";
    d.bytes = bytes;
    d.usage = usage;
    d.data = data;
    enum hl_result r = hl_buf_create(b->world->device,
                                     &b->world->buffers[slot], &d);
    b->world->bytes += bytes;
    return r == HL_OK || hlc_bridge_fail(b, "vertex and index buffers", r);
}

static bool upload_stream(struct hlc_bridge *b, enum hlc_layout layout,
                          int stream, uint32_t n_vertices)
{
    size_t stride = strides[layout][stream], bytes = stride * n_vertices;
    if (bytes == 0)
        return true;
    uint8_t *data = malloc(bytes), *at = data;
    if (!data)
        return hlc_bridge_fail(b, "vertices", HL_ERR_MEMORY);
    for (uint32_t m = 0; m < b->scene->n_meshes; m++) {
        const struct hlc_part *part = &b->parts[m];
        if (!part->used || part->layout != layout)
            continue;
        for (uint32_t i = 0; i < part->prep.n_vertices; i++, at += stride)
            write_vertex(at, stream, part, &b->scene->meshes[m], i);
    }
    bool ok = make_buffer(b, layout * STREAMS + (uint32_t)stream, data, bytes,
                          HL_BUF_VERTEX);
    free(data);
    return ok;
}

/* ---- indices ----------------------------------------------------------- */

static bool upload_indices(struct hlc_bridge *b, bool narrow, uint32_t n)
{
    size_t size = narrow ? sizeof(uint16_t) : sizeof(uint32_t);
    if (n == 0)
        return true;
    uint8_t *data = malloc(size * n), *at = data;
    if (!data)
        return hlc_bridge_fail(b, "indices", HL_ERR_MEMORY);
    for (uint32_t m = 0; m < b->scene->n_meshes; m++) {
        const struct hlc_part *part = &b->parts[m];
        if (!part->used || part->index16 != narrow)
            continue;
        for (uint32_t i = 0; i < part->prep.n_indices; i++, at += size) {
            uint16_t small = (uint16_t)part->prep.indices[i];
            if (narrow)
                memcpy(at, &small, size);
            else
                memcpy(at, &part->prep.indices[i], size);
        }
    }
    bool ok = make_buffer(b, narrow ? INDEX16 : INDEX32, data, size * n,
                          HL_BUF_INDEX);
    free(data);
    return ok;
}

/* 65,535 is left out: some machines restart a strip there. */
static bool place(struct hlc_bridge *b, uint32_t n_vertices[HLC_LAYOUTS],
                  uint32_t n_indices[2])
{
    uint64_t v[HLC_LAYOUTS] = { 0 }, n[2] = { 0 };
    for (uint32_t m = 0; m < b->scene->n_meshes; m++) {
        struct hlc_part *part = &b->parts[m];
        if (!part->used)
            continue;
        part->index16 = part->prep.n_vertices <= 65535;
        part->base_vertex = (int32_t)v[part->layout];
        part->first = (uint32_t)n[part->index16];
        v[part->layout] += part->prep.n_vertices;
        n[part->index16] += part->prep.n_indices;
        if (v[part->layout] > INT32_MAX || n[part->index16] > INT32_MAX)
            return hlc_bridge_fail(b, "meshes", HL_ERR_LIMIT);
    }
    for (int i = 0; i < HLC_LAYOUTS; i++)
        n_vertices[i] = (uint32_t)v[i];
    n_indices[0] = (uint32_t)n[0];
    n_indices[1] = (uint32_t)n[1];
    return true;
}

bool hlc_parts_upload(struct hlc_bridge *b)
{
    uint32_t n_vertices[HLC_LAYOUTS] = { 0 }, n_indices[2] = { 0 };
    if (!place(b, n_vertices, n_indices))
        return false;
    for (int layout = 0; layout < HLC_LAYOUTS; layout++)
        for (int s = 0; s < STREAMS; s++)
            if (!upload_stream(b, (enum hlc_layout)layout, s,
                               n_vertices[layout]))
                return false;
    if (!upload_indices(b, false, n_indices[0]) ||
        !upload_indices(b, true, n_indices[1]))
        return false;
    struct hlc_world *w = b->world;
    for (uint32_t i = 0; i < w->n_items; i++) {
        struct hl_item *item = &w->items[i];
        uint32_t mesh = b->scene->objects[w->item_object[i]].mesh;
        const struct hlc_part *part = &b->parts[mesh];
        for (uint32_t s = 0; s < STREAMS; s++)
            item->vertex[s] = w->buffers[part->layout * STREAMS + s];
        item->index = w->buffers[part->index16 ? INDEX16 : INDEX32];
        item->index16 = part->index16;
        item->first = part->first;
        item->count = part->prep.n_indices;
        item->base_vertex = part->base_vertex;
    }
    return true;
}
