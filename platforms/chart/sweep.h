/* SPDX-License-Identifier: Zlib */
#ifndef HLT_SWEEP_H
#define HLT_SWEEP_H
#include "platforms/chart/chart.h"

#define HLT_MACHINES "vulkan,packemu,packemu:dx10,packemu:xbox360,packemu:ps3"

/* A scene's name in the table and in names of files: the argument without
 * folder and ending; what is no letter, digit, '-' or '_' becomes '_'. */
void hlt_scene_key(char out[HLT_NAME], const char *arg);
#endif
