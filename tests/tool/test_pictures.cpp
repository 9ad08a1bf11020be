// What pictures are drawn from: patterns without seams, loops that are shortest in their strip, the view, zeros.
#include "bindings/cli/ambient_light.cpp"
#include "bindings/cli/camera.cpp"
#include "bindings/cli/canvas.cpp"
#include "bindings/cli/closed_pattern.cpp"
#include "bindings/cli/deflate.cpp"
#include "bindings/cli/drawing.cpp"
#include "bindings/cli/loop_lines.cpp"
#include "bindings/cli/normals.cpp"
#include "bindings/cli/png.cpp"
#include "bindings/cli/potential.cpp"
#include "bindings/cli/render.cpp"
#include "bindings/cli/whole_stripes.cpp"

#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <thread>

namespace test_pictures {

using namespace test;

namespace {

struct Solved {
    Hierarchy hierarchy;
    Loops loops;
    Solution solution;
    cli::Foliation f;

    Solved(const TriMesh& mesh, const std::vector<double>& weights) : hierarchy(mesh) {
        loops = library_loops(hierarchy,
                              hmf_hierarchy_describe(hierarchy.get())->boundary_count > 0 ? 0 : hierarchy.coarsest());
        loops.weights = weights;
        solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-8));
        const LevelMesh level = read_level(hierarchy, 0);
        f.positions = level.positions;
        f.triangles = level.triangle_vertices;
        f.triangle_edges = level.triangle_edges;
        f.edge_vertices = level.edge_vertices;
        f.values = solution.values;
        const Owned<hmf_singularity_set> set = singularities(solution.foliation);
        f.singular.assign(set->list, set->list + set->count);
        f.loop_weights = weights;
    }
};

// The largest difference of an even pattern with this period across an edge, as a part of the period.
double worst_seam(const cli::Foliation& f, const cli::Potential& potential, double period) {
    std::vector<std::vector<std::array<double, 2>>> seen(f.values.size()); // folded u at both ends, for each triangle
    const auto folded = [&](double u) { return std::fabs(u / period - std::floor(u / period + 0.5)); };
    for (size_t t = 0; t < f.triangle_count(); ++t)
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t e = f.triangle_edges[3 * t + s];
            double a = folded(potential.u[t][s]), b = folded(potential.u[t][(s + 1) % 3]);
            if (f.triangles[3 * t + s] != f.edge_vertices[2 * e]) std::swap(a, b);
            seen[e].push_back({a, b});
        }
    double worst = 0;
    for (const auto& pair : seen)
        for (size_t i = 0; i < 2; ++i) worst = std::max(worst, std::fabs(pair[0][i] - pair[1][i]));
    return worst;
}

std::vector<double> even_values(const Solved& s, double period) {
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.critical = 1;
    options.spacing = 1e300;
    const auto lines = make<hmf_lines>([&](hmf_lines** out, hmf_error* error) {
        return hmf_trace(s.solution.foliation.get(), &options, nullptr, out, error);
    });
    std::vector<cli::Crossing> crossings;
    std::vector<double> heights;
    cli::add_crossings(s.f, *lines, nullptr, crossings, heights);
    EXPECT_EQ(heights.size(), s.loops.count());
    return cli::whole_stripes(s.f, crossings, heights, period);
}

} // namespace

TEST(Pictures, StripesHaveNoSeamsWhateverTheWeights) {
    const std::vector<std::vector<double>> cases = {{1, 200}, {1, std::sqrt(2.0)}, {0.01, 1}};
    for (const std::vector<double>& weights : cases) {
        Solved s(pretzel(2, 2), weights);
        const double period = 0.3 * weights[1];
        if (cli::common_period(weights, period) == 0) {
            // The weights alone have none: seams.
            EXPECT_GT(worst_seam(s.f, cli::local_potential(s.f, period), period), 0.05);
        }
        s.f.stripe_values = even_values(s, period);
        EXPECT_LT(worst_seam(s.f, cli::local_potential(s.f, period), period), 1e-6) << weights[0] << " " << weights[1];
    }
    // Where the weights are multiples of the period nothing changes.
    Solved s(pretzel(2, 2), {1, 2});
    const std::vector<double> same = even_values(s, 0.25);
    for (size_t e = 0; e < same.size(); ++e) EXPECT_NEAR(same[e], s.f.values[e], 1e-9);
    EXPECT_LT(worst_seam(s.f, cli::local_potential(s.f, 0.25), 0.25), 1e-6);
}

