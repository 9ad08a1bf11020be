// The matrix of a level of the multigrid, for Gauss-Seidel sweeps on several threads.
//
// Symmetric, scaled to unit diagonal, in single precision.  The rows are cut into
// parts of some thousand that lie together.  A row that touches a part before its
// own belongs to the border:
//
//      part 0   | part 1   | part 2          order of a sweep: the parts, which do
//      o-o-o-o  |          |                 not touch each other, on several threads;
//      | | | |  B-o-o-o-o  |                 then the border.  Backward the other way
//      o-o-o-F--B | | | |  B-o-o             round.
//               B-o-o-o-F--B | |
//
// So it is one Gauss-Seidel sweep over all rows, in an order that comes from the
// matrix alone: no coupling is given up, and the bits are those of one thread.
//
// Rows are numbered by parts, and in each first those that touch nothing else (o), then those that touch the border of
// another part (F), then its border: columns of the first, nine in ten, are 16-bit numbers within the part.
//
// Where conjugate gradients ask for a backward sweep and then for a forward one, they need no product with A.
// The backward sweep solves each row with what comes after it new and what comes before it old:
//
//      z_i = g_i - sum of a_ij z_j, j after i, - sum of a_ij x_j, j before i      x: before the sweep
//
//      (A z)_i = g_i - sum of a_ij (x_j - z_j), j before i
//
// and the next forward sweep reads those entries anyway.
#pragma once

#include "signed_matrix.hpp"

namespace hmf {

// Added to right sides in single precision: far from their support the sweeps would decay into subnormal
// numbers, which are slow.
constexpr float FLOOR_VALUE = 1e-25f;

// z: x after the backward sweep.
struct StepSums {
    double zr = 0, zAz = 0, zq = 0; // z * g, z * A z, z * A p
    void operator+=(const StepSums& other) {
        zr += other.zr;
        zAz += other.zAz;
        zq += other.zq;
    }
};

// Vectors of conjugate gradients beside the residual g, which is the right side of the sweeps, and their x.
struct StepVectors {
    float* product = nullptr;    // A p
    float* direction = nullptr;  // p
    float* solution = nullptr;   // the sum of the steps
    float* difference = nullptr; // x before the backward sweep - x after it
    // Of a residual, for the largest row; negative: the unknown is held.  Null: neither is asked for.
    float* row_scale = nullptr;
    // Room for those of each segment of the matrix: too much for the stack.
    StepSums* sums = nullptr;
};

// Of a residual: the square of its 2-norm, and the largest row with its scale.
struct ResidualNorms {
    double squares = 0, largest_row = 0;
    void operator+=(const ResidualNorms& other) {
        squares += other.squares;
        if (other.largest_row > largest_row) largest_row = other.largest_row;
    }
};

class SweepMatrix {
public:
    // scale: of each row and column; 0 leaves them out.  renumber: also by where rows lie, so that vectors are
    // read in order.
    Done build(const SignedMatrix& matrix, const float* scale, bool renumber, const Parallel& parallel, Memory& memory);
    // Takes the values of another matrix with the same columns, in the rows with changed[i] != 0.
    void refresh(const SignedMatrix& matrix, const float* scale, const uint8_t* changed, const Parallel& parallel);
    // Where vectors have row i of the matrix.
    uint32_t number(size_t i) const { return number_.empty() ? static_cast<uint32_t>(i) : number_.data()[i]; }

    // x after a sweep from 0; it has to be finite before.  row_scale: as in StepVectors, or null.
    void forward(const float* b, float* x, const Parallel& parallel, const float* row_scale = nullptr) const;
    // What a forward sweep has left of b.
    void find_rest(const float* x, float* rest, const Parallel& parallel) const;
    // x after a sweep in the opposite order.
    void backward(const float* b, float* x, const Parallel& parallel) const;
    // The same, and what the next step needs.
    StepSums backward_to_step(const float* g, float* x, const StepVectors& v, const Parallel& parallel) const;
    // The step: p = z + beta p, A p = A z + beta A p, solution += alpha p, g -= alpha A p; and a forward sweep.
    ResidualNorms step_forward(float alpha, float beta, float* g, float* x, const StepVectors& v,
                               const Parallel& parallel) const;

