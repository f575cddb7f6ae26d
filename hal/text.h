/* SPDX-License-Identifier: Zlib */
#ifndef HL_TEXT_H
#define HL_TEXT_H
/* Text into a fixed buffer without stdio, for hal and core. Always
 * NUL-terminated; what does not fit is cut. */
#include <stddef.h>
#include <stdint.h>

struct hl_text { char *at; size_t left; };

struct hl_text hl_text_begin(char *buffer, size_t bytes);
void hl_text_str(struct hl_text *, const char *);
void hl_text_uint(struct hl_text *, uint64_t);
#endif
