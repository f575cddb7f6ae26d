/* SPDX-License-Identifier: Zlib */
/* OBJ through assimp, which triangulates polygons. assimp is handed a text of
 * our own making: only v, vt, vn, f, o, g and usemtl lines, whose numbers are
 * finite and whose indices exist, so that nothing it trusts can hurt it and
 * no mtllib makes it open a file. Surfaces have one material whatever an mtl
 * says (design section 4), and are never culled. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <assimp/cimport.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include "platforms/host/image.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/scene_file.h"
#include "platforms/host/util.h"

/* Ear clipping is quadratic in a polygon's corners, and worse. */
enum { POLYGON_LIMIT = 1024, NAME_LIMIT = 64 };
#define CORNER_LIMIT ((uint64_t)1 << 26)

enum { POSITION, TEXTURE, NORMAL, N_KINDS };
static const char *const kind_key[N_KINDS] = {"v", "vt", "vn"};

struct obj {
    const char *file;
    struct hlh_error *error;
    uint32_t line;
    uint32_t total[N_KINDS], met[N_KINDS];
    unsigned char *broken;            /* per position: is not finite         */
    uint64_t corners;
    uint32_t faces, dropped;
    struct hlh_buffer out;
};

static bool blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

static char *skip(char *s)
{
    while (blank(*s))
        s++;
    return s;
}

/* The next line, ended by 0 in place, continuation lines (backslash) joined;
 * NULL at the end. */
static char *next_line(struct obj *o, char **at, char *end)
{
    char *line = *at, *s = line;
    if (s >= end)
        return NULL;
    for (o->line++; s < end && *s != '\n'; s++) {
        bool joins = s[0] == '\\' &&
                     (s[1] == '\n' || (s[1] == '\r' && s[2] == '\n'));
        if (joins) {
            *s = ' ';
            s += s[1] == '\r';
            *s = ' ';
            s[1] = ' ';
            o->line++;
        } else if (!*s) {
            *s = ' ';
        }
    }
    *at = s + 1;
    *s = 0;
    return skip(line);
}

/* The text behind the keyword, or NULL. */
static char *keyword(char *line, const char *key)
{
    size_t n = strlen(key);
    if (strncmp(line, key, n) != 0 || (line[n] && !blank(line[n])))
        return NULL;
    return skip(line + n);
}

/* "v 1 2 3", with what is not finite as 0; at least `least` numbers. */
static bool vector(struct obj *o, char *s, int kind)
{
    const int least = kind == TEXTURE ? 1 : 3, most = kind == TEXTURE ? 2 : 3;
    float v[3] = {0, 0, 0};
    bool finite = true;
    int n = 0;
    while (n < most && *s) {
        char *end;
        v[n] = (float)strtod(s, &end);
        if (end == s || (*end && !blank(*end)))
            return hlh_fail(o->error, o->file, "line %u: %s: \"%.20s\" is not "
                            "a number", (unsigned)o->line, kind_key[kind], s);
        finite = finite && isfinite(v[n]);
        n++;
        s = skip(end);
    }
    if (n < least)
        return hlh_fail(o->error, o->file, "line %u: %s: has %d of %d numbers",
                        (unsigned)o->line, kind_key[kind], n, least);
    if (!finite)
        v[0] = v[1] = v[2] = 0;
    if (kind == POSITION)
        o->broken[o->met[POSITION]] = !finite;
    o->met[kind]++;
    hlh_buffer_print(&o->out, "%s %.9g %.9g", kind_key[kind], v[0], v[1]);
    if (kind != TEXTURE)
        hlh_buffer_print(&o->out, " %.9g", v[2]);
    hlh_buffer_add(&o->out, "\n", 1);
    return true;
}

/* One index of a corner, made absolute; 1 is the first. */
static bool index_of(struct obj *o, char **at, int kind, uint32_t *out)
{
    char *end;
    long long v;
    if (**at != '-' && !isdigit((unsigned char)**at))
        return hlh_fail(o->error, o->file, "line %u: f: \"%.20s\" is not an "
                        "index", (unsigned)o->line, *at);
    v = strtoll(*at, &end, 10);
    if (end == *at)
        return hlh_fail(o->error, o->file, "line %u: f: \"%.20s\" is not an "
                        "index", (unsigned)o->line, *at);
    if (v < 0 && v >= -(long long)o->met[kind])
        v += (long long)o->met[kind] + 1;
    if (v < 1 || v > o->total[kind])
        return hlh_fail(o->error, o->file, "line %u: f: %s %.*s does not "
                        "exist, there are %u", (unsigned)o->line,
                        kind_key[kind], (int)(end - *at < 20 ? end - *at : 20),
                        *at, (unsigned)o->total[kind]);
    *out = (uint32_t)v;
    *at = end;
    return true;
}

