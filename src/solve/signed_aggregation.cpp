// Smoothed aggregation (Vanek, Mandel, Brezina 1996) with signs.  Not in [W],
// which only moves one vertex at a time.
//
//   root r and its strong neighbours      left-overs join by vote
//
//         o   o                                o   o
//          \ /                                  \ /
//       o---r---o    . . .                   o---r---o---x
//          / \                                  / \     /
//         o   o                                o   o---'
//
// The sign of a member in its aggregate is minus the sign of its entry to the
// root: that is how a smooth vector continues across the edge.  With it the
// aggregates of a twisted Laplacian are those of an ordinary one, but where
// an aggregate lies round a tripod.
//
//   T   tentative prolongation: signed near-kernel vector, cut into aggregates
//   P = (I - omega D^-1 A) T, with weak entries of A moved to the diagonal
//   coarse matrix P^T A P
#include "signed_aggregation.hpp"

#include <cmath>

#include "../base/prefetch.hpp"
#ifndef AHEAD
#define AHEAD 48
#endif

namespace hmf {

namespace {

constexpr uint32_t undecided = 0xffffffffu;
constexpr uint32_t left_out = 0xfffffffeu;    // the smoother alone is enough
constexpr uint32_t joined = 0x80000000u;      // mark of an unknown that joined later
constexpr double omega = 2.0 / 3;
// A hub is not smoothed: its row would couple all aggregates around it with
// each other, and the Galerkin product would cost the square of its degree.
constexpr uint32_t largest_smoothed_degree = 48;
constexpr uint32_t rows_between_ticks = 32768;

constexpr uint8_t on_column = 1, on_row = 2; // the row depends strongly on the column, the column on the row

inline double magnitude(double x) { return std::fabs(x); }

struct Aggregates {
    uint32_t count = 0;
    Array<uint32_t> of;      // aggregate per unknown, or left_out
    Array<int8_t> sign;      // per unknown
    Array<uint8_t> strong;   // per entry of the matrix: on_column, on_row
};

// Which unknowns depend strongly on which, and which hardly on any.  Measured
// by the share of the entry in the row, not by |a_ij| / sqrt(a_ii a_jj): where
// weights jump by orders of magnitude the latter calls all entries of the
// lighter rows weak.
bool find_dependence(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a, Memory& memory) {
    const uint32_t n = matrix.n;
    if (!a.of.allocate(memory, n) || !a.sign.allocate_filled(memory, n, 1) || !a.strong.allocate(memory, matrix.offset[n])) return false;
    struct Unknown { double kernel, least; }; // least: |a_ij| kernel_j of a strong entry of row i
    Array<Unknown> unknowns;
    if (!unknowns.allocate(memory, n)) return false;
    Unknown* unknown = unknowns.data();
    for (uint32_t i = 0; i < n; ++i)
        unknown[i] = {kernel[i], kernel[i] > 0 ? static_cast<double>(strength) * kernel[i] * matrix.diagonal[i] : 1e300};
    const uint32_t total = matrix.offset[n];
    uint8_t* strong = a.strong.data();
    uint32_t* of = a.of.data();
    for (uint32_t i = 0; i < n; ++i) {
        const Unknown own = unknown[i];
        double sum = 0;
        for (uint32_t k = matrix.offset[i], end = matrix.offset[i + 1]; k < end; ++k) {
            if (AHEAD && total - k > AHEAD) prefetch(&unknown[matrix.column[k + AHEAD]]);
            const Unknown other = unknown[matrix.column[k]];
            const double size = magnitude(matrix.entry[k]), share = size * other.kernel;
            sum += share;
            strong[k] = static_cast<uint8_t>((share >= own.least) * on_column + (size * own.kernel >= other.least) * on_row);
        }
        of[i] = sum > 0.1 * own.kernel * matrix.diagonal[i] ? undecided : left_out;
    }
    return true;
}

void take_in(const SignedMatrix& matrix, uint32_t root, bool strong_only, Aggregates& a) {
    a.of[root] = a.count;
    for (uint32_t k = matrix.offset[root]; k < matrix.offset[root + 1]; ++k) {
        const uint32_t j = matrix.column[k];
        if (a.of[j] != undecided || (strong_only && !(a.strong[k] & on_row))) continue;
        a.of[j] = a.count;
        a.sign[j] = matrix.entry[k] < 0 ? 1 : -1;
    }
    ++a.count;
}

// Joins i to the neighbouring aggregate with the largest signed vote; false
// if there is none.  vote: zeros, left as found.
// any: also by weak entries, and to members that joined themselves.
bool join_by_vote(const SignedMatrix& matrix, const Array<double>& kernel, uint32_t i, bool any, double* vote, Aggregates& a) {
    const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
    const uint32_t mask = any ? ~joined : ~0u;
    const auto counts = [&](uint32_t k, uint32_t of) {
        return of < left_out && (of & mask) < a.count && (any || (a.strong[k] & on_column));
    };
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t j = matrix.column[k], of = a.of[j];
        if (counts(k, of)) vote[of & mask] -= matrix.entry[k] * a.sign[j] * kernel[j];
    }
    uint32_t best = undecided;
    double best_vote = -1;
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t of = a.of[matrix.column[k]];
        if (!counts(k, of)) continue;
        const double v = vote[of & mask], size = magnitude(v);
        if (size <= best_vote) continue;
        best = of & mask;
        best_vote = size;
        a.sign[i] = v < 0 ? -1 : 1;
    }
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t of = a.of[matrix.column[k]];
        if (counts(k, of)) vote[of & mask] = 0;
    }
    if (best == undecided) return false;
    a.of[i] = best | joined;
    return true;
}

