/* SPDX-License-Identifier: Zlib */
#ifndef HL_VK_H
#define HL_VK_H
/* Inside of the Vulkan backend. Reading order of the files:
 *   vk_device.c    instance, choice of a device, open and close
 *   vk_caps.c      formats and caps
 *   vk_memory.c    blocks of device memory, buffers
 *   vk_frame.c     command buffers in flight, submit, staging, timings
 *   vk_image.c     textures, their layouts, barriers
 *   vk_descriptor.c  samplers and cached descriptor sets
 *   vk_program.c   pipelines
 *   vk_pass.c      a pass and its draws */
#include "platforms/vulkan/hl_vulkan.h"

enum {
    HLVK_FRAMES = 2,         /* one recorded while one executes              */
    HLVK_SAMPLERS = 27,      /* filter x wrap_u x wrap_v                     */
    HLVK_DUMMY_STREAM = HL_MAX_STREAMS, /* binding of absent attributes      */
    HLVK_BARRIERS = 64       /* image barriers gathered before they go out   */
};

/* ---- memory ---------------------------------------------------------- */

enum hlvk_where {
    HLVK_LOCAL,              /* the device's own, perhaps not mapped         */
    HLVK_UPLOAD,             /* mapped, coherent; read by shaders in place   */
    HLVK_STAGE,              /* mapped, coherent; copied from, once          */
    HLVK_READBACK            /* mapped, coherent, cached if there is such    */
};

/* A block's address range is a list of segments without gaps. Free ones are
 * merged with their neighbours, so that freeing never needs memory. */
struct hlvk_segment {
    struct hlvk_segment *prev, *next;
    struct hlvk_block *block;
    VkDeviceSize offset, bytes;
    bool used;
};
struct hlvk_block {
    struct hlvk_block *next;
    VkDeviceMemory memory;
    unsigned char *map;      /* NULL: not visible to the host                */
    VkDeviceSize bytes;
    uint32_t type;
    bool image;              /* holds images; others hold buffers            */
    struct hlvk_segment *first;
};
struct hlvk_memory {
    struct hlvk_segment *segment;
    VkDeviceMemory memory;
    VkDeviceSize offset;
    unsigned char *map;      /* of this range, or NULL                       */
};

/* ---- objects --------------------------------------------------------- */

/* Head of every object: destroyed ones wait in a list for the last frame
 * that may use them. */
struct hlvk_object {
    struct hlvk_object *next;
    uint64_t frame;          /* serial that must complete first              */
    char kind;               /* as in hl_backend.destroy                     */
};

struct hlvk_buf {
    struct hlvk_object head;
    VkBuffer buffer;
    struct hlvk_memory memory;
    VkDeviceSize bytes;
    uint32_t serial;         /* never used twice: key of cached sets         */
    bool fresh;              /* no pass can have read it yet                 */
};

/* What an image was last used for decides the barrier before its next use. */
enum hlvk_use {
    HLVK_USE_NONE, HLVK_USE_SAMPLED, HLVK_USE_COLOR, HLVK_USE_DEPTH,
    HLVK_USE_DEPTH_READ, HLVK_USE_COPY_TO, HLVK_USE_COPY_FROM
};

struct hlvk_tex {
    struct hlvk_object head;
    VkImage image;
    struct hlvk_memory memory;
    VkImageView view;        /* to sample: all levels, perhaps another format */
    VkImageView target;      /* level 0                                      */
    enum hl_format format;
    uint32_t width, height, mips;
    enum hlvk_use use;
    uint32_t serial;
    uint64_t pass;           /* last pass that gathered its barrier          */
};

/* Sets as the pipeline layout numbers them: vk_descriptor.c says why the
 * fourth exists. */
enum {
    HLVK_SET_UNIFORMS, HLVK_SET_TEXTURES, HLVK_SET_STORAGE,
    HLVK_SET_VERTEX_UNIFORMS, HLVK_SETS
};

struct hlvk_prog {
    struct hlvk_object head;
    VkPipeline pipeline;
    uint32_t streams;        /* mask of vertex buffer bindings it declares   */
    uint32_t reads[HLVK_SETS]; /* masks of the bindings that its stages read */
};

/* ---- frames ---------------------------------------------------------- */

struct hlvk_chunk {          /* a staging buffer, filled from the front      */
    struct hlvk_chunk *next;
    VkBuffer buffer;
    struct hlvk_memory memory;
    VkDeviceSize bytes, used;
};

