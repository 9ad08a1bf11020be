// A column at a time; by symmetry that is a row:
//
//     column c of P  --A-->  column of A P, some 70 rows  --P^T-->  some 10 coarse rows
#include "galerkin.hpp"

#include "../base/prefetch.hpp"

namespace hmf {

namespace {

// Entries of a coarse row for which there is room at first; meshes have 10 to 18 on average.
constexpr size_t PRODUCT_EXPECTED_ENTRIES = 24;
constexpr uint32_t PRODUCT_ROWS_OF_BLOCK = 512; // a row takes 1 to 2 microseconds
// The rows of A are met in no order: their memory is asked for product_rows_ahead.
constexpr uint32_t PRODUCT_ROWS_AHEAD = 16;

uint32_t longest(const uint32_t* offset, size_t n) {
    uint32_t most = 0;
    for (size_t i = 0; i < n; ++i) most = offset[i + 1] - offset[i] > most ? offset[i + 1] - offset[i] : most;
    return most;
}

// What a task needs for itself.
struct Scratch {
    RowSums fine, sum; // columns of A P and of the whole product
    Array<uint32_t> fine_index, sum_index;
    Array<double> fine_value, sum_value;

    // most: entries of a column of A P.
    Done allocate(uint32_t n, uint32_t count, size_t most, Memory& memory) {
        return fine.allocate(n, memory) && sum.allocate(count, memory) && fine_index.allocate(memory, most + 1)
            && fine_value.allocate(memory, most + 1) && sum_index.allocate(memory, count + size_t{1})
            && sum_value.allocate(memory, count + size_t{1});
    }
};

struct Product {
    const SignedMatrix& matrix;
    const Prolongation& columns;
    const SparseRows<float>& rows;

    // Column c, into the scratch; returns the number of its entries.
    uint32_t multiply(uint32_t c, Scratch& s) const {
        const uint32_t* row = columns.row.data();
        const uint32_t total = static_cast<uint32_t>(columns.row.size());
        RowSum<double> fine = s.fine.begin(s.fine_index.data(), s.fine_value.data());
        for (uint32_t t = columns.start[c], end = columns.start[c + size_t{1}]; t < end; ++t) {
            if (total - t > 2 * PRODUCT_ROWS_AHEAD) prefetch(&matrix.offset[row[t + 2 * PRODUCT_ROWS_AHEAD]]);
            if (total - t > PRODUCT_ROWS_AHEAD) {
                const uint32_t soon = row[t + PRODUCT_ROWS_AHEAD], at = matrix.offset[soon];
                prefetch(&matrix.diagonal[soon]);
                prefetch(&matrix.column[at]);
                prefetch(&matrix.entry[at]);
            }
            const uint32_t j = row[t];
            const double factor = static_cast<double>(columns.entry[t]);
            fine.add(j, factor * matrix.diagonal[j]);
            for (uint32_t k = matrix.offset[j], last = matrix.offset[j + 1]; k < last; ++k)
                fine.add(matrix.column[k], factor * matrix.entry[k]);
        }
        s.fine.end(fine);
        RowSum<double> sum = s.sum.begin(s.sum_index.data(), s.sum_value.data());
        const uint32_t* const offset = rows.offset.data();
        const uint32_t* const column = rows.column.data();
        const float* const entry = rows.entry.data();
        for (uint32_t f = 0; f < fine.count; ++f) {
            const uint32_t i = fine.column[f];
            const double value = fine.entry[f];
            for (uint32_t q = offset[i], last = offset[i + size_t{1}]; q < last; ++q)
                sum.add(column[q], static_cast<double>(entry[q]) * value);
        }
        s.sum.end(sum);
        return sum.count;
    }

    // Rows of a block; false: there is no room for them.
    bool write(BlockRows<double>& out, uint32_t b, Array<double>& diagonal, Scratch& s) const {
        for (uint32_t c = out.first_row(b); c < out.first_row(b + 1); ++c) {
            const uint32_t count = multiply(c, s);
            if (!out.has_room(b, count)) return false;
            out.begin_row(b, c);
            uint32_t* const column = out.column(b);
            double* const entry = out.entry(b);
            uint32_t used = 0;
            for (uint32_t d = 0; d < count; ++d) {
                column[used] = s.sum_index[d];
                entry[used] = s.sum_value[d];
                const bool on_diagonal = s.sum_index[d] == c;
                if (on_diagonal) diagonal[c] = s.sum_value[d];
                used += !on_diagonal;
            }
            out.end_row(b, used);
        }
        return true;
    }
};

} // namespace

Done galerkin(const SignedMatrix& matrix, const Prolongation& columns, const SparseRows<float>& rows,
              CoarseMatrix& coarse, Call& call) {
    Memory& memory = call.memory;
    const Parallel& parallel = call.parallel;
    const uint32_t count = static_cast<uint32_t>(columns.columns());
    const size_t bound = size_t{longest(columns.start.data(), count)} * (longest(matrix.offset, matrix.n) + 1);
    const uint32_t slots = parallel.slots() < BLOCKS_AT_ONCE ? parallel.slots() : BLOCKS_AT_ONCE;
    Scratch scratch[BLOCKS_AT_ONCE];
    for (uint32_t s = 0; s < slots; ++s)
        if (!scratch[s].allocate(matrix.n, count, bound < matrix.n ? bound : matrix.n, memory)) return false;
    if (!coarse.diagonal.allocate_filled(memory, count, 0)) return false;
    const Product product{matrix, columns, rows};
    BlockRows<double> out;
    return out.write(count, PRODUCT_ROWS_OF_BLOCK, PRODUCT_EXPECTED_ENTRIES, call, [&](uint32_t b, uint32_t slot) {
        return product.write(out, b, coarse.diagonal, scratch[slot]);
    }) && out.join(coarse.rows, true, memory);
}

} // namespace hmf
