/* SPDX-License-Identifier: Zlib */
/* shaders/shared compiled as C and as GLSL, side by side: a stage of the
 * test's own evaluates every function on a device for a texture full of
 * arguments. Codes must be equal, floats within what Vulkan allows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/check.h"
#include "tests/stage_kernels.h"

static const uint32_t pack_spirv[] = {
#include "pack_frag.x"
};
static const char pack_glsl[] = {
#include "pack_frag_glsl.x"
};

enum { SIDE = 256, N = SIDE * SIDE };

struct bench {
    struct ck_machine *m;
    float (*args)[4];
    float (*got)[4];         /* by the device                                */
    float (*want)[4];        /* by C                                         */
    hl_tex input, output, codes;
    hl_tex other;            /* bound where nothing is read                  */
    hl_tex numbers;          /* {0} but while function 24 reads one          */
    uint16_t (*code)[2];
};

/* ---- the device's side ------------------------------------------------ */

static hl_tex make_tex(struct ck_machine *m, enum hl_format f,
                       enum hl_format sample_as)
{
    struct hl_tex_desc d = { .format = f, .sample_as = sample_as,
                             .width = SIDE, .height = SIDE,
                             .usage = HL_TEX_SAMPLED | HL_TEX_TARGET |
                                      HL_TEX_READBACK };
    hl_tex t;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    return t;
}

static struct bench *begin(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct bench *b = calloc(1, sizeof *b);
    assert_non_null(b);
    b->m = m;
    b->args = calloc(N, sizeof *b->args);
    b->got = calloc(N, sizeof *b->got);
    b->want = calloc(N, sizeof *b->want);
    b->code = calloc(N, sizeof *b->code);
    b->input = make_tex(m, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE);
    b->output = make_tex(m, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE);
    b->codes = make_tex(m, HL_FORMAT_RG16_UNORM, HL_FORMAT_R32_UINT);
    b->other = make_tex(m, HL_FORMAT_RG16_UNORM, HL_FORMAT_R32_UINT);
    return b;
}

static void end(struct bench *b)
{
    hl_tex_destroy(b->m->device, &b->input);
    hl_tex_destroy(b->m->device, &b->output);
    hl_tex_destroy(b->m->device, &b->codes);
    hl_tex_destroy(b->m->device, &b->other);
    free(b->args);
    free(b->got);
    free(b->want);
    free(b->code);
    free(b);
}

static void draw(struct bench *b, uint32_t what, enum hl_format format,
                 hl_tex target, hl_tex second)
{
    struct hl_device *d = b->m->device;
    struct hl_code code = { pack_spirv, sizeof pack_spirv, pack_glsl,
                            pack_kernel() };
    struct hl_prog_desc p = {
        .label = "pack", .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_NONE, &code }, .spec = { { 0, what } },
        .n_specs = 1, .n_colors = 1, .color = { format } };
    struct hl_texture_binding textures[3] = { { .tex = b->input },
                                              { .tex = second },
                                              { .tex = b->numbers } };
    struct hl_draw draw = { .count = 3, .textures = textures,
                            .n_textures = 3 };
    struct hl_pass pass = { .label = "pack", .n_colors = 1, .draws = &draw,
                            .n_draws = 1 };
    pass.color[0].tex = target;
    pass.color[0].load = HL_LOAD_DISCARD;
    assert_int_equal(hl_prog_create(d, &draw.prog, &p), HL_OK);
    assert_int_equal(hl_tex_write(d, b->input, 0, b->args,
                                  N * sizeof *b->args), HL_OK);
    assert_int_equal(hl_pass_run(d, &pass), HL_OK);
    hl_prog_destroy(d, &draw.prog);
}

static void evaluate(struct bench *b, uint32_t what)
{
    draw(b, what, HL_FORMAT_RGBA32_FLOAT, b->output, b->other);
    assert_int_equal(hl_tex_read(b->m->device, b->output, b->got,
                                 N * sizeof *b->got), HL_OK);
}

