// Quad meshes by number, with short critical leaves merged, over poles, and
// relaxed: sound whatever the numbers are, on the surface, as many as wished.
#include "support/sample.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace test_quads {

using namespace test;

namespace {

using Made = Owned<hmf_quad_mesh>;

hmf_quad_options wish(uint64_t count, uint64_t relax) {
    hmf_quad_options options{};
    options.struct_size = sizeof options;
    options.count = count;
    options.merge = 1;
    options.relax = relax;
    return options;
}

Made quads_of(const Foliation& foliation, const hmf_quad_options& options) {
    return make<hmf_quad_mesh>([&](hmf_quad_mesh** out, hmf_error* error) {
        return hmf_quads(foliation.get(), &options, nullptr, out, error);
    });
}

hmf_error refusal_of(const Foliation& foliation, const hmf_quad_options& options) {
    hmf_quad_mesh* out = nullptr;
    hmf_error error{};
    hmf_quads(foliation.get(), &options, nullptr, &out, &error);
    EXPECT_EQ(out, nullptr);
    hmf_free(out);
    return error;
}

std::vector<uint32_t> random_marks(size_t vertices, size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<uint32_t> marks;
    while (marks.size() < count) {
        const uint32_t v = static_cast<uint32_t>(random.below(vertices));
        if (std::find(marks.begin(), marks.end(), v) == marks.end()) marks.push_back(v);
    }
    return marks;
}

// Edges of each vertex; fails the test unless the mesh is closed, oriented,
// manifold, without two edges that have the same ends, and of the genus.
std::vector<int> expect_sound(const hmf_quad_mesh& mesh, size_t genus) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> next; // side -> the one before it around its first vertex
    std::vector<int> valence(mesh.vertex_count, 0);
    for (size_t q = 0; q < mesh.quad_count; ++q)
        for (size_t s = 0; s < 4; ++s) {
            const uint32_t* quad = mesh.quads + 4 * q;
            const uint32_t a = quad[s], b = quad[(s + 1) % 4];
            EXPECT_LT(a, mesh.vertex_count);
            EXPECT_NE(a, b);
            EXPECT_TRUE(next.insert({{a, b}, quad[(s + 3) % 4]}).second) << "two sides from " << a << " to " << b;
            ++valence[a];
        }
    size_t open = 0;
    for (const auto& side : next) open += !next.count({side.first.second, side.first.first});
    EXPECT_EQ(open, 0u);
    EXPECT_EQ(static_cast<long>(mesh.vertex_count) - static_cast<long>(mesh.quad_count),
              2 - 2 * static_cast<long>(genus));
    if (open) return valence;
    std::vector<char> seen(mesh.vertex_count, 0);
    for (const auto& side : next) {
        const uint32_t v = side.first.first;
        if (seen[v]) continue;
        seen[v] = 1;
        int turns = 0;
        for (uint32_t to = side.first.second; turns == 0 || (to != side.first.second && turns <= valence[v]); ++turns)
            to = next.at({v, to});
        EXPECT_EQ(turns, valence[v]) << "vertex " << v;
    }
    for (size_t i = 0; i < 3 * mesh.vertex_count; ++i) EXPECT_TRUE(std::isfinite(mesh.positions[i]));
    return valence;
}

// Squared distance of a point from a triangle: from its plane where the foot lies
// inside, else from the nearest of its sides.
double square_distance(const double* p, const double* const* corner) {
    double n[3], best = HUGE_VAL;
    const auto cross = [](const double* o, const double* x, const double* y, double* out) {
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            out[k] = (x[i] - o[i]) * (y[j] - o[j]) - (x[j] - o[j]) * (y[i] - o[i]);
        }
    };
    const auto dot = [](const double* x, const double* y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
    cross(corner[0], corner[1], corner[2], n);
    bool inside = true;
    for (int s = 0; s < 3; ++s) {
        const double *a = corner[s], *b = corner[(s + 1) % 3];
        double m[3], foot = 0, length = 0, square = 0;
        cross(p, a, b, m);
        inside = inside && dot(m, n) >= 0;
        for (int k = 0; k < 3; ++k) {
            foot += (p[k] - a[k]) * (b[k] - a[k]);
            length += (b[k] - a[k]) * (b[k] - a[k]);
        }
        const double t = std::min(1.0, std::max(0.0, foot / length));
        for (int k = 0; k < 3; ++k) square += std::pow(p[k] - a[k] - t * (b[k] - a[k]), 2);
        best = std::min(best, square);
    }
    if (!inside) return best;
    double height = 0;
    for (int k = 0; k < 3; ++k) height += (p[k] - corner[0][k]) * n[k];
    return height * height / dot(n, n);
}

} // namespace

