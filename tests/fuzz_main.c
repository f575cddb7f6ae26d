/* SPDX-License-Identifier: Zlib */
/* For compilers without libFuzzer: runs each file that is named, or, with
 * none, as many random inputs as $HL_FUZZ_RUNS says (10,000), of the seed
 * $HL_TEST_SEED (1). */
#include <string.h>
#include "tests/fuzz.h"

static uint8_t input[1 << 16];

static uint32_t next(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

static long number(const char *name, long otherwise)
{
    const char *text = getenv(name);
    return text && *text ? strtol(text, NULL, 10) : otherwise;
}

static int run_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        fprintf(stderr, "%s: cannot be opened\n", path);
        return 1;
    }
    size_t n = fread(input, 1, sizeof input, file);
    fclose(file);
    LLVMFuzzerTestOneInput(input, n);
    return 0;
}

int main(int argc, char **argv)
{
    int bad = 0;
    for (int i = 1; i < argc; i++)
        bad |= run_file(argv[i]);
    if (argc > 1)
        return bad;
    long runs = number("HL_FUZZ_RUNS", 10000), seed = number("HL_TEST_SEED", 1);
    printf("HL_TEST_SEED=%ld, %ld runs\n", seed, runs);
    for (long i = 0; i < runs; i++) {
        uint64_t state = (uint64_t)seed * 0x9e3779b97f4a7c15u + (uint64_t)i;
        next(&state);
        size_t n = next(&state) % 4096;
        for (size_t k = 0; k < n; k++)
            input[k] = (uint8_t)next(&state);
        LLVMFuzzerTestOneInput(input, n);
    }
    return 0;
}
