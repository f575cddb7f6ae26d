/* SPDX-License-Identifier: Zlib */
#include "tests/console_kit.h"
#include <string.h>

void con_caps(struct hl_caps *c, const struct hl_profile *profile,
              bool memory)
{
    ck_lavapipe(c);
    strcpy(c->backend, memory ? "memory" : "stand-in");
    strcpy(c->device, memory ? "console memory" : "stand-in formats");
    c->samples = 15;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        struct hl_format_caps *f = &c->format[i];
        f->samples = f->samples ? 15 : 0;
        /* Only a console has its own formats. */
        if (!memory && i >= HL_FORMAT_RG16_FIXED32)
            f->use = f->samples = 0;
    }
    c->profile = *profile;
    c->console_memory = memory;
}

struct hl_needs con_needs(void)
{
    struct hl_needs n = { .width = 1280, .height = 720, .n_objects = 100,
                          .n_triangles = 50000, .n_lights = 200,
                          .lights_per_pixel = 12, .lights_per_object = 30,
                          .lights = HL_LIGHTS_SMOOTH, .far = 100, .peak = 20,
                          .specular = HL_NEED_ONE_EXPONENT, .exponent = 32 };
    return n;
}

struct hl_plan con_plan(enum hl_pipeline pipeline, const struct hl_needs *n,
                        const struct hl_caps *c)
{
    struct hl_plan p;
    enum hl_refusal why;
    if (hl_plan_make(&p, pipeline, n, c, &why) != HL_OK)
        fail_msg("refused: %d", (int)why);
    return p;
}

const struct hl_plan_reason *con_reason(const struct hl_plan *p,
                                        enum hl_reason why)
{
    for (uint32_t i = 0; i < p->n_reasons; i++)
        if (p->reason[i].why == why)
            return &p->reason[i];
    return NULL;
}
