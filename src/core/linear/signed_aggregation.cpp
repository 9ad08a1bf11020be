// Smoothed aggregation (Vanek, Mandel, Brezina 1996) with signs.  Not in [W],
// which only moves one vertex at a time.
//
//   root r and its strong neighbors       left-overs join by vote
//
//         o   o                                o   o
//          \ /                                  \ /
//       o---r---o    . . .                   o---r---o---x
//          / \                                  / \     /
//         o   o                                o   o---'
//
// The sign of a member in its aggregate is minus the sign of its entry to the
// root: that is how a smooth vector continues across the edge.  With it the aggregates of a twisted Laplacian are those
// of an ordinary one, except for an aggregate around a tripod.
//
//   T   tentative prolongation: signed near-kernel vector, cut into aggregates
//   P = (I - omega D^-1 A) T, with weak entries of A moved to the diagonal
//   coarse matrix P^T A P
#include "signed_aggregation.hpp"

#include <cmath>

#include "../base/prefetch.hpp"

namespace hmf {

namespace {

constexpr uint32_t UNDECIDED = 0xffffffffu;
constexpr uint32_t LEFT_OUT = 0xfffffffeu;     // the smoother alone is enough
constexpr uint32_t JOINED_LATER = 0x80000000u; // mark of an unknown that joined later
constexpr double OMEGA = 2.0 / 3;
// A hub is not smoothed: its row would couple all aggregates around it with
// each other, and the Galerkin product would cost the square of its degree.
constexpr uint32_t LARGEST_SMOOTHED_DEGREE = 48;
// Entries of a row of the prolongation for which there is room at first; meshes have 2 to 3 on average.
constexpr size_t EXPECTED_ENTRIES = 4;
constexpr uint32_t ROWS_OF_BLOCK = 4096;

constexpr uint8_t ON_COLUMN = 1, ON_MATRIX_ROW = 2; // the row depends strongly on the column, the column on the row

struct Aggregates {
    uint32_t count = 0;
    Array<uint32_t> of;    // aggregate per unknown, or left_out
    Array<int8_t> sign;    // per unknown
    Array<uint8_t> strong; // per entry of the matrix: on_column, on_matrix_row
};

// Which unknowns depend strongly on which, and which hardly on any.  Measured
// by the share of the entry in the row, not by |a_ij| / sqrt(a_ii a_jj): where
// weights jump by orders of magnitude the latter calls all entries of the
// lighter rows weak.
Done find_dependence(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a,
                     const Parallel& parallel, Memory& memory) {
    const uint32_t n = matrix.n;
    if (!a.of.allocate(memory, n) || !a.sign.allocate_filled(memory, n, 1, parallel)
        || !a.strong.allocate(memory, matrix.offset[n]))
        return false;
    struct Unknown {
        double kernel, least;
    }; // least: |a_ij| kernel_j of a strong entry of row i
    Array<Unknown> unknowns;
    if (!unknowns.allocate(memory, n)) return false;
    Unknown* unknown = unknowns.data();
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            unknown[i] = {kernel[i],
                          kernel[i] > 0 ? static_cast<double>(strength) * kernel[i] * matrix.diagonal[i] : 1e300};
    });
    const uint32_t total = matrix.offset[n];
    constexpr uint32_t ahead = 48;
    uint8_t* strong = a.strong.data();
    uint32_t* of = a.of.data();
    parallel.for_blocks(n, [&, total, unknown, strong, of](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Unknown own = unknown[i];
            double sum = 0;
            for (uint32_t k = matrix.offset[i], last = matrix.offset[i + 1]; k < last; ++k) {
                if (total - k > ahead) prefetch(&unknown[matrix.column[k + ahead]]);
                const Unknown other = unknown[matrix.column[k]];
                const double size = std::fabs(matrix.entry[k]), share = size * other.kernel;
                sum += share;
                strong[k] = static_cast<uint8_t>((share >= own.least) * ON_COLUMN
                                                 + (size * own.kernel >= other.least) * ON_MATRIX_ROW);
            }
            of[i] = own.kernel > 0 && sum > 0.1 * own.kernel * matrix.diagonal[i] ? UNDECIDED : LEFT_OUT;
        }
    });
    return true;
}

