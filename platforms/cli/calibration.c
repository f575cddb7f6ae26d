/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/calibration.h"
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

const char *const hlc_calibration_scenes[] = {
    "fig8", "fig9", "lidr", "many", NULL
};

bool hlc_is_calibration_scene(const char *name)
{
    for (int i = 0; hlc_calibration_scenes[i]; i++)
        if (!strcmp(hlc_calibration_scenes[i], name))
            return true;
    return false;
}

/* ---- keys --------------------------------------------------------------- */

struct key {
    const char *name;
    size_t at;                   /* of a float of hl_caps                    */
    const char *unit;
};
#define AT(name) #name, offsetof(struct hl_caps, name)

static const struct key costs[] = {
    { AT(cost.draw_ns), "ns a draw" },
    { AT(cost.vertex_ns), "ns a triangle" },
    { AT(cost.pixel_ns), "ns a covered pixel" },
    { AT(cost.fetch_ns), "ns a texel fetch of 4 to 8 bytes" },
    { AT(cost.blend_ns), "ns a blend of 8 bytes" },
    { AT(cost.light_ns), "ns a light and pixel, from uniforms" },
    { AT(cost.light_flat_ns), "ns a light and pixel, from flat varyings" },
    { AT(cost.light_gather_ns), "ns a light and pixel, from a list" },
    { AT(cost.readback_ns), "ns a texel read back" },
    { AT(cost.sync_ns), "ns a submit and wait" },
    { AT(cost.untaken), "share paid of what a condition leaves out, 0..1" },
};
static const struct key errors[] = {
    { AT(error.full), "codes, L-buffer of the frame's size against forward" },
    { AT(error.half), "codes, that of half the frame against full" },
    { AT(error.eight), "codes, RGBA8_UNORM against full" },
    { AT(error.margin), "factor on predicted codes" },
};
enum { N_COSTS = sizeof costs / sizeof *costs,
       N_ERRORS = sizeof errors / sizeof *errors,
       N_FORMATS = HL_FORMAT_COUNT - 1, N_EIGHTHS = 7,
       N_KEYS = N_COSTS + 2 * N_FORMATS + N_EIGHTHS + N_ERRORS };

static float *of_key(struct hl_caps *caps, const struct key *k,
                     char key[HLC_CALIBRATION_KEY], const char **unit)
{
    snprintf(key, HLC_CALIBRATION_KEY, "%s", k->name);
    *unit = k->unit;
    return (float *)(void *)((char *)caps + k->at);
}

static float *of_format(float *list, uint32_t i, const char *what,
                        char key[HLC_CALIBRATION_KEY])
{
    enum hl_format f = (enum hl_format)(i + 1);
    snprintf(key, HLC_CALIBRATION_KEY, "cost.format_%s_ns.%s", what,
             hl_format_info(f)->name);
    return &list[f];
}

float *hlc_calibration_value(struct hl_caps *caps, uint32_t i,
                             char key[HLC_CALIBRATION_KEY], const char **unit)
{
    const char *unread;
    unit = unit ? unit : &unread;
    *unit = "ns a texel";
    if (i < N_COSTS)
        return of_key(caps, &costs[i], key, unit);
    i -= N_COSTS;
    if (i < N_FORMATS)
        return of_format(caps->cost.format_blend_ns, i, "blend", key);
    i -= N_FORMATS;
    if (i < N_FORMATS)
        return of_format(caps->cost.format_fetch_ns, i, "fetch", key);
    i -= N_FORMATS;
    *unit = "share of the error of an L-buffer of half the frame a side";
    if (i < N_EIGHTHS) {
        snprintf(key, HLC_CALIBRATION_KEY, "error.eighths.%u", i + 1);
        return &caps->error.eighths[i + 1];
    }
    i -= N_EIGHTHS;
    return i < N_ERRORS ? of_key(caps, &errors[i], key, unit) : NULL;
}

static const char *kind_name(enum hl_device_kind kind)
{
    static const char *const names[] = { "other", "discrete", "integrated",
                                         "cpu" };
    return (unsigned)kind < 4 ? names[kind] : names[0];
}

/* ---- reading ------------------------------------------------------------ */

enum { SEEN_VERSION = N_KEYS, SEEN_BACKEND, SEEN_KIND, SEEN_DEVICE,
       SEEN_DRIVER, N_SEEN };

struct reading {
    struct hl_caps caps;
    const char *name;
    uint32_t line;
    bool seen[N_SEEN];
    struct hlh_error *error;
};

