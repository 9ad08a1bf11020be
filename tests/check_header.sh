#!/bin/sh
# hmf.h compiles alone and included twice, in every C standard and in C++,
# without a warning, with each compiler that is installed.
# Prints a line "ok", "not ok" or "skip" for each check, as all check_*.sh do.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

cat > "$work/twice.c" <<'END'
#include <hmf/hmf.h>
#include <hmf/hmf.h>
hmf_status use(const hmf_hierarchy *h, hmf_level_info *info, hmf_error *error);
hmf_status use(const hmf_hierarchy *h, hmf_level_info *info, hmf_error *error)
{
    return hmf_level_counts(h, 0, info, error);
}
END
cp "$work/twice.c" "$work/twice.cpp"

check() { # name, then the command
    name=$1
    shift
    if "$@" > "$work/log" 2>&1; then
        echo "ok header $name"
    else
        echo "not ok header $name"
        head -15 "$work/log"
        failed=1
    fi
}

warnings="-Wall -Wextra -Wconversion -Wpedantic -Wshadow -Werror -fsyntax-only -I$root/include"
for cc in gcc clang; do
    if ! command -v $cc > /dev/null; then
        echo "skip header $cc (skipped: not installed)"
        continue
    fi
    for std in c89 c99 c11 c17; do
        check "$cc-$std" $cc -std=$std $warnings -Wstrict-prototypes -Wc++-compat "$work/twice.c"
    done
    check "$cc-c++17" $cc -x c++ -std=c++17 $warnings -Wold-style-cast "$work/twice.cpp"
done
exit $failed
