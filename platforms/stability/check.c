/* SPDX-License-Identifier: Zlib */
/* Boundaries against those of an earlier run. The file: a line of what was
 * swept, then "row.case boundary" a line, "none" where nothing broke. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"
#include "platforms/stability/parts.h"

enum { LINE = 160 };

static void head(char out[LINE], const char *machine, bool fast)
{
    snprintf(out, LINE, "halflight stability 1 %s %s", machine,
             fast ? "fast" : "whole");
}

/* Of what was measured; the rest has no line. */
static bool measured(const struct hls_result *r)
{
    return r->verdict == HLS_HELD || r->verdict == HLS_MOVED;
}

bool hls_save(const char *path, const struct hls_result *r, uint32_t n,
              const char *machine, bool fast, struct hlh_error *error)
{
    char line[LINE], name[HLS_NAME];
    struct hlh_buffer b = {0};
    head(line, machine, fast);
    hlh_buffer_print(&b, "%s\n", line);
    for (uint32_t i = 0; i < n; i++) {
        hls_name(name, &r[i]);
        if (measured(&r[i]) && r[i].found)
            hlh_buffer_print(&b, "%s %.9g\n", name, r[i].boundary);
        else if (measured(&r[i]))
            hlh_buffer_print(&b, "%s none\n", name);
    }
    bool ok = b.failed ? hlh_fail(error, path, "out of memory")
                       : hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}

/* How far along the sweep p lies, in widths of bisection. */
static double along(const struct hls_result *r, double p)
{
    double from = r->curve->from, to = r->curve->to;
    if (r->row->grid == HLS_LOG)
        return fabs(log(p / from)) / log(1.01);
    if (r->row->grid == HLS_LINEAR)
        return fabs(p - from) / (0.01 * fabs(to - from));
    return fabs(p - from);
}

/* A fall that never comes is as bad as can be, a rise as good. */
static bool worse(const struct hls_result *r, double before)
{
    double was = isnan(before) ? INFINITY : along(r, before);
    double is = r->found ? along(r, r->boundary) : INFINITY;
    /* 1e-6: numbers of the file are rounded. */
    double slack = r->row->grid == HLS_WHOLE ? 1e-6 : 1 + 1e-6;
    return r->curve->falling ? is > was + slack : is < was - slack;
}

/* The boundary that the file has for `name`: false where it has none. */
static bool find(double *out, const char *text, const char *name)
{
    size_t length = strlen(name);
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, name, length) || line[length] != ' ')
            continue;
        *out = strncmp(line + length + 1, "none", 4)
                   ? strtod(line + length + 1, NULL) : (double)NAN;
        return true;
    }
    return false;
}

static bool fell(const struct hls_result *r, const char *text)
{
    char name[HLS_NAME], was[HLS_NUMBER], is[HLS_NUMBER];
    double before;
    hls_name(name, r);
    if (!measured(r) || !find(&before, text, name) || !worse(r, before))
        return false;
    hlc_fail(0, "stability: %s: boundary was %s, now %s %s: worse", name,
             hls_number(was, r->row, before),
             hls_number(is, r->row, r->boundary), r->row->unit);
    return true;
}

int hls_check(const char *path, const struct hls_result *r, uint32_t n,
              const char *machine, bool fast, struct hlh_error *error)
{
    char line[LINE], *text;
    size_t size;
    int worse_ones = 0;
    head(line, machine, fast);
    if (!hlh_file_read(&text, &size, path, error))
        return -1;
    if (strncmp(text, line, strlen(line)) || text[strlen(line)] != '\n') {
        hlh_fail(error, path, "is not of \"%s\"", line);
        worse_ones = -1;
    }
    for (uint32_t i = 0; worse_ones >= 0 && i < n; i++)
        worse_ones += fell(&r[i], text);
    free(text);
    return worse_ones;
}
