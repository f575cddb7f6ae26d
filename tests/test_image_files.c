/* SPDX-License-Identifier: Zlib */
/* Pictures and ids in files: what goes out comes back, what is broken is
 * refused, and nothing half-written is left behind. */
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>
#include <jpeglib.h>
#include "platforms/host/image.h"
#include "tests/scene_kit.h"

enum { W = 5, H = 3, N = W * H * 3 };

static void make(struct hlh_picture *p, float *rgb)
{
    for (int i = 0; i < N; i++)
        rgb[i] = (float)i * 0.037f - 0.1f;
    p->width = W;
    p->height = H;
    p->rgb = rgb;
    p->linear = true;
}

static void pfm_comes_back_bit_for_bit(void **state)
{
    struct hlh_picture p, back;
    struct hlh_error e;
    float rgb[N];
    char path[SK_PATH], *bytes;
    size_t size;
    make(&p, rgb);
    rgb[7] = INFINITY;
    rgb[8] = NAN;
    rgb[9] = 1e-40f;
    sk_path(path, state, "p.pfm");
    assert_true(hlh_picture_write_pfm(&p, path, &e));
    assert_true(hlh_picture_read(&back, path, &e));
    assert_true(back.width == W && back.height == H && back.linear);
    assert_memory_equal(back.rgb, rgb, sizeof rgb);
    hlh_picture_free(&back);
    /* The format's own order: the bottom row comes first. */
    assert_true(hlh_file_read(&bytes, &size, path, &e));
    assert_memory_equal(bytes, "PF\n5 3\n-1.0\n", 12);
    assert_int_equal(size, 12 + sizeof rgb);
    assert_memory_equal(bytes + 12, &rgb[2 * W * 3], sizeof(float));
    free(bytes);
}

static void foreign_pfm_is_read(void **state)
{
    static const unsigned char grey[] =
        "Pf\r\n1 2\t1.0\n\x3f\x80\0\0\x40\0\0\0";       /* 1, above it 2 */
    struct hlh_picture p;
    struct hlh_error e;
    char path[SK_PATH];
    sk_path(path, state, "g.pfm");
    sk_write(state, "g.pfm", grey, sizeof grey - 1);
    assert_true(hlh_picture_read(&p, path, &e));
    assert_true(p.rgb[0] == 2 && p.rgb[2] == 2 && p.rgb[3] == 1);
    hlh_picture_free(&p);
}

