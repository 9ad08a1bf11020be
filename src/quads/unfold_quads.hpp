// Quads that lie folded over on their surface, turned back.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// Vertices round quads that are inverted, or look inwards, move on the surface until none is, as far
// as that can be reached; in the end no more quads are inverted than before.
// turned: whether that made it better.
[[nodiscard]] hmf_status unfold_quads(const Mesh& mesh, const double* position, QuadMesh& quads, bool& turned,
                                      Call& call);

} // namespace hmf
