/* SPDX-License-Identifier: Zlib */
/* A pass in two steps: what may fail is prepared for all draws first, then
 * the whole is recorded, which cannot fail, so no pass is ever half there. */
#include <string.h>
#include "platforms/vulkan/vk.h"

/* ---- descriptor sets --------------------------------------------------- */

const struct hl_bk_range *hlvk_ranges(const struct hl_bk_draw *draw,
                                      uint32_t kind)
{
    return kind == HLVK_SET_STORAGE ? draw->storage : draw->uniform;
}

static uint64_t range_key(const struct hlvk *v, const struct hl_bk_range *r)
{
    if (r->slot == HL_NO_SLOT)
        return 0;
    return (uint64_t)v->bufs[r->slot]->serial << 32 | r->bytes;
}

static uint64_t texture_key(const struct hlvk *v, const struct hl_bk_draw *d,
                            uint32_t i)
{
    const struct hl_bk_texture *t = &d->texture[i];
    if (i >= d->n_textures || t->slot == HL_NO_SLOT)
        return 0;
    return (uint64_t)v->texs[t->slot]->serial << 32 |
           (uint32_t)(t->filter << 16 | t->wrap_u << 8 | t->wrap_v);
}

/* What the program reads of one set; 0 where nothing is bound or read. */
static void make_key(const struct hlvk *v, const struct hl_bk_draw *d,
                     uint32_t kind, uint32_t reads, uint64_t *key)
{
    for (uint32_t i = 0; i < hlvk_set_kinds[kind].n; i++)
        key[i] = !(reads >> i & 1) ? 0
               : kind == HLVK_SET_TEXTURES ? texture_key(v, d, i)
               : range_key(v, &hlvk_ranges(d, kind)[i]);
}

/* Neighbouring draws mostly bind the same: compare before asking. */
static enum hl_result find_sets(struct hlvk *v, const struct hl_bk_draw *draws,
                                uint32_t n, bool *storage)
{
    uint64_t keys[HLVK_SETS][HL_MAX_TEXTURES], key[HL_MAX_TEXTURES];
    VkDescriptorSet sets[HLVK_SETS] = { VK_NULL_HANDLE };
    if (!hl_bk_grow(v->device, &v->scratch, &v->max_scratch, n,
                    sizeof *v->scratch))
        return HL_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t kind = 0; kind < HLVK_SETS; kind++) {
            uint32_t reads = v->progs[draws[i].prog]->reads[kind];
            size_t bytes = hlvk_set_kinds[kind].n * sizeof *key;
            if (!reads)
                continue;
            make_key(v, &draws[i], kind, reads, key);
            if (!sets[kind] || memcmp(key, keys[kind], bytes)) {
                enum hl_result r = hlvk_set_find(v, kind, key, &draws[i],
                                                 &sets[kind]);
                if (r)
                    return r;
                memcpy(keys[kind], key, bytes);
            }
            v->scratch[i][kind] = sets[kind];
        }
    *storage = sets[HLVK_SET_STORAGE] != VK_NULL_HANDLE;
    return HL_OK;
}

/* ---- barriers ---------------------------------------------------------- */

static enum hlvk_use depth_use(const struct hl_bk_pass *p)
{
    return p->depth_read_only ? HLVK_USE_DEPTH_READ : HLVK_USE_DEPTH;
}

static void use_targets(struct hlvk *v, VkCommandBuffer cmd,
                        const struct hl_bk_pass *p)
{
    for (uint32_t i = 0; i < p->n_colors; i++) {
        const struct hl_bk_target *t = &p->color[i];
        hlvk_tex_use(v, cmd, v->texs[t->slot], HLVK_USE_COLOR,
                     t->load != HL_LOAD_KEEP);
        if (t->resolve != HL_NO_SLOT)
            hlvk_tex_use(v, cmd, v->texs[t->resolve], HLVK_USE_COLOR, true);
    }
    if (p->depth.slot != HL_NO_SLOT)
        hlvk_tex_use(v, cmd, v->texs[p->depth.slot], depth_use(p),
                     p->depth.load != HL_LOAD_KEEP);
}

static void use_textures(struct hlvk *v, VkCommandBuffer cmd,
                         const struct hl_bk_draw *d)
{
    uint32_t reads = v->progs[d->prog]->reads[HLVK_SET_TEXTURES];
    for (uint32_t i = 0; i < d->n_textures; i++) {
        if (!(reads >> i & 1) || d->texture[i].slot == HL_NO_SLOT)
            continue;
        struct hlvk_tex *t = v->texs[d->texture[i].slot];
        if (t->pass == v->pass)
            continue;
        t->pass = v->pass;
        hlvk_tex_use(v, cmd, t, hlvk_sampled(t), false);
    }
}

static void barriers(struct hlvk *v, VkCommandBuffer cmd,
                     const struct hl_bk_pass *p,
                     const struct hl_bk_draw *draws, uint32_t n)
{
    v->pass++;
    use_targets(v, cmd, p);
    for (uint32_t i = 0; i < n; i++)
        use_textures(v, cmd, &draws[i]);
    hlvk_tex_use(v, cmd, v->white, HLVK_USE_SAMPLED, false);
    hlvk_barrier(v, cmd);
}

/* ---- rendering --------------------------------------------------------- */

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

static VkClearColorValue clear_color(bool integer, const float clear[4])
{
    VkClearColorValue c;
    memcpy(c.float32, clear, sizeof c.float32);
    /* 4294967040 is the largest float below 2^32. */
    for (int i = 0; integer && i < 4; i++)
        c.uint32[i] = !(clear[i] > 0.0f) ? 0
                    : clear[i] > 4294967040.0f ? UINT32_MAX
                                               : (uint32_t)clear[i];
    return c;
}

