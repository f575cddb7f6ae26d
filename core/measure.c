/* SPDX-License-Identifier: Zlib */
/* Needs of a frame, measured on the host without a device. */
#include <string.h>
#include "core/frame.h"
#include "core/light.h"
#include "core/shadow_map.h"
#include "core/stipple.h"
#include "core/vec.h"
#include "shaders/shared/shade.h"

static void measure_shadows(struct hl_needs *n, const struct hl_light *l)
{
    n->n_shadow_lights += l->shadow;
    n->shadow_points |= l->shadow &&
                        (l->kind == HL_POINT || (l->kind == HL_SPOT &&
                                                 l->outer >= HL_SHADOW_WIDE));
}

static void measure_lights(struct hl_needs *n, const struct hl_frame *f,
                           float aspect)
{
    struct hl_peak_grid peak;
    double area = 0;
    uint32_t w = HL_PEAK_X * 64, h = (uint32_t)((float)w / aspect) + 1;
    struct hl_span fine = hl_span_whole(w, h, &f->camera, aspect);
    hl_peak_begin(&peak, &f->camera, aspect);
    n->lights = n->n_shadow_lights = 0;
    n->shadow_points = false;
    for (uint32_t i = 0; i < f->n_lights; i++) {
        const struct hl_light *l = &f->lights[i];
        struct hl_lit_sphere s;
        struct hl_rect r;
        if (hl_light_check(l))
            continue;
        measure_shadows(n, l);
        n->lights |= l->falloff == HL_INVERSE_SQUARE ? HL_LIGHTS_INVERSE_SQUARE
                                                     : HL_LIGHTS_SMOOTH;
        if (l->kind != HL_POINT)
            n->lights |= HL_LIGHTS_CONES;
        if (!hl_lights_view(&s, l, 1, &f->camera, aspect) ||
            !hl_sphere_rect(&r, &s, &fine) || !hl_peak_add(&peak, &s, l))
            continue;
        /* pi / 4: a sphere's outline in its rectangle. */
        area += 0.785 * r.width * r.height / ((double)w * h);
    }
    n->lights_per_pixel = (float)area;
    n->peak = hl_peak_of(&peak);
}

/* ---- forward draws ------------------------------------------------------ */

enum { GRID = 256 };         /* pixels, the width areas are counted on       */

/* Of an item's box on the screen: its rectangle, and how much of that the
 * outline fills. */
struct shape { float x0, y0, x1, y1; double area; };

static bool shape_of(struct shape *out, const struct hl_item *it,
                     const struct hl_camera *c, const struct hl_span *span)
{
    struct hl_stipple_outline o;
    struct hl_stipple_object b;
    memset(&b, 0, sizeof b);
    if (!hl_stipple_project(&o, it->world, it->bounds_min, it->bounds_max, c,
                            span))
        return false;
    hl_stipple_bound(&b, &o);
    *out = (struct shape){ b.x0, b.y0, b.x1, b.y1, hl_stipple_area(&o) };
    return true;
}

/* Of the outline, the part in a light's rectangle, taken as if it were spread
 * evenly over its own. */
static double shared_area(const struct shape *s, const struct hl_rect *r)
{
    float x0 = (float)r->x, x1 = (float)(r->x + r->width);
    float y0 = (float)r->y, y1 = (float)(r->y + r->height);
    x0 = s->x0 > x0 ? s->x0 : x0;
    y0 = s->y0 > y0 ? s->y0 : y0;
    x1 = s->x1 < x1 ? s->x1 : x1;
    y1 = s->y1 < y1 ? s->y1 : y1;
    double all = (double)(s->x1 - s->x0) * (double)(s->y1 - s->y0);
    return x1 > x0 && y1 > y0 && all > 0
           ? s->area * (double)(x1 - x0) * (double)(y1 - y0) / all : 0;
}

struct further {
    double draws, triangles, fragments, area; /* beyond an object's first    */
    double pairs, pair_triangles, pair_area;  /* one a light and object      */
    double lights;               /* of all objects, blended ones too         */
};