bool aggregate(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a, Memory& memory, Call* call) {
    const uint32_t n = matrix.n;
    if (!find_dependence(matrix, kernel, strength, a, memory) || !continues(call)) return false;
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != undecided) continue;
        // Without early exit, which would be a jump that nobody can predict.
        bool has_strong = false, taken = false;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
            const uint32_t of = a.of[matrix.column[k]];
            const bool strong = a.strong[k] & on_row;
            has_strong |= strong & (of == undecided);
            taken |= strong & (of < left_out);
        }
        if (has_strong & !taken) take_in(matrix, i, true, a);
    }
    Array<double> vote;
    if (!continues(call) || !vote.allocate_filled(memory, n, 0)) return false;
    // First to the cores only, which keeps the aggregates round.
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] == undecided) join_by_vote(matrix, kernel, i, false, vote.data(), a);
    // Groups whose whole outside was taken, as heavy edges among light ones:
    // they have to stay together, or the coarse level cannot move them.
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != undecided) continue;
        bool has_strong = false;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1] && !has_strong; ++k)
            has_strong = a.of[matrix.column[k]] == undecided && (a.strong[k] & on_row);
        if (has_strong) take_in(matrix, i, true, a);
    }
    // What is left has weak neighbours only.
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] == undecided && !join_by_vote(matrix, kernel, i, true, vote.data(), a)) take_in(matrix, i, false, a);
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] < left_out) a.of[i] &= ~joined;
    return true;
}

// A row that is being written.
template <class Entry>
struct RowWriter {
    uint32_t* place;   // per column, where it lies in the row; those of earlier rows lie before begin
    uint32_t* column;
    Entry* entry;
    uint32_t begin, at;

    // Without jumps: which columns were met before, nobody can predict.
    void add(uint32_t c, Entry value) {
        const uint32_t p = place[c];
        const bool is_new = p - begin >= at - begin;
        const uint32_t slot = is_new ? at : p;
        place[c] = slot;
        column[slot] = c;
        entry[slot] += value;
        at += is_new;
        entry[at] = 0;
    }
    // Takes the entry in column c out.
    Entry take_out(uint32_t c) {
        const uint32_t p = place[c];
        if (p - begin >= at - begin) return 0;
        const Entry value = entry[p];
        --at;
        entry[p] = entry[at];
        column[p] = column[at];
        place[column[p]] = p;
        place[c] = undecided;
        return value;
    }
};

// A sparse matrix that is written row by row.
template <class Entry>
class GrowingRows {
public:
    Array<uint32_t> offset, column;
    Array<Entry> entry;

    bool begin(uint32_t rows, size_t expected, uint32_t columns, Memory& memory) {
        return offset.allocate(memory, rows + size_t{1}) && column.allocate(memory, expected) && entry.allocate(memory, expected)
            && place_.allocate_filled(memory, columns, undecided);
    }
    // For a row of at most so many entries.
    bool make_room(size_t entries, Memory& memory) {
        const size_t used = used_, needed = used + entries + 1; // a writer sets the entry behind its last to zero
        if (needed <= column.size()) return true;
        if (needed > 0xf0000000u) { memory.take(SIZE_MAX); return false; }
        const size_t wanted = needed + column.size() / 3;
        Array<uint32_t> new_column;
        Array<Entry> new_entry;
        if (!new_column.allocate(memory, wanted) || !new_entry.allocate(memory, wanted)) return false;
        if (used) {
            std::memcpy(new_column.data(), column.data(), used * sizeof(uint32_t));
            std::memcpy(new_entry.data(), entry.data(), used * sizeof(Entry));
        }
        column.swap(new_column);
        entry.swap(new_entry);
        return true;
    }
    RowWriter<Entry> begin_row(uint32_t row) {
        offset[row] = used_;
        entry[used_] = 0;
        return {place_.data(), column.data(), entry.data(), used_, used_};
    }
    void end_row(const RowWriter<Entry>& row) { used_ = row.at; }
    void end(uint32_t rows) {
        offset[rows] = used_;
        place_.release();
    }

private:
    Array<uint32_t> place_;
    uint32_t used_ = 0;
};

