#include "values.hpp"

#include <cmath>

namespace hmf {

double unit_of_weights(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent); // largest = m * 2^exponent, 0.5 <= m < 1
    return std::ldexp(1.0, exponent - weight_bits);
}

hmf_status check_level(const hmf_hierarchy* hierarchy, size_t level, Call& call) {
    if (!hierarchy)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "The hierarchy is NULL. Make one with hmf_build.");
    if (level >= hierarchy->level_count)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                         "There is no level %llu; the hierarchy has %llu, counted from 0.",
                         static_cast<unsigned long long>(level),
                         static_cast<unsigned long long>(hierarchy->level_count));
    return HMF_OK;
}

hmf_status check_count(size_t count, size_t needed, const char* what, Call& call) {
    if (count == needed) return HMF_OK;
    return call.fail(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, needed, "%s has %llu entries but the level has %llu.", what,
                     static_cast<unsigned long long>(count), static_cast<unsigned long long>(needed));
}

hmf_status check_capacity(size_t capacity, size_t needed, const char* what, Call& call) {
    if (capacity >= needed) return HMF_OK;
    return call.fail(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, needed, "%s has room for %llu entries but %llu are needed.",
                     what, static_cast<unsigned long long>(capacity), static_cast<unsigned long long>(needed));
}

uint32_t internal_side(const hmf_hierarchy& h, size_t triangle) {
    const uint32_t* edges = h.triangle_edges + 3 * triangle;
    const uint32_t second = h.edge_internal[edges[1]], third = h.edge_internal[edges[2]];
    uint32_t side = 2 * h.edge_internal[edges[0]];
    for (uint32_t turn = 0; turn < 2; ++turn, side = twin(side)) {
        const uint32_t a = edge_of(h.input.next[side]), b = edge_of(h.input.prev(side));
        if ((a == second && b == third) || (a == third && b == second)) break;
    }
    return side;
}

uint32_t internal_face(const hmf_hierarchy& h, size_t triangle) { return h.input.face[internal_side(h, triangle)]; }

bool first_sides(const State& state, Array<uint32_t>& side, Memory& memory) {
    const Mesh& mesh = state.foliation.mesh;
    if (!side.allocate(memory, mesh.face_count)) return false;
    if (state.level == 0) {
        for (uint32_t t = 0; t < mesh.face_count; ++t) side[t] = internal_side(*state.hierarchy, t);
    } else {
        for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    }
    return true;
}

namespace {

// The caller's number of each internal edge is not stored; the map goes the other way.
uint32_t internal_edge(const State& state, size_t e) {
    return state.level == 0 ? state.hierarchy->edge_internal[e] : static_cast<uint32_t>(e);
}

} // namespace

hmf_status import_values(State& state, const double* values, size_t count, double& unit, bool poles_allowed,
                         Call& call) {
    Foliation& f = state.foliation;
    if (!values)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "values is NULL. Give one value per edge of the level.");
    if (check_count(count, f.mesh.edge_count, "values", call)) return call.status();
    // The lowest bit that any value uses, and the largest value.
    double largest = 0;
    int lowest = INT32_MAX;
    for (size_t e = 0; e < count; ++e) {
        const double x = values[e];
        if (!(x >= 0) || x > 1e300)
            return call.fail(HMF_ERROR_VALUE_NOT_FINITE, HMF_ELEMENT_EDGE, e,
                             "The value of edge %llu is %g. Values are finite and not negative.",
                             static_cast<unsigned long long>(e), x);
        if (x > largest) largest = x;
        if (x == 0) continue;
        int exponent = 0;
        const double mantissa = std::frexp(x, &exponent);
        uint64_t bits = static_cast<uint64_t>(std::ldexp(mantissa, 53));
        int zeros = 0;
        while (!(bits & 1)) {
            bits >>= 1;
            ++zeros;
        }
        if (exponent - 53 + zeros < lowest) lowest = exponent - 53 + zeros;
    }
    if (largest == 0)
        return call.fail(HMF_ERROR_VALUE_POLE, HMF_ELEMENT_EDGE, 0,
                         "All values are zero. A foliation has at least one positive value.");
    int exponent = 0;
    std::frexp(largest, &exponent);
    // Values with few bits get a finer unit.  Others, results of the library as a
    // rule, keep theirs, so that no bit is lost by passing them on and on; if
    // positions in the tree (half of a sum of three values) are then no
    // integers, one bit more is needed.
    constexpr int full = 40;
    const bool few = exponent - lowest < full;
    int unit_exponent = few ? exponent - weight_bits : lowest;
    const auto fits = [&] { return exponent - unit_exponent <= 53; };
    const auto read = [&] {
        unit = std::ldexp(1.0, unit_exponent);
        for (size_t e = 0; e < count; ++e) f.value[internal_edge(state, e)] = static_cast<int64_t>(values[e] / unit);
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
    if (!fits())
        return call.fail(HMF_ERROR_VALUE_NOT_CLOSED, HMF_ELEMENT_NONE, 0,
                         "The values are not multiples of a common power of two within 52 bits. Pass values as the "
                         "library returned them.");
    for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h) {
        const int64_t corner2 = f.corner2(h);
        if (corner2 >= 0 && corner2 % 2 == 0) continue;
        uint64_t edge = edge_of(f.mesh.next[h]);
        if (state.level == 0)
            for (uint64_t e = 0; e < count; ++e)
                if (state.hierarchy->edge_internal[e] == edge) {
                    edge = e;
                    break;
                }
        return call.fail(
            HMF_ERROR_VALUE_NOT_CLOSED, HMF_ELEMENT_EDGE, edge,
            "The triangle inequality breaks at edge %llu. Pass values of this mesh as the library returned them.",
            static_cast<unsigned long long>(edge));
    }
    if (poles_allowed) return HMF_OK;
    const SingularityCount found = count_singularities(f, nullptr, nullptr, nullptr, nullptr);
    if (f.out_of_memory) return call.out_of_memory();
    if (found.poles > 0)
        return call.fail(HMF_ERROR_VALUE_POLE, HMF_ELEMENT_NONE, 0,
                         "The values have %llu poles; hmf_singularities lists them. Start from hmf_initialize or a "
                         "result of hmf_solve.",
                         static_cast<unsigned long long>(found.poles));
    return HMF_OK;
}

hmf_status export_values(const State& state, double unit, double* values, Call& call) {
    constexpr int64_t largest_exact = int64_t{1} << 53;
    const Foliation& f = state.foliation;
    for (size_t e = 0; e < f.mesh.edge_count; ++e)
        if (f.value[internal_edge(state, e)] > largest_exact)
            return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_EDGE, e,
                             "The value of edge %llu needs more than the 53 bits of a double: the loops cross it too "
                             "often. Refine the mesh there, or leave loops out.",
                             static_cast<unsigned long long>(e));
    for (size_t e = 0; e < f.mesh.edge_count; ++e)
        values[e] = static_cast<double>(f.value[internal_edge(state, e)]) * unit;
    return HMF_OK;
}

} // namespace hmf
