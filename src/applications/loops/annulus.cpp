#include "annulus.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// Turns that a search may visit, and the one in which it starts.
constexpr uint32_t ANNULUS_TURNS = 4, FIRST_TURN = 1;
// Of the distances from the landmark, in shortest ways round from it.
constexpr double RADIUS = 1.25;
// Around a vertex of more triangles regions are not identified: each new region takes a walk around it.
constexpr size_t MOST_IN_FAN = 512;
// Settled states in all searches, per state: meshes whose triangles are no fans take at most 4.  Beyond, the shortest
// way so far counts; on a strip of long triangles each root would settle most states.
constexpr uint64_t MOST_SETTLED = 16;
constexpr uint32_t CLOSED = static_cast<uint32_t>(-1); // a stamp

} // namespace

// The region on the left of the place: two places, or three in the middle of a triangle.
Done Annulus::add_copy(Place entry, double distance) {
    const uint32_t h = entry.half_edge, k = mesh_.next[h], l = mesh_.next[k];
    const uint64_t n = count(h), m = count(k), q = count(l);
    const uint32_t at_origin = static_cast<uint32_t>((n + q - m) / 2),
                   at_target = static_cast<uint32_t>((n + m - q) / 2);
    const uint32_t at_apex = static_cast<uint32_t>((m + q - n) / 2);
    Copy copy{};
    copy.side[0] = entry;
    copy.sides = 2;
    if (entry.position < at_origin) {
        copy.side[1] = {l, static_cast<uint32_t>(q) - entry.position};
    } else if (entry.position > at_origin) {
        copy.side[1] = {k, static_cast<uint32_t>(n) - entry.position};
    } else {
        copy.sides = 3;
        copy.side[1] = {k, at_target};
        copy.side[2] = {l, at_apex};
    }
    for (uint32_t s = 0; s < copy.sides; ++s) copy.length[s] = length_(edge_of(copy.side[s].half_edge));
    for (uint32_t& to : copy.to) to = NONE;
    copy.same = NONE;
    copy.distance = distance;
    return copies_.push(copy);
}

Done Annulus::push_border(uint32_t link, uint32_t before, uint32_t after) {
    return border_.push({link, before, after});
}

// Copy i is the region between the places i and i + 1 of the loop.
Done Annulus::build_strip(const Array<Place>& loop) {
    const uint32_t n = static_cast<uint32_t>(loop.size());
    for (uint32_t i = 0; i < n; ++i)
        if (!add_copy(other(loop[i]), 0)) return false;
    Array<uint32_t> exit;
    if (!exit.allocate(call_.memory, n)) return false;
    for (uint32_t i = 0; i < n; ++i) {
        const Place leave = loop[i + 1 < n ? i + 1 : 0];
        exit[i] = NONE;
        for (uint32_t s = 1; s < copies_[i].sides; ++s)
            if (copies_[i].side[s].half_edge == leave.half_edge && copies_[i].side[s].position == leave.position)
                exit[i] = s;
        assert(exit[i] != NONE); // the next place is at another side of the region
    }
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t j = i + 1 < n ? i + 1 : 0;
        copies_[i].to[exit[i]] = 4 * j;
        copies_[j].to[0] = 4 * i + exit[i];
        copies_[i].turns[exit[i]] = j == 0;
        copies_[j].turns[0] = j == 0 ? -1 : 0;
    }
    // Third sides: on the right of the loop (exit 2) the border runs along with
    // it, on the left (exit 1) against it.
    for (uint32_t right = 0; right < 2; ++right) {
        const uint32_t first = static_cast<uint32_t>(border_.size());
        for (uint32_t k = 0; k < n; ++k) {
            const uint32_t i = right ? k : n - 1 - k;
            if (copies_[i].sides != 3 || exit[i] != 1 + right) continue;
            const uint32_t at = static_cast<uint32_t>(border_.size());
            if (!push_border(4 * i + (right ? 1 : 2), at - 1, at + 1)) return false;
        }
        const uint32_t end = static_cast<uint32_t>(border_.size());
        if (end == first) continue;
        border_[first].before = end - 1;
        border_[end - 1].after = first;
    }
    return true;
}

