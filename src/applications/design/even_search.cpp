// Poles at the ends of limbs.  The scale of a foliation without poles decays
// along a limb that no loop goes around: a limb needs curvature at its end.
//
//       ____
//      /    \___________        .   one pole at a pointed tip (angle pi), two at the
//     |  body     limb   )     .    rim of a blunt one (pi + pi: a flat cap), none
//      \____/-----------        .   where there is curvature enough
//
// Tips are the persistent minima of log |grad u|, smoothed. The alternatives are tried at one tip after the other; the
// loops are the pants loops of the
// surface with its marked vertices, found by the fast search (the shortest loops took most of the time and gave a
// higher distortion: .40 instead of .30 on botijo). The weights minimize the distortion (Gauss-Newton,
// marked_trial.hpp).
#include "even_search.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "whole_weights.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t SEARCH_ROUNDS = 3; // of Gauss-Newton for a choice
// With more loops the weights stay as guessed from areas: the derivatives take time proportional to the square of their
// number. Scale distortion of a plate with 300 holes .42 instead of .39, in a third of the time.
constexpr size_t MOST_DERIVED = 300;
constexpr double SEARCH_PERSISTENCE = 0.3; // least, of a tip
// Where the scale is less even than that in the end, all is done again from the start with up to as much work and
// shallower tips: which is better depends on the shape.  Unevenness 0.28: areas differ by about 7 (95 % / 5 %).
constexpr double STILL_UNEVEN = 0.28, SHALLOW = 0.2, MOST_AGAIN = 150;
constexpr double DEPTH = 0.2;     // least, below the mean
constexpr double TWO_POLES = 2.0; // depth from which on two poles are tried first
constexpr size_t SEARCH_MOST_TIPS = 24;
constexpr double PRICE = 0.012;             // of a pole, in unevenness
constexpr double LONGEST_SEARCH_STEP = 1.2; // of the logarithm of a weight
constexpr double DAMPING = 1e-3;
// Of the disk between two poles: it covers the end of a limb.
constexpr EdgeDistances::DiskLimit CAP{8, 0.02, 2.4};

} // namespace

// The scale after one step of smoothing, and its mean.
Done EvenSearch::smooth_scale(const Array<double>& scale, Array<double>& smooth, double& mean) {
    if (!smooth.allocate(memory_, mesh_.vertex_count)) return false;
    mean = 0;
    for (uint32_t v = 0; v < mesh_.vertex_count; ++v) mean += distances_.area(v) / distances_.whole_area() * scale[v];
    for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
        double area = distances_.area(v), sum = area * scale[v];
        for (const uint32_t h : mesh_.around(v)) {
            const uint32_t w = mesh_.target(h);
            sum += distances_.area(w) * scale[w];
            area += distances_.area(w);
        }
        smooth[v] = area > 0 ? sum / area : scale[v];
    }
    return true;
}

// Vertices within two rings of some tips and their poles.
Done EvenSearch::find_taken(const Array<Tip>& tips, Array<uint8_t>& taken) {
    Array<uint32_t> queue;
    queue.start(memory_);
    if (!taken.allocate_filled(memory_, mesh_.vertex_count, uint8_t{0})) return false;
    const auto take = [&](uint32_t v) -> Done {
        if (v == NONE || taken[v]) return true;
        taken[v] = 1;
        return queue.push(v);
    };
    for (const Tip& tip : tips)
        if (!take(tip.vertex) || !take(tip.ends[0]) || !take(tip.ends[1])) return false;
    size_t begin = 0;
    for (int ring = 0; ring < 2; ++ring) {
        const size_t end = queue.size();
        for (; begin < end; ++begin) {
            for (const uint32_t h : mesh_.around(queue[begin])) {
                if (!take(mesh_.target(h))) return false;
            }
        }
    }
    return true;
}

