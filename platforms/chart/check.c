/* SPDX-License-Identifier: Zlib */
/* A number a scene, machine and measure of error: the area that the front takes
 * below a corner which stays where it was when the file was saved, so that only
 * the front's own moves change it. One for the front of all ways, and one for
 * that of each group of them, since what is beaten may become worse unseen.
 * Counted cost: the same on every run and every machine. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/chart.h"
#include "platforms/cli/value.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"

/* Less than this share of the stored area is worse, more of it is better:
 * what libm rounds elsewhere is far below, and any change of what is drawn
 * that a front shows is far above. */
#define SLACK 0.02

static const enum hlt_column measures[] = {
    HLT_PSNR, HLT_FLICKER, HLT_FLIP, HLT_EDGE, HLT_MAX
};
/* Of groups the first two: enough to see that one changed. */
enum { MEASURES = sizeof measures / sizeof *measures, OF_GROUPS = 2,
       FIELDS = 7 };

static const char all_ways[] = "all";

/* Names have no commas, as in the table. */
static const char head[] =
    "# halflight chart --save: areas of fronts below their corners, octaves\n"
    "# of cost_ns times octaves of error; what chart --check compares with.\n";
static const char columns[] =
    "scene,machine,ways,error,area,corner_cost,corner_error";

static bool is_all(const char *ways) { return !strcmp(ways, all_ways); }

/* Leaves those of a group; how many. */
static uint32_t only(struct hlt_point *p, uint32_t n, const char *ways)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++)
        if (is_all(ways) || !strcmp(p[i].row->group, ways))
            p[kept++] = p[i];
    return kept;
}

/* ---- saving ------------------------------------------------------------- */

/* The worst cost and error; of groups twice that, so that one of a single way
 * has an area too. False where nothing was measured. */
static bool corner_of(double *cost, double *error, const struct hlt_point *p,
                      uint32_t n, const char *ways)
{
    double beyond = is_all(ways) ? 1 : 2;
    *cost = *error = 0;
    for (uint32_t i = 0; i < n; i++) {
        *cost = p[i].cost * beyond > *cost ? p[i].cost * beyond : *cost;
        *error = p[i].error * beyond > *error ? p[i].error * beyond : *error;
    }
    return n > 0;
}

static bool save_front(struct hlh_buffer *out, const struct hlt_table *t,
                       const struct hlt_row *of, const char *ways,
                       enum hlt_column measure)
{
    uint32_t n;
    double cost, error;
    struct hlt_point *p = hlt_points(&n, t, of->scene, of->machine, HLT_COST,
                                     measure);
    if (!p)
        return false;
    n = only(p, n, ways);
    if (corner_of(&cost, &error, p, n, ways))
        hlh_buffer_print(out, "%s,%s,%s,%s,%.6f,%.9g,%.9g\n", of->scene,
                         of->machine, ways, hlt_column_name(measure),
                         hlt_hypervolume(p, n, cost, error), cost, error);
    free(p);
    return true;
}

static bool is_of(const struct hlt_row *a, const struct hlt_row *b)
{
    return !strcmp(a->scene, b->scene) && !strcmp(a->machine, b->machine);
}

/* Of the scene and machine of row `first`. */
static bool save_fronts(struct hlh_buffer *out, const struct hlt_table *t,
                        uint32_t first)
{
    const struct hlt_row *of = &t->rows[first];
    for (int m = 0; m < MEASURES; m++)
        if (!save_front(out, t, of, all_ways, measures[m]))
            return false;
    for (uint32_t i = first; i < t->n; i++) {
        const char *ways = t->rows[i].group;
        bool seen = !is_of(of, &t->rows[i]);
        for (uint32_t k = first; k < i && !seen; k++)
            seen = is_of(of, &t->rows[k]) && !strcmp(ways, t->rows[k].group);
        for (int m = 0; m < OF_GROUPS && !seen; m++)
            if (!save_front(out, t, of, ways, measures[m]))
                return false;
    }
    return true;
}

/* The first row of its scene and machine. */
static bool is_first(const struct hlt_table *t, uint32_t i)
{
    for (uint32_t k = 0; k < i; k++)
        if (is_of(&t->rows[k], &t->rows[i]))
            return false;
    return true;
}

