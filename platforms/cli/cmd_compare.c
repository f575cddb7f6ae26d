/* SPDX-License-Identifier: Zlib */
/* compare TEST REFERENCE: docs/json.md says what the numbers mean. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/cli/metrics.h"
#include "platforms/host/util.h"

struct pair {
    struct hlh_picture test, reference;
    uint32_t *ids;           /* NULL: not given                              */
};

static bool all_finite(const struct hlh_picture *p, const char *path,
                       struct hlh_error *error)
{
    static const char *const channel[3] = { "red", "green", "blue" };
    size_t n = (size_t)p->width * p->height * 3;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(p->rgb[i]))
            return hlh_fail(error, path, "pixel %u,%u: %s is %s",
                            (unsigned)(i / 3 % p->width),
                            (unsigned)(i / 3 / p->width), channel[i % 3],
                            isnan(p->rgb[i]) ? "not a number" : "infinite");
    return true;
}

static bool read_one(struct hlh_picture *out, const char *path,
                     struct hlh_error *error)
{
    return hlh_picture_read(out, path, error) &&
           all_finite(out, path, error);
}

static bool same_size(const char *path, uint32_t width, uint32_t height,
                      const struct hlh_picture *reference,
                      struct hlh_error *error)
{
    if (width == reference->width && height == reference->height)
        return true;
    return hlh_fail(error, path, "is %u x %u, the reference %u x %u",
                    (unsigned)width, (unsigned)height,
                    (unsigned)reference->width, (unsigned)reference->height);
}

static bool read_pair(struct pair *p, const struct hlc_options *o,
                      struct hlh_error *error)
{
    uint32_t width, height;
    if (!read_one(&p->test, o->arg[0], error) ||
        !read_one(&p->reference, o->arg[1], error) ||
        !same_size(o->arg[0], p->test.width, p->test.height, &p->reference,
                   error))
        return false;
    return !o->ids ||
           (hlh_ids_read_png(&p->ids, &width, &height, o->ids, error) &&
            same_size(o->ids, width, height, &p->reference, error));
}

static void free_pair(struct pair *p)
{
    hlh_picture_free(&p->test);
    hlh_picture_free(&p->reference);
    free(p->ids);
}

static cJSON *to_json(const struct hlc_metrics *m, const struct pair *p,
                      const struct hlc_options *o)
{
    cJSON *j = hlc_json_begin("compare");
    cJSON_AddStringToObject(j, "test", o->arg[0]);
    cJSON_AddStringToObject(j, "reference", o->arg[1]);
    hlc_json_size(j, "size", p->test.width, p->test.height);
    hlc_json_real(j, "peak", m->peak, 9);
    hlc_json_real(j, "psnr", m->psnr, 9);
    hlc_json_real(j, "relmse", m->relmse, 9);
    hlc_json_real(j, "max", m->max, 9);
    hlc_json_real(j, "p999", m->p999, 9);
    hlc_json_real(j, "mae", m->mae, 9);
    hlc_json_real(j, "edge_mae", m->edge_mae, 9);
    hlc_json_real(j, "rest_mae", m->rest_mae, 9);
    if (p->ids)
        hlc_json_uint(j, "edge_pixels", m->edge_pixels);
    else
        cJSON_AddNullToObject(j, "edge_pixels");
    hlc_json_real(j, "rms_codes", m->rms_codes, 9);
    hlc_json_real(j, "within_1_255", m->within_1_255, 9);
    hlc_json_real(j, "flip", m->flip, 9);
    hlc_json_real(j, "flip_p99", m->flip_p99, 9);
    hlc_json_real(j, "ssim", m->ssim, 9);
    return j;
}

/* A file that was asked for comes first: when it cannot be written, nothing
 * is printed either. */
static bool publish(const struct hlc_metrics *m, const struct pair *p,
                    const struct hlc_options *o, struct hlh_error *error)
{
    cJSON *j = to_json(m, p, o);
    bool ok = !o->json || !strcmp(o->json, "-") ||
              hlc_json_emit(j, o->json, error);
    ok = ok && hlc_json_emit(j, "-", error);
    cJSON_Delete(j);
    return ok;
}

static int judge(const struct hlc_metrics *m, const struct hlc_options *o)
{
    char psnr[64] = "", max[64] = "";
    if (o->has_min_psnr && m->psnr < o->min_psnr)
        snprintf(psnr, sizeof psnr, ": PSNR %.6g dB is below %.6g", m->psnr,
                 o->min_psnr);
    if (o->has_max_error && m->max > o->max_error)
        snprintf(max, sizeof max, ": largest difference %.6g is above %.6g",
                 m->max, o->max_error);
    if (!psnr[0] && !max[0])
        return HLC_DONE;
    return hlc_fail(HLC_FAILED, "%s%s%s", o->arg[0], psnr, max);
}

int hlc_cmd_compare(const struct hlc_options *o)
{
    struct pair p;
    struct hlc_metrics m;
    struct hlh_error error;
    memset(&p, 0, sizeof p);
    bool ok = read_pair(&p, o, &error);
    if (ok && !hlc_metrics_measure(&m, &p.test, &p.reference, p.ids))
        ok = hlh_fail(&error, o->arg[0], "out of memory");
    ok = ok && publish(&m, &p, o, &error);
    free_pair(&p);
    return ok ? judge(&m, o) : hlc_fail(HLC_BAD, "%s", error.text);
}
