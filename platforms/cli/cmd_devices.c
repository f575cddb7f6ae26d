/* SPDX-License-Identifier: Zlib */
/* devices: what this build and this machine can draw with. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"

enum { DEVICES_MAX = 16, BACKENDS_MAX = 8 };

struct found {
    struct hl_device_info info;
    enum hl_result opened;
    struct hl_caps caps;     /* where opened is HL_OK                        */
};
struct machine {
    const struct hl_backend *backend;
    enum hl_result listed;
    uint32_t n;
    struct found devices[DEVICES_MAX];
};

static const char *kind_name(enum hl_device_kind kind)
{
    switch (kind) {
    case HL_DEVICE_DISCRETE: return "discrete";
    case HL_DEVICE_INTEGRATED: return "integrated";
    case HL_DEVICE_CPU: return "cpu";
    default: return "other";
    }
}

/* ---- asking ------------------------------------------------------------- */

static void look_at_device(struct found *f, const struct hl_backend *backend,
                           uint32_t index)
{
    struct hl_device_desc d;
    struct hl_device *device;
    char text[16];
    memset(&d, 0, sizeof d);
    snprintf(text, sizeof text, "%u", (unsigned)index);
    d.version = HL_VERSION;
    d.hooks = hlc_hooks();
    d.device = text;
    f->opened = hl_device_open(&device, backend, &d);
    if (f->opened != HL_OK)
        return;
    f->caps = *hl_device_caps(device);
    hl_device_close(&device);
}

static void look_at(struct machine *m, const struct hl_backend *backend)
{
    struct hl_device_info info[DEVICES_MAX];
    struct hl_hooks hooks = hlc_hooks();
    m->backend = backend;
    m->listed = hl_devices_list(backend, &hooks, info, DEVICES_MAX, &m->n);
    if (m->listed != HL_OK)
        m->n = 0;
    if (m->n > DEVICES_MAX)
        m->n = DEVICES_MAX;
    for (uint32_t i = 0; i < m->n; i++) {
        m->devices[i].info = info[i];
        look_at_device(&m->devices[i], backend, i);
    }
}

/* ---- text --------------------------------------------------------------- */

static void print_formats(const struct hl_caps *c)
{
    for (int i = HL_FORMAT_NONE + 1; i < HL_FORMAT_COUNT; i++) {
        const struct hl_format_caps *f = &c->format[i];
        printf("      %-15s %-7s %-6s %-6s %-5s",
               hl_format_info((enum hl_format)i)->name,
               f->use & HL_USE_SAMPLED ? "sampled" : "-",
               f->use & HL_USE_LINEAR ? "linear" : "-",
               f->use & HL_USE_TARGET ? "target" : "-",
               f->use & HL_USE_BLEND ? "blend" : "-");
        for (unsigned s = 1; s <= 8; s *= 2)
            if (f->samples & s)
                printf(" x%u", s);
        printf("\n");
    }
}

static void print_device(const struct found *f, uint32_t index)
{
    const struct hl_caps *c = &f->caps;
    printf("  %u %s (%s), %s\n", (unsigned)index, f->info.name,
           kind_name(f->info.kind), f->info.driver);
    if (f->opened != HL_OK) {
        printf("      cannot be opened: %s\n", hl_result_name(f->opened));
        return;
    }
    printf("      textures to %u a side, %u colour targets, uniform ranges "
           "to %u bytes, storage to %u%s\n", (unsigned)c->max_tex_dim,
           (unsigned)c->max_colors, (unsigned)c->max_uniform_bytes,
           (unsigned)c->max_storage_bytes,
           c->timestamps ? ", timestamps" : "");
    print_formats(c);
}

static void print_machine(const struct machine *m)
{
    printf("%s%s%s\n", m->backend->name, m->n ? "" : ": ",
           m->n ? "" : hl_result_name(m->listed == HL_OK ? HL_ERR_NO_DEVICE
                                                         : m->listed));
    for (uint32_t i = 0; i < m->n; i++)
        print_device(&m->devices[i], i);
}

/* ---- JSON --------------------------------------------------------------- */

static void add_samples(cJSON *j, uint32_t mask)
{
    double counts[4];
    int n = 0;
    for (unsigned s = 1; s <= 8; s *= 2)
        if (mask & s)
            counts[n++] = s;
    hlc_json_reals(j, "samples", counts, n, 3);
}

static cJSON *format_json(const struct hl_caps *c, enum hl_format format)
{
    static const char *const use[] = { "sampled", "linear", "target",
                                       "blend" };
    const struct hl_format_caps *f = &c->format[format];
    cJSON *j = cJSON_CreateObject();
    cJSON_AddStringToObject(j, "name", hl_format_info(format)->name);
    cJSON *uses = cJSON_AddArrayToObject(j, "use");
    for (int i = 0; i < 4; i++)
        if (f->use >> i & 1)
            cJSON_AddItemToArray(uses, cJSON_CreateString(use[i]));
    add_samples(j, f->samples);
    return j;
}

