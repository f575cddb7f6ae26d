/* SPDX-License-Identifier: Zlib */
/* A pass in two steps: what may fail is prepared for all draws first, then
 * the whole is recorded, which cannot fail, so no pass is ever half there. */
#include <string.h>
#include "platforms/vulkan/vk.h"

/* ---- prepare: descriptor sets ---------------------------------------- */

struct keys { uint64_t key[HLVK_SETS][HL_MAX_TEXTURES]; };

static uint64_t range_key(const struct hlvk *v, const struct hl_bk_range *r)
{
    if (r->slot == HL_NO_SLOT)
        return 0;
    return (uint64_t)v->bufs[r->slot]->serial << 32 | r->bytes;
}

static void make_keys(const struct hlvk *v, const struct hl_bk_draw *d,
                      struct keys *out)
{
    uint32_t i;
    memset(out, 0, sizeof *out);
    for (i = 0; i < HL_MAX_UNIFORMS; i++)
        out->key[0][i] = range_key(v, &d->uniform[i]);
    for (i = 0; i < d->n_textures; i++) {
        const struct hl_bk_texture *t = &d->texture[i];
        if (t->slot != HL_NO_SLOT)
            out->key[1][i] = (uint64_t)v->texs[t->slot]->serial << 32 |
                             (uint32_t)(t->filter << 16 | t->wrap_u << 8 |
                                        t->wrap_v);
    }
    for (i = 0; i < HL_MAX_STORAGE; i++)
        out->key[2][i] = range_key(v, &d->storage[i]);
}

/* Neighbouring draws mostly bind the same: compare before asking. */
static enum hl_result find_sets(struct hlvk *v, const struct hl_bk_draw *draws,
                                uint32_t n)
{
    struct keys now, before;
    uint32_t i, kind;
    enum hl_result result;
    if (!hlvk_grow(v, &v->scratch, &v->max_scratch, n, sizeof *v->scratch))
        return HL_ERR_MEMORY;
    for (i = 0; i < n; i++) {
        make_keys(v, &draws[i], &now);
        for (kind = 0; kind < HLVK_SETS; kind++) {
            if (i > 0 && !memcmp(now.key[kind], before.key[kind],
                                 sizeof now.key[kind])) {
                v->scratch[i][kind] = v->scratch[i - 1][kind];
                continue;
            }
            result = hlvk_set_find(v, kind, now.key[kind], &draws[i],
                                   &v->scratch[i][kind]);
            if (result)
                return result;
        }
        before = now;
    }
    return HL_OK;
}

/* ---- barriers -------------------------------------------------------- */

static enum hlvk_use depth_use(const struct hl_bk_pass *p)
{
    return p->depth_read_only ? HLVK_USE_DEPTH_READ : HLVK_USE_DEPTH;
}

static void barriers(struct hlvk *v, VkCommandBuffer cmd,
                     const struct hl_bk_pass *p,
                     const struct hl_bk_draw *draws, uint32_t n)
{
    uint32_t i, k;
    v->pass++;
    for (i = 0; i < p->n_colors; i++) {
        const struct hl_bk_target *t = &p->color[i];
        hlvk_tex_use(v, cmd, v->texs[t->slot], HLVK_USE_COLOR,
                     t->load != HL_LOAD_KEEP);
        if (t->resolve != HL_NO_SLOT)
            hlvk_tex_use(v, cmd, v->texs[t->resolve], HLVK_USE_COLOR, true);
    }
    if (p->depth.slot != HL_NO_SLOT)
        hlvk_tex_use(v, cmd, v->texs[p->depth.slot], depth_use(p),
                     p->depth.load != HL_LOAD_KEEP);
    for (i = 0; i < n; i++)
        for (k = 0; k < draws[i].n_textures; k++) {
            uint32_t slot = draws[i].texture[k].slot;
            struct hlvk_tex *t = slot == HL_NO_SLOT ? v->white
                                                    : v->texs[slot];
            if (t->pass == v->pass)
                continue;
            t->pass = v->pass;
            hlvk_tex_use(v, cmd, t, hlvk_sampled(t), false);
        }
    hlvk_tex_use(v, cmd, v->white, HLVK_USE_SAMPLED, false);
    hlvk_barrier(v, cmd);
}

/* ---- rendering ------------------------------------------------------- */

static VkAttachmentLoadOp load_op(enum hl_load load)
{
    return load == HL_LOAD_KEEP ? VK_ATTACHMENT_LOAD_OP_LOAD
         : load == HL_LOAD_CLEAR ? VK_ATTACHMENT_LOAD_OP_CLEAR
                                 : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
}

