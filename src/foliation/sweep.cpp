#include "sweep.hpp"

namespace hmf {

Done Sweeps::prepare(const Foliation& f, const Rings& rings, uint32_t coarser_count, Call& call) {
    const uint32_t n = f.mesh.vertex_count;
    block_count_ = std::min(n / smallest_block, most_blocks);
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
    uint32_t* const block = waiting_.data(); // not needed before the first sweep
    find_blocks(rings, coarser_count, block, call.parallel);
    call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            bool same = true;
            for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t)
                same &= block[rings.neighbour[t]] == block[v];
            inside_[v] = same ? block[v] : NONE;
        }
    });
    list_inside();
    return true;
}

// Those of the finer level by number, and the others with a neighbour of that level.
void Sweeps::find_blocks(const Rings& rings, uint32_t coarser_count, uint32_t* block, const Parallel& parallel) const {
    const uint32_t n = static_cast<uint32_t>(inside_.size()), first = coarser_count < n ? coarser_count : 0;
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            size_t from = v;
            for (uint32_t t = rings.offset[v]; from < first && t < rings.offset[v + 1]; ++t) from = rings.neighbour[t];
            block[v] = from < first ? NONE : static_cast<uint32_t>((from - first) * block_count_ / (n - first));
        }
    });
}

void Sweeps::list_inside() {
    const uint32_t n = static_cast<uint32_t>(inside_.size());
    const auto list_of = [&](uint32_t v) { return std::min(inside_[v], block_count_); };
    uint32_t at[most_blocks + 1] = {};
    for (uint32_t v = 0; v < n; ++v) ++at[list_of(v)];
    uint32_t sum = 0;
    for (uint32_t k = 0; k <= block_count_; ++k) {
        begin_[k] = sum;
        sum += at[k];
        at[k] = begin_[k];
    }
    begin_[block_count_ + 1] = sum;
    for (uint32_t v = 0; v < n; ++v) order_[at[list_of(v)]++] = v;
}

void Sweeps::sweep_block(uint32_t block, Task& task, const Rings& rings, const double* weight, bool backward,
                         SweepResult& result) {
    const uint32_t begin = begin_[block];
    const List list{&order_[begin], begin_[block + 1] - begin, backward};
    task.foliation.block = block;
    uint32_t waiting = 0;
    for (uint32_t i = 0; i < list.size; ++i) {
        if (list.size - i > Rings::ahead) rings.prefetch_star(task.foliation.value, weight, list[i + Rings::ahead]);
        task.foliation.outside = false;
        relax_vertex(task.foliation, rings, weight, list[i], task.star, result);
        if (task.foliation.outside) waiting_[begin + waiting++] = list[i];
    }
    waits_[block] = waiting;
}

Done Sweeps::sweep_inside(Foliation& f, const Rings& rings, const double* weight, bool backward, const Star& star,
                          SweepResult& result, Call& call, double fraction) {
    for (uint32_t first = 0; first < block_count_; first += blocks_at_once) {
        if (!call.tick(fraction, true)) return false;
        const uint32_t count = std::min(blocks_at_once, block_count_ - first), epoch = f.epoch;
        SweepResult part[blocks_at_once];
        call.parallel.for_each(count, [&](uint32_t k, uint32_t) {
            Task& task = task_[k];
            // Stamps of one block do not meet those of another one.
            task.foliation.epoch = epoch;
            task.star.budget = star.budget;
            sweep_block(backward ? block_count_ - 1 - first - k : first + k, task, rings, weight, backward, part[k]);
        });
        for (uint32_t k = 0; k < count; ++k) {
            result += part[k];
            f.epoch = std::max(f.epoch, task_[k].foliation.epoch);
        }
    }
    return true;
}

Done Sweeps::sweep_list(List list, Foliation& f, const Rings& rings, const double* weight, Star& star,
                        SweepResult& result, Call& call, double fraction) {
    for (uint32_t i = 0; i < list.size; ++i) {
        if (i % 8192 == 0 && !call.tick(fraction, true)) return false;
        if (list.size - i > Rings::ahead) rings.prefetch_star(f.value, weight, list[i + Rings::ahead]);
        relax_vertex(f, rings, weight, list[i], star, result);
    }
    return true;
}

void Sweeps::sweep(Foliation& f, const Rings& rings, const double* weight, bool backward, Star& star,
                   SweepResult& result, Call& call, double fraction) {
    if (block_count_ == 1) {
        const uint32_t n = f.mesh.vertex_count;
        for (uint32_t i = 0; i < n; ++i) {
            if (i % 8192 == 0 && !call.tick(fraction, true)) return;
            if (n - i > Rings::ahead)
                rings.prefetch_star(f.value, weight, backward ? n - 1 - i - Rings::ahead : i + Rings::ahead);
            relax_vertex(f, rings, weight, backward ? n - 1 - i : i, star, result);
        }
        return;
    }
    if (!sweep_inside(f, rings, weight, backward, star, result, call, fraction)) return;
    for (uint32_t k = 0; k < block_count_; ++k) {
        const List waiting{&waiting_[begin_[k]], waits_[k], false};
        if (!sweep_list(waiting, f, rings, weight, star, result, call, fraction)) return;
    }
    const uint32_t others = begin_[block_count_];
    const List border{order_.data() + others, begin_[block_count_ + 1] - others, backward};
    (void)sweep_list(border, f, rings, weight, star, result, call, fraction);
}

} // namespace hmf
