#!/bin/bash
# The C and C++ sources have the format of .clang-format, and no line is longer than 120 columns.
# The public headers are laid out by hand: their comments are the manual.
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
exit $failed
