// The number of points of a leaf is known only after it has been followed. Tasks do not allocate: a leaf without enough
// space is counted, and followed again with the space that it needs.
#include "leaf_rows.hpp"

#include "../lines/polyline.hpp"

namespace hmf {

LeafRows::LeafRows(const QuadInput& in, Call& call) : in_(in), call_(call) {
    for (LeafRow& row : row_) row.ruler.start(call.memory);
}

// Rows run beside the lower boundary.
uint32_t LeafRows::at_a_time(uint32_t cylinder) const {
    const Boundary& lower = in_.graph.boundaries[in_.cylinders.list[cylinder].lower];
    const uint64_t rows = in_.f.mesh.edge_count / 2 / (lower.end - lower.begin + 1);
    return rows < 1 ? 1 : rows < MOST ? static_cast<uint32_t>(rows) : MOST;
}

void LeafRows::follow_leaf(uint32_t cylinder, LeafRow& row) const {
    Ruler& ruler = row.ruler;
    const Crossing start = in_.cylinders.leaf_at(in_.f, cylinder, row.height, &row.piece);
    const uint64_t limit = in_.graph.crossing_limit(), room = ruler.v.capacity();
    ruler.clear();
    row.points = 1; // the last one is the first again
    Crossing at = start;
    double v = 0, p[3];
    do {
        if (row.points < room) {
            point_at(in_.f, in_.position, at, p);
            ruler.add(v, p, twin(at.half_edge));
            v += in_.conjugate.step(at);
        }
        ++row.points;
        at = follow(in_.f, at);
    } while (!(at == start) && row.points <= limit + 1);
    if (row.points > room) return;
    point_at(in_.f, in_.position, start, p);
    ruler.add(v, p, twin(start.half_edge));
}

hmf_status LeafRows::read(uint32_t cylinder, uint32_t begin, uint32_t end) {
    const Boundary& lower = in_.graph.boundaries[in_.cylinders.list[cylinder].lower];
    const uint64_t expected = (lower.end - lower.begin) + (lower.end - lower.begin) / 4;
    bool fits = false;
    for (uint32_t i = begin; i < end; ++i) row_[i].points = expected;
    for (int tries = 0; tries < 2 && !fits; ++tries) {
        for (uint32_t i = begin; i < end; ++i)
            if (!row_[i].ruler.reserve(row_[i].points)) return call_.out_of_memory();
        if (!call_.tick(0)) return call_.was_cancelled();
        call_.parallel.for_each(end - begin, [&](uint32_t i, uint32_t) {
            LeafRow& row = row_[begin + i];
            if (tries == 0 || row.ruler.v.size() < row.points) follow_leaf(cylinder, row);
        });
        fits = true;
        for (uint32_t i = begin; i < end; ++i) {
            if (row_[i].points > in_.graph.crossing_limit() + 1)
                return call_.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0, "A leaf crosses too many edges.");
            fits &= row_[i].ruler.v.size() == row_[i].points;
        }
    }
    return HMF_OK;
}

} // namespace hmf
