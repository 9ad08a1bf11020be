#!/bin/bash
# The C and C++ sources have the format of .clang-format, and no line is longer than 120 columns.
# The public headers are laid out by hand: their comments are the manual.  Names have the style of .clang-tidy.
#
#     tests/checks/check_format.sh
set -u
cd "$(dirname "$0")/../.." || exit 1
sources=$(git ls-files '*.cpp' '*.hpp' '*.c' 2> /dev/null | grep -v '^include/') # links into src and include are not listed again
if [ -z "$sources" ]; then
    echo "skip format (skipped: not a git checkout)"
    exit 0
fi

failed=0
long=$(awk 'length($0) > 120 && !/https?:\/\// { print FILENAME ":" FNR }' $sources include/hmf/*)
if [ -z "$long" ]; then echo "ok columns"; else printf 'not ok columns: lines above 120\n%s\n' "$long" && failed=1; fi

# Other versions break lines in other places.
if ! clang-format --version 2> /dev/null | grep -q 'version 14\.'; then
    echo "skip format (skipped: needs clang-format 14)"
elif differ=$(clang-format --dry-run -Werror $sources 2>&1); then
    echo "ok format"
else
    printf 'not ok format: run clang-format -i on these\n%s\n' "$(grep -o '^[^:]*' <<< "$differ" | sort -u | head -20)"
    failed=1
fi

# All of src as one file: a header is read once.
if ! clang-tidy --version > /dev/null 2>&1; then
    echo "skip names (skipped: needs clang-tidy)"
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    printf "#include \"$PWD/%s\"\n" src/*/*/*.cpp > "$work/all.cpp"
    if clang-tidy --quiet --config-file=.clang-tidy --checks='-*,readability-identifier-naming' --header-filter='.*' \
        "$work/all.cpp" -- -std=c++17 -Iinclude > "$work/log" 2>&1; then
        echo "ok names"
    else
        printf 'not ok names: the style is in .clang-tidy\n%s\n' "$(grep error: "$work/log" | sort -u | head -20)"
        failed=1
    fi
fi
exit $failed
