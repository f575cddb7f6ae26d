/* SPDX-License-Identifier: Zlib */
#ifndef HLC_PROBE_H
#define HLC_PROBE_H
/* hl_probe of a scene: four pictures of it, drawn at the options' size and
 * samples and compared. */
#include "platforms/cli/shot.h"

/* What cannot be drawn (forward with shadows, a format the profile has not)
 * stays 0, unknown. An exit code: only a lost device or memory fails it. */
int hlc_probe_measure(struct hl_probe *out, struct hlc_stage *stage,
                      const struct hlc_options *o);
/* Root mean square of the difference of 8-bit sRGB codes, unrounded ones. Same
 * sizes. */
double hlc_rms_codes(const struct hlh_picture *a, const struct hlh_picture *b);
#endif
