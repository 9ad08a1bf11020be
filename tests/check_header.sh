#!/bin/sh
# hmf.h compiles alone and included twice, in every C standard and in C++, and
# hmf.hpp in C++17 and C++20, without a warning, with each compiler that is installed.
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
cat > "$work/classes.cpp" <<'END'
#include <hmf/hmf.hpp>
#include <hmf/hmf.hpp>
hmf::Solution use(const std::vector<double>& positions, const std::vector<uint32_t>& triangles);
hmf::Solution use(const std::vector<double>& positions, const std::vector<uint32_t>& triangles)
{
    const hmf::Hierarchy hierarchy(positions, triangles);
    hmf::Solution solution = hierarchy.solve(hierarchy.loops(0));
    return solution.foliation.zeros_and_poles().empty() ? solution.foliation.relax() : std::move(solution);
}
END

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
    for std in c++17 c++20; do
        check "$cc-hpp-$std" $cc -x c++ -std=$std $warnings -Wold-style-cast "$work/classes.cpp"
    done
done

# hmf.hpp leaves out no function of hmf.h but those that only fill in defaults,
# and names every choice.
complete() {
    missing=0
    sed 's|/\*.*\*/||' "$root/include/hmf/hmf.hpp" > "$work/code.hpp" # without comments
    for symbol in $(sed -n 's/^HMF_API .*[ *]\(hmf_[a-z_]*\)(.*/\1/p' "$root/include/hmf/hmf.h" | grep -v -e '_options_init$' -e '^hmf_version$' -e '^hmf_status_string$') \
        $(sed -n 's/^#define \(HMF_\(COLLAPSE\|METHOD\|LEAVES\|LOOP\|LOOPS\|PROGRESS\)_[A-Z_]*\).*/\1/p' "$root/include/hmf/hmf.h"); do
        grep -qw "$symbol" "$work/code.hpp" || { echo "hmf.hpp lacks $symbol"; missing=1; }
    done
    return $missing
}
check hpp-complete complete
exit $failed
