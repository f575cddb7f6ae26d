/* SPDX-License-Identifier: Zlib */
/* The scene, as the command line changed it. */
#include <string.h>
#include "platforms/cli/setup.h"

static void set3(float out[3], const double in[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (float)in[k];
}

static void override(struct hlh_scene *s, const struct hlc_options *o)
{
    if (o->has_camera) {
        memset(&s->camera, 0, sizeof s->camera);
        set3(s->camera.eye, o->eye);
        set3(s->camera.target, o->target);
        s->camera.vfov = (float)o->vfov;
        s->camera_is_default = false;
    }
    if (o->has_ambient)
        set3(s->ambient, o->ambient);
    if (o->has_background)
        set3(s->background, o->background);
}

static void set_masks(struct hlh_scene *s, enum hlc_mask mask)
{
    for (uint32_t i = 0; mask && i < s->n_materials; i++)
        s->materials[i].fence = mask == HLC_MASK_BLEND &&
                                s->materials[i].alpha == HLH_ALPHA_MASK;
}

static void set_shadows(struct hlh_scene *s, bool all)
{
    for (uint32_t i = 0; all && i < s->n_lights; i++)
        s->lights[i].shadow = true;
}

bool hlc_scene_open(struct hlh_scene *out, const struct hlc_options *o,
                    struct hlh_error *error)
{
    if (!hlh_scene_load(out, o->arg[0], error))
        return false;
    if (o->lights && !hlh_scene_lights_csv(out, o->lights, o->lights_replace,
                                           error)) {
        hlh_scene_free(out);
        return false;
    }
    override(out, o);
    set_masks(out, o->mask);
    set_shadows(out, o->shadow_lights_all);
    return true;
}
