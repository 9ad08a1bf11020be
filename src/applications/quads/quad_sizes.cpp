// Rounding of lengths with one equation per cylinder: as many columns at the
// lower boundary as at the upper one.
//
// Each arc has two sides, so one more quad on it changes the balance of one
// cylinder or two, by +1 at a lower boundary and -1 at an upper one.  The sum
// of all balances is even.  A balance that is off is led along a path of arcs,
// one more quad or one less on each, to another that is off: the cheapest path
// through the states (cylinder, change that it still needs), where a change costs
// what it adds to the sum of (columns - wish)^2 / wish.
//
// The equations can force an arc to have no length: where two zeros coincide in
// truth, as symmetry asks, a discrete foliation has them a little apart, in some
// order or other.  Such an arc may get 0 columns, and its zeros become one.  With
// `merge` every arc shorter than half an edge does.
//
// Then no two edges may have the same ends.  Points within an arc and rows
// between the boundaries keep all but these apart, which get more columns:
//
//     Z---Z      a circle of arcs without columns, or less than three columns on
//      \ /       an arc (or circle) from a vertex to itself;
//                two arcs of one column with the same ends;
//                less than three columns around a cylinder;
//                less than three rows in one whose boundaries share a vertex.
#include "quad_sizes.hpp"

#include <algorithm>
#include <cmath>

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"

namespace hmf {

namespace {

constexpr int64_t LEAST_ROUND = 3;      // columns of a cylinder, or of a circle
constexpr int64_t LEAST_OVER_POLES = 2; // on an arc between two poles: one quad closes the end
constexpr int64_t MOST_ROWS_NEEDED = 3;
constexpr double MOST_LINES = 1 << 24;
constexpr double BELOW_SOFT = 1e6, FROM_MERGED = 4; // costs

int64_t rounded(double x) { return static_cast<int64_t>(std::floor(x + 0.5)); }

} // namespace

hmf_status QuadSizes::start(const Cylinders& cylinders, const Array<double>& length, double ring_length, bool merge,
                            Call& call) {
    Memory& memory = call.memory;
    cylinders_ = &cylinders;
    merge_ = merge;
    ring_length_ = ring_length;
    const size_t arcs = graph().arcs.size(), n = cylinders.list.size(), zeros = graph().zeros.size();
    queue_.start(memory);
    if (!columns.allocate(memory, arcs) || !rows.allocate(memory, n) || !length_.allocate(memory, arcs)
        || !wish_.allocate(memory, arcs) || !floor_.allocate(memory, arcs) || !soft_.allocate(memory, arcs)
        || !off_.allocate(memory, n) || !held_.allocate(memory, arcs) || !from_.allocate(memory, 2 * n)
        || !reached_.allocate(memory, 2 * n) || !root_.allocate(memory, zeros) || !order_.allocate(memory, zeros)
        || !ends_.allocate(memory, arcs) || !prongs_.allocate_filled(memory, zeros, 0) || !met_.allocate(memory, zeros))
        return call.out_of_memory();
    for (size_t a = 0; a < arcs; ++a) length_[a] = (length[a] + length[graph().arcs[a].twin]) / 2;
    for (const Sector& s : graph().sectors) ++prongs_[s.zero];
    return HMF_OK;
}

int64_t columns_across(const Cylinders& cylinders, const Array<int64_t>& columns, int64_t ring, uint32_t c) {
    if (cylinders.graph.zeros.empty()) return ring;
    int64_t sum = 0;
    const Boundary& b = cylinders.graph.boundaries[cylinders.list[c].lower];
    for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) sum += columns[a];
    return sum;
}

int64_t QuadSizes::quad_count() const {
    int64_t sum = 0;
    for (uint32_t c = 0; c < rows.size(); ++c) sum += across(c) * rows[c];
    // One quad less for each pole, and a third one for an end with two.
    for (uint32_t a = 0; a < columns.size(); ++a) {
        if (columns[a] == 0 || !is_pole(graph().arcs[a].from)) continue;
        --sum;
        if (columns[a] == LEAST_OVER_POLES && is_pole(graph().arcs[a].to) && a < graph().arcs[a].twin) --sum;
    }
    return sum;
}

double QuadSizes::deviation(uint32_t a, int64_t n) const {
    const double d = static_cast<double>(n) - wish_[a];
    return d * d / (wish_[a] > 1 ? wish_[a] : 1);
}

