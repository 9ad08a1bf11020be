#include "sweep_matrix.hpp"

#include <cmath>

#include "../base/prefetch.hpp"
#include "../base/sort_few.hpp"

namespace hmf {

namespace {

// Rows with more entries are on the border: otherwise all of their neighbors would be.
constexpr uint32_t WIDEST_INNER_ROW = 48;
// The rows of the matrix are read in no order, so their memory is prefetched.
constexpr uint32_t SWEEP_AHEAD = 8;

void prefetch_row(const SignedMatrix& matrix, uint32_t i) {
    prefetch(&matrix.column[matrix.offset[i]]);
    prefetch(&matrix.entry[matrix.offset[i]]);
}

// The place of a row. A mesh has its coarse vertices first, and those of each level in an order in space. Most vertices
// belong to the last level, and nearly every other vertex has a neighbor of that level, or a neighbor that has one: two
// steps to the last neighbor lead there.
Done find_places(const SignedMatrix& matrix, Array<uint32_t>& place, const Parallel& parallel, Memory& memory) {
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

} // namespace

// --- Order -------------------------------------------------------------------

// While the entries are written.
struct SweepMatrix::Order {
    static constexpr uint32_t ON_BORDER = 0x80000000u;
    Array<uint32_t> row;         // of the matrix, by number; empty: the number
    Array<uint32_t> code;        // of each row of the matrix: its number, and whether it is on the border
    Array<uint8_t> kind;         // of each row of the matrix
    Array<uint8_t> lower, upper; // groups of each row of the matrix; no_room: that many or more
    bool all_inner = true;

    uint32_t row_of(uint32_t k) const { return row.empty() ? k : row.data()[k]; }
};

// By places, but in the original order for rows that are close together.
Done SweepMatrix::list_in_space(const SignedMatrix& matrix, Order& order, const Parallel& parallel,
                                Memory& memory) const {
    constexpr uint32_t least_width = 64, most_bins = 8192;
    const uint32_t n = matrix.n, width = n / most_bins < least_width ? least_width : n / most_bins + 1;
    Array<uint32_t> place, begin;
    if (!find_places(matrix, place, parallel, memory) || !order.row.allocate(memory, n)
        || !begin.allocate(memory, n / width + size_t{2})
        || !sort_by_few(
            n, n / width + 1, [&](uint32_t i) { return place[i] / width; }, order.row.data(), begin.data(), parallel,
            memory))
        return false;
    parallel.for_blocks(n, [&](size_t first, size_t end) {
        for (size_t k = first; k < end; ++k) order.code[order.row[k]] = static_cast<uint32_t>(k);
    });
    return true;
}

// Hubs are on the border whatever part they are in, and what touches one need not be.
void SweepMatrix::set_kinds(const SignedMatrix& matrix, Order& order, const Parallel& parallel) const {
    const bool fits = shift_ <= NARROW_BITS || matrix.n <= 1u << NARROW_BITS;
    const uint32_t *const offset = matrix.offset, *const code = order.code.data(), shift = shift_;
    uint8_t* const kind = order.kind.data();
    const auto is_hub = [=](uint32_t i) { return offset[i + size_t{1}] - offset[i] > WIDEST_INNER_ROW; };
    order.all_inner = parallel.sum_blocks<uint32_t>(matrix.n, [=, &matrix](size_t begin, size_t end) {
        uint32_t others = 0;
        for (uint32_t i = static_cast<uint32_t>(begin); i < end; ++i) {
            const uint32_t own = code[i] >> shift;
            uint32_t outside = 0, before = 0;
            // In one part there is nothing outside.
            for (uint32_t t = offset[i], last = parts_ > 1 ? offset[i + size_t{1}] : t; t < last; ++t) {
                const uint32_t part = code[matrix.column[t]] >> shift;
                outside |= part ^ own;
                before |= part < own;
            }
            if (before) {
                before = 0;
                for (uint32_t t = offset[i], last = offset[i + size_t{1}]; t < last; ++t)
                    before |= (code[matrix.column[t]] >> shift < own) & !is_hub(matrix.column[t]);
            }
            kind[i] = before || is_hub(i) ? border : outside || !fits ? fringe : inner;
            others += kind[i] != inner;
        }
        return others;
    }) == 0;
}

// By parts and kinds, in the order in which they are listed.
Done SweepMatrix::set_numbers(uint32_t n, Order& order, const Parallel& parallel, Memory& memory) {
    if (!segment_.allocate_filled(memory, kinds * size_t{parts_}, Segment{})) return false;
    if (order.row.empty() && order.all_inner) {
        // One part, or parts that do not touch each other.
        for (uint32_t part = 0; part < parts_; ++part) {
            const uint32_t begin = base(part), end = part + 1 < parts_ ? base(part + 1) : n;
            segment_[kinds * part].row = begin;
            segment_[kinds * part].rows = end - begin;
        }
        return true;
    }
    Array<uint32_t> listed = static_cast<Array<uint32_t>&&>(order.row);
    if (!number_.allocate(memory, n) || !order.row.allocate(memory, n)) return false;
    parallel.for_each(parts_, [&](uint32_t part, uint32_t) {
        const uint32_t begin = base(part), end = part + 1 < parts_ ? base(part + 1) : n;
        Segment* const segments = &segment_[kinds * part];
        uint32_t next[kinds] = {0, 0, 0};
        const auto row_at = [&](uint32_t k) { return listed.empty() ? k : listed.data()[k]; };
        for (uint32_t k = begin; k < end; ++k) ++next[order.kind[row_at(k)]];
        uint32_t at = begin;
        for (uint32_t kind = 0; kind < kinds; ++kind) {
            segments[kind].row = at;
            segments[kind].rows = next[kind];
            next[kind] = at;
            at += segments[kind].rows;
        }
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t i = row_at(k), to = next[order.kind[i]]++;
            order.row[to] = i;
            number_[i] = to;
        }
    });
    return true;
}

// Which rows come before row i in a sweep: in its part, or the whole inside if it is on the border.
struct SweepMatrix::Before {
    uint32_t number, shift;
    bool on_border;

