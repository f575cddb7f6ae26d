/* SPDX-License-Identifier: Zlib */
/* The tables of docs that are measured: `docs-tables FILE.md RUN.json ...`
 * writes FILE.md to stdout with what stands between each
 * "<!-- table NAME: ... -->" and "<!-- end -->" made anew from the runs of
 * `halflight conform --json`. Equal figures share a row, three digits each. */
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 32, NAMES = 512, LINE = 1024 };

struct run { cJSON *json, *checks; const char *backend, *profile; };
static struct run runs[RUNS];
static int n_runs;

static void fail(const char *where, const char *what)
{
    fprintf(stderr, "docs-tables: %s: %s\n", where, what);
    exit(1);
}

static void add(char *line, const char *text)
{
    size_t used = strlen(line);
    snprintf(line + used, LINE - used, "%s", text);
}

/* ---- runs ---------------------------------------------------------------- */

static char *read_all(const char *path)
{
    FILE *f = fopen(path, "rb");
    size_t size = 0, room = 1 << 16;
    char *text = malloc(room);
    if (!f || !text)
        fail(path, "cannot be read");
    for (size_t got; (got = fread(text + size, 1, room - size - 1, f)) > 0;) {
        size += got;
        if (size + 1 == room && !(text = realloc(text, room *= 2)))
            fail(path, "out of memory");
    }
    text[size] = 0;
    fclose(f);
    return text;
}

static const char *string_of(const cJSON *object, const char *key)
{
    const char *s = cJSON_GetStringValue(cJSON_GetObjectItem(object, key));
    return s ? s : "";
}

static void read_run(const char *path)
{
    char *text = read_all(path);
    struct run *r = &runs[n_runs++];
    r->json = cJSON_Parse(text);
    r->checks = cJSON_GetObjectItem(r->json, "checks");
    r->backend = string_of(r->json, "backend");
    r->profile = string_of(r->json, "profile");
    if (!cJSON_IsArray(r->checks))
        fail(path, "is no result of halflight conform");
    free(text);
}

/* The check of that name, NULL where it was skipped. */
static const cJSON *ran(const struct run *r, const char *name)
{
    const cJSON *c;
    cJSON_ArrayForEach(c, r->checks)
        if (!strcmp(string_of(c, "name"), name))
            return strcmp(string_of(c, "status"), "skip") ? c : NULL;
    return NULL;
}

/* ---- which runs: "vulkan + gl: xbox360; packemu: all" -------------------- */

static bool same_profiles(const bool *in, const char *a, const char *b)
{
    for (int i = 0; i < n_runs; i++)
        for (int k = 0; k < n_runs; k++)
            if (!strcmp(runs[i].backend, a) && !strcmp(runs[k].backend, b) &&
                !strcmp(runs[i].profile, runs[k].profile) && in[i] != in[k])
                return false;
    return true;
}

static bool first_of_backend(int i)
{
    for (int k = 0; k < i; k++)
        if (!strcmp(runs[k].backend, runs[i].backend))
            return false;
    return true;
}

static bool profiles_of(char *line, const bool *in, const char *backend)
{
    char list[LINE] = "";
    bool some = false, all = true;
    for (int i = 0; i < n_runs; i++) {
        if (strcmp(runs[i].backend, backend))
            continue;
        all = all && in[i];
        if (in[i]) {
            add(list, some ? ", " : "");
            add(list, runs[i].profile);
        }
        some = some || in[i];
    }
    add(line, all ? "all" : list);
    return some;
}

static void label(char *line, const bool *in)
{
    bool done[RUNS] = { false };
    for (int i = 0; i < n_runs; i++) {
        char which[LINE] = "";
        if (done[i] || !first_of_backend(i) ||
            !profiles_of(which, in, runs[i].backend))
            continue;
        add(line, line[0] ? "; " : "");
        add(line, runs[i].backend);
        for (int k = i + 1; k < n_runs; k++)
            if (!done[k] && first_of_backend(k) &&
                same_profiles(in, runs[i].backend, runs[k].backend)) {
                add(line, " + ");
                add(line, runs[k].backend);
                done[k] = true;
            }
        add(line, ": ");
        add(line, which);
    }
}

/* ---- rows: line[i] is what run i has, "" for nothing --------------------- */

static char lines[RUNS][LINE];

static void print_rows(const char *name)
{
    for (int i = 0; i < n_runs; i++) {
        bool in[RUNS] = { false };
        char on[LINE] = "";
        bool again = lines[i][0] == 0;
        for (int k = 0; k < n_runs; k++) {
            in[k] = !strcmp(lines[k], lines[i]);
            again = again || (in[k] && k < i);
        }
        if (again)
            continue;
        label(on, in);
        printf("| `%s` | %s |%s\n", name, on, lines[i]);
    }
}