/* Lights that forward shading of an item takes. */
static uint32_t lights_on(struct further *w, const struct hl_frame *f,
                          const struct hl_box *b, const struct shape *shape,
                          const struct hl_span *span, float aspect)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < f->n_lights; k++) {
        const struct hl_light *l = &f->lights[k];
        struct hl_lit_sphere s;
        struct hl_rect r;
        memset(&s, 0, sizeof s);
        s.world = hl_load3(l->position);
        s.radius = l->kind == HL_DIRECTIONAL ? -1.0f : l->radius;
        if (!hl_sphere_touches_box(&s, b) ||
            hl_lights_view(&s, l, 1, &f->camera, aspect) != 1)
            continue;
        n++;
        if (hl_sphere_rect(&r, &s, span))
            w->pair_area += shared_area(shape, &r);
    }
    return n;
}

static void add_further(struct further *w, const struct hl_item *it,
                        uint32_t lights, double area)
{
    double draws = lights > 8 ? (lights + 7) / 8 - 1 : 0;
    w->draws += draws;
    w->triangles += draws * (it->count / 3);
    w->fragments += draws * area;
    w->area += area;
    w->pairs += lights;
    w->pair_triangles += (double)lights * (it->count / 3);
}

static void measure_items(struct hl_needs *n, const struct hl_frame *f,
                          const struct hl_surface *surfaces, float aspect)
{
    struct further w = { 0, 0, 0, 0, 0, 0, 0, 0 };
    const struct hl_span span =
        hl_span_whole(GRID, (uint32_t)(GRID / aspect) + 1, &f->camera,
                      aspect);
    double screen = (double)span.w * (double)span.h;
    uint32_t seen = 0;
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        struct hl_box b = hl_box_world(it->world, it->bounds_min,
                                       it->bounds_max);
        float z;
        n->n_triangles += it->count / 3;
        n->blended |= surfaces[it->surface].blended;
        n->decals |= surfaces[it->surface].decal;
        n->brdfs |= it->material && it->material->brdf != HL_BRDF_BLINN_PHONG;
        if (!hl_box_visible(&b, &f->camera, aspect, &z))
            continue;
        seen++;
        struct shape shape = { 0, 0, 0, 0, 0 };
        /* What blends has all its lights in one draw: no further area. */
        bool once = surfaces[it->surface].blended ||
                    surfaces[it->surface].decal;
        if (!once)
            shape_of(&shape, it, &f->camera, &span);
        uint32_t lights = lights_on(&w, f, &b, &shape, &span, aspect);
        w.lights += lights;
        if (!once)
            add_further(&w, it, lights, shape.area);
    }
    n->further_draws = (float)w.draws;
    n->further_triangles = (float)w.triangles;
    n->further_cover = (float)(w.area > 0 ? w.fragments / w.area : 0);
    n->pair_triangles = (float)w.pair_triangles;
    n->pair_cover = (float)(w.pair_area / screen);
    n->pair_draws = (float)w.pairs;
    n->lights_per_object = seen ? (float)(w.lights / seen) : 0.0f;
}

/* Items over one point, by the outlines of their boxes as patterns are
 * assigned: on a grid of points, so that an object between four
 * of them counts at its centre alone. */
enum { LAYERS_X = 128, LAYERS_Y = 72 };

static void cover(uint8_t *cell, int32_t x0, int32_t x1, int32_t y)
{
    for (uint8_t *c = cell + y * LAYERS_X + x0; x0 < x1; x0++, c++)
        if (*c < 255)
            (*c)++;
}

/* Cell of a coordinate, within 0..most; NaN, of a transform that the frame
 * will be refused for, is 0. */
static int32_t cell_at(float x, int32_t most)
{
    return !(x > 0) ? 0 : x >= (float)most ? most : (int32_t)x;
}

/* Points of row y that lie in the outline: x0 <= x < x1. */
static void layer_span(const struct hl_stipple_outline *o, float y,
                       int32_t *x0, int32_t *x1)
{
    float low = LAYERS_X, high = 0;
    for (uint32_t i = 0, j = o->n_corners - 1; i < o->n_corners; j = i++) {
        float a = o->y[j], b = o->y[i];
        if ((a <= y) == (b <= y))
            continue;
        float x = o->x[j] + (o->x[i] - o->x[j]) * ((y - a) / (b - a));
        low = hl_min(low, x);
        high = hl_max(high, x);
    }
    *x0 = cell_at(low + 0.5f, LAYERS_X);
    *x1 = cell_at(high + 0.5f, LAYERS_X);
}

