/* SPDX-License-Identifier: Zlib */
#ifndef SHADOW_KIT_H
#define SHADOW_KIT_H
/* What the tests of shadow volumes share, and two oracles that share nothing
 * with the volumes but the mesh: how often a volume winds about a point
 * (signed crossings of a ray through the emitted triangles) is how many faces
 * lit from their front lie between the point and the light (each tried). */
#include "core/shadow_volume.h"
#include "tests/check.h"

struct sv_rig {
    struct mk_memory memory;
    struct hl_hooks hooks;
    struct mk_mesh input;
    struct hl_shadow_mesh mesh;
    uint32_t *indices, n;
    void *scratch;
    struct hl_shadow_counts counts;
    float light[4];
    unsigned parts;
    uint64_t random;
};

struct sv_seen { uint32_t tried, in_shadow, deeper; };

/* cmocka's; teardown releases all and fails when the hooks miss something. */
int sv_setup(void **state);
int sv_teardown(void **state);
/* Release the input and what was made of it. */
void sv_drop(struct sv_rig *);
/* Prepare the input; room for any volume of it. */
void sv_prepare(struct sv_rig *);
/* The volume of the light and parts, into room for no index more than
 * promised. */
void sv_cast(struct sv_rig *);
void sv_random_light(struct sv_rig *, float w);
/* The closed volume is a closed chain, with no side too many. */
void sv_check_chain(const struct sv_rig *);
/* Prepare, and compare the oracles for so many lights of either kind, one in
 * four on both sides of faces, and points for each. */
struct sv_seen sv_compare(struct sv_rig *, uint32_t lights, uint32_t points);
double sv_length(const double v[3]);
#endif
