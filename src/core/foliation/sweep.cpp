#include "sweep.hpp"

#include "../base/sort_few.hpp"

#include <algorithm>

namespace hmf {

namespace {

// In the word of a vertex: its block, and above that the rounds.
constexpr uint32_t BLOCK_BITS = 8;
constexpr uint32_t outside_in(uint32_t round) { return uint32_t{1} << (BLOCK_BITS + round); }

} // namespace

Done Sweeps::prepare(const Foliation& f, const Rings& rings, uint32_t coarser_count, Call& call) {
    const uint32_t n = f.mesh.vertex_count;
    block_count_ = std::min(n / SMALLEST_BLOCK, MOST_BLOCKS);
    // What hangs in a monogon moves along from elsewhere.
    if (block_count_ < 2 || !rings.monogons.vertex.empty()) {
        block_count_ = 1;
        return true;
    }
    if (!inside_.allocate(call.memory, n) || !order_.allocate(call.memory, n) || !waiting_.allocate(call.memory, n))
        return false;
    for (Task& task : task_)
        if (!task.foliation.share(f, inside_.data(), call.memory) || !task.star.allocate(call.memory, rings.max_degree))
            return false;
    plan_rounds();
    uint32_t* const block = waiting_.data(); // not needed before the first sweep
    find_blocks(rings, coarser_count, block, call.parallel);
    call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            uint32_t other = 0; // bits in which the blocks of neighbors differ
            for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t)
                other |= block[rings.neighbor[t]] ^ block[v];
            if (block[v] == NONE) other = NONE;
            uint32_t word = block[v] & (outside_in(0) - 1);
            for (uint32_t r = 0; other && r < round_count_; ++r) word |= other >> round_[r].shift ? outside_in(r) : 0;
            inside_[v] = word;
        }
    });
    return sort_by_few(
        n, list_count_ + 1, [&](uint32_t v) { return list_of(v); }, order_.data(), begin_, call.parallel, call.memory);
}

// Four blocks at a time, or two of the last ones.
void Sweeps::plan_rounds() {
    list_count_ = 0;
    round_count_ = 0;
    const uint32_t last = block_count_ - 1;
    for (uint32_t shift = 0; last >> shift > 0; shift += last >> (shift + 2) > 0 ? 2 : 1) {
        const uint32_t count = (last >> shift) + 1;
        round_[round_count_++] = {shift, count, list_count_};
        list_count_ += count;
    }
}

// Vertices of the finer level by number; each other vertex goes with a neighbor that has a block.
void Sweeps::find_blocks(const Rings& rings, uint32_t coarser_count, uint32_t* block, const Parallel& parallel) {
    constexpr int most_passes = 8; // what is further from a vertex of the finer level has no block
    const uint32_t n = static_cast<uint32_t>(inside_.size()), first = coarser_count < n ? coarser_count : 0;
    uint32_t* const other = inside_.data(); // not needed yet
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v)
            other[v] = block[v] = v < first ? NONE : static_cast<uint32_t>((v - first) * block_count_ / (n - first));
    });
    const uint32_t* from = other;
    uint32_t left = first;
    for (int pass = 0; pass < most_passes && left > 0; ++pass) {
        uint32_t* const to = from == other ? block : other;
        left = parallel.sum_blocks<uint32_t>(first, [&](size_t begin, size_t end) {
            uint32_t without = 0;
            for (size_t v = begin; v < end; ++v) {
                uint32_t own = from[v];
                for (uint32_t t = rings.offset[v]; own == NONE && t < rings.offset[v + 1]; ++t)
                    own = from[rings.neighbor[t]];
                to[v] = own;
                without += own == NONE;
            }
            return without;
        });
        from = to;
    }
    if (from == other) parallel.copy(block, from, first);
}

// That of the first round in which it is inside of a block.
uint32_t Sweeps::list_of(uint32_t vertex) const {
    const uint32_t word = inside_.data()[vertex];
    for (uint32_t r = 0; r < round_count_; ++r)
        if (!(word & outside_in(r))) return round_[r].list + ((word & (outside_in(0) - 1)) >> round_[r].shift);
    return list_count_;
}

