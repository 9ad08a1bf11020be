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

#include "flat_polygons.hpp"
#include "weights.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmf {

namespace {

constexpr double INTRINSIC_TOLERANCE = -1e-9; // of the sum of two cotangents
constexpr double FLIP_GAIN = 1 - 1e-13;       // of the sum of six cotangents, for one flip
constexpr double THIN = 1e3;                  // sum of cotangents
// Squares of the sine of an angle that lengths do not tell, and squares to 31 digits; then cotangents are known to
// this part.
constexpr double UNKNOWN_ANGLE = 1e-8, UNKNOWN_FINE_ANGLE = 1e-22, AGREEMENT = 1e-6;
constexpr uint32_t NOT_WAITING = NONE - 1, NEEDED = NONE - 2;

// b^2 + c^2 - a^2 without the cancellation of needles.  Branch-free, by a
// table: which of b and c is greater would be mispredicted half the time.
double opposite_product(double a, double b, double c) {
    const double sides[2] = {b, c};
    const bool second = !(b > c);
    const double high = sides[second], low = sides[!second];
    return (high - a) * (high + a) + low * low;
}

// An edge ij and its two triangles; areas are four areas.
template <class Number>
struct EdgeTriangles {
    Number ij, jk, ki, il, lj, area_k, area_l;

    EdgeTriangles(const Mesh& mesh, uint32_t edge, const Array<Number>& side, const Array<Number>& area) {
        const uint32_t h = 2 * edge, t = twin(h);
        const uint32_t jk_side = mesh.next[h], il_side = mesh.next[t];
        ij = side[edge];
        jk = side[edge_of(jk_side)];
        ki = side[edge_of(mesh.next[jk_side])];
        il = side[edge_of(il_side)];
        lj = side[edge_of(mesh.next[il_side])];
        area_k = area[mesh.face[h]];
        area_l = area[mesh.face[t]];
    }
};

// By lengths; and to 31 digits, by squares of lengths.
struct Quad : EdgeTriangles<double> {
    Quad(const Mesh& mesh, const Metric& metric, uint32_t edge) :
        EdgeTriangles(mesh, edge, metric.length, metric.four_areas) {}
    double cotangent_sum() const {
        return opposite_product(ij, jk, ki) / area_k + opposite_product(ij, il, lj) / area_l;
    }
};
struct FineQuad : EdgeTriangles<TwoDoubles> {
    FineQuad(const Mesh& mesh, const Metric& metric, uint32_t edge) :
        EdgeTriangles(mesh, edge, metric.square, metric.fine_area) {}
    double cotangent_sum() const { return ((jk + ki - ij) / area_k + (il + lj - ij) / area_l).value(); }
};

bool one_triangle(const Mesh& mesh, uint32_t edge) { return mesh.face[2 * edge] == mesh.face[2 * edge + 1]; }

} // namespace

double cotangent_sum(const Mesh& mesh, const Metric& metric, uint32_t edge) {
    return metric.is_fine() ? FineQuad(mesh, metric, edge).cotangent_sum() : Quad(mesh, metric, edge).cotangent_sum();
}

bool needs_flip(const Mesh& mesh, const double* sum, uint32_t edge) {
    return sum[edge] < INTRINSIC_TOLERANCE && !one_triangle(mesh, edge);
}

