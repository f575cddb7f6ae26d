/* SPDX-License-Identifier: Zlib */
#include "tests/cli_kit.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ARGS = 40, LINE = 1024 };

static char tool[4096];      /* absolute path, set once by tool_find         */

bool tool_find(const char *argv0)
{
    const char *named = getenv("HL_TOOL"), *slash = strrchr(argv0, '/');
    char path[2048], here[2048] = "";
    if (named)
        snprintf(path, sizeof path, "%s", named);
    else
        snprintf(path, sizeof path, "%.*s/../halflight",
                 slash ? (int)(slash - argv0) : 1, slash ? argv0 : ".");
    if (path[0] != '/' && !getcwd(here, sizeof here - 1))
        return false;
    snprintf(tool, sizeof tool, "%s%s%s", here, here[0] ? "/" : "", path);
    if (access(tool, X_OK) == 0)
        return true;
    fprintf(stderr, "%s cannot be run: make it, or set HL_TOOL\n", tool);
    return false;
}

static void split(char **argv, char *line)
{
    int n = 0;
    argv[n++] = tool;
    for (char *w = strtok(line, " "); w; w = strtok(NULL, " ")) {
        assert_true(n + 1 < ARGS);
        argv[n++] = strcmp(w, "''") ? w : w + 2;
    }
    argv[n] = NULL;
}

static void take(char *text, size_t room, FILE *file)
{
    rewind(file);
    size_t n = fread(text, 1, room - 1, file);
    text[n] = 0;
    fclose(file);
}

void tool_run(struct tool_run *r, void **state, const char *line)
{
    char copy[LINE], *argv[ARGS];
    FILE *out = tmpfile(), *err = tmpfile();
    int status = 0;
    assert_non_null(out);
    assert_non_null(err);
    assert_true(strlen(line) < LINE);
    strcpy(copy, line);
    split(argv, copy);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        dup2(fileno(out), 1);
        dup2(fileno(err), 2);
        if (chdir(*state) == 0)
            execv(tool, argv);
        _exit(127);
    }
    assert_true(child > 0);
    while (waitpid(child, &status, 0) < 0)
        assert_int_equal(errno, EINTR);
    r->code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    take(r->out, sizeof r->out, out);
    take(r->err, sizeof r->err, err);
}

void tool_done(struct tool_run *r, void **state, const char *line)
{
    tool_run(r, state, line);
    if (r->code != 0 || r->err[0])
        fail_msg("%s: exit %d: %s", line, r->code, r->err);
}

void tool_refused(void **state, const char *line, int code, const char *part)
{
    static struct tool_run r;
    int files = sk_count(state);
    tool_run(&r, state, line);
    const char *end = strchr(r.err, '\n');
    if (r.code != code)
        fail_msg("%s: exit %d, not %d: %s", line, r.code, code, r.err);
    if (strncmp(r.err, "halflight: ", 11) || !end || end[1] ||
        !strstr(r.err, part))
        fail_msg("%s: not one line with '%s': %s", line, part, r.err);
    if (code != 1 && r.out[0])
        fail_msg("%s: printed %s", line, r.out);
    if (sk_count(state) != files)
        fail_msg("%s: left or took a file", line);
}

void tool_refuse_all(void **state, const struct tool_line *rows, size_t n,
                     int code)
{
    for (size_t i = 0; i < n; i++)
        tool_refused(state, rows[i].line, code, rows[i].part);
}

/* ---- JSON --------------------------------------------------------------- */

cJSON *tool_json(const char *text)
{
    cJSON *j = cJSON_Parse(text);
    if (!j)
        fail_msg("not JSON: %s", text);
    assert_true(tool_number(j, "version") == 1);
    return j;
}

const cJSON *tool_at(const cJSON *j, const char *path)
{
    char key[64];
    const char *p = path;
    while (j && *p) {
        size_t n = strcspn(p, ".");
        assert_true(n < sizeof key);
        memcpy(key, p, n);
        key[n] = 0;
        j = cJSON_GetObjectItemCaseSensitive(j, key);
        p += n + (p[n] == '.');
    }
    if (!j)
        fail_msg("there is no %s", path);
    return j;
}

double tool_number(const cJSON *j, const char *path)
{
    const cJSON *n = tool_at(j, path);
    if (!cJSON_IsNumber(n))
        fail_msg("%s is not a number", path);
    return n->valuedouble;
}

const char *tool_text(const cJSON *j, const char *path)
{
    const cJSON *n = tool_at(j, path);
    if (!cJSON_IsString(n))
        fail_msg("%s is not a text", path);
    return n->valuestring;
}

bool tool_is_null(const cJSON *j, const char *path)
{
    return cJSON_IsNull(tool_at(j, path));
}
