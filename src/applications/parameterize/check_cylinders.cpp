#include "check_cylinders.hpp"

#include "../../core/base/sparse_map.hpp"
#include "../common/cylinder_leaves.hpp"

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

// Sums along a closed leaf.
struct LeafSums {
    double by_f = 0, by_du = 0; // fluxes
    int64_t rise = 0;           // of u along the vertices on its left
    bool is_crossed = false;    // by a zero
};

LeafSums read_leaf(const Foliation& f, const double* weight, const Array<Crossing>& leaf, const SparseMap& crossed,
                   const SignBundle& bundle, const TwistedForm& du) {
    LeafSums sums;
    int chart = 1; // of the face before the crossing, against the first one
    for (const Crossing& crossing : leaf) {
        const uint32_t h = crossing.half_edge, e = edge_of(h), k = twin(h);
        sums.by_f += weight[e] * static_cast<double>(f.value[e]);
        sums.by_du += weight[e] * chart * static_cast<double>(du.at(bundle, h));
        chart *= bundle.turn[e];
        const bool left = turns_left(f, crossing);
        if (!left) sums.rise -= chart * du.at(bundle, f.mesh.prev(k));
        sums.is_crossed |= crossed.find(left ? k : f.mesh.next[k]) != SparseMap::ABSENT;
    }
    sums.is_crossed |= chart < 0;
    return sums;
}

} // namespace

hmf_status check_cylinders(State& state, const MovedZeros& moved, const SignBundle& bundle, const TwistedForm& du,
                           CylinderCheck& out, Call& call) {
    Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    Cylinders cylinders;
    SparseMap crossed;
    Array<Crossing> leaf;
    leaf.start(call.memory);
    if (!crossed.start(call.memory)) return call.out_of_memory();
    for (const uint32_t h : moved.crossed)
        if (!crossed.set(h, 1)) return call.out_of_memory();
    if (build_cylinders(f, moved.zeros, cylinders, call)) return call.status();
    // A zero may have crossed the middle.
    constexpr double places[] = {0.5, 0.25, 0.75, 0.03, 0.97};
    for (uint32_t c = 0; c < cylinders.list.size(); ++c) {
        const int64_t height = cylinders.list[c].height;
        LeafSums sums;
        sums.is_crossed = true;
        for (size_t k = 0; k < 5 && sums.is_crossed; ++k) {
            const int64_t at = static_cast<int64_t>(places[k] * 2 * static_cast<double>(height)) | 1;
            const Crossing start = leaf_at(f, cylinders, c, std::min(at, 2 * height - 1));
            if (!closed_leaf(f, start, cylinders.graph.crossing_limit(), leaf))
                return call.memory.failure()
                         ? call.out_of_memory()
                         : call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                                     "A leaf crosses too many edges. Pass values as the library returned them for "
                                     "loops.");
            if (!call.work(4 * leaf.size(), 0.5, false)) return call.was_cancelled();
            sums = read_leaf(f, weight, leaf, crossed, bundle, du);
        }
        if (sums.is_crossed) {
            ++out.crossed;
            out.crossed_area += static_cast<double>(height) * sums.by_f;
            continue;
        }
        const double ratio = std::fabs(sums.by_du) / sums.by_f;
        out.least = std::min(out.least, ratio);
        out.most = std::max(out.most, ratio);
        out.area += static_cast<double>(height) * std::fabs(sums.by_du);
        out.open += sums.rise != 0;
    }
    return HMF_OK;
}

} // namespace hmf
