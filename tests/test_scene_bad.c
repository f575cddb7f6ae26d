/* SPDX-License-Identifier: Zlib */
/* Broken and hostile scene files: each is refused with one line that names
 * the place, and nothing is read that is not there (run under the address
 * sanitizer for the second half of that). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "platforms/host/image.h"
#include "tests/scene_kit.h"

static void the_sound_document_loads(void **state)
{
    struct hlh_scene s;
    char text[512];
    if (!sk_load(state, &s, NULL, NULL, text))
        fail_msg("%s", text);
    sk_assert_promises(&s);
    assert_int_equal(s.n_triangles, 2);
    hlh_scene_free(&s);
}

struct bad {
    const char *find, *by, *expect;
};

static void refuse_all(void **state, const struct bad *bad, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct hlh_scene s;
        char text[512];
        if (sk_load(state, &s, bad[i].find, bad[i].by, text))
            fail_msg("%s -> %s was taken", bad[i].find, bad[i].by);
        sk_assert_contains(text, "kit.glb: ");
        sk_assert_contains(text, bad[i].expect);
        assert_null(strchr(text, '\n'));
        /* *out is zeroed: freeing it again would do no harm. */
        assert_null(s.meshes);
        assert_int_equal(s.n_meshes, 0);
        hlh_scene_free(&s);
    }
}

#define REFUSE(table) refuse_all(state, table, sizeof table / sizeof *table)

static void ranges_are_refused(void **state)
{
    static const struct bad table[] = {
        {"'VEC3','count':4}", "'VEC3','count':5}",
         "accessors[0]: ends at byte 60 of bufferViews[0], which has 48"},
        {"'byteOffset':128,'byteLength':12", "'byteOffset':250,"
         "'byteLength':12",
         "bufferViews[3]: ends at byte 262 of buffers[0], which has 256"},
        {"[{'byteLength':256}]", "[{'byteLength':257}]",
         "buffers[0].byteLength: is 257, but there are only 256"},
        {"'VEC3','count':4}", "'VEC3','count':4294967290}",
         "accessors[0]: ends at byte 51539607480 of bufferViews[0]"},
        {"'VEC3','count':4}", "'VEC3','count':1e300}", "accessors[0].count"},
        {"'VEC3','count':4}", "'VEC3','count':-4}", "accessors[0].count"},
        {"'VEC3','count':4}", "'VEC3','count':0}", "accessors[0].count"},
        {"'VEC3','count':4}", "'VEC3','count':3.5}", "accessors[0].count"},
        {"'VEC3','count':4}", "'VEC3','count':'4'}", "accessors[0].count"},
        {"'VEC3','count':4}", "'VEC3'}", "accessors[0].count: is missing"},
        {"'VEC3','count':4}", "'VEC3','count':4,'byteOffset':1}",
         "accessors[0]: ends at byte 49"},
        {"'VEC3','count':4}", "'VEC3','count':4,"
         "'byteOffset':9007199254740992}", "accessors[0]: ends at byte"},
        {"'byteOffset':48,", "'byteOffset':9007199254740992,",
         "bufferViews[1]: ends at byte"},
        {"'byteOffset':48,", "'byteOffset':-48,", "bufferViews[1].byteOffset"},
        {"'byteLength':48}", "'byteLength':48,'byteStride':8}",
         "accessors[0]: elements of 12 bytes are 8 apart"},
        {"'byteLength':48}", "'byteLength':48,'byteStride':16}",
         "accessors[0]: ends at byte 60"},
        {"'byteLength':48}", "'byteLength':48,'byteStride':13}",
         "bufferViews[0].byteStride: is 13"},
        {"'byteLength':48}", "'byteLength':48,'byteStride':256}",
         "bufferViews[0].byteStride"},
        {"'byteLength':48}", "'byteLength':48,'byteStride':0}",
         "bufferViews[0].byteStride"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0}",
         "bufferViews[0].byteLength: is missing"},
        {"{'buffer':0,'byteLength':48}", "{'byteLength':48}",
         "bufferViews[0].buffer: is missing"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':1,'byteLength':48}",
         "bufferViews[0].buffer: is 1, but there are 1 buffers"},
        {"{'bufferView':0,", "{'bufferView':5,",
         "accessors[0].bufferView: is 5, but there are 5 bufferViews"},
        {"{'bufferView':0,", "{'bufferView':4294967296,",
         "accessors[0].bufferView"},
        {"{'bufferView':0,", "{", "has no triangles"},
        {"{'bufferView':0,'componentType':5126,'type':'VEC3','count':4}",
         "{'componentType':5126,'type':'VEC3','count':4000000000}",
         "accessors[0].count"},
    };
    REFUSE(table);
}

