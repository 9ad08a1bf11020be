// Surfaces as they come out of volumes: {field = 0} by marching tetrahedra,
// with the slivers and needles where the surface passes close to grid points.
#pragma once

#include "meshes.hpp"

namespace test {

// The largest component of {field > 0} in the unit cube, on a grid of n^3 cells
// of six tetrahedra each (Kuhn); outside of the cube the field counts as
// negative.  A vertex keeps the share `least` of its grid edge from either end.
// Closed and manifold by construction; genus is counted.  No triangles if
// the field is nowhere positive.
TriMesh implicit_surface(size_t n, double least, const std::function<double(double, double, double)>& field);

// A random field: blobs, a gyroid cut out by a box or ball, or a sum of waves.
// `frequency` decides the genus.
TriMesh random_implicit_surface(size_t n, double frequency, Random& random);

} // namespace test
