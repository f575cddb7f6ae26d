/* SPDX-License-Identifier: Zlib */
#ifndef HLK_CALIBRATE_H
#define HLK_CALIBRATE_H
/* `halflight calibrate`: what the planner predicts by, measured. Reading
 * order: plane.c (two scenes made for measuring), rounds.c (frames timed in
 * turn), units.c and readback.c (each unit cost by differences of them),
 * frames.c (how well whole frames of scenes come out by them), errors.c (what
 * size and format of the L-buffer cost in accuracy), report.c, cmd_calibrate.c.
 */
#include "platforms/cli/calibration.h"
#include "platforms/cli/shot.h"

/* ---- plane.c ------------------------------------------------------------ */

/* A wall that fills the view of a picture of this aspect, and 64 lights before
 * it whose rectangles cover all of that. */
bool hlk_plane(struct hlh_scene *out, double aspect, struct hlh_error *error);
/* 400 boxes of a pixel or two, 12 cuts^2 triangles each, no lights. */
enum { HLK_DUST = 400 };
bool hlk_dust(struct hlh_scene *out, uint32_t cuts, struct hlh_error *error);

/* ---- rounds.c ----------------------------------------------------------- */

enum { HLK_ROUNDS = 31 };        /* at most                                  */

struct hlk_frame {
    struct hlc_shot shot;        /* not open: renderer NULL, times NAN       */
    double ms[HLK_ROUNDS];
};
/* All open frames in turn, a round of them `rounds` times after one that is
 * not counted; `busy`: this process's processor time in place of the clock's.
 * False: the device failed. */
bool hlk_time(struct hlk_frame *frame, uint32_t n, uint32_t rounds, bool busy);

/* Median and quartiles; n of them were finite. */
struct hlk_value { double median, low, high; uint32_t n; };
struct hlk_value hlk_value_of(const double *v, uint32_t n);
/* Above 0 by more than twice the median's own deviation. */
bool hlk_is_sure(const struct hlk_value *);

/* ---- what is found ------------------------------------------------------ */

enum { HLK_NOTES = 96 };
struct hlk_notes {
    uint32_t n;
    struct { char key[HLC_CALIBRATION_KEY], text[112]; } note[HLK_NOTES];
    char head[4096];             /* lines of the file's head                 */
};
/* In place of one that is there. */
void hlk_note(struct hlk_notes *, const char *key, const char *format, ...);
const char *hlk_note_of(void *notes, const char *key);

/* Values of a key, one a round: what is sure goes into caps, or may_be_0 and
 * not below it; a note in any case. */
void hlk_take(struct hl_caps *caps, struct hlk_notes *notes, const char *key,
              const double *v, uint32_t n, bool may_be_0);

/* ---- units.c, readback.c ------------------------------------------------ */

/* Into caps->cost, what cannot be told left as it is. An exit code, after one
 * line. `o`: backend, size. */
int hlk_units(struct hl_caps *caps, struct hlk_notes *notes,
              const struct hlc_options *o);
/* sync_ns and readback_ns, on an open device. */
void hlk_readback(struct hl_caps *caps, struct hlk_notes *notes,
                  struct hl_device *device);

/* ---- frames.c ----------------------------------------------------------- */

enum { HLK_FORWARD, HLK_INFERRED, HLK_WAYS };
enum { HLK_BUILT_IN, HLK_MEASURED, HLK_COSTS };
/* A scene drawn forward, and inferred with 5/8 a side as the measured costs
 * lead to. */
struct hlk_frames {
    char scene[64];
    struct hlk_value ms[HLK_WAYS];
    /* Of what the frame really had, counted on packemu, and of what the
     * planner took it to have: ms at built-in and at measured unit costs. */
    double counted[HLK_WAYS][HLK_COSTS], planned[HLK_WAYS][HLK_COSTS];
    struct hlk_value ratio;      /* inferred over forward                    */
};
/* Of o->arg[0]. An exit code, after one line. A way that cannot be drawn or
 * counted has NANs. */
int hlk_frames_measure(struct hlk_frames *out, const struct hlc_options *o,
                       const struct hl_caps *units);

/* ---- errors.c ----------------------------------------------------------- */

enum { HLK_SCENES = 16, HLK_POINTS = 24 };
/* A picture of one size and format of L-buffer, against the truth. */
struct hlk_point {
    uint32_t eighths;
    enum hl_format format;
    double codes;                /* RMS, 8-bit sRGB                          */
    double predicted;            /* by the scene's probe, margin 1           */
    bool choice;                 /* a planner may take it unasked            */
};
struct hlk_error {
    char scene[64];
    struct hl_probe probe;
    float share[9];              /* as hl_error_model.eighths; 0: not known  */
    uint32_t n;
    struct hlk_point point[HLK_POINTS];
};
/* Draw and compare o->arg[0]. An exit code, after one line. */
int hlk_error_measure(struct hlk_error *out, const struct hlc_options *o);
/* The largest of all shares, full, half and eight, and the margin that no
 * point is above which a planner may choose. An exit code: the scenes of the
 * options are planned once more. */
int hlk_errors(struct hl_caps *caps, struct hlk_notes *notes,
               struct hlk_error *errors, uint32_t n,
               const struct hlc_options *o);
#endif
