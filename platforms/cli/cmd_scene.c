/* SPDX-License-Identifier: Zlib */
/* scene: the list of built-in scenes, or one scene written as files. */
#include <stdio.h>
#include "platforms/cli/commands.h"
#include "platforms/host/scene.h"

static int list(void)
{
    const char *name, *description;
    for (uint32_t i = 0; (name = hlh_scene_builtin_name(i, &description));
         i++)
        printf("%-16s %s\n", name, description);
    return HLC_DONE;
}

int hlc_cmd_scene(const struct hlc_options *o)
{
    struct hlh_scene scene;
    struct hlh_error error;
    if (!o->n_args)
        return list();
    if (!hlh_scene_load(&scene, o->arg[0], &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    bool ok = (!o->lights || hlh_scene_lights_csv(&scene, o->lights,
                                                  o->lights_replace, &error))
              && hlh_scene_write(&scene, o->out, &error);
    hlh_scene_free(&scene);
    return ok ? HLC_DONE : hlc_fail(HLC_BAD, "%s", error.text);
}
