// Test meshes, made by formula: the same on every machine up to the last bits
// of sin and cos.  Each is closed, connected, oriented and manifold; genus is
// what the maker intends, and mesh_defect checks it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace test {

struct TriMesh {
    std::vector<double> positions;   // 3 per vertex
    std::vector<uint32_t> triangles; // 3 per triangle, counter-clockwise from outside
    size_t genus = 0;

    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return triangles.size() / 3; }
};

inline void add_triangle(TriMesh& mesh, uint32_t a, uint32_t b, uint32_t c) {
    mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
}

constexpr double PI = 3.14159265358979323846;

// Deterministic random numbers (splitmix64).
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t bits();
    double unit(); // [0, 1)
    size_t below(size_t n) { return static_cast<size_t>(bits() % n); }

private:
    uint64_t state_;
};

// Numbers are drawn one in a statement, here and wherever a mesh is random: in which order a compiler evaluates the
// arguments of a call is its own choice, and another order is another mesh.

// Empty if the mesh is a closed, connected, oriented manifold of its genus,
// else a sentence.
std::string mesh_defect(const TriMesh& mesh);

// --- Makers ------------------------------------------------------------------

struct TorusOptions {
    bool random_diagonals = false; // not Delaunay
    double stretch = 1;            // factor along x
    double jitter = 0;             // shift of the angles, in cells
    uint64_t seed = 1;
};

// Around the z axis; vertex i * m + j lies at angle 2 pi i / n around the axis
// and 2 pi j / m around the tube (without jitter).
TriMesh torus(size_t n, size_t m, double R, double r, const TorusOptions& options = {});

// Surface of the cells (i, j, k) with filled(i, j, k); the cell boundaries lie at
// xs, ys, zs.  Cells that touch along an edge or in a corner only are not allowed.
TriMesh voxel_surface(const std::vector<double>& xs, const std::vector<double>& ys, const std::vector<double>& zs,
                      const std::function<bool(size_t, size_t, size_t)>& filled);

// Plate of (2 g + 1) x 3 x 1 unit cells with g square holes in a row: hole k
// (from 0) spans x in [2k + 1, 2k + 2], y in [1, 2].
TriMesh plate(size_t holes);

// The same with edges of very different lengths: triangles of aspect about `aspect`.
TriMesh thin_plate(size_t holes, double aspect);

// Moves the first vertex of a triangle to the middle of the other two: flat, or flat up to rounding.
void flatten(TriMesh& mesh, size_t triangle, bool up_to_rounding);

// plate, refined and rounded.
TriMesh pretzel(size_t holes, size_t refinements, size_t smoothings = 4);

// Tube along the trefoil knot.
TriMesh trefoil(size_t n, size_t m, double radius);

// A torus with a closed finger of `rings` rings: a limb that no loop goes around.
TriMesh torus_with_finger(size_t n, size_t m, size_t rings, double length);

// Two tori on the x axis (centers 0 and `distance`), joined by a tube of six sides.
TriMesh joined_tori(size_t n, size_t m, double distance, size_t rings);

// --- Changes -----------------------------------------------------------------

TriMesh subdivide(const TriMesh& mesh); // one triangle -> four
TriMesh smooth(const TriMesh& mesh, size_t rounds);
TriMesh scaled(const TriMesh& mesh, double factor);
TriMesh uneven(TriMesh mesh);         // no two handles, bars or heights alike
using Matrix = std::array<double, 9>; // rows
Matrix rotation(double axis_x, double axis_y, double axis_z, double angle);
Matrix random_rotation(Random& random);
TriMesh transformed(const TriMesh& mesh, const Matrix& matrix);

// Vertices in `count` random triangles, alternately near the middle of a side
// (cap) and near a corner (needle), so that an angle of `degrees` arises.
TriMesh with_bad_triangles(const TriMesh& mesh, size_t count, double degrees, uint64_t seed);

// Random flips between triangles whose unit normals have a product of at least
// min_cosine and form a convex quadrilateral.  1 - 1e-12: the surface stays the same.
TriMesh with_random_flips(const TriMesh& mesh, size_t attempts, double min_cosine, uint64_t seed);

// Flips edges until all cotangent weights are at least `floor`, or `rounds` end.
TriMesh with_delaunay_flips(const TriMesh& mesh, double floor, size_t rounds);

} // namespace test
