// Surfaces with two triangulations each, one of them far from Delaunay, and vertices of high valence.  Genus 1 if
// nothing else is said.
#pragma once

#include "meshes.hpp"

namespace test {

enum class Strips { ladder, fans };

// A ring of square section with four flat outer walls.  Each wall has n more vertices at random heights on its two
// vertical sides, and is triangulated as a ladder or as two fans.  The numbers of the vertices are the same.
TriMesh walled_ring(size_t n, Strips strips, uint64_t seed = 1);
std::vector<uint32_t> walled_ring_longitude(); // vertices of a loop around the axis
// A ring of square section of n segments, 8 divides n.  Its flat top and bottom are ladders, or fans over an eighth
// of the circles each.
TriMesh flat_ring(size_t n, Strips strips);
// A coarse torus; in `hubs` of its triangles lies a circle of n vertices with a hub in the middle, raised by lift.
TriMesh wheels(size_t n, size_t hubs, double lift = 0);
// A polygon of n corners, in space, that a fan from its first corner triangulates: a disk.
TriMesh fan_polygon(size_t n);

} // namespace test
