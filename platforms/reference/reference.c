/* SPDX-License-Identifier: Zlib */
/* The picture: samples, layers, threads over tiles. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/reference/internal.h"

enum { TILE = 16, MAX_GRID = 64, MAX_SIZE = 65536, MAX_THREADS = 256 };

/* One picture in the making. `lock` guards what follows it. */
struct job {
    const struct hlr_prepared *p;
    const struct hlr_options *o;
    struct hlr_camera camera;
    float *rgb;
    uint32_t *ids;
    double (*at)[2];             /* samples within the pixel, 0..1           */
    uint32_t n_at, tiles_x, n_tiles;
    pthread_mutex_t lock;
    uint32_t next_tile, done_tiles, threads;
    bool failed;
    struct hlr_stats stats;
};

static bool scratch_make(struct hlr_scratch *out, const struct hlr_prepared *p)
{
    memset(out, 0, sizeof *out);
    out->reached = calloc(p->lights.n / 64 + 1, sizeof *out->reached);
    return out->reached != NULL;
}

static void scratch_free(struct hlr_scratch *scratch)
{
    free(scratch->reached);
    free(scratch->layers);
    memset(scratch, 0, sizeof *scratch);
}

/* out = e + rho (A + D) + ks S */
static void shade(double out[3], struct hlr_surface *s,
                  struct hlr_light_sum *sum, const struct job *job,
                  const struct hlr_ray *ray, const struct hlr_hit *hit,
                  struct hlr_scratch *scratch)
{
    const struct hlr_prepared *p = job->p;
    hlr_surface(s, p, ray, hit, job->o);
    hlr_light_sum(sum, p, s, unit3(sub3(ray->o, s->position)), job->o,
                  scratch);
    for (int k = 0; k < 3; k++)
        out[k] = s->emission[k] +
                 s->rho[k] * ((double)p->scene->ambient[k] + sum->d[k]) +
                 s->ks[k] * sum->s[k];
    scratch->surfaces++;
    scratch->light_evaluations += sum->n;
}

static void fill_probe(struct hlr_probe *out, const struct hlr_hit *hit,
                       const struct hlr_surface *s,
                       const struct hlr_light_sum *sum)
{
    *out = (struct hlr_probe){ .id = hit->tri->object + 1,
        .triangle = hit->tri->prim, .lights = sum->n,
        .back_face = hit->back, .depth = hit->t,
        .position = { s->position.x, s->position.y, s->position.z },
        .normal = { s->normal.x, s->normal.y, s->normal.z },
        .uv = { s->uv.u, s->uv.v }, .lambda = s->lambda,
        .alpha = s->alpha, .exponent = s->exponent };
    for (int k = 0; k < 3; k++) {
        out->rho[k] = s->rho[k];
        out->ks[k] = s->ks[k];
        out->emission[k] = s->emission[k];
        out->diffuse[k] = sum->d[k];
        out->specular[k] = sum->s[k];
    }
}

/* One sample: the opaque surface or the background, then the layers over it
 * from the farthest to the nearest. `probe` may be NULL. Returns the id. */
static uint32_t sample(double out[3], struct hlr_probe *probe,
                       const struct job *job, double x, double y,
                       struct hlr_scratch *scratch)
{
    struct hlr_ray ray;
    struct hlr_hit hit;
    struct hlr_surface s;
    struct hlr_light_sum sum;
    double c[3];
    hlr_camera_ray(&ray, &job->camera, x, y);
    hlr_trace(&hit, job->p, &ray, job->o->brute_force, scratch);
    uint32_t id = hit.tri ? hit.tri->object + 1 : 0;
    for (int k = 0; k < 3; k++)
        out[k] = (double)job->p->scene->background[k];
    if (hit.tri) {
        shade(out, &s, &sum, job, &ray, &hit, scratch);
        if (probe)
            fill_probe(probe, &hit, &s, &sum);
    }
    for (uint32_t i = scratch->n_layers; i-- > 0;) {
        const struct hlr_hit *layer = &scratch->layers[i];
        shade(c, &s, &sum, job, &ray, layer, scratch);
        for (int k = 0; k < 3; k++)
            out[k] = s.alpha * c[k] + (1 - s.alpha) * out[k];
        if (probe)
            fill_probe(probe, layer, &s, &sum);
        if (job->o->ids_of_blended && s.alpha > 0)
            id = layer->tri->object + 1;
    }
    if (probe)
        probe->layers = scratch->n_layers;
    return id;
}

