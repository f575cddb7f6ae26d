/* SPDX-License-Identifier: Zlib */
/* The conformance suite itself: it passes on every backend under every
 * profile, each defect put in fails its own checks and no other, and a run
 * that leaves a required check out fails. */
#include <stdio.h>
#include <string.h>
#include "platforms/conform/conform.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

/* ---- a run --------------------------------------------------------------- */

struct run {
    struct hl_conform_desc d;
    struct hl_device_desc device;
    struct hl_conform_counts counts;
    const struct hl_conform_mutant *mutant;
    uint32_t caught, missed, beside; /* of the mutant                        */
    uint64_t hash;               /* of all names and worst errors            */
    char first[192];             /* the first that failed, and why           */
    char skipped[96];            /* the first that was skipped               */
};

static void look(void *user, const struct hl_conform_result *r)
{
    struct run *run = user;
    bool failed = r->status == HL_CONFORM_FAIL;
    uint32_t words[2];
    assert_true(r->name[0] && r->why && r->unit && r->where && r->note);
    if (r->status == HL_CONFORM_SKIP && !run->skipped[0])
        snprintf(run->skipped, sizeof run->skipped, "%s", r->name);
    if (failed && !run->first[0])
        snprintf(run->first, sizeof run->first, "%s: %g of %g: %s", r->name,
                 r->worst, r->limit, r->why);
    memcpy(words, &r->worst, sizeof words);
    run->hash = mk_hash(run->hash, words, 2);
    if (!run->mutant || r->status == HL_CONFORM_SKIP)
        return;
    bool named = hl_conform_mutant_fails(run->mutant, r->name);
    run->caught += failed && named;
    run->missed += !failed && named;
    run->beside += failed && !named;
    if (failed && !named)
        print_error("%s: %s fails too\n", run->mutant->name, r->name);
    if (!failed && named && run->caught)
        print_error("%s: %s does not fail\n", run->mutant->name, r->name);
}

static void prepare(struct run *run, struct ck_machine *m,
                    const struct hl_backend *backend, const char *profile)
{
    memset(run, 0, sizeof *run);
    run->device = ck_desc(m);
    run->device.profile = profile ? hl_profile_find(profile) : NULL;
    run->d.backend = backend;
    run->d.device = &run->device;
    run->d.result = look;
    run->d.user = run;
    run->d.quick = true;
    run->hash = 0xcbf29ce484222325u;
    if (!strcmp(backend->name, "packemu"))
        run->d.memory = hl_packemu_memory;
}

static void go(struct run *run)
{
    assert_int_equal(hl_conform_run(&run->d, &run->counts), HL_OK);
}

/* ---- everything passes --------------------------------------------------- */

/* All random cases where the profile has memory of its own. */
static void passes(struct ck_machine *m, const char *profile)
{
    struct run run;
    bool console = !strcmp(m->backend->name, "packemu");
    prepare(&run, m, m->backend, profile);
    run.d.quick = !console && strcmp(profile, "native");
    go(&run);
    print_message("%s, %s: %u passed, %u skipped, %llu cases\n",
                  m->backend->name, profile, run.counts.passed,
                  run.counts.skipped, (unsigned long long)run.counts.cases);
    if (run.counts.failed)
        fail_msg("%u failed: %s", run.counts.failed, run.first);
    assert_true(run.counts.passed > 100);
}

static void native_passes(void **state)
{
    passes(ck_machine(state), "native");
}
static void dx10_passes(void **state)
{
    passes(ck_machine(state), "dx10");
}
static void xbox360_passes(void **state)
{
    passes(ck_machine(state), "xbox360");
}
static void ps3_passes(void **state)
{
    passes(ck_machine(state), "ps3");
}

/* Another seed gives other cases, the same seed the same. */
static void seeds_are_kept(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct run run[3];
    for (int i = 0; i < 3; i++) {
        prepare(&run[i], m, m->backend, "native");
        run[i].d.seed = i == 2 ? 7 : 3;
        run[i].d.only = "normal.rg16_snorm";
        go(&run[i]);
        assert_int_equal(run[i].counts.failed, 0);
    }
    assert_true(run[0].hash == run[1].hash);
    assert_true(run[0].hash != run[2].hash);
}

