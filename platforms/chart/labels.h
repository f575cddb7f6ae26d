/* SPDX-License-Identifier: Zlib */
#ifndef HLT_LABELS_H
#define HLT_LABELS_H
/* Where the words of a chart go, so that none covers another, a point or the
 * frame. Pixels; which way y grows does not matter. */
#include <stdbool.h>
#include <stdint.h>

struct hlt_box { double x0, y0, x1, y1; };   /* x0 <= x1, y0 <= y1           */

struct hlt_label {
    double x, y;             /* the point that it names                      */
    double width, height;    /* of its text                                  */
    /* Out. */
    bool placed;             /* false: there was no room                     */
    struct hlt_box box;      /* of its text                                  */
    double near_x, near_y;   /* the box's point nearest to the point         */
    bool leader;             /* so far off that a line to near_x, near_y
                              * must say whose it is                         */
};

struct hlt_field {
    struct hlt_box frame;    /* labels stay inside                           */
    const struct hlt_box *boxes; /* never covered: points, other words       */
    uint32_t n_boxes;
    const struct hlt_box *lines; /* covered where there is no better place   */
    uint32_t n_lines;
};

/* Place all that there is room for; how many. The same input gives the same
 * places. Boxes of placed labels lie in the frame and are 2 px apart from one
 * another, 1 px from field->boxes. */
uint32_t hlt_labels_place(struct hlt_label *labels, uint32_t n,
                          const struct hlt_field *field);

/* Upper bound of the width of a line of text in DejaVu Sans, the widest of
 * the usual sans-serif fonts; size in pixels. */
double hlt_text_width(const char *utf8, double size);

bool hlt_boxes_touch(const struct hlt_box *a, const struct hlt_box *b,
                     double apart);
#endif