void take_in(const SignedMatrix& matrix, uint32_t root, bool strong_only, Aggregates& a) {
    a.of[root] = a.count;
    for (uint32_t k = matrix.offset[root]; k < matrix.offset[root + 1]; ++k) {
        const uint32_t j = matrix.column[k];
        if (a.of[j] != UNDECIDED || (strong_only && !(a.strong[k] & ON_MATRIX_ROW))) continue;
        a.of[j] = a.count;
        a.sign[j] = matrix.entry[k] < 0 ? 1 : -1;
    }
    ++a.count;
}

// Joins i to the neighboring aggregate with the largest signed vote; false if there is
// none.  vote: zeros, left as found.
bool join_by_vote(const SignedMatrix& matrix, const Array<double>& kernel, uint32_t i, double* vote, Aggregates& a) {
    const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
    const uint32_t mask = ~JOINED_LATER;
    const auto counts = [&](uint32_t of) { return of < LEFT_OUT && (of & mask) < a.count; };
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t j = matrix.column[k], of = a.of[j];
        if (counts(of)) vote[of & mask] -= matrix.entry[k] * a.sign[j] * kernel[j];
    }
    uint32_t best = UNDECIDED;
    double best_vote = -1;
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t of = a.of[matrix.column[k]];
        if (!counts(of)) continue;
        const double v = vote[of & mask], size = std::fabs(v);
        if (size <= best_vote) continue;
        best = of & mask;
        best_vote = size;
        a.sign[i] = v < 0 ? -1 : 1;
    }
    for (uint32_t k = begin; k < end; ++k) {
        const uint32_t of = a.of[matrix.column[k]];
        if (counts(of)) vote[of & mask] = 0;
    }
    if (best == UNDECIDED) return false;
    a.of[i] = best | JOINED_LATER;
    return true;
}

// The same for strong entries to members that did not join in the first pass. The members are only read, so the
// unknowns can be processed in any order. Returns best and sign, or undecided.
uint32_t core_to_join(const SignedMatrix& matrix, const Array<double>& kernel, uint32_t i, const Aggregates& a) {
    uint32_t candidate[LARGEST_SMOOTHED_DEGREE];
    double vote[LARGEST_SMOOTHED_DEGREE];
    uint32_t count = 0;
    for (uint32_t k = matrix.offset[i], end = matrix.offset[i + 1]; k < end; ++k) {
        const uint32_t j = matrix.column[k], of = a.of.data()[j];
        candidate[count] = of;
        vote[count] = -(matrix.entry[k] * a.sign.data()[j] * kernel.data()[j]);
        count += (of < a.count) & (a.strong.data()[k] & ON_COLUMN);
        if (count == LARGEST_SMOOTHED_DEGREE) break;
    }
    uint32_t best = UNDECIDED;
    double best_size = -1;
    for (uint32_t c = 0; c < count; ++c) {
        double sum = 0;
        for (uint32_t d = 0; d < count; ++d)
            sum += candidate[d] == candidate[c] ? vote[d] : 0; // NOLINT(clang-analyzer-core*): set below count
        if (std::fabs(sum) <= best_size) continue;
        best_size = std::fabs(sum);
        best = 2 * candidate[c] + (sum < 0);
    }
    return best;
}

// First to the cores only, which keeps the aggregates round.
Done join_cores(const SignedMatrix& matrix, const Array<double>& kernel, Aggregates& a, const Parallel& parallel,
                Memory& memory) {
    Array<uint32_t> choice;
    if (!choice.allocate(memory, matrix.n)) return false;
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            choice[i] = a.of[i] == UNDECIDED ? core_to_join(matrix, kernel, static_cast<uint32_t>(i), a) : UNDECIDED;
    });
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            if (choice[i] == UNDECIDED) continue;
            a.of[i] = choice[i] / 2 | JOINED_LATER;
            a.sign[i] = choice[i] % 2 ? -1 : 1;
        }
    });
    return true;
}

// Numbers the aggregates by their last members.  Meshes from a hierarchy have
// most vertices at the end, in an order in space; the roots jump about.
Done renumber(Aggregates& a, uint32_t n, Memory& memory) {
    Array<uint32_t> number;
    if (!number.allocate_filled(memory, a.count, UNDECIDED)) return false;
    uint32_t next = a.count;
    for (uint32_t i = n; i-- > 0;) {
        if (a.of[i] >= LEFT_OUT) continue;
        uint32_t& own = number[a.of[i] & ~JOINED_LATER];
        if (own == UNDECIDED) own = --next;
        a.of[i] = own;
    }
    return true;
}

