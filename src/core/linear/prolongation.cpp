#include "prolongation.hpp"

namespace hmf {

Done Prolongation::share(const Array<uint32_t>& of, const Parallel& parallel, Memory& memory) {
    const size_t count = start.size() - 1;
    if (!own_end_.allocate(memory, count)) return false;
    const size_t size = block(), blocks = (count + size - 1) / size;
    parallel.for_blocks(count, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            uint32_t at = start[c], last = start[c + 1];
            while (at < last) {
                const uint32_t owner = of[row[at]];
                if (owner >= begin && owner < end) {
                    ++at;
                    continue;
                }
                --last;
                std::swap(row[at], row[last]);
                std::swap(entry[at], entry[last]);
            }
            own_end_[c] = at;
        }
    });
    if (!other_start_.allocate_filled(memory, blocks + 1, 0)) return false;
    for (size_t c = 0; c < count; ++c)
        for (uint32_t t = own_end_[c]; t < start[c + 1]; ++t) ++other_start_[of[row[t]] / size];
    uint32_t sum = 0;
    for (uint32_t& s : other_start_) s = sum += s;
    if (!other_.allocate(memory, sum)) return false;
    for (size_t c = count; c-- > 0;)
        for (uint32_t t = start[c + 1]; t-- > own_end_[c];)
            other_[--other_start_[of[row[t]] / size]] = {static_cast<uint32_t>(c), t};
    return true;
}

void Prolongation::scale(const float* coarse, const float* fine, const Parallel& parallel) {
    parallel.for_blocks(columns(), [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c)
            for (uint32_t t = start[c]; t < start[c + 1]; ++t) entry[t] *= coarse[c] / fine[row[t]];
    });
}

void Prolongation::renumber(const SweepMatrix& fine, const Parallel& parallel) {
    parallel.for_blocks(row.size(), [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) row[t] = fine.number(row[t]);
    });
}

void Prolongation::restrict_to(float* coarse, const float* fine, float floor, const SweepMatrix* next,
                               const Parallel& parallel) const {
    parallel.for_blocks(columns(), [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            float sum = floor;
            for (uint32_t t = start[c]; t < start[c + 1]; ++t) sum += entry[t] * fine[row[t]];
            coarse[next ? next->number(c) : c] = sum;
        }
    });
}

void Prolongation::add_to(float* fine, const float* coarse, const SweepMatrix* next, const Parallel& parallel) const {
    const size_t size = block();
    const auto at = [=](size_t c) { return coarse[next ? next->number(c) : c]; };
    parallel.for_blocks(columns(), [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            const float x = at(c);
            for (uint32_t t = start[c]; t < own_end_[c]; ++t) fine[row[t]] += entry[t] * x;
        }
        const size_t own = begin / size;
        for (uint32_t k = other_start_[own]; k < other_start_[own + 1]; ++k) {
            const Other& o = other_[k];
            fine[row[o.at]] += entry[o.at] * at(o.column);
        }
    });
}

} // namespace hmf
