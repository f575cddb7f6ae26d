/* SPDX-License-Identifier: Zlib */
/* The dispatcher: devices, handle pools, buffers, textures and programs.
 * Validation happens once, here and in hal/check_prog.c, console.c and
 * pass.c; backends trust what they are given. */
#include <string.h>
#include "hal/device.h"
#include "hal/text.h"

static const struct hl_device_desc no_desc;

const char *hl_result_name(enum hl_result result)
{
    switch (result) {
    case HL_OK: return "ok";
    case HL_ERR_INVALID: return "invalid argument";
    case HL_ERR_UNSUPPORTED: return "not supported";
    case HL_ERR_MEMORY: return "out of memory";
    case HL_ERR_LIMIT: return "limit exceeded";
    case HL_ERR_NO_DEVICE: return "no such backend or device";
    case HL_ERR_DEVICE_LOST: return "device lost";
    case HL_ERR_VERSION: return "version mismatch";
    }
    return "unknown result";
}

/* ---- log and refusals ------------------------------------------------- */

void hl_bk_log(struct hl_device *d, enum hl_log_level level,
               enum hl_log_id id, const char *a, const char *b, const char *c)
{
    char line[512];
    struct hl_text t = hl_text_begin(line, sizeof line);
    if (!d->log)
        return;
    if (a)
        hl_text_str(&t, a);
    if (a && b)
        hl_text_str(&t, b);
    if (a && b && c)
        hl_text_str(&t, c);
    d->log(d->log_user, level, id, line);
}

enum hl_result hl_refuse(struct hl_device *d, enum hl_result result,
                         enum hl_log_id id, const char *what, const char *why)
{
    hl_bk_log(d, HL_LOG_ERROR, id, what, ": ", why);
    return result;
}

