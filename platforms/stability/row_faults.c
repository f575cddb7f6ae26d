/* SPDX-License-Identifier: Zlib */
/* Devices that fail: a whole life (upload a scene, plan, make a renderer, draw
 * and read back) on a machine whose n-th call fails, for every n. Right is: an
 * error, and the code it failed with; the same life again gives the same
 * picture, or on a lost device nothing works any more; nothing is left of
 * memory or objects. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"
#include "platforms/stability/rig.h"
#include "hal/backend.h"

enum { SIDE = 16, STRIDE = HLS_STEPS };
enum fault { CALL_ONCE, CALL_EVER, LOST, MEMORY_ONCE, MEMORY_EVER };

/* ---- host memory that is counted and fails ------------------------------ */

struct memory { size_t live, calls, fail_at; bool for_ever; };

static bool runs_out(size_t calls, size_t fail_at, bool for_ever)
{
    return fail_at && (calls == fail_at || (for_ever && calls > fail_at));
}

static void *take(void *user, size_t bytes)
{
    struct memory *m = user;
    void *p = runs_out(++m->calls, m->fail_at, m->for_ever) ? NULL
                                                            : malloc(bytes);
    m->live += p != NULL;
    return p;
}

static void give(void *user, void *p)
{
    struct memory *m = user;
    m->live -= p != NULL;
    free(p);
}

/* ---- a backend whose calls fail ----------------------------------------- */

/* Outlives the device. */
struct rules {
    const struct hl_backend *inner;
    size_t calls, fail_at;
    bool for_ever;
    enum hl_result with;
    size_t live;                 /* buffers, textures and programs           */
};

/* In front of the inner backend's state; aligned for any. */
struct front {
    struct rules *rules;
    struct hl_device_desc desc;  /* inner's, valid until close               */
};
enum { FRONT = (sizeof(struct front) + 63) / 64 * 64 };

static void *inner_state(void *state) { return (char *)state + FRONT; }

static struct rules *rules_of(void *state)
{
    return ((struct front *)state)->rules;
}

/* HL_OK where the call may go on. */
static enum hl_result may(void *state)
{
    struct rules *r = rules_of(state);
    return runs_out(++r->calls, r->fail_at, r->for_ever) ? r->with : HL_OK;
}

#define CALL(name, ...) \
    enum hl_result e = may(state); \
    if (e == HL_OK) \
        e = rules_of(state)->inner->name(inner_state(state), __VA_ARGS__)

static enum hl_result f_open(void *state, struct hl_device *device,
                             const struct hl_device_desc *desc,
                             struct hl_caps *caps)
{
    struct front *f = state;
    f->rules = *(struct rules *const *)desc->native;
    f->desc = *desc;
    f->desc.native = NULL;
    CALL(open, device, &f->desc, caps);
    return e;
}

static void f_close(void *state)
{
    rules_of(state)->inner->close(inner_state(state));
}

static enum hl_result f_buf_create(void *state, uint32_t slot,
                                   const struct hl_buf_desc *d)
{
    CALL(buf_create, slot, d);
    rules_of(state)->live += e == HL_OK;
    return e;
}

static enum hl_result f_buf_write(void *state, uint32_t slot, size_t offset,
                                  const void *data, size_t bytes)
{
    CALL(buf_write, slot, offset, data, bytes);
    return e;
}

static enum hl_result f_tex_create(void *state, uint32_t slot,
                                   const struct hl_tex_desc *d)
{
    CALL(tex_create, slot, d);
    rules_of(state)->live += e == HL_OK;
    return e;
}

static enum hl_result f_tex_write(void *state, uint32_t slot, uint32_t mip,
                                  const void *data, size_t bytes)
{
    CALL(tex_write, slot, mip, data, bytes);
    return e;
}

static enum hl_result f_tex_read(void *state, uint32_t slot, void *out,
                                 size_t bytes)
{
    CALL(tex_read, slot, out, bytes);
    return e;
}

static enum hl_result f_prog_create(void *state, uint32_t slot,
                                    const struct hl_prog_desc *d)
{
    CALL(prog_create, slot, d);
    rules_of(state)->live += e == HL_OK;
    return e;
}

static void f_destroy(void *state, char kind, uint32_t slot)
{
    rules_of(state)->live--;
    rules_of(state)->inner->destroy(inner_state(state), kind, slot);
}

static enum hl_result f_pass_run(void *state, const struct hl_bk_pass *pass,
                                 const struct hl_bk_draw *draws, uint32_t n)
{
    CALL(pass_run, pass, draws, n);
    return e;
}

