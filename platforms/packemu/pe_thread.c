/* SPDX-License-Identifier: Zlib */
/* A pool that sleeps between runs; items are taken under one lock, since an
 * item (a bin, a chunk of draws) costs a thousand times what the lock does. */
#if !defined(PE_NO_THREADS) && \
    (defined(__unix__) || (defined(__APPLE__) && defined(__MACH__)))
#define PE_POSIX 1
#if !defined(_POSIX_C_SOURCE) && !defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#endif
#include <pthread.h>
#include <time.h>
#include <unistd.h>
#endif
#include "platforms/packemu/pe_thread.h"

enum { MAX_THREADS = 64 };

#ifdef PE_POSIX

struct pe_pool {
    struct hl_device *device;
    pthread_mutex_t lock;
    pthread_cond_t work, idle;
    pthread_t thread[MAX_THREADS];   /* [0] is the caller's and not used     */
    uint32_t n_threads;
    uint32_t named;                  /* threads that know their number       */
    uint32_t run_id;                 /* raised by every run                  */
    uint32_t next, n, busy;          /* items; workers inside the run        */
    void (*run)(void *, uint32_t, uint32_t);
    void *user;
    bool quit;
};

/* Lock held on entry and on return. */
static void take_items(struct pe_pool *p, uint32_t thread)
{
    while (p->next < p->n) {
        uint32_t item = p->next++;
        pthread_mutex_unlock(&p->lock);
        p->run(p->user, item, thread);
        pthread_mutex_lock(&p->lock);
    }
}

static void *worker(void *user)
{
    struct pe_pool *p = user;
    uint32_t seen = 0;
    pthread_mutex_lock(&p->lock);
    uint32_t me = ++p->named;
    for (;;) {
        while (!p->quit && p->run_id == seen)
            pthread_cond_wait(&p->work, &p->lock);
        if (p->quit)
            break;
        seen = p->run_id;
        p->busy++;
        take_items(p, me);
        if (--p->busy == 0)
            pthread_cond_signal(&p->idle);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

static uint32_t processors(void)
{
#ifdef _SC_NPROCESSORS_ONLN
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    if (n > 0)
        return n > MAX_THREADS ? MAX_THREADS : (uint32_t)n;
#endif
    return 1;
}

struct pe_pool *pe_pool_open(struct hl_device *device, uint32_t threads)
{
    struct pe_pool *p = hl_bk_alloc(device, sizeof *p);
    if (!p)
        return NULL;
    p->device = device;
    p->n_threads = 1;
    if (threads == 0)
        threads = processors();
    if (threads > MAX_THREADS)
        threads = MAX_THREADS;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->work, NULL);
    pthread_cond_init(&p->idle, NULL);
    while (p->n_threads < threads &&
           pthread_create(&p->thread[p->n_threads], NULL, worker, p) == 0)
        p->n_threads++;
    return p;
}

void pe_pool_close(struct pe_pool *p)
{
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->quit = true;
    pthread_cond_broadcast(&p->work);
    pthread_mutex_unlock(&p->lock);
    for (uint32_t i = 1; i < p->n_threads; i++)
        pthread_join(p->thread[i], NULL);
    pthread_cond_destroy(&p->idle);
    pthread_cond_destroy(&p->work);
    pthread_mutex_destroy(&p->lock);
    hl_bk_free(p->device, p);
}

uint32_t pe_pool_threads(const struct pe_pool *p) { return p->n_threads; }

void pe_pool_run(struct pe_pool *p, uint32_t n,
                 void (*run)(void *user, uint32_t item, uint32_t thread),
                 void *user)
{
    if (p->n_threads == 1 || n <= 1) {
        for (uint32_t i = 0; i < n; i++)
            run(user, i, 0);
        return;
    }
    pthread_mutex_lock(&p->lock);
    p->run = run;
    p->user = user;
    p->next = 0;
    p->n = n;
    p->run_id++;
    pthread_cond_broadcast(&p->work);
    take_items(p, 0);
    /* A worker that wakes only now finds no item and does no harm. */
    while (p->busy > 0)
        pthread_cond_wait(&p->idle, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

double pe_clock_ms(void)
{
    struct timespec t;
    if (clock_gettime(CLOCK_MONOTONIC, &t) != 0)
        return 0;
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

#else

struct pe_pool { struct hl_device *device; };

struct pe_pool *pe_pool_open(struct hl_device *device, uint32_t threads)
{
    struct pe_pool *p = hl_bk_alloc(device, sizeof *p);
    (void)threads;
    if (p)
        p->device = device;
    return p;
}

void pe_pool_close(struct pe_pool *p)
{
    if (p)
        hl_bk_free(p->device, p);
}

uint32_t pe_pool_threads(const struct pe_pool *p)
{
    (void)p;
    return 1;
}

void pe_pool_run(struct pe_pool *p, uint32_t n,
                 void (*run)(void *user, uint32_t item, uint32_t thread),
                 void *user)
{
    (void)p;
    for (uint32_t i = 0; i < n; i++)
        run(user, i, 0);
}

double pe_clock_ms(void) { return 0; }

#endif
