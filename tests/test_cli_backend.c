/* SPDX-License-Identifier: Zlib */
/* The tool on backends that draw: which one is taken where no driver is, what
 * render and plan say of each machine by each console's rules, and the
 * software device's own frames. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "tests/cli_kit.h"

#define PACKEMU "render thin --backend packemu --size 64x36 "

static const char *const backends[] = { "vulkan", "gl", "packemu" };
static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };
enum { BACKENDS = 3, PROFILES = 4 };

/* ---- a machine without drivers ------------------------------------------ */

/* The loader is sent where no Vulkan driver is. GL's libraries are loaded by
 * name, and the first found is the run's own directory's, which is none: a
 * file of no bytes, whatever this machine has elsewhere. */
static void hide_drivers(void **state)
{
    static const char *const files[] = { "libOSMesa.so.8", "libOSMesa.so.6",
                                         "libOSMesa.so", "libEGL.so.1" };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        sk_write(state, files[i], "", 0);
    setenv("VK_ICD_FILENAMES", "/nothing", 1);
    setenv("VK_DRIVER_FILES", "/nothing", 1);
    setenv("LD_LIBRARY_PATH", ".", 1);
}

/* What hide_drivers sets, as it was. */
static char *before[3];
static const char *const hidden[3] = { "VK_ICD_FILENAMES", "VK_DRIVER_FILES",
                                       "LD_LIBRARY_PATH" };

static int keep_drivers(void **state)
{
    for (int i = 0; i < 3; i++) {
        const char *v = getenv(hidden[i]);
        before[i] = v ? malloc(strlen(v) + 1) : NULL;
        if (before[i])
            strcpy(before[i], v);
    }
    return sk_setup(state);
}

static int show_drivers(void **state)
{
    for (int i = 0; i < 3; i++) {
        if (before[i])
            setenv(hidden[i], before[i], 1);
        else
            unsetenv(hidden[i]);
        free(before[i]);
    }
    return sk_teardown(state);
}

static void packemu_is_there_without_drivers(void **state)
{
    static const char *const lines[] = {
        "plan thin --json -", "render thin --size 16x9 --json -",
        "conform --quick --only weights.sum --json -",
    };
    static const struct tool_line rows[] = {
        { "render thin --backend vulkan --out x.png", "--backend vulkan: " },
        { "render thin --backend gl --out x.png", "--backend gl: " },
        { "plan thin --backend gl --gl-context egl", "--backend gl: " },
        { "plan thin --gl-context osmesa --backend gl", "--backend gl: " },
        { "devices --backend gl", "--backend gl: " },
        { "conform --backend gl", "--backend gl: " },
        { "render thin --device llvmpipe", "--device llvmpipe: " },
    };
    static struct tool_run r;
    hide_drivers(state);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        tool_done(&r, state, lines[i]);
        cJSON *j = tool_json(r.out);
        assert_string_equal(tool_text(j, "backend"), "packemu");
        cJSON_Delete(j);
    }
    TOOL_REFUSE(rows, 3);
    tool_done(&r, state, "devices");
    sk_assert_contains(r.out, "vulkan: no such backend or device");
    sk_assert_contains(r.out, "gl: no such backend or device");
    sk_assert_contains(r.out, "0 packemu (cpu), halflight packemu");
}

/* ---- one line for every machine ----------------------------------------- */

/* Skip a backend that this machine lacks; packemu is everywhere. */
static bool has(void **state, const char *backend)
{
    static struct tool_run r;
    char line[64];
    snprintf(line, sizeof line, "devices --backend %s", backend);
    tool_run(&r, state, line);
    if (r.code == 0)
        return true;
    assert_int_equal(r.code, 3);
    assert_true(strcmp(backend, "packemu") != 0);
    print_message("no %s device here\n", backend);
    return false;
}

