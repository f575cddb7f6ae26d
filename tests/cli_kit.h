/* SPDX-License-Identifier: Zlib */
#ifndef CLI_KIT_H
#define CLI_KIT_H
/* Runs the built tool from outside: HL_TOOL, or ../halflight beside the test
 * program, in the directory of scene_kit's fixtures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <cjson/cJSON.h>
#include "tests/scene_kit.h"

struct tool_run { int code; char out[131072], err[4096]; };

/* First thing in main: argv[0] says where the tool is. False with a line on
 * stderr when there is none. */
bool tool_find(const char *argv0);

/* Words of `line` are apart by blanks; '' is an empty one. */
void tool_run(struct tool_run *out, void **state, const char *line);
/* Exit 0 and nothing on stderr, or the test fails. */
void tool_done(struct tool_run *out, void **state, const char *line);
/* The run ends with `code`, says one line on stderr that has `part`, prints
 * nothing where the code is not 1, and leaves as many files as there were. */
void tool_refused(void **state, const char *line, int code, const char *part);

struct tool_line { const char *line, *part; };
void tool_refuse_all(void **state, const struct tool_line *rows, size_t n,
                     int code);
#define TOOL_REFUSE(rows, code) \
    tool_refuse_all(state, rows, sizeof rows / sizeof *rows, code)

/* JSON of version 1, or the test fails; cJSON_Delete. */
cJSON *tool_json(const char *text);
/* Member "a.b.c"; fails where there is none. */
const cJSON *tool_at(const cJSON *j, const char *path);
double tool_number(const cJSON *j, const char *path);
const char *tool_text(const cJSON *j, const char *path);
bool tool_is_null(const cJSON *j, const char *path);
#endif
