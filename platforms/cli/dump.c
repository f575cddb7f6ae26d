/* SPDX-License-Identifier: Zlib */
/* --dump: every target of a frame, once as a picture to look at (PNG) and
 * once as exact numbers (PFM, 16-bit PNG), and an index that says what each
 * one is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/plan_text.h"
#include "platforms/cli/readback.h"
#include "platforms/cli/render.h"
#include "platforms/host/util.h"
#include "shaders/shared/pack.h"

struct dump {
    struct hlc_render *r;
    struct hlc_outputs *files;
    struct hlh_error *error;
    struct hlh_buffer index;
};

/* What a texel looks like: v is the stored texel, its pair of numbers where
 * the role has one; rgb what is written. */
typedef void (*look)(const struct hlc_render *, const float v[4],
                     float rgb[3]);

/* ---- files ------------------------------------------------------------- */

static char *path_of(const struct dump *d, const char *name)
{
    size_t bytes = strlen(d->r->o->dump) + strlen(name) + 2;
    char *path = malloc(bytes);
    if (path)
        snprintf(path, bytes, "%s/%s", d->r->o->dump, name);
    return path;
}

static bool start(struct dump *d, const char *name, const char *what,
                  char **path)
{
    *path = path_of(d, name);
    hlh_buffer_print(&d->index, "%-24s %s\n", name, what);
    return *path || hlh_fail(d->error, name, "out of memory");
}

static bool finish(struct dump *d, char *path, bool ok)
{
    if (ok)
        hlc_outputs_add(d->files, path);
    free(path);
    return ok;
}

static bool write_picture(struct dump *d, const char *name, const char *what,
                          const struct hlh_picture *p, double exposure)
{
    char *path;
    size_t n = strlen(name);
    if (!start(d, name, what, &path))
        return false;
    bool pfm = n > 4 && strcmp(name + n - 4, ".pfm") == 0;
    return finish(d, path, pfm ? hlh_picture_write_pfm(p, path, d->error)
                               : hlh_picture_write_png(p, exposure, path,
                                                       d->error));
}

static bool write_ids(struct dump *d, const char *name, const char *what,
                      const uint32_t *ids, uint32_t w, uint32_t h)
{
    char *path;
    if (!start(d, name, what, &path))
        return false;
    return finish(d, path, hlh_ids_write_png(ids, w, h, path, d->error));
}

/* ---- colours ----------------------------------------------------------- */

/* PNGs are written as sRGB: what is to be seen as code c is given as its
 * linear light. */
static float shown(float c)
{
    float x = c < 0 ? 0 : c > 1 ? 1 : c;
    return x <= 0.04045f ? x / 12.92f
                         : (float)pow((x + 0.055) / 1.055, 2.4);
}

static void show3(float rgb[3], float r, float g, float b)
{
    rgb[0] = shown(r);
    rgb[1] = shown(g);
    rgb[2] = shown(b);
}

/* A colour of its own for each number; 0 is black. */
static void show_id(float rgb[3], uint32_t id)
{
    uint32_t x = id * UINT32_C(0x9E3779B1);
    x = (x ^ x >> 15) * UINT32_C(0x85EBCA77);
    x ^= x >> 13;
    if (id == 0)
        show3(rgb, 0, 0, 0);
    else
        show3(rgb, (float)(64 + (x & 191u)) / 255.0f,
              (float)(64 + (x >> 8 & 191u)) / 255.0f,
              (float)(64 + (x >> 16 & 191u)) / 255.0f);
}

/* 0 black, then blue, cyan, green, yellow, red, 1 white. */
static void show_heat(float rgb[3], float x)
{
    static const float ramp[7][3] = {
        { 0, 0, 0 }, { 0.1f, 0.1f, 0.8f }, { 0, 0.7f, 0.8f },
        { 0.1f, 0.7f, 0.1f }, { 0.95f, 0.9f, 0.1f }, { 0.9f, 0.15f, 0.1f },
        { 1, 1, 1 }
    };
    float t = (x < 0 ? 0 : x > 1 ? 1 : x) * 6;
    int i = t < 5 ? (int)t : 5;
    float f = t - (float)i;
    show3(rgb, ramp[i][0] + f * (ramp[i + 1][0] - ramp[i][0]),
          ramp[i][1] + f * (ramp[i + 1][1] - ramp[i][1]),
          ramp[i][2] + f * (ramp[i + 1][2] - ramp[i][2]));
}

/* ---- what texels mean -------------------------------------------------- */

static void stored(const struct hlc_render *r, const float v[4], float rgb[3])
{
    (void)r;
    memcpy(rgb, v, 3 * sizeof *rgb);
}

static void as_normal(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    (void)r;
    hl_vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(v[0]),
                                       hl_unorm_to_snorm(v[1])));
    show3(rgb, n.x * 0.5f + 0.5f, n.y * 0.5f + 0.5f, n.z * 0.5f + 0.5f);
}

