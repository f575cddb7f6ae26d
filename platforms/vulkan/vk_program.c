/* SPDX-License-Identifier: Zlib */
/* Programs: one pipeline each, viewport and scissor dynamic; and what their
 * stages read, found in the SPIR-V. */
#include <string.h>
#include "platforms/vulkan/hl_spirv.h"
#include "platforms/vulkan/vk.h"

/* ---- what a stage reads ------------------------------------------------ */

enum { MAX_VARIABLES = 64 };

/* Opcodes and decorations: SPIR-V specification, section 3. */
enum { OP_FUNCTION = 54, OP_DECORATE = 71, BINDING = 33, DESCRIPTOR_SET = 34 };

struct variable {
    uint32_t id, binding;
    uint32_t set;            /* word index of the decoration; 0 none         */
    bool used;
};

struct stage {
    uint32_t *words;         /* a copy: bindings are moved in it             */
    uint32_t n_words;
    struct variable vars[MAX_VARIABLES];
    uint32_t n_vars;
};

/* Word index of the instruction after the one at `at`; 0 at the end. */
static uint32_t next(const struct stage *s, uint32_t at)
{
    uint32_t length = at ? s->words[at] >> 16 : 5;
    uint32_t to = at + length;
    return length && to < s->n_words &&
           s->words[to] >> 16 <= s->n_words - to ? to : 0;
}

static struct variable *variable(struct stage *s, uint32_t id)
{
    for (uint32_t i = 0; i < s->n_vars; i++)
        if (s->vars[i].id == id)
            return &s->vars[i];
    if (s->n_vars == MAX_VARIABLES)
        return NULL;
    struct variable *v = &s->vars[s->n_vars++];
    *v = (struct variable){ .id = id, .binding = UINT32_MAX };
    return v;
}

/* Decorations come before functions, where any word that equals a variable's
 * id counts as a use: some are literals, and to read too much is harmless.
 * False: more variables than any stage has. */
static bool scan(struct stage *s)
{
    bool body = false;
    for (uint32_t at = 0; (at = next(s, at)) != 0;) {
        const uint32_t *w = s->words + at;
        uint32_t op = *w & 0xffff, n = *w >> 16;
        body |= op == OP_FUNCTION;
        for (uint32_t i = 1; body && i < n; i++)
            for (uint32_t k = 0; k < s->n_vars; k++)
                s->vars[k].used |= s->vars[k].id == w[i];
        if (op != OP_DECORATE || n < 4 ||
            (w[2] != BINDING && w[2] != DESCRIPTOR_SET))
            continue;
        struct variable *v = variable(s, w[1]);
        if (!v)
            return false;
        if (w[2] == BINDING)
            v->binding = w[3];
        else
            v->set = at + 3;
    }
    return true;
}

/* Mask of the bindings of a set that the stage reads. */
static uint32_t bindings(const struct stage *s, uint32_t set)
{
    uint32_t mask = 0;
    for (uint32_t i = 0; i < s->n_vars; i++) {
        const struct variable *v = &s->vars[i];
        if (v->used && v->set && s->words[v->set] == set && v->binding < 32)
            mask |= 1u << v->binding;
    }
    return mask;
}

/* Uniforms that only the vertex stage reads move to their own set. */
static void move_uniforms(struct stage *s, uint32_t keep)
{
    for (uint32_t i = 0; i < s->n_vars; i++) {
        struct variable *v = &s->vars[i];
        if (v->set && s->words[v->set] == HLVK_SET_UNIFORMS &&
            v->binding < 32 && !(keep >> v->binding & 1))
            s->words[v->set] = HLVK_SET_VERTEX_UNIFORMS;
    }
}

/* ---- vertex input ------------------------------------------------------ */

struct vertex_input {
    VkVertexInputBindingDescription bindings[HL_MAX_STREAMS + 1];
    VkVertexInputAttributeDescription attrs[HL_MAX_ATTRS];
    VkPipelineVertexInputStateCreateInfo info;
};

static const VkFormat attr_formats[] = {
    [HL_ATTR_NONE] = VK_FORMAT_R32G32B32A32_SFLOAT,
    [HL_ATTR_F32X1] = VK_FORMAT_R32_SFLOAT,
    [HL_ATTR_F32X2] = VK_FORMAT_R32G32_SFLOAT,
    [HL_ATTR_F32X3] = VK_FORMAT_R32G32B32_SFLOAT,
    [HL_ATTR_F32X4] = VK_FORMAT_R32G32B32A32_SFLOAT,
    [HL_ATTR_U8X4_UNORM] = VK_FORMAT_R8G8B8A8_UNORM,
    [HL_ATTR_S8X4_SNORM] = VK_FORMAT_R8G8B8A8_SNORM,
    [HL_ATTR_S16X4_SNORM] = VK_FORMAT_R16G16B16A16_SNORM,
    [HL_ATTR_U16X2_UNORM] = VK_FORMAT_R16G16_UNORM,
    [HL_ATTR_F16X2] = VK_FORMAT_R16G16_SFLOAT,
    [HL_ATTR_F16X4] = VK_FORMAT_R16G16B16A16_SFLOAT
};