enum hl_result hl_refuse_number(struct hl_device *d, enum hl_result result,
                                enum hl_log_id id, const char *what,
                                uint64_t number, const char *why)
{
    char line[256];
    struct hl_text t = hl_text_begin(line, sizeof line);
    hl_text_uint(&t, number);
    hl_text_str(&t, why);
    return hl_refuse(d, result, id, what, line);
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool hl_bk_name_has(const char *name, const char *part)
{
    for (; *name; name++) {
        size_t i = 0;
        while (part[i] && lower(name[i]) == lower(part[i]))
            i++;
        if (!part[i])
            return true;
    }
    return false;
}

void hl_bk_validation_error(struct hl_device *d, const char *text)
{
    d->validation_errors++;
    hl_bk_log(d, HL_LOG_ERROR, HL_MSG_VALIDATION, text, NULL, NULL);
}

void *hl_bk_alloc(struct hl_device *d, size_t bytes)
{
    void *p = d->hooks.alloc(d->hooks.user, bytes ? bytes : 1);
    if (p)
        memset(p, 0, bytes);
    return p;
}

void hl_bk_free(struct hl_device *d, void *p)
{
    if (p)
        d->hooks.free(d->hooks.user, p);
}

void *hl_bk_texture(struct hl_device *d, const struct hl_backend *backend,
                    hl_tex tex, uint32_t *slot)
{
    *slot = hl_pool_find(&d->pool[HL_POOL_TEX], tex.id);
    return d->backend->open == backend->open && *slot != HL_NO_SLOT ? d->state
                                                                  : NULL;
}

bool hl_bk_grow(struct hl_device *d, void *array, uint32_t *max, uint32_t need,
                size_t item)
{
    uint32_t more = *max ? *max : 16;
    void *old;
    if (need <= *max)
        return true;
    while (more < need)
        more *= 2;
    memcpy(&old, array, sizeof old);
    void *grown = hl_bk_alloc(d, more * item);
    if (!grown)
        return false;
    if (old)
        memcpy(grown, old, *max * item);
    hl_bk_free(d, old);
    memcpy(array, &grown, sizeof grown);
    *max = more;
    return true;
}

/* ---- pools -------------------------------------------------------------- */

static bool pool_open(struct hl_device *d, struct hl_pool *p, uint32_t max)
{
    p->max = max;
    p->generation = hl_bk_alloc(d, max * sizeof *p->generation);
    p->live = hl_bk_alloc(d, max);
    p->free_slot = hl_bk_alloc(d, max * sizeof *p->free_slot);
    if (!p->generation || !p->live || !p->free_slot)
        return false;
    for (uint32_t i = 0; i < max; i++) {
        p->generation[i] = 1;
        p->free_slot[i] = max - 1 - i;
    }
    p->n_free = max;
    return true;
}

static void pool_close(struct hl_device *d, struct hl_pool *p)
{
    hl_bk_free(d, p->generation);
    hl_bk_free(d, p->live);
    hl_bk_free(d, p->free_slot);
}

/* A slot that is not live yet: pool_commit makes it so, pool_undo not. */
static uint32_t pool_take(struct hl_pool *p)
{
    return p->n_free ? p->free_slot[--p->n_free] : HL_NO_SLOT;
}

static uint32_t pool_commit(struct hl_pool *p, uint32_t slot)
{
    p->live[slot] = 1;
    p->n_used++;
    return (uint32_t)p->generation[slot] << 16 | slot;
}

static void pool_undo(struct hl_pool *p, uint32_t slot)
{
    p->free_slot[p->n_free++] = slot;
}

static void pool_release(struct hl_pool *p, uint32_t slot)
{
    p->live[slot] = 0;
    p->n_used--;
    if (p->generation[slot] == 0xffff)
        return;
    p->generation[slot]++;
    p->free_slot[p->n_free++] = slot;
}

uint32_t hl_pool_find(const struct hl_pool *p, uint32_t handle)
{
    uint32_t slot = handle & 0xffff;
    if (handle == 0 || slot >= p->max || !p->live[slot] ||
        p->generation[slot] != handle >> 16)
        return HL_NO_SLOT;
    return slot;
}

/* ---- device ------------------------------------------------------------- */

enum hl_result hl_devices_list(const struct hl_backend *backend,
                               const struct hl_hooks *hooks,
                               struct hl_device_info *out, uint32_t max,
                               uint32_t *n)
{
    if (!n)
        return HL_ERR_INVALID;
    *n = 0;
    if (!backend)
        return HL_ERR_NO_DEVICE;
    if (backend->version != HL_VERSION)
        return HL_ERR_VERSION;
    if (!hooks || !hooks->alloc || !hooks->free || (max && !out))
        return HL_ERR_INVALID;
    return backend->list(hooks, out, max, n);
}

static void device_free(struct hl_device *d)
{
    for (int i = 0; i < HL_POOL_COUNT; i++)
        pool_close(d, &d->pool[i]);
    hl_bk_free(d, d->bufs);
    hl_bk_free(d, d->texs);
    hl_bk_free(d, d->progs);
    hl_bk_free(d, d->draws);
    hl_bk_free(d, d->state);
    hl_bk_free(d, d);
}

static uint32_t pool_size(uint32_t asked)
{
    return asked == 0 ? 4096 : asked > 0xffff ? 0xffff : asked;
}

static bool device_pools(struct hl_device *d)
{
    struct hl_device_desc *s = &d->desc;
    s->max_buffers = pool_size(s->max_buffers);
    s->max_textures = pool_size(s->max_textures);
    s->max_programs = pool_size(s->max_programs);
    d->bufs = hl_bk_alloc(d, s->max_buffers * sizeof *d->bufs);
    d->texs = hl_bk_alloc(d, s->max_textures * sizeof *d->texs);
    d->progs = hl_bk_alloc(d, s->max_programs * sizeof *d->progs);
    d->state = hl_bk_alloc(d, d->backend->state_bytes);
    return d->bufs && d->texs && d->progs && d->state &&
           pool_open(d, &d->pool[HL_POOL_BUF], s->max_buffers) &&
           pool_open(d, &d->pool[HL_POOL_TEX], s->max_textures) &&
           pool_open(d, &d->pool[HL_POOL_PROG], s->max_programs);
}

enum hl_result hl_device_open(struct hl_device **out,
                              const struct hl_backend *backend,
                              const struct hl_device_desc *desc)
{
    if (!out)
        return HL_ERR_INVALID;
    *out = NULL;
    if (!desc || !desc->hooks.alloc || !desc->hooks.free)
        return HL_ERR_INVALID;
    if (desc->version != HL_VERSION)
        return HL_ERR_VERSION;
    if (!backend)
        return HL_ERR_NO_DEVICE;
    if (backend->version != HL_VERSION)
        return HL_ERR_VERSION;
    struct hl_device *d = desc->hooks.alloc(desc->hooks.user, sizeof *d);
    if (!d)
        return HL_ERR_MEMORY;
    memset(d, 0, sizeof *d);
    d->backend = backend;
    d->hooks = desc->hooks;
    d->log = desc->log;
    d->log_user = desc->log_user;
    d->desc = *desc;
    enum hl_result r = device_pools(d) ? HL_OK : HL_ERR_MEMORY;
    if (r == HL_OK)
        r = hl_profile_check(d, d->desc.profile);
    if (r == HL_OK)
        r = backend->open(d->state, d, &d->desc, &d->caps);
    if (r == HL_OK)
        hl_profile_apply(&d->caps, d->desc.profile);
    d->caps.uniform_align += d->caps.uniform_align == 0;
    d->caps.storage_align += d->caps.storage_align == 0;
    /* What the desc points to is borrowed for this call only. */
    d->desc.device = no_desc.device;
    if (d->desc.profile)
        d->desc.profile = &d->caps.profile;
    if (r != HL_OK) {
        device_free(d);
        return r;
    }
    *out = d;
    return HL_OK;
}

static void destroy_all(struct hl_device *d, int pool, char kind)
{
    for (uint32_t i = 0; i < d->pool[pool].max; i++)
        if (d->pool[pool].live[i])
            d->backend->destroy(d->state, kind, i);
}

void hl_device_close(struct hl_device **device)
{
    if (!device || !*device)
        return;
    struct hl_device *d = *device;
    if (!d->lost)
        d->backend->submit(d->state, true);
    destroy_all(d, HL_POOL_PROG, 'p');
    destroy_all(d, HL_POOL_TEX, 't');
    destroy_all(d, HL_POOL_BUF, 'b');
    d->backend->close(d->state);
    device_free(d);
    *device = NULL;
}

const struct hl_caps *hl_device_caps(const struct hl_device *d)
{
    return &d->caps;
}

uint32_t hl_device_validation_errors(const struct hl_device *d)
{
    return d->validation_errors;
}

struct hl_counts hl_device_counts(const struct hl_device *d)
{
    return d->counts;
}

/* Remember a lost device; pass every result through here. */
static enum hl_result note(struct hl_device *d, enum hl_result r)
{
    if (r == HL_ERR_DEVICE_LOST)
        d->lost = true;
    return r;
}

/* ---- buffers ------------------------------------------------------------ */

enum hl_result hl_buf_create(struct hl_device *d, hl_buf *out,
                             const struct hl_buf_desc *desc)
{
    if (!d || !out || !desc)
        return HL_ERR_INVALID;
    out->id = 0;
    struct hl_buf_desc b = *desc;
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    if (b.bytes == 0)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_buf_desc.bytes", "0 bytes");
    if (b.usage == 0)
        b.usage = HL_BUF_VERTEX | HL_BUF_INDEX;
    if (b.usage > 15)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_buf_desc.usage", b.usage,
                                " has unknown bits");
    struct hl_pool *p = &d->pool[HL_POOL_BUF];
    uint32_t slot = pool_take(p);
    if (slot == HL_NO_SLOT)
        return hl_refuse_number(d, HL_ERR_LIMIT, HL_MSG_LIMIT, "buffers",
                                p->max, " are live: raise max_buffers");
    enum hl_result r = note(d, d->backend->buf_create(d->state, slot, &b));
    if (r != HL_OK) {
        pool_undo(p, slot);
        return r;
    }
    d->bufs[slot].bytes = b.bytes;
    d->bufs[slot].usage = b.usage;
    if (b.data)
        d->counts.bytes_written += b.bytes;
    out->id = pool_commit(p, slot);
    return HL_OK;
}

