#include "sweep_matrix.hpp"

#include <cmath>

#include "../base/prefetch.hpp"
#include "../base/sort_few.hpp"

namespace hmf {

namespace {

constexpr uint32_t no_row = 0xffffffffu;
// Rows with more entries are on the border: otherwise all of their neighbours would be.
constexpr uint32_t widest_inner_row = 48;
constexpr uint32_t places_of_bin = 64;
// The rows of the matrix are met in no order: their memory is asked for ahead.
constexpr uint32_t ahead = 8;

void prefetch_row(const SignedMatrix& matrix, uint32_t i) {
    prefetch(&matrix.column[matrix.offset[i]]);
    prefetch(&matrix.entry[matrix.offset[i]]);
}

} // namespace

// --- Order -------------------------------------------------------------------

// Where a row lies.  A mesh has its coarse vertices first, and those of each level in
// an order in space.  Most vertices are of the last level, and nearly every other one has a
// neighbour of it, or a neighbour that has: two steps to the last neighbour lead there.
static Done find_places(const SignedMatrix& matrix, Array<uint32_t>& place, const Parallel& parallel, Memory& memory) {
    Array<uint32_t> last;
    if (!last.allocate(memory, matrix.n) || !place.allocate(memory, matrix.n)) return false;
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            uint32_t largest = static_cast<uint32_t>(i);
            for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k)
                largest = matrix.column[k] > largest ? matrix.column[k] : largest;
            last[i] = largest;
        }
    });
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) place[i] = last[last[i]];
    });
    return true;
}

// The part that most of the neighbours of row i are in, and the row itself.
static uint8_t most_common(const SignedMatrix& matrix, const uint8_t* part, size_t i) {
    const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
    const uint8_t own = part[i];
    uint8_t other = 0;
    for (uint32_t k = begin; k < end; ++k) other |= part[matrix.column[k]] ^ own;
    if (other == 0 || end - begin > widest_inner_row) return own;
    uint8_t best = own;
    uint32_t most = 0;
    for (uint32_t k = begin; k <= end; ++k) {
        const uint8_t candidate = k == begin ? own : part[matrix.column[k - 1]];
        uint32_t count = candidate == own;
        for (uint32_t t = begin; t < end; ++t) count += part[matrix.column[t]] == candidate;
        if (count <= most) continue;
        most = count;
        best = candidate;
    }
    return best;
}

// Parts without the border: about equally many rows each, by their places.
Done SweepMatrix::share_rows(const SignedMatrix& matrix, Array<uint8_t>& own, const Parallel& parallel,
                             Memory& memory) const {
    const uint32_t n = matrix.n;
    Array<uint32_t> place, bin;
    Array<uint8_t> ragged;
    if (!find_places(matrix, place, parallel, memory) || !ragged.allocate(memory, n) || !own.allocate(memory, n)
        || !bin.allocate_filled(memory, n / places_of_bin + size_t{1}, 0))
        return false;
    for (const uint32_t p : place) ++bin[p / places_of_bin];
    uint64_t before = 0;
    for (uint32_t& b : bin) {
        const uint64_t count = b;
        b = static_cast<uint32_t>(before * parts_ / n);
        before += count;
    }
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const bool wide = matrix.offset[i + 1] - matrix.offset[i] > widest_inner_row;
            ragged[i] = static_cast<uint8_t>(wide ? parts_ : bin[place[i] / places_of_bin]);
        }
    });
    // Straighter: on meshes a third less border.
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) own[i] = most_common(matrix, ragged.data(), i);
    });
    return true;
}

uint32_t SweepMatrix::parts_of(uint32_t n) {
    const uint32_t small = n / rows_of_small_part, large = n / rows_of_part;
    const uint32_t parts = small < enough_parts ? small : large > enough_parts ? large : enough_parts;
    return parts < 1 ? 1 : parts < most_parts ? parts : most_parts;
}

// The part of each row, and room[i] groups for it, enough in any case.
Done SweepMatrix::cut(const SignedMatrix& matrix, Array<uint8_t>& room, const Parallel& parallel, Memory& memory) {
    const uint32_t n = matrix.n;
    parts_ = parts_of(n);
    Array<uint8_t> own;
    if (!part_.allocate(memory, n) || !room.allocate(memory, n)
        || !(parts_ > 1 ? share_rows(matrix, own, parallel, memory) : own.allocate_filled(memory, n, 0)))
        return false;
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            uint8_t least = own[i];
            uint32_t before = 0;
            for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
                const uint32_t j = matrix.column[k];
                least = own[j] < least ? own[j] : least;
                before += own[j] == own[i] && j < i;
            }
            const bool border = least < own[i] || own[i] == parts_;
            part_[i] = border ? static_cast<uint8_t>(parts_) : own[i];
            if (border) before = matrix.offset[i + 1] - matrix.offset[i];
            const uint32_t groups = (before + Group::size - (before > 0)) / Group::size;
            room[i] = static_cast<uint8_t>(groups < no_room ? groups : no_room);
        }
    });
    return true;
}

