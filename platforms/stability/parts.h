/* SPDX-License-Identifier: Zlib */
#ifndef HLS_PARTS_H
#define HLS_PARTS_H
/* What report.c, plot.c and check.c share. */
#include "platforms/stability/stability.h"

enum { HLS_NAME = 64, HLS_NUMBER = 24 };

/* "row.case" */
void hls_name(char out[HLS_NAME], const struct hls_result *);
/* A p of the row, "none" of NAN; `out`. */
const char *hls_number(char out[HLS_NUMBER], const struct hls_row *row,
                       double p);
/* plot.c: FOLDER/ROW.svg, the n curves of one row. */
bool hls_plot(const char *folder, const struct hls_result *, uint32_t n,
              struct hlh_error *error);
#endif
