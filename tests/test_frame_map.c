/* SPDX-License-Identifier: Zlib */
/* Frames with shadow maps against rays: what is lit is what sees the light,
 * but for the width of the filter. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/shadow_map.h"
#include "core/vec.h"
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H };

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

/* ---- scenes ------------------------------------------------------------- */

/* A machine, a scene and its renderer; L-buffer and frame of one size, so
 * that a pixel is its light. */
struct stage {
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
};

static const char *backend_of(void **state)
{
    return ck_machine(state)->backend->name;
}

static void open_stage(struct stage *g, const char *backend,
                       const char *profile)
{
    ck_open_as(&g->m, backend, profile);
    fk_begin(&g->s, &g->m);
    g->s.needs.light_width = FK_W;
    g->s.needs.light_height = FK_H;
    g->s.needs.shadows = HL_SHADOWS_MAPS;
}

static void make(struct stage *g)
{
    fk_prepare(&g->run, &g->s, HL_PIPELINE_INFERRED);
    g->run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&g->run), HL_OK);
}

static void close_stage(struct stage *g)
{
    fk_destroy(&g->run);
    fk_end(&g->s);
    ck_close(&g->m);
}

static float *draw(struct stage *g)
{
    struct hlc_texels t;
    float *px = malloc(N * 4 * sizeof *px);
    assert_non_null(px);
    assert_int_equal(hl_frame_draw(g->run.r, &g->s.frame, &g->run.stats),
                     HL_OK);
    assert_int_equal(hlc_texels_read(&t, g->m.device,
                                     hl_renderer_output(g->run.r)), HL_OK);
    for (size_t i = 0; i < N; i++)
        hlc_texel(px + 4 * i, &t, i);
    hlc_texels_free(&t);
    return px;
}

/* Share of the light that comes through, a pixel; -1 where there is hardly
 * any: below a tenth of what is brightest. */
static float *through(struct stage *g)
{
    float *dark = draw(g), most = 0;
    for (uint32_t i = 0; i < g->s.frame.n_lights; i++)
        g->s.light[i].shadow = !g->s.light[i].shadow;
    float *lit = draw(g);
    for (uint32_t i = 0; i < g->s.frame.n_lights; i++)
        g->s.light[i].shadow = !g->s.light[i].shadow;
    for (int i = 0; i < N; i++)
        most = lit[4 * i] > most ? lit[4 * i] : most;
    assert_true(most > 0.01f);
    for (int i = 0; i < N; i++)
        dark[i] = lit[4 * i] > most * 0.1f ? dark[4 * i] / lit[4 * i] : -1;
    free(lit);
    return dark;
}

static void lay_down(struct hl_item *it)
{
    float k = it->world[0];
    it->world[5] = it->world[10] = 0;
    it->world[6] = -k;
    it->world[9] = k;
}

static void look(struct fk_scene *s, float ex, float ey, float ez, float x,
                 float y, float z)
{
    const float eye[3] = { ex, ey, ez }, to[3] = { x, y, z };
    assert_int_equal(hl_camera_look_at(&s->frame.camera, eye, to, 60, 0.1f,
                                       100), HL_OK);
}

/* The light that is nearly straight above all of it, of a kind. */
static struct hl_light *light_of(struct fk_scene *s, enum hl_light_kind kind,
                                 float x, float y, float z)
{
    struct hl_light *l = fk_light(s, x, y, z, 24);
    hl_vec3 d = hl_normalize3(hl_v3(-x, -y, -z));
    l->kind = kind;
    l->shadow = true;
    l->direction[0] = d.x, l->direction[1] = d.y, l->direction[2] = d.z;
    l->inner = 0.75f;
    l->outer = 0.85f;
    return l;
}

/* ---- rays --------------------------------------------------------------- */

/* World ray of a pixel's centre. */
static hl_vec3 ray_of(const struct hl_camera *c, int x, int y, hl_vec3 *eye)
{
    float ty = c->tan_half_y, tx = ty * FK_W / FK_H;
    hl_vec3 v = hl_v3(tx * (2 * ((float)x + 0.5f) / FK_W - 1),
                      ty * (1 - 2 * ((float)y + 0.5f) / FK_H), -1);
    const float *m = c->view;
    *eye = hl_v3(-hl_dot3(hl_load3(m), hl_load3(m + 12)),
                 -hl_dot3(hl_load3(m + 4), hl_load3(m + 12)),
                 -hl_dot3(hl_load3(m + 8), hl_load3(m + 12)));
    return hl_v3(hl_dot3(hl_load3(m), v), hl_dot3(hl_load3(m + 4), v),
                 hl_dot3(hl_load3(m + 8), v));
}

