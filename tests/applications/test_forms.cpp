// Harmonic 1-forms, checked with what the caller has: edges, cotangents, paths.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

namespace test_forms {

using namespace test;

namespace {

using Matrix = Eigen::MatrixXd;
using Forms = Owned<hmf_form_set>;

Forms forms_of(const Hierarchy& hierarchy, size_t level = 0) {
    return make<hmf_form_set>(
        [&](auto out, auto error) { return hmf_harmonic_forms(hierarchy.get(), level, nullptr, out, error); });
}

Matrix square(const double* entries, uint64_t n) {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        entries, static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
}

// The integral of a form along side s of a triangle.
struct Sides {
    const LevelMesh& mesh;
    const double* form;
    double operator()(size_t triangle, size_t s) const {
        const uint32_t edge = mesh.triangle_edges[3 * triangle + s % 3];
        return mesh.edge_vertices[2 * edge] == mesh.triangle_vertices[3 * triangle + s % 3] ? form[edge] : -form[edge];
    }
};

double integral_of_product(const LevelMesh& mesh, const double* a, const double* b) {
    const Sides x{mesh, a}, y{mesh, b};
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count; ++t) sum += 0.5 * (x(t, 0) * y(t, 1) - x(t, 1) * y(t, 0));
    return sum;
}

double along(const LevelMesh& mesh, const double* form, const std::vector<uint32_t>& loop) {
    std::map<std::pair<uint32_t, uint32_t>, double> value;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t v = mesh.edge_vertices[2 * e], w = mesh.edge_vertices[2 * e + 1];
        value[{v, w}] = form[e];
        value[{w, v}] = -form[e];
    }
    double sum = 0;
    for (size_t k = 0; k < loop.size(); ++k) sum += value.at({loop[k], loop[(k + 1) % loop.size()]});
    return sum;
}

// Root mean squares over vertices, of the sum of the fluxes and of the sum of their sizes.
double divergence(const LevelMesh& mesh, const double* form) {
    std::vector<double> sum(mesh.vertex_count), size(mesh.vertex_count);
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const double flux = mesh.weights[e] * form[e];
        for (const int end : {0, 1}) {
            sum[mesh.edge_vertices[2 * e + size_t(end)]] += end ? -flux : flux;
            size[mesh.edge_vertices[2 * e + size_t(end)]] += std::fabs(flux);
        }
    }
    const auto norm = [](const std::vector<double>& x) {
        return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())).norm();
    };
    return norm(sum) / norm(size);
}

// What holds exactly on every triangulation of the caller.
void expect_integer_classes(const LevelMesh& mesh, const hmf_form_set& forms) {
    const uint64_t n = forms.form_count;
    for (uint64_t i = 0; i < n; ++i) {
        const double* const form = forms.values + i * forms.edge_count;
        const Sides side{mesh, form};
        for (size_t t = 0; t < mesh.triangle_count; ++t) ASSERT_EQ(side(t, 0) + side(t, 1) + side(t, 2), 0);
        for (uint64_t j = 0; j < n; ++j) {
            const double wanted = i + forms.genus == j ? 1 : j + forms.genus == i ? -1 : 0;
            EXPECT_EQ(double(forms.intersections[n * i + j]), wanted);
            EXPECT_NEAR(integral_of_product(mesh, form, forms.values + j * forms.edge_count), wanted, 1e-9);
        }
    }
}

// Period of a torus, as it is for the shortest basis.
std::complex<double> reduced(std::complex<double> tau) {
    for (int n = 0; n < 100; ++n) {
        tau -= std::round(tau.real());
        if (std::norm(tau) >= 1 - 1e-12) break;
        tau = -1.0 / tau;
    }
    return {std::fabs(tau.real()), tau.imag()};
}

std::complex<double> period_of_torus(const TriMesh& mesh, size_t level = 0) {
    const Hierarchy hierarchy(mesh);
    const Forms forms = forms_of(hierarchy, level);
    return reduced({forms->period_real[0], forms->period_imaginary[0]});
}

