// Leaves, cylinders and quads against oracles that share no code with them.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>
#include <memory>
#include <numeric>
#include <set>

namespace test_leaves {

using namespace test;

namespace {

using Traced = Owned<hmf_lines>;

hmf_trace_options trace_options() {
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    return options;
}

Traced trace(const Foliation& foliation, const hmf_trace_options& options) {
    Traced t = make<hmf_lines>(
        [&](hmf_lines** out, hmf_error* error) { return hmf_trace(foliation.get(), &options, nullptr, out, error); });
    if (t) {
        EXPECT_GE(t->struct_size, sizeof *t);
        EXPECT_EQ(t->offsets[0], 0u);
        EXPECT_EQ(t->offsets[t->line_count], t->point_count);
    }
    return t;
}

size_t size_of(const Traced& t, size_t k) { return static_cast<size_t>(t->offsets[k + 1] - t->offsets[k]); }

// The lines, for loops over them.
std::vector<hmf_line> lines_of(const Traced& t) { return {t->lines, t->lines + t->line_count}; }

Owned<hmf_cylinder_set> cylinders(const Foliation& foliation, const Loops* loops) {
    hmf_loop_set set{};
    if (loops) set = loops->view();
    return make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(foliation.get(), loops ? &set : nullptr, nullptr, out, error);
    });
}

// Everything about lines that follows from what a leaf is: consecutive points
// lie in one triangle and at the same distance from the corner between their
// edges, and lines do not cross in any triangle.
void expect_leaves(const LevelMesh& mesh, const std::vector<double>& values, const Traced& t) {
    ASSERT_TRUE(t);
    std::vector<std::vector<uint32_t>> triangles(mesh.edge_count);
    for (uint32_t f = 0; f < mesh.triangle_count; ++f)
        for (uint32_t s = 0; s < 3; ++s) triangles[mesh.triangle_edges[3 * f + s]].push_back(f);
    // The part of an edge between its first vertex and a point on it.
    const auto part = [&](uint32_t e, size_t p) {
        const double* a = &mesh.positions[3 * mesh.edge_vertices[2 * e]];
        const double* b = &mesh.positions[3 * mesh.edge_vertices[2 * e + 1]];
        double ab = 0, ap = 0;
        for (size_t k = 0; k < 3; ++k) {
            ab += (b[k] - a[k]) * (b[k] - a[k]);
            ap += (b[k] - a[k]) * (t->points[3 * p + k] - a[k]);
        }
        return ap / ab;
    };
    const double largest = *std::max_element(values.begin(), values.end());
    struct Segment {
        double from, to;
    }; // places on the rim of a triangle, 0 to 3
    std::map<uint32_t, std::vector<Segment>> in_triangle;
    size_t wrong = 0, apart = 0, crossing = 0;
    for (size_t k = 0; k < t->line_count; ++k) {
        const size_t begin = static_cast<size_t>(t->offsets[k]), n = size_of(t, k);
        double length = 0;
        for (size_t i = 0; i + !t->lines[k].closed < n; ++i) {
            const size_t p = begin + i, q = begin + (i + 1) % n;
            double square = 0;
            for (size_t a = 0; a < 3; ++a)
                square += (t->points[3 * p + a] - t->points[3 * q + a]) * (t->points[3 * p + a] - t->points[3 * q + a]);
            length += std::sqrt(square);
            const uint32_t e = t->point_edges[p], f = t->point_edges[q];
            if (e == HMF_NONE || f == HMF_NONE) continue; // in a zero
            uint32_t common = HMF_NONE;
            for (uint32_t x : triangles[e])
                for (uint32_t y : triangles[f])
                    if (x == y) common = x;
            if (common == HMF_NONE) {
                ++apart;
                continue;
            }
            if (e == f) continue; // along an edge of value 0
            // The corner between both edges.
            uint32_t corner = HMF_NONE;
            for (size_t a = 0; a < 2; ++a)
                for (size_t b = 0; b < 2; ++b)
                    if (mesh.edge_vertices[2 * e + a] == mesh.edge_vertices[2 * f + b])
                        corner = mesh.edge_vertices[2 * e + a];
            const double s = part(e, p), r = part(f, q);
            const double at_e = (mesh.edge_vertices[2 * e] == corner ? s : 1 - s) * values[e],
                         at_f = (mesh.edge_vertices[2 * f] == corner ? r : 1 - r) * values[f];
            wrong += std::abs(at_e - at_f) > 1e-11 * largest;
            double place[2];
            for (size_t c = 0; c < 3; ++c) {
                const uint32_t side = mesh.triangle_edges[3 * common + c];
                const bool same = mesh.edge_vertices[2 * side] == mesh.triangle_vertices[3 * common + c];
                if (side == e) place[0] = double(c) + (same ? s : 1 - s);
                if (side == f) place[1] = double(c) + (same ? r : 1 - r);
            }
            in_triangle[common].push_back({std::min(place[0], place[1]), std::max(place[0], place[1])});
        }
        if (t->lines[k].end != HMF_END_LIMIT) { EXPECT_NEAR(length, t->lines[k].length, 1e-9 * length) << k; }
    }
    constexpr double eps = 1e-9;
    for (const auto& entry : in_triangle)
        for (size_t i = 0; i < entry.second.size(); ++i)
            for (size_t j = i + 1; j < entry.second.size(); ++j) {
                const Segment &a = entry.second[i], &b = entry.second[j];
                const auto inside = [&](double x) { return x > a.from + eps && x < a.to - eps; };
                const auto outside = [&](double x) { return x < a.from - eps || x > a.to + eps; };
                crossing += (inside(b.from) && outside(b.to)) || (outside(b.from) && inside(b.to));
            }
    EXPECT_EQ(apart, 0u);
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(crossing, 0u);
}