static void store(struct bench *b, uint32_t what)
{
    draw(b, what, HL_FORMAT_RG16_UNORM, b->codes, b->other);
    assert_int_equal(hl_tex_read(b->m->device, b->codes, b->code,
                                 N * sizeof *b->code), HL_OK);
}

/* ---- comparing -------------------------------------------------------- */

/* |got - want| <= absolute + relative |want| of channel `c`; the worst use
 * of that tolerance is printed. */
static void compare(const struct bench *b, int c, double absolute,
                    double relative, const char *what)
{
    double worst = 0;
    for (uint32_t i = 0; i < N; i++) {
        double w = (double)b->want[i][c], g = (double)b->got[i][c];
        double limit = absolute + relative * fabs(w);
        if (!(fabs(g - w) <= limit))
            fail_msg("%s of %.9g %.9g %.9g %.9g: device %.9g, C %.9g", what,
                     (double)b->args[i][0], (double)b->args[i][1],
                     (double)b->args[i][2], (double)b->args[i][3], g, w);
        if (limit > 0 && fabs(g - w) / limit > worst)
            worst = fabs(g - w) / limit;
    }
    print_message("%s: %.0f %% of the tolerance used\n", what, worst * 100);
}

/* The 16-bit codes of a value are equal, but where the value lies within
 * `error` of the middle between two codes: there they may be neighbours. */
static uint32_t compare_codes(const struct bench *b, int c, double error)
{
    uint32_t ties = 0;
    for (uint32_t i = 0; i < N; i++) {
        double w = (double)b->want[i][c] * 65535;
        double g = (double)b->got[i][c] * 65535;
        double x = floor(w + 0.5), y = floor(g + 0.5);
        if (x == y)
            continue;
        ties++;
        if (fabs(x - y) > 1 || fabs(fabs(w - floor(w)) - 0.5) > error * 65535)
            fail_msg("argument %u: code %.0f on the device, %.0f in C", i, y,
                     x);
    }
    return ties;
}

static void four(float out[4], float x, float y, float z, float w)
{
    out[0] = x;
    out[1] = y;
    out[2] = z;
    out[3] = w;
}

/* ---- functions -------------------------------------------------------- */

/* Vulkan: inversesqrt 2 ulp, sqrt and 1 / x 2.5 ulp each: with the sums
 * 8 ulp of a value up to 1, 2^-21. */
static void normals_encode_alike(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        double z = ck_between(&seed, -0.9999, 1), phi = ck_between(&seed, 0, 7);
        double r = sqrt(1 - z * z);
        float *a = b->args[i];
        four(a, (float)(r * cos(phi)), (float)(r * sin(phi)), (float)z, 0);
        hl_vec2 e = hl_normal_encode(hl_v3(a[0], a[1], a[2]));
        four(b->want[i], e.x, e.y, 0, 0);
    }
    evaluate(b, 0);
    for (int c = 0; c < 2; c++)
        compare(b, c, ldexp(1, -21), 0, "hl_normal_encode");
    for (uint32_t i = 0; i < N; i++)
        for (int c = 0; c < 2; c++) {
            b->want[i][c] = hl_snorm_to_unorm(b->want[i][c]);
            b->got[i][c] = hl_snorm_to_unorm(b->got[i][c]);
        }
    uint32_t ties = compare_codes(b, 0, ldexp(1, -22)) +
                    compare_codes(b, 1, ldexp(1, -22));
    print_message("%u of %u codes were ties\n", ties, N * 2);
    end(b);
}

static void singular_normals_encode_alike(void **state)
{
    struct bench *b = begin(state);
    four(b->args[0], 0, 0, -1, 0);
    for (uint32_t i = 1; i < N; i++)
        four(b->args[i], 0, 0, 0, 0);
    evaluate(b, 0);
    for (uint32_t i = 0; i < N; i++)
        assert_true(b->got[i][0] == 0 && b->got[i][1] == 0);
    end(b);
}

/* sqrt 2.5 ulp of at most 1, doubled; products 3 more: 2^-20. Near r = 1 the
 * root of a difference magnifies: its error e gives sqrt e, at most 2^-11.5
 * for e = 2^-23, which counts only times the component it scales. */
