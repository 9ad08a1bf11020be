// The scale on a cylinder is about its height over its width: where its mean is
// above that of the surface the weight gets smaller by as much, where it is below
// larger.  After some rounds of that the best weights are rounded.
//
// A cylinder is told by the low bits of its height: twice the number of its loop,
// and 1; if the weight counts twice (around a boundary) these are twice as much.
#include "weight_search.hpp"

#include <algorithm>
#include <cmath>

#include "../common/boundary_zeros.hpp"
#include "../common/cylinder_leaves.hpp"
#include "../../core/leaves/double_reflection.hpp"
#include "whole_weights.hpp"

namespace hmf {

namespace {

constexpr int64_t WEIGHT_LABELS = 16384, WEIGHT_LARGEST = int64_t{1} << 40;
constexpr double LARGEST_RATIO = 1024;
constexpr uint32_t WEIGHT_VERTICES = 4000; // of the double, on the level of the search
constexpr uint64_t WEIGHT_ROUNDS = 24;
constexpr double WEIGHT_TOLERANCE = 1e-4, FINE_TOLERANCE = 1e-8;

// exp(x) for small x, the same bits everywhere.
double growth(double x) {
    double sum = 1, term = 1;
    for (int k = 1; k < 20; ++k) sum += term *= x / k;
    return sum;
}

} // namespace

hmf_status WeightSearch::start() {
    level_ = h_.level_count - 1;
    while (level_ > 0 && h_.levels[level_ - 1].mesh.vertex_count <= WEIGHT_VERTICES) --level_;
    tolerance_ = WEIGHT_TOLERANCE;
    return state_.allocate(h_, 0, call_.memory) ? HMF_OK : call_.out_of_memory();
}

hmf_status WeightSearch::keep_all_if_bare(const WeightedLoops& loops, Array<double>& weights, double& unevenness,
                                          bool& bare) {
    bool all = true;
    for (const double w : weights) all = all && w > 0;
    if (find_if_bare(loops, weights, bare)) return call_.status();
    if (all || !bare) return HMF_OK;
    for (double& w : weights) w = std::max(w, 1.0);
    return measure(loops, weights, unevenness) || find_if_bare(loops, weights, bare) ? call_.status() : HMF_OK;
}

hmf_status WeightSearch::find_if_bare(const WeightedLoops& loops, const Array<double>& weights, bool& bare) {
    const size_t level = level_;
    double unevenness = HUGE_VAL;
    bare = false;
    level_ = 0;
    tolerance_ = FINE_TOLERANCE;
    if (measure(loops, weights, unevenness) || (unevenness < HUGE_VAL && find_bare_parts(bare))) return call_.status();
    level_ = level;
    tolerance_ = WEIGHT_TOLERANCE;
    return HMF_OK;
}

hmf_status WeightSearch::measure(const WeightedLoops& loops, const Array<double>& weights, double& unevenness) {
    const size_t n = loops.of.size();
    unevenness = HUGE_VAL;
    if (!integers_.allocate(call_.memory, n)) return call_.out_of_memory();
    double largest = 0;
    for (const double w : weights) largest = std::max(largest, w);
    for (size_t k = 0; k < n; ++k) {
        const double w = weights[loops.of[k]];
        const int64_t x = static_cast<int64_t>(w / largest * static_cast<double>(WEIGHT_LARGEST));
        integers_[k] =
            w > 0 ? (x / WEIGHT_LABELS * WEIGHT_LABELS + 2 * static_cast<int64_t>(loops.of[k]) + 1) * loops.factor[k]
                  : 0;
    }
    ++solves;
    const double part = static_cast<double>(solves) / (static_cast<double>(solves) + 20);
    if (!call_.tick(from + (to - from) * part)) return call_.was_cancelled();
    Call inner(&call_);
    const auto failed = [&]() -> hmf_status {
        if (inner.cancelled() || call_.cancelled()) return call_.was_cancelled();
        return call_.memory.failure() ? call_.out_of_memory() : HMF_OK;
    };
    state_.load(0, Triangulation::input);
    initial_foliation(state_.foliation.mesh, loops.loops, integers_.data(), state_.foliation.value);
    const size_t coarsest = h_.level_count - 1;
    if (!state_.go_to(coarsest, inner) || (coarsest == 0 && !state_.to_intrinsic(inner))) return failed();
    SolveLog log(false, inner, 1);
    SolveOptions options;
    options.tolerance = tolerance_;
    options.stop_level = level_;
    const hmf_status status = run_cascade(state_, options, inner, log);
    if (inner.cancelled() || status >= HMF_ERROR_NULL) return failed();
    if (level_ == 0 && !state_.to_input(inner)) return failed();
    unit_ = log.unit();
    if (!scale_.measure(state_.foliation.mesh, h_.levels[level_].position, state_.foliation.value,
                        unit_ * largest / static_cast<double>(WEIGHT_LARGEST), call_.memory))
        return call_.out_of_memory();
    unevenness = scale_.unevenness();
    return HMF_OK;
}

// What hmf_quads refuses: halves that cannot be made symmetric, zeros that are no disks.
hmf_status WeightSearch::find_bare_parts(bool& any) {
    Reflection reflection;
    Symmetrized made;
    if (make_symmetric(*state_.hierarchy, state_.level, state_.foliation, call_, made)) return call_.status();
    any = !made.exact;
    if (any) return HMF_OK;
    if (read_reflection(h_, reflection, call_)) return call_.status();
    Cylinders cylinders;
    cylinders.graph.division = division_at_boundary(reflection);
    Call inner(&call_);
    if (cylinders.build(state_.foliation, nullptr, nullptr, inner)) {
        if (inner.cancelled()) return call_.was_cancelled();
        return call_.memory.failure() ? call_.out_of_memory() : HMF_OK;
    }
    for (const Zero& zero : cylinders.graph.zeros) any = any || zero.euler != 1;
    return HMF_OK;
}

// Of the scale on the cylinders of each loop, by their vertices.
hmf_status WeightSearch::find_means(const WeightedLoops& loops, bool& known) {
    Memory& memory = call_.memory;
    const Mesh& mesh = state_.foliation.mesh;
    Cylinders cylinders;
    Array<double> area, at_vertex, area_at;
    const size_t count = loops.callers_count();
    known = false;
    Call inner(&call_);
    if (cylinders.build(state_.foliation, nullptr, nullptr, inner)) {
        if (inner.cancelled()) return call_.was_cancelled();
        return memory.failure() ? call_.out_of_memory() : HMF_OK;
    }
    if (!mean_.allocate_filled(memory, count, 0.0) || !area.allocate_filled(memory, count, 0.0)
        || !at_vertex.allocate_filled(memory, mesh.vertex_count, 0.0)
        || !area_at.allocate_filled(memory, mesh.vertex_count, 0.0))
        return call_.out_of_memory();
    CylinderParts parts;
    if (!parts.find(state_.foliation, cylinders, call_)) return call_.stopped();
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t t = mesh.face[h], v = mesh.origin[h];
        at_vertex[v] += scale_.area[t] * scale_.log_scale[t];
        area_at[v] += scale_.area[t];
    }
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double ends = area_at[mesh.origin[2 * e]] + area_at[mesh.target(2 * e)];
        const double sum = at_vertex[mesh.origin[2 * e]] + at_vertex[mesh.target(2 * e)];
        const double whole = 2 * static_cast<double>(state_.foliation.value[e]);
        parts.visit(state_.foliation, e, [&](uint32_t c, int64_t first, int64_t last) {
            const int64_t height = static_cast<int64_t>(static_cast<double>(cylinders.list[c].height) * unit_);
            const int64_t low = height % WEIGHT_LABELS;
            const size_t loop = static_cast<size_t>(low % 2 == 1 ? low / 2 : low / 4);
            if (loop >= count || !(whole > 0)) return;
            const double share = static_cast<double>(last - first) / whole;
            mean_[loop] += share * sum;
            area[loop] += share * ends;
        });
    }
    known = true;
    for (size_t c = 0; c < count; ++c) mean_[c] = area[c] > 0 ? mean_[c] / area[c] : scale_.mean;
    return HMF_OK;
}

