#include "class_lengths.hpp"

#include "carry_loops.hpp"
#include "../../core/curves/disjoint.hpp"
#include "library_loops.hpp"
#include "loop_parameters.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

// Per axis, in CLOSE.
static constexpr double TILT[3] = {1, 0.6, 0.4};

ClassLengths::ClassLengths(const hmf_hierarchy& hierarchy, size_t found, Call& call, LoopCare care) :
    hierarchy_(&hierarchy), mesh_(loop_mesh(hierarchy, found)), position_(hierarchy.levels[found].position),
    call_(call), care_(care), found_(found), level_(found), geodesic_(mesh_, position_, 0, call),
    dual_length_(mesh_, position_) {
    while (level_ > 0 && hierarchy.levels[level_].mesh.vertex_count < MEASURED_VERTICES) --level_;
    finest_ = level_;
    while (finest_ > 0 && hierarchy.levels[finest_].mesh.vertex_count < FINEST_VERTICES) --finest_;
}

ClassLengths::ClassLengths(const Mesh& mesh, const double* position, Call& call) :
    hierarchy_(nullptr), mesh_(mesh), position_(position), call_(call), geodesic_(mesh, position, 0, call),
    dual_length_(mesh, position) {}

Done ClassLengths::start() {
    Memory& memory = call_.memory;
    started_ = true;
    classes_.start(memory);
    crossings_.start(memory);
    loop_.start(memory);
    name_.start(memory);
    names_.start(memory);
    measure_extent();
    if (!strip_length_.allocate_filled(memory, mesh_.edge_count, -1.0)) return false;
    if (!visited_.allocate_filled(memory, mesh_.face_count, 0u)) return false;
    if (!geodesic_.keep_lengths() || !one_.start(memory) || !curve_.allocate(mesh_, memory)) return false;
    return words_.start(mesh_, mesh_.edge_count, call_);
}

// The box of the surface.
void ClassLengths::measure_extent() {
    double highest[3] = {0, 0, 0};
    for (size_t v = 0; v < mesh_.vertex_count; ++v)
        for (size_t a = 0; a < 3; ++a) {
            const double x = position_[3 * v + a] / geodesic_.scale();
            if (v == 0 || x < lowest_[a]) lowest_[a] = x;
            if (v == 0 || x > highest[a]) highest[a] = x;
        }
    for (size_t a = 0; a < 3; ++a) tilt_[a] = highest[a] > lowest_[a] ? CLOSE * TILT[a] / (highest[a] - lowest_[a]) : 0;
}

Done ClassLengths::pull(ClosedGeodesic& geodesic, const Mesh& mesh, const double* position, const uint32_t* crossings,
                        size_t n, Class& c) {
    loop_.clear();
    for (size_t i = 0; i < n; ++i)
        if (!loop_.push(crossings[i])) return false;
    if (!geodesic.straighten(loop_, MOST_REPEATS, c.length)) return false;
    // In the tilted metric, by the mean place of the edges that it crosses.
    double sum = 0;
    for (const uint32_t h : loop_)
        for (size_t a = 0; a < 3; ++a) {
            const double ends = position[3 * size_t{mesh.origin[h]} + a] / geodesic.scale()
                              + position[3 * size_t{mesh.target(h)} + a] / geodesic.scale();
            sum += tilt_[a] * (ends / 2 - lowest_[a]);
        }
    const double n_left = static_cast<double>(loop_.size());
    c.doubt = ROUND_DOUBT / (n_left * n_left);
    c.length *= 1 + sum / n_left;
    return true;
}

double ClassLengths::strip_length(const uint32_t* crossings, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
        double& length = strip_length_[edge_of(crossings[i])];
        if (length < 0) length = dual_length_(edge_of(crossings[i]));
        sum += length;
    }
    return sum;
}

Done ClassLengths::add(const uint32_t* crossings, size_t n, uint32_t& id) {
    if (!started_ && !start()) return false;
    name_.clear();
    if (!words_.name(
            mesh_, 0, n, [&](uint64_t i) { return crossings[i]; }, name_)
        || !names_.add(name_, id))
        return false;
    const bool is_new = id == classes_.size();
    const double strip = strip_length(crossings, n);
    if (care_ == LoopCare::quick) {
        Class known{};
        known.length = strip;
        return !is_new || classes_.push(known);
    }
    if (!is_new && !(strip < classes_[id].strip * (1 - CLOSE))) {
        // Another strip of a class may lead to another of its geodesics, unless it is the same one: some hang on marked
        // vertices, others are separated by bumps.
        const Class& c = classes_[id];
        const size_t most = mesh_.marked_count > 0 ? CANDIDATES : STARTS;
        size_t met = 0;
        ++visit_;
        for (size_t k = 0; k < n; ++k) visited_[mesh_.face[crossings[k]]] = visit_;
        for (uint64_t k = c.first; k < c.end; ++k) met += visited_[mesh_.face[crossings_[k]]] == visit_;
        if (c.starts >= most || met == n) return true;
    }
    Class made{};
    made.starts = 1;
    made.stage = stage_where_found();
    if (!pull(geodesic_, mesh_, position_, crossings, n, made)) return false;
    if (!is_new) {
        Class& c = classes_[id];
        if (c.starts < UINT8_MAX) ++c.starts;
        c.strip = std::min(c.strip, strip);
        if (c.stage != made.stage && made.length < c.found * (1 - CLOSE)) { // a longer one was measured
            c.stage = made.stage;
            c.length = HUGE_VAL;
            c.wanted = true;
        }
        if (c.stage != made.stage || made.length >= c.length * (1 - SAME)) return true;
        c.found = std::min(c.found, made.length);
        c.length = made.length;
        c.doubt = made.doubt;
        return keep_curve(crossings, n, c);
    }
    if (!keep_curve(crossings, n, made)) return false;
    made.found = made.length;
    made.strip = strip;
    return classes_.push(made);
}

