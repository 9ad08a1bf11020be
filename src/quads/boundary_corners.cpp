#include "boundary_corners.hpp"

#include "../base/heap_sort.hpp"
#include "boundary_walk.hpp"
#include "quad_shape.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double CUT = 0.2;           // distance of a corner from a side, in the side; of a circle in four sides
constexpr double LEAST_CORNER = 0.15; // sine of a corner of the quads there
constexpr int ROUNDS = 2;
constexpr size_t STRIDE = 1024;

struct CutCorner {
    uint32_t from, to, vertex, rim; // ends of the side, vertex of the mesh, the edge of the boundary that ends there
    double size;
};

class Corners {
public:
    Corners(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), quads_(quads), call_(call) {}

    hmf_status run(size_t& moved) {
        moved = 0;
        if (!prepare()) return call_.out_of_memory();
        for (int round = 0; round < ROUNDS; ++round) {
            cut_.clear();
            if (const hmf_status status = find()) return status;
            heap_sort(cut_.data(), cut_.size(), [](const CutCorner& a, const CutCorner& b) {
                return a.size != b.size ? a.size > b.size : a.vertex < b.vertex;
            });
            size_t taken = 0;
            for (const CutCorner& c : cut_) taken += take(c);
            moved += taken;
            if (taken == 0) break;
        }
        return HMF_OK;
    }

private:
    Done prepare() {
        cut_.start(call_.memory);
        return stars_.build(quads_, call_.memory);
    }

    Point place(uint32_t vertex) const { return point(position_, vertex); }

    static double square_to_segment(const Point& p, const Point& a, const Point& b) {
        const Point side = b - a;
        const double length = dot(side, side);
        double t = length > 0 ? dot(p - a, side) / length : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        const Point off = p - (a + t * side);
        return dot(off, off);
    }

    // Does only one quad have the side?
    bool is_outer(uint32_t a, uint32_t b) const {
        for (const uint32_t* q = stars_.begin(a); q != stars_.end(a); ++q)
            for (size_t k = 0; k < 4; ++k)
                if (quads_.quads[4 * size_t{*q} + k] == b && quads_.quads[4 * size_t{*q} + (k + 1) % 4] == a)
                    return false;
        return true;
    }

    hmf_status find() {
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            if (i % (4 * STRIDE) == 0 && !call_.tick(0)) return call_.was_cancelled();
            const uint32_t a = quads_.quads[i], b = quads_.quads[i / 4 * 4 + (i + 1) % 4];
            if (!is_on_rim(mesh_, quads_.sides[a]) || !is_on_rim(mesh_, quads_.sides[b])
                || !is_at_boundary(quads_.held[a]) || !is_at_boundary(quads_.held[b]) || !is_outer(a, b))
                continue;
            const CutCorner c = worst_between(a, b);
            if (c.vertex != NONE && !cut_.push(c)) return call_.out_of_memory();
        }
        return HMF_OK;
    }

    // The vertex of the boundary between two of the quads that is farthest from their side, if it is far.
    CutCorner worst_between(uint32_t a, uint32_t b) const {
        CutCorner worst{a, b, NONE, NONE, 0};
        const uint32_t begin = quads_.sides[a], end = quads_.sides[b];
        const Point side = at(quads_, b) - at(quads_, a);
        double farthest = CUT * CUT * dot(side, side);
        for (uint32_t h = begin; h != end;) {
            const uint32_t w = mesh_.target(h);
            const double square = square_to_segment(place(w), at(quads_, a), at(quads_, b));
            if (square > farthest) {
                farthest = square;
                worst.vertex = w;
                worst.rim = h;
                worst.size = square / dot(side, side);
            }
            h = next_on_rim(mesh_, h);
            if (h == begin) return {a, b, NONE, NONE, 0}; // another boundary
        }
        return worst;
    }

    bool take(const CutCorner& c) {
        const CutCorner now = worst_between(c.from, c.to);
        if (now.vertex != c.vertex) return false;
        const Point corner = place(c.vertex);
        const Point to_first = corner - at(quads_, c.from), to_second = corner - at(quads_, c.to);
        const bool first = dot(to_first, to_first) <= dot(to_second, to_second);
        return move(first ? c.from : c.to, c) || move(first ? c.to : c.from, c);
    }

    bool move(uint32_t v, const CutCorner& c) {
        if (quads_.held[v] == AT_CORNER) return false;
        const Point from = at(quads_, v);
        const double before[3] = {from.x, from.y, from.z};
        const uint32_t side = quads_.sides[v];
        const double worst = stars_.worst_corner(mesh_, position_, quads_, v);
        quads_.put(v, position_ + size_t{3} * c.vertex, c.rim);
        const double after = stars_.worst_corner(mesh_, position_, quads_, v);
        if (after < LEAST_CORNER && after < worst) {
            quads_.put(v, before, side);
            return false;
        }
        quads_.held[v] = AT_CORNER;
        return true;
    }

    const Mesh& mesh_;
    const double* position_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    Array<CutCorner> cut_;
};

} // namespace

hmf_status take_boundary_corners(const Mesh& mesh, const double* position, QuadMesh& quads, size_t& moved, Call& call) {
    return Corners(mesh, position, quads, call).run(moved);
}

} // namespace hmf
