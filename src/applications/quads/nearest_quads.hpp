// The quads near each vertex of the surface.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_shape.hpp"

#include <cmath>

namespace hmf {

// Each vertex of the surface belongs to the vertex of the quads that is nearest along edges of the surface, its owner,
// and is compared with the quads around that.
class NearestQuads {
public:
    // stars: of the quads.  front: of a double, only vertices in front have owners; NULL: the surface is closed.
    Done build(const Mesh& mesh, const double* position, const Reflection* front, const QuadMesh& quads,
               const QuadStars& stars, Call& call);

    uint32_t owner(uint32_t x) const { return owner_[x]; }   // NONE: x is not in front
    uint32_t before(uint32_t x) const { return before_[x]; } // the vertex before x on the path from its owner; NONE

    struct Place {
        uint32_t quad = NONE;
        double square = HUGE_VAL; // of the distance
    };
    // The nearest of the quads around the owner, each of them two triangles along its shorter diagonal; no quad if
    // its squared distance is at most `least`.
    Place find(uint32_t x, double least) const;

private:
    const double* position_ = nullptr;
    const QuadMesh* quads_ = nullptr;
    const QuadStars* stars_ = nullptr;
    Array<uint32_t> owner_, before_;
};

} // namespace hmf
