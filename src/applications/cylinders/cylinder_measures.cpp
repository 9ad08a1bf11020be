#include "cylinder_measures.hpp"

#include "curve_classes.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

hmf_status wrong_class(Call& call) {
    return call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                     "The values do not belong to these loops: heights of cylinders and weights of loops differ, or "
                     "their classes do. Pass the loops that were solved.");
}

Done keys_of_cylinders(const GivenCylinders& given, Array<int64_t>& keys, Memory& memory) {
    if (!keys.allocate(memory, given.cylinders.list.size())) return false;
    for (size_t c = 0; c < keys.size(); ++c) keys[c] = given.cylinders.list[c].height;
    return true;
}

// The heights that the cylinders of the loops must have.
Done keys_of_loops(const GivenCylinders& given, const WeightedLoops& loops, Array<int64_t>& keys, Memory& memory) {
    if (!keys.allocate(memory, loops.weights.size())) return false;
    for (size_t c = 0; c < keys.size(); ++c)
        keys[c] = static_cast<int64_t>(static_cast<double>(loops.weights[c]) * (loops.unit / given.unit));
    return true;
}

// Builds `measured`; found[c]: its cylinder that is cylinder c.  Fills out[c].loop, unless loops is NULL.
hmf_status match_by_classes(const GivenCylinders& given, const WeightedLoops* loops, State& solved, Cylinders& measured,
                            Array<uint32_t>& found, Array<hmf_cylinder>& out, Call& call) {
    const size_t n = given.cylinders.list.size(), level = given.state.level;
    const size_t first = loops ? std::max(level, loops->level) : level,
                 last = loops ? std::min(level, loops->level) : level;
    CurveClasses classes;
    ClassTable own, at_minimum, of_loops;
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

hmf_status measure_cylinders(const GivenCylinders& given, const WeightedLoops* loops, State& solved, double unit,
                             Array<hmf_cylinder>& out, Twists* twists, Call& call) {
    const size_t n = given.cylinders.list.size();
    Cylinders measured;
    Array<uint32_t> found;
    Array<double> area;
    Curves middle;
    if (match_by_classes(given, loops, solved, measured, found, out, call)) return call.status();
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
    return twists ? measure_twists(solved, measured, found, out, unit, *twists, call) : HMF_OK;
}

} // namespace hmf