struct hlvk_frame {
    VkCommandPool pool;
    VkCommandBuffer *cmds;   /* submitted together, in order                 */
    VkCommandBuffer cmd;     /* the last of them, which records              */
    uint32_t n_cmds;         /* in use                                       */
    uint32_t n_made, max_cmds;
    bool storage;            /* cmd has bound storage buffers                */
    VkFence fence;
    uint64_t serial;
    bool recording, submitted;
    struct hlvk_chunk *chunks;
    VkDeviceSize staged;     /* bytes in chunks                              */
    VkQueryPool *queries;
    uint32_t n_queries, max_queries;
    const char **labels;     /* of passes                                    */
    uint32_t n_passes, max_labels;
};

/* ---- descriptor sets ------------------------------------------------- */

struct hlvk_set_kind {
    VkDescriptorType type;
    uint32_t n, n_dynamic;   /* bindings, and those with an offset           */
    VkShaderStageFlags stages;
};
extern const struct hlvk_set_kind hlvk_set_kinds[HLVK_SETS];

struct hlvk_set {
    VkDescriptorSet set;
    uint64_t key[HL_MAX_TEXTURES];
    uint32_t kind, hash;
};
/* Sets by content. They stay valid from frame to frame; a cache that has
 * grown large is set aside and, a frame later at the earliest, begun anew. */
struct hlvk_cache {
    VkDescriptorPool *pools; /* filled in order, the same number of sets each */
    uint32_t n_pools, max_pools;
    struct hlvk_set *sets;
    uint32_t n_sets, max_sets;
    uint32_t *table;         /* index + 1 into sets, open addressing; 0 none */
    uint32_t table_size;     /* power of two, at least twice n_sets          */
};

/* ---- device ---------------------------------------------------------- */

struct hlvk {
    struct hl_device *device;
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice vk;
    VkQueue queue;
    uint32_t family;
    bool borrowed;           /* instance and device are the embedder's       */
    bool lost;
    VkDebugUtilsMessengerEXT messenger;
    PFN_vkSetDebugUtilsObjectNameEXT name_object;   /* NULL: no names        */

    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_allocation, max_buffer;
    VkDeviceSize copy_align;
    enum hl_device_kind kind;
    double tick_ms;          /* of a timestamp; 0: no timestamps             */
    uint64_t tick_mask;
    struct hlvk_block *blocks;

    struct hlvk_buf **bufs;
    struct hlvk_tex **texs;
    struct hlvk_prog **progs;
    uint32_t max_bufs, max_texs, max_progs;
    struct hlvk_object *garbage;
    uint32_t serials;

    struct hlvk_frame frames[HLVK_FRAMES];
    uint32_t frame;          /* the one that records                         */
    uint64_t serial;         /* of that frame                                */
    uint64_t completed;      /* every serial up to it                        */
    uint64_t pass;           /* passes so far                                */
    struct hlvk_chunk *spare;
    uint32_t n_spare;
    struct hlvk_buf readback;
    struct hl_timing *timings;
    uint64_t *stamps;        /* as read back                                 */
    uint32_t n_timings, max_timings, max_stamps;

    VkImageMemoryBarrier2 barriers[HLVK_BARRIERS];
    uint32_t n_barriers;
    bool copied;             /* to buffers since the last barrier            */

    VkDescriptorSetLayout set_layouts[HLVK_SETS];
    VkPipelineLayout layout;
    VkSampler samplers[HLVK_SAMPLERS];
    struct hlvk_cache caches[2];
    uint32_t cache;
    struct hlvk_buf *dummy;  /* unused ranges, absent attributes             */
    struct hlvk_tex *white;
    VkDescriptorSet (*scratch)[HLVK_SETS]; /* of one pass's draws            */
    uint32_t max_scratch;
};

/* vk_device.c. Log and translate; a lost device is remembered. */
enum hl_result hlvk_check(struct hlvk *, VkResult, const char *what);
void hlvk_name(struct hlvk *, VkObjectType, uint64_t handle, const char *);

/* vk_caps.c */
VkFormat hlvk_format(enum hl_format);
bool hlvk_has_stencil(enum hl_format);
VkImageAspectFlags hlvk_aspects(enum hl_format);
VkImageUsageFlags hlvk_usage(const struct hl_tex_desc *);
/* Usable at all: version, features, a graphics queue. */
bool hlvk_usable(VkPhysicalDevice, uint32_t *family);
void hlvk_describe(VkPhysicalDevice, struct hl_device_info *);
void hlvk_caps(struct hlvk *, struct hl_caps *);

