// A user of the installed hmf.hpp: objects and exceptions between two files.
#include "other.hpp"

#include <cstdio>

int main() {
    const hmf::Hierarchy hierarchy = build();
    const hmf::Solution solution = hierarchy.solve();
    if (solution.status != HMF_OK || energy(solution.foliation) != solution.foliation.energy()) return 1;
    try {
        hierarchy.level(hierarchy.level_count());
    } catch (const hmf::Error& error) {
        std::printf("energy %.9g; %s\n", solution.report.energy, error.what());
        return error.status() == HMF_ERROR_LEVEL ? 0 : 1;
    }
    return 1;
}
