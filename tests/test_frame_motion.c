/* SPDX-License-Identifier: Zlib */
/* Motion vectors: what the channel says of boxes and walls that move, of a
 * camera that moves, of both and of neither, against projections in double;
 * where there is none; and who may write it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"
#include "tests/frame_kit.h"

enum { LW = 100, LH = 56, LN = LW * LH };

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

/* ---- the oracle --------------------------------------------------------- */

static void transform(double out[4], const float m[16], const double p[4])
{
    for (int r = 0; r < 4; r++) {
        out[r] = 0;
        for (int c = 0; c < 4; c++)
            out[r] += (double)m[c * 4 + r] * p[c];
    }
}

/* x and y, down, over w. */
static void project(double out[2], const struct hl_camera *c,
                    const double world[4])
{
    double v[4], t = (double)c->tan_half_y;
    transform(v, c->view, world);
    out[0] = v[0] / (t * FK_W / FK_H) / -v[2];
    out[1] = -v[1] / t / -v[2];
}

/* Motion of the point of plane z = `plane` that is seen at texel x, y: the
 * camera now looks down -z. */
static void moved(double out[2], const struct fk_scene *s,
                  const struct hl_item *it, double plane, double x, double y)
{
    const struct hl_camera *now = &s->frame.camera;
    const struct hl_camera *then = s->frame.before ? s->frame.before : now;
    const float *before = it->world_before ? it->world_before : it->world;
    double depth = 10 - plane, t = (double)now->tan_half_y * depth;
    double world[4] = { (x / LW * 2 - 1) * t * FK_W / FK_H,
                        (1 - y / LH * 2) * t, plane, 1 };
    double model[4] = { 0, 0, 0, 1 }, last[4], a[2], b[2];
    /* Now: scaled and put somewhere. */
    for (int k = 0; k < 3; k++)
        model[k] = (world[k] - (double)it->world[12 + k]) /
                   (double)it->world[5 * k];
    transform(last, before, model);
    project(a, now, world);
    project(b, then, last);
    for (int k = 0; k < 2; k++) {
        double m = a[k] - b[k];
        out[k] = m > 1 ? 1 : m < -1 ? -1 : m;
    }
}

/* ---- frames ------------------------------------------------------------- */

struct looked {
    struct hl_plan plan;
    float motion[LN][2];
    uint32_t item[LN];           /* 1 + item; 0: background                  */
};

static void read_pairs(struct fk_run *run, enum hl_role role, float (*out)[2])
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, run->scene->m->device,
                                     hl_renderer_target(run->r, role)),
                     HL_OK);
    assert_int_equal(t.width * t.height, LN);
    for (size_t i = 0; i < LN; i++) {
        float v[4];
        hlc_texel(v, &t, i);
        hlc_two16(out[i], run->plan.two16, v);
    }
    hlc_texels_free(&t);
}

static void look(struct looked *l, struct fk_scene *s)
{
    static float ids[LN][2];
    struct fk_run run;
    s->needs.light_width = LW;
    s->needs.light_height = LH;
    s->needs.motion = true;
    fk_prepare(&run, s, HL_PIPELINE_INFERRED);
    l->plan = run.plan;
    if (!run.plan.stipple)
        run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &s->frame, &run.stats), HL_OK);
    assert_int_equal(hl_submit(s->m->device, true), HL_OK);
    read_pairs(&run, HL_ROLE_MOTION, l->motion);
    read_pairs(&run, HL_ROLE_DSF, ids);
    for (int i = 0; i < LN; i++) {
        uint32_t id = (uint32_t)(ids[i][1] * run.plan.id_steps + 0.5f);
        l->item[i] = 0;
        for (uint32_t k = 0; id && k < s->frame.n_items; k++)
            if (s->item[k].id_base <= id)
                l->item[i] = k + 1;
        for (int k = 0; k < 2; k++)
            l->motion[i][k] = hl_motion_decode(l->motion[i][k]);
    }
    fk_destroy(&run);
}

/* Encoding, as the plan says; vertices snap to 1/256 of a texel, so half a
 * step of what the motion changes by over that, on both axes; and floats:
 * quotients of numbers up to 10, of five roundings each. */