// Side a of the border and the next one, if they are one segment that begins at a vertex.
void Annulus::close_up(uint32_t a) {
    for (;;) {
        const uint32_t b = border_[a].after;
        if (b == a || border_[b].after == a) return;
        const uint32_t link_a = border_[a].link, link_b = border_[b].link;
        const Place place_a = copies_[link_a / 4].side[link_a % 4], place_b = copies_[link_b / 4].side[link_b % 4];
        if (place_b.half_edge != twin(place_a.half_edge) || place_b.position != 0 || !ends_at_plain_vertex(place_a))
            return;
        int turns = 0;
        uint32_t at = link_a;
        for (;;) { // around the vertex, from a to b
            const Copy& copy = copies_[at / 4];
            const uint32_t s = at % 4 + 1 < copy.sides ? at % 4 + 1 : 0;
            if (at - at % 4 + s == link_b) break;
            turns += copy.turns[s];
            at = copy.to[s];
        }
        copies_[link_a / 4].to[link_a % 4] = link_b;
        copies_[link_b / 4].to[link_b % 4] = link_a;
        copies_[link_a / 4].turns[link_a % 4] = turns;
        copies_[link_b / 4].turns[link_b % 4] = -turns;
        const uint32_t before = border_[a].before, after = border_[b].after;
        border_[a].link = border_[b].link = NONE;
        border_[before].after = after;
        border_[after].before = before;
        a = before;
    }
}

// The fan from side a of the border to the next one, if it is more than a full
// turn around a vertex: its last regions are the first ones again.
Done Annulus::find_same(uint32_t a) {
    const uint32_t b = border_[a].after, link_a = border_[a].link, link_b = border_[b].link;
    const Place place = copies_[link_a / 4].side[link_a % 4];
    if (a == b || !ends_at_plain_vertex(place)) return true;
    size_t degree = 0;
    for (const uint32_t h : mesh_.around(mesh_.target(place.half_edge)))
        if (++degree > MOST_IN_FAN || h == NONE) return true;
    fan_.clear();
    int32_t turns = 0;
    uint32_t at = link_a;
    for (;;) {
        if (!fan_.push({at / 4, turns}) || !call_.work(1)) return false;
        if (fan_.size() > degree) {
            const Wedge first = fan_[fan_.size() - 1 - degree];
            Copy& one = copies_[first.copy];
            Copy& other = copies_[at / 4];
            if (one.same == NONE && other.same == NONE) {
                one.same = at / 4;
                one.turns[3] = turns - first.turns;
                other.same = first.copy;
                other.turns[3] = first.turns - turns;
            }
        }
        const Copy& copy = copies_[at / 4];
        const uint32_t s = at % 4 + 1 < copy.sides ? at % 4 + 1 : 0;
        if (at - at % 4 + s == link_b) return true;
        turns += copy.turns[s];
        at = copy.to[s];
    }
}

Done Annulus::grow(size_t capacity) {
    heap_.clear();
    const auto enqueue = [&](uint32_t b) {
        const uint32_t link = border_[b].link;
        const Copy& copy = copies_[link / 4];
        return heap_.push({copy.distance + copy.length[link % 4], b});
    };
    for (uint32_t b = 0; b < border_.size(); ++b)
        if (border_[b].link != NONE) close_up(b);
    for (uint32_t b = 0; b < border_.size(); ++b)
        if (border_[b].link != NONE && !find_same(b)) return false;
    for (uint32_t b = 0; b < border_.size(); ++b)
        if (border_[b].link != NONE && !enqueue(b)) return false;
    while (!heap_.empty() && copies_.size() < capacity) {
        const NearestFirst::Entry top = heap_.pop();
        const uint32_t b = top.item, link = border_[b].link;
        if (link == NONE) continue;
        if (!call_.work(64)) return false;
        const uint32_t copy = static_cast<uint32_t>(copies_.size());
        if (!add_copy(other(copies_[link / 4].side[link % 4]), top.distance)) return false;
        copies_[link / 4].to[link % 4] = 4 * copy;
        copies_[copy].to[0] = link;
        // Its other sides take the place of b.
        border_[b].link = 4 * copy + 1;
        uint32_t last = b;
        if (copies_[copy].sides == 3) {
            last = static_cast<uint32_t>(border_.size());
            const uint32_t after = border_[b].after;
            if (!push_border(4 * copy + 2, b, after)) return false;
            border_[after].before = last;
            border_[b].after = last;
        }
        if (!enqueue(b) || (last != b && !enqueue(last))) return false;
        const uint32_t before = border_[b].before;
        close_up(last);
        if (border_[b].link != NONE && border_[b].after == last) close_up(b);
        if (border_[before].link != NONE && border_[before].after == b) close_up(before);
        const uint32_t sides[3] = {before, b, last};
        for (const uint32_t side : sides)
            if (border_[side].link != NONE && !find_same(side)) return false;
    }
    return true;
}

// Lower bounds for the way that is left (Goldberg, Harrelson: Computing the
// shortest path, 2005).  The distance from a landmark, turn 0 of its copy, changes
// by no more than the way does, also where it is cut off at a radius; and a way is
// as long one turn on, so that each turn of the landmark gives a bound.
double Annulus::way_left(uint32_t state, uint32_t goal) const {
    double bound = 0;
    const uint32_t back = std::min(state % ANNULUS_TURNS, goal % ANNULUS_TURNS);
    const uint32_t on = ANNULUS_TURNS - 1 - std::max(state % ANNULUS_TURNS, goal % ANNULUS_TURNS);
    const double *a = landmark_.data() + (state - back), *b = landmark_.data() + (goal - back);
    for (uint32_t k = 0; k <= back + on; ++k) bound = std::max(bound, a[k] > b[k] ? a[k] - b[k] : b[k] - a[k]);
    return bound;
}

