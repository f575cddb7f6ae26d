#!/bin/sh
# SPDX-License-Identifier: Zlib
# make-charts.sh TOOL [RESULTS.md]: the charts of error over cost, into
# build/docs/chart, and the tables of docs/results.md that are made from them:
# what stands between <!-- NAME --> and <!-- /NAME -->, for each NAME of
# chart-fronts, chart-formats, chart-volumes and regret that is there.
# HL_SCENES: more scenes than the built-in ones, names or files.
# HL_CHART_OPTIONS: of the sweep, such as "--fast --machines packemu"; a sweep
# that was broken off is gone on with. HL_CHART_KEEP=1: no sweep, the tables
# anew from what the last one left.
# Counted columns are the same on every run; times are not.
set -eu
tool=$1
doc=${2:-docs/results.md}
out=build/docs/chart
mkdir -p "$out"
command="halflight chart fig7 fig8 fig9 lidr${HL_SCENES:+ $HL_SCENES}${HL_CHART_OPTIONS:+ $HL_CHART_OPTIONS} --out $out"
if [ -z "${HL_CHART_KEEP:-}" ]; then
    # shellcheck disable=SC2086
    "$tool" chart fig7 fig8 fig9 lidr ${HL_SCENES:-} ${HL_CHART_OPTIONS:-} --out "$out" > "$out/chart.tmp"
    echo "$command" > "$out/command.txt"
    mv "$out/chart.tmp" "$out/chart.txt"
fi
# Files by their names alone: where they lie is nobody else's matter.
command=$(sed 's|[^ ]*/\([^ /]*\.gl[a-z]*\)|\1|g' "$out/command.txt")

# csv FILE PROGRAM: awk over a table of ours (no field has a comma in it):
# $c["name"] is that column; lines of comments are skipped.
csv() {
    grep -v '^#' "$1" | awk -F, "NR == 1 { for (i = 1; i <= NF; i++) c[\$i] = i; next } $2"
}
size() { sed -n '1s/.*, \([0-9]*\)x\([0-9]*\).*/\1 x \2/p' "$out/chart.csv"; }
remade() {
    echo
    echo "Pictures of $(size). Made by \`$command\`; \`make docs\` writes this table."
}
# Functions of awk that the tables share. name(): as the charts have it.
common='
function name(s) { sub(/^inferred /, "", s); gsub(/_UNORM/, "", s); gsub(/_FLOAT/, "F", s); return s }
function time(t, low, high) { return t == "" ? "" : sprintf("%.2f (%.2f..%.2f)", t, low, high) }
function decibels(e) { return -20 * log(e) / log(10) }
'

# Ways that nothing beats, where they are a tenth nearer than what is cheaper, on
# machines without a profile: a table to be read. The CSV has all. Rows come
# sorted by cost, then by what is better.
fronts() {
    echo "| scene | machine | way | cost, ns a pixel | bytes moved a pixel | PSNR, dB | FLIP | flicker | time over inferred 5/8 (quartiles) |"
    echo "|---|---|---|---|---|---|---|---|---|"
    csv "$out/chart.csv" '$c["budget"] + 0 == 0 && $c["cost_ns"] > 0 && $c["psnr"] != "" && $c["machine"] !~ /:/ {
        printf "%s,%s,%s,%.9g,%s,%.9g,%s,%s,%s,%s,%s\n", $c["scene"], $c["machine"], $c["way"], $c["cost_ns"],
            $c["moved_bytes"], $c["psnr"] == "inf" ? 160 : $c["psnr"], $c["flip"], $c["flicker"], $c["time_ratio"],
            $c["time_low"], $c["time_high"] }' |
    LC_ALL=C sort -t, -k1,1 -k2,2 -k4,4g -k6,6gr -k3,3 | awk -F, "$common"'
        { key = $1 "," $2; error = 10 ^ (-$6 / 20)
          if (key != last) { best = 1e9; shown = 0 }
          if (error <= 0.9 * best) {
              best = error
              printf "| %s | %s | %s | %.1f | %.1f | %.1f | %.4f | %s | %s |\n", shown ? "" : $1, shown ? "" : $2,
                  name($3), $4, $5, $6, $7, $8 == "" ? "" : sprintf("%.2g", $8), time($9, $10, $11)
              shown = 1
          }
          last = key }'
    remade
}