std::vector<hmf_singularity> zeros_of(const Foliation& foliation) {
    const auto set = singularities(foliation);
    return {set->list, set->list + set->count};
}

struct Sample {
    const char* name;
    TriMesh mesh;
    std::vector<double> weights; // one per loop of the cut system
};

std::vector<Sample> samples() {
    TorusOptions sheared;
    sheared.jitter = 0.25;
    sheared.seed = 7;
    return {{"torus", torus(24, 12, 2, 1), {1}},
            {"sheared torus", torus(40, 20, 2, 1, sheared), {0.7}},
            {"pretzel 2", pretzel(2, 2), {1, 1}},
            {"pretzel 3", pretzel(3, 2), {1, 2.5, 0.3}},
            {"plate 2", plate(2), {3, 1}},
            {"finger", torus_with_finger(24, 12, 8, 3), {1}},
            {"bad triangles", with_bad_triangles(pretzel(2, 2), 12, 0.5, 3), {1, 1}}};
}

class Leaves : public testing::TestWithParam<size_t> {
protected:
    void SetUp() override {
        sample = samples()[GetParam()];
        hierarchy.reset(new Hierarchy(sample.mesh));
        loops = library_loops(*hierarchy, hierarchy->coarsest());
        loops.weights = sample.weights;
        solution = solve(*hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-9));
        ASSERT_LT(solution.status, HMF_ERROR_NULL);
        mesh = read_level(*hierarchy, 0);
    }
    Sample sample;
    std::unique_ptr<Hierarchy> hierarchy;
    Loops loops;
    Solution solution;
    LevelMesh mesh;
};

TEST_P(Leaves, LevelSets) {
    hmf_trace_options options = trace_options();
    options.spacing = 0.21;
    const Traced t = trace(solution.foliation, options);
    size_t expected = 0;
    for (double w : sample.weights) expected += static_cast<size_t>(std::max(1.0, std::floor(w / 0.21 + 0.5)));
    EXPECT_EQ(t->line_count, expected);
    for (const hmf_line& line : lines_of(t)) {
        EXPECT_EQ(line.kind, HMF_LINE_LEVEL);
        EXPECT_EQ(line.closed, 1);
        EXPECT_EQ(line.end, HMF_END_CLOSED);
        EXPECT_LT(line.cylinder, sample.weights.size());
    }
    expect_leaves(mesh, solution.values, t);
}

