/* SPDX-License-Identifier: Zlib */
/* A device of any backend in this program. */
#include <stdio.h>
#include <string.h>
#include "platforms/cli/calibration.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/setup.h"
#include "platforms/gl/hl_gl.h"
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"

static void listen(void *user, enum hl_log_level level, enum hl_log_id id,
                   const char *text)
{
    struct hlc_machine *m = user;
    if (level != HL_LOG_ERROR)
        return;
    if (id == HL_MSG_VALIDATION)
        hlc_fail(0, "validation: %s", text);
    snprintf(m->complaint, sizeof m->complaint, "%s", text);
}

static enum hl_result open_on(struct hlc_machine *m,
                              const struct hl_backend *backend,
                              const struct hlc_options *o)
{
    const struct hl_gl_native gl = { o->gl_context, NULL };
    struct hl_device_desc d;
    memset(&d, 0, sizeof d);
    d.version = HL_VERSION;
    d.hooks = hlc_hooks();
    d.native = backend == &hl_backend_gl ? &gl : NULL;
    d.log = listen;
    d.log_user = m;
    d.device = o->device;
    d.validation = o->validation;
    d.profile = o->profile ? hl_profile_find(o->profile) : NULL;
    m->backend = backend;
    return hl_device_open(&m->device, backend, &d);
}

/* The device's own caps, and over them what was measured. */
static int take_caps(struct hlc_machine *m, const struct hlc_options *o)
{
    struct hlh_error error;
    m->caps = *hl_device_caps(m->device);
    if (!o->calibration ||
        hlc_calibration_read(&m->caps, o->calibration, &error))
        return HLC_DONE;
    hlc_machine_close(m);
    return hlc_fail(HLC_BAD, "%s", error.text);
}

int hlc_machine_open(struct hlc_machine *m, const struct hlc_options *o)
{
    enum hl_result r = HL_ERR_NO_DEVICE;
    const struct hl_backend *b;
    memset(m, 0, sizeof *m);
    if (o->backend) {
        b = hl_platform_find(o->backend);
        r = b ? open_on(m, b, o) : HL_ERR_NO_DEVICE;
    }
    for (uint32_t i = 0; !o->backend && r != HL_OK; i++) {
        b = hl_platform(i);
        if (!b)
            break;
        if (strcmp(b->name, "null"))
            r = open_on(m, b, o);
    }
    if (r == HL_OK)
        return take_caps(m, o);
    const char *why = m->complaint[0] ? m->complaint : hl_result_name(r);
    if (o->device)
        return hlc_fail(HLC_NO_DEVICE, "--device %s: %s", o->device, why);
    if (o->backend)
        return hlc_fail(HLC_NO_DEVICE, "--backend %s: %s", o->backend, why);
    return hlc_fail(HLC_NO_DEVICE, "no backend has a device: %s", why);
}

void hlc_machine_close(struct hlc_machine *m)
{
    hl_device_close(&m->device);
}
