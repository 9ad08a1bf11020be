// Coarse tubes whose radius varies by orders of magnitude: their narrow parts are rings of edges and bands of triangles
// where a foliation is 0, and their zeros are close together.
#pragma once

#include "meshes.hpp"

namespace test {

struct TubeOptions {
    size_t rings = 3, corners = 3;
    double radius = 0.3;  // of the widest section; that of the axis, a circle, is 3
    double variation = 0; // the narrowest section is smaller by up to e^variation
    bool smooth = true;   // the radius is a wave along the axis; otherwise each section has its own
    uint64_t seed = 0;
};

TubeOptions random_tube(Random& random); // 3 to 24 rings, 3 to 8 corners, variation up to 6

TriMesh closed_tube(const TubeOptions& options); // a torus; vertex i * corners + j lies on ring i
TriMesh open_tube(const TubeOptions& options);   // an annulus
TriMesh capped_tube(const TubeOptions& options); // a sphere

// Joins two random triangles by a tube of three sides, which adds a handle: rings >= 1 sections, narrower in the middle
// by a factor of `waist`.  False, and an unchanged mesh, if no two triangles without a common vertex were found.
bool add_handle(TriMesh& mesh, size_t rings, double waist, Random& random);

} // namespace test
