/* SPDX-License-Identifier: Zlib */
/* halflight-packemu: built-in scenes drawn by the software device, with the C
 * library alone. It prints a hash of what was drawn, so that machines,
 * compilers and numbers of threads can be compared by a line of text. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/render.h"
#include "platforms/cli/tap.h"
#include "platforms/cli/value.h"
#include "platforms/host/util.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/profiles/hl_profiles.h"

/* ---- the device -------------------------------------------------------- */

static void listen(void *user, enum hl_log_level level, enum hl_log_id id,
                   const char *text)
{
    struct hlc_machine *m = user;
    (void)id;
    if (level == HL_LOG_ERROR)
        snprintf(m->complaint, sizeof m->complaint, "%s", text);
}

static struct hl_device_desc describe(const struct hl_packemu_native *native,
                                      const struct hlc_options *o)
{
    struct hl_device_desc d;
    memset(&d, 0, sizeof d);
    d.version = HL_VERSION;
    d.hooks = hlc_hooks();
    d.native = native;
    d.profile = o->profile ? hl_profile_find(o->profile) : NULL;
    return d;
}

int hlc_machine_open(struct hlc_machine *m, const struct hlc_options *o)
{
    const struct hl_packemu_native native = { o->threads };
    struct hl_device_desc d = describe(&native, o);
    memset(m, 0, sizeof *m);
    d.log = listen;
    d.log_user = m;
    m->backend = &hl_backend_packemu;
    enum hl_result r = hl_device_open(&m->device, m->backend, &d);
    if (r == HL_OK) {
        m->caps = *hl_device_caps(m->device);
        return HLC_DONE;
    }
    return hlc_fail(HLC_NO_DEVICE, "device: %s",
                    m->complaint[0] ? m->complaint : hl_result_name(r));
}

void hlc_machine_close(struct hlc_machine *m)
{
    hl_device_close(&m->device);
}

/* ---- hashes: FNV-1a ------------------------------------------------------ */

static uint64_t hash_byte(uint64_t h, unsigned byte)
{
    return (h ^ byte) * 0x100000001b3u;
}

/* As the bytes of a little-endian machine, on any. */
static uint64_t hash_picture(const struct hlh_picture *p)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < (size_t)p->width * p->height * 3; i++) {
        uint32_t u;
        memcpy(&u, &p->rgb[i], sizeof u);
        for (int k = 0; k < 32; k += 8)
            h = hash_byte(h, u >> k & 255u);
    }
    return h;
}

static void print_hash(const char *what, uint32_t w, uint32_t h,
                       enum hl_format format, uint64_t hash)
{
    printf("%-8s %ux%u %-18s %08lx%08lx\n", what, w, h,
           hl_format_info(format)->name, (unsigned long)(hash >> 32),
           (unsigned long)(hash & 0xffffffffu));
}

/* Memory of every target, in the machine's own order of bytes: which is the
 * profile's and not the host's. */
static void print_targets(const struct hlc_render *r)
{
    for (uint32_t i = 0; i < r->shot.plan.n_targets; i++) {
        const struct hl_plan_target *t = &r->shot.plan.target[i];
        size_t bytes;
        const uint8_t *m = hl_packemu_memory(
            r->stage.machine.device,
            hl_renderer_target(r->shot.renderer, t->role), &bytes);
        uint64_t hash = 0xcbf29ce484222325u;
        for (size_t k = 0; m && k < bytes; k++)
            hash = hash_byte(hash, m[k]);
        print_hash(hlc_role_name(t->role), t->width, t->height, t->format,
                   hash);
    }
}

/* ---- options ------------------------------------------------------------- */

struct job {
    struct hlc_options o;
    bool targets, quick;
    const char *only, *mutant;   /* of conform                               */
};

