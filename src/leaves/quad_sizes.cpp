// Rounding of lengths with one equation per cylinder: as many columns at the
// lower boundary as at the upper one.
//
// Each arc has two sides, so one more quad on it changes the balance of one
// cylinder or two, by +1 at a lower boundary and -1 at an upper one.  The sum
// of all balances is even.  A balance that is off is led along a path of arcs,
// one more quad or one less on each, to another that is off: the shortest path
// through the states (cylinder, change that it still needs).  The unrounded
// lengths solve the equations, so there is such a path as long as the arcs on
// it can give a quad away.
//
// The equations can force an arc to have no length: where two zeros coincide in
// truth, as symmetry asks, a discrete foliation has them a little apart, in some
// order or other.  Such an arc may get 0 columns, and its zeros become one.
#include "quad_sizes.hpp"

#include <cmath>

namespace hmf {

namespace {

// Fewer would join the same two vertices twice: points within an arc keep its
// ends apart, and two of them those of an arc from a zero to itself.  An arc
// between two marked vertices gives one point at each end to a quad over its end.
constexpr int64_t LEAST_ROWS = 3, LEAST_COLUMNS = 2, LEAST_ON_LOOP = 3;
constexpr double MOST = 1 << 24;

class Balance {
public:
    // shrinks: per arc side, not 0 where an arc may vanish if there is no other way.
    Balance(const Cylinders& cylinders, const Array<uint8_t>& shrinks, Array<int64_t>& columns) :
        cylinders_(cylinders), graph_(cylinders.graph), shrinks_(shrinks), columns_(columns) {}

    hmf_status run(Call& call) {
        const size_t n = cylinders_.list.size();
        if (!off_.allocate_filled(call.memory, n, int64_t{0}) || !from_.allocate(call.memory, 2 * n)
            || !queue_.allocate(call.memory, 2 * n) || !held_.allocate(call.memory, graph_.arcs.size()))
            return call.out_of_memory();
        for (uint32_t a = 0; a < graph_.arcs.size(); ++a) off_[cylinder(a)] += sign(a) * columns_[a];
        for (uint32_t c = 0; c < n; ++c)
            while (off_[c] != 0) {
                bool found = false;
                for (vanishing_ = false; !found; vanishing_ = true) {
                    for (uint8_t& h : held_) h = 0;
                    // An arc that would have to give two away is held back in the next search.
                    for (size_t tries = 0; tries <= graph_.arcs.size() && !found; ++tries) {
                        const uint32_t last = search(c);
                        if (last == NONE) break;
                        found = apply(last);
                    }
                    if (vanishing_) break;
                }
                if (!found)
                    return call.fail(
                        HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_OPTION, 0,
                        "The cylinders cannot be matched with quads of this size. Choose a smaller edge_length.");
            }
        return HMF_OK;
    }

    static int64_t least(const CriticalGraph& graph, uint32_t a) {
        const Zero &from = graph.zeros[graph.sectors[graph.arcs[a].from].zero],
                   &to = graph.zeros[graph.sectors[graph.arcs[a].to].zero];
        return &from == &to || (from.index == 0 && to.index == 0) ? LEAST_ON_LOOP : LEAST_COLUMNS;
    }

private:
    int64_t least_now(uint32_t a) const { return vanishing_ && shrinks_[a] ? 0 : least(graph_, a); }
    uint32_t cylinder(uint32_t a) const { return cylinders_.of_boundary[graph_.sectors[graph_.arcs[a].from].boundary]; }
    int64_t sign(uint32_t a) const {
        return cylinders_.list[cylinder(a)].lower == graph_.sectors[graph_.arcs[a].from].boundary ? 1 : -1;
    }

    struct Step {
        uint32_t state, arc;
    }; // how a state was reached