static void types_are_refused(void **state)
{
    static const struct bad table[] = {
        {"5126", "5124", "accessors[0].componentType: is 5124"},
        {"5126", "5127", "accessors[0].componentType"},
        {"'componentType':5126,", "", "accessors[0].componentType: is "
         "missing"},
        {"'type':'VEC3'", "'type':'VEC5'", "accessors[0].type: is \"VEC5\""},
        {"'type':'VEC3'", "'type':3", "accessors[0].type: is not a string"},
        {"'type':'VEC3',", "", "accessors[0].type: is missing"},
        {"'type':'VEC3'", "'type':'VEC2'",
         "meshes[0].primitives[0].POSITION: accessors[0] has 2 components"},
        {"5126", "5125", "POSITION: accessors[0] holds 32-bit integers"},
        {"5123,'type':'SCALAR'", "5122,'type':'SCALAR'",
         "indices: accessors[3] does not hold unsigned scalars"},
        {"5123,'type':'SCALAR','count':6", "5123,'type':'VEC2','count':3",
         "indices: accessors[3] does not hold unsigned scalars"},
        {"5123,'type':'SCALAR'", "5123,'normalized':true,'type':'SCALAR'",
         "indices: accessors[3] does not hold unsigned scalars"},
        {"'componentType':5126", "'normalized':1,'componentType':5126",
         "accessors[0].normalized: is not true or false"},
    };
    REFUSE(table);
}

static void meshes_are_refused(void **state)
{
    static const struct bad table[] = {
        {"'POSITION':0,", "", "meshes[0].primitives[0]: has no POSITION"},
        {"'POSITION':0", "'POSITION':4", "POSITION: is 4, but there are 4 "
         "accessors"},
        {"'NORMAL':1", "'NORMAL':-1", "NORMAL: is -1"},
        {"'NORMAL':1", "'JOINTS_0':9", "JOINTS_0: is 9"},
        {"'indices':3", "'indices':3.5", "indices: is 3.5"},
        {"'material':0", "'material':1", "material: is 1, but there are 1 "
         "materials"},
        {"'mode':4", "'mode':7", "mode: is 7"},
        {"'SCALAR','count':6", "'SCALAR','count':5",
         "has 5 corners, not a multiple of 3"},
        {"'primitives':[", "'primitives':[1,", "primitives[0]: is not an "
         "object"},
        {"'VEC2','count':4", "'VEC2','count':3",
         "TEXCOORD_0: accessors[2] has 3 elements, POSITION has 4"},
        {"'mode':4", "'mode':1", "has no triangles"},
        {"[{'mesh':0,'children':[1]}", "[{'children':[1]}",
         "has no triangles"},
        {"'meshes':[{'name':'square','primitives':[", "'meshes':[{},"
         "{'primitives':[", "meshes[0]: has no primitives"},
        {"'meshes':[", "'meshes':[1,", "meshes[0]: is not an object"},
        {"'meshes':[", "'meshes':{},'x':[", "meshes: is not an array"},
    };
    REFUSE(table);
}