static VkAttachmentStoreOp store_op(bool discard)
{
    return discard ? VK_ATTACHMENT_STORE_OP_DONT_CARE
                   : VK_ATTACHMENT_STORE_OP_STORE;
}

static VkClearColorValue clear_color(enum hl_format format,
                                     const float clear[4])
{
    VkClearColorValue c;
    int i;
    memcpy(c.float32, clear, sizeof c.float32);
    if (hl_format_info(format)->kind == HL_KIND_UINT)
        for (i = 0; i < 4; i++)
            c.uint32[i] = clear[i] <= 0.0f ? 0
                        : clear[i] >= 4294967040.0f ? UINT32_MAX
                                                    : (uint32_t)clear[i];
    return c;
}

static void color_attachment(const struct hlvk *v,
                             const struct hl_bk_target *t,
                             VkRenderingAttachmentInfo *a)
{
    const struct hlvk_tex *x = v->texs[t->slot];
    a->sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    a->imageView = x->target;
    a->imageLayout = hlvk_layout(HLVK_USE_COLOR);
    a->loadOp = load_op(t->load);
    a->storeOp = store_op(t->discard);
    a->clearValue.color = clear_color(x->format, t->clear);
    if (t->resolve == HL_NO_SLOT)
        return;
    /* Integers cannot be averaged: theirs is the first sample. */
    a->resolveMode = hl_format_info(x->format)->kind == HL_KIND_UINT
                     ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT
                     : VK_RESOLVE_MODE_AVERAGE_BIT;
    a->resolveImageView = v->texs[t->resolve]->target;
    a->resolveImageLayout = hlvk_layout(HLVK_USE_COLOR);
}

static void depth_attachment(const struct hlvk *v, const struct hl_bk_pass *p,
                             VkRenderingAttachmentInfo *a)
{
    a->sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    a->imageView = v->texs[p->depth.slot]->target;
    a->imageLayout = hlvk_layout(depth_use(p));
    a->loadOp = load_op(p->depth.load);
    /* Any other store counts as a write, which would race with shaders that
     * sample this very image. */
    a->storeOp = p->depth_read_only ? VK_ATTACHMENT_STORE_OP_NONE
                                    : store_op(p->depth.discard);
    a->clearValue.depthStencil.depth = p->depth.clear[0];
}

static void rendering_begin(const struct hlvk *v, VkCommandBuffer cmd,
                            const struct hl_bk_pass *p)
{
    VkRenderingAttachmentInfo colors[HL_MAX_COLORS], depth;
    VkRenderingInfo info = { .sType = VK_STRUCTURE_TYPE_RENDERING_INFO };
    VkViewport viewport = { 0 };
    uint32_t i;
    memset(colors, 0, sizeof colors);
    memset(&depth, 0, sizeof depth);
    for (i = 0; i < p->n_colors; i++)
        color_attachment(v, &p->color[i], &colors[i]);
    info.renderArea.extent.width = p->width;
    info.renderArea.extent.height = p->height;
    info.layerCount = 1;
    info.colorAttachmentCount = p->n_colors;
    info.pColorAttachments = colors;
    if (p->depth.slot != HL_NO_SLOT) {
        depth_attachment(v, p, &depth);
        info.pDepthAttachment = &depth;
    }
    vkCmdBeginRendering(cmd, &info);
    viewport.width = (float)p->width;
    viewport.height = (float)p->height;
    viewport.maxDepth = 1.0f;
    vkCmdSetViewport(cmd, 0, 1, &viewport);
}

/* ---- draws ----------------------------------------------------------- */

/* What is bound; nothing is bound twice. */
struct bound {
    VkPipeline pipeline;
    VkDescriptorSet sets[HLVK_SETS];
    uint32_t offsets[HL_MAX_UNIFORMS + HL_MAX_STORAGE];
    VkBuffer streams[HL_MAX_STREAMS + 1];
    VkBuffer index;
    bool index16;
    struct hl_rect scissor;
};

static uint32_t offset_of(const struct hl_bk_range *r)
{
    return r->slot == HL_NO_SLOT ? 0 : r->offset;
}

