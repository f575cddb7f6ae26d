/* SPDX-License-Identifier: Zlib */
#ifndef CHECK_H
#define CHECK_H
/* What the tests of hal, core and pictures share: cmocka in the order that
 * it needs, devices with a log that is kept, half floats, caps. Hooks that
 * count and fail, and random numbers, are mesh_kit's. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include "core/halflight.h"
#include "tests/mesh_kit.h"

/* ---- devices ---------------------------------------------------------- */

enum { CK_IDS = HL_MSG_DEVICE + 1 };

/* A device and all that it said. Not to be moved while open. */
struct ck_machine {
    const struct hl_backend *backend;
    struct hl_device *device;    /* NULL: there is none, `last` says why     */
    struct mk_memory memory;
    uint32_t errors, warnings;   /* logged                                   */
    uint32_t by_id[CK_IDS];
    enum hl_log_id last_id;
    char last[512];
    uint32_t invalid;            /* errors of the validation layers          */
};

/* Hooks and log of `m`, validation on. */
struct hl_device_desc ck_desc(struct ck_machine *m);
/* Open `backend` ("null", "vulkan"); native as in hl_device_desc. False: no
 * such device here. Any other failure fails the test. */
bool ck_open(struct ck_machine *m, const char *backend, const void *native);
/* By the rules of a console, "ps3"; there must be such a device. */
void ck_open_as(struct ck_machine *m, const char *backend,
                const char *profile);
/* Close; fail on memory left and on validation errors. */
void ck_close(struct ck_machine *m);

/* A group's state: initial state of each test is a backend's name; setup
 * opens it, teardown closes. */
int ck_setup(void **state);
int ck_teardown(void **state);
/* The machine of a test, or a skip with the reason on stdout. */
struct ck_machine *ck_machine(void **state);

/* A row of a group: `name` on backend, shown as "name (backend)". */
#define CK_ON(backend, name) \
    { #name " (" backend ")", name, ck_setup, ck_teardown, \
      (void *)(uintptr_t)(backend) }

/* The last call was refused: one error more than `before`, its id, and a
 * text that has `part`. */
void ck_refused(const struct ck_machine *m, uint32_t before,
                enum hl_log_id id, const char *part);
/* A call that gives `result`, logs `id` and names `part`. */
#define CK_REFUSED(m, call, result, id, part)        \
    do {                                             \
        uint32_t errors_ = (m)->errors;              \
        assert_int_equal(call, result);              \
        ck_refused(m, errors_, id, part);            \
    } while (0)
/* A call that is fine, and says nothing. */
#define CK_ALLOWED(m, call)                          \
    do {                                             \
        uint32_t errors_ = (m)->errors;              \
        assert_int_equal(call, HL_OK);               \
        assert_int_equal((m)->errors, errors_);      \
    } while (0)

/* ---- caps ------------------------------------------------------------- */

/* lavapipe of Mesa 22.3.6 as its backend describes it, from a literal. */
void ck_lavapipe(struct hl_caps *out);

/* ---- numbers ---------------------------------------------------------- */

float ck_half(uint16_t half);
/* Toward nearest, ties to even; or toward zero. Finite input. */
uint16_t ck_half_nearest(float x);
uint16_t ck_half_truncate(float x);
/* Units in the last place between two finite floats. */
uint32_t ck_ulps(float a, float b);
/* Doubles in [low, high). */
double ck_between(uint64_t *seed, double low, double high);

/* |got - want| <= tolerance (and neither NaN), or fail with both. */
#define ck_near(got, want, tolerance) \
    ck_near_at(__FILE__, __LINE__, #got, got, want, tolerance)
void ck_near_at(const char *file, int line, const char *what, double got,
                double want, double tolerance);

/* ---- pictures --------------------------------------------------------- */

/* A target read back as linear RGBA floats, from malloc; RGBA16_FLOAT,
 * RGBA32_FLOAT, RGBA16_UNORM. *w and *h may be NULL. */
float *ck_read(struct hl_device *d, hl_tex tex, uint32_t *w, uint32_t *h);
#endif
