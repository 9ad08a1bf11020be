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

namespace hmf {

namespace {

constexpr uint32_t undecided = 0xffffffffu;
constexpr uint32_t left_out = 0xfffffffeu; // the smoother alone is enough
constexpr uint32_t joined = 0x80000000u;   // mark of an unknown that joined later
constexpr double omega = 2.0 / 3;
// A hub is not smoothed: its row would couple all aggregates around it with
// each other, and the Galerkin product would cost the square of its degree.
constexpr uint32_t largest_smoothed_degree = 48;
constexpr uint32_t rows_between_ticks = 32768;

constexpr uint8_t on_column = 1, on_row = 2; // the row depends strongly on the column, the column on the row

struct Aggregates {
    uint32_t count = 0;
    Array<uint32_t> of;    // aggregate per unknown, or left_out
    Array<int8_t> sign;    // per unknown
    Array<uint8_t> strong; // per entry of the matrix: on_column, on_row
};

// Which unknowns depend strongly on which, and which hardly on any.  Measured
// by the share of the entry in the row, not by |a_ij| / sqrt(a_ii a_jj): where
// weights jump by orders of magnitude the latter calls all entries of the
// lighter rows weak.
Done find_dependence(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a,
                     Memory& memory) {
    const uint32_t n = matrix.n;
    if (!a.of.allocate(memory, n) || !a.sign.allocate_filled(memory, n, 1)
        || !a.strong.allocate(memory, matrix.offset[n]))
        return false;
    struct Unknown {
        double kernel, least;
    }; // least: |a_ij| kernel_j of a strong entry of row i
    Array<Unknown> unknowns;
    if (!unknowns.allocate(memory, n)) return false;
    Unknown* unknown = unknowns.data();
    for (uint32_t i = 0; i < n; ++i)
        unknown[i] = {kernel[i],
                      kernel[i] > 0 ? static_cast<double>(strength) * kernel[i] * matrix.diagonal[i] : 1e300};
    const uint32_t total = matrix.offset[n];
    constexpr uint32_t ahead = 48;
    uint8_t* strong = a.strong.data();
    uint32_t* of = a.of.data();
    for (uint32_t i = 0; i < n; ++i) {
        const Unknown own = unknown[i];
        double sum = 0;
        for (uint32_t k = matrix.offset[i], end = matrix.offset[i + 1]; k < end; ++k) {
            if (total - k > ahead) prefetch(&unknown[matrix.column[k + ahead]]);
            const Unknown other = unknown[matrix.column[k]];
            const double size = std::fabs(matrix.entry[k]), share = size * other.kernel;
            sum += share;
            strong[k] =
                static_cast<uint8_t>((share >= own.least) * on_column + (size * own.kernel >= other.least) * on_row);
        }
        of[i] = own.kernel > 0 && sum > 0.1 * own.kernel * matrix.diagonal[i] ? undecided : left_out;
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
bool join_by_vote(const SignedMatrix& matrix, const Array<double>& kernel, uint32_t i, bool any, double* vote,
                  Aggregates& a) {
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
        const double v = vote[of & mask], size = std::fabs(v);
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

// Numbers the aggregates by their last members.  Meshes from a hierarchy have
// most vertices at the end, in an order in space; the roots jump about.
Done renumber(Aggregates& a, uint32_t n, Memory& memory) {
    Array<uint32_t> number;
    if (!number.allocate_filled(memory, a.count, undecided)) return false;
    uint32_t next = a.count;
    for (uint32_t i = n; i-- > 0;) {
        if (a.of[i] >= left_out) continue;
        uint32_t& own = number[a.of[i] & ~joined];
        if (own == undecided) own = --next;
        a.of[i] = own;
    }
    return true;
}

Done aggregate(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a, Memory& memory,
               Call* call) {
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
        if (a.of[i] == undecided && !join_by_vote(matrix, kernel, i, true, vote.data(), a))
            take_in(matrix, i, false, a);
    return renumber(a, n, memory);
}

// A sparse matrix that is written row by row.
template <class Entry>
struct GrowingRows {
    Array<uint32_t> offset, column;
    Array<Entry> entry;
    uint32_t used = 0;

    Done begin(uint32_t rows, size_t expected, Memory& memory) {
        return offset.allocate(memory, rows + size_t{1}) && column.allocate(memory, expected)
            && entry.allocate(memory, expected);
    }
    Done make_room(size_t more, Memory& memory) {
        if (used + more <= column.size()) return true;
        if (used + more > 0xf0000000u) {
            memory.take(SIZE_MAX);
            return false;
        }
        const size_t wanted = used + more + column.size() / 3;
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
    void begin_row(uint32_t row) { offset[row] = used; }
    void push(uint32_t c, Entry value) {
        column[used] = c;
        entry[used++] = value;
    }
    void end(uint32_t rows) { offset[rows] = used; }
};

// A row of P that is being written.
struct ProlongationRow {
    uint32_t* place; // per column, where it lies in the row; those of earlier rows lie before begin
    uint32_t* column;
    float* entry;
    uint32_t begin, at;

    // Without jumps: which columns were met before, nobody can predict.
    void add(uint32_t c, float value) {
        const uint32_t p = place[c];
        const bool is_new = p - begin >= at - begin;
        const uint32_t slot = is_new ? at : p;
        place[c] = slot;
        column[slot] = c;
        entry[slot] += value;
        at += is_new;
        entry[at] = 0;
    }
};

// P for the matrix before scaling, row by row.
Done build_prolongation(const SignedMatrix& matrix, const Array<double>& kernel, const Aggregates& a,
                        const Array<double>& norm, GrowingRows<float>& rows, Memory& memory, Call* call) {
    const uint32_t n = matrix.n;
    Array<double> tentative; // entry of T per unknown
    Array<uint32_t> place;
    if (!tentative.allocate(memory, n) || !rows.begin(n, size_t{3} * n, memory)
        || !place.allocate_filled(memory, a.count, undecided))
        return false;
    for (uint32_t i = 0; i < n; ++i) tentative[i] = a.of[i] == left_out ? 0 : a.sign[i] * kernel[i] / norm[a.of[i]];
    for (uint32_t i = 0; i < n; ++i) {
        if (i % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
        if (!rows.make_room(end - begin + size_t{2}, memory)) return false; // one more is set to zero behind the last
        rows.begin_row(i);
        if (a.of[i] == left_out) continue;
        ProlongationRow row{place.data(), rows.column.data(), rows.entry.data(), rows.used, rows.used};
        rows.entry[rows.used] = 0;
        double factor = 0;
        if (end - begin <= largest_smoothed_degree) {
            // Weak entries act on the smooth vector as if they lay on the diagonal.
            const double all = matrix.diagonal[i] * kernel[i];
            double strong = all;
            for (uint32_t k = begin; k < end; ++k) {
                const uint32_t j = matrix.column[k];
                const bool used = (a.strong[k] & on_column) & (a.of[j] != left_out);
                strong -= std::fabs(matrix.entry[k]) * (used ? 0 : kernel[j]);
            }
            if (strong > 0.05 * all) factor = omega * kernel[i] / strong;
        }
        row.add(a.of[i], static_cast<float>(factor > 0 ? (1 - omega) * tentative[i] : tentative[i]));
        for (uint32_t k = begin; k < end && factor > 0; ++k) {
            const uint32_t j = matrix.column[k];
            if ((a.strong[k] & on_column) && a.of[j] != left_out)
                row.add(a.of[j], static_cast<float>(-factor * matrix.entry[k] * tentative[j]));
        }
        rows.used = row.at;
    }
    rows.end(n);
    return true;
}

// P^T into the level.
Done transpose(const GrowingRows<float>& rows, uint32_t columns, MultigridLevel& level, Memory& memory) {
    const uint32_t n = level.n, total = rows.offset[n];
    Array<uint32_t>& start = level.prolongation_start;
    if (!start.allocate_filled(memory, columns + size_t{1}, 0) || !level.prolongation_row.allocate(memory, total)
        || !level.prolongation_entry.allocate(memory, total))
        return false;
    for (uint32_t k = 0; k < total; ++k) ++start[rows.column[k]];
    uint32_t sum = 0;
    for (uint32_t c = 0; c <= columns; ++c) {
        sum += start[c];
        start[c] = sum;
    }
    for (uint32_t i = n; i-- > 0;)
        for (uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
            const uint32_t at = --start[rows.column[k]];
            level.prolongation_row[at] = i;
            level.prolongation_entry[at] = rows.entry[k];
        }
    return true;
}

// A vector with few entries, and which those are.
class SparseVector {
public:
    Done allocate(uint32_t n, Memory& memory) {
        if (!places_.allocate_filled(memory, n, {0, undecided}) || !touched_.allocate(memory, n + size_t{1}))
            return false;
        place_ = places_.data();
        list_ = touched_.data();
        return true;
    }
    // label: another one for every vector.
    void begin(uint32_t label) {
        label_ = label;
        count_ = 0;
    }
    // Without jumps: whether i was met before, nobody can predict.
    void add(uint32_t i, double value) {
        Place& p = place_[i];
        list_[count_] = i;
        count_ += p.label != label_;
        p.label = label_;
        p.value += value;
    }
    uint32_t count() const { return count_; }
    uint32_t index(uint32_t k) const { return list_[k]; }
    double take(uint32_t i) {
        const double value = place_[i].value;
        place_[i].value = 0;
        return value;
    }

private:
    struct Place {
        double value;
        uint32_t label;
    };
    Array<Place> places_;
    Array<uint32_t> touched_;
    Place* place_ = nullptr;
    uint32_t* list_ = nullptr;
    uint32_t label_ = undecided, count_ = 0;
};

// P^T A P, a column at a time; by symmetry that is a row.
Done galerkin(const SignedMatrix& matrix, const MultigridLevel& level, const GrowingRows<float>& p, uint32_t count,
              CoarseMatrix& coarse, Memory& memory, Call* call) {
    SparseVector fine, sum; // column of A P, and of the whole product
    GrowingRows<double> rows;
    if (!fine.allocate(matrix.n, memory) || !sum.allocate(count, memory) || !coarse.diagonal.allocate(memory, count)
        || !rows.begin(count, size_t{11} * count, memory))
        return false;
    const uint32_t* row = level.prolongation_row.data();
    const uint32_t total = level.prolongation_start[count];
    // The rows of A are met in no order: their memory is asked for ahead.
    constexpr uint32_t ahead = 16;
    for (uint32_t c = 0; c < count; ++c) {
        if (c % rows_between_ticks == 0 && !continues(call)) return false;
        fine.begin(c);
        for (uint32_t t = level.prolongation_start[c], end = level.prolongation_start[c + 1]; t < end; ++t) {
            if (total - t > 2 * ahead) prefetch(&matrix.offset[row[t + 2 * ahead]]);
            if (total - t > ahead) {
                const uint32_t soon = row[t + ahead], at = matrix.offset[soon];
                prefetch(&matrix.diagonal[soon]);
                prefetch(&matrix.column[at]);
                prefetch(&matrix.entry[at]);
            }
            const uint32_t j = row[t];
            const double factor = static_cast<double>(level.prolongation_entry[t]);
            fine.add(j, factor * matrix.diagonal[j]);
            for (uint32_t k = matrix.offset[j], last = matrix.offset[j + 1]; k < last; ++k)
                fine.add(matrix.column[k], factor * matrix.entry[k]);
        }
        sum.begin(c);
        for (uint32_t f = 0; f < fine.count(); ++f) {
            const uint32_t i = fine.index(f);
            const double value = fine.take(i);
            for (uint32_t q = p.offset[i], last = p.offset[i + 1]; q < last; ++q)
                sum.add(p.column[q], static_cast<double>(p.entry[q]) * value);
        }
        coarse.diagonal[c] = sum.take(c);
        if (!rows.make_room(sum.count(), memory)) return false;
        rows.begin_row(c);
        for (uint32_t d = 0; d < sum.count(); ++d)
            if (sum.index(d) != c) rows.push(sum.index(d), sum.take(sum.index(d)));
    }
    rows.end(count);
    coarse.offset = static_cast<Array<uint32_t>&&>(rows.offset);
    coarse.column = static_cast<Array<uint32_t>&&>(rows.column);
    coarse.entry = static_cast<Array<double>&&>(rows.entry);
    return true;
}

} // namespace

Done unit_diagonal_scale(const SignedMatrix& matrix, double threshold, Array<float>& scale, Memory& memory) {
    if (!scale.allocate(memory, matrix.n)) return false;
    for (uint32_t i = 0; i < matrix.n; ++i)
        scale[i] = matrix.diagonal[i] > threshold ? static_cast<float>(1 / std::sqrt(matrix.diagonal[i])) : 0.0f;
    return true;
}

Done scale_matrix(const SignedMatrix& matrix, MultigridLevel& level, Memory& memory) {
    constexpr uint32_t block = MultigridLevel::block;
    const uint32_t n = matrix.n;
    size_t total = 0;
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t below = 0;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) below += matrix.column[k] < i;
        total += (below + block - (below > 0)) / block * block;
    }
    total += block; // written to, but not used
    if (total > 0xf0000000u) {
        memory.take(SIZE_MAX);
        return false;
    }
    if (level.n != n || level.start.empty()) {
        level.n = n;
        if (!level.start.allocate(memory, n + size_t{1}) || !level.b.allocate(memory, n) || !level.x.allocate(memory, n)
            || !level.r.allocate(memory, n))
            return false;
    }
    if (level.column.size() != total && (!level.column.allocate(memory, total) || !level.entry.allocate(memory, total)))
        return false;
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
            entry[at] = std::fabs(value) > 1e-20 ? static_cast<float>(value) : 0.0f;
            at += j < i;
        }
        for (uint32_t t = 0; t < block; ++t) {
            column[at + t] = i;
            entry[at + t] = 0;
        }
        const uint32_t used = at - level.start[i];
        at = level.start[i] + (used + block - (used > 0)) / block * block;
    }
    level.start[n] = at;
    return true;
}

Done coarsen(const SignedMatrix& matrix, MultigridLevel& level, float strength, Array<double>& near_kernel,
             CoarseMatrix& coarse, Memory& memory, Call* call) {
    const uint32_t n = level.n = matrix.n;
    for (uint32_t i = 0; i < n; ++i)
        if (!(level.scale[i] > 0)) near_kernel[i] = 0;
    Aggregates a;
    if (!continues(call) || !aggregate(matrix, near_kernel, strength, a, memory, call) || !continues(call))
        return false;
    const uint32_t count = a.count;
    Array<double> norm;
    if (!norm.allocate_filled(memory, count, 0)) return false;
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] != left_out) norm[a.of[i]] += matrix.diagonal[i] * near_kernel[i] * near_kernel[i];
    for (uint32_t c = 0; c < count; ++c) norm[c] = std::sqrt(norm[c]);
    GrowingRows<float> rows;
    if (!build_prolongation(matrix, near_kernel, a, norm, rows, memory, call)) return false;
    a = Aggregates{};
    near_kernel = static_cast<Array<double>&&>(norm);
    return transpose(rows, count, level, memory) && galerkin(matrix, level, rows, count, coarse, memory, call);
}

} // namespace hmf
