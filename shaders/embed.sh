#!/bin/sh
# SPDX-License-Identifier: Zlib
# Compile every row of variants.def and write one C file that holds them all:
#   embed.sh spirv OUT.c     Vulkan SPIR-V, table hl_spirv[HL_SHADER_COUNT]
# The output is a build product and never committed.
set -eu
mode=$1
out=$2
dir=$(dirname "$0")
tmp=$out.$$

mkdir -p "$tmp"
[ "$mode" = spirv ] || { echo "embed.sh: unknown mode $mode" >&2; exit 2; }

sed -n 's/^HL_SHADER(\([A-Z0-9_]*\), \([a-z]*\), \([a-z_.]*\), "\(.*\)")$/\1 \2 \3 \4/p' \
    "$dir/variants.def" > "$tmp/rows"
{
    echo '#include "platforms/vulkan/hl_spirv.h"'
    while read -r name stage file defines; do
        # vulkan1.1: later targets make compute use LocalSizeId, which needs
        # maintenance4 (VUID-RuntimeSpirv-LocalSizeId-06434).
        # shellcheck disable=SC2086
        glslangValidator -V -g0 --target-env vulkan1.1 -S "$stage" \
            -I"$dir" -I"$dir/.." $defines -x -o "$tmp/$name.x" "$dir/$file" \
            > "$tmp/$name.log" 2>&1 || { cat "$tmp/$name.log" >&2; exit 1; }
        echo "static const uint32_t code_$name[] = {"
        grep -v '^[[:space:]]*//' "$tmp/$name.x"
        echo "};"
    done < "$tmp/rows"
    echo 'const struct hl_spirv hl_spirv[HL_SHADER_COUNT] = {'
    while read -r name stage file defines; do
        echo "    [HL_SHADER_$name] = { code_$name, sizeof code_$name },"
    done < "$tmp/rows"
    echo '};'
} > "$tmp/out.c"
mv "$tmp/out.c" "$out"
rm -rf "$tmp"
