/* SPDX-License-Identifier: Zlib */
#ifndef HLT_PLOT_PARTS_H
#define HLT_PLOT_PARTS_H
/* What the files of a chart's picture share. Pixels from the lower left. */
#include "platforms/chart/axis.h"
#include "platforms/chart/chart.h"
#include "platforms/chart/labels.h"
#include "platforms/host/util.h"

enum { HLT_WIDTH = 960, HLT_HEIGHT = 640, HLT_LEFT = 86, HLT_RIGHT = 24,
       HLT_BOTTOM = 82, HLT_TOP = 108, HLT_GROUPS = 16 };

/* A word on the front: of the points that are equal to `point`, which are next
 * to it, too. */
struct hlt_word {
    const struct hlt_point *point;
    uint32_t equal;                  /* others                               */
    char text[HLT_NAME + 16];
};

struct hlt_chart {
    const struct hlt_point *point;
    uint32_t n;
    enum hlt_column cost, error;
    struct hlt_axis x, y;
    const char *group[HLT_GROUPS];   /* the number is that of its mark       */
    bool used[HLT_GROUPS];           /* some point is of it                  */
    uint32_t n_groups;
    bool bars;                       /* low..high differ somewhere           */
    double right_limit, worst_limit; /* cost and error beyond which a point
                                      * that is not notable is not shown, but
                                      * named                                */
    bool numbered;                   /* words are numbers of a key           */
    double right;                    /* of the plot                          */
    struct hlt_word *word;           /* malloc'd                             */
    struct hlt_label *label;         /* malloc'd, one a word                 */
    uint32_t n_words;
};

#define HLT_WORD_SIZE 11.0           /* of text on the front                 */
#define HLT_MARK 5.0                 /* half a mark's side                   */

/* "inferred 5/8 RGBA16_FLOAT x4" -> "5/8 RGBA16F x4": what every second label
 * would say is said once, above the chart. */
void hlt_short_name(char out[HLT_NAME], const char *way);
/* Where a point lies, also one of no error. */
double hlt_point_x(const struct hlt_chart *, const struct hlt_point *);
double hlt_point_y(const struct hlt_chart *, const struct hlt_point *);
/* Of a front's points, those that are 1 % nearer to the reference than all
 * notable ones that are cheaper. The rest is on the front, but nobody would
 * pay for it: no word names it. */
bool hlt_is_notable(const struct hlt_chart *, const struct hlt_point *);
bool hlt_is_beyond(const struct hlt_chart *, const struct hlt_point *);
/* The last one has all that there are too many of. */
uint32_t hlt_group_of(const struct hlt_chart *, const char *name);

/* plot_script.c: for gnuplot; script->failed when memory is out. */
void hlt_plot_script(struct hlh_buffer *script, const struct hlt_chart *,
                     const char *title);

/* plot.c: all but the script: axes, groups, words and where they go. False:
 * memory is out; hlt_layout_free in any case. n > 0. */
bool hlt_layout(struct hlt_chart *, const struct hlt_point *, uint32_t n,
                enum hlt_column cost, enum hlt_column error);
void hlt_layout_free(struct hlt_chart *);
#endif
