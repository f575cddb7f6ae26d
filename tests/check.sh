#!/bin/sh
# SPDX-License-Identifier: Zlib
# check.sh BUILD: what a compiler does not see. One line a check: "ok NAME",
# "not ok NAME" with what is wrong below it, or "skip NAME: reason". Exit 1 when
# one failed.
set -u
build=$1
cd "$(dirname "$0")/.." || exit 1
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
bad=0

# verdict NAME: the check passed when $tmp/out is empty.
verdict() {
    if [ -s "$tmp/out" ]; then
        echo "not ok $1"
        sed 's/^/    /' "$tmp/out" | head -n 20
        bad=1
    else
        echo "ok $1"
    fi
}

# arrows NAME FOLDER ALLOWED: files below FOLDER include only what matches.
arrows() {
    grep -rn '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "$2" --include='*.[ch]' \
        --include='*.glsl' --include='*.vert' --include='*.frag' |
        grep -vE "\"($3)" > "$tmp/out"
    verdict "$1"
}

core_public='core/(halflight|needs|plan|scene|frame|mesh|ids|stipple|stipple_mode|shadow_mesh)\.h'
hal_public='hal/(hal|caps|backend|formats|profile)\.'
arrows includes_shaders shaders 'shaders/'
arrows includes_shared shaders/shared 'shaders/shared/'
arrows includes_hal hal 'hal/|shaders/(shared/|variants\.def)'
arrows includes_core core 'core/|hal/|shaders/(shared/|variants\.def)'
arrows includes_null platforms/null "$hal_public|hal/text\.h|platforms/null/|shaders/shared/"
arrows includes_vulkan platforms/vulkan "$hal_public|platforms/vulkan/|shaders/shared/"
arrows includes_gl platforms/gl "$hal_public|hal/text\.h|platforms/gl/|shaders/shared/"
arrows includes_packemu platforms/packemu "$hal_public|hal/text\.h|platforms/packemu/|shaders/(shared/|variants\.def)"
arrows includes_profiles platforms/profiles "$hal_public|platforms/profiles/|shaders/shared/"
arrows includes_conform platforms/conform "$hal_public|hal/text\.h|$core_public|shaders/shared/|platforms/(conform|profiles)/|platforms/packemu/hl_packemu\.h"
arrows includes_host platforms/host 'platforms/host/'
arrows includes_reference platforms/reference 'platforms/reference/|platforms/host/scene\.h'
arrows includes_tool platforms/cli "$hal_public|$core_public|shaders/shared/|platforms/"
for part in chart stability calibrate; do
    arrows includes_$part platforms/$part "$hal_public|$core_public|shaders/shared/|platforms/(chart|cli|host|profiles|reference|$part)/|platforms/platforms\.h"
done
grep -rnE '#include[[:space:]]*<(vulkan|GL|EGL|GLFW|assimp|cjson|png|jpeglib|pthread|stdio|stdlib|unistd)' \
    core hal shaders > "$tmp/out"
verdict no_platform_header_below

# symbols NAME LIBRARY OWN MORE: what a library asks of a platform is in
# symbols.txt or matches MORE; its own symbols, and those of libraries below
# it, begin with OWN.
symbols() {
    case $build in
    *sanitize*|*coverage*)
        echo "skip $1: instrumented build"
        return ;;
    esac
    nm -u "$build/lib$2.a" | awk '$1 == "U" { print $2 }' | sort -u |
        grep -vE "^($3)_|^_GLOBAL_OFFSET_TABLE_\$" | grep -vxE "$4" > "$tmp/used"
    grep -v '^#' tests/symbols.txt | sort -u | comm -13 - "$tmp/used" > "$tmp/out"
    verdict "$1"
}
symbols symbols halflight hl 'none'
# __cpu: of compilers' own run time, for loops cloned by processor.
symbols symbols_packemu halflight-packemu 'hl|pe' 'pthread_[a-z_]+|clock_gettime|sysconf|__cpu_(model|indicator_init)'
symbols symbols_profiles halflight-profiles hl 'none'
# The models of the conformance suite compute in double precision by the
# mathematics library; nothing that is drawn comes from them.
symbols symbols_conform halflight-conform 'hl|cf' \
    'a?(sin|cos|tan)|sincos|atan2|f(min|max|mod|abs)|frexp|(ld)?exp2?f?|log2?|pow|strn?(chr|cmp)|strrchr'

