/* SPDX-License-Identifier: Zlib */
/* A context of EGL with no surface at all: on one of EGL's devices, or, where
 * it enumerates none, on Mesa's surfaceless platform. */
#include <dlfcn.h>
#include <string.h>
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include "platforms/gl/gl.h"

enum { MAX_DEVICES = 16 };   /* more are not looked at                       */

enum {
    BIND_API, CHOOSE_CONFIG, CREATE_CONTEXT, DESTROY_CONTEXT, MAKE_CURRENT,
    CURRENT, INITIALIZE, QUERY_STRING, FIND, N_ENTRIES
};
static const char *const names[N_ENTRIES] = {
    [BIND_API] = "eglBindAPI", [CHOOSE_CONFIG] = "eglChooseConfig",
    [CREATE_CONTEXT] = "eglCreateContext",
    [DESTROY_CONTEXT] = "eglDestroyContext",
    [MAKE_CURRENT] = "eglMakeCurrent", [CURRENT] = "eglGetCurrentContext",
    [INITIALIZE] = "eglInitialize", [QUERY_STRING] = "eglQueryString",
    [FIND] = "eglGetProcAddress"
};

static hlgl_function find(const struct hlgl_context *c, const char *name)
{
    return ((PFNEGLGETPROCADDRESSPROC)c->entry[FIND])(name);
}

static bool make_current(const struct hlgl_context *c, EGLContext context)
{
    return ((PFNEGLMAKECURRENTPROC)c->entry[MAKE_CURRENT])(
        c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

static bool use(struct hlgl_context *c)
{
    ((PFNEGLBINDAPIPROC)c->entry[BIND_API])(EGL_OPENGL_API);
    return ((PFNEGLGETCURRENTCONTEXTPROC)c->entry[CURRENT])() == c->handle ||
           make_current(c, c->handle);
}

/* The display stays initialised: others in this process may use it, and EGL
 * does not count them. */
static void close_context(struct hlgl_context *c)
{
    ((PFNEGLBINDAPIPROC)c->entry[BIND_API])(EGL_OPENGL_API);
    if (((PFNEGLGETCURRENTCONTEXTPROC)c->entry[CURRENT])() == c->handle)
        make_current(c, EGL_NO_CONTEXT);
    ((PFNEGLDESTROYCONTEXTPROC)c->entry[DESTROY_CONTEXT])(c->display,
                                                          c->handle);
}

static bool load(struct hlgl_context *c)
{
    c->library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    for (int i = 0; i < N_ENTRIES && c->library; i++) {
        c->entry[i] = hlgl_symbol(c, names[i]);
        if (!c->entry[i])
            return false;
    }
    return c->library != NULL;
}

static bool has(const struct hlgl_context *c, const char *extension)
{
    const char *all = ((PFNEGLQUERYSTRINGPROC)c->entry[QUERY_STRING])(
        EGL_NO_DISPLAY, EGL_EXTENSIONS);
    return all && strstr(all, extension);
}

/* ---- displays ---------------------------------------------------------- */

static EGLDisplay platform_display(const struct hlgl_context *c,
                                   EGLenum platform, void *native)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC get = (PFNEGLGETPLATFORMDISPLAYEXTPROC)
        find(c, "eglGetPlatformDisplayEXT");
    return get && has(c, "EGL_EXT_platform_base")
           ? get(platform, native, NULL) : EGL_NO_DISPLAY;
}

static uint32_t devices(const struct hlgl_context *c,
                        EGLDeviceEXT out[MAX_DEVICES])
{
    PFNEGLQUERYDEVICESEXTPROC query =
        (PFNEGLQUERYDEVICESEXTPROC)find(c, "eglQueryDevicesEXT");
    EGLint n = 0;
    if (!query || !has(c, "EGL_EXT_platform_device") ||
        !(has(c, "EGL_EXT_device_enumeration") || has(c, "EGL_EXT_device_base"))
        || !query(MAX_DEVICES, out, &n) || n < 0)
        return 0;
    return (uint32_t)n;
}

/* Surfaceless comes after the devices, which it repeats: it is tried where
 * they are none. */
static enum hlgl_found display_open(struct hlgl_context *c, uint32_t index)
{
    EGLDeviceEXT device[MAX_DEVICES];
    uint32_t n = devices(c, device);
    if (index >= (n ? n : 1))
        return HLGL_END;
    if (n)
        c->display = platform_display(c, EGL_PLATFORM_DEVICE_EXT,
                                      device[index]);
    else if (has(c, "EGL_MESA_platform_surfaceless"))
        c->display = platform_display(c, EGL_PLATFORM_SURFACELESS_MESA,
                                      EGL_DEFAULT_DISPLAY);
    if (c->display == EGL_NO_DISPLAY ||
        !((PFNEGLINITIALIZEPROC)c->entry[INITIALIZE])(c->display, NULL, NULL))
        return HLGL_FAILED;
    return HLGL_OPEN;
}

/* ---- context ----------------------------------------------------------- */

static EGLContext create(const struct hlgl_context *c, bool debug)
{
    static const EGLint want[] = {
        EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE
    };
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_DEBUG, debug ? EGL_TRUE : EGL_FALSE, EGL_NONE
    };
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint n = 0;
    if (!((PFNEGLCHOOSECONFIGPROC)c->entry[CHOOSE_CONFIG])(
            c->display, want, &config, 1, &n) || n == 0)
        config = EGL_NO_CONFIG_KHR;
    return ((PFNEGLCREATECONTEXTPROC)c->entry[CREATE_CONTEXT])(
        c->display, config, EGL_NO_CONTEXT, attributes);
}

enum hlgl_found hlgl_egl_open(struct hlgl_context *c, uint32_t index,
                              bool debug)
{
    if (!load(c))
        return HLGL_END;
    enum hlgl_found found = display_open(c, index);
    if (found != HLGL_OPEN)
        return found;
    c->kind = "egl";
    c->use = use;
    c->close = close_context;
    c->find = find;
    ((PFNEGLBINDAPIPROC)c->entry[BIND_API])(EGL_OPENGL_API);
    c->handle = create(c, debug);
    return c->handle == EGL_NO_CONTEXT ? HLGL_FAILED : HLGL_OPEN;
}
