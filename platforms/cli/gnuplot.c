/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/gnuplot.h"
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "platforms/host/util.h"

/* The child's: stdin is the script, nothing else is shared. */
static void become_gnuplot(int from)
{
    dup2(from, STDIN_FILENO);
    close(from);
    execlp("gnuplot", "gnuplot", "-", (char *)NULL);
    _exit(127);
}

static bool write_all(int to, const char *text)
{
    size_t left = strlen(text);
    while (left > 0) {
        ssize_t n = write(to, text, left);
        if (n < 0 && errno != EINTR)
            return false;
        text += n > 0 ? n : 0;
        left -= n > 0 ? (size_t)n : 0;
    }
    return true;
}

/* The path in gnuplot's quotes, where a quote is doubled. */
static bool set_up(int to, const char *path, unsigned width, unsigned height)
{
    char head[128];
    snprintf(head, sizeof head, "set encoding utf8\nset terminal svg size "
             "%u,%u dynamic enhanced font 'sans-serif,13' background "
             "'white'\nset output '", width, height);
    bool ok = write_all(to, head);
    for (const char *p = path; *p && ok; p++) {
        char one[3] = { *p, *p == '\'' ? '\'' : 0, 0 };
        ok = write_all(to, one);
    }
    return ok && write_all(to, "'\n");
}

static bool run(const char *path, unsigned width, unsigned height,
                const char *script, int *status)
{
    int ends[2];
    if (pipe(ends) != 0)
        return false;
    pid_t child = fork();
    if (child == 0) {
        close(ends[1]);
        become_gnuplot(ends[0]);
    }
    close(ends[0]);
    bool ok = child > 0 && set_up(ends[1], path, width, height) &&
              write_all(ends[1], script);
    close(ends[1]);
    while (child > 0 && waitpid(child, status, 0) < 0)
        if (errno != EINTR)
            return false;
    return ok;
}

bool hlc_gnuplot(const char *path, unsigned width, unsigned height,
                 const char *script, struct hlh_error *error)
{
    struct sigaction ignore, before;
    int status = -1;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;       /* a gnuplot that ends early          */
    sigaction(SIGPIPE, &ignore, &before);
    bool ok = run(path, width, height, script, &status);
    sigaction(SIGPIPE, &before, NULL);
    if (ok && WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return true;
    remove(path);
    return hlh_fail(error, path, WIFEXITED(status) && WEXITSTATUS(status) ==
                    127 ? "gnuplot is not installed: no chart"
                        : "gnuplot could not draw it");
}