/* ---- mutants ------------------------------------------------------------- */

/* Every mutant under `profile`; adds to caught[] by mutant. */
static void run_mutants(struct ck_machine *m, const char *profile,
                        uint32_t *caught)
{
    const struct hl_conform_mutant *mutant;
    for (uint32_t i = 0; (mutant = hl_conform_mutant(i)); i++) {
        struct run run;
        prepare(&run, m, m->backend, profile);
        run.mutant = mutant;
        run.d.mutant = mutant->name;
        go(&run);
        caught[i] += run.caught;
        /* Where the mutant has nothing to act on, nothing fails: then its
         * checks pass, but for those that are not the profile's. */
        if (run.beside || (run.caught && run.missed))
            fail_msg("%s, %s: %s: %u caught, %u missed, %u beside",
                     m->backend->name, profile, mutant->name, run.caught,
                     run.missed, run.beside);
    }
}

enum { MUTANTS = 7 };

static void mutants_are_caught_by_drivers(void **state)
{
    struct ck_machine *m = ck_machine(state);
    uint32_t caught[MUTANTS] = { 0 };
    run_mutants(m, "xbox360", caught);
    for (uint32_t i = 0; i < MUTANTS; i++) {
        const char *name = hl_conform_mutant(i)->name;
        /* The console's own fixed point, which drivers do not have. */
        bool here = strcmp(name, "missing_x32") &&
                    strcmp(name, "wrong_exp_bias");
        if ((caught[i] > 0) != here)
            fail_msg("%s: caught %u times", name, caught[i]);
    }
}

static void mutants_are_caught_by_packemu(void **state)
{
    struct ck_machine *m = ck_machine(state);
    uint32_t caught[MUTANTS] = { 0 };
    assert_null(hl_conform_mutant(MUTANTS));
    run_mutants(m, "native", caught);
    run_mutants(m, "xbox360", caught);
    run_mutants(m, "ps3", caught);
    for (int i = 0; i < MUTANTS; i++)
        if (!caught[i])
            fail_msg("%s is not caught", hl_conform_mutant(
                     (uint32_t)i)->name);
}

static void mutant_names_end_where_they_end(void **state)
{
    struct hl_conform_mutant m = { "m", "", "a.b c.d* e" };
    (void)state;
    assert_true(hl_conform_mutant_fails(&m, "a.b"));
    assert_false(hl_conform_mutant_fails(&m, "a.bc"));
    assert_false(hl_conform_mutant_fails(&m, "a."));
    assert_true(hl_conform_mutant_fails(&m, "c.d"));
    assert_true(hl_conform_mutant_fails(&m, "c.dx.y"));
    assert_false(hl_conform_mutant_fails(&m, "c"));
    assert_true(hl_conform_mutant_fails(&m, "e"));
    m.fails = "";
    assert_false(hl_conform_mutant_fails(&m, "a.b"));
}

/* ---- a run that is shorter than the list --------------------------------- */

/* A backend that is another, but for a format that it hides or a call that
 * fails. One test runs at a time. */
static const struct hl_backend *inner;
static enum hl_format hidden;

static enum hl_result open_less(void *state, struct hl_device *device,
                                const struct hl_device_desc *desc,
                                struct hl_caps *caps)
{
    enum hl_result r = inner->open(state, device, desc, caps);
    caps->format[hidden].use = 0;
    return r;
}

static enum hl_result no_pass(void *state, const struct hl_bk_pass *pass,
                              const struct hl_bk_draw *draws, uint32_t n)
{
    (void)state;
    (void)pass;
    (void)draws;
    (void)n;
    return HL_ERR_MEMORY;
}

static void a_missing_check_fails(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_backend less = *m->backend;
    struct run run;
    inner = m->backend;
    hidden = HL_FORMAT_RG16_SNORM;
    less.open = open_less;
    prepare(&run, m, &less, "native");
    go(&run);
    assert_int_equal(run.counts.failed, 1);
    assert_non_null(strstr(run.first, "conform.complete"));
    assert_string_equal(run.skipped, "normal.rg16_snorm.mean");
    /* Under another name nothing is required of it. */
    less.name = "own";
    prepare(&run, m, &less, "native");
    go(&run);
    assert_int_equal(run.counts.failed, 0);
    assert_true(run.counts.skipped > 10);
}

