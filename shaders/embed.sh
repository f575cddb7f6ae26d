#!/bin/sh
# SPDX-License-Identifier: Zlib
# Compile every row of variants.def and write one C file that holds them all:
#   embed.sh spirv OUT.c     Vulkan SPIR-V, table hl_spirv[HL_SHADER_COUNT]
#   embed.sh glsl OUT.c      GLSL 4.50 for OpenGL, table hl_glsl[...]
# or one stage of an embedder's own, for #include in an array of char:
#   embed.sh stage OUT FILE  GLSL 4.50 for OpenGL
# The output is a build product and never committed.
set -eu
mode=$1
out=$2
dir=$(dirname "$0")
tmp=$out.$$

case $mode in
spirv) header=platforms/vulkan/hl_spirv.h strip=-g0 ;;
# Names are kept: GL matches the blocks of two stages by name.
glsl|stage) header=platforms/gl/hl_glsl.h strip= ;;
*) echo "embed.sh: unknown mode $mode" >&2; exit 2 ;;
esac
mkdir -p "$tmp"

# compile OUTPUT SOURCE OPTIONS...: one row to SPIR-V.
compile() {
    output=$1 source=$2
    shift 2
    # vulkan1.1: later targets make compute use LocalSizeId, which needs
    # maintenance4 (VUID-RuntimeSpirv-LocalSizeId-06434).
    # shellcheck disable=SC2086
    glslangValidator -V $strip --target-env vulkan1.1 -S "$stage" \
        -I"$dir" -I"$dir/.." $defines "$@" -o "$output" "$source" \
        > "$tmp/$name.log" 2>&1 || { cat "$tmp/$name.log" >&2; exit 1; }
}

row_spirv() {
    compile "$tmp/$name.x" "$dir/$file" -x
    echo "static const uint32_t code_$name[] = {"
    grep -v '^[[:space:]]*//' "$tmp/$name.x"
    echo "};"
}

# Set and binding become binding alone: uniforms, textures and storage have
# numbers of their own in GL. As bytes: C99 ends string literals at 4095.
glsl_bytes() {
    compile "$tmp/$name.spv" "$1"
    spirv-cross --version 450 --no-es --remove-unused-variables \
        --no-support-nonzero-baseinstance --output "$tmp/$name.glsl" \
        "$tmp/$name.spv"
    od -An -v -tu1 "$tmp/$name.glsl" | sed 's/  */,/g; s/^,//; s/$/,/'
    echo 0
}

row_glsl() {
    echo "static const char code_$name[] = {"
    glsl_bytes "$dir/$file"
    echo "};"
}

if [ "$mode" = stage ]; then
    name=stage stage=${3##*.} defines=
    glsl_bytes "$3" > "$tmp/out"
    mv "$tmp/out" "$out"
    rm -rf "$tmp"
    exit 0
fi

sed -n 's/^HL_SHADER(\([A-Z0-9_]*\), \([a-z]*\), \([a-z_.]*\), "\(.*\)")$/\1 \2 \3 \4/p' \
    "$dir/variants.def" > "$tmp/rows"
{
    echo "#include \"$header\""
    while read -r name stage file defines; do
        "row_$mode"
    done < "$tmp/rows"
    if [ "$mode" = spirv ]; then
        echo 'const struct hl_spirv hl_spirv[HL_SHADER_COUNT] = {'
    else
        echo 'const char *const hl_glsl[HL_SHADER_COUNT] = {'
    fi
    while read -r name stage file defines; do
        if [ "$mode" = spirv ]; then
            echo "    [HL_SHADER_$name] = { code_$name, sizeof code_$name },"
        else
            echo "    [HL_SHADER_$name] = code_$name,"
        fi
    done < "$tmp/rows"
    echo '};'
} > "$tmp/out.c"
mv "$tmp/out.c" "$out"
rm -rf "$tmp"