static void normals_decode_alike(void **state)
{
    struct bench *b = begin(state);
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        float x = hl_unorm_to_snorm((float)(i % SIDE * 257) / 65535.0f);
        float y = hl_unorm_to_snorm((float)(i / SIDE * 257) / 65535.0f);
        four(a, x, y, 0, 0);
        hl_vec3 n = hl_normal_decode(hl_v2(x, y));
        four(b->want[i], n.x, n.y, n.z, 0);
    }
    evaluate(b, 1);
    for (uint32_t i = 0; i < N; i++) {
        double x = (double)b->args[i][0], y = (double)b->args[i][1];
        double z2 = 1 - x * x - y * y, z = z2 > 0 ? sqrt(z2) : 0;
        double e = 2 * (z > 5e-4 ? ldexp(1, -23) / z : 3.5e-4) + ldexp(1, -20);
        for (int c = 0; c < 3; c++)
            ck_near((double)b->got[i][c], (double)b->want[i][c], e);
    }
    end(b);
}

static void exact_functions_are_exact(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        float w = hl_mesh_pack_tangent_w(i & 1 ? 1.0f : -1.0f,
                                         mk_below(&seed, 1u << 24));
        four(b->args[i], (float)ck_between(&seed, -1, 1), mk_unit(&seed), w,
             0);
        four(b->want[i], hl_snorm_to_unorm(b->args[i][0]),
             hl_unorm_to_snorm(b->args[i][1]), hl_tangent_w_group(w),
             hl_tangent_w_sign(w));
    }
    evaluate(b, 2);
    /* A device may contract a b + c: one rounding of the product less. */
    compare(b, 0, 6e-8, 0, "hl_snorm_to_unorm");
    compare(b, 1, 6e-8, 0, "hl_unorm_to_snorm");
    compare(b, 2, 0, 0, "hl_tangent_w_group");
    compare(b, 3, 0, 0, "hl_tangent_w_sign");
    for (uint32_t i = 0; i < N; i++) {
        four(b->args[i], (float)i, 0, 0, 0);
        four(b->want[i], (float)(i >> 8), (float)(i & 255), (float)i, 0);
    }
    evaluate(b, 3);
    for (int c = 0; c < 3; c++)
        compare(b, c, 0, 0, "hl_split16, hl_join16");
    end(b);
}

static void depth_and_exponent_encode_alike(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        four(b->args[i], (float)ck_between(&seed, -1, 120), 0.01f, (float)i,
             1.0f / 65535);
        four(b->want[i], hl_depth_encode(b->args[i][0], 0.01f),
             hl_id_encode((float)i, 1.0f / 65535), 0, 0);
    }
    evaluate(b, 4);
    compare(b, 0, 0, 0, "hl_depth_encode");
    compare(b, 1, 0, 0, "hl_id_encode");
    for (uint32_t i = 0; i < N; i++) {
        float n = (float)exp2(ck_between(&seed, 0, 8));
        four(b->args[i], n, (float)i / (N - 1), 0, 0);
        four(b->want[i], hl_exponent_encode(n),
             hl_exponent_decode(b->args[i][1]), 0, 0);
    }
    evaluate(b, 5);
    /* log2: 3 ulp of at most 8 (2^-21 absolute below 2), an eighth of it;
     * exp2: 3 + 2 x ulp, x up to 8. */
    compare(b, 0, 3 * ldexp(1, -23), 0, "hl_exponent_encode");
    compare(b, 1, 0, 19 * ldexp(1, -23), "hl_exponent_decode");
    compare_codes(b, 0, 3 * ldexp(1, -23));
    end(b);
}

/* Sums and products round alike in both; 1 / x is 2.5 ulp, pow is exp2 of
 * y log2 x: 2^-21 y absolute in the exponent, so 2^-21 y ln 2 of the value
 * and 3 + 2 |y log2 x| ulp. */