static void add_layer(uint8_t *cell, const struct hl_stipple_outline *o)
{
    float x = 0, y = 0;
    bool any = false;
    for (int32_t r = 0; r < LAYERS_Y; r++) {
        int32_t x0, x1;
        layer_span(o, (float)r + 0.5f, &x0, &x1);
        cover(cell, x0, x1, r);
        any |= x0 < x1;
    }
    for (uint32_t i = 0; i < o->n_corners; i++) {
        x += o->x[i] / (float)o->n_corners;
        y += o->y[i] / (float)o->n_corners;
    }
    int32_t at = cell_at(x, LAYERS_X - 1);
    if (!any)
        cover(cell, at, at + 1, cell_at(y, LAYERS_Y - 1));
}

/* Layers of what is blended, or of what is not. */
static void add_layers(uint8_t cell[LAYERS_X * LAYERS_Y],
                       const struct hl_frame *f,
                       const struct hl_surface *surfaces, bool blended,
                       float aspect)
{
    struct hl_span span = hl_span_whole(LAYERS_X, LAYERS_Y, &f->camera,
                                        aspect);
    struct hl_stipple_outline o;
    memset(cell, 0, LAYERS_X * LAYERS_Y);
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        if (surfaces[it->surface].blended == blended &&
            hl_stipple_project(&o, it->world, it->bounds_min, it->bounds_max,
                               &f->camera, &span))
            add_layer(cell, &o);
    }
}

static void measure_layers(struct hl_needs *n, const struct hl_frame *f,
                           const struct hl_surface *surfaces, float aspect)
{
    uint8_t cell[LAYERS_X * LAYERS_Y];
    uint32_t covered = 0;
    n->blended_layers = 0;
    if (n->blended)
        add_layers(cell, f, surfaces, true, aspect);
    for (int i = 0; i < LAYERS_X * LAYERS_Y && n->blended; i++)
        n->blended_layers = cell[i] > n->blended_layers ? cell[i]
                                                        : n->blended_layers;
    add_layers(cell, f, surfaces, false, aspect);
    for (int i = 0; i < LAYERS_X * LAYERS_Y; i++)
        covered += cell[i] > 0;
    n->cover = (float)(covered ? covered : 1) / (LAYERS_X * LAYERS_Y);
}

/* Exponents of what is drawn forward are no channel's, but its highlights are
 * wanted. */
static void measure_exponents(struct hl_needs *n, const struct hl_frame *f,
                              const struct hl_surface *surfaces)
{
    bool any = false, differ = false, forward = false;
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        if (!it->material || it->material->no_specular)
            continue;
        if (surfaces[it->surface].blended &&
            n->translucency == HL_TRANSLUCENCY_FORWARD) {
            forward = true;
            continue;
        }
        float e = hl_roughness_exponent(it->material->roughness);
        differ |= (any && e != n->exponent) ||
                  (surfaces[it->surface].textures & HL_TEXTURED_METAL_ROUGH);
        n->exponent = any ? n->exponent : e;
        any = true;
    }
    n->specular = !any ? forward ? HL_NEED_ONE_EXPONENT : HL_NEED_NO_SPECULAR
                  : differ ? HL_NEED_EXPONENTS : HL_NEED_ONE_EXPONENT;
}

void hl_needs_measure(struct hl_needs *needs, const struct hl_frame *frame,
                      const struct hl_surface *surfaces, float aspect)
{
    needs->n_objects = frame->n_items;
    needs->n_lights = frame->n_lights;
    needs->n_triangles = 0;
    needs->blended = needs->decals = needs->brdfs = false;
    needs->exponent = 1.0f;
    needs->far = frame->camera.far;
    measure_lights(needs, frame, aspect);
    measure_items(needs, frame, surfaces, aspect);
    measure_layers(needs, frame, surfaces, aspect);
    measure_exponents(needs, frame, surfaces);
}
