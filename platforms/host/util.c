/* SPDX-License-Identifier: Zlib */
#include "platforms/host/util.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Longest tail of a file name that an error line shows: the reason behind it
 * must still fit into struct hlh_error. */
enum { FILE_SHOWN = 200 };

bool hlh_fail(struct hlh_error *error, const char *file, const char *format,
              ...)
{
    va_list args;
    size_t used = 0, length;
    if (!error)
        return false;
    error->text[0] = 0;
    if (file) {
        length = strlen(file);
        snprintf(error->text, sizeof error->text, "%s%s: ",
                 length > FILE_SHOWN ? "..." : "",
                 length > FILE_SHOWN ? file + length - FILE_SHOWN : file);
        used = strlen(error->text);
    }
    va_start(args, format);
    vsnprintf(error->text + used, sizeof error->text - used, format, args);
    va_end(args);
    for (char *c = error->text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = '?';
    return false;
}

void *hlh_push(void *array_address, uint32_t *n, size_t element_size)
{
    void *array;
    char *slot;
    memcpy(&array, array_address, sizeof array);
    if (*n == UINT32_MAX / 2)
        return NULL;
    if ((*n & (*n - 1)) == 0) {
        size_t capacity = *n ? (size_t)*n * 2 : 1;
        if (capacity > SIZE_MAX / element_size)
            return NULL;
        array = realloc(array, capacity * element_size);
        if (!array)
            return NULL;
        memcpy(array_address, &array, sizeof array);
    }
    slot = (char *)array + *n * element_size;
    memset(slot, 0, element_size);
    ++*n;
    return slot;
}

void *hlh_alloc(size_t n, size_t size)
{
    if (size && n > SIZE_MAX / size)
        return NULL;
    n *= size;
    return malloc(n ? n : 1);
}

void *hlh_alloc_zero(size_t n, size_t size)
{
    return calloc(n ? n : 1, size ? size : 1);
}

char *hlh_strdup(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy)
        memcpy(copy, text, size);
    return copy;
}

static bool reserve(struct hlh_buffer *b, size_t more)
{
    size_t capacity = b->capacity ? b->capacity : 256;
    char *bytes;
    if (b->failed || more > SIZE_MAX / 2 - b->size) {
        b->failed = true;
        return false;
    }
    while (capacity < b->size + more)
        capacity *= 2;
    if (capacity != b->capacity) {
        bytes = realloc(b->bytes, capacity);
        if (!bytes) {
            b->failed = true;
            return false;
        }
        b->bytes = bytes;
        b->capacity = capacity;
    }
    return true;
}

void hlh_buffer_add(struct hlh_buffer *b, const void *bytes, size_t size)
{
    if (!size || !reserve(b, size))
        return;
    memcpy(b->bytes + b->size, bytes, size);
    b->size += size;
}

void hlh_buffer_print(struct hlh_buffer *b, const char *format, ...)
{
    va_list args;
    int length;
    va_start(args, format);
    length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length < 0) {
        b->failed = true;
        return;
    }
    if (!reserve(b, (size_t)length + 1))
        return;
    va_start(args, format);
    vsnprintf(b->bytes + b->size, (size_t)length + 1, format, args);
    va_end(args);
    b->size += (size_t)length;
}

void hlh_buffer_free(struct hlh_buffer *b)
{
    free(b->bytes);
    memset(b, 0, sizeof *b);
}

const char *hlh_path_base(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool hlh_path_is(const char *path, const char *extension)
{
    const char *dot = strrchr(hlh_path_base(path), '.');
    return dot && strcasecmp(dot + 1, extension) == 0;
}