// Of one quad more or less on arc a.
double QuadSizes::cost(uint32_t a, int64_t by) const {
    const double more = deviation(a, columns[a] + by) - deviation(a, columns[a]);
    double sum = more > 0 ? more + 1e-3 : 1e-3; // the shortest of equal paths
    if (by < 0 && columns[a] <= soft_[a]) sum += BELOW_SOFT;
    if (by > 0 && columns[a] == 0) sum += FROM_MERGED;
    return sum;
}

void QuadSizes::change(uint32_t a, int64_t by) {
    const uint32_t other = graph().arcs[a].twin;
    columns[a] += by;
    columns[other] = columns[a];
    off_[cylinder(a)] += sign(a) * by;
    off_[cylinder(other)] += sign(other) * by;
}

bool QuadSizes::raise(uint32_t a, int64_t to) {
    const uint32_t other = graph().arcs[a].twin;
    if (floor_[a] < to) floor_[a] = floor_[other] = to;
    if (soft_[a] < to) soft_[a] = soft_[other] = to;
    if (columns[a] >= to) return false;
    change(a, to - columns[a]);
    return true;
}

// States: 2 * cylinder + 1 if it needs +1, + 0 if it needs -1.  Finds the last
// arc of the cheapest path that mends two balances, reached from last_state;
// NONE if there is none.
Done QuadSizes::search(uint32_t start, uint32_t& last, uint32_t& last_state, Call& call) {
    last = NONE;
    for (Step& s : from_) s = {NONE, NONE};
    for (double& r : reached_) r = HUGE_VAL;
    queue_.clear();
    const int64_t need = off_[start] > 0 ? -1 : 1;
    const uint32_t first = 2 * start + (need > 0);
    double best = HUGE_VAL;
    from_[first] = {first, NONE};
    reached_[first] = 0;
    if (!queue_.push({0, first})) return false;
    while (!queue_.empty()) {
        const NearestFirst::Entry top = queue_.pop();
        const uint32_t state = top.item, c = state / 2;
        if (top.distance > reached_[state]) continue;
        if (top.distance >= best) break;
        if (!call.tick(0)) return false;
        const int64_t wanted = state % 2 ? 1 : -1;
        const uint32_t boundaries[2] = {cylinders_->list[c].lower, cylinders_->list[c].upper};
        for (const uint32_t boundary : boundaries) {
            const Boundary& b = graph().boundaries[boundary];
            for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
                const int64_t by = wanted * sign(a);
                if (by < 0 && (held_[a] || columns[a] <= floor_[a])) continue;
                const uint32_t other = graph().arcs[a].twin, d = cylinder(other);
                const int64_t effect = by * sign(other);
                if (d == c && effect == -wanted) continue; // nothing changes
                const double whole = top.distance + cost(a, by);
                const int64_t off = off_[d] + (d == start ? need : 0);
                if (off * effect < 0) {
                    if (whole < best) {
                        best = whole;
                        last = a;
                        last_state = state;
                    }
                    continue;
                }
                const uint32_t next = 2 * d + (effect < 0);
                if (whole >= reached_[next]) continue;
                reached_[next] = whole;
                from_[next] = {state, a};
                if (!queue_.push({whole, next})) return false;
            }
        }
    }
    return true;
}

// Changes the arcs of the path found; false, and nothing changed, if one of
// them cannot give that much.
bool QuadSizes::apply(uint32_t last, uint32_t last_state) {
    bool fits = true;
    for (int round = 0; round < 2; ++round) {
        uint32_t a = last, state = last_state;
        for (;;) {
            const int64_t by = (state % 2 ? 1 : -1) * sign(a);
            change(a, round == 1 ? -by : by); // or back
            if (columns[a] < floor_[a]) {
                fits = false;
                held_[a] = held_[graph().arcs[a].twin] = 1;
            }
            if (from_[state].arc == NONE) break;
            a = from_[state].arc;
            state = from_[state].state;
        }
        if (fits) return true;
    }
    return false;
}

hmf_status QuadSizes::balance(bool& matched, Call& call) {
    matched = true;
    for (uint32_t c = 0; c < off_.size(); ++c)
        while (off_[c] != 0) {
            for (uint8_t& h : held_) h = 0;
            bool done = false;
            // An arc that would have to give two away is held back in the next search.
            for (size_t tries = 0; tries <= columns.size() && !done; ++tries) {
                uint32_t last = NONE, last_state = 0;
                if (!search(c, last, last_state, call)) return call.stopped();
                if (last == NONE) break;
                done = apply(last, last_state);
            }
            if (done) continue;
            matched = false;
            return HMF_OK;
        }
    return HMF_OK;
}

