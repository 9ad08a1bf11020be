// Intrinsic Delaunay triangulation by flips on edge lengths [Fisher, Springborn,
// Bobenko and Schroeder 2006].
//
//          k
//        / | \         The two triangles are laid out in the plane, i at the
//       i--+->j        origin, j on the x-axis; k above, l below.  The flipped
//        \ | /         edge is as long as the distance of k and l there.
//          l
//
// An edge is Delaunay if cot(k) + cot(l) >= 0.  If it is not, the angles at i
// and j are below 180 degrees, so the flip is possible; the other diagonal may
// join two vertices that have an edge, or a vertex to itself.  An edge with one
// triangle on both sides is Delaunay.  The weights are then >= 0 on any input.
//
// End: the sum of the cotangents of all angles is positive, and a flip lowers
// it (by the tangency of the two circles; it is the harmonic index of [Musin
// 1997]).  A flip is made only if the numbers, as they are computed and
// stored, lower the part of the two triangles by a fixed share.
#include "intrinsic.hpp"

#include "weights.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double TOLERANCE = -1e-9; // of the sum of two cotangents
constexpr double FAILURE = -1e-7;   // of the weight
constexpr double GAIN = 1 - 1e-13;  // of the sum of six cotangents, for one flip
constexpr uint32_t NOT_WAITING = NONE - 1;

// b^2 + c^2 - a^2 without the cancellation of needles.
double opposite_product(double a, double b, double c) { return b > c ? (b - a) * (b + a) + c * c : (c - a) * (c + a) + b * b; }

// An edge ij and its two triangles; areas are four areas.
struct Quad {
    double ij, jk, ki, il, lj, area_k, area_l;

    Quad(const Mesh& mesh, const Metric& metric, uint32_t edge) {
        const uint32_t h = 2 * edge, t = twin(h);
        const uint32_t jk_side = mesh.next[h], il_side = mesh.next[t];
        ij = metric.length[edge];
        jk = metric.length[edge_of(jk_side)];
        ki = metric.length[edge_of(mesh.next[jk_side])];
        il = metric.length[edge_of(il_side)];
        lj = metric.length[edge_of(mesh.next[il_side])];
        area_k = metric.four_areas[mesh.face[h]];
        area_l = metric.four_areas[mesh.face[t]];
    }
    double cotangent_sum() const { return opposite_product(ij, jk, ki) / area_k + opposite_product(ij, il, lj) / area_l; }
};

bool one_triangle(const Mesh& mesh, uint32_t edge) { return mesh.face[2 * edge] == mesh.face[2 * edge + 1]; }

bool needs_flip(const Mesh& mesh, const Metric& metric, uint32_t edge) {
    return !one_triangle(mesh, edge) && Quad(mesh, metric, edge).cotangent_sum() < TOLERANCE;
}

// The other diagonal and the areas at i and j; false if it would be no gain.
bool other_diagonal(const Quad& q, double& kl, double& area_i, double& area_j) {
    // Feet of k and l on ij, measured from i and from j; heights.
    const double shift_k = 0.5 * (q.ki - q.jk) * ((q.ki + q.jk) / q.ij), shift_l = 0.5 * (q.il - q.lj) * ((q.il + q.lj) / q.ij);
    const double half = 0.5 * q.ij, y_k = q.area_k / (2 * q.ij), y_l = q.area_l / (2 * q.ij);
    const double x = shift_k - shift_l, y = y_k + y_l;
    kl = std::sqrt(x * x + y * y);
    area_i = 2 * ((half + shift_k) * y_l + (half + shift_l) * y_k);
    area_j = 2 * ((half - shift_k) * y_l + (half - shift_l) * y_k);
    if (!(kl > 0 && area_i > 0 && area_j > 0)) return false;
    const double ij = q.ij * q.ij, jk = q.jk * q.jk, ki = q.ki * q.ki, il = q.il * q.il, lj = q.lj * q.lj;
    return (kl * kl + ki + il) / area_i + (kl * kl + lj + jk) / area_j < GAIN * ((ij + jk + ki) / q.area_k + (ij + il + lj) / q.area_l);
}

