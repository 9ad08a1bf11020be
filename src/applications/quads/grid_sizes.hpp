// The columns and rows that are built.  Of a double those of an arc or a cylinder and of its
// mirror image together: so they are symmetric, and even where the boundary crosses.
#pragma once

#include "quad_input.hpp"
#include "quad_mesh.hpp"

namespace hmf {

class GridSizes {
public:
    Array<int64_t> columns; // per side of an arc
    Array<int64_t> rows;    // per cylinder
    int64_t ring = 0;       // columns of the closed leaf, if there is no zero

    Done allocate(const QuadInput& in, Memory& memory) {
        return columns.allocate(memory, in.graph.arcs.size()) && rows.allocate(memory, in.cylinders.list.size());
    }
    void take(const QuadInput& in, const QuadSizes& sizes, const QuadWish& wish);

private:
    void tune_rows(const QuadInput& in, const QuadSizes& sizes, const QuadWish& wish);
};

} // namespace hmf
