#include "loop_search.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

Done LoopSearch::prepare(const Signatures& signatures, size_t states_per_region) {
    Memory& memory = call_.memory;
    signatures_ = &signatures;
    const size_t n = cut_.region_count, states = edge_label_ ? states_per_region * n : n;
    heap_.start(memory);
    order_.start(memory);
    closings_.start(memory);
    cycle_.start(memory);
    epoch_ = 0;
    budget_exhausted_ = false;
    size_t places = edge_label_ ? 2 : 0;
    for (table_shift_ = 63; edge_label_ && places < 2 * states; places *= 2) --table_shift_;
    clear_states();
    if (!arc_.allocate(memory, 3 * n) || !bound_.allocate_filled(memory, n, 0.0)
        || !nearest_root_.allocate_filled(memory, n, HUGE_VAL) || !state_.allocate(memory, states)
        || !covered_.allocate(memory, edge_label_ ? states : 0)
        || (table_.size() != places && !table_.allocate_filled(memory, places, NONE)) || !order_.reserve(states)
        || !heap_.reserve(3 * states + 1))
        return false;
    for (size_t i = 0; i < 3 * n; ++i) {
        const uint32_t link = cut_.link[i], segment = link >> 1;
        arc_[i] = link == NONE ? Arc{0, 0, NONE, NONE}
                               : Arc{edge_length_[cut_.segment_edge[segment]], signatures.of[segment],
                                     cut_.region[link ^ 1u], link};
    }
    for (uint32_t s = 0; s < n && !edge_label_; ++s) state_[s] = {0, 0, 0, s, NONE, NONE}; // else as they are made
    return true;
}

// The state of a region with a sum of labels.  NONE: there is none yet, or no
// room to make it.  Without labels states are regions.
uint32_t LoopSearch::find_state(uint32_t region, uint64_t label, bool make) {
    if (!edge_label_) return region;
    const uint64_t hash = (label + region * uint64_t{0x9e3779b97f4a7c15}) * uint64_t{0xbf58476d1ce4e5b9};
    size_t place = static_cast<size_t>(hash >> table_shift_);
    for (; table_[place] != NONE; place = place + 1 < table_.size() ? place + 1 : 0) {
        const uint32_t s = table_[place];
        if (covered_[s].label == label && state_[s].region == region) return s;
    }
    if (!make) return NONE;
    if (state_count_ == state_.size()) {
        budget_exhausted_ = exhausted_here_ = true;
        return NONE;
    }
    const uint32_t made = state_count_++;
    table_[place] = made;
    covered_[made] = {label, static_cast<uint32_t>(place)};
    state_[made].region = region;
    state_[made].stamp = 0;
    return made;
}

Done LoopSearch::search(uint32_t root, double limit, double kept) {
    ++epoch_;
    heap_.clear();
    order_.clear();
    clear_states();
    exhausted_here_ = false;
    const uint32_t start = find_state(root, 0, true);
    state_[start] = {0, 0, 2 * epoch_, root, NONE, NONE};
    heap_.add(0, start); // at most one for each link
    closings_.clear();
    double shortest = limit, reach = limit; // of the loops found, and of the loops searched for
    while (!heap_.empty()) {
        const uint32_t s = heap_.pop();
        if (settled(s)) continue;
        const double here = state_[s].distance;
        if (2 * here >= reach) break;
        state_[s].stamp = 2 * epoch_ + 1;
        order_.add(s);
        ++work_;
        if (!call_.work(64)) return false;
        const Arc* const arcs = &arc_[3 * size_t{state_[s].region}];
        const uint64_t label = edge_label_ ? covered_[s].label : 0, signature_here = state_[s].signature;
        for (uint32_t i = 0; i < 3; ++i) {
            const Arc& arc = arcs[i];
            if (arc.to == NONE) break;
            if (bound_[arc.to] >= reach) continue;
            const double d = here + arc.length;
            const bool far = 2 * d >= reach; // it would not be settled
            const uint32_t to = edge_label_ ? find_state(arc.to, label_after(label, arc.half_segment), !far) : arc.to;
            if (to == NONE) continue;
            SearchState& state = state_[to];
            const uint64_t signature = signature_here ^ arc.signature;
            if (state.stamp <= 2 * epoch_) {
                if (far || (state.stamp == 2 * epoch_ && !(d < state.distance))) continue;
                state.stamp = 2 * epoch_;
                state.distance = d;
                state.signature = signature;
                state.before = s;
                state.through = arc.half_segment;
                heap_.add(d, to);
            } else if (signature != state.signature && d + state.distance < reach
                       && !signatures_->is_trivial(signature ^ state.signature)) {
                const double length = d + state.distance;
                if (!keep({length, signature ^ state.signature, arc.half_segment, s, to})) return false;
                shortest = std::min(shortest, length);
                reach = std::min(reach, std::max(SLACK * shortest, kept));
            }
        }
    }
    for (const uint32_t s : order_) {
        double& nearest = nearest_root_[state_[s].region];
        if (exhausted_here_ || !(state_[s].distance < nearest)) continue;
        nearest = state_[s].distance;
    }
    if (!exhausted_here_)
        for (const uint32_t s : order_) raise_bound(state_[s].region, shortest - 2 * state_[s].distance);
    while (!closings_.empty() && closings_.back().length > reach) closings_.pop();
    return true;
}

// The shortest for each signature, sorted by length; CANDIDATES of them.
Done LoopSearch::keep(const Closing& closing) {
    size_t i = 0;
    while (i < closings_.size() && closings_[i].signature != closing.signature) ++i;
    if (i < closings_.size()) {
        if (!(closing.length < closings_[i].length)) return true;
    } else if (i < CANDIDATES) {
        if (!closings_.push(closing)) return false;
    } else if (closing.length < closings_[--i].length) {
    } else return true;
    for (; i > 0 && closing.length < closings_[i - 1].length; --i) closings_[i] = closings_[i - 1];
    closings_[i] = closing;
    return true;
}

// The cycle of a link in the search tree:  root ---- o===state
//                                                     \\  | closing
//                                                       `=to
Done LoopSearch::strip(size_t i, Array<uint32_t>& found) {
    const uint32_t closing = closings_[i].link, state = closings_[i].from, to = closings_[i].to;
    ++epoch_; // marks the way from the state to the root
    for (uint32_t at = state; at != NONE; at = state_[at].before) state_[at].stamp = 2 * epoch_;
    uint32_t meet = to;
    while (!reached(meet)) meet = state_[meet].before;
    found.clear();
    for (uint32_t at = state; at != meet; at = state_[at].before)
        if (!found.push(state_[at].through)) return false;
    std::reverse(found.begin(), found.end());
    if (!found.push(closing)) return false;
    for (uint32_t at = to; at != meet; at = state_[at].before)
        if (!found.push(state_[at].through ^ 1u)) return false;
    return true;
}

} // namespace hmf
