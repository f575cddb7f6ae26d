/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

/* ---- devices ---------------------------------------------------------- */

static void keep(void *user, enum hl_log_level level, enum hl_log_id id,
                 const char *text)
{
    struct ck_machine *m = user;
    if (level == HL_LOG_INFO)
        return;
    m->errors += level == HL_LOG_ERROR;
    m->warnings += level == HL_LOG_WARNING;
    if ((unsigned)id < CK_IDS)
        m->by_id[id]++;
    m->last_id = id;
    snprintf(m->last, sizeof m->last, "%s", text);
    if (id == HL_MSG_VALIDATION && level == HL_LOG_ERROR) {
        m->invalid++;
        print_error("%s\n", text);
    }
}

struct hl_device_desc ck_desc(struct ck_machine *m)
{
    struct hl_device_desc d;
    memset(&d, 0, sizeof d);
    d.version = HL_VERSION;
    d.hooks = mk_hooks(&m->memory);
    d.log = keep;
    d.log_user = m;
    d.validation = true;
    return d;
}

bool ck_open(struct ck_machine *m, const char *backend, const void *native)
{
    memset(m, 0, sizeof *m);
    m->backend = hl_platform_find(backend);
    if (!m->backend) {
        snprintf(m->last, sizeof m->last, "no backend %s in this program",
                 backend);
        return false;
    }
    struct hl_device_desc d = ck_desc(m);
    d.native = native;
    enum hl_result r = hl_device_open(&m->device, m->backend, &d);
    if (r != HL_OK && r != HL_ERR_NO_DEVICE)
        fail_msg("%s: %s: %s", backend, hl_result_name(r), m->last);
    return r == HL_OK;
}

void ck_open_as(struct ck_machine *m, const char *backend,
                const char *profile)
{
    memset(m, 0, sizeof *m);
    m->backend = hl_platform_find(backend);
    struct hl_device_desc d = ck_desc(m);
    d.profile = hl_profile_find(profile);
    assert_non_null(d.profile);
    if (hl_device_open(&m->device, m->backend, &d) != HL_OK)
        fail_msg("%s as %s: %s", backend, profile, m->last);
}

void ck_close(struct ck_machine *m)
{
    if (!m->device)
        return;
    assert_int_equal(hl_device_validation_errors(m->device), m->invalid);
    hl_device_close(&m->device);
    if (m->invalid)
        fail_msg("%u validation errors, see above", m->invalid);
    if (m->memory.n_live)
        fail_msg("%zu allocations were not freed", m->memory.n_live);
}

int ck_setup(void **state)
{
    const char *backend = *state;
    struct ck_machine *m = malloc(sizeof *m);
    if (!m)
        return -1;
    ck_open(m, backend, NULL);
    *state = m;
    return 0;
}

int ck_teardown(void **state)
{
    struct ck_machine *m = *state;
    ck_close(m);
    free(m);
    return 0;
}

struct ck_machine *ck_machine(void **state)
{
    struct ck_machine *m = *state;
    if (!m->device) {
        print_message("skipped: no %s device: %s\n",
                      m->backend ? m->backend->name : "such", m->last);
        skip();
    }
    return m;
}

void ck_refused(const struct ck_machine *m, uint32_t before,
                enum hl_log_id id, const char *part)
{
    if (m->errors != before + 1)
        fail_msg("%u errors logged, not 1; last: %s", m->errors - before,
                 m->last);
    if (m->last_id != id || !strstr(m->last, part))
        fail_msg("logged %d \"%s\", not %d with \"%s\"", (int)m->last_id,
                 m->last, (int)id, part);
}

/* ---- caps ------------------------------------------------------------- */

static void usable(struct hl_caps *c, enum hl_format f, int use)
{
    c->format[f].use = (uint8_t)use;
    c->format[f].samples = use & HL_USE_TARGET ? 1 | 4 : 0;
}