/* v, v/vt, v//vn or v/vt/vn; an index that is absent is 0. */
static bool corner(struct obj *o, char **at, uint32_t out[N_KINDS])
{
    out[TEXTURE] = out[NORMAL] = 0;
    if (!index_of(o, at, POSITION, &out[POSITION]))
        return false;
    if (**at == '/') {
        ++*at;
        if (**at != '/' && **at && !blank(**at) &&
            !index_of(o, at, TEXTURE, &out[TEXTURE]))
            return false;
        if (**at == '/') {
            ++*at;
            if (**at && !blank(**at) &&
                !index_of(o, at, NORMAL, &out[NORMAL]))
                return false;
        }
    }
    if (**at && !blank(**at))
        return hlh_fail(o->error, o->file, "line %u: f: \"%.20s\" follows a "
                        "corner", (unsigned)o->line, *at);
    *at = skip(*at);
    return true;
}

static void print_corner(struct obj *o, const uint32_t c[N_KINDS],
                         bool texture, bool normal)
{
    hlh_buffer_print(&o->out, " %u", (unsigned)c[POSITION]);
    if (texture)
        hlh_buffer_print(&o->out, "/%u", (unsigned)c[TEXTURE]);
    else if (normal)
        hlh_buffer_print(&o->out, "/");
    if (normal)
        hlh_buffer_print(&o->out, "/%u", (unsigned)c[NORMAL]);
}

static bool face(struct obj *o, char *s)
{
    uint32_t c[POLYGON_LIMIT][N_KINDS];
    bool texture = true, normal = true, broken = false;
    uint32_t n = 0;
    while (*s) {
        if (n == POLYGON_LIMIT)
            return hlh_fail(o->error, o->file, "line %u: f: has more than %d "
                            "corners", (unsigned)o->line, POLYGON_LIMIT);
        if (!corner(o, &s, c[n]))
            return false;
        texture = texture && c[n][TEXTURE];
        normal = normal && c[n][NORMAL];
        broken = broken || o->broken[c[n][POSITION] - 1];
        n++;
    }
    if (n < 3)
        return hlh_fail(o->error, o->file, "line %u: f: has %u corners",
                        (unsigned)o->line, (unsigned)n);
    o->corners += n;
    if (o->corners > CORNER_LIMIT)
        return hlh_fail(o->error, o->file, "line %u: f: there are more than "
                        "2^26 corners", (unsigned)o->line);
    if (broken) {
        o->dropped += n - 2;
        return true;
    }
    hlh_buffer_print(&o->out, "f");
    for (uint32_t i = 0; i < n; i++)
        print_corner(o, c[i], texture, normal);
    hlh_buffer_print(&o->out, "\n");
    o->faces++;
    return true;
}

/* Names only separate; anything unusual becomes an underscore. */
static void name(struct obj *o, const char *key, const char *s)
{
    char clean[NAME_LIMIT + 1];
    size_t n = 0;
    for (; *s && n < NAME_LIMIT; s++)
        clean[n++] = isalnum((unsigned char)*s) || *s == '.' || *s == '-'
                         ? *s : '_';
    clean[n] = 0;
    hlh_buffer_print(&o->out, "%s %s\n", key, n ? clean : "default");
}

static bool statement(struct obj *o, char *line)
{
    static const char *const names[] = {"o", "g", "usemtl"};
    char *rest;
    for (int k = 0; k < N_KINDS; k++)
        if ((rest = keyword(line, kind_key[k])))
            return vector(o, rest, k);
    if ((rest = keyword(line, "f")))
        return face(o, rest);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if ((rest = keyword(line, names[k])))
            name(o, names[k], rest);
    return true;
}

/* Once over the text to count, once to check and to write; next_line ends
 * lines in place, so each pass has a text of its own. */
static bool sanitise(struct obj *o, char *text, size_t size)
{
    char *copy = hlh_alloc(size + 2, 1), *at = copy, *line;
    bool ok = true;
    if (!copy)
        return hlh_fail(o->error, o->file, "out of memory");
    memcpy(copy, text, size);
    copy[size] = copy[size + 1] = 0;
    while ((line = next_line(o, &at, copy + size)))
        for (int k = 0; k < N_KINDS; k++)
            o->total[k] += keyword(line, kind_key[k]) != NULL;
    o->line = 0;
    memcpy(copy, text, size);
    copy[size] = copy[size + 1] = 0;
    at = copy;
    o->broken = hlh_alloc_zero(o->total[POSITION], 1);
    if (!o->broken)
        ok = hlh_fail(o->error, o->file, "out of memory");
    while (ok && (line = next_line(o, &at, copy + size)))
        ok = statement(o, line);
    free(copy);
    if (ok && o->out.failed)
        ok = hlh_fail(o->error, o->file, "out of memory");
    if (ok && !o->faces)
        ok = hlh_fail(o->error, o->file, "has no faces to draw");
    return ok;
}