/* Does o + t d, 0 < t < most, meet an upright box? */
static bool meets(hl_vec3 o, hl_vec3 d, float most, const float *at,
                  float half)
{
    const float a[3] = { o.x, o.y, o.z }, b[3] = { d.x, d.y, d.z };
    float from = 0, to = most;
    for (int i = 0; i < 3; i++) {
        float t0 = (at[i] - half - a[i]) / b[i];
        float t1 = (at[i] + half - a[i]) / b[i];
        from = fmaxf(from, fminf(t0, t1));
        to = fminf(to, fmaxf(t0, t1));
    }
    return from < to;
}

/* Items 1.. are boxes that hide the light from p, or panes. */
static bool is_box(const struct fk_scene *s, uint32_t i)
{
    return s->item[i].surface != FK_BLENDED;
}

static bool hidden(const struct fk_scene *s, hl_vec3 p)
{
    const struct hl_light *l = &s->light[0];
    hl_vec3 d = l->kind == HL_DIRECTIONAL
                ? hl_scale3(hl_load3(l->direction), -100)
                : hl_sub3(hl_load3(l->position), p);
    for (uint32_t i = 1; i < s->frame.n_items; i++)
        if (is_box(s, i) &&
            meets(p, d, 1, s->item[i].world + 12, s->item[i].world[0]))
            return true;
    return false;
}

/* Point of the plane at height y that pixel i sees past the boxes. */
static bool on_plane(const struct fk_scene *s, int i, float y, hl_vec3 *p)
{
    hl_vec3 eye, d = ray_of(&s->frame.camera, i % FK_W, i / FK_W, &eye);
    if (d.y >= 0)
        return false;
    float t = (y - eye.y) / d.y;
    *p = hl_add3(eye, hl_scale3(d, t));
    for (uint32_t k = 1; k < s->frame.n_items; k++)
        if (is_box(s, k) && meets(eye, d, t, s->item[k].world + 12,
                                  s->item[k].world[0] * 1.02f))
            return false;
    return true;
}

static bool on_floor(const struct fk_scene *s, int i, hl_vec3 *p)
{
    return on_plane(s, i, 0, p);
}

/* ---- where shadows fall ------------------------------------------------- */

/* 1 hidden, 0 lit, -1 neither for sure: within `edge` of the border. */
static int surely(const struct fk_scene *s, hl_vec3 p, float edge)
{
    bool first = hidden(s, p);
    for (int k = 0; k < 64; k++) {
        float a = (float)k * 0.3927f, r = edge * (float)(k / 16 + 1) / 4;
        if (hidden(s, hl_add3(p, hl_v3(r * cosf(a), 0, r * sinf(a)))) != first)
            return -1;
    }
    return first;
}

/* On the floor a shadow's border may be off by the kernel (2 texels), the
 * lift (3.33) and half a texel of the map, over the cosine of the light's
 * angle: here below 45 degrees, 8.2 texels. */
static float border(const struct stage *g, float distance)
{
    const struct hl_light *l = &g->s.light[0];
    float half = (float)g->run.plan.shadow_size * 0.5f - HL_SHADOW_BORDER;
    float slope = l->kind == HL_POINT ? 1 : tanf(l->outer);
    return 8.2f / half * (l->kind == HL_DIRECTIONAL ? 24 : distance * slope);
}

static void compare(struct stage *g, const char *profile)
{
    float edge = border(g, 9), *v = through(g);
    uint32_t dark = 0, lit = 0;
    for (int i = 0; i < N; i++) {
        hl_vec3 p;
        if (v[i] < 0 || !on_floor(&g->s, i, &p))
            continue;
        int want = surely(&g->s, p, edge);
        dark += want == 1;
        lit += want == 0;
        /* Weights are rounded a few times, halves once: 2^-11. */
        if (want >= 0 && fabsf(v[i] - (float)!want) > 2e-3f)
            fail_msg("%s: light %d, pixel %d %d (%g %g): %g, not %d", profile,
                     (int)g->s.light[0].kind, i % FK_W, i / FK_W, (double)p.x,
                     (double)p.z, (double)v[i], !want);
    }
    if (dark < 200 || lit < 2000)
        fail_msg("%s: too few pixels: %u dark, %u lit", profile, dark, lit);
    free(v);
}