hmf_status WeightSearch::run(const WeightedLoops& loops, uint64_t limit, Array<double>& weights, double& unevenness) {
    Array<double> trial;
    double step = 0.7;
    bool known = false;
    const size_t count = loops.callers_count();
    if (!weights.allocate_filled(call_.memory, count, 1.0) || !trial.allocate_filled(call_.memory, count, 1.0))
        return call_.out_of_memory();
    unevenness = HUGE_VAL;
    const uint64_t rounds = limit > 0 && limit < WEIGHT_ROUNDS ? limit : WEIGHT_ROUNDS;
    for (uint64_t k = 0; k < rounds && step > 0.1; ++k) {
        double now = HUGE_VAL;
        if (measure(loops, trial, now)) return call_.status();
        if (now < unevenness) {
            const bool enough = now > 0.998 * unevenness;
            unevenness = now;
            for (size_t c = 0; c < count; ++c) weights[c] = trial[c];
            if (enough) break;
            if (find_means(loops, known)) return call_.status();
            if (!known) break;
        } else step /= 2;
        if (!(unevenness < HUGE_VAL)) return HMF_OK;
        double largest = 0;
        for (size_t c = 0; c < count; ++c) {
            const double off = std::min(2.0, std::max(-2.0, step * (mean_[c] - scale_.mean)));
            trial[c] = weights[c] * growth(-off);
            largest = std::max(largest, trial[c]);
        }
        for (double& w : trial) w = std::max(w / largest, 1 / LARGEST_RATIO);
    }
    double exact = HUGE_VAL;
    if (measure(loops, weights, exact)) return call_.status();
    if (!(exact < HUGE_VAL)) return HMF_OK;
    const Level& level = h_.levels[level_];
    const double across = scale_.across(level.position, level.mesh.vertex_count);
    return to_whole_numbers(exact, across, call_, weights, unevenness,
                            [&](const Array<double>& rounded, double& now) { return measure(loops, rounded, now); });
}

} // namespace hmf