TEST_P(Leaves, CriticalGraph) {
    const Traced t = trace(solution.foliation, trace_options());
    const std::vector<hmf_singularity> zeros = zeros_of(solution.foliation);
    std::vector<int> ends(zeros.size(), 0);
    int prongs = 0;
    for (const hmf_singularity& zero : zeros) prongs += 2 - zero.index;
    EXPECT_EQ(2 * t->line_count, static_cast<size_t>(prongs));
    for (const hmf_line& line : lines_of(t)) {
        EXPECT_EQ(line.kind, HMF_LINE_CRITICAL);
        ASSERT_LT(line.begin_zero, zeros.size());
        ASSERT_LT(line.end_zero, zeros.size());
        ++ends[line.begin_zero];
        ++ends[line.end_zero];
    }
    for (size_t z = 0; z < zeros.size(); ++z) EXPECT_EQ(ends[z], 2 - zeros[z].index) << z;
    expect_leaves(mesh, solution.values, t);
}

TEST_P(Leaves, ThroughPoints) {
    Random random(5);
    std::vector<uint32_t> triangles;
    std::vector<double> barycentrics;
    for (int i = 0; i < 40; ++i) {
        triangles.push_back(static_cast<uint32_t>(random.below(mesh.triangle_count)));
        const double a = random.unit(), b = random.unit() * (1 - a);
        barycentrics.insert(barycentrics.end(), {a, b, 1 - a - b});
    }
    hmf_trace_options options = trace_options();
    options.point_count = triangles.size();
    options.point_triangles = triangles.data();
    options.point_barycentrics = barycentrics.data();
    const Traced t = trace(solution.foliation, options);
    ASSERT_EQ(t->line_count, triangles.size());
    expect_leaves(mesh, solution.values, t);
    // The point lies on its leaf, unless it is in the middle of a triangle with a zero.
    for (size_t i = 0; i < triangles.size(); ++i) {
        const hmf_line& line = t->lines[i];
        EXPECT_EQ(line.source, i);
        if (line.end == HMF_END_NOWHERE) continue;
        EXPECT_EQ(line.closed, 1);
        double F[3], point[3];
        for (size_t s = 0; s < 3; ++s) F[s] = solution.values[mesh.triangle_edges[3 * triangles[i] + s]];
        if (F[0] < F[1] + F[2] && F[1] < F[0] + F[2] && F[2] < F[0] + F[1]) continue;
        for (size_t k = 0; k < 3; ++k) {
            point[k] = 0;
            for (size_t c = 0; c < 3; ++c)
                point[k] +=
                    barycentrics[3 * i + c] * mesh.positions[3 * mesh.triangle_vertices[3 * triangles[i] + c] + k];
        }
        double nearest = 1e300;
        const size_t n = size_of(t, i);
        for (size_t p = 0; p < n; ++p) {
            const double* a = &t->points[3 * (t->offsets[i] + p)];
            const double* b = &t->points[3 * (t->offsets[i] + (p + 1) % n)];
            double ab = 0, ap = 0, d = 0;
            for (size_t k = 0; k < 3; ++k) {
                ab += (b[k] - a[k]) * (b[k] - a[k]);
                ap += (b[k] - a[k]) * (point[k] - a[k]);
            }
            const double x = ab > 0 ? std::min(1.0, std::max(0.0, ap / ab)) : 0;
            for (size_t k = 0; k < 3; ++k)
                d += (a[k] + x * (b[k] - a[k]) - point[k]) * (a[k] + x * (b[k] - a[k]) - point[k]);
            nearest = std::min(nearest, std::sqrt(d));
        }
        EXPECT_LT(nearest, 1e-6) << i;
    }
}

TEST_P(Leaves, LengthLimit) {
    hmf_trace_options options = trace_options();
    options.spacing = 0.5;
    options.critical = 1;
    options.length_limit = 0.8;
    const Traced t = trace(solution.foliation, options);
    expect_leaves(mesh, solution.values, t);
    for (const hmf_line& line : lines_of(t)) {
        EXPECT_LE(line.length, (line.kind == HMF_LINE_CRITICAL ? 1 : 2) * 0.8 + 1e-12);
        EXPECT_TRUE(line.closed || line.end == HMF_END_LIMIT || line.end == HMF_END_ZERO);
    }
}

