/* SPDX-License-Identifier: Zlib */
#ifndef VULKAN_KIT_H
#define VULKAN_KIT_H
/* What the tests of the Vulkan backend share, and of others that draw the same:
 * a device with a quad, uniforms and a target, a stage of their own, and the
 * backend's inside. */
#include "platforms/vulkan/vk.h"
#include "shaders/shared/block.h"
#include "tests/check.h"

enum { VT_SIDE = 8, VT_ROW = 256 };

/* Quantities of vulkan.frag. */
enum {
    VT_OWN_COLOR, VT_VERTEX_COLOR, VT_FRAG_COORD, VT_FETCH, VT_SAMPLE,
    VT_UNBOUND
};

struct vertex { float position[3], uv[2]; };
/* From the top left corner of the target, uv 0,0, to the bottom right. */
extern const struct vertex vt_quad[6];

struct rig {
    struct ck_machine *m;
    struct hl_device *d;
    hl_buf mesh;             /* vt_quad                                      */
    hl_buf uniforms;         /* vt_uniforms                                  */
    hl_tex target;           /* VT_SIDE squared, RGBA32_FLOAT                */
};
typedef float image[VT_SIDE][VT_SIDE][4];

/* On a device of the test's own; or on the test's machine. */
struct rig vt_rig_on(struct hl_device *d);
struct rig vt_rig(void **state);
struct hlvk *vt_inside(struct hl_device *d);

hl_tex vt_tex(struct hl_device *d, enum hl_format format, uint32_t side,
              uint32_t samples, uint32_t usage);
/* Identities, moved to the right by move_x of clip space; id base 7. */
struct hl_object_block vt_object(float move_x);
/* Row 0: that object block, unmoved; row i of 8, VT_ROW bytes each, the
 * colour i / 8, 1 / 4, 0, 1. */
hl_buf vt_uniforms(struct hl_device *d);
/* The quad's layout, a quantity, RGBA32_FLOAT. */
struct hl_prog_desc vt_prog_desc(uint32_t what);
hl_prog vt_prog(struct hl_device *d, const struct hl_prog_desc *p);
/* The quad with object block and colour of row 1. */
struct hl_draw vt_draw(const struct rig *r, hl_prog prog);
/* A pass that clears the target to 0. */
enum hl_result vt_run(struct hl_device *d, hl_tex target,
                      const struct hl_draw *draws, uint32_t n);
void vt_read(const struct rig *r, image out);
/* Draw the quad with one program, perhaps one texture, and read. */
void vt_draw_one(const struct rig *r, const struct hl_prog_desc *p,
                 const struct hl_texture_binding *tex, image out);
/* The device still does what it should. */
void vt_assert_usable(const struct rig *r);
#endif
