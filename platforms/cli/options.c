/* SPDX-License-Identifier: Zlib */
/* One table of options: it is read by the parser and printed as the help. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/option.h"
#include "shaders/shared/block.h"

#define R (1u << HLC_RENDER)
#define P (1u << HLC_PLAN)
#define D (1u << HLC_DEVICES)
#define S (1u << HLC_SCENE)
#define C (1u << HLC_COMPARE)
#define F (1u << HLC_CONFORM)
#define H (1u << HLC_CHART)
#define T (1u << HLC_STABILITY)
#define K (1u << HLC_CALIBRATE)
#define AT(member) offsetof(struct hlc_options, member)

static const struct hlc_option rows[] = {
    { "backend", "vulkan|gl|packemu|null", BACKEND, R | P | D | F | T | K, 0,
      0, 0,
      "default: the first that has a device; stability: packemu" },
    { "device", "N|NAME", TEXT, R | P | F | T | K, AT(device), 0, 0,
      "index or part of a name, see 'halflight devices'" },
    { "gl-context", "osmesa|egl", GL_CONTEXT, R | P | F | T | K, 0, 0, 0,
      "of --backend gl; default: osmesa, then egl" },
    { "validation", NULL, FLAG, R | P | F, AT(validation), 0, 0,
      "driver validation layers" },
    { "profile", "native|dx10|xbox360|ps3", PROFILE, R | P | F | T | K, 0, 0, 0,
      "console whose rules hold; default: the device's own" },
    { "pipeline", "auto|forward|forward-multipass|inferred|reference",
      PIPELINE, R | P, 0, 0, 0, "default: the cheapest" },
    { "size", "WxH", SIZE, R | P | H | K, AT(width), 1, HLC_SIZE_MAX,
      "pixels; default 1280x720, of chart and calibrate 640x360, of chart "
      "--fast 320x180" },
    { "light-size", "WxH", SIZE, R | P, AT(light_width), 1, HLC_SIZE_MAX,
      "of the light buffer; default 5/8 of the size" },
    { "samples", "1|2|4|8", SAMPLES, R | P, 0, 0, 0, "a pixel; default 1" },
    { "camera", "ex,ey,ez,tx,ty,tz,vfov", CAMERA, R | P, 0, 0, 0,
      "eye, target, degrees; --camera=-1,... where it begins with a minus" },
    { "near", "METRES", REAL, R | P, AT(near), 1e-6, HLC_FLOAT_RANGE, "" },
    { "far", "METRES", REAL, R | P, AT(far), 1e-6, HLC_FLOAT_RANGE,
      "default: by the scene's bounds" },
    { "lights", "FILE.csv", TEXT, R | P | S, AT(lights), 0, 0,
      "x,y,z,radius,r,g,b a line" },
    { "lights-mode", "add|replace", LIGHTS_MODE, R | P | S, 0, 0, 0,
      "what --lights does to the scene's own; default add" },
    { "ambient", "r,g,b", AMBIENT, R | P, 0, 0, 0, "linear" },
    { "background", "r,g,b", BACKGROUND, R | P, 0, 0, 0, "linear" },
    { "no-normal-maps", NULL, FLAG, R | P, AT(no_normal_maps), 0, 0, "" },
    { "no-specular", NULL, FLAG, R | P, AT(no_specular), 0, 0, "" },
    { "max-error", "E", MAX_ERROR, R | P | C, 0, 0, 0,
      "render, plan: RMS 8-bit codes that a plan may be off, by prediction; "
      "compare: largest linear difference that passes" },
    { "max-cost", "MS", REAL, R | P, AT(max_cost), 1e-6, HLC_FLOAT_RANGE,
      "that a plan may take, by prediction" },
    { "calibration", "FILE", TEXT, R | P | H, AT(calibration), 0, 0,
      "of 'halflight calibrate', to predict by" },
    { "light-path", "auto|rects|tiles|lists|volumes", LIGHT_PATH, R | P, 0,
      0, 0, "how the light pass finds its lights" },
    { "light-batch", "K", COUNT, R | P | T, AT(light_batch), 1, HL_BATCH_MAX,
      "lights a draw" },
    { "tile", "N", COUNT, R | P, AT(tile), 8, 256, "texels a side" },
    { "tile-depth", "on|off", TILE_DEPTH, R | P, 0, 0, 0,
      "may lists be bounded by depth; default on" },
    { "volume-texels", "N", COUNT, R | P, AT(volume_texels), 1, 1e9,
      "light path volumes: smaller lights get no stencil volume" },
    { "shadows", "none|volumes|maps", SHADOWS, R | P, 0, 0, 0,
      "of lights that cast them; default none, reference: drawn" },
    { "shadow-size", "N", COUNT, R | P, AT(shadow_size), 16, 8192,
      "texels a side of a shadow map; default 1024" },
    { "shadow-lights", "all|scene", SHADOW_LIGHTS, R | P, 0, 0, 0,
      "which lights cast shadows; default: those that the scene says" },
    { "translucency", "auto|forward|2x2|4x4", TRANSLUCENCY, R | P, 0, 0, 0,
      "how translucent surfaces are lit: in their draws, or stippled" },
    { "stipple", "best|user|depth|depth-free", STIPPLE, R | P, 0, 0, 0,
      "who gets which pattern; default best" },
    { "stipple-filter", "auto|cone|bilinear", STIPPLE_FILTER, R | P | T, 0, 0,
      0,
      "of light that is read through a pattern" },
    { "mask", "test|blend", MASK, R | P | S, 0, 0, 0,
      "masked surfaces: all alpha tested, or all blended; default: as the "
      "scene says" },
    { "scissor", "on|off", SCISSOR, R | P, 0, 0, 0,
      "of forward-multipass; default on" },
    { "half-pixel", "auto|none|state|vertex", HALF_PIXEL, R | P | T, 0, 0, 0,
      "who puts integer pixel centres at halves; default: the state" },
    { "light-format", "FORMAT", FORMAT, R | P | T, AT(light_format), 0, 0,
      "of the light buffer, such as RGBA16_FLOAT" },
    { "normal-format", "FORMAT", FORMAT, R | P | T, AT(normal_format), 0, 0,
      "of the normals: RG16_UNORM, RG8_UNORM or RG16_FLOAT" },
    { "ids-scheme", "unique|colored|paper", IDS_SCHEME, R | P, 0, 0, 0,
      "numbers of regions; default unique" },
    { "ids-seed", "N", COUNT, R | P, AT(ids_seed), 0, 1e9,
      "of the published scheme's random ids; default 4, one of the 9 of "
      "24 drawings that collide in sight in fig7" },
    { "dsf", "auto|off|slope|constant", DSF, R | P | T, 0, 0, 0,
      "filter of the light buffer" },
    { "fill", "auto|nearest|bilinear|depth", FILL, R | P | T, 0, 0, 0,
      "what a pixel reads whose taps are all rejected" },
    { "fetch", "auto|gather|bilinear", FETCH, R | P | T, 0, 0, 0,
      "how the filter fetches light" },
    { "centroid", "on|off", CENTROID, R | P | T, 0, 0, 0,
      "with samples: interpolate where the surface covers; default on" },
    { "motion", NULL, FLAG, R | P, AT(motion), 0, 0,
      "a channel of motion vectors" },
    { "jitter", "X,Y", JITTER, R | P, 0, 0, 0,
      "pixels that the picture moves right and down, -1 to 1" },
    { "part", "WxH", SIZE, R, AT(part_width), 1, HLC_SIZE_MAX,
      "of the size that is drawn, from the top left on" },
    { "dsf-k", "K", REAL, R | P | T, AT(dsf_k), 1e-3, 1e3,
      "slope factor; 1.1 at least keeps a tilted surface whole" },
    { "dsf-c", "C", REAL, R | P | T, AT(dsf_c), 1e-9, 1, "share of depth" },
    { "dsf-tau", "T", REAL, R | P, AT(dsf_tau), 1e-9, 1,
      "constant threshold, share of depth" },
    { "out", "FILE", TEXT, R | S | H | T | K, AT(out), 0, 0,
      "render: PNG; scene: prefix of the files; calibrate: FILE; chart, "
      "stability: folder" },
    { "machines", "LIST", TEXT, H, AT(machines), 0, 0,
      "backends and profiles, such as vulkan,packemu:ps3; default vulkan, "
      "packemu and its profiles" },
    { "fast", NULL, FLAG, H | T, AT(fast), 0, 0,
      "fewer points, smaller pictures: under two minutes" },
    { "rounds", "N", ROUNDS, H, AT(rounds), 0, 1000,
      "timed rounds a point, against one baseline in turn; 0: no times" },
    { "fresh", NULL, FLAG, H, AT(afresh), 0, 0,
      "begin anew where an unfinished sweep could be gone on with" },
    { "check", "FILE", TEXT, H | T, AT(check), 0, 0,
      "of --save: what became worse than in it is a failure" },
    { "save", "FILE", TEXT, H | T, AT(save), 0, 0,
      "write this run's figures for --check" },
    { "hdr", "F.pfm", TEXT, R, AT(hdr), 0, 0, "linear picture" },
    { "exposure", "EV", REAL, R, AT(exposure), -64, 64, "of the PNG" },
    { "json", "FILE", TEXT, R | P | D | C | F | H | T | K, AT(json), 0, 0,
      "'-' is stdout; see docs/json.md" },
    { "dump", "DIR", TEXT, R, AT(dump), 0, 0, "every target as an image" },
    { "ids", "F.png", TEXT, R | C, AT(ids), 0, 0,
      "render: write object and normal group ids; compare: read the "
      "reference's" },
    { "frames", "N", COUNT, R, AT(frames), 1, HLC_FRAMES_MAX,
      "timed frames" },
    { "warmup", "N", COUNT, R, AT(warmup), 0, HLC_FRAMES_MAX,
      "frames before them; default 3" },
    { "supersample", "N", COUNT, R, AT(supersample), 1, 64,
      "N x N samples a pixel, pipeline reference only" },
    { "list", NULL, FLAG, F | T, AT(list), 0, 0,
      "conform: the checks that must run, and the defects they must catch; "
      "stability: the rows" },
    { "only", "NAMES", TEXT, F | T, AT(only), 0, 0,
      "checks or rows whose names begin with it" },
    { "mutant", "NAME", TEXT, F, AT(mutant), 0, 0,
      "put a defect in, which checks must then fail for" },
    { "seed", "N", COUNT, F, AT(seed), 1, 1e9,
      "of random cases; default 1" },
    { "quick", NULL, FLAG, F, AT(quick), 0, 0,
      "the same checks with fewer random cases" },
    { "min-psnr", "DB", MIN_PSNR, C, 0, 0, 0, "smallest PSNR that passes" },
};
enum { N_ROWS = sizeof rows / sizeof rows[0] };

struct command {
    const char *name, *args;
    uint32_t min_args, max_args;
    const char *help;
};
static const struct command commands[HLC_COMMAND_COUNT] = {
    [HLC_HELP] = { "help", "[COMMAND]", 0, 1, "this text" },
    [HLC_VERSION] = { "version", "", 0, 0, "version" },
    [HLC_RENDER] = { "render", "SCENE", 1, 1, "draw a picture" },
    [HLC_PLAN] = { "plan", "SCENE", 1, 1,
                   "what would be drawn with, and why" },
    [HLC_DEVICES] = { "devices", "", 0, 0, "backends, drivers, devices" },
    [HLC_SCENE] = { "scene", "[SCENE]", 0, 1,
                    "list built-in scenes, or write one as files" },
    [HLC_COMPARE] = { "compare", "TEST REFERENCE", 2, 2,
                      "how far a PNG or PFM is from another" },
    [HLC_CONFORM] = { "conform", "", 0, 0,
                      "check formats, packing and blending on a device" },
    [HLC_CHART] = { "chart", "SCENE...", 1, HLC_ARGS,
                    "error over cost of every way to draw, CSV and SVG" },
    [HLC_STABILITY] = { "stability", "", 0, 0,
                        "where each method fails, CSV and SVG" },
    [HLC_CALIBRATE] = { "calibrate", "[SCENE...]", 0, HLC_ARGS,
                        "measure what the planner predicts by" },
};

/* ---- the line ----------------------------------------------------------- */

