/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/json.h"

static void put3(cJSON *object, const char *key, const float v[3])
{
    double d[3] = { (double)v[0], (double)v[1], (double)v[2] };
    hlc_json_reals(object, key, d, 3, 9);
}

static void put_limit(cJSON *object, const char *key, double metres)
{
    if (metres > 0)
        hlc_json_real(object, key, metres, 9);
    else
        cJSON_AddNullToObject(object, key);
}

void hlc_json_scene(cJSON *tree, const struct hlh_scene *s, double near,
                    double far)
{
    cJSON *o = cJSON_AddObjectToObject(tree, "scene");
    cJSON_AddStringToObject(o, "name", s->name ? s->name : "");
    hlc_json_uint(o, "objects", s->n_objects);
    hlc_json_uint(o, "triangles", s->n_triangles);
    hlc_json_uint(o, "lights", s->n_lights);
    hlc_json_uint(o, "lights_range_derived", s->lights_range_derived);
    cJSON_AddBoolToObject(o, "lights_are_default", s->lights_are_default);
    hlc_json_uint(o, "triangles_dropped", s->triangles_dropped);
    hlc_json_uint(o, "normals_repaired", s->normals_repaired);
    put3(o, "ambient", s->ambient);
    put3(o, "background", s->background);
    put3(o, "bounds_min", s->bounds_min);
    put3(o, "bounds_max", s->bounds_max);
    o = cJSON_AddObjectToObject(tree, "camera");
    put3(o, "eye", s->camera.eye);
    put3(o, "target", s->camera.target);
    hlc_json_real(o, "vfov", (double)s->camera.vfov, 9);
    put_limit(o, "near", near);
    put_limit(o, "far", far);
    cJSON_AddBoolToObject(o, "default", s->camera_is_default);
}