static void add_number(char *line, const cJSON *value)
{
    char text[32];
    snprintf(text, sizeof text, "%.3g", cJSON_GetNumberValue(value));
    add(line, text);
}

/* Three digits would hide that two counts differ. */
static void add_count(char *line, const cJSON *value)
{
    char text[32];
    snprintf(text, sizeof text, "%.0f", cJSON_GetNumberValue(value));
    add(line, text);
}

/* ---- tables of storages: a row a storage, a column a check --------------- */

enum show { FIGURE, LAST_AT, NOTE, COUNTS, WORST };
struct column { const char *head, *check; enum show show; };

static void add_cell(char *line, const cJSON *c, enum show show)
{
    const cJSON *at = cJSON_GetObjectItem(c, "at");
    const cJSON *table = cJSON_GetObjectItem(c, "table");
    int n = cJSON_GetArraySize(at);
    add(line, " ");
    if (show == NOTE)
        add(line, string_of(c, "note"));
    else if (show == COUNTS)
        for (int i = 0; i < n; i++) {
            add(line, i ? ", " : "");
            add_count(line, cJSON_GetArrayItem(at, i));
        }
    else
        add_number(line, show == LAST_AT ? cJSON_GetArrayItem(at, n - 1)
                                         : cJSON_GetObjectItem(c, "worst"));
    if (show <= LAST_AT && cJSON_IsNumber(table)) {
        add(line, " / ");
        add_number(line, table);
    }
    add(line, " |");
}

static void storage(const char *group, const char *row,
                    const struct column *columns)
{
    for (int i = 0; i < n_runs; i++) {
        bool any = false;
        lines[i][0] = 0;
        for (const struct column *k = columns; k->head; k++) {
            char name[LINE];
            snprintf(name, sizeof name, "%s.%s.%s", group, row, k->check);
            const cJSON *c = ran(&runs[i], name);
            any = any || c;
            if (c)
                add_cell(lines[i], c, k->show);
            else
                add(lines[i], " - |");
        }
        if (!any)
            lines[i][0] = 0;
    }
    print_rows(row);
}

static void head(const char *first, const struct column *columns)
{
    printf("| %s | on |", first);
    for (const struct column *k = columns; k->head; k++)
        printf(" %s |", k->head);
    printf("\n|---|---|");
    for (const struct column *k = columns; k->head; k++)
        printf("---|");
    printf("\n");
}

static void normals(void)
{
    static const char *const rows[] = {
        "rg16_unorm", "rg16_snorm", "rg16_fixed32", "rgba8_bytes",
        "rgba8_argb", "rg16_float", "rg16_float_biased", "rg8_unorm", NULL };
    static const struct column columns[] = {
        { "mean", "mean", FIGURE }, { "to 90", "band_90", FIGURE },
        { "to 120", "band_120", FIGURE }, { "to 138.9", "band_139", FIGURE },
        { "to 170", "band_170", FIGURE }, { "to 179", "band_179", FIGURE },
        { "to 180", "pole", FIGURE }, { NULL, NULL, FIGURE } };
    static const struct column errors[] = {
        { "mean", "mean", LAST_AT }, { "to 90", "band_90", LAST_AT },
        { "", "-", FIGURE }, { "", "-", FIGURE }, { "", "-", FIGURE },
        { "", "-", FIGURE }, { "", "-", FIGURE }, { NULL, NULL, FIGURE } };
    head("storage", columns);
    for (int i = 0; rows[i]; i++)
        storage("normal", rows[i], columns);
    storage("normal", "unscaled", errors);
    storage("normal", "base255", errors);
}

static void depth(void)
{
    static const char *const rows[] = {
        "rg16_unorm", "rg16_snorm", "rg16_fixed32", "rgba8_bytes",
        "rgba8_argb", "rg16_snorm_half", "rg16_float", "rg16_float_metres",
        "unscaled", "rg8_unorm", NULL };
    static const struct column columns[] = {
        { "far 100", "far_100", FIGURE }, { "500", "far_500", FIGURE },
        { "1,000", "far_1000", FIGURE }, { "5,000", "far_5000", FIGURE },
        { NULL, NULL, FIGURE } };
    head("storage", columns);
    for (int i = 0; rows[i]; i++)
        storage("depth", rows[i], columns);
}

static void codes(void)
{
    static const char *const rows[] = {
        "rg16_unorm", "rg16_snorm", "rg16_fixed32", "rgba8_bytes",
        "rgba8_argb", "rg8_unorm", NULL };
    static const struct column columns[] = {
        { "stored, worst", "stored", WORST },
        { "read back, worst", "read", WORST }, { NULL, NULL, FIGURE } };
    head("storage", columns);
    for (int i = 0; rows[i]; i++)
        storage("code", rows[i], columns);
}

