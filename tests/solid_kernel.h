/* SPDX-License-Identifier: Zlib */
#ifndef SOLID_KERNEL_H
#define SOLID_KERNEL_H
/* hl_code.kernel of the tests' solid stage. */
void (*solid_kernel(void))(void);
#endif
