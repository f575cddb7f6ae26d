#!/bin/sh
# SPDX-License-Identifier: Zlib
# run.sh BUILD: every test program in a process of its own, then check.sh and
# portable.sh.
# Prints a line a program, each failure with its output, each skipped case
# with its reason. A case of must-pass.txt that did not run and pass is a
# failure, so that nothing drops out unseen, but for skipped ones that match
# the pattern $HL_MAY_SKIP (such as "(vulkan)" where there is no driver); a
# crash fails the cases that it kept from running. The last line counts over
# all of them. HL_UPDATE=1 writes must-pass.txt and plans.txt anew.
set -u
build=$1
here=$(dirname "$0")
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
passed=0 failed=0 skipped=0

# Tests draw with the software driver, wherever they run, and keep what it
# compiles between runs.
for icd in /usr/share/vulkan/icd.d/lvp_icd*.json; do
    [ -f "$icd" ] && export VK_DRIVER_FILES="${VK_DRIVER_FILES:-$icd}"
done
[ -n "${XDG_RUNTIME_DIR:-}" ] || export XDG_RUNTIME_DIR="$tmp"
# Absolute: some cases run elsewhere.
export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-$(cd "$build" && pwd)/shader-cache}"
mkdir -p "$MESA_SHADER_CACHE_DIR"
export HL_TOOL="${HL_TOOL:-$build/halflight}"
export ASAN_OPTIONS="${ASAN_OPTIONS:-allocator_may_return_null=1:detect_leaks=0}"

# cases KIND FILE: names of the cases with that mark, one a line: a word, and
# in brackets the backend that it ran on.
cases() {
    sed -n "s/.*\[ *$1 *\] \([A-Za-z_][A-Za-z0-9_]*\( ([a-z]*)\)\{0,1\}\).*/\1/p" "$2" | sort -u
}

one() {
    name=$1
    log=$tmp/$name.log
    start=$(date +%s)
    # Two files: cmocka writes to both, and a buffered line that the other
    # stream cuts in two would be no line at all.
    timeout 900 "$build/tests/$name" > "$log" 2> "$log.err"
    rc=$?
    cat "$log.err" >> "$log"
    cases OK "$log" > "$tmp/ok"
    cases FAILED "$log" > "$tmp/bad"
    cases SKIPPED "$log" > "$tmp/skip"
    cases RUN "$log" > "$tmp/run"
    if ! [ -s "$tmp/run" ]; then    # not a cmocka program: one case
        echo "$name" > "$tmp/run"
        case $rc in
        0) echo "$name" > "$tmp/ok" ;;
        77) echo "$name" > "$tmp/skip" ;;
        *) echo "$name" > "$tmp/bad" ;;
        esac
    fi
    # Neither passed nor failed nor skipped: the program died in it.
    sort -u "$tmp/ok" "$tmp/bad" "$tmp/skip" | comm -13 - "$tmp/run" >> "$tmp/bad"
    grep -vxF -f "$tmp/bad" "$tmp/ok" > "$tmp/good"
    grep -vxF -f "$tmp/bad" "$tmp/skip" > "$tmp/skips"
    p=$(wc -l < "$tmp/good") f=$(sort -u "$tmp/bad" | wc -l) s=$(wc -l < "$tmp/skips")
    [ "$rc" -ne 0 ] && [ "$rc" -ne 77 ] && [ "$f" -eq 0 ] && f=1
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    sed "s/^/$name /" "$tmp/good" >> "$tmp/all-passed"
    sed "s/^/$name /" "$tmp/skips" >> "$tmp/all-skipped"
    printf '%-24s %4d passed, %d failed, %d skipped  (%d s)\n' "$name" "$p" "$f" "$s" \
        $(($(date +%s) - start))
    while read -r c; do
        why=$(grep -m 1 -B 3 "SKIPPED *\] $c" "$log" | grep -v '\[' | tail -n 1)
        echo "    skipped: $c: ${why:-no reason given}"
    done < "$tmp/skips"
    if [ "$f" -gt 0 ]; then
        sort -u "$tmp/bad" | sed 's/^/    failed: /'
        grep -v '\[ *\(RUN\|OK\) *\]' "$log" | tail -n 40 | sed 's/^/    | /'
    fi
}

: > "$tmp/all-passed"
: > "$tmp/all-skipped"
# Benchmarks lie beside the suites, and are none.
for program in "$build"/tests/test_* "$build"/tests/embed; do
    [ -x "$program" ] && one "$(basename "$program")"
done

# Scripts that print their cases as "ok NAME", "not ok NAME", "skip NAME: why".
script() {
    start=$(date +%s)
    sh "$here/$1.sh" "$build" > "$tmp/$1.log" 2>&1
    rc=$?
    p=$(grep -c '^ok ' "$tmp/$1.log") f=$(grep -c '^not ok ' "$tmp/$1.log")
    s=$(grep -c '^skip ' "$tmp/$1.log")
    [ "$rc" -ne 0 ] && [ "$f" -eq 0 ] && f=1
    printf '%-24s %4d passed, %d failed, %d skipped  (%d s)\n' "$1" "$p" "$f" "$s" \
        $(($(date +%s) - start))
    grep -v '^ok ' "$tmp/$1.log" | sed 's/^/    /'
    sed -n "s/^ok /$1 /p" "$tmp/$1.log" >> "$tmp/all-passed"
    sed -n "s/^skip \([^:]*\):.*/$1 \1/p" "$tmp/$1.log" >> "$tmp/all-skipped"
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
}
script check
script portable

sort -u "$tmp/all-passed" > "$tmp/have"
if [ -n "${HL_UPDATE:-}" ]; then
    # But for those that need what a machine may lack: scenes beside the
    # project, a C++ compiler, a processor with AVX2.
    grep -vE 'third_party_files_load|the_lidr_rooms_lights|headers_alone_cxx|x86_64_v3' "$tmp/have" \
        > "$here/must-pass.txt"
    echo "must-pass.txt: written"
fi
[ -n "${HL_MAY_SKIP:-}" ] && grep -e "$HL_MAY_SKIP" "$tmp/all-skipped" >> "$tmp/have"
sort -u -o "$tmp/have" "$tmp/have"
grep -v '^#' "$here/must-pass.txt" | sort -u | comm -13 "$tmp/have" - > "$tmp/missing"
if [ -s "$tmp/missing" ]; then
    echo "must pass, but did not run and pass:"
    sed 's/^/    /' "$tmp/missing"
    failed=$((failed + $(wc -l < "$tmp/missing")))
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
