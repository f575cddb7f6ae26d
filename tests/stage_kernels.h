/* SPDX-License-Identifier: Zlib */
#ifndef STAGE_KERNELS_H
#define STAGE_KERNELS_H
/* hl_code.kernel of the tests' own stages, tests/NAME.frag, for the software
 * device. */
void (*vulkan_kernel(void))(void);
void (*pack_kernel(void))(void);
void (*own_taps_kernel(void))(void);
#endif