static void light_model_is_alike(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        four(a, (float)exp(ck_between(&seed, -12, 5)),
             (float)exp(ck_between(&seed, -5, 5)),
             (float)ck_between(&seed, -1, 1), (float)ck_between(&seed, 0, 9));
        four(b->want[i], hl_falloff_smooth(a[0], a[1]),
             hl_falloff_inverse_square(a[0], a[1]),
             hl_spot(a[2], a[3], 0.25f), hl_clamp01(a[2]));
    }
    evaluate(b, 6);
    compare(b, 0, 3e-7, 0, "hl_falloff_smooth");
    /* Where the window 1 - q^2 is small, its rounding counts fully: 1.2e-7
     * of 1 / d2, which is 1e4 at most. */
    for (uint32_t i = 0; i < N; i++) {
        double d2 = fmax((double)b->args[i][0], 1e-4);
        ck_near((double)b->got[i][1], (double)b->want[i][1], 6e-7 / d2);
    }
    compare(b, 2, 1e-5, 0, "hl_spot");
    compare(b, 3, 0, 0, "hl_clamp01");
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        four(a, mk_unit(&seed), (float)ck_between(&seed, 1, 256),
             mk_unit(&seed), mk_unit(&seed));
        four(b->want[i], hl_specular(a[0], a[1]),
             hl_luminance(hl_v3(a[0], a[1], a[2])),
             hl_specular_scale(hl_v3(a[0], a[1], a[2]), a[3]), 0);
    }
    evaluate(b, 7);
    for (uint32_t i = 0; i < N; i++) {
        double x = (double)b->args[i][0], n = (double)b->args[i][1];
        double w = (double)b->want[i][0];
        double l = x > 0 ? fabs(n * log2(x)) : 0;
        double e = n * ldexp(1, -21) * 0.7 + (3 + 2 * l) * ldexp(1, -23);
        ck_near((double)b->got[i][0], w, w * e + 1.2e-38);
    }
    compare(b, 1, 0, 4e-7, "hl_luminance");
    compare(b, 2, 0, 1e-6, "hl_specular_scale");
    end(b);
}

static void material_is_alike(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        four(a, mk_unit(&seed), mk_unit(&seed), mk_unit(&seed),
             mk_unit(&seed));
        hl_vec3 ks = hl_material_specular(hl_v3(a[0], a[1], a[2]), a[3], 20);
        four(b->want[i], ks.x, ks.y, ks.z, hl_roughness_exponent(a[3]));
    }
    evaluate(b, 8);
    for (int c = 0; c < 3; c++)
        compare(b, c, 1e-6, 0, "hl_material_specular");
    /* 2 / alpha^2 by 2.5 ulp, up to 258. */
    compare(b, 3, 1e-6, 5e-7, "hl_roughness_exponent");
    for (uint32_t i = 0; i < N; i++) {
        const float *a = b->args[i];
        hl_vec3 rho = hl_material_albedo(hl_v3(a[0], a[1], a[2]), a[3]);
        four(b->want[i], rho.x, rho.y, rho.z, 0);
    }
    evaluate(b, 9);
    for (int c = 0; c < 3; c++)
        compare(b, c, 1.2e-7, 0, "hl_material_albedo");
    end(b);
}

static void filter_is_alike(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        float f = i % 7 ? mk_unit(&seed) : 0.0f;
        four(a, f, mk_unit(&seed), (float)(i & 15), 0);
        hl_vec4 v = hl_bilinear(hl_v2(a[0], a[1]));
        four(b->want[i], v.x, v.y, v.z, v.w);
    }
    evaluate(b, 10);
    for (int c = 0; c < 4; c++)
        compare(b, c, 1.2e-7, 0, "hl_bilinear");
    for (uint32_t i = 0; i < N; i++) {
        hl_vec4 v = hl_bilinear(hl_v2(b->args[i][0], b->args[i][1]));
        hl_vec4 t = hl_v4((float)(i & 1), (float)(i >> 1 & 1),
                          (float)(i >> 2 & 1), (float)(i >> 3 & 1));
        v = hl_dsf_weights(v, t);
        four(b->want[i], v.x, v.y, v.z, v.w);
    }
    evaluate(b, 11);
    for (int c = 0; c < 4; c++)
        compare(b, c, 5e-7, 0, "hl_dsf_weights");
    for (uint32_t i = 0; i < N; i++) {
        float *a = b->args[i];
        four(a, (float)ck_between(&seed, 0, 50),
             (float)ck_between(&seed, 0, 50),
             (float)ck_between(&seed, 0, 20), mk_unit(&seed));
        four(b->want[i],
             hl_dsf_threshold(0.01f, 1.5f, 0.001f, a[0], a[1], a[2]),
             hl_dsf_accept(a[0], a[3], a[1], a[3], a[2], 0.5f), 0, 0);
    }
    evaluate(b, 12);
    compare(b, 0, 0, 4e-7, "hl_dsf_threshold");
    compare(b, 1, 0, 0, "hl_dsf_accept");
    end(b);
}

