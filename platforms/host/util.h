/* SPDX-License-Identifier: Zlib */
#ifndef HLH_UTIL_H
#define HLH_UTIL_H
/* Small helpers that only the files of platforms/host share. */
#include <stdarg.h>
#include "platforms/host/scene.h"

#if defined(__GNUC__)
#define HLH_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define HLH_PRINTF(f, a)
#endif

/* Fill *error (may be NULL) with one line "file: reason" and return false, so
 * that a check reads `return hlh_fail(...)`. Control characters, which a
 * hostile file can put into a name, become '?': the line stays one line. A
 * long file name keeps its end. file may be NULL. */
bool hlh_fail(struct hlh_error *error, const char *file, const char *format,
              ...) HLH_PRINTF(3, 4);

/* Append one zeroed element to a malloc'd array of *n elements. The capacity
 * is the next power of two, never stored. NULL when memory is out or *n is
 * at its limit; the array is then as before. */
void *hlh_push(void *array_address, uint32_t *n, size_t element_size);

/* malloc(n * size) that fails rather than wrap; size 0 gives one byte. */
void *hlh_alloc(size_t n, size_t size);
void *hlh_alloc_zero(size_t n, size_t size);
char *hlh_strdup(const char *text);

/* Bytes that grow: bytes is malloc'd (NULL while empty); failed sticks once
 * memory ran out, so that a writer may check once, at its end. */
struct hlh_buffer {
    char *bytes;
    size_t size, capacity;
    bool failed;
};
void hlh_buffer_add(struct hlh_buffer *b, const void *bytes, size_t size);
void hlh_buffer_print(struct hlh_buffer *b, const char *format, ...)
    HLH_PRINTF(2, 3);
void hlh_buffer_free(struct hlh_buffer *b);

/* As hlh_file_read, but only a regular file: what a scene file names must
 * not block on a pipe or read a device. */
bool hlh_file_read_regular(char **bytes, size_t *size, const char *path,
                           struct hlh_error *error);
/* "a/b/c.glb" -> "c.glb"; a pointer into path. */
const char *hlh_path_base(const char *path);
/* The ending after the last dot of the base name, "" where there is none;
 * compared without case by hlh_path_is. */
bool hlh_path_is(const char *path, const char *extension);
#endif
