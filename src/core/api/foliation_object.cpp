#include "foliation_object.hpp"

#include "../extreme/coarser_unit.hpp"
#include "read_values.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hmf {

hmf_status refuse_poles(uint64_t poles, Call& call) {
    if (poles == 0) return HMF_OK;
    return call.fail(
        HMF_ERROR_VALUE_POLE, HMF_ELEMENT_NONE, 0,
        "The values have %llu poles; hmf_singularities lists them. Start from hmf_foliation_from_loops or a "
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

hmf_status coarsen_unit(State& state, uint32_t bits, Call& call) {
    bool exact = false;
    if (!to_coarser_unit(state.foliation, bits, call.memory, exact)) return call.out_of_memory();
    if (!exact)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "Heights are no multiples of the unit. Please report it.");
    state.largest_input_value >>= bits;
    return HMF_OK;
}

hmf_status make_foliation(const State& state, const FoliationData& data, Call& call, hmf_foliation** out) {
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
    hmf_foliation made{&h,      state.level, data.unit, n, nullptr, nullptr, data.solved_bits,
                       nullptr, data.poles,  0,         0, {},      {}};
    ResultBlock block;
    block.room(made, made.values, n);
    if (data.solved) block.array(made, made.solved, n, data.solved);
    if (data.fraction) block.array(made, made.fraction, f.mesh.vertex_count, data.fraction);
    if (const SolveLog* log = data.log) {
        made.has_report = 1;
        made.report = log->report;
        block.array(made, made.report.levels, log->levels.size(), log->levels.data());
        block.array(made, made.report.history, log->history.size(), log->history.data());
    }
    const uint64_t before = call.memory.used();
    hmf_foliation* object = block.make(made, h, call);
    if (!object) return call.status();
    object->bytes = call.memory.used() - before;
    new (&object->kept) std::atomic<Kept*>(nullptr);
    double* values = fill(object->values);
    call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e)
            values[e] = static_cast<double>(f.value[internal_edge(h, state.level, e)]) * data.unit;
    });
    h.references.fetch_add(1, std::memory_order_relaxed);
    *out = object;
    return HMF_OK;
}

} // namespace hmf

using namespace hmf;

extern "C" {

hmf_status hmf_foliation_from_values(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                                     const hmf_control* control, hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    State state;
    FoliationData data;
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
    if (read_values(state, values, count, data.unit, data.poles, call)) return call.status();
    if (!call.tick(0.9)) return call.was_cancelled();
    return make_foliation(state, data, call, out) ? call.status() : entry.end();
}

void hmf_foliation_destroy(hmf_foliation* foliation) {
    if (!foliation) return;
    hmf_hierarchy* const hierarchy = const_cast<hmf_hierarchy*>(foliation->hierarchy);
    if (Kept* const kept = foliation->kept.load()) kept->destroy(kept, *hierarchy);
    free_block(foliation);
    hmf_hierarchy_destroy(hierarchy);
}

const double* hmf_foliation_values(const hmf_foliation* foliation, size_t* count) {
    if (count) *count = foliation ? foliation->hierarchy->shown_edges(foliation->level) : 0;
    return foliation ? foliation->values : nullptr;
}

size_t hmf_foliation_level(const hmf_foliation* foliation) { return foliation ? foliation->level : 0; }

double hmf_foliation_unit(const hmf_foliation* foliation) { return foliation ? foliation->unit : 0; }

uint64_t hmf_foliation_memory(const hmf_foliation* foliation) {
    if (!foliation) return 0;
    const Kept* const kept = foliation->kept.load(std::memory_order_acquire);
    return foliation->bytes + (kept ? kept->bytes : 0);
}

const hmf_report* hmf_foliation_report(const hmf_foliation* foliation) {
    return foliation && foliation->has_report ? &foliation->report : nullptr;
}

} // extern "C"