static void check_texel(const struct looked *l, const struct fk_scene *s,
                        const struct hl_item *it, double plane, int i)
{
    double x = i % LW + 0.5, y = i / LW + 0.5, want[2], a[2], b[2];
    moved(want, s, it, plane, x, y);
    moved(a, s, it, plane, x + 1, y);
    moved(b, s, it, plane, x, y + 1);
    for (int k = 0; k < 2; k++) {
        double step = fabs(a[k] - want[k]) + fabs(b[k] - want[k]);
        double error = (double)hl_plan_target(&l->plan,
                                              HL_ROLE_MOTION)->error;
        ck_near((double)l->motion[i][k], want[k],
                error + step / 256 + 20 * 6e-8);
    }
}

/* Wall, item 0, at z = -2; box, item 1, whose front is at z = 2: seen from
 * (0, 0, 10) its sides are behind that. */
static void make_scene(struct fk_scene *s, struct ck_machine *m)
{
    fk_begin(s, m);
    fk_add(s, FK_QUAD, FK_PLAIN, 0, 0, -2, 4);
    fk_add(s, FK_BOX, FK_PLAIN, 0, 0, 0, 2);
    fk_light(s, 0, 4, 5, 20);
}

static void check_all(const struct looked *l, const struct fk_scene *s)
{
    static const double plane[2] = { -2, 2 };
    uint32_t seen[3] = { 0, 0, 0 };
    for (int i = 0; i < LN; i++) {
        uint32_t k = l->item[i];
        seen[k]++;
        if (k)
            check_texel(l, s, &s->item[k - 1], plane[k - 1], i);
        else
            assert_true(l->motion[i][0] == 0 && l->motion[i][1] == 0);
    }
    assert_true(seen[0] > 300 && seen[1] > 300 && seen[2] > 200);
}

/* A turn about z by `a` radians, scaled, then put at x, y, z. */
static void place(float m[16], float scale, float a, float x, float y,
                  float z)
{
    memset(m, 0, 16 * sizeof *m);
    m[0] = m[5] = scale * cosf(a);
    m[1] = scale * sinf(a);
    m[4] = -m[1];
    m[10] = scale;
    m[12] = x, m[13] = y, m[14] = z;
    m[15] = 1;
}

static void one_profile(const char *backend, const char *profile)
{
    static const float eye[3] = { 0.6f, -0.3f, 11 }, to[3] = { 0.2f, 0.1f, 0 };
    static struct fk_scene s;
    static struct looked l;
    struct ck_machine m;
    struct hl_camera then;
    float box[16];
    ck_open_as(&m, backend, profile);
    make_scene(&s, &m);
    assert_int_equal(hl_camera_look_at(&then, eye, to, 50, 0.1f, 100), HL_OK);
    place(box, 1.6f, 0.3f, -0.7f, 0.4f, -0.5f);
    for (int i = 0; i < 4; i++) {
        s.item[1].world_before = i & 1 ? box : NULL;
        s.frame.before = i & 2 ? &then : NULL;
        look(&l, &s);
        check_all(&l, &s);
        for (int k = 0; i == 0 && k < LN; k++)
            assert_true(l.motion[k][0] == 0 && l.motion[k][1] == 0);
    }
    fk_end(&s);
    ck_close(&m);
}

static void motion_is_what_moved(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    for (int i = 0; i < 4; i++)
        one_profile(backend, profiles[i]);
}

/* Scene and camera as they were, the picture's jitter another: no texel
 * moves. */
static void jitter_is_no_motion(void **state)
{
    static struct fk_scene s;
    static struct looked l;
    make_scene(&s, ck_machine(state));
    struct hl_camera then = s.frame.camera;
    s.frame.before = &then;
    s.frame.camera.jitter[0] = 0.4f;
    s.frame.camera.jitter[1] = -0.3f;
    then.jitter[0] = -0.5f;
    look(&l, &s);
    for (int i = 0; i < LN; i++)
        assert_true(l.motion[i][0] == 0 && l.motion[i][1] == 0);
    fk_end(&s);
}

/* Cut at half the screen; nothing where the point was behind the eye. */
static void motion_is_cut(void **state)
{
    static struct fk_scene s;
    static struct looked l;
    float box[16], wall[16];
    make_scene(&s, ck_machine(state));
    place(box, 2, 0, -60, 40, 0);
    place(wall, 4, 0, 0, 0, 30);
    s.item[1].world_before = box;
    s.item[0].world_before = wall;
    look(&l, &s);
    for (int i = 0; i < LN; i++) {
        bool in = l.item[i] == 2;
        ck_near((double)l.motion[i][0], in ? 1 : 0, in ? 4e-5 : 0);
        ck_near((double)l.motion[i][1], in ? 1 : 0, in ? 4e-5 : 0);
    }
    fk_end(&s);
}

