#!/bin/sh
# SPDX-License-Identifier: Zlib
# published.sh TOOL [BACKEND [SAMPLES]]: the results of Kircher and Lawrance
# 2009 (figures 8, 7, 9 and 1) as ratios measured here, one table row each.
# The two sides of a ratio are run in turn, so that a busy moment falls on
# both; medians over ROUNDS (5) of FRAMES (10), smallest and largest round's
# ratio in brackets. SIZE (1280x720) and LIGHT (800x450) may be set. SAMPLES
# of figures 9 and 1: 4. Images of figure 9 are compared with the reference.
set -eu
tool=$1 backend=${2:-vulkan} samples=${3:-4}
rounds=${ROUNDS:-5} frames=${FRAMES:-10} size=${SIZE:-1280x720} light=${LIGHT:-800x450}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

value() { sed -n "s/.*\"$1\":[[:space:]]*\([-0-9.e+]*\).*/\1/p" "$2" | head -n 1; }

# render NAME SCENE OPTION...: a timed run, its median added to NAME.ms.
render() {
    name=$1 scene=$2
    shift 2
    "$tool" render "$scene" --backend "$backend" --size "$size" --frames "$frames" \
        --json "$tmp/$name.json" "$@" >/dev/null
    sed -n '/"frame_ms"/,/}/p' "$tmp/$name.json" > "$tmp/frame"
    value median "$tmp/frame" >> "$tmp/$name.ms"
}

# ratio A B: of medians, and of rounds from smallest to largest.
ratio() {
    paste "$tmp/$1.ms" "$tmp/$2.ms" | awk '{ print $1 / $2 }' | sort -g > "$tmp/r"
    a=$(sort -g "$tmp/$1.ms" | awk '{ x[NR] = $1 } END { print x[int((NR + 1) / 2)] }')
    b=$(sort -g "$tmp/$2.ms" | awk '{ x[NR] = $1 } END { print x[int((NR + 1) / 2)] }')
    awk -v a="$a" -v b="$b" '{ x[NR] = $1 } END { printf "%.2f (%.2f..%.2f)", a / b, x[1], x[NR] }' "$tmp/r"
}

# The faster of two timed runs, by median.
faster() {
    for n in "$1" "$2"; do
        echo "$(sort -g "$tmp/$n.ms" | awk '{ x[NR] = $1 } END { print x[int((NR + 1) / 2)] }') $n"
    done | sort -g | head -n 1 | cut -d' ' -f2
}

edge() {
    "$tool" compare "$tmp/$1.pfm" "$tmp/ref.pfm" --ids "$tmp/ids.png" --json "$tmp/c.json" >/dev/null
    echo "$(value edge_mae "$tmp/c.json") $(value psnr "$tmp/c.json") $(value flip "$tmp/c.json")"
}

echo "| row | what | here | paper |"
echo "|---|---|---|---|"

i=0
while [ $i -lt "$rounds" ]; do
    render f8 fig8 --pipeline forward-multipass --scissor off
    render i8 fig8 --pipeline inferred --light-size "$light"
    i=$((i + 1))
done
echo "| RES-1 | fig8: multi-pass forward, whole objects : inferred | $(ratio f8 i8) | 167 : 29.4 = 5.68 |"

i=0
while [ $i -lt "$rounds" ]; do
    render a7 fig7 --pipeline forward
    render b7 fig7 --pipeline forward-multipass
    render i7 fig7 --pipeline inferred --light-size "$light"
    i=$((i + 1))
done
best=$(faster a7 b7)
echo "| RES-2 | fig7: best forward ($([ "$best" = a7 ] && echo '8 lights a draw' || echo 'multi-pass, scissored')) : inferred | $(ratio "$best" i7) | 5.03 ms, no forward figure |"

i=0
while [ $i -lt "$rounds" ]; do
    render full9 fig9 --samples "$samples" --pipeline inferred --light-size "$size" --dsf off --hdr "$tmp/full.pfm"
    render low9 fig9 --samples "$samples" --pipeline inferred --light-size "$light" --hdr "$tmp/low.pfm"
    i=$((i + 1))
done
"$tool" render fig9 --pipeline reference --size "$size" --samples "$samples" --hdr "$tmp/ref.pfm" --ids "$tmp/ids.png" >/dev/null
echo "| RES-3 | fig9, $samples samples: $size without DSF : $light with DSF | $(ratio full9 low9) | 32 : 25 = 1.28 |"
set -- $(edge full) $(edge low)
echo "| | its images against the reference: edge error / PSNR / FLIP, $size without DSF | $1 / $2 / $3 | more aliasing |"
echo "| | the same, $light with DSF | $4 / $5 / $6 | better |"

i=0
while [ $i -lt "$rounds" ]; do
    render a1 fig1 --samples "$samples" --pipeline forward
    render b1 fig1 --samples "$samples" --pipeline forward-multipass
    render i1 fig1 --samples "$samples" --pipeline inferred --light-size "$light"
    i=$((i + 1))
done
best=$(faster a1 b1)
echo "| RES-4 | fig1, 213 lights, $samples samples: best forward ($([ "$best" = a1 ] && echo '8 lights a draw' || echo 'multi-pass, scissored')) : inferred | $(ratio "$best" i1) | 43.5 ms, no forward figure |"
