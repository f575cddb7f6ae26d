/* SPDX-License-Identifier: Zlib */
/* Whole files in and out. */
#define _XOPEN_SOURCE 700                        /* realpath */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

/* Largest file that is read: an endless device ends here, not in swap. */
#define FILE_LIMIT ((size_t)1 << 31)

static bool slurp(FILE *file, struct hlh_buffer *b, const char *path,
                  struct hlh_error *error)
{
    char part[65536];
    size_t got;
    while ((got = fread(part, 1, sizeof part, file)) > 0) {
        hlh_buffer_add(b, part, got);
        if (b->failed)
            return hlh_fail(error, path, "out of memory");
        if (b->size > FILE_LIMIT)
            return hlh_fail(error, path, "longer than 2 GiB");
    }
    if (ferror(file))
        return hlh_fail(error, path, "cannot be read: %s", strerror(errno));
    hlh_buffer_add(b, "", 1);
    if (b->failed)
        return hlh_fail(error, path, "out of memory");
    return true;
}

bool hlh_file_read(char **bytes, size_t *size, const char *path,
                   struct hlh_error *error)
{
    struct hlh_buffer b = {0};
    FILE *file = fopen(path, "rb");
    bool ok;
    *bytes = NULL;
    *size = 0;
    if (!file)
        return hlh_fail(error, path, "cannot be opened: %s", strerror(errno));
    ok = slurp(file, &b, path, error);
    fclose(file);
    if (!ok) {
        hlh_buffer_free(&b);
        return false;
    }
    *bytes = b.bytes;
    *size = b.size - 1;
    return true;
}

bool hlh_file_read_regular(char **bytes, size_t *size, const char *path,
                           struct hlh_error *error)
{
    struct stat info;
    *bytes = NULL;
    *size = 0;
    if (stat(path, &info) != 0)
        return hlh_fail(error, path, "cannot be opened: %s", strerror(errno));
    if (!S_ISREG(info.st_mode))
        return hlh_fail(error, path, "is not a regular file");
    return hlh_file_read(bytes, size, path, error);
}

static bool write_all(int fd, const char *bytes, size_t size)
{
    while (size) {
        ssize_t n = write(fd, bytes, size);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        bytes += n;
        size -= (size_t)n;
    }
    return true;
}

/* A device or a pipe (--out /dev/null) is written to, never renamed over. */
static bool write_direct(const char *path, const void *bytes, size_t size,
                         struct hlh_error *error)
{
    int fd = open(path, O_WRONLY);
    bool ok;
    if (fd < 0)
        return hlh_fail(error, path, "cannot be opened: %s", strerror(errno));
    ok = write_all(fd, bytes, size);
    if (!ok)
        hlh_fail(error, path, "cannot be written: %s", strerror(errno));
    if (close(fd) != 0 && ok)
        ok = hlh_fail(error, path, "cannot be written: %s", strerror(errno));
    return ok;
}

/* Open a new file beside path; its name goes to temporary. mkstemp would
 * give mode 0600, where the user's umask should decide. */
static int open_beside(char *temporary, size_t size, const char *path)
{
    for (unsigned i = 0; i < 1000; i++) {
        int fd;
        snprintf(temporary, size, "%s.tmp-%ld-%u", path, (long)getpid(), i);
        fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    return -1;
}

static bool write_renamed(const char *path, const void *bytes, size_t size,
                          const char *shown, struct hlh_error *error)
{
    size_t room = strlen(path) + 40;
    char *temporary = malloc(room);
    int fd, problem = 0;
    if (!temporary)
        return hlh_fail(error, shown, "out of memory");
    fd = open_beside(temporary, room, path);
    if (fd < 0) {
        free(temporary);
        return hlh_fail(error, shown, "cannot be created: %s",
                        strerror(errno));
    }
    if (!write_all(fd, bytes, size))
        problem = errno ? errno : EIO;
    if (close(fd) != 0 && !problem)
        problem = errno;
    if (!problem && rename(temporary, path) != 0)
        problem = errno;
    if (problem)
        unlink(temporary);
    free(temporary);
    if (problem)
        return hlh_fail(error, shown, "cannot be written: %s",
                        strerror(problem));
    return true;
}

bool hlh_file_write(const char *path, const void *bytes, size_t size,
                    struct hlh_error *error)
{
    struct stat info;
    char *target;
    bool ok;
    if (stat(path, &info) != 0)
        return write_renamed(path, bytes, size, path, error);
    if (S_ISDIR(info.st_mode))
        return hlh_fail(error, path, "is a directory");
    if (!S_ISREG(info.st_mode))
        return write_direct(path, bytes, size, error);
    /* Behind a symbolic link the file changes, not the link. */
    target = realpath(path, NULL);
    if (!target)
        return hlh_fail(error, path, "cannot be written: %s",
                        strerror(errno));
    ok = write_renamed(target, bytes, size, path, error);
    free(target);
    return ok;
}