static enum hl_result f_submit(void *state, bool wait)
{
    CALL(submit, wait);
    return e;
}

static uint32_t f_timings(void *state, struct hl_timing *out, uint32_t max)
{
    return rules_of(state)->inner->timings(inner_state(state), out, max);
}

static struct hl_backend faulty(const struct hl_backend *inner)
{
    return (struct hl_backend){
        inner->name, inner->version, FRONT + inner->state_bytes,
        inner->list, f_open, f_close, f_buf_create, f_buf_write,
        f_tex_create, f_tex_write, f_tex_read, f_prog_create, f_destroy,
        f_pass_run, f_submit, f_timings
    };
}

/* ---- a life ------------------------------------------------------------- */

struct faults {
    struct hlh_scene scene;
    struct hlh_picture good;     /* of a life without a fault                */
    size_t calls;                /* of it that may fail                      */
    size_t drawn;                /* calls of the machine until it was read   */
    struct hl_backend backend;
    struct memory memory;
    struct rules rules, *native; /* native: to rules                         */
};

/* Upload, plan, make, draw, read: HL_OK or any failure. */
static enum hl_result live(struct hlh_picture *out, struct faults *f,
                           struct hl_device *d, const struct hlc_options *o)
{
    static const struct hlc_world_options w;
    struct hlc_stage stage;
    struct hlc_shot shot;
    struct hlh_error error;
    memset(&stage, 0, sizeof stage);
    stage.machine.device = d;
    stage.machine.backend = &f->backend;
    stage.machine.caps = *hl_device_caps(d);
    stage.scene = f->scene;      /* borrowed                                 */
    enum hl_result r = HL_ERR_MEMORY;
    if (hlc_world_create(&stage.world, d, &stage.scene, &w, &error)) {
        if (hlc_shot_open(&shot, &stage, o, NULL, NULL, NULL) == 0) {
            r = hlc_shot_draw(&shot, NULL);
            if (r == HL_OK)
                r = hlc_shot_read(&shot, out);
            f->drawn = f->rules.calls;
            hlc_shot_close(&shot);
        }
    }
    hlc_world_free(&stage.world);
    return r;
}

static bool same(const struct hlh_picture *a, const struct hlh_picture *b)
{
    return !memcmp(a->rgb, b->rgb, sizeof(float[3]) * SIDE * SIDE);
}

/* What the machine does after the fault; whether that is right. */
static bool afterwards(struct faults *f, struct hl_device *d, bool sticky,
                       const struct hlc_options *o)
{
    struct hlh_picture p;
    enum hl_result r = live(&p, f, d, o);
    bool right = sticky ? r != HL_OK : r == HL_OK && same(&p, &f->good);
    if (r == HL_OK)
        hlh_picture_free(&p);
    return right;
}

static struct hl_device_desc describe(struct faults *f,
                                      const struct hlc_options *o)
{
    struct hl_device_desc d;
    memset(&d, 0, sizeof d);
    d.version = HL_VERSION;
    d.hooks = (struct hl_hooks){ take, give, &f->memory };
    d.profile = o->profile ? hl_profile_find(o->profile) : NULL;
    d.native = &f->native;
    return d;
}

static void arm(struct faults *f, enum fault kind, size_t at)
{
    bool memory = kind == MEMORY_ONCE || kind == MEMORY_EVER;
    bool ever = kind == CALL_EVER || kind == MEMORY_EVER;
    f->memory = (struct memory){ 0, 0, memory ? at : 0, ever };
    f->rules = (struct rules){ f->rules.inner, 0, memory ? 0 : at, ever,
                               kind == LOST ? HL_ERR_DEVICE_LOST
                                            : HL_ERR_MEMORY, 0 };
}

/* An error where call `at` failed. There may be a way around a failed
 * allocation, and what fails while all is destroyed has no one to tell. */
static bool right_result(const struct faults *f, enum hl_result r, size_t at,
                         bool memory, const struct hlh_picture *p)
{
    if (at == 0)
        return r == HL_OK;
    if (r == HL_OK)
        return (memory || at > f->drawn) && same(p, &f->good);
    return r != HL_ERR_INVALID;
}

/* Whether all was right with call `at` failing (0: none); *reached: it came
 * to be made. */