/* One box is seen, one casts from behind the camera; six maps are there in
 * any case, and the shadows of a point light lie on several. */
static void shadows_fall_where_rays_say(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 12; i++) {
        static struct stage g;
        open_stage(&g, backend, profiles[i % 4]);
        look(&g.s, 0, 5, 7, 0, 0, 0);
        lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 9));
        fk_add(&g.s, FK_BOX, FK_PLAIN, -2, 1.6f, 0, 1.1f);
        fk_add(&g.s, FK_BOX, FK_PLAIN, 2, 5.4f, 5.8f, 1.2f);
        light_of(&g.s, (enum hl_light_kind)(i / 4), 1.5f, 9, 7.5f);
        make(&g);
        compare(&g, profiles[i % 4]);
        assert_int_equal(g.run.stats.lights, 1);
        close_stage(&g);
    }
}

static void statistics_count(void **state)
{
    static struct stage g;
    open_stage(&g, backend_of(state), "native");
    look(&g.s, 0, 5, 7, 0, 0, 0);
    lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 9));
    fk_add(&g.s, FK_BOX, FK_PLAIN, -2, 1.2f, 0, 0.7f);
    fk_add(&g.s, FK_BOX, FK_PLAIN, 2, 1.4f, 0, 0.8f)->no_shadow = true;
    light_of(&g.s, HL_DIRECTIONAL, 1, 8, 3);
    light_of(&g.s, HL_SPOT, 1, 8, 3);
    light_of(&g.s, HL_POINT, -2, 5, 0)->shadow = false;
    make(&g);
    free(draw(&g));
    assert_int_equal(g.run.stats.shadow_lights, 2);
    assert_int_equal(g.run.stats.shadow_casters, 4);
    assert_int_equal(g.run.stats.shadow_triangles, 2 * (2 + 12));
    assert_int_equal(g.run.stats.lights, 3);
    close_stage(&g);
}

/* ---- what needs no shadow ----------------------------------------------- */

/* Everything is lit as it is without shadows: 2^-10 is one step of a half
 * float, or of 7e3 ones 2^-7. */
static void all_lit(struct stage *g, const char *what, double angle)
{
    enum hl_format color = hl_plan_target(&g->run.plan, HL_ROLE_COLOR)->format;
    float step = color == HL_FORMAT_RGB10A2_FLOAT ? 1.0f / 128 : 1.0f / 1024;
    float *v = through(g);
    uint32_t n = 0, bad = 0;
    for (int i = 0; i < N; i++) {
        n += v[i] >= 0;
        bad += v[i] >= 0 && !(fabsf(v[i] - 1) <= step);
    }
    free(v);
    if (bad || n < 1500)
        fail_msg("%s, light %d at %g degrees: %u of %u pixels", what,
                 (int)g->s.light[0].kind, angle, bad, n);
}

/* A floor and a tilted wall, alone, under lights up to 85 degrees aslant. */
static void planes_do_not_shade_themselves(void **state)
{
    const char *backend = backend_of(state);
    for (int p = 0; p < 4; p++) {
        static struct stage g;
        open_stage(&g, backend, profiles[p]);
        look(&g.s, 0, 3, 4, 0, 0, 0);
        lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 20));
        light_of(&g.s, HL_POINT, 0, 9, 0);
        g.s.needs.lights = HL_LIGHTS_CONES;
        light_of(&g.s, HL_SPOT, 0, 9, 0);
        g.s.needs.shadow_size = 256;
        make(&g);
        g.s.frame.n_lights = 1;
        for (int i = 0; i < 18; i++) {
            double a = i / 3 * 17 * 3.14159265 / 180, r = 12;
            g.s.frame.n_lights = 0;
            struct hl_light *l = light_of(
                &g.s, (enum hl_light_kind)(i % 3), (float)(r * sin(a) * 0.8),
                (float)(r * cos(a)), (float)(r * sin(a) * 0.6));
            /* At a slant the light is weak everywhere, but not uneven. */
            l->inner = 0.3f;
            l->outer = 0.4f;
            all_lit(&g, profiles[p], i / 3 * 17.0);
        }
        close_stage(&g);
    }
}

/* Walls, floor and ceiling about a light that is not in the middle: seams of
 * its maps run across them. Edges, where one plane's taps are another's
 * depth, are left out. */
