/* SPDX-License-Identifier: Zlib */
/* Forward draws: each object with the lights that touch it. */
#include <string.h>
#include "core/renderer.h"

struct batcher {
    const struct hl_frame *frame;
    uint32_t visible, refs[HL_BATCH_MAX], n, done;
    struct hl_rect rect;
};

static void send(struct hl_renderer *r, struct batcher *b, bool base)
{
    int kind = base ? PROG_BASE : PROG_MORE;
    if (r->counting)
        kind = base ? PROG_COUNT_BASE : PROG_COUNT_MORE;
    struct hl_draw *d = hl_draw_mesh(r, b->frame, b->visible, kind);
    uint32_t size = r->plan.batch ? r->plan.batch : 1;
    hl_draw_lights(r, d, hl_put_batch(r, b->frame, b->refs, b->n, size));
    if (!base && r->plan.scissor)
        d->scissor = b->rect;
    r->stats.blends += !base;
    b->n = 0;
    b->done++;
}

/* Base draws of all objects first, then further lights where the depth is
 * equal: `base` says which of the two this call makes. FWD-2's base draw has
 * the first eight lights, FWD-1's has none. */
static void object_draws(struct hl_renderer *r, const struct hl_frame *f,
                         uint32_t visible, bool base)
{
    bool multipass = r->plan.pipeline == HL_PIPELINE_FORWARD_MULTIPASS;
    struct batcher b;
    memset(&b, 0, sizeof b);
    b.frame = f;
    b.visible = visible;
    if (multipass && base) {
        send(r, &b, true);
        return;
    }
    for (uint32_t i = 0; i < r->n_spheres; i++) {
        struct hl_lit_sphere *s = &r->spheres[i];
        if (!hl_sphere_touches_box(s, &r->visible[visible].box))
            continue;
        if (r->plan.scissor && !hl_sphere_rect(&b.rect, s, &r->frame_span))
            continue;
        b.refs[b.n++] = i;
        if (b.n < r->plan.batch)
            continue;
        bool first = !multipass && b.done == 0;
        if (first == base)
            send(r, &b, base);
        else
            b.n = 0, b.done++;
        if (base)
            return;
    }
    bool first = !multipass && b.done == 0;
    if (first ? base : b.n > 0 && !base)
        send(r, &b, base);
}

void hl_emit_forward(struct hl_renderer *r, const struct hl_frame *f)
{
    for (uint32_t i = 0; i < r->n_opaque; i++)
        object_draws(r, f, i, true);
    for (uint32_t i = 0; i < r->n_opaque; i++)
        object_draws(r, f, i, false);
}
