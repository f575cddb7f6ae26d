/* SPDX-License-Identifier: Zlib */
/* Meshes of what casts shadow volumes, once a mesh. What is blended casts
 * none. What is masked casts none either: its holes have no edges that a
 * volume could be drawn from (shadow maps draw them). */
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge_parts.h"

static bool casts(const struct hlc_world *w, uint32_t item)
{
    const struct hl_surface *s = &w->surfaces[w->items[item].surface];
    return !s->blended && !s->decal && !s->masked &&
           !w->items[item].no_shadow;
}

static bool prepare(struct hlc_bridge *b, uint32_t i)
{
    const struct hlh_mesh *mesh = &b->scene->meshes[i];
    struct hlc_shadow *out = &b->world->shadows[i];
    struct hl_shadow_mesh_desc d = { mesh->vertices->position,
                                     sizeof *mesh->vertices, mesh->indices,
                                     mesh->n_indices, mesh->n_vertices };
    enum hl_result r = hl_shadow_mesh_prepare(&out->mesh, &b->hooks, &d);
    if (r == HL_OK && out->mesh.n_vertices) {
        struct hl_buf_desc buffer;
        memset(&buffer, 0, sizeof buffer);
        buffer.label = "shadow mesh";
        buffer.bytes = 8 * sizeof(float) * (size_t)out->mesh.n_vertices;
        buffer.usage = HL_BUF_VERTEX;
        buffer.data = out->mesh.vertices;
        r = hl_buf_create(b->world->device, &out->vertices, &buffer);
        b->world->bytes += buffer.bytes;
    }
    return r == HL_OK || hlc_bridge_fail(b, mesh->name, r);
}

bool hlc_shadows_make(struct hlc_bridge *b)
{
    struct hlc_world *w = b->world;
    if (!b->options->shadow_volumes)
        return true;
    w->shadows = calloc((size_t)b->scene->n_meshes + 1, sizeof *w->shadows);
    if (!w->shadows)
        return hlc_bridge_fail(b, "shadow meshes", HL_ERR_MEMORY);
    for (uint32_t i = 0; i < w->n_items; i++) {
        uint32_t mesh = b->scene->objects[w->item_object[i]].mesh;
        struct hlc_shadow *s = &w->shadows[mesh];
        if (!casts(w, i))
            continue;
        if (!s->made && !prepare(b, mesh))
            return false;
        s->made = true;
        if (s->mesh.n_vertices == 0)
            continue;
        w->items[i].shadow_mesh = &s->mesh;
        w->items[i].shadow_vertices = s->vertices;
    }
    return true;
}

void hlc_shadows_free(struct hlc_world *w)
{
    struct hl_hooks hooks = hlc_hooks();
    for (uint32_t i = 0; w->shadows && i < w->scene->n_meshes; i++) {
        hl_buf_destroy(w->device, &w->shadows[i].vertices);
        hl_shadow_mesh_free(&w->shadows[i].mesh, &hooks);
    }
    free(w->shadows);
    w->shadows = NULL;
}
