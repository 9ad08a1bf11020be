// Monogons: disks whose boundary is one edge, from a vertex to itself.
//
//         _____
//       /   w   \        A foliation without poles is 0 on the edge, which can
//      |   / \   |       be contracted, and then 0 on everything inside, for
//       \  | |  /        an interior vertex of other value would be a pole.
//        \_|_|_/
//           v
//
// The edges from a vertex to itself cut the surface into pieces.  A piece with
// one edge at its boundary is a disk if its Euler characteristic (faces - edges
// + vertices of the interior) is 1.  Then it is joined to its neighbor, which
// may become such a piece.  Edges inside of a monogon bound monogons, so that
// this finds all of them, in linear time.
//
// A marked vertex inside counts as a hole: the value of an edge around it is
// twice the distance of v from it (foliation.hpp).
#include "monogon.hpp"

#include "../base/disjoint_sets.hpp"

namespace hmf {

namespace {

bool joins_itself(const Mesh& mesh, uint32_t edge) { return mesh.origin[2 * edge] == mesh.origin[2 * edge + 1]; }

struct Piece {
    int32_t euler;  // of the interior
    uint32_t sides; // of edges at the boundary that are left
    uint32_t edge;  // these edges, by exclusive or: the edge itself if there is one
    bool inside;    // of a monogon
    bool is_monogon() const { return sides == 1 && euler == 1; }
};

// The surface cut along the edges from a vertex to itself.
class MonogonPieces {
public:
    explicit MonogonPieces(const Mesh& mesh) : mesh_(mesh) {}

    Done cut(Memory& memory) {
        if (!parent_.allocate(memory, mesh_.face_count)
            || !piece_.allocate_filled(memory, mesh_.face_count, Piece{0, 0, 0, false})
            || !self_edges_.allocate_filled(memory, mesh_.vertex_count, 0))
            return false;
        for (uint32_t f = 0; f < mesh_.face_count; ++f) parent_[f] = f;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            if (joins_itself(mesh_, e)) ++self_edges_[mesh_.origin[2 * e]];
            else unite(parent_.data(), mesh_.face[2 * e], mesh_.face[2 * e + 1]);
        }
        return true;
    }

    void count_euler() {
        for (uint32_t f = 0; f < mesh_.face_count; ++f) ++at(f).euler;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e)
            for (uint32_t h = 2 * e; h < 2 * e + 2; ++h) {
                Piece& p = at(mesh_.face[h]);
                if (joins_itself(mesh_, e)) {
                    ++p.sides;
                    p.edge ^= e;
                } else if (!(h & 1)) {
                    --p.euler;
                }
            }
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v)
            if (self_edges_[v] == 0 && !mesh_.is_marked(v)) ++at(mesh_.face[mesh_.out[v]]).euler;
    }

    // Each monogon is joined to the piece outside, which may become one.  bounds: per edge, 1 if it bounds one.
    Done join_monogons(Array<uint8_t>& bounds, Memory& memory) {
        Array<uint32_t> queue;
        queue.start(memory);
        for (uint32_t f = 0; f < mesh_.face_count; ++f)
            if (parent_[f] == f && piece_[f].is_monogon() && !queue.push(f)) return false;
        for (size_t i = 0; i < queue.size(); ++i) {
            Piece& inner = piece_[queue[i]];
            if (inner.sides != 1) continue; // the whole surface is left
            const uint32_t e = inner.edge, v = mesh_.origin[2 * e];
            const uint32_t left = root(mesh_.face[2 * e]);
            const uint32_t other = left == queue[i] ? root(mesh_.face[2 * e + 1]) : left;
            Piece& outer = piece_[other];
            inner.inside = true;
            bounds[e] = 1;
            outer.euler += inner.euler - 1;
            outer.edge ^= e;
            --outer.sides;
            if (--self_edges_[v] == 0 && !mesh_.is_marked(v)) ++outer.euler;
            if (outer.is_monogon() && !queue.push(other)) return false;
        }
        return true;
    }

    Piece& at(uint32_t face) { return piece_[root(face)]; }

private:
    uint32_t root(uint32_t face) { return find_root(parent_.data(), face); }

    const Mesh& mesh_;
    Array<uint32_t> parent_;     // union-find of the faces
    Array<Piece> piece_;         // at the root of its faces
    Array<uint32_t> self_edges_; // edges to itself at each vertex that are left
};

} // namespace

Done Monogons::find(const Mesh& mesh, Memory& memory) {
    bool any = false;
    for (uint32_t e = 0; e < mesh.edge_count && !any; ++e) any = joins_itself(mesh, e);
    if (!any) return true;
    MonogonPieces pieces(mesh);
    edges.start(memory);
    if (!edge.allocate_filled(memory, mesh.edge_count, 0) || !vertex.allocate_filled(memory, mesh.vertex_count, INSIDE)
        || !pieces.cut(memory))
        return false;
    pieces.count_euler();
    if (!pieces.join_monogons(edge, memory)) return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        if (pieces.at(mesh.face[h]).inside) edge[edge_of(h)] = 1;
        else vertex[mesh.origin[h]] &= static_cast<uint8_t>(~INSIDE);
    }
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (edge[e] && !edges.push(e)) return false;
        uint8_t& kind = vertex[mesh.origin[2 * e]];
        if (joins_itself(mesh, e) && !(kind & INSIDE)) kind |= edge[e] ? HOST : SELF_EDGE;
    }
    return true;
}

} // namespace hmf
