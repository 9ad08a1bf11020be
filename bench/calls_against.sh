#!/bin/bash
# Each call of the interface against the first version, in one run.
#
#     bench/calls_against.sh MESH.obj ...
#
# Builds the commit before the foliation became an object (COMMIT, default
# af01c03) beside this tree, runs bench/before/calls and bench_calls by turns
# (TURNS, default 3) and prints the ratio of the smallest processor times.
# "Before" is the count call and the fill call together.
set -eu
cd "$(dirname "$0")/.."
commit=${COMMIT:-af01c03} turns=${TURNS:-3} work=$PWD/build/calls-against
mkdir -p "$work"
if [ ! -e "$work/libhmf.a" ]; then
    rm -rf "$work/tree"
    mkdir "$work/tree"
    git archive "$commit" include src | tar x -C "$work/tree"
    (cd "$work" && for source in tree/src/*/*/*.cpp; do
        c++ -std=c++17 -O3 -DNDEBUG -fno-exceptions -fno-rtti -ffp-contract=off -Itree/include -c "$source"
    done && ar rcs libhmf.a ./*.o && rm ./*.o)
fi
cc -O2 -I"$work/tree/include" bench/before/calls.c "$work/libhmf.a" -lstdc++ -lm -o "$work/before"
cmake -S . -B "$work/now" -DCMAKE_BUILD_TYPE=Release -DHMF_BUILD_BENCH=ON > /dev/null
cmake --build "$work/now" --target bench_calls -j "$(nproc)" > /dev/null
for mesh in "$@"; do
    rm -f "$work"/*.txt
    for ((turn = 0; turn < turns; ++turn)); do
        "$work/before" 1 "$mesh" >> "$work/before.txt"
        "$work/now/bench/bench_calls" --plain -r 1 "$mesh" >> "$work/now.txt"
    done
    printf '\n%s\n\n| call | before s | now s | ratio |\n|---|--:|--:|--:|\n' "$(basename "$mesh")"
    awk '
        { t = $NF; sub(/ [^ ]*$/, ""); name = $0 }
        name ~ /^parameterize/ { name = "parameterize" }
        FILENAME ~ /before.txt$/ { if (!(name in before) || t < before[name]) before[name] = t; if (!seen[name]++) order[++n] = name; next }
        !(name in now) || t < now[name] { now[name] = t }
        END {
            for (i = 1; i <= n; ++i)
                printf "| %s | %.3f | %.3f | %.2f |\n", order[i], before[order[i]], now[order[i]], now[order[i]] / before[order[i]]
        }' "$work/before.txt" "$work/now.txt"
done