static const char usage[] =
    "halflight-packemu SCENE [options]     draw a built-in scene\n"
    "  --profile native|dx10|xbox360|ps3   console whose memory is kept\n"
    "  --pipeline auto|forward|forward-multipass|inferred\n"
    "  --size WxH          pixels; default 1280x720\n"
    "  --light-size WxH    of the light buffer; default 5/8 of the size\n"
    "  --samples 1|2|4|8   a pixel; default 1\n"
    "  --shadows none|volumes|maps\n"
    "  --translucency auto|forward|2x2|4x4\n"
    "  --threads N         default 0: one a processor\n"
    "  --frames N          timed frames\n"
    "  --hdr F.pfm         linear picture\n"
    "  --out F.ppm         8-bit sRGB picture\n"
    "  --targets           a hash of every target's memory too\n"
    "halflight-packemu conform [options]   the conformance suite, as TAP\n"
    "  --profile, --threads as above\n"
    "  --quick             fewer random cases\n"
    "  --only NAMES        checks whose names begin with it\n"
    "  --mutant NAME       with a defect that must be caught\n"
    "scenes:";

static int help(void)
{
    const char *name;
    printf("%s", usage);
    for (uint32_t i = 0; (name = hlh_scene_builtin_name(i, NULL)); i++)
        printf(" %s", name);
    printf("\n");
    return HLC_DONE;
}

static bool take_count(uint32_t *out, const char *value, uint32_t high)
{
    return hlc_read_count(out, value) && *out <= high;
}

static bool take_size(uint32_t *w, uint32_t *h, const char *value)
{
    return hlc_read_size(w, h, value) && *w && *h && *w <= HLC_SIZE_MAX &&
           *h <= HLC_SIZE_MAX;
}

static bool take_word(struct hlc_options *o, const char *name,
                      const char *value)
{
    int i;
    if (!strcmp(name, "pipeline")) {
        i = hlc_read_word(value, "auto|forward|forward-multipass|inferred");
        o->pipeline = (enum hl_pipeline)(i < 0 ? 0 : i);
        return i >= 0;
    }
    if (!strcmp(name, "shadows")) {
        i = hlc_read_word(value, "none|volumes|maps");
        o->shadows = (enum hl_shadows)(i < 0 ? 0 : i);
        return i >= 0;
    }
    if (!strcmp(name, "translucency")) {
        i = hlc_read_word(value, "auto|forward|2x2|4x4");
        o->translucency = (enum hl_translucency)(i < 0 ? 0 : i);
        return i >= 0;
    }
    i = hlc_read_word(value, "1|2|4|8");
    o->samples = 1u << (i < 0 ? 0 : i);
    return i >= 0;
}

/* False: no such option, or not its value. */
static bool take(struct job *j, const char *name, const char *value)
{
    struct hlc_options *o = &j->o;
    if (!strcmp(name, "only"))
        return (j->only = value)[0];
    if (!strcmp(name, "mutant"))
        return (j->mutant = value)[0];
    if (!strcmp(name, "profile"))
        return hl_profile_find(o->profile = value) != NULL;
    if (!strcmp(name, "pipeline") || !strcmp(name, "samples") ||
        !strcmp(name, "shadows") || !strcmp(name, "translucency"))
        return take_word(o, name, value);
    if (!strcmp(name, "size"))
        return take_size(&o->width, &o->height, value);
    if (!strcmp(name, "light-size"))
        return take_size(&o->light_width, &o->light_height, value);
    if (!strcmp(name, "threads"))
        return take_count(&o->threads, value, 1024);
    if (!strcmp(name, "frames"))
        return take_count(&o->frames, value, HLC_FRAMES_MAX);
    if (!strcmp(name, "hdr"))
        return (o->hdr = value)[0];
    return !strcmp(name, "out") && (o->out = value)[0];
}

static int parse(struct job *j, int argc, char **argv)
{
    memset(j, 0, sizeof *j);
    j->o.arg[0] = argv[1];
    j->o.width = 1280;
    j->o.height = 720;
    j->o.samples = 1;
    j->o.warmup = 1;
    for (int i = 2; i < argc; i++) {
        bool *flag = !strcmp(argv[i], "--targets") ? &j->targets
                     : !strcmp(argv[i], "--quick") ? &j->quick : NULL;
        if (flag) {
            *flag = true;
            continue;
        }
        if (strncmp(argv[i], "--", 2) || i + 1 == argc ||
            !take(j, argv[i] + 2, argv[i + 1]))
            return hlc_fail(HLC_BAD, "%s %s: no such option or value; see "
                            "'halflight-packemu help'", argv[i],
                            i + 1 < argc ? argv[i + 1] : "");
        i++;
    }
    return HLC_DONE;
}

