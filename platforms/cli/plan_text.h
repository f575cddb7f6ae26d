/* SPDX-License-Identifier: Zlib */
#ifndef HLC_PLAN_TEXT_H
#define HLC_PLAN_TEXT_H
/* A plan in words and as JSON. Needs no device. */
#include <stddef.h>
#include <stdio.h>
#include "core/plan.h"

struct cJSON;                /* cjson/cJSON.h, which not all programs have   */

/* Names as the options and the JSON spell them; never NULL. */
const char *hlc_pipeline_name(enum hl_pipeline);       /* "inferred"         */
const char *hlc_role_name(enum hl_role);               /* "light"            */
const char *hlc_pass_name(enum hl_pass_role);          /* "geometry"         */
const char *hlc_light_path_name(enum hl_light_path);   /* "tiles"            */
const char *hlc_reason_name(enum hl_reason);           /* "dsf_slope"        */
const char *hlc_dsf_name(uint32_t dsf);                /* HL_DSF_*: "slope"  */
const char *hlc_specular_name(uint32_t specular);      /* HL_SPECULAR_*      */
const char *hlc_falloff_name(uint32_t falloff);        /* HL_SPEC_FALLOFF    */
const char *hlc_blend_name(enum hl_blend);
const char *hlc_compare_name(enum hl_compare);
const char *hlc_repeat_name(enum hl_repeat);
const char *hlc_two16_name(uint32_t two16);            /* HL_TWO16_*         */
const char *hlc_depth_read_name(uint32_t depth_read);  /* HL_DEPTH_READ_*    */
const char *hlc_half_pixel_name(enum hl_half_pixel);
const char *hlc_decals_name(enum hl_decals);
const char *hlc_translucency_name(enum hl_translucency);
const char *hlc_stipple_name(enum hl_stipple_mode);
const char *hlc_shadows_name(enum hl_shadows);         /* "maps"             */
const char *hlc_number_name(uint32_t number);          /* enum hl_number     */
const char *hlc_endian_name(uint32_t endian);          /* enum hl_endian     */
bool hlc_is_native(const struct hl_plan *);
/* Unit of hl_plan_target.error; "" where a role has no error. */
const char *hlc_error_unit(enum hl_role);

/* Reason i of the plan: one sentence with its numbers, cut to `bytes`. */
void hlc_reason_text(const struct hl_plan *plan, uint32_t i, char *out,
                     size_t bytes);
/* The section of the paper that says so, "" where it is not the paper's:
 * "K 2.1" is Kircher and Lawrance 2009, section 2.1. */
const char *hlc_reason_section(enum hl_reason);
/* What could not be met, as a sentence; "" for HL_REFUSED_NOTHING. */
const char *hlc_refusal_text(enum hl_refusal);
/* The same with the numbers that a refused plan's reasons hold: one line. */
void hlc_refusal_line(const struct hl_plan *refused, enum hl_refusal,
                      char *out, size_t bytes);

/* Targets, passes, totals and every reason, for a person and for tests:
 * equal plans give equal text. */
void hl_plan_text(FILE *out, const struct hl_plan *plan);
/* The "plan" object of docs/json.md; NULL when memory is out. */
struct cJSON *hlc_plan_json(const struct hl_plan *plan);
#endif