static const cJSON *target(const cJSON *j, const char *role)
{
    const cJSON *t;
    cJSON_ArrayForEach(t, tool_at(j, "plan.targets"))
        if (!strcmp(tool_text(t, "role"), role))
            return t;
    fail_msg("no target %s", role);
    return NULL;
}

/* Formats of a console's own are its memory's; others stand in for them. */
static void expect_formats(const cJSON *j, const char *backend,
                           const char *profile)
{
    bool memory = !strcmp(backend, "packemu");
    const char *dsf = tool_text(target(j, "dsf"), "format");
    const char *want = strcmp(profile, "xbox360") == 0
                       ? memory ? "RG16_FIXED32" : "RG16_SNORM"
                       : strcmp(profile, "ps3") == 0 ? "RGBA8_UNORM"
                       : "RG16_UNORM";
    if (strcmp(dsf, want))
        fail_msg("%s as %s: dsf is %s, not %s", backend, profile, dsf, want);
    bool edram = !strcmp(profile, "xbox360");
    assert_int_equal(tool_number(target(j, "light"), "edram_tiles") > 0,
                     edram);
}

static void profiles_are_planned_on_all(void **state)
{
    static struct tool_run r;
    for (int i = 0; i < BACKENDS; i++)
        for (int k = 0; k < PROFILES && has(state, backends[i]); k++) {
            char line[256];
            snprintf(line, sizeof line, "render thin --size 64x36 --pipeline "
                     "inferred --backend %s --profile %s --json -",
                     backends[i], profiles[k]);
            tool_done(&r, state, line);
            cJSON *j = tool_json(r.out);
            assert_string_equal(tool_text(j, "backend"), backends[i]);
            assert_string_equal(tool_text(j, "profile"), profiles[k]);
            assert_string_equal(tool_text(j, "plan.profile"), profiles[k]);
            assert_true(tool_number(j, "non_finite_pixels") == 0);
            assert_true(tool_number(j, "counts.light_evaluations") > 0);
            expect_formats(j, backends[i], profiles[k]);
            cJSON_Delete(j);
        }
}

/* Rounding may move two pixels at silhouettes by a third of the peak: 10 lg
 * (64 36 9 / 2) = 40 dB. */
static void forward_is_the_reference_on_all(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, "render fig8 --pipeline reference --size 64x36 "
                         "--hdr r.pfm");
    for (int i = 0; i < BACKENDS; i++) {
        char line[256];
        if (!has(state, backends[i]))
            continue;
        snprintf(line, sizeof line, "render fig8 --pipeline forward --size "
                 "64x36 --backend %s --hdr %s.pfm", backends[i], backends[i]);
        tool_done(&r, state, line);
        snprintf(line, sizeof line, "compare %s.pfm r.pfm --min-psnr 40",
                 backends[i]);
        tool_done(&r, state, line);
    }
}

/* ---- the software device ------------------------------------------------ */

static void packemu_describes_itself(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, "devices --backend packemu --json -");
    cJSON *j = tool_json(r.out);
    assert_int_equal(cJSON_GetArraySize(tool_at(j, "profiles")), PROFILES);
    const cJSON *b = cJSON_GetArrayItem(tool_at(j, "backends"), 0);
    assert_string_equal(tool_text(b, "name"), "packemu");
    assert_int_equal(cJSON_GetArraySize(tool_at(b, "devices")), 1);
    const cJSON *d = cJSON_GetArrayItem(tool_at(b, "devices"), 0);
    assert_string_equal(tool_text(d, "kind"), "cpu");
    assert_string_equal(tool_text(d, "driver"), "halflight packemu");
    assert_true(tool_number(d, "caps.max_tex_dim") == 16384);
    assert_true(tool_number(d, "caps.cost_ns.light") > 0);
    cJSON_Delete(j);
    tool_done(&r, state, "plan thin --backend packemu --device 0");
    tool_done(&r, state, "plan thin --backend packemu --device ckEMU");
    tool_refused(state, "plan thin --backend packemu --device 1", 3,
                 "no packemu device is called 1");
    tool_refused(state, "plan thin --backend packemu --device packemus", 3,
                 "--device packemus: ");
}

