/* SPDX-License-Identifier: Zlib */
#ifndef HLC_PROBE_H
#define HLC_PROBE_H
/* hl_probe of a scene: six pictures of it, drawn at the options' size and
 * samples, with the options' filter and features, and one by the reference
 * renderer, which is the truth that they are compared with. */
#include "platforms/cli/metrics.h"   /* hlc_rms_codes */
#include "platforms/cli/shot.h"

/* Does the command's budget need one? */
bool hlc_probe_wanted(const struct hlc_options *o);
/* What cannot be drawn stays 0, unknown: forward with shadows, a format that
 * the profile has not, all of it on the backend `null`. Where no L-buffer of
 * the frame's size fits EDRAM, the smaller ones are against the truth, and
 * `full` is none. An exit code: only a lost device or memory fails it. */
int hlc_probe_measure(struct hl_probe *out, struct hlc_stage *stage,
                      const struct hlc_options *o);
/* The truth: rgb NULL where the reference renderer cannot draw it. */
void hlc_probe_truth(struct hlh_picture *out, const struct hlc_stage *stage,
                     const struct hlc_options *o);
#endif
