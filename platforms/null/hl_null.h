/* SPDX-License-Identifier: Zlib */
#ifndef HL_NULL_H
#define HL_NULL_H
/* A device that draws nothing: memory-backed objects, passes recorded as
 * text. The template for a port, and a stand-in for any machine, since its
 * caps can be given. */
#include "hal/backend.h"

extern const struct hl_backend hl_backend_null;

/* hl_device_desc.native of this backend; all optional. */
struct hl_null_native {
    const struct hl_caps *caps;   /* the machine to pose as                  */
    /* One line a pass: label, size x samples, targets by slot with their
     * load ("d0" depth, "ro0" read only), draws:
     * "pass light 800x450x1 c0=3(clear) ro0=2(keep) draws=17". */
    void (*record)(void *user, const char *line);
    void *record_user;
    uint32_t fail_at;             /* the n-th create, write or pass fails
                                   * with HL_ERR_MEMORY; 0 = never           */
};
#endif
