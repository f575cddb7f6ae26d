/* SPDX-License-Identifier: Zlib */
/* chart.csv: a comment with version, size and settings, a line of column
 * names, a row a line. Nothing is quoted: names have no commas. A file is not
 * trusted: what is not exactly that is one line of error. */
#include <locale.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/chart/chart.h"
#include "platforms/cli/value.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"

#define TITLE "# halflight chart "
#define VERSION "1"
#define UNFINISHED "unfinished"

enum { TEXTS = 8, COUNTS = 4, FIELDS = 13 + HLT_COLUMNS, LINE = 4096,
       ROWS = 100000 };

/* ---- fields ------------------------------------------------------------- */

/* Columns before the numbers, in order: texts, then what is written as a whole
 * number, then the budget. */
static const struct { const char *name; size_t at, bytes; } texts[TEXTS] = {
#define TEXT_AT(member) { #member, offsetof(struct hlt_row, member), \
                          sizeof ((struct hlt_row *)0)->member }
    TEXT_AT(scene), TEXT_AT(machine), TEXT_AT(way), TEXT_AT(group),
    TEXT_AT(pipeline), TEXT_AT(light_format), TEXT_AT(normal_format),
    TEXT_AT(light_path)
};
static const struct { const char *name; size_t at; } counts[COUNTS] = {
    { "light_width", offsetof(struct hlt_row, light_width) },
    { "light_height", offsetof(struct hlt_row, light_height) },
    { "samples", offsetof(struct hlt_row, samples) },
    { "batch", offsetof(struct hlt_row, batch) }
};

static const char *field_name(int i)
{
    if (i < TEXTS)
        return texts[i].name;
    if (i < TEXTS + COUNTS)
        return counts[i - TEXTS].name;
    return i == TEXTS + COUNTS ? "budget"
           : hlt_column_name((enum hlt_column)(i - TEXTS - COUNTS - 1));
}

static double *field_number(struct hlt_row *r, int i)
{
    return i == TEXTS + COUNTS ? &r->budget
                               : &r->value[i - TEXTS - COUNTS - 1];
}

/* The same text in every locale: nine digits, "" for NAN. */
static void write_number(char out[32], double v)
{
    const char *point = localeconv()->decimal_point;
    snprintf(out, 32, "%.9g", v);
    char *at = strcmp(point, ".") ? strstr(out, point) : NULL;
    if (at) {
        *at = '.';
        memmove(at + 1, at + strlen(point), strlen(at + strlen(point)) + 1);
    }
    if (isnan(v))
        out[0] = 0;
}

static bool read_number(double *out, const char *text)
{
    char local[64];
    const char *point = localeconv()->decimal_point, *dot;
    size_t n = strlen(text);
    if (!n || !strcmp(text, "inf")) {
        *out = n ? (double)INFINITY : (double)NAN;
        return true;
    }
    if (n > 32)
        return false;
    dot = strchr(text, '.');
    snprintf(local, sizeof local, "%.*s%s%s", (int)(dot ? dot - text : 32),
             text, dot ? point : "", dot ? dot + 1 : "");
    if (strcmp(point, ".") == 0)
        return hlc_read_real(out, local);
    char *end;
    *out = strtod(local, &end);
    return strspn(text, "0123456789+-.eE") == n && !*end && isfinite(*out);
}

static int by_key(const void *a, const void *b)
{
    const struct hlt_row *x = a, *y = b;
    int c = strcmp(x->scene, y->scene);
    c = c ? c : strcmp(x->machine, y->machine);
    return c ? c : strcmp(x->way, y->way);
}

/* ---- reading ------------------------------------------------------------ */

struct reader {
    struct hlt_table *table;
    const char *path;
    struct hlh_error *error;
    unsigned line;
};

static bool bad(const struct reader *r, const char *what, const char *text)
{
    return hlh_fail(r->error, r->path, "line %u: %s \"%.40s\"", r->line, what,
                    text);
}