Done aggregate(const SignedMatrix& matrix, const Array<double>& kernel, float strength, Aggregates& a, Call& call) {
    const uint32_t n = matrix.n;
    Memory& memory = call.memory;
    const Parallel& parallel = call.parallel;
    if (!find_dependence(matrix, kernel, strength, a, parallel, memory) || !continues(call)) return false;
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != UNDECIDED) continue;
        // Without early exit: its branch would be mispredicted half the time.
        bool has_strong = false, taken = false;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
            const uint32_t of = a.of[matrix.column[k]];
            const bool strong = a.strong[k] & ON_MATRIX_ROW;
            has_strong |= strong & (of == UNDECIDED);
            taken |= strong & (of < LEFT_OUT);
        }
        if (has_strong & !taken) take_in(matrix, i, true, a);
    }
    if (!continues(call) || !join_cores(matrix, kernel, a, parallel, memory)) return false;
    // Groups all of whose neighbors were taken, such as heavy edges among light ones: they have to stay together, or
    // the coarse level cannot move them.
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != UNDECIDED) continue;
        bool has_strong = false;
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1] && !has_strong; ++k)
            has_strong = a.of[matrix.column[k]] == UNDECIDED && (a.strong[k] & ON_MATRIX_ROW);
        if (has_strong) take_in(matrix, i, true, a);
    }
    // The remaining unknowns have weak neighbors only.
    Array<double> vote;
    for (uint32_t i = 0; i < n; ++i) {
        if (a.of[i] != UNDECIDED) continue;
        if (vote.empty() && !vote.allocate_filled(memory, n, 0)) return false;
        if (!join_by_vote(matrix, kernel, i, vote.data(), a)) take_in(matrix, i, false, a);
    }
    return renumber(a, n, memory);
}

// P for the matrix before scaling, row by row.
struct SmoothedRows {
    const SignedMatrix& matrix;
    const Array<double>& kernel;
    const Aggregates& a;
    const Array<double>& tentative; // entry of T per unknown

    // What the entries of T are multiplied with, beside those of A; 0: they are not smoothed.
    double factor(uint32_t i) const {
        const uint32_t begin = matrix.offset[i], end = matrix.offset[i + 1];
        if (end - begin > LARGEST_SMOOTHED_DEGREE) return 0;
        // Weak entries act on the smooth vector as if they lay on the diagonal.
        const double all = matrix.diagonal[i] * kernel.data()[i];
        double strong = all;
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t j = matrix.column[k];
            const bool used = (a.strong.data()[k] & ON_COLUMN) & (a.of.data()[j] != LEFT_OUT);
            strong -= std::fabs(matrix.entry[k]) * (used ? 0 : kernel.data()[j]);
        }
        return strong > 0.05 * all ? OMEGA * kernel.data()[i] / strong : 0;
    }

    // Rows of a block; false: there is no room for them.
    bool write(BlockRows<float>& out, uint32_t b, RowSums& sums) const {
        for (uint32_t i = out.first_row(b); i < out.first_row(b + 1); ++i) {
            out.begin_row(b, i);
            const uint32_t own = a.of.data()[i], begin = matrix.offset[i], end = matrix.offset[i + 1];
            if (own == LEFT_OUT) continue;
            const double smoothing = factor(i), t = tentative.data()[i];
            if (!out.has_room(b, smoothing > 0 ? end - begin + 1 : 1)) return false;
            RowSum<float> row = sums.begin(out.column(b), out.entry(b));
            row.add(own, static_cast<float>(smoothing > 0 ? (1 - OMEGA) * t : t));
            for (uint32_t k = begin; k < end && smoothing > 0; ++k) {
                const uint32_t j = matrix.column[k], of = a.of.data()[j];
                if ((a.strong.data()[k] & ON_COLUMN) && of != LEFT_OUT)
                    row.add(of, static_cast<float>(-smoothing * matrix.entry[k] * tentative.data()[j]));
            }
            sums.end(row);
            out.end_row(b, row.count);
        }
        return true;
    }
};

Done build_prolongation(const SignedMatrix& matrix, const Array<double>& kernel, const Aggregates& a,
                        const Array<double>& norm, SparseRows<float>& rows, Call& call) {
    Memory& memory = call.memory;
    const Parallel& parallel = call.parallel;
    const uint32_t n = matrix.n, slots = parallel.slots() < BLOCKS_AT_ONCE ? parallel.slots() : BLOCKS_AT_ONCE;
    Array<double> tentative;
    RowSums sums[BLOCKS_AT_ONCE];
    if (!tentative.allocate(memory, n)) return false;
    for (uint32_t s = 0; s < slots; ++s)
        if (!sums[s].allocate(a.count, memory)) return false;
    parallel.for_blocks(n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            tentative[i] = a.of[i] == LEFT_OUT ? 0 : a.sign[i] * kernel[i] / norm[a.of[i]];
    });
    const SmoothedRows smoothed{matrix, kernel, a, tentative};
    BlockRows<float> out;
    return out.write(n, ROWS_OF_BLOCK, EXPECTED_ENTRIES, call, [&](uint32_t b, uint32_t slot) {
        return smoothed.write(out, b, sums[slot]);
    }) && out.join(rows, false, memory);
}