namespace {

// The other diagonal and the areas at i and j; false if it would be no gain.
bool other_diagonal(const Quad& q, double& kl, double& area_i, double& area_j) {
    // Feet of k and l on ij, measured from i and from j; heights.
    const double shift_k = 0.5 * (q.ki - q.jk) * ((q.ki + q.jk) / q.ij),
                 shift_l = 0.5 * (q.il - q.lj) * ((q.il + q.lj) / q.ij);
    const double half = 0.5 * q.ij, y_k = q.area_k / (2 * q.ij), y_l = q.area_l / (2 * q.ij);
    const double x = shift_k - shift_l, y = y_k + y_l;
    kl = std::sqrt(x * x + y * y);
    area_i = 2 * ((half + shift_k) * y_l + (half + shift_l) * y_k);
    area_j = 2 * ((half - shift_k) * y_l + (half - shift_l) * y_k);
    if (!(kl > 0 && area_i > 0 && area_j > 0)) return false;
    const double ij = q.ij * q.ij, jk = q.jk * q.jk, ki = q.ki * q.ki, il = q.il * q.il, lj = q.lj * q.lj;
    return (kl * kl + ki + il) / area_i + (kl * kl + lj + jk) / area_j
         < FLIP_GAIN * ((ij + jk + ki) / q.area_k + (ij + il + lj) / q.area_l);
}

// Products of the sides at i, and at j, give the angles there: with ij along the x-axis, dots are ij times the feet
// of k and l, and half of four areas are ij times their heights.
bool other_diagonal(const FineQuad& q, TwoDoubles& kl, TwoDoubles& area_i, TwoDoubles& area_j) {
    const TwoDoubles i_k = 0.5 * (q.ij + q.ki - q.jk), i_l = 0.5 * (q.ij + q.il - q.lj);
    const TwoDoubles j_k = q.ij - i_k, j_l = q.ij - i_l, k = 0.5 * q.area_k, l = 0.5 * q.area_l;
    kl = q.ki + q.il - 2 * ((i_k * i_l - k * l) / q.ij);
    area_i = 2 * ((k * i_l + l * i_k) / q.ij);
    area_j = 2 * ((k * j_l + l * j_k) / q.ij);
    if (!(kl.high > 0 && area_i.high > 0 && area_j.high > 0)) return false;
    const TwoDoubles after = (kl + q.ki + q.il) / area_i + (kl + q.lj + q.jk) / area_j,
                     before = (q.ij + q.jk + q.ki) / q.area_k + (q.ij + q.il + q.lj) / q.area_l;
    return after.value() < FLIP_GAIN * before.value();
}

bool flip_thin(Mesh& mesh, Metric& metric, uint32_t edge) {
    TwoDoubles kl, area_i, area_j;
    if (!other_diagonal(FineQuad(mesh, metric, edge), kl, area_i, area_j)) return false;
    flip(mesh, edge);
    metric.square[edge] = kl;
    metric.fine_area[mesh.face[2 * edge]] = area_i;
    metric.fine_area[mesh.face[2 * edge + 1]] = area_j;
    return true;
}

// Flips if that is needed and possible.
bool flip_if_needed(Mesh& mesh, Metric& metric, const double* sum, uint32_t edge) {
    if (!needs_flip(mesh, sum, edge)) return false;
    if (!metric.square.empty()) return flip_thin(mesh, metric, edge);
    double kl = 0, area_i = 0, area_j = 0;
    if (!other_diagonal(Quad(mesh, metric, edge), kl, area_i, area_j)) return false;
    flip(mesh, edge); // its triangle on the left is then the one at i
    metric.length[edge] = kl;
    metric.four_areas[mesh.face[2 * edge]] = area_i;
    metric.four_areas[mesh.face[2 * edge + 1]] = area_j;
    return true;
}

// Four times the area, by the formula that does not cancel [Kahan 2000].
double four_areas(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    return std::sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)));
}

// The three angles of a face to the sums of the edges opposite to them.
void set_cotangents(const uint32_t* half_edges, const double* length, double four_areas, EdgeSums& sums) {
    const double a = length[0], b = length[1], c = length[2], inverse = 1 / four_areas;
    sums.set(half_edges[0], inverse * opposite_product(a, b, c));
    sums.set(half_edges[1], inverse * opposite_product(b, c, a));
    sums.set(half_edges[2], inverse * opposite_product(c, a, b));
}

} // namespace

Done measure(const Mesh& mesh, const double* position, const uint32_t* sides, Metric& metric, double* sum, Call& call) {
    EdgeSums sums(sum);
    if (!metric.length.allocate(call.memory, mesh.edge_count)
        || !metric.four_areas.allocate(call.memory, mesh.face_count) || (sum && !sums.allocate(mesh, call.memory)))
        return false;
    const auto visit = [&](uint32_t ij, uint32_t jk, uint32_t ki) {
        const uint32_t half_edges[3] = {ij, jk, ki};
        const double* corner[3];
        for (int s = 0; s < 3; ++s) corner[s] = position + size_t{3} * mesh.origin[half_edges[s]];
        double side[3][3];
        for (int s = 0; s < 3; ++s) {
            const double *a = corner[s], *b = corner[s == 2 ? 0 : s + 1];
            for (int c = 0; c < 3; ++c) side[s][c] = b[c] - a[c];
        }
        // Both triangles of an edge give it the same length.
        double length[3];
        for (int s = 0; s < 3; ++s)
            length[s] = std::sqrt(side[s][0] * side[s][0] + side[s][1] * side[s][1] + side[s][2] * side[s][2]);
        const double *u = side[0], *v = side[1];
        const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        const double four_areas = 2 * std::sqrt(x * x + y * y + z * z);
        for (int s = 0; s < 3; ++s)
            if (!(half_edges[s] & 1)) metric.length[edge_of(half_edges[s])] = length[s];
        metric.four_areas[mesh.face[ij]] = four_areas;
        if (sum) set_cotangents(half_edges, length, four_areas, sums);
    };
    const auto visit_half_edges = [&](size_t begin, size_t end) {
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end), visit);
    };
    const auto visit_sides = [&](size_t begin, size_t end) {
        for (size_t face = begin; face < end; ++face) { // by its lowest half-edge, as there
            const uint32_t* h = sides + 4 * face;
            const uint32_t lowest = ((h[1] < h[0]) & (h[1] < h[2])) + 2u * ((h[2] < h[0]) & (h[2] < h[1])),
                           second = lowest == 2 ? 0 : lowest + 1;
            visit(h[lowest], h[second], h[3 - lowest - second]);
        }
    };
    const Done visited = sides ? call.pass(mesh.face_count, 0, visit_sides)
                               : call.pass(size_t{2} * mesh.edge_count, 0, visit_half_edges);
    return visited && (!sum || sums.add(call, 0));
}

