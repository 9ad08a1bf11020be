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

double magnitude(float x) { return static_cast<double>(x < 0 ? -x : x); }

// Does unknown i depend strongly on j?  Measured by the share of the entry in
// the row of i, not by |a_ij| / sqrt(a_ii a_jj): where weights jump by orders
// of magnitude the latter calls all entries of the lighter rows weak.
bool depends(const Array<double>& kernel, uint32_t i, uint32_t j, float entry, float strength) {
    return magnitude(entry) * kernel[j] >= static_cast<double>(strength) * kernel[i];
}

struct Aggregates {
    uint32_t count = 0;
    Array<uint32_t> of;    // aggregate per unknown, or left_out
    Array<int8_t> sign;    // per unknown
};

// Unknowns that hardly depend on their neighbours.
void leave_out_dominant_rows(const MultigridLevel& level, const Array<double>& kernel, Aggregates& a) {
    for (uint32_t i = 0; i < level.n; ++i) {
        a.of[i] = undecided;
        a.sign[i] = 1;
        double sum = 0;
        for (uint32_t k = level.start[2 * i]; k < level.start[2 * i + 2]; ++k)
            sum += magnitude(level.entry[k]) * kernel[level.column[k]];
        if (!(sum > 0.1 * kernel[i])) a.of[i] = left_out;
    }
}

void take_in(const MultigridLevel& level, const Array<double>& kernel, uint32_t root, float strength, Aggregates& a) {
    a.of[root] = a.count;
    for (uint32_t k = level.start[2 * root]; k < level.start[2 * root + 2]; ++k) {
        const uint32_t j = level.column[k];
        if (a.of[j] != undecided || !depends(kernel, j, root, level.entry[k], strength)) continue;
        a.of[j] = a.count;
        a.sign[j] = level.entry[k] < 0 ? 1 : -1;
    }
    ++a.count;
}

// Joins i to the neighbouring aggregate with the largest signed vote; false
// if there is none.  vote: zeros, left as found.
bool join_by_vote(const MultigridLevel& level, const Array<double>& kernel, uint32_t i, float strength, bool any_member, double* vote,
                  Aggregates& a) {
    const uint32_t begin = level.start[2 * i], end = level.start[2 * i + 2];
    const uint32_t mask = any_member ? ~joined : ~0u;
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t j = level.column[k];
        if (a.of[j] >= left_out || (a.of[j] & mask) >= a.count || !depends(kernel, i, j, level.entry[k], strength)) continue;
        vote[a.of[j] & mask] -= static_cast<double>(level.entry[k]) * a.sign[j] * kernel[j];
    }
    uint32_t best = undecided;
    double best_vote = -1;
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t j = level.column[k];
        if (a.of[j] >= left_out || (a.of[j] & mask) >= a.count || !depends(kernel, i, j, level.entry[k], strength)) continue;
        const double v = vote[a.of[j] & mask], size = v < 0 ? -v : v;
        if (size <= best_vote) continue;
        best = a.of[j] & mask;
        best_vote = size;
        a.sign[i] = v < 0 ? -1 : 1;
    }
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t j = level.column[k];
        if (a.of[j] < left_out && (a.of[j] & mask) < a.count) vote[a.of[j] & mask] = 0;
    }
    if (best == undecided) return false;
    a.of[i] = best | joined;
    return true;
}

bool aggregate(const MultigridLevel& level, const Array<double>& kernel, float strength, Aggregates& a, Memory& memory, Call* call) {
    const uint32_t n = level.n;
    if (!a.of.allocate(memory, n) || !a.sign.allocate(memory, n)) return false;
    leave_out_dominant_rows(level, kernel, a);
    if (!continues(call)) return false;
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != undecided) continue;
        bool has_strong = false, free = true;
        for (uint32_t k = level.start[2 * i]; k < level.start[2 * i + 2] && free; ++k) {
            const uint32_t j = level.column[k];
            if (!depends(kernel, j, i, level.entry[k], strength)) continue;
            has_strong |= a.of[j] == undecided;
            free = a.of[j] >= left_out;
        }
        if (free && has_strong) take_in(level, kernel, i, strength, a);
    }
    Array<double> vote;
    if (!continues(call) || !vote.allocate_filled(memory, n, 0)) return false;
    // First to the cores only, which keeps the aggregates round.
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] == undecided) join_by_vote(level, kernel, i, strength, false, vote.data(), a);
    // Groups whose whole outside was taken, as heavy edges among light ones:
    // they have to stay together, or the coarse level cannot move them.
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != undecided) continue;
        bool has_strong = false;
        for (uint32_t k = level.start[2 * i]; k < level.start[2 * i + 2] && !has_strong; ++k) {
            const uint32_t j = level.column[k];
            has_strong = a.of[j] == undecided && depends(kernel, j, i, level.entry[k], strength);
        }
        if (has_strong) take_in(level, kernel, i, strength, a);
    }
    // What is left has weak neighbours only.
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] == undecided && !join_by_vote(level, kernel, i, 0, true, vote.data(), a)) take_in(level, kernel, i, 0, a);
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] < left_out) a.of[i] &= ~joined;
    return true;
}