static void materials_and_images_are_refused(void **state)
{
    static const struct bad table[] = {
        {"'metallicFactor':0.25", "'metallicFactor':-0.25",
         "materials[0].pbrMetallicRoughness.metallicFactor: is -0.25"},
        {"'roughnessFactor':0.5", "'roughnessFactor':1e999",
         "roughnessFactor: is not a finite number"},
        {"'roughnessFactor':0.5", "'roughnessFactor':2",
         "roughnessFactor: is 2"},
        {"[0.5,0.25,1,1]", "[0.5,0.25,1]", "baseColorFactor: has 3 numbers, "
         "not 4"},
        {"[0.5,0.25,1,1]", "[0.5,0.25,-1,1]", "baseColorFactor: is -1"},
        {"'emissiveFactor':[0,0,0.5]", "'emissiveFactor':[0,0,-0.5]",
         "materials[0].emissiveFactor: is -0.5"},
        {"'emissiveFactor'", "'alphaMode':'SOLID','emissiveFactor'",
         "materials[0].alphaMode: is \"SOLID\""},
        {"'emissiveFactor'", "'alphaCutoff':-1,'emissiveFactor'",
         "materials[0].alphaCutoff: is -1"},
        {"'emissiveFactor'", "'doubleSided':1,'emissiveFactor'",
         "materials[0].doubleSided"},
        {"{'index':0}", "{'index':1}", "baseColorTexture.index: is 1, but "
         "there are 1 textures"},
        {"{'index':0}", "{}", "baseColorTexture.index: is missing"},
        {"{'index':0}", "{'index':0,'extensions':{'KHR_texture_transform':"
         "{'scale':[1]}}}", "baseColorTexture.scale: has 1 numbers"},
        {"'source':0", "'source':1", "textures[0].source: is 1"},
        {"'source':0,", "", "textures[0]: names no PNG or JPEG image"},
        {"'sampler':0", "'sampler':1", "textures[0].sampler: is 1"},
        {"'wrapS':33071", "'wrapS':33072", "samplers[0].wrapS: is 33072"},
        {"[{'bufferView':4,", "[{'bufferView':5,", "images[0].bufferView: is "
         "5"},
        {"[{'bufferView':4,", "[{'bufferView':0,",
         "images[0]: is neither a PNG nor a JPEG image"},
        {"[{'bufferView':4,", "[{", "images[0]: has neither a uri nor a "
         "bufferView"},
        {"'byteOffset':140,'byteLength':75", "'byteOffset':140,"
         "'byteLength':60", "images[0]: PNG: the file is truncated"},
        {"[{'bufferView':4,", "[{'uri':'gone.png',",
         "images[0].uri: \"gone.png\" cannot be opened: No such file"},
    };
    REFUSE(table);
}

static void nodes_are_refused(void **state)
{
    static const struct bad table[] = {
        {"'scene':0,", "'scene':1,", "scene: is 1, but there are 1 scenes"},
        {"'scene':0,", "'scene':'0',", "scene: is not a number"},
        {"'nodes':[0,2]", "'nodes':[0,3]", "scenes[0].nodes[1]: is 3"},
        {"'nodes':[0,2]", "'nodes':[0,0]", "draw nodes[0] twice"},
        {"'nodes':[0,2]", "'nodes':[0,1]", "draw nodes[1] twice"},
        {"'children':[1]", "'children':[3]", "nodes[0].children[0]: is 3"},
        {"'children':[1]", "'children':[0]", "nodes[0]: is its own ancestor"},
        {"'children':[1]", "'children':[1,1]", "nodes[1] is a child of "
         "nodes[0] already"},
        {"{'translation':[0,0,3]", "{'children':[0],'translation':[0,0,3]",
         "is its own ancestor"},
        {"[{'mesh':0", "[{'mesh':1", "nodes[0].mesh: is 1"},
        {"{'camera':0", "{'camera':1", "nodes[2].camera: is 1"},
        {"{'light':0}", "{'light':1}", "nodes[1].light: is 1, but there are "
         "1 lights"},
        {"'translation':[0,0,3]", "'translation':[0,0,1e999]",
         "nodes[1].translation[2]: is not a finite number"},
        {"'translation':[0,0,3]", "'rotation':[0,0,0,0]",
         "nodes[1].rotation: is not a rotation"},
        {"[{'mesh':0", "[{'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,0],"
         "'mesh':0", "nodes[0].matrix: its last row"},
        {"[{'mesh':0", "[{'matrix':[1,0,0,0],'mesh':0",
         "nodes[0].matrix: has 4 numbers, not 16"},
        {"[{'mesh':0", "[{'scale':[1e200,1e200,1e200],'mesh':0",
         "nodes[0]: its world matrix"},
        {"[{'mesh':0", "[{'translation':[1e20,0,0],'mesh':0",
         "farther than 1e12 metres"},
        {"[{'mesh':0,'children':[1]", "[{'scale':[1,0,0],'mesh':0",
         "has no triangles"},
    };
    REFUSE(table);
}

