#include "foliation_object.hpp"

#include "../foliation/coarser_unit.hpp"
#include "shared_flat.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hmf {

constexpr int weight_bits = 48;

double unit_of_weights(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent); // largest = m * 2^exponent, 0.5 <= m < 1
    return std::ldexp(1.0, exponent - weight_bits);
}

hmf_status refuse_poles(uint64_t poles, Call& call) {
    if (poles == 0) return HMF_OK;
    return call.fail(HMF_ERROR_VALUE_POLE, HMF_ELEMENT_NONE, 0,
                     "The values have %llu poles; hmf_singularities lists them. Start from hmf_initialize or a "
                     "result of hmf_solve.",
                     static_cast<unsigned long long>(poles));
}

hmf_status check_foliation(const hmf_foliation* foliation, Call& call) {
    if (foliation) return refuse_poles(foliation->poles, call);
    return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "The foliation is NULL. Make one with hmf_solve.");
}

hmf_status load_values(const hmf_foliation& foliation, size_t finest, State& state, Call& call) {
    const hmf_hierarchy& h = *foliation.hierarchy;
    const size_t level = foliation.level;
    if (!state.allocate(h, std::min(level, finest), call.memory)) return call.out_of_memory();
    state.load(level, Triangulation::input);
    for (size_t e = 0; e < foliation.count; ++e) {
        if (e % 131072 == 0 && !call.tick(0, true)) return call.was_cancelled();
        state.foliation.value[internal_edge(h, level, e)] = static_cast<int64_t>(foliation.values[e] / foliation.unit);
    }
    return HMF_OK;
}

hmf_status load_solved(const hmf_foliation& foliation, State& state, double& unit, Call& call) {
    unit = foliation.unit;
    if (!foliation.solved) {
        if (load_values(foliation, foliation.level, state, call)) return call.status();
        if (foliation.level > 0 || state.to_intrinsic(call)) return HMF_OK;
        return call.stopped();
    }
    unit = std::ldexp(unit, -static_cast<int>(foliation.solved_bits));
    if (!state.allocate(*foliation.hierarchy, foliation.level, call.memory)) return call.out_of_memory();
    state.load(foliation.level, Triangulation::intrinsic);
    std::memcpy(state.foliation.value, foliation.solved, foliation.count * sizeof(int64_t));
    double largest = 0;
    for (size_t e = 0; e < foliation.count; ++e) largest = std::max(largest, foliation.values[e]);
    state.largest_input_value = static_cast<int64_t>(largest / unit);
    return HMF_OK;
}

hmf_status load_solved_in_unit_of_values(const hmf_foliation& foliation, State& state, Call& call) {
    double unit = 1;
    if (load_solved(foliation, state, unit, call)) return call.status();
    return foliation.solved_bits > 0 ? coarsen_unit(state, static_cast<uint32_t>(foliation.solved_bits), call) : HMF_OK;
}

hmf_status coarsen_unit(State& state, uint32_t bits, Call& call) {
    bool exact = false;
    if (!to_coarser_unit(state.foliation, bits, call.memory, exact)) return call.out_of_memory();
    if (!exact)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "Heights are no multiples of the unit. Please report it.");
    state.largest_input_value >>= bits;
    return HMF_OK;
}

hmf_status make_foliation(const State& state, const Making& making, Call& call, hmf_foliation** out) {
    constexpr int64_t largest_exact = int64_t{1} << 53;
    const hmf_hierarchy& h = *state.hierarchy;
    const Foliation& f = state.foliation;
    const size_t n = f.mesh.edge_count;
    const size_t too_large = call.parallel.sum_blocks<uint64_t>(n, [&](size_t begin, size_t end) {
        uint64_t count = 0;
        for (size_t e = begin; e < end; ++e) count += f.value[e] > largest_exact;
        return count;
    });
    for (size_t e = 0; e < n && too_large > 0; ++e)
        if (f.value[internal_edge(h, state.level, e)] > largest_exact)
            return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_EDGE, e,
                             "The value of edge %llu needs more than the 53 bits of a double: the loops cross it too "
                             "often. Refine the mesh there, or leave loops out.",
                             static_cast<unsigned long long>(e));
    hmf_foliation made{&h,      state.level,  making.unit, n, nullptr, nullptr, making.solved_bits,
                       nullptr, making.poles, 0,           0, {},      {}};
    ResultBlock block;
    block.room(made, made.values, n);
    if (making.solved) block.array(made, made.solved, n, making.solved);
    if (making.fraction) block.array(made, made.fraction, f.mesh.vertex_count, making.fraction);
    if (const Recorder* recorder = making.recorder) {
        made.has_report = 1;
        made.report = recorder->report;
        block.array(made, made.report.levels, recorder->levels.size(), recorder->levels.data());
        block.array(made, made.report.history, recorder->history.size(), recorder->history.data());
    }
    const uint64_t before = call.memory.used();
    hmf_foliation* object = block.make(made, h, call);
    if (!object) return call.status();
    object->bytes = call.memory.used() - before;
    new (&object->flat) std::atomic<SharedFlat*>(nullptr);
    double* values = fill(object->values);
    call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e)
            values[e] = static_cast<double>(f.value[internal_edge(h, state.level, e)]) * making.unit;
    });
    h.references.fetch_add(1, std::memory_order_relaxed);
    *out = object;
    return HMF_OK;
}