TEST(Pictures, CommonPeriod) {
    EXPECT_NEAR(cli::common_period({1, 1}, 0.3), 1.0 / 3, 1e-12);
    EXPECT_NEAR(cli::common_period({1, 1.5}, 0.2), 0.25, 0.09);
    EXPECT_EQ(cli::common_period({1, std::sqrt(2.0)}, 0.3), 0);
    EXPECT_EQ(cli::common_period({1, 200}, 9), 0);
}

TriMesh without_triangles(TriMesh mesh, const std::vector<size_t>& gone) { // the last ones first
    for (const size_t t : gone) {
        const auto at = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(3 * t);
        mesh.triangles.erase(at, at + 3);
    }
    return mesh;
}

// Across every edge the two triangles agree up to a sign and multiples of the period, and nothing is far from (u, v).
TEST(Pictures, CheckerboardsHaveNoSeams) {
    const std::vector<std::pair<TriMesh, std::vector<double>>> cases = {
        {torus(24, 16, 2, 0.8), {1}},
        {trefoil(60, 8, 0.3), {1}},
        {pretzel(2, 2), {1, 1.7}},
        {pretzel(3, 2), {1, 1, 3}},
        {torus_with_finger(20, 12, 6, 2), {1}},
        // With boundary the seams join it.
        {without_triangles(torus(24, 16, 2, 0.8), {400, 0}), {1, 1, 1}},
        {without_triangles(pretzel(2, 2), {900, 500, 7}), {1, 1, 1, 1, 1}}};
    for (const auto& [mesh, weights] : cases) {
        Solved s(mesh, weights);
        const auto p = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
            return hmf_parameterize(s.solution.foliation.get(), nullptr, nullptr, out, error);
        });
        const double period = cli::wanted_period(s.f);
        const std::vector<double> uv = cli::closed_pattern(s.f.triangles, s.f.triangle_edges, *p, period);
        ASSERT_EQ(uv.size(), 2 * s.f.triangles.size()) << mesh.genus;
        std::vector<std::vector<size_t>> sides(s.f.values.size());
        for (size_t k = 0; k < s.f.triangle_edges.size(); ++k) sides[s.f.triangle_edges[k]].push_back(k);
        const auto whole = [&](double x) { return std::fabs(x / period - std::floor(x / period + 0.5)) < 1e-6; };
        size_t cut = 0;
        for (size_t e = 0; e < sides.size(); ++e) {
            if (sides[e].size() == 1) continue; // on the boundary
            const size_t k = sides[e][0], m = sides[e][1];
            const size_t k2 = k % 3 == 2 ? k - 2 : k + 1, m2 = m % 3 == 2 ? m - 2 : m + 1;
            const double sign = p->transition[3 * e];
            for (size_t i = 0; i < 2; ++i) {
                EXPECT_TRUE(whole(uv[2 * m2 + i] - sign * uv[2 * k + i])) << e;
                EXPECT_TRUE(whole(uv[2 * m + i] - sign * uv[2 * k2 + i])) << e;
            }
            cut += p->seam[e];
        }
        EXPECT_GT(cut, 0u);
        double worst = 0;
        for (size_t k = 0; k < uv.size(); ++k) worst = std::max(worst, std::fabs(uv[k] - p->corner_uv[k]));
        EXPECT_LT(worst, 4 * period) << mesh.genus;
    }
}