static void destroy(struct hl_device *d, int pool, char kind, uint32_t *id)
{
    uint32_t slot = hl_pool_find(&d->pool[pool], *id);
    *id = 0;
    if (slot == HL_NO_SLOT)
        return;
    d->backend->destroy(d->state, kind, slot);
    pool_release(&d->pool[pool], slot);
}

void hl_buf_destroy(struct hl_device *d, hl_buf *buf)
{
    if (d && buf)
        destroy(d, HL_POOL_BUF, 'b', &buf->id);
}

enum hl_result hl_buf_write(struct hl_device *d, hl_buf buf, size_t offset,
                            const void *data, size_t bytes)
{
    if (!d || (!data && bytes))
        return HL_ERR_INVALID;
    uint32_t slot = hl_pool_find(&d->pool[HL_POOL_BUF], buf.id);
    if (slot == HL_NO_SLOT)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_HANDLE, "hl_buf_write",
                         "not a live buffer");
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    size_t size = d->bufs[slot].bytes;
    if (offset > size || bytes > size - offset)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_buf_write", size,
                                " bytes is the buffer, the range ends past it");
    if (bytes == 0)
        return HL_OK;
    d->counts.bytes_written += bytes;
    return note(d, d->backend->buf_write(d->state, slot, offset, data, bytes));
}

