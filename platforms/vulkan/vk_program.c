/* SPDX-License-Identifier: Zlib */
/* Programs: one pipeline each, viewport and scissor dynamic. */
#include <string.h>
#include "platforms/vulkan/hl_spirv.h"
#include "platforms/vulkan/vk.h"

/* ---- which attributes a vertex stage reads --------------------------- */

enum { ALL_ATTRS = (1 << HL_MAX_ATTRS) - 1, MAX_INPUTS = 64 };

/* Opcodes and operands of the SPIR-V specification, section 3. */
enum {
    OP_TYPE_FLOAT = 22, OP_TYPE_VECTOR = 23, OP_TYPE_POINTER = 32,
    OP_VARIABLE = 59, OP_DECORATE = 71, DECORATION_LOCATION = 30,
    STORAGE_INPUT = 1
};

struct location { uint32_t id, location; };

/* The next instruction after `at`, or NULL at the end; *length its words. */
static const uint32_t *instruction(const struct hl_spirv *s,
                                   const uint32_t *at, uint32_t *length)
{
    const uint32_t *end = s->words + s->bytes / 4;
    at = at ? at + *length : s->words + 5;
    if (at >= end)
        return NULL;
    *length = *at >> 16;
    return *length && *length <= (size_t)(end - at) ? at : NULL;
}

/* Variables of one location: pointers to a float or a vector of them. Others
 * (matrices, arrays) reach over several, which need not be told apart. */
static bool is_plain(const struct hl_spirv *s, uint32_t pointer)
{
    const uint32_t *at = NULL;
    uint32_t n = 0, type = 0;
    while ((at = instruction(s, at, &n)) != NULL)
        if ((*at & 0xffff) == OP_TYPE_POINTER && n > 3 && at[1] == pointer)
            type = at[3];
    for (at = NULL, n = 0; (at = instruction(s, at, &n)) != NULL;)
        if (n > 1 && at[1] == type && ((*at & 0xffff) == OP_TYPE_FLOAT ||
                                       (*at & 0xffff) == OP_TYPE_VECTOR))
            return true;
    return false;
}

/* Mask of the input locations that a stage declares. Fetching an attribute
 * that it does not read costs time on lavapipe. */
static uint32_t inputs(const struct hl_spirv *s)
{
    struct location found[MAX_INPUTS];
    const uint32_t *at = NULL;
    uint32_t i, n = 0, n_found = 0, mask = 0;
    while ((at = instruction(s, at, &n)) != NULL) {
        uint32_t op = *at & 0xffff;
        if (op == OP_DECORATE && n > 3 && at[2] == DECORATION_LOCATION) {
            if (n_found == MAX_INPUTS)
                return ALL_ATTRS;
            found[n_found].id = at[1];
            found[n_found++].location = at[3];
        }
        /* Decorations come before variables. */
        if (op != OP_VARIABLE || n < 4 || at[3] != STORAGE_INPUT)
            continue;
        for (i = 0; i < n_found; i++)
            if (found[i].id == at[2] && found[i].location < HL_MAX_ATTRS)
                mask |= (is_plain(s, at[1]) ? 1u : (uint32_t)ALL_ATTRS)
                        << found[i].location;
    }
    return mask & ALL_ATTRS;
}

/* ---- vertex input ---------------------------------------------------- */

struct vertex_input {
    VkVertexInputBindingDescription bindings[HL_MAX_STREAMS + 1];
    VkVertexInputAttributeDescription attrs[HL_MAX_ATTRS];
    VkPipelineVertexInputStateCreateInfo info;
};

static VkFormat attr_format(enum hl_attr_format format)
{
    switch (format) {
    case HL_ATTR_F32X1: return VK_FORMAT_R32_SFLOAT;
    case HL_ATTR_F32X2: return VK_FORMAT_R32G32_SFLOAT;
    case HL_ATTR_F32X3: return VK_FORMAT_R32G32B32_SFLOAT;
    case HL_ATTR_U8X4_UNORM: return VK_FORMAT_R8G8B8A8_UNORM;
    case HL_ATTR_S8X4_SNORM: return VK_FORMAT_R8G8B8A8_SNORM;
    case HL_ATTR_S16X4_SNORM: return VK_FORMAT_R16G16B16A16_SNORM;
    case HL_ATTR_U16X2_UNORM: return VK_FORMAT_R16G16_UNORM;
    case HL_ATTR_F16X2: return VK_FORMAT_R16G16_SFLOAT;
    case HL_ATTR_F16X4: return VK_FORMAT_R16G16B16A16_SFLOAT;
    default: return VK_FORMAT_R32G32B32A32_SFLOAT;
    }
}