bool hlt_save(const struct hlt_table *t, const char *path,
              struct hlh_error *error)
{
    struct hlh_buffer b = { NULL, 0, 0, false };
    bool ok = true;
    hlh_buffer_print(&b, "%s# size %ux%u\n%s\n", head, (unsigned)t->width,
                     (unsigned)t->height, columns);
    for (uint32_t i = 0; i < t->n && ok; i++)
        ok = !is_first(t, i) || save_fronts(&b, t, i);
    if (!ok || b.failed)
        ok = hlh_fail(error, path, "out of memory");
    else
        ok = hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}

/* ---- checking ----------------------------------------------------------- */

struct stored {
    const char *scene, *machine, *ways;
    enum hlt_column error;
    double area, cost, worst;            /* corner                           */
};

static bool read_column(enum hlt_column *out, const char *name)
{
    for (int k = 0; k < MEASURES; k++)
        if (!strcmp(name, hlt_column_name(measures[k]))) {
            *out = measures[k];
            return true;
        }
    return false;
}

/* Cuts the line up. */
static bool read_stored(struct stored *out, char *line)
{
    char *field[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        field[i] = line;
        line += strcspn(line, ",");
        if ((*line == ',') != (i + 1 < FIELDS))
            return false;
        *line++ = 0;
    }
    out->scene = field[0];
    out->machine = field[1];
    out->ways = field[2];
    return read_column(&out->error, field[3]) &&
           hlc_read_real(&out->area, field[4]) && out->area >= 0 &&
           hlc_read_real(&out->cost, field[5]) && out->cost > 0 &&
           hlc_read_real(&out->worst, field[6]) && out->worst > 0;
}

static void say(const struct stored *s, const char *what, double area)
{
    fprintf(stderr, "halflight: %s on %s, %s, %s ways: the front's area is "
            "%.3f, was %.3f (%+.1f %%): %s\n", s->scene, s->machine,
            hlt_column_name(s->error), s->ways, area, s->area,
            100 * (area - s->area) / s->area, what);
}

/* 1: worse; 0: not; -1: memory is out. */
static int judge(const struct stored *s, const struct hlt_table *t)
{
    uint32_t n;
    struct hlt_point *p = hlt_points(&n, t, s->scene, s->machine, HLT_COST,
                                     s->error);
    if (!p)
        return -1;
    n = only(p, n, s->ways);
    double area = hlt_hypervolume(p, n, s->cost, s->worst);
    free(p);
    if (n == 0) {
        fprintf(stderr, "halflight: %s on %s, %s, %s ways: in the file, but "
                "was not measured\n", s->scene, s->machine,
                hlt_column_name(s->error), s->ways);
        return 1;
    }
    bool worse = area < s->area * (1 - SLACK);
    if (worse)
        say(s, "worse", area);
    else if (area > s->area * (1 + SLACK))
        say(s, "better, to be saved anew", area);
    return worse;
}

/* Pictures of another size have other costs and errors. */
static bool same_size(const char *line, const struct hlt_table *t,
                      const char *path, struct hlh_error *error)
{
    char size[32];
    snprintf(size, sizeof size, "%ux%u", (unsigned)t->width,
             (unsigned)t->height);
    return strncmp(line, "# size ", 7) || !strcmp(line + 7, size) ||
           hlh_fail(error, path, "is of pictures of %.16s, these are %s",
                    line + 7, size);
}

/* The line that *text begins with, cut off; *text: what follows. */
static char *next_line(char **text)
{
    char *line = *text, *end = line + strcspn(line, "\n");
    *text = *end ? end + 1 : end;
    *end = 0;
    return line;
}

static int check_lines(char *text, const struct hlt_table *t,
                       const char *path, struct hlh_error *error)
{
    int worse = 0;
    unsigned number = 0, fronts = 0;
    while (*text) {
        struct stored s;
        char *line = next_line(&text);
        number++;
        if (!same_size(line, t, path, error))
            return -1;
        if (*line == '#' || !strcmp(line, columns))
            continue;
        int bad = read_stored(&s, line) ? judge(&s, t) : -2;
        if (bad < 0) {
            hlh_fail(error, path, bad == -1 ? "out of memory" : "line %u is "
                     "not of a file that chart --save writes", number);
            return -1;
        }
        worse += bad;
        fronts++;
    }
    if (fronts > 0)
        return worse;
    hlh_fail(error, path, "has no front to compare with");
    return -1;
}

int hlt_check(const struct hlt_table *t, const char *path,
              struct hlh_error *error)
{
    char *text;
    size_t size;
    if (!hlh_file_read(&text, &size, path, error))
        return -1;
    int worse = check_lines(text, t, path, error);
    free(text);
    return worse;
}