// The minima of a function on the vertices with their persistence: vertices are passed from low to high, and
// where two parts meet, the higher of their minima ends.  visit(vertex, persistence).
template <class Visit>
Done EvenSearch::for_persistent_minima(const Array<double>& height, Visit visit) {
    const uint32_t n = mesh_.vertex_count;
    Array<uint32_t> rising, part, lowest;
    Array<uint8_t> passed;
    if (!rising.allocate(memory_, n) || !part.allocate(memory_, n) || !lowest.allocate(memory_, n)
        || !passed.allocate_filled(memory_, n, uint8_t{0}))
        return false;
    const auto lower = [&height](uint32_t a, uint32_t b) {
        return height[a] != height[b] ? height[a] < height[b] : a < b;
    };
    for (uint32_t v = 0; v < n; ++v) rising[v] = part[v] = lowest[v] = v;
    heap_sort(rising.data(), n, lower);
    for (const uint32_t v : rising) {
        passed[v] = 1;
        for (const uint32_t h : mesh_.around(v)) {
            const uint32_t w = mesh_.target(h);
            const uint32_t a = find_root(part.data(), v), b = find_root(part.data(), w);
            if (!passed[w] || a == b) continue;
            const uint32_t x = lowest[a], y = lowest[b], ends = lower(x, y) ? y : x, stays = lower(x, y) ? x : y;
            if (ends != v && !visit(ends, height[v] - height[ends])) return false;
            unite(part.data(), a, b);
            lowest[find_root(part.data(), a)] = stays;
        }
    }
    return visit(rising[0], HUGE_VAL);
}

// Persistent minima of the smoothed scale that lie away from the tips there are, the deepest first.
Done EvenSearch::find_tips(const EvenChoice& choice, double least, Array<Tip>& found) {
    Array<double> smooth;
    Array<uint8_t> taken;
    double mean = 0;
    found.start(memory_);
    if (!smooth_scale(choice.scale, smooth, mean) || !find_taken(choice.tips, taken)) return false;
    const auto add = [&](uint32_t v, double persistence) -> Done {
        if (persistence < least || smooth[v] > mean - DEPTH || taken[v]) return true;
        return found.push({v, mean - smooth[v], 0, false, {NONE, NONE}});
    };
    if (!for_persistent_minima(smooth, add)) return false;
    heap_sort(found.data(), found.size(),
              [](const Tip& a, const Tip& b) { return a.depth != b.depth ? a.depth > b.depth : a.vertex < b.vertex; });
    for (Tip& tip : found)
        if (!distances_.diameter(tip.vertex, CAP, nullptr, tip.ends)) return false;
    return true;
}

Done EvenSearch::list_marks(EvenChoice& choice) {
    choice.marks.start(memory_);
    const auto add = [&](uint32_t v) -> Done {
        for (const uint32_t w : choice.marks)
            if (w == v) return true;
        return choice.marks.push(v);
    };
    for (const Tip& tip : choice.tips) {
        if (tip.poles == 1 && !add(tip.vertex)) return false;
        if (tip.poles == 2 && (!add(tip.ends[0]) || !add(tip.ends[1]))) return false;
    }
    return true;
}

Done EvenSearch::copy(const EvenChoice& from, EvenChoice& to) {
    to.tips.start(memory_);
    for (const Tip& tip : from.tips)
        if (!to.tips.push(tip)) return false;
    return true;
}

// A solve, or its derivatives: they take longer with more loops.
void EvenSearch::count(const MarkedTrial& trial) {
    ++solves;
    work += work_of(trial.weights.size());
}

hmf_status EvenSearch::evaluate(EvenChoice& choice, uint32_t rounds, double rival) {
    choice.unevenness = HUGE_VAL;
    MarkedTrial trial(like_, call_, fraction);
    if (trial.start(surface_, choice.marks, choice.kind, choice.loops) || !trial.usable()) return call_.status();
    Array<double> step, kept;
    if (!kept.allocate(memory_, trial.weights.size()) || !choice.weights.allocate(memory_, trial.weights.size()))
        return call_.out_of_memory();
    const auto keep = [&] {
        choice.unevenness = trial.unevenness();
        for (size_t c = 0; c < kept.size(); ++c) choice.weights[c] = trial.weights[c];
        return trial.vertex_scale(choice.scale, memory_);
    };
    count(trial);
    if (trial.solve() || !trial.usable()) return call_.status();
    if (!keep()) return call_.out_of_memory();
    if (trial.weights.size() > MOST_DERIVED) rounds = 0;
    double damping = DAMPING;
    for (uint32_t round = 0; round < rounds; ++round) {
        fraction = work < budget ? work / budget : 1;
        if (!call_.tick(fraction)) return call_.was_cancelled();
        if (round > 0 && work >= budget) return HMF_OK;
        bool known = false;
        count(trial);
        if (trial.derive(known) || !trial.usable() || !known) return call_.status();
        const double before = choice.unevenness;
        bool better = false;
        for (int attempt = 0; attempt < 2 && !better; ++attempt) {
            if (trial.best_step(damping, step) || step.size() != kept.size()) return call_.status();
            double longest = 0;
            for (const double x : step) longest = std::max(longest, std::fabs(x));
            const double shrink = longest > LONGEST_SEARCH_STEP * 3 ? LONGEST_SEARCH_STEP * 3 / longest : 1;
            for (size_t c = 0; c < kept.size(); ++c) {
                const double x = std::min(std::max(step[c] * shrink, -LONGEST_SEARCH_STEP), LONGEST_SEARCH_STEP);
                trial.weights[c] = choice.weights[c] * (1 + x / 2) / (1 - x / 2);
            }
            count(trial);
            if (trial.solve() || !trial.usable()) return call_.status();
            better = trial.unevenness() < choice.unevenness;
            if (!better) damping *= 30;
        }
        if (!better) return HMF_OK;
        if (!keep()) return call_.out_of_memory();
        const double fall = before - choice.unevenness;
        if (fall < 0.002 || choice.unevenness - 1.5 * fall > rival) return HMF_OK;
    }
    return HMF_OK;
}

