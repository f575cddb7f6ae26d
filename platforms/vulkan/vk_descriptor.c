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

#define BOTH (VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT)

/* Sets 0 to 2 are those of shaders/shared/block.h; the last one takes the
 * uniforms that only the vertex stage of a program reads. lavapipe copies its
 * whole fragment state, 35 KB, at the first draw after any uniform that
 * fragment stages could see is bound, and at every draw while a storage
 * buffer is: 2,000 draws cost 1 us each with this split and 3 to 15 without.
 * Four sets and eight dynamic uniforms are what Vulkan guarantees. */
const struct hlvk_set_kind hlvk_set_kinds[HLVK_SETS] = {
    { VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, HL_MAX_UNIFORMS,
      HL_MAX_UNIFORMS, BOTH },
    { VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, HL_MAX_TEXTURES, 0, BOTH },
    { VK_DESCRIPTOR_TYPE_STORAGE_BUFFER_DYNAMIC, HL_MAX_STORAGE,
      HL_MAX_STORAGE, BOTH },
    { VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, HL_MAX_UNIFORMS,
      HL_MAX_UNIFORMS, VK_SHADER_STAGE_VERTEX_BIT }
};

/* ---- samplers ---------------------------------------------------------- */

static VkSampler *sampler(struct hlvk *v, unsigned filter, unsigned wrap_u,
                          unsigned wrap_v)
{
    return &v->samplers[(filter * 3 + wrap_u) * 3 + wrap_v];
}

static enum hl_result sampler_make(struct hlvk *v, unsigned filter,
                                   unsigned wrap_u, unsigned wrap_v)
{
    static const VkSamplerAddressMode wraps[] = {
        [HL_WRAP_CLAMP] = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
        [HL_WRAP_REPEAT] = VK_SAMPLER_ADDRESS_MODE_REPEAT,
        [HL_WRAP_MIRROR] = VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT
    };
    VkFilter f = filter == HL_FILTER_NEAREST ? VK_FILTER_NEAREST
                                             : VK_FILTER_LINEAR;
    VkSamplerCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = f, .minFilter = f,
        .addressModeU = wraps[wrap_u], .addressModeV = wraps[wrap_v],
        .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE
    };
    /* The others look at level 0 alone. */
    if (filter == HL_FILTER_TRILINEAR) {
        info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
        info.maxLod = VK_LOD_CLAMP_NONE;
    }
    return hlvk_check(v, vkCreateSampler(v->vk, &info, NULL,
                                         sampler(v, filter, wrap_u, wrap_v)),
                      "vkCreateSampler");
}

/* ---- sets -------------------------------------------------------------- */

static enum hl_result pool_make(struct hlvk *v, struct hlvk_cache *c)
{
    VkDescriptorPoolSize sizes[HLVK_SETS];
    for (uint32_t i = 0; i < HLVK_SETS; i++)
        sizes[i] = (VkDescriptorPoolSize){
            hlvk_set_kinds[i].type, hlvk_set_kinds[i].n * POOL_SETS
        };
    VkDescriptorPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = POOL_SETS,
        .poolSizeCount = HLVK_SETS, .pPoolSizes = sizes
    };
    if (!hl_bk_grow(v->device, &c->pools, &c->max_pools, c->n_pools + 1,
                   sizeof *c->pools))
        return HL_ERR_MEMORY;
    enum hl_result r = hlvk_check(
        v, vkCreateDescriptorPool(v->vk, &info, NULL, &c->pools[c->n_pools]),
        "vkCreateDescriptorPool");
    c->n_pools += !r;
    return r;
}

static enum hl_result set_make(struct hlvk *v, struct hlvk_cache *c,
                               uint32_t kind, VkDescriptorSet *out)
{
    uint32_t pool = c->n_sets / POOL_SETS;
    enum hl_result r = pool == c->n_pools ? pool_make(v, c) : HL_OK;
    if (r)
        return r;
    VkDescriptorSetAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = c->pools[pool],
        .descriptorSetCount = 1, .pSetLayouts = &v->set_layouts[kind]
    };
    return hlvk_check(v, vkAllocateDescriptorSets(v->vk, &info, out),
                      "vkAllocateDescriptorSets");
}

/* A key of 0 binds the dummy, whatever the draw has there. */
static VkDescriptorBufferInfo buffer_info(const struct hlvk *v, uint64_t key,
                                          const struct hl_bk_range *r)
{
    if (!key)
        return (VkDescriptorBufferInfo){ v->dummy->buffer, 0, VK_WHOLE_SIZE };
    return (VkDescriptorBufferInfo){ v->bufs[r->slot]->buffer, 0, r->bytes };
}