/* Returns the mask of streams. All attributes are declared, which costs no
 * time on lavapipe where a stage does not read them; absent ones come from a
 * buffer that does not advance. */
static uint32_t vertex_input(const struct hl_vertex_layout *layout,
                             struct vertex_input *out)
{
    uint32_t streams = 0, n_bindings = 0;
    for (uint32_t i = 0; i < HL_MAX_ATTRS; i++) {
        const struct hl_attr *a = &layout->attr[i];
        uint32_t stream = a->format ? a->stream : HLVK_DUMMY_STREAM;
        out->attrs[i] = (VkVertexInputAttributeDescription){
            i, stream, attr_formats[a->format], a->format ? a->offset : 0
        };
        streams |= 1u << stream;
    }
    for (uint32_t i = 0; streams >> i; i++) {
        if (!(streams >> i & 1))
            continue;
        out->bindings[n_bindings++] = (VkVertexInputBindingDescription){
            i, i == HLVK_DUMMY_STREAM ? 0 : layout->stride[i],
            VK_VERTEX_INPUT_RATE_VERTEX
        };
    }
    out->info = (VkPipelineVertexInputStateCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = n_bindings,
        .pVertexBindingDescriptions = out->bindings,
        .vertexAttributeDescriptionCount = HL_MAX_ATTRS,
        .pVertexAttributeDescriptions = out->attrs
    };
    return streams;
}

/* ---- blending, depth, raster ------------------------------------------- */

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
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE }, VK_BLEND_OP_MAX },
    [HL_BLEND_SHIFT] = {
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_CONSTANT_COLOR },
        { VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_CONSTANT_ALPHA },
        VK_BLEND_OP_ADD }
};

static VkPipelineColorBlendAttachmentState blend_state(
    const struct hl_prog_desc *desc)
{
    return (VkPipelineColorBlendAttachmentState){
        .blendEnable = desc->blend != HL_BLEND_OFF,
        .srcColorBlendFactor = blends[desc->blend].color[0],
        .dstColorBlendFactor = blends[desc->blend].color[1],
        .colorBlendOp = blends[desc->blend].op,
        .srcAlphaBlendFactor = blends[desc->blend].alpha[0],
        .dstAlphaBlendFactor = blends[desc->blend].alpha[1],
        .alphaBlendOp = blends[desc->blend].op,
        .colorWriteMask = desc->no_color_write ? 0 : 15
    };
}

static const VkCompareOp compares[] = {
    [HL_COMPARE_OFF] = VK_COMPARE_OP_ALWAYS,
    [HL_COMPARE_NEVER] = VK_COMPARE_OP_NEVER,
    [HL_COMPARE_LESS] = VK_COMPARE_OP_LESS,
    [HL_COMPARE_LESS_EQUAL] = VK_COMPARE_OP_LESS_OR_EQUAL,
    [HL_COMPARE_EQUAL] = VK_COMPARE_OP_EQUAL,
    [HL_COMPARE_GREATER_EQUAL] = VK_COMPARE_OP_GREATER_OR_EQUAL,
    [HL_COMPARE_GREATER] = VK_COMPARE_OP_GREATER,
    [HL_COMPARE_ALWAYS] = VK_COMPARE_OP_ALWAYS
};

static VkStencilOpState stencil_state(const struct hl_stencil *s,
                                      const struct hl_stencil_face *face)
{
    static const VkStencilOp ops[] = {
        [HL_STENCIL_KEEP] = VK_STENCIL_OP_KEEP,
        [HL_STENCIL_ZERO] = VK_STENCIL_OP_ZERO,
        [HL_STENCIL_REPLACE] = VK_STENCIL_OP_REPLACE,
        [HL_STENCIL_INCREMENT] = VK_STENCIL_OP_INCREMENT_AND_CLAMP,
        [HL_STENCIL_DECREMENT] = VK_STENCIL_OP_DECREMENT_AND_CLAMP,
        [HL_STENCIL_INCREMENT_WRAP] = VK_STENCIL_OP_INCREMENT_AND_WRAP,
        [HL_STENCIL_DECREMENT_WRAP] = VK_STENCIL_OP_DECREMENT_AND_WRAP,
        [HL_STENCIL_INVERT] = VK_STENCIL_OP_INVERT
    };
    return (VkStencilOpState){
        .failOp = ops[face->fail], .passOp = ops[face->pass],
        .depthFailOp = ops[face->depth_fail],
        .compareOp = compares[face->test],
        .compareMask = s->read_mask, .writeMask = s->write_mask,
        .reference = s->reference
    };
}

