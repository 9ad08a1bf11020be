#include "check_cylinders.hpp"

#include "../../core/leaves/cylinders.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

hmf_status build_cylinders(Foliation& f, const ZeroList& zeros, Cylinders& cylinders, Call& call) {
    if (f.mesh.marked_count == 0) {
        Call quiet(&call);
        const hmf_status status = cylinders.build(f, zeros, quiet);
        if (call.cancelled() || call.memory.failure()) return call.stopped();
        int64_t sum = 0;
        for (const Zero& zero : cylinders.graph.zeros) sum += zero.index;
        if (status == HMF_OK && sum == 2 * f.mesh.euler()) return HMF_OK;
    }
    return cylinders.build(f, nullptr, nullptr, call);
}

} // namespace

hmf_status check_cylinders(State& state, const ZeroList& zeros, const SignBundle& bundle, const TwistedForm& du,
                           CylinderCheck& out, Call& call) {
    Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    Cylinders cylinders;
    Array<Crossing> leaf;
    leaf.start(call.memory);
    if (build_cylinders(f, zeros, cylinders, call)) return call.status();
    // Of one that is narrower than a triangle a zero may have crossed the middle.
    constexpr double places[] = {0.5, 0.25, 0.75, 0.03, 0.97};
    for (uint32_t c = 0; c < cylinders.list.size(); ++c) {
        const int64_t height = cylinders.list[c].height;
        bool is_crossed = true;
        for (size_t k = 0; k < 5 && is_crossed; ++k) {
            const int64_t at = static_cast<int64_t>(places[k] * 2 * static_cast<double>(height)) | 1;
            const Crossing start = cylinders.leaf_at(f, c, std::min(at, 2 * height - 1));
            if (!closed_leaf(f, start, cylinders.graph.crossing_limit(), leaf))
                return call.memory.failure()
                         ? call.out_of_memory()
                         : call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                                     "A leaf crosses too many edges. Pass values as the library returned them for "
                                     "loops.");
            if (!call.work(4 * leaf.size(), 0.5, false)) return call.was_cancelled();
            double by_du = 0, by_f = 0;
            int chart = 1; // of the face before the crossing, against the first one
            for (const Crossing& crossing : leaf) {
                const uint32_t h = crossing.half_edge, e = edge_of(h);
                by_f += weight[e] * static_cast<double>(f.value[e]);
                by_du += weight[e] * chart * static_cast<double>(du.at(bundle, h));
                chart *= bundle.turn[e];
            }
            if (chart < 0) continue;
            is_crossed = false;
            const double ratio = std::fabs(by_du) / by_f;
            out.least = std::min(out.least, ratio);
            out.most = std::max(out.most, ratio);
            out.area += static_cast<double>(height) * std::fabs(by_du);
        }
        out.crossed += is_crossed;
    }
    return HMF_OK;
}

} // namespace hmf
