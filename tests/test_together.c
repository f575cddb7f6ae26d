/* SPDX-License-Identifier: Zlib */
/* Devices live together: two of Vulkan, one of GL and the software device are
 * open at once, draw the same scene in turn and are closed in every order.
 * Each has memory of its own, all of which it gives back, and a neighbour that
 * comes or goes changes no bit of its frames.
 *
 * Leaks below the hooks, in drivers too, with LeakSanitizer:
 *   echo 'int dlclose(void *h) { return !h; }' > noclose.c && gcc -c noclose.c
 *   make config=sanitize B=build/leak LDFLAGS=$PWD/noclose.o \
 *       build/leak/tests/test_together
 *   echo leak:libOSMesa.so > leaks
 *   ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 \
 *       LSAN_OPTIONS=suppressions=leaks VK_LOADER_LAYERS_DISABLE='~all~' \
 *       build/leak/tests/test_together
 * A driver that stays loaded can be named in a report, and lavapipe's last
 * 128 bytes stay in reach; OSMesa leaves some of its own; the validation layers
 * leak theirs, and so stay out. fast_unwind_on_malloc=0 would stop the
 * drivers' compilers for good. */
#include <stdlib.h>
#include <string.h>
#include "tests/frame_kit.h"

enum { DEVICES = 4, ORDERS = 24, ROUNDS = 3, W = 64, H = 36,
       BYTES = W * H * 8 };

static const char *const backends[DEVICES] = { "vulkan", "vulkan", "gl",
                                               "packemu" };

/* A device, its scene and its renderer. Not to be moved while open. */
struct place {
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    uint8_t first[BYTES], now[BYTES];
};

static struct place places[DEVICES];

/* Skip where one is missing, before any is left open. */
static void all_are_here(void)
{
    struct ck_machine m;
    for (int i = 0; i < DEVICES; i++) {
        if (!ck_open(&m, backends[i], NULL)) {
            print_message("skipped: no %s device: %s\n", backends[i], m.last);
            skip();
        }
        ck_close(&m);
    }
}

static void open_place(struct place *p, const char *backend)
{
    uint64_t seed = 3;
    assert_true(ck_open(&p->m, backend, NULL));
    fk_begin(&p->s, &p->m);
    fk_room(&p->s, 12, &seed);
    p->s.needs.width = W;
    p->s.needs.height = H;
    p->s.needs.light_path = HL_LIGHT_PATH_TILES;
    fk_prepare(&p->run, &p->s, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&p->run), HL_OK);
}

static void close_place(struct place *p)
{
    fk_destroy(&p->run);
    fk_end(&p->s);
    assert_int_equal(hl_device_validation_errors(p->m.device), 0);
    ck_close(&p->m);
    assert_int_equal(p->m.memory.n_live, 0);
}

static void draw_place(struct place *p, uint8_t *out)
{
    struct hl_device *d = p->m.device;
    struct hl_tex_desc t;
    hl_tex frame = hl_renderer_output(p->run.r);
    assert_true(hl_tex_info(d, frame, &t));
    assert_int_equal(t.width * t.height * hl_format_info(t.format)->bytes,
                     BYTES);
    assert_int_equal(hl_frame_draw(p->run.r, &p->s.frame, NULL), HL_OK);
    assert_int_equal(hl_submit(d, true), HL_OK);
    assert_int_equal(hl_tex_read(d, frame, out, BYTES), HL_OK);
}

static void draws_as_ever(struct place *p)
{
    draw_place(p, p->now);
    if (memcmp(p->now, p->first, BYTES))
        fail_msg("%s: a frame is not as its first",
                 backends[p - places]);
}

/* The n-th order of 0..DEVICES-1, by its digits of falling base. */
static void order_of(int n, int out[DEVICES])
{
    int left[DEVICES] = { 0, 1, 2, 3 };
    for (int i = 0; i < DEVICES; i++) {
        int base = DEVICES - i, k = n % base;
        out[i] = left[k];
        left[k] = left[base - 1];
        n /= base;
    }
}

/* A picture: neither black nor one colour, so that equal ones say something. */
static void shows_something(const uint8_t *frame)
{
    uint32_t other = 0;
    for (int i = 8; i < BYTES; i += 8)
        other += memcmp(frame + i, frame, 6) != 0;
    assert_true(other > W * H / 10);
}

static void devices_close_in_any_order(void **state)
{
    (void)state;
    all_are_here();
    for (int n = 0; n < ORDERS; n++) {
        int order[DEVICES];
        order_of(n, order);
        for (int i = 0; i < DEVICES; i++)
            open_place(&places[i], backends[i]);
        for (int i = 0; i < DEVICES && n == 0; i++)
            draw_place(&places[i], places[i].first);
        for (int round = 0; round < ROUNDS; round++)
            for (int i = 0; i < DEVICES; i++)
                draws_as_ever(&places[i]);
        for (int i = 0; i < DEVICES; i++) {
            close_place(&places[order[i]]);
            for (int k = i + 1; k < DEVICES; k++)
                draws_as_ever(&places[order[k]]);
        }
    }
    assert_memory_equal(places[0].first, places[1].first, BYTES);
    for (int i = 0; i < DEVICES; i++)
        shows_something(places[i].first);
}

/* Every order is one, and no two are the same. */
static void orders_are_all_there(void **state)
{
    bool seen[256] = { false };
    (void)state;
    for (int n = 0; n < ORDERS; n++) {
        int order[DEVICES], have = 0, code = 0;
        order_of(n, order);
        for (int i = 0; i < DEVICES; i++) {
            have |= 1 << order[i];
            code = code * DEVICES + order[i];
        }
        assert_int_equal(have, (1 << DEVICES) - 1);
        assert_false(seen[code]);
        seen[code] = true;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_are_all_there),
        cmocka_unit_test(devices_close_in_any_order),
    };
    return cmocka_run_group_tests_name("devices together", tests, NULL, NULL);
}
