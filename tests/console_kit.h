/* SPDX-License-Identifier: Zlib */
#ifndef CONSOLE_KIT_H
#define CONSOLE_KIT_H
/* Machines with the rules of a profile, made without a device. */
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

/* Formats as lavapipe's, all sample counts; `memory`: it keeps memory as the
 * console does, and so lacks the blends that the profile takes away. */
void con_caps(struct hl_caps *out, const struct hl_profile *profile,
              bool memory);
/* 1280 x 720, 200 smooth lights of peak 20, one exponent. */
struct hl_needs con_needs(void);
/* Made, or the test fails. */
struct hl_plan con_plan(enum hl_pipeline, const struct hl_needs *,
                        const struct hl_caps *);
/* NULL where the plan has no such reason. */
const struct hl_plan_reason *con_reason(const struct hl_plan *,
                                        enum hl_reason);
#endif