static void as_dsf_depth(const struct hlc_render *r, const float v[4],
                         float rgb[3])
{
    (void)r;
    show3(rgb, v[0], v[0], v[0]);
}

static void as_metres(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = v[0] * (float)r->far;
}

static uint32_t region_of(const struct hlc_render *r, const float v[4])
{
    return (uint32_t)(v[1] * r->plan.id_steps + 0.5f);
}

static void as_region(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    show_id(rgb, region_of(r, v));
}

static void as_exponent(const struct hlc_render *r, const float v[4],
                        float rgb[3])
{
    (void)r;
    rgb[0] = rgb[1] = rgb[2] = hl_exponent_decode(v[0]);
}

static void as_level(const struct hlc_render *r, const float v[4],
                     float rgb[3])
{
    (void)r;
    show3(rgb, v[0], v[0], v[0]);
}

static void as_diffuse(const struct hlc_render *r, const float v[4],
                       float rgb[3])
{
    for (int k = 0; k < 3; k++)
        rgb[k] = v[k] * r->plan.light_scale;
}

static void as_specular(const struct hlc_render *r, const float v[4],
                        float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = v[3] * r->plan.light_scale;
}

/* Device depth to metres, as core/frame_data.c lays it out. */
static void as_z(const struct hlc_render *r, const float v[4], float rgb[3])
{
    double n = r->near, f = r->far, d = (double)v[0];
    double z = r->plan.reversed_depth ? n * f / (d * (f - n) + n)
                                      : n * f / (f - d * (f - n));
    rgb[0] = rgb[1] = rgb[2] = (float)z;
}

static void as_z_share(const struct hlc_render *r, const float v[4],
                       float rgb[3])
{
    as_z(r, v, rgb);
    show3(rgb, rgb[0] / (float)r->far, rgb[0] / (float)r->far,
          rgb[0] / (float)r->far);
}

/* ---- targets ----------------------------------------------------------- */

static const struct target_file {
    enum hl_role role;
    const char *name, *what;
    look look;
    bool light;                  /* light: the exposure applies              */
} target_files[] = {
    { HL_ROLE_NORMAL, "normal.png", "view-space normals, 0.5 + 0.5 n",
      as_normal, false },
    { HL_ROLE_NORMAL, "normal_stored.pfm", "the G-buffer's two numbers",
      stored, false },
    { HL_ROLE_DSF, "depth.png", "linear depth that the DSF reads, black at "
      "the eye, white at far", as_dsf_depth, false },
    { HL_ROLE_DSF, "depth.pfm", "the same in metres", as_metres, false },
    { HL_ROLE_DSF, "regions.png", "region ids that the DSF compares, a colour "
      "each", as_region, false },
    { HL_ROLE_EXPONENT, "exponent.png", "specular exponent as stored: black "
      "1, white 256", as_level, false },
    { HL_ROLE_EXPONENT, "exponent.pfm", "specular exponent, 1 to 256",
      as_exponent, false },
    { HL_ROLE_LIGHT_DEPTH, "light_depth.png", "depth buffer at L-buffer size, "
      "made linear", as_z_share, false },
    { HL_ROLE_LIGHT_DEPTH, "light_depth.pfm", "the same in metres", as_z,
      false },
    { HL_ROLE_DEPTH_COPY, "depth_copy.png", "light_depth as it is copied to be "
      "read", as_z_share, false },
    { HL_ROLE_DEPTH_COPY, "depth_copy.pfm", "the same in metres", as_z,
      false },
    { HL_ROLE_LIGHT, "light_diffuse.png", "L-buffer: diffuse light",
      as_diffuse, true },
    { HL_ROLE_LIGHT, "light_diffuse.pfm", "the same, linear", as_diffuse,
      true },
    { HL_ROLE_LIGHT, "light_specular.png", "L-buffer: specular intensity",
      as_specular, true },
    { HL_ROLE_LIGHT, "light_specular.pfm", "the same, linear", as_specular,
      true },
    { HL_ROLE_DEPTH, "frame_depth.png", "depth buffer of the frame, made "
      "linear", as_z_share, false },
    { HL_ROLE_DEPTH, "frame_depth.pfm", "the same in metres", as_z, false },
};

static void texel_of(const struct dump *d, const struct hlc_texels *t,
                     enum hl_role role, size_t i, float v[4])
{
    hlc_texel(v, t, i);
    if (role != HL_ROLE_NORMAL && role != HL_ROLE_DSF)
        return;
    hlc_two16(v, d->r->plan.two16, v);
    v[2] = 0;
}

