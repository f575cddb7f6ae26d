/* SPDX-License-Identifier: Zlib */
#ifndef HL_PROFILE_H
#define HL_PROFILE_H
/* A console's rules as data: what the planner keeps to, and what a backend
 * that keeps console memory does. Included by hal/caps.h; the consoles
 * themselves are in platforms/profiles, one file each. Where hardware is not
 * known, the model stated there is one that emulators agree on. */

/* Xenos texture numbers; all that is resolved is one or the other. */
enum hl_number {
    HL_NUMBER_UNSIGNED = 0,  /* n / (2^b - 1)                                */
    HL_NUMBER_SIGNED         /* max(-1, n / (2^(b-1) - 1))                   */
};
/* Byte swaps between GPU words and memory. */
enum hl_endian {
    HL_ENDIAN_NONE = 0, HL_ENDIAN_8IN16, HL_ENDIAN_8IN32, HL_ENDIAN_16IN32
};

/* How a console keeps one texture. Zero everywhere is what the console does
 * when nothing is asked. */
struct hl_console {
    uint16_t edram_tile;     /* 1 + first EDRAM tile; 0: the device's choice */
    int8_t color_exp_bias;   /* shader output times 2^bias, before the store */
    int8_t resolve_exp_bias; /* times 2^bias on the way to memory            */
    uint8_t resolve_number;  /* enum hl_number, also how it is sampled       */
    uint8_t endian;          /* enum hl_endian, of resolve and fetch         */
    uint16_t remap;          /* PlayStation 3 remap word; 0: 0xAAE4          */
};

/* One way to keep a kind of data, first usable first. */
enum hl_on {
    HL_ON_ANY = 0,
    HL_ON_CONSOLE,           /* only where caps.console_memory               */
    HL_ON_STAND_IN           /* only where not: the nearest there is         */
};
struct hl_profile_format {
    enum hl_format format;   /* NONE ends a list                             */
    enum hl_format sample_as; /* NONE = format                               */
    uint8_t on;              /* enum hl_on                                   */
    uint8_t two16;           /* HL_TWO16_* of shaders/shared/pack.h          */
    uint8_t depth_read;      /* HL_DEPTH_READ_* of block.h                   */
    float range;             /* fixed point: the largest value a blend keeps,
                              * as the shader writes it; 0: floating point   */
    float sampled;           /* what is sampled where `range` was written    */
    struct hl_console console;
};

enum { HL_PROFILE_FORMATS = 4, HL_PROFILE_NO_BLEND = 8 };

struct hl_profile {
    char name[16];           /* "native", "dx10", "xbox360", "ps3"           */
    /* Kinds of data. An empty list: the planner's own choice by caps. */
    struct hl_profile_format two16[HL_PROFILE_FORMATS];  /* normals, DSF     */
    struct hl_profile_format scalar[HL_PROFILE_FORMATS]; /* exponent         */
    struct hl_profile_format light[HL_PROFILE_FORMATS];
    struct hl_profile_format color[HL_PROFILE_FORMATS];
    struct hl_profile_format depth[HL_PROFILE_FORMATS];
    /* The console's own formats that do not blend; NONE ends. Taken from the
     * caps of machines with console_memory, where nothing stands in.        */
    enum hl_format no_blend[HL_PROFILE_NO_BLEND];
    float id_steps;          /* an id is stored as id / id_steps; 0 = 65535  */
    uint32_t samples;        /* mask of sample counts; 0: all of the machine */
    /* EDRAM; tiles 0: there is none. A tile holds width x height samples of
     * 32 bits; surfaces of 64 bits take two. */
    uint32_t edram_tiles, edram_tile_width, edram_tile_height;
    bool resolve_to_read;    /* targets are copied out before they are read  */
    bool float_taps;         /* no integer views: DSF and L-buffer are sampled
                              * as numbers, not as words                     */
    bool one_mrt_format;     /* all colour targets of a pass have one format */
    bool packed_normals;     /* normals in bytes: blending them is not
                              * blending normals                             */
    bool depth_copy_if_bound; /* a bound depth target cannot be read, not
                              * even read only                               */
    bool integer_centers;    /* Direct3D 9 pixel centres                     */
    bool big_endian;
};

/* First broken rule of a profile, which no device can be opened with and no
 * plan made for; NULL when it is sound. A name may be empty here. */
const char *hl_profile_fault(const struct hl_profile *);
/* EDRAM tiles of a target; 0 on machines without EDRAM. */
uint64_t hl_edram_tiles(const struct hl_profile *, enum hl_format format,
                        uint32_t width, uint32_t height, uint32_t samples);
#endif
