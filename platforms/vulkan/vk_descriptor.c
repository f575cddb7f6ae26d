/* SPDX-License-Identifier: Zlib */
/* Descriptor sets. Content decides: a set once written is found again by what
 * it binds, in every later frame, and never changed. Objects are named by
 * serials that are not used twice, so a set of a destroyed object is simply
 * never asked for. */
#include <string.h>
#include "platforms/vulkan/vk.h"

enum {
    POOL_SETS = 256,
    CACHE_SETS = 4096        /* a cache that has more is retired             */
};

static const struct {
    VkDescriptorType type;
    uint32_t n;
} kinds[HLVK_SETS] = {
    { VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, HL_MAX_UNIFORMS },
    { VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, HL_MAX_TEXTURES },
    { VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, HL_MAX_STORAGE }
};

/* ---- samplers -------------------------------------------------------- */

static uint32_t sampler_index(unsigned filter, unsigned u, unsigned w)
{
    return (uint32_t)((filter * 3 + u) * 3 + w);
}

static enum hl_result sampler_make(struct hlvk *v, unsigned filter,
                                   unsigned u, unsigned w)
{
    static const VkSamplerAddressMode wraps[] = {
        [HL_WRAP_CLAMP] = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
        [HL_WRAP_REPEAT] = VK_SAMPLER_ADDRESS_MODE_REPEAT,
        [HL_WRAP_MIRROR] = VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT
    };
    VkSamplerCreateInfo info = { .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO };
    info.magFilter = info.minFilter =
        filter == HL_FILTER_NEAREST ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    /* Only trilinear looks past level 0. */
    if (filter == HL_FILTER_TRILINEAR) {
        info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
        info.maxLod = VK_LOD_CLAMP_NONE;
    }
    info.addressModeU = wraps[u];
    info.addressModeV = wraps[w];
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    return hlvk_check(v, vkCreateSampler(
                             v->vk, &info, NULL,
                             &v->samplers[sampler_index(filter, u, w)]),
                      "vkCreateSampler");
}

static enum hl_result samplers_make(struct hlvk *v)
{
    unsigned i;
    enum hl_result result = HL_OK;
    for (i = 0; i < HLVK_SAMPLERS && !result; i++)
        result = sampler_make(v, i / 9, i / 3 % 3, i % 3);
    return result;
}

/* ---- sets ------------------------------------------------------------ */

static enum hl_result pool_make(struct hlvk *v, struct hlvk_cache *c)
{
    VkDescriptorPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO
    };
    VkDescriptorPoolSize sizes[HLVK_SETS];
    enum hl_result result;
    uint32_t i;
    if (!hlvk_grow(v, &c->pools, &c->max_pools, c->n_pools + 1,
                   sizeof *c->pools))
        return HL_ERR_MEMORY;
    for (i = 0; i < HLVK_SETS; i++) {
        sizes[i].type = kinds[i].type;
        sizes[i].descriptorCount = kinds[i].n * POOL_SETS;
    }
    info.maxSets = POOL_SETS;
    info.poolSizeCount = HLVK_SETS;
    info.pPoolSizes = sizes;
    result = hlvk_check(v, vkCreateDescriptorPool(v->vk, &info, NULL,
                                                  &c->pools[c->n_pools]),
                        "vkCreateDescriptorPool");
    if (!result)
        c->n_pools++;
    return result;
}

static enum hl_result set_make(struct hlvk *v, struct hlvk_cache *c,
                               uint32_t kind, VkDescriptorSet *out)
{
    VkDescriptorSetAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO
    };
    uint32_t pool = c->n_sets / POOL_SETS;
    enum hl_result result = HL_OK;
    if (pool == c->n_pools)
        result = pool_make(v, c);
    if (result)
        return result;
    info.descriptorPool = c->pools[pool];
    info.descriptorSetCount = 1;
    info.pSetLayouts = &v->set_layouts[kind];
    return hlvk_check(v, vkAllocateDescriptorSets(v->vk, &info, out),
                      "vkAllocateDescriptorSets");
}

static void buffer_info(const struct hlvk *v, const struct hl_bk_range *r,
                        VkDescriptorBufferInfo *out)
{
    const struct hlvk_buf *b = r->slot == HL_NO_SLOT ? v->dummy
                                                     : v->bufs[r->slot];
    out->buffer = b->buffer;
    out->offset = 0;
    out->range = r->slot == HL_NO_SLOT ? VK_WHOLE_SIZE : r->bytes;
}