    Before(uint32_t code, uint32_t part_shift) :
        number(code & ~Order::ON_BORDER), shift(part_shift), on_border(code & Order::ON_BORDER) {}
    bool operator()(uint32_t code) const {
        const uint32_t other = code & ~Order::ON_BORDER;
        const bool smaller = other < number;
        return on_border ? !(code & Order::ON_BORDER) | smaller : smaller & (other >> shift == number >> shift);
    }
};

uint32_t SweepMatrix::entries_before(const SignedMatrix& matrix, const Order& order, uint32_t i) const {
    const Before before(order.code.data()[i], shift_);
    uint32_t count = 0;
    for (uint32_t t = matrix.offset[i]; t < matrix.offset[i + 1]; ++t)
        count += before(order.code.data()[matrix.column[t]]);
    return count;
}

// How many groups each segment has, and room for them.
Done SweepMatrix::lay_out(const SignedMatrix& matrix, Order& order, const Parallel& parallel, Memory& memory) {
    const uint32_t n = matrix.n;
    const auto room = [](uint32_t entries) {
        const uint32_t count = groups_of(entries);
        return static_cast<uint8_t>(count < NO_ROOM ? count : NO_ROOM);
    };
    if (!order.lower.allocate(memory, n) || !order.upper.allocate(memory, n)) return false;
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (uint32_t i = static_cast<uint32_t>(begin); i < end; ++i) {
            const uint32_t before = entries_before(matrix, order, i);
            order.lower[i] = room(before);
            order.upper[i] = room(matrix.offset[i + 1] - matrix.offset[i] - before);
        }
    });
    parallel.for_each(kinds * parts_, [&](uint32_t s, uint32_t) {
        Segment& at = segment_[s];
        for (uint32_t k = at.row; k < at.row + at.rows; ++k) {
            const uint32_t i = order.row_of(k);
            uint32_t lower = order.lower.data()[i], upper = order.upper.data()[i];
            if (lower == NO_ROOM || upper == NO_ROOM) {
                const uint32_t before = entries_before(matrix, order, i);
                lower = groups_of(before);
                upper = groups_of(matrix.offset[i + 1] - matrix.offset[i] - before);
            }
            at.lower_end += lower;
            at.upper_end += upper;
        }
    });
    struct Count {
        uint64_t lower = 0, upper = 0;
    } total[2];
    uint32_t marks = 0;
    for (uint32_t s = 0; s < kinds * parts_; ++s) {
        Segment& at = segment_[s];
        Count& count = total[s % kinds != inner];
        const uint64_t lower = at.lower_end, upper = at.upper_end;
        at.lower = static_cast<uint32_t>(count.lower);
        at.upper = static_cast<uint32_t>(count.upper);
        count.lower += lower;
        count.upper += upper;
        at.lower_end = static_cast<uint32_t>(count.lower);
        at.upper_end = static_cast<uint32_t>(count.upper);
        at.mark = marks;
        marks += (at.rows + ROWS_OF_MARK - 1) / ROWS_OF_MARK;
    }
    for (const Count& count : total)
        if (count.lower > 0xf0000000u || count.upper > 0xf0000000u) {
            memory.take(SIZE_MAX);
            return false;
        }
    order.lower.release();
    order.upper.release();
    return narrow_.lower.allocate(memory, total[0].lower + 1) && narrow_.upper.allocate(memory, total[0].upper + 1)
        && wide_.lower.allocate(memory, total[1].lower + 1) && wide_.upper.allocate(memory, total[1].upper + 1)
        && mark_.allocate(memory, marks);
}