static void bind_sets(const struct hlvk *v, VkCommandBuffer cmd,
                      struct bound *b, const struct hl_bk_draw *d,
                      const VkDescriptorSet *sets)
{
    uint32_t offsets[HL_MAX_UNIFORMS + HL_MAX_STORAGE];
    const uint32_t *storage = offsets + HL_MAX_UNIFORMS;
    uint32_t i;
    for (i = 0; i < HL_MAX_UNIFORMS; i++)
        offsets[i] = offset_of(&d->uniform[i]);
    for (i = 0; i < HL_MAX_STORAGE; i++)
        offsets[HL_MAX_UNIFORMS + i] = offset_of(&d->storage[i]);
    if (sets[0] != b->sets[0] ||
        memcmp(offsets, b->offsets, HL_MAX_UNIFORMS * sizeof *offsets))
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                v->layout, 0, 1, sets, HL_MAX_UNIFORMS,
                                offsets);
    if (sets[1] != b->sets[1])
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                v->layout, 1, 1, sets + 1, 0, NULL);
    if (sets[2] != b->sets[2] ||
        memcmp(storage, b->offsets + HL_MAX_UNIFORMS,
               HL_MAX_STORAGE * sizeof *offsets))
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                v->layout, 2, 1, sets + 2, HL_MAX_STORAGE,
                                storage);
    memcpy(b->sets, sets, sizeof b->sets);
    memcpy(b->offsets, offsets, sizeof b->offsets);
}

static void bind_streams(const struct hlvk *v, VkCommandBuffer cmd,
                         struct bound *b, const struct hl_bk_draw *d,
                         uint32_t streams)
{
    static const VkDeviceSize zero = 0;
    uint32_t i;
    for (i = 0; streams >> i; i++) {
        VkBuffer buffer = v->dummy->buffer;
        if (!(streams >> i & 1))
            continue;
        if (i < HL_MAX_STREAMS && d->vertex[i] != HL_NO_SLOT)
            buffer = v->bufs[d->vertex[i]]->buffer;
        if (buffer == b->streams[i])
            continue;
        vkCmdBindVertexBuffers(cmd, i, 1, &buffer, &zero);
        b->streams[i] = buffer;
    }
}

static void bind_index(const struct hlvk *v, VkCommandBuffer cmd,
                       struct bound *b, const struct hl_bk_draw *d)
{
    VkBuffer buffer = v->bufs[d->index]->buffer;
    if (buffer == b->index && d->index16 == b->index16)
        return;
    vkCmdBindIndexBuffer(cmd, buffer, 0, d->index16 ? VK_INDEX_TYPE_UINT16
                                                    : VK_INDEX_TYPE_UINT32);
    b->index = buffer;
    b->index16 = d->index16;
}

static void bind_scissor(VkCommandBuffer cmd, struct bound *b,
                         const struct hl_rect *r)
{
    VkRect2D rect;
    if (!memcmp(r, &b->scissor, sizeof *r))
        return;
    rect.offset.x = r->x;
    rect.offset.y = r->y;
    rect.extent.width = (uint32_t)r->width;
    rect.extent.height = (uint32_t)r->height;
    vkCmdSetScissor(cmd, 0, 1, &rect);
    b->scissor = *r;
}

static void record_draw(const struct hlvk *v, VkCommandBuffer cmd,
                        struct bound *b, const struct hl_bk_draw *d,
                        const VkDescriptorSet *sets)
{
    const struct hlvk_prog *p = v->progs[d->prog];
    if (p->pipeline != b->pipeline) {
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, p->pipeline);
        b->pipeline = p->pipeline;
    }
    bind_sets(v, cmd, b, d, sets);
    bind_streams(v, cmd, b, d, p->streams);
    bind_scissor(cmd, b, &d->scissor);
    if (d->index == HL_NO_SLOT) {
        vkCmdDraw(cmd, d->count, d->instances, d->first, 0);
        return;
    }
    bind_index(v, cmd, b, d);
    vkCmdDrawIndexed(cmd, d->count, d->instances, d->first, d->base_vertex,
                     0);
}

enum hl_result hlvk_pass_run(void *state, const struct hl_bk_pass *pass,
                             const struct hl_bk_draw *draws, uint32_t n)
{
    struct hlvk *v = state;
    struct hlvk_frame *f;
    struct bound bound;
    uint32_t i;
    enum hl_result result = hlvk_begin(v, &f);
    if (!result)
        result = find_sets(v, draws, n);
    if (!result)
        result = hlvk_pass_reserve(v, f);
    if (result)
        return result;
    memset(&bound, 0, sizeof bound);
    barriers(v, f->cmd, pass, draws, n);
    hlvk_pass_begin(v, f, pass->label);
    rendering_begin(v, f->cmd, pass);
    for (i = 0; i < n; i++)
        record_draw(v, f->cmd, &bound, &draws[i], v->scratch[i]);
    vkCmdEndRendering(f->cmd);
    hlvk_pass_end(v, f);
    return HL_OK;
}
