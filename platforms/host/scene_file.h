/* SPDX-License-Identifier: Zlib */
#ifndef HLH_SCENE_FILE_H
#define HLH_SCENE_FILE_H
/* The file formats behind hlh_scene_load. Each fills a zeroed scene and
 * leaves bounds, counts and defaults to hlh_scene_finish; on failure *out may
 * hold parts, which the caller frees. */
#include "platforms/host/scene.h"

bool hlh_gltf_load(struct hlh_scene *out, const char *path,
                   struct hlh_error *error);
bool hlh_obj_load(struct hlh_scene *out, const char *path,
                  struct hlh_error *error);
#endif