// --- Entries -----------------------------------------------------------------

// Smaller ones would only make slow subnormal numbers.
static float scaled(double value) { return std::fabs(value) > 1e-20 ? static_cast<float>(value) : 0.0f; }

// Entries of a row on one side of it that have no group yet; room for those of some more, and to fill up.
template <class Column>
struct SweepMatrix::Side {
    static constexpr uint32_t MORE = 32;
    Group<Column>* at;
    uint32_t used = 0;
    Column mark = 0;
    Column column[MORE + 2 * GROUP_SIZE] = {};
    float entry[MORE + 2 * GROUP_SIZE] = {};

    explicit Side(Group<Column>* begin) : at(begin) {}
    void begin_row() {
        used = 0;
        mark = Group<Column>::FIRST;
    }
    // All that there is; the last group is filled up.
    void write(uint32_t count, Column own) {
        for (uint32_t t = 0; t < GROUP_SIZE; ++t) {
            column[count + t] = own;
            entry[count + t] = 0;
        }
        uint32_t t = 0;
        do {
            std::memcpy(at->column, column + t, sizeof at->column);
            std::memcpy(at->entry, entry + t, sizeof at->entry);
            at->column[0] = static_cast<Column>(at->column[0] | mark);
            mark = 0;
            ++at;
            t += GROUP_SIZE;
        } while (t < count);
    }
    // Only whole groups, and something is left for the end of the row.
    void write_whole(Column own) {
        if (used <= GROUP_SIZE) return;
        const uint32_t whole = (used - 1) / GROUP_SIZE * GROUP_SIZE;
        Column last_column[GROUP_SIZE];
        float last_entry[GROUP_SIZE];
        std::memcpy(last_column, column + whole, sizeof last_column);
        std::memcpy(last_entry, entry + whole, sizeof last_entry);
        write(whole, own);
        std::memcpy(column, last_column, sizeof last_column);
        std::memcpy(entry, last_entry, sizeof last_entry);
        used -= whole;
    }
};

template <class Column>
void SweepMatrix::write_rows(const SignedMatrix& matrix, const float* scale, const Order& order, const Segment& at,
                             uint32_t first_column, Groups<Column>& groups) {
    Group<Column>*const lower_begin = groups.lower.data(), *const upper_begin = groups.upper.data();
    Side<Column> lower(lower_begin + at.lower), upper(upper_begin + at.upper);
    const uint32_t* const code = order.code.data();
    const uint32_t last_row = at.row + at.rows;
    for (uint32_t k = at.row; k < last_row; ++k) {
        if (last_row - k > SWEEP_AHEAD) prefetch_row(matrix, order.row_of(k + SWEEP_AHEAD));
        if ((k - at.row) % ROWS_OF_MARK == 0)
            mark_[at.mark + (k - at.row) / ROWS_OF_MARK] = {static_cast<uint32_t>(lower.at - lower_begin),
                                                            static_cast<uint32_t>(upper.at - upper_begin)};
        const uint32_t i = order.row_of(k);
        const Before before(code[i], shift_);
        const Column own = static_cast<Column>(k - first_column);
        const double own_scale = static_cast<double>(scale[i]);
        lower.begin_row();
        upper.begin_row();
        for (uint32_t t = matrix.offset[i], end = matrix.offset[i + 1];;) {
            const uint32_t stop = end - t > Side<Column>::MORE ? t + Side<Column>::MORE : end;
            uint32_t used_lower = lower.used, used_upper = upper.used;
            // Branch-free: an entry that does not belong to a side is written over by the next.
            for (; t < stop; ++t) {
                const uint32_t j = matrix.column[t], other = code[j];
                const float value = scaled(matrix.entry[t] * own_scale * static_cast<double>(scale[j]));
                const bool is_before = before(other);
                lower.column[used_lower] = upper.column[used_upper] =
                    static_cast<Column>((other & ~Order::ON_BORDER) - first_column);
                lower.entry[used_lower] = upper.entry[used_upper] = value;
                used_lower += is_before;
                used_upper += !is_before;
            }
            lower.used = used_lower;
            upper.used = used_upper;
            if (t == end) break;
            lower.write_whole(own);
            upper.write_whole(own);
        }
        lower.write(lower.used, own);
        upper.write(upper.used, own);
    }
}

