#!/bin/bash
# Instructions of each call, this tree against a commit: a loss of 2 % shows on a busy machine, where times do not.
#
#     bench/instructions.sh [COMMIT]      default: HEAD if there are changes that are not committed, else HEAD^
#
# Counts by callgrind (valgrind) on the surfaces of tests/checks/consumers/hashes.c: inclusive instructions of each public
# function over all of them.  They say nothing of caches and threads; bench/run.sh measures time.
# Fails if a call that takes more than 1 % of all has lost more than LOSS per cent (default 2).
# Environment: LOSS, FLAGS (default "-O3 -DNDEBUG"), JOBS
set -eu
cd "$(dirname "$0")/.."
commit=${1:-$([ -z "$(git status --porcelain -- src include)" ] && echo HEAD^ || echo HEAD)}
commit=$(git rev-parse --short "$commit")
flags=${FLAGS:--O3 -DNDEBUG} work=$PWD/build/instructions
ccache=$(command -v ccache || true)

count() { # folder with src and include, name
    local objects=$work/$2
    rm -rf "$objects"
    mkdir -p "$objects"
    # shellcheck disable=SC2086
    (cd "$objects" && printf '%s\n' "$1"/src/*/*/*.cpp | xargs -P "${JOBS:-$(nproc)}" -n 1 \
        $ccache c++ -std=c++17 $flags -fno-exceptions -fno-rtti -ffp-contract=off -I"$1/include" -c &&
        cc -O1 -I"$1/include" -c "$OLDPWD/tests/checks/consumers/hashes.c" -o program.o && c++ ./*.o -o program)
    valgrind -q --tool=callgrind --callgrind-out-file="$objects/profile" "$objects/program" > "$objects/hashes"
    # "1,234 (5.6%)  file:function [program]"; the public functions are those of the headers.
    callgrind_annotate --inclusive=yes --threshold=100 "$objects/profile" |
        sed -nE 's/^ *([0-9,]+) .*PROGRAM TOTALS.*/all \1/p; s/^ *([0-9,]+) .*:(hmf_[a-z_]+) \[.*/\2 \1/p' |
        tr -d , | sort > "$work/$2.counts"
}

rm -rf "$work/tree"
mkdir -p "$work/tree"
git archive "$commit" include src | tar x -C "$work/tree"
count "$work/tree" before
count "$PWD" now
cmp -s "$work/before/hashes" "$work/now/hashes" || echo "other bits than $commit"
printf '\n| call | %s, millions | now | ratio |\n|---|--:|--:|--:|\n' "$commit"
join "$work/before.counts" "$work/now.counts" | awk -v loss="${LOSS:-2}" '
    { name[NR] = $1; before[NR] = $2; now[NR] = $3; if ($1 == "all") all = $2 }
    END {
        for (i = 1; i <= NR; ++i) {
            if (before[i] < all / 1000) continue
            ratio = now[i] / before[i]
            lost = before[i] > all / 100 && ratio > 1 + loss / 100
            printf "| %s | %.1f | %.1f | %.4f%s |\n", name[i], before[i] / 1e6, now[i] / 1e6, ratio, lost ? " lost" : ""
            failed += lost
        }
        if (NR < 5) { print "too few calls were counted"; exit 1 }
        exit failed > 0
    }'