static void sums(void)
{
    static const char *const rows[] = {
        "rgba16_float", "rgba16_unorm", "rgba16_fixed32", "rg11b10_float",
        "rgb10a2_float", "rgba8_unorm", NULL };
    static const struct column columns[] = {
        { "a blend", "blend_rounding", NOTE }, { "4", "sum_4", FIGURE },
        { "32", "sum_32", FIGURE }, { "81", "sum_81", FIGURE },
        { "287", "sum_287", FIGURE }, { "1,000", "sum_1000", FIGURE },
        { "4,096", "sum_4096", FIGURE }, { "stalls after", "stall", COUNTS },
        { NULL, NULL, FIGURE } };
    head("format", columns);
    for (int i = 0; rows[i]; i++)
        storage("blend", rows[i], columns);
}

/* ---- tables of checks: a row a check ------------------------------------- */

static void check_line(char *line, const cJSON *c)
{
    const char *unit = string_of(c, "unit");
    add(line, " ");
    add(line, string_of(c, "why"));
    add(line, " | ");
    add_number(line, cJSON_GetObjectItem(c, "worst"));
    add(line, " of ");
    add_number(line, cJSON_GetObjectItem(c, "limit"));
    add(line, unit[0] ? " " : "");
    add(line, unit);
    add(line, " | ");
    add_count(line, cJSON_GetObjectItem(c, "cases"));
    add(line, " |");
}

static void check_rows(const char *prefix)
{
    static const char *seen[NAMES];
    int n = 0;
    for (int i = 0; i < n_runs; i++) {
        const cJSON *c;
        cJSON_ArrayForEach(c, runs[i].checks) {
            const char *name = string_of(c, "name");
            bool known = strncmp(name, prefix, strlen(prefix)) != 0;
            for (int k = 0; k < n && !known; k++)
                known = !strcmp(seen[k], name);
            if (known || n == NAMES)
                continue;
            seen[n++] = name;
            for (int k = 0; k < n_runs; k++) {
                const cJSON *of = ran(&runs[k], name);
                lines[k][0] = 0;
                if (of)
                    check_line(lines[k], of);
            }
            print_rows(name);
        }
    }
}

static void check_table(const char *const *prefixes)
{
    printf("| check | on | what it holds to | worst | cases |\n"
           "|---|---|---|---|---|\n");
    for (int i = 0; prefixes[i]; i++)
        check_rows(prefixes[i]);
}

static void filter(void)
{
    static const char *const prefixes[] = { "dsf.", "weights.", "ids.",
                                            NULL };
    check_table(prefixes);
}

static void consoles(void)
{
    static const char *const prefixes[] = { "plan.", "ladder.", "xbox.",
                                            "ps3.", "centre.", NULL };
    check_table(prefixes);
}

static void machines(void)
{
    printf("| backend | profile | device, driver | passed | failed | skipped "
           "| cases |\n|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < n_runs; i++) {
        static const char *const keys[] = { "passed", "failed", "skipped",
                                            "cases" };
        const cJSON *j = runs[i].json;
        const char *device = string_of(j, "device");
        /* The software device's driver is its number of threads, of which
         * nothing depends. */
        bool own = !strcmp(device, runs[i].backend);
        printf("| %s | %s | %s%s%s |", runs[i].backend, runs[i].profile,
               device, own ? "" : "; ", own ? "" : string_of(j, "driver"));
        for (int k = 0; k < 4; k++)
            printf(" %.0f |",
                   cJSON_GetNumberValue(cJSON_GetObjectItem(j, keys[k])));
        printf("\n");
    }
}

/* ---- the document -------------------------------------------------------- */

static void print_table(const char *name, const char *path)
{
    static const struct { const char *name; void (*print)(void); } tables[] =
        { { "machines", machines }, { "normals", normals },
          { "depth", depth }, { "codes", codes }, { "sums", sums },
          { "filter", filter }, { "consoles", consoles } };
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (!strcmp(tables[i].name, name)) {
            printf("\n");
            tables[i].print();
            printf("\n");
            return;
        }
    fail(path, "names a table that there is not");
}

static void print_document(const char *path)
{
    char name[64];
    const char *end;
    for (const char *t = read_all(path), *next; *t; t = next) {
        end = strchr(t, '\n');
        next = end ? end + 1 : t + strlen(t);
        printf("%.*s", (int)(next - t), t);
        if (sscanf(t, "<!-- table %63[a-z0-9]:", name) != 1)
            continue;
        print_table(name, path);
        next = strstr(next, "<!-- end -->");
        if (!next)
            fail(path, "a table has no <!-- end -->");
    }
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc > 2 + RUNS)
        fail("usage", "docs-tables FILE.md RUN.json ...");
    for (int i = 2; i < argc; i++)
        read_run(argv[i]);
    print_document(argv[1]);
    for (int i = 0; i < n_runs; i++)
        cJSON_Delete(runs[i].json);
    if (fflush(stdout) != 0)
        fail("stdout", "cannot be written");
    return 0;
}