static uint32_t id_at(const struct job *job, double x, double y,
                      struct hlr_scratch *scratch)
{
    struct hlr_ray ray;
    struct hlr_hit hit;
    hlr_camera_ray(&ray, &job->camera, x, y);
    hlr_trace(&hit, job->p, &ray, job->o->brute_force, scratch);
    for (uint32_t i = 0; job->o->ids_of_blended && i < scratch->n_layers; i++)
        if (hlr_alpha(job->p, &ray, &scratch->layers[i]) > 0)
            return scratch->layers[i].tri->object + 1;
    return hit.tri ? hit.tri->object + 1 : 0;
}

static void pixel(const struct job *job, uint32_t x, uint32_t y,
                  struct hlr_scratch *scratch)
{
    double sum[3] = { 0 }, c[3];
    size_t at = (size_t)y * job->o->width + x;
    uint32_t id = 0;
    bool centred = false;
    for (uint32_t i = 0; i < job->n_at; i++) {
        const double *s = job->at[i];
        uint32_t here = sample(c, NULL, job, x + s[0], y + s[1], scratch);
        for (int k = 0; k < 3; k++)
            sum[k] += c[k];
        if (s[0] == 0.5 && s[1] == 0.5) {
            id = here;
            centred = true;
        }
    }
    scratch->samples += job->n_at;
    for (int k = 0; k < 3; k++)
        job->rgb[3 * at + (size_t)k] = (float)(sum[k] / job->n_at);
    if (job->ids)
        job->ids[at] = centred ? id : id_at(job, x + 0.5, y + 0.5, scratch);
}

static void tile(const struct job *job, uint32_t t,
                 struct hlr_scratch *scratch)
{
    uint32_t x0 = t % job->tiles_x * TILE, y0 = t / job->tiles_x * TILE;
    for (uint32_t y = y0; y < y0 + TILE && y < job->o->height; y++)
        for (uint32_t x = x0; x < x0 + TILE && x < job->o->width; x++)
            pixel(job, x, y, scratch);
}

/* Take the next tile and tell of the one done; false at the end. */
static bool next_tile(struct job *job, uint32_t *t, bool first)
{
    pthread_mutex_lock(&job->lock);
    job->done_tiles += !first;
    if (!first && job->o->progress)
        job->o->progress((double)job->done_tiles / job->n_tiles,
                         job->o->user);
    *t = job->next_tile;
    bool more = *t < job->n_tiles && !job->failed;
    job->next_tile += more;
    pthread_mutex_unlock(&job->lock);
    return more;
}

static void *work(void *user)
{
    struct job *job = user;
    struct hlr_scratch scratch;
    uint32_t t;
    bool ok = scratch_make(&scratch, job->p);
    for (bool first = true; ok && next_tile(job, &t, first); first = false) {
        tile(job, t, &scratch);
        ok = !scratch.failed;
    }
    pthread_mutex_lock(&job->lock);
    job->failed = job->failed || !ok;
    job->threads++;
    job->stats.samples += scratch.samples;
    job->stats.surfaces += scratch.surfaces;
    job->stats.light_evaluations += scratch.light_evaluations;
    pthread_mutex_unlock(&job->lock);
    scratch_free(&scratch);
    return NULL;
}

static uint32_t thread_count(const struct job *job)
{
    uint32_t n = job->o->threads;
    if (n == 0) {
        long online = sysconf(_SC_NPROCESSORS_ONLN);
        n = online > 0 ? (uint32_t)online : 1;
    }
    n = n < MAX_THREADS ? n : MAX_THREADS;
    return n < job->n_tiles ? n : job->n_tiles;
}

/* The calling thread works too: a thread that cannot be started is done
 * without. */
