#!/bin/sh
# check_plain.sh WORK_FOLDER
# check_plain.sh WORK_FOLDER --quick LIBRARY OTHER   compiles nothing of the library: the bits of two that have been built
#
# The library compiles without a build system and without a warning, and
# gives the same bits with each compiler and optimization, also where the
# processor could multiply and add in one (gcc's -O2 and all -O3 run with -march=haswell if it can).
# Two pairs of them; with HMF_PLAIN_ALL=1 all six, as the variant machines does.
# Flags that would give other bits are refused with a sentence.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$1
failed=0
reference=
rm -rf "$work"
mkdir -p "$work"

# The bits that a library gives; OTHER was made by clang with sanitizers.
bits_of() { # library, file, compiler and flags
    library=$1 bits=$2
    shift 2
    "$@" -x c++ -std=c++17 -O1 -I"$root/include" "$root/tests/checks/consumers/hashes.c" -x none "$library" -lpthread -o "$bits.program" &&
        "$bits.program" > "$bits"
}
if [ "${2:-}" = --quick ]; then
    if [ ! -e "$4" ]; then
        echo "skip plain-same-bits (skipped: no $4; ./test.sh sanitizers makes it)"
    elif bits_of "$3" "$work/bits" c++ > "$work/log" 2>&1 &&
        bits_of "$4" "$work/other" clang++ -fsanitize=address,undefined > "$work/log" 2>&1 && cmp "$work/bits" "$work/other"; then
        echo "ok plain-same-bits $(basename "$(dirname "$3")") $(basename "$(dirname "$4")")"
    else
        echo "not ok plain-same-bits $3 $4"
        head -20 "$work/log"
        failed=1
    fi
fi

for cxx in g++ clang++; do
    if ! command -v $cxx > /dev/null; then
        echo "skip plain $cxx (skipped: not installed)"
        continue
    fi
    for flags in "-O2 -ffast-math" -Ofast; do
        # shellcheck disable=SC2086
        if $cxx -std=c++17 $flags -I"$root/include" -c "$root/src/core/base/memory.cpp" -o "$work/refused.o" > "$work/refused.log" 2>&1 ||
            ! grep -q 'error.*hmf needs' "$work/refused.log"; then
            echo "not ok plain-refuses $cxx $flags"
            failed=1
        else
            echo "ok plain-refuses $cxx $flags"
        fi
    done
    case ${HMF_PLAIN_ALL:-}$cxx${2:-} in
    *--quick) levels= ;;
    g++) levels=-O2 ;;
    clang++) levels=-O0 ;; # bindings compares gcc's -O3 with clang's, of WebAssembly
    *) levels="-O0 -O2 -O3" ;;
    esac
    for level in $levels; do
        name=$cxx$level
        case $name in
        g++-O2 | *-O3) grep -qw fma /proc/cpuinfo 2> /dev/null && level="$level -march=haswell" ;;
        esac
        objects=$work/$name
        mkdir -p "$objects"
        if ! (cd "$objects" && printf '%s\n' "$root"/src/*/*/*.cpp | xargs -P "${JOBS:-2}" -n 4 \
                $cxx -std=c++17 $level -Wall -Wextra -Wconversion -Werror -I"$root/include" -c) > "$objects/log" 2>&1; then
            echo "not ok plain $name"
            grep -E ' (error|warning):' "$objects/log" | cut -c 1-200 | head -12
            failed=1
            continue
        fi
        echo "ok plain $name"
        if ! { $cxx -x c++ -std=c++17 -O1 -I"$root/include" -c "$root/tests/checks/consumers/hashes.c" -o "$objects/hashes_program.o" &&
                $cxx "$objects"/*.o -o "$objects/program" && "$objects/program" > "$objects/bits"; } > "$objects/log" 2>&1; then
            echo "not ok plain-runs $name"
            head -20 "$objects/log"
            failed=1
            continue
        fi
        [ -n "$reference" ] || reference=$objects/bits
        if cmp -s "$reference" "$objects/bits"; then
            echo "ok plain-same-bits $name"
        else
            echo "not ok plain-same-bits $name"
            diff "$reference" "$objects/bits"
            failed=1
        fi
    done
done
exit $failed
