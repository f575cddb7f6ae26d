/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/report.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is in a table ------------------------------------------------- */

static bool same_spot(const struct hlt_row *a, const struct hlt_row *b)
{
    return !strcmp(a->scene, b->scene) && !strcmp(a->machine, b->machine);
}

bool hlt_spot_at(const char **scene, const char **machine,
                 const struct hlt_table *t, uint32_t i)
{
    for (uint32_t k = 0; k < t->n; k++) {
        if (k > 0 && same_spot(&t->rows[k], &t->rows[k - 1]))
            continue;
        if (i-- == 0) {
            *scene = t->rows[k].scene;
            *machine = t->rows[k].machine;
            return true;
        }
    }
    return false;
}

/* Of row k's machine: is it the second scene that has it? */
static bool is_second(const struct hlt_table *t, uint32_t k)
{
    uint32_t before = 0;
    if (k > 0 && same_spot(&t->rows[k], &t->rows[k - 1]))
        return false;
    for (uint32_t i = 0; i < k; i++)
        before += !strcmp(t->rows[i].machine, t->rows[k].machine) &&
                  (i == 0 || !same_spot(&t->rows[i], &t->rows[i - 1]));
    return before == 1;
}

bool hlt_mean_at(const char **machine, const struct hlt_table *t, uint32_t i)
{
    for (uint32_t k = 0; k < t->n; k++)
        if (is_second(t, k) && i-- == 0) {
            *machine = t->rows[k].machine;
            return true;
        }
    return false;
}

bool hlt_front_of(struct hlt_front *f, const struct hlt_table *t,
                  const char *scene, const char *machine,
                  enum hlt_column cost, enum hlt_column error)
{
    memset(f, 0, sizeof *f);
    f->scene = scene;
    f->machine = machine;
    f->cost = cost;
    f->error = error;
    f->point = hlt_points(&f->n, t, scene, machine, cost, error);
    if (!f->point)
        return false;
    for (uint32_t i = 0; i < f->n; i++) {
        f->corner_cost = fmax(f->corner_cost, f->point[i].cost);
        f->corner_error = fmax(f->corner_error, f->point[i].error);
    }
    f->area = hlt_hypervolume(f->point, f->n, f->corner_cost,
                              f->corner_error);
    return true;
}

/* ---- for people --------------------------------------------------------- */

static void print_time(const struct hlt_row *r)
{
    char text[48] = "-";
    if (isfinite(r->value[HLT_RATIO]))
        snprintf(text, sizeof text, "%.2f (%.2f..%.2f)", r->value[HLT_RATIO],
                 r->value[HLT_RATIO_LOW], r->value[HLT_RATIO_HIGH]);
    printf("%-19s", text);
}

static void print_front(const struct hlt_front *f)
{
    uint32_t front = 0;
    for (uint32_t i = 0; i < f->n; i++)
        front += f->point[i].front;
    printf("\n%s on %s: area %.3f; %u of %u ways are not beaten\n"
           "  cost ns  time ratio           PSNR    FLIP  flicker\n",
           f->scene, f->machine, f->area, (unsigned)front, (unsigned)f->n);
    for (uint32_t i = 0; i < f->n; i++) {
        const struct hlt_row *r = f->point[i].row;
        if (!f->point[i].front)
            continue;
        printf("%9.2f  ", r->value[HLT_COST]);
        print_time(r);
        printf("%7.2f %7.4f", r->value[HLT_PSNR], r->value[HLT_FLIP]);
        if (isfinite(r->value[HLT_FLICKER]))
            printf(" %8.2g", r->value[HLT_FLICKER]);
        else
            printf(" %8s", "-");
        printf("  %s\n", r->way);
    }
}

static void print_means(const struct hlt_table *t)
{
    const char *machine;
    for (uint32_t i = 0; hlt_mean_at(&machine, t, i); i++) {
        struct hlt_front f;
        if (hlt_front_of(&f, t, NULL, machine, HLT_COST, HLT_PSNR))
            printf("%smean of all scenes on %s: area %.3f\n", i ? "" : "\n",
                   machine, f.area);
        free(f.point);
    }
}

void hlt_report_print(const struct hlt_table *t, const char *path)
{
    const char *scene, *machine;
    printf("%s: %u rows of %u x %u", path, (unsigned)t->n, (unsigned)t->width,
           (unsigned)t->height);
    if (t->refused)
        printf("; %u ways are refused, see refused.txt", (unsigned)t->refused);
    printf("\nArea: what the front of PSNR over counted cost takes below its "
           "worst cost and\nerror, octaves times octaves; the more the better. "
           "Time: of the frame over the\nbaseline's (quartiles).\n");
    for (uint32_t i = 0; hlt_spot_at(&scene, &machine, t, i); i++) {
        struct hlt_front f;
        if (hlt_front_of(&f, t, scene, machine, HLT_COST, HLT_PSNR))
            print_front(&f);
        free(f.point);
    }
    print_means(t);
}

/* ---- pictures ----------------------------------------------------------- */

/* 1: made; 0: nothing to be shown; -1: not made, after a line. */
static int plot(const struct hlt_table *t, const char *folder,
                const char *scene, const char *machine, enum hlt_column cost,
                enum hlt_column error)
{
    char path[4096], title[256];
    struct hlt_front f;
    struct hlh_error why = { "out of memory" };
    const char *tail = cost == HLT_RATIO ? "-time"
                       : error == HLT_FLIP ? "-flip"
                       : error == HLT_FLICKER ? "-flicker" : "";
    size_t used = (size_t)snprintf(path, sizeof path, "%s/", folder);
    snprintf(path + used, sizeof path - used, "%s-%s%s.svg",
             scene ? scene : "mean", machine, tail);
    for (char *c = path + used; *c; c++)
        *c = *c == ':' ? '-' : *c;
    snprintf(title, sizeof title, "%s on %s, %u x %u",
             scene ? scene : "Geometric mean of all scenes", machine,
             (unsigned)t->width, (unsigned)t->height);
    bool ok = hlt_front_of(&f, t, scene, machine, cost, error);
    bool empty = ok && f.n == 0;
    ok = ok && (empty || hlt_plot(path, title, f.point, f.n, cost, error,
                                  &why));
    free(f.point);
    if (!ok)
        fprintf(stderr, "halflight: %s\n", why.text);
    return !ok ? -1 : empty ? 0 : 1;
}

uint32_t hlt_report_plot(const struct hlt_table *t, const char *folder)
{
    static const struct { enum hlt_column cost, error; } all[] = {
        { HLT_COST, HLT_PSNR }, { HLT_RATIO, HLT_PSNR },
        { HLT_COST, HLT_FLIP }, { HLT_COST, HLT_FLICKER }
    };
    const char *scene, *machine;
    uint32_t n = 0;
    int made = 0;
    for (uint32_t i = 0; made >= 0 && hlt_spot_at(&scene, &machine, t, i);
         i++)
        for (int k = 0; k < 2 && made >= 0; k++) {
            made = plot(t, folder, scene, machine, all[k].cost, all[k].error);
            n += made > 0;
        }
    for (uint32_t i = 0; made >= 0 && hlt_mean_at(&machine, t, i); i++)
        for (int k = 0; k < 4 && made >= 0; k++) {
            made = plot(t, folder, NULL, machine, all[k].cost, all[k].error);
            n += made > 0;
        }
    return n;
}
