// A vertex is snapped to the nearest point of the sharp edges if a side of a quad joins it to another one that is near
// a sharp edge as well, and the side has the direction of both edges:
//
//     o---o---o---o       the row on both sides of which the faces lie
//     |   |   |   |
//     x---x---x---x       x: near the sharp edge, joined along it
//    ==================   sharp edge
//     |   |   |   |
//     o---o---o---o
#include "box_tree.hpp"
#include "fit_quads.hpp"
#include "quad_numbers.hpp"
#include "surface_lines.hpp"

namespace hmf {

namespace {

class Snap {
public:
    Snap(const Mesh& mesh, const double* position, const SurfaceSearch& surface, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), surface_(surface), quads_(quads), call_(call) {}

    hmf_status run(size_t& snapped) {
        snapped = 0;
        edges_.start(call_.memory);
        if (!find_sharp_edges()) return call_.stopped();
        if (edges_.empty()) return HMF_OK;
        if (!measure_sides() || !find_nearest() || !choose() || !stars_.build(quads_, call_.memory) || !put(snapped))
            return call_.stopped();
        return HMF_OK;
    }

private:
    // The mean side at each vertex.
    Done measure_sides() {
        Array<uint32_t> degree;
        const uint32_t n = quads_.vertex_count();
        if (!length_.allocate_filled(call_.memory, n, 0.0) || !degree.allocate_filled(call_.memory, n, 0u))
            return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i)
            for (const uint32_t v : {quads_.quads[i], next_corner(i)}) {
                length_[v] += length_of(at(quads_, next_corner(i)) - at(quads_, quads_.quads[i]));
                ++degree[v];
            }
        for (uint32_t v = 0; v < n; ++v) length_[v] /= static_cast<double>(degree[v]);
        return call_.tick(0);
    }

    Done find_sharp_edges() {
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            const uint32_t h = 2 * e;
            if (e % 16384 == 0 && !call_.tick(0)) return false;
            if (mesh_.face[h] == NONE || mesh_.face[twin(h)] == NONE) continue;
            if (is_sharp(mesh_, position_, h) && !edges_.push(h)) return false;
        }
        return true;
    }

    bool can_snap(uint32_t v) const { return !quads_.held[v] || quads_.held[v] == ON_CREASE; }
    Point on_edge(size_t i, uint32_t v) const { return nearest_on_edge(mesh_, position_, edges_[i], at(quads_, v)); }

    // The sharp edge that is nearest to each vertex, within reach.
    Done find_nearest() {
        BoxTree tree;
        const uint32_t n = quads_.vertex_count();
        const auto end = [&](size_t i, int k) { return point(position_, mesh_.origin[edges_[i] + uint32_t(k)]); };
        if (!edge_.allocate_filled(call_.memory, n, NONE) || !tree.build(edges_.size(), 2, end, call_.memory))
            return false;
        for (uint32_t v = 0; v < n; ++v) {
            if (v % 1024 == 0 && !call_.tick(0)) return false;
            if (!can_snap(v)) continue;
            double best = TAKEN_FROM * TAKEN_FROM * length_[v] * length_[v];
            tree.search(at(quads_, v), best, [&](size_t i) {
                const double d = square_of(at(quads_, v) - on_edge(i, v));
                if (d < best) {
                    best = d;
                    edge_[v] = static_cast<uint32_t>(i);
                }
                return best;
            });
        }
        return true;
    }

    Done choose() {
        if (!snaps_.allocate_filled(call_.memory, quads_.vertex_count(), 0)) return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            const uint32_t a = quads_.quads[i], b = next_corner(i);
            if (follows(a, b)) snaps_[a] = snaps_[b] = 1;
        }
        return call_.tick(0);
    }

    // Whether the side between the places where both would be runs along sharp edges.
    bool follows(uint32_t a, uint32_t b) const {
        if (edge_[a] == NONE || edge_[b] == NONE) return false;
        const Point side = on_edge(edge_[b], b) - on_edge(edge_[a], a);
        return square_of(side) >= 0.25 * square_of(at(quads_, b) - at(quads_, a)) && runs_along(edge_[a], side)
            && runs_along(edge_[b], side);
    }
    bool runs_along(uint32_t i, const Point& side) const {
        const Point edge = point(position_, mesh_.target(edges_[i])) - point(position_, mesh_.origin[edges_[i]]);
        return std::fabs(dot(edge, side)) >= SHARP * length_of(edge) * length_of(side);
    }

    Done put(size_t& snapped) {
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            if (!call_.work(256, 0, false)) return false;
            if (!snaps_[v] || quads_.held[v]) continue;
            // Not where a corner of its quads would get too flat or too sharp.
            const Point p = on_edge(edge_[v], v);
            if (!(stars_.worst_corner(surface_, quads_, v, p) > LEAST_TAKEN)) continue;
            quads_.put(v, p, edges_[edge_[v]]);
            quads_.held[v] = ON_CREASE;
            ++snapped;
        }
        return true;
    }

    uint32_t next_corner(size_t i) const { return quads_.quads[i / 4 * 4 + (i + 1) % 4]; }

    const Mesh& mesh_;
    const double* position_;
    const SurfaceSearch& surface_;
    QuadMesh& quads_;
    Call& call_;
    Array<double> length_;  // per vertex of the quads
    Array<uint32_t> edges_; // sharp
    Array<uint32_t> edge_;  // per vertex: the nearest of them; NONE
    Array<uint8_t> snaps_;
    QuadStars stars_;
};

} // namespace

hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const SurfaceSearch& surface, QuadMesh& quads,
                               size_t& snapped, Call& call) {
    return Snap(mesh, position, surface, quads, call).run(snapped);
}

} // namespace hmf
