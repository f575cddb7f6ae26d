/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/host/gltf_write.h"
#include "platforms/host/image.h"

enum { GLB, CSV, CAMERA, N_FILES };

static void print_csv(struct hlh_buffer *out, const struct hlh_scene *s)
{
    hlh_buffer_print(out, "# x,y,z,radius,r,g,b (metres, linear RGB; smooth "
                     "falloff)\n");
    for (uint32_t i = 0; i < s->n_lights; i++) {
        const struct hlh_light *l = &s->lights[i];
        if (hlh_light_in_csv(l))
            hlh_buffer_print(out, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                             l->position[0], l->position[1], l->position[2],
                             l->radius, l->color[0], l->color[1],
                             l->color[2]);
    }
}

static void print_camera(struct hlh_buffer *out, const struct hlh_scene *s)
{
    const struct hlh_camera *c = &s->camera;
    hlh_buffer_print(out, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g 1280x720 "
                     "ambient %.9g,%.9g,%.9g\n", c->eye[0], c->eye[1],
                     c->eye[2], c->target[0], c->target[1], c->target[2],
                     c->vfov, s->ambient[0], s->ambient[1], s->ambient[2]);
}

static bool write_files(const struct hlh_buffer *file,
                        char *const path[N_FILES], struct hlh_error *error)
{
    for (int i = 0; i < N_FILES; i++)
        if (!hlh_file_write(path[i], file[i].bytes, file[i].size, error)) {
            /* Complete as each is, a part of the three is no scene. */
            while (i-- > 0)
                unlink(path[i]);
            return false;
        }
    return true;
}

static bool write_all(const struct hlh_scene *scene, char *path[N_FILES],
                      const char *prefix, struct hlh_error *error)
{
    static const char *const ending[N_FILES] = {".glb", ".lights.csv",
                                                ".camera"};
    struct hlh_buffer file[N_FILES] = {{0}};
    bool ok = true;
    for (int i = 0; i < N_FILES && ok; i++) {
        size_t room = strlen(prefix) + strlen(ending[i]) + 1;
        path[i] = malloc(room);
        if (path[i])
            snprintf(path[i], room, "%s%s", prefix, ending[i]);
        else
            ok = hlh_fail(error, prefix, "out of memory");
    }
    ok = ok && hlh_glb_encode(&file[GLB], scene, path[GLB], error);
    if (ok) {
        print_csv(&file[CSV], scene);
        print_camera(&file[CAMERA], scene);
        ok = !file[CSV].failed && !file[CAMERA].failed;
        ok = ok ? write_files(file, path, error)
                : hlh_fail(error, prefix, "out of memory");
    }
    for (int i = 0; i < N_FILES; i++)
        hlh_buffer_free(&file[i]);
    return ok;
}

bool hlh_scene_write(const struct hlh_scene *scene, const char *prefix,
                     struct hlh_error *error)
{
    char *path[N_FILES] = {NULL};
    bool ok = write_all(scene, path, prefix, error);
    for (int i = 0; i < N_FILES; i++)
        free(path[i]);
    return ok;
}