// --- Entries -----------------------------------------------------------------

inline void SweepMatrix::Group::clear(uint32_t i) {
    for (uint32_t t = 0; t < size; ++t) {
        column[t] = i;
        entry[t] = 0;
    }
}

// Which of the rows that touch row i come before it in a sweep: of its part, or where it is on the border.
template <bool on_border>
struct Before {
    const uint8_t* part;
    uint32_t i;
    uint8_t own;
    bool operator()(uint32_t j) const { return on_border ? (part[j] != own) | (j < i) : (part[j] == own) & (j < i); }
};

// at: its place; end: that of its part.  Returns the place of the next row.
template <class Before>
SweepMatrix::Group* SweepMatrix::write_row(const SignedMatrix& matrix, const float* scale, Before before, Group* at,
                                           const Group* end) {
    const uint32_t i = before.i;
    const double own = static_cast<double>(scale[i]);
    const Group* const begin = at;
    at->clear(i);
    uint32_t used = 0;
    for (uint32_t k = matrix.offset[i], last = matrix.offset[i + 1]; k < last; ++k) {
        const uint32_t j = matrix.column[k];
        const double value = matrix.entry[k] * own * static_cast<double>(scale[j]);
        // All are written, and the next one over those that do not come before.
        at->column[used] = j;
        // Smaller ones would only make slow subnormal numbers.
        at->entry[used] = std::fabs(value) > 1e-20 ? static_cast<float>(value) : 0.0f;
        used += before(j);
        if (used < Group::size) continue;
        at->row = i;
        used = 0;
        if (++at == end) return at; // what is left does not come before
        at->clear(i);
    }
    if (used == 0 && at != begin) return at;
    at->row = i;
    at->column[used] = i;
    at->entry[used] = 0;
    return at + 1;
}

// Row i of a part, at its place.  Returns the place of the next row.
inline SweepMatrix::Group* SweepMatrix::write_row_of(const SignedMatrix& matrix, const float* scale, uint32_t part,
                                                     uint32_t i, Group* at) {
    const Group* const end = group_.data() + range_[part].end;
    const uint8_t* const parts = part_.data();
    const uint8_t own = static_cast<uint8_t>(part);
    return part == parts_ ? write_row(matrix, scale, Before<true>{parts, i, own}, at, end)
                          : write_row(matrix, scale, Before<false>{parts, i, own}, at, end);
}

Done SweepMatrix::build(const SignedMatrix& matrix, const float* scale, const Parallel& parallel, Memory& memory) {
    const uint32_t n = matrix.n;
    Array<uint8_t> room;
    Array<uint32_t> order; // of the rows in a sweep
    if (!cut(matrix, room, parallel, memory) || !order.allocate(memory, n) || !range_.allocate(memory, parts_ + 1))
        return false;
    uint32_t at[most_parts + 2];
    if (!sort_by_few(
            n, parts_ + 1, [&](uint32_t i) { return part_[i]; }, order.data(), at, parallel, memory))
        return false;
    uint64_t groups[most_parts + 1] = {0};
    parallel.for_each(parts_ + 1, [&](uint32_t part, uint32_t) {
        groups[part] = 0;
        for (uint32_t k = at[part]; k < at[part + 1]; ++k) {
            const uint32_t i = order[k];
            groups[part] += room[i] < no_room ? room[i] : (matrix.offset[i + 1] - matrix.offset[i]) / Group::size + 1;
        }
    });
    room.release();
    uint64_t total = 1;
    Range* const range = range_.data();
    for (uint32_t part = 0; part <= parts_; ++part) {
        range[part].begin = static_cast<uint32_t>(total);
        total += groups[part] + 1; // one that belongs to no row
        range[part].end = static_cast<uint32_t>(total - 1);
    }
    if (total > 0xf0000000u) {
        memory.take(SIZE_MAX);
        return false;
    }
    if (!group_.allocate(memory, total)) return false;
    for (uint32_t part = 0; part <= parts_; ++part) group_[range[part].begin - 1].row = no_row;
    parallel.for_each(parts_ + 1, [&](uint32_t part, uint32_t) {
        const uint32_t last = at[part + 1];
        Group* end = group_.data() + range_[part].begin;
        for (uint32_t k = at[part]; k < last; ++k) {
            if (last - k > ahead) prefetch_row(matrix, order[k + ahead]);
            end = write_row_of(matrix, scale, part, order[k], end);
        }
        end->row = no_row;
        range[part].end = static_cast<uint32_t>(end - group_.data());
    });
    return true;
}