static VkDescriptorImageInfo image_info(struct hlvk *v, uint64_t key,
                                        const struct hl_bk_texture *t)
{
    if (!key)
        return (VkDescriptorImageInfo){
            *sampler(v, HL_FILTER_NEAREST, HL_WRAP_CLAMP, HL_WRAP_CLAMP),
            v->white->view, hlvk_layout(hlvk_sampled(v->white))
        };
    const struct hlvk_tex *x = v->texs[t->slot];
    return (VkDescriptorImageInfo){
        *sampler(v, t->filter, t->wrap_u, t->wrap_v), x->view,
        hlvk_layout(hlvk_sampled(x))
    };
}

static void set_write(struct hlvk *v, uint32_t kind, const uint64_t *key,
                      const struct hl_bk_draw *draw, VkDescriptorSet set)
{
    VkWriteDescriptorSet writes[HL_MAX_TEXTURES];
    VkDescriptorBufferInfo buffers[HL_MAX_TEXTURES];
    VkDescriptorImageInfo images[HL_MAX_TEXTURES];
    uint32_t n = hlvk_set_kinds[kind].n;
    for (uint32_t i = 0; i < n; i++) {
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set, .dstBinding = i, .descriptorCount = 1,
            .descriptorType = hlvk_set_kinds[kind].type,
            .pImageInfo = &images[i], .pBufferInfo = &buffers[i]
        };
        if (kind == HLVK_SET_TEXTURES)
            images[i] = image_info(v, key[i], &draw->texture[i]);
        else
            buffers[i] = buffer_info(v, key[i],
                                     &hlvk_ranges(draw, kind)[i]);
    }
    vkUpdateDescriptorSets(v->vk, n, writes, 0, NULL);
}

/* ---- cache ------------------------------------------------------------- */

static uint32_t hash_key(uint32_t kind, const uint64_t *key)
{
    uint64_t h = kind + 1;
    for (uint32_t i = 0; i < hlvk_set_kinds[kind].n; i++) {
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
    if (!hl_bk_grow(v->device, &c->sets, &c->max_sets, c->n_sets + 1,
                   sizeof *c->sets))
        return false;
    if ((c->n_sets + 1) * 2 <= c->table_size)
        return true;
    uint32_t size = c->table_size ? c->table_size * 2 : 64;
    uint32_t *table = hl_bk_alloc(v->device, size * sizeof *table);
    if (!table)
        return false;
    hl_bk_free(v->device, c->table);
    c->table = table;
    c->table_size = size;
    for (uint32_t i = 0; i < c->n_sets; i++)
        table_put(c, i);
    return true;
}

static bool cache_find(const struct hlvk_cache *c, uint32_t kind,
                       uint32_t hash, const uint64_t *key,
                       VkDescriptorSet *out)
{
    uint32_t mask = c->table_size - 1;
    if (!c->table_size)
        return false;
    for (uint32_t at = hash & mask; c->table[at]; at = (at + 1) & mask) {
        const struct hlvk_set *s = &c->sets[c->table[at] - 1];
        if (s->hash == hash && s->kind == kind &&
            !memcmp(s->key, key, hlvk_set_kinds[kind].n * sizeof *key)) {
            *out = s->set;
            return true;
        }
    }
    return false;
}

enum hl_result hlvk_set_find(struct hlvk *v, uint32_t kind,
                             const uint64_t *key,
                             const struct hl_bk_draw *draw,
                             VkDescriptorSet *out)
{
    struct hlvk_cache *c = &v->caches[v->cache];
    uint32_t hash = hash_key(kind, key);
    if (cache_find(c, kind, hash, key, out))
        return HL_OK;
    if (!cache_reserve(v, c))
        return HL_ERR_MEMORY;
    struct hlvk_set *s = &c->sets[c->n_sets];
    enum hl_result r = set_make(v, c, kind, &s->set);
    if (r)
        return r;
    set_write(v, kind, key, draw, s->set);
    memcpy(s->key, key, hlvk_set_kinds[kind].n * sizeof *key);
    s->kind = kind;
    s->hash = hash;
    table_put(c, c->n_sets++);
    *out = s->set;
    return HL_OK;
}

/* Called as a frame begins. The other cache was set aside as an earlier one
 * began, so that it was last used two frames ago or more, and a frame begins
 * only when the one two before it is done. */
void hlvk_sets_frame(struct hlvk *v)
{
    if (v->caches[v->cache].n_sets < CACHE_SETS)
        return;
    v->cache ^= 1;
    struct hlvk_cache *c = &v->caches[v->cache];
    for (uint32_t i = 0; i < c->n_pools; i++)
        vkResetDescriptorPool(v->vk, c->pools[i], 0);
    if (c->table)
        memset(c->table, 0, c->table_size * sizeof *c->table);
    c->n_sets = 0;
}

/* ---- open and close ---------------------------------------------------- */

static enum hl_result layout_make(struct hlvk *v, uint32_t kind)
{
    VkDescriptorSetLayoutBinding b[HL_MAX_TEXTURES] = { { 0 } };
    VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = hlvk_set_kinds[kind].n, .pBindings = b
    };
    for (uint32_t i = 0; i < hlvk_set_kinds[kind].n; i++)
        b[i] = (VkDescriptorSetLayoutBinding){
            i, hlvk_set_kinds[kind].type, 1, hlvk_set_kinds[kind].stages, NULL
        };
    return hlvk_check(v, vkCreateDescriptorSetLayout(v->vk, &info, NULL,
                                                     &v->set_layouts[kind]),
                      "vkCreateDescriptorSetLayout");
}