// More columns where two edges would have the same ends.
hmf_status QuadSizes::mend(bool& mended, Call& call) {
    const auto low = [&](uint32_t a) { return zero(graph().arcs[a].from); };
    const auto high = [&](uint32_t a) { return zero(graph().arcs[a].to); };
    mended = false;
    for (uint32_t c = 0; c < rows.size(); ++c) {
        if (across(c) >= LEAST_ROUND) continue;
        const Boundary& b = graph().boundaries[cylinders_->list[c].lower];
        uint32_t best = b.arcs_begin;
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a)
            if (wish_[a] - static_cast<double>(columns[a]) > wish_[best] - static_cast<double>(columns[best])) best = a;
        mended |= raise(best, columns[best] + 1);
    }
    // Zeros at the ends of an arc without columns become one, the nearest first.
    size_t count = 0;
    for (uint32_t a = 0; a < columns.size(); ++a)
        if (columns[a] == 0 && a < graph().arcs[a].twin) ends_[count++] = {0, 0, a};
    heap_sort(ends_.data(), count, [&](const Ends& x, const Ends& y) {
        return wish_[x.arc] != wish_[y.arc] ? wish_[x.arc] < wish_[y.arc] : x.arc < y.arc;
    });
    for (uint32_t z = 0; z < root_.size(); ++z) {
        root_[z] = z;
        order_[z] = prongs_[z] - 2;
    }
    for (size_t i = 0; i < count; ++i) {
        const uint32_t a = ends_[i].arc, x = find_root(root_.data(), low(a)), y = find_root(root_.data(), high(a));
        // A vertex of less than four edges is a pole again.
        if (x == y || order_[x] + order_[y] < 0) {
            mended |= raise(a, x == y ? LEAST_ROUND : 1);
            continue;
        }
        const int32_t sum = order_[x] + order_[y];
        unite(root_.data(), x, y);
        order_[x < y ? x : y] = sum;
    }
    count = 0;
    for (uint32_t a = 0; a < columns.size(); ++a) {
        if (columns[a] == 0 || columns[a] >= LEAST_ROUND || a > graph().arcs[a].twin) continue;
        const uint32_t x = find_root(root_.data(), low(a)), y = find_root(root_.data(), high(a));
        if (x == y) mended |= raise(a, LEAST_ROUND);
        else if (columns[a] == 1) ends_[count++] = {std::min(x, y), std::max(x, y), a};
    }
    heap_sort(ends_.data(), count, [&](const Ends& x, const Ends& y) {
        if (x.low != y.low) return x.low < y.low;
        if (x.high != y.high) return x.high < y.high;
        return wish_[x.arc] != wish_[y.arc] ? wish_[x.arc] < wish_[y.arc] : x.arc < y.arc;
    });
    for (size_t i = 1; i < count; ++i)
        if (ends_[i].low == ends_[i - 1].low && ends_[i].high == ends_[i - 1].high) mended |= raise(ends_[i].arc, 2);
    return call.tick(0) ? HMF_OK : call.was_cancelled();
}

hmf_status QuadSizes::round_all(double step, bool& matched, Call& call) {
    matched = true;
    double total = 0, quads = 0;
    for (const double l : length_) total += l / step;
    total += ring_length_ / step;
    for (uint32_t c = 0; c < rows.size(); ++c) {
        const double wanted = std::floor(static_cast<double>(cylinders_->list[c].height) / step + 0.5);
        double round = ring_length_ / step;
        const Boundary& b = graph().boundaries[cylinders_->list[c].lower];
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) round += length_[a] / step;
        total += wanted;
        quads += wanted * round;
        rows[c] = wanted < 1 ? 1 : wanted < MOST_LINES ? static_cast<int64_t>(wanted) : 0;
    }
    if (!(total < MOST_LINES) || !(quads <= static_cast<double>(MOST_QUADS)))
        return call.fail(
            HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
            "There would be %.3g quads of this size, with %.3g in a row; at most %.3g and %.3g fit. Choose "
            "a larger edge_length.",
            quads, total, static_cast<double>(MOST_QUADS), MOST_LINES);
    if (graph().zeros.empty()) {
        ring = rounded(ring_length_ / step);
        ring = std::max(ring, LEAST_ROUND);
        rows[0] = std::max(rows[0], MOST_ROWS_NEEDED);
        return HMF_OK;
    }
    for (int64_t& o : off_) o = 0;
    for (uint32_t a = 0; a < columns.size(); ++a) {
        const bool poles = is_pole(graph().arcs[a].from) && is_pole(graph().arcs[a].to);
        const bool circle = zero(graph().arcs[a].from) == zero(graph().arcs[a].to);
        wish_[a] = length_[a] / step;
        columns[a] = rounded(wish_[a]);
        floor_[a] = circle ? LEAST_ROUND : poles ? LEAST_OVER_POLES : 0;
        soft_[a] = !merge_ && poles ? LEAST_ROUND : !merge_ ? 2 : wish_[a] < 0.5 ? 0 : 1;
        soft_[a] = std::max(soft_[a], floor_[a]);
        columns[a] = std::max(columns[a], soft_[a]);
        off_[cylinder(a)] += sign(a) * columns[a];
    }
    // Every round raises the fewest columns of an arc, which never exceed three.
    for (bool mended = true; mended;) {
        if (balance(matched, call)) return call.status();
        if (!matched) return HMF_OK;
        if (mend(mended, call)) return call.status();
    }
    for (uint32_t c = 0; c < rows.size(); ++c) rows[c] = std::max(rows[c], rows_needed(c));
    return HMF_OK;
}