static bool dump_look(struct dump *d, const struct hlc_texels *t,
                      const struct target_file *f)
{
    size_t n = (size_t)t->width * t->height;
    struct hlh_picture p = { t->width, t->height,
                             malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, f->name, "out of memory");
    for (size_t i = 0; i < n; i++) {
        float v[4];
        texel_of(d, t, f->role, i, v);
        f->look(d->r, v, p.rgb + 3 * i);
    }
    bool ok = write_picture(d, f->name, f->what, &p,
                            f->light ? d->r->o->exposure : 0);
    free(p.rgb);
    return ok;
}

static bool dump_regions(struct dump *d, const struct hlc_texels *t)
{
    size_t n = (size_t)t->width * t->height;
    uint32_t *ids = malloc(n * sizeof *ids);
    if (!ids)
        return hlh_fail(d->error, "regions", "out of memory");
    for (size_t i = 0; i < n; i++) {
        float v[4];
        texel_of(d, t, HL_ROLE_DSF, i, v);
        ids[i] = region_of(d->r, v);
    }
    bool ok = write_ids(d, "regions_16bit.png", "the same, as numbers", ids,
                        t->width, t->height);
    free(ids);
    return ok;
}

static bool dump_target(struct dump *d, const struct hl_plan_target *target)
{
    struct hlc_texels t;
    bool ok = true;
    if (target->samples > 1 || target->role == HL_ROLE_COLOR ||
        target->role == HL_ROLE_RESOLVED)
        return true;
    enum hl_result e = hlc_texels_read(&t, d->r->machine.device,
                                       hl_renderer_target(d->r->renderer,
                                                          target->role));
    if (e != HL_OK)
        return hlh_fail(d->error, hlc_role_name(target->role), "%s",
                        hl_result_name(e));
    for (size_t i = 0; i < sizeof target_files / sizeof *target_files; i++)
        if (target_files[i].role == target->role)
            ok = ok && dump_look(d, &t, &target_files[i]);
    if (target->role == HL_ROLE_DSF)
        ok = ok && dump_regions(d, &t);
    hlc_texels_free(&t);
    return ok;
}

/* ---- statistics -------------------------------------------------------- */

static bool dump_ids(struct dump *d)
{
    uint32_t w = d->r->picture.width, h = d->r->picture.height;
    size_t n = (size_t)w * h;
    struct hlh_picture p = { w, h, malloc(n * 3 * sizeof(float)), true };
    if (!p.rgb)
        return hlh_fail(d->error, "ids.png", "out of memory");
    for (size_t i = 0; i < n; i++)
        show_id(p.rgb + 3 * i, d->r->inside.ids[i]);
    bool ok = write_picture(d, "ids.png", "objects and their normal groups, "
                            "a colour each", &p, 0);
    free(p.rgb);
    return ok;
}

static bool dump_lights(struct dump *d)
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
        show_heat(p.rgb + 3 * i, in->lights[i] / most);
    snprintf(what, sizeof what, "light evaluations a pixel: black 0, blue, "
             "green, red, white %.0f", (double)most);
    bool ok = write_picture(d, "lights.png", what, &p, 0);
    for (size_t i = 0; i < 3 * n; i++)
        p.rgb[i] = in->lights[i / 3];
    ok = ok && write_picture(d, "lights.pfm", "the same, as numbers", &p, 0);
    free(p.rgb);
    return ok;
}

static bool dump_rejects(struct dump *d)
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
        show3(p.rgb + 3 * i, c[0], c[1], c[2]);
    }
    bool ok = write_picture(d, "rejects.png", "DSF taps rejected: grey 0, "
                            "blue 1, green 2, yellow 3, red all 4", &p, 0);
    free(p.rgb);
    return ok;
}

static bool dump_index(struct dump *d)
{
    char *path = path_of(d, "index.txt");
    bool ok = path && !d->index.failed;
    if (ok)
        ok = hlh_file_write(path, d->index.bytes, d->index.size, d->error);
    else
        hlh_fail(d->error, "index.txt", "out of memory");
    return finish(d, path, ok);
}

bool hlc_dump(struct hlc_render *r, struct hlc_outputs *files,
              struct hlh_error *error)
{
    struct dump d = { r, files, error, { NULL, 0, 0, false } };
    const struct hlc_inside *in = &r->inside;
    bool ok = hlc_outputs_folder(files, r->o->dump, error) &&
              write_picture(&d, "frame.png", "the picture, as --out",
                            &r->picture, r->o->exposure) &&
              write_picture(&d, "frame.pfm", "the picture, linear",
                            &r->picture, 0);
    for (uint32_t i = 0; ok && i < r->plan.n_targets; i++)
        ok = dump_target(&d, &r->plan.target[i]);
    ok = ok && (!in->ids || dump_ids(&d)) && (!in->lights || dump_lights(&d))
         && (!in->rejects || dump_rejects(&d)) && dump_index(&d);
    hlh_buffer_free(&d.index);
    return ok;
}