Done mollify(const Mesh& mesh, double factor, Metric& metric, double* sum, Call& call) {
    Array<double>& length = metric.length;
    double total = 0, missing = 0;
    for (const double x : length) total += x;
    const double margin = factor * (total / mesh.edge_count);
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const double rest = length[edge_of(mesh.next[h])] + length[edge_of(mesh.prev(h))] - length[edge_of(h)];
        missing = std::max(missing, margin - rest);
    }
    if (missing == 0) return true;
    for (double& x : length) x += missing;
    EdgeSums sums(sum);
    if (sum && !sums.allocate(mesh, call.memory)) return false;
    for_each_face(mesh, 0, 2 * mesh.edge_count, [&](uint32_t ij, uint32_t jk, uint32_t ki) {
        const uint32_t half_edges[3] = {ij, jk, ki};
        const double side[3] = {length[edge_of(ij)], length[edge_of(jk)], length[edge_of(ki)]};
        double& area = metric.four_areas[mesh.face[ij]];
        area = four_areas(side[0], side[1], side[2]);
        if (sum) set_cotangents(half_edges, side, area, sums);
    });
    return !sum || sums.add(call, 0);
}

Done measure_thin(const Mesh& mesh, const double* position, Metric& metric, double* sum, Call& call) {
    bool thin = false;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) thin |= sum[e] > THIN || sum[e] < -THIN;
    if (!thin) return true;
    if (!metric.square.allocate(call.memory, mesh.edge_count)
        || !metric.fine_area.allocate(call.memory, mesh.face_count))
        return false;
    const auto squares = [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e) {
            TwoDoubles square;
            for (size_t c = 0; c < 3 && position; ++c) {
                const TwoDoubles side = TwoDoubles::of_sum(position[size_t{3} * mesh.origin[2 * e + 1] + c],
                                                           -position[size_t{3} * mesh.origin[2 * e] + c]);
                square = square + side * side;
            }
            metric.square[e] = position ? square : TwoDoubles::of_product(metric.length[e], metric.length[e]);
        }
    };
    const auto areas = [&](size_t begin, size_t end) {
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t ij, uint32_t jk, uint32_t ki) {
                          const TwoDoubles a = metric.square[edge_of(ij)], b = metric.square[edge_of(jk)],
                                           c = metric.square[edge_of(ki)], dot = a + b - c;
                          const TwoDoubles area = square_root(4 * (a * b) - dot * dot);
                          // Without an area in exact numbers it has that which rounding gave it.
                          const double rounded = metric.four_areas[mesh.face[ij]];
                          const bool is_known = area.high > 0.5 * rounded && area.high < 2 * rounded;
                          metric.fine_area[mesh.face[ij]] = is_known ? area : TwoDoubles{rounded, 0};
                      });
    };
    const auto sums = [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e) sum[e] = FineQuad(mesh, metric, static_cast<uint32_t>(e)).cotangent_sum();
    };
    return call.pass(mesh.edge_count, 0, squares) && call.pass(size_t{2} * mesh.edge_count, 0, areas)
        && call.pass(mesh.edge_count, 0, sums);
}

bool is_delaunay(const Mesh& mesh, const double* sum, const Parallel& parallel) {
    return parallel.sum_blocks<uint64_t>(mesh.edge_count, [&](size_t begin, size_t end) {
        uint64_t flips = 0;
        for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e) flips += needs_flip(mesh, sum, e);
        return flips;
    }) == 0;
}

