/* SPDX-License-Identifier: Zlib */
/* The run: groups in order, results with their verdicts, and the list of
 * what had to run. */
#include <string.h>
#include "hal/backend.h"
#include "hal/text.h"
#include "platforms/conform/cf.h"

/* ---- what is required --------------------------------------------------- */

/* Twelve columns: vulkan, gl and packemu, each native, dx10, xbox360, ps3. */
static const struct { const char *name, *where; } required[] = {
#define HL_REQUIRED(name, where) { name, where },
#include "platforms/conform/required.def"
#undef HL_REQUIRED
};
enum { N_REQUIRED = sizeof required / sizeof required[0] };

static const char *const backends[] = { "vulkan", "gl", "packemu" };
static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

const char *hl_conform_name(uint32_t i)
{
    return i < N_REQUIRED ? required[i].name : NULL;
}

static int column(const char *backend, const char *profile)
{
    for (int b = 0; b < 3; b++)
        for (int p = 0; p < 4; p++)
            if (!strcmp(backend, backends[b]) && !strcmp(profile, profiles[p]))
                return b * 5 + p;
    return -1;
}

char hl_conform_required(uint32_t i, const char *backend, const char *profile)
{
    if (i >= N_REQUIRED)
        return '.';
    int c = column(backend, profile);
    if (c >= 0)
        return required[i].where[c];
    return strchr(required[i].where, 'r') ? 's' : '.';
}

static int find(const char *name)
{
    for (int i = 0; i < N_REQUIRED; i++)
        if (!strcmp(required[i].name, name))
            return i;
    return -1;
}

/* ---- mutants ------------------------------------------------------------ */

static const struct hl_conform_mutant mutants[] = {
#define HL_MUTANT(name, what, fails) { name, what, fails },
#include "platforms/conform/mutants.def"
#undef HL_MUTANT
};
enum { N_MUTANTS = sizeof mutants / sizeof mutants[0] };

const struct hl_conform_mutant *hl_conform_mutant(uint32_t i)
{
    return i < N_MUTANTS ? &mutants[i] : NULL;
}

/* A pattern ends at a blank or the end. */
static bool matches(const char *pattern, const char *name)
{
    while (*pattern && *pattern != ' ' && *pattern != '*') {
        if (*pattern != *name)
            return false;
        pattern++;
        name++;
    }
    return *pattern == '*' || !*name;
}

bool hl_conform_mutant_fails(const struct hl_conform_mutant *m,
                             const char *name)
{
    for (const char *p = m->fails; p && *p;) {
        if (matches(p, name))
            return true;
        p = strchr(p, ' ');
        p = p ? p + 1 : NULL;
    }
    return false;
}

/* ---- results ------------------------------------------------------------ */

void cf_join(char *out, size_t bytes, const char *a, const char *b,
             const char *c, const char *d)
{
    const char *part[4] = { a, b, c, d };
    struct hl_text t = hl_text_begin(out, bytes);
    for (int i = 0; i < 4; i++)
        if (part[i])
            hl_text_str(&t, part[i]);
}

struct hl_conform_result cf_result(enum hl_conform_level level,
                                   const char *unit, double limit,
                                   const char *why)
{
    struct hl_conform_result r;
    memset(&r, 0, sizeof r);
    r.level = level;
    r.unit = unit;
    r.limit = limit;
    r.why = why;
    r.table = (double)NAN;
    r.where = "";
    r.note = "";
    return r;
}

void cf_case(struct hl_conform_result *r, double error)
{
    r->cases++;
    if (error > r->worst || error != error)
        r->worst = error;
}

void cf_case_at(struct hl_conform_result *r, double error, double x, double y)
{
    bool worse = error > r->worst || error != error || r->cases == 0;
    cf_case(r, error);
    if (worse && r->worst == r->worst) {
        r->at[0] = x;
        r->at[1] = y;
    }
}

static bool wanted(const struct cf *cf, const char *name)
{
    const char *only = cf->desc->only;
    return !only || !strncmp(name, only, strlen(only));
}

static void publish(struct cf *cf, const struct hl_conform_result *r)
{
    struct hl_conform_counts *c = &cf->counts;
    c->passed += r->status == HL_CONFORM_PASS;
    c->failed += r->status == HL_CONFORM_FAIL;
    c->skipped += r->status == HL_CONFORM_SKIP;
    c->cases += r->cases;
    if (cf->desc->result)
        cf->desc->result(cf->desc->user, r);
}

/* A name twice, or one that is not in the list, is a failure of the suite. */
static void settle(struct cf *cf, struct hl_conform_result *r)
{
    int i = find(r->name);
    if (!wanted(cf, r->name))
        return;
    if (i < 0 || cf->seen[i]) {
        r->status = HL_CONFORM_FAIL;
        r->why = i < 0 ? "not in required.def" : "reported twice";
    } else {
        cf->seen[i] = (uint8_t)(1 + (r->status == HL_CONFORM_SKIP));
        if (r->status == HL_CONFORM_SKIP && cf->listed &&
            hl_conform_required((uint32_t)i, cf->desc->backend->name,
                                cf->profile_name) == '.')
            return;
    }
    publish(cf, r);
}