double length_of(const cli::Line& line) {
    double sum = 0;
    for (size_t i = 0; i < line.size(); ++i) sum += cli::distance_of(line[i], line[(i + 1) % line.size()]);
    return sum;
}

// No local change shortens it: each point lies on an edge and is the best there between its neighbors, or at its end.
void expect_shortest(const cli::Foliation& f, const cli::Line& line) {
    const size_t count = line.size();
    size_t inside = 0;
    for (size_t i = 0; i < count; ++i) {
        const cli::PlanePoint x = line[i], before = line[(i + count - 1) % count], after = line[(i + 1) % count];
        bool on_edge = false;
        for (size_t e = 0; e < f.values.size() && !on_edge; ++e) {
            const cli::PlanePoint p = cli::place(f, f.edge_vertices[2 * e]),
                                  q = cli::place(f, f.edge_vertices[2 * e + 1]);
            if (cli::distance_of(p, x) + cli::distance_of(x, q) > cli::distance_of(p, q) + 1e-9) continue;
            on_edge = true;
            const double t = cli::distance_of(p, x) / cli::distance_of(p, q);
            const double now = cli::distance_of(before, x) + cli::distance_of(x, after);
            for (const double step : {-0.05, 0.05}) {
                if (t + step < 0 || t + step > 1) continue;
                ++inside;
                const cli::PlanePoint moved = cli::between(p, q, t + step);
                EXPECT_GT(cli::distance_of(before, moved) + cli::distance_of(moved, after), now - 1e-4) << i;
            }
        }
        EXPECT_TRUE(on_edge) << i;
    }
    EXPECT_GT(inside, count);
}

// Around a torus the shortest closed curves of the class are circles.
TEST(Pictures, LoopsAreDrawnShort) {
    Solved s(torus(30, 20, 2, 0.5), {1});
    const Loops on_input = library_loops(s.hierarchy, 0);
    const hmf_loop_set view = on_input.view();
    const std::vector<cli::Line> lines = cli::loop_lines(s.f, view);
    ASSERT_EQ(lines.size(), 1u);
    // A polygon of 20 sides, around the tube.
    const double polygon = 20 * 2 * 0.5 * std::sin(3.14159265358979 / 20);
    EXPECT_GT(length_of(lines[0]), 0.98 * polygon);
    EXPECT_LT(length_of(lines[0]), 1.002 * polygon);
    expect_shortest(s.f, lines[0]);
}

// Vertices in a zig-zag around the tube: the kinks go, and the line stays where the loop is.
TEST(Pictures, LoopsOfTheCallerHaveNoKinks) {
    Solved s(torus(60, 20, 2, 0.5), {1});
    const uint32_t across = 20;
    std::vector<uint32_t> path;
    const auto is_edge = [&](uint32_t a, uint32_t b) {
        for (size_t e = 0; e < s.f.values.size(); ++e)
            if ((s.f.edge_vertices[2 * e] == a && s.f.edge_vertices[2 * e + 1] == b)
                || (s.f.edge_vertices[2 * e] == b && s.f.edge_vertices[2 * e + 1] == a))
                return true;
        return false;
    };
    // Teeth of three columns to both sides: to the right at rows 2, 6, .., to the left at rows 0, 4, ..
    const auto vertex = [&](int column, uint32_t row) { return across * uint32_t((column + 60) % 60) + row; };
    for (uint32_t row = 0; row < across; row += 2) {
        const int side = row % 4 == 2 ? 1 : -1;
        for (int k = 0; k <= 3; ++k) path.push_back(vertex(side * k, row));
        for (int k = 3; k >= 0; --k) path.push_back(vertex(side * k, row + 1));
    }
    for (size_t i = 0; i < path.size(); ++i) ASSERT_TRUE(is_edge(path[i], path[(i + 1) % path.size()])) << i;
    const uint64_t offsets[2] = {0, path.size()};
    hmf_loop_set set{};
    set.count = 1;
    set.offsets = offsets;
    set.elements = path.data();
    set.element_kind = HMF_PATH_VERTICES;
    const std::vector<cli::Line> lines = cli::loop_lines(s.f, set);
    ASSERT_EQ(lines.size(), 1u);
    cli::Line drawn;
    for (const uint32_t v : path) drawn.push_back(cli::place(s.f, v));
    const double polygon = 20 * 2 * 0.5 * std::sin(3.14159265358979 / 20);
    EXPECT_GT(length_of(drawn), 2 * polygon);
    EXPECT_LT(length_of(lines[0]), 1.02 * polygon);
    for (const cli::PlanePoint& p : lines[0]) {
        double nearest = 1e9;
        for (const cli::PlanePoint& q : drawn) nearest = std::min(nearest, cli::distance_of(p, q));
        EXPECT_LT(nearest, 0.3);
    }
}