Done SweepMatrix::build(const SignedMatrix& matrix, const float* scale, bool renumber, const Parallel& parallel,
                        Memory& memory) {
    const uint32_t n = matrix.n;
    shift_ = n < 2 * SMALL_PART ? 31 : n / SMALL_PART < ENOUGH_PARTS ? SMALL_PART_BITS : PART_BITS;
    while (n >> shift_ >= MOST_PARTS) ++shift_;
    parts_ = (n >> shift_) + 1;
    number_.release();
    Order order;
    if (!order.code.allocate(memory, n) || !order.kind.allocate(memory, n)) return false;
    if (renumber && parts_ > 1) {
        if (!list_in_space(matrix, order, parallel, memory)) return false;
    } else {
        parallel.for_blocks(n, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) order.code[i] = static_cast<uint32_t>(i);
        });
    }
    set_kinds(matrix, order, parallel);
    if (!set_numbers(n, order, parallel, memory)) return false;
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            order.code[i] = number(i) | (order.kind[i] == border ? Order::ON_BORDER : 0);
    });
    order.kind.release();
    if (!lay_out(matrix, order, parallel, memory)) return false;
    parallel.for_each(kinds * parts_, [&](uint32_t s, uint32_t) {
        const Segment& at = segment_[s];
        if (s % kinds == inner) write_rows(matrix, scale, order, at, base(s / kinds), narrow_);
        else write_rows(matrix, scale, order, at, 0, wide_);
    });
    const auto end = [](auto& groups) {
        for (auto* const list : {&groups.lower, &groups.upper}) {
            auto& last = list->data()[list->size() - 1];
            last = {};
            last.column[0] = last.FIRST;
        }
    };
    end(narrow_);
    end(wide_);
    return true;
}

template <class Column>
void SweepMatrix::refresh_row(const SignedMatrix& matrix, const float* scale, uint32_t i, const SweepMatrix& numbers,
                              uint32_t first_column, Group<Column>* low, Group<Column>* up, uint32_t own) {
    uint32_t used_low = 0, used_up = 0;
    for (uint32_t t = matrix.offset[i], last = matrix.offset[i + 1]; t < last; ++t) {
        const uint32_t j = matrix.column[t], c = numbers.number(j);
        const float value = scaled(matrix.entry[t] * static_cast<double>(scale[i]) * static_cast<double>(scale[j]));
        if (used_low == GROUP_SIZE && !low[1].is_first()) {
            ++low;
            used_low = 0;
        }
        // The columns tell which entries come before the row; padding entries have a column of their own.
        if (used_low < GROUP_SIZE && c != own && low->column_at(used_low) + first_column == c) {
            low->entry[used_low++] = value;
            continue;
        }
        if (used_up == GROUP_SIZE) {
            ++up;
            used_up = 0;
        }
        up->entry[used_up++] = value;
    }
}

