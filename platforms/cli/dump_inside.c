/* SPDX-License-Identifier: Zlib */
/* --dump: pictures of what a frame counted, and of its shadow map. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "platforms/cli/dump.h"

/* ---- colours ----------------------------------------------------------- */

/* PNGs are written as sRGB: what is to be seen as code c is given as its
 * linear light. */
static float shown(float c)
{
    float x = c < 0 ? 0 : c > 1 ? 1 : c;
    return x <= 0.04045f ? x / 12.92f
                         : (float)pow((x + 0.055) / 1.055, 2.4);
}

void hlc_show3(float rgb[3], float r, float g, float b)
{
    rgb[0] = shown(r);
    rgb[1] = shown(g);
    rgb[2] = shown(b);
}

void hlc_show_id(float rgb[3], uint32_t id)
{
    uint32_t x = id * UINT32_C(0x9E3779B1);
    x = (x ^ x >> 15) * UINT32_C(0x85EBCA77);
    x ^= x >> 13;
    if (id == 0)
        hlc_show3(rgb, 0, 0, 0);
    else
        hlc_show3(rgb, (float)(64 + (x & 191u)) / 255.0f,
              (float)(64 + (x >> 8 & 191u)) / 255.0f,
              (float)(64 + (x >> 16 & 191u)) / 255.0f);
}

void hlc_show_heat(float rgb[3], float x)
{
    static const float ramp[7][3] = {
        { 0, 0, 0 }, { 0.1f, 0.1f, 0.8f }, { 0, 0.7f, 0.8f },
        { 0.1f, 0.7f, 0.1f }, { 0.95f, 0.9f, 0.1f }, { 0.9f, 0.15f, 0.1f },
        { 1, 1, 1 }
    };
    float t = (x < 0 ? 0 : x > 1 ? 1 : x) * 6;
    int i = t < 5 ? (int)t : 5;
    float f = t - (float)i;
    hlc_show3(rgb, ramp[i][0] + f * (ramp[i + 1][0] - ramp[i][0]),
          ramp[i][1] + f * (ramp[i + 1][1] - ramp[i][1]),
          ramp[i][2] + f * (ramp[i + 1][2] - ramp[i][2]));
}

static bool dump_ids(struct hlc_dump *d)
{
    uint32_t w = d->r->picture.width, h = d->r->picture.height;
    size_t n = (size_t)w * h;
    struct hlh_picture p = { w, h, malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, "ids.png", "out of memory");
    for (size_t i = 0; i < n; i++)
        hlc_show_id(p.rgb + 3 * i, d->r->inside.ids[i]);
    bool ok = hlc_dump_picture(d, "ids.png", "objects and their normal groups, "
                            "a colour each", &p, 0);
    free(p.rgb);
    return ok;
}

static bool dump_lights(struct hlc_dump *d)
{
    const struct hlc_inside *in = &d->r->inside;
    size_t n = (size_t)in->lights_width * in->lights_height;
    struct hlh_picture p = { in->lights_width, in->lights_height,
                             malloc(n * 3 * sizeof(float)), true };
    float most = 1;
    char what[80];
    if (!p.rgb)
        return hlh_fail(d->error, "lights.png", "out of memory");
    for (size_t i = 0; i < n; i++)
        most = in->lights[i] > most ? in->lights[i] : most;
    for (size_t i = 0; i < n; i++)
        hlc_show_heat(p.rgb + 3 * i, in->lights[i] / most);
    snprintf(what, sizeof what, "light evaluations a pixel: black 0, blue, "
             "green, red, white %.0f", (double)most);
    bool ok = hlc_dump_picture(d, "lights.png", what, &p, 0);
    for (size_t i = 0; i < 3 * n; i++)
        p.rgb[i] = in->lights[i / 3];
    ok = ok && hlc_dump_picture(d, "lights.pfm", "the same, as numbers", &p, 0);
    free(p.rgb);
    return ok;
}

