#!/bin/bash
# Tests of the tests: each defect of a table is put into a copy of the sources,
# and the test named beside it must fail.
#
#     tests/mutations.sh FOLDER [PATTERN]
#
# FOLDER is for the copy and its build, only lines that match PATTERN are done.
#
# Columns: file, sed expression, program, cases of it.  An expression that
# changes nothing is a failure: the table goes with the sources.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
pattern=${2:-.}
jobs=${JOBS:-$(nproc)}
tree=$folder/tree

table() {
    grep -v -e '^#' -e '^$' << 'END' | grep -E -- "$pattern"
# The class: heights, cores, the way back
src/leaves/class_certificate.cpp    s/if (found == wanted) continue/continue/                                test_class         ClassCertificate.*
src/leaves/class_certificate.cpp    s/if (same(spoke_.data() + offset_\[c\], .* walk)) {$/if (c == d) {/     test_class         ClassCertificate.*
src/solve/class_watch.cpp           s/^    std::memcpy(f.value, values.data(), .*//                          test_class         ClassGuard.*
END
}

# A fresh copy; files that are as before keep their times, so that little is built again.
copy() {
    local part file
    rm -rf "$folder/new"
    mkdir -p "$tree" "$folder/new"
    (cd "$root" && tar cf - CMakeLists.txt include src bindings/readers tests) | (cd "$folder/new" && tar xf -)
    (cd "$folder/new" && find . -type f) | while read -r file; do
        cmp -s "$folder/new/$file" "$tree/$file" && continue
        mkdir -p "$(dirname "$tree/$file")"
        cp "$folder/new/$file" "$tree/$file"
    done
    rm -rf "$folder/new"
}

build() { # program ...
    cmake --build "$folder/build" -j "$jobs" --target "$@" > "$folder/build.log" 2>&1
}

run() { # program, cases
    timeout 600 "$folder/build/tests/$1" --gtest_filter="$2" > "$folder/run.log" 2>&1
}

copy
cmake -S "$tree" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DHMF_BUILD_TESTS=ON \
    -DHMF_BUILD_CLI=OFF -DHMF_INSTALL=OFF > "$folder/configure.log" 2>&1 || {
    echo "not ok mutations: cmake failed, see $folder/configure.log"
    exit 1
}
read -r -d '' -a programs < <(table | awk '{ print $(NF - 1) }' | sort -u)
if [ ${#programs[@]} -eq 0 ]; then
    echo "skip mutations (skipped: no line matches $pattern)"
    exit 0
fi
build "${programs[@]}" || {
    echo "not ok mutations: the build failed"
    tail -20 "$folder/build.log"
    exit 1
}

failed=0
report() { # ok or not ok, text
    echo "$1 $2"
    [ "$1" = ok ] || failed=1
}

# Without a defect the same cases pass.
while read -r program cases; do
    if run "$program" "$cases" && grep -q '^\[  PASSED  \] [1-9]' "$folder/run.log"; then report ok "$program $cases"
    else report "not ok" "$program $cases fails without a defect, or selects no test"; fi
done < <(table | awk '{ print $(NF - 1), $NF }' | sort -u)

while read -r line; do
    file=${line%% *}
    program=$(awk '{ print $(NF - 1) }' <<< "$line")
    cases=${line##* }
    change=$(sed "s/^[^ ]* *//; s/ *$program *[^ ]*$//" <<< "$line")
    cp -p "$tree/$file" "$folder/original"
    sed "$change" "$folder/original" > "$tree/$file"
    if cmp -s "$folder/original" "$tree/$file"; then report "not ok" "$file: '$change' changes nothing"
    elif ! build "$program"; then report "not ok" "$file: with '$change' it does not compile"
    elif run "$program" "$cases"; then report "not ok" "$file: '$change' survives $program $cases"
    else report ok "$file: '$change' is noticed by $(sed -n 's/^\[  FAILED  \] \([A-Za-z0-9_/]*\.[A-Za-z0-9_/]*\).*/\1/p' "$folder/run.log" | head -1)"; fi
    cp "$folder/original" "$tree/$file" # a new time: what was built of the defect is built again
done < <(table)
exit $failed