// Whatever side of a surface the zeros are on, it is looked at from there.
TEST(Pictures, TheDefaultViewSeesTheZeros) {
    const TriMesh mesh = torus(60, 40, 2, 0.8);
    std::vector<cli::Vec> points;
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        points.push_back({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]});
    const cli::Samples samples = cli::sample_surface(points, mesh.triangles);
    const std::vector<cli::Vec> sides = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const cli::Vec side : sides) {
        std::vector<cli::Target> targets;
        for (size_t v = 0; v < points.size(); ++v) {
            bool is_highest = true; // of the points at hand
            for (size_t w = 0; w < points.size(); w += 7)
                is_highest = is_highest && cli::dot(side, points[w]) <= cli::dot(side, points[v]) + 0.02;
            if (is_highest) targets.push_back({{points[v]}, 1});
        }
        ASSERT_GE(targets.size(), 1u);
        const cli::View view = cli::best_view(samples, targets);
        EXPECT_GT(cli::dot(cli::unit(view.from), side), 0.1) << side.x << side.y << side.z;
    }
}

// Zeros at one place are drawn beside each other; a number tells an order above 1.
TEST(Pictures, ZerosThatLieTogetherAreAllSeen) {
    Solved s(torus(60, 40, 2, 0.8), {1});
    cli::PictureStyle style;
    style.width = 400;
    style.height = 300;
    style.has_view = true;
    style.view = {{0, 0, 1}, {0, 1, 0}};
    const double period = cli::wanted_period(s.f);
    // The highest vertex, which is seen from above.
    size_t top = 0;
    for (size_t v = 0; v < s.f.positions.size() / 3; ++v)
        if (s.f.positions[3 * v + 2] > s.f.positions[3 * top + 2]) top = v;
    const auto blue = [&](const std::vector<int>& orders) {
        s.f.singular.clear();
        for (const int order : orders) {
            hmf_singularity zero{};
            zero.index = -order;
            for (size_t k = 0; k < 3; ++k) zero.position[k] = s.f.positions[3 * top + k];
            s.f.singular.push_back(zero);
        }
        const cli::Image image = cli::render(s.f, cli::local_potential(s.f, period), {}, {}, style);
        size_t count = 0;
        for (size_t k = 0; k < image.rgb.size(); k += 3)
            count += image.rgb[k + 2] > 120 && image.rgb[k + 2] > 2 * image.rgb[k]
                  && image.rgb[k + 2] > image.rgb[k + 1] + 60;
        return double(count);
    };
    const double one = blue({1});
    EXPECT_EQ(blue({}), 0);
    EXPECT_GT(one, 10);
    EXPECT_GT(blue({1, 1}), 1.7 * one);
    EXPECT_GT(blue({1, 1, 1, 1}), 3.2 * one);
    // The number covers some of its ball.
    EXPECT_LT(blue({2}), 0.9 * one);
    EXPECT_GT(blue({2}), 0.3 * one);
}

