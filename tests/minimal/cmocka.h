/* SPDX-License-Identifier: Zlib */
#ifndef HL_MINIMAL_CMOCKA_H
#define HL_MINIMAL_CMOCKA_H
/* The part of cmocka's interface that the tests use, for machines that have
 * no package of it (cross compilers): found by -Itests/minimal in its stead.
 * Values are compared as 64-bit integers, a failure leaves by longjmp. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

struct CMUnitTest {
    const char *name;
    void (*test_func)(void **state);
    int (*setup_func)(void **state);
    int (*teardown_func)(void **state);
    void *initial_state;
};
#define cmocka_unit_test(f) { #f, f, NULL, NULL, NULL }
#define cmocka_unit_test_setup_teardown(f, setup, teardown) \
    { #f, f, setup, teardown, NULL }
/* How many failed. No test is run whose name lacks the environment's
 * HL_TEST, where that is set. */
#define cmocka_run_group_tests_name(name, tests, setup, teardown)     \
    min_run(name, tests, sizeof(tests) / sizeof((tests)[0]), setup, teardown)
#define cmocka_run_group_tests(tests, setup, teardown) \
    cmocka_run_group_tests_name(#tests, tests, setup, teardown)
int min_run(const char *name, const struct CMUnitTest *tests, size_t n,
            int (*setup)(void **), int (*teardown)(void **));

#if defined(__GNUC__)
#define MIN_PRINTF(f, a) __attribute__((format(printf, f, a)))
#define MIN_LEAVES __attribute__((noreturn))
#else
#define MIN_PRINTF(f, a)
#define MIN_LEAVES
#endif
void print_message(const char *format, ...) MIN_PRINTF(1, 2);
void print_error(const char *format, ...) MIN_PRINTF(1, 2);
void _fail(const char *file, int line) MIN_LEAVES;
void min_skip(void) MIN_LEAVES;
void min_fail(const char *file, int line, const char *format, ...)
    MIN_PRINTF(3, 4) MIN_LEAVES;
void min_int(const char *file, int line, const char *what, uint64_t a,
             uint64_t b, int equal);
void min_string(const char *file, int line, const char *a, const char *b,
                int equal);
void min_memory(const char *file, int line, const void *a, const void *b,
                size_t n);

#define fail() _fail(__FILE__, __LINE__)
#define skip() min_skip()
#define fail_msg(...) min_fail(__FILE__, __LINE__, __VA_ARGS__)
#define assert_true(c) \
    min_int(__FILE__, __LINE__, #c, (uint64_t)((c) ? 1 : 0), 1, 1)
#define assert_false(c) \
    min_int(__FILE__, __LINE__, #c, (uint64_t)((c) ? 1 : 0), 0, 1)
#define assert_int_equal(a, b) \
    min_int(__FILE__, __LINE__, #a, (uint64_t)(a), (uint64_t)(b), 1)
#define assert_int_not_equal(a, b) \
    min_int(__FILE__, __LINE__, #a, (uint64_t)(a), (uint64_t)(b), 0)
#define assert_in_range(v, low, high)                                     \
    min_int(__FILE__, __LINE__, #v " in range",                           \
            (uint64_t)(v) >= (uint64_t)(low) &&                           \
            (uint64_t)(v) <= (uint64_t)(high), 1, 1)
#define assert_null(p) assert_true((p) == NULL)
#define assert_non_null(p) assert_true((p) != NULL)
#define assert_ptr_equal(a, b) \
    assert_true((const void *)(a) == (const void *)(b))
#define assert_string_equal(a, b) min_string(__FILE__, __LINE__, a, b, 1)
#define assert_string_not_equal(a, b) min_string(__FILE__, __LINE__, a, b, 0)
#define assert_memory_equal(a, b, n) min_memory(__FILE__, __LINE__, a, b, n)
#endif
