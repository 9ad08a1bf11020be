#include "stars.hpp"

namespace hmf {

Done Stars::build(const Mesh& mesh, Call& call) {
    const uint32_t n = mesh.vertex_count, sides = 2 * mesh.edge_count;
    if (!offset.allocate_filled(call.memory, n + size_t{1}, 0) || !half_edge.allocate(call.memory, sides)
        || !call.tick(0))
        return false;
    for (uint32_t h = 0; h < sides; ++h) ++offset[mesh.origin[h]];
    uint32_t sum = 0;
    for (uint32_t& at : offset) {
        const uint32_t degree = at;
        at = sum;
        sum += degree;
    }
    return call.pass(n, 0, [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
            uint32_t t = offset[v];
            for (const uint32_t h : mesh.around(v)) half_edge[t++] = h;
        }
    });
}

} // namespace hmf
