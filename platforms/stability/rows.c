/* SPDX-License-Identifier: Zlib */
#include "platforms/stability/stability.h"

#define HLS_ROW(name) extern const struct hls_row hls_row_##name;
#include "platforms/stability/rows.def"
#undef HLS_ROW

const struct hls_row *hls_row(uint32_t i)
{
    static const struct hls_row *const rows[] = {
#define HLS_ROW(name) &hls_row_##name,
#include "platforms/stability/rows.def"
#undef HLS_ROW
        NULL
    };
    return i < sizeof rows / sizeof *rows ? rows[i] : NULL;
}