// P, row by row.  place: one value per aggregate, where it lies in the row.
class Prolongation {
public:
    Prolongation(MultigridLevel& level, const Array<double>& kernel, const Aggregates& a, const Array<double>& norm, float strength)
        : level_(level), kernel_(kernel), a_(a), norm_(norm), strength_(strength) {}

    bool build(Memory& memory, Call* call) {
        const uint32_t n = level_.n;
        Array<uint32_t> place;
        if (!place.allocate_filled(memory, a_.count, 0) || !tentative_.allocate(memory, n)) return false;
        for (uint32_t i = 0; i < n; ++i) tentative_[i] = a_.of[i] == left_out ? 0 : a_.sign[i] * kernel_[i] / norm_[a_.of[i]];
        if (!level_.prolongation_start.allocate(memory, n + size_t{1})) return false;
        // place: 1 + the last row that touched the aggregate.
        uint32_t total = 0;
        for (uint32_t i = 0; i < n; ++i) {
            level_.prolongation_start[i] = total;
            if (a_.of[i] == left_out) continue;
            place[a_.of[i]] = i + 1;
            ++total;
            if (!is_smoothed(i)) continue;
            for (uint32_t k = level_.start[2 * i]; k < level_.start[2 * i + 2]; ++k) {
                if (!is_used(i, k)) continue;
                uint32_t& seen = place[a_.of[level_.column[k]]];
                total += seen != i + 1;
                seen = i + 1;
            }
        }
        level_.prolongation_start[n] = total;
        if (!level_.prolongation_column.allocate(memory, total) || !level_.prolongation_entry.allocate(memory, total)) return false;
        for (uint32_t i = 0; i < a_.count; ++i) place[i] = undecided;
        for (uint32_t i = 0; i < n; ++i) {
            if (i % rows_between_ticks == 0 && !continues(call)) return false;
            if (a_.of[i] != left_out) fill_row(i, place);
        }
        return true;
    }

private:
    bool is_smoothed(uint32_t i) const { return level_.start[2 * i + 2] - level_.start[2 * i] <= largest_smoothed_degree; }
    bool is_used(uint32_t i, uint32_t k) const {
        const uint32_t j = level_.column[k];
        return a_.of[j] != left_out && depends(kernel_, i, j, level_.entry[k], strength_);
    }

    void fill_row(uint32_t i, Array<uint32_t>& place) {
        const uint32_t begin = level_.prolongation_start[i];
        uint32_t at = begin;
        add(a_.of[i], 0, begin, at, place);
        double own = tentative_[i];
        if (is_smoothed(i)) {
            // Weak entries act on the smooth vector as if they lay on the diagonal.
            double diagonal = 1;
            for (uint32_t k = level_.start[2 * i]; k < level_.start[2 * i + 2]; ++k)
                if (!is_used(i, k)) diagonal -= magnitude(level_.entry[k]) * kernel_[level_.column[k]] / kernel_[i];
            const double factor = diagonal > 0.05 ? omega / diagonal : 0;
            own *= factor > 0 ? 1 - omega : 1;
            for (uint32_t k = level_.start[2 * i]; k < level_.start[2 * i + 2]; ++k)
                if (is_used(i, k)) add(a_.of[level_.column[k]], -factor * static_cast<double>(level_.entry[k]) * tentative_[level_.column[k]], begin, at, place);
        }
        add(a_.of[i], own, begin, at, place);
    }

    void add(uint32_t aggregate, double value, uint32_t begin, uint32_t& at, Array<uint32_t>& place) {
        uint32_t p = place[aggregate];
        // Places of earlier rows lie before begin.
        if (p == undecided || p < begin) {
            p = place[aggregate] = at++;
            level_.prolongation_column[p] = aggregate;
            level_.prolongation_entry[p] = 0;
        }
        level_.prolongation_entry[p] += static_cast<float>(value);
    }

    MultigridLevel& level_;
    const Array<double>& kernel_;
    const Aggregates& a_;
    const Array<double>& norm_;
    Array<double> tentative_; // entry of T per unknown
    float strength_;
};