// P for the matrix before scaling, row by row.
bool build_prolongation(const SignedMatrix& matrix, const Array<double>& kernel, const Aggregates& a, const Array<double>& norm,
                        GrowingRows<float>& rows, Memory& memory, Call* call) {
    const uint32_t n = matrix.n;
    Array<double> tentative; // entry of T per unknown
    if (!tentative.allocate(memory, n) || !rows.begin(n, size_t{3} * n, a.count, memory)) return false;
    for (uint32_t i = 0; i < n; ++i) tentative[i] = a.of[i] == left_out ? 0 : a.sign[i] * kernel[i] / norm[a.of[i]];
    for (uint32_t i = 0; i < n; ++i) {
        if (i % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
        if (!rows.make_room(end - begin + size_t{1}, memory)) return false;
        RowWriter<float> row = rows.begin_row(i);
        if (a.of[i] == left_out) continue;
        double factor = 0;
        if (end - begin <= largest_smoothed_degree) {
            // Weak entries act on the smooth vector as if they lay on the diagonal.
            const double all = matrix.diagonal[i] * kernel[i];
            double strong = all;
            for (uint32_t k = begin; k < end; ++k) {
                const uint32_t j = matrix.column[k];
                const bool used = (a.strong[k] & on_column) & (a.of[j] != left_out);
                strong -= magnitude(matrix.entry[k]) * (used ? 0 : kernel[j]);
            }
            if (strong > 0.05 * all) factor = omega * kernel[i] / strong;
        }
        row.add(a.of[i], static_cast<float>(factor > 0 ? (1 - omega) * tentative[i] : tentative[i]));
        for (uint32_t k = begin; k < end && factor > 0; ++k) {
            const uint32_t j = matrix.column[k];
            if ((a.strong[k] & on_column) && a.of[j] != left_out) row.add(a.of[j], static_cast<float>(-factor * matrix.entry[k] * tentative[j]));
        }
        rows.end_row(row);
    }
    rows.end(n);
    return true;
}

// P^T into the level.
bool transpose(const GrowingRows<float>& rows, uint32_t columns, MultigridLevel& level, Memory& memory) {
    const uint32_t n = level.n, total = rows.offset[n];
    Array<uint32_t>& start = level.prolongation_start;
    if (!start.allocate_filled(memory, columns + size_t{1}, 0) || !level.prolongation_row.allocate(memory, total)
        || !level.prolongation_entry.allocate(memory, total))
        return false;
    for (uint32_t k = 0; k < total; ++k) ++start[rows.column[k]];
    uint32_t sum = 0;
    for (uint32_t c = 0; c <= columns; ++c) { sum += start[c]; start[c] = sum; }
    for (uint32_t i = n; i-- > 0;)
        for (uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
            const uint32_t at = --start[rows.column[k]];
            level.prolongation_row[at] = i;
            level.prolongation_entry[at] = rows.entry[k];
        }
    return true;
}

// A P, diagonal of A included.
bool multiply_by_prolongation(const SignedMatrix& matrix, const GrowingRows<float>& p, uint32_t count, GrowingRows<double>& product, Memory& memory,
                              Call* call) {
    const uint32_t n = matrix.n;
    if (!product.begin(n, size_t{5} * n, count, memory)) return false;
    const uint32_t *offset = p.offset.data(), *p_column = p.column.data();
    const float* p_entry = p.entry.data();
    for (uint32_t i = 0; i < n; ++i) {
        if (i % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t first = matrix.offset[i], end = matrix.offset[i + 1];
        size_t most = offset[i + 1] - offset[i];
        for (uint32_t k = first; k < end; ++k) most += offset[matrix.column[k] + 1] - offset[matrix.column[k]];
        if (!product.make_room(most < count ? most : count, memory)) return false;
        RowWriter<double> row = product.begin_row(i);
        for (uint32_t k = first; k <= end; ++k) {
            const uint32_t j = k < end ? matrix.column[k] : i;
            const double value = k < end ? matrix.entry[k] : matrix.diagonal[i];
            for (uint32_t q = offset[j]; q < offset[j + 1]; ++q) row.add(p_column[q], value * static_cast<double>(p_entry[q]));
        }
        product.end_row(row);
    }
    product.end(n);
    return true;
}

// P^T (A P), a coarse row at a time.
bool galerkin(const MultigridLevel& level, const GrowingRows<double>& product, uint32_t count, CoarseMatrix& coarse, Memory& memory, Call* call) {
    GrowingRows<double> rows;
    const uint32_t* p_column = product.column.data();
    const double* p_entry = product.entry.data();
    if (!coarse.diagonal.allocate(memory, count) || !rows.begin(count, size_t{10} * count, count, memory)) return false;
    for (uint32_t c = 0; c < count; ++c) {
        if (c % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t first = level.prolongation_start[c], end = level.prolongation_start[c + 1];
        size_t most = 0;
        for (uint32_t t = first; t < end; ++t) most += product.offset[level.prolongation_row[t] + 1] - product.offset[level.prolongation_row[t]];
        if (!rows.make_room(most < count ? most : count, memory)) return false;
        RowWriter<double> row = rows.begin_row(c);
        for (uint32_t t = first; t < end; ++t) {
            const uint32_t i = level.prolongation_row[t];
            const double left = static_cast<double>(level.prolongation_entry[t]);
            for (uint32_t k = product.offset[i]; k < product.offset[i + 1]; ++k) row.add(p_column[k], left * p_entry[k]);
        }
        coarse.diagonal[c] = row.take_out(c);
        rows.end_row(row);
    }
    rows.end(count);
    coarse.offset = static_cast<Array<uint32_t>&&>(rows.offset);
    coarse.column = static_cast<Array<uint32_t>&&>(rows.column);
    coarse.entry = static_cast<Array<double>&&>(rows.entry);
    return true;
}

} // namespace

bool unit_diagonal_scale(const SignedMatrix& matrix, double threshold, Array<float>& scale, Memory& memory) {
    if (!scale.allocate(memory, matrix.n)) return false;
    for (uint32_t i = 0; i < matrix.n; ++i)
        scale[i] = matrix.diagonal[i] > threshold ? static_cast<float>(1 / std::sqrt(matrix.diagonal[i])) : 0.0f;
    return true;
}

bool scale_matrix(const SignedMatrix& matrix, MultigridLevel& level, Memory& memory) {
    const uint32_t n = matrix.n;
    size_t total = 0;
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t below = 0;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) below += matrix.column[k] < i;
        total += (below + 3) / 4 * 4;
    }
    total += 4; // written to, but not used
    if (total > 0xf0000000u) { memory.take(SIZE_MAX); return false; }
    if (level.n != n || level.start.empty()) {
        level.n = n;
        if (!level.start.allocate(memory, n + size_t{1}) || !level.b.allocate(memory, n) || !level.x.allocate(memory, n)
            || !level.r.allocate(memory, n))
            return false;
    }
    if (level.column.size() != total && (!level.column.allocate(memory, total) || !level.entry.allocate(memory, total))) return false;
    const float* scale = level.scale.data();
    uint32_t* column = level.column.data();
    float* entry = level.entry.data();
    uint32_t at = 0;
    for (uint32_t i = 0; i < n; ++i) {
        level.start[i] = at;
        const double own = static_cast<double>(scale[i]);
        // All are written, and the next one over those that are not below.
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
            const uint32_t j = matrix.column[k];
            const double value = matrix.entry[k] * own * static_cast<double>(scale[j]);
            column[at] = j;
            // Smaller ones would only make slow subnormal numbers.
            entry[at] = magnitude(value) > 1e-20 ? static_cast<float>(value) : 0.0f;
            at += j < i;
        }
        const uint32_t end = (at + 3) / 4 * 4;
        for (uint32_t t = 0; t < 4; ++t) {
            column[at + t] = i;
            entry[at + t] = 0;
        }
        at = end;
    }
    level.start[n] = at;
    return true;
}

