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
    // step: length of an edge in the flat metric; number: of quads, 0 if that follows from the step.
    void take(const QuadInput& in, const QuadSizes& sizes, double step, double number);

private:
    void tune_rows(const QuadInput& in, const QuadSizes& sizes, double step, double number);
};

} // namespace hmf
