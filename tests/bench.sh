#!/bin/sh
# SPDX-License-Identifier: Zlib
# bench.sh TOOL [SCENE [LIGHTS.csv CAMERA AMBIENT]] [-- FLOOR COMMAND...]
# Times of the pipelines for one scene, in turn, so that a busy moment of the
# machine falls on all of them: medians over rounds of frames, with their
# spread, as ratios to inferred lighting; that also on the other backends.
# FLOOR is any program that prints "median_ms=X"; it takes its turn too.
# ROUNDS and FRAMES may be set.
set -eu
tool=$1
shift
rounds=${ROUNDS:-5} frames=${FRAMES:-20}
scene=fig8 lights= camera= ambient=
[ $# -gt 0 ] && [ "$1" != -- ] && { scene=$1; shift; }
[ $# -gt 0 ] && [ "$1" != -- ] && { lights=$1 camera=$2 ambient=$3; shift 3; }
[ $# -gt 0 ] && shift
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

value() { sed -n "s/.*\"$1\":[[:space:]]*\([-0-9.e+]*\).*/\1/p" "$2" | head -n 1; }
middle() { sort -g "$1" | awk '{ a[NR] = $1 } END { print a[int((NR + 1) / 2)] }'; }

# render NAME OPTION...: one timed run, its median into NAME.ms.
render() {
    name=$1
    shift
    "$tool" render "$scene" ${lights:+--lights "$lights" --lights-mode replace} \
        ${camera:+"--camera=$camera"} ${ambient:+--ambient "$ambient"} \
        --size 1280x720 --frames "$frames" --json "$tmp/$name.json" "$@" >/dev/null
    sed -n '/"frame_ms"/,/}/p' "$tmp/$name.json" > "$tmp/frame"
    value median "$tmp/frame" >> "$tmp/$name.ms"
}

i=0
while [ $i -lt "$rounds" ]; do
    render multipass --pipeline forward-multipass --scissor off
    render scissored --pipeline forward-multipass --scissor on
    render forward --pipeline forward
    render inferred --pipeline inferred --light-size 800x450
    for backend in gl packemu; do
        render $backend --backend $backend --pipeline inferred --light-size 800x450
    done
    if [ $# -gt 0 ]; then
        "$@" | sed -n 's/.*median_ms=\([0-9.]*\).*/\1/p' >> "$tmp/floor.ms"
    fi
    i=$((i + 1))
done

base=$(middle "$tmp/inferred.ms")
echo "$scene, 1280 x 720, $(sed -n 's/.*"device":[[:space:]]*"\([^"]*\)".*/\1/p' "$tmp/inferred.json" | head -n 1), $rounds rounds of $frames frames"
echo "pipeline      median ms   min..max of rounds   against inferred   light evaluations"
for name in multipass scissored forward inferred gl packemu floor; do
    [ -f "$tmp/$name.ms" ] || continue
    evals=-
    [ -f "$tmp/$name.json" ] && evals=$(value light_evaluations "$tmp/$name.json")
    printf '%-12s %10.1f %11.1f..%-8.1f %16.2f   %s\n' "$name" "$(middle "$tmp/$name.ms")" \
        "$(sort -g "$tmp/$name.ms" | head -n 1)" "$(sort -g "$tmp/$name.ms" | tail -n 1)" \
        "$(middle "$tmp/$name.ms" | awk -v b="$base" '{ print $1 / b }')" "$evals"
done
