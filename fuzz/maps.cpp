// What follows from a foliation, judged by the arrays of the results alone, on coarse and extreme surfaces: swept tubes
// with radius up to e^6, small handles, Dehn twists, knots, gyroids and sponges, walls, fans and wheels of high
// valence, every vertex marked.  Judged are (u, v), cylinders, leaves and charts.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "../tests/support/extreme_surfaces.hpp"
#include "../tests/support/implicit_surface.hpp"
#include "../tests/support/map_problems.hpp"
#include "bytes.hpp"
#include "owned.hpp"

namespace {

using namespace fuzz;
using namespace test::map_problems;
using test::PI;
using test::Random;
using test::TriMesh;

// --- Problems ----------------------------------------------------------------

Problem of(TriMesh mesh, bool has_boundary = false) {
    Problem p;
    p.mesh = std::move(mesh);
    p.has_boundary = has_boundary;
    return p;
}

Problem knot(Random& random) {
    const size_t n = 12 + random.below(60), m = 3 + random.below(4);
    return of(test::trefoil(n, m, 0.05 + 0.4 * random.unit()));
}

// Gyroids, blobs and waves with handles of any size.
Problem sponge(Random& random) {
    const size_t n = 5 + random.below(4);
    const double frequency = 2 + 4 * random.unit();
    return of(test::random_implicit_surface(n, frequency, random));
}

Problem walls(Random& random) {
    const size_t n = 4 + random.below(40);
    const auto strips = random.below(2) ? test::Strips::fans : test::Strips::ladder;
    return of(test::walled_ring(n, strips, random.bits()));
}

Problem ring_of_fans(Random& random) { return of(test::flat_ring(8 * (1 + random.below(12)), test::Strips::fans)); }

// Valence up to 300; one of 64 has 50 000, the most that is solved for.
Problem wheel(Random& random) {
    const size_t n = random.below(64) ? 3 + random.below(300) : 50000;
    return of(test::wheels(n, 1, random.unit()));
}

Problem all_marked(Random& random) {
    const size_t n = 3 + random.below(4), m = 3 + random.below(3);
    Problem p = of(test::torus(n, m, 3, 0.3 + 2 * random.unit()));
    p.marks.resize(p.mesh.vertex_count());
    std::iota(p.marks.begin(), p.marks.end(), 0u);
    p.kind = HMF_LOOPS_PANTS;
    return p;
}

Problem any_problem(Bytes& bytes) {
    Problem (*const makers[])(Random&) = {
        closed,         open, sphere, marked, twisted,      genus_two, genus_two_pants, genus_three_pants,
        thin_cylinders, knot, sponge, walls,  ring_of_fans, wheel,     all_marked};
    constexpr uint32_t count = sizeof makers / sizeof *makers;
    const uint32_t which = bytes.below(count);
    Random random(bytes.wide_below(65536));
    return makers[which](random);
}

// --- Judges ------------------------------------------------------------------

struct Case {
    const Problem& problem;
    const hmf_level_mesh& mesh;
    const hmf_foliation* foliation;
    const double* value; // |du| of the foliation, per edge
    const hmf_loop_set& loops;
    double energy, unit;
    size_t n() const { return static_cast<size_t>(mesh.triangle_count); }
};

size_t after(size_t corner) { return corner - corner % 3 + (corner + 1) % 3; }

// (u, v): both sides of an edge are where its transition says, signs go around vertices as cones say, and areas.
void judge_map(const Case& c, const hmf_parameterization& map) {
    double area = 0, absolute = 0, largest = 0;
    for (size_t i = 0; i < 6 * c.n(); ++i) largest = std::max(largest, std::fabs(map.corner_uv[i]));
    for (size_t t = 0; t < c.n(); ++t) {
        const double* const p = map.corner_uv + 6 * t;
        const double twice = (p[2] - p[0]) * (p[5] - p[1]) - (p[4] - p[0]) * (p[3] - p[1]);
        area += 0.5 * twice;
        absolute += 0.5 * std::fabs(twice);
    }
    FUZZ_ASSERT(std::fabs(area - map.area) <= 1e-9 * absolute);
    FUZZ_ASSERT(area > 0.9 * c.energy && area < 1.5 * c.energy);
    FUZZ_ASSERT(absolute < 1.5 * c.energy * (1 + 1e-9));
    FUZZ_ASSERT(map.circumference_least > 0.5 && map.circumference_most < 2);
    std::vector<size_t> first(c.mesh.edge_count, SIZE_MAX);
    const double rounding = std::ldexp(largest, -50);
    for (size_t side = 0; side < 3 * c.n(); ++side) {
        const size_t e = c.mesh.triangle_edges[side];
        if (first[e] == SIZE_MAX) {
            first[e] = side;
            continue;
        }
        const double* const g = map.transition + 3 * e;
        const size_t ends[2][2] = {{first[e], after(side)}, {after(first[e]), side}};
        for (const auto& end : ends)
            for (size_t x = 0; x < 2; ++x)
                FUZZ_ASSERT(std::fabs(g[0] * map.corner_uv[2 * end[0] + x] + g[1 + x] - map.corner_uv[2 * end[1] + x])
                            <= rounding);
    }
    if (c.problem.has_boundary) return;
    std::vector<double> sign(c.mesh.vertex_count, 1);
    long turns = 0;
    for (size_t e = 0; e < c.mesh.edge_count; ++e)
        for (size_t end = 0; end < 2; ++end) sign[c.mesh.edge_vertices[2 * e + end]] *= map.transition[3 * e];
    for (size_t v = 0; v < c.mesh.vertex_count; ++v) {
        FUZZ_ASSERT((map.cone[v] % 2 != 0) == (sign[v] < 0));
        turns += 2 - map.cone[v];
    }
    FUZZ_ASSERT(turns == 4 - 4 * static_cast<long>(c.problem.mesh.genus));
}

// From one triangle of a leaf to the next: the edge that both have.
size_t common_edge(const Case& c, uint32_t s, uint32_t t) {
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
            if (c.mesh.triangle_edges[3 * s + i] == c.mesh.triangle_edges[3 * t + j])
                return c.mesh.triangle_edges[3 * s + i];
    FUZZ_ASSERT(false);
    return 0;
}

// Once along a leaf through triangles (u, v) come back moved by (0, circumference), where no zero is near: the cylinder
// is four times as high as the triangles of the leaf.
void judge_leaf(const Case& c, const hmf_parameterization& map, const hmf_cylinder& cylinder, const uint32_t* leaf,
                size_t length) {
    double widest = 0, sign = 1, u = 0, v = 0;
    std::vector<size_t> first(c.mesh.edge_count, SIZE_MAX);
    for (size_t side = 3 * c.n(); side-- > 0;) first[c.mesh.triangle_edges[side]] = side / 3;
    for (size_t i = 0; i < length; ++i) {
        for (size_t k = 0; k < 3; ++k) widest = std::max(widest, c.value[c.mesh.triangle_edges[3 * leaf[i] + k]]);
        const size_t e = common_edge(c, leaf[i], leaf[(i + 1) % length]);
        const double* const g = map.transition + 3 * e;
        // The transition, or its inverse.
        const bool ahead = first[e] == leaf[i];
        u = ahead ? g[0] * u + g[1] : g[0] * (u - g[1]);
        v = ahead ? g[0] * v + g[2] : g[0] * (v - g[2]);
        sign *= g[0];
    }
    if (length < 3 || 4 * widest > cylinder.height) return;
    FUZZ_ASSERT(sign > 0);
    FUZZ_ASSERT(std::fabs(u) <= 1e-9 * (std::fabs(u) + std::fabs(v) + widest));
    FUZZ_ASSERT(std::fabs(v) > 0.5 * cylinder.circumference && std::fabs(v) < 2 * cylinder.circumference);
}

void judge_cylinders(const Case& c, const hmf_cylinder_set& set, const hmf_parameterization* map) {
    double sum = 0;
    std::vector<uint32_t> met(c.loops.count, 0);
    for (size_t i = 0; i < set.count; ++i) {
        const hmf_cylinder& cylinder = set.list[i];
        sum += cylinder.height * cylinder.circumference;
        FUZZ_ASSERT(cylinder.loop < c.loops.count);
        ++met[cylinder.loop];
        const double weight = c.loops.weights ? c.loops.weights[cylinder.loop] : 1;
        FUZZ_ASSERT(std::fabs(cylinder.height - weight) <= 64 * c.unit);
        if (map && !c.problem.has_boundary)
            judge_leaf(c, *map, cylinder, set.leaves->elements + set.leaves->offsets[i],
                       static_cast<size_t>(set.leaves->offsets[i + 1] - set.leaves->offsets[i]));
    }
    for (const uint32_t m : met) FUZZ_ASSERT(m == 1);
    FUZZ_ASSERT(std::fabs(sum - c.energy) <= 1e-4 * c.energy);
}

// Closed leaves: each passes from edge to edge of one triangle, as far from the corner between them on both, by the
// values of the foliation.
void judge_lines(const Case& c, const hmf_lines& lines, const hmf_cylinder_set& set, double spacing) {
    std::vector<size_t> count(set.count, 0);
    const double largest = *std::max_element(c.value, c.value + c.mesh.edge_count);
    const auto along = [&](size_t point, uint32_t from) {
        const uint32_t e = lines.point_edges[point];
        const uint32_t* const ends = c.mesh.edge_vertices + 2 * size_t{e};
        double squares = 0, length = 0;
        for (size_t x = 0; x < 3; ++x) {
            const double a = c.problem.mesh.positions[3 * size_t{ends[0]} + x],
                         b = c.problem.mesh.positions[3 * size_t{ends[1]} + x],
                         p = lines.points[3 * point + x] - c.problem.mesh.positions[3 * size_t{from} + x];
            squares += p * p;
            length += (a - b) * (a - b);
        }
        return length > 0 ? std::sqrt(squares / length) * c.value[e] : 0;
    };
    for (size_t l = 0; l < lines.line_count; ++l) {
        const hmf_line& line = lines.lines[l];
        if (line.kind != HMF_LINE_LEVEL) continue;
        FUZZ_ASSERT(line.closed && line.cylinder < set.count);
        ++count[line.cylinder];
        const size_t begin = static_cast<size_t>(lines.offsets[l]), end = static_cast<size_t>(lines.offsets[l + 1]);
        for (size_t i = begin; i < end; ++i) {
            const size_t j = i + 1 < end ? i + 1 : begin;
            const uint32_t *const a = c.mesh.edge_vertices + 2 * size_t{lines.point_edges[i]},
                                  *const b = c.mesh.edge_vertices + 2 * size_t{lines.point_edges[j]};
            const uint32_t corner = a[0] == b[0] || a[0] == b[1] ? a[0] : a[1];
            FUZZ_ASSERT(corner == b[0] || corner == b[1]);
            FUZZ_ASSERT(std::fabs(along(i, corner) - along(j, corner)) <= 1e-6 * largest);
        }
    }
    for (size_t i = 0; i < set.count; ++i)
        FUZZ_ASSERT(count[i] == std::max<size_t>(1, static_cast<size_t>(std::llround(set.list[i].height / spacing))));
}

using Triangle = std::array<double, 6>;

// Whether a side of a has all of b on its right, up to rounding.
bool is_apart(const Triangle& a, const Triangle& b) {
    constexpr double rounding = 1e-12;
    for (size_t i = 0; i < 3; ++i) {
        const size_t j = (i + 1) % 3;
        const double x = a[2 * j] - a[2 * i], y = a[2 * j + 1] - a[2 * i + 1];
        bool apart = true;
        for (size_t k = 0; k < 3; ++k)
            apart = apart && x * (b[2 * k + 1] - a[2 * i + 1]) - y * (b[2 * k] - a[2 * i]) <= rounding;
        if (apart) return true;
    }
    return false;
}

// Triangles are in the square, keep their orientation, and do not overlap.
void judge_charts(const Case& c, const hmf_chart_set& charts) {
    std::vector<Triangle> shapes;
    for (size_t t = 0; t < c.n(); ++t) {
        Triangle p;
        std::copy(charts.corner_uv + 6 * t, charts.corner_uv + 6 * t + 6, p.begin());
        for (const double x : p) FUZZ_ASSERT(x >= 0 && x <= 1);
        const double twice = (p[2] - p[0]) * (p[5] - p[1]) - (p[4] - p[0]) * (p[3] - p[1]);
        FUZZ_ASSERT(twice >= 0);
        if (twice > 1e-10) shapes.push_back(p);
    }
    const auto left = [](const Triangle& p) { return std::min({p[0], p[2], p[4]}); };
    const auto right = [](const Triangle& p) { return std::max({p[0], p[2], p[4]}); };
    std::sort(shapes.begin(), shapes.end(), [&](const Triangle& a, const Triangle& b) { return left(a) < left(b); });
    for (size_t i = 0; i < shapes.size(); ++i)
        for (size_t j = i + 1; j < shapes.size() && left(shapes[j]) < right(shapes[i]); ++j)
            FUZZ_ASSERT(is_apart(shapes[i], shapes[j]) || is_apart(shapes[j], shapes[i]));
}

// --- One input ---------------------------------------------------------------

// NULL where the library says that it cannot.
template <class T, class Call>
Owned<T> unless_unsupported(Call&& call) {
    T* out = nullptr;
    hmf_error error{};
    const hmf_status status = call(&out, &error);
    if (status != HMF_OK && status != HMF_ERROR_UNSUPPORTED) std::fprintf(stderr, "%s\n", error.message);
    FUZZ_ASSERT(status == HMF_OK || status == HMF_ERROR_UNSUPPORTED);
    return Owned<T>(out);
}

void judge_all(const Case& c, double spacing, bool with_charts) {
    const auto map = unless_unsupported<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(c.foliation, nullptr, nullptr, out, error);
    });
    if (map) judge_map(c, *map);
    const auto set = unless_unsupported<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(c.foliation, &c.loops, nullptr, out, error);
    });
    if (set) judge_cylinders(c, *set, map.get());
    if (set && !c.problem.has_boundary) {
        hmf_trace_options options = sized<hmf_trace_options>();
        options.spacing = spacing;
        const auto lines = unless_unsupported<hmf_lines>(
            [&](hmf_lines** out, hmf_error* error) { return hmf_trace(c.foliation, &options, nullptr, out, error); });
        if (lines) judge_lines(c, *lines, *set, spacing);
    }
    if (!with_charts) return;
    const auto charts = unless_unsupported<hmf_chart_set>(
        [&](hmf_chart_set** out, hmf_error* error) { return hmf_atlas(c.foliation, nullptr, nullptr, out, error); });
    if (charts) judge_charts(c, *charts);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Problem p = any_problem(bytes);
    if (p.mesh.triangle_count() == 0) return 0;
    hmf_hierarchy_options build = sized<hmf_hierarchy_options>();
    Owned<hmf_mark_set> suggested;
    if (p.is_sphere) {
        suggested = unless_unsupported<hmf_mark_set>([&](hmf_mark_set** out, hmf_error* error) {
            return hmf_suggest_marks(p.mesh.positions.data(), p.mesh.vertex_count(), p.mesh.triangles.data(),
                                     p.mesh.triangle_count(), nullptr, nullptr, out, error);
        });
        if (!suggested) return 0;
        p.marks.assign(suggested->marked_vertices, suggested->marked_vertices + suggested->marked_count);
    }
    build.marked_vertices = p.marks.data();
    build.marked_count = p.marks.size();
    hmf_hierarchy* made = nullptr;
    // Some triangulations have too few vertices, or too few for their marks.
    if (hmf_hierarchy_create(p.mesh.positions.data(), p.mesh.vertex_count(), p.mesh.triangles.data(),
                             p.mesh.triangle_count(), &build, nullptr, &made, nullptr))
        return 0;
    const Owned<hmf_hierarchy> hierarchy(made);
    p.mesh.genus = static_cast<size_t>(hmf_hierarchy_describe(made)->genus);
    hmf_loop_set loops = sized<hmf_loop_set>();
    Owned<hmf_loop_set> chosen;
    const uint64_t drawn[2] = {0, p.path.size()};
    if (p.path.empty()) {
        chosen = unless_unsupported<hmf_loop_set>([&](hmf_loop_set** out, hmf_error* error) {
            return hmf_loops(hierarchy.get(), 0, p.kind, nullptr, out, error);
        });
        if (!chosen) return 0;
        loops = *chosen;
    } else {
        loops.element_kind = HMF_PATH_VERTICES;
        loops.count = 1;
        loops.offsets = drawn;
        loops.elements = p.path.data();
    }
    const uint32_t octaves = bytes.below(2) * 10;
    std::vector<double> weights;
    for (size_t i = 0; i < loops.count; ++i)
        weights.push_back(std::exp2(octaves * (static_cast<double>(bytes.byte()) / 255 - 0.5)));
    loops.weights = weights.data();
    hmf_foliation* solved = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_solve(hierarchy.get(), &loops, nullptr, nullptr, &solved, &error);
    const Owned<hmf_foliation> foliation(solved);
    if (status != HMF_OK) return 0;
    hmf_level_mesh* level = nullptr;
    FUZZ_ASSERT(hmf_level(hierarchy.get(), 0, nullptr, &level, nullptr) == HMF_OK);
    const Owned<hmf_level_mesh> mesh(level);
    size_t count = 0;
    const double* const value = hmf_foliation_values(solved, &count);
    FUZZ_ASSERT(count == level->edge_count);
    const Case c{p, *level, solved, value, loops, hmf_foliation_report(solved)->energy, hmf_foliation_unit(solved)};
    double largest = 0;
    for (const double w : weights) largest = std::max(largest, w);
    const double spacing = largest * (0.05 + static_cast<double>(bytes.byte()) / 256);
    judge_all(c, spacing, bytes.below(4) == 0 && c.n() < 3000);
    return 0;
}
