/* SPDX-License-Identifier: Zlib */
#ifndef HLC_COMMANDS_H
#define HLC_COMMANDS_H
/* The tool's commands. Each returns the exit code of the process, has said
 * why on stderr in one line when that is not 0, and has then left no output
 * file behind. */
#include "platforms/cli/options.h"

enum {                       /* exit codes                                   */
    HLC_DONE = 0,
    HLC_FAILED = 1,          /* a comparison or a test                       */
    HLC_BAD = 2,             /* usage or input                               */
    HLC_NO_DEVICE = 3        /* no such backend or device                    */
};

int hlc_cmd_render(const struct hlc_options *);
int hlc_cmd_plan(const struct hlc_options *);
int hlc_cmd_scene(const struct hlc_options *);
int hlc_cmd_compare(const struct hlc_options *);
int hlc_cmd_devices(const struct hlc_options *);
int hlc_cmd_conform(const struct hlc_options *);
int hlc_cmd_chart(const struct hlc_options *);       /* platforms/chart      */
int hlc_cmd_calibrate(const struct hlc_options *);
int hlc_cmd_stability(const struct hlc_options *);   /* platforms/stability  */

/* Print "halflight: <text>" and a line end to stderr; return `code`. Line
 * ends inside become blanks. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int hlc_fail(int code, const char *format, ...);
#endif