static bool wrong(struct reading *r, const char *format, ...)
    HLH_PRINTF(2, 3);
static bool wrong(struct reading *r, const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return hlh_fail(r->error, r->name, "line %u: %s", r->line, text);
}

/* strtod and printf have the point of the process's locale. */
static void change_point(char *text, bool to_locale)
{
    const char *point = localeconv()->decimal_point;
    char from = to_locale ? '.' : point[0], to = to_locale ? point[0] : '.';
    char *p = point[0] && !point[1] ? strchr(text, from) : NULL;
    if (p)
        *p = to;
}

static bool number(struct reading *r, float *out, const char *value, bool share)
{
    char text[64], *end;
    snprintf(text, sizeof text, "%s", value);
    change_point(text, true);
    double x = strtod(text, &end);
    bool plain = value[strspn(value, "0123456789+-.eE")] == 0;
    if (!plain || strlen(value) >= sizeof text || end == text || *end)
        return wrong(r, "'%.40s' is no number", value);
    /* Half a step above the largest float still rounds to it. */
    if (!(fabs(x) < 0x1.ffffffp127))
        return wrong(r, "'%.40s' is too large", value);
    if (x < 0 || signbit(x))
        return wrong(r, "'%.40s' is below 0", value);
    if (share && x > 1)
        return wrong(r, "'%.40s' is above 1", value);
    *out = (float)x;
    return true;
}

static bool once(struct reading *r, int which, const char *key)
{
    if (r->seen[which])
        return wrong(r, "%.60s is there twice", key);
    r->seen[which] = true;
    return true;
}

static bool must_be(struct reading *r, const char *key, const char *value,
                    const char *wanted)
{
    return !strcmp(value, wanted) ||
           wrong(r, "%s is '%.40s', this machine's is '%s'", key, value,
                 wanted);
}

/* What a file is of. 1: done, 0: wrong, -1: another key. */
static int head(struct reading *r, const char *key, const char *value)
{
    static const char *const keys[] = { "version", "backend", "device_kind",
                                        "device", "driver" };
    int i = 0;
    while (i < 5 && strcmp(keys[i], key))
        i++;
    if (i == 5)
        return -1;
    if (!once(r, SEEN_VERSION + i, key))
        return 0;
    switch (SEEN_VERSION + i) {
    case SEEN_VERSION:
        return must_be(r, key, value, "1");
    case SEEN_BACKEND:
        return must_be(r, key, value, r->caps.backend);
    case SEEN_KIND:
        return must_be(r, key, value, kind_name(r->caps.kind));
    default:
        return 1;                /* for people                               */
    }
}

static bool take(struct reading *r, const char *key, const char *value)
{
    char name[HLC_CALIBRATION_KEY];
    float *slot;
    int done = head(r, key, value);
    if (done >= 0)
        return done > 0;
    if (!r->seen[SEEN_VERSION])
        return wrong(r, "%.60s before version", key);
    for (uint32_t i = 0;; i++) {
        slot = hlc_calibration_value(&r->caps, i, name, NULL);
        if (!slot)
            return wrong(r, "no key '%.60s'", key);
        if (!strcmp(name, key))
            return once(r, (int)i, key) &&
                   number(r, slot, value, slot == &r->caps.cost.untaken);
    }
}

static char *trim(char *text)
{
    size_t n = strlen(text);
    while (n > 0 && strchr(" \t\r", text[n - 1]))
        text[--n] = 0;
    return text + strspn(text, " \t");
}

static bool take_line(struct reading *r, char *text)
{
    char *key = trim(text), *equals = strchr(key, '=');
    if (!*key || *key == '#')
        return true;
    if (!equals)
        return wrong(r, "no 'key = value'");
    *equals = 0;
    key = trim(key);
    char *value = trim(equals + 1);
    if (!*value)
        return wrong(r, "%.60s has no value", key);
    return take(r, key, value);
}

static bool take_all(struct reading *r, char *text, size_t size)
{
    char *end = text + size;
    while (text < end) {
        char *stop = memchr(text, '\n', (size_t)(end - text));
        stop = stop ? stop : end;
        r->line++;
        if (memchr(text, 0, (size_t)(stop - text)))
            return wrong(r, "a byte of 0");
        *stop = 0;
        if (!take_line(r, text))
            return false;
        text = stop + 1;
    }
    for (int i = SEEN_VERSION; i <= SEEN_KIND; i++)
        if (!r->seen[i])
            return hlh_fail(r->error, r->name, "no %s",
                            i == SEEN_VERSION ? "version"
                            : i == SEEN_BACKEND ? "backend" : "device_kind");
    return true;
}

