/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/json.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

cJSON *hlc_json_begin(const char *command)
{
    cJSON *tree = cJSON_CreateObject();
    cJSON_AddNumberToObject(tree, "version", HLC_JSON_VERSION);
    cJSON_AddStringToObject(tree, "command", command);
    return tree;
}

/* cJSON prints 17 digits of what 9 say, so numbers go in as text. */
static cJSON *real(double value, int digits)
{
    char text[40];
    if (!isfinite(value))
        return cJSON_CreateNull();
    snprintf(text, sizeof text, "%.*g", digits, value);
    return cJSON_CreateRaw(text);
}

static void add(cJSON *object, const char *key, cJSON *item)
{
    if (!cJSON_AddItemToObject(object, key, item))
        cJSON_Delete(item);
}

void hlc_json_real(cJSON *object, const char *key, double value, int digits)
{
    add(object, key, real(value, digits));
}

void hlc_json_reals(cJSON *object, const char *key, const double *values,
                    int n, int digits)
{
    cJSON *array = cJSON_CreateArray();
    for (int i = 0; i < n; i++)
        cJSON_AddItemToArray(array, real(values[i], digits));
    add(object, key, array);
}

void hlc_json_uint(cJSON *object, const char *key, uint64_t value)
{
    cJSON_AddNumberToObject(object, key, (double)value);
}

void hlc_json_size(cJSON *object, const char *key, uint32_t width,
                   uint32_t height)
{
    double size[2] = { width, height };
    hlc_json_reals(object, key, size, 2, 10);
}

bool hlc_json_emit(const cJSON *tree, const char *path,
                   struct hlh_error *error)
{
    char *text = tree ? cJSON_Print(tree) : NULL;
    bool ok;
    if (!text)
        return hlh_fail(error, path, "out of memory for the JSON");
    size_t n = strlen(text);
    text[n] = '\n';          /* over the NUL: n + 1 bytes are there          */
    if (strcmp(path, "-"))
        ok = hlh_file_write(path, text, n + 1, error);
    else if (fwrite(text, 1, n + 1, stdout) == n + 1 && fflush(stdout) == 0)
        ok = true;
    else
        ok = hlh_fail(error, "stdout", "cannot be written");
    free(text);
    return ok;
}
