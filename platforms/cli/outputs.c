/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/outputs.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "platforms/host/util.h"

static bool is_folder(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

/* The folder that path names an entry of; malloc'd. */
static char *parent_of(const char *path)
{
    size_t n = strlen(path);
    while (n > 1 && path[n - 1] == '/')
        n--;
    while (n > 0 && path[n - 1] != '/')
        n--;
    char *parent = hlh_strdup(n ? path : ".");
    if (parent && n)
        parent[n] = 0;
    return parent;
}

static bool check_parent(const char *path, struct hlh_error *error)
{
    char *parent = parent_of(path);
    bool ok = parent && is_folder(parent);
    if (!ok)
        hlh_fail(error, path, "its folder does not exist");
    else if (access(parent, W_OK) != 0)
        ok = hlh_fail(error, path, "its folder cannot be written: %s",
                      strerror(errno));
    free(parent);
    return ok;
}

bool hlc_output_check(const char *path, struct hlh_error *error)
{
    if (!path || strcmp(path, "-") == 0)
        return true;
    if (!*path)
        return hlh_fail(error, "output", "the file name is empty");
    if (is_folder(path))
        return hlh_fail(error, path, "is a folder");
    return check_parent(path, error);
}

bool hlc_output_check_folder(const char *path, struct hlh_error *error)
{
    struct stat s;
    if (!path)
        return true;
    if (!*path)
        return hlh_fail(error, "output", "the folder's name is empty");
    if (stat(path, &s) != 0)
        return check_parent(path, error);
    if (!S_ISDIR(s.st_mode))
        return hlh_fail(error, path, "is not a folder");
    return access(path, W_OK) == 0 ||
           hlh_fail(error, path, "cannot be written: %s", strerror(errno));
}

bool hlc_outputs_folder(struct hlc_outputs *o, const char *path,
                        struct hlh_error *error)
{
    if (mkdir(path, 0777) == 0)
        o->folder = hlh_strdup(path);
    else if (!is_folder(path))
        return hlh_fail(error, path, "cannot be made: %s", strerror(errno));
    return true;
}

void hlc_outputs_add(struct hlc_outputs *o, const char *path)
{
    char **slot = strcmp(path, "-") ? hlh_push(&o->paths, &o->n, sizeof *slot)
                                    : NULL;
    if (slot)
        *slot = hlh_strdup(path);
}

void hlc_outputs_end(struct hlc_outputs *o, bool undo)
{
    for (uint32_t i = 0; i < o->n; i++) {
        if (undo && o->paths[i])
            remove(o->paths[i]);
        free(o->paths[i]);
    }
    if (undo && o->folder)
        rmdir(o->folder);
    free(o->paths);
    free(o->folder);
    memset(o, 0, sizeof *o);
}