static void seams_of_six_maps_are_not_seen(void **state)
{
    static struct stage g;
    open_stage(&g, backend_of(state), "native");
    look(&g.s, 0, 2, 3.9f, 0, 1.5f, -4);
    lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 4));
    fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, -4, 4);
    for (int k = 0; k < 2; k++) {
        struct hl_item *it = fk_add(&g.s, FK_QUAD, FK_PLAIN, k ? 4 : -4, 0, 0,
                                    4);
        it->world[0] = it->world[10] = 0;
        it->world[8] = k ? -4.0f : 4.0f;
        it->world[2] = k ? 4.0f : -4.0f;
    }
    light_of(&g.s, HL_POINT, 0.7f, 1.9f, -1.2f)->radius = 40;
    make(&g);
    float *v = through(&g);
    uint32_t seen = 0;
    for (int i = 0; i < N; i++) {
        hl_vec3 eye, d = ray_of(&g.s.frame.camera, i % FK_W, i / FK_W, &eye);
        float t[4] = { -eye.y / d.y, (-4 - eye.z) / d.z, (4 - eye.x) / d.x,
                       (-4 - eye.x) / d.x }, one = 1e9f, two = 1e9f;
        for (int k = 0; k < 4; k++) {
            if (t[k] > 0 && t[k] < one) {
                two = one;
                one = t[k];
            } else if (t[k] > 0 && t[k] < two) {
                two = t[k];
            }
        }
        /* 10 texels of 8 m / 1012 along the ray. */
        if (v[i] < 0 || two - one < 0.1f)
            continue;
        seen++;
        if (fabsf(v[i] - 1) > 2e-3f)
            fail_msg("pixel %d %d: %g", i % FK_W, i / FK_W, (double)v[i]);
    }
    assert_true(seen > 5000);
    free(v);
    close_stage(&g);
}

/* ---- masks -------------------------------------------------------------- */

/* The left half of the pane is holes. */
static void holes_let_light_through(void **state)
{
    static struct stage g;
    static const uint8_t texels[8] = { 255, 255, 255, 0, 255, 255, 255, 255 };
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA8_UNORM, .width = 2,
                             .height = 1 };
    hl_tex tex;
    open_stage(&g, backend_of(state), "native");
    assert_int_equal(hl_tex_create(g.m.device, &tex, &t), HL_OK);
    assert_int_equal(hl_tex_write(g.m.device, tex, 0, texels, sizeof texels),
                     HL_OK);
    look(&g.s, 0, 6, 5, 0, 0, 0);
    lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 9));
    /* Above and behind the camera: the material is no visible item's. */
    struct hl_item *it = fk_add(&g.s, FK_QUAD, FK_MASKED, 0, 8, 0, 1.5f);
    lay_down(it);
    it->texture[0].tex = tex;
    light_of(&g.s, HL_DIRECTIONAL, 0, 10, 0);
    make(&g);
    float *v = through(&g);
    uint32_t dark = 0, lit = 0;
    for (int i = 0; i < N; i++) {
        hl_vec3 eye, d = ray_of(&g.s.frame.camera, i % FK_W, i / FK_W, &eye);
        hl_vec3 p = hl_add3(eye, hl_scale3(d, -eye.y / d.y));
        if (v[i] < 0 || d.y >= 0 || fabsf(p.z) > 1.4f)
            continue;
        /* 0.1 m: 3 texels of 26 m / 1024, and the kernel. */
        if (p.x > 0.1f && p.x < 1.4f) {
            dark++;
            assert_true(v[i] < 1e-3f);
        } else if (p.x < -0.1f || p.x > 1.6f) {
            lit++;
            assert_true(fabsf(v[i] - 1) < 2e-3f);
        }
    }
    assert_true(dark > 100 && lit > 400);
    free(v);
    hl_tex_destroy(g.m.device, &tex);
    close_stage(&g);
}

/* ---- translucent layers ------------------------------------------------- */

/* Floor and two panes, each of one colour of its own, so that a channel of
 * the picture is the light of one of them, and the same share of it whether
 * there are shadows or not. */
static void add_layers(struct stage *g)
{
    static const float at[3] = { 0, 0.8f, 1.6f };
    for (int k = 0; k < 3; k++) {
        struct hl_item *it = fk_add(&g->s, FK_QUAD, k ? FK_BLENDED : FK_PLAIN,
                                    0, at[k], 0, 6);
        struct hl_material *m = fk_material(&g->s, it);
        lay_down(it);
        for (int c = 0; c < 3; c++)
            m->base[c] = c == k;
        m->base[3] = 0.5f;
    }
    fk_add(&g->s, FK_BOX, FK_PLAIN, 0.5f, 4.2f, -2, 2);
}

