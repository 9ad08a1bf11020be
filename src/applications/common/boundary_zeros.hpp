// The zeros of a cluster with vertices of the boundary, and the arcs along it; the
// double is exactly symmetric.
//
// A ring of vertices around a tube, off the boundary, is taken apart in the same way: each is its own root.
//
// Every vertex of the cluster belongs to the vertex of the boundary that is nearest
// along zero edges, its root.  Prongs leave at closed corners; their roots and the
// marked vertices of the boundary are the places of zeros.  A run is a part of the circle
// between closed corners that belongs to one place: a sector there.  Sides that belong to no place lie between two
// runs, beside the arc that joins their places.
#pragma once

#include "../../core/leaves/critical_graph.hpp"
#include "../../core/leaves/mirror_symmetry.hpp"

namespace hmf {

// For CriticalGraph::division.  The reflection outlives it.
ClusterDivision division_at_boundary(const Reflection& reflection);

} // namespace hmf