static void bad_pfm_is_refused(void **state)
{
    static const char *const table[][2] = {
        {"P6\n1 1\n255\n", "does not start with PF"},
        {"", "does not start with PF"},
        {"PF\n0 1\n-1\n", "width is not 1 to 16384"},
        {"PF\n-1 1\n-1\n", "width is not"},
        {"PF\n1 99999\n-1\n", "height is not"},
        {"PF\n1 1\n0\n            ", "scale is not a number but 0"},
        {"PF\n1 1\nnan\n            ", "scale is not"},
        {"PF\n1 1\n-1", "has no scale"},
        {"PF\n1 1\n-1\n12345678901", "has 11 bytes of pixels where 1 x 1 "
         "need 12"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct hlh_picture p;
        struct hlh_error e;
        char path[SK_PATH];
        sk_write_text(state, "bad.pfm", table[i][0]);
        sk_path(path, state, "bad.pfm");
        assert_false(hlh_picture_read(&p, path, &e));
        sk_assert_contains(e.text, "bad.pfm: PFM: ");
        sk_assert_contains(e.text, table[i][1]);
        assert_null(p.rgb);
    }
}

/* sRGB (IEC 61966-2-1) of 0.5 is 0.7354: 188. Half of it, by exposure, is
 * 0.25: 0.5371, 137. What is outside 0..1 is clamped, NaN is black. */
static void png_is_srgb_of_the_exposed_value(void **state)
{
    float rgb[N] = {0.5f, 0, 1, -1, 2, NAN, INFINITY, 0.0031308f, 0.002f};
    struct hlh_picture p, back;
    struct hlh_error e;
    struct hlh_image image;
    char path[SK_PATH], *bytes;
    size_t size;
    make(&p, rgb);
    rgb[0] = 0.5f, rgb[1] = 0, rgb[2] = 1, rgb[3] = -1, rgb[4] = 2;
    rgb[5] = NAN, rgb[6] = INFINITY, rgb[7] = 0.0031308f, rgb[8] = 0.002f;
    sk_path(path, state, "p.png");
    assert_true(hlh_picture_write_png(&p, 0, path, &e));
    assert_true(hlh_file_read(&bytes, &size, path, &e));
    assert_true(hlh_image_decode(&image, bytes, size, "p", &e));
    assert_memory_equal(image.rgba, "\274\0\377\377\0\377\0\377\377\12\7\377",
                        12);
    free(image.rgba);
    free(image.name);
    /* A picture cut short is refused, not shown grey. */
    assert_false(hlh_image_decode(&image, bytes, size - 20, "cut", &e));
    sk_assert_contains(e.text, "cut: PNG: ");
    free(bytes);
    assert_true(hlh_picture_write_png(&p, -1, path, &e));
    assert_true(hlh_picture_read(&back, path, &e));
    assert_false(back.linear);
    /* Read back as the middle of code 137's interval: the next code is 0.004
     * of 0.25 away. */
    assert_true(fabsf(back.rgb[0] - 0.25f) < 0.003f);
    hlh_picture_free(&back);
}

/* Every 8-bit code is a fixed point of reading and writing. */
static void png_codes_are_fixed_points(void **state)
{
    struct hlh_picture p = {256, 1, NULL, true}, back;
    struct hlh_error e;
    char path[SK_PATH];
    p.rgb = calloc(256 * 3, sizeof *p.rgb);
    assert_non_null(p.rgb);
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++) {
            double v = i / 255.0;
            p.rgb[i * 3 + c] = (float)(v <= 0.04045
                ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
        }
    sk_path(path, state, "codes.png");
    assert_true(hlh_picture_write_png(&p, 0, path, &e));
    assert_true(hlh_picture_read(&back, path, &e));
    for (int i = 0; i < 256 * 3; i++)
        assert_true(back.rgb[i] == p.rgb[i]);
    hlh_picture_free(&back);
    hlh_picture_free(&p);
}

static void ids_come_back(void **state)
{
    static const uint32_t largest[] = {65535, 65536, 4294967295u};
    for (size_t i = 0; i < 3; i++) {
        uint32_t ids[6] = {0, 1, 255, 256, 54321, 0}, *back, w, h;
        struct hlh_error e;
        char path[SK_PATH];
        ids[5] = largest[i];
        sk_path(path, state, "ids.png");
        assert_true(hlh_ids_write_png(ids, 3, 2, path, &e));
        if (!hlh_ids_read_png(&back, &w, &h, path, &e))
            fail_msg("%s", e.text);
        assert_true(w == 3 && h == 2);
        assert_memory_equal(back, ids, sizeof ids);
        free(back);
    }
}

static void a_picture_is_not_ids(void **state)
{
    struct hlh_picture p;
    struct hlh_error e;
    float rgb[N];
    uint32_t *ids, w, h;
    char path[SK_PATH];
    make(&p, rgb);
    sk_path(path, state, "rgb.png");
    assert_true(hlh_picture_write_png(&p, 0, path, &e));
    assert_false(hlh_ids_read_png(&ids, &w, &h, path, &e));
    sk_assert_contains(e.text, "ids are 16-bit grey or 8-bit RGBA");
    assert_null(ids);
}

static unsigned char *make_jpeg(J_COLOR_SPACE space, unsigned long *size)
{
    struct jpeg_compress_struct c;
    struct jpeg_error_mgr e;
    unsigned char *out = NULL;
    c.err = jpeg_std_error(&e);
    jpeg_create_compress(&c);
    *size = 0;
    jpeg_mem_dest(&c, &out, size);
    c.image_width = 16;
    c.image_height = 8;
    c.input_components = space == JCS_CMYK ? 4 : space == JCS_RGB ? 3 : 1;
    c.in_color_space = space;
    jpeg_set_defaults(&c);
    jpeg_set_quality(&c, 100, TRUE);
    jpeg_start_compress(&c, TRUE);
    for (int y = 0; y < 8; y++) {
        unsigned char line[64];
        unsigned char *row = line;
        for (int i = 0; i < 64; i++)
            line[i] = (unsigned char)(space == JCS_RGB ? i % 3 * 100 : 77);
        jpeg_write_scanlines(&c, &row, 1);
    }
    jpeg_finish_compress(&c);
    jpeg_destroy_compress(&c);
    return out;
}

/* A flat colour at quality 100 survives but for the rounding of the colour
 * transform, there and back: 2 codes. */
static void jpeg_is_decoded(void **state)
{
    static const J_COLOR_SPACE spaces[] = {JCS_RGB, JCS_GRAYSCALE};
    static const int want[2][3] = {{0, 100, 200}, {77, 77, 77}};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct hlh_image image;
        struct hlh_error e;
        unsigned long size;
        unsigned char *bytes = make_jpeg(spaces[i], &size);
        if (!hlh_image_decode(&image, bytes, size, "j", &e))
            fail_msg("%s", e.text);
        assert_true(image.width == 16 && image.height == 8);
        assert_string_equal(image.name, "j");
        for (int k = 0; k < 16 * 8; k++) {
            for (int c = 0; c < 3; c++)
                assert_in_range(image.rgba[k * 4 + c] + 2 - want[i][c], 0, 4);
            assert_int_equal(image.rgba[k * 4 + 3], 255);
        }
        free(image.rgba);
        free(image.name);
        free(bytes);
    }
}

