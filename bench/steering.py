#!/usr/bin/env python3
"""What the numbers of src/core/solve/parameters.hpp are worth.

    bench/steering.py [--only NAME] BUILD MESH.obj ...

BUILD has the static library.  The solver is compiled once with variables in place
of the constants; then each of them is halved and doubled, by turns with its own value:
processor time and linear solves of all meshes (loops: cut and pants, twice,
the smallest), as ratios.  The table is bench/steering.md.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = r"""
#include <hmf/applications.h>
#include <time.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>
#include "src/core/solve/parameters.hpp"

namespace {
struct Number { const char* name; double* real; uint32_t* whole; size_t* size; };
using namespace hmf::parameters;
Number numbers[] = {
#include "steering_table.inc"
};
void set(Number& n, double x) {
    if (n.real) *n.real = x;
    if (n.whole) *n.whole = static_cast<uint32_t>(x);
    if (n.size) *n.size = static_cast<size_t>(x);
}
double get(const Number& n) { return n.real ? *n.real : n.whole ? *n.whole : static_cast<double>(*n.size); }
struct Problem { hmf_hierarchy* h; hmf_loop_set* loops; };
struct Result { double seconds = 0; uint64_t solves = 0; int unsolved = 0; };
double now() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}
void solve_all(const std::vector<Problem>& problems, std::vector<double>& least, Result& r) {
    r = Result{};
    least.resize(problems.size(), 1e9);
    for (size_t i = 0; i < problems.size(); ++i) {
        hmf_foliation* f = nullptr;
        const double start = now();
        const hmf_status s = hmf_solve(problems[i].h, problems[i].loops, nullptr, nullptr, &f, nullptr);
        const double t = now() - start;
        if (t < least[i]) least[i] = t;
        r.seconds += least[i];
        r.unsolved += s != HMF_OK;
        if (const hmf_report* report = f ? hmf_foliation_report(f) : nullptr)
            for (uint64_t k = 0; k < report->level_count; ++k) r.solves += report->levels[k].linear_solve_count;
        hmf_foliation_destroy(f);
    }
}
}

int main(int count, char** arguments) {
    std::vector<Problem> problems;
    const char* only = arguments[1];
    for (int a = 2; a < count; ++a) {
        std::vector<double> p;
        std::vector<uint32_t> t;
        FILE* file = std::fopen(arguments[a], "r");
        if (!file) return 1;
        char line[1024];
        while (std::fgets(line, sizeof line, file)) {
            double x, y, z;
            long i[3];
            if (line[0] == 'v' && line[1] == ' ' && std::sscanf(line + 2, "%lf %lf %lf", &x, &y, &z) == 3)
                p.insert(p.end(), {x, y, z});
            if (line[0] == 'f' && (std::sscanf(line + 2, "%ld %ld %ld", i, i + 1, i + 2) == 3
                                   || std::sscanf(line + 2, "%ld%*s %ld%*s %ld", i, i + 1, i + 2) == 3))
                for (long k : i) t.push_back(uint32_t(k - 1));
        }
        std::fclose(file);
        hmf_hierarchy* h = nullptr;
        hmf_error e{};
        if (hmf_hierarchy_create(p.data(), p.size() / 3, t.data(), t.size() / 3, nullptr, nullptr, &h, &e)) {
            std::fprintf(stderr, "%s: %s\n", arguments[a], e.message);
            return 1;
        }
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            hmf_loop_set* loops = nullptr;
            if (hmf_loops(h, hmf_hierarchy_describe(h)->level_count - 1, kind, nullptr, &loops, &e)) {
                std::fprintf(stderr, "%s: %s\n", arguments[a], e.message);
                return 1;
            }
            problems.push_back({h, loops});
        }
    }
    Result chosen, tried;
    std::vector<double> warm;
    solve_all(problems, warm, chosen);
    std::printf("%zu problems, %.2f s, %d linear solves, %d unsolved\n\n", problems.size(), chosen.seconds,
                int(chosen.solves), chosen.unsolved);
    std::printf("| constant | value | tried | time | linear solves | unsolved |\n|---|--:|--:|--:|--:|--:|\n");
    for (Number& n : numbers) {
        if (*only && !std::strstr(n.name, only)) continue;
        const double value = get(n);
        for (const double factor : {0.5, 2.0}) {
            double other = value * factor;
            if (!n.real) other = factor < 1 ? double(size_t(value / 2)) : value * 2;
            if (!n.real && other == value) continue;
            if (!n.real && std::strstr(n.name, "EVERY") && other < 1) continue;
            std::vector<double> least_chosen, least_tried;
            for (int turn = 0; turn < 2; ++turn) {
                set(n, value);
                solve_all(problems, least_chosen, chosen);
                set(n, other);
                solve_all(problems, least_tried, tried);
            }
            set(n, value);
            std::printf("| %s | %g | %g | %.3f | %.3f | %d |\n", n.name, value, other, tried.seconds / chosen.seconds,
                        double(tried.solves) / double(chosen.solves), tried.unsolved);
            std::fflush(stdout);
        }
    }
    return 0;
}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="constants whose name contains this")
    parser.add_argument("build")
    parser.add_argument("mesh", nargs="+")
    options = parser.parse_args()
    header = (ROOT / "src/core/solve/parameters.hpp").read_text()
    fields = {"double": "real", "uint32_t": "whole", "size_t": "size"}
    table = []
    for kind, names in re.findall(r"^constexpr (\w+) (.*?);", header, re.M):
        for name in re.findall(r"(\w+) =", names):
            places = [f"&{name}" if field == fields[kind.replace("uint64_t", "size_t")] else "nullptr"
                      for field in fields.values()]
            table.append(f'{{"{name}", {", ".join(places)}}},\n')
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        shutil.copytree(ROOT / "src", work / "src")
        solve = work / "src/core/solve"
        (solve / "parameters.hpp").write_text(re.sub(r"^constexpr", "inline", header, flags=re.M))
        (work / "steering_table.inc").write_text("".join(table))
        (work / "program.cpp").write_text(PROGRAM)
        flags = ["-std=c++17", "-O3", "-DNDEBUG", "-ffp-contract=off", f"-I{ROOT}/include", f"-I{work}"]
        sources = sorted(str(source) for source in solve.glob("*.cpp"))
        subprocess.check_call(["c++", *flags, "-fno-exceptions", "-fno-rtti", "-c", *sources], cwd=work)
        objects = [pathlib.Path(source).with_suffix(".o").name for source in sources]
        subprocess.check_call(["c++", *flags, "program.cpp", *objects,
                               str(pathlib.Path(options.build).resolve() / "libhmf.a"), "-o", "program"], cwd=work)
        sys.exit(subprocess.call([str(work / "program"), options.only, *options.mesh]))


main()
