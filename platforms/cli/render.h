/* SPDX-License-Identifier: Zlib */
#ifndef HLC_RENDER_H
#define HLC_RENDER_H
/* What the files of the render command share. Reading order: cmd_render.c,
 * render_device.c or render_reference.c, then dump.c and render_json.c. */
#include "platforms/cli/outputs.h"
#include "platforms/cli/shot.h"

struct hlc_spread { double median, min, max; uint32_t n; };
enum { HLC_RENDER_PASSES = 16 };

/* A picture of the inside; NULL where it was not asked for. */
struct hlc_inside {
    uint32_t *ids;               /* a pixel: HL_INSPECT_IDS with the scene's
                                  * objects for items; the reference gives
                                  * 1 + object                               */
    float *lights;               /* light_width * light_height of the shading
                                  * pass: evaluations                        */
    uint32_t lights_width, lights_height;
    uint8_t *rejects;            /* a pixel: HL_INSPECT_REJECTS              */
    uint8_t *stipple;            /* an L-buffer texel: HL_INSPECT_STIPPLE    */
};

struct hlc_render {
    const struct hlc_options *o;
    /* Before planning, for a budget (probe.h); NULL: none. */
    int (*probe)(struct hl_probe *, struct hlc_stage *,
                 const struct hlc_options *);
    struct hlc_stage stage;      /* the reference: its scene alone           */
    struct hlh_picture picture;
    struct hlc_inside inside;
    uint64_t non_finite;         /* pixels with a NaN or an infinity         */
    uint64_t light_evaluations;
    double near, far;            /* metres; the reference: 0 = no limit      */
    struct hlc_spread frame_ms;
    struct hlc_spread record_ms; /* of it, until hl_frame_draw returned      */
    double first_ms;             /* the first frame: drivers compile in it   */
    uint32_t n_passes;
    struct { const char *name; double ms; } passes[HLC_RENDER_PASSES];

    /* Drawn by a device only. */
    struct hlc_shot shot;
    struct hl_camera before;     /* with --motion: far / 100 to the left     */
    uint32_t validation_errors;

    /* By the reference only. */
    uint32_t threads;
    uint64_t surfaces;
};

/* Whether statistics or pictures of the inside are to be made. */
bool hlc_render_inspects(const struct hlc_options *o);
/* Draw r->stage.scene into r->picture and r->inside. An exit code, after one
 * line. */
int hlc_render_device(struct hlc_render *r);
void hlc_render_device_free(struct hlc_render *r);
int hlc_render_reference(struct hlc_render *r);

/* Whole json output; false with a reason. */
bool hlc_render_json(const struct hlc_render *r, struct hlh_error *error);
/* Every target as images in o->dump, and index.txt about them. */
bool hlc_dump(struct hlc_render *r, struct hlc_outputs *files,
              struct hlh_error *error);

double hlc_now_ms(void);         /* of a clock that only goes forward        */
/* Sorts the values. n = 0 gives a spread of zeros. */
struct hlc_spread hlc_spread_of(double *values, uint32_t n);
/* Sorts n > 0 values: their median and quartiles, each one of them. */
struct hlc_quartiles { double median, low, high; };
struct hlc_quartiles hlc_quartiles_of(double *values, uint32_t n);
#endif