static void add_cost(cJSON *caps, const struct hl_cost_model *c)
{
    cJSON *j = cJSON_AddObjectToObject(caps, "cost_ns");
    hlc_json_real(j, "draw", (double)c->draw_ns, 6);
    hlc_json_real(j, "vertex", (double)c->vertex_ns, 6);
    hlc_json_real(j, "pixel", (double)c->pixel_ns, 6);
    hlc_json_real(j, "fetch", (double)c->fetch_ns, 6);
    hlc_json_real(j, "blend", (double)c->blend_ns, 6);
    hlc_json_real(j, "light", (double)c->light_ns, 6);
    hlc_json_real(j, "light_gather", (double)c->light_gather_ns, 6);
    hlc_json_real(j, "readback", (double)c->readback_ns, 6);
    hlc_json_real(j, "sync", (double)c->sync_ns, 6);
    hlc_json_real(j, "untaken", (double)c->untaken, 6);
}

static cJSON *caps_json(const struct hl_caps *c)
{
    cJSON *j = cJSON_CreateObject();
    hlc_json_uint(j, "max_tex_dim", c->max_tex_dim);
    hlc_json_uint(j, "max_colors", c->max_colors);
    hlc_json_uint(j, "max_uniform_bytes", c->max_uniform_bytes);
    hlc_json_uint(j, "max_storage_bytes", c->max_storage_bytes);
    hlc_json_uint(j, "uniform_align", c->uniform_align);
    hlc_json_uint(j, "storage_align", c->storage_align);
    add_samples(j, c->samples);
    cJSON_AddBoolToObject(j, "timestamps", c->timestamps);
    cJSON_AddBoolToObject(j, "clip_zero_to_one", c->clip_zero_to_one);
    add_cost(j, &c->cost);
    cJSON *formats = cJSON_AddArrayToObject(j, "formats");
    for (int i = HL_FORMAT_NONE + 1; i < HL_FORMAT_COUNT; i++)
        cJSON_AddItemToArray(formats, format_json(c, (enum hl_format)i));
    return j;
}

static cJSON *device_json(const struct found *f, uint32_t index)
{
    cJSON *j = cJSON_CreateObject();
    hlc_json_uint(j, "index", index);
    cJSON_AddStringToObject(j, "name", f->info.name);
    cJSON_AddStringToObject(j, "driver", f->info.driver);
    cJSON_AddStringToObject(j, "kind", kind_name(f->info.kind));
    if (f->opened == HL_OK)
        cJSON_AddItemToObject(j, "caps", caps_json(&f->caps));
    else
        cJSON_AddNullToObject(j, "caps");
    return j;
}

static cJSON *machines_json(const struct machine *m, uint32_t n)
{
    cJSON *j = hlc_json_begin("devices");
    cJSON *profiles = cJSON_AddArrayToObject(j, "profiles");
    for (uint32_t i = 0; hl_profile_at(i); i++)
        cJSON_AddItemToArray(profiles,
                             cJSON_CreateString(hl_profile_at(i)->name));
    cJSON *backends = cJSON_AddArrayToObject(j, "backends");
    for (uint32_t i = 0; i < n; i++) {
        cJSON *b = cJSON_CreateObject();
        cJSON_AddItemToArray(backends, b);
        cJSON_AddStringToObject(b, "name", m[i].backend->name);
        cJSON *devices = cJSON_AddArrayToObject(b, "devices");
        for (uint32_t k = 0; k < m[i].n; k++)
            cJSON_AddItemToArray(devices, device_json(&m[i].devices[k], k));
    }
    return j;
}

/* ---- the command -------------------------------------------------------- */

static int publish(const struct machine *m, uint32_t n,
                   const struct hlc_options *o)
{
    struct hlh_error error;
    bool ok = true;
    if (o->json) {
        cJSON *j = machines_json(m, n);
        ok = hlc_json_emit(j, o->json, &error);
        cJSON_Delete(j);
    }
    if (!ok)
        return hlc_fail(HLC_BAD, "%s", error.text);
    if (o->json && !strcmp(o->json, "-"))
        return HLC_DONE;
    for (uint32_t i = 0; i < n; i++)
        print_machine(&m[i]);
    printf("profiles\n");
    for (uint32_t i = 0; hl_profile_at(i); i++)
        printf("  %s\n", hl_profile_at(i)->name);
    return HLC_DONE;
}

int hlc_cmd_devices(const struct hlc_options *o)
{
    struct machine *m = calloc(BACKENDS_MAX, sizeof *m);
    uint32_t n = 0;
    int code;
    if (!m)
        return hlc_fail(HLC_BAD, "devices: out of memory");
    for (uint32_t i = 0; hl_platform(i) && n < BACKENDS_MAX; i++)
        if (!o->backend || !strcmp(o->backend, hl_platform(i)->name))
            look_at(&m[n++], hl_platform(i));
    if (o->backend && !m[0].n)
        code = hlc_fail(HLC_NO_DEVICE, "--backend %s: has no device here",
                        o->backend);
    else
        code = publish(m, n, o);
    free(m);
    return code;
}