// A mesh of a few vertices may have no two limbs.
Done EvenSearch::mark_four(EvenChoice& choice) {
    for (uint32_t v = 0; v < mesh_.vertex_count && like_.genus == 0 && choice.marks.size() < 4; ++v) {
        if (!choice.tips.push({v, HUGE_VAL, 1, false, {NONE, NONE}}) || !list_marks(choice)) return false;
    }
    return true;
}

// The default loops with weights 1.
hmf_status EvenSearch::measure_before(EvenChoice& plain) {
    MarkedTrial trial(like_, call_, fraction);
    plain.kind = HMF_LOOPS_CUT;
    if (trial.start(surface_, plain.marks, plain.kind, plain.loops) || !trial.usable()) return call_.status();
    for (double& w : trial.weights) w = 1;
    count(trial);
    if (trial.solve() || !trial.usable()) return call_.status();
    unevenness_before = plain.unevenness = trial.unevenness();
    if (!plain.weights.allocate_filled(memory_, trial.weights.size(), 1.0)) return call_.out_of_memory();
    return HMF_OK;
}

// Lower is better: unevenness and the price of the poles.
double EvenSearch::gain(const EvenChoice& before, const EvenChoice& after) const {
    const double poles = static_cast<double>(after.marks.size()) - static_cast<double>(before.marks.size());
    return before.unevenness - after.unevenness - PRICE * poles;
}

// Marked vertices of the caller, and two poles at each tip: at `ends`, or those of
// a diameter of the disk.
hmf_status EvenSearch::first_choice(const Array<uint32_t>& given, const Array<uint32_t>& tips,
                                    const Array<uint32_t>* ends, EvenChoice& choice) {
    choice.tips.start(memory_);
    for (const uint32_t v : given)
        if (!choice.tips.push({v, HUGE_VAL, 1, true, {NONE, NONE}})) return call_.out_of_memory();
    for (size_t i = 0; i < tips.size(); ++i) {
        Tip tip{tips[i], HUGE_VAL, 2, false, {NONE, NONE}};
        if (ends) {
            tip.ends[0] = (*ends)[2 * i];
            tip.ends[1] = (*ends)[2 * i + 1];
        } else if (!distances_.diameter(tip.vertex, CAP, nullptr, tip.ends)) return call_.out_of_memory();
        if (tip.ends[0] == NONE) continue;
        if (!choice.tips.push(tip)) return call_.out_of_memory();
    }
    return list_marks(choice) && mark_four(choice) ? HMF_OK : call_.out_of_memory();
}

hmf_status EvenSearch::run(const Array<uint32_t>& given, const Array<uint32_t>& tips, const Array<uint32_t>& ends,
                           EvenChoice& best) {
    if (!distances_.start()) return call_.out_of_memory();
    EvenChoice plain;
    if (first_choice(given, tips, &ends, plain) || measure_before(plain) || first_choice(given, tips, nullptr, best)
        || evaluate(best, SEARCH_ROUNDS))
        return call_.status();
    if (!tips.empty()) {
        EvenChoice other;
        if (first_choice(given, tips, &ends, other) || evaluate(other, SEARCH_ROUNDS)) return call_.status();
        if (gain(best, other) > 0) best = static_cast<EvenChoice&&>(other);
    }
    if (poles && improve(SEARCH_PERSISTENCE, best)) return call_.status();
    if (poles && may_repeat && best.unevenness > STILL_UNEVEN && best.unevenness < HUGE_VAL) {
        EvenChoice other;
        budget = work + std::min(budget, MOST_AGAIN);
        if (first_choice(given, tips, nullptr, other) || evaluate(other, SEARCH_ROUNDS) || improve(SHALLOW, other))
            return call_.status();
        if (gain(best, other) > 0) best = static_cast<EvenChoice&&>(other);
    }
    // Never less even than the default loops, with weights 1 or better ones.
    if (plain.unevenness < 1.5 * best.unevenness) {
        if (plain.unevenness < best.unevenness) best = static_cast<EvenChoice&&>(plain);
        EvenChoice other;
        other.kind = HMF_LOOPS_CUT;
        if (first_choice(given, tips, &ends, other) || evaluate(other, SEARCH_ROUNDS)) return call_.status();
        if (gain(best, other) > 0) best = static_cast<EvenChoice&&>(other);
    }
    return HMF_OK;
}