// Heights are the weights, areas and fluxes add up to the energy, each cylinder
// has its loop, and its leaf as a loop gives the same minimizer.
TEST_P(Leaves, Cylinders) {
    const auto set = cylinders(solution.foliation, &loops);
    ASSERT_TRUE(set);
    const size_t count = static_cast<size_t>(set->count);
    ASSERT_EQ(count, sample.weights.size());
    const std::vector<hmf_cylinder> list(set->list, set->list + count);
    const hmf_loop_set& middle = *set->leaves;
    ASSERT_EQ(middle.count, count);
    EXPECT_EQ(middle.struct_size, sizeof middle);
    EXPECT_EQ(middle.element_kind, HMF_PATH_TRIANGLES);
    EXPECT_EQ(middle.level, 0u);
    Loops leaves;
    leaves.offsets.assign(middle.offsets, middle.offsets + count + 1);
    leaves.elements.assign(middle.elements, middle.elements + middle.offsets[count]);
    for (size_t c = 0; c < count; ++c) EXPECT_EQ(middle.weights[c], list[c].height);
    double flux = 0, area = 0;
    std::set<uint32_t> used;
    for (const hmf_cylinder& c : list) {
        ASSERT_LT(c.loop, count);
        used.insert(c.loop);
        // Weights are rounded to 48 bits of the largest one.
        EXPECT_NEAR(c.height, sample.weights[c.loop],
                    1e-14 * *std::max_element(sample.weights.begin(), sample.weights.end()));
        if (sample.weights[c.loop] == 1) { EXPECT_EQ(c.height, 1.0); }
        EXPECT_NEAR(c.area, c.height * c.circumference, 1e-9 * solution.report.energy);
        EXPECT_DOUBLE_EQ(c.modulus, c.height / c.circumference);
        flux += c.height * c.circumference;
        area += c.area;
        leaves.weights.push_back(c.height);
    }
    EXPECT_EQ(used.size(), count);
    EXPECT_NEAR(flux, solution.report.energy, 1e-9 * solution.report.energy);
    EXPECT_NEAR(area, solution.report.energy, 1e-9 * solution.report.energy);
    const Solution again = solve(*hierarchy, &leaves, solve_options(HMF_METHOD_NEWTON, 1e-9));
    ASSERT_LT(again.status, HMF_ERROR_NULL) << again.error.message;
    EXPECT_NEAR(again.report.energy, solution.report.energy, 1e-9 * solution.report.energy);
    // The set can be given as it is.
    hmf_foliation* direct = nullptr;
    const hmf_solve_options newton = solve_options(HMF_METHOD_NEWTON, 1e-9);
    ASSERT_EQ(hmf_solve(hierarchy->get(), set->leaves, &newton, nullptr, &direct, nullptr), again.status);
    EXPECT_EQ(values_of(Foliation(direct)), again.values);
    // One leaf alone has the class of its loop alone.
    for (size_t c = 0; count > 1 && c < count; ++c) {
        Loops one, other;
        one.add({leaves.elements.begin() + static_cast<long>(leaves.offsets[c]),
                 leaves.elements.begin() + static_cast<long>(leaves.offsets[c + 1])});
        const uint32_t l = list[c].loop;
        other.level = loops.level;
        other.add({loops.elements.begin() + static_cast<long>(loops.offsets[l]),
                   loops.elements.begin() + static_cast<long>(loops.offsets[l + 1])});
        const double a = solve(*hierarchy, &one, solve_options(HMF_METHOD_NEWTON, 1e-9)).report.energy;
        const double b = solve(*hierarchy, &other, solve_options(HMF_METHOD_NEWTON, 1e-9)).report.energy;
        EXPECT_NEAR(a, b, 1e-9 * a) << c;
    }
}

