/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/host/scene_clean.h"
#include "platforms/host/scene_file.h"
#include "platforms/host/util.h"

bool hlh_scene_load(struct hlh_scene *out, const char *name_or_path,
                    struct hlh_error *error)
{
    const char *path = name_or_path, *builtin;
    bool ok;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; (builtin = hlh_scene_builtin_name(i, NULL)); i++)
        if (strcmp(builtin, path) == 0)
            return hlh_scene_builtin(out, path, error);
    if (hlh_path_is(path, "gltf") || hlh_path_is(path, "glb"))
        ok = hlh_gltf_load(out, path, error);
    else if (hlh_path_is(path, "obj"))
        ok = hlh_obj_load(out, path, error);
    else
        return hlh_fail(error, path, "is neither a built-in scene nor a "
                        ".gltf, .glb or .obj file");
    if (ok) {
        out->name = hlh_strdup(hlh_path_base(path));
        if (out->name)
            ok = hlh_scene_finish(out, path, true, error);
        else
            ok = hlh_fail(error, path, "out of memory");
    }
    if (!ok)
        hlh_scene_free(out);
    return ok;
}