bool coarsen(const SignedMatrix& matrix, MultigridLevel& level, float strength, Array<double>& near_kernel, CoarseMatrix& coarse,
             Memory& memory, Call* call) {
    const uint32_t n = level.n = matrix.n;
    for (uint32_t i = 0; i < n; ++i)
        if (!(level.scale[i] > 0)) near_kernel[i] = 0;
    Aggregates a;
    if (!continues(call) || !aggregate(matrix, near_kernel, strength, a, memory, call) || !continues(call)) return false;
    const uint32_t count = a.count;
    Array<double> norm;
    if (!norm.allocate_filled(memory, count, 0)) return false;
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] != left_out) norm[a.of[i]] += matrix.diagonal[i] * near_kernel[i] * near_kernel[i];
    for (uint32_t c = 0; c < count; ++c) norm[c] = std::sqrt(norm[c]);
    GrowingRows<double> product;
    {
        GrowingRows<float> rows;
        if (!build_prolongation(matrix, near_kernel, a, norm, rows, memory, call)) return false;
        a = Aggregates{};
        near_kernel = static_cast<Array<double>&&>(norm);
        if (!transpose(rows, count, level, memory) || !multiply_by_prolongation(matrix, rows, count, product, memory, call)) return false;
    }
    return galerkin(level, product, count, coarse, memory, call);
}

} // namespace hmf
