/* SPDX-License-Identifier: Zlib */
#ifndef SCENE_KIT_H
#define SCENE_KIT_H
/* What the tests of scene files share: a directory of their own, and a small
 * sound GLB from which each test makes its own by replacing text. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "platforms/host/scene.h"

enum { SK_PATH = 512, SK_JSON = 8192 };

/* cmocka group fixtures: *state is the directory's name. */
int sk_setup(void **state);
int sk_teardown(void **state);

/* DIR/name into out, of SK_PATH bytes. */
void sk_path(char *out, void **state, const char *name);
void sk_write(void **state, const char *name, const void *bytes, size_t size);
void sk_write_text(void **state, const char *name, const char *text);
bool sk_exists(void **state, const char *name);
/* Files in the directory. */
int sk_count(void **state);

/* The sound document, with ' for ": a square of two triangles with normals,
 * texture coordinates, one material with a texture, one spot light on a node
 * of its own, a camera. sk_bin is its binary chunk:
 *   0 positions 4 x VEC3, 48 normals 4 x VEC3, 96 texture coordinates 4 x
 *   VEC2, 128 indices 6 x u16, 140 a PNG of 2 x 2 pixels (SK_PNG bytes). */
enum { SK_AT_NORMAL = 48, SK_AT_UV = 96, SK_AT_INDEX = 128, SK_AT_PNG = 140,
       SK_BIN = 256 };
extern const char sk_good[];
void sk_bin(uint8_t bin[SK_BIN]);
/* Copy text into out, of SK_JSON bytes, with the first `find` replaced; a
 * text that does not hold it fails the test. find NULL: only copy. */
void sk_replace(char *out, const char *text, const char *find,
                const char *by);
/* A GLB of this JSON (' become ") and binary chunk (NULL: none). */
void sk_write_glb(void **state, const char *name, const char *json,
                  const uint8_t *bin, size_t bin_size);
/* All in one: replace, write NAME.glb, load; the error line goes to text (of
 * at least sizeof(struct hlh_error)), "" on success. */
bool sk_load(void **state, struct hlh_scene *out, const char *find,
             const char *by, char *text);

/* Everything that scene.h promises of any loaded scene. */
void sk_assert_promises(const struct hlh_scene *scene);
void sk_assert_contains(const char *text, const char *part);
#endif