static void broken_images_are_refused(void **state)
{
    struct hlh_image image;
    struct hlh_error e;
    unsigned long size;
    unsigned char *bytes = make_jpeg(JCS_RGB, &size);
    (void)state;
    assert_false(hlh_image_decode(&image, bytes, size / 2, "half", &e));
    sk_assert_contains(e.text, "half: JPEG: ");
    assert_null(image.rgba);
    /* libjpeg would paint the rest grey and only warn. */
    assert_false(hlh_image_decode(&image, bytes, size - 12, "cut", &e));
    sk_assert_contains(e.text, "cut: JPEG: Premature end");
    free(bytes);
    bytes = make_jpeg(JCS_CMYK, &size);
    assert_false(hlh_image_decode(&image, bytes, size, "cmyk", &e));
    sk_assert_contains(e.text, "cmyk: JPEG: ");
    free(bytes);
    assert_false(hlh_image_decode(&image, "GIF89a", 6, "gif", &e));
    sk_assert_contains(e.text, "gif: is neither a PNG nor a JPEG image");
    assert_false(hlh_image_decode(&image, "", 0, "none", &e));
}

/* IHDR of 20,000 x 20,000: refused by its header, before memory is asked
 * for. */
static void a_huge_png_is_refused_by_its_header(void **state)
{
    unsigned char png[33] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13,
                             'I', 'H', 'D', 'R', 0, 0, 0x4e, 0x20, 0, 0, 0x4e,
                             0x20, 8, 6, 0, 0, 0};
    struct hlh_image image;
    struct hlh_error e;
    uint32_t crc = 0xffffffff;
    (void)state;
    for (int i = 12; i < 29; i++) {
        crc ^= png[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (int k = 0; k < 4; k++)
        png[29 + k] = (unsigned char)(~crc >> (24 - 8 * k));
    assert_false(hlh_image_decode(&image, png, sizeof png, "huge", &e));
    sk_assert_contains(e.text, "huge: PNG: ");
    sk_assert_contains(e.text, "IHDR");
}

static void writes_are_whole_or_not_at_all(void **state)
{
    struct hlh_error e;
    struct stat info;
    char path[SK_PATH], link_path[SK_PATH], *bytes;
    size_t size;
    int before, pipe_end;
    sk_path(path, state, "out.txt");
    assert_true(hlh_file_write(path, "one", 3, &e));
    assert_true(hlh_file_write(path, "three", 5, &e));
    assert_true(hlh_file_read(&bytes, &size, path, &e));
    assert_int_equal(size, 5);
    assert_string_equal(bytes, "three");
    free(bytes);
    before = sk_count(state);
    sk_path(path, state, "gone/out.txt");
    assert_false(hlh_file_write(path, "x", 1, &e));
    sk_assert_contains(e.text, "gone/out.txt: cannot be created: No such");
    assert_false(hlh_file_write(*state, "x", 1, &e));
    sk_assert_contains(e.text, "is a directory");
    assert_int_equal(sk_count(state), before);
    /* A link stays a link; a pipe (or a device) is written into. */
    sk_path(path, state, "out.txt");
    sk_path(link_path, state, "link.txt");
    assert_int_equal(symlink(path, link_path), 0);
    assert_true(hlh_file_write(link_path, "four", 4, &e));
    assert_int_equal(lstat(link_path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_size, 4);
    sk_path(path, state, "pipe");
    assert_int_equal(mkfifo(path, 0600), 0);
    pipe_end = open(path, O_RDONLY | O_NONBLOCK);
    assert_true(pipe_end >= 0);
    assert_true(hlh_file_write(path, "five!", 5, &e));
    assert_int_equal(read(pipe_end, link_path, SK_PATH), 5);
    close(pipe_end);
    assert_int_equal(stat(path, &info), 0);
    assert_true(S_ISFIFO(info.st_mode));
}

/* A limit on file sizes stands for a full disk: the write fails half-way. */
static void a_full_disk_leaves_nothing(void **state)
{
    struct rlimit before, small;
    struct hlh_error e;
    char path[SK_PATH], bytes[4096] = {0}, *kept;
    int n = sk_count(state);
    size_t size;
    bool ok;
    sk_path(path, state, "full.txt");
    assert_true(hlh_file_write(path, "old", 3, &e));
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before;
    small.rlim_cur = 1000;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    ok = hlh_file_write(path, bytes, sizeof bytes, &e);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_false(ok);
    sk_assert_contains(e.text, "full.txt: cannot be written: File too large");
    assert_int_equal(sk_count(state), n + 1);
    assert_true(hlh_file_read(&kept, &size, path, &e));
    assert_string_equal(kept, "old");
    free(kept);
}

static void reading_says_what_is_wrong(void **state)
{
    struct hlh_picture p;
    struct hlh_error e;
    char path[SK_PATH], *bytes;
    size_t size;
    sk_path(path, state, "nothing.png");
    assert_false(hlh_picture_read(&p, path, &e));
    sk_assert_contains(e.text, "nothing.png: cannot be opened: No such");
    assert_false(hlh_picture_read(&p, "x.gif", &e));
    sk_assert_contains(e.text, "x.gif: is neither a .png nor a .pfm");
    assert_false(hlh_file_read(&bytes, &size, *state, &e));
    sk_assert_contains(e.text, "cannot be read: Is a directory");
    assert_null(bytes);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(pfm_comes_back_bit_for_bit),
        cmocka_unit_test(foreign_pfm_is_read),
        cmocka_unit_test(bad_pfm_is_refused),
        cmocka_unit_test(png_is_srgb_of_the_exposed_value),
        cmocka_unit_test(png_codes_are_fixed_points),
        cmocka_unit_test(ids_come_back),
        cmocka_unit_test(a_picture_is_not_ids),
        cmocka_unit_test(jpeg_is_decoded),
        cmocka_unit_test(broken_images_are_refused),
        cmocka_unit_test(a_huge_png_is_refused_by_its_header),
        cmocka_unit_test(writes_are_whole_or_not_at_all),
        cmocka_unit_test(a_full_disk_leaves_nothing),
        cmocka_unit_test(reading_says_what_is_wrong),
    };
    return cmocka_run_group_tests_name("image files", tests, sk_setup,
                                       sk_teardown);
}