// Rows of P^T.
struct Transposed {
    Array<uint32_t> start, row;
    Array<float> entry;

    bool build(const MultigridLevel& level, uint32_t columns, Memory& memory) {
        const size_t total = level.prolongation_column.size();
        if (!start.allocate_filled(memory, columns + size_t{1}, 0) || !row.allocate(memory, total) || !entry.allocate(memory, total)) return false;
        for (size_t k = 0; k < total; ++k) ++start[level.prolongation_column[k]];
        uint32_t sum = 0;
        for (uint32_t c = 0; c <= columns; ++c) { sum += start[c]; start[c] = sum; }
        for (uint32_t i = level.n; i-- > 0;)
            for (uint32_t k = level.prolongation_start[i]; k < level.prolongation_start[i + 1]; ++k) {
                const uint32_t at = --start[level.prolongation_column[k]];
                row[at] = i;
                entry[at] = level.prolongation_entry[k];
            }
        return true;
    }
};

// Rows of a product that is written row by row, with room made beforehand.
struct ProductRows {
    Array<uint32_t> offset, column;
    Array<double> entry;
    size_t used = 0;

    bool begin(size_t rows, size_t expected, Memory& memory) {
        used = 0;
        return offset.allocate(memory, rows + 1) && column.allocate(memory, expected) && entry.allocate(memory, expected);
    }
    bool make_room(size_t more, Memory& memory) {
        if (used + more <= column.size()) return true;
        if (used + more > 0xf0000000u) { memory.take(SIZE_MAX); return false; }
        const size_t wanted = used + more + column.size() / 3;
        Array<uint32_t> new_column;
        Array<double> new_entry;
        if (!new_column.allocate(memory, wanted) || !new_entry.allocate(memory, wanted)) return false;
        if (used) {
            std::memcpy(new_column.data(), column.data(), used * sizeof(uint32_t));
            std::memcpy(new_entry.data(), entry.data(), used * sizeof(double));
        }
        column.swap(new_column);
        entry.swap(new_entry);
        return true;
    }
};

