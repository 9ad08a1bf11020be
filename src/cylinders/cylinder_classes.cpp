// Cylinders and loops matched; see cylinder_classes.hpp.
#include "cylinder_classes.hpp"

#include "../solve/solve.hpp"

#include <algorithm>

namespace hmf {

hmf_status wrong_class(Call& call) {
    return call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                     "The values do not belong to these loops: heights of cylinders and weights of loops differ, or "
                     "their classes do. Pass the loops that were solved.");
}

namespace {

bool is_among(const Array<int64_t>& items, size_t n, int64_t x) {
    for (size_t i = 0; i < n; ++i)
        if (items[i] == x) return true;
    return false;
}

} // namespace

Done Labels::choose(const Cylinders& cylinders, Memory& memory) {
    const size_t n = cylinders.list.size();
    if (!factor.allocate(memory, n) || !height.allocate(memory, n)) return false;
    for (size_t c = 0; c < n; ++c) {
        const int64_t own = cylinders.list[c].height;
        factor[c] = 1;
        height[c] = own;
        while (is_among(height, c, height[c])) height[c] = ++factor[c] * own;
    }
    return true;
}

void Labels::stretch(const Foliation& f, const Cylinders& cylinders, int64_t* value) const {
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
        int64_t sum = 0;
        cylinders.visit_parts(f.mesh, f.value, e,
                              [&](uint32_t c, int64_t from, int64_t to) { sum += factor[c] * ((to - from) / 2); });
        value[e] = sum;
    }
}

hmf_status Labels::find(const Cylinders& others, Array<uint32_t>& found, Call& call) const {
    const size_t n = height.size();
    if (!found.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    for (uint32_t d = 0; d < others.list.size(); ++d)
        for (size_t c = 0; c < n; ++c)
            if (height[c] == others.list[d].height) found[c] = d;
    for (size_t c = 0; c < n; ++c)
        if (found[c] == NONE || others.list.size() != n)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, c,
                             "A cylinder is lost between two triangulations. Please report it.");
    return HMF_OK;
}

namespace {

// By the number of edges; NONE where another one has it already, or where the height is another one.
hmf_status match_by_votes(const Mesh& mesh, const int64_t* value, const Cylinders& here, const int64_t* other_value,
                          const Cylinders& there, const Array<double>* wanted, Array<uint32_t>& found, Call& call) {
    const size_t n = here.list.size();
    Array<uint64_t> votes;
    Array<uint32_t> along, other;
    along.start(call.memory);
    other.start(call.memory);
    if (!votes.allocate_filled(call.memory, n * n, uint64_t{0})) return call.out_of_memory();
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % 65536 == 0 && !call.tick(0)) return call.was_cancelled();
        bool room = true;
        along.clear();
        other.clear();
        here.visit_parts(mesh, value, e, [&](uint32_t c, int64_t, int64_t) { room = room && along.push(c); });
        there.visit_parts(mesh, other_value, e, [&](uint32_t c, int64_t, int64_t) { room = room && other.push(c); });
        if (!room) return call.out_of_memory();
        if (along.size() != other.size()) continue;
        for (size_t i = 0; i < along.size(); ++i) ++votes[along[i] * n + other[i]];
    }
    for (size_t c = 0; c < n; ++c) {
        uint64_t most = 0;
        for (uint32_t d = 0; d < n; ++d)
            if (votes[c * n + d] > most) {
                most = votes[c * n + d];
                found[c] = d;
            }
        for (size_t b = 0; b < c; ++b)
            if (found[b] == found[c]) found[c] = NONE;
        if (wanted && found[c] != NONE && static_cast<double>(there.list[found[c]].height) != (*wanted)[c])
            found[c] = NONE;
    }
    return HMF_OK;
}

} // namespace

