/* SPDX-License-Identifier: Zlib */
#ifndef HLC_CALIBRATION_H
#define HLC_CALIBRATION_H
/* What `halflight calibrate` measured, as a small text file: "key = value"
 * lines, '#' comments, a version, the backend and kind of device it holds for
 * (docs/calibration.md). A key that is not there leaves the value that caps
 * had. */
#include "hal/caps.h"
#include "platforms/host/scene.h"

enum { HLC_CALIBRATION_BYTES = 65536 };  /* longest file that is read         */

/* caps->cost and caps->error from a file of the same backend and kind of
 * device. False with one line (file, line, what); *caps is then as before. */
bool hlc_calibration_read(struct hl_caps *caps, const char *path,
                          struct hlh_error *error);
/* The same of text; `name` is the file's, for the line. */
bool hlc_calibration_parse(struct hl_caps *caps, const char *text, size_t size,
                           const char *name, struct hlh_error *error);

/* What is written above a key: one line without a line end, NULL for nothing
 * but its unit. Key "" is the file's head and may have several lines. */
typedef const char *(*hlc_calibration_note)(void *user, const char *key);
/* "-" is stdout; a file by temporary file and rename. `note` may be NULL. A
 * reader gets the same floats. */
bool hlc_calibration_write(const struct hl_caps *caps, const char *path,
                           hlc_calibration_note note, void *user,
                           struct hlh_error *error);

/* Scenes that are drawn where none are named; NULL ends them. */
extern const char *const hlc_calibration_scenes[];
bool hlc_is_calibration_scene(const char *name);

/* Value i of a file, in the file's order; NULL past the last. The key goes to
 * `key`; `unit` (may be NULL) is a static text. */
enum { HLC_CALIBRATION_KEY = 48 };
float *hlc_calibration_value(struct hl_caps *caps, uint32_t i,
                             char key[HLC_CALIBRATION_KEY],
                             const char **unit);
#endif
