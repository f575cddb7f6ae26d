/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/tap.h"
#include <string.h>
#include "platforms/cli/commands.h"

struct tap { FILE *out; uint32_t n; const struct hl_conform_desc *desc; };

/* Where the worst case was, and what is known besides. */
static void more(FILE *out, const struct hl_conform_result *r)
{
    if (r->n_at)
        fprintf(out, "; %s:", r->where);
    for (uint32_t i = 0; i < r->n_at; i++)
        fprintf(out, " %.6g", r->at[i]);
    if (r->note && r->note[0])
        fprintf(out, "; %s", r->note);
    fprintf(out, "\n");
}

static void line(void *user, const struct hl_conform_result *r)
{
    struct tap *t = user;
    if (t->desc->result)
        t->desc->result(t->desc->user, r);
    bool failed = r->status == HL_CONFORM_FAIL;
    fprintf(t->out, "%sok %u - %s", failed ? "not " : "", ++t->n, r->name);
    if (r->status == HL_CONFORM_SKIP) {
        fprintf(t->out, " # SKIP %s\n", r->why ? r->why : "");
        return;
    }
    fprintf(t->out, " # worst %.4g%s%s of %.4g in %llu cases", r->worst,
            r->unit[0] ? " " : "", r->unit, r->limit,
            (unsigned long long)r->cases);
    more(t->out, r);
    if (failed)
        fprintf(t->out, "# %s\n", r->why);
}

int hlc_tap_run(const struct hl_conform_desc *desc, FILE *out)
{
    struct tap t = { out, 0, desc };
    struct hl_conform_desc d = *desc;
    struct hl_conform_counts counts;
    memset(&counts, 0, sizeof counts);
    d.result = line;
    d.user = &t;
    fprintf(out, "TAP version 13\n");
    enum hl_result r = hl_conform_run(&d, &counts);
    if (r != HL_OK) {
        fprintf(out, "Bail out! %s\n", hl_result_name(r));
        return hlc_fail(r == HL_ERR_INVALID ? HLC_BAD : HLC_NO_DEVICE,
                        "conform: %s", hl_result_name(r));
    }
    fprintf(out, "1..%u\n# %u passed, %u failed, %u skipped; %llu cases\n",
            t.n, counts.passed, counts.failed, counts.skipped,
            (unsigned long long)counts.cases);
    if (desc->mutant && counts.failed == 0)
        fprintf(out, "# %s spoils nothing that is used here\n",
                desc->mutant);
    return counts.failed ? HLC_FAILED : HLC_DONE;
}
