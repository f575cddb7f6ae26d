/* SPDX-License-Identifier: Zlib */
#ifndef HALFLIGHT_H
#define HALFLIGHT_H
/* All public headers, in the order to read them. */
#include "hal/caps.h"    /* what a machine says of itself                    */
#include "hal/hal.h"     /* devices, buffers, textures, programs, passes     */
#include "core/needs.h"  /* what a scene asks                                */
#include "core/plan.h"   /* the frame as data, and why                       */
#include "core/scene.h"  /* camera, lights, surfaces, items                  */
#include "core/frame.h"  /* runs a plan                                      */
#include "core/mesh.h"   /* normal groups, tangents                          */
#include "core/ids.h"    /* region ids                                       */
#include "core/stipple.h" /* patterns of translucent objects                 */
#include "core/shadow_mesh.h" /* meshes that cast shadow volumes            */
#endif