// A P on the scaled matrix, diagonal of A included.
bool multiply_by_prolongation(const SignedMatrix& matrix, const MultigridLevel& level, uint32_t count, ProductRows& product, Memory& memory,
                              Call* call) {
    Array<uint32_t> places;
    const uint32_t n = level.n;
    if (!places.allocate_filled(memory, count, undecided) || !product.begin(n, size_t{5} * n, memory)) return false;
    const uint32_t* start = level.prolongation_start.data();
    const uint32_t* p_column = level.prolongation_column.data();
    const float* p_entry = level.prolongation_entry.data();
    const float* scale = level.scale.data();
    uint32_t* place = places.data();
    for (uint32_t i = 0; i < n; ++i) {
        if (i % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t first = matrix.offset[i], end = matrix.offset[i + 1];
        size_t most = start[i + 1] - start[i];
        for (uint32_t k = first; k < end; ++k) most += start[matrix.column[k] + 1] - start[matrix.column[k]];
        if (!product.make_room(most, memory)) return false;
        const uint32_t begin = static_cast<uint32_t>(product.used);
        uint32_t at = begin;
        uint32_t* column = product.column.data();
        double* entry = product.entry.data();
        const double own = static_cast<double>(scale[i]);
        product.offset[i] = begin;
        for (uint32_t k = first; k <= end; ++k) {
            const uint32_t j = k < end ? matrix.column[k] : i;
            const double a = own * static_cast<double>(scale[j]) * (k < end ? matrix.entry[k] : matrix.diagonal[i]);
            for (uint32_t q = start[j]; q < start[j + 1]; ++q) {
                const uint32_t d = p_column[q];
                const double value = a * static_cast<double>(p_entry[q]);
                const uint32_t p = place[d];
                if (p != undecided && p >= begin) { entry[p] += value; continue; }
                place[d] = at;
                column[at] = d;
                entry[at++] = value;
            }
        }
        product.used = at;
    }
    product.offset[n] = static_cast<uint32_t>(product.used);
    return true;
}

// P^T (A P), a coarse row at a time.
bool galerkin(const SignedMatrix& matrix, const MultigridLevel& level, uint32_t count, CoarseMatrix& coarse, Memory& memory, Call* call) {
    Transposed transposed;
    ProductRows product, rows;
    Array<uint32_t> places;
    if (!multiply_by_prolongation(matrix, level, count, product, memory, call) || !transposed.build(level, count, memory)
        || !places.allocate_filled(memory, count, undecided) || !coarse.diagonal.allocate(memory, count)
        || !rows.begin(count, size_t{10} * count, memory))
        return false;
    const uint32_t* p_column = product.column.data();
    const double* p_entry = product.entry.data();
    uint32_t* place = places.data();
    for (uint32_t c = 0; c < count; ++c) {
        if (c % rows_between_ticks == 0 && !continues(call)) return false;
        const uint32_t first = transposed.start[c], end = transposed.start[c + 1];
        size_t most = 0;
        for (uint32_t t = first; t < end; ++t) most += product.offset[transposed.row[t] + 1] - product.offset[transposed.row[t]];
        // A row never has more entries than there are aggregates.
        if (!rows.make_room(most < count ? most : count, memory)) return false;
        const uint32_t begin = static_cast<uint32_t>(rows.used);
        uint32_t at = begin;
        uint32_t* column = rows.column.data();
        double* entry = rows.entry.data();
        double diagonal = 0;
        rows.offset[c] = begin;
        for (uint32_t t = first; t < end; ++t) {
            const uint32_t i = transposed.row[t];
            const double left = static_cast<double>(transposed.entry[t]);
            for (uint32_t k = product.offset[i]; k < product.offset[i + 1]; ++k) {
                const uint32_t d = p_column[k];
                const double value = left * p_entry[k];
                if (d == c) { diagonal += value; continue; }
                const uint32_t p = place[d];
                if (p != undecided && p >= begin) { entry[p] += value; continue; }
                place[d] = at;
                column[at] = d;
                entry[at++] = value;
            }
        }
        rows.used = at;
        coarse.diagonal[c] = diagonal;
    }
    rows.offset[count] = static_cast<uint32_t>(rows.used);
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
    const uint32_t n = level.n = matrix.n;
    size_t total = 0;
    for (uint32_t i = 0; i < n; ++i) {
        uint32_t below = 0;
        const uint32_t first = matrix.offset[i], end = matrix.offset[i + 1];
        for (uint32_t k = first; k < end; ++k) below += matrix.column[k] < i;
        total += (below + 3) / 4 * 4 + (end - first - below + 3) / 4 * 4;
    }
    if (total > 0xf0000000u) { memory.take(SIZE_MAX); return false; }
    if (!level.start.allocate(memory, 2 * size_t{n} + 1) || !level.column.allocate(memory, total)
        || !level.entry.allocate(memory, total) || !level.b.allocate(memory, n) || !level.x.allocate(memory, n))
        return false;
    uint32_t at = 0;
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t upper = 0; upper < 2; ++upper) {
            level.start[2 * size_t{i} + upper] = at;
            for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
                const uint32_t j = matrix.column[k];
                if ((j > i) != (upper == 1)) continue;
                const double unit_entry = matrix.entry[k] * static_cast<double>(level.scale[i]) * static_cast<double>(level.scale[j]);
                // Smaller ones would only make slow subnormal numbers.
                if (!(unit_entry > 1e-20 || unit_entry < -1e-20)) continue;
                level.column[at] = j;
                level.entry[at++] = static_cast<float>(unit_entry);
            }
            for (; at % 4; ++at) {
                level.column[at] = level.column[at - 1];
                level.entry[at] = 0;
            }
        }
    level.start[2 * size_t{n}] = at;
    return true;
}

bool coarsen(const SignedMatrix& matrix, MultigridLevel& level, float strength, Array<double>& near_kernel, CoarseMatrix& coarse,
             Memory& memory, Call* call) {
    for (uint32_t i = 0; i < level.n; ++i) near_kernel[i] = level.scale[i] > 0 ? near_kernel[i] / static_cast<double>(level.scale[i]) : 0;
    Aggregates a;
    if (!continues(call) || !aggregate(level, near_kernel, strength, a, memory, call) || !continues(call)) return false;
    Array<double> norm;
    if (!norm.allocate_filled(memory, a.count, 0)) return false;
    for (uint32_t i = 0; i < level.n; ++i)
        if (a.of[i] != left_out) norm[a.of[i]] += near_kernel[i] * near_kernel[i];
    for (uint32_t c = 0; c < a.count; ++c) norm[c] = std::sqrt(norm[c]);
    if (!Prolongation(level, near_kernel, a, norm, strength).build(memory, call)) return false;
    a.of.release();
    a.sign.release();
    near_kernel = static_cast<Array<double>&&>(norm);
    return galerkin(matrix, level, static_cast<uint32_t>(near_kernel.size()), coarse, memory, call);
}

} // namespace hmf