// The conjugate foliation by hmf_parameterize: |dv| on the edges.
TEST_P(Leaves, Conjugate) {
    hmf_parameterization* made = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_parameterize(solution.foliation.get(), nullptr, nullptr, &made, &error);
    const Owned<hmf_parameterization> flat(made);
    ASSERT_EQ(status, HMF_OK) << error.message;
    const double* const uv = flat->corner_uv;
    std::vector<double> dv(mesh.edge_count);
    for (size_t t = 0; t < mesh.triangle_count; ++t)
        for (size_t s = 0; s < 3; ++s)
            dv[mesh.triangle_edges[3 * t + s]] = std::abs(uv[6 * t + 2 * ((s + 1) % 3) + 1] - uv[6 * t + 2 * s + 1]);
    const auto set = cylinders(solution.foliation, nullptr);
    ASSERT_TRUE(set);
    const size_t count = static_cast<size_t>(set->count);
    ASSERT_EQ(count, sample.weights.size());
    for (size_t c = 0; c < count; ++c) EXPECT_EQ(set->list[c].loop, HMF_NONE);

    hmf_trace_options options = trace_options();
    options.leaves = HMF_LEAVES_CONJUGATE;
    options.spacing = 0.05;
    const Traced levels = trace(solution.foliation, options);
    expect_leaves(mesh, dv, levels);
    std::vector<double> lines(count, 0);
    for (const hmf_line& line : lines_of(levels)) {
        ASSERT_LT(line.cylinder, count);
        ++lines[line.cylinder];
        EXPECT_EQ(line.begin, HMF_END_CRITICAL);
        EXPECT_EQ(line.end, HMF_END_CRITICAL);
    }
    for (size_t c = 0; c < count; ++c)
        EXPECT_NEAR(lines[c], set->list[c].circumference / 0.05, 1 + 0.05 * set->list[c].circumference / 0.05) << c;

    options = trace_options();
    options.leaves = HMF_LEAVES_CONJUGATE;
    options.critical = 1;
    options.length_limit = 3;
    const Traced prongs = trace(solution.foliation, options);
    expect_leaves(mesh, dv, prongs);
    // As many prongs as multiples of pi in the cone angles, where no triangle is folded.
    size_t expected = 0;
    for (size_t v = 0; v < mesh.vertex_count; ++v)
        expected += flat->cone[v] > 2 ? static_cast<size_t>(flat->cone[v]) : 0;
    if (flat->flipped_count == 0) { EXPECT_EQ(prongs->line_count, expected); }
    for (const hmf_line& line : lines_of(prongs)) {
        EXPECT_EQ(line.begin, HMF_END_ZERO);
        EXPECT_LE(line.length, 3 + 1e-12);
    }

    const uint32_t triangle = static_cast<uint32_t>(mesh.triangle_count / 2);
    const double middle[3] = {0.3, 0.3, 0.4};
    options.critical = 0;
    options.point_count = 1;
    options.point_triangles = &triangle;
    options.point_barycentrics = middle;
    const Traced one = trace(solution.foliation, options);
    ASSERT_EQ(one->line_count, 1u);
    expect_leaves(mesh, dv, one);
}

