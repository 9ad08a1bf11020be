#!/bin/sh
# check_static.sh WORK_FOLDER
#
# Static analysis of the core: clang-tidy with the list in .clang-tidy (the
# static analyzer of clang is in it), cppcheck, the analyzer of gcc, and the stack:
# every function has a bounded frame, and no chain of calls goes round.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
jobs=${JOBS:-$(nproc)}
failed=0
cd "$root" || exit 1

if command -v clang-tidy > /dev/null; then
    rm -rf "$work/tidy" && mkdir -p "$work/tidy"
    for source in src/*/*/*.cpp; do printf '%s\n' "$source"; done | xargs -P "$jobs" -I{} sh -c \
        'clang-tidy --quiet "$1" -- -std=c++17 -Iinclude > "$2/$(basename "$1").log" 2> /dev/null || echo "$1"' sh {} "$work/tidy" \
        > "$work/tidy-failed"
    if [ -s "$work/tidy-failed" ]; then
        echo "not ok static clang-tidy"
        cat "$work"/tidy/*.log | grep -E ': (error|warning):' | sort -u | head -30
        failed=1
    else
        echo "ok static clang-tidy: $(ls src/*/*/*.cpp | wc -l) files"
    fi
else
    echo "skip static clang-tidy (skipped: not installed)"
fi

# Its parser takes size_t{3} * v for a pointer, and arrays that are filled by a call for uninitialized.
if command -v cppcheck > /dev/null; then
    if cppcheck --quiet -j "$jobs" --std=c++17 --language=c++ --enable=warning,portability --inline-suppr --error-exitcode=1 \
        --suppress=missingIncludeSystem --suppress=constStatement --suppress=CastIntegerToAddressAtReturn \
        --suppress=uninitvar --suppress=legacyUninitvar --suppress=arrayIndexThenCheck --suppress=invalidPointerCast \
        --suppress=compareBoolExpressionWithInt --suppress=uselessAssignmentPtrArg -Iinclude src > "$work/cppcheck.log" 2>&1; then
        echo "ok static cppcheck"
    else
        echo "not ok static cppcheck"
        grep -E '^src' "$work/cppcheck.log" | head -20
        failed=1
    fi
else
    echo "skip static cppcheck (skipped: not installed)"
fi

# The analyzer of gcc, which is made for C.  Left out, with the reason:
#   null-dereference, null-argument  it forgets that a function of another file refused NULL, and that a count is the same
#                                    when it is read again; the analyzer of clang has these
#   use-of-uninitialized-value       a loop over three coordinates may end before it began, it thinks; valgrind has it
if command -v g++ > /dev/null && g++ -fanalyzer -E -x c++ - < /dev/null > /dev/null 2>&1; then
    if printf '%s\n' src/*/*/*.cpp | xargs -P "$jobs" -n 1 \
        g++ -std=c++17 -O2 -fanalyzer -Wno-analyzer-null-dereference -Wno-analyzer-null-argument \
        -Wno-analyzer-use-of-uninitialized-value -Werror -Iinclude -c -o /dev/null > "$work/gcc.log" 2>&1; then
        echo "ok static gcc: $(ls src/*/*/*.cpp | wc -l) files"
    else
        echo "not ok static gcc"
        grep -E '(error|warning):' "$work/gcc.log" | sort -u | head -20
        failed=1
    fi
else
    echo "skip static gcc (skipped: no g++ with an analyzer)"
fi

# Frames and calls as gcc sees them.
if command -v g++ > /dev/null && command -v python3 > /dev/null; then
    rm -rf "$work/stack" && mkdir -p "$work/stack"
    if (cd "$work/stack" && printf '%s\n' "$root"/src/*/*/*.cpp | xargs -P "$jobs" -n 4 \
            g++ -std=c++17 -O2 -fcallgraph-info=su -I"$root/include" -c) > "$work/stack.log" 2>&1; then
        python3 "$root/tests/checks/stack_use.py" "$work/stack" || failed=1
    else
        echo "not ok static stack: the build failed"
        failed=1
    fi
else
    echo "skip static stack (skipped: no g++ or python3)"
fi
exit $failed