std::vector<uint32_t> grid_loop(size_t n, size_t m, bool around_tube) {
    std::vector<uint32_t> loop;
    for (size_t k = 0; k < (around_tube ? m : n); ++k) loop.push_back(static_cast<uint32_t>(around_tube ? k : k * m));
    return loop;
}

} // namespace

// A torus of revolution is conformal to a rectangle of sides 2 pi and 2 pi r / sqrt(R^2 - r^2).
TEST(Forms, PeriodOfATorusInClosedForm) {
    const double wanted = std::sqrt(3.0 * 3.0 - 1.0);
    double before = 0;
    for (const size_t n : {24, 48, 96}) {
        const std::complex<double> tau = period_of_torus(torus(n, n / 2, 3, 1));
        const double error = std::abs(tau - std::complex<double>(0, wanted)) / wanted;
        EXPECT_LT(error, 12.0 / double(n * n));
        if (before > 0) EXPECT_LT(error, 0.3 * before);
        before = error;
    }
}

// On a torus the absolute values of a form are a foliation: that of its class has the same energy, and its periods
// tell which class it is.
TEST(Forms, EnergiesAreThoseOfFoliations) {
    const size_t n = 40, m = 18;
    TorusOptions options;
    options.random_diagonals = true;
    options.jitter = 0.3;
    const TriMesh mesh = torus(n, m, 2, 0.9, options);
    const Hierarchy hierarchy(mesh);
    const LevelMesh level = read_level(hierarchy, 0);
    const Forms forms = forms_of(hierarchy);
    const Matrix inner = square(forms->inner_products, 2);
    for (const bool around_tube : {true, false}) {
        Eigen::Matrix2d period; // rows: along the loop of the foliation, along the other one
        for (const int row : {0, 1})
            for (const int column : {0, 1})
                period(row, column) = along(level, forms->values + size_t(column) * forms->edge_count,
                                            grid_loop(n, m, around_tube == (row == 0)));
        EXPECT_LT((period - period.array().round().matrix()).norm(), 1e-12);
        EXPECT_NEAR(std::fabs(period.determinant()), 1, 1e-12);
        const Eigen::Vector2d form = period.inverse() * Eigen::Vector2d(0, 1);
        Loops loops;
        loops.kind = HMF_PATH_VERTICES;
        loops.add(grid_loop(n, m, around_tube));
        const hmf_loop_set set = loops.view();
        const Foliation solved = make<hmf_foliation>(
            [&](auto out, auto error) { return hmf_solve(hierarchy.get(), &set, nullptr, nullptr, out, error); });
        EXPECT_NEAR(form.dot(inner * form) / energy(solved), 1, 1e-7);
    }
}

TEST(Forms, AreHarmonicOnDelaunayMeshes) {
    for (const size_t genus : {2, 3}) {
        const TriMesh mesh = with_delaunay_flips(pretzel(genus, 1), 1e-3, 100);
        const Hierarchy hierarchy(mesh);
        const LevelMesh level = read_level(hierarchy, 0);
        const Forms forms = forms_of(hierarchy);
        ASSERT_EQ(forms->genus, genus);
        ASSERT_EQ(forms->form_count, 2 * genus);
        expect_integer_classes(level, *forms);
        EXPECT_LT(forms->residual, 1e-8);
        const uint64_t n = forms->form_count;
        const Matrix inner = square(forms->inner_products, n);
        for (uint64_t i = 0; i < n; ++i) {
            const double* const a = forms->values + i * forms->edge_count;
            EXPECT_LT(divergence(level, a), 1e-8);
            for (uint64_t j = 0; j < n; ++j) {
                double product = 0;
                for (size_t e = 0; e < level.edge_count; ++e)
                    product += level.weights[e] * a[e] * forms->values[j * forms->edge_count + e];
                EXPECT_NEAR(product, inner(Eigen::Index(i), Eigen::Index(j)), 1e-7 * inner.norm());
            }
        }
    }
}

