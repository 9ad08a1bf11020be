// Cotangent weights ([W] Eq. 5): half the sum of the cotangents of the two
// angles opposite to an edge.
#pragma once

#include "mesh.hpp"

namespace hmf {

// Cotangent of the angle at apex between the points a and b; 3 coordinates
// each.  Finite, also for triangles without area and for extreme units.
double cotangent(const double* apex, const double* a, const double* b);

// Bounds of the weights that the solver sees; energy and residual are those of the bounded
// ones.  The cap on level 0 is met by needles with angles below 5e-7.
struct WeightBounds {
    double floor, cap;
    double negative; // a weight below this is counted; of intrinsic ones one that is negative beyond rounding
};
constexpr WeightBounds COARSE_WEIGHTS = {1e-3, 1e3, 0}, INTRINSIC_WEIGHTS = {1e-9, 1e6, -1e-7};

// Visits each face of the half-edges from begin to end - 1 once, by its lowest
// half-edge.  These are one in three, in no order: they are listed first, branch-free.
template <class Visit>
void for_each_face(const Mesh& mesh, uint32_t begin, uint32_t end, Visit visit) {
    constexpr uint32_t block = 1024;
    uint32_t lowest[block];
    while (begin < end) {
        const uint32_t stop = end - begin < block ? end : begin + block;
        uint32_t count = 0;
        for (uint32_t h = begin; h < stop; ++h) {
            const uint32_t a = mesh.next[h], b = mesh.next[a];
            lowest[count] = h;
            count += (a > h) & (b > h);
        }
        for (uint32_t n = 0; n < count; ++n) {
            const uint32_t h = lowest[n], a = mesh.next[h];
            visit(h, a, mesh.next[a]);
        }
        begin = stop;
    }
}

// Sums of two parts for each edge, one from the triangle on each side: blocks of
// triangles write them without meeting.
class EdgeSums {
public:
    EdgeSums(double* sum) : left_(sum) {}
    Done allocate(const Mesh& mesh, Memory& memory) { return right_.allocate(memory, mesh.edge_count); }
    // The part of the triangle of half-edge h.
    void set(uint32_t h, double part) { (h & 1 ? right_.data() : left_)[edge_of(h)] = part; }
    // Once all parts are there.
    Done add(Call& call, double fraction) {
        return call.pass(right_.size(), fraction, [this](size_t begin, size_t end) {
            for (size_t e = begin; e < end; ++e) left_[e] += right_[e];
        });
    }

private:
    double* left_;
    Array<double> right_;
};

// Fills sum with the cotangents of the two angles opposite to each edge, added.
// The fourth power of a coordinate must be harmless.
[[nodiscard]] hmf_status cotangent_sums(const Mesh& mesh, const double* position, double* sum, Call& call,
                                        double fraction);

// From sums of cotangents to weights, in place: clamped to their bounds. Returns the number of negative ones.
uint64_t clamp_weights(const Mesh& mesh, const WeightBounds& bounds, double* sum,
                       const Parallel& parallel = Parallel());

} // namespace hmf