static void lights_and_cameras_are_refused(void **state)
{
    static const struct bad table[] = {
        {"'range':5", "'range':-5", "lights[0].range: is negative: -5"},
        {"'range':5", "'range':1e999", "lights[0].range: is not a finite"},
        {"'range':5", "'range':null", "lights[0].range: is not a finite"},
        {"'intensity':10", "'intensity':-10", "intensity: is negative: -10"},
        {"'intensity':10", "'intensity':1e40", "brighter than 1e30"},
        {"[1,0.5,0.25]", "[1,-0.5,0.25]", "color: is negative: -0.5"},
        {"[1,0.5,0.25]", "[1,0.5]", "color: has 2 numbers"},
        {"'type':'spot'", "'type':'area'", "type: is \"area\""},
        {"'type':'spot',", "", "lights[0].type"},
        {"'innerConeAngle':0.1", "'innerConeAngle':0.6",
         "spot: angles are 0.6 and 0.5"},
        {"'outerConeAngle':0.5", "'outerConeAngle':2", "spot: angles are"},
        {"'innerConeAngle':0.1", "'innerConeAngle':-0.1", "spot: angles"},
        {"'translation':[0,0,3]", "'translation':[0,0,1e13]",
         "nodes[1]: its light or camera is farther than 1e12"},
        {"'translation':[0,0,3]", "'scale':[0,0,0]", "nodes[1]: is scaled to "
         "nothing"},
        {"'yfov':1", "'yfov':0", "cameras[0].perspective.yfov: is 0"},
        {"'yfov':1", "'yfov':-1", "cameras[0].perspective.yfov"},
        {"'yfov':1", "'yfov':3.2", "cameras[0].perspective.yfov"},
        {"'yfov':1", "'yfov':1,'aspectRatio':-1", "aspectRatio: is -1"},
        {"'type':'perspective'", "'type':'fisheye'", "cameras[0].type"},
    };
    REFUSE(table);
}

static void documents_are_refused(void **state)
{
    static const struct bad table[] = {
        {"{'asset'", "['asset'", "JSON: is broken at byte"},
        {"'version':'2.0'", "'version':'1.0'", "asset.version: is \"1.0\""},
        {"'version':'2.0'", "'minVersion':'2.1','version':'2.1'",
         "asset.minVersion: is \"2.1\""},
        {"'asset'", "'asses'", "asset: is missing"},
        {"'asset'", "'extensionsRequired':['KHR_draco_mesh_compression'],"
         "'asset'", "extensionsRequired[0]: the file needs "
         "KHR_draco_mesh_compression, which is not supported"},
        {"'asset'", "'extensionsRequired':['KHR_materials_unlit',"
         "'EXT_meshopt_compression'],'asset'",
         "extensionsRequired[1]: the file needs EXT_meshopt_compression"},
        {"'asset'", "'extensionsRequired':['KHR_texture_basisu'],'asset'",
         "KHR_texture_basisu"},
        {"'asset'", "'extensionsRequired':"
         "['KHR_materials_pbrSpecularGlossiness'],'asset'",
         "KHR_materials_pbrSpecularGlossiness"},
        {"'asset'", "'extensionsRequired':[1],'asset'",
         "extensionsRequired[0]: is not a string"},
        {"'asset'", "'extensionsRequired':['a\\nb'],'asset'",
         "needs a?b, which"},
        {"[{'byteLength':256}]", "[{'byteLength':256},{'byteLength':4}]",
         "buffers[1]: has neither a uri nor the GLB's binary chunk"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'../a.bin'}]",
         "buffers[0].uri: \"../a.bin\" is not a file beside"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'a/../../b'}]",
         "is not a file beside"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'%2e%2e/b'}]",
         "is not a file beside"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'/etc/passwd'}]",
         "is not a file beside"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'http://a/b'}]",
         "is not a file beside"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'gone%20a.bin'}]",
         "buffers[0].uri: \"gone a.bin\" cannot be opened: No such file"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'a%0'}]",
         "buffers[0].uri: is not a valid URI"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'a%00b'}]",
         "buffers[0].uri: is not a valid URI"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'.'}]",
         "buffers[0].uri"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':"
         "'data:application/octet-stream;base64,AAA*'}]",
         "buffers[0].uri: its base64 is broken"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':'data:,AAAA'}]",
         "buffers[0].uri: is a data: URI without"},
        {"[{'byteLength':256}]", "[{'byteLength':256,'uri':"
         "'data:;base64,AAAA'}]", "is 256, but there are only 3 bytes"},
    };
    REFUSE(table);
}

