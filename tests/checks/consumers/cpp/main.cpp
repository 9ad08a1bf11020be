// A user of the installed hmf.hpp and applications.hpp: objects and exceptions between two files.
#include "other.hpp"

#include <cstdio>
#include <hmf/applications.hpp>

int main() {
    const hmf::Hierarchy hierarchy = build();
    const hmf::Solution solution = hmf::solve_cut_system(hierarchy);
    if (solution.status != HMF_OK || energy(solution.foliation) != solution.foliation.energy()) return 1;
    const hmf::QuadMesh mesh = hmf::quads(solution.foliation);
    if (mesh->vertex_count != mesh->quad_count) return 1; // genus 1
    try {
        hierarchy.level(hierarchy.level_count());
    } catch (const hmf::Error& error) {
        std::printf("energy %.9g; %s\n", solution.report.energy, error.what());
        return error.status() == HMF_ERROR_LEVEL ? 0 : 1;
    }
    return 1;
}