void SweepMatrix::refresh(const SignedMatrix& matrix, const float* scale, const uint8_t* changed,
                          const Parallel& parallel) {
    parallel.for_each(parts_ + 1, [&](uint32_t part, uint32_t) {
        const Group* const end = group_.data() + range_[part].end;
        for (Group* at = group_.data() + range_[part].begin; at != end;) {
            Group* next = at;
            do ++next;
            while (next->row == at->row);
            if (changed[at->row]) {
                const Group kept = *next; // a row that fills its groups clears the one after them
                write_row_of(matrix, scale, part, at->row, at);
                *next = kept;
            }
            at = next;
        }
    });
}

// --- Sweeps ------------------------------------------------------------------

// Sum of entry * x.
inline float SweepMatrix::Group::product(const float* x) const {
    static_assert(size == 5, "written out here");
    return ((entry[0] * x[column[0]] + entry[1] * x[column[1]]) + (entry[2] * x[column[2]] + entry[3] * x[column[3]]))
         + entry[4] * x[column[4]];
}

// y -= value times the entries, which are as well those of the column `row`.
inline void SweepMatrix::Group::subtract(float value, float* y) const {
    for (uint32_t t = 0; t < size; ++t) y[column[t]] -= entry[t] * value;
}

// row(i, begin, end) for the rows of a part and their groups, in order.
template <class Row>
void SweepMatrix::for_rows(uint32_t part, Row row) const {
    const Group* const end = group_.data() + range_[part].end;
    for (const Group* at = group_.data() + range_[part].begin; at != end;) {
        const Group* const begin = at;
        do ++at;
        while (at->row == begin->row);
        row(begin->row, begin, at);
    }
}

void SweepMatrix::forward(const float* b, float* x, float* residual, const Parallel& parallel) const {
    // From zero: what is left is the product with the entries that come after each row.
    const auto sweep = [&](uint32_t part, uint32_t = 0) {
        const Group* const end = group_.data() + range_[part].end;
        for (const Group* at = group_.data() + range_[part].begin; at != end;) {
            const Group* const begin = at;
            const uint32_t i = at->row;
            float sum = 0;
            do sum += at->product(x);
            while ((++at)->row == i);
            const float value = b[i] - sum;
            x[i] = value;
            residual[i] = 0;
            for (const Group* group = begin; group != at; ++group) group->subtract(value, residual);
        }
    };
    parallel.for_each(parts_, sweep);
    sweep(parts_);
}

void SweepMatrix::backward(float* b, float* x, const Parallel& parallel) const {
    const auto sweep = [&](uint32_t part, uint32_t = 0) {
        const Group* const begin = group_.data() + range_[part].begin;
        for (const Group* at = group_.data() + range_[part].end; at != begin;) {
            const Group* const end = at;
            const uint32_t i = (at - 1)->row;
            float sum = 0;
            do sum += (--at)->product(x);
            while ((at - 1)->row == i);
            const float value = b[i] - sum;
            x[i] = value;
            for (const Group* group = at; group != end; ++group) group->subtract(value, b);
        }
    };
    sweep(parts_);
    parallel.for_each(parts_, sweep);
}

void SweepMatrix::multiply(const float* x, float* y, const Parallel& parallel) const {
    const auto rows = [&](uint32_t part, uint32_t = 0) {
        for_rows(part, [&](uint32_t i, const Group* begin, const Group* end) {
            float sum = 0;
            for (const Group* group = begin; group != end; ++group) { sum += group->product(x); }
            y[i] = x[i] + sum;
            for (const Group* group = begin; group != end; ++group) group->subtract(-x[i], y);
        });
    };
    parallel.for_each(parts_, rows);
    rows(parts_);
}

double SweepMatrix::energy(const float* x, const Parallel& parallel) const {
    double part_sum[most_parts + 1];
    parallel.for_each(parts_ + 1, [&](uint32_t part, uint32_t) {
        double sum = 0;
        for_rows(part, [&](uint32_t i, const Group* begin, const Group* end) {
            float product = 0;
            for (const Group* group = begin; group != end; ++group) product += group->product(x);
            sum += static_cast<double>(x[i]) * (static_cast<double>(x[i]) + 2 * static_cast<double>(product));
        });
        part_sum[part] = sum;
    });
    double sum = 0;
    for (uint32_t part = 0; part <= parts_; ++part)
        sum += part_sum[part]; // NOLINT(clang-analyzer-core*): each part set its own
    return sum;
}

} // namespace hmf
