#!/bin/sh
# SPDX-License-Identifier: Zlib
# make-tables.sh TOOL TABLES: the conformance suite on every backend that is
# here and every profile, JSON into build/docs; the tables of docs/*.md that
# are made from it; and a look at what porting.md and packing.md cite. A
# second run changes no byte.
set -eu
tool=$1
tables=$2
out=build/docs
mkdir -p "$out"
runs=
for backend in vulkan gl packemu; do
    for profile in native dx10 xbox360 ps3; do
        json=$out/$backend-$profile.json
        code=0
        "$tool" conform --backend $backend --profile $profile --json "$json" > "$out/tap" 2> "$out/err" || code=$?
        # 3: no such backend or device here.
        if [ $code = 3 ]; then
            echo "docs: $backend, $profile: not here, and so in no table" >&2
        elif [ $code != 0 ]; then
            cat "$out/err" >&2
            exit 1
        else
            runs="$runs $json"
        fi
    done
done
for doc in docs/porting.md docs/packing.md; do
    "$tables" "$doc" $runs > "$out/new.md"
    cmp -s "$out/new.md" "$doc" || cp "$out/new.md" "$doc"
done

# What is cited is there: `group.check` in required.def ('*' for any ending),
# `reason: name` in the planner's texts, `test_file: name` in that file.
bad=0
for word in $(cat docs/porting.md docs/packing.md | grep -o '`[^`]*`' | tr -d '`' | sed 's/: /:/' | grep -E \
    '^(normal|code|ids|depth|dsf|weights|blend|index|centre|plan|ladder|xbox|ps3)\.[a-z0-9_.]+\*?$|^(reason|test_[a-z0-9_]+):[a-z0-9_]+$' | sort -u); do
    case $word in
    reason:*) grep -q "{ \"${word#*:}\"," platforms/cli/plan_reason.c ;;
    test_*) grep -qs "void ${word#*:}(void \*\*" "tests/${word%%:*}.c" ;;
    *\*) grep -qF "(\"${word%\*}" platforms/conform/required.def ;;
    *) grep -qF "(\"$word\"" platforms/conform/required.def ;;
    esac || { echo "docs: $word is cited and not there" >&2; bad=1; }
done
exit $bad
