/* SPDX-License-Identifier: Zlib */
#ifndef PE_THREAD_H
#define PE_THREAD_H
/* The one seam to threads and clocks. POSIX threads where the platform has
 * them; with PE_NO_THREADS, or elsewhere, everything runs on the caller's
 * thread and the clock stands still. */
#include "hal/backend.h"

struct pe_pool;

/* `threads` workers, the caller among them; 0: one a processor. NULL: out of
 * memory. A machine that gives fewer threads gets fewer. */
struct pe_pool *pe_pool_open(struct hl_device *, uint32_t threads);
void pe_pool_close(struct pe_pool *);
uint32_t pe_pool_threads(const struct pe_pool *);
/* Call run(user, item, thread) for items 0..n-1, in any order, thread <
 * pe_pool_threads; returns when all are done. */
void pe_pool_run(struct pe_pool *, uint32_t n,
                 void (*run)(void *user, uint32_t item, uint32_t thread),
                 void *user);
/* Milliseconds from some fixed point; 0 where there is no clock. */
double pe_clock_ms(void);
#endif
