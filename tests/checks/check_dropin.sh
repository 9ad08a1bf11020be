#!/bin/sh
# check_dropin.sh WORK_FOLDER BUILD_FOLDER
#
# The files that src/packaging/amalgamate.py makes compile with one command each, without a warning, and give
# the same bits as the libraries of the build folder, on the meshes of bindings/same_bits.  Without
# optimization, which takes seconds: check_plain.sh compares levels of optimization.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$1
build=$(cd "$2" && pwd)
failed=0
rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd)
"$root/src/packaging/amalgamate.py" "$work" || exit 1

compare() { # file, program of bindings/same_bits, library
    mkdir -p "$work/hmf" && cp "$work"/*.h "$work/hmf"
    if ! (cd "$work" && c++ -std=c++17 -O0 -Wall -Wextra -Werror -c "$1.cpp") > "$work/$1.log" 2>&1; then
        echo "not ok dropin $1"
        grep -E ' (error|warning):' "$work/$1.log" | cut -c 1-200 | head -12
        failed=1
    elif ! (cc -std=c99 -I"$work" "$root/bindings/same_bits/$2.c" "$work/$1.o" -lstdc++ -lm -o "$work/$1-dropin" &&
            cc -std=c99 -I"$root/include" "$root/bindings/same_bits/$2.c" "$build/$3" -lstdc++ -lm -o "$work/$1-library" &&
            "$work/$1-dropin" > "$work/$1.txt" && "$work/$1-library" > "$work/$1-library.txt" && test -s "$work/$1.txt") \
            > "$work/$1.log" 2>&1; then
        echo "not ok dropin-runs $1"
        head -12 "$work/$1.log"
        failed=1
    elif ! cmp -s "$work/$1.txt" "$work/$1-library.txt"; then
        echo "not ok dropin-same-bits $1"
        diff "$work/$1.txt" "$work/$1-library.txt"
        failed=1
    else
        echo "ok dropin $1"
    fi
}

compare hmf_core own_loops libhmf_core.a
compare hmf same_bits libhmf.a
exit $failed