libraries='halflight halflight-null halflight-packemu halflight-profiles halflight-conform halflight-vulkan halflight-gl'
# Libraries neither print, abort, allocate behind the hooks' back nor keep
# state of their own.
for lib in $libraries; do
    nm -u "$build/lib$lib.a" | awk -v lib=$lib '$1 == "U" { print lib ": " $2 }'
done | grep -wE 'f?printf|f?puts|fputc|putchar|fwrite|abort|exit|malloc|calloc|realloc|free|getenv|__assert_fail|stdout|stderr|errno' \
    > "$tmp/out"
case $build in
*sanitize*|*coverage*) echo "skip libraries_keep_quiet: instrumented build" ;;
*) verdict libraries_keep_quiet ;;
esac
for lib in $libraries; do
    objdump -h "$build/lib$lib.a" | awk -v lib=$lib '/file format/ { file = $1 }
        ($2 == ".data" || $2 == ".bss") && $3 !~ /^0*$/ { print lib ": " file " " $2 " holds 0x" $3 }'
done > "$tmp/out"
case $build in
*sanitize*|*coverage*) echo "skip no_mutable_globals: instrumented build" ;;
*) verdict no_mutable_globals ;;
esac

# Every public header alone, as C99 and as C++.
for h in hal/caps.h hal/hal.h hal/backend.h hal/text.h core/needs.h core/plan.h core/scene.h core/frame.h \
    core/mesh.h core/ids.h core/stipple.h core/halflight.h platforms/platforms.h platforms/null/hl_null.h \
    platforms/vulkan/hl_vulkan.h platforms/gl/hl_gl.h platforms/packemu/hl_packemu.h \
    platforms/profiles/hl_profiles.h platforms/conform/conform.h; do
    echo "#include \"$h\"" > "$tmp/h.c"
    ${CC:-gcc} -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror -I. -fsyntax-only "$tmp/h.c" \
        2>> "$tmp/alone"
    if command -v g++ > /dev/null 2>&1; then
        cp "$tmp/h.c" "$tmp/h.cc"
        g++ -Wall -Wextra -Werror -I. -fsyntax-only "$tmp/h.cc" 2>> "$tmp/alone-cc"
    fi
done
touch "$tmp/alone" "$tmp/alone-cc"
cp "$tmp/alone" "$tmp/out"
verdict headers_alone_c99
if command -v g++ > /dev/null 2>&1; then
    cp "$tmp/alone-cc" "$tmp/out"
    verdict headers_alone_cxx
else
    echo "skip headers_alone_cxx: no g++ here"
fi

sources() { find core hal platforms shaders tests -name '*.[ch]' -o -name '*.glsl' -o -name '*.vert' -o -name '*.frag'; }
sources | xargs awk 'length($0) > 100 { print FILENAME ":" FNR ": " length($0) " columns" }' > "$tmp/out"
verdict lines_at_most_100
# A function body: from a "{" in the first column to its "}".
sources | grep '\.c$' | xargs awk 'FNR == 1 { open = 0 }
    /^\{/ { open = FNR }
    /^\}/ { if (open && FNR - open + 1 > 82) print FILENAME ":" open ": " FNR - open - 1 " lines"; open = 0 }' > "$tmp/out"
verdict functions_at_most_80
grep -rnwE 'TODO|FIXME|XXX|HACK' core hal platforms shaders tests Makefile \
    --exclude=check.sh > "$tmp/out"
verdict nothing_left_undone
exit $bad
