/* SPDX-License-Identifier: Zlib */
#ifndef HLC_GNUPLOT_H
#define HLC_GNUPLOT_H
/* Charts by gnuplot, a program of its own. */
#include <stdbool.h>
#include "platforms/host/scene.h"

/* Run a script (text, data in it by here-documents) whose output is the SVG
 * `path`: the terminal and output are set before it. False with one line where
 * gnuplot is not there or complains; no half file is left. width, height: of
 * the picture, points. */
bool hlc_gnuplot(const char *path, unsigned width, unsigned height,
                 const char *script, struct hlh_error *error);
#endif
