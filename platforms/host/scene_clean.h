/* SPDX-License-Identifier: Zlib */
#ifndef HLH_SCENE_CLEAN_H
#define HLH_SCENE_CLEAN_H
/* What every mesh and every scene passes through on load, whatever format it
 * came from, so that struct hlh_scene keeps its promises. */
#include "platforms/host/scene.h"

/* Make a mesh keep what scene.h promises. On entry every index is below
 * n_vertices; everything else may be garbage. With has_normals false, and for
 * each NaN, infinite or zero normal, the face's normal is taken, and the
 * vertex is split where faces differ; the others are normalised. Triangles of
 * zero area (exactly, in double precision) or with a non-finite position are
 * dropped; unused vertices too, the order of the rest is kept, so that
 * cleaning twice changes nothing. A tangent that is not usable becomes
 * 0,0,0,0; colours are clamped to 0..1 as glTF asks, NaN becoming 1; texture
 * coordinates to +-1e6, NaN becoming 0. The counts are added to those of
 * *scene. False only when memory is out. */
bool hlh_mesh_clean(struct hlh_mesh *mesh, bool has_normals,
                    struct hlh_scene *scene);

/* Make vertices that are equal bit for bit one. False: out of memory. */
bool hlh_mesh_merge(struct hlh_mesh *mesh);

/* Count triangles, find the bounds and, with defaults, add the camera and
 * lights that scene.h documents where the scene has none. Objects that are
 * scaled down to a line or a point are removed and their triangles counted as
 * dropped. False with a reason: no triangles at all, more than 2^31 of
 * them, or a position beyond 1e12 metres (squares would overflow a float). */
bool hlh_scene_finish(struct hlh_scene *scene, const char *file,
                      bool defaults, struct hlh_error *error);

/* A material of glTF's default values: white metal of roughness 1. */
void hlh_material_default(struct hlh_material *material);
#endif
