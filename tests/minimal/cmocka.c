/* SPDX-License-Identifier: Zlib */
#include "tests/minimal/cmocka.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static jmp_buf leave;
enum { FAILED = 1, SKIPPED };

static void print(FILE *to, const char *format, va_list args)
{
    vfprintf(to, format, args);
    fflush(to);
}

void print_message(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print(stdout, format, args);
    va_end(args);
}

void print_error(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print(stderr, format, args);
    va_end(args);
}

void _fail(const char *file, int line)
{
    print_error("%s:%d: failed\n", file, line);
    longjmp(leave, FAILED);
}

void min_skip(void)
{
    longjmp(leave, SKIPPED);
}

void min_fail(const char *file, int line, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print(stderr, format, args);
    va_end(args);
    print_error("\n");
    _fail(file, line);
}

void min_int(const char *file, int line, const char *what, uint64_t a,
             uint64_t b, int equal)
{
    if ((a == b) != equal)
        min_fail(file, line, "%s: %lld, %s%lld", what, (long long)a,
                 equal ? "not " : "which is ", (long long)b);
}

void min_string(const char *file, int line, const char *a, const char *b,
                int equal)
{
    if ((strcmp(a, b) == 0) != equal)
        min_fail(file, line, "\"%s\", \"%s\"", a, b);
}

void min_memory(const char *file, int line, const void *a, const void *b,
                size_t n)
{
    const unsigned char *x = a, *y = b;
    for (size_t i = 0; i < n; i++)
        if (x[i] != y[i])
            min_fail(file, line, "byte %zu of %zu: 0x%02x, not 0x%02x", i, n,
                     x[i], y[i]);
}

enum part { SETUP, TEST, TEARDOWN };

static int run_part(const struct CMUnitTest *t, enum part part)
{
    static void *state;              /* outlives longjmp                     */
    int left = setjmp(leave);
    if (left)
        return left;
    if (part == SETUP) {
        state = t->initial_state;
        return t->setup_func && t->setup_func(&state) ? FAILED : 0;
    }
    if (part == TEARDOWN)
        return t->teardown_func && t->teardown_func(&state) ? FAILED : 0;
    t->test_func(&state);
    return 0;
}

static int run_one(const struct CMUnitTest *t)
{
    int result = run_part(t, SETUP);
    if (result)
        return result;
    result = run_part(t, TEST);
    int after = run_part(t, TEARDOWN);
    return result == FAILED || !after ? result : after;
}

int min_run(const char *name, const struct CMUnitTest *tests, size_t n,
            int (*setup)(void **), int (*teardown)(void **))
{
    const char *only = getenv("HL_TEST");
    void *state = NULL;
    int failed = 0;
    if (setup && setup(&state))
        return 1;
    for (size_t i = 0; i < n; i++) {
        if (only && !strstr(tests[i].name, only))
            continue;
        printf("[ RUN      ] %s\n", tests[i].name);
        fflush(stdout);
        int r = run_one(&tests[i]);
        printf("[ %s ] %s\n", r == FAILED ? " FAILED "
               : r == SKIPPED ? " SKIPPED" : "      OK", tests[i].name);
        failed += r == FAILED;
    }
    if (teardown)
        teardown(&state);
    fprintf(stderr, "%s: %d failed\n", name, failed);
    return failed;
}