# Geometric means over the scenes of the L-buffers of each format and size.
formats() {
    csv "$out/chart.csv" '$c["pipeline"] == "inferred" && $c["way"] ~ "^inferred ./8 [A-Z0-9_]*$" && $c["psnr"] != "" {
        split($c["way"], w, " ")
        printf "%s,%s,%s,%s,%s,%s,%s\n", $c["machine"], w[3], w[2], $c["scene"], $c["psnr"], $c["cost_ns"],
            $c["moved_bytes"] }' |
    LC_ALL=C sort -t, -k1,1 -k2,2 -k3,3 -k4,4 | awk -F, "$common"'
        { row = $1 "," $2; at = row "," $3
          if (!(row in seen)) { seen[row] = ++rows; order[rows] = row }
          if (!($3 in size)) { size[$3] = 1 }
          n[at]++; db[at] += $5; cost[at] += log($6); moved[at] += $7 }
        END {
            printf "| machine | L-buffer |"
            for (k = 1; k <= 8; k++) if ((k "/8") in size) { printf " %d/8: PSNR, dB; ns; bytes a pixel |", k; columns++ }
            printf "\n|---|---|"
            for (k = 1; k <= columns; k++) printf "---|"
            print ""
            for (r = 1; r <= rows; r++) {
                split(order[r], w, ",")
                printf "| %s | %s |", w[1] == machine ? "" : w[1], name(w[2])
                machine = w[1]
                for (k = 1; k <= 8; k++) if ((k "/8") in size) {
                    at = order[r] "," k "/8"
                    if (n[at]) printf " %.1f; %.1f; %.1f |", db[at] / n[at], exp(cost[at] / n[at]), moved[at] / n[at]
                    else printf " |"
                }
                print ""
            } }'
    remade
}

# The tool prints "fig8 on vulkan: area 12.703; 7 of 19 ways are not beaten".
volumes() {
    echo "| front | area, octaves of cost x octaves of error | ways on it |"
    echo "|---|---|---|"
    sed -n 's/^\(.* on .*\): area \([0-9.]*\); \(.*\) ways are not beaten$/| \1 | \2 | \3 |/p
        s/^\(mean of all scenes on .*\): area \([0-9.]*\)$/| \1 | \2 | |/p' "$out/chart.txt"
    remade
}

# A row a scene and machine, a column a budget: what was chosen, its error, its
# cost over the best's where that is not 1.
regret() {
    csv "$out/regret.csv" "$common"'
        function cell() {
            if ($c["chosen_codes"] == "") return $c["verdict"]
            return name($c["chosen"]) ", " sprintf("%.2f", $c["chosen_codes"]) ($c["regret"] == "" || sprintf("%.2f",
                $c["regret"]) == "1.00" ? "" : sprintf(", x %.2f", $c["regret"])) ($c["verdict"] == "met" ? "" : ", " $c["verdict"])
        }
        {
            key = $c["scene"] ($c["calibrated_on"] == "yes" ? "" : " \\*") " | " $c["machine"]
            b = $c["budget_codes"]
            if (!(key in seen)) { seen[key] = ++rows; order[rows] = key }
            if (!(b in budget)) { budget[b] = ++n; at[n] = b }
            text[key, b] = cell()
        }
        END {
            printf "| scene | machine |"
            for (i = 1; i <= n; i++) printf " %s |", at[i] " codes"
            printf "\n|---|---|"
            for (i = 1; i <= n; i++) printf "---|"
            print ""
            for (r = 1; r <= rows; r++) {
                printf "| %s |", order[r]
                for (i = 1; i <= n; i++) printf " %s |", text[order[r], at[i]]
                print ""
            }
        }'
    echo
    echo "Chosen, its RMS codes, its cost over the best's where that is not 1.00. \\* not a scene that \`halflight calibrate\` draws."
    sed -n '/^regret: worst/,/wrongly/p' "$out/chart.txt" | tr '\n' ' ' | sed 's/^regret: w/W/; s/ *$/./'
    echo
    remade
}

# put NAME FILE: into the document, between its marks.
put() {
    grep -qF "<!-- $1 -->" "$doc" && grep -qF "<!-- /$1 -->" "$doc" || {
        echo "docs: $doc has no place for $1" >&2
        return 0
    }
    awk -v from="<!-- $1 -->" -v to="<!-- /$1 -->" -v file="$2" '
        index($0, to) { inside = 0 }
        !inside { print }
        index($0, from) { inside = 1; while ((getline line < file) > 0) print line }' "$doc" > "$out/new.md"
    cmp -s "$out/new.md" "$doc" || cp "$out/new.md" "$doc"
}

for table in fronts formats volumes; do
    $table > "$out/$table.md"
    put "chart-$table" "$out/$table.md"
done
if [ -s "$out/regret.csv" ]; then
    regret > "$out/regret.md"
    put regret "$out/regret.md"
fi
