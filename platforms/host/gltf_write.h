/* SPDX-License-Identifier: Zlib */
#ifndef HLH_GLTF_WRITE_H
#define HLH_GLTF_WRITE_H
#include "platforms/host/scene.h"
#include "platforms/host/util.h"

/* Lights that x,y,z,radius,r,g,b cannot say go into the GLB. */
static inline bool hlh_light_in_csv(const struct hlh_light *l)
{
    return l->kind == HLH_LIGHT_POINT && l->falloff == HLH_FALLOFF_SMOOTH &&
           !l->shadow;
}

/* Append the scene as a GLB 2.0 file. file is for error lines. Fails beyond
 * 4 GiB. What glTF has no word for goes into extras (scene.h). Floats are
 * printed so that they read back bit for bit. */
bool hlh_glb_encode(struct hlh_buffer *out, const struct hlh_scene *scene,
                    const char *file, struct hlh_error *error);
#endif