/* ---- through a format ------------------------------------------------- */

/* What a G-buffer of two 16-bit channels really holds: the code next to the
 * value. Vulkan lets a conversion be off by 0.6 of a code. */
static void unorm16_targets_round_to_the_next_code(void **state)
{
    struct bench *b = begin(state);
    uint64_t seed = mk_seed();
    uint32_t off = 0;
    for (uint32_t i = 0; i < N; i++)
        four(b->args[i], (float)ck_between(&seed, -1, 1),
             (float)ck_between(&seed, -1, 1), 0, 0);
    store(b, 21);
    for (uint32_t i = 0; i < N; i++)
        for (int c = 0; c < 2; c++) {
            double x = (double)hl_snorm_to_unorm(b->args[i][c]) * 65535;
            assert_true(fabs((double)b->code[i][c] - x) <= 0.6);
            off += (double)b->code[i][c] != floor(x + 0.5);
        }
    print_message("%u of %u codes not the nearest\n", off, N * 2);
    end(b);
}

static void ids_survive_the_target(void **state)
{
    struct bench *b = begin(state);
    for (uint32_t i = 0; i < N; i++)
        four(b->args[i], 0, 0.01f, (float)i, 1.0f / 65535);
    store(b, 4);
    for (uint32_t i = 0; i < N; i++)
        assert_int_equal(b->code[i][1], i);
    draw(b, 20, HL_FORMAT_RGBA32_FLOAT, b->output, b->codes);
    assert_int_equal(hl_tex_read(b->m->device, b->output, b->got,
                                 N * sizeof *b->got), HL_OK);
    for (uint32_t i = 0; i < N; i++) {
        const float *g = b->got[i];
        if (g[0] != 1 || g[1] != 0 || g[2] != 0)
            fail_msg("id %u: accepted %g, with the next's %g, the last's %g",
                     i, (double)g[0], (double)g[1], (double)g[2]);
    }
    end(b);
}

/* ---- consoles ----------------------------------------------------------- */

/* Arguments: a number, an id, its steps and the mode; every id there is. */
static void console_arguments(struct bench *b, uint32_t mode)
{
    float steps = mode == HL_TWO16_SIGNED || mode == HL_TWO16_FIXED32
                  ? 65534.0f : 65535.0f;
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < N; i++)
        four(b->args[i], (float)ck_between(&seed, -0.1, 1.1),
             i < 65534 ? (float)i : 65534.0f, steps, (float)mode);
}

/* Bytes are whole codes, floats two roundings at the size of the range; a
 * device may keep the product's digits (one rounding less). */