static void image_info(const struct hlvk *v, const struct hl_bk_draw *draw,
                       uint32_t i, VkDescriptorImageInfo *out)
{
    struct hl_bk_texture none = { HL_NO_SLOT, 0, 0, 0 };
    const struct hl_bk_texture *t = i < draw->n_textures &&
                                    draw->texture[i].slot != HL_NO_SLOT
                                    ? &draw->texture[i] : &none;
    const struct hlvk_tex *x = t->slot == HL_NO_SLOT ? v->white
                                                     : v->texs[t->slot];
    out->sampler = v->samplers[sampler_index(t->filter, t->wrap_u,
                                             t->wrap_v)];
    out->imageView = x->view;
    out->imageLayout = hlvk_layout(hlvk_sampled(x));
}

static void set_write(struct hlvk *v, uint32_t kind,
                      const struct hl_bk_draw *draw, VkDescriptorSet set)
{
    VkWriteDescriptorSet writes[HL_MAX_TEXTURES];
    VkDescriptorBufferInfo buffers[HL_MAX_TEXTURES];
    VkDescriptorImageInfo images[HL_MAX_TEXTURES];
    uint32_t i;
    memset(writes, 0, sizeof writes);
    for (i = 0; i < kinds[kind].n; i++) {
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = set;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = kinds[kind].type;
        if (kind == 1) {
            image_info(v, draw, i, &images[i]);
            writes[i].pImageInfo = &images[i];
            continue;
        }
        buffer_info(v, kind == 0 ? &draw->uniform[i] : &draw->storage[i],
                    &buffers[i]);
        writes[i].pBufferInfo = &buffers[i];
    }
    vkUpdateDescriptorSets(v->vk, kinds[kind].n, writes, 0, NULL);
}

/* ---- cache ----------------------------------------------------------- */

static uint32_t hash_key(uint32_t kind, const uint64_t *key)
{
    uint64_t h = kind + 1;
    uint32_t i;
    for (i = 0; i < kinds[kind].n; i++) {
        h = (h ^ key[i]) * 0x9e3779b97f4a7c15u;
        h ^= h >> 32;
    }
    return (uint32_t)h;
}

static void table_put(struct hlvk_cache *c, uint32_t index)
{
    uint32_t mask = c->table_size - 1;
    uint32_t at = c->sets[index].hash & mask;
    while (c->table[at])
        at = (at + 1) & mask;
    c->table[at] = index + 1;
}

/* Room for one more set, the table at most half full. */
static bool cache_reserve(struct hlvk *v, struct hlvk_cache *c)
{
    uint32_t i, size = c->table_size ? c->table_size * 2 : 64;
    uint32_t *table;
    if (!hlvk_grow(v, &c->sets, &c->max_sets, c->n_sets + 1,
                   sizeof *c->sets))
        return false;
    if ((c->n_sets + 1) * 2 <= c->table_size)
        return true;
    table = hl_bk_alloc(v->device, size * sizeof *table);
    if (!table)
        return false;
    hl_bk_free(v->device, c->table);
    c->table = table;
    c->table_size = size;
    for (i = 0; i < c->n_sets; i++)
        table_put(c, i);
    return true;
}

static const struct hlvk_set *cache_find(const struct hlvk_cache *c,
                                         uint32_t kind, uint32_t hash,
                                         const uint64_t *key)
{
    uint32_t mask = c->table_size - 1, at;
    if (!c->table_size)
        return NULL;
    for (at = hash & mask; c->table[at]; at = (at + 1) & mask) {
        const struct hlvk_set *s = &c->sets[c->table[at] - 1];
        if (s->hash == hash && s->kind == kind &&
            !memcmp(s->key, key, kinds[kind].n * sizeof *key))
            return s;
    }
    return NULL;
}

enum hl_result hlvk_set_find(struct hlvk *v, uint32_t kind,
                             const uint64_t *key,
                             const struct hl_bk_draw *draw,
                             VkDescriptorSet *out)
{
    struct hlvk_cache *c = &v->caches[v->cache];
    uint32_t hash = hash_key(kind, key);
    const struct hlvk_set *found = cache_find(c, kind, hash, key);
    struct hlvk_set *s;
    enum hl_result result;
    if (found) {
        *out = found->set;
        return HL_OK;
    }
    if (!cache_reserve(v, c))
        return HL_ERR_MEMORY;
    s = &c->sets[c->n_sets];
    result = set_make(v, c, kind, &s->set);
    if (result)
        return result;
    set_write(v, kind, draw, s->set);
    memcpy(s->key, key, kinds[kind].n * sizeof *key);
    s->kind = kind;
    s->hash = hash;
    table_put(c, c->n_sets++);
    *out = s->set;
    return HL_OK;
}

