/* SPDX-License-Identifier: Zlib */
/* The script goes to gnuplot's standard input by a pipe; what it draws and
 * what it says come back by files without names, so that no name of ours is
 * ever read by gnuplot, to which "| command" is a place to write to. */
#include "platforms/cli/gnuplot.h"
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

enum { SVG_MAX = 1 << 26 };

/* ---- the program -------------------------------------------------------- */

/* -d: no settings of the user's; nor a decimal comma. By env, which ends with
 * 127 where there is no such program: between fork and exec no function may
 * allocate, since another thread may have been allocating. */
static void become_gnuplot(int script, FILE *svg, FILE *said)
{
    dup2(script, STDIN_FILENO);
    dup2(fileno(svg), STDOUT_FILENO);
    dup2(fileno(said), STDERR_FILENO);
    close(script);
    execlp("env", "env", "LC_ALL=C", "gnuplot", "-d", "-", (char *)NULL);
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

static bool set_up(int to, unsigned width, unsigned height)
{
    char head[192];
    snprintf(head, sizeof head, "set encoding utf8\nset terminal svg size "
             "%u,%u dynamic enhanced font 'sans-serif,13' background "
             "'white'\n", width, height);
    return write_all(to, head);
}

/* Until it ends; its exit status, or -1. */
static int wait_for(pid_t child)
{
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int run(unsigned width, unsigned height, const char *script, FILE *svg,
               FILE *said)
{
    int ends[2];
    if (pipe(ends) != 0)
        return -1;
    pid_t child = fork();
    if (child == 0) {
        close(ends[1]);
        become_gnuplot(ends[0], svg, said);
    }
    close(ends[0]);
    bool ok = child > 0 && set_up(ends[1], width, height) &&
              write_all(ends[1], script);
    close(ends[1]);
    int code = child > 0 ? wait_for(child) : -1;
    return ok || code > 0 ? code : -1;
}

/* A gnuplot that ends early is an error of writing, not the end of us. */
static int run_unsignalled(unsigned width, unsigned height,
                           const char *script, FILE *svg, FILE *said)
{
    struct sigaction ignore, before;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &before);
    int code = run(width, height, script, svg, said);
    sigaction(SIGPIPE, &before, NULL);
    return code;
}

/* ---- what comes back ---------------------------------------------------- */

/* Of a file that another process wrote to: NUL-terminated, malloc'd. */
static char *read_all(FILE *f, size_t *size)
{
    long n = fseek(f, 0, SEEK_END) == 0 ? ftell(f) : -1;
    char *text = n >= 0 && n < SVG_MAX ? malloc((size_t)n + 1) : NULL;
    if (!text)
        return NULL;
    rewind(f);
    *size = fread(text, 1, (size_t)n, f);
    text[*size] = 0;
    return text;
}

/* Viewers show the title, which is the drawing program's name and no more. */
static void blank(char *text, const char *part)
{
    char *at = strstr(text, part);
    if (at)
        memset(at, ' ', strlen(part));
}

/* gnuplot shows where, in lines that begin with blanks or a "^", then says
 * what: the last line. */
static bool complain(FILE *said, const char *path, struct hlh_error *error)
{
    size_t size;
    char *text = read_all(said, &size), *line = text;
    while (text && size > 0 && strchr(" \n\t", text[size - 1]))
        text[--size] = 0;
    for (char *c = text; c && *c; c++)
        line = *c == '\n' ? c + 1 : line;
    hlh_fail(error, path, "gnuplot could not draw it%s%.200s",
             line && *line ? ": " : "", line ? line : "");
    free(text);
    return false;
}

static bool store(FILE *svg, const char *path, struct hlh_error *error)
{
    size_t size;
    char *text = read_all(svg, &size);
    if (!text)
        return hlh_fail(error, path, "out of memory");
    blank(text, "<title>Gnuplot</title>");
    bool ok = strstr(text, "</svg>")
              ? hlh_file_write(path, text, size, error)
              : hlh_fail(error, path, "gnuplot drew nothing");
    free(text);
    return ok;
}

bool hlc_gnuplot(const char *path, unsigned width, unsigned height,
                 const char *script, struct hlh_error *error)
{
    FILE *svg = tmpfile(), *said = tmpfile();
    bool ok = false;
    int code = svg && said ? run_unsignalled(width, height, script, svg, said)
                           : -1;
    if (!svg || !said)
        hlh_fail(error, path, "no room for temporary files");
    else if (code == 127)
        hlh_fail(error, path, "gnuplot is not installed: no chart");
    else if (code != 0)
        complain(said, path, error);
    else
        ok = store(svg, path, error);
    if (svg)
        fclose(svg);
    if (said)
        fclose(said);
    return ok;
}