hmf_status match_cylinders(const Mesh& mesh, const int64_t* value, const Cylinders& here, const int64_t* other_value,
                           const Cylinders& there, const Array<double>* wanted, Array<uint32_t>& found, Call& call) {
    const size_t n = here.list.size();
    if (there.list.size() != n) return wrong_class(call);
    if (!found.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    if (match_by_votes(mesh, value, here, other_value, there, wanted, found, call)) return call.status();
    for (size_t c = 0; c < n; ++c)
        if (found[c] == NONE) return wrong_class(call);
    return HMF_OK;
}

namespace {

// The harmonic foliation of disjoint curves on the level of the state.  The
// weights are those of the keys, changed by parts of a million so that heights
// tell the curves apart; found: cylinder of each curve.
hmf_status minimise(State& state, const Curves& curves, const Array<int64_t>& key, Cylinders& cylinders,
                    Array<uint32_t>& found, Call& call) {
    Foliation& f = state.foliation;
    const size_t n = key.size();
    Labels labels;
    int64_t largest = 1;
    for (size_t c = 0; c < n; ++c) largest = std::max(largest, key[c]);
    if (!labels.height.allocate(call.memory, n)) return call.out_of_memory();
    const double scale = static_cast<double>(int64_t{1} << 46) / static_cast<double>(largest);
    for (size_t c = 0; c < n; ++c) {
        labels.height[c] = static_cast<int64_t>(static_cast<double>(key[c]) * scale);
        while (is_among(labels.height, c, labels.height[c])) labels.height[c] += 1 << 18;
    }
    state.load(state.level, state.triangulation);
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) f.value[e] = 0;
    for (size_t c = 0; c < n; ++c)
        for (uint64_t i = curves.offsets[c]; i < curves.offsets[c + 1]; ++i)
            f.value[edge_of(curves.crossings[i].half_edge)] += labels.height[c];
    SolveOptions options;
    options.tolerance = 1e-8;
    options.stop_level = state.level;
    Recorder recorder(false, call, 1);
    const hmf_status status = run_cascade(state, options, call, recorder);
    if (status >= HMF_ERROR_NULL) return status;
    // The unit may be finer now, and the heights with it.
    const int64_t finer = static_cast<int64_t>(1 / recorder.unit());
    for (int64_t& height : labels.height) height *= finer;
    if (cylinders.build(f, nullptr, nullptr, call) || labels.find(cylinders, found, call)) return call.status();
    return cylinders.find_vertices(f, call) ? HMF_OK : call.stopped();
}

} // namespace

hmf_status match_classes(State& state, const Curves& a, const Array<int64_t>& key_a, const Curves& b,
                         const Array<int64_t>& key_b, Array<uint32_t>& found, Call& call) {
    Foliation& f = state.foliation;
    const size_t n = key_a.size(), edges = f.mesh.edge_count;
    const double* weight = state.hierarchy->levels[state.level].weight;
    Array<int64_t> value;
    Array<uint32_t> of_a, of_b, on_edges;
    Cylinders in_a, in_b;
    if (key_b.size() != n) return wrong_class(call);
    if (!value.allocate(call.memory, edges) || !found.allocate_filled(call.memory, n, NONE))
        return call.out_of_memory();
    if (minimise(state, a, key_a, in_a, of_a, call)) return call.status();
    std::memcpy(value.data(), f.value, edges * sizeof(int64_t));
    if (minimise(state, b, key_b, in_b, of_b, call)) return call.status();
    double apart = 0, size = 0;
    for (size_t e = 0; e < edges; ++e) {
        const double x = static_cast<double>(f.value[e]), d = x - static_cast<double>(value[e]);
        apart += weight[e] * d * d;
        size += weight[e] * x * x;
    }
    // Another class is not even close.
    if (!(apart < 1e-6 * size)) return wrong_class(call);
    if (match_cylinders(f.mesh, value.data(), in_a, f.value, in_b, nullptr, on_edges, call)) return call.status();
    for (size_t c = 0; c < n; ++c)
        for (uint32_t l = 0; l < n; ++l)
            if (of_b[l] == on_edges[of_a[c]] && key_a[c] == key_b[l]) found[c] = l;
    for (size_t c = 0; c < n; ++c)
        if (found[c] == NONE) return wrong_class(call);
    return HMF_OK;
}

} // namespace hmf