static VkPipelineDepthStencilStateCreateInfo depth_state(
    const struct hl_prog_desc *desc)
{
    return (VkPipelineDepthStencilStateCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = desc->depth_test != HL_COMPARE_OFF,
        .depthWriteEnable = desc->depth_write,
        .depthCompareOp = compares[desc->depth_test],
        .stencilTestEnable = desc->stencil.front.test != HL_COMPARE_OFF,
        .front = stencil_state(&desc->stencil, &desc->stencil.front),
        .back = stencil_state(&desc->stencil, &desc->stencil.back)
    };
}

static VkPipelineRasterizationStateCreateInfo raster_state(
    const struct hl_prog_desc *desc)
{
    return (VkPipelineRasterizationStateCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = desc->cull == HL_CULL_NONE ? VK_CULL_MODE_NONE
                  : desc->cull == HL_CULL_BACK ? VK_CULL_MODE_BACK_BIT
                                               : VK_CULL_MODE_FRONT_BIT,
        /* Vulkan judges winding as seen on the screen, row 0 on top: the
         * same as "y up" of hal.h, with no turn for clip space's y. */
        .frontFace = desc->mirrored ? VK_FRONT_FACE_CLOCKWISE
                                    : VK_FRONT_FACE_COUNTER_CLOCKWISE,
        .lineWidth = 1.0f
    };
}

/* ---- pipeline ---------------------------------------------------------- */

static VkResult output_pipeline(struct hlvk *v,
                                const struct hl_prog_desc *desc,
                                VkGraphicsPipelineCreateInfo *info,
                                VkPipeline *out)
{
    VkPipelineColorBlendAttachmentState blend[HL_MAX_COLORS];
    VkFormat colors[HL_MAX_COLORS];
    for (uint32_t i = 0; i < desc->n_colors; i++) {
        blend[i] = blend_state(desc);
        colors[i] = hlvk_format(desc->color[i]);
    }
    float k = desc->blend_constant;
    VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = desc->n_colors, .pAttachments = blend,
        .blendConstants = { k, k, k, k }
    };
    VkPipelineRenderingCreateInfo rendering = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = desc->n_colors,
        .pColorAttachmentFormats = colors,
        .depthAttachmentFormat = hlvk_format(desc->depth),
        .stencilAttachmentFormat = hlvk_has_stencil(desc->depth)
                                   ? hlvk_format(desc->depth)
                                   : VK_FORMAT_UNDEFINED
    };
    VkPipelineDepthStencilStateCreateInfo depth = depth_state(desc);
    VkPipelineRasterizationStateCreateInfo raster = raster_state(desc);
    VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = (VkSampleCountFlagBits)desc->samples
    };
    info->pNext = &rendering;
    info->pRasterizationState = &raster;
    info->pMultisampleState = &multisample;
    info->pDepthStencilState = &depth;
    info->pColorBlendState = &blending;
    return vkCreateGraphicsPipelines(v->vk, VK_NULL_HANDLE, 1, info, NULL,
                                     out);
}

static enum hl_result make_pipeline(
    struct hlvk *v, const struct hl_prog_desc *desc,
    const VkPipelineShaderStageCreateInfo *stages, uint32_t n_stages,
    const struct vertex_input *input, VkPipeline *out)
{
    static const VkDynamicState states[] = {
        VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR
    };
    static const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2, .pDynamicStates = states
    };
    static const VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1, .scissorCount = 1
    };
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = desc->topology == HL_TOPOLOGY_LINES
                    ? VK_PRIMITIVE_TOPOLOGY_LINE_LIST
                    : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST
    };
    VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = n_stages, .pStages = stages,
        .pVertexInputState = &input->info, .pInputAssemblyState = &assembly,
        .pViewportState = &viewport, .pDynamicState = &dynamic,
        .layout = v->layout
    };
    return hlvk_check(v, output_pipeline(v, desc, &info, out),
                      "vkCreateGraphicsPipelines");
}

/* ---- stages ------------------------------------------------------------ */

struct specs {
    VkSpecializationMapEntry entries[HL_MAX_SPECS];
    uint32_t values[HL_MAX_SPECS];
    VkSpecializationInfo info;
};