TEST(Quads, SoundOnRandomMarkedSurfaces) {
    size_t close = 0, tried = 0;
    for (size_t genus = 0; genus < 4; ++genus) {
        const TriMesh mesh = genus == 1 ? torus(24, 12, 2, 0.8) : pretzel(genus, 1);
        for (size_t n = genus == 0 ? 4 : 0; n <= 8; n += sample<size_t>(4, 8)) {
            const SolvedSurface surface(mesh, random_marks(mesh.vertex_count(), n, 7 * genus + n));
            ASSERT_TRUE(surface.solution.foliation);
            for (const uint64_t count : {1, 60, 300, 1500})
                for (const uint64_t relax : {0, 8}) {
                    SCOPED_TRACE("genus " + std::to_string(genus) + ", marks " + std::to_string(n) + ", count "
                                 + std::to_string(count) + ", relax " + std::to_string(relax));
                    hmf_quad_mesh* out = nullptr;
                    hmf_error error{};
                    const hmf_quad_options options = wish(count, relax);
                    const hmf_status status =
                        hmf_quads(surface.solution.foliation.get(), &options, nullptr, &out, &error);
                    const Made mesh_of_quads(out);
                    // Random marks may have one image, which no leaf tells apart; and nine quads of a torus are folded.
                    if (status == HMF_ERROR_QUADS && (n > 0 || count == 1)) continue;
                    ASSERT_EQ(status, HMF_OK) << error.message;
                    const std::vector<int> valence = expect_sound(*mesh_of_quads, genus);
                    EXPECT_EQ(std::count(valence.begin(), valence.end(), 2), 0);
                    EXPECT_EQ(static_cast<size_t>(
                                  std::count_if(valence.begin(), valence.end(), [](int v) { return v != 4; })),
                              mesh_of_quads->irregular_count);
                    if (count < 1500) continue;
                    ++tried;
                    const double off = static_cast<double>(mesh_of_quads->quad_count) / static_cast<double>(count) - 1;
                    EXPECT_LT(std::fabs(off), 0.1);
                    close += std::fabs(off) < 0.03;
                }
        }
    }
    EXPECT_GT(tried, 12u);
    EXPECT_GE(2 * close, tried);
}

TEST(Quads, PolesKeepTheirVertexIfWished) {
    const TriMesh mesh = pretzel(2, 1);
    const SolvedSurface surface(mesh, random_marks(mesh.vertex_count(), 4, 3));
    hmf_quad_options options = wish(1500, 0);
    options.keep_poles = 1;
    const Made kept = quads_of(surface.solution.foliation, options);
    options.keep_poles = 0;
    const Made made = quads_of(surface.solution.foliation, options);
    ASSERT_TRUE(kept && made);
    const std::vector<int> with = expect_sound(*kept, 2), without = expect_sound(*made, 2);
    // Each has one quad of its own less, and two vertices with three edges.
    const auto poles = std::count(with.begin(), with.end(), 2);
    EXPECT_GT(poles, 0);
    EXPECT_EQ(kept->quad_count, made->quad_count + static_cast<uint64_t>(poles));
    EXPECT_EQ(std::count(without.begin(), without.end(), 3), 2 * poles);
}

TEST(Quads, RelaxedVerticesAreOnTheSurface) {
    const TriMesh mesh = pretzel(2, 1);
    const SolvedSurface surface(mesh);
    const Made made = quads_of(surface.solution.foliation, wish(400, 10));
    ASSERT_TRUE(made);
    EXPECT_EQ(made->inverted_count, 0u);
    for (size_t v = 0; v < made->vertex_count; v += 7) {
        double best = HUGE_VAL;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            const double* corner[3];
            for (size_t c = 0; c < 3; ++c) corner[c] = &mesh.positions[3 * size_t{mesh.triangles[3 * t + c]}];
            best = std::min(best, square_distance(made->positions + 3 * v, corner));
        }
        EXPECT_LT(std::sqrt(best), 1e-9) << "vertex " << v;
    }
}