void cf_report(struct cf *cf, const struct cf_group *g, const char *last,
               struct hl_conform_result *r)
{
    char name[96];
    cf_join(name, sizeof name, g->prefix, ".", last, NULL);
    r->name = name;
    if (cf->broken) {
        r->status = HL_CONFORM_FAIL;
        r->why = cf->complaint;
    } else if (r->status != HL_CONFORM_SKIP) {
        r->status = r->cases > 0 && r->worst <= r->limit
                    ? HL_CONFORM_PASS : HL_CONFORM_FAIL;
    }
    settle(cf, r);
}

/* The names of a group that its function did not come to. */
static void rest(struct cf *cf, const struct cf_group *g, const char *why)
{
    size_t n = strlen(g->prefix);
    for (int i = 0; i < N_REQUIRED; i++) {
        const char *name = required[i].name;
        struct hl_conform_result r = cf_result(HL_CONFORM_EXACT, "", 0, why);
        if (cf->seen[i] || strncmp(name, g->prefix, n) || name[n] != '.' ||
            strchr(name + n + 1, '.'))
            continue;
        r.name = name;
        r.status = cf->broken || !why ? HL_CONFORM_FAIL : HL_CONFORM_SKIP;
        if (cf->broken)
            r.why = cf->complaint;
        else if (!why)
            r.why = "was not reported";
        settle(cf, &r);
    }
}

static bool group_wanted(const struct cf *cf, const struct cf_group *g)
{
    const char *only = cf->desc->only;
    size_t n = strlen(g->prefix);
    return !only || !strncmp(g->prefix, only, strlen(only)) ||
           (!strncmp(g->prefix, only, n) && only[n] == '.');
}

/* Names that had to run and did not. */
static void complete(struct cf *cf)
{
    static const struct cf_group own = { "conform", NULL, 0 };
    struct hl_conform_result r =
        cf_result(HL_CONFORM_EXACT, "checks", 0,
                  "every check that required.def asks for here runs");
    char missing[192] = "";
    if (cf->desc->only)
        return;
    for (int i = 0; i < N_REQUIRED; i++) {
        char need = hl_conform_required((uint32_t)i, cf->desc->backend->name,
                                        cf->profile_name);
        if (!strcmp(required[i].name, "conform.complete") || need == '.')
            continue;
        bool ran = cf->seen[i] == 1 || (need == 's' && cf->seen[i]);
        r.cases++;
        r.worst += ran ? 0 : 1;
        if (!ran && !missing[0])
            cf_join(missing, sizeof missing, "did not run: ",
                    required[i].name, NULL, NULL);
    }
    r.note = missing;
    cf->broken = false;
    cf_report(cf, &own, "complete", &r);
}

static enum cf_mutant mutant_of(const char *name, bool *found)
{
    static const char *const names[] = {
        NULL, "base255", "swapped_bytes", "missing_x32", "half_pixel",
        "wrong_exp_bias", "blend_63_255", "id_65535_on_xbox" };
    *found = true;
    for (int i = 1; name && i < (int)(sizeof names / sizeof names[0]); i++)
        if (!strcmp(name, names[i]))
            return (enum cf_mutant)i;
    *found = !name;
    return CF_MUTANT_NONE;
}

enum hl_result hl_conform_run(const struct hl_conform_desc *desc,
                              struct hl_conform_counts *out)
{
    struct cf cf;
    bool found;
    memset(&cf, 0, sizeof cf);
    if (out)
        *out = cf.counts;
    if (!desc || !desc->backend || !desc->device ||
        !desc->device->hooks.alloc || !desc->device->hooks.free)
        return HL_ERR_INVALID;
    cf.desc = desc;
    cf.mutant = mutant_of(desc->mutant, &found);
    if (!found)
        return HL_ERR_INVALID;
    enum hl_result r = HL_OK;
    if (!cf_open(&cf)) {
        cf_close(&cf);
        return cf.result;
    }
    cf.listed = column(desc->backend->name, cf.profile_name) >= 0;
    for (const struct cf_group *g = cf_groups; g->prefix; g++) {
        if (!group_wanted(&cf, g))
            continue;
        /* Each group has random numbers of its own, so that a check alone
         * is the check in the whole run. */
        cf.seed = (desc->seed ? desc->seed : 1) * 0x10001u +
                  (uint64_t)(g - cf_groups);
        cf.broken = false;
        cf.complaint[0] = 0;
        const char *why = g->run(&cf, g);
        rest(&cf, g, why);
    }
    complete(&cf);
    if (out)
        *out = cf.counts;
    cf_close(&cf);
    return r;
}