    uint32_t segments() const { return kinds * parts_; }

private:
    // Entries of a row, padded with zeros: most rows of a mesh have one group of entries before the row in a sweep and
    // one after it, and the end of a loop of variable length would be mispredicted in each row.
    static constexpr uint32_t GROUP_SIZE = 4;
    template <class Column>
    struct Group {
        static constexpr Column FIRST = static_cast<Column>(Column{1} << (8 * sizeof(Column) - 1));
        Column column[GROUP_SIZE]; // the first one marked in the first group of a row
        float entry[GROUP_SIZE];

        bool is_first() const { return column[0] & FIRST; }
        Column column_at(uint32_t t) const { return static_cast<Column>(column[t] & static_cast<Column>(~FIRST)); }
        float product(const float* x) const;
    };
    // What comes before each row and after it; at the end of each a group that belongs to no row.
    template <class Column>
    struct Groups {
        Array<Group<Column>> lower, upper;
    };
    using Narrow = uint16_t;
    using Wide = uint32_t;

    static uint32_t groups_of(uint32_t entries) { return entries == 0 ? 1 : (entries - 1) / GROUP_SIZE + 1; }

    // The larger the parts the shorter the border, 5 % of the rows with these numbers; but there
    // have to be enough parts for the threads, and a part takes 5 times as long as waking a thread.
    static constexpr uint32_t PART_BITS = 14, SMALL_PART_BITS = 13, SMALL_PART = 1 << SMALL_PART_BITS;
    static constexpr uint32_t NARROW_BITS = 15; // of the columns of a part, beside the mark
    static constexpr uint32_t ENOUGH_PARTS = 32, MOST_PARTS = 255;

    enum Kind : uint32_t { inner, fringe, border, kinds };
    // Rows of one kind in one part, one after the other.
    struct Segment {
        uint32_t row = 0, rows = 0;
        uint32_t lower = 0, lower_end = 0, upper = 0, upper_end = 0; // their groups
        uint32_t mark = 0;                                           // the first one of its marks
    };
    // Where the groups of every rows_of_mark-th row of a segment begin.
    struct Mark {
        uint32_t lower, upper;
    };
    static constexpr uint32_t ROWS_OF_MARK = 32;

    struct Order;
    struct Before;
    template <class Column>
    struct Side;
    static constexpr uint32_t NO_ROOM = 255; // that many groups of a row, or more

    const Segment& segment(uint32_t part, Kind kind) const { return segment_.data()[kinds * part + kind]; }
    uint32_t base(uint32_t part) const { return part << shift_; } // of narrow columns
    Done list_in_space(const SignedMatrix& matrix, Order& order, const Parallel& parallel, Memory& memory) const;
    void set_kinds(const SignedMatrix& matrix, Order& order, const Parallel& parallel) const;
    Done set_numbers(uint32_t n, Order& order, const Parallel& parallel, Memory& memory);
    Done lay_out(const SignedMatrix& matrix, Order& order, const Parallel& parallel, Memory& memory);
    uint32_t entries_before(const SignedMatrix& matrix, const Order& order, uint32_t i) const;
    template <class Column>
    void write_rows(const SignedMatrix& matrix, const float* scale, const Order& order, const Segment& at,
                    uint32_t first_column, Groups<Column>& groups);
    template <class Column>
    static void refresh_row(const SignedMatrix& matrix, const float* scale, uint32_t i, const SweepMatrix& numbers,
                            uint32_t first_column, Group<Column>* low, Group<Column>* up, uint32_t own);
    template <class Visit>
    void for_kind(uint32_t part, Kind kind, Visit visit) const;
    template <class Sweep>
    void forward_by(const Parallel& parallel, Sweep sweep) const;
    template <class Sweep>
    void backward_by(const Parallel& parallel, Sweep sweep) const;

    uint32_t parts_ = 1, shift_ = 31; // row number k is of part k >> shift_
    Array<uint32_t> number_;          // of each row of the matrix; empty: its own
    Array<Segment> segment_;          // kinds of each part
    Array<Mark> mark_;
    Groups<Narrow> narrow_; // of the inner rows
    Groups<Wide> wide_;     // of the others
};

} // namespace hmf
