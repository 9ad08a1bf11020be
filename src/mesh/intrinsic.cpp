// Intrinsic Delaunay triangulation by flips on edge lengths [Fisher, Springborn,
// Bobenko and Schroeder 2006].
//
//          k
//        / | \         The two triangles are laid out in the plane, i at the
//       i--+->j        origin, j on the x-axis; k above, l below.  The flipped
//        \ | /         edge is as long as the distance of k and l there.
//          l
//
// A flip is always possible, unless both sides of the edge are one triangle;
// such an edge is Delaunay already.  The weights are then >= 0 on any input.
#include "intrinsic.hpp"

#include "weights.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double TOLERANCE = -1e-9; // of the sum of cotangents
constexpr double FAILURE = -1e-7;   // of the weight
constexpr uint32_t NOT_WAITING = NONE - 1;

// Four times the area, by the formula that does not cancel [Kahan 2000].
// Lengths that break the triangle inequality by rounding give a thin triangle.
double four_areas(double a, double b, double c) {
    if (a < b) { const double x = a; a = b; b = x; }
    if (b < c) { const double x = b; b = c; c = x; }
    if (a < b) { const double x = a; a = b; b = x; }
    const double rest = c - (a - b);
    const double square = rest > 0 ? (a + (b + c)) * rest * (c + (a - b)) * (a + (b - c)) : 0;
    const double least = 1e-15 * a * a;
    const double area = std::sqrt(square);
    return area > least ? area : least;
}

// Cotangent of the angle opposite to a.
double opposite_cotangent(double a, double b, double c) {
    // (b^2 + c^2 - a^2) without the cancellation of needles.
    const double numerator = b > c ? (b - a) * (b + a) + c * c : (c - a) * (c + a) + b * b;
    return numerator / four_areas(a, b, c);
}

struct Quad {
    double ij, jk, ki, il, lj;
};

Quad quad(const Mesh& mesh, const Array<double>& length, uint32_t edge) {
    const uint32_t h = 2 * edge, t = twin(h);
    const uint32_t jk = mesh.next[h], ki = mesh.next[jk], il = mesh.next[t], lj = mesh.next[il];
    return {length[edge], length[edge_of(jk)], length[edge_of(ki)], length[edge_of(il)], length[edge_of(lj)]};
}

double cotangent_sum(const Quad& q) { return opposite_cotangent(q.ij, q.jk, q.ki) + opposite_cotangent(q.ij, q.il, q.lj); }

double other_diagonal(const Quad& q) {
    // Foot of k and l on ij, measured from i.
    const double x_k = 0.5 * (q.ij + (q.ki - q.jk) * ((q.ki + q.jk) / q.ij));
    const double x_l = 0.5 * (q.ij + (q.il - q.lj) * ((q.il + q.lj) / q.ij));
    const double y = (four_areas(q.ij, q.jk, q.ki) + four_areas(q.ij, q.il, q.lj)) / (2 * q.ij);
    const double x = x_k - x_l;
    return std::sqrt(x * x + y * y);
}

bool one_triangle(const Mesh& mesh, uint32_t edge) { return mesh.face[2 * edge] == mesh.face[2 * edge + 1]; }

// An edge from a vertex to itself would tie the vertex to what it encloses (the
// tip of a spike): such a flip is left out, its weight is raised instead.
bool makes_loop(const Mesh& mesh, uint32_t edge) {
    return mesh.origin[mesh.prev(2 * edge)] == mesh.origin[mesh.prev(2 * edge + 1)];
}

bool needs_flip(const Mesh& mesh, const Array<double>& length, uint32_t edge) {
    return !one_triangle(mesh, edge) && !makes_loop(mesh, edge) && cotangent_sum(quad(mesh, length, edge)) < TOLERANCE;
}

} // namespace

bool edge_lengths(const Mesh& mesh, const double* position, Memory& memory, Array<double>& length) {
    if (!length.allocate(memory, mesh.edge_count)) return false;
    double largest = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double *a = position + size_t{3} * mesh.origin[2 * e], *b = position + size_t{3} * mesh.origin[2 * e + 1];
        for (int c = 0; c < 3; ++c) {
            const double d = a[c] < b[c] ? b[c] - a[c] : a[c] - b[c];
            if (d > largest) largest = d;
        }
    }
    // A power of two: exact, so that the unit of the input has no influence.
    double scale = 1;
    for (int n = 0; n < 1000 && largest * scale > 1; ++n) scale *= 0.5;
    for (int n = 0; n < 1000 && largest * scale < 0.5; ++n) scale *= 2;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double *a = position + size_t{3} * mesh.origin[2 * e], *b = position + size_t{3} * mesh.origin[2 * e + 1];
        const double x = scale * (a[0] - b[0]), y = scale * (a[1] - b[1]), z = scale * (a[2] - b[2]);
        length[e] = std::sqrt(x * x + y * y + z * z);
    }
    return true;
}

bool is_delaunay(const Mesh& mesh, const Array<double>& length) {
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        if (needs_flip(mesh, length, e)) return false;
    return true;
}

hmf_status intrinsic_delaunay(Mesh& mesh, Array<double>& length, uint32_t* flips, size_t capacity, size_t& flip_count, Call& call,
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
            if (budget > 0 && needs_flip(mesh, length, e)) {
                --budget;
                if (flip_count < capacity) flips[flip_count] = e;
                ++flip_count;
                length[e] = other_diagonal(quad(mesh, length, e));
                flip(mesh, e);
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

uint64_t intrinsic_weights(const Mesh& mesh, const Array<double>& length, double* weight) {
    uint64_t raised = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double w = 0.5 * cotangent_sum(quad(mesh, length, e));
        raised += w < FAILURE;
        weight[e] = w < INTRINSIC_WEIGHT_FLOOR ? INTRINSIC_WEIGHT_FLOOR : w > INTRINSIC_WEIGHT_CAP ? INTRINSIC_WEIGHT_CAP : w;
    }
    return raised;
}

} // namespace hmf
