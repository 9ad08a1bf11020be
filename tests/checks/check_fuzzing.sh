#!/bin/bash
# check_fuzzing.sh WORK_FOLDER
#
# Each fuzz target with libFuzzer and sanitizers. Findings and the grown corpora stay in WORK_FOLDER.
# Environment: HMF_FUZZ_SECONDS  for each target (default 1800)
#              HMF_FUZZ_TARGETS  which, in this order (default: all)
set -u
cd "$(dirname "$0")/../.." || exit 1
mkdir -p "$1"
work=$(cd "$1" && pwd)
failed=0
if ! command -v clang++ > /dev/null; then
    echo "skip fuzzing (skipped: no clang++)"
    exit 0
fi
mkdir -p "$work/out" "$work/work" "$work/src"
ln -sfn "$PWD" "$work/src/hmf"
if ! CC=clang CXX=clang++ CFLAGS='' SRC=$work/src WORK=$work/work OUT=$work/out LIB_FUZZING_ENGINE=-fsanitize=fuzzer \
    CXXFLAGS="-O1 -gline-tables-only -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all" \
    bash -eu fuzz/oss-fuzz/build.sh > "$work/build.log" 2>&1; then
    echo "not ok fuzzing: the build failed"
    tail -20 "$work/build.log"
    exit 1
fi
# libFuzzer measures a timeout on the clock: packing of charts, 13 s with sanitizers, is no finding on a busy machine.
for name in ${HMF_FUZZ_TARGETS:-$(cd fuzz && ls ./*.cpp | sed 's|^./||; s|\.cpp$||; /^driver$/d')}; do
    mkdir -p "$work/corpus/$name" "$work/found/$name"
    log=$work/$name.log corpora=("$work/corpus/$name")
    [ ! -d "fuzz/corpus/$name" ] || corpora+=("fuzz/corpus/$name")
    if "$work/out/$name" -max_total_time="${HMF_FUZZ_SECONDS:-1800}" -timeout=600 -rss_limit_mb=4000 -print_final_stats=1 \
        -artifact_prefix="$work/found/$name/" "${corpora[@]}" > "$log" 2>&1; then
        echo "ok fuzzing $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, \
$(grep -o 'cov: [0-9]*' "$log" | tail -1 | cut -c 6-) edges reached"
    else
        echo "not ok fuzzing $name: the input is in $work/found/$name"
        tail -5 "$log"
        failed=1
    fi
done
exit $failed