namespace {

// Flips until every edge is Delaunay or `budget` flips were made.
hmf_status flip_edges(Mesh& mesh, Metric& metric, double* sum, uint64_t budget, FlipLog& flips, Call& call, double from,
                      double to) {
    // A stack inside an array: next edge below, NONE at the bottom.  Nearly no edge
    // needs a flip, so all are tested first; later a flip nearby tests again.
    Array<uint32_t> waiting;
    if (!waiting.allocate(call.memory, mesh.edge_count)) return call.out_of_memory();
    const auto test = [&](size_t begin, size_t end) {
        for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e)
            waiting[e] = needs_flip(mesh, sum, e) ? NEEDED : NOT_WAITING;
    };
    if (!call.pass(mesh.edge_count, from, test)) return HMF_CANCELLED;
    uint32_t top = NONE, steps = 0;
    for (uint32_t first = 0; first < mesh.edge_count; ++first) {
        if (waiting[first] != NEEDED) continue;
        uint32_t e = first;
        for (;;) {
            if (++steps % 16384 == 0 && !call.tick(from + (to - from) * first / mesh.edge_count)) return HMF_CANCELLED;
            if (budget > 0 && flip_if_needed(mesh, metric, sum, e)) {
                --budget;
                flips.add(e);
                const uint32_t h = 2 * e, t = twin(h);
                const uint32_t round[4] = {mesh.next[h], mesh.prev(h), mesh.next[t], mesh.prev(t)};
                sum[e] = cotangent_sum(mesh, metric, e);
                for (const uint32_t side : round) {
                    const uint32_t other = edge_of(side);
                    sum[other] = cotangent_sum(mesh, metric, other);
                    if (waiting[other] != NOT_WAITING && waiting[other] != NEEDED) continue;
                    waiting[other] = top;
                    top = other;
                }
            }
            if (top == NONE) break;
            e = top;
            top = waiting[e];
            waiting[e] = NEEDED; // if it is after all, and no gain now, it may be one later
        }
    }
    return HMF_OK;
}

} // namespace

hmf_status intrinsic_delaunay(Mesh& mesh, Metric& metric, double* sum, FlipLog& flips, Call& call, double from,
                              double to) {
    const uint64_t edges = mesh.edge_count, most = INTRINSIC_FLIPS_PER_EDGE * edges;
    for (uint64_t budget = FLIPS_PER_EDGE_ALONE * edges;;) {
        const size_t before = flips.count;
        hmf_status status = flip_edges(mesh, metric, sum, budget, flips, call, from, to);
        if (status || flips.count - before < budget) return status; // no edge is left that a flip improves
        from = to;
        // The polygons of a round take at most two flips of an edge.
        const uint64_t room = most - flips.count;
        if (room == 0) return HMF_OK;
        const bool last = room < 4 * edges;
        budget = last ? room : edges;
        if (!last) status = triangulate_polygons(mesh, metric, sum, flips, call, to);
        if (status) return status;
    }
}

namespace {

// Cotangent of the angle opposite to h, from the sides of its triangle alone; false if the triangle is so thin that
// rounding decides.
bool cotangent_by_sides(const Mesh& mesh, const Metric& metric, uint32_t h, double& cotangent) {
    const TwoDoubles a = metric.square_of(edge_of(h)), b = metric.square_of(edge_of(mesh.next[h])),
                     c = metric.square_of(edge_of(mesh.prev(h)));
    const TwoDoubles dot = b + c - a, product = 4 * (b * c), rest = product - dot * dot;
    cotangent = dot.high / std::sqrt(rest.high);
    return rest.high > (metric.is_fine() ? UNKNOWN_FINE_ANGLE : UNKNOWN_ANGLE) * product.high;
}

} // namespace

Done find_bad_flip(const Mesh& mesh, const Metric& metric, const double* sum, const FlipLog& flips, Call& call,
                   double fraction, uint32_t& bad) {
    Array<uint8_t> is_checked;
    if (!is_checked.allocate_filled(call.memory, mesh.edge_count, 0)) return false;
    for (size_t n = 0; n < flips.count; ++n) {
        if (n % 16384 == 0 && !call.tick(fraction)) return false;
        const uint32_t e = bad = flips.edges[n], h = 2 * e, t = twin(h);
        if (is_checked[e]) continue;
        is_checked[e] = 1;
        // The sums around the flip are those of the triangles as they are.
        for (const uint32_t side : {h, mesh.next[h], mesh.prev(h), mesh.next[t], mesh.prev(t)})
            if (sum[edge_of(side)] != cotangent_sum(mesh, metric, edge_of(side))) return true;
        double at_k = 0, at_l = 0;
        if (!cotangent_by_sides(mesh, metric, h, at_k) || !cotangent_by_sides(mesh, metric, t, at_l)) continue;
        const double difference = at_k + at_l - sum[e], size = 1 + std::fabs(at_k) + std::fabs(at_l);
        if (!(std::fabs(difference) <= AGREEMENT * size) || !(at_k + at_l >= -AGREEMENT * size)) return true;
    }
    bad = NONE;
    return true;
}

} // namespace hmf
