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
// + vertices of the interior) is 1.  Then it is joined to its neighbour, which
// may become such a piece.  Edges inside of a monogon bound monogons, so that
// this finds all of them, in linear time.
//
// A marked vertex inside counts as a hole: the value of an edge round it is
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
};

} // namespace

Done Monogons::find(const Mesh& mesh, Memory& memory) {
    bool any = false;
    for (uint32_t e = 0; e < mesh.edge_count && !any; ++e) any = joins_itself(mesh, e);
    if (!any) return true;
    Array<uint32_t> parent, self_edges, queue; // union-find of the faces; edges to itself at each vertex that are left
    Array<Piece> piece;                        // at the root of its faces
    if (!parent.allocate(memory, mesh.face_count)
        || !piece.allocate_filled(memory, mesh.face_count, Piece{0, 0, 0, false})
        || !self_edges.allocate_filled(memory, mesh.vertex_count, 0)
        || !edge.allocate_filled(memory, mesh.edge_count, 0)
        || !vertex.allocate_filled(memory, mesh.vertex_count, INSIDE))
        return false;
    edges.start(memory);
    queue.start(memory);
    for (uint32_t f = 0; f < mesh.face_count; ++f) parent[f] = f;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (joins_itself(mesh, e)) {
            ++self_edges[mesh.origin[2 * e]];
        } else {
            unite(parent.data(), mesh.face[2 * e], mesh.face[2 * e + 1]);
        }
    }
    for (uint32_t f = 0; f < mesh.face_count; ++f) ++piece[find_root(parent.data(), f)].euler;
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        for (uint32_t h = 2 * e; h < 2 * e + 2; ++h) {
            Piece& p = piece[find_root(parent.data(), mesh.face[h])];
            if (joins_itself(mesh, e)) {
                ++p.sides;
                p.edge ^= e;
            } else if (!(h & 1)) {
                --p.euler;
            }
        }
    for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        if (self_edges[v] == 0 && !mesh.is_marked(v)) ++piece[find_root(parent.data(), mesh.face[mesh.out[v]])].euler;
    for (uint32_t f = 0; f < mesh.face_count; ++f)
        if (parent[f] == f && piece[f].sides == 1 && piece[f].euler == 1 && !queue.push(f)) return false;
    for (size_t i = 0; i < queue.size(); ++i) {
        Piece& inner = piece[queue[i]];
        if (inner.sides != 1) continue; // the whole surface is left
        const uint32_t e = inner.edge, v = mesh.origin[2 * e];
        const uint32_t left = find_root(parent.data(), mesh.face[2 * e]);
        const uint32_t other = left == queue[i] ? find_root(parent.data(), mesh.face[2 * e + 1]) : left;
        Piece& outer = piece[other];
        inner.inside = true;
        edge[e] = 1;
        outer.euler += inner.euler - 1;
        outer.edge ^= e;
        --outer.sides;
        if (--self_edges[v] == 0 && !mesh.is_marked(v)) ++outer.euler;
        if (outer.sides == 1 && outer.euler == 1 && !queue.push(other)) return false;
    }
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        if (piece[find_root(parent.data(), mesh.face[h])].inside) edge[edge_of(h)] = 1;
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
