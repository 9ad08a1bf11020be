// Leaves of a cylinder as rulers, some at a time on the threads of the host.
#pragma once

#include "quad_input.hpp"

namespace hmf {

struct LeafRow {
    Ruler ruler;         // once round, from the path across the cylinder
    int64_t height = 0;  // half units above the lower side
    uint64_t piece = 0;  // of the path, where the leaf crosses it
    uint64_t points = 0; // that the ruler needs
};

class LeafRows {
public:
    static constexpr uint32_t MOST = 32; // at a time

    LeafRows(const QuadInput& in, Call& call);

    // How many of a cylinder are read at a time, so that they take no more memory than the mesh.
    uint32_t at_a_time(uint32_t cylinder) const;
    // The leaves at the heights of the rows from begin to end.
    [[nodiscard]] hmf_status read(uint32_t cylinder, uint32_t begin, uint32_t end);

    LeafRow& operator[](uint32_t i) { return row_[i]; }

private:
    void follow_leaf(uint32_t cylinder, LeafRow& row) const;

    const QuadInput& in_;
    Call& call_;
    LeafRow row_[MOST + 1];
};

} // namespace hmf
