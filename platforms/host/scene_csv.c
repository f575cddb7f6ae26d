/* SPDX-License-Identifier: Zlib */
/* Lights as text: x,y,z,radius,r,g,b a line. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

/* What stands for more than the longest line that could be meant. */
enum { LINE_LIMIT = 1000, N_FIELDS = 7 };

static const char *const field_name[N_FIELDS] = {"x", "y", "z", "radius",
                                                 "r", "g", "b"};

/* Squares and products of these stay within a float. */
static const double field_limit[N_FIELDS] = {1e12, 1e12, 1e12, 1e18,
                                             1e30, 1e30, 1e30};

static const char *skip_blanks(const char *s)
{
    while (*s == ' ' || *s == '\t' || *s == '\r')
        s++;
    return s;
}

/* strtod alone would also take hexadecimal numbers and leading line ends. */
static bool number(const char **at, double *value)
{
    const char *s = skip_blanks(*at);
    char *end;
    size_t digits = strspn(s, "+-.0123456789eE");
    if (!digits && strncmp(s, "nan", 3) && strncmp(s, "inf", 3))
        return false;
    *value = strtod(s, &end);
    if (end == s || (digits && (size_t)(end - s) > digits))
        return false;
    *at = skip_blanks(end);
    return true;
}

static bool parse_line(struct hlh_light *l, const char *line, unsigned at,
                       const char *path, struct hlh_error *error)
{
    float v[N_FIELDS];
    for (int i = 0; i < N_FIELDS; i++) {
        double value;
        if (!number(&line, &value))
            return hlh_fail(error, path, "line %u: field %d (%s): \"%.20s\" "
                            "is not a number; a line is x,y,z,radius,r,g,b, "
                            "with no header", at, i + 1, field_name[i], line);
        v[i] = (float)value;
        if (!isfinite(value))
            return hlh_fail(error, path, "line %u: %s is not finite", at,
                            field_name[i]);
        if (!(fabs(value) <= field_limit[i]))
            return hlh_fail(error, path, "line %u: %s is beyond %g", at,
                            field_name[i], field_limit[i]);
        if (i >= 3 && v[i] < 0)
            return hlh_fail(error, path, "line %u: %s is negative: %g", at,
                            field_name[i], value);
        if (i < N_FIELDS - 1 && *line != ',')
            return hlh_fail(error, path, "line %u: has %d of 7 numbers, "
                            "separated by commas: x,y,z,radius,r,g,b", at,
                            i + 1);
        if (i < N_FIELDS - 1)
            line++;
    }
    if (*line)
        return hlh_fail(error, path, "line %u: goes on after seven numbers: "
                        "\"%.20s\"", at, line);
    memset(l, 0, sizeof *l);
    l->kind = HLH_LIGHT_POINT;
    l->falloff = HLH_FALLOFF_SMOOTH;
    l->direction[1] = -1;
    memcpy(l->position, v, sizeof l->position);
    l->radius = v[3];
    memcpy(l->color, v + 4, sizeof l->color);
    return true;
}

static bool parse(struct hlh_light **lights, uint32_t *n, char *text,
                  size_t size, const char *path, struct hlh_error *error)
{
    unsigned at = 0;
    for (char *line = text, *end; line < text + size; line = end + 1) {
        const char *first;
        struct hlh_light *l, parsed;
        at++;
        end = memchr(line, '\n', (size_t)(text + size - line));
        if (!end)
            end = text + size;
        if (end - line > LINE_LIMIT)
            return hlh_fail(error, path, "line %u: is longer than %d bytes",
                            at, LINE_LIMIT);
        if (memchr(line, 0, (size_t)(end - line)))
            return hlh_fail(error, path, "line %u: holds a zero byte", at);
        *end = 0;
        first = skip_blanks(line);
        if (!*first || *first == '#')
            continue;
        if (!parse_line(&parsed, first, at, path, error))
            return false;
        l = hlh_push(lights, n, sizeof *l);
        if (!l)
            return hlh_fail(error, path, "out of memory");
        *l = parsed;
    }
    return true;
}

bool hlh_scene_lights_csv(struct hlh_scene *scene, const char *path,
                          bool replace, struct hlh_error *error)
{
    struct hlh_light *lights = NULL, *l;
    uint32_t n = 0, kept;
    size_t size;
    char *text;
    bool ok = true;
    if (!hlh_file_read(&text, &size, path, error))
        return false;
    /* Default lights stand in only while there are no others. */
    kept = replace || scene->lights_are_default ? 0 : scene->n_lights;
    for (uint32_t i = 0; ok && i < kept; i++) {
        l = hlh_push(&lights, &n, sizeof *l);
        if (l)
            *l = scene->lights[i];
        else
            ok = hlh_fail(error, path, "out of memory");
    }
    ok = ok && parse(&lights, &n, text, size, path, error);
    free(text);
    if (!ok) {
        free(lights);
        return false;
    }
    free(scene->lights);
    scene->lights = lights;
    scene->n_lights = n;
    scene->lights_are_default = false;
    if (!kept)
        scene->lights_range_derived = 0;
    return true;
}
