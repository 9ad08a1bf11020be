#!/bin/sh
# hmf.h and applications.h compile alone and included twice, in every C standard and in
# C++, and hmf.hpp and applications.hpp in C++17 and C++20, without a warning, with each
# compiler that is installed.  hmf.h and hmf.hpp need no header of the applications.
# Prints a line "ok", "not ok" or "skip" for each check, as all check_*.sh do.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

cat > "$work/hmf.c" <<'END'
#include <hmf/hmf.h>
#include <hmf/hmf.h>
hmf_status use(const hmf_hierarchy *h, hmf_level_mesh **out, hmf_error *error);
hmf_status use(const hmf_hierarchy *h, hmf_level_mesh **out, hmf_error *error)
{
    return hmf_level(h, 0, NULL, out, error);
}
END
cat > "$work/applications.c" <<'END'
#include <hmf/applications.h>
#include <hmf/applications.h>
hmf_status use(const hmf_foliation *f, hmf_quad_mesh **out, hmf_error *error);
hmf_status use(const hmf_foliation *f, hmf_quad_mesh **out, hmf_error *error)
{
    return hmf_quads(f, NULL, NULL, out, error);
}
END
cat > "$work/hmf.hpp.cpp" <<'END'
#include <hmf/hmf.hpp>
#include <hmf/hmf.hpp>
hmf::Solution use(const std::vector<double>& positions, const std::vector<uint32_t>& triangles, const hmf::Loops& loops);
hmf::Solution use(const std::vector<double>& positions, const std::vector<uint32_t>& triangles, const hmf::Loops& loops)
{
    const hmf::Hierarchy hierarchy(positions, triangles);
    hmf::Solution solution = hierarchy.solve(loops);
    return solution.foliation.singularities()->count == 0 ? solution.foliation.relax() : std::move(solution);
}
END
cat > "$work/applications.hpp.cpp" <<'END'
#include <hmf/applications.hpp>
#include <hmf/applications.hpp>
double use(const hmf::Hierarchy& hierarchy, const hmf::Foliation& foliation, const hmf::Loops& loops);
double use(const hmf::Hierarchy& hierarchy, const hmf::Foliation& foliation, const hmf::Loops& loops)
{
    const hmf::Parameterization map = hmf::parameterize(hmf::solve_cut_system(hierarchy).foliation);
    return map.corner_uv()[0] + hmf::trace(foliation).points()[0] + hmf::quads(foliation).positions()[0]
           + hmf::cylinders(foliation, loops).list()[0].height + hmf::cylinders(foliation).leaves().weights[0];
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

warnings="-Wall -Wextra -Wconversion -Wpedantic -Wshadow -Werror -fsyntax-only"
mkdir -p "$work/core/hmf"
cp "$root/include/hmf/hmf.h" "$root/include/hmf/hmf.hpp" "$work/core/hmf"
for cc in gcc clang; do
    if ! command -v $cc > /dev/null; then
        echo "skip header $cc (skipped: not installed)"
        continue
    fi
    for header in hmf applications; do
        case $header in hmf) include=$work/core ;; *) include=$root/include ;; esac
        for std in c89 c99 c11 c17; do
            check "$cc-$header-$std" $cc -std=$std $warnings -I"$include" -Wstrict-prototypes -Wc++-compat "$work/$header.c"
        done
        check "$cc-$header-c++17" $cc -x c++ -std=c++17 $warnings -I"$include" -Wold-style-cast "$work/$header.c"
        for std in c++17 c++20; do
            check "$cc-$header-hpp-$std" $cc -x c++ -std=$std $warnings -I"$include" -Wold-style-cast "$work/$header.hpp.cpp"
        done
    done
done

# hmf.hpp and applications.hpp together leave out no function of hmf.h and applications.h.
complete() {
    missing=0
    cat "$root/include/hmf/hmf.h" "$root/include/hmf/applications.h" > "$work/all.h"
    cat "$root/include/hmf/hmf.hpp" "$root/include/hmf/applications.hpp" | sed 's|/\*.*\*/||' > "$work/code.hpp" # without comments
    for symbol in $(sed -n 's/^HMF_API .*[ *]\(hmf_[a-z_]*\)(.*/\1/p' "$work/all.h" | grep -v -e '^hmf_version$' -e '^hmf_status_string$'); do
        grep -qw "$symbol" "$work/code.hpp" || { echo "the C++ headers lack $symbol"; missing=1; }
    done
    return $missing
}
check "hpp-complete" complete
exit $failed