/* ---- pictures ------------------------------------------------------------ */

/* Written so that a NaN becomes 0. */
static char srgb(float linear)
{
    double x = (double)linear, v = 255;
    if (!(x > 0))
        v = 0;
    else if (x <= 0.0031308)
        v = 255 * 12.92 * x;
    else if (x < 1)
        v = 255 * (1.055 * pow(x, 1 / 2.4) - 0.055);
    return (char)(unsigned char)floor(v + 0.5);
}

static bool write_ppm(const struct hlh_picture *p, const char *path,
                      struct hlh_error *error)
{
    struct hlh_buffer b = { NULL, 0, 0, false };
    hlh_buffer_print(&b, "P6\n%u %u\n255\n", (unsigned)p->width,
                     (unsigned)p->height);
    for (size_t i = 0; i < (size_t)p->width * p->height * 3; i++) {
        char c = srgb(p->rgb[i]);
        hlh_buffer_add(&b, &c, 1);
    }
    bool ok = b.failed ? hlh_fail(error, path, "out of memory")
                       : hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}

/* ---- the program --------------------------------------------------------- */

static void print_drawn(const struct hlc_render *r, bool targets)
{
    const struct hl_plan *p = &r->shot.plan;
    uint32_t lights = r->stage.scene.n_lights;
    printf("%s, %s, %s, %u light%s\n", r->stage.scene.name,
           r->o->profile ? r->o->profile : "native",
           hlc_pipeline_name(p->pipeline), lights, lights == 1 ? "" : "s");
    if (targets)
        print_targets(r);
    if (r->frame_ms.n)
        printf("%.1f ms a frame\n", r->frame_ms.median);
    print_hash("frame", r->picture.width, r->picture.height,
               p->n_targets ? hl_plan_target(p, HL_ROLE_COLOR)->format
                            : HL_FORMAT_NONE,
               hash_picture(&r->picture));
}

static int draw(struct hlc_render *r, const struct job *j)
{
    struct hlh_error error;
    r->o = &j->o;
    if (!hlh_scene_builtin(&r->stage.scene, j->o.arg[0], &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    int code = hlc_render_device(r);
    if (code != HLC_DONE)
        return code;
    if ((j->o.hdr && !hlh_picture_write_pfm(&r->picture, j->o.hdr, &error)) ||
        (j->o.out && !write_ppm(&r->picture, j->o.out, &error)))
        return hlc_fail(HLC_BAD, "%s", error.text);
    print_drawn(r, j->targets);
    return HLC_DONE;
}

static int draw_scene(const struct job *j)
{
    struct hlc_render *r = calloc(1, sizeof *r);
    if (!r)
        return hlc_fail(HLC_BAD, "out of memory");
    int code = draw(r, j);
    hlc_render_device_free(r);
    hlh_picture_free(&r->picture);
    free(r);
    return code;
}

static int conform(const struct job *j)
{
    const struct hl_packemu_native native = { j->o.threads };
    const struct hl_device_desc device = describe(&native, &j->o);
    struct hl_conform_desc d;
    memset(&d, 0, sizeof d);
    d.backend = &hl_backend_packemu;
    d.device = &device;
    d.mutant = j->mutant;
    d.quick = j->quick;
    d.only = j->only;
    d.memory = hl_packemu_memory;
    return hlc_tap_run(&d, stdout);
}

int main(int argc, char **argv)
{
    struct job j;
    if (argc < 2 || !strcmp(argv[1], "help") || !strcmp(argv[1], "--help"))
        return help();
    int code = parse(&j, argc, argv);
    if (code != HLC_DONE)
        return code;
    code = strcmp(argv[1], "conform") ? draw_scene(&j) : conform(&j);
    /* A full disk behind stdout shows only here. */
    if (fflush(stdout) != 0 && !code)
        code = hlc_fail(HLC_BAD, "stdout: cannot be written");
    return code;
}
