// Cutting the mesh into a polygon, and products of walks; see edge_words.hpp.
#include "edge_words.hpp"

#include "tree_cotree.hpp"

namespace hmf {

namespace {

constexpr size_t EDGES_STRIDE = 65536, EDGE_SPLITS_STRIDE = 4096; // edges, and splits, between two reports

} // namespace

Done EdgeWords::start(const Mesh& mesh, uint32_t edge_capacity, Call& call) {
    Memory& memory = call.memory;
    Array<EdgeKind> kind;
    Array<uint32_t> corner, twin_side;
    memory_ = &memory;
    scratch_.start(memory);
    twin_side.start(memory);
    if (!find_trees(mesh, kind, call) || !corner.allocate_filled(memory, size_t{2} * mesh.edge_count, NONE)
        || !walks_.start(edge_capacity, memory))
        return false;
    // Once around the polygon, which lies on the left: the corner at which each half-edge starts.
    uint32_t first = 0;
    while (first < 2 * mesh.edge_count && kind[edge_of(first)] != EdgeKind::side) ++first;
    if (first == 2 * mesh.edge_count) return false; // a sphere
    uint32_t h = first;
    do {
        if (kind[edge_of(h)] == EdgeKind::side) {
            corner[h] = static_cast<uint32_t>(twin_side.size());
            if (!twin_side.push(h)) return false;
        }
        h = mesh.next[h];
        for (; kind[edge_of(h)] == EdgeKind::across; h = mesh.next[twin(h)])
            corner[h] = static_cast<uint32_t>(twin_side.size());
    } while (h != first);
    const uint32_t n = static_cast<uint32_t>(twin_side.size());
    for (uint32_t& side : twin_side) side = corner[twin(side)];
    if (!quads_.start(twin_side, memory)) return false;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % EDGES_STRIDE == 0 && !call.tick(0, true)) return false;
        if (kind[e] == EdgeKind::in_tree) continue;
        const uint32_t from = corner[2 * e] % n;
        const uint32_t to = kind[e] == EdgeKind::side ? (corner[2 * e] + 1) % n : corner[2 * e + 1] % n;
        if (from == to) continue;
        scratch_.clear();
        if (!scratch_.push(from) || !scratch_.push(to) || !walks_.set(2 * e, scratch_)) return false;
    }
    return true;
}

Done EdgeWords::were_split(const Collapse* collapses, size_t count, Call& call) {
    for (size_t i = count; i-- > 0;) {
        if (i % EDGE_SPLITS_STRIDE == 0 && !call.tick(0, true)) return false;
        const Collapse& c = collapses[i];
        walks_.clear(edge_of(c.h));
        walks_.copy(c.ki, twin(c.jk));
        walks_.copy(c.il, twin(c.lj));
    }
    return true;
}

Done EdgeWords::append(uint32_t half_edge, Walk& walk) const {
    return walks_.for_letters(half_edge, [&](uint32_t spoke, bool) { return quads_.append(walk, spoke); });
}

// Half-edge 2e is the way back along the two others of its triangle.
Done EdgeWords::join(uint32_t edge, uint32_t ahead, uint32_t back) {
    scratch_.clear();
    return append(twin(back), scratch_) && append(twin(ahead), scratch_) && walks_.set(2 * edge, scratch_);
}

} // namespace hmf
