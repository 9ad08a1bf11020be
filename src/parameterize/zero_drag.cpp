#include "zero_drag.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t MOST_CROSSED = 65536;               // in one search
constexpr int64_t LARGEST_HEIGHT = int64_t{1} << 59; // the sum of two leaves room for two more

bool is_too_high(int64_t height) { return height > LARGEST_HEIGHT || height < -LARGEST_HEIGHT; }

} // namespace

Done ZeroDrags::drag(const Array<uint32_t>& tripods, Call& call, size_t& left) {
    Memory& memory = call.memory;
    Array<uint32_t> waiting;
    queue_.start(memory);
    way_.start(memory);
    waiting.start(memory);
    if (!waiting.extend(tripods.size()) || !reached_from_.allocate_filled(memory, mesh_.face_count, NONE)) return false;
    std::copy(tripods.begin(), tripods.end(), waiting.begin());
    // u is not defined there: no way leads through before the zero has left.
    for (const uint32_t h : tripods) reached_from_[mesh_.face[h]] = BARRED;
    for (size_t before = waiting.size() + 1; !waiting.empty() && waiting.size() < before;) {
        before = waiting.size();
        for (size_t i = 0; i < waiting.size();) {
            if (!call.tick(0) || !find_way(waiting[i])) return false;
            if (vertex_ == NONE) {
                ++i;
                continue;
            }
            taken_[vertex_] = 1;
            move_odd_turn(waiting[i], way_[0]);
            for (uint32_t& other : waiting) // the turn round the vertex has to be even before
                for (uint32_t side = 0; &other != &waiting[i] && side < 2 && mesh_.target(other) == vertex_; ++side)
                    move_odd_turn(other, mesh_.next[other]);
            // A tripod with all of its corners there has its odd turn nowhere else.
            if (turn_round(vertex_) != (way_.size() == 1 ? -1 : 1)) continue;
            if (!follow_way()) {
                left = waiting.size();
                return true;
            }
            reached_from_[mesh_.face[waiting[i]]] = NONE;
            waiting[i] = waiting.back();
            waiting.pop();
        }
    }
    left = waiting.size();
    return true;
}

Done ZeroDrags::cross(uint32_t h) {
    uint32_t& from = reached_from_[mesh_.face[twin(h)]];
    if (from != NONE) return true;
    from = h;
    return queue_.push(h);
}

Done ZeroDrags::find_way(uint32_t tripod) {
    way_.clear();
    vertex_ = NONE;
    const uint32_t sides[3] = {tripod, mesh_.next[tripod], mesh_.prev(tripod)};
    for (const uint32_t h : sides) {
        if (taken_[mesh_.target(h)]) continue;
        vertex_ = mesh_.target(h);
        return way_.push(h);
    }
    queue_.clear();
    for (const uint32_t h : sides)
        if (!cross(h)) return false;
    for (size_t i = 0; i < queue_.size() && i < MOST_CROSSED && vertex_ == NONE; ++i) {
        const uint32_t into = twin(queue_[i]), apex = mesh_.origin[mesh_.prev(into)];
        if (taken_[apex]) {
            if (!cross(mesh_.next[into]) || !cross(mesh_.prev(into))) return false;
            continue;
        }
        vertex_ = apex;
        for (uint32_t h = queue_[i]; h != BARRED; h = reached_from_[mesh_.face[h]])
            if (!way_.push(h)) return false;
        if (!way_.push(way_.back())) return false;
        std::reverse(way_.begin(), way_.end());
    }
    for (const uint32_t h : queue_) reached_from_[mesh_.face[twin(h)]] = NONE;
    return true;
}

// False: heights need too many bits.
bool ZeroDrags::follow_way() {
    // The sides of the tripod are a_r + a_l, a_l + a, a + a_r, where a are the heights of its corners.
    const uint32_t first = way_[0];
    const int64_t side[3] = {du(first), du(mesh_.next[first]), -du(mesh_.prev(first))};
    for (const int64_t s : side)
        if (is_too_high(s)) return false;
    int64_t right = (side[1] - side[2] - side[0]) / 2, left = (side[2] - side[0] - side[1]) / 2;
    if (way_.size() == 1) lower(twin(first), -bundle_.turn[edge_of(first)] * left);
    for (size_t i = 1; i < way_.size(); ++i) {
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
void ZeroDrags::move_odd_turn(uint32_t& from, uint32_t to) {
    if (from == to) return;
    const bool is_next = to == mesh_.next[from];
    change_chart(is_next ? mesh_.prev(from) : mesh_.next[from]);
    change_chart(is_next ? from : to);
    from = to;
}

int ZeroDrags::turn_round(uint32_t v) const {
    int turn = 1;
    for (const uint32_t h : mesh_.around(v)) turn *= bundle_.turn[edge_of(h)];
    return turn;
}

// Across h the chart of its face changes its sign.
void ZeroDrags::change_chart(uint32_t h) {
    const uint32_t e = edge_of(h);
    bundle_.turn[e] = static_cast<int8_t>(-bundle_.turn[e]);
    if (h % 2 == 0) du_.value[e] = -du_.value[e];
}

// The origin of h goes down by `height`, in the chart of the face of h.
void ZeroDrags::lower(uint32_t h, int64_t height) {
    for (const uint32_t out : mesh_.around_from(h)) {
        if (out != h) height *= bundle_.turn[edge_of(out)];
        du_.add(bundle_, out, height);
    }
}

} // namespace hmf
