#!/bin/sh
# SPDX-License-Identifier: Zlib
# make-stability.sh TOOL [STABILITY.md]: sweeps every failure on packemu and on
# Vulkan, where that has a device, into build/docs/stability (CSV, an SVG a
# failure), and writes their boundaries between <!-- boundaries --> and
# <!-- /boundaries --> of docs/stability.md. A second run changes no byte.
set -eu
tool=$1
doc=${2:-docs/stability.md}
out=build/docs/stability
mkdir -p "$out"
backends=
for backend in packemu vulkan; do
    code=0
    "$tool" stability --backend $backend --out "$out/$backend" > "$out/$backend.txt" 2> "$out/err" || code=$?
    # 3: no such device here.
    [ $code != 3 ] || continue
    tail -n 1 "$out/$backend.txt"
    if [ $code != 0 ]; then
        cat "$out/err" >&2
        grep -E ' (moved|broken) ' "$out/$backend.txt" >&2 || :
        exit 1
    fi
    backends="$backends $out/$backend/boundaries.csv"
done

# Fields of ours: quotes stand around the fifth and the last alone.
{
    echo "| curve | parameter | packemu | Vulkan | must lie in | theory |"
    echo "|---|---|---|---|---|---|"
    # shellcheck disable=SC2086
    awk -F, '
    function number(x) { return x == "" ? "none" : sprintf("%.4g", x) }
    FNR == 1 { file++; next }
    {
        key = $1 "." $2
        text = $0
        sub(/"$/, "", text); sub(/^.*,"/, "", text); gsub(/\|/, "\\|", text)
        parameter = $5; gsub(/"/, "", parameter)
        if (!(key in row)) { row[key] = ++n; name[n] = key }
        at[key, file] = $11 == "skipped" ? "-" : number($7)
        range[key] = $9 == "" ? "none" : $9 == $10 ? number($9) : number($9) " to " number($10)
        theory[key] = text; what[key] = parameter ($6 == "" ? "" : ", " $6)
    }
    END {
        for (i = 1; i <= n; i++) {
            k = name[i]
            printf "| %s | %s | %s | %s | %s | %s |\n", k, what[k], at[k, 1], (file > 1 ? at[k, 2] : "-"), range[k], theory[k]
        }
    }' $backends
    echo
    echo "none: no boundary in the whole sweep. -: not to be had on that machine. Made by \`make docs\` with"
    echo "\`halflight stability --backend B --out build/docs/stability/B\`, which draws a chart of each failure too."
} > "$out/table.md"
awk -v from="<!-- boundaries -->" -v to="<!-- /boundaries -->" -v file="$out/table.md" '
    index($0, to) { inside = 0 }
    !inside { print }
    index($0, from) { inside = 1; while ((getline line < file) > 0) print line }' "$doc" > "$out/new.md"
cmp -s "$out/new.md" "$doc" || cp "$out/new.md" "$doc"