// The deepest ones with poles, the others without, as many as there is room for.
Done EvenSearch::add_tips(const Array<Tip>& found, size_t with_poles, size_t room, EvenChoice& choice) {
    for (size_t i = 0; i < found.size() && i < room; ++i) {
        Tip tip = found[i];
        tip.poles = i >= with_poles ? 0 : tip.depth > TWO_POLES && tip.ends[0] != NONE ? 2 : 1;
        if (!choice.tips.push(tip)) return false;
    }
    return true;
}

// Adds and removes poles.
hmf_status EvenSearch::improve(double persistence, EvenChoice& best) {
    // All new tips together, then the deepest half of them, a quarter..., as long as that helps.
    for (int pass = 0; pass < 3 && best.unevenness < HUGE_VAL && work < budget; ++pass) {
        Array<Tip> found;
        if (!find_tips(best, persistence, found)) return call_.out_of_memory();
        const size_t room = SEARCH_MOST_TIPS - std::min(SEARCH_MOST_TIPS, best.tips.size());
        if (found.size() < 1 || room < 1) break;
        bool better = false;
        for (size_t count = std::min(found.size(), room); count > 0 && !better && work < budget; count /= 2) {
            EvenChoice next;
            if (!copy(best, next) || !add_tips(found, count, room, next) || !list_marks(next))
                return call_.out_of_memory();
            if (evaluate(next, SEARCH_ROUNDS)) return call_.status();
            better = gain(best, next) > 0;
            if (better) best = static_cast<EvenChoice&&>(next);
        }
        if (better) continue;
        if (!add_tips(found, 0, room, best)) return call_.out_of_memory(); // each is tried below
        break;
    }
    // Another number of poles at one tip after the other.
    bool changed = true;
    for (int pass = 0; pass < 3 && changed && work < budget; ++pass) {
        changed = false;
        for (size_t i = 0; i < best.tips.size() && work < budget; ++i) {
            const uint32_t now = best.tips[i].poles;
            if (best.tips[i].stays) continue;
            for (uint32_t count = 0; count <= 2 && work < budget; ++count) {
                if (count == now || count == best.tips[i].poles) continue;
                EvenChoice next;
                if (!copy(best, next)) return call_.out_of_memory();
                next.tips[i].poles = count;
                if (count == 2 && next.tips[i].ends[0] == NONE) continue;
                if (!list_marks(next)) return call_.out_of_memory();
                if (like_.genus == 0 && next.marks.size() < 4) continue;
                if (evaluate(next, SEARCH_ROUNDS, best.unevenness)) return call_.status();
                if (gain(best, next) <= 0) continue;
                best = static_cast<EvenChoice&&>(next);
                changed = true;
            }
        }
    }
    return HMF_OK;
}

hmf_status EvenSearch::round_weights(EvenChoice& best) {
    MarkedTrial trial(like_, call_, fraction);
    if (trial.start(surface_, best.marks, best.kind, best.loops) || !trial.usable()
        || trial.weights.size() != best.weights.size())
        return call_.status();
    const auto measure = [&](const Array<double>& weights, double& unevenness) -> hmf_status {
        for (size_t c = 0; c < weights.size(); ++c) trial.weights[c] = weights[c];
        if (!call_.tick(fraction)) return call_.was_cancelled();
        count(trial);
        if (trial.solve()) return call_.status();
        unevenness = trial.usable() ? trial.unevenness() : HUGE_VAL;
        return HMF_OK;
    };
    double exact = HUGE_VAL;
    if (measure(best.weights, exact) || !trial.usable()) return call_.status();
    return to_whole_numbers(exact, trial.across(), call_, best.weights, best.unevenness, measure);
}

} // namespace hmf
