#include "carry_loops.hpp"

#include "../../core/base/heap_sort.hpp"

#include <algorithm>
#include <cstring>

namespace hmf {

Done LoopCarrier::load(const hmf_hierarchy& hierarchy, size_t level, size_t finest, const Loops& loops,
                       Memory& memory) {
    hierarchy_ = &hierarchy;
    level_ = level;
    const Mesh& room = mesh_of(finest);
    entries_.start(memory);
    scratch_.start(memory);
    free_ = NONE;
    const size_t sides =
        level > finest ? size_t{2} * mesh_of(finest + 1).edge_count : 0; // levels are refined from there
    return next_.allocate(memory, sides) && head_.allocate_filled(memory, room.edge_count, NONE)
        && curve_.allocate(room, memory) && replace(loops);
}

Done LoopCarrier::replace(const Loops& loops) {
    for (const Entry& entry : entries_) head_[entry.edge] = NONE;
    entries_.clear();
    free_ = NONE;
    loop_count_ = loops.count();
    for (size_t c = 0; c < loop_count_; ++c)
        for (uint64_t i = loops.offsets[c]; i < loops.offsets[c + 1]; ++i) {
            const uint32_t h = loops.crossings[i];
            if (!add(edge_of(h), static_cast<uint32_t>(c), 1, h & 1u ? -1 : 1)) return false;
        }
    return true;
}

const LoopCarrier::Entry* LoopCarrier::find(uint32_t edge, uint32_t loop) const {
    for (uint32_t i = head_[edge]; i != NONE; i = entries_[i].next)
        if (entries_[i].loop == loop) return &entries_[i];
    return nullptr;
}

Done LoopCarrier::add(uint32_t edge, uint32_t loop, uint32_t count, int32_t signed_count) {
    if (const Entry* found = find(edge, loop)) {
        Entry& entry = entries_[static_cast<size_t>(found - entries_.data())];
        entry.count += count;
        entry.signed_count += signed_count;
        return true;
    }
    uint32_t at = free_;
    if (at != NONE) {
        free_ = entries_[at].next;
    } else {
        at = static_cast<uint32_t>(entries_.size());
        if (!entries_.push({})) return false;
    }
    entries_[at] = {edge, loop, count, signed_count, head_[edge]};
    head_[edge] = at;
    return true;
}

void LoopCarrier::drop_edge(uint32_t edge) {
    while (head_[edge] != NONE) {
        const uint32_t at = head_[edge];
        head_[edge] = entries_[at].next;
        entries_[at].loop = NONE;
        entries_[at].next = free_;
        free_ = at;
    }
}

Done LoopCarrier::copy_edge(uint32_t from, uint32_t to, bool reversed) {
    for (uint32_t i = head_[from]; i != NONE;) {
        const Entry entry = entries_[i]; // the array may move
        if (!add(to, entry.loop, entry.count, reversed ? -entry.signed_count : entry.signed_count)) return false;
        i = entry.next;
    }
    return true;
}

Done LoopCarrier::unflip_edge(uint32_t edge) {
    const uint32_t h = 2 * edge, t = twin(h);
    const uint32_t a = next_[h], b = next_[a], c = next_[t], d = next_[c];
    const uint32_t around[5] = {edge, edge_of(a), edge_of(b), edge_of(c), edge_of(d)};
    bool any = false;
    for (uint32_t e : around) any |= head_[e] != NONE;
    if (!any) {
        unflip_sides(next_.data(), edge);
        return true;
    }
    scratch_.clear();
    for (uint32_t e : around)
        for (uint32_t i = head_[e]; i != NONE; i = entries_[i].next) {
            bool known = false;
            for (const Entry& entry : scratch_) known |= entry.loop == entries_[i].loop;
            if (!known && !scratch_.push({edge, entries_[i].loop, 0, 0, NONE})) return false;
        }
    // After the reversal h is followed by d and a (as seen from the right, see mesh.hpp).
    unflip_sides(next_.data(), edge);
    const uint32_t left[2] = {next_[h], next_[next_[h]]};
    for (Entry& entry : scratch_) {
        const auto count = [&](uint32_t e) -> int64_t {
            const Entry* f = find(e, entry.loop);
            return f ? f->count : 0;
        };
        const auto flow = [&](uint32_t side) -> int32_t { // out of the triangle of the side
            const Entry* f = find(edge_of(side), entry.loop);
            return f ? (side & 1u ? -f->signed_count : f->signed_count) : 0;
        };
        const int64_t ac = count(edge_of(a)) + count(edge_of(c)), bd = count(edge_of(b)) + count(edge_of(d));
        entry.count = static_cast<uint32_t>(std::max(ac, bd) - count(edge));
        entry.signed_count = -flow(left[0]) - flow(left[1]); // as much goes in as goes out
    }
    drop_edge(edge);
    for (const Entry& entry : scratch_)
        if ((entry.count || entry.signed_count) && !add(edge, entry.loop, entry.count, entry.signed_count))
            return false;
    return true;
}

Done LoopCarrier::refine(Call& call) {
    const Level& finer = hierarchy_->levels[level_ - 1];
    if (!call.tick(0, true)) return false;
    std::memcpy(next_.data(), mesh().next, size_t{2} * mesh().edge_count * sizeof(uint32_t));
    for (size_t i = finer.flip_end; i-- > finer.flip_begin;) {
        if (i % 16384 == 0 && !call.tick(0, true)) return false;
        if (!unflip_edge(hierarchy_->flips[i])) return false;
    }
    // The entries of the edges that have come, which had none; in order, as those of one come from another.
    for (size_t i = finer.collapse_end; i-- > finer.collapse_begin;) {
        if (i % 16384 == 0 && !call.tick(0, true)) return false;
        constexpr size_t ahead = 16;
        const Collapse* const log = hierarchy_->collapses;
        if (i >= finer.collapse_begin + ahead) {
            prefetch(&head_[edge_of(log[i - ahead].ki)]);
            prefetch(&head_[edge_of(log[i - ahead].il)]);
        }
        const Collapse& c = log[i];
        // ki and jk both lead to or from k: k -> i beside j -> k; i -> l beside l -> j.
        if (!copy_edge(edge_of(c.ki), edge_of(c.jk), !((c.ki ^ c.jk) & 1u))
            || !copy_edge(edge_of(c.il), edge_of(c.lj), !((c.il ^ c.lj) & 1u)))
            return false;
    }
    --level_;
    return true;
}

Done LoopCarrier::read(size_t first, size_t last, Loops& out, Call& call) {
    if (!out.start(call.memory)) return false;
    // One loop after another, each from its crossing numbers.
    const Mesh& mesh = mesh_of(level_);
    Array<uint32_t> edge, begin; // of all loops, sorted by loop
    if (!begin.allocate_filled(call.memory, loop_count_ + 2, 0u) || !edge.allocate(call.memory, entries_.size()))
        return false;
    for (const Entry& entry : entries_)
        if (entry.loop != NONE) ++begin[entry.loop + 2];
    for (size_t c = 0; c < loop_count_; ++c) begin[c + 2] += begin[c + 1];
    for (const Entry& entry : entries_)
        if (entry.loop != NONE) edge[begin[entry.loop + 1]++] = entry.edge;
    for (size_t c = first; c < last; ++c) {
        curve_.clear();
        heap_sort(edge.data() + begin[c], begin[c + 1] - begin[c], [](uint32_t a, uint32_t b) { return a < b; });
        uint32_t oriented = NONE;
        for (uint32_t i = begin[c]; i < begin[c + 1]; ++i) {
            const Entry& entry = *find(edge[i], static_cast<uint32_t>(c));
            if (oriented == NONE && entry.signed_count) oriented = edge[i];
            curve_.count[edge[i]] = entry.count;
            curve_.total += entry.count;
            if (entry.count && !curve_.edges.push(edge[i])) return false;
        }
        if (!curve_.trace(mesh, call)) return false;
        int64_t sum = 0;
        for (uint32_t h : curve_.components.crossings)
            if (edge_of(h) == oriented) sum += h & 1u ? -1 : 1;
        const bool reversed = oriented != NONE && sum != find(oriented, static_cast<uint32_t>(c))->signed_count;
        const size_t n = curve_.components.crossings.size();
        for (size_t i = 0; i < n; ++i)
            if (!out.crossings.push(reversed ? twin(curve_.components.crossings[n - 1 - i])
                                             : curve_.components.crossings[i]))
                return false;
        if (!out.offsets.push(out.crossings.size())) return false;
    }
    return true;
}

} // namespace hmf