void ck_lavapipe(struct hl_caps *c)
{
    enum { FETCH = HL_USE_SAMPLED | HL_USE_LINEAR, DRAW = HL_USE_TARGET };
    memset(c, 0, sizeof *c);
    strcpy(c->backend, "vulkan");
    strcpy(c->device, "llvmpipe (LLVM 15.0.6, 256 bits)");
    strcpy(c->driver, "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)");
    c->kind = HL_DEVICE_CPU;
    c->max_tex_dim = 16384;
    c->max_colors = 8;
    c->max_uniform_bytes = 65536;
    c->max_storage_bytes = 1u << 27;
    c->uniform_align = c->storage_align = 16;
    c->samples = 1 | 4;
    c->timestamps = true;
    c->clip_zero_to_one = true;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        enum hl_format f = (enum hl_format)i;
        enum hl_format_kind kind = hl_format_info(f)->kind;
        int use = kind == HL_KIND_UINT ? HL_USE_SAMPLED | DRAW
                  : kind == HL_KIND_DEPTH ? HL_USE_SAMPLED | DRAW
                  : kind == HL_KIND_SNORM ? FETCH | DRAW
                  : FETCH | DRAW | HL_USE_BLEND;
        usable(c, f, use);
        if (kind == HL_KIND_UINT)
            c->format[f].samples = 1;
    }
    c->cost = (struct hl_cost_model){
        .draw_ns = 1500.0f, .vertex_ns = 150.0f, .pixel_ns = 1.5f,
        .fetch_ns = 1.2f, .blend_ns = 1.9f, .light_ns = 2.4f,
        .light_flat_ns = 1.5f, .light_gather_ns = 8.0f, .readback_ns = 0.5f,
        .sync_ns = 15000.0f, .untaken = 1.0f };
}

/* ---- numbers ---------------------------------------------------------- */

float ck_half(uint16_t h)
{
    int e = h >> 10 & 31;
    float m = (float)(h & 1023) / 1024.0f;
    float x = e == 31 ? (h & 1023 ? NAN : INFINITY)
              : e ? ldexpf(1 + m, e - 15) : ldexpf(m, -14);
    return h & 0x8000 ? -x : x;
}

/* The code at or next toward zero of |x|. */
static uint16_t below(float x, bool *tie, bool *up)
{
    uint16_t low = 0, high = 0x7c00;
    while (high - low > 1) {
        uint16_t mid = (uint16_t)((low + high) / 2);
        if (ck_half(mid) <= x)
            low = mid;
        else
            high = mid;
    }
    float a = ck_half(low), b = high == 0x7c00 ? 65536.0f : ck_half(high);
    *tie = x - a == b - x;
    *up = x - a > b - x;
    return low;
}

uint16_t ck_half_truncate(float x)
{
    bool tie, up;
    return (uint16_t)(below(fabsf(x), &tie, &up) | (x < 0 ? 0x8000 : 0));
}

uint16_t ck_half_nearest(float x)
{
    bool tie, up;
    uint16_t h = below(fabsf(x), &tie, &up);
    if (up || (tie && h & 1))
        h++;
    return (uint16_t)(h | (x < 0 ? 0x8000 : 0));
}

uint32_t ck_ulps(float a, float b)
{
    int32_t x, y;
    memcpy(&x, &a, 4);
    memcpy(&y, &b, 4);
    int64_t i = x < 0 ? (int64_t)INT32_MIN - x : x;
    int64_t j = y < 0 ? (int64_t)INT32_MIN - y : y;
    int64_t n = i > j ? i - j : j - i;
    return a != a || b != b || n > UINT32_MAX ? UINT32_MAX : (uint32_t)n;
}

double ck_between(uint64_t *seed, double low, double high)
{
    return low + (high - low) * (double)mk_unit(seed);
}

void ck_near_at(const char *file, int line, const char *what, double got,
                double want, double tolerance)
{
    if (fabs(got - want) <= tolerance)
        return;
    print_error("%s: %.9g, not %.9g within %.3g\n", what, got, want,
                tolerance);
    _fail(file, line);
}

/* ---- pictures --------------------------------------------------------- */

float *ck_read(struct hl_device *d, hl_tex tex, uint32_t *w, uint32_t *h)
{
    struct hl_tex_desc t;
    assert_true(hl_tex_info(d, tex, &t));
    size_t n = (size_t)t.width * t.height * 4;
    size_t bytes = n / 4 * hl_format_info(t.format)->bytes;
    float *out = malloc(n * sizeof *out);
    void *raw = malloc(bytes);
    assert_non_null(out);
    assert_non_null(raw);
    assert_int_equal(hl_tex_read(d, tex, raw, bytes), HL_OK);
    const uint16_t *u = raw;
    if (t.format == HL_FORMAT_RGBA32_FLOAT)
        memcpy(out, raw, bytes);
    else
        for (size_t i = 0; i < n; i++)
            out[i] = t.format == HL_FORMAT_RGBA16_FLOAT
                     ? ck_half(u[i]) : (float)u[i] / 65535.0f;
    free(raw);
    if (w)
        *w = t.width;
    if (h)
        *h = t.height;
    return out;
}