void SweepMatrix::refresh(const SignedMatrix& matrix, const float* scale, const uint8_t* changed,
                          const Parallel& parallel) {
    // The groups of row k.
    const auto find = [&](const Segment& at, uint32_t k, auto& groups, auto*& low, auto*& up) {
        const Mark mark = mark_[at.mark + (k - at.row) / ROWS_OF_MARK];
        low = groups.lower.data() + mark.lower;
        up = groups.upper.data() + mark.upper;
        for (uint32_t rows = (k - at.row) % ROWS_OF_MARK; rows > 0; --rows) {
            do ++low;
            while (!low->is_first());
            do ++up;
            while (!up->is_first());
        }
    };
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (uint32_t i = static_cast<uint32_t>(begin); i < end; ++i) {
            if (!changed[i]) continue;
            const uint32_t k = number(i), part = k >> shift_;
            uint32_t kind = inner;
            while (k - segment_[kinds * part + kind].row >= segment_[kinds * part + kind].rows) ++kind;
            const Segment& at = segment_[kinds * part + kind];
            if (kind == inner) {
                Group<Narrow>*low, *up;
                find(at, k, narrow_, low, up);
                refresh_row(matrix, scale, i, *this, base(part), low, up, k);
            } else {
                Group<Wide>*low, *up;
                find(at, k, wide_, low, up);
                refresh_row(matrix, scale, i, *this, 0, low, up, k);
            }
        }
    });
}

// --- Sweeps ------------------------------------------------------------------

// Sum of entry * x.
template <class Column>
inline float SweepMatrix::Group<Column>::product(const float* x) const {
    static_assert(GROUP_SIZE == 4, "written out here");
    return (entry[0] * x[column_at(0)] + entry[1] * x[column[1]]) + (entry[2] * x[column[2]] + entry[3] * x[column[3]]);
}

// visit(segment, its groups, where its columns begin)
template <class Visit>
void SweepMatrix::for_kind(uint32_t part, Kind kind, Visit visit) const {
    if (kind == inner) visit(segment(part, inner), narrow_, base(part));
    else visit(segment(part, kind), wide_, 0u);
}

// sweep(part, kind) in the order of a sweep.
template <class Sweep>
void SweepMatrix::forward_by(const Parallel& parallel, Sweep sweep) const {
    parallel.for_each(parts_, [&](uint32_t part, uint32_t) {
        sweep(part, inner);
        sweep(part, fringe);
    });
    for (uint32_t part = 0; part < parts_; ++part) sweep(part, border);
}

template <class Sweep>
void SweepMatrix::backward_by(const Parallel& parallel, Sweep sweep) const {
    for (uint32_t part = parts_; part-- > 0;) sweep(part, border);
    parallel.for_each(parts_, [&](uint32_t part, uint32_t) {
        sweep(part, fringe);
        sweep(part, inner);
    });
}

// From zero: only what comes before a row counts.
void SweepMatrix::forward(const float* b, float* x, const Parallel& parallel, const float* row_scale) const {
    forward_by(parallel, [&](uint32_t part, Kind kind) {
        for_kind(part, kind, [=](const Segment& s, const auto& groups, uint32_t first_column) {
            const float* const columns = x + first_column;
            auto* at = groups.lower.data() + s.lower;
            for (uint32_t i = s.row, end = s.row + s.rows; i < end; ++i) {
                float sum = 0;
                do sum += at->product(columns);
                while (!(++at)->is_first());
                x[i] = row_scale && row_scale[i] < 0 ? 0 : b[i] - sum;
            }
        });
    });
}

// It is the product with what comes after each row.
void SweepMatrix::find_rest(const float* x, float* rest, const Parallel& parallel) const {
    parallel.for_each(kinds * parts_, [&](uint32_t k, uint32_t) {
        for_kind(k / kinds, static_cast<Kind>(k % kinds),
                 [=](const Segment& s, const auto& groups, uint32_t first_column) {
                     const float* const columns = x + first_column;
                     auto* at = groups.upper.data() + s.upper;
                     for (uint32_t i = s.row, end = s.row + s.rows; i < end; ++i) {
                         float sum = 0;
                         do sum += at->product(columns);
                         while (!(++at)->is_first());
                         rest[i] = -sum;
                     }
                 });
    });
}

void SweepMatrix::backward(const float* b, float* x, const Parallel& parallel) const {
    backward_by(parallel, [&](uint32_t part, Kind kind) {
        for_kind(part, kind, [=](const Segment& s, const auto& groups, uint32_t first_column) {
            const float* const columns = x + first_column;
            auto* low = groups.lower.data() + s.lower_end;
            auto* up = groups.upper.data() + s.upper_end;
            for (uint32_t i = s.row + s.rows; i-- > s.row;) {
                float before = 0, after = 0;
                do before += (--low)->product(columns);
                while (!low->is_first());
                do after += (--up)->product(columns);
                while (!up->is_first());
                x[i] = b[i] - after - before;
            }
        });
    });
}

