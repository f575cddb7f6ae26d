/* SPDX-License-Identifier: Zlib */
#ifndef HL_CONFORMANCE_H
#define HL_CONFORMANCE_H
/* The conformance suite, for any backend, also an embedder's own. Each check
 * draws with the built-in stages and compares with a model in double
 * precision of the format that is stored, never with another machine. What
 * must run where is required.def; a run that leaves one out fails. */
#include "hal/hal.h"

enum hl_conform_level {
    HL_CONFORM_EXACT,        /* integers, equal                              */
    HL_CONFORM_INTERVAL,     /* one of the codes next to the true value      */
    HL_CONFORM_TOLERANCE     /* within a bound that is derived               */
};
enum hl_conform_status {
    HL_CONFORM_PASS, HL_CONFORM_FAIL, HL_CONFORM_SKIP
};

/* One check. Strings are valid during the callback. */
struct hl_conform_result {
    const char *name;        /* "normal.rg16_unorm.band_90"                  */
    enum hl_conform_level level;
    enum hl_conform_status status;
    const char *unit;        /* of worst, limit and table; "" for counts     */
    double worst, limit;     /* passed: worst <= limit                       */
    double table;            /* published or derived figure beside which
                              * `worst` stands; NaN: there is none           */
    const char *why;         /* where the limit comes from; of a skip or a
                              * broken check, the reason                     */
    uint64_t cases;
    const char *where;       /* names of `at`: "theta, phi"; "" where none   */
    double at[3];            /* the worst case                               */
    uint32_t n_at;
    const char *note;        /* what was found besides, "" for nothing       */
};

struct hl_conform_desc {
    const struct hl_backend *backend;
    /* With hooks, log and profile as for hl_device_open; opened and closed
     * by the run. */
    const struct hl_device_desc *device;
    const char *mutant;      /* name of a defect to be caught; NULL: none    */
    uint64_t seed;           /* of random cases; 0 = 1                       */
    bool quick;              /* the same checks with fewer random cases      */
    const char *only;        /* names that begin with it; NULL: all          */
    /* Bytes of a texture's memory in the machine's order, where a host can
     * see them; NULL: it cannot. */
    const uint8_t *(*memory)(struct hl_device *, hl_tex, size_t *bytes);
    void (*result)(void *user, const struct hl_conform_result *);
    void *user;
};

struct hl_conform_counts {
    uint32_t passed, failed, skipped;
    uint64_t cases;
};

/* HL_OK where all checks ran, whether or not they passed. Otherwise what
 * hl_device_open gave, or HL_ERR_INVALID for a desc that cannot be run. */
enum hl_result hl_conform_run(const struct hl_conform_desc *,
                              struct hl_conform_counts *out);

/* Checks of required.def, in order: what a backend is asked for under a
 * profile. '.' not there, 'r' runs, 's' may be skipped; for a backend that
 * the list does not name, all that any runs is 's'. NULL past the last. */
const char *hl_conform_name(uint32_t i);
char hl_conform_required(uint32_t i, const char *backend,
                         const char *profile);

/* Defects that are put in on purpose, and the checks that must catch them:
 * names, apart by blanks, '*' stands for any ending. */
struct hl_conform_mutant { const char *name, *what, *fails; };
/* NULL past the last. */
const struct hl_conform_mutant *hl_conform_mutant(uint32_t i);
/* Does a name match one of a mutant's? */
bool hl_conform_mutant_fails(const struct hl_conform_mutant *,
                             const char *name);
#endif
