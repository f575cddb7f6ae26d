/* SPDX-License-Identifier: Zlib */
#ifndef HLC_JSON_H
#define HLC_JSON_H
/* JSON output of the tool; keys and meaning are documented in docs/json.md.
 * cJSON trees are the caller's: cJSON_Delete. A NULL tree (memory is out)
 * may be passed on; hlc_json_emit then fails. */
#include <stdbool.h>
#include <cjson/cJSON.h>
#include "platforms/host/scene.h"

enum { HLC_JSON_VERSION = 1 }; /* raised when a key changes or goes          */

/* {"version", "command"} */
cJSON *hlc_json_begin(const char *command);
/* A number with `digits` significant digits (1..17), null when not finite:
 * a float has 9, a measured time 4. */
void hlc_json_real(cJSON *object, const char *key, double value, int digits);
/* An array of such numbers. */
void hlc_json_reals(cJSON *object, const char *key, const double *values,
                    int n, int digits);
/* Exact up to 2^53. */
void hlc_json_uint(cJSON *object, const char *key, uint64_t value);
/* [width, height] */
void hlc_json_size(cJSON *object, const char *key, uint32_t width,
                   uint32_t height);
/* The "scene" and "camera" objects. near and far in metres, 0 = no limit. */
void hlc_json_scene(cJSON *tree, const struct hlh_scene *scene, double near,
                    double far);
/* Write the tree and a line end to path by temporary file and rename, or to
 * stdout when path is "-". */
bool hlc_json_emit(const cJSON *tree, const char *path,
                   struct hlh_error *error);
#endif
