/* SPDX-License-Identifier: Zlib */
#include <stdarg.h>
#include <stdio.h>
#include "platforms/cli/commands.h"

int hlc_fail(int code, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = ' ';
    fprintf(stderr, "halflight: %s\n", text);
    return code;
}
