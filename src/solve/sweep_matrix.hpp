// The matrix of a level of the multigrid, for Gauss-Seidel sweeps on several threads.
//
// Symmetric, scaled to unit diagonal, in single precision.  The rows are cut into
// parts of some thousand that lie together.  A row that touches a part before its
// own belongs to the border:
//
//      part 0   | part 1   | part 2          order of a sweep: the parts, which do
//      o-o-o-o  |          |                 not touch each other, on several threads;
//      | | | |  B-o-o-o-o  |                 then the border.  Backward the other way
//      o-o-o-o--B | | | |  B-o-o             round.
//               B-o-o-o-o--B | |
//
// So it is one Gauss-Seidel sweep over all rows, in an order that comes from the
// matrix alone: no coupling is given up, and the bits are those of one thread.
#pragma once

#include "signed_matrix.hpp"

namespace hmf {

class SweepMatrix {
public:
    // scale: of each row and column; 0 leaves them out.
    Done build(const SignedMatrix& matrix, const float* scale, const Parallel& parallel, Memory& memory);
    // Takes the values of another matrix with the same columns, in the rows with changed[i] != 0.
    void refresh(const SignedMatrix& matrix, const float* scale, const uint8_t* changed, const Parallel& parallel);

    // x after a sweep from 0, and what is left of b then.  x has to be finite before.
    void forward(const float* b, float* x, float* residual, const Parallel& parallel) const;
    // x after a sweep in the opposite order; b is used up.
    void backward(float* b, float* x, const Parallel& parallel) const;
    // y = A x.
    void multiply(const float* x, float* y, const Parallel& parallel) const;
    // x A x.
    double energy(const float* x, const Parallel& parallel) const;

    double stored_entries() const { return static_cast<double>(group_.size()) * Group::size; }

private:
    // Entries of a row in columns that come before it in the sweep; those that come after it are
    // the transpose.  Filled up with zeros: most rows of a mesh have one group, and the
    // end of a loop whose length varies would be mispredicted in each row.
    struct Group {
        static constexpr uint32_t size = 5;
        uint32_t row;
        uint32_t column[size];
        float entry[size];

        void clear(uint32_t i); // zeros; the row stays
        float product(const float* x) const;
        void subtract(float value, float* y) const;
    };

    // The larger the parts the shorter the border, 5 % of the rows with these numbers; but there
    // have to be enough parts for the threads, and a part takes 5 times as long as waking a thread.
    static constexpr uint32_t rows_of_part = 16384, rows_of_small_part = 8192, enough_parts = 32, most_parts = 255;

    // Groups of a part or of the border.
    struct Range {
        uint32_t begin = 0, end = 0;
    };
    static constexpr uint32_t no_room = 255; // that many groups of a row, or more

    static uint32_t parts_of(uint32_t n);
    Done share_rows(const SignedMatrix& matrix, Array<uint8_t>& own, const Parallel& parallel, Memory& memory) const;
    Done cut(const SignedMatrix& matrix, Array<uint8_t>& room, const Parallel& parallel, Memory& memory);
    template <class Before>
    static Group* write_row(const SignedMatrix& matrix, const float* scale, Before before, Group* at, const Group* end);
    Group* write_row_of(const SignedMatrix& matrix, const float* scale, uint32_t part, uint32_t i, Group* at);
    template <class Row>
    void for_rows(uint32_t part, Row row) const;

    uint32_t parts_ = 1;
    Array<uint8_t> part_; // of each row; parts_: the border
    Array<Group> group_;  // by parts, the border last; before and after each is one that belongs to no row
    Array<Range> range_;  // of each part, and of the border; not in place: many matrices lie on one stack
};

} // namespace hmf