// --- Steps of conjugate gradients ----------------------------------------------

namespace {

// Sums of the segments of all parts, which are added in their order; room for most, of which nothing is set before.
template <class Sums, uint32_t most>
class OfSegments {
public:
    void set(uint32_t k, const Sums& sums) { std::memcpy(room_ + k * sizeof(Sums), &sums, sizeof(Sums)); }
    Sums total(uint32_t count) const {
        Sums sum;
        for (uint32_t k = 0; k < count; ++k) {
            Sums part;
            std::memcpy(&part, room_ + k * sizeof(Sums), sizeof(Sums));
            sum += part;
        }
        return sum;
    }

private:
    unsigned char room_[most * sizeof(Sums)];
};

} // namespace

StepSums SweepMatrix::backward_to_step(const float* g, float* x, const StepVectors& v, const Parallel& parallel) const {
    const float *const product = v.product, *const row_scale = v.row_scale;
    float* const difference = v.difference;
    backward_by(parallel, [&](uint32_t part, Kind kind) {
        StepSums out;
        for_kind(part, kind, [=, &out](const Segment& s, const auto& groups, uint32_t first_column) {
            const float* const columns = x + first_column;
            auto* low = groups.lower.data() + s.lower_end;
            auto* up = groups.upper.data() + s.upper_end;
            StepSums sums;
            double dz = 0;
            for (uint32_t i = s.row + s.rows; i-- > s.row;) {
                float before = 0, after = 0;
                do before += (--low)->product(columns);
                while (!low->is_first());
                do after += (--up)->product(columns);
                while (!up->is_first());
                const float own = g[i];
                float z = own - after - before;
                if (row_scale && row_scale[i] < 0) z = 0;
                const float d = x[i] - z;
                x[i] = z;
                difference[i] = d;
                sums.zr += static_cast<double>(z * own);
                sums.zq += static_cast<double>(z * product[i]);
                dz += static_cast<double>(d * after);
            }
            // z A z = z g - the sum over rows of z_i a_ij d_j, j before i; by columns: d_j times what comes after.
            sums.zAz = sums.zr - dz;
            out = sums;
        });
        v.sums[kinds * part + kind] = out;
    });
    StepSums sum;
    for (uint32_t k = 0; k < segments(); ++k) sum += v.sums[k];
    return sum;
}

ResidualNorms SweepMatrix::step_forward(float alpha, float beta, float* g, float* x, const StepVectors& v,
                                        const Parallel& parallel) const {
    OfSegments<ResidualNorms, kinds * MOST_PARTS> of;
    float *const product = v.product, *const direction = v.direction, *const solution = v.solution;
    const float *const difference = v.difference, *const row_scale = v.row_scale;
    forward_by(parallel, [&](uint32_t part, Kind kind) {
        ResidualNorms out;
        for_kind(part, kind, [=, &out](const Segment& s, const auto& groups, uint32_t first_column) {
            const float *const columns = x + first_column, *const differences = difference + first_column;
            auto* at = groups.lower.data() + s.lower;
            ResidualNorms norms;
            float largest = 0;
            for (uint32_t i = s.row, end = s.row + s.rows; i < end; ++i) {
                float sum = 0, before = 0;
                do {
                    sum += at->product(columns);
                    before += at->product(differences);
                } while (!(++at)->is_first());
                const float old = g[i], p = x[i] + beta * direction[i];
                float q = (old - before) + beta * product[i];
                const bool held = row_scale && row_scale[i] < 0;
                if (held) q = 0;
                const float rest = old - alpha * q + FLOOR_VALUE;
                direction[i] = p;
                product[i] = q;
                solution[i] += alpha * p;
                g[i] = rest;
                norms.squares += static_cast<double>(rest * rest);
                if (row_scale) {
                    const float row = row_scale[i] * std::fabs(rest);
                    largest = row > largest ? row : largest;
                }
                x[i] = held ? 0 : rest - sum;
            }
            norms.largest_row = static_cast<double>(largest);
            out = norms;
        });
        of.set(kinds * part + kind, out);
    });
    return of.total(segments());
}

} // namespace hmf
