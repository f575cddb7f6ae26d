#!/bin/sh
# SPDX-License-Identifier: Zlib
# portable.sh BUILD: the software device on other compilers and another order
# of bytes. Frames must have the same bytes everywhere, down to every target's
# memory. One line a check: "ok NAME", "not ok NAME" with what is wrong below
# it, or "skip NAME: reason". Exit 1 when one failed.
set -u
build=$1
cd "$(dirname "$0")/.." || exit 1
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
out=$build/portable
mkdir -p "$out"
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
    : > "$tmp/out"
}
has() { command -v "$1" > /dev/null 2>&1; }

# build NAME CC CFLAGS TARGETS: into $out/NAME; false when it failed.
build() {
    # MAKEFLAGS: what make was called with for the suites is not for here.
    if ! MAKEFLAGS='' make -j2 --no-print-directory B="$out/$1" CC="$2" CFLAGS="$3" config=release \
            $4 > "$tmp/build.log" 2>&1; then
        grep -v '^  [A-Z]' "$tmp/build.log" > "$tmp/out"
        [ -s "$tmp/out" ] || echo "make failed" > "$tmp/out"
        verdict "build_$1"
        return 1
    fi
    : > "$tmp/out"
    verdict "build_$1"
}

qemu='qemu-ppc64 -L /usr/powerpc64-linux-gnu'
# run NAME ARGUMENTS: the program of that build.
run() {
    name=$1
    shift
    case $name in
    powerpc) $qemu "$out/$name/halflight-packemu" "$@" ;;
    *) "$out/$name/halflight-packemu" "$@" ;;
    esac
}

# frames NAME THREADS FILE: fig8 with every profile and pipeline.
frames() {
    for profile in native dx10 xbox360 ps3; do
        for pipeline in inferred forward; do
            run "$1" fig8 --size 160x90 --profile $profile --pipeline $pipeline --threads "$2" --targets
        done
    done > "$3" 2>&1
}
# same CHECK NAME THREADS: its frames are those of gcc on one thread.
same() {
    frames "$2" "$3" "$tmp/frames"
    diff "$tmp/gcc" "$tmp/frames" > "$tmp/out"
    verdict "$1"
}

case $build in
*sanitize*|*coverage*) echo "skip builds_and_frames: instrumented build" ;;
*)
if ! build gcc "gcc -std=c99" "" packemu; then exit 1; fi
# Names of libraries in the brackets of readelf's lines.
readelf -d "$out/gcc/halflight-packemu" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' |
    grep -vE '^(libc|libm|libpthread|ld-linux[a-z0-9-]*)\.so\.[0-9]+$' > "$tmp/out"
verdict c_library_alone
frames gcc 1 "$tmp/gcc"
# Targets and frames: 5 at least of an inferred frame, 3 of a forward one.
[ "$(grep -cE '^[a-z_]+ +(160x90|100x56) ' "$tmp/gcc")" -ge 32 ] || cp "$tmp/gcc" "$tmp/out"
verdict frames_are_drawn
same frames_two_threads gcc 2
same frames_three_threads gcc 3
build no_threads gcc "-O1 -DPE_NO_THREADS" packemu && same frames_no_threads no_threads 0
if has clang; then
    build clang clang -O2 packemu && same frames_clang clang 2
else
    echo "skip build_clang: no clang here"
    echo "skip frames_clang: no clang here"
fi
if grep -q ' avx2 .* fma \| fma .* avx2 ' /proc/cpuinfo 2> /dev/null; then
    build x86_64_v3 gcc "-march=x86-64-v3" packemu && same frames_x86_64_v3 x86_64_v3 2
else
    echo "skip build_x86_64_v3: no such processor"
    echo "skip frames_x86_64_v3: no such processor"
fi
if has powerpc64-linux-gnu-gcc && has qemu-ppc64; then
    if build powerpc powerpc64-linux-gnu-gcc -O2 "packemu plain-tests"; then
        # What takes long, in the background.
        run powerpc conform --quick --profile xbox360 > "$tmp/conform_powerpc" 2>&1 &
        same frames_powerpc powerpc 2
        for test in "$out"/powerpc/plain/test_*; do
            $qemu "$test" > "$tmp/log" 2>&1 && continue
            echo "$(basename "$test"):" >> "$tmp/out"
            grep -v 'RUN\|   OK ' "$tmp/log" | tail -n 10 >> "$tmp/out"
        done
        verdict tests_powerpc
        wait
        run gcc conform --quick --profile xbox360 > "$tmp/conform_gcc" 2>&1
        grep -q '^# .* 0 failed' "$tmp/conform_powerpc" || cp "$tmp/conform_powerpc" "$tmp/out"
        verdict conform_powerpc
        # Even the worst cases are the same.
        diff "$tmp/conform_gcc" "$tmp/conform_powerpc" > "$tmp/out"
        verdict conform_powerpc_figures
    fi
else
    for check in build frames tests conform; do
        echo "skip ${check}_powerpc: no powerpc64-linux-gnu-gcc or qemu-ppc64 here"
    done
    echo "skip conform_powerpc_figures: no powerpc64-linux-gnu-gcc or qemu-ppc64 here"
fi ;;
esac

# A few seconds of random plans and passes; make fuzz runs them for long.
for f in fuzz_plan fuzz_packemu; do
    runs=10000
    [ $f = fuzz_packemu ] && runs=400
    HL_FUZZ_RUNS=$runs "$build/fuzz/$f" > "$tmp/log" 2>&1 || cp "$tmp/log" "$tmp/out"
    verdict $f
done
exit $bad
