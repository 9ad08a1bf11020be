#include "flat_flips.hpp"

#include "quad_shape.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double FLAT = 1e-9;               // of the size of the mesh: how far a flip may move the surface
constexpr double COTANGENT_ROUNDING = 1e-9; // of a sum of two cotangents, per unit of their size
constexpr size_t FLIPS_EACH = 64;           // for each edge, so that the time is bounded
constexpr size_t FLIPS_SLICE = 256;         // edges between ticks

class FlatFlips {
public:
    FlatFlips(Foliation& f, const double* position, const Reflection* mirror, Call& call) :
        f_(f), mesh_(f.mesh), position_(position), mirror_(mirror), call_(call) {}

    hmf_status run() {
        find_tolerance();
        waiting_.start(call_.memory);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e)
            if (!waiting_.push(e)) return call_.out_of_memory();
        size_t left = FLIPS_EACH * mesh_.edge_count;
        for (size_t i = 0; !waiting_.empty() && left > 0; ++i) {
            if (i % FLIPS_SLICE == 0 && !call_.work(16 * FLIPS_SLICE + 8 * f_.take_walked()))
                return call_.was_cancelled();
            const uint32_t h = 2 * waiting_.back();
            waiting_.pop();
            if (!is_inside(h) || !should_flip(h)) continue;
            flip_both(h);
            --left;
            for (const uint32_t g : {mesh_.next[h], mesh_.prev(h), mesh_.next[twin(h)], mesh_.prev(twin(h))})
                if (!waiting_.push(edge_of(g))) return call_.out_of_memory();
        }
        return HMF_OK;
    }

private:
    void find_tolerance() {
        double square = 0;
        for (size_t k = 0; k < 3; ++k) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
                low = std::min(low, position_[size_t{3} * v + k]);
                high = std::max(high, position_[size_t{3} * v + k]);
            }
            square += (high - low) * (high - low);
        }
        tolerance_ = FLAT * std::sqrt(square);
    }

    bool is_inside(uint32_t h) const { return !mirror_ || (mirror_->is_front[h] && mirror_->is_front[twin(h)]); }
    uint32_t apex(uint32_t h) const { return mesh_.origin[mesh_.prev(h)]; }

    bool should_flip(uint32_t h) const {
        if (apex(h) == apex(twin(h))) return false;
        const Point a = point(position_, mesh_.origin[h]), c = point(position_, apex(h)) - a,
                    d = point(position_, apex(twin(h))) - a, b = point(position_, mesh_.target(h)) - a;
        const Point across = cross(b, d - c);
        // The surface moves by the distance of the two diagonals.
        if (!(std::fabs(dot(across, c)) <= tolerance_ * std::sqrt(dot(across, across)))) return false;
        const Point up = cross(b, c), down = cross(d, b);
        // Folded, or a triangle without area, of which rounding would decide.
        const double least = tolerance_ * tolerance_ * dot(b, b);
        if (!(dot(up, down) > 0) || !(dot(up, up) > least) || !(dot(down, down) > least)) return false;
        // Both new triangles look the same way as the old ones: the quadrilateral is convex.
        if (dot(cross(d - c, d - b), up) >= 0 || dot(cross(c, d - c), up) >= 0) return false;
        const double at_c = dot(c, c - b) / std::sqrt(dot(up, up)), at_d = dot(d, d - b) / std::sqrt(dot(down, down));
        return at_c + at_d < -COTANGENT_ROUNDING * (1 + std::fabs(at_c) + std::fabs(at_d));
    }

    // Of a double the mirror image turns the other way.
    void flip_both(uint32_t h) {
        TransportStatistics statistics;
        const uint32_t image = mirror_ ? edge_of(mirror_->half_edge[h]) : NONE;
        flip_foliation(f_, edge_of(h), false, statistics);
        if (image != NONE) flip_foliation(f_, image, true, statistics);
    }

    Foliation& f_;
    const Mesh& mesh_;
    const double* position_;
    const Reflection* mirror_;
    Call& call_;
    Array<uint32_t> waiting_;
    double tolerance_ = 0;
};

} // namespace

hmf_status flip_flat_parts(Foliation& f, const double* position, const Reflection* mirror, Call& call) {
    return FlatFlips(f, position, mirror, call).run();
}

} // namespace hmf
