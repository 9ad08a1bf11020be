// The sides of triangles, those between the same two vertices together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace readers {

// A side is 3 * triangle + corner; it joins that corner and the next one of its triangle.
inline uint32_t next_corner(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }

// Groups of one kind: group g has the members order[starts[g]] to order[starts[g + 1] - 1], by number.
struct Groups {
    std::vector<uint32_t> order, starts;
    size_t count() const { return starts.size() - 1; }
    size_t size_of(size_t group) const { return starts[group + 1] - starts[group]; }
    const uint32_t* begin_of(size_t group) const { return order.data() + starts[group]; }
    const uint32_t* end_of(size_t group) const { return order.data() + starts[group + 1]; }
};

// One group for each pair of vertices that a side joins.  Linear time.  Throws MeshError above 2^31 / 3 triangles.
Groups group_sides(const std::vector<uint32_t>& triangles, size_t vertex_count);

// One group for each set of three vertices that a triangle has.
Groups group_triangles(const std::vector<uint32_t>& triangles, size_t vertex_count);

// Classes of numbers that become fewer; the least number of a class stands for it.
class Classes {
public:
    explicit Classes(size_t count) : parent_(count) {
        for (size_t i = 0; i < count; ++i) parent_[i] = static_cast<uint32_t>(i);
    }
    uint32_t of(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(uint32_t i, uint32_t j) {
        i = of(i);
        j = of(j);
        if (i < j) parent_[j] = i;
        else parent_[i] = j;
    }

private:
    std::vector<uint32_t> parent_;
};

} // namespace readers