// The strip that was pulled straight, or, if that is not simple, the one that it was.
Done ClassLengths::keep_curve(const uint32_t* crossings, size_t n, Class& c) {
    bool simple = false;
    one_.keep_first(0);
    if (!one_.add(loop_) || !disjoint(mesh_, one_, 0, 1, curve_, nullptr, call_, simple)) return false;
    c.first = crossings_.size();
    for (size_t k = 0; k < (simple ? loop_.size() : n); ++k)
        if (!crossings_.push(simple ? loop_[k] : crossings[k])) return false;
    c.end = crossings_.size();
    return true;
}

size_t ClassLengths::shortest(const uint32_t* ids, size_t n) {
    if (n == 1) return 0;
    size_t best = 0;
    for (size_t i = 1; i < n; ++i)
        if (classes_[ids[i]].length < classes_[ids[best]].length) best = i;
    // Another class that may be shorter is measured, and this one as well.
    double most = HUGE_VAL;
    for (size_t i = 0; i < n; ++i) {
        const Class& c = classes_[ids[i]];
        const double upper = c.length * (1 + c.doubt + DOUBT[c.stage]);
        most = std::min(most, upper);
    }
    const auto may_be = [&](const Class& c) { return c.length <= most * (1 + DOUBT[c.stage]); };
    bool other = false;
    for (size_t i = 0; i < n; ++i) other |= ids[i] != ids[best] && may_be(classes_[ids[i]]);
    for (size_t i = 0; i < n && other; ++i) {
        Class& c = classes_[ids[i]];
        c.wanted |= c.stage != Stage::done && may_be(c);
    }
    return best;
}

bool ClassLengths::may_be_shorter(const uint32_t* ids, const uint32_t* others, size_t n) {
    double least = 0, most = 0;
    for (size_t i = 0; i < n; ++i) {
        const Class &c = classes_[ids[i]], &other = classes_[others[i]];
        least += c.length / (1 + DOUBT[c.stage]);
        most += other.length * (1 + other.doubt + DOUBT[other.stage]);
    }
    if (!(least < most)) return false;
    for (size_t i = 0; i < n; ++i) {
        want(ids[i]);
        want(others[i]);
    }
    return true;
}

Done ClassLengths::measure(bool& changed) {
    changed = false;
    return measure_stage(Stage::found, changed) && measure_stage(Stage::measured, changed);
}

// The classes at a stage, for the next stage.
Done ClassLengths::measure_stage(Stage stage, bool& changed) {
    const size_t finest = stage == Stage::found ? level_ : finest_;
    Loops loops;
    Array<uint32_t> ids;
    ids.start(call_.memory);
    if (!loops.start(call_.memory)) return false;
    for (uint32_t id = 0; id < classes_.size(); ++id) {
        const Class& c = classes_[id];
        if (!c.wanted || c.stage != stage) continue;
        if (!loops.add(crossings_.data() + c.first, static_cast<size_t>(c.end - c.first)) || !ids.push(id))
            return false;
    }
    if (ids.empty()) return true;
    changed = true;
    LoopCarrier carrier;
    Multicurve curve; // on the levels between
    if (!carrier.load(*hierarchy_, found_, finest, loops, call_.memory)
        || (found_ > finest + 1 && !curve.allocate(hierarchy_->levels[finest + 1].mesh, call_.memory)))
        return false;
    while (carrier.level() > finest) {
        if (!carrier.refine(call_) || !carrier.read(0, ids.size(), loops, call_)) return false;
        const bool last = carrier.level() == finest;
        const double* const position = hierarchy_->levels[carrier.level()].position;
        const Mesh& mesh = carrier.mesh();
        ClosedGeodesic geodesic(mesh, position, geodesic_.scale(), call_);
        Loops pulled;
        if (!pulled.start(call_.memory)) return false;
        for (size_t k = 0; k < ids.size(); ++k) {
            Class& c = classes_[ids[k]];
            // Starts from a curve that is the shortest up to small bumps.
            if (!pull(geodesic, mesh, position, loops.loop(k), loops.length(k), c)) return false;
            if (last) continue;
            bool simple = false;
            if (!pulled.add(loop_) || !disjoint(mesh, pulled, k, k + 1, curve, nullptr, call_, simple)) return false;
            if (simple) continue;
            pulled.keep_first(k);
            if (!pulled.add(loops, k)) return false;
        }
        if (!last && !carrier.replace(pulled)) return false;
    }
    for (const uint32_t id : ids) {
        classes_[id].stage = finest == finest_ ? Stage::done : Stage::measured;
        classes_[id].wanted = false;
    }
    return true;
}

} // namespace hmf