// A scaled mesh has the same quads, scaled; by a power of two, and twice, to the bit.
TEST(Quads, ScaleAndRepetition) {
    // Bit for bit by powers of two. Other factors change the rounding, which decides whether a step is taken where a
    // quad is about to fold, so some vertices move by a part of a side; a mesh without symmetry has no other ties.
    const auto quads_with_tunnels = [](const TriMesh& mesh) {
        const Hierarchy hierarchy(mesh);
        const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_TUNNEL);
        const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-8));
        return quads_of(solution.foliation, wish(900, 40));
    };
    const TriMesh mesh = uneven(pretzel(3, 1));
    const Made one = quads_with_tunnels(mesh), again = quads_with_tunnels(mesh);
    for (const double factor : {1.0, 1024.0, 1.0 / 1024, 1e3, 1e-3}) {
        const Made made = quads_with_tunnels(scaled(mesh, factor));
        ASSERT_TRUE(one && again && made);
        ASSERT_EQ(one->quad_count, made->quad_count) << factor;
        ASSERT_TRUE(std::equal(one->quads, one->quads + 4 * one->quad_count, made->quads)) << factor;
        double squares = 0;
        for (size_t i = 0; i < 3 * one->vertex_count; ++i) {
            ASSERT_EQ(one->positions[i], again->positions[i]);
            if (factor == 1 || factor > 1000 * 1.01 || factor < 0.99e-3) {
                ASSERT_EQ(one->positions[i] * factor, made->positions[i]) << factor;
            }
            squares += std::pow(one->positions[i] - made->positions[i] / factor, 2);
        }
        EXPECT_LT(std::sqrt(squares / double(one->vertex_count)), 0.1 * one->edge_length) << factor;
    }
}

// Critical leaves of a plate have no length by symmetry: any size works.
TEST(Quads, VeryFineSizes) {
    const SolvedSurface surface(plate(2));
    for (const double length : {1.0, 0.5, 0.2, 0.05, 0.02}) {
        hmf_quad_options options{};
        options.struct_size = sizeof options;
        options.edge_length = length;
        const Made made = quads_of(surface.solution.foliation, options);
        ASSERT_TRUE(made) << length;
        EXPECT_EQ(static_cast<long>(made->vertex_count) - static_cast<long>(made->quad_count), -2) << length;
        if (length > 0.1) expect_sound(*made, 2);
    }
}

// Quads much smaller than the triangles are as good as larger ones, but for one of four rotations (before each
// attempt to untangle looked further than the last, three had an inverted quad).
TEST(Quads, FinerThanTheTriangles) {
    for (int turn = 0; turn < sample(4, 1); ++turn) {
        SCOPED_TRACE(turn);
        const SolvedSurface surface(transformed(pretzel(2, 1), rotation(1, 2, 3, turn)));
        const Made made = quads_of(surface.solution.foliation, wish(30000, 10));
        ASSERT_TRUE(made);
        expect_sound(*made, 2);
        EXPECT_NEAR(static_cast<double>(made->quad_count), 30000, 0.03 * 30000);
        EXPECT_EQ(made->inverted_count, 0u);
    }
}

// Near the least possible number rounding stretches quads so much that some fold over: more are made.
TEST(Quads, MoreWhereTheFewestFold) {
    const SolvedSurface surface(plate(4));
    const Made made = quads_of(surface.solution.foliation, wish(60, 40)); // it needs 81, of which 7 fold over
    ASSERT_TRUE(made);
    expect_sound(*made, 4);
    EXPECT_LT(50 * made->inverted_count, made->quad_count);
}

TEST(Quads, Refusals) {
    const SolvedSurface surface(torus(24, 12, 2, 0.8));
    const Foliation& f = surface.solution.foliation;
    hmf_quad_options options = wish(100, 0);
    options.edge_length = 0.1;
    EXPECT_EQ(refusal_of(f, options).status, HMF_ERROR_OPTIONS);
    EXPECT_EQ(refusal_of(f, wish((uint64_t{1} << 28) + 1, 0)).status, HMF_ERROR_OPTIONS);
    EXPECT_EQ(refusal_of(f, wish(100, 1001)).status, HMF_ERROR_OPTIONS);
    EXPECT_TRUE(quads_of(f, wish(100, 1000)));
    for (const double length : {1e-5, 1e-9, 1e-300}) {
        options = wish(0, 0);
        options.edge_length = length;
        const hmf_error error = refusal_of(f, options);
        EXPECT_EQ(error.status, HMF_ERROR_OPTIONS) << length;
        EXPECT_NE(std::string(error.message).find("larger edge_length"), std::string::npos) << error.message;
    }
}

