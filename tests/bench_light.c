/* SPDX-License-Identifier: Zlib */
/* The light loop of packemu beside a plain C loop over the same planes: not a
 * test, a program to run by hand on a quiet machine.
 *   bench_light [LIGHTS [THREADS [ROUNDS]]]
 * Both shade 800 x 450 points of a G-buffer under LIGHTS smooth point lights
 * with Blinn-Phong of one exponent, in bins of 64 x 64 handed to THREADS. The
 * plain loop reads positions and normals that are there as floats and calls
 * the C library's powf; packemu fetches and decodes its G-buffer (D32, RG16)
 * and rebuilds positions, each frame. ns a pixel a light, wall time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "platforms/null/hl_null.h"
#include "platforms/packemu/pe.h"
#include "shaders/shared/block.h"

enum { W = 800, H = 450, BINS_X = (W + PE_BIN - 1) / PE_BIN,
       BINS_Y = (H + PE_BIN - 1) / PE_BIN, TILE = 32,
       TILES_X = (W + TILE - 1) / TILE, TILES_Y = (H + TILE - 1) / TILE,
       MAX_LIGHTS = 1024, MAX_ROUNDS = 101 };

struct scene {
    uint32_t n_lights;
    float depth[H][W];
    uint16_t normal[H][W][2];
    float p[3][H][W], n[3][H][W];            /* of the plain loop            */
    float out[4][H][W];
    hl_vec4 light[MAX_LIGHTS * HL_POINT_VEC4S];
    uint32_t tile[TILES_X * TILES_Y][2];
    struct hl_frame_block frame;
    struct pe_state state;
    struct pe_texture depth_tex, normal_tex;
    struct pe_program program;
    struct pe_draw draw;
};

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* ---- the scene ----------------------------------------------------------- */

static float wave(float x) { return sinf(x) * 0.4f; }

/* A wavy wall four metres away, near plane 0.1, far 100. */
static void fill_texel(struct scene *s, int x, int y)
{
    float z = 4.0f + 0.2f * wave((float)x * 0.05f);
    float nx = wave((float)x * 0.05f), ny = wave((float)y * 0.07f);
    float nz = sqrtf(1.0f - nx * nx - ny * ny);
    float k = 1.0f / sqrtf(2.0f * (nz + 1.0f));
    s->depth[y][x] = s->frame.depth.x / z - s->frame.depth.y;
    s->normal[y][x][0] = (uint16_t)((nx * k * 0.5f + 0.5f) * 65535.0f + 0.5f);
    s->normal[y][x][1] = (uint16_t)((ny * k * 0.5f + 0.5f) * 65535.0f + 0.5f);
    hl_vec4 r = s->frame.ray_light;
    s->p[0][y][x] = (((float)x + 0.5f) * r.x + r.z) * z;
    s->p[1][y][x] = (((float)y + 0.5f) * r.y + r.w) * z;
    s->p[2][y][x] = -z;
    s->n[0][y][x] = nx;
    s->n[1][y][x] = ny;
    s->n[2][y][x] = nz;
}

static void fill_lights(struct scene *s)
{
    uint32_t seed = 1;
    float at[6];
    for (uint32_t i = 0; i < s->n_lights; i++) {
        for (int k = 0; k < 6; k++) {
            seed = seed * 1664525u + 1013904223u;
            at[k] = (float)(seed >> 8) * (1.0f / 16777216.0f);
        }
        s->light[2 * i] = hl_v4(at[0] * 6 - 3, at[1] * 4 - 2, at[2] - 3.5f,
                                1.0f / 9.0f);
        s->light[2 * i + 1] = hl_v4(at[3], at[4], at[5], 0);
    }
    for (int t = 0; t < TILES_X * TILES_Y; t++) {
        s->tile[t][0] = 0;
        s->tile[t][1] = s->n_lights;
    }
}