static bool read_title(const struct reader *r, const char *line)
{
    char size[64];
    size_t n = strlen(TITLE VERSION ", ");
    struct hlt_table *t = r->table;
    if (strncmp(line, TITLE, strlen(TITLE)))
        return bad(r, "not a table of halflight chart:", line);
    if (strncmp(line, TITLE VERSION ", ", n))
        return bad(r, "another version than " VERSION ":", line);
    snprintf(size, sizeof size, "%.*s", (int)strcspn(line + n, ","), line + n);
    line += n + strlen(size);
    if (!hlc_read_size(&t->width, &t->height, size) || !t->width ||
        !t->height || t->width > HLC_SIZE_MAX || t->height > HLC_SIZE_MAX)
        return bad(r, "not a size of pictures:", size);
    if (!strncmp(line, ", ", 2))
        line += 2;
    else if (*line)
        return bad(r, "goes on after the size:", line);
    n = strlen(UNFINISHED);
    t->unfinished = !strncmp(line, UNFINISHED, n) &&
                    (!line[n] || !strncmp(line + n, ", ", 2));
    line += !t->unfinished ? 0 : line[n] ? n + 2 : n;
    if (strlen(line) >= sizeof t->settings)
        return bad(r, "settings too long:", line);
    snprintf(t->settings, sizeof t->settings, "%s", line);
    return true;
}

/* Field i of a line, which it is cut out of; NULL past the last. */
static char *next_field(char **line)
{
    char *field = *line;
    if (!field)
        return NULL;
    char *comma = strchr(field, ',');
    *line = comma ? comma + 1 : NULL;
    if (comma)
        *comma = 0;
    return field;
}

static bool read_names(const struct reader *r, char *line)
{
    for (int i = 0; i < FIELDS; i++) {
        const char *field = next_field(&line);
        if (!field || strcmp(field, field_name(i)))
            return hlh_fail(r->error, r->path, "line %u: column %d is \"%.40s\""
                            ", not \"%s\"", r->line, i + 1,
                            field ? field : "", field_name(i));
    }
    return line ? bad(r, "more columns:", line) : true;
}

static bool read_field(const struct reader *r, struct hlt_row *row, int i,
                       const char *field)
{
    char *at = (char *)row;
    if (i < TEXTS) {
        if (strlen(field) >= texts[i].bytes || (i < 3 && !*field))
            return bad(r, i < 3 && !*field ? "a name is missing:"
                                           : "too long:", field);
        memcpy(at + texts[i].at, field, strlen(field));
    } else if (i < TEXTS + COUNTS) {
        uint32_t v;
        if (!hlc_read_count(&v, field))
            return bad(r, "not a whole number:", field);
        memcpy(at + counts[i - TEXTS].at, &v, sizeof v);
    } else if (!read_number(field_number(row, i), field)) {
        return bad(r, "not a number:", field);
    }
    return true;
}

static bool read_row(const struct reader *r, char *line)
{
    struct hlt_row row, *put;
    memset(&row, 0, sizeof row);
    for (int i = 0; i < FIELDS; i++) {
        const char *field = next_field(&line);
        if (!field)
            return hlh_fail(r->error, r->path, "line %u: %d of %d columns",
                            r->line, i, FIELDS);
        if (!read_field(r, &row, i, field))
            return false;
    }
    if (line)
        return bad(r, "more columns:", line);
    if (!(row.budget >= 0))
        return bad(r, "not a budget:", row.way);
    put = r->table->n < ROWS
          ? hlh_push(&r->table->rows, &r->table->n, sizeof *put) : NULL;
    if (!put)
        return hlh_fail(r->error, r->path, "line %u: too many rows", r->line);
    *put = row;
    return true;
}

/* A last line without an end is a row whose writing was cut off: not there. */
static bool read_lines(struct reader *r, char *text, size_t size)
{
    for (char *line = text, *end; line < text + size; line = end + 1) {
        end = memchr(line, '\n', (size_t)(text + size - line));
        r->line++;
        if (!end)
            break;
        if (end - line > LINE)
            return hlh_fail(r->error, r->path, "line %u: is longer than %d "
                            "bytes", r->line, LINE);
        *end = 0;
        for (const char *c = line; c < end; c++)
            if ((unsigned char)*c < 32 || *c == 127)
                return hlh_fail(r->error, r->path, "line %u: holds byte %u",
                                r->line, (unsigned char)*c);
        if (!(r->line == 1 ? read_title(r, line)
              : r->line == 2 ? read_names(r, line) : read_row(r, line)))
            return false;
    }
    return r->table->width > 0 ||
           hlh_fail(r->error, r->path, "line 1: not a table of halflight "
                    "chart");
}

static bool is_there(const char *path) { return access(path, F_OK) == 0; }

static bool sort_rows(struct hlt_table *t, const char *path,
                      struct hlh_error *error)
{
    if (t->n)
        qsort(t->rows, t->n, sizeof *t->rows, by_key);
    for (uint32_t i = 1; i < t->n; i++)
        if (by_key(&t->rows[i - 1], &t->rows[i]) == 0)
            return hlh_fail(error, path, "%s, %s: two rows of \"%s\"",
                            t->rows[i].scene, t->rows[i].machine,
                            t->rows[i].way);
    return true;
}

