/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/chart.h"

static const struct { const char *name; enum hlt_kind kind; } columns[] = {
#define HLT_COLUMN(id, name, kind, what) { name, HLT_##kind },
#include "platforms/chart/columns.def"
#undef HLT_COLUMN
};

const char *hlt_column_name(enum hlt_column c) { return columns[c].name; }

enum hlt_kind hlt_column_kind(enum hlt_column c) { return columns[c].kind; }