// The shortest way from turn 0 of a copy to turn 1 of it, if it is shorter than `best`.
Done Annulus::search_from(uint32_t root, bool is_landmark, double& best, Array<uint32_t>& out) {
    const uint32_t start = root * ANNULUS_TURNS + FIRST_TURN, goal = start + 1;
    const uint32_t reached = ++stamp_, settled = ++stamp_;
    const auto left = [&](uint32_t state) { return is_landmark ? 0 : way_left(state, goal); };
    double radius = is_landmark ? RADIUS * best : best;
    bool arrived = false;
    heap_.clear();
    state_[start] = {0, NONE, reached};
    if (!heap_.push({left(start), start})) return false;
    while (!heap_.empty()) {
        const NearestFirst::Entry top = heap_.pop();
        const uint32_t state = top.item;
        if (state_[state].stamp == settled) continue;
        if (top.distance >= radius) break;
        state_[state].stamp = settled;
        ++settled_;
        if (is_landmark) landmark_[state] = state_[state].distance;
        if (state == goal) {
            arrived = true;
            if (!is_landmark) break;
            radius = std::min(radius, RADIUS * top.distance);
        }
        if (!call_.work(64)) return false;
        const Copy& copy = copies_[state / ANNULUS_TURNS];
        for (uint32_t s = 0; s < 4; ++s) {
            const uint32_t next = s == 3 ? copy.same : s < copy.sides && copy.to[s] != NONE ? copy.to[s] / 4 : NONE;
            if (next == NONE) continue;
            const int turn = static_cast<int>(state % ANNULUS_TURNS) + copy.turns[s];
            if (turn < 0 || turn >= static_cast<int>(ANNULUS_TURNS)) continue;
            const uint32_t to = next * ANNULUS_TURNS + static_cast<uint32_t>(turn);
            const double d = s == 3 ? state_[state].distance : state_[state].distance + copy.length[s];
            const uint32_t stamp = state_[to].stamp;
            if (stamp >= settled || (stamp == reached && !(d < state_[to].distance))) continue;
            const double whole = d + left(to);
            if (whole >= radius) continue;
            state_[to] = {d, 4 * (state / ANNULUS_TURNS) + s, reached};
            if (!heap_.push({whole, to})) return false;
        }
    }
    if (is_landmark)
        for (double& x : landmark_) x = std::min(x, radius);
    if (!arrived || state_[goal].distance >= best) return true;
    best = state_[goal].distance;
    return read_way(start, goal, out);
}

Done Annulus::read_way(uint32_t start, uint32_t goal, Array<uint32_t>& out) const {
    out.clear();
    for (uint32_t state = goal; state != start;) {
        const uint32_t link = state_[state].from;
        const Copy& copy = copies_[link / 4];
        if (link % 4 != 3 && !out.push(copy.side[link % 4].half_edge)) return false;
        state = link / 4 * ANNULUS_TURNS
              + static_cast<uint32_t>(static_cast<int>(state % ANNULUS_TURNS) - copy.turns[link % 4]);
    }
    std::reverse(out.begin(), out.end());
    return true;
}

// From each copy where turns are counted.  A shorter loop than the best so far
// passes none from which the search has been: they are closed.
Done Annulus::search(double limit, Array<uint32_t>& out) {
    const size_t states = copies_.size() * ANNULUS_TURNS;
    if (!state_.allocate_filled(call_.memory, states, SearchState{HUGE_VAL, NONE, 0})
        || !landmark_.allocate_filled(call_.memory, states, HUGE_VAL))
        return false;
    double best = limit;
    bool is_landmark = true;
    stamp_ = 0;
    settled_ = 0;
    for (uint32_t root = 0; root < copies_.size() && settled_ < MOST_SETTLED * states; ++root) {
        const Copy& copy = copies_[root];
        bool counts = false;
        for (uint32_t s = 0; s < copy.sides; ++s) counts |= copy.to[s] != NONE && copy.turns[s] > 0;
        if (!counts) continue;
        if (!search_from(root, is_landmark, best, out)) return false;
        is_landmark = false;
        for (uint32_t turn = 0; turn < ANNULUS_TURNS; ++turn) state_[root * ANNULUS_TURNS + turn].stamp = CLOSED;
    }
    return true;
}

Done Annulus::shortest(const Array<uint32_t>& count, const Array<Place>& loop, size_t capacity, double limit,
                       Array<uint32_t>& out) {
    count_ = &count;
    copies_.clear();
    border_.clear();
    out.start(call_.memory);
    return build_strip(loop) && grow(capacity) && search(limit, out);
}

} // namespace hmf