static const struct hlc_option *find_row(const char *name, size_t length)
{
    for (int i = 0; i < N_ROWS; i++)
        if (strlen(rows[i].name) == length &&
            !memcmp(rows[i].name, name, length))
            return &rows[i];
    return NULL;
}

/* "-1,2" and "-" are values; "--out" is the next option. */
static bool is_value(const char *text)
{
    return text && (text[0] != '-' || !text[1] ||
                    strchr("0123456789.", text[1]));
}

/* argv[*i] begins with "--"; *i moves on over a value of its own word. */
static int parse_option(struct hlc_options *o, int *i, char **argv)
{
    const char *name = argv[*i] + 2, *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const struct hlc_option *r = find_row(name, length);
    const char *value = equals ? equals + 1 : NULL;
    if (!r)
        return hlc_fail(HLC_BAD, "--%.*s: unknown option", (int)length, name);
    if (!(r->commands & 1u << o->command))
        return hlc_fail(HLC_BAD, "--%s: not an option of %s", r->name,
                        commands[o->command].name);
    if (r->kind == FLAG && value)
        return hlc_fail(HLC_BAD, "--%s=%s: takes no value", r->name, value);
    if (r->kind != FLAG && !value && is_value(argv[*i + 1]))
        value = argv[++*i];
    if (r->kind != FLAG && (!value || !*value))
        return hlc_fail(HLC_BAD, "--%s: needs a value: %s", r->name, r->value);
    return hlc_option_take(o, r, value);
}