// Bands of rows and parts of the file are the same, whichever thread makes them and in which order.
TEST(Pictures, HaveTheSameBytesWithEveryNumberOfThreads) {
    Solved s(torus(60, 40, 2, 0.8), {1});
    cli::PictureStyle style;
    style.width = 330;
    style.height = 250;
    style.legend = true;
    const cli::Potential potential = cli::local_potential(s.f, cli::wanted_period(s.f));
    const auto bytes = [&](hmf_control* control) {
        return cli::png_of(cli::render(s.f, potential, {}, {}, style, control), cli::Workers(control));
    };
    const std::string alone = bytes(nullptr);
    for (const bool backwards : {false, true}) {
        hmf_control control{};
        control.struct_size = sizeof control;
        control.workers = 3;
        control.parallel_user = backwards ? &control : nullptr;
        control.parallel_for = [](void* user, hmf_task_fn task, void* context, uint32_t count) {
            std::vector<std::thread> threads;
            for (uint32_t k = 0; k < count; ++k) {
                threads.emplace_back(task, context, user ? count - 1 - k : k);
                if (user) threads.back().join();
            }
            if (user) return;
            for (std::thread& t : threads) t.join();
        };
        EXPECT_EQ(bytes(&control) == alone, true) << backwards;
    }
}

// What a part throws comes back to the caller.
TEST(Pictures, APartThatFailsIsHeardOf) {
    hmf_control control{};
    control.struct_size = sizeof control;
    control.workers = 2;
    control.parallel_for = [](void*, hmf_task_fn task, void* context, uint32_t count) {
        for (uint32_t k = 0; k < count; ++k) std::thread(task, context, k).join();
    };
    const auto fail_at_2 = [](size_t k) {
        if (k == 2) throw std::bad_alloc();
    };
    EXPECT_THROW(cli::Workers(&control).each(4, fail_at_2), std::bad_alloc);
    size_t sum = 0;
    cli::Workers().each(5, [&](size_t k) { sum += k; });
    EXPECT_EQ(sum, 10u);
}

// The cost of a prefix code is the sum of the weights of the inner nodes of its tree, which joining the two lightest
// makes least.
TEST(Pictures, CodesAreBestAndNotTooLong) {
    std::vector<std::vector<uint32_t>> cases = {{0, 5}, {1, 1}, {0, 3, 0, 1, 1}, {7, 0, 7, 7, 7, 7}};
    std::vector<uint32_t> fibonacci{1, 1}, many(286, 0);
    while (fibonacci.size() < 24) fibonacci.push_back(fibonacci.end()[-1] + fibonacci.end()[-2]);
    for (uint32_t k = 0; k < many.size(); ++k) many[k] = k % 7 == 3 ? 0 : k * k % 1009;
    cases.push_back(fibonacci);
    cases.push_back(many);
    for (const std::vector<uint32_t>& counts : cases) {
        for (const unsigned longest : {30u, 15u}) {
            const std::vector<uint8_t> lengths = cli::code_lengths(counts, longest);
            std::multiset<uint64_t> heap;
            uint64_t cost = 0, least = 0;
            double kraft = 0;
            for (size_t s = 0; s < counts.size(); ++s) {
                EXPECT_EQ(lengths[s] > 0, counts[s] > 0);
                EXPECT_LE(lengths[s], longest);
                if (counts[s] == 0) continue;
                heap.insert(counts[s]);
                cost += uint64_t{counts[s]} * lengths[s];
                kraft += std::ldexp(1.0, -lengths[s]);
            }
            if (heap.size() == 1) continue; // one bit all the same
            EXPECT_EQ(kraft, 1);
            while (heap.size() > 1) {
                const uint64_t both = *heap.begin() + *std::next(heap.begin());
                heap.erase(heap.begin(), std::next(heap.begin(), 2));
                heap.insert(both);
                least += both;
            }
            if (longest == 30) EXPECT_EQ(cost, least);
            else EXPECT_GE(cost, least);
        }
    }
}

} // namespace test_pictures
