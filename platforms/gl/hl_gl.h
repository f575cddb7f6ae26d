/* SPDX-License-Identifier: Zlib */
#ifndef HL_GL_H
#define HL_GL_H
/* OpenGL 4.5 core backend, without a window. No GL library is linked: one is
 * found when a device is opened, through OSMesa (libOSMesa.so) or EGL
 * (libEGL.so.1: its devices, else Mesa's surfaceless platform), or it is the
 * embedder's.
 *
 * hl_device_desc.device: index in the list of hl_devices_list, or part of a
 * device's name in any case; NULL takes the first: OSMesa, then EGL's in its
 * own order. Link with -ldl where the C library asks for it.
 *
 * GL contexts belong to threads: a device is used on the thread that opened
 * it. Each halflight call makes the device's own context current and leaves
 * it so; an embedder who keeps a GL context of its own there binds that one
 * again. OSMesa and EGL of one Mesa share what is current: on one thread, do
 * not keep a device of each open.
 *
 * A stage of the embedder's own (hl_code.glsl) is GLSL 4.50 as
 * `spirv-cross --version 450 --no-es` writes it: uniform slot n at uniform
 * binding n, texture slot n at unit n, storage slot n at storage binding n;
 * constant n as `const uint c = SPIRV_CROSS_CONSTANT_ID_n;` (or int, float,
 * bool), that macro defined under #ifndef; blocks of one name and different
 * members do not meet in one program. */
#include "hal/backend.h"

extern const struct hl_backend hl_backend_gl;

/* hl_device_desc.native; zero in a member is its default. */
struct hl_gl_native {
    const char *context;     /* "osmesa", "egl"; NULL: whichever there is    */
    /* Not NULL: use the context that is current, at each call of halflight,
     * on the calling thread, 4.5 core at least, and these functions of it.
     * It is neither made current nor destroyed. All state that halflight
     * sets is left as it falls: pixel store, framebuffer, program, vertex
     * array, buffer ranges, texture units, samplers, depth, blend, cull. */
    void *(*get_proc)(const char *name);
};
#endif
