// The native side of bench.js: native MESH REPETITIONS prints one line of JSON
// with the least processor seconds of hmf_hierarchy_create and hmf_solve.
//
// MESH: two uint64, the numbers of vertices and triangles, then positions and
// triangles as hmf_hierarchy_create takes them.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include <hmf/applications.h>

namespace {

double processor_seconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool stop(hmf_status status, const hmf_error& error) {
    if (status) std::fprintf(stderr, "%s: %s\n", hmf_status_string(status), error.message);
    return status != HMF_OK;
}

} // namespace

int main(int argc, char** argv) {
    std::FILE* file = argc == 3 ? std::fopen(argv[1], "rb") : nullptr;
    uint64_t counts[2];
    if (!file || std::fread(counts, 8, 2, file) != 2) return 1;
    std::vector<double> positions(3 * counts[0]);
    std::vector<uint32_t> triangles(3 * counts[1]);
    if (std::fread(positions.data(), 8, positions.size(), file) != positions.size()
        || std::fread(triangles.data(), 4, triangles.size(), file) != triangles.size())
        return 1;
    std::fclose(file);
    double value = 0;
    double build = 1e300, solve = 1e300;
    for (int i = 0; i < std::atoi(argv[2]); ++i) {
        hmf_hierarchy* h = nullptr;
        hmf_error error = {};
        const double start = processor_seconds();
        if (stop(hmf_hierarchy_create(positions.data(), counts[0], triangles.data(), counts[1], nullptr, nullptr, &h,
                                      &error),
                 error))
            return 1;
        const double built = processor_seconds();
        hmf_foliation* f = nullptr;
        if (stop(hmf_solve_cut_system(h, nullptr, nullptr, &f, &error), error)) return 1;
        const double solved = processor_seconds();
        value = hmf_foliation_values(f, nullptr)[0];
        hmf_foliation_destroy(f);
        hmf_hierarchy_destroy(h);
        if (built - start < build) build = built - start;
        if (solved - built < solve) solve = solved - built;
    }
    std::printf("{\"build\": %.6f, \"solve\": %.6f, \"value\": %.17g}\n", build, solve, value);
}