// From task.next on. False: it walked far around clusters, and is not done.
bool Sweeps::sweep_block(uint32_t round, uint32_t block, Task& task, const Rings& rings, const double* weight,
                         bool backward, SweepResult& result) {
    const uint32_t shift = round_[round].shift, own = round_[round].list + block, begin = begin_[own];
    const List list{&order_[begin], begin_[own + 1] - begin, backward};
    task.foliation.block = block << shift;
    task.foliation.mask = outside_in(round) | ((outside_in(0) - 1) >> shift << shift);
    uint32_t& waiting = waits_[own];
    task.foliation.walked = 0;
    for (uint32_t& i = task.next; i < list.size; ++i) {
        if (task.foliation.walked > MOST_WALKED) return false;
        if (list.size - i > Rings::AHEAD) rings.prefetch_star(task.foliation.value, weight, list[i + Rings::AHEAD]);
        task.foliation.outside = false;
        relax_vertex(task.foliation, rings, weight, list[i], task.star, result);
        if (task.foliation.outside) waiting_[begin + waiting++] = list[i];
    }
    return true;
}

Done Sweeps::sweep_round(uint32_t round, Foliation& f, const Rings& rings, const double* weight, bool backward,
                         const Star& star, SweepResult& result, Call& call, double fraction) {
    const uint32_t blocks = round_[round].count;
    for (uint32_t first = 0; first < blocks; first += BLOCKS_AT_ONCE) {
        const uint32_t count = std::min(BLOCKS_AT_ONCE, blocks - first);
        SweepResult part[BLOCKS_AT_ONCE];
        bool is_done[BLOCKS_AT_ONCE] = {};
        const auto block = [&](uint32_t k) { return backward ? blocks - 1 - first - k : first + k; };
        for (uint32_t k = 0; k < count; ++k) {
            // Stamps of one block do not meet those of another one.
            task_[k].foliation.epoch = f.epoch;
            task_[k].star.budget = star.budget;
            task_[k].next = waits_[round_[round].list + block(k)] = 0;
        }
        Done goes_on = true;
        while (std::count(is_done, is_done + count, true) < count) {
            goes_on = call.tick(fraction, true);
            if (!goes_on) break;
            call.parallel.for_each(count, [&](uint32_t k, uint32_t) {
                if (!is_done[k]) is_done[k] = sweep_block(round, block(k), task_[k], rings, weight, backward, part[k]);
            });
        }
        for (uint32_t k = 0; k < count; ++k) {
            result += part[k];
            f.epoch = std::max(f.epoch, task_[k].foliation.epoch);
        }
        if (!goes_on) return false;
    }
    return true;
}

Done Sweeps::sweep_list(List list, Foliation& f, const Rings& rings, const double* weight, Star& star,
                        SweepResult& result, Call& call, double fraction) {
    for (uint32_t i = 0; i < list.size; ++i) {
        if (i % 256 == 0 && !call.work(8192 + 8 * f.take_walked(), fraction)) return false;
        if (list.size - i > Rings::AHEAD) rings.prefetch_star(f.value, weight, list[i + Rings::AHEAD]);
        relax_vertex(f, rings, weight, list[i], star, result);
    }
    return true;
}

void Sweeps::sweep(Foliation& f, const Rings& rings, const double* weight, bool backward, Star& star,
                   SweepResult& result, Call& call, double fraction) {
    if (block_count_ == 1) {
        const uint32_t n = f.mesh.vertex_count;
        for (uint32_t i = 0; i < n; ++i) {
            if (i % 256 == 0 && !call.work(8192 + 8 * f.take_walked(), fraction)) return;
            if (n - i > Rings::AHEAD)
                rings.prefetch_star(f.value, weight, backward ? n - 1 - i - Rings::AHEAD : i + Rings::AHEAD);
            relax_vertex(f, rings, weight, backward ? n - 1 - i : i, star, result);
        }
        return;
    }
    for (uint32_t round = 0; round < round_count_; ++round)
        if (!sweep_round(round, f, rings, weight, backward, star, result, call, fraction)) return;
    for (uint32_t k = 0; k < list_count_; ++k) {
        if (waits_[k] == 0) continue;
        const List waiting{&waiting_[begin_[k]], waits_[k], false};
        if (!sweep_list(waiting, f, rings, weight, star, result, call, fraction)) return;
    }
    const uint32_t others = begin_[list_count_];
    const List border{order_.data() + others, begin_[list_count_ + 1] - others, backward};
    (void)sweep_list(border, f, rings, weight, star, result, call, fraction);
}

} // namespace hmf