/* Returns the mask of bindings. An absent attribute comes from a buffer that
 * does not advance. */
static uint32_t vertex_input(const struct hl_vertex_layout *layout,
                             uint32_t read, struct vertex_input *out)
{
    uint32_t i, streams = 0, n = 0, n_bindings = 0;
    for (i = 0; i < HL_MAX_ATTRS; i++) {
        const struct hl_attr *a = &layout->attr[i];
        VkVertexInputAttributeDescription *d = &out->attrs[n];
        if (!(read >> i & 1))
            continue;
        n++;
        d->location = i;
        d->binding = a->format ? a->stream : HLVK_DUMMY_STREAM;
        d->format = attr_format(a->format);
        d->offset = a->format ? a->offset : 0;
        streams |= 1u << d->binding;
    }
    for (i = 0; i <= HL_MAX_STREAMS; i++) {
        VkVertexInputBindingDescription *b = &out->bindings[n_bindings];
        if (!(streams >> i & 1))
            continue;
        n_bindings++;
        b->binding = i;
        b->stride = i < HL_MAX_STREAMS ? layout->stride[i] : 0;
        b->inputRate = VK_VERTEX_INPUT_RATE_VERTEX;
    }
    out->info.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    out->info.vertexBindingDescriptionCount = n_bindings;
    out->info.pVertexBindingDescriptions = out->bindings;
    out->info.vertexAttributeDescriptionCount = n;
    out->info.pVertexAttributeDescriptions = out->attrs;
    return streams;
}

/* ---- blending, depth, raster ------------------------------------------ */

struct output {
    VkPipelineColorBlendAttachmentState blends[HL_MAX_COLORS];
    VkPipelineColorBlendStateCreateInfo blend;
    VkPipelineDepthStencilStateCreateInfo depth;
    VkPipelineRasterizationStateCreateInfo raster;
    VkPipelineMultisampleStateCreateInfo multisample;
    VkFormat colors[HL_MAX_COLORS];
    VkPipelineRenderingCreateInfo rendering;
};

/* Factors: source and destination of colour, then of alpha. */
static const struct {
    VkBlendFactor color[2], alpha[2];
    VkBlendOp op;
} blends[] = {
    [HL_BLEND_OFF] = { { 0, 0 }, { 0, 0 }, VK_BLEND_OP_ADD },
    [HL_BLEND_ADD] = {
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE },
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE }, VK_BLEND_OP_ADD },
    [HL_BLEND_OVER] = {
        { VK_BLEND_FACTOR_SRC_ALPHA, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA },
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA },
        VK_BLEND_OP_ADD },
    [HL_BLEND_ADD_ALPHA] = {
        { VK_BLEND_FACTOR_SRC_ALPHA, VK_BLEND_FACTOR_ONE },
        { VK_BLEND_FACTOR_ZERO, VK_BLEND_FACTOR_ONE }, VK_BLEND_OP_ADD },
    [HL_BLEND_MAX] = {
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE },
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE }, VK_BLEND_OP_MAX }
};

static void blend_state(const struct hl_prog_desc *desc, struct output *o)
{
    uint32_t i;
    for (i = 0; i < desc->n_colors; i++) {
        VkPipelineColorBlendAttachmentState *b = &o->blends[i];
        b->blendEnable = desc->blend != HL_BLEND_OFF;
        b->srcColorBlendFactor = blends[desc->blend].color[0];
        b->dstColorBlendFactor = blends[desc->blend].color[1];
        b->colorBlendOp = blends[desc->blend].op;
        b->srcAlphaBlendFactor = blends[desc->blend].alpha[0];
        b->dstAlphaBlendFactor = blends[desc->blend].alpha[1];
        b->alphaBlendOp = blends[desc->blend].op;
        b->colorWriteMask = desc->no_color_write ? 0 : 15;
    }
    o->blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    o->blend.attachmentCount = desc->n_colors;
    o->blend.pAttachments = o->blends;
}

