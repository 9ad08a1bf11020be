// Quads that lie folded over on their surface, turned back.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// Whether vertices stay on the surface, or some may leave it: the last resort where quads are too large for
// what lies between them, as boundaries and folds.
enum class Unfold { on_surface, off_surface };

// Vertices round quads that are inverted, or look inwards, move until none is, as far
// as that can be reached; in the end no more quads are inverted than before.  Off the surface it does not matter
// where quads look, and vertices leave it only where it helps and no farther than they must.
struct Unfolded {
    bool better = false; // than before
    uint64_t inverted = 0;
};
[[nodiscard]] hmf_status unfold_quads(const Mesh& mesh, const double* position, Unfold where, QuadMesh& quads,
                                      Unfolded& unfolded, Call& call);

} // namespace hmf