// With one row between the boundaries, which have no zero in common, all edges
// across have other ends.
int64_t QuadSizes::rows_needed(uint32_t c) {
    if (!merge_) return MOST_ROWS_NEEDED;
    const Boundary &lower = graph().boundaries[cylinders_->list[c].lower],
                   &upper = graph().boundaries[cylinders_->list[c].upper];
    for (uint32_t& m : met_) m = 0;
    for (uint32_t a = lower.arcs_begin; a < lower.arcs_end; ++a)
        met_[find_root(root_.data(), zero(graph().arcs[a].from))] = 1;
    for (uint32_t a = upper.arcs_begin; a < upper.arcs_end; ++a)
        if (met_[find_root(root_.data(), zero(graph().arcs[a].from))]) return MOST_ROWS_NEEDED;
    return MOST_ROWS_NEEDED - 1;
}

hmf_status QuadSizes::of_step(double step, Call& call) {
    bool matched = false;
    if (round_all(step, matched, call)) return call.status();
    if (!matched)
        return call.fail(HMF_ERROR_QUADS, HMF_ELEMENT_OPTION, 0,
                         "No numbers of columns match on all cylinders. Choose a smaller edge_length; if that does not "
                         "help, the mesh is too coarse for the foliation, so subdivide it.");
    return HMF_OK;
}

hmf_status QuadSizes::widen_at_poles(Call& call) {
    Array<int64_t> narrow, few;
    if (!copy_array(columns, narrow, call.memory) || !copy_array(rows, few, call.memory)) return call.out_of_memory();
    for (uint32_t a = 0; a < columns.size(); ++a)
        if ((is_pole(graph().arcs[a].from) || is_pole(graph().arcs[a].to)) && columns[a] > 0) raise(a, 2);
    for (int64_t& r : rows) r = std::max(r, MOST_ROWS_NEEDED);
    for (bool mended = true, matched = false; mended;) {
        if (balance(matched, call)) return call.status();
        if (!matched) { // poles keep their vertex then
            columns.swap(narrow);
            rows.swap(few);
            break;
        }
        if (mend(mended, call)) return call.status();
    }
    return HMF_OK;
}

// The search over the edge length takes this many.
constexpr int MOST_STEPS = 16;

hmf_status QuadSizes::of_count(double step, int64_t count, Call& call) {
    const double wished = static_cast<double>(count);
    double best = HUGE_VAL, best_step = step, low = 0, high = HUGE_VAL; // steps with too many quads, too few
    bool any = false;
    for (int k = 0; k < MOST_STEPS; ++k) {
        bool matched = false;
        if (round_all(step, matched, call)) return call.status();
        const double made = matched ? static_cast<double>(quad_count()) : wished / 2;
        const double off = made > wished ? made / wished : wished / made;
        if (matched && (!any || off < best)) {
            any = true;
            best = off;
            best_step = step;
        }
        if (any && best < 1.01) break;
        if (made > wished) low = std::max(low, step);
        else high = std::min(high, step);
        double next = step * std::sqrt(made / wished);
        if (!(next > low) || !(next < high))
            next = high < HUGE_VAL ? (low > 0 ? std::sqrt(low * high) : high / 2) : 2 * low;
        if (next == step) break;
        step = next;
    }
    if (!any)
        return call.fail(HMF_ERROR_QUADS, HMF_ELEMENT_OPTION, 0,
                         "The cylinders cannot be matched with so few quads. Choose a larger count.");
    bool matched = false;
    return round_all(best_step, matched, call); // the best one again
}

} // namespace hmf