// A vertex on the line between two others of its triangle, up to rounding: the area is nothing but rounding, and what
// it measures must not decide how rows are joined.  With other rounding the quads are the same.
TEST(Quads, TrianglesThatAreFlatUpToRounding) {
    hmf_hierarchy_options build{};
    build.struct_size = sizeof build;
    build.mollify = 0.005;
    hmf_quad_options options{};
    options.struct_size = sizeof options;
    for (const double jitter : {0.0, 0.3})
        for (const size_t n : {4, 5, 6})
            for (size_t t = 0; t < 2 * n * n; ++t) {
                SCOPED_TRACE(std::to_string(n) + ", " + std::to_string(t));
                Made made[2];
                for (const size_t k : {0, 1}) {
                    TriMesh mesh = torus(n, n, 2, 1, {true, 1, jitter, 7});
                    flatten(mesh, t, k == 1);
                    const Hierarchy hierarchy(mesh, build);
                    const Solution solution = solve(hierarchy, nullptr, solve_options(0, 0));
                    ASSERT_TRUE(solution.foliation);
                    made[k] = quads_of(solution.foliation, options);
                    ASSERT_TRUE(made[k]);
                    expect_sound(*made[k], 1);
                    for (size_t i = 0; i < 3 * made[k]->vertex_count; ++i)
                        ASSERT_TRUE(std::isfinite(made[k]->positions[i]));
                }
                if (jitter == 0) continue; // symmetric: rounding decides ties
                ASSERT_EQ(made[0]->vertex_count, made[1]->vertex_count);
                for (size_t i = 0; i < 3 * made[0]->vertex_count; ++i)
                    ASSERT_NEAR(made[0]->positions[i], made[1]->positions[i], 1e-6);
            }
}

// Local gradients that differ by a factor of a million, beside triangles of 0.00001 degrees: by lengths that follow
// them, the columns of a cylinder's two sides would be millions apart. By those of the flat surface few steps match
// them (each asks once for progress), and the quads are as many as wished and sound.
TEST(Quads, ColumnsThatAreMillionsApart) {
    hmf_hierarchy_options build{};
    build.struct_size = sizeof build;
    build.mollify = 1e-5;
    const Hierarchy hierarchy(with_bad_triangles(plate(3), 10, 1e-5, 4), build);
    const Solution solution = solve(hierarchy, nullptr, solve_options(0, 0));
    ASSERT_TRUE(solution.foliation);
    size_t reports = 0;
    hmf_control control{};
    control.struct_size = sizeof control;
    control.progress_user = &reports;
    control.progress = [](void* user, double) -> int32_t {
        ++*static_cast<size_t*>(user);
        return HMF_PROGRESS_CONTINUE;
    };
    const hmf_quad_options options = wish(5000, 0);
    const Made made = make<hmf_quad_mesh>([&](hmf_quad_mesh** out, hmf_error* error) {
        return hmf_quads(solution.foliation.get(), &options, &control, out, error);
    });
    ASSERT_TRUE(made);
    EXPECT_LT(reports, 300000u);
    EXPECT_NEAR(static_cast<double>(made->quad_count), 5000, 50);
    expect_sound(*made, 3);
}

// The corners of a plate stick out: vertices of relaxed quads lie on most of them.
TEST(Quads, TipsAreReached) {
    const TriMesh mesh = plate(2);
    const SolvedSurface surface(mesh);
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], mesh.positions[i]);
        high[i % 3] = std::max(high[i % 3], mesh.positions[i]);
    }
    const Made made = quads_of(surface.solution.foliation, wish(1500, 10));
    ASSERT_TRUE(made);
    expect_sound(*made, 2);
    int reached = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        double nearest = HUGE_VAL;
        for (size_t v = 0; v < made->vertex_count; ++v) {
            double square = 0;
            for (size_t k = 0; k < 3; ++k) {
                const double d = made->positions[3 * v + k] - (corner >> k & 1u ? high[k] : low[k]);
                square += d * d;
            }
            nearest = std::min(nearest, square);
        }
        reached += nearest == 0;
    }
    EXPECT_GE(reached, 6);
}

// Where rows run along sharp edges their vertices lie on them.
TEST(Quads, SharpEdgesAreFollowed) {
    const TriMesh mesh = plate(2); // all edges of its faces are sharp, at whole coordinates
    const SolvedSurface surface(mesh);
    const auto on_edges = [&](uint64_t relax) {
        const Made made = quads_of(surface.solution.foliation, wish(3000, relax));
        size_t count = 0;
        for (size_t v = 0; v < made->vertex_count; ++v) {
            int whole = 0; // coordinates; x and y at holes and sides, z at top and bottom
            for (size_t k = 0; k < 3; ++k) {
                const double x = made->positions[3 * v + k];
                whole += std::fabs(x - std::floor(x + 0.5)) < 1e-9;
            }
            count += whole >= 2;
        }
        if (relax > 0) {
            EXPECT_EQ(made->inverted_count, 0u);
            expect_sound(*made, 2);
        }
        return count;
    };
    EXPECT_GT(on_edges(10), 3 * on_edges(0) + 50);
}

} // namespace test_quads
