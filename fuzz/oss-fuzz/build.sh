#!/bin/bash -eu
# Builds every fuzz target into $OUT, each with its corpus as NAME_seed_corpus.zip.  OSS-Fuzz sets CC, CXX, CFLAGS,
# CXXFLAGS, LIB_FUZZING_ENGINE, SRC, WORK and OUT; ./test.sh fuzzing does the same on any machine with clang.
source=$SRC/hmf
cmake -S "$source" -B "$WORK/hmf" -DCMAKE_BUILD_TYPE=None -DHMF_BUILD_CLI=OFF -DHMF_INSTALL=OFF -DHMF_BUILD_FUZZ=ON \
    -DHMF_FUZZING_ENGINE="$LIB_FUZZING_ENGINE"
targets=()
for file in "$source"/fuzz/*.cpp; do
    name=$(basename "$file" .cpp)
    [ "$name" = driver ] || targets+=("$name")
done
cmake --build "$WORK/hmf" -j "${JOBS:-$(nproc)}" --target "${targets[@]}"
for name in "${targets[@]}"; do
    cp "$WORK/hmf/fuzz/$name" "$OUT/"
    if [ -d "$source/fuzz/corpus/$name" ]; then (cd "$source/fuzz/corpus/$name" && zip -q -r "$OUT/${name}_seed_corpus.zip" .); fi
done
