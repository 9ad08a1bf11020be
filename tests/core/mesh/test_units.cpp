// Positions in any unit, as small and as large as doubles are: a power of two changes no bit of what has no unit, and
// what has the unit of the positions is that many times as large.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_units {

using namespace test;

namespace {

// Numbers of one result in the unit of the unscaled mesh.
class Numbers {
public:
    explicit Numbers(int exponent) : exponent_(exponent) {}
    template <class T>
    void plain(const T* numbers, size_t count) {
        all.insert(all.end(), numbers, numbers + count);
    }
    void lengths(const double* numbers, size_t count) {
        for (size_t i = 0; i < count; ++i) all.push_back(std::ldexp(numbers[i], -exponent_));
    }
    std::vector<double> all;

private:
    int exponent_;
};

void add_loops(const Hierarchy& h, int32_t kind, Numbers& to) {
    const auto loops = loops_of(h, kind);
    ASSERT_TRUE(loops);
    to.plain(loops->elements, static_cast<size_t>(loops->offsets[loops->count]));
}

void add_lines(const hmf_foliation* f, int exponent, Numbers& to) {
    for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE})
        for (const double limit : {0.0, std::ldexp(3.0, exponent)}) {
            hmf_trace_options options{};
            options.struct_size = sizeof options;
            options.critical = 1;
            options.spacing = limit > 0 ? 0 : 0.2;
            options.length_limit = limit;
            options.leaves = leaves;
            const auto lines =
                make<hmf_lines>([&](auto out, hmf_error* e) { return hmf_trace(f, &options, nullptr, out, e); });
            ASSERT_TRUE(lines);
            to.lengths(lines->points, 3 * static_cast<size_t>(lines->point_count));
            for (size_t i = 0; i < lines->line_count; ++i) to.lengths(&lines->lines[i].length, 1);
        }
}

void add_quads(const hmf_foliation* f, int exponent, Numbers& to) {
    for (const bool by_length : {false, true}) {
        hmf_quad_options options{};
        options.struct_size = sizeof options;
        options.edge_length = by_length ? std::ldexp(0.75, exponent) : 0;
        options.relax = by_length ? 0 : 5;
        const auto quads =
            make<hmf_quad_mesh>([&](auto out, hmf_error* e) { return hmf_quads(f, &options, nullptr, out, e); });
        ASSERT_TRUE(quads);
        to.lengths(quads->positions, 3 * static_cast<size_t>(quads->vertex_count));
        to.plain(quads->quads, 4 * static_cast<size_t>(quads->quad_count));
        to.lengths(&quads->edge_length, 1);
    }
}

void add_maps(const hmf_foliation* f, Numbers& to) {
    const auto map = make<hmf_parameterization>(
        [&](auto out, hmf_error* e) { return hmf_parameterize(f, nullptr, nullptr, out, e); });
    ASSERT_TRUE(map);
    to.plain(map->corner_uv, 6 * static_cast<size_t>(map->triangle_count));
    to.plain(map->dilatation, static_cast<size_t>(map->triangle_count));
    to.lengths(&map->seam_length, 1);
    const auto charts =
        make<hmf_chart_set>([&](auto out, hmf_error* e) { return hmf_atlas(f, nullptr, nullptr, out, e); });
    ASSERT_TRUE(charts);
    to.plain(charts->corner_uv, 6 * static_cast<size_t>(charts->triangle_count));
    to.lengths(&charts->seam_length, 1);
}

void add_design(const TriMesh& mesh, Numbers& to) {
    hmf_design_options options{};
    options.struct_size = sizeof options;
    options.solve_limit = 10;
    const auto design = make<hmf_design>([&](auto out, hmf_error* e) {
        return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                               &options, nullptr, out, e);
    });
    ASSERT_TRUE(design);
    to.plain(design->marked_vertices, static_cast<size_t>(design->marked_count));
    to.plain(design->loops->weights, static_cast<size_t>(design->loops->count));
    to.plain(&design->unevenness, 1);
}

// log |grad u| in the caller's unit, where |grad u| itself may be no double.
double scale_of_triangle(const hmf_foliation* f, size_t triangles) {
    const auto scale =
        make<hmf_scale>([&](hmf_scale** out, hmf_error* error) { return hmf_conformal_scale(f, nullptr, out, error); });
    EXPECT_EQ(scale->triangle_count, triangles);
    return scale->log_scale[0];
}

void add_all(const TriMesh& mesh, int exponent, Numbers& to, double& log_scale) {
    const Hierarchy h(mesh, 0, 60);
    ASSERT_TRUE(h);
    for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS})
        add_loops(h, kind, to);
    const LevelMesh coarse = read_level(h, h.coarsest());
    to.lengths(coarse.positions.data(), coarse.positions.size());
    const auto f = make<hmf_foliation>(
        [&](auto out, hmf_error* e) { return hmf_solve_cut_system(h.get(), nullptr, nullptr, out, e); });
    ASSERT_TRUE(f);
    const std::vector<double> values = values_of(f);
    to.plain(values.data(), values.size());
    log_scale = scale_of_triangle(f.get(), mesh.triangle_count());
    const auto zeros = singularities(f);
    for (size_t i = 0; i < zeros->count; ++i) to.lengths(zeros->list[i].position, 3);
    add_lines(f.get(), exponent, to);
    add_quads(f.get(), exponent, to);
    add_maps(f.get(), to);
    add_design(mesh, to);
}

} // namespace

TEST(Units, ChangeNoBit) {
    const TriMesh mesh = pretzel(2, 1);
    Numbers plain(0);
    double plain_log = 0;
    add_all(mesh, 0, plain, plain_log);
    ASSERT_FALSE(HasFatalFailure());
    ASSERT_GT(plain.all.size(), 10000u);
    for (const int exponent : {-900, -500, -200, -60, 60, 200, 500, 900}) {
        SCOPED_TRACE(exponent);
        Numbers other(exponent);
        double other_log = 0;
        add_all(scaled(mesh, std::ldexp(1.0, exponent)), exponent, other, other_log);
        ASSERT_FALSE(HasFatalFailure());
        EXPECT_EQ(other.all, plain.all);
        EXPECT_NEAR(other_log, plain_log - exponent * std::log(2.0), 1e-9);
    }
}

} // namespace test_units