// P by columns, the rows of each in order.  Chunks of rows count theirs in each column; how
// many chunks there are makes no difference.
Done transpose(const SparseRows<float>& rows, uint32_t columns, Prolongation& p, const Parallel& parallel,
               Memory& memory) {
    const size_t n = rows.offset.size() - 1, total = rows.offset[n];
    const uint32_t chunks = parallel.slots() < BLOCKS_AT_ONCE ? parallel.slots() : BLOCKS_AT_ONCE;
    const size_t size = (n + chunks - 1) / chunks;
    Array<uint32_t> next; // of each chunk for each column
    if (!next.allocate_filled(memory, chunks * size_t{columns}, 0) || !p.start.allocate(memory, columns + size_t{1})
        || !p.row.allocate(memory, total) || !p.entry.allocate(memory, total))
        return false;
    const auto end_of = [&](size_t begin) { return begin + size < n ? begin + size : n; };
    parallel.for_blocks(n, size, [&](size_t begin, size_t) {
        uint32_t* const count = next.data() + begin / size * columns;
        for (uint32_t k = rows.offset[begin]; k < rows.offset[end_of(begin)]; ++k) ++count[rows.column[k]];
    });
    uint32_t sum = 0;
    for (uint32_t c = 0; c < columns; ++c) {
        p.start[c] = sum;
        for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
            uint32_t& at = next[chunk * size_t{columns} + c];
            const uint32_t count = at;
            at = sum;
            sum += count;
        }
    }
    p.start[columns] = sum;
    parallel.for_blocks(n, size, [&](size_t begin, size_t end) {
        uint32_t* const at = next.data() + begin / size * columns;
        for (size_t i = begin; i < end; ++i)
            for (uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
                const uint32_t place = at[rows.column[k]]++;
                p.row.data()[place] = static_cast<uint32_t>(i);
                p.entry.data()[place] = rows.entry[k];
            }
    });
    return true;
}

} // namespace

Done unit_diagonal_scale(const SignedMatrix& matrix, double threshold, Array<float>& scale, const Parallel& parallel,
                         Memory& memory) {
    if (!scale.allocate(memory, matrix.n)) return false;
    parallel.for_blocks(matrix.n, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            scale[i] = matrix.diagonal[i] > threshold ? static_cast<float>(1 / std::sqrt(matrix.diagonal[i])) : 0.0f;
    });
    return true;
}

Done coarsen(const SignedMatrix& matrix, MultigridLevel& level, float strength, Array<double>& near_kernel,
             CoarseMatrix& coarse, Call& call) {
    Memory& memory = call.memory;
    const Parallel& parallel = call.parallel;
    const uint32_t n = matrix.n;
    for (uint32_t i = 0; i < n; ++i)
        if (!(level.scale[i] > 0)) near_kernel[i] = 0;
    Aggregates a;
    if (!continues(call) || !aggregate(matrix, near_kernel, strength, a, call) || !continues(call)) return false;
    const uint32_t count = a.count;
    Array<double> norm;
    if (!norm.allocate_filled(memory, count, 0)) return false;
    for (uint32_t i = 0; i < n; ++i)
        if (a.of[i] != LEFT_OUT) norm[a.of[i]] += matrix.diagonal[i] * near_kernel[i] * near_kernel[i];
    for (uint32_t c = 0; c < count; ++c) norm[c] = std::sqrt(norm[c]);
    SparseRows<float> rows;
    if (!build_prolongation(matrix, near_kernel, a, norm, rows, call)) return false;
    a.sign.release();
    a.strong.release();
    near_kernel = static_cast<Array<double>&&>(norm);
    Prolongation& p = level.prolongation;
    if (!transpose(rows, count, p, parallel, memory) || !p.share(a.of, parallel, memory)) return false;
    a.of.release();
    return galerkin(matrix, p, rows, coarse, call);
}

} // namespace hmf