// Closed, oriented, manifold, only quads, of the right genus; irregular vertices
// exactly at the zeros; on the surface.
TEST_P(Leaves, Quads) {
    double area = 0;
    for (size_t t = 0; t < mesh.triangle_count; ++t) {
        double a[3], b[3];
        for (size_t k = 0; k < 3; ++k) {
            const auto at = [&](size_t c) { return mesh.positions[3 * mesh.triangle_vertices[3 * t + c] + k]; };
            a[k] = at(1) - at(0);
            b[k] = at(2) - at(0);
        }
        const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
        area += 0.5 * std::sqrt(x * x + y * y + z * z);
    }
    const std::vector<hmf_singularity> zeros = zeros_of(solution.foliation);
    for (const double length : {0.0, 0.07, 0.2, 1.0, 100.0}) {
        SCOPED_TRACE(length);
        hmf_quad_options options{};
        options.struct_size = sizeof options;
        options.edge_length = length;
        const auto made = make<hmf_quad_mesh>([&](hmf_quad_mesh** out, hmf_error* error) {
            return hmf_quads(solution.foliation.get(), &options, nullptr, out, error);
        });
        ASSERT_TRUE(made);
        const size_t vertices = static_cast<size_t>(made->vertex_count), count = static_cast<size_t>(made->quad_count);
        const std::vector<double> positions(made->positions, made->positions + 3 * vertices);
        const std::vector<uint32_t> quads(made->quads, made->quads + 4 * count);
        std::map<std::pair<uint32_t, uint32_t>, int> sides;
        std::vector<int> valence(vertices, 0);
        for (size_t q = 0; q < count; ++q)
            for (size_t s = 0; s < 4; ++s) {
                ASSERT_LT(quads[4 * q + s], vertices);
                ++sides[{quads[4 * q + s], quads[4 * q + (s + 1) % 4]}];
                ++valence[quads[4 * q + s]];
            }
        size_t bad = 0;
        for (const auto& side : sides)
            bad += side.second != 1 || side.first.first == side.first.second
                || !sides.count({side.first.second, side.first.first});
        EXPECT_EQ(bad, 0u) << "sides";
        for (size_t v = 0; v < vertices; ++v)
            ASSERT_EQ(valence[v], v < zeros.size() ? 2 * (2 - zeros[v].index) : 4) << v;
        // V - E + F with E = 2 F: one component of the right genus, if the fans close as counted above.
        EXPECT_EQ(static_cast<long>(vertices) - static_cast<long>(count),
                  2 - 2 * static_cast<long>(hmf_hierarchy_describe(hierarchy->get())->genus));
        for (double x : positions) ASSERT_TRUE(std::isfinite(x));
        if (length == 0.07) {
            EXPECT_GT(static_cast<double>(count), 0.5 * area / (length * length));
            EXPECT_LT(static_cast<double>(count), 2 * area / (length * length));
        }
        // A fan around each vertex: following the quads comes back after all of them.
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> before; // (vertex, next) -> previous in the quad
        for (size_t q = 0; q < count; ++q)
            for (size_t s = 0; s < 4; ++s)
                before[{quads[4 * q + s], quads[4 * q + (s + 1) % 4]}] = quads[4 * q + (s + 3) % 4];
        std::vector<char> seen(vertices, 0);
        for (const auto& start : before) {
            const uint32_t v = start.first.first;
            if (seen[v]) continue;
            seen[v] = 1;
            int turns = 0;
            uint32_t next = start.first.second;
            do {
                next = before.at({v, next});
                ++turns;
            } while (next != start.first.second && turns <= valence[v]);
            ASSERT_EQ(turns, valence[v]) << v;
        }
    }
}

TEST_P(Leaves, ForeignLoopsAreRefused) {
    const size_t n = sample.weights.size();
    const auto cylinders_of = [&](const Loops& given, const Foliation& f) {
        const hmf_loop_set set = given.view();
        hmf_cylinder_set* out = nullptr;
        const hmf_status status = hmf_cylinders(f.get(), &set, nullptr, &out, nullptr);
        EXPECT_EQ(out != nullptr, status == HMF_OK);
        hmf_free(out);
        return status;
    };
    Loops other = loops;
    other.weights[0] *= 1.5;
    EXPECT_EQ(cylinders_of(other, solution.foliation), HMF_ERROR_VALUE_CLASS);
    if (n > 1) {
        Loops fewer;
        fewer.level = loops.level;
        fewer.add({loops.elements.begin(), loops.elements.begin() + static_cast<long>(loops.offsets[1])});
        fewer.weights = {1};
        EXPECT_EQ(cylinders_of(fewer, solution.foliation), HMF_ERROR_VALUE_CLASS);
        other = loops;
        std::swap(other.weights[0], other.weights[1]);
        EXPECT_EQ(cylinders_of(other, solution.foliation),
                  other.weights[0] == other.weights[1] ? HMF_OK : HMF_ERROR_VALUE_CLASS);
    }
    // Far from the minimum.
    Loops fine = library_loops(*hierarchy, 0);
    fine.weights = sample.weights;
    EXPECT_EQ(cylinders_of(fine, initialize(*hierarchy, fine)), HMF_ERROR_VALUE_NOT_HARMONIC);
}