bool hlc_calibration_parse(struct hl_caps *caps, const char *text, size_t size,
                           const char *name, struct hlh_error *error)
{
    struct reading r = { *caps, name, 0, { false }, error };
    if (size > HLC_CALIBRATION_BYTES)
        return hlh_fail(error, name, "longer than 64 KiB");
    char *copy = malloc(size + 1);
    if (!copy)
        return hlh_fail(error, name, "out of memory");
    memcpy(copy, text, size);
    copy[size] = 0;
    bool ok = take_all(&r, copy, size);
    free(copy);
    if (ok) {
        caps->cost = r.caps.cost;
        caps->error = r.caps.error;
    }
    return ok;
}

bool hlc_calibration_read(struct hl_caps *caps, const char *path,
                          struct hlh_error *error)
{
    FILE *file = fopen(path, "rb");
    size_t room = HLC_CALIBRATION_BYTES + 1;
    char *text = file ? malloc(room) : NULL;
    bool ok = false;
    if (!file)
        return hlh_fail(error, path, "cannot be opened: %s", strerror(errno));
    size_t size = text ? fread(text, 1, room, file) : 0;
    if (!text)
        hlh_fail(error, path, "out of memory");
    else if (ferror(file))
        hlh_fail(error, path, "cannot be read: %s", strerror(errno));
    else
        ok = hlc_calibration_parse(caps, text, size, path, error);
    fclose(file);
    free(text);
    return ok;
}

/* ---- writing ------------------------------------------------------------ */

static void print_text(struct hlh_buffer *b, const char *key, const char *text)
{
    char clean[HL_CAPS_NAME];
    snprintf(clean, sizeof clean, "%s", text);
    for (char *p = clean; *p; p++)
        if ((unsigned char)*p < 32 || *p == 127)
            *p = '?';
    hlh_buffer_print(b, "%s = %s\n", key, clean[0] ? clean : "?");
}

static void print_value(struct hlh_buffer *b, const char *key,
                        const char *unit, float value, const char *note)
{
    char text[32];
    snprintf(text, sizeof text, "%.9g", (double)value);
    change_point(text, false);
    hlh_buffer_print(b, "\n# %s%s%s\n%s = %s\n", unit, note ? "; " : "",
                     note ? note : "", key, text);
}

static void print_head(struct hlh_buffer *b, const struct hl_caps *caps,
                       const char *note)
{
    for (const char *p = note ? note : ""; *p; p += *p == '\n') {
        int n = (int)strcspn(p, "\n");
        hlh_buffer_print(b, "# %.*s\n", n, p);
        p += n;
    }
    hlh_buffer_print(b, "version = 1\nbackend = %s\ndevice_kind = %s\n",
                     caps->backend, kind_name(caps->kind));
    print_text(b, "device", caps->device);
    print_text(b, "driver", caps->driver);
}

/* Formats that nothing was measured of are left out. */
static bool is_left_out(const char *key, float value)
{
    return !strncmp(key, "cost.format_", 12) && !(value > 0);
}

bool hlc_calibration_write(const struct hl_caps *caps, const char *path,
                           hlc_calibration_note note, void *user,
                           struct hlh_error *error)
{
    struct hl_caps copy = *caps;
    struct hlh_buffer b = { 0 };
    char key[HLC_CALIBRATION_KEY];
    const char *unit;
    const float *value;
    print_head(&b, caps, note ? note(user, "") : NULL);
    for (uint32_t i = 0;
         (value = hlc_calibration_value(&copy, i, key, &unit)) != NULL; i++)
        if (!is_left_out(key, *value))
            print_value(&b, key, unit, *value, note ? note(user, key) : NULL);
    bool out = !strcmp(path, "-");
    bool ok = !b.failed || hlh_fail(error, path, "out of memory");
    if (ok && out && (fwrite(b.bytes, 1, b.size, stdout) != b.size ||
                      fflush(stdout) != 0))
        ok = hlh_fail(error, NULL, "stdout cannot be written");
    else if (ok && !out)
        ok = hlh_file_write(path, b.bytes, b.size, error);
    hlh_buffer_free(&b);
    return ok;
}
