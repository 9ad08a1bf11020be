// Surfaces with boundary for the tests: meshes, loops and arcs by construction, and what
// holds for every result.
#pragma once

#include <vector>

#include "surface.hpp"

namespace test {

using Path = std::vector<uint32_t>;

// Paths of vertices on level 0.
struct Curves {
    Loops loops;
    std::vector<uint8_t> arcs;

    Curves() { loops.kind = HMF_PATH_VERTICES; }
    void add(const Path& path, bool is_arc, double weight = 1) {
        loops.add(path);
        loops.weights.push_back(weight);
        arcs.push_back(is_arc);
    }
    hmf_loop_set view() const {
        hmf_loop_set set = loops.view();
        set.arcs = arcs.data();
        return set;
    }
};

Solution solve_curves(const Hierarchy& hierarchy, const Curves& curves);

// Part of a disk with a hole: n round, m across; vertex i * (m + 1) + j at radius j.
TriMesh annulus(size_t n, size_t m, double R, double jitter, uint64_t seed);

// A rectangle of a x b with n x m cells, with jittered vertices inside.
TriMesh rectangle(size_t n, size_t m, double a, double b, double jitter, uint64_t seed);

// Number of triangles of each edge.
std::vector<int> triangles_of_edges(const LevelMesh& mesh);

// The back has the values of the front, so that they can be read again: closed, without poles, the same.
void expect_symmetric(const Solution& s);

// What holds for every result on a surface with boundary.
void expect_result(const Hierarchy& hierarchy, const Solution& s, int64_t boundaries, int64_t marks_inside = 0,
                   int64_t marks_on_boundary = 0);

// Removes the triangles near some places; keeps the largest part, without unused vertices.
TriMesh with_holes(const TriMesh& mesh, size_t holes, size_t rings, uint64_t seed);

// Holes may have met at a vertex, cut off a part, or left a disk.
bool is_sound(const TriMesh& mesh);

int64_t boundary_count(const TriMesh& mesh);

Owned<hmf_lines> levels(const Solution& s, double spacing, int32_t leaves = HMF_LEAVES_FOLIATION);

Owned<hmf_quad_mesh> quads_of(const Solution& s, const hmf_quad_options& options);

hmf_quad_options quad_options(uint64_t count, bool merge = false, uint64_t relax = 0);

// An oriented manifold of the same genus and with as many boundary curves, which lie on those of the surface.
void expect_quads_conform(const TriMesh& mesh, const hmf_quad_mesh& quads, int64_t genus);

} // namespace test