// On every level, with the loops on any other: each has its cylinder, and heights times circumferences are the energy
// of that level.
TEST(Cylinders, OnEachLevel) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.4, 60);
    ASSERT_GE(hierarchy.levels(), 3u);
    for (size_t level = 0; level < hierarchy.levels(); ++level) {
        Loops loops = library_loops(hierarchy, level);
        loops.weights = {1, 3};
        hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 1e-10);
        options.stop_level = level;
        const Solution solution = solve(hierarchy, &loops, options);
        ASSERT_EQ(solution.status, HMF_OK) << solution.error.message;
        for (size_t other = 0; other < hierarchy.levels(); ++other) {
            Loops carried = library_loops(hierarchy, other);
            carried.weights = loops.weights;
            const auto set = cylinders(solution.foliation, &carried);
            ASSERT_TRUE(set);
            ASSERT_EQ(set->count, 2u);
            double flux = 0, area = 0;
            for (size_t c = 0; c < 2; ++c) {
                ASSERT_LT(set->list[c].loop, 2u);
                EXPECT_EQ(set->list[c].height, loops.weights[set->list[c].loop]) << level << " " << other;
                flux += set->list[c].height * set->list[c].circumference;
                area += set->list[c].area;
            }
            EXPECT_NE(set->list[0].loop, set->list[1].loop);
            EXPECT_NEAR(flux, solution.report.energy, 1e-9 * solution.report.energy) << level;
            EXPECT_NEAR(area, solution.report.energy, 1e-9 * solution.report.energy) << level;
        }
    }
}

// What is not the minimum is improved where it is near, and refused where its energy is larger by a hundredth.
TEST(Cylinders, OfValuesNearTheMinimum) {
    const Hierarchy hierarchy(pretzel(2, 1));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Solution best = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    ASSERT_EQ(best.status, HMF_OK);
    size_t near = 0, far = 0;
    for (const uint64_t sweeps : {1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 377, 987, 2584}) {
        const Solution some = relax(initialize(hierarchy, loops), solve_options(HMF_METHOD_SINGLE_LEVEL, 0, sweeps));
        ASSERT_TRUE(some.foliation);
        const double ratio = energy(some.foliation) / energy(best.foliation);
        if (std::fabs(ratio - 1.01) < 1e-4) continue;
        hmf_error error{};
        hmf_cylinder_set* out = nullptr;
        const hmf_status status = hmf_cylinders(some.foliation.get(), nullptr, nullptr, &out, &error);
        hmf_free(out);
        EXPECT_EQ(status, ratio < 1.01 ? HMF_OK : HMF_ERROR_VALUE_NOT_HARMONIC) << sweeps << " sweeps, ratio " << ratio;
        near += ratio < 1.01;
        far += ratio > 1.01 && ratio < 2;
        char said[40];
        std::snprintf(said, sizeof said, " is %.2g times ", ratio);
        if (status != HMF_OK) { EXPECT_NE(std::strstr(error.message, said), nullptr) << error.message << said; }
    }
    EXPECT_GT(near, 0u);
    EXPECT_GT(far, 0u);
}

// Values of a solve, read again, have the same leaves.
TEST_P(Leaves, OfValuesReadAgain) {
    hmf_trace_options options = trace_options();
    options.spacing = 0.3;
    options.critical = 1;
    const Traced direct = trace(solution.foliation, options),
                 again = trace(create(*hierarchy, 0, solution.values), options);
    ASSERT_TRUE(direct && again);
    ASSERT_EQ(direct->line_count, again->line_count);
    ASSERT_EQ(direct->point_count, again->point_count);
    for (uint64_t i = 0; i < 3 * direct->point_count; ++i) ASSERT_EQ(direct->points[i], again->points[i]);
}