static void sparse_accessors_are_refused(void **state)
{
#define SPARSE(count, view, at, type) \
    "'VEC3','count':4,'sparse':{'count':" count ",'indices':{'bufferView':" \
    view ",'byteOffset':" at ",'componentType':" type "},'values':{" \
    "'bufferView':1}}}"
    static const struct bad table[] = {
        {"'VEC3','count':4}", SPARSE("5", "3", "0", "5123"),
         "accessors[0].sparse.count: is 5"},
        {"'VEC3','count':4}", SPARSE("0", "3", "0", "5123"),
         "accessors[0].sparse.count: is 0"},
        {"'VEC3','count':4}", SPARSE("4", "3", "0", "5126"),
         "indices.componentType: is 5126"},
        {"'VEC3','count':4}", SPARSE("4", "3", "6", "5123"),
         "accessors[0].sparse: ends at byte 14"},
        {"'VEC3','count':4}", SPARSE("4", "1", "0", "5125"),
         "sparse.indices: element 2 is 1065353216, but the accessor has 4"},
        {"'VEC3','count':4}", SPARSE("4", "7", "0", "5125"),
         "accessors[0].sparse.bufferView: is 7"},
        {"'VEC3','count':4}", "'VEC3','count':4,'sparse':{'count':1}}",
         "accessors[0].sparse.indices: is missing"},
    };
    REFUSE(table);
}

/* Bytes of the binary chunk, not of the JSON. */
static void an_index_past_its_buffer_is_refused(void **state)
{
    uint8_t bin[SK_BIN];
    char path[SK_PATH];
    struct hlh_scene s;
    struct hlh_error e;
    sk_bin(bin);
    bin[SK_AT_INDEX + 8] = 4;
    sk_write_glb(state, "index.glb", sk_good, bin, sizeof bin);
    sk_path(path, state, "index.glb");
    assert_false(hlh_scene_load(&s, path, &e));
    sk_assert_contains(e.text, "index.glb: meshes[0].primitives[0].indices: "
                       "element 4 of accessors[3] is 4, but there are 4 "
                       "vertices");
    bin[SK_AT_INDEX + 8] = 1;
    bin[SK_AT_INDEX + 11] = 255;
    sk_write_glb(state, "index.glb", sk_good, bin, sizeof bin);
    assert_false(hlh_scene_load(&s, path, &e));
    sk_assert_contains(e.text, "element 5 of accessors[3] is 65283");
}

/* Every prefix of a GLB, and every one-byte change of its container. */
static void truncated_and_bent_containers_never_crash(void **state)
{
    uint8_t bin[SK_BIN], *glb;
    char path[SK_PATH], *bytes;
    struct hlh_scene s;
    struct hlh_error e;
    size_t size;
    sk_bin(bin);
    sk_write_glb(state, "whole.glb", sk_good, bin, sizeof bin);
    sk_path(path, state, "whole.glb");
    assert_true(hlh_file_read(&bytes, &size, path, &e));
    sk_path(path, state, "bent.glb");
    for (size_t n = 0; n < size; n += n < 64 ? 1 : 37) {
        sk_write(state, "bent.glb", bytes, n);
        assert_false(hlh_scene_load(&s, path, &e));
        sk_assert_contains(e.text, "GLB header: ");
        if (n >= 12)
            sk_assert_contains(e.text, "the file is truncated");
    }
    glb = malloc(size);
    assert_non_null(glb);
    for (size_t i = 0; i < 20; i++)
        for (int bit = 0; bit < 8; bit++) {
            memcpy(glb, bytes, size);
            glb[i] ^= (uint8_t)(1 << bit);
            sk_write(state, "bent.glb", glb, size);
            if (hlh_scene_load(&s, path, &e))
                hlh_scene_free(&s);
        }
    free(glb);
    free(bytes);
}