    // States: 2 * cylinder + 1 if it needs +1, + 0 if it needs -1.  Returns the
    // last arc of a path that mends two balances, reached from last_state_.
    uint32_t search(uint32_t start) {
        for (Step& s : from_) s = {NONE, NONE};
        const int64_t need = off_[start] > 0 ? -1 : 1;
        const uint32_t first = 2 * start + (need > 0);
        uint32_t end = 0;
        from_[first] = {first, NONE};
        queue_[end++] = first;
        for (uint32_t at = 0; at < end; ++at) {
            const uint32_t state = queue_[at], c = state / 2;
            const int64_t wanted = state % 2 ? 1 : -1;
            const uint32_t boundaries[2] = {cylinders_.list[c].lower, cylinders_.list[c].upper};
            for (const uint32_t boundary : boundaries)
                for (uint32_t a = graph_.boundaries[boundary].arcs_begin; a < graph_.boundaries[boundary].arcs_end;
                     ++a) {
                    const int64_t change = wanted * sign(a);
                    if (change < 0 && (held_[a] || columns_[a] <= least_now(a))) continue;
                    const uint32_t other = graph_.arcs[a].twin, d = cylinder(other);
                    const int64_t effect = change * sign(other);
                    if (d == c && effect == -wanted) continue; // nothing changes
                    const int64_t off = off_[d] + (d == start ? need : 0);
                    if (off * effect < 0) {
                        last_state_ = state;
                        return a;
                    }
                    const uint32_t next = 2 * d + (effect < 0);
                    if (from_[next].state != NONE) continue;
                    from_[next] = {state, a};
                    queue_[end++] = next;
                }
        }
        return NONE;
    }

    // Changes the arcs of the path found; false, and nothing changed, if one of
    // them cannot give that much.
    bool apply(uint32_t last) {
        bool fits = true;
        for (int round = 0; round < 2; ++round) {
            uint32_t a = last, state = last_state_;
            for (;;) {
                int64_t change = (state % 2 ? 1 : -1) * sign(a);
                if (round == 1) change = -change; // back
                const uint32_t other = graph_.arcs[a].twin;
                columns_[a] += change;
                columns_[other] = columns_[a];
                off_[cylinder(a)] += sign(a) * change;
                off_[cylinder(other)] += sign(other) * change;
                if (columns_[a] < least_now(a)) {
                    fits = false;
                    held_[a] = held_[other] = 1;
                }
                if (from_[state].arc == NONE) break;
                a = from_[state].arc;
                state = from_[state].state;
            }
            if (fits) return true;
        }
        return false;
    }

    const Cylinders& cylinders_;
    const CriticalGraph& graph_;
    const Array<uint8_t>& shrinks_;
    Array<int64_t>& columns_;
    Array<int64_t> off_; // columns of the lower boundary minus those of the upper one
    Array<Step> from_;
    Array<uint32_t> queue_;
    Array<uint8_t> held_;
    uint32_t last_state_ = 0;
    bool vanishing_ = false;
};

} // namespace

hmf_status quad_sizes(const Cylinders& cylinders, const Array<double>& conjugate_length, double step,
                      Array<int64_t>& columns, Array<int64_t>& rows, Call& call) {
    const CriticalGraph& graph = cylinders.graph;
    if (!columns.allocate(call.memory, graph.arcs.size()) || !rows.allocate(call.memory, cylinders.list.size()))
        return call.out_of_memory();
    double total = 0;
    for (size_t c = 0; c < rows.size(); ++c) {
        const double wanted = std::floor(static_cast<double>(cylinders.list[c].height) / step + 0.5);
        total += wanted;
        rows[c] = wanted < LEAST_ROWS ? LEAST_ROWS : wanted < MOST ? static_cast<int64_t>(wanted) : 0;
    }
    for (uint32_t a = 0; a < columns.size(); ++a) {
        const double wanted =
            std::floor((conjugate_length[a] + conjugate_length[graph.arcs[a].twin]) / (2 * step) + 0.5);
        total += wanted;
        const int64_t least = Balance::least(graph, a);
        columns[a] = wanted < static_cast<double>(least) ? least : wanted < MOST ? static_cast<int64_t>(wanted) : 0;
    }
    if (!(total < MOST))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "edge_length is too small for the surface. Choose a larger one.");
    Array<uint8_t> shrinks;
    if (!shrinks.allocate(call.memory, graph.arcs.size())) return call.out_of_memory();
    for (uint32_t a = 0; a < shrinks.size(); ++a)
        shrinks[a] = Balance::least(graph, a) == LEAST_COLUMNS
                  && conjugate_length[a] + conjugate_length[graph.arcs[a].twin] < 3 * step;
    return Balance(cylinders, shrinks, columns).run(call);
}

} // namespace hmf
