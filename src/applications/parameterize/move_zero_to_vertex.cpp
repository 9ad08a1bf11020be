#include "move_zero_to_vertex.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr size_t MOST_CROSSED = 65536;                    // faces in one search
constexpr int64_t LARGEST_DRAG_HEIGHT = int64_t{1} << 59; // the sum of two leaves room for two more

bool is_too_high(int64_t height) { return height > LARGEST_DRAG_HEIGHT || height < -LARGEST_DRAG_HEIGHT; }

} // namespace

Done ZeroMoves::move(const Array<uint32_t>& tripods, const Array<uint32_t>& even, Call& call, size_t& left) {
    left = 0;
    if (tripods.empty() && even.empty()) return true;
    Memory& memory = call.memory;
    Array<uint32_t> waiting;
    refused_.start(memory);
    nearest_.start(memory);
    reached_.start(memory);
    way_.start(memory);
    if (!waiting.allocate(memory, tripods.size()) || !settled_.allocate_filled(memory, mesh_.face_count, NONE))
        return false;
    std::copy(tripods.begin(), tripods.end(), waiting.begin());
    // u is not defined there: no way leads through before the zero has left.
    for (const uint32_t h : tripods) settled_[mesh_.face[h]] = BARRED;
    for (size_t before = waiting.size() + 1; !waiting.empty() && waiting.size() < before;) {
        before = waiting.size();
        for (size_t i = 0; i < waiting.size();) {
            if (!call.tick(0) || !find_way(waiting[i])) return false;
            if (vertex_ == NONE) {
                ++i;
                continue;
            }
            move_odd_turn(waiting[i], way_[0]);
            for (uint32_t& other : waiting) // the turn around the vertex has to be even before
                for (uint32_t side = 0; &other != &waiting[i] && side < 2 && mesh_.target(other) == vertex_; ++side)
                    move_odd_turn(other, mesh_.next[other]);
            // A tripod with all of its corners there has its odd turn nowhere else.
            if (!may_end()) {
                if (!refuse()) return false;
                continue;
            }
            if (!cross_faces()) return false;
            if (!follow_way()) {
                left = waiting.size();
                return true;
            }
            settled_[mesh_.face[waiting[i]]] = NONE;
            waiting[i] = waiting.back();
            waiting.pop();
        }
    }
    left = waiting.size();
    for (size_t i = 0; left == 0 && i < even.size(); ++i)
        for (;;) {
            if (!call.tick(0) || !find_way_from_vertex(even[i])) return false;
            if (vertex_ != NONE) {
                // A triangle whose third corner is at the height of the zero.
                const uint32_t side = mesh_.next[way_[0]];
                change_chart(side);
                if (!may_end()) {
                    change_chart(side);
                    if (!refuse()) return false;
                    continue;
                }
            }
            if (!cross_faces()) return false;
            if (vertex_ == NONE || !follow_way()) left = even.size() - i;
            break;
        }
    forget_refused();
    return true;
}

// The zero arrives at a vertex whose turn is even, if this is not yet counted.
bool ZeroMoves::may_end() {
    if (turn_round(vertex_) != (way_.size() == 1 ? -1 : 1)) return false;
    forget_refused();
    taken_[vertex_] = 1;
    return true;
}

Done ZeroMoves::refuse() {
    taken_[vertex_] = 1;
    return refused_.push(vertex_);
}

void ZeroMoves::forget_refused() {
    for (const uint32_t v : refused_) taken_[v] = 0;
    refused_.clear();
}

// From the center of the face of h to its origin, which lies `height` above it: v is the mean of the centers around it.
double ZeroMoves::distance(double height, uint32_t h) const {
    double v = 0, sum = 0, weights = 0;
    uint32_t degree = 0;
    int8_t chart = 1;
    for (const uint32_t out : mesh_.around_from(h)) {
        sum += v;
        ++degree;
        const uint32_t ahead = mesh_.prev(out), e = edge_of(ahead);
        weights += weight_[e];
        v -= chart * weight_[e] * static_cast<double>(du(ahead));
        chart = static_cast<int8_t>(chart * bundle_.turn[e]);
    }
    const double mean = sum / degree;
    return std::sqrt(weights * height * height + mean * mean);
}