static void container_errors_name_their_place(void **state)
{
    static const struct {
        const char *bytes;
        size_t size;
        const char *expect;
    } table[] = {
        {"", 0, "GLB header: does not start with"},
        {"glTFabcd", 8, "GLB header: is truncated"},
        {"glTF\1\0\0\0\14\0\0\0", 12, "GLB header: version 1"},
        {"glTF\2\0\0\0\14\0\0\0", 12, "leaves no room for a chunk"},
        {"glTF\2\0\0\0\24\0\0\0\4\0\0\0JSON", 20,
         "GLB chunk 0: has 4 bytes by its header, 0 are left"},
        {"glTF\2\0\0\0\30\0\0\0\4\0\0\0XXXX{}  ", 24, "GLB chunk 0: is not "
         "JSON"},
        {"glTF\2\0\0\0\30\0\0\0\4\0\0\0JSON{}  ", 24, "asset: is missing"},
        {"glTF\2\0\0\0\34\0\0\0\4\0\0\0JSON{}  abcd", 28,
         "GLB chunk 1: is truncated"},
        {"glTF\2\0\0\0\30\0\0\0\4\0\0\0JSON{} x", 24, "JSON: goes on after"},
        {"glTF\2\0\0\0\30\0\0\0\4\0\0\0JSON[]  ", 24, "JSON: is not an "
         "object"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct hlh_scene s;
        struct hlh_error e;
        char path[SK_PATH];
        sk_write(state, "bytes.glb", table[i].bytes, table[i].size);
        sk_path(path, state, "bytes.glb");
        assert_false(hlh_scene_load(&s, path, &e));
        sk_assert_contains(e.text, table[i].expect);
    }
}

static void deep_and_long_json_is_survived(void **state)
{
    enum { DEEP = 200000 };
    char *text = malloc(DEEP + 1), path[SK_PATH];
    struct hlh_scene s;
    struct hlh_error e;
    assert_non_null(text);
    memset(text, '[', DEEP);
    text[DEEP] = 0;
    sk_write_text(state, "deep.gltf", text);
    free(text);
    sk_path(path, state, "deep.gltf");
    assert_false(hlh_scene_load(&s, path, &e));
    sk_assert_contains(e.text, "JSON: is broken at byte");
}

/* 40 nodes in a chain each of scale 1e10: the product overflows. */
static void a_chain_of_nodes_cannot_overflow(void **state)
{
    char nodes[SK_JSON], rooted[SK_JSON], marked[SK_JSON], json[SK_JSON];
    size_t n = 0;
    uint8_t bin[SK_BIN];
    char path[SK_PATH];
    struct hlh_scene s;
    struct hlh_error e;
    for (int i = 3; i < 43; i++)
        n += (size_t)snprintf(nodes + n, sizeof nodes - n,
                              ",{'scale':[1e10,1e10,1e10],'children':[%d]}",
                              i + 1);
    snprintf(nodes + n, sizeof nodes - n, ",{'mesh':0}],");
    sk_replace(rooted, sk_good, "'nodes':[0,2]", "'nodes':[0,2,3]");
    sk_replace(marked, rooted, "[1,2,5]}],", "[1,2,5]}@");
    sk_replace(json, marked, "@", nodes);
    sk_bin(bin);
    sk_write_glb(state, "chain.glb", json, bin, sizeof bin);
    sk_path(path, state, "chain.glb");
    assert_false(hlh_scene_load(&s, path, &e));
    sk_assert_contains(e.text, "its world matrix is not finite");
}

/* A short run of what a long one found nothing with: numbers of the JSON are
 * replaced by extremes, bytes anywhere by noise. */
static void mutations_never_break_a_promise(void **state)
{
    static const char *const extreme[] = {
        "-1", "0", "4294967295", "1e308", "1e999", "1.5", "null", "''", "[]",
        "9007199254740993", "65535", "2"};
    enum { N_EXTREME = sizeof extreme / sizeof *extreme, RUNS = 1500 };
    uint32_t random = 12345, taken = 0;
    char path[SK_PATH];
    sk_path(path, state, "mutant.glb");
    for (int run = 0; run < RUNS; run++) {
        char json[SK_JSON];
        const char *digit = sk_good;
        uint8_t bin[SK_BIN];
        struct hlh_scene s;
        struct hlh_error e;
        size_t skip;
        sk_bin(bin);
        random = random * 1664525u + 1013904223u;
        skip = (random >> 8) % (strlen(sk_good) - 60);
        digit = strpbrk(sk_good + skip, "0123456789");
        snprintf(json, sizeof json, "%.*s%s%s", (int)(digit - sk_good),
                 sk_good, extreme[(random >> 4) % N_EXTREME],
                 digit + strspn(digit, "0123456789.e"));
        random = random * 1664525u + 1013904223u;
        bin[(random >> 8) % SK_BIN] = (uint8_t)(random >> 24);
        sk_write_glb(state, "mutant.glb", json, bin, sizeof bin);
        e.text[0] = 0;
        if (hlh_scene_load(&s, path, &e)) {
            sk_assert_promises(&s);
            hlh_scene_free(&s);
            taken++;
        } else {
            sk_assert_contains(e.text, "mutant.glb: ");
        }
    }
    /* Some mutations are harmless, or the test is vacuous. */
    assert_in_range(taken, RUNS / 50, RUNS / 2);
}

static void obj_errors_name_their_line(void **state)
{
    static const char *const table[][2] = {
        {"v 0 0\n", "line 1: v: has 2 of 3 numbers"},
        {"v 0 0 x\n", "line 1: v: \"x\" is not a number"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "has no faces to draw"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
         "line 4: f: v 4 does not exist, there are 3"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "f: v 0 does not exist"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 2 3\n", "f: v -4 does not exist"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2 3\n",
         "f: vt 1 does not exist, there are 0"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2 3\n", "f: vn 1 does not"},
        {"v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: f: has 2 corners"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3x\n", "f: \"x\" follows a corner"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf a b c\n", "f: \"a b c\" is not an "
         "index"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n",
         "does not exist"},
        {"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "has no faces to draw"},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "has no triangles"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct hlh_scene s;
        struct hlh_error e;
        char path[SK_PATH];
        sk_write_text(state, "bad.obj", table[i][0]);
        sk_path(path, state, "bad.obj");
        if (hlh_scene_load(&s, path, &e))
            fail_msg("%s was taken", table[i][0]);
        sk_assert_contains(e.text, "bad.obj: ");
        sk_assert_contains(e.text, table[i][1]);
    }
}

static void other_names_are_refused(void **state)
{
    static const char *const table[][2] = {
        {"gone.glb", "cannot be opened: No such file"},
        {"gone.gltf", "cannot be opened: No such file"},
        {"gone.obj", "cannot be opened: No such file"},
        {"picture.png", "is neither a built-in scene nor"},
        {"fig800", "is neither a built-in scene nor"},
    };
    struct hlh_scene s;
    struct hlh_error e;
    char path[SK_PATH];
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        sk_path(path, state, table[i][0]);
        assert_false(hlh_scene_load(&s, path, &e));
        sk_assert_contains(e.text, table[i][1]);
    }
    assert_false(hlh_scene_load(&s, *state, &e));
    assert_false(hlh_scene_load(&s, "", &e));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sound_document_loads),
        cmocka_unit_test(ranges_are_refused),
        cmocka_unit_test(types_are_refused),
        cmocka_unit_test(meshes_are_refused),
        cmocka_unit_test(materials_and_images_are_refused),
        cmocka_unit_test(nodes_are_refused),
        cmocka_unit_test(lights_and_cameras_are_refused),
        cmocka_unit_test(documents_are_refused),
        cmocka_unit_test(sparse_accessors_are_refused),
        cmocka_unit_test(an_index_past_its_buffer_is_refused),
        cmocka_unit_test(truncated_and_bent_containers_never_crash),
        cmocka_unit_test(container_errors_name_their_place),
        cmocka_unit_test(deep_and_long_json_is_survived),
        cmocka_unit_test(a_chain_of_nodes_cannot_overflow),
        cmocka_unit_test(mutations_never_break_a_promise),
        cmocka_unit_test(obj_errors_name_their_line),
        cmocka_unit_test(other_names_are_refused),
    };
    return cmocka_run_group_tests_name("hostile scene files", tests, sk_setup,
                                       sk_teardown);
}