static void specialise(const struct hl_prog_desc *desc, struct specs *s)
{
    for (uint32_t i = 0; i < desc->n_specs; i++) {
        s->values[i] = desc->spec[i].value;
        s->entries[i] = (VkSpecializationMapEntry){
            desc->spec[i].id, i * 4, 4
        };
    }
    s->info = (VkSpecializationInfo){
        desc->n_specs, s->entries, desc->n_specs * 4, s->values
    };
}

static enum hl_result stage_read(struct hlvk *v, const struct hl_stage *from,
                                 struct stage *s)
{
    struct hl_spirv code = { NULL, 0 };
    if (from->builtin != HL_SHADER_NONE)
        code = hl_spirv[from->builtin];
    else if (from->code)
        code = (struct hl_spirv){ from->code->spirv,
                                  from->code->spirv_bytes };
    s->n_words = (uint32_t)(code.bytes / 4);
    if (code.words && code.bytes >= 20 && code.bytes % 4 == 0) {
        s->words = hl_bk_alloc(v->device, code.bytes);
        if (!s->words)
            return HL_ERR_MEMORY;
        memcpy(s->words, code.words, code.bytes);
        if (scan(s))
            return HL_OK;
    }
    hl_bk_log(v->device, HL_LOG_ERROR, HL_MSG_ARGUMENT,
              "hl_prog_desc: a stage comes without usable SPIR-V", NULL,
              NULL);
    return HL_ERR_UNSUPPORTED;
}

static enum hl_result stage_module(struct hlvk *v, const struct stage *s,
                                   const struct specs *specs,
                                   VkShaderStageFlagBits bit,
                                   VkPipelineShaderStageCreateInfo *out)
{
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = s->n_words * 4, .pCode = s->words
    };
    *out = (VkPipelineShaderStageCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
        .stage = bit, .pName = "main", .pSpecializationInfo = &specs->info
    };
    return hlvk_check(v, vkCreateShaderModule(v->vk, &info, NULL,
                                              &out->module),
                      "vkCreateShaderModule");
}

static void find_uses(struct hlvk_prog *p, struct stage *vertex,
                      const struct stage *fragment)
{
    uint32_t all = bindings(vertex, HLVK_SET_UNIFORMS);
    uint32_t shared = bindings(fragment, HLVK_SET_UNIFORMS);
    p->reads[HLVK_SET_UNIFORMS] = shared;
    p->reads[HLVK_SET_VERTEX_UNIFORMS] = all & ~shared;
    p->reads[HLVK_SET_TEXTURES] = bindings(vertex, HLVK_SET_TEXTURES) |
                                  bindings(fragment, HLVK_SET_TEXTURES);
    p->reads[HLVK_SET_STORAGE] = bindings(vertex, HLVK_SET_STORAGE) |
                                 bindings(fragment, HLVK_SET_STORAGE);
    move_uniforms(vertex, shared);
}

static enum hl_result build(struct hlvk *v, const struct hl_prog_desc *desc,
                            struct stage stage[2], struct hlvk_prog *p)
{
    VkPipelineShaderStageCreateInfo info[2];
    struct vertex_input input;
    struct specs specs;
    bool fragment = desc->fragment.builtin || desc->fragment.code;
    memset(info, 0, sizeof info);
    enum hl_result r = stage_read(v, &desc->vertex, &stage[0]);
    if (!r && fragment)
        r = stage_read(v, &desc->fragment, &stage[1]);
    if (r)
        return r;
    find_uses(p, &stage[0], &stage[1]);
    p->streams = vertex_input(&desc->layout, &input);
    specialise(desc, &specs);
    r = stage_module(v, &stage[0], &specs, VK_SHADER_STAGE_VERTEX_BIT,
                     &info[0]);
    if (!r && fragment)
        r = stage_module(v, &stage[1], &specs, VK_SHADER_STAGE_FRAGMENT_BIT,
                         &info[1]);
    if (!r)
        r = make_pipeline(v, desc, info, fragment ? 2 : 1, &input,
                          &p->pipeline);
    vkDestroyShaderModule(v->vk, info[0].module, NULL);
    vkDestroyShaderModule(v->vk, info[1].module, NULL);
    return r;
}

enum hl_result hlvk_prog_create(void *state, uint32_t slot,
                                const struct hl_prog_desc *desc)
{
    struct hlvk *v = state;
    struct hlvk_prog *p = hl_bk_alloc(v->device, sizeof *p);
    struct stage *stage = hl_bk_alloc(v->device, 2 * sizeof *stage);
    enum hl_result r = HL_ERR_MEMORY;
    if (p && stage) {
        r = build(v, desc, stage, p);
        hl_bk_free(v->device, stage[0].words);
        hl_bk_free(v->device, stage[1].words);
    }
    hl_bk_free(v->device, stage);
    if (r) {
        hl_bk_free(v->device, p);
        return r;
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
