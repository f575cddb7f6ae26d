/* SPDX-License-Identifier: Zlib */
/* A context of OSMesa, Mesa's software renderer without a window system, which
 * Mesa removed in 25.1. Its few entries are declared here, so that building
 * needs no header of it. */
#include <dlfcn.h>
#include "platforms/gl/gl.h"

/* GL/osmesa.h */
enum {
    OSMESA_FORMAT = 0x22, OSMESA_PROFILE = 0x33, OSMESA_CORE_PROFILE = 0x34,
    OSMESA_MAJOR = 0x36, OSMESA_MINOR = 0x37, OSMESA_RGBA = 0x1908
};
typedef void *(*create_fn)(const int *attributes, void *share);
typedef void (*destroy_fn)(void *context);
typedef GLboolean (*make_current_fn)(void *context, void *buffer, GLenum type,
                                     GLsizei width, GLsizei height);
typedef void *(*current_fn)(void);
typedef hlgl_function (*find_fn)(const char *name);

enum { CREATE, DESTROY, MAKE_CURRENT, CURRENT, FIND, N_ENTRIES };
static const char *const names[N_ENTRIES] = {
    [CREATE] = "OSMesaCreateContextAttribs",
    [DESTROY] = "OSMesaDestroyContext",
    [MAKE_CURRENT] = "OSMesaMakeCurrent",
    [CURRENT] = "OSMesaGetCurrentContext",
    [FIND] = "OSMesaGetProcAddress"
};

static bool use(struct hlgl_context *c)
{
    if (((current_fn)c->entry[CURRENT])() == c->handle)
        return true;
    return ((make_current_fn)c->entry[MAKE_CURRENT])(
        c->handle, c->pixel, GL_UNSIGNED_BYTE, 1, 1);
}

/* The library stays loaded: Mesa and LLVM leave thread and exit handlers. */
static void close_context(struct hlgl_context *c)
{
    if (((current_fn)c->entry[CURRENT])() == c->handle)
        ((make_current_fn)c->entry[MAKE_CURRENT])(NULL, NULL,
                                                  GL_UNSIGNED_BYTE, 0, 0);
    ((destroy_fn)c->entry[DESTROY])(c->handle);
}

static hlgl_function find(const struct hlgl_context *c, const char *name)
{
    return ((find_fn)c->entry[FIND])(name);
}

static bool load(struct hlgl_context *c)
{
    static const char *const files[] = {
        "libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"
    };
    for (int i = 0; i < 3 && !c->library; i++)
        c->library = dlopen(files[i], RTLD_NOW | RTLD_LOCAL);
    for (int i = 0; i < N_ENTRIES && c->library; i++) {
        c->entry[i] = hlgl_symbol(c, names[i]);
        if (!c->entry[i])
            return false;
    }
    return c->library != NULL;
}

enum hlgl_found hlgl_osmesa_open(struct hlgl_context *c, uint32_t index,
                                 bool debug)
{
    static const int attributes[] = {
        OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
        OSMESA_MAJOR, 4, OSMESA_MINOR, 5, 0
    };
    (void)debug;   /* it has no debug contexts, and reports errors in any    */
    if (index > 0 || !load(c))
        return HLGL_END;
    c->kind = "osmesa";
    c->use = use;
    c->close = close_context;
    c->find = find;
    c->handle = ((create_fn)c->entry[CREATE])(attributes, NULL);
    return c->handle ? HLGL_OPEN : HLGL_FAILED;
}