void hlvk_sets_frame(struct hlvk *v)
{
    struct hlvk_cache *old = &v->caches[v->cache];
    struct hlvk_cache *next = &v->caches[v->cache ^ 1];
    uint32_t i;
    if (old->n_sets < CACHE_SETS || next->frame > v->completed)
        return;
    old->frame = v->serial;
    for (i = 0; i < next->n_pools; i++)
        vkResetDescriptorPool(v->vk, next->pools[i], 0);
    if (next->table)
        memset(next->table, 0, next->table_size * sizeof *next->table);
    next->n_sets = 0;
    v->cache ^= 1;
}

/* ---- open and close -------------------------------------------------- */

static enum hl_result layouts_make(struct hlvk *v)
{
    VkDescriptorSetLayoutBinding b[HL_MAX_TEXTURES] = { { 0 } };
    VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO
    };
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO
    };
    enum hl_result result = HL_OK;
    uint32_t kind, i;
    for (kind = 0; kind < HLVK_SETS && !result; kind++) {
        for (i = 0; i < kinds[kind].n; i++) {
            b[i].binding = i;
            b[i].descriptorType = kinds[kind].type;
            b[i].descriptorCount = 1;
            b[i].stageFlags = VK_SHADER_STAGE_VERTEX_BIT |
                              VK_SHADER_STAGE_FRAGMENT_BIT;
        }
        set.bindingCount = kinds[kind].n;
        set.pBindings = b;
        result = hlvk_check(v, vkCreateDescriptorSetLayout(
                                   v->vk, &set, NULL, &v->set_layouts[kind]),
                            "vkCreateDescriptorSetLayout");
    }
    if (result)
        return result;
    info.setLayoutCount = HLVK_SETS;
    info.pSetLayouts = v->set_layouts;
    return hlvk_check(v, vkCreatePipelineLayout(v->vk, &info, NULL,
                                                &v->layout),
                      "vkCreatePipelineLayout");
}

static enum hl_result dummies_make(struct hlvk *v)
{
    /* An absent vertex attribute, then zeros for whatever reads on. */
    static const float data[64] = { 0.0f, 0.0f, 0.0f, 1.0f };
    static const unsigned char white[4] = { 255, 255, 255, 255 };
    struct hl_tex_desc tex = { 0 };
    enum hl_result result;
    v->dummy = hl_bk_alloc(v->device, sizeof *v->dummy);
    if (!v->dummy)
        return HL_ERR_MEMORY;
    v->dummy->bytes = sizeof data;
    result = hlvk_buf_make(v, sizeof data,
                           VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                               VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                           HLVK_UPLOAD, &v->dummy->buffer,
                           &v->dummy->memory);
    if (result)
        return result;
    memcpy(v->dummy->memory.map, data, sizeof data);
    tex.format = HL_FORMAT_RGBA8_UNORM;
    tex.width = tex.height = tex.mips = tex.samples = 1;
    tex.usage = HL_TEX_SAMPLED;
    result = hlvk_tex_make(v, &tex, &v->white);
    if (!result)
        result = hlvk_tex_upload(v, v->white, 0, white, sizeof white);
    return result;
}

enum hl_result hlvk_sets_open(struct hlvk *v)
{
    enum hl_result result = layouts_make(v);
    if (!result)
        result = samplers_make(v);
    return result ? result : dummies_make(v);
}

void hlvk_sets_close(struct hlvk *v)
{
    uint32_t i, k;
    for (k = 0; k < 2; k++) {
        for (i = 0; i < v->caches[k].n_pools; i++)
            vkDestroyDescriptorPool(v->vk, v->caches[k].pools[i], NULL);
        hl_bk_free(v->device, v->caches[k].pools);
        hl_bk_free(v->device, v->caches[k].sets);
        hl_bk_free(v->device, v->caches[k].table);
    }
    for (i = 0; i < HLVK_SAMPLERS; i++)
        vkDestroySampler(v->vk, v->samplers[i], NULL);
    vkDestroyPipelineLayout(v->vk, v->layout, NULL);
    for (i = 0; i < HLVK_SETS; i++)
        vkDestroyDescriptorSetLayout(v->vk, v->set_layouts[i], NULL);
    if (v->dummy)
        hlvk_buf_release(v, v->dummy);
    if (v->white)
        hlvk_tex_release(v, v->white);
    hl_bk_free(v->device, v->scratch);
}
