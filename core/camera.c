/* SPDX-License-Identifier: Zlib */
#include "core/exact.h"
#include "core/scene.h"
#include "core/vec.h"

enum hl_result hl_camera_look_at(struct hl_camera *out, const float eye[3],
                                 const float target[3], float vfov,
                                 float near, float far)
{
    hl_vec3 e = hl_load3(eye);
    hl_vec3 back = hl_sub3(e, hl_load3(target));
    if (!(hl_length3(back) > 0.0f) || !(vfov > 0.0f) || !(vfov < 180.0f) ||
        !(near > 0.0f) || !(far > near))
        return HL_ERR_INVALID;
    back = hl_normalize3(back);
    /* Straight up or down: nearer the y axis than a float direction can say
     * (1e-6 radians). */
    float level = sqrtf(back.x * back.x + back.z * back.z);
    hl_vec3 up = level < 1e-6f ? hl_v3(0, 0, -1) : hl_v3(0, 1, 0);
    hl_vec3 x = hl_normalize3(hl_cross3(up, back));
    hl_vec3 y = hl_cross3(back, x);
    const float v[16] = { x.x, y.x, back.x, 0, x.y, y.y, back.y, 0,
                          x.z, y.z, back.z, 0, -hl_dot3(x, e), -hl_dot3(y, e),
                          -hl_dot3(back, e), 1 };
    for (int i = 0; i < 16; i++)
        out->view[i] = v[i];
    out->tan_half_y = (float)hl_exact_tan((double)vfov *
                                          (3.14159265358979323846 / 360));
    out->near = near;
    out->far = far;
    out->jitter[0] = out->jitter[1] = 0;
    return HL_OK;
}
