/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/stability.h"

bool hls_lab_scene(struct hls_lab *lab, struct hlh_scene *scene,
                   const struct hlc_options *o)
{
    hls_lab_clear(lab);
    lab->open = hlc_stage_open(&lab->stage, scene, o) == HLC_DONE;
    if (!lab->open)
        snprintf(lab->note, sizeof lab->note, "no stage to draw on");
    return lab->open;
}

void hls_lab_clear(struct hls_lab *lab)
{
    if (lab->open)
        hlc_stage_close(&lab->stage);
    lab->open = false;
}
