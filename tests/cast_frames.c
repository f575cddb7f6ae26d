/* SPDX-License-Identifier: Zlib */
/* What a frame's L-buffer is, and what rays say it should be. */
#include <string.h>
#include "tests/cast_kit.h"

void cs_draw(struct cs_rig *g, struct hlc_texels *light)
{
    assert_int_equal(hl_frame_draw(g->run.r, &g->s.frame, &g->run.stats),
                     HL_OK);
    assert_int_equal(hlc_texels_read(light, g->m.device,
                                     hl_renderer_target(g->run.r,
                                                        HL_ROLE_LIGHT)),
                     HL_OK);
}

static void read_ids(struct cs_rig *g)
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, g->m.device,
                                     hl_renderer_target(g->run.r,
                                                        HL_ROLE_DSF)), HL_OK);
    for (size_t i = 0; i < CS_TEXELS; i++) {
        float x[4], v[2];
        hlc_texel(x, &t, i);
        hlc_two16(v, g->run.plan.two16, x);
        g->id[i] = (uint32_t)(v[1] * g->run.plan.id_steps + 0.5f);
    }
    hlc_texels_free(&t);
}

static const struct hl_item *item_of(const struct cs_rig *g, uint32_t id)
{
    const struct hl_item *it = NULL;
    for (uint32_t i = 0; id && i < g->s.frame.n_items; i++)
        if (g->s.item[i].id_base <= id)
            it = &g->s.item[i];
    return it;
}

/* Lights `which`, without any shadow. */
static void draw_bare(struct cs_rig *g, uint32_t which, struct hlc_texels *out)
{
    struct fk_scene *s = &g->s;
    struct hl_item items[FK_ITEMS];
    struct hl_light lights[FK_LIGHTS];
    memcpy(items, s->item, sizeof items);
    memcpy(lights, s->light, sizeof lights);
    for (uint32_t i = 0; i < s->frame.n_items; i++)
        s->item[i].no_shadow = true;
    for (uint32_t i = 0; i < s->frame.n_lights; i++)
        s->light[i].radius *= which >> i & 1 ? 1.0f : 0.0f;
    for (uint32_t i = 0; i < s->frame.n_lights; i++)
        if (!(which >> i & 1))
            memset(s->light[i].color, 0, sizeof s->light[i].color);
    cs_draw(g, out);
    assert_int_equal(g->run.stats.shadow_casters, 0);
    memcpy(s->item, items, sizeof items);
    memcpy(s->light, lights, sizeof lights);
}


/* Each texel has the bits of the frame with just those lights that reach it. */
struct cs_seen cs_check(struct cs_rig *g, const char *name)
{
    uint32_t n = g->s.frame.n_lights, wrong = 0, cast = 0;
    struct hlc_texels got, bare[4];
    struct cs_seen seen;
    memset(&seen, 0, sizeof seen);
    cs_draw(g, &got);
    for (uint32_t k = 0; k < n; k++)
        cast += g->s.light[k].shadow;
    assert_int_equal(g->run.stats.shadow_lights, cast);
    read_ids(g);
    for (uint32_t k = 0; k < 1u << n; k++)
        draw_bare(g, k, &bare[k]);
    size_t size = hl_format_info(got.format)->bytes;
    for (int i = 0; i < CS_TEXELS; i++) {
        const struct hl_item *it = item_of(g, g->id[i]);
        uint32_t which = 0;
        bool sure = it != NULL;
        for (uint32_t k = 0; k < n && sure; k++) {
            int shade = cs_shade(g, it, i, &g->s.light[k]);
            which |= shade == 0 ? 1u << k : 0;
            sure = shade >= 0;
        }
        if (!sure) {
            seen.unsure += it != NULL;
            continue;
        }
        const uint8_t *a = got.bytes + (size_t)i * size;
        const uint8_t *b = bare[which].bytes + (size_t)i * size;
        const uint8_t *all = bare[(1u << n) - 1].bytes + (size_t)i * size;
        /* Dark where it would be lit. */
        bool dark = memcmp(b, all, size) != 0;
        seen.dark += dark;
        seen.of[it - g->s.item][!dark]++;
        seen.lit += memcmp(b, bare[0].bytes + (size_t)i * size, size) != 0;
        wrong += memcmp(a, b, size) != 0;
    }
    if (wrong)
        fail_msg("%s on %s: %u texels are wrong (%u dark, %u lit)", name,
                 g->run.plan.profile, wrong, seen.dark, seen.lit);
    hlc_texels_free(&got);
    for (uint32_t k = 0; k < 1u << n; k++)
        hlc_texels_free(&bare[k]);
    return seen;
}