static bool survive(struct faults *f, enum fault kind, size_t at,
                    bool *reached, const struct hlc_options *o)
{
    struct hl_device *d = NULL;
    struct hlh_picture p = { 0, 0, NULL, true };
    bool memory = kind == MEMORY_ONCE || kind == MEMORY_EVER;
    /* A device that was lost in one call is lost to all that follow. */
    bool sticky = kind != CALL_ONCE && kind != MEMORY_ONCE;
    size_t left = 0;             /* objects that a life forgot               */
    arm(f, kind, at);
    struct hl_device_desc desc = describe(f, o);
    enum hl_result r = hl_device_open(&d, &f->backend, &desc);
    bool right = true;
    if (r == HL_OK) {
        r = live(&p, f, d, o);
        right = right_result(f, r, at, memory, &p);
        if (right && r != HL_OK)
            right = afterwards(f, d, sticky, o);
        left = f->rules.live;
    } else {
        right = at && !d;
    }
    if (at == 0 && r == HL_OK)
        f->good = p;
    else if (r == HL_OK)
        hlh_picture_free(&p);
    hl_device_close(&d);
    *reached = (memory ? f->memory.calls : f->rules.calls) >= at;
    return right && left == 0 && f->memory.live == 0 && f->rules.live == 0;
}

/* ---- the row ------------------------------------------------------------ */

static bool build(struct faults *f)
{
    struct hls_rig rig;
    hls_rig_begin(&rig, 2, 60);
    hls_rig_wall(&rig, 0, 1, 0);
    hls_rig_wall(&rig, 0, 0.5, 0.3);
    hlh_build_light(&rig.b, hlh_v3(0.3, 0.2, 1), 3, hlh_v3(1, 1, 1));
    hlh_build_light(&rig.b, hlh_v3(-0.3, 0, 1), 3, hlh_v3(1, 0, 0));
    return hls_rig_take(&f->scene, &rig);
}

/* arg: enum fault. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct faults *f = calloc(1, sizeof *f);
    struct hlc_options o;
    bool reached;
    lab->data = f;
    hls_rig_options(&o, lab, SIDE, SIDE);
    if (!f || !build(f))
        return false;
    if (strcmp(lab->o->backend, "packemu") &&
        (lab->o->fast || c->arg[0] >= (double)MEMORY_ONCE)) {
        *skip = "takes minutes where programs are compiled";
        return true;
    }
    f->native = &f->rules;
    f->rules.inner = hl_platform_find(lab->o->backend);
    f->backend = faulty(f->rules.inner);
    if (!survive(f, CALL_ONCE, 0, &reached, &o))
        return hls_rig_fail("faults", HL_ERR_INVALID);
    f->calls = c->arg[0] == (double)MEMORY_ONCE ||
               c->arg[0] == (double)MEMORY_EVER ? f->memory.calls
                                                : f->rules.calls;
    snprintf(lab->note, sizeof lab->note, "%u calls that may fail",
             (unsigned)f->calls);
    return true;
}

static void end(struct hls_lab *lab)
{
    struct faults *f = lab->data;
    if (f) {
        hlh_picture_free(&f->good);
        hlh_scene_free(&f->scene);
    }
    free(f);
    lab->data = NULL;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct faults *f = lab->data;
    struct hlc_options o;
    hls_rig_options(&o, lab, SIDE, SIDE);
    *m = 0;
    for (size_t n = (size_t)p; n <= f->calls; n += STRIDE) {
        bool reached = false;
        *m += !survive(f, (enum fault)c->arg[0], n, &reached, &o);
        *m += !reached;
    }
    return true;
}

#define RIGHT "none: an error, no leak, a device that works or is lost"

static const struct hls_case cases[] = {
    { "call-once", "one call of the machine fails", 1, STRIDE, 0, false, NAN,
      NAN, RIGHT, { CALL_ONCE, 0, 0, 0 } },
    { "call-ever", "and all that follow", 1, STRIDE, 0, false, NAN, NAN,
      RIGHT, { CALL_EVER, 0, 0, 0 } },
    { "lost", "a call finds the device lost", 1, STRIDE, 0, false, NAN, NAN,
      RIGHT, { LOST, 0, 0, 0 } },
    { "memory-once", "one allocation on the host fails", 1, STRIDE, 0, false,
      NAN, NAN, RIGHT, { MEMORY_ONCE, 0, 0, 0 } },
    { "memory-ever", "and all that follow", 1, STRIDE, 0, false, NAN, NAN,
      RIGHT, { MEMORY_EVER, 0, 0, 0 } },
};

const struct hls_row hls_row_faults = {
    "faults", "Memory or the device goes while a frame is made",
    "conformance c; 70 (SQLite's and curl's way to test)",
    "call that fails, and every 24th after it", "calls", "wrong outcomes",
    HLS_WHOLE, cases, sizeof cases / sizeof *cases, begin, end, measure
};