/* Patterns are every other texel of L, and the filter reaches one more: 3
 * pixels, 13 m away and seen at 45 degrees: 2 * 13 m * tan 30 degrees / 90
 * over the root of 1/2. */
static void compare_layer(struct stage *g, const float *dark,
                          const float *lit, int layer)
{
    uint32_t n[2] = { 0, 0 };
    float edge = border(g, 9) + 3 * 0.236f;
    for (int i = 0; i < N; i++) {
        hl_vec3 p;
        float all = lit[4 * i + layer];
        if (!on_plane(&g->s, i, (float)layer * 0.8f, &p) ||
            fabsf(p.x) > 5.4f || fabsf(p.z) > 5.4f || all < 0.02f)
            continue;
        /* The box's outline in the picture, for the filter. */
        hl_vec3 eye, d = ray_of(&g->s.frame.camera, i % FK_W, i / FK_W, &eye);
        bool beside = meets(eye, d, 100, g->s.item[3].world + 12, 2.5f);
        int want = beside ? -1 : surely(&g->s, p, edge);
        if (want < 0)
            continue;
        n[want]++;
        if (fabsf(dark[4 * i + layer] / all - (float)!want) > 5e-3f)
            fail_msg("layer %d, pixel %d %d: %g, not %d", layer, i % FK_W,
                     i / FK_W, (double)(dark[4 * i + layer] / all), !want);
    }
    if (n[0] < 500 || n[1] < 60)
        fail_msg("layer %d: too few pixels: %u dark, %u lit", layer, n[1],
                 n[0]);
}

static void shadows_fall_on_every_layer(void **state)
{
    const char *backend = backend_of(state);
    for (int k = 0; k < 2; k++) {
        static struct stage g;
        open_stage(&g, backend, "native");
        look(&g.s, 0, 9, 8, 0, 0, 0);
        add_layers(&g);
        light_of(&g.s, k ? HL_POINT : HL_DIRECTIONAL, 3, 10, -5);
        g.s.needs.translucency = HL_TRANSLUCENCY_2X2;
        fk_prepare(&g.run, &g.s, HL_PIPELINE_INFERRED);
        assert_int_equal(fk_create(&g.run), HL_OK);
        float *dark = draw(&g);
        assert_int_equal(g.run.stats.stippled, 2);
        g.s.light[0].shadow = false;
        float *lit = draw(&g);
        for (int layer = 0; layer < 3; layer++)
            compare_layer(&g, dark, lit, layer);
        free(dark);
        free(lit);
        close_stage(&g);
    }
}

/* ---- stability ---------------------------------------------------------- */

enum { MOVES = 64 };

/* Seen from straight above, a step of one pixel's width moves the picture of
 * the floor by one pixel and changes nothing else: what else changes of
 * the light of a place is crawling. The floor reaches past the view, so that
 * the map is fitted to the view. Gives the mean over pixels in half shadow. */
static double crawling(void **state, float pixels)
{
    static struct stage g;
    static float first[N];
    static bool floor_first[N];
    double sum = 0;
    uint32_t n = 0;
    open_stage(&g, backend_of(state), "native");
    lay_down(fk_add(&g.s, FK_QUAD, FK_PLAIN, 0, 0, 0, 300));
    for (int i = 0; i < 6; i++)
        fk_add(&g.s, FK_BOX, FK_PLAIN, (float)i * 2.1f - 4, 3,
               (float)(i % 2) * 4 - 2, 0.4f);
    light_of(&g.s, HL_DIRECTIONAL, 2, 6, 1.3f);
    g.s.needs.shadow_size = 256;
    make(&g);
    float step = 2 * 8 * 0.57735027f / FK_H * pixels;
    for (int k = 0; k < MOVES; k++) {
        look(&g.s, (float)k * step, 8, 0, (float)k * step, 0, 0);
        g.s.frame.camera.far = 12;
        float *v = draw(&g);
        int moved = (int)((float)k * pixels + 0.5f);
        for (int i = 0; i < N; i++) {
            int x = i % FK_W;
            hl_vec3 p;
            bool floor = on_floor(&g.s, i, &p);
            if (k == 0) {
                first[i] = v[4 * i];
                floor_first[i] = floor;
            } else if (x + moved < FK_W && floor && floor_first[i + moved] &&
                       first[i + moved] > 0.05f &&
                       first[i + moved] < 0.75f) {
                sum += fabs((double)v[4 * i] - (double)first[i + moved]);
                n++;
            }
        }
        free(v);
    }
    close_stage(&g);
    assert_true(n > 2000);
    return sum / n;
}

