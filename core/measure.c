/* SPDX-License-Identifier: Zlib */
/* Needs of a frame, measured on the host without a device. */
#include <string.h>
#include "core/frame.h"
#include "core/light.h"
#include "core/vec.h"
#include "shaders/shared/shade.h"

/* The light's peak is bounded on a coarse grid of the screen: each cell sums
 * every light whose bounds touch it, at full strength. */
enum { CELLS_X = 16, CELLS_Y = 9 };

static void add_cells(float *cell, const struct hl_rect *b, float x)
{
    for (int32_t y = b->y; y < b->y + b->height; y++)
        for (int32_t i = b->x; i < b->x + b->width; i++)
            cell[y * CELLS_X + i] += x;
}

static void measure_lights(struct hl_needs *n, const struct hl_frame *f,
                           float aspect)
{
    float cell[CELLS_X * CELLS_Y];
    double area = 0;
    memset(cell, 0, sizeof cell);
    n->lights = 0;
    for (uint32_t i = 0; i < f->n_lights; i++) {
        const struct hl_light *l = &f->lights[i];
        struct hl_lit_sphere s;
        struct hl_rect b, fine;
        if (hl_light_check(l))
            continue;
        n->lights |= l->falloff == HL_INVERSE_SQUARE ? HL_LIGHTS_INVERSE_SQUARE
                                                     : HL_LIGHTS_SMOOTH;
        if (l->kind != HL_POINT)
            n->lights |= HL_LIGHTS_CONES;
        if (!hl_lights_view(&s, l, 1, &f->camera, aspect) ||
            !hl_sphere_rect(&b, &s, &f->camera, CELLS_X, CELLS_Y) ||
            !hl_sphere_rect(&fine, &s, &f->camera, CELLS_X * 64,
                            (uint32_t)(CELLS_X * 64 / aspect) + 1))
            continue;
        double w = CELLS_X * 64, h = (double)((uint32_t)(w / (double)aspect) +
                                              1);
        /* pi / 4: a sphere's outline in its rectangle. */
        area += 0.785 * fine.width * fine.height / (w * h);
        add_cells(cell, &b, hl_light_peak(l));
    }
    n->lights_per_pixel = (float)area;
    n->peak = 0;
    for (int i = 0; i < CELLS_X * CELLS_Y; i++)
        n->peak = cell[i] > n->peak ? cell[i] : n->peak;
}

static void measure_items(struct hl_needs *n, const struct hl_frame *f,
                          const struct hl_surface *surfaces, float aspect)
{
    uint64_t pairs = 0;
    uint32_t seen = 0;
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        struct hl_box b = hl_box_world(it->world, it->bounds_min,
                                       it->bounds_max);
        float z;
        n->n_triangles += it->count / 3;
        n->blended |= surfaces[it->surface].blended;
        if (!hl_box_visible(&b, &f->camera, aspect, &z))
            continue;
        seen++;
        for (uint32_t k = 0; k < f->n_lights; k++) {
            struct hl_lit_sphere s;
            memset(&s, 0, sizeof s);
            s.world = hl_load3(f->lights[k].position);
            s.radius = f->lights[k].kind == HL_DIRECTIONAL
                       ? -1.0f : f->lights[k].radius;
            pairs += hl_sphere_touches_box(&s, &b);
        }
    }
    n->lights_per_object = seen ? (float)((double)pairs / seen) : 0.0f;
}

static void measure_exponents(struct hl_needs *n, const struct hl_frame *f,
                              const struct hl_surface *surfaces)
{
    bool any = false, differ = false;
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        if (!it->material || it->material->no_specular ||
            surfaces[it->surface].blended)
            continue;
        float e = hl_roughness_exponent(it->material->roughness);
        differ |= (any && e != n->exponent) ||
                  (surfaces[it->surface].textures & HL_TEXTURED_METAL_ROUGH);
        n->exponent = any ? n->exponent : e;
        any = true;
    }
    n->specular = !any ? HL_NEED_NO_SPECULAR
                  : differ ? HL_NEED_EXPONENTS : HL_NEED_ONE_EXPONENT;
}

void hl_needs_measure(struct hl_needs *needs, const struct hl_frame *frame,
                      const struct hl_surface *surfaces, float aspect)
{
    needs->n_objects = frame->n_items;
    needs->n_lights = frame->n_lights;
    needs->n_triangles = 0;
    needs->blended = false;
    needs->exponent = 1.0f;
    needs->far = frame->camera.far;
    measure_lights(needs, frame, aspect);
    measure_items(needs, frame, surfaces, aspect);
    measure_exponents(needs, frame, surfaces);
}
