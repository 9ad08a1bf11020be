// Quads with all vertices on a surface cut its tips and corners off:
//
//          x                 x         x: the vertex of the surface farthest from the
//        /   \             / | \          quads around it
//      o-------o    ->    o  |  o      the corner of its nearest quad goes there whose
//     /         \        /   |   \        quads stay best
//
// If the distance is too large, it moves part of it along the edges; by the next call the quads have followed.
#include "reach_tips.hpp"

#include "../../core/base/heap_sort.hpp"
#include "nearest_quads.hpp"
#include "quad_shape.hpp"
#include "sharp_edges.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double FAR = 0.5;           // in mean sides of the quads: what is cut off less stays so
constexpr double LEAST_CORNER = 0.45; // sine, of the quads around a vertex that moves
constexpr double LONGEST = 2;         // side of these, in the longest before

struct FarVertex {
    uint32_t vertex, quad; // of the surface, and the quad nearest to it
    double distance;
};

class TipReach {
public:
    TipReach(const Mesh& mesh, const double* position, const SurfaceSearch& surface, const Reflection* front,
             QuadMesh& quads, Call& call) :
        mesh_(mesh),
        position_(position), surface_(surface), front_(front), quads_(quads), call_(call) {}

    hmf_status run(size_t& moved) {
        moved = 0;
        tips_.start(call_.memory);
        if (!stars_.build(quads_, call_.memory) || !near_.build(mesh_, position_, front_, quads_, stars_, call_)
            || !find_tips())
            return call_.stopped();
        return reach(moved) ? HMF_OK : call_.stopped();
    }

private:
    // The farthest of the vertices that belong to each vertex of the quads, if it is far.
    Done find_tips() {
        double sides = 0;
        for (size_t i = 0; i < quads_.quads.size(); ++i)
            sides += length(at(quads_, quads_.quads[i]) - at(quads_, quads_.quads[i / 4 * 4 + (i + 1) % 4]));
        least_ = FAR * sides / static_cast<double>(quads_.quads.size());
        Array<FarVertex> farthest;
        if (!farthest.allocate_filled(call_.memory, quads_.vertex_count(), FarVertex{NONE, NONE, least_ * least_}))
            return false;
        for (uint32_t x = 0; x < mesh_.vertex_count; ++x) {
            if (x % 4096 == 0 && !call_.tick(0)) return false;
            const uint32_t owner = near_.owner(x);
            if (owner == NONE) continue;
            const NearestQuads::Place place = near_.find(x, farthest[owner].distance);
            if (place.quad != NONE) farthest[owner] = {x, place.quad, place.square};
        }
        for (const FarVertex& tip : farthest)
            if (tip.quad != NONE && !tips_.push(tip)) return false;
        heap_sort(tips_.data(), tips_.size(), [](const FarVertex& a, const FarVertex& b) {
            return a.distance != b.distance ? a.distance > b.distance : a.vertex < b.vertex;
        });
        return true;
    }

    // Farthest first; of two neighbors only the first one moves.
    Done reach(size_t& moved) {
        Array<uint8_t> near;
        if (!near.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0})) return false;
        for (const FarVertex& tip : tips_) {
            if (!call_.tick(0)) return false;
            // The tip itself, or as far on the way to it as quads stay good.
            uint32_t best = NONE, to = tip.vertex;
            for (; to != NONE && !(is_near(tip.quad, to)); to = near_.before(to)) {
                if (!call_.work(256, 0, false)) return false;
                best = mover(tip.quad, to, near);
                if (best != NONE) break;
            }
            if (best == NONE) continue;
            quads_.put(best, position_ + size_t{3} * to, side_at(to));
            quads_.held[best] = to != tip.vertex                      ? ON_WAY_TO_TIP
                              : is_sharp_corner(mesh_, position_, to) ? AT_SHARP_CORNER
                                                                      : AT_TIP;
            ++moved;
            for (const uint32_t* q = stars_.begin(best); q != stars_.end(best); ++q)
                for (size_t k = 0; k < 4; ++k) near[quads_.quads[4 * size_t{*q} + k]] = 1;
        }
        return true;
    }

    // A corner of the quad is too close to be worth a move.
    bool is_near(uint32_t q, uint32_t x) const {
        for (size_t k = 0; k < 4; ++k)
            if (length(at(quads_, quads_.quads[4 * size_t{q} + k]) - point(position_, x)) < least_) return true;
        return false;
    }

    // The corner of a quad that best goes to the vertex x of the surface; NONE: none can.
    uint32_t mover(uint32_t q, uint32_t x, const Array<uint8_t>& near) {
        uint32_t best = NONE;
        double best_corner = LEAST_CORNER;
        for (size_t k = 0; k < 4; ++k) {
            const uint32_t v = quads_.quads[4 * size_t{q} + k];
            const uint8_t held = quads_.held[v];
            if ((held && held != ON_CREASE && held != ON_WAY_TO_TIP) || near[v]) continue;
            const double worst = worst_after(v, x);
            if (!(worst > best_corner)) continue;
            best_corner = worst;
            best = v;
        }
        return best;
    }

    // The worst corner if v went to the vertex x of the surface; 0 if a side got far too long.
    double worst_after(uint32_t v, uint32_t x) {
        const double back[3] = {at(quads_, v).x, at(quads_, v).y, at(quads_, v).z};
        const uint32_t side = quads_.sides[v];
        const double most = LONGEST * longest_side(v);
        quads_.put(v, position_ + size_t{3} * x, side_at(x));
        const double worst = longest_side(v) > most ? 0 : stars_.worst_corner(surface_, quads_, v);
        quads_.put(v, back, side);
        return worst;
    }

    // Of the quads around a vertex.
    double longest_side(uint32_t v) const {
        double longest = 0;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q)
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t* const corner = &quads_.quads[4 * size_t{*q}];
                longest = std::max(longest, length(at(quads_, corner[k]) - at(quads_, corner[(k + 1) % 4])));
            }
        return longest;
    }

    uint32_t side_at(uint32_t x) const {
        for (const uint32_t h : mesh_.around(x))
            if (!front_ || front_->is_front[h]) return h;
        return mesh_.out[x];
    }

    static double length(const Point& a) { return std::sqrt(dot(a, a)); }

    const Mesh& mesh_;
    const double* position_;
    const SurfaceSearch& surface_;
    const Reflection* front_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    NearestQuads near_;
    Array<FarVertex> tips_;
    double least_ = 0; // distance of what is far
};

} // namespace

hmf_status reach_tips(const Mesh& mesh, const double* position, const SurfaceSearch& surface, const Reflection* front,
                      QuadMesh& quads, size_t& moved, Call& call) {
    return TipReach(mesh, position, surface, front, quads, call).run(moved);
}

} // namespace hmf