static void convert_vertex(const struct aiMesh *in, uint32_t i,
                           struct hlh_vertex *v)
{
    memset(v, 0, sizeof *v);
    v->position[0] = in->mVertices[i].x;
    v->position[1] = in->mVertices[i].y;
    v->position[2] = in->mVertices[i].z;
    if (in->mNormals) {
        v->normal[0] = in->mNormals[i].x;
        v->normal[1] = in->mNormals[i].y;
        v->normal[2] = in->mNormals[i].z;
    }
    /* OBJ counts v upwards. */
    if (in->mTextureCoords[0]) {
        v->uv[0] = in->mTextureCoords[0][i].x;
        v->uv[1] = 1 - in->mTextureCoords[0][i].y;
    }
    for (int k = 0; k < 4; k++)
        v->color[k] = 1;
}

static bool convert_mesh(struct hlh_scene *s, const struct aiMesh *in,
                         struct hlh_mesh *mesh)
{
    uint32_t n = 0;
    mesh->vertices = hlh_alloc(in->mNumVertices, sizeof *mesh->vertices);
    mesh->indices = hlh_alloc((size_t)in->mNumFaces * 3,
                              sizeof *mesh->indices);
    mesh->name = hlh_strdup(in->mName.length ? in->mName.data : "mesh");
    if (!mesh->vertices || !mesh->indices || !mesh->name)
        return false;
    mesh->n_vertices = in->mNumVertices;
    mesh->has_uv = in->mTextureCoords[0] != NULL;
    for (uint32_t i = 0; i < in->mNumVertices; i++)
        convert_vertex(in, i, &mesh->vertices[i]);
    for (uint32_t f = 0; f < in->mNumFaces; f++) {
        const struct aiFace *face = &in->mFaces[f];
        if (face->mNumIndices != 3)
            continue;
        for (int k = 0; k < 3; k++)
            mesh->indices[n++] = face->mIndices[k];
    }
    mesh->n_indices = n;
    return hlh_mesh_merge(mesh) &&
           hlh_mesh_clean(mesh, in->mNormals != NULL, s);
}

static bool convert(struct hlh_scene *s, const struct aiScene *in)
{
    struct hlh_material *m =
        hlh_push(&s->materials, &s->n_materials, sizeof *m);
    if (!m)
        return false;
    hlh_material_default(m);
    m->base_color[0] = m->base_color[1] = m->base_color[2] = 0.8f;
    m->metallic = 0;
    m->roughness = 0.5f;
    m->double_sided = true;
    m->name = hlh_strdup("obj");
    if (!m->name)
        return false;
    for (uint32_t i = 0; i < in->mNumMeshes; i++) {
        struct hlh_mesh *mesh =
            hlh_push(&s->meshes, &s->n_meshes, sizeof *mesh);
        struct hlh_object *object;
        if (!mesh || !convert_mesh(s, in->mMeshes[i], mesh))
            return false;
        object = hlh_push(&s->objects, &s->n_objects, sizeof *object);
        if (!object)
            return false;
        object->mesh = s->n_meshes - 1;
        for (int k = 0; k < 16; k += 5)
            object->world[k] = 1;
    }
    return true;
}

static bool import(struct hlh_scene *out, struct obj *o)
{
    const struct aiScene *scene;
    bool ok;
    if (o->out.size > UINT32_MAX)
        return hlh_fail(o->error, o->file, "is longer than 4 GiB");
    scene = aiImportFileFromMemory(o->out.bytes, (unsigned)o->out.size,
                                   aiProcess_Triangulate, "obj");
    if (!scene)
        return hlh_fail(o->error, o->file, "OBJ: %s", aiGetErrorString());
    ok = convert(out, scene);
    aiReleaseImport(scene);
    if (!ok)
        return hlh_fail(o->error, o->file, "out of memory");
    out->triangles_dropped += o->dropped;
    return true;
}

bool hlh_obj_load(struct hlh_scene *out, const char *path,
                  struct hlh_error *error)
{
    struct obj o = {0};
    size_t size;
    char *text;
    bool ok;
    o.file = path;
    o.error = error;
    if (!hlh_file_read(&text, &size, path, error))
        return false;
    ok = sanitise(&o, text, size) && import(out, &o);
    free(text);
    free(o.broken);
    hlh_buffer_free(&o.out);
    return ok;
}
