// The certificate during a solve, and the way back; see class_guard.hpp.
#include "solve.hpp"

namespace hmf {

hmf_status ClassGuard::start(State& state, double unit_of_values, const Loops* loops, const Array<int64_t>& weights,
                             Call& call) {
    const double begin = call.seconds();
    const Mesh& mesh = state.foliation.mesh;
    state.listener = nullptr;
    started = false;
    checks = Checks::result;
    zeros.known = false;
    zeros.vertices.start(call.memory);
    zeros.tripods.start(call.memory);
    unit = unit_of_values;
    // Room for the finest level.
    if (!words.start(mesh, state.hierarchy->levels[0].mesh.edge_count, call)) return call.stopped();
    if (!call.tick(0, true)) return call.was_cancelled();
    if (reference.take(state.foliation, words, call)) return call.status();
    if (!call.tick(0, true)) return call.was_cancelled();
    if (reference.known()) {
        if (loops) {
            if (reference.number_by_class(mesh, words, *loops, call)) return call.status();
        } else if (!weights.empty()) {
            reference.number_by_weight(weights);
        }
        started = weights.empty() || reference.agrees(weights);
        if (started) listen(state);
    }
    seconds += call.seconds() - begin;
    return HMF_OK;
}

void ClassGuard::listen(State& state) {
    listener_ = {&words,
                 [](void* user, const Mesh& mesh, uint32_t edge, bool reversed) {
                     return static_cast<CurveWords*>(user)->flipped(mesh, edge, reversed);
                 },
                 [](void* user, const Mesh& mesh, const Collapse* collapses, size_t count, Call& call) {
                     return static_cast<CurveWords*>(user)->were_split(mesh, collapses, count, call);
                 }};
    state.listener = &listener_;
}

hmf_status ClassGuard::certify(State& state, double unit_of_values, Call& call) {
    result = {};
    if (!started) return HMF_OK;
    const double begin = call.seconds();
    const int64_t finer = static_cast<int64_t>(unit / unit_of_values);
    const hmf_status status = reference.compare(state.foliation, words, zeros, finer, call, result);
    zeros.known = false; // the values go on changing
    if (!holds()) lost = result;
    seconds += call.seconds() - begin;
    return status;
}

hmf_status solve_in_class(State& state, const SolveOptions& options, Call& call, SolveLog& log, ClassGuard& guard) {
    const size_t start = state.level;
    const Triangulation triangulation = state.triangulation;
    const double unit = log.unit();
    const int64_t largest = state.largest_input_value;
    const TransportStatistics statistics = state.statistics;
    Foliation& f = state.foliation;
    Array<int64_t> values;
    Array<uint32_t> out; // decides the tree of the walks; another one than that of the level after restriction
    if (guard.started && options.method == HMF_METHOD_NEWTON) {
        if (!values.allocate(call.memory, f.mesh.edge_count) || !out.allocate(call.memory, f.mesh.vertex_count))
            return call.out_of_memory();
        std::memcpy(values.data(), f.value, values.size() * sizeof(int64_t));
        std::memcpy(out.data(), f.mesh.out, out.size() * sizeof(uint32_t));
    }
    hmf_status status = run_cascade(state, options, call, log, &guard);
    if (status >= HMF_ERROR_NULL || call.cancelled() || state.level != options.stop_level) return status;
    if (const hmf_status looked = guard.certify(state, log.unit(), call)) return looked;
    if (guard.holds()) return status;
    if (values.empty())
        return status == HMF_OK ? HMF_LIMIT_CLASS : status; // HMF_METHOD_PAPER: flips may leave the class
    if (call.finishing()) return HMF_CANCELLED;             // there is no time for another try
    if (call.out_of_time()) return HMF_LIMIT_TIME;

    // Repeats the solve with guarded steps.
    state.load(start, triangulation);
    std::memcpy(f.mesh.out, out.data(), out.size() * sizeof(uint32_t));
    std::memcpy(f.value, values.data(), values.size() * sizeof(int64_t));
    log.set_unit(unit);
    state.largest_input_value = largest;
    state.statistics = statistics;
    if (state.listener && !guard.words.start(f.mesh, state.hierarchy->levels[0].mesh.edge_count, call))
        return call.stopped();
    guard.checks = ClassGuard::Checks::levels;
    log.certificate.known = false;
    if (!log.event(state.level, 0, energy(f, state.hierarchy->levels[start].weight, call.parallel), -1))
        return call.out_of_memory();
    status = run_cascade(state, options, call, log, &guard);
    if (status >= HMF_ERROR_NULL || call.cancelled() || state.level != options.stop_level) return status;
    const ClassCheck lost = guard.lost;
    if (const hmf_status looked = guard.certify(state, log.unit(), call)) return looked;
    if (guard.holds()) guard.lost = lost;
    else if (status == HMF_OK) status = HMF_LIMIT_CLASS;
    return status;
}

} // namespace hmf