/* vk_memory.c */
enum hl_result hlvk_memory_alloc(struct hlvk *, const VkMemoryRequirements *,
                                 enum hlvk_where, bool image,
                                 struct hlvk_memory *out);
void hlvk_memory_free(struct hlvk *, struct hlvk_memory *);
void hlvk_memory_close(struct hlvk *);
enum hl_result hlvk_buf_make(struct hlvk *, VkDeviceSize bytes,
                             VkBufferUsageFlags, enum hlvk_where,
                             VkBuffer *, struct hlvk_memory *);
void hlvk_buf_unmake(struct hlvk *, VkBuffer, struct hlvk_memory *);
enum hl_result hlvk_buf_create(void *, uint32_t, const struct hl_buf_desc *);
enum hl_result hlvk_buf_write(void *, uint32_t, size_t, const void *, size_t);
void hlvk_buf_release(struct hlvk *, struct hlvk_buf *);

/* vk_frame.c */
enum hl_result hlvk_frames_open(struct hlvk *);
void hlvk_frames_close(struct hlvk *);
/* The frame that records, begun if it was not. */
enum hl_result hlvk_begin(struct hlvk *, struct hlvk_frame **out);
enum hl_result hlvk_flush(struct hlvk *, bool wait);
/* Wait for all submitted frames and release what they held. */
enum hl_result hlvk_wait(struct hlvk *);
enum hl_result hlvk_submit(void *, bool wait);
/* Copy data to where the frame that is returned can copy it from. */
enum hl_result hlvk_stage(struct hlvk *, const void *data, size_t bytes,
                          struct hlvk_frame **, VkBuffer *,
                          VkDeviceSize *offset);
void hlvk_destroy(void *, char kind, uint32_t slot);
/* Make ready for one more pass, which reads storage buffers or does not. */
enum hl_result hlvk_pass_reserve(struct hlvk *, struct hlvk_frame *,
                                 bool storage);
void hlvk_pass_begin(struct hlvk *, struct hlvk_frame *, const char *label);
void hlvk_pass_end(struct hlvk *, struct hlvk_frame *);
uint32_t hlvk_timings(void *, struct hl_timing *, uint32_t max);

/* vk_image.c */
enum hl_result hlvk_tex_make(struct hlvk *, const struct hl_tex_desc *,
                             struct hlvk_tex **out);
void hlvk_tex_release(struct hlvk *, struct hlvk_tex *);
enum hl_result hlvk_tex_create(void *, uint32_t, const struct hl_tex_desc *);
enum hl_result hlvk_tex_write(void *, uint32_t, uint32_t, const void *,
                              size_t);
enum hl_result hlvk_tex_upload(struct hlvk *, struct hlvk_tex *, uint32_t mip,
                               const void *, size_t);
enum hl_result hlvk_tex_read(void *, uint32_t, void *, size_t);
VkImageLayout hlvk_layout(enum hlvk_use);
/* The use in which shaders sample it. */
enum hlvk_use hlvk_sampled(const struct hlvk_tex *);
/* Gather the barrier that `use` needs; with discard, contents may go. */
void hlvk_tex_use(struct hlvk *, VkCommandBuffer, struct hlvk_tex *,
                  enum hlvk_use, bool discard);
/* Record what was gathered. */
void hlvk_barrier(struct hlvk *, VkCommandBuffer);

/* vk_descriptor.c */
enum hl_result hlvk_sets_open(struct hlvk *);
void hlvk_sets_close(struct hlvk *);
void hlvk_sets_frame(struct hlvk *);
/* The set of one kind with this content; keys as made in vk_pass.c. */
enum hl_result hlvk_set_find(struct hlvk *, uint32_t kind,
                             const uint64_t *key,
                             const struct hl_bk_draw *, VkDescriptorSet *out);

/* vk_program.c */
enum hl_result hlvk_prog_create(void *, uint32_t,
                                const struct hl_prog_desc *);
void hlvk_prog_release(struct hlvk *, struct hlvk_prog *);

/* vk_pass.c. Ranges of a draw for a set of uniforms or storage. */
const struct hl_bk_range *hlvk_ranges(const struct hl_bk_draw *,
                                      uint32_t kind);
enum hl_result hlvk_pass_run(void *, const struct hl_bk_pass *,
                             const struct hl_bk_draw *, uint32_t);
#endif