Done ZeroMoves::reach(uint32_t crossed, const Reached& before, double right, double left, int8_t sheet) {
    const uint32_t into = twin(crossed);
    if (settled_[mesh_.face[into]] != NONE) return true;
    Reached r = before;
    r.crossed = crossed;
    r.right = right;
    r.left = left;
    r.sheet = sheet;
    r.apex = right + sheet * static_cast<double>(du(mesh_.next[into]));
    r.center = (right + left + r.apex) / 3;
    const double weight = weight_[edge_of(crossed)];
    const double up = r.center - before.center, across = weight * (left - right);
    r.length += std::sqrt(up * up + across * across + 4 * weight * std::fabs(left * right));
    return nearest_.push({r.length, static_cast<uint32_t>(reached_.size())}) && reached_.push(r);
}

void ZeroMoves::begin() {
    way_.clear();
    reached_.clear();
    nearest_.clear();
    vertex_ = last_ = NONE;
}

// The way to the target of a half-edge without a step: h leaves it in the same face.
void ZeroMoves::try_corner(uint32_t side, double height) {
    const uint32_t end = mesh_.target(side);
    if (taken_[end]) return;
    const double d = distance(height, mesh_.next[side]);
    if (vertex_ != NONE && d >= least_) return;
    least_ = d;
    vertex_ = end;
    last_ = side;
}

Done ZeroMoves::find_way(uint32_t tripod) {
    begin();
    const uint32_t side[3] = {tripod, mesh_.next[tripod], mesh_.prev(tripod)};
    // Heights of the origins of the sides.
    const double s0 = static_cast<double>(du(side[0])), s1 = static_cast<double>(du(side[1])),
                 s2 = static_cast<double>(du(side[2]));
    const double height[3] = {0.5 * (s0 - s1 - s2), 0.5 * (s0 + s1 + s2), 0.5 * (s1 - s0 - s2)};
    for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t to = (k + 1) % 3;
        try_corner(side[k], height[to]);
        const int8_t turn = bundle_.turn[edge_of(side[k])];
        if (!reach(side[k], Reached(), -height[k], height[to], k == 2 ? static_cast<int8_t>(-turn) : turn))
            return false;
    }
    return search();
}

// The zero leaves to the side that the fluxes pull to, where u would drift if it were not held.
Done ZeroMoves::find_way_from_vertex(uint32_t v) {
    begin();
    double divergence = 0;
    int8_t chart = 1;
    for (const uint32_t h : mesh_.around(v)) {
        divergence += chart * weight_[edge_of(h)] * static_cast<double>(du(h));
        chart = static_cast<int8_t>(chart * bundle_.turn[edge_of(mesh_.prev(h))]);
    }
    const double sign = divergence > 0 ? 1 : -1;
    for (const uint32_t h : mesh_.around(v)) {
        const uint32_t opposite = mesh_.next[h], last = mesh_.next[opposite];
        const double right = chart * static_cast<double>(du(h)), left = -chart * static_cast<double>(du(last));
        if (sign * left > 0) try_corner(opposite, left);
        const auto sheet = static_cast<int8_t>(chart * bundle_.turn[edge_of(opposite)]);
        if ((sign * left > 0 || sign * right > 0) && !reach(opposite, Reached(), right, left, sheet)) return false;
        chart = static_cast<int8_t>(chart * bundle_.turn[edge_of(last)]);
    }
    return search();
}

Done ZeroMoves::search() {
    uint32_t best = NONE;
    size_t settled = 0;
    while (!nearest_.empty() && settled < MOST_CROSSED) {
        const NearestFirst::Entry entry = nearest_.pop();
        if (vertex_ != NONE && entry.distance >= least_) break;
        const Reached r = reached_[entry.item];
        const uint32_t into = twin(r.crossed), to_apex = mesh_.next[into], from_apex = mesh_.next[to_apex];
        uint32_t& mark = settled_[mesh_.face[into]];
        if (mark != NONE) continue;
        mark = entry.item;
        ++settled;
        const uint32_t apex = mesh_.origin[from_apex];
        if (!taken_[apex] && apex != mesh_.origin[into]) { // the odd turn is at the left end of the way
            const double d = r.length + distance(r.apex - r.center, from_apex);
            if (vertex_ == NONE || d < least_) {
                least_ = d;
                vertex_ = apex;
                best = entry.item;
            }
        }
        Reached from = r;
        from.from = entry.item;
        const auto sheet = [&](uint32_t h) { return static_cast<int8_t>(r.sheet * bundle_.turn[edge_of(h)]); };
        if (!reach(to_apex, from, r.right, r.apex, sheet(to_apex))
            || !reach(from_apex, from, r.apex, r.left, sheet(from_apex)))
            return false;
    }
    for (const Reached& r : reached_) {
        uint32_t& mark = settled_[mesh_.face[twin(r.crossed)]];
        if (mark != BARRED) mark = NONE;
    }
    if (best == NONE) return vertex_ == NONE || way_.push(last_);
    for (uint32_t i = best; i != NONE; i = reached_[i].from)
        if (!way_.push(reached_[i].crossed)) return false;
    if (!way_.push(way_.back())) return false;
    std::reverse(way_.begin(), way_.end());
    return true;
}

