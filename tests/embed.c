/* SPDX-License-Identifier: Zlib */
/* An engine embeds halflight: its own mesh in its own vertex layout, its own
 * material shader, its own allocator and log; three frames by inferred
 * lighting on Vulkan and on the software device, one pixel checked against
 * the light model by hand. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "core/halflight.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/vulkan/hl_vulkan.h"
#include "shaders/shared/block.h"

static const uint32_t own_spirv[] = {
#include "embed_frag.x"
};

/* The same material for the software device: embed.frag in C. */
static void own_shade(const struct pe_draw *draw, struct hl_pe_fragments *f)
{
    const struct hl_frame_block *frame =
        hl_pe_uniform(draw, HL_SLOT_FRAME, sizeof *frame);
    const float *paint = hl_pe_uniform(draw, HL_SLOT_MATERIAL,
                                       8 * sizeof *paint);
    float light[6][HL_PE_BATCH];
    hl_pe_read_lights(draw, f, light);
    for (uint32_t i = 0; i < f->n && frame && paint; i++) {
        const float *p = paint + 4 * ((f->x[i] / 8 + f->y[i] / 8) & 1);
        f->color[0][0][i] = p[0] * (frame->ambient.x + light[0][i]);
        f->color[0][1][i] = p[1] * (frame->ambient.y + light[1][i]);
        f->color[0][2][i] = p[2] * (frame->ambient.z + light[2][i]);
        f->color[0][3][i] = 1;
    }
}

/* hl_read_lights compares depths by their slope. */
static const struct hl_pe_stage own_stage = { own_shade, true, false, false };

/* The engine's side: memory it counts, messages it keeps. */
struct engine { long blocks; int errors; char last[256]; };

static void *engine_alloc(void *user, size_t bytes)
{
    ((struct engine *)user)->blocks++;
    return malloc(bytes);
}

static void engine_free(void *user, void *memory)
{
    ((struct engine *)user)->blocks -= memory != NULL;
    free(memory);
}

static void engine_log(void *user, enum hl_log_level level, enum hl_log_id id,
                       const char *text)
{
    struct engine *e = user;
    (void)id;
    if (level == HL_LOG_ERROR)
        e->errors++;
    snprintf(e->last, sizeof e->last, "%s", text);
}

/* Its vertex: normal as four signed bytes before the position, no tangent;
 * one flat quad is one normal group, so the missing attribute's default
 * (0,0,0,1) is group 0. */
struct vertex { int8_t normal[4]; float position[3]; };

static const struct vertex quad[4] = {
    { { 0, 0, 127, 0 }, { -4, -4, 0 } }, { { 0, 0, 127, 0 }, { 4, -4, 0 } },
    { { 0, 0, 127, 0 }, { 4, 4, 0 } }, { { 0, 0, 127, 0 }, { -4, 4, 0 } },
};
static const uint16_t quad_index[6] = { 0, 1, 2, 0, 2, 3 };

enum { W = 320, H = 180 };

struct scene {
    struct hl_surface surface;
    struct hl_code code;
    struct hl_item item;
    struct hl_light light;
    struct hl_frame frame;
    float paint[8];
};

static int make_scene(struct scene *s, struct hl_device *d)
{
    static const struct scene none;
    *s = none;
    s->code.spirv = own_spirv;
    s->code.spirv_bytes = sizeof own_spirv;
    s->code.kernel = (void (*)(void))(uintptr_t)&own_stage;
    s->surface.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
    s->surface.layout.attr[HL_ATTR_POSITION].offset = 4;
    s->surface.layout.attr[HL_ATTR_NORMAL].format = HL_ATTR_S8X4_SNORM;
    s->surface.layout.stride[0] = sizeof(struct vertex);
    s->surface.own_material = &s->code;
    struct hl_buf_desc v = { "quad", sizeof quad, 0, false, quad };
    struct hl_buf_desc i = { "quad index", sizeof quad_index, 0, false,
                             quad_index };
    if (hl_buf_create(d, &s->item.vertex[0], &v) != HL_OK ||
        hl_buf_create(d, &s->item.index, &i) != HL_OK)
        return 0;
    s->item.index16 = true;
    s->item.count = 6;
    for (int k = 0; k < 16; k += 5)
        s->item.world[k] = 1;
    for (int k = 0; k < 3; k++) {
        s->item.bounds_min[k] = k < 2 ? -4.0f : 0.0f;
        s->item.bounds_max[k] = k < 2 ? 4.0f : 0.0f;
        s->light.color[k] = 0.25f * (float)(k + 1);
        s->frame.ambient[k] = 0.1f;
        s->paint[k] = 0.8f;
        s->paint[4 + k] = 0.2f;
    }
    s->item.id_base = 1;
    s->item.material_block = s->paint;
    s->item.material_bytes = sizeof s->paint;
    s->light.position[2] = 1.5f;
    s->light.radius = 4;
    s->frame.items = &s->item;
    s->frame.n_items = 1;
    s->frame.lights = &s->light;
    s->frame.n_lights = 1;
    return 1;
}