/* ---- textures ----------------------------------------------------------- */

static uint32_t full_mips(uint32_t w, uint32_t h)
{
    uint32_t n = 1;
    for (uint32_t s = w > h ? w : h; s > 1; s >>= 1)
        n++;
    return n;
}

static enum hl_result check_tex(struct hl_device *d, struct hl_tex_desc *t)
{
    if (t->format == HL_FORMAT_NONE)
        t->format = HL_FORMAT_RGBA8_UNORM;
    if (t->samples == 0)
        t->samples = 1;
    if (t->mips == 0)
        t->mips = 1;
    if (t->usage == 0)
        t->usage = HL_TEX_SAMPLED;
    if ((unsigned)t->format >= HL_FORMAT_COUNT)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_FORMAT,
                                "hl_tex_desc.format", (uint64_t)t->format,
                                " is not a format");
    if (t->usage > 7)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_desc.usage", t->usage,
                                " has unknown bits");
    if (t->width == 0 || t->width > d->caps.max_tex_dim)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_desc.width", t->width,
                                " is not in 1..max_tex_dim");
    if (t->height == 0 || t->height > d->caps.max_tex_dim)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_desc.height", t->height,
                                " is not in 1..max_tex_dim");
    if (t->sample_as == HL_FORMAT_NONE)
        t->sample_as = t->format;
    if ((unsigned)t->sample_as >= HL_FORMAT_COUNT ||
        (t->sample_as != t->format &&
         (hl_format_info(t->sample_as)->bytes !=
          hl_format_info(t->format)->bytes ||
          ((hl_format_info(t->format)->kind == HL_KIND_DEPTH ||
            hl_format_info(t->sample_as)->kind == HL_KIND_DEPTH) &&
           !hl_depth_as_color(&d->caps, t)))))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_FORMAT,
                         "hl_tex_desc.sample_as",
                         "not a colour format of the same texel size");
    if (t->mips > full_mips(t->width, t->height) ||
        (t->mips > 1 && t->samples > 1))
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_desc.mips", t->mips,
                                " is more than the size has");
    const struct hl_format_caps *f = &d->caps.format[t->format];
    bool target = (t->usage & HL_TEX_TARGET) != 0;
    if ((target && !(f->use & HL_USE_TARGET)) ||
        ((t->usage & HL_TEX_SAMPLED) &&
         !(d->caps.format[t->sample_as].use & HL_USE_SAMPLED)))
        return hl_refuse(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                         hl_format_info(t->format)->name,
                         "this device lacks the usage asked for");
    if (t->samples & (t->samples - 1) || t->samples > 8 ||
        (t->samples > 1 && (!target || !(f->samples & t->samples))))
        return hl_refuse_number(d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
                                "hl_tex_desc.samples", t->samples,
                                " is not a sample count of this format here");
    return hl_console_check(d, t);
}

enum hl_result hl_tex_create(struct hl_device *d, hl_tex *out,
                             const struct hl_tex_desc *desc)
{
    if (!d || !out || !desc)
        return HL_ERR_INVALID;
    out->id = 0;
    struct hl_tex_desc t = *desc;
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    enum hl_result r = check_tex(d, &t);
    if (r != HL_OK)
        return r;
    struct hl_pool *p = &d->pool[HL_POOL_TEX];
    uint32_t slot = pool_take(p);
    if (slot == HL_NO_SLOT)
        return hl_refuse_number(d, HL_ERR_LIMIT, HL_MSG_LIMIT, "textures",
                                p->max, " are live: raise max_textures");
    r = note(d, d->backend->tex_create(d->state, slot, &t));
    if (r != HL_OK) {
        pool_undo(p, slot);
        return r;
    }
    t.label = NULL;
    d->texs[slot] = t;
    out->id = pool_commit(p, slot);
    return HL_OK;
}

void hl_tex_destroy(struct hl_device *d, hl_tex *tex)
{
    if (d && tex)
        destroy(d, HL_POOL_TEX, 't', &tex->id);
}