static void a_failing_machine_fails(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_backend bad = *m->backend;
    struct run run;
    bad.pass_run = no_pass;
    prepare(&run, m, &bad, "native");
    go(&run);
    assert_true(run.counts.failed > 190);
    assert_non_null(strstr(run.first, "out of memory"));
}

/* The list has each name once, and asks something of every column. */
static void the_list_is_whole(void **state)
{
    static const char *const backends[] = { "vulkan", "gl", "packemu" };
    (void)state;
    const char *name;
    for (uint32_t i = 0; (name = hl_conform_name(i)); i++) {
        bool somewhere = false;
        for (uint32_t k = 0; k < i; k++)
            assert_string_not_equal(name, hl_conform_name(k));
        for (int b = 0; b < 3; b++)
            for (uint32_t p = 0; hl_profile_at(p); p++) {
                char c = hl_conform_required(i, backends[b],
                                             hl_profile_at(p)->name);
                assert_true(c == 'r' || c == 's' || c == '.');
                somewhere = somewhere || c == 'r';
            }
        if (!somewhere)
            fail_msg("%s need not run anywhere", name);
        assert_int_equal(hl_conform_required(i, "own", "native"), 's');
    }
    assert_int_equal(hl_conform_required(100000, "vulkan", "native"), '.');
}

/* ---- refusals ------------------------------------------------------------ */

static void bad_descs_are_refused(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_conform_counts counts;
    struct run run;
    assert_int_equal(hl_conform_run(NULL, &counts), HL_ERR_INVALID);
    prepare(&run, m, m->backend, NULL);
    run.d.device = NULL;
    assert_int_equal(hl_conform_run(&run.d, &counts), HL_ERR_INVALID);
    prepare(&run, m, m->backend, NULL);
    run.d.backend = NULL;
    assert_int_equal(hl_conform_run(&run.d, &counts), HL_ERR_INVALID);
    prepare(&run, m, m->backend, NULL);
    run.d.mutant = "bogus";
    assert_int_equal(hl_conform_run(&run.d, &counts), HL_ERR_INVALID);
    prepare(&run, m, m->backend, NULL);
    run.device.version = 0;
    assert_int_equal(hl_conform_run(&run.d, &counts), HL_ERR_VERSION);
    prepare(&run, m, m->backend, NULL);
    run.d.result = NULL;
    run.d.only = "weights";
    assert_int_equal(hl_conform_run(&run.d, NULL), HL_OK);
}

/* Every allocation fails once: the run says so or its checks fail, and
 * nothing is left. */
static void memory_may_run_out(void **state)
{
    (void)state;
    struct ck_machine m;
    struct run run;
    size_t refused = 0;
    memset(&m, 0, sizeof m);
    for (size_t k = 1; ; k++) {
        prepare(&run, &m, hl_platform_find("null"), "native");
        run.d.only = "weights";
        run.device.max_buffers = run.device.max_textures = 16;
        run.device.max_programs = 16;
        m.memory.n_allocs = 0;
        m.memory.fail_at = k;
        enum hl_result r = hl_conform_run(&run.d, &run.counts);
        if (m.memory.n_live)
            fail_msg("allocation %zu: %zu are left", k, m.memory.n_live);
        if (m.memory.n_allocs < k)
            break;
        refused += r == HL_ERR_MEMORY;
        assert_true(r == HL_ERR_MEMORY || run.counts.failed > 0);
    }
    assert_true(refused > 10);
}

#define EACH(name) CK_ON("vulkan", name), CK_ON("gl", name), \
                   CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(native_passes),
        EACH(dx10_passes),
        EACH(xbox360_passes),
        EACH(ps3_passes),
        EACH(seeds_are_kept),
        CK_ON("vulkan", mutants_are_caught_by_drivers),
        CK_ON("gl", mutants_are_caught_by_drivers),
        CK_ON("packemu", mutants_are_caught_by_packemu),
        cmocka_unit_test(mutant_names_end_where_they_end),
        EACH(a_missing_check_fails),
        EACH(a_failing_machine_fails),
        EACH(bad_descs_are_refused),
        cmocka_unit_test(the_list_is_whole),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests_name("conformance suite", tests, NULL,
                                       NULL);
}
