// An egg: a sphere with marked vertices at its tips, where what comes out can be said beforehand.  And the affine map
// of one triangle, against singular values by Eigen.
#include "src/applications/parameterize/dilatation.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <complex>

namespace test_marked_spheres {

using namespace test;

namespace {

const double pi = std::acos(-1.0);

// x^2 + y^2 + (z / length)^2 = 1 by rings of n vertices; the rings are as dense at the tips as anywhere, so that
// triangles are small there.
TriMesh egg(size_t n, size_t rings, double length) {
    TriMesh mesh;
    for (size_t k = 0; k < rings; ++k)
        for (size_t i = 0; i < n; ++i) {
            const double a = 2 * pi * (static_cast<double>(i) + 0.5 * static_cast<double>(k % 2)) / double(n);
            const double t = pi * static_cast<double>(k + 1) / static_cast<double>(rings + 1);
            mesh.positions.insert(mesh.positions.end(),
                                  {std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), -length * std::cos(t)});
        }
    mesh.positions.insert(mesh.positions.end(), {0, 0, -length, 0, 0, length});
    const auto at = [n](size_t k, size_t i) { return static_cast<uint32_t>(k * n + i % n); };
    const uint32_t bottom = static_cast<uint32_t>(rings * n), top = bottom + 1;
    for (size_t i = 0; i < n; ++i) {
        mesh.triangles.insert(mesh.triangles.end(), {bottom, at(0, i + 1), at(0, i)});
        mesh.triangles.insert(mesh.triangles.end(), {top, at(rings - 1, i), at(rings - 1, i + 1)});
        for (size_t k = 0; k + 1 < rings; ++k)
            if (k % 2 == 0)
                mesh.triangles.insert(mesh.triangles.end(), {at(k, i), at(k, i + 1), at(k + 1, i), at(k, i + 1),
                                                             at(k + 1, i + 1), at(k + 1, i)});
            else
                mesh.triangles.insert(mesh.triangles.end(), {at(k, i), at(k, i + 1), at(k + 1, i + 1), at(k, i),
                                                             at(k + 1, i + 1), at(k + 1, i)});
    }
    return mesh;
}

} // namespace

// Two at each end, as far from one another as a disk of 0.4 % of the area is wide, though the triangles there are
// smaller than that.
TEST(MarkedSpheres, TipsAreMarkedAcrossADisk) {
    const double length = 3;
    for (const size_t n : {16, 32}) {
        const TriMesh mesh = egg(n, 2 * n, length);
        ASSERT_EQ(mesh_defect(mesh), "");
        double area = 0;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            Eigen::Vector3d p[3];
            for (size_t c = 0; c < 3; ++c)
                p[c] = Eigen::Map<const Eigen::Vector3d>(&mesh.positions[3 * mesh.triangles[3 * t + c]]);
            area += (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
        }
        const std::vector<uint32_t> marks = suggested_marks(mesh);
        ASSERT_EQ(marks.size(), 4u);
        for (const double end : {-1.0, 1.0}) {
            std::vector<Eigen::Vector3d> here;
            for (const uint32_t v : marks)
                if (mesh.positions[3 * v + 2] * end > 0)
                    here.push_back(Eigen::Map<const Eigen::Vector3d>(&mesh.positions[3 * v]));
            ASSERT_EQ(here.size(), 2u);
            for (const auto& p : here) EXPECT_GT(end * p.z(), 0.8 * length);
            const double wide = 2 * std::sqrt(4e-3 * area / pi);
            EXPECT_GT((here[0] - here[1]).norm(), 0.8 * wide);
            EXPECT_LT((here[0] - here[1]).norm(), 2.5 * wide);
        }
    }
}