// Quads of 24 sizes, none with two edges that have the same ends; how many there are.
size_t expect_simple_quads(const Solution& solution, int32_t merge) {
    size_t made = 0;
    for (double length = 0.1; length < 20; length *= 1.25) {
        hmf_quad_options options{};
        options.struct_size = sizeof options;
        options.edge_length = length;
        options.merge = merge;
        hmf_quad_mesh* out = nullptr;
        const hmf_status status = hmf_quads(solution.foliation.get(), &options, nullptr, &out, nullptr);
        const Owned<hmf_quad_mesh> mesh(out);
        EXPECT_TRUE(status == HMF_OK || status == HMF_ERROR_QUADS) << status;
        if (!mesh) continue;
        ++made;
        size_t twice = 0;
        std::set<std::pair<uint32_t, uint32_t>> sides;
        for (size_t q = 0; q < mesh->quad_count; ++q)
            for (size_t s = 0; s < 4; ++s) {
                const uint32_t a = mesh->quads[4 * q + s], b = mesh->quads[4 * q + (s + 1) % 4];
                twice += a == b || !sides.insert({a, b}).second;
            }
        EXPECT_EQ(twice, 0u) << "length " << length;
    }
    return made;
}

// Of any size there is a quad mesh without two edges that have the same ends, or a refusal.
TEST(LeavesContract, NoTwoEdgesOfAQuadMeshHaveTheSameEnds) {
    for (const size_t genus : {2, 3, 4})
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS})
            for (const int32_t merge : {0, 1}) {
                SCOPED_TRACE("genus " + std::to_string(genus) + " kind " + std::to_string(kind) + " merge "
                             + std::to_string(merge));
                const Hierarchy hierarchy(pretzel(genus, 1));
                const auto loops = loops_of(hierarchy, kind);
                ASSERT_TRUE(loops);
                EXPECT_GT(expect_simple_quads(solve(hierarchy, *loops), merge), 6u);
            }
}

// What the header promises about arguments: each refusal with its status.
TEST(LeavesContract, Refusals) {
    const Hierarchy hierarchy(pretzel(2, 1));
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-9));
    const hmf_foliation* f = solution.foliation.get();
    hmf_error error{};
    hmf_trace_options options = trace_options();
    uint64_t lines = 0;
    const auto traced = [&] {
        hmf_lines* out = nullptr;
        const hmf_status status = hmf_trace(f, &options, nullptr, &out, &error);
        EXPECT_EQ(out != nullptr, status == HMF_OK);
        if (out) lines = out->line_count;
        hmf_free(out);
        return status;
    };
    for (const double bad : {-1.0, static_cast<double>(INFINITY), static_cast<double>(NAN), 1e-30}) {
        options = trace_options();
        options.spacing = bad;
        EXPECT_EQ(traced(), HMF_ERROR_OPTIONS) << bad;
    }
    options = trace_options();
    options.leaves = 7;
    EXPECT_EQ(traced(), HMF_ERROR_OPTIONS);
    options = trace_options();
    options.point_count = 2;
    EXPECT_EQ(traced(), HMF_ERROR_NULL);
    uint32_t triangles[] = {0, UINT32_MAX};
    double barycentrics[] = {0.5, 0.25, 0.25, 1, 0, 0};
    options.point_triangles = triangles;
    options.point_barycentrics = barycentrics;
    EXPECT_EQ(traced(), HMF_ERROR_OPTIONS);
    EXPECT_EQ(error.index, 1u);
    triangles[1] = 1;
    barycentrics[3] = 0.5;
    EXPECT_EQ(traced(), HMF_ERROR_OPTIONS);
    EXPECT_EQ(error.index, 1u);
    barycentrics[3] = 1;
    EXPECT_EQ(traced(), HMF_OK);
    EXPECT_EQ(lines, 2u);

    hmf_quad_options quads{};
    quads.struct_size = sizeof quads;
    for (const double bad : {-1.0, static_cast<double>(NAN), 1e-9}) {
        quads.edge_length = bad;
        hmf_quad_mesh* out = nullptr;
        EXPECT_EQ(hmf_quads(f, &quads, nullptr, &out, &error), HMF_ERROR_OPTIONS) << bad;
        EXPECT_EQ(out, nullptr);
    }
}

INSTANTIATE_TEST_SUITE_P(Samples, Leaves, testing::Range(size_t{0}, samples().size()));

} // namespace

} // namespace test_leaves