// Flips if that is needed and possible.
bool flip_if_needed(Mesh& mesh, Metric& metric, uint32_t edge) {
    if (one_triangle(mesh, edge)) return false;
    const Quad q(mesh, metric, edge);
    if (!(q.cotangent_sum() < TOLERANCE)) return false;
    double kl = 0, area_i = 0, area_j = 0;
    if (!other_diagonal(q, kl, area_i, area_j)) return false;
    flip(mesh, edge); // its triangle on the left is then the one at i
    metric.length[edge] = kl;
    metric.four_areas[mesh.face[2 * edge]] = area_i;
    metric.four_areas[mesh.face[2 * edge + 1]] = area_j;
    return true;
}

// A power of two that brings coordinates to a size whose squares are harmless,
// so that the unit of the input has no influence.
double metric_scale(const Mesh& mesh, const double* position) {
    double largest = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double *a = position + size_t{3} * mesh.origin[2 * e], *b = position + size_t{3} * mesh.origin[2 * e + 1];
        for (int c = 0; c < 3; ++c) {
            const double d = a[c] < b[c] ? b[c] - a[c] : a[c] - b[c];
            if (d > largest) largest = d;
        }
    }
    double scale = 1;
    for (int n = 0; n < 1000 && largest * scale > 1; ++n) scale *= 0.5;
    for (int n = 0; n < 1000 && largest * scale < 0.5; ++n) scale *= 2;
    return scale;
}

} // namespace

bool measure(const Mesh& mesh, const double* position, Memory& memory, Metric& metric) {
    if (!metric.length.allocate(memory, mesh.edge_count) || !metric.four_areas.allocate(memory, mesh.face_count)) return false;
    const double scale = metric_scale(mesh, position);
    const auto difference = [&](uint32_t h, double* d) {
        const double *a = position + size_t{3} * mesh.origin[h], *b = position + size_t{3} * mesh.target(h);
        for (int c = 0; c < 3; ++c) d[c] = scale * (b[c] - a[c]);
    };
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        double u[3];
        difference(h, u);
        if (!(h & 1)) metric.length[edge_of(h)] = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        if (h > mesh.next[h] || h > mesh.prev(h)) continue;
        double v[3];
        difference(mesh.next[h], v);
        const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        metric.four_areas[mesh.face[h]] = 2 * std::sqrt(x * x + y * y + z * z);
    }
    return true;
}

bool is_delaunay(const Mesh& mesh, const Metric& metric) {
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        if (needs_flip(mesh, metric, e)) return false;
    return true;
}

hmf_status intrinsic_delaunay(Mesh& mesh, Metric& metric, uint32_t* flips, size_t capacity, size_t& flip_count, Call& call,
                              double from, double to) {
    Array<uint32_t> waiting; // stack inside an array: next edge below, NONE at the bottom
    if (!waiting.allocate_filled(call.memory, mesh.edge_count, NOT_WAITING)) return call.out_of_memory();
    uint64_t budget = INTRINSIC_FLIPS_PER_EDGE * mesh.edge_count;
    flip_count = 0;
    uint32_t top = NONE, steps = 0;
    for (uint32_t first = 0; first < mesh.edge_count; ++first) {
        uint32_t e = first;
        for (;;) {
            if (++steps % 16384 == 0 && !call.tick(from + (to - from) * first / mesh.edge_count)) return HMF_CANCELLED;
            if (budget > 0 && flip_if_needed(mesh, metric, e)) {
                --budget;
                if (flip_count < capacity) flips[flip_count] = e;
                ++flip_count;
                const uint32_t h = 2 * e, t = twin(h);
                const uint32_t round[4] = {mesh.next[h], mesh.prev(h), mesh.next[t], mesh.prev(t)};
                for (const uint32_t side : round) {
                    const uint32_t other = edge_of(side);
                    if (waiting[other] != NOT_WAITING) continue;
                    waiting[other] = top;
                    top = other;
                }
            }
            if (top == NONE) break;
            e = top;
            top = waiting[e];
            waiting[e] = NOT_WAITING;
        }
    }
    return HMF_OK;
}

uint64_t intrinsic_weights(const Mesh& mesh, const Metric& metric, double* weight) {
    uint64_t raised = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double w = 0.5 * Quad(mesh, metric, e).cotangent_sum();
        raised += w < FAILURE;
        weight[e] = w < INTRINSIC_WEIGHT_FLOOR ? INTRINSIC_WEIGHT_FLOOR : w > INTRINSIC_WEIGHT_CAP ? INTRINSIC_WEIGHT_CAP : w;
    }
    return raised;
}

} // namespace hmf
