// A surface cut into a polygon: a tree of edges through all vertices, and one of
// edges that are crossed through all triangles (Eppstein, Dynamic generators of
// topologically embedded graphs, 2003).  2 * genus edges are in neither.
#pragma once

#include "../base/memory.hpp"
#include "../mesh/mesh.hpp"

namespace hmf {

enum class EdgeKind : uint8_t { side, in_tree, across }; // of the polygon, or the tree, or inside the polygon

// Per edge.  The tree starts at vertex 0.
Done find_trees(const Mesh& mesh, Array<EdgeKind>& kind, Call& call);

} // namespace hmf
