// The initial foliation of weighted loops ([W] 3.3): every edge gets the
// weights of the loops that cross it.
#include "loops.hpp"

namespace hmf {

void initial_foliation(const Mesh& mesh, const Loops& loops, const int64_t* weights, int64_t* value) {
    for (uint32_t e = 0; e < mesh.edge_count; ++e) value[e] = 0;
    for (size_t c = 0; c < loops.count(); ++c)
        for (uint64_t i = loops.offsets[c]; i < loops.offsets[c + 1]; ++i)
            value[edge_of(loops.crossings[i])] += weights[c];
}

} // namespace hmf
