// Names of free homotopy classes: of curves on the surface, or, where vertices are
// marked, on the surface without them.  Exact, and carried from level to level.
#pragma once

#include "crossing_words.hpp"
#include "edge_words.hpp"

namespace hmf {

class CurveWords {
public:
    // On a mesh with room for edge_capacity edges.
    Done start(const Mesh& mesh, uint32_t edge_capacity, Call& call) {
        kind_ = mesh.marked_count > 0 ? Kind::marked : mesh.euler() == 2 ? Kind::sphere : Kind::closed;
        if (kind_ == Kind::marked) return crossings_.start(mesh, edge_capacity, call);
        return kind_ == Kind::sphere || edges_.start(mesh, edge_capacity, call);
    }

    // After a flip of the same mesh, or its reversal.
    Done flipped(const Mesh& mesh, uint32_t edge, bool reversed) {
        if (kind_ == Kind::marked) return crossings_.flipped(mesh, edge, reversed);
        return kind_ == Kind::sphere || edges_.flipped(mesh, edge);
    }
    // After these collapses were undone, the last one first.
    Done were_split(const Mesh& mesh, const Collapse* collapses, size_t count, Call& call) {
        if (kind_ == Kind::marked) return crossings_.were_split(mesh, collapses, count, call);
        return kind_ == Kind::sphere || edges_.were_split(collapses, count, call);
    }

    // Of a closed curve that crosses half_edge(i) for i in [begin, end), each from its left to its right, and none
    // there and back again: the same for all curves in its class, whatever their direction, and for no others.
    // name: empty; empty behind it: contractible.
    template <class HalfEdge>
    Done name(const Mesh& mesh, uint64_t begin, uint64_t end, HalfEdge half_edge, Walk& name) const {
        if (kind_ == Kind::marked) return crossings_.canonical(begin, end, half_edge, name);
        return kind_ == Kind::sphere || edges_.canonical(mesh, begin, end, half_edge, name);
    }

private:
    enum class Kind : uint8_t { sphere, closed, marked };
    Kind kind_ = Kind::sphere;
    EdgeWords edges_;
    CrossingWords crossings_;
};

} // namespace hmf