// Values of the front of a double, and the same on its back.
static hmf_status mirror_values(const hmf_hierarchy& h, const double* values, Array<double>& both, Call& call) {
    if (!both.allocate(call.memory, h.input.edge_count)) return call.out_of_memory();
    const size_t m = h.surface_triangles;
    for (size_t e = 0; e < h.surface_edges; ++e) both[e] = values[e];
    for (size_t t = 0; t < m; ++t)
        for (size_t s = 0; s < 3; ++s)
            both[h.triangle_edges[3 * (m + t) + 2 - s]] = values[h.triangle_edges[3 * t + s]];
    return HMF_OK;
}

hmf_status read_values(State& state, const double* values, size_t count, double& unit, uint64_t& poles, Call& call) {
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
        largest = std::max(largest, x);
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
    if (!fits())
        return call.fail(HMF_ERROR_VALUE_NOT_CLOSED, HMF_ELEMENT_NONE, 0,
                         "The values are not multiples of a common power of two within 52 bits. Pass values as the "
                         "library returned them.");
    if (!call.tick(0.4)) return call.was_cancelled();
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
    if (!call.tick(0.5)) return call.was_cancelled();
    const SingularityCount found = count_singularities(f, {}, &call);
    if (call.cancelled()) return call.was_cancelled();
    poles = found.poles;
    return HMF_OK;
}

} // namespace hmf

using namespace hmf;

extern "C" {

hmf_status hmf_foliation_create(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                                const hmf_control* control, hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    State state;
    Making making;
    if (!state.allocate(*hierarchy, level, call.memory)) return call.out_of_memory();
    state.load(level, Triangulation::input);
    if (!call.tick(0.1)) return call.was_cancelled();
    Array<double> both;
    if (values && level == 0 && hierarchy->is_double()) {
        if (check_count(count, hierarchy->surface_edges, "values", call)
            || mirror_values(*hierarchy, values, both, call))
            return call.status();
        values = both.data();
        count = both.size();
    }
    if (read_values(state, values, count, making.unit, making.poles, call)) return call.status();
    if (!call.tick(0.9)) return call.was_cancelled();
    return make_foliation(state, making, call, out) ? call.status() : entry.end();
}

void hmf_foliation_destroy(hmf_foliation* foliation) {
    if (!foliation) return;
    hmf_hierarchy* const hierarchy = const_cast<hmf_hierarchy*>(foliation->hierarchy);
    free_shared_flat(*foliation);
    free_block(foliation);
    hmf_destroy(hierarchy);
}

const double* hmf_foliation_values(const hmf_foliation* foliation, size_t* count) {
    if (count) *count = foliation ? foliation->hierarchy->shown_edges(foliation->level) : 0;
    return foliation ? foliation->values : nullptr;
}

size_t hmf_foliation_level(const hmf_foliation* foliation) { return foliation ? foliation->level : 0; }

double hmf_foliation_unit(const hmf_foliation* foliation) { return foliation ? foliation->unit : 0; }

uint64_t hmf_foliation_memory(const hmf_foliation* foliation) {
    if (!foliation) return 0;
    const SharedFlat* const kept = foliation->flat.load(std::memory_order_acquire);
    return foliation->bytes + (kept ? kept->bytes() : 0);
}

const hmf_report* hmf_foliation_report(const hmf_foliation* foliation) {
    return foliation && foliation->has_report ? &foliation->report : nullptr;
}

} // extern "C"