static int draw(struct hl_renderer *r, struct hl_device *d, struct scene *s)
{
    for (int i = 0; i < 3; i++) {
        const float eye[3] = { 0.01f * (float)i, 0, 5 };
        const float target[3] = { 0.01f * (float)i, 0, 0 };
        if (hl_camera_look_at(&s->frame.camera, eye, target, 50, 0.5f, 50) ||
            hl_frame_draw(r, &s->frame, NULL) || hl_submit(d, i == 2))
            return 0;
    }
    return 1;
}

/* Pixel (W/2 + 4, H/2 + 4): out = paint (A + c a N.L), smooth falloff. */
static float expected(int channel, int x, int y)
{
    float t = tanf(50 * 3.14159265f / 360);
    float px = ((float)x + 0.5f - W / 2) * 2 * t / H * 5 + 0.02f;
    float py = (H / 2 - (float)y - 0.5f) * 2 * t / H * 5;
    float d2 = px * px + py * py + 1.5f * 1.5f;
    float a = (1 - d2 / 16) * (1 - d2 / 16);
    float paint = (x / 8 + y / 8) % 2 == 0 ? 0.8f : 0.2f;
    return paint * (0.1f + 0.25f * (float)(channel + 1) * a * 1.5f / sqrtf(d2));
}

static float half_to_float(uint16_t h)
{
    int e = h >> 10 & 31;
    float m = (float)(h & 1023) / 1024.0f;
    return e ? ldexpf(1 + m, e - 15) : ldexpf(m, -14);
}

static int check(struct hl_renderer *r, struct hl_device *d)
{
    uint16_t *pixels = malloc((size_t)W * H * 8);
    int x = W / 2 + 4, y = H / 2 + 4, good = 1;
    if (hl_tex_read(d, hl_renderer_output(r), pixels, (size_t)W * H * 8))
        good = 0;
    for (int c = 0; good && c < 3; c++) {
        float got = half_to_float(pixels[(y * W + x) * 4 + c]);
        float want = expected(c, x, y);
        /* Two half-float stores, 2^-10 each (L-buffer and frame), and the
         * L-buffer's five eighths: bilinear over a falloff whose second
         * derivative is below 0.2 a metre^2, at texels of 0.04 m: 2e-4. */
        float tolerance = want * 2 / 1024 + 2e-4f;
        printf("channel %d: %.5f, by hand %.5f\n", c, (double)got,
               (double)want);
        good = fabsf(got - want) <= tolerance;
    }
    free(pixels);
    return good;
}

static int run(struct hl_device *d)
{
    struct scene s;
    struct hl_needs needs = { .width = W, .height = H, .light_width = 200,
                              .light_height = 113, .n_objects = 1,
                              .n_triangles = 2, .n_lights = 1, .far = 50 };
    struct hl_plan plan;
    if (!make_scene(&s, d) ||
        hl_plan_make(&plan, HL_PIPELINE_INFERRED, &needs, hl_device_caps(d),
                     NULL))
        return 0;
    struct hl_renderer_desc desc = { .plan = &plan, .surfaces = &s.surface,
                                     .n_surfaces = 1, .max_items = 1,
                                     .max_lights = 1, .readback = true };
    void *memory = malloc(hl_renderer_bytes(&desc));
    struct hl_renderer *r;
    int good = hl_renderer_create(&r, d, &desc, memory) == HL_OK &&
               draw(r, d, &s) && check(r, d);
    hl_renderer_destroy(&r);
    free(memory);
    return good;
}

static int embed(const struct hl_backend *backend, const char *name)
{
    struct engine engine = { 0, 0, "" };
    struct hl_device_desc desc = { .version = HL_VERSION,
        .hooks = { engine_alloc, engine_free, &engine }, .log = engine_log,
        .log_user = &engine, .validation = true };
    struct hl_device *d;
    enum hl_result r = hl_device_open(&d, backend, &desc);
    printf("embed: %s: %s\n", name, hl_result_name(r));
    if (r != HL_OK)
        return r == HL_ERR_NO_DEVICE ? 77 : 1;
    int good = run(d) && hl_device_validation_errors(d) == 0;
    hl_device_close(&d);
    if (!good || engine.blocks || engine.errors)
        printf("embed: failed; %ld blocks left, log: %s\n", engine.blocks,
               engine.last);
    return good && !engine.blocks && !engine.errors ? 0 : 1;
}

/* One by one: 77, which the suites take for skipped, where Vulkan has no
 * device and all else is well. */
int main(void)
{
    int software = embed(&hl_backend_packemu, "packemu");
    int vulkan = embed(&hl_backend_vulkan, "vulkan");
    return software ? 1 : vulkan;
}
