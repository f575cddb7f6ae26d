/* SPDX-License-Identifier: Zlib */
#ifndef HLC_OUTPUTS_H
#define HLC_OUTPUTS_H
/* Files a command writes: tried before the long work, and taken back when a
 * later one fails, so that a command leaves all of them or none. */
#include <stdbool.h>
#include <stdint.h>
#include "platforms/host/scene.h"

struct hlc_outputs {
    char **paths;                /* written so far                           */
    uint32_t n;
    char *folder;                /* made by hlc_outputs_folder; or NULL      */
};

/* A file could be written at path: its folder is there and writable, and it
 * is no folder itself. NULL and "-" are fine. Says so without touching it. */
bool hlc_output_check(const char *path, struct hlh_error *error);
/* path is a folder that can be written, or can be made. */
bool hlc_output_check_folder(const char *path, struct hlh_error *error);
/* Make the folder unless it is there. */
bool hlc_outputs_folder(struct hlc_outputs *, const char *path,
                        struct hlh_error *error);
/* Note a file that was written. */
void hlc_outputs_add(struct hlc_outputs *, const char *path);
/* Forget the list; with undo, remove the files, and the folder if it was
 * made. */
void hlc_outputs_end(struct hlc_outputs *, bool undo);
#endif