static void pairs_encode_alike(void **state)
{
    static const double error[] = { 1.2e-7, 2.4e-7, 7.7e-6, 0, 0 };
    struct bench *b = begin(state);
    for (uint32_t mode = 0; mode <= HL_TWO16_BYTES_ARGB; mode++) {
        console_arguments(b, mode);
        uint32_t odd = 0;
        evaluate(b, 22);
        for (uint32_t i = 0; i < N; i++) {
            const float *a = b->args[i], *g = b->got[i];
            hl_vec4 v = hl_two16_encode(mode, a[0],
                                        hl_id_encode(a[1], 1.0f / a[2]));
            four(b->want[i], v.x, v.y, v.z, v.w);
            /* A code apart, where the number lies between two. */
            if (memcmp(b->want[i], g, 16) && mode >= HL_TWO16_BYTES) {
                double c = (double)hl_clamp01(a[0]) * 65535;
                assert_true(fabs(c - floor(c) - 0.5) < 0.02);
                memcpy(b->want[i], g, 16);
                odd++;
            }
        }
        assert_true(odd < N / 1000);
        for (int c = 0; c < 4; c++)
            compare(b, c, error[mode], 0, "hl_two16_encode");
    }
    end(b);
}

static void pairs_and_bytes_decode_alike(void **state)
{
    struct bench *b = begin(state);
    for (uint32_t mode = 0; mode <= HL_TWO16_BYTES_ARGB; mode++) {
        uint64_t seed = mk_seed();
        for (uint32_t i = 0; i < N; i++) {
            float *a = b->args[i];
            for (int c = 0; c < 3; c++)
                a[c] = (float)mk_below(&seed, 256) / 255.0f;
            a[3] = (float)mode;
            hl_vec2 v = hl_two16_decode(mode, hl_v2(a[0], a[1]));
            four(b->want[i], v.x, v.y, hl_depth_barg(hl_v3(a[0], a[1], a[2])),
                 0);
        }
        evaluate(b, 23);
        compare(b, 0, 6e-8, 0, "hl_two16_decode");
        compare(b, 1, 6e-8, 0, "hl_two16_decode");
        /* The sum is exact, the quotient 2.5 ulp. */
        compare(b, 2, 0, 2.5 * ldexp(1, -23), "hl_depth_barg");
    }
    end(b);
}

/* Every id through a target of each kind that stand-ins have, sampled as
 * numbers: the nearest id is the one written, with room to spare (below half
 * a step; two roundings of 65535 steps are 0.008). */
static void ids_survive_as_numbers(void **state)
{
    static const struct {
        enum hl_format format, sample_as;
        uint32_t mode;
    } row[] = {
        { HL_FORMAT_RG16_UNORM, HL_FORMAT_NONE, HL_TWO16_UNORM },
        { HL_FORMAT_RG16_SNORM, HL_FORMAT_NONE, HL_TWO16_SIGNED },
        { HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RG16_UNORM, HL_TWO16_BYTES }
    };
    struct bench *b = begin(state);
    for (int k = 0; k < 3; k++) {
        hl_tex none = { 0 }, t = make_tex(b->m, row[k].format,
                                          row[k].sample_as);
        console_arguments(b, row[k].mode);
        draw(b, 22, row[k].format, t, b->other);
        b->numbers = t;
        evaluate(b, 24);
        b->numbers = none;
        hl_tex_destroy(b->m->device, &t);
        for (uint32_t i = 0; i < N; i++) {
            const float *g = b->got[i], *a = b->args[i];
            if (g[2] != a[1] || !(g[3] < 0.01f))
                fail_msg("mode %u, id %g: read %g, off by %g",
                         row[k].mode, (double)a[1], (double)g[2],
                         (double)g[3]);
            /* Half a code, and one rounding of the product. */
            ck_near((double)g[0], (double)hl_clamp01(a[0]),
                    0.5 / 65534 + 6e-7);
        }
    }
    end(b);
}

#define TEST(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(normals_encode_alike),
        TEST(singular_normals_encode_alike),
        TEST(normals_decode_alike),
        TEST(exact_functions_are_exact),
        TEST(depth_and_exponent_encode_alike),
        TEST(light_model_is_alike),
        TEST(material_is_alike),
        TEST(filter_is_alike),
        TEST(unorm16_targets_round_to_the_next_code),
        TEST(ids_survive_the_target),
        TEST(pairs_encode_alike),
        TEST(pairs_and_bytes_decode_alike),
        TEST(ids_survive_as_numbers),
    };
    return cmocka_run_group_tests_name("C and GLSL", tests, NULL, NULL);
}
