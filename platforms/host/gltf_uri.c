/* SPDX-License-Identifier: Zlib */
/* What a glTF's uri names: base64 in the text itself, or a file beside it. */
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

/* In place; false for a broken %XX or an encoded zero byte. */
static bool percent_decode(char *s)
{
    char *out = s;
    while (*s) {
        int high, low;
        if (*s != '%') {
            *out++ = *s++;
            continue;
        }
        high = hex_digit(s[1]);
        low = high < 0 ? -1 : hex_digit(s[2]);
        if (low < 0 || (high == 0 && low == 0))
            return false;
        *out++ = (char)(high * 16 + low);
        s += 3;
    }
    *out = 0;
    return true;
}

static int base64_digit(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Padding may be left out; nothing but digits may stand before it. */
static bool base64_decode(const char *s, char **bytes, size_t *size)
{
    size_t n = strlen(s), bits = 0;
    uint32_t word = 0;
    char *out;
    while (n && s[n - 1] == '=')
        n--;
    if (n % 4 == 1 || strlen(s) - n > 2)
        return false;
    out = malloc(n / 4 * 3 + 4);
    *bytes = out;
    *size = 0;
    for (size_t i = 0; out && i < n; i++) {
        int digit = base64_digit(s[i]);
        if (digit < 0) {
            free(out);
            *bytes = NULL;
            return false;
        }
        word = word << 6 | (uint32_t)digit;
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            out[(*size)++] = (char)(word >> bits & 255);
        }
    }
    return true;
}

static bool fetch_data(struct gltf *g, const char *uri, const char *where,
                       char **bytes, size_t *size)
{
    const char *comma = strchr(uri, ',');
    if (!comma || comma - uri < 7 || strncmp(comma - 7, ";base64", 7) != 0)
        return hlh_fail(g->error, g->file, "%s.uri: is a data: URI without "
                        "\";base64,\"", where);
    if (!base64_decode(comma + 1, bytes, size))
        return hlh_fail(g->error, g->file, "%s.uri: its base64 is broken",
                        where);
    return *bytes || gltf_memory(g);
}

static bool leaves_folder(const char *path)
{
    if (*path == '/')
        return true;
    for (const char *s = path; s; s = strchr(s, '/')) {
        if (*s == '/')
            s++;
        if (strncmp(s, "..", 2) == 0 && (!s[2] || s[2] == '/'))
            return true;
    }
    /* A colon stands for a scheme (http:) or a drive, a backslash for the
     * separator of another system. */
    return strpbrk(path, ":\\") != NULL;
}

static bool fetch_file(struct gltf *g, char *name, const char *where,
                       char **bytes, size_t *size)
{
    size_t folder = (size_t)(hlh_path_base(g->file) - g->file);
    struct hlh_error inner;
    char *path;
    bool ok;
    if (!percent_decode(name) || !*name)
        return hlh_fail(g->error, g->file, "%s.uri: is not a valid URI",
                        where);
    if (leaves_folder(name))
        return hlh_fail(g->error, g->file, "%s.uri: \"%.100s\" is not a file "
                        "beside the scene or below", where, name);
    path = malloc(folder + strlen(name) + 1);
    if (!path)
        return gltf_memory(g);
    memcpy(path, g->file, folder);
    strcpy(path + folder, name);
    ok = hlh_file_read_regular(bytes, size, path, &inner);
    free(path);
    if (!ok) {
        /* "path: reason": only the reason is news. */
        const char *reason = strrchr(inner.text, ':');
        const char *cannot = strstr(inner.text, ": cannot be ");
        if (cannot)
            reason = cannot;
        return hlh_fail(g->error, g->file, "%s.uri: \"%.100s\"%s", where, name,
                        reason ? reason + 1 : "");
    }
    return true;
}

bool gltf_fetch(struct gltf *g, const char *uri, const char *where,
                char **bytes, size_t *size)
{
    char *name;
    bool ok;
    *bytes = NULL;
    *size = 0;
    if (strncmp(uri, "data:", 5) == 0) {
        ok = fetch_data(g, uri, where, bytes, size);
    } else {
        name = hlh_strdup(uri);
        if (!name)
            return gltf_memory(g);
        ok = fetch_file(g, name, where, bytes, size);
        free(name);
    }
    if (ok && *size > g->bytes_left) {
        free(*bytes);
        *bytes = NULL;
        return hlh_fail(g->error, g->file, "%s.uri: what the scene refers to "
                        "exceeds 2 GiB in all", where);
    }
    if (ok)
        g->bytes_left -= *size;
    return ok;
}
