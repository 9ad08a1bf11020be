// Which quad is nearest to a point in space.
#pragma once

#include "box_tree.hpp"
#include "quad_mesh.hpp"

namespace hmf {

// Each quad is two triangles along its shorter diagonal.
class NearestQuads {
public:
    Done build(const QuadMesh& quads, Memory& memory);

    struct Place {
        uint32_t quad = NONE;
        double square = HUGE_VAL; // of the distance
        uint64_t steps = 0;       // elementary ones of the search
    };
    // The nearest quad, or one whose squared distance is at most `enough`.  The quad found before is tried first, as
    // points that follow each other are near to each other.
    Place find(const Point& p, double enough);

private:
    double square_to(const Point& p, uint32_t q) const;

    const QuadMesh* quads_ = nullptr;
    BoxTree tree_;
    uint32_t last_ = 0;
};

} // namespace hmf