static void depth_state(const struct hl_prog_desc *desc, struct output *o)
{
    static const VkCompareOp ops[] = {
        [HL_COMPARE_OFF] = VK_COMPARE_OP_ALWAYS,
        [HL_COMPARE_NEVER] = VK_COMPARE_OP_NEVER,
        [HL_COMPARE_LESS] = VK_COMPARE_OP_LESS,
        [HL_COMPARE_LESS_EQUAL] = VK_COMPARE_OP_LESS_OR_EQUAL,
        [HL_COMPARE_EQUAL] = VK_COMPARE_OP_EQUAL,
        [HL_COMPARE_GREATER_EQUAL] = VK_COMPARE_OP_GREATER_OR_EQUAL,
        [HL_COMPARE_GREATER] = VK_COMPARE_OP_GREATER,
        [HL_COMPARE_ALWAYS] = VK_COMPARE_OP_ALWAYS
    };
    o->depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    o->depth.depthTestEnable = desc->depth_test != HL_COMPARE_OFF;
    o->depth.depthWriteEnable = desc->depth_write;
    o->depth.depthCompareOp = ops[desc->depth_test];
}

static void raster_state(const struct hl_prog_desc *desc, struct output *o)
{
    o->raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    o->raster.polygonMode = VK_POLYGON_MODE_FILL;
    o->raster.cullMode = desc->cull == HL_CULL_NONE ? VK_CULL_MODE_NONE
                       : desc->cull == HL_CULL_BACK ? VK_CULL_MODE_BACK_BIT
                                                    : VK_CULL_MODE_FRONT_BIT;
    /* Vulkan judges winding as it is seen on the screen, row 0 on top: the
     * same as "y up" of hal.h, with no turn for clip space's y. */
    o->raster.frontFace = desc->mirrored ? VK_FRONT_FACE_CLOCKWISE
                                         : VK_FRONT_FACE_COUNTER_CLOCKWISE;
    o->raster.lineWidth = 1.0f;
    o->multisample.sType =
        VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    o->multisample.rasterizationSamples =
        (VkSampleCountFlagBits)desc->samples;
}

static void output_state(const struct hl_prog_desc *desc, struct output *o)
{
    uint32_t i;
    blend_state(desc, o);
    depth_state(desc, o);
    raster_state(desc, o);
    for (i = 0; i < desc->n_colors; i++)
        o->colors[i] = hlvk_format(desc->color[i]);
    o->rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    o->rendering.colorAttachmentCount = desc->n_colors;
    o->rendering.pColorAttachmentFormats = o->colors;
    o->rendering.depthAttachmentFormat = hlvk_format(desc->depth);
}

/* ---- stages ---------------------------------------------------------- */

struct stages {
    VkShaderModule modules[2];
    VkPipelineShaderStageCreateInfo info[2];
    uint32_t n;
    VkSpecializationMapEntry entries[HL_MAX_SPECS];
    uint32_t values[HL_MAX_SPECS];
    VkSpecializationInfo spec;
};

/* Words NULL: the stage is empty, or has no SPIR-V. */
static struct hl_spirv stage_code(const struct hl_stage *stage)
{
    struct hl_spirv s = { NULL, 0 };
    if (stage->builtin != HL_SHADER_NONE)
        return hl_spirv[stage->builtin];
    if (stage->code) {
        s.words = stage->code->spirv;
        s.bytes = stage->code->spirv_bytes;
    }
    return s;
}

static void specialise(const struct hl_prog_desc *desc, struct stages *s)
{
    uint32_t i;
    for (i = 0; i < desc->n_specs; i++) {
        s->values[i] = desc->spec[i].value;
        s->entries[i].constantID = desc->spec[i].id;
        s->entries[i].offset = i * 4;
        s->entries[i].size = 4;
    }
    s->spec.mapEntryCount = desc->n_specs;
    s->spec.pMapEntries = s->entries;
    s->spec.dataSize = desc->n_specs * 4;
    s->spec.pData = s->values;
}