static void texture(struct pe_texture *t, enum hl_format f, void *memory)
{
    t->desc.format = t->desc.sample_as = t->stored = t->view = f;
    t->desc.width = W;
    t->desc.height = H;
    t->desc.samples = t->desc.mips = 1;
    t->desc.usage = HL_TEX_SAMPLED | HL_TEX_TARGET;
    t->words = t->samples = 1;
    t->memory = memory;
    t->bytes = (size_t)W * H * 4;
}

static void fill_draw(struct scene *s)
{
    struct pe_view *v = s->draw.view;
    texture(&s->depth_tex, HL_FORMAT_D32_FLOAT, s->depth);
    texture(&s->normal_tex, HL_FORMAT_RG16_UNORM, s->normal);
    for (int i = 0; i < HL_MAX_TEXTURES; i++)
        v[i].state = &s->state;
    v[HL_TEX_DEPTH].texture = &s->depth_tex;
    v[HL_TEX_NORMAL].texture = &s->normal_tex;
    s->program.spec[HL_SPEC_SPECULAR].u = HL_SPECULAR_CONSTANT;
    s->program.spec[HL_SPEC_FALLOFF].u = 1;
    s->program.spec[HL_SPEC_LIGHT_OUT].f = 1;
    s->draw.program = &s->program;
    s->draw.uniform[HL_SLOT_FRAME] = &s->frame;
    s->draw.uniform_bytes[HL_SLOT_FRAME] = sizeof s->frame;
    s->draw.storage[HL_SLOT_LIST] = s->light;
    s->draw.storage_bytes[HL_SLOT_LIST] = sizeof s->light;
    s->draw.storage[HL_SLOT_TILES] = s->tile;
    s->draw.storage_bytes[HL_SLOT_TILES] = sizeof s->tile;
}

static void fill(struct scene *s, uint32_t n_lights)
{
    float near = 0.1f, far = 100, tan_y = 0.5f, tan_x = tan_y * W / H;
    s->n_lights = n_lights;
    s->frame.ray_light = hl_v4(2 * tan_x / W, -2 * tan_y / H, -tan_x, tan_y);
    /* Reversed: d = near (far - z) / (z (far - near)). */
    s->frame.depth = hl_v4(near * far / (far - near), near / (far - near),
                           1 / far, far);
    s->frame.misc = hl_v4(32, TILE, TILES_X, 0);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            fill_texel(s, x, y);
    fill_lights(s);
    fill_draw(s);
}

/* ---- the loops ----------------------------------------------------------- */

/* What a reader of the paper writes: pixel by pixel, all lights. */
static void plain_pixel(struct scene *s, int x, int y)
{
    float p[3], n[3], v[3], d[3] = { 0, 0, 0 }, specular = 0;
    for (int k = 0; k < 3; k++) {
        p[k] = s->p[k][y][x];
        n[k] = s->n[k][y][x];
    }
    float eye = 1 / sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++)
        v[k] = -p[k] * eye;
    for (uint32_t i = 0; i < s->n_lights; i++) {
        hl_vec4 a = s->light[2 * i], c = s->light[2 * i + 1];
        float l[3] = { a.x - p[0], a.y - p[1], a.z - p[2] }, h[3];
        float d2 = l[0] * l[0] + l[1] * l[1] + l[2] * l[2];
        float inv = 1 / sqrtf(d2), nl = 0, nh = 0, hh = 0;
        float w = 1 - d2 * a.w > 0 ? 1 - d2 * a.w : 0;
        for (int k = 0; k < 3; k++) {
            nl += n[k] * l[k] * inv;
            h[k] = l[k] * inv + v[k];
            nh += n[k] * h[k];
            hh += h[k] * h[k];
        }
        nl = (nl > 0 ? nl : 0) * w * w;
        nh = nh > 0 ? nh : 0;
        d[0] += c.x * nl;
        d[1] += c.y * nl;
        d[2] += c.z * nl;
        specular += (0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z) * nl *
                    powf(nh / sqrtf(hh), 32);
    }
    for (int k = 0; k < 3; k++)
        s->out[k][y][x] = d[k];
    s->out[3][y][x] = specular;
}

