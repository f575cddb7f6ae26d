#!/bin/sh
# SPDX-License-Identifier: Zlib
# worse.sh BUILD [FAULT...]: does a change for the worse show? The tree is
# copied with the objects of BUILD (build/release), one fault at a time is put
# into the copy, the tool is built and its figures are compared with those that
# tests/chart.txt (and tests/stability.txt) keep. Each fault must make the tool
# end with 1 and say what became worse; without a fault it must say nothing.
# Prints a table; exit 1 where a fault was not noticed. By hand: some minutes.
# dsf: the filter of the L-buffer is off where it should be scaled by slope.
# pack: 16 bits in two bytes by fract(255 v), as is often published.
# k1: one light a blend.
set -eu
build=$1
shift
faults=${*:-none dsf pack k1}
cd "$(dirname "$0")/.."
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
tree=$tmp/tree
mkdir -p "$tree/b" "$tree/build"

# Times are kept, so that only what a fault touches is compiled anew.
git ls-files -co --exclude-standard -z | tar -c --null -T - --ignore-failed-read 2>/dev/null | tar -x -C "$tree"
cp -Rp "$build/obj" "$tree/b/"
[ -n "${GEN:-}" ] || GEN=build/gen
find "$tree/b" -name '*.d' -exec sed -i -e "s|$build/obj/|b/obj/|" -e "s|$GEN/|gen/|g" {} +
cp -Rp "$GEN" "$tree/gen"

# inject FAULT: prints the files that it is in.
inject() {
    case $1 in
    none) ;;
    dsf) sed -i 's/p->dsf = HL_DSF_SLOPE;/p->dsf = HL_DSF_OFF;/' "$tree/core/pipe_dsf.c"
        echo core/pipe_dsf.c ;;
    pack) awk '/^HL_FN hl_vec2 hl_bytes16_encode/ { inside = 1 }
            inside && /hl_split16/ { print "    float lo = v * 255.0f - hl_floor(v * 255.0f);"; next }
            inside && /return/ { print "    return hl_v2(v - lo * (1.0f / 255.0f), lo);"; inside = 0; next }
            { print }' shaders/shared/pack.h > "$tree/shaders/shared/pack.h"
        echo shaders/shared/pack.h ;;
    k1) sed -i -e 's/p->batch = ask->n.batch ? ask->n.batch : 8;/p->batch = 1;/' -e 's/p->batch = most;/p->batch = 1;/' \
            "$tree/core/pipe_light.c"
        echo core/pipe_light.c ;;
    *) echo "worse.sh: no fault \"$1\": none, dsf, pack or k1" >&2
        exit 2 ;;
    esac
}

# watch NAME COMMAND...: $tmp/NAME.rc and the lines that say what is worse.
watch() {
    name=$1 rc=0
    shift
    "$@" > "$tmp/$name.out" 2> "$tmp/$name.err" || rc=$?
    echo $rc > "$tmp/$name.rc"
    grep ': worse$' "$tmp/$name.err" > "$tmp/$name.worse" || :
    grep ': better, ' "$tmp/$name.err" > "$tmp/$name.better" || :
}

# row FAULT NAME: of the table; false where it is not as it must be.
row() {
    n=$(wc -l < "$tmp/$2.worse") rc=$(cat "$tmp/$2.rc")
    first=$(sort -t'(' -k2 -g "$tmp/$2.worse" | head -n 1 | sed 's/^halflight: //')
    [ "$n" -gt 0 ] || first=$(tail -n 1 "$tmp/$2.err")
    echo "| $1 | $2 | $rc | $n | $(wc -l < "$tmp/$2.better") | $first |"
    if [ "$1" = none ]; then
        [ "$rc" = 0 ] && [ "$n" = 0 ]
    else
        [ "$rc" = 1 ] && [ "$n" -gt 0 ]
    fi
}

bad=0
echo "| fault | check | exit | became worse | better | the most |"
echo "|---|---|---|---|---|---|"
for fault in $faults; do
    touched=$(inject "$fault")
    for f in $touched; do
        if cmp -s "$f" "$tree/$f"; then
            echo "worse.sh: $fault: nothing to change in $f" >&2
            exit 2
        fi
    done
    if ! MAKEFLAGS='' make -j2 -C "$tree" B=b GEN=gen tool > "$tmp/make" 2>&1; then
        tail "$tmp/make" >&2
        exit 2
    fi
    noticed=0
    watch chart "$tree/b/halflight" chart --fast --rounds 0 --size 192x108 --machines packemu,packemu:ps3 fig8 fig9 \
        --fresh --out "$tmp/chart" --check tests/chart.txt
    row "$fault" chart && noticed=1
    if [ -f tests/stability.txt ]; then
        watch stability "$tree/b/halflight" stability --fast --out "$tmp/stability" --check tests/stability.txt
        # One of the two that notices a fault is enough; without one both keep still.
        if row "$fault" stability; then
            [ "$fault" = none ] || noticed=1
        else
            [ "$fault" != none ] || noticed=0
        fi
    fi
    [ $noticed = 1 ] || bad=1
    for f in $touched; do
        cp "$f" "$tree/$f"
    done
done
exit $bad