static void run(struct job *job)
{
    pthread_t threads[MAX_THREADS];
    uint32_t n = 0, want = thread_count(job) - 1;
    while (n < want && pthread_create(&threads[n], NULL, work, job) == 0)
        n++;
    work(job);
    for (uint32_t i = 0; i < n; i++)
        pthread_join(threads[i], NULL);
}

/* Vulkan 1.3, "Standard sample locations", in sixteenths; 1, 2, 4, 8 follow
 * one another. */
static const unsigned char standard[15][2] = {
    { 8, 8 },
    { 12, 12 }, { 4, 4 },
    { 6, 2 }, { 14, 6 }, { 2, 10 }, { 10, 14 },
    { 9, 5 }, { 7, 11 }, { 13, 9 }, { 5, 3 },
    { 3, 13 }, { 1, 7 }, { 11, 15 }, { 15, 1 },
};

static bool make_samples(struct job *job)
{
    uint32_t grid = job->o->grid;
    uint32_t n = job->o->samples ? job->o->samples : 1;
    if (grid > MAX_GRID || n > 8 || (n & (n - 1)))
        return false;
    job->n_at = grid ? grid * grid : n;
    job->at = calloc(job->n_at, sizeof *job->at);
    for (uint32_t i = 0; job->at && i < job->n_at; i++) {
        double *at = job->at[i];
        at[0] = grid ? (i % grid + 0.5) / grid : standard[n - 1 + i][0] / 16.0;
        at[1] = grid ? (i / grid + 0.5) / grid : standard[n - 1 + i][1] / 16.0;
    }
    return job->at != NULL;
}

static bool make_job(struct job *job, const struct hlr_prepared *prepared,
                     const struct hlr_options *o)
{
    memset(job, 0, sizeof *job);
    job->p = prepared;
    job->o = o;
    if (o->width < 1 || o->width > MAX_SIZE || o->height < 1 ||
        o->height > MAX_SIZE || !(o->near >= 0) || !(o->far >= 0))
        return false;
    job->tiles_x = (o->width + TILE - 1) / TILE;
    job->n_tiles = job->tiles_x * ((o->height + TILE - 1) / TILE);
    return hlr_camera_make(&job->camera, &prepared->scene->camera, o);
}

bool hlr_draw(float *rgb_out, uint32_t *ids_out,
              const struct hlr_prepared *prepared,
              const struct hlr_options *options, struct hlr_stats *stats)
{
    struct job job;
    double start = hlr_now();
    if (!make_job(&job, prepared, options) || !make_samples(&job))
        return false;
    job.rgb = rgb_out;
    job.ids = ids_out;
    bool ok = pthread_mutex_init(&job.lock, NULL) == 0;
    if (ok) {
        run(&job);
        pthread_mutex_destroy(&job.lock);
    }
    free(job.at);
    job.stats.prepare_seconds = prepared->seconds;
    job.stats.draw_seconds = hlr_now() - start;
    job.stats.threads = job.threads;
    job.stats.triangles = prepared->n_tris;
    if (stats)
        *stats = job.stats;
    return ok && !job.failed;
}

bool hlr_probe(struct hlr_probe *out, const struct hlr_prepared *prepared,
               const struct hlr_options *options, double x, double y)
{
    struct job job;
    struct hlr_scratch scratch;
    double color[3];
    memset(out, 0, sizeof *out);
    if (!make_job(&job, prepared, options) ||
        !scratch_make(&scratch, prepared))
        return false;
    sample(color, out, &job, x, y, &scratch);
    memcpy(out->color, color, sizeof color);
    bool ok = !scratch.failed;
    scratch_free(&scratch);
    return ok;
}

bool hlr_render(float *rgb_out, uint32_t *ids_out,
                const struct hlh_scene *scene,
                const struct hlr_options *options, struct hlr_stats *stats)
{
    struct hlr_prepared *prepared = hlr_prepare(scene, NULL);
    bool ok = prepared && hlr_draw(rgb_out, ids_out, prepared, options, stats);
    hlr_prepared_free(prepared);
    return ok;
}