bool hlt_table_read(struct hlt_table *t, const char *path,
                    struct hlh_error *error)
{
    struct reader r = { t, path, error, 0 };
    char *text;
    size_t size;
    memset(t, 0, sizeof *t);
    if (!is_there(path))
        return true;
    if (!hlh_file_read_regular(&text, &size, path, error))
        return false;
    bool ok = read_lines(&r, text, size) && sort_rows(t, path, error);
    free(text);
    if (!ok)
        hlt_table_free(t);
    return ok;
}

/* ---- writing ------------------------------------------------------------ */

static void print_head(struct hlh_buffer *b, const struct hlt_table *t)
{
    hlh_buffer_print(b, TITLE VERSION ", %ux%u%s%s%s\n", (unsigned)t->width,
                     (unsigned)t->height, t->unfinished ? ", " UNFINISHED : "",
                     t->settings[0] ? ", " : "", t->settings);
    for (int i = 0; i < FIELDS; i++)
        hlh_buffer_print(b, "%s%c", field_name(i),
                         i + 1 < FIELDS ? ',' : '\n');
}

static void print_row(struct hlh_buffer *b, const struct hlt_row *r)
{
    struct hlt_row row = *r;
    const char *at = (const char *)&row;
    for (int i = 0; i < FIELDS; i++) {
        char text[32];
        uint32_t v;
        if (i < TEXTS) {
            hlh_buffer_print(b, "%s,", at + texts[i].at);
            continue;
        }
        if (i < TEXTS + COUNTS) {
            memcpy(&v, at + counts[i - TEXTS].at, sizeof v);
            snprintf(text, sizeof text, "%u", (unsigned)v);
        } else {
            write_number(text, *field_number(&row, i));
        }
        hlh_buffer_print(b, "%s%c", text, i + 1 < FIELDS ? ',' : '\n');
    }
}

static bool append_bytes(const struct hlh_buffer *b, const char *path,
                         struct hlh_error *error)
{
    FILE *f = b->failed ? NULL : fopen(path, "ab");
    bool ok = f && fwrite(b->bytes, 1, b->size, f) == b->size;
    if (f)
        ok = fclose(f) == 0 && ok;
    return ok || hlh_fail(error, path, "could not be written");
}

/* As a file would give it back, so that a sweep that was gone on with has the
 * same numbers as one that was not. */
static void as_written(struct hlt_row *r)
{
    for (int i = TEXTS + COUNTS; i < FIELDS; i++) {
        char text[32];
        write_number(text, *field_number(r, i));
        read_number(field_number(r, i), text);
    }
}

bool hlt_table_append(struct hlt_table *t, const struct hlt_row *row,
                      const char *path, struct hlh_error *error)
{
    struct hlh_buffer b;
    memset(&b, 0, sizeof b);
    struct hlt_row *put = hlh_push(&t->rows, &t->n, sizeof *put);
    if (!put)
        return hlh_fail(error, path, "out of memory");
    *put = *row;
    as_written(put);
    if (!is_there(path))
        print_head(&b, t);
    print_row(&b, put);
    bool ok = append_bytes(&b, path, error);
    hlh_buffer_free(&b);
    return ok;
}

bool hlt_table_write(struct hlt_table *t, const char *path,
                     struct hlh_error *error)
{
    struct hlh_buffer b;
    memset(&b, 0, sizeof b);
    if (t->n)
        qsort(t->rows, t->n, sizeof *t->rows, by_key);
    print_head(&b, t);
    for (uint32_t i = 0; i < t->n; i++)
        print_row(&b, &t->rows[i]);
    bool ok = b.failed ? hlh_fail(error, path, "out of memory")
                       : hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}

/* ---- rows --------------------------------------------------------------- */

void hlt_table_free(struct hlt_table *t)
{
    free(t->rows);
    memset(t, 0, sizeof *t);
}

const struct hlt_row *hlt_table_find(const struct hlt_table *t,
                                     const char *scene, const char *machine,
                                     const char *way)
{
    for (uint32_t i = 0; i < t->n; i++) {
        const struct hlt_row *r = &t->rows[i];
        if (!strcmp(r->scene, scene) && !strcmp(r->machine, machine) &&
            !strcmp(r->way, way))
            return r;
    }
    return NULL;
}