static void packemu_writes_what_is_asked(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, PACKEMU "--pipeline inferred --frames 3 --out o.png "
              "--hdr o.pfm --ids i.png --json o.json --validation");
    assert_int_equal(sk_count(state), 4);
    tool_done(&r, state, "compare o.png o.pfm --ids i.png --min-psnr 30");
    tool_done(&r, state, PACKEMU "--pipeline inferred --frames 3 "
              "--validation --json -");
    cJSON *j = tool_json(r.out);
    sk_assert_contains(tool_text(j, "driver"), "halflight packemu");
    assert_string_equal(tool_text(j, "device"), "packemu");
    assert_true(tool_number(j, "frame_ms.n") == 3);
    assert_true(tool_number(j, "frame_ms.median") > 0);
    assert_true(tool_number(j, "plan.cost_ms") > 0);
    assert_int_equal(cJSON_GetArraySize(tool_at(j, "passes")), 3);
    assert_int_equal(cJSON_GetArraySize(tool_at(j, "dsf.taps_rejected")), 5);
    assert_true(tool_number(j, "validation_errors") == 0);
    cJSON_Delete(j);
}

static void same_file(void **state, const char *a, const char *b, bool same)
{
    struct hlh_error error;
    char path[SK_PATH], *p, *q;
    size_t n, m;
    sk_path(path, state, a);
    assert_true(hlh_file_read(&p, &n, path, &error));
    sk_path(path, state, b);
    assert_true(hlh_file_read(&q, &m, path, &error));
    if ((n == m && memcmp(p, q, n) == 0) != same)
        fail_msg("%s and %s are %s", a, b, same ? "unlike" : "alike");
    free(p);
    free(q);
}

/* Whole pixel centres put at halves by the state or by the vertices are one
 * picture; left where they are they are another. */
static void half_pixels_are_shifted_once(void **state)
{
    static const char *const modes[] = { "auto", "state", "vertex", "none" };
    static struct tool_run r;
    for (int i = 0; i < 4; i++) {
        char line[256], file[16];
        snprintf(file, sizeof file, "%s.pfm", modes[i]);
        snprintf(line, sizeof line, PACKEMU "--profile xbox360 --half-pixel "
                 "%s --hdr %s", modes[i], file);
        tool_done(&r, state, line);
        same_file(state, "auto.pfm", file, i < 3);
    }
    tool_refused(state, PACKEMU "--profile ps3 --half-pixel vertex", 2,
                 "pixel centres are at halves here");
    tool_refused(state, PACKEMU "--profile dx10 --half-pixel state", 2,
                 "pixel centres are at halves here");
}

/* No bit depends on which thread came first. */
static void packemu_frames_are_the_same_twice(void **state)
{
    static struct tool_run r;
    for (int i = 0; i < PROFILES; i++) {
        char line[256];
        for (int k = 0; k < 2; k++) {
            snprintf(line, sizeof line, PACKEMU "--profile %s --hdr %d.pfm",
                     profiles[i], k);
            tool_done(&r, state, line);
        }
        same_file(state, "0.pfm", "1.pfm", true);
    }
}

#define IN_DIRECTORY(name) \
    cmocka_unit_test_setup_teardown(name, sk_setup, sk_teardown)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(packemu_is_there_without_drivers,
                                        keep_drivers, show_drivers),
        IN_DIRECTORY(profiles_are_planned_on_all),
        IN_DIRECTORY(forward_is_the_reference_on_all),
        IN_DIRECTORY(packemu_describes_itself),
        IN_DIRECTORY(packemu_writes_what_is_asked),
        IN_DIRECTORY(half_pixels_are_shifted_once),
        IN_DIRECTORY(packemu_frames_are_the_same_twice),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("cli backends", tests, NULL, NULL);
}