static struct hl_rect bin(uint32_t item)
{
    struct hl_rect r = { (int32_t)(item % BINS_X) * PE_BIN,
                         (int32_t)(item / BINS_X) * PE_BIN, PE_BIN, PE_BIN };
    r.width = W - r.x < PE_BIN ? W - r.x : PE_BIN;
    r.height = H - r.y < PE_BIN ? H - r.y : PE_BIN;
    return r;
}

static void plain_bin(void *user, uint32_t item, uint32_t thread)
{
    struct hl_rect r = bin(item);
    (void)thread;
    for (int y = r.y; y < r.y + r.height; y++)
        for (int x = r.x; x < r.x + r.width; x++)
            plain_pixel(user, x, y);
}

static void packemu_bin(void *user, uint32_t item, uint32_t thread)
{
    struct scene *s = user;
    struct hl_rect r = bin(item);
    float out[4][PE_BIN * PE_BIN];
    (void)thread;
    pe_fragment_kernels[HL_SHADER_LIGHT_TILES_FRAG].rect(&s->draw, &r, out);
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < r.height; y++)
            memcpy(&s->out[c][r.y + y][r.x], &out[c][y * PE_BIN],
                   (size_t)r.width * sizeof(float));
}

/* ---- timing -------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double measure(struct scene *s, struct pe_pool *pool, int rounds,
                      const char *name,
                      void (*run)(void *, uint32_t, uint32_t))
{
    double t[MAX_ROUNDS], per = 1.0 / ((double)W * H * s->n_lights);
    for (int i = 0; i < rounds; i++) {
        double start = now_ns();
        pe_pool_run(pool, BINS_X * BINS_Y, run, s);
        t[i] = (now_ns() - start) * per;
    }
    qsort(t, (size_t)rounds, sizeof *t, by_value);
    printf("%-8s %6.3f ns/pixel/light, %.3f .. %.3f of %d\n", name,
           t[rounds / 2], t[0], t[rounds - 1], rounds);
    return t[rounds / 2];
}

static double sum_of(const struct scene *s)
{
    double sum = 0;
    const float *out = &s->out[0][0][0];
    for (int i = 0; i < 4 * W * H; i++)
        sum += (double)out[i];
    return sum;
}

static void *take(void *user, size_t bytes)
{
    (void)user;
    return malloc(bytes);
}

static void give(void *user, void *memory)
{
    (void)user;
    free(memory);
}

int main(int argc, char **argv)
{
    int lights = argc > 1 ? atoi(argv[1]) : 64;
    int threads = argc > 2 ? atoi(argv[2]) : 2;
    int rounds = argc > 3 ? atoi(argv[3]) : 11;
    struct hl_device_desc desc;
    struct hl_device *device;
    struct scene *s = calloc(1, sizeof *s);
    memset(&desc, 0, sizeof desc);
    desc.version = HL_VERSION;
    desc.hooks.alloc = take;
    desc.hooks.free = give;
    if (!s || lights < 1 || lights > MAX_LIGHTS || threads < 1 ||
        rounds < 1 || rounds > MAX_ROUNDS ||
        hl_device_open(&device, &hl_backend_null, &desc) != HL_OK) {
        fprintf(stderr, "bench_light [LIGHTS 1..%d [THREADS [ROUNDS 1..%d]]]"
                "\n", MAX_LIGHTS, MAX_ROUNDS);
        return 2;
    }
    fill(s, (uint32_t)lights);
    struct pe_pool *pool = pe_pool_open(device, (uint32_t)threads);
    printf("%d x %d, %d lights, %u threads\n", W, H, lights,
           pe_pool_threads(pool));
    double plain = measure(s, pool, rounds, "plain C", plain_bin);
    double a = sum_of(s);
    double fast = measure(s, pool, rounds, "packemu", packemu_bin);
    double b = sum_of(s);
    printf("ratio    %6.3f (plain C / packemu); sums differ by %.1e\n",
           plain / fast, fabs(a - b) / a);
    pe_pool_close(pool);
    hl_device_close(&device);
    free(s);
    return fabs(a - b) < 1e-3 * a ? 0 : 1;
}
