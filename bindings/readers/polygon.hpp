// One face of a file on its way into a mesh.  It may have any number of corners.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh_formats.hpp"

namespace readers {

// Adds a fan from the first corner; triangulate_polygons replaces it when all vertices are known.
class Polygon {
public:
    explicit Polygon(TriangleMesh& mesh) : mesh_(mesh) {}

    void add(uint32_t corner) {
        if (corners_ >= 2) mesh_.triangles.insert(mesh_.triangles.end(), {first_, previous_, corner});
        else if (corners_ == 0) first_ = corner;
        previous_ = corner;
        ++corners_;
    }
    size_t corners() const { return corners_; }
    // line: of the file, 0 where it has none.
    void end(size_t line) { mesh_.origin.add_face(mesh_.triangle_count(), line); }

private:
    TriangleMesh& mesh_;
    uint32_t first_ = 0, previous_ = 0;
    size_t corners_ = 0;
};

// Cuts the polygons of a mesh that consists of fans.  A convex polygon of few corners stays a fan, unless a triangle of
// it has no area.  Any other one is cut along diagonals inside it: concave faces do not fold, corners on a straight
// side make no triangle without area where the polygon has one, and triangles are Delaunay within it.  A polygon of n
// corners gives n - 2 triangles; it takes O(n sqrt n) time at worst, unless it crosses itself.
void triangulate_polygons(TriangleMesh& mesh);

} // namespace readers
