#!/bin/sh
# SPDX-License-Identifier: Zlib
# matrix.sh TOOL SCENE...: each scene by inferred lighting on every backend
# and profile, and forward on every backend, against the reference renderer;
# a Markdown table of PSNR (dB) and of the share of pixels within 1/255 after
# sRGB. SIZE=640x360; KEEP=DIR keeps the pictures. Lights: those of the file.
set -eu
tool=$1
shift
size=${SIZE:-640x360}
dir=${KEEP:-$(mktemp -d)}
mkdir -p "$dir"
[ -n "${KEEP:-}" ] || trap 'rm -rf "$dir"' EXIT

value() { sed -n "s/.*\"$1\":[[:space:]]*\([-0-9.e+]*\|null\).*/\1/p" "$2" | head -n 1; }

# cell NAME OPTION...: draw, compare, print "PSNR share".
cell() {
    name=$1
    shift
    if ! "$tool" render "$scene" --size "$size" --hdr "$dir/$name.pfm" --out "$dir/$name.png" \
        "$@" > "$dir/$name.txt" 2>&1; then
        echo "refused"
        return
    fi
    "$tool" compare "$dir/$name.pfm" "$dir/$base-reference.pfm" > "$dir/$name.json"
    awk -v p="$(value psnr "$dir/$name.json")" -v w="$(value within_1_255 "$dir/$name.json")" \
        'BEGIN { printf "%.1f / %.4f", p, w }'
}

echo "| scene | backend | forward | inferred native | dx10 | xbox360 | ps3 |"
echo "|---|---|---|---|---|---|---|"
for scene in "$@"; do
    base=$(basename "$scene" | sed 's/\.[a-z]*$//')
    "$tool" render "$scene" --pipeline reference --size "$size" --hdr "$dir/$base-reference.pfm" > /dev/null
    for backend in vulkan gl packemu; do
        printf '| %s | %s | %s' "$base" "$backend" \
            "$(cell "$base-$backend-forward" --backend $backend --pipeline forward)"
        for profile in native dx10 xbox360 ps3; do
            printf ' | %s' "$(cell "$base-$backend-$profile" --backend $backend --profile $profile \
                --pipeline inferred)"
        done
        echo " |"
    done
done