/* All variants of the stage say the same: textured, masked, mirrored, with
 * exponents and BRDFs beside. */
static void every_stage_says_the_same(void **state)
{
    static const enum fk_surface surface[] = { FK_PLAIN, FK_FULL, FK_MASKED };
    static struct fk_scene s;
    static struct looked first, l;
    float box[16];
    place(box, 1.6f, 0.3f, -0.7f, 0.4f, -0.5f);
    for (int i = 0; i < 9; i++) {
        make_scene(&s, ck_machine(state));
        s.item[1].world_before = box;
        for (int k = 0; k < 2; k++) {
            s.item[k].surface = surface[i % 3];
            s.material[k].no_specular = i / 3 == 0;
            s.material[k].roughness = k ? 0.5f : 0.7f;
        }
        s.material[1].brdf = i / 3 == 2 ? HL_BRDF_SKIN : HL_BRDF_BLINN_PHONG;
        look(i ? &l : &first, &s);
        check_all(i ? &l : &first, &s);
        if (i)
            assert_memory_equal(l.motion, first.motion, sizeof l.motion);
        fk_end(&s);
    }
}

/* ---- who writes it ------------------------------------------------------ */

/* A translucent pane before the box moves the other way: the texels of its
 * pattern, a quarter of those that it covers, are its own, all others the
 * surface's behind it. 7 m away its 3 m a side are 20.8 texels. */
static void translucent_surfaces_write_theirs(void **state)
{
    static struct fk_scene s;
    static struct looked l;
    float box[16], pane[16];
    uint32_t panes = 0;
    make_scene(&s, ck_machine(state));
    place(box, 2, 0, -0.5f, 0, 0);
    place(pane, 1.5f, 0, 0.5f, 0, 3);
    s.item[1].world_before = box;
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_BLENDED, 0, 0, 3, 1.5f);
    it->world_before = pane;
    fk_material(&s, it)->base[3] = 0.5f;
    s.needs.translucency = HL_TRANSLUCENCY_2X2;
    look(&l, &s);
    assert_int_equal(l.plan.stipple, 2);
    for (int i = 0; i < LN; i++) {
        panes += l.item[i] == 3;
        if (l.item[i] == 0)
            continue;
        check_texel(&l, &s, &s.item[l.item[i] - 1],
                    l.item[i] == 3 ? 3 : l.item[i] == 2 ? 2 : -2, i);
    }
    assert_true(panes >= 10 * 10 && panes <= 11 * 11);
    fk_end(&s);
}

/* A decal lies on what it lies on, and moves as that does. */
static void decals_leave_it(void **state)
{
    static struct fk_scene s;
    static struct looked with, without;
    float box[16], decal[16];
    make_scene(&s, ck_machine(state));
    place(box, 1.6f, 0.3f, -0.7f, 0.4f, -0.5f);
    place(decal, 0.5f, 0, 1, 1, 1);
    s.item[1].world_before = box;
    s.surface[FK_TWO_SIDED].decal = true;
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_TWO_SIDED, 0, 0, 2.01f, 0.5f);
    it->world_before = decal;
    look(&with, &s);
    assert_int_equal(with.plan.decals, HL_DECALS_BLEND_NORMALS);
    s.frame.n_items--;
    look(&without, &s);
    assert_memory_equal(with.motion, without.motion, sizeof with.motion);
    fk_end(&s);
}

/* ---- refusals ----------------------------------------------------------- */

static void bad_motion_is_named(void **state)
{
    struct ck_machine *m = ck_machine(state);
    static struct fk_scene s;
    struct fk_run run;
    float bad[16];
    make_scene(&s, m);
    s.needs.motion = true;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    place(bad, INFINITY, 0, 0, 0, 0);
    s.item[1].world_before = bad;
    CK_REFUSED(m, hl_frame_draw(run.r, &s.frame, NULL), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "items 1: world_before");
    s.item[1].world_before = NULL;
    struct hl_camera then = s.frame.camera;
    then.near = 0;
    s.frame.before = &then;
    CK_REFUSED(m, hl_frame_draw(run.r, &s.frame, NULL), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_frame.before");
    fk_destroy(&run);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(motion_is_what_moved),
        DRAWN(jitter_is_no_motion),
        DRAWN(motion_is_cut),
        DRAWN(every_stage_says_the_same),
        DRAWN(translucent_surfaces_write_theirs),
        DRAWN(decals_leave_it),
        CK_ON("null", bad_motion_is_named),
    };
    return cmocka_run_group_tests_name("motion of frames", tests, NULL, NULL);
}
