/* SPDX-License-Identifier: Zlib */
#ifndef HLC_CALIBRATION_H
#define HLC_CALIBRATION_H
/* What `halflight calibrate` measured, as a small text file: "key = value"
 * lines, '#' comments, a version, the backend and device it holds for. */
#include "hal/caps.h"
#include "platforms/host/scene.h"

/* caps->cost and caps->error from a file of the same backend and kind of
 * device. False with one line (file, line, what); *caps is then as before. */
bool hlc_calibration_read(struct hl_caps *caps, const char *path,
                          struct hlh_error *error);
bool hlc_calibration_write(const struct hl_caps *caps, const char *path,
                           struct hlh_error *error);
#endif
