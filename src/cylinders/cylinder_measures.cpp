#include "cylinder_measures.hpp"

#include "../leaves/curve_classes.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// The foliation stretched by labels, on the level and side of `like`.
hmf_status stretch(const hmf_hierarchy& h, size_t level, const Foliation& f, const Cylinders& cylinders,
                   const Labels& labels, State& stretched, Call& call) {
    if (!stretched.allocate(h, level, call.memory)) return call.out_of_memory();
    stretched.load(level, Triangulation::input);
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
    if (!measured.find_vertices(solved.foliation, call) || !labelled.find_vertices(stretched.foliation, call)
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
    state.load(level, Triangulation::input);
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

Done keys_of_cylinders(const GivenCylinders& given, Array<int64_t>& keys, Memory& memory) {
    if (!keys.allocate(memory, given.cylinders.list.size())) return false;
    for (size_t c = 0; c < keys.size(); ++c) keys[c] = given.cylinders.list[c].height;
    return true;
}

// The heights that the cylinders of the loops must have.
Done keys_of_loops(const GivenCylinders& given, const GivenWeights& loops, Array<int64_t>& keys, Memory& memory) {
    if (!keys.allocate(memory, loops.weights.size())) return false;
    for (size_t c = 0; c < keys.size(); ++c)
        keys[c] = static_cast<int64_t>(static_cast<double>(loops.weights[c]) * (loops.unit / given.unit));
    return true;
}

// Fills out[c].loop with two minima on the coarsest level.
hmf_status match_loops_by_minima(const GivenCylinders& given, const GivenWeights& loops, Array<hmf_cylinder>& out,
                                 Call& call) {
    const hmf_hierarchy& h = *given.state.hierarchy;
    const size_t n = given.cylinders.list.size(), coarsest = h.level_count - 1;
    Labels labels;
    State stretched;
    Curves of_loops, own;
    Array<int64_t> loop_keys, keys;
    Array<uint32_t> order, loop_of;
    Cylinders on_coarsest;
    if (!labels.choose(given.cylinders, call.memory) || !keys_of_cylinders(given, keys, call.memory)
        || !keys_of_loops(given, loops, loop_keys, call.memory))
        return call.out_of_memory();
    if (loops_on_coarsest(h, loops.level, loops.loops, of_loops, call)
        || stretch(h, given.state.level, given.state.foliation, given.cylinders, labels, stretched, call))
        return call.status();
    if (!stretched.go_to(coarsest, call) || (coarsest == 0 && !stretched.to_intrinsic(call))) return call.stopped();
    if (on_coarsest.build(stretched.foliation, nullptr, nullptr, call) || labels.find(on_coarsest, order, call)
        || middle_leaves(stretched.foliation, on_coarsest, &order, own, call)
        || match_classes(stretched, own, keys, of_loops, loop_keys, loop_of, call))
        return call.status();
    for (size_t c = 0; c < n; ++c) out[c].loop = loop_of[c];
    return HMF_OK;
}

// Builds `measured`, with find_vertices done; found[c]: its cylinder that is cylinder c.  Fills out[c].loop, unless
// loops is NULL.
hmf_status match_by_labels(const GivenCylinders& given, const GivenWeights* loops, State& solved, double unit,
                           Cylinders& measured, Array<uint32_t>& found, Array<hmf_cylinder>& out, Call& call) {
    const Foliation& f = given.state.foliation;
    Labels labels;
    State stretched;
    Array<double> heights;
    if (!given.cylinders.find_vertices(f, call) || !labels.choose(given.cylinders, call.memory)
        || !heights.allocate(call.memory, out.size()))
        return call.stopped();
    for (size_t c = 0; c < heights.size(); ++c) heights[c] = out[c].height / unit; // exact: units are powers of two
    if (stretch(*solved.hierarchy, solved.level, f, given.cylinders, labels, stretched, call)
        || find_at_minimum(solved, stretched, labels, heights, measured, found, call))
        return call.status();
    return loops ? match_loops_by_minima(given, *loops, out, call) : HMF_OK;
}

// The same by free homotopy classes, without marked vertices.
hmf_status match_by_classes(const GivenCylinders& given, const GivenWeights* loops, State& solved, double,
                            Cylinders& measured, Array<uint32_t>& found, Array<hmf_cylinder>& out, Call& call) {
    const size_t n = given.cylinders.list.size(), level = given.state.level;
    const size_t first = loops ? std::max(level, loops->level) : level,
                 last = loops ? std::min(level, loops->level) : level;
    CurveClasses classes;
    CurveNames own, at_minimum, of_loops;
    if (measured.build(solved.foliation, nullptr, nullptr, call) || classes.start(*solved.hierarchy, first, last, call))
        return call.status();
    for (;;) {
        const size_t here = classes.level();
        if (here == level && classes.name(given.cylinders, own, call)) return call.status();
        if (here == level && level > 0 && classes.name(measured, at_minimum, call)) return call.status();
        if (loops && here == loops->level && classes.name(loops->loops, of_loops, call)) return call.status();
        if (here == last) break;
        if (classes.refine(call)) return call.status();
    }
    if (level == 0 && (classes.to_intrinsic(call) || classes.name(measured, at_minimum, call))) return call.status();
    if (at_minimum.count() != n) return wrong_class(call);
    if (!measured.find_vertices(solved.foliation, call)) return call.stopped();
    if (!found.allocate(call.memory, n)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) {
        found[c] = own.find(c, at_minimum);
        if (found[c] == NONE) return wrong_class(call);
    }
    if (!loops) return HMF_OK;
    Array<int64_t> keys, loop_keys;
    if (!keys_of_cylinders(given, keys, call.memory) || !keys_of_loops(given, *loops, loop_keys, call.memory))
        return call.out_of_memory();
    if (of_loops.count() != n) return wrong_class(call);
    for (size_t c = 0; c < n; ++c) {
        out[c].loop = own.find(c, of_loops);
        if (out[c].loop == NONE || keys[c] != loop_keys[out[c].loop]) return wrong_class(call);
    }
    return HMF_OK;
}

} // namespace

hmf_status measure_cylinders(const GivenCylinders& given, const GivenWeights* loops, State& solved, double unit,
                             Array<hmf_cylinder>& out, Call& call) {
    const size_t n = given.cylinders.list.size();
    Cylinders measured;
    Array<uint32_t> found;
    Array<double> area;
    Curves middle;
    const auto match = given.state.foliation.mesh.marked_count > 0 ? match_by_labels : match_by_classes;
    if (match(given, loops, solved, unit, measured, found, out, call)) return call.status();
    if (!area.allocate(call.memory, n)) return call.out_of_memory();
    const double* weight = solved.hierarchy->levels[solved.level].weight;
    if (cylinder_areas(solved.foliation, measured, weight, area.data(), call)) return call.status();
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

} // namespace hmf