// The conjugation comes near to a square of -1 where triangles become smaller, and the period matrix to a symmetric one
// with positive imaginary part; then the inner products have the determinant 1.
TEST(Forms, ConjugationConverges) {
    TriMesh mesh = pretzel(2, 1);
    double before = 0;
    for (int refinement = 0; refinement < 3; ++refinement, mesh = subdivide(mesh)) {
        const Hierarchy hierarchy(mesh);
        const Forms forms = forms_of(hierarchy);
        const Matrix conjugation = square(forms->conjugation, 4), inner = square(forms->inner_products, 4),
                     imaginary = square(forms->period_imaginary, 2), real = square(forms->period_real, 2);
        const Matrix square_plus_one = conjugation * conjugation + Matrix::Identity(4, 4);
        EXPECT_NEAR(square_plus_one.cwiseAbs().maxCoeff(), forms->conjugation_error, 1e-12);
        EXPECT_EQ(Eigen::LLT<Matrix>(imaginary).info(), Eigen::Success);
        EXPECT_LT((imaginary - imaginary.transpose()).norm(), 1e-12 * imaginary.norm());
        EXPECT_EQ(real, real.transpose());
        EXPECT_NEAR(inner.determinant(), 1, 8 * forms->conjugation_error);
        // *form j by its coefficients: the integral of form i ^ *form j is the inner product.
        Matrix intersections(4, 4);
        for (Eigen::Index k = 0; k < 16; ++k) intersections(k / 4, k % 4) = double(forms->intersections[k]);
        EXPECT_LT((intersections * conjugation - inner).norm(), 1e-12 * inner.norm());
        // Conjugates of holomorphic forms, by their coefficients: -i times themselves.
        Eigen::MatrixXcd holomorphic(4, 2);
        holomorphic << Eigen::Matrix2cd::Identity(), real + std::complex<double>(0, 1) * imaginary;
        const Eigen::MatrixXcd wrong = conjugation * holomorphic + std::complex<double>(0, 1) * holomorphic;
        EXPECT_LT(wrong.norm(), 2 * forms->conjugation_error * holomorphic.norm());
        if (before > 0) EXPECT_LT(forms->conjugation_error, 0.6 * before);
        before = forms->conjugation_error;
    }
}

// The same flat faces in other triangles, and the same surface in other numbers and units.
TEST(Forms, BelongToTheSurface) {
    const TriMesh mesh = subdivide(subdivide(plate(1)));
    const TriMesh flipped = with_random_flips(mesh, 20 * mesh.triangle_count(), 1 - 1e-12, 5);
    const std::complex<double> tau = period_of_torus(mesh);
    EXPECT_LT(std::abs(period_of_torus(flipped) - tau), 1e-8);
    EXPECT_LT(std::abs(period_of_torus(scaled(mesh, 1e-4)) - tau), 1e-8);
    EXPECT_LT(std::abs(period_of_torus(mesh, 1) - tau), 0.1 * std::abs(tau));
    const Hierarchy hierarchy(flipped);
    expect_integer_classes(read_level(hierarchy, 0), *forms_of(hierarchy));
    expect_integer_classes(read_level(hierarchy, 1), *forms_of(hierarchy, 1));
}

TEST(Forms, OfManyHandles) {
    const Hierarchy hierarchy(subdivide(plate(12)));
    const Forms forms = forms_of(hierarchy);
    ASSERT_EQ(forms->genus, 12u);
    expect_integer_classes(read_level(hierarchy, 0), *forms);
}

TEST(Forms, WhatHasNoneAndWhatIsRefused) {
    TriMesh sphere;
    sphere.positions = {1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    sphere.triangles = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5};
    const Hierarchy marked(subdivide(sphere), with_marks({0, 1, 2, 3}));
    EXPECT_EQ(forms_of(marked)->form_count, 0u);

    TriMesh open = torus(8, 6, 3, 1);
    open.triangles.resize(open.triangles.size() - 3);
    const Hierarchy with_boundary(open);
    hmf_form_set* out = nullptr;
    hmf_error error{};
    EXPECT_EQ(hmf_harmonic_forms(with_boundary.get(), 0, nullptr, &out, &error), HMF_ERROR_MESH_BOUNDARY);
    EXPECT_EQ(hmf_harmonic_forms(marked.get(), 99, nullptr, &out, &error), HMF_ERROR_LEVEL);
    EXPECT_EQ(hmf_harmonic_forms(nullptr, 0, nullptr, &out, &error), HMF_ERROR_NULL);
}

} // namespace test_forms
