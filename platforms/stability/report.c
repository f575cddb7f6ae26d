/* SPDX-License-Identifier: Zlib */
/* Results as text, CSV and charts. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "platforms/cli/outputs.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"
#include "platforms/stability/parts.h"

const char *hls_verdict_name(enum hls_verdict v)
{
    static const char *const name[] = { "held", "MOVED", "BROKEN", "skipped" };
    return name[v];
}

void hls_name(char out[HLS_NAME], const struct hls_result *r)
{
    snprintf(out, HLS_NAME, "%s.%s", r->row->name, r->curve->name);
}

/* ---- text ---------------------------------------------------------------- */

const char *hls_number(char out[HLS_NUMBER], const struct hls_row *row,
                       double p)
{
    snprintf(out, HLS_NUMBER, isnan(p) ? "none" : row->grid == HLS_WHOLE
             ? "%.0f" : "%.4g", p);
    return out;
}

static void range_text(char *out, size_t size, const struct hls_row *row,
                       const struct hls_case *c)
{
    char low[HLS_NUMBER], high[HLS_NUMBER];
    hls_number(low, row, c->low);
    hls_number(high, row, c->high);
    bool two = strcmp(low, high) != 0;
    snprintf(out, size, "%s%s%s", low, two ? ".." : "", two ? high : "");
}

void hls_print_head(void)
{
    printf("%-29s %-9s %-14s %-16s %-7s %s\n", "row.case", "p*", "unit",
           "expected", "", "derived");
}

void hls_print(const struct hls_result *r)
{
    char name[HLS_NAME], at[HLS_NUMBER] = "-", range[2 * HLS_NUMBER + 2];
    hls_name(name, r);
    if (r->verdict != HLS_BROKEN && !r->skip)
        hls_number(at, r->row, r->boundary);
    range_text(range, sizeof range, r->row, r->curve);
    printf("%-29s %-9s %-14s %-16s %-7s %s\n", name, at, r->row->unit, range,
           hls_verdict_name(r->verdict),
           r->skip ? r->skip
           : r->verdict == HLS_BROKEN && r->note[0] ? r->note
                                                    : r->curve->derived);
    fflush(stdout);
}

/* ---- CSV ----------------------------------------------------------------- */

static void add_text(struct hlh_buffer *b, const char *text)
{
    hlh_buffer_add(b, "\"", 1);
    for (const char *c = text; *c; c++)
        hlh_buffer_add(b, *c == '"' ? "\"\"" : c, *c == '"' ? 2 : 1);
    hlh_buffer_add(b, "\"", 1);
}

/* An empty field is a number that is not there. */
static void add_real(struct hlh_buffer *b, double x, char after)
{
    if (isnan(x))
        hlh_buffer_print(b, "%c", after);
    else
        hlh_buffer_print(b, "%.9g%c", x, after);
}

static void add_machine(struct hlh_buffer *b, const char *machine)
{
    const char *colon = strchr(machine, ':');
    hlh_buffer_print(b, "%.*s,%s,",
                     (int)(colon ? colon - machine : (long)strlen(machine)),
                     machine, colon ? colon + 1 : "native");
}

static void add_boundary(struct hlh_buffer *b, const struct hls_result *r,
                         const char *machine)
{
    hlh_buffer_print(b, "%s,%s,", r->row->name, r->curve->name);
    add_machine(b, machine);
    add_text(b, r->row->parameter);
    hlh_buffer_print(b, ",%s,", r->row->unit);
    add_real(b, r->boundary, ',');
    add_real(b, r->at, ',');
    add_real(b, r->curve->low, ',');
    add_real(b, r->curve->high, ',');
    hlh_buffer_print(b, "%s,", hls_verdict_name(r->verdict));
    add_text(b, r->curve->derived);
    hlh_buffer_add(b, "\n", 1);
}

static void add_curve(struct hlh_buffer *b, const struct hls_result *r,
                      const char *machine)
{
    for (uint32_t i = 0; i < r->n; i++) {
        hlh_buffer_print(b, "%s,%s,", r->row->name, r->curve->name);
        add_machine(b, machine);
        add_real(b, r->p[i], ',');
        add_real(b, r->m[i], ',');
        add_real(b, r->curve->limit, '\n');
    }
}

static bool write_csv(const char *folder, const char *name, const char *head,
                      void (*add)(struct hlh_buffer *,
                                  const struct hls_result *, const char *),
                      const struct hls_result *r, uint32_t n,
                      const char *machine, struct hlh_error *error)
{
    char path[1024];
    struct hlh_buffer b = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    hlh_buffer_print(&b, "%s\n", head);
    for (uint32_t i = 0; i < n; i++)
        add(&b, &r[i], machine);
    bool ok = b.failed ? hlh_fail(error, path, "out of memory")
                       : hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}

bool hls_write(const char *folder, const struct hls_result *r, uint32_t n,
               const char *machine, char note[120], struct hlh_error *error)
{
    struct hlc_outputs made = {0};
    struct hlh_error no_chart;
    note[0] = 0;
    bool ok = hlc_outputs_folder(&made, folder, error) &&
              write_csv(folder, "boundaries.csv", "row,case,backend,profile,"
                        "parameter,unit,boundary,measure,low,high,verdict,"
                        "derived", add_boundary, r, n, machine, error) &&
              write_csv(folder, "curves.csv",
                        "row,case,backend,profile,p,measure,limit", add_curve,
                        r, n, machine, error);
    hlc_outputs_end(&made, !ok);
    for (uint32_t i = 0, last; ok && i < n; i = last) {
        for (last = i; last < n && r[last].row == r[i].row;)
            last++;
        if (!hls_plot(folder, r + i, last - i, &no_chart)) {
            snprintf(note, 120, "%.119s", no_chart.text);
            break;
        }
    }
    return ok;
}
