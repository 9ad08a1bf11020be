#include "read_values.hpp"

#include "entry.hpp"
#include "foliation_object.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr int WEIGHT_BITS = 48;
constexpr int DOUBLE_BITS = 53;
constexpr int FEW_BITS = 40; // values with fewer are given a finer unit
// Of the largest value: its unit is a normal double, and the values are finite in others.
constexpr double LEAST_VALUE = 1e-270, MOST_VALUE = 1e300;

// x = m * 2^exponent, 0.5 <= m < 1
int exponent_of(double x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    return exponent;
}

// The exponent of the lowest bit of x > 0.
int lowest_bit(double x) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    uint64_t bits = static_cast<uint64_t>(std::ldexp(mantissa, DOUBLE_BITS));
    int zeros = 0;
    for (; !(bits & 1); bits >>= 1) ++zeros;
    return exponent - DOUBLE_BITS + zeros;
}

struct Range {
    double largest = 0;
    int lowest = INT32_MAX; // the lowest bit that any value uses
};

hmf_status find_range(const double* values, size_t count, Range& range, Call& call) {
    for (size_t e = 0; e < count; ++e) {
        const double x = values[e];
        if (!(x >= 0) || x > MOST_VALUE)
            return call.fail(HMF_ERROR_VALUE_NOT_FINITE, HMF_ELEMENT_EDGE, e,
                             "The value of edge %llu is %g. Values are not negative, and at most 1e300.",
                             static_cast<unsigned long long>(e), x);
        range.largest = std::max(range.largest, x);
        if (x > 0) range.lowest = std::min(range.lowest, lowest_bit(x));
    }
    if (range.largest == 0)
        return call.fail(HMF_ERROR_VALUE_POLE, HMF_ELEMENT_EDGE, 0,
                         "All values are zero. A foliation has at least one positive value.");
    if (range.largest < LEAST_VALUE)
        return call.fail(HMF_ERROR_VALUE_NOT_FINITE, HMF_ELEMENT_NONE, 0,
                         "The largest value is %g. It is at least 1e-270: multiply all by a power of two.",
                         range.largest);
    return HMF_OK;
}

// Values with few bits get a finer unit.  Others, results of the library as a
// rule, keep theirs, so that no bit is lost by passing them on and on; if
// positions in the tree (half of a sum of three values) are then no
// integers, one bit more is needed.
hmf_status to_integers(State& state, const double* values, size_t count, double& unit, Call& call) {
    Foliation& f = state.foliation;
    Range range;
    if (find_range(values, count, range, call)) return call.status();
    const int exponent = exponent_of(range.largest);
    const bool few = exponent - range.lowest < FEW_BITS;
    int unit_exponent = few ? exponent - WEIGHT_BITS : range.lowest;
    const auto fits = [&] { return exponent - unit_exponent <= DOUBLE_BITS; };
    const auto read = [&] {
        unit = std::ldexp(1.0, unit_exponent);
        for (size_t e = 0; e < count; ++e)
            f.value[internal_edge(*state.hierarchy, state.level, e)] = static_cast<int64_t>(values[e] / unit);
    };
    if (fits()) read();
    if (!few && fits()) {
        int64_t odd = 0;
        for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h) odd |= f.corner2(h) & 1;
        if (odd) {
            --unit_exponent;
            if (fits()) read();
        }
    }
    if (fits()) return HMF_OK;
    return call.fail(HMF_ERROR_VALUE_NOT_CLOSED, HMF_ELEMENT_NONE, 0,
                     "The values are not multiples of a common power of two within 52 bits. Pass values as the "
                     "library returned them.");
}

// Triangle inequalities, and an even sum around each triangle.
hmf_status check_triangles(const State& state, size_t count, Call& call) {
    const Foliation& f = state.foliation;
    for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h) {
        const int64_t corner2 = f.corner2(h);
        if (corner2 >= 0 && corner2 % 2 == 0) continue;
        const uint32_t opposite = edge_of(f.mesh.next[h]);
        size_t edge = 0;
        while (edge < count && internal_edge(*state.hierarchy, state.level, edge) != opposite) ++edge;
        return call.fail(
            HMF_ERROR_VALUE_NOT_CLOSED, HMF_ELEMENT_EDGE, edge,
            "The triangle inequality breaks at edge %llu. Pass values of this mesh as the library returned them.",
            static_cast<unsigned long long>(edge));
    }
    return HMF_OK;
}

} // namespace

double unit_of_weights(double largest) { return std::ldexp(1.0, exponent_of(largest) - WEIGHT_BITS); }

hmf_status mirror_values(const hmf_hierarchy& h, const double* values, Array<double>& both, Call& call) {
    if (!both.allocate(call.memory, h.input.edge_count)) return call.out_of_memory();
    const size_t m = h.surface_triangles;
    for (size_t e = 0; e < h.surface_edges; ++e) both[e] = values[e];
    for (size_t t = 0; t < m; ++t)
        for (size_t s = 0; s < 3; ++s)
            both[h.triangle_edges[3 * (m + t) + 2 - s]] = values[h.triangle_edges[3 * t + s]];
    return HMF_OK;
}

hmf_status read_values(State& state, const double* values, size_t count, double& unit, uint64_t& poles, Call& call) {
    if (!values)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "values is NULL. Give one value per edge of the level.");
    if (check_count(count, state.foliation.mesh.edge_count, "values", call)
        || to_integers(state, values, count, unit, call))
        return call.status();
    if (!call.tick(0.4)) return call.was_cancelled();
    if (check_triangles(state, count, call)) return call.status();
    if (!call.tick(0.5)) return call.was_cancelled();
    const SingularityCount found = count_singularities(state.foliation, {}, &call);
    if (call.cancelled()) return call.was_cancelled();
    poles = found.poles;
    return HMF_OK;
}

} // namespace hmf
