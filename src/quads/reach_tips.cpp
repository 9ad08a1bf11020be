// Quads with all vertices on a surface cut its tips and corners off:
//
//          x                 x         x: the vertex of the surface farthest from the
//        /   \             / | \          quads round it
//      o-------o    ->    o  |  o      the corner of its nearest quad goes there whose
//     /         \        /   |   \        quads stay best
//
// Where it would have to go too far, it goes some way along the edges there; the next time the quads have followed.
//
// Each vertex of the surface belongs to the vertex of the quads that is nearest
// along edges, and is compared with the quads round that.
#include "reach_tips.hpp"

#include "../base/heap_sort.hpp"
#include "../base/nearest_first.hpp"
#include "quad_shape.hpp"
#include "sharp_edges.hpp"
#include "surface_walk.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double FAR = 0.5;           // in mean sides of the quads: what is cut off less stays so
constexpr double LEAST_CORNER = 0.45; // sine, of the quads round a vertex that moves
constexpr double LONGEST = 2;         // side of these, in the longest before

struct FarVertex {
    uint32_t vertex, quad; // of the surface, and the quad nearest to it
    double distance;
};

class TipReach {
public:
    TipReach(const Mesh& mesh, const double* position, const Reflection* front, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), front_(front), quads_(quads), call_(call) {}

    hmf_status run(size_t& moved) {
        moved = 0;
        tips_.start(call_.memory);
        if (!stars_.build(quads_, call_.memory) || !find_owners() || !find_tips()) return call_.stopped();
        return reach(moved) ? HMF_OK : call_.stopped();
    }

private:
    bool is_in_front(uint32_t h) const { return !front_ || front_->is_front[h] || front_->is_front[twin(h)]; }

    // By Dijkstra's algorithm from the corners of the triangles where vertices of quads lie.
    Done find_owners() {
        const uint32_t n = mesh_.vertex_count;
        NearestFirst heap;
        Array<double> distance;
        heap.start(call_.memory);
        if (!distance.allocate_filled(call_.memory, n, HUGE_VAL) || !owner_.allocate_filled(call_.memory, n, NONE)
            || !before_.allocate_filled(call_.memory, n, NONE))
            return false;
        const auto offer = [&](uint32_t x, double d, uint32_t v, uint32_t from) -> Done {
            if (!(d < distance[x])) return true;
            distance[x] = d;
            owner_[x] = v;
            before_[x] = from;
            return heap.push({d, x});
        };
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            uint32_t h = quads_.sides[v];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h])
                if (!offer(mesh_.origin[h], length(at(quads_, v) - point(position_, mesh_.origin[h])), v, NONE))
                    return false;
        }
        for (size_t i = 0; !heap.empty(); ++i) {
            if (i % 16384 == 0 && !call_.tick(0)) return false;
            const NearestFirst::Entry top = heap.pop();
            const uint32_t x = top.item;
            if (top.distance > distance[x]) continue;
            for (const uint32_t h : mesh_.around(x)) {
                const uint32_t y = mesh_.target(h);
                const double d = top.distance + length(point(position_, x) - point(position_, y));
                if (is_in_front(h) && !offer(y, d, owner_[x], x)) return false;
            }
        }
        return true;
    }

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
            if (owner_[x] == NONE) continue;
            const FarVertex tip = nearest_quad(x, farthest[owner_[x]].distance);
            if (tip.quad != NONE) farthest[owner_[x]] = tip;
        }
        for (const FarVertex& tip : farthest)
            if (tip.quad != NONE && !tips_.push(tip)) return false;
        heap_sort(tips_.data(), tips_.size(), [](const FarVertex& a, const FarVertex& b) {
            return a.distance != b.distance ? a.distance > b.distance : a.vertex < b.vertex;
        });
        return true;
    }

    // Squared distance from the quads round its owner, each of two triangles along its shorter diagonal;
    // no quad if it is at most `least`.
    FarVertex nearest_quad(uint32_t x, double least) const {
        FarVertex tip{x, NONE, HUGE_VAL};
        const double* const p = position_ + size_t{3} * x;
        for (const uint32_t* q = stars_.begin(owner_[x]); q != stars_.end(owner_[x]); ++q) {
            const double* corner[4];
            for (size_t k = 0; k < 4; ++k) corner[k] = &quads_.positions[size_t{3} * quads_.quads[4 * size_t{*q} + k]];
            const Point a = at(quads_, quads_.quads[4 * size_t{*q}]) - at(quads_, quads_.quads[4 * size_t{*q} + 2]),
                        b = at(quads_, quads_.quads[4 * size_t{*q} + 1]) - at(quads_, quads_.quads[4 * size_t{*q} + 3]);
            const size_t turn = dot(a, a) <= dot(b, b) ? 0 : 1;
            for (size_t half = 0; half < 4; half += 2) {
                double nearest[3];
                int on = 0;
                const double square = nearest_in_triangle(p, corner[(turn + half) % 4], corner[(turn + half + 1) % 4],
                                                          corner[(turn + half + 2) % 4], nearest, on);
                if (!(square > least)) return {x, NONE, 0};
                if (!(square < tip.distance)) continue;
                tip.distance = square;
                tip.quad = *q;
            }
        }
        return tip;
    }

    // Farthest first; of two neighbours only the first one moves.
    Done reach(size_t& moved) {
        Array<uint8_t> near;
        if (!near.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0})) return false;
        for (const FarVertex& tip : tips_) {
            if (!call_.tick(0)) return false;
            // The tip itself, or as far on the way to it as quads stay good.
            uint32_t best = NONE, to = tip.vertex;
            for (; to != NONE && !(is_near(tip.quad, to)); to = before_[to]) {
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

    // A corner of the quad is where it is not worth the while.
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
        const double worst = longest_side(v) > most ? 0 : stars_.worst_corner(mesh_, position_, quads_, v);
        quads_.put(v, back, side);
        return worst;
    }

    // Of the quads round a vertex.
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
    const Reflection* front_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    // Per vertex of the surface: that of the quads, NONE if it is not in front; and the one before on the way from it.
    Array<uint32_t> owner_, before_;
    Array<FarVertex> tips_;
    double least_ = 0; // distance of what is far
};

} // namespace

hmf_status reach_tips(const Mesh& mesh, const double* position, const Reflection* front, QuadMesh& quads, size_t& moved,
                      Call& call) {
    return TipReach(mesh, position, front, quads, call).run(moved);
}

} // namespace hmf
