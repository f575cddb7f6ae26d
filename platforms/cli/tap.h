/* SPDX-License-Identifier: Zlib */
#ifndef HLC_TAP_H
#define HLC_TAP_H
/* A conformance run as TAP (Test Anything Protocol, version 13). */
#include <stdio.h>
#include "platforms/conform/conform.h"

/* Run it, a line a check on `out`; desc->result, if any, is called too. An
 * exit code: HLC_DONE when all passed, HLC_FAILED; or another after one line
 * on stderr, where the device could not be opened. */
int hlc_tap_run(const struct hl_conform_desc *desc, FILE *out);
#endif
