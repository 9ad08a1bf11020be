// The surface with boundary of a double: the double without its back, where points would be seen from behind.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_mesh.hpp"

namespace hmf {

class FrontSurface {
public:
    Done build(const Mesh& whole, const Reflection& reflection, Memory& memory);

    // Triangles behind have the number NONE.
    const Mesh& mesh() const { return mesh_; }

    // Vertices of the quads that were found behind lie in front from then on, those of the boundary on its edges; one
    // stays where it is if it is not known on which edge it lies.
    void bring_forward(const double* position, QuadMesh& quads) const;

private:
    uint32_t rim_at(const double* position, uint32_t side, const Point& p) const;

    const Reflection* reflection_ = nullptr;
    Array<uint32_t> face_;
    Mesh mesh_;
};

} // namespace hmf