bool hl_tex_live(const struct hl_device *d, hl_tex tex)
{
    return hl_pool_find(&d->pool[HL_POOL_TEX], tex.id) != HL_NO_SLOT;
}

bool hl_tex_info(const struct hl_device *d, hl_tex tex,
                 struct hl_tex_desc *out)
{
    uint32_t slot = hl_pool_find(&d->pool[HL_POOL_TEX], tex.id);
    if (slot == HL_NO_SLOT)
        return false;
    *out = d->texs[slot];
    return true;
}

static size_t level_bytes(const struct hl_tex_desc *t, uint32_t mip,
                          size_t texel)
{
    size_t w = t->width >> mip, h = t->height >> mip;
    return (w ? w : 1) * (h ? h : 1) * texel;
}

enum hl_result hl_tex_write(struct hl_device *d, hl_tex tex, uint32_t mip,
                            const void *data, size_t bytes)
{
    if (!d || !data)
        return HL_ERR_INVALID;
    uint32_t slot = hl_pool_find(&d->pool[HL_POOL_TEX], tex.id);
    if (slot == HL_NO_SLOT)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_HANDLE, "hl_tex_write",
                         "not a live texture");
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    const struct hl_tex_desc *t = &d->texs[slot];
    if (mip >= t->mips || t->samples > 1 ||
        hl_format_info(t->format)->kind == HL_KIND_DEPTH)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_tex_write",
                         "no such level, multisampled, or depth");
    size_t need = level_bytes(t, mip, hl_format_info(t->format)->bytes);
    if (bytes != need)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_write", need, " bytes are needed");
    d->counts.bytes_written += bytes;
    return note(d, d->backend->tex_write(d->state, slot, mip, data, bytes));
}

enum hl_result hl_tex_read(struct hl_device *d, hl_tex tex, void *out,
                           size_t bytes)
{
    if (!d || !out)
        return HL_ERR_INVALID;
    uint32_t slot = hl_pool_find(&d->pool[HL_POOL_TEX], tex.id);
    if (slot == HL_NO_SLOT)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_HANDLE, "hl_tex_read",
                         "not a live texture");
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    const struct hl_tex_desc *t = &d->texs[slot];
    const struct hl_format_info *f = hl_format_info(t->format);
    if (!(t->usage & HL_TEX_READBACK) || t->samples > 1)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_tex_read",
                         "needs HL_TEX_READBACK and one sample");
    size_t need = level_bytes(t, 0, f->kind == HL_KIND_DEPTH ? 4 : f->bytes);
    if (bytes != need)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_tex_read", need, " bytes are needed");
    return note(d, d->backend->tex_read(d->state, slot, out, bytes));
}

/* ---- programs ----------------------------------------------------------- */

enum hl_result hl_prog_create(struct hl_device *d, hl_prog *out,
                              const struct hl_prog_desc *desc)
{
    if (!d || !out || !desc)
        return HL_ERR_INVALID;
    out->id = 0;
    struct hl_prog_desc p = *desc;
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    enum hl_result r = hl_check_prog(d, &p);
    if (r != HL_OK)
        return r;
    struct hl_pool *pool = &d->pool[HL_POOL_PROG];
    uint32_t slot = pool_take(pool);
    if (slot == HL_NO_SLOT)
        return hl_refuse_number(d, HL_ERR_LIMIT, HL_MSG_LIMIT, "programs",
                                pool->max, " are live: raise max_programs");
    r = note(d, d->backend->prog_create(d->state, slot, &p));
    if (r != HL_OK) {
        pool_undo(pool, slot);
        return r;
    }
    struct hl_prog_state *s = &d->progs[slot];
    memcpy(s->color, p.color, sizeof s->color);
    s->n_colors = p.n_colors;
    s->depth = p.depth;
    s->samples = p.samples;
    s->depth_write = p.depth_write || hl_stencil_writes(&p.stencil);
    s->streams = 0;
    for (int i = 0; i < HL_MAX_ATTRS; i++)
        if (p.layout.attr[i].format != HL_ATTR_NONE)
            s->streams |= 1u << p.layout.attr[i].stream;
    out->id = pool_commit(pool, slot);
    return HL_OK;
}

void hl_prog_destroy(struct hl_device *d, hl_prog *prog)
{
    if (d && prog)
        destroy(d, HL_POOL_PROG, 'p', &prog->id);
}
