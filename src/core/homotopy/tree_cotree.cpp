// Breadth first, both; see tree_cotree.hpp.
#include "tree_cotree.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t TREE_STRIDE = 65536; // vertices or triangles between two reports

} // namespace

Done find_trees(const Mesh& mesh, Array<EdgeKind>& kind, Call& call) {
    Memory& memory = call.memory;
    Array<uint32_t> queue;
    Array<uint8_t> seen;
    queue.start(memory);
    if (!kind.allocate_filled(memory, mesh.edge_count, EdgeKind::side)
        || !seen.allocate_filled(memory, std::max(mesh.face_count, mesh.vertex_count), uint8_t{0})
        || !queue.reserve(seen.size()))
        return false;
    seen[0] = 1;
    queue.add(0);
    for (size_t i = 0; i < queue.size(); ++i) {
        if (i % TREE_STRIDE == 0 && !call.tick(0, true)) return false;
        for (const uint32_t h : mesh.around(queue[i])) {
            const uint32_t v = mesh.target(h);
            if (!seen[v]) {
                seen[v] = 1;
                queue.add(v);
                kind[edge_of(h)] = EdgeKind::in_tree;
            }
        }
    }
    for (uint8_t& s : seen) s = 0;
    queue.clear();
    seen[mesh.face[0]] = 1;
    queue.add(0); // a half-edge of each triangle
    for (size_t i = 0; i < queue.size(); ++i) {
        if (i % TREE_STRIDE == 0 && !call.tick(0, true)) return false;
        uint32_t h = queue[i];
        for (uint32_t side = 0; side < 3; ++side, h = mesh.next[h]) {
            if (kind[edge_of(h)] != EdgeKind::side || seen[mesh.face[twin(h)]]) continue;
            seen[mesh.face[twin(h)]] = 1;
            kind[edge_of(h)] = EdgeKind::across;
            queue.add(twin(h));
        }
    }
    return true;
}

} // namespace hmf