// Where a leaf goes through one of these faces is not looked at.
Done ZeroMoves::cross_faces() {
    for (size_t i = 0; moved_ && i < way_.size(); ++i) {
        const uint32_t h = i == 0 ? way_[0] : twin(way_[i]);
        for (const uint32_t side : {h, mesh_.next[h], mesh_.prev(h)})
            if (!moved_->crossed.push(side)) return false;
    }
    return true;
}

// False: heights need too many bits.
bool ZeroMoves::follow_way() {
    // The sides of the tripod are a_r + a_l, a_l + a, a + a_r, where a are the heights of its corners.
    const uint32_t first = way_[0];
    const int64_t side[3] = {du(first), du(mesh_.next[first]), -du(mesh_.prev(first))};
    for (const int64_t s : side)
        if (is_too_high(s)) return false;
    int64_t right = (side[1] - side[2] - side[0]) / 2, left = (side[2] - side[0] - side[1]) / 2;
    if (way_.size() == 1) lower(twin(first), -bundle_.turn[edge_of(first)] * left);
    for (const uint32_t h : mesh_.around(vertex_)) touch(mesh_.target(h));
    for (size_t i = 1; i < way_.size(); ++i) {
        touch(mesh_.origin[way_[i]]);
        touch(mesh_.target(way_[i]));
        const uint32_t h = way_[i], e = edge_of(h), to_apex = mesh_.next[twin(h)], from_apex = mesh_.next[to_apex];
        const int8_t turn = bundle_.turn[e];
        du_.value[e] = h % 2 == 0 ? left - right : -turn * (left - right);
        right *= turn;
        left *= turn;
        const int64_t apex = right + du(to_apex);
        if (is_too_high(apex)) return false;
        if (i + 1 == way_.size()) {
            lower(from_apex, apex);
            change_chart(from_apex);
        } else if (way_[i + 1] == from_apex) {
            right = apex;
        } else {
            left = -apex;
            change_chart(from_apex);
        }
    }
    return true;
}

// From the target of one half-edge of a tripod to that of another: the two sides that
// meet at the third corner change their signs.
void ZeroMoves::move_odd_turn(uint32_t& from, uint32_t to) {
    if (from == to) return;
    const bool is_next = to == mesh_.next[from];
    change_chart(is_next ? mesh_.prev(from) : mesh_.next[from]);
    change_chart(is_next ? from : to);
    from = to;
}

void ZeroMoves::touch(uint32_t v) {
    if (moved_) moved_->untouched[v] = 0;
}

int ZeroMoves::turn_round(uint32_t v) const {
    int turn = 1;
    for (const uint32_t h : mesh_.around(v)) turn *= bundle_.turn[edge_of(h)];
    return turn;
}

// Across h the chart of its face changes its sign.
void ZeroMoves::change_chart(uint32_t h) {
    const uint32_t e = edge_of(h);
    bundle_.turn[e] = static_cast<int8_t>(-bundle_.turn[e]);
    if (h % 2 == 0) du_.value[e] = -du_.value[e];
}

// The origin of h goes down by `height`, in the chart of the face of h.
void ZeroMoves::lower(uint32_t h, int64_t height) {
    for (const uint32_t out : mesh_.around_from(h)) {
        if (out != h) height *= bundle_.turn[edge_of(out)];
        du_.add(bundle_, out, height);
    }
}

} // namespace hmf