bool hlc_command_find(enum hlc_command *out, const char *name)
{
    for (int i = 0; i < HLC_COMMAND_COUNT; i++)
        if (!strcmp(commands[i].name, name)) {
            *out = (enum hlc_command)i;
            return true;
        }
    return false;
}

static int parse_command(struct hlc_options *o, const char *name)
{
    if (!strcmp(name, "--help") || !strcmp(name, "-h"))
        name = "help";
    if (!strcmp(name, "--version"))
        name = "version";
    if (hlc_command_find(&o->command, name))
        return 0;
    if (name[0] == '-')
        return hlc_fail(HLC_BAD, "%s: the command comes first; see "
                        "'halflight help'", name);
    return hlc_fail(HLC_BAD, "%s: no such command; see 'halflight help'",
                    name);
}

static int check(const struct hlc_options *o)
{
    const struct command *c = &commands[o->command];
    if (o->n_args < c->min_args)
        return hlc_fail(HLC_BAD, "%s: needs %s", c->name, c->args);
    if (o->near > 0 && o->far > 0 && o->near >= o->far)
        return hlc_fail(HLC_BAD, "--near %g --far %g: near must be below far",
                        o->near, o->far);
    if (o->part_width > o->width || o->part_height > o->height)
        return hlc_fail(HLC_BAD, "--part %ux%u: is larger than --size %ux%u",
                        (unsigned)o->part_width, (unsigned)o->part_height,
                        (unsigned)o->width, (unsigned)o->height);
    if (o->supersample && !o->reference)
        return hlc_fail(HLC_BAD, "--supersample %u: is an option of "
                        "--pipeline reference", (unsigned)o->supersample);
    if (o->command == HLC_SCENE && o->n_args && !o->out)
        return hlc_fail(HLC_BAD, "scene %s: needs --out PREFIX", o->arg[0]);
    if (o->command == HLC_SCENE && !o->n_args && (o->out || o->lights))
        return hlc_fail(HLC_BAD, "scene: needs a SCENE to write");
    return 0;
}