static bool dump_rejects(struct hlc_dump *d)
{
    static const float colors[6][3] = {
        { 0, 0, 0 }, { 0.25f, 0.25f, 0.25f }, { 0.1f, 0.4f, 0.9f },
        { 0.1f, 0.75f, 0.3f }, { 0.95f, 0.8f, 0.1f }, { 0.9f, 0.1f, 0.1f }
    };
    uint32_t w = d->r->picture.width, h = d->r->picture.height;
    size_t n = (size_t)w * h;
    struct hlh_picture p = { w, h, malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, "rejects.png", "out of memory");
    for (size_t i = 0; i < n; i++) {
        const float *c = colors[d->r->inside.rejects[i] % 6];
        hlc_show3(p.rgb + 3 * i, c[0], c[1], c[2]);
    }
    bool ok = hlc_dump_picture(d, "rejects.png", "DSF taps rejected: grey 0, "
                            "blue 1, green 2, yellow 3, red all 4", &p, 0);
    free(p.rgb);
    return ok;
}

/* Neighbouring patterns far apart: hues by the golden angle. */
static void show_pattern(float rgb[3], uint32_t pattern)
{
    float hue = (float)(pattern - 1) * 0.618034f;
    float c[3];
    for (int k = 0; k < 3; k++) {
        float t = hue + (float)k / 3;
        t = fabsf((t - floorf(t)) * 6 - 3) - 1;
        c[k] = 0.15f + 0.85f * (t < 0 ? 0 : t > 1 ? 1 : t);
    }
    hlc_show3(rgb, c[0], c[2], c[1]);
}

static bool dump_stipple(struct hlc_dump *d)
{
    const struct hlc_inside *in = &d->r->inside;
    uint32_t w = d->r->shot.plan.light_width, h = d->r->shot.plan.light_height;
    size_t n = (size_t)w * h;
    struct hlh_picture p = { w, h, malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, "stipple.png", "out of memory");
    for (size_t i = 0; i < n; i++)
        if (in->stipple[i] > 1)
            show_pattern(p.rgb + 3 * i, in->stipple[i] - 1u);
        else
            hlc_show3(p.rgb + 3 * i, 0.25f * in->stipple[i],
                      0.25f * in->stipple[i], 0.25f * in->stipple[i]);
    bool ok = hlc_dump_picture(d, "stipple.png", "who is in each L-buffer "
                               "texel: black nothing, grey opaque, a colour a "
                               "pattern", &p, 0);
    free(p.rgb);
    return ok;
}

bool hlc_dump_inside(struct hlc_dump *d)
{
    const struct hlc_inside *in = &d->r->inside;
    return (!in->ids || dump_ids(d)) && (!in->lights || dump_lights(d)) &&
           (!in->rejects || dump_rejects(d)) &&
           (!in->stipple || dump_stipple(d));
}

/* Depth of a perspective crowds near 0: what is in the map is spread over
 * black (near) to light grey; white is nothing. */
bool hlc_dump_shadow_map(struct hlc_dump *d, const struct hlc_texels *t)
{
    size_t n = (size_t)t->width * t->height;
    float low = 1, high = 0, v[4];
    bool reversed = d->r->shot.plan.reversed_depth;
    float empty = reversed ? 0.0f : 1.0f;
    struct hlh_picture p = { t->width, t->height,
                             malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, "shadow_map.png", "out of memory");
    for (size_t i = 0; i < n; i++) {
        hlc_texel(v, t, i);
        p.rgb[3 * i] = v[0];
        if (v[0] < empty || v[0] > empty) {
            low = v[0] < low ? v[0] : low;
            high = v[0] > high ? v[0] : high;
        }
    }
    for (size_t i = 0; i < n; i++) {
        float z = p.rgb[3 * i];
        float x = (z - low) / (high > low ? high - low : 1);
        bool none = !(z < empty || z > empty);
        float c = none ? 1 : 0.85f * (reversed ? 1 - x : x);
        hlc_show3(p.rgb + 3 * i, c, c, c);
    }
    bool ok = hlc_dump_picture(d, "shadow_map.png", "depth from the light "
                               "drawn last with shadows: black the nearest, "
                               "white nothing", &p, 0);
    free(p.rgb);
    return ok;
}