static enum hl_result stage_add(struct hlvk *v, struct stages *s,
                                VkShaderStageFlagBits bit,
                                const struct hl_spirv *code)
{
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO
    };
    VkPipelineShaderStageCreateInfo *stage = &s->info[s->n];
    enum hl_result result;
    if (!code->words || code->bytes < 20 || code->bytes % 4) {
        hl_bk_log(v->device, HL_LOG_ERROR, HL_MSG_ARGUMENT,
                  "hl_prog_desc: a stage comes without SPIR-V", NULL, NULL);
        return HL_ERR_UNSUPPORTED;
    }
    info.codeSize = code->bytes;
    info.pCode = code->words;
    result = hlvk_check(v, vkCreateShaderModule(v->vk, &info, NULL,
                                                &s->modules[s->n]),
                        "vkCreateShaderModule");
    stage->sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage->stage = bit;
    stage->module = s->modules[s->n];
    stage->pName = "main";
    stage->pSpecializationInfo = &s->spec;
    s->n++;
    return result;
}

/* ---- pipeline -------------------------------------------------------- */

static enum hl_result pipeline(struct hlvk *v,
                               const struct hl_prog_desc *desc,
                               const struct stages *s,
                               const struct vertex_input *input,
                               VkPipeline *out)
{
    static const VkDynamicState dynamic_states[] = {
        VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR
    };
    VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO
    };
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO
    };
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO
    };
    VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO
    };
    struct output o;
    memset(&o, 0, sizeof o);
    output_state(desc, &o);
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = dynamic_states;
    assembly.topology = desc->topology == HL_TOPOLOGY_LINES
                        ? VK_PRIMITIVE_TOPOLOGY_LINE_LIST
                        : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.viewportCount = viewport.scissorCount = 1;
    info.pNext = &o.rendering;
    info.stageCount = s->n;
    info.pStages = s->info;
    info.pVertexInputState = &input->info;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &o.raster;
    info.pMultisampleState = &o.multisample;
    info.pDepthStencilState = &o.depth;
    info.pColorBlendState = &o.blend;
    info.pDynamicState = &dynamic;
    info.layout = v->layout;
    return hlvk_check(v, vkCreateGraphicsPipelines(v->vk, VK_NULL_HANDLE, 1,
                                                   &info, NULL, out),
                      "vkCreateGraphicsPipelines");
}

enum hl_result hlvk_prog_create(void *state, uint32_t slot,
                                const struct hl_prog_desc *desc)
{
    struct hlvk *v = state;
    struct hl_spirv vertex = stage_code(&desc->vertex);
    struct hl_spirv fragment = stage_code(&desc->fragment);
    struct hlvk_prog *p = hl_bk_alloc(v->device, sizeof *p);
    struct vertex_input input;
    struct stages s;
    enum hl_result result;
    if (!p)
        return HL_ERR_MEMORY;
    memset(&s, 0, sizeof s);
    memset(&input, 0, sizeof input);
    specialise(desc, &s);
    result = stage_add(v, &s, VK_SHADER_STAGE_VERTEX_BIT, &vertex);
    if (!result && (desc->fragment.builtin || desc->fragment.code))
        result = stage_add(v, &s, VK_SHADER_STAGE_FRAGMENT_BIT, &fragment);
    if (!result) {
        p->streams = vertex_input(&desc->layout, inputs(&vertex), &input);
        result = pipeline(v, desc, &s, &input, &p->pipeline);
    }
    vkDestroyShaderModule(v->vk, s.modules[0], NULL);
    vkDestroyShaderModule(v->vk, s.modules[1], NULL);
    if (result) {
        hl_bk_free(v->device, p);
        return result;
    }
    hlvk_name(v, VK_OBJECT_TYPE_PIPELINE, (uint64_t)p->pipeline, desc->label);
    v->progs[slot] = p;
    return HL_OK;
}

void hlvk_prog_release(struct hlvk *v, struct hlvk_prog *p)
{
    vkDestroyPipeline(v->vk, p->pipeline, NULL);
    hl_bk_free(v->device, p);
}
