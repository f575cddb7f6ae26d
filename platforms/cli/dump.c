/* SPDX-License-Identifier: Zlib */
/* --dump: every target of a frame, once as a picture to look at (PNG) and
 * once as exact numbers (PFM, 16-bit PNG), and an index that says what each
 * one is. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/dump.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"

/* What a texel looks like: v is the stored texel, its pair of numbers where
 * the role has one; rgb what is written. */
typedef void (*look)(const struct hlc_render *, const float v[4],
                     float rgb[3]);

/* ---- files ------------------------------------------------------------- */

static char *path_of(const struct hlc_dump *d, const char *name)
{
    size_t bytes = strlen(d->r->o->dump) + strlen(name) + 2;
    char *path = malloc(bytes);
    if (path)
        snprintf(path, bytes, "%s/%s", d->r->o->dump, name);
    return path;
}

static bool start(struct hlc_dump *d, const char *name, const char *what,
                  char **path)
{
    *path = path_of(d, name);
    hlh_buffer_print(&d->index, "%-24s %s\n", name, what);
    return *path || hlh_fail(d->error, name, "out of memory");
}

static bool finish(struct hlc_dump *d, char *path, bool ok)
{
    if (ok)
        hlc_outputs_add(d->files, path);
    free(path);
    return ok;
}

bool hlc_dump_picture(struct hlc_dump *d, const char *name, const char *what,
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

static bool write_ids(struct hlc_dump *d, const char *name, const char *what,
                      const uint32_t *ids, uint32_t w, uint32_t h)
{
    char *path;
    if (!start(d, name, what, &path))
        return false;
    return finish(d, path, hlh_ids_write_png(ids, w, h, path, d->error));
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
    hlc_show3(rgb, n.x * 0.5f + 0.5f, n.y * 0.5f + 0.5f, n.z * 0.5f + 0.5f);
}

static void as_dsf_depth(const struct hlc_render *r, const float v[4],
                         float rgb[3])
{
    (void)r;
    hlc_show3(rgb, v[0], v[0], v[0]);
}

static void as_metres(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = v[0] * (float)r->far;
}

static uint32_t region_of(const struct hlc_render *r, const float v[4])
{
    return (uint32_t)(v[1] * r->shot.plan.id_steps + 0.5f);
}

static void as_region(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    hlc_show_id(rgb, region_of(r, v));
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
    hlc_show3(rgb, v[0], v[0], v[0]);
}

static void as_diffuse(const struct hlc_render *r, const float v[4],
                       float rgb[3])
{
    for (int k = 0; k < 3; k++)
        rgb[k] = v[k] * r->shot.plan.light_scale;
}

static void as_specular(const struct hlc_render *r, const float v[4],
                        float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = v[3] * r->shot.plan.light_scale;
}

/* Saturates at a 64th of the screen. */
static void as_motion(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    (void)r;
    hlc_show3(rgb, 0.5f + 16 * hl_motion_decode(v[0]),
              0.5f - 16 * hl_motion_decode(v[1]), 0.5f);
}

static void as_pixels(const struct hlc_render *r, const float v[4],
                      float rgb[3])
{
    rgb[0] = hl_motion_decode(v[0]) * 0.5f * (float)r->shot.plan.width;
    rgb[1] = hl_motion_decode(v[1]) * -0.5f * (float)r->shot.plan.height;
    rgb[2] = 0;
}

/* Device depth to metres, as core/frame_view.c lays it out; what lies beyond
 * far, without a far plane, counts as there. */
static void as_z(const struct hlc_render *r, const float v[4], float rgb[3])
{
    double n = r->near, f = r->far, d = (double)v[0];
    double e = r->shot.plan.reversed_depth ? d : 1 - d;
    double z = !r->shot.plan.infinite_far ? n * f / (e * (f - n) + n)
               : e > n / f ? n / e : f;
    rgb[0] = rgb[1] = rgb[2] = (float)z;
}

static void as_z_share(const struct hlc_render *r, const float v[4],
                       float rgb[3])
{
    as_z(r, v, rgb);
    hlc_show3(rgb, rgb[0] / (float)r->far, rgb[0] / (float)r->far,
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
    { HL_ROLE_MOTION, "motion.png", "screen motion: grey is still, red to the "
      "right, green down; a 64th of the screen is the most", as_motion, false },
    { HL_ROLE_MOTION, "motion.pfm", "the same in pixels right and down",
      as_pixels, false },
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

/* Roles that keep a pair of numbers a texel. */
static bool is_pair(const struct hl_plan *p, enum hl_role role)
{
    return role == HL_ROLE_NORMAL || role == HL_ROLE_DSF ||
           role == HL_ROLE_MOTION || (role == HL_ROLE_EXPONENT && p->brdfs);
}

static void texel_of(const struct hlc_dump *d, const struct hlc_texels *t,
                     enum hl_role role, size_t i, float v[4])
{
    hlc_texel(v, t, i);
    if (!is_pair(&d->r->shot.plan, role))
        return;
    hlc_two16(v, d->r->shot.plan.two16, v);
    v[2] = 0;
}

static bool dump_look(struct hlc_dump *d, const struct hlc_texels *t,
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
    bool ok = hlc_dump_picture(d, f->name, f->what, &p,
                            f->light ? d->r->o->exposure : 0);
    free(p.rgb);
    return ok;
}

static bool dump_regions(struct hlc_dump *d, const struct hlc_texels *t)
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

static bool dump_target(struct hlc_dump *d, const struct hl_plan_target *target)
{
    struct hlc_texels t;
    bool ok = true;
    if (target->samples > 1 || target->role == HL_ROLE_COLOR ||
        target->role == HL_ROLE_RESOLVED)
        return true;
    enum hl_result e = hlc_texels_read(&t, d->r->stage.machine.device,
                                       hl_renderer_target(d->r->shot.renderer,
                                                          target->role));
    if (e != HL_OK)
        return hlh_fail(d->error, hlc_role_name(target->role), "%s",
                        hl_result_name(e));
    for (size_t i = 0; i < sizeof target_files / sizeof *target_files; i++)
        if (target_files[i].role == target->role)
            ok = ok && dump_look(d, &t, &target_files[i]);
    if (target->role == HL_ROLE_DSF)
        ok = ok && dump_regions(d, &t);
    if (target->role == HL_ROLE_SHADOW_MAP)
        ok = ok && hlc_dump_shadow_map(d, &t);
    hlc_texels_free(&t);
    return ok;
}

static bool dump_index(struct hlc_dump *d)
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
    struct hlc_dump d = { r, files, error, { NULL, 0, 0, false } };
    bool ok = hlc_outputs_folder(files, r->o->dump, error) &&
              hlc_dump_picture(&d, "frame.png", "the picture, as --out",
                            &r->picture, r->o->exposure) &&
              hlc_dump_picture(&d, "frame.pfm", "the picture, linear",
                            &r->picture, 0);
    for (uint32_t i = 0; ok && i < r->shot.plan.n_targets; i++)
        ok = dump_target(&d, &r->shot.plan.target[i]);
    ok = ok && hlc_dump_inside(&d) && dump_index(&d);
    hlh_buffer_free(&d.index);
    return ok;
}