static VkRenderingAttachmentInfo color_attachment(
    const struct hlvk *v, const struct hl_bk_target *t)
{
    const struct hlvk_tex *x = v->texs[t->slot];
    bool integer = hl_format_info(x->format)->kind == HL_KIND_UINT;
    VkRenderingAttachmentInfo a = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = x->target,
        .imageLayout = hlvk_layout(HLVK_USE_COLOR),
        .loadOp = load_op(t->load), .storeOp = store_op(t->discard),
        .clearValue = { .color = clear_color(integer, t->clear) }
    };
    if (t->resolve != HL_NO_SLOT) {
        /* Integers cannot be averaged: theirs is the first sample. */
        a.resolveMode = integer ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT
                                : VK_RESOLVE_MODE_AVERAGE_BIT;
        a.resolveImageView = v->texs[t->resolve]->target;
        a.resolveImageLayout = hlvk_layout(HLVK_USE_COLOR);
    }
    return a;
}

static VkRenderingAttachmentInfo depth_attachment(const struct hlvk *v,
                                                  const struct hl_bk_pass *p)
{
    return (VkRenderingAttachmentInfo){
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = v->texs[p->depth.slot]->target,
        .imageLayout = hlvk_layout(depth_use(p)),
        .loadOp = load_op(p->depth.load),
        /* Any other store counts as a write, which would race with shaders
         * that sample this very image. */
        .storeOp = p->depth_read_only ? VK_ATTACHMENT_STORE_OP_NONE
                                      : store_op(p->depth.discard),
        .clearValue = { .depthStencil = {
            p->depth.clear[0], (uint32_t)p->depth.clear[1] } }
    };
}

static void begin_rendering(const struct hlvk *v, VkCommandBuffer cmd,
                            const struct hl_bk_pass *p)
{
    VkRenderingAttachmentInfo colors[HL_MAX_COLORS], depth;
    VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea = { { 0, 0 }, { p->width, p->height } },
        .layerCount = 1,
        .colorAttachmentCount = p->n_colors, .pColorAttachments = colors
    };
    VkViewport viewport = {
        0.0f, 0.0f, (float)p->width, (float)p->height, 0.0f, 1.0f
    };
    for (uint32_t i = 0; i < p->n_colors; i++)
        colors[i] = color_attachment(v, &p->color[i]);
    if (p->depth.slot != HL_NO_SLOT) {
        depth = depth_attachment(v, p);
        info.pDepthAttachment = &depth;
        if (hlvk_has_stencil(v->texs[p->depth.slot]->format))
            info.pStencilAttachment = &depth;
    }
    vkCmdBeginRendering(cmd, &info);
    vkCmdSetViewport(cmd, 0, 1, &viewport);
}

/* ---- draws ------------------------------------------------------------- */

/* What is bound in a pass; nothing is bound twice. */
struct bound {
    VkPipeline pipeline;
    VkDescriptorSet sets[HLVK_SETS];
    uint32_t offsets[HLVK_SETS][HL_MAX_UNIFORMS];
    VkBuffer streams[HL_MAX_STREAMS + 1];
    VkBuffer index;
    bool index16;
    struct hl_rect scissor;
};

static void bind_set(const struct hlvk *v, VkCommandBuffer cmd,
                     struct bound *b, const struct hl_bk_draw *d,
                     uint32_t kind, VkDescriptorSet set)
{
    uint32_t offsets[HL_MAX_UNIFORMS];
    uint32_t n = hlvk_set_kinds[kind].n_dynamic;
    uint32_t reads = v->progs[d->prog]->reads[kind];
    const struct hl_bk_range *r = hlvk_ranges(d, kind);
    for (uint32_t i = 0; i < n; i++)
        offsets[i] = reads >> i & 1 && r[i].slot != HL_NO_SLOT ? r[i].offset
                                                               : 0;
    if (set == b->sets[kind] &&
        !memcmp(offsets, b->offsets[kind], n * sizeof *offsets))
        return;
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, v->layout,
                            kind, 1, &set, n, offsets);
    b->sets[kind] = set;
    memcpy(b->offsets[kind], offsets, n * sizeof *offsets);
}

static void bind_streams(const struct hlvk *v, VkCommandBuffer cmd,
                         struct bound *b, const struct hl_bk_draw *d,
                         uint32_t streams)
{
    static const VkDeviceSize zero = 0;
    for (uint32_t i = 0; streams >> i; i++) {
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
    VkRect2D rect = {
        { r->x, r->y }, { (uint32_t)r->width, (uint32_t)r->height }
    };
    if (!memcmp(r, &b->scissor, sizeof *r))
        return;
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
    for (uint32_t kind = 0; kind < HLVK_SETS; kind++)
        if (p->reads[kind])
            bind_set(v, cmd, b, d, kind, sets[kind]);
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
    bool storage;
    enum hl_result r = hlvk_begin(v, &f);
    if (!r)
        r = find_sets(v, draws, n, &storage);
    if (!r)
        r = hlvk_pass_reserve(v, f, storage);
    if (r)
        return r;
    memset(&bound, 0, sizeof bound);
    barriers(v, f->cmd, pass, draws, n);
    hlvk_pass_begin(v, f, pass->label);
    begin_rendering(v, f->cmd, pass);
    for (uint32_t i = 0; i < n; i++)
        record_draw(v, f->cmd, &bound, &draws[i], v->scratch[i]);
    vkCmdEndRendering(f->cmd);
    hlvk_pass_end(v, f);
    return HL_OK;
}