// Quads over poles lie on the egg and look outwards, also relaxed.
TEST(MarkedSpheres, QuadsOverPolesLieOnIt) {
    const double length = 3;
    const TriMesh mesh = egg(32, 64, length);
    const std::vector<uint32_t> marks = suggested_marks(mesh);
    const Hierarchy hierarchy(mesh, with_marks(marks));
    ASSERT_TRUE(hierarchy);
    const auto f = make<hmf_foliation>(
        [&](auto out, hmf_error* e) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, e); });
    ASSERT_TRUE(f);
    for (const uint64_t relax : {0, 1, 20}) {
        hmf_quad_options options{};
        options.struct_size = sizeof options;
        options.count = 800;
        options.relax = relax;
        const auto quads =
            make<hmf_quad_mesh>([&](auto out, hmf_error* e) { return hmf_quads(f.get(), &options, nullptr, out, e); });
        ASSERT_TRUE(quads);
        for (size_t v = 0; v < quads->vertex_count; ++v) {
            const double *p = quads->positions + 3 * v, z = p[2] / length;
            EXPECT_NEAR(std::sqrt(p[0] * p[0] + p[1] * p[1] + z * z), 1, 0.02) << "vertex " << v;
        }
        EXPECT_EQ(quads->inverted_count, 0u) << relax;
        std::vector<int> valence(quads->vertex_count, 0);
        for (size_t i = 0; i < 4 * quads->quad_count; ++i) ++valence[quads->quads[i]];
        size_t irregular = 0;
        for (const int n : valence) irregular += n != 4;
        EXPECT_EQ(quads->irregular_count, irregular);
        size_t inwards = 0;
        for (size_t q = 0; q < quads->quad_count; ++q) {
            Eigen::Vector3d p[4];
            for (size_t c = 0; c < 4; ++c)
                p[c] = Eigen::Map<const Eigen::Vector3d>(quads->positions + 3 * quads->quads[4 * q + c]);
            Eigen::Vector3d outwards = p[0] + p[1] + p[2] + p[3];
            outwards.z() /= length * length;
            inwards += (p[2] - p[0]).cross(p[3] - p[1]).dot(outwards) <= 0;
        }
        EXPECT_EQ(inwards, 0u) << relax;
    }
}

// Up to a dilatation of 1000; beyond it a triangle is degenerate.
TEST(AffineMap, SingularValues) {
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        double p[3][3], u[3], v[3];
        for (auto& corner : p)
            for (double& x : corner) x = random.unit();
        const double thin = std::pow(10, -4 * random.unit()); // of the image
        for (int c = 0; c < 3; ++c) u[c] = random.unit(), v[c] = thin * random.unit();
        Eigen::Vector3d a, b;
        for (int c = 0; c < 3; ++c) a[c] = p[1][c] - p[0][c], b[c] = p[2][c] - p[0][c];
        const Eigen::Vector3d e = a.normalized(), f = (b - b.dot(e) * e).normalized();
        Eigen::Matrix2d from, to;
        from << a.dot(e), b.dot(e), a.dot(f), b.dot(f);
        to << u[1] - u[0], u[2] - u[0], v[1] - v[0], v[2] - v[0];
        const Eigen::Matrix2d derivative = to * from.inverse();
        const Eigen::Vector2d singular = derivative.jacobiSvd().singularValues();
        const hmf::AffineMap map = hmf::affine_map(p[0], p[1], p[2], u, v);
        const double expected = singular[0] / singular[1];
        if (expected < 999.9) EXPECT_NEAR(map.dilatation, expected, 1e-6 * expected);
        if (expected > 1000.1) EXPECT_EQ(map.dilatation, HUGE_VAL);
        EXPECT_NEAR(map.determinant, derivative.determinant(), 1e-9 * singular[0] * singular[0]);
        EXPECT_NEAR(map.area, from.determinant() / 2, 1e-9);
        const std::complex<double> dz =
            0.5 * std::complex<double>(derivative(0, 0) + derivative(1, 1), derivative(1, 0) - derivative(0, 1));
        EXPECT_NEAR(map.differential[0], (dz * dz).real(), 1e-9 * singular[0] * singular[0]);
        EXPECT_NEAR(map.differential[1], (dz * dz).imag(), 1e-9 * singular[0] * singular[0]);
    }
}

} // namespace test_marked_spheres