static int parse_rest(struct hlc_options *o, int argc, char **argv)
{
    const struct command *c = &commands[o->command];
    bool options = true;
    for (int i = 2; i < argc; i++) {
        const char *a = argv[i];
        if (options && !strcmp(a, "--")) {
            options = false;
        } else if (options && (!strcmp(a, "--help") || !strcmp(a, "-h"))) {
            o->arg[0] = c->name;
            o->n_args = 1;
            o->command = HLC_HELP;
            return 0;
        } else if (options && !strncmp(a, "--", 2)) {
            int code = parse_option(o, &i, argv);
            if (code)
                return code;
        } else if (options && a[0] == '-' && a[1]) {
            return hlc_fail(HLC_BAD, "%s: unknown option", a);
        } else if (o->n_args == c->max_args) {
            return hlc_fail(HLC_BAD, "%s: %s takes no further argument", a,
                            c->name);
        } else {
            o->arg[o->n_args++] = a;
        }
    }
    return check(o);
}

int hlc_options_parse(struct hlc_options *out, int argc, char **argv)
{
    memset(out, 0, sizeof *out);
    out->ids_seed = 4;
    out->seed = 1;
    out->width = 1280;
    out->height = 720;
    out->samples = 1;
    out->warmup = 3;
    if (argc < 2)
        return 0;
    int code = parse_command(out, argv[1]);
    /* Hundreds of pictures, or measured where the frame is small; of chart
     * less still with --fast. */
    if (out->command == HLC_CALIBRATE) {
        out->width = 640;
        out->height = 360;
    } else if (out->command == HLC_CHART) {
        out->width = out->height = 0;
    }
    return code ? code : parse_rest(out, argc, argv);
}

/* ---- help --------------------------------------------------------------- */

static void print_options(enum hlc_command command)
{
    for (int i = 0; i < N_ROWS; i++) {
        const struct hlc_option *r = &rows[i];
        if (r->commands & 1u << command)
            printf("  --%s%s%s%s%s\n", r->name, r->value ? " " : "",
                   r->value ? r->value : "", r->help[0] ? "\n        " : "",
                   r->help);
    }
}

static void print_command(const struct command *c, int width)
{
    char line[64];
    snprintf(line, sizeof line, "%s%s%s", c->name, c->args[0] ? " " : "",
             c->args);
    printf("  halflight %-*s  %s\n", width, line, c->help);
}

void hlc_options_help(enum hlc_command command)
{
    if (command != HLC_HELP) {
        print_command(&commands[command], 0);
        print_options(command);
        return;
    }
    printf("halflight: many dynamic lights on any graphics machine\n\n");
    for (int i = HLC_RENDER; i < HLC_COMMAND_COUNT; i++)
        print_command(&commands[i], 24);
    print_command(&commands[HLC_HELP], 24);
    printf("\nSCENE is a built-in name ('halflight scene' lists them) or a "
           ".gltf, .glb or .obj\nfile. Options are --name value or "
           "--name=value; 'halflight help COMMAND' lists\nthem. Exit code: "
           "0 done, 1 a comparison or check failed, 2 bad usage or input, "
           "3 no\nsuch backend or device.\n");
}
