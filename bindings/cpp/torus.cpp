// A torus of 7 vertices, 14 triangles and 21 edges: its harmonic foliation.
#include <hmf/applications.hpp>

#include <cstdio>

int main() try {
    const double positions[] = {3, -3, 0, -3, 3, 0, -3, -3, 1, 3, 3, 1, -1, -2, 3, 1, 2, 3, 0, 0, 15};
    const uint32_t triangles[] = {0, 1, 3, 0, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 5, 2, 5, 4, 3, 4, 6,
                                  3, 6, 5, 4, 5, 0, 4, 0, 6, 5, 6, 1, 5, 1, 0, 6, 0, 2, 6, 2, 1};
    const hmf::Hierarchy hierarchy(positions, triangles);
    const hmf::Solution solution = hmf::solve_cut_system(hierarchy);
    std::printf("energy %.6f, %d zeros\n", solution.report.energy, static_cast<int>(solution.report.zeros));
    for (double value : solution.foliation.values()) std::printf("%.17g\n", value);
} catch (const hmf::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