/* Full light is 0.9 here. The point of the floor that a pixel sees is the same
 * to 1e-5 m, in half shadow 1e-4 of the light; halves add 2^-11. */
static void shadows_do_not_crawl(void **state)
{
    double e = crawling(state, 1);
    print_message("half shadow changes by %.2g as the camera moves\n", e);
    assert_true(e < 2e-3);
}

/* ---- plans -------------------------------------------------------------- */

static void console_plan(struct hl_plan *out, struct fk_scene *s, bool point)
{
    s->frame.n_items = s->frame.n_lights = 0;
    lay_down(fk_add(s, FK_QUAD, FK_PLAIN, 0, 0, 0, 9));
    light_of(s, point ? HL_POINT : HL_SPOT, 0, 8, 0);
    memset(&s->needs, 0, sizeof s->needs);
    s->needs.width = 1280;
    s->needs.height = 720;
    s->needs.shadows = HL_SHADOWS_MAPS;
    fk_plan(out, s, HL_PIPELINE_INFERRED);
}

/* 800 x 450 of light take 580 of 2,048 tiles, 1024 x 1024 of depth 13 x 64,
 * 3 x 2 of 512 20 x 64, and 3 x 2 of 1024 39 x 128. */
static void maps_lie_beside_the_light(void **state)
{
    static struct fk_scene s;
    struct ck_machine m;
    struct hl_plan p;
    ck_open_as(&m, backend_of(state), "xbox360");
    fk_begin(&s, &m);
    for (int point = 0; point < 2; point++) {
        console_plan(&p, &s, point);
        const struct hl_plan_target *l = hl_plan_target(&p, HL_ROLE_LIGHT);
        const struct hl_plan_target *t = hl_plan_target(&p,
                                                        HL_ROLE_SHADOW_MAP);
        assert_int_equal(p.shadow_size, point ? 512 : 1024);
        assert_int_equal(t->width, point ? 1536 : 1024);
        assert_int_equal(l->edram_tiles, 580);
        assert_int_equal(t->edram_tiles, point ? 1280 : 832);
        assert_true(p.edram_tiles <= 2048);
        uint32_t a = l->console.edram_tile, b = t->console.edram_tile;
        if (hl_device_caps(m.device)->console_memory)
            assert_true(a && b && (a + 580 <= b || b + t->edram_tiles <= a));
    }
    fk_end(&s);
    ck_close(&m);
}

static void plans_grow_by_one_target(void **state)
{
    static struct fk_scene s;
    struct ck_machine *m = ck_machine(state);
    struct hl_plan with, without;
    enum hl_refusal why;
    fk_begin(&s, m);
    console_plan(&with, &s, true);
    assert_int_equal(with.shadow_size, 1024);
    s.needs.shadows = HL_SHADOWS_NONE;
    fk_plan(&without, &s, HL_PIPELINE_INFERRED);
    assert_null(hl_plan_target(&without, HL_ROLE_SHADOW_MAP));
    assert_int_equal(with.n_targets, without.n_targets + 1);
    assert_int_equal(with.n_passes, without.n_passes + 2);
    assert_true(with.cost_ms > without.cost_ms);
    s.needs.shadows = HL_SHADOWS_MAPS;
    s.needs.n_shadow_lights = 500;
    assert_int_equal(hl_plan_make(&without, HL_PIPELINE_INFERRED, &s.needs,
                                  hl_device_caps(m->device), &why), HL_OK);
    assert_int_equal(with.n_targets, without.n_targets);
    assert_int_equal(with.n_passes, without.n_passes);
    s.needs.shadow_size = 16384;
    assert_int_equal(hl_plan_make(&without, HL_PIPELINE_INFERRED, &s.needs,
                                  hl_device_caps(m->device), &why),
                     HL_ERR_UNSUPPORTED);
    assert_int_equal(why, HL_REFUSED_SHADOWS);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(shadows_fall_where_rays_say),
        DRAWN(statistics_count),
        DRAWN(planes_do_not_shade_themselves),
        DRAWN(seams_of_six_maps_are_not_seen),
        DRAWN(holes_let_light_through),
        DRAWN(shadows_fall_on_every_layer),
        DRAWN(shadows_do_not_crawl),
        DRAWN(maps_lie_beside_the_light),
        DRAWN(plans_grow_by_one_target),
    };
    return cmocka_run_group_tests_name("frames with shadow maps", tests, NULL,
                                       NULL);
}
