#include "cylinder_measures.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// The foliation stretched by labels, on the level and side of `like`.
hmf_status stretch(const hmf_hierarchy& h, size_t level, const Foliation& f, const Cylinders& cylinders,
                   const Labels& labels, State& stretched, Call& call) {
    if (!stretched.allocate(h, level, call.memory)) return call.out_of_memory();
    stretched.load(level, Side::input);
    if (!call.tick(0)) return call.was_cancelled();
    labels.stretch(f, cylinders, stretched.foliation.value);
    return call.tick(0) ? HMF_OK : call.was_cancelled();
}

// found[c]: the cylinder of `measured`, at the minimum, that is cylinder c of the caller's side.
// heights: of these, in units of solved.
hmf_status find_at_minimum(State& solved, State& stretched, const Labels& labels, const Array<double>& heights,
                           Cylinders& measured, Array<uint32_t>& found, Call& call) {
    Cylinders labelled;
    Array<uint32_t> of_label, on_edges;
    Array<double> wanted;
    if (stretched.level == 0 && !stretched.to_intrinsic(call)) return call.stopped();
    if (measured.build(solved.foliation, nullptr, nullptr, call)
        || labelled.build(stretched.foliation, nullptr, nullptr, call) || labels.find(labelled, of_label, call))
        return call.status();
    if (!measured.find_vertices(solved.foliation, call.memory) || !call.tick(0)
        || !labelled.find_vertices(stretched.foliation, call.memory) || !call.tick(0)
        || !found.allocate(call.memory, of_label.size()) || !wanted.allocate(call.memory, of_label.size()))
        return call.stopped();
    for (size_t c = 0; c < wanted.size(); ++c) wanted[of_label[c]] = heights[c];
    if (match_cylinders(solved.foliation.mesh, stretched.foliation.value, labelled, solved.foliation.value, measured,
                        &wanted, on_edges, call))
        return call.status();
    for (size_t c = 0; c < found.size(); ++c) found[c] = on_edges[of_label[c]];
    return HMF_OK;
}

// Middle leaves of the loops' own cylinders on the coarsest level.  Loop c is
// as high as its number, in steps of `step` units, so that it is found again.
hmf_status loops_on_coarsest(const hmf_hierarchy& h, size_t level, const Loops& loops, Curves& curves, Call& call) {
    constexpr int64_t step = int64_t{1} << 20;
    const size_t coarsest = h.level_count - 1, n = loops.count();
    Array<int64_t> number;
    Array<uint32_t> order;
    State state;
    if (!number.allocate(call.memory, n) || !order.allocate_filled(call.memory, n, 0u)
        || !state.allocate(h, std::min(coarsest, level), call.memory))
        return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) number[c] = static_cast<int64_t>(c + 1) * step;
    state.load(level, Side::input);
    initial_foliation(state.foliation.mesh, loops, number.data(), state.foliation.value);
    if (!state.go_to(coarsest, call) || (coarsest == 0 && !state.to_intrinsic(call))) return call.stopped();
    Cylinders cylinders;
    if (cylinders.build(state.foliation, nullptr, nullptr, call)) return call.status();
    if (cylinders.list.size() != n)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "The loops have other cylinders than expected. Please report it.");
    for (uint32_t d = 0; d < n; ++d) {
        const int64_t found = cylinders.list[d].height / step;
        if (found >= 1 && found <= static_cast<int64_t>(n)) order[static_cast<size_t>(found) - 1] = d;
    }
    return middle_leaves(state.foliation, cylinders, &order, curves, call);
}

} // namespace

hmf_status measure_cylinders(const Foliation& f, const Cylinders& cylinders, State& solved, double unit,
                             Array<hmf_cylinder>& out, Call& call) {
    const size_t n = cylinders.list.size();
    Labels labels;
    State stretched;
    Cylinders measured;
    Array<uint32_t> found;
    Array<double> area, heights;
    Curves middle;
    if (!labels.choose(cylinders, call.memory) || !heights.allocate(call.memory, n)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) heights[c] = out[c].height / unit; // exact: units are powers of two
    if (stretch(*solved.hierarchy, solved.level, f, cylinders, labels, stretched, call)
        || find_at_minimum(solved, stretched, labels, heights, measured, found, call))
        return call.status();
    const double* weight = solved.hierarchy->levels[solved.level].weight;
    if (!area.allocate(call.memory, n)) return call.out_of_memory();
    if (!call.tick(0)) return call.was_cancelled();
    cylinder_areas(solved.foliation, measured, weight, area.data());
    if (middle_leaves(solved.foliation, measured, &found, middle, call)) return call.status();
    for (size_t c = 0; c < n; ++c) {
        double flux = 0;
        for (uint64_t i = middle.offsets[c]; i < middle.offsets[c + 1]; ++i) {
            const uint32_t h = middle.crossings[i].half_edge;
            flux += weight[edge_of(h)] * static_cast<double>(solved.foliation.at(h));
        }
        out[c].circumference = flux * unit;
        out[c].modulus = out[c].height / out[c].circumference;
        out[c].area = area[found[c]] * unit * unit;
    }
    return HMF_OK;
}

hmf_status match_loops(const hmf_hierarchy& h, const State& state, const Cylinders& cylinders, double unit,
                       size_t level, const Loops& loops, const Array<int64_t>& weights, double loops_unit,
                       Array<hmf_cylinder>& out, Call& call) {
    const size_t n = cylinders.list.size(), coarsest = h.level_count - 1;
    Labels labels;
    State stretched;
    Curves of_loops, own;
    Array<int64_t> loop_keys, keys;
    Array<uint32_t> order, loop_of;
    Cylinders on_coarsest;
    if (!labels.choose(cylinders, call.memory) || !keys.allocate(call.memory, n)
        || !loop_keys.allocate(call.memory, weights.size()))
        return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) keys[c] = cylinders.list[c].height;
    for (size_t c = 0; c < weights.size(); ++c)
        loop_keys[c] = static_cast<int64_t>(static_cast<double>(weights[c]) * (loops_unit / unit));
    if (loops_on_coarsest(h, level, loops, of_loops, call)
        || stretch(h, state.level, state.foliation, cylinders, labels, stretched, call))
        return call.status();
    if (!stretched.go_to(coarsest, call) || (coarsest == 0 && !stretched.to_intrinsic(call))) return call.stopped();
    if (on_coarsest.build(stretched.foliation, nullptr, nullptr, call) || labels.find(on_coarsest, order, call)
        || middle_leaves(stretched.foliation, on_coarsest, &order, own, call)
        || match_classes(stretched, own, keys, of_loops, loop_keys, loop_of, call))
        return call.status();
    for (size_t c = 0; c < n; ++c) out[c].loop = loop_of[c];
    return HMF_OK;
}

} // namespace hmf
