// Loops drawn by picked points: --through.
#pragma once

#include <string>

#include "read_loops.hpp"
#include "read_mesh.hpp"

namespace cli {

// Closed paths of vertices: the shortest way along edges from each picked vertex to the next, and from the last to the
// first.  "12 57 103" are vertices, "0,1.5,0.5 1,1.5,0.5 0.5,1.5,0" places, of which the nearest vertices are taken;
// ";" begins another loop.  `lines` are the numbers of the loops, from 1.  Throws Failure.
LoopList draw_loops(const std::string& picked, const TriangleMesh& mesh);

} // namespace cli
