// From a level of the multigrid to the next coarser one and back, on several threads.
//
// By columns, one for each coarse unknown.  Blocks of columns own the rows of their
// aggregates.  A column also has a few rows that other blocks own, where aggregates
// of both touch:
//
//     column   | own rows          | rows of others |     restriction: all of them
//
//     block    | own columns, own rows | own rows, columns of others |   prolongation
#pragma once

#include "sweep_matrix.hpp"

namespace hmf {

struct Prolongation {
    Array<uint32_t> start; // columns + 1
    Array<uint32_t> row;
    Array<float> entry;

    bool empty() const { return start.empty(); }
    size_t columns() const { return own_end_.size(); }

    // Once start, row and entry are there.  of: for each row the column of its
    // aggregate; rows without one are in no column.
    Done share(const Array<uint32_t>& of, const Parallel& parallel, Memory& memory);
    // Each entry times coarse[column] / fine[row].
    void scale(const float* coarse, const float* fine, const Parallel& parallel);
    // The rows get the numbers that vectors have.
    void renumber(const SweepMatrix& fine, const Parallel& parallel);
    // coarse = floor + P^T fine.  next: has the numbers of the coarse unknowns; null: their own.
    void restrict_to(float* coarse, const float* fine, float floor, const SweepMatrix* next,
                     const Parallel& parallel) const;
    // fine += P coarse.
    void add_to(float* fine, const float* coarse, const SweepMatrix* next, const Parallel& parallel) const;

private:
    struct Other {
        uint32_t column, at; // in row and entry
    };
    size_t block() const { return Parallel::pass_block(columns()); }

    Array<uint32_t> own_end_;     // columns
    Array<Other> other_;          // entries of own rows in columns of others, by the block of the row
    Array<uint32_t> other_start_; // where those of each block begin
};

} // namespace hmf