static enum hl_result dummy_make(struct hlvk *v)
{
    /* An absent vertex attribute, then zeros for whatever reads on. */
    static const float data[64] = { 0.0f, 0.0f, 0.0f, 1.0f };
    v->dummy = hl_bk_alloc(v->device, sizeof *v->dummy);
    if (!v->dummy)
        return HL_ERR_MEMORY;
    enum hl_result r = hlvk_buf_make(v, sizeof data,
                                     VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                         VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                     HLVK_UPLOAD, &v->dummy->buffer,
                                     &v->dummy->memory);
    if (!r)
        memcpy(v->dummy->memory.map, data, sizeof data);
    return r;
}

static enum hl_result white_make(struct hlvk *v)
{
    static const unsigned char texel[4] = { 255, 255, 255, 255 };
    struct hl_tex_desc desc = {
        .format = HL_FORMAT_RGBA8_UNORM, .width = 1, .height = 1,
        .samples = 1, .mips = 1, .usage = HL_TEX_SAMPLED,
        .sample_as = HL_FORMAT_RGBA8_UNORM
    };
    enum hl_result r = hlvk_tex_make(v, &desc, &v->white);
    return r ? r : hlvk_tex_upload(v, v->white, 0, texel, sizeof texel);
}

enum hl_result hlvk_sets_open(struct hlvk *v)
{
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = HLVK_SETS, .pSetLayouts = v->set_layouts
    };
    enum hl_result r = HL_OK;
    for (uint32_t i = 0; i < HLVK_SETS && !r; i++)
        r = layout_make(v, i);
    if (!r)
        r = hlvk_check(v, vkCreatePipelineLayout(v->vk, &info, NULL,
                                                 &v->layout),
                       "vkCreatePipelineLayout");
    for (unsigned i = 0; i < HLVK_SAMPLERS && !r; i++)
        r = sampler_make(v, i / 9, i / 3 % 3, i % 3);
    if (!r)
        r = dummy_make(v);
    return r ? r : white_make(v);
}

void hlvk_sets_close(struct hlvk *v)
{
    for (uint32_t k = 0; k < 2; k++) {
        struct hlvk_cache *c = &v->caches[k];
        for (uint32_t i = 0; i < c->n_pools; i++)
            vkDestroyDescriptorPool(v->vk, c->pools[i], NULL);
        hl_bk_free(v->device, c->pools);
        hl_bk_free(v->device, c->sets);
        hl_bk_free(v->device, c->table);
    }
    for (uint32_t i = 0; i < HLVK_SAMPLERS; i++)
        vkDestroySampler(v->vk, v->samplers[i], NULL);
    vkDestroyPipelineLayout(v->vk, v->layout, NULL);
    for (uint32_t i = 0; i < HLVK_SETS; i++)
        vkDestroyDescriptorSetLayout(v->vk, v->set_layouts[i], NULL);
    if (v->dummy)
        hlvk_buf_release(v, v->dummy);
    if (v->white)
        hlvk_tex_release(v, v->white);
    hl_bk_free(v->device, v->scratch);
}
