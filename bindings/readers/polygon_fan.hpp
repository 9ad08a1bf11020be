// One polygon as triangles: a fan from its first corner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace readers {

class PolygonFan {
public:
    explicit PolygonFan(std::vector<uint32_t>& triangles) : triangles_(triangles) {}

    void add(uint32_t corner) {
        if (corners_ >= 2) {
            triangles_.push_back(first_);
            triangles_.push_back(previous_);
            triangles_.push_back(corner);
        } else if (corners_ == 0) first_ = corner;
        previous_ = corner;
        ++corners_;
    }
    size_t corners() const { return corners_; }

private:
    std::vector<uint32_t>& triangles_;
    uint32_t first_ = 0, previous_ = 0;
    size_t corners_ = 0;
};

} // namespace readers
