// Twists of cylinders: closed forms on flat tori, and laws on surfaces of genus 2.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_twists {

using namespace test;

namespace {

using Cylinders = Owned<hmf_cylinder_set>;

Cylinders cylinders_of(const Foliation& foliation, const Loops& loops) {
    const hmf_loop_set set = loops.view();
    return make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(foliation.get(), &set, nullptr, out, error);
    });
}

Cylinders cylinders_of(const Hierarchy& hierarchy, const Loops& loops) {
    const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-10));
    EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
    return cylinders_of(solution.foliation, loops);
}

// n x m rectangles of a x 1, each with its center, glued to a flat torus: (i + n, j) = (i, j), (i, m) = (i + shift, 0).
// Every line of the grid is folded, so the points lie in one rectangle; shift, n and m are even.
struct FlatTorus {
    size_t n, m, shift;
    double a;

    uint32_t corner(size_t i, size_t j) const { return static_cast<uint32_t>(j < m ? i % n + n * j : (i + shift) % n); }
    uint32_t center(size_t i, size_t j) const { return static_cast<uint32_t>(n * m + i % n + n * j); }

    TriMesh mesh() const {
        TriMesh mesh;
        mesh.genus = 1;
        for (size_t j = 0; j < m; ++j)
            for (size_t i = 0; i < n; ++i)
                mesh.positions.insert(mesh.positions.end(), {i % 2 ? a : 0, j % 2 ? 1.0 : 0, 0});
        for (size_t k = 0; k < n * m; ++k) mesh.positions.insert(mesh.positions.end(), {a / 2, 0.5, 0});
        for (size_t j = 0; j < m; ++j)
            for (size_t i = 0; i < n; ++i) {
                const uint32_t at[4] = {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
                for (size_t k = 0; k < 4; ++k) add_triangle(mesh, at[k], at[(k + 1) % 4], center(i, j));
            }
        return mesh;
    }

    // One row has height 1.
    std::vector<double> values(const Hierarchy& hierarchy) const {
        const LevelMesh level = read_level(hierarchy, 0);
        std::vector<double> values;
        for (size_t e = 0; e < level.edge_count; ++e) {
            const uint32_t v = level.edge_vertices[2 * e], w = level.edge_vertices[2 * e + 1];
            const bool to_center = v >= n * m || w >= n * m;
            values.push_back(to_center ? 0.5 : v / n == w / n ? 0 : 1);
        }
        return values;
    }

    // Vertices of a simple path from a corner to itself, m rows up and `steps` corners along them.
    std::vector<uint32_t> staircase(int steps) const {
        std::vector<uint32_t> path;
        const int rows = static_cast<int>(m), sense = steps < 0 ? -1 : 1;
        for (int j = 0, i = 0; j < rows; ++j) {
            for (; i != steps * (j + 1) / rows; i += sense) path.push_back(corner_at(i, j));
            path.push_back(corner_at(i, j));
        }
        return path;
    }
    uint32_t corner_at(int i, int j) const {
        const int row = static_cast<int>(n);
        return corner(static_cast<size_t>((i % row + row) % row), static_cast<size_t>(j));
    }

    // Through the first row, below the centers or above them.
    void add_row(Loops& loops, bool above) const {
        std::vector<uint32_t> strip;
        for (uint32_t i = 0; i < n; ++i) strip.insert(strip.end(), {4 * i + 3, above ? 4 * i + 2 : 4 * i, 4 * i + 1});
        loops.add(strip);
    }
};

void expect_equal_places(double place, double expected, double circumference) {
    EXPECT_NEAR(std::remainder(place - expected, circumference), 0, 1e-6 * circumference) << place << " " << expected;
}

struct Side {
    std::vector<uint32_t> vertices;
    std::vector<double> places;
};
Side side_of(const Cylinders& set, size_t cylinder, size_t side) {
    const uint64_t begin = set->corner_offsets[2 * cylinder + side], end = set->corner_offsets[2 * cylinder + side + 1];
    return {{set->corner_vertices + begin, set->corner_vertices + end},
            {set->corner_places + begin, set->corner_places + end}};
}

// What holds for every cylinder with corners.  even: there are vertices of even order, around which the conjugate is
// not closed, so that both sides of an arc have different lengths.
void expect_twists(const Cylinders& set, bool even = false) {
    ASSERT_TRUE(set);
    std::vector<double> arcs;
    for (size_t c = 0; c < set->count; ++c) {
        const double whole = set->list[c].circumference;
        uint32_t lowest[2];
        for (size_t k = 0; k < 2; ++k) {
            const Side side = side_of(set, c, k);
            ASSERT_FALSE(side.places.empty());
            lowest[k] = side.vertices[0];
            double round = 0;
            for (size_t i = 0; i < side.places.size(); ++i) {
                EXPECT_GE(side.vertices[i], lowest[k]);
                EXPECT_TRUE(side.places[i] >= 0 && side.places[i] < whole);
                double arc = side.places[(i + 1) % side.places.size()] - side.places[i];
                if (arc <= 0) arc += whole;
                arcs.push_back(arc);
                round += arc;
            }
            EXPECT_NEAR(round, whole, 1e-9 * whole);
            EXPECT_EQ(side.places[0], k == 0 ? 0 : set->twists[c]);
        }
        EXPECT_LE(lowest[0], lowest[1]);
    }
    if (even) return;
    // Every arc has two sides.
    ASSERT_EQ(arcs.size() % 2, 0u);
    std::sort(arcs.begin(), arcs.end());
    for (size_t i = 0; i < arcs.size(); i += 2) EXPECT_NEAR(arcs[i], arcs[i + 1], 1e-6 * arcs.back());
}

} // namespace

// The sides are one leaf, and the shift of the gluing is the twist.
TEST(Twists, OfFlatTori) {
    for (const double a : {1.0, 1.5, 0.75})
        for (const size_t shift : {0, 2, 6, 10}) {
            SCOPED_TRACE(testing::Message() << a << " " << shift);
            const FlatTorus torus{12, 8, shift, a};
            const Hierarchy hierarchy(torus.mesh(), 0, 1000);
            ASSERT_TRUE(hierarchy);
            Loops loops;
            torus.add_row(loops, false);
            loops.weights = {8};
            // Solved, and with edges of value 0 along every row.
            for (const bool exact : {false, true}) {
                const auto set = exact ? cylinders_of(create(hierarchy, 0, torus.values(hierarchy)), loops)
                                       : cylinders_of(hierarchy, loops);
                ASSERT_TRUE(set);
                ASSERT_EQ(set->count, 1u);
                EXPECT_NEAR(set->list[0].circumference, 12 * a, 1e-6);
                EXPECT_TRUE(set->twists[0] >= 0 && set->twists[0] < set->list[0].circumference);
                expect_equal_places(set->twists[0], a * static_cast<double>(shift), 12 * a);
                EXPECT_EQ(set->corner_offsets[2], 0u);
            }
        }
}

// A Dehn twist about the loop of a cylinder adds its circumference to the twist, which is modulo the circumference and
// so stays the same.  Dehn twists about a curve that crosses the loop make other loops of it: on a flat torus their
// twists have a closed form.
TEST(Twists, AfterDehnTwists) {
    for (const double a : {1.0, 0.75})
        for (const size_t shift : {0, 2, 10})
            for (const int turns : {-2, -1, 0, 1, 2}) {
                SCOPED_TRACE(testing::Message() << a << " " << shift << " " << turns);
                const FlatTorus torus{12, 8, shift, a};
                const Hierarchy hierarchy(torus.mesh(), 0, 1000);
                ASSERT_TRUE(hierarchy);
                // Once up and `turns` times around a row.
                const int steps = 12 * turns - static_cast<int>(shift);
                Loops loops;
                loops.kind = HMF_PATH_VERTICES;
                loops.add(torus.staircase(steps));
                const double x = a * steps, y = 8, length = std::sqrt(x * x + y * y), height = 12 * a * y / length;
                loops.weights = {height};
                const auto set = cylinders_of(hierarchy, loops);
                ASSERT_TRUE(set);
                ASSERT_EQ(set->count, 1u);
                EXPECT_NEAR(set->list[0].circumference, length, 1e-6 * length);
                expect_equal_places(set->twists[0], 12 * a * x / length, length);
            }
}

// Two marked vertices, between which there are two cylinders.
TEST(Twists, OfMarkedFlatTori) {
    for (const size_t shift : {0, 4})
        for (const size_t p : {0, 1, 7})
            for (const double unit : {1.0, 3.0}) {
                SCOPED_TRACE(testing::Message() << shift << " " << p << " " << unit);
                const FlatTorus torus{12, 8, shift, 1};
                const std::vector<uint32_t> marks{torus.center(0, 0), torus.center(p, 3)};
                const Hierarchy hierarchy(torus.mesh(), with_marks(marks, 0, 1000));
                ASSERT_TRUE(hierarchy);
                Loops loops;
                torus.add_row(loops, true);
                torus.add_row(loops, false);
                loops.weights = {3 * unit, 5 * unit};
                const auto set = cylinders_of(hierarchy, loops);
                ASSERT_TRUE(set);
                ASSERT_EQ(set->count, 2u);
                for (size_t c = 0; c < 2; ++c) {
                    EXPECT_NEAR(set->list[c].circumference, 12 * unit, 1e-6);
                    EXPECT_EQ(side_of(set, c, 0).vertices, std::vector<uint32_t>{marks[0]});
                    EXPECT_EQ(side_of(set, c, 1).vertices, std::vector<uint32_t>{marks[1]});
                    const double right = static_cast<double>(p);
                    expect_equal_places(set->twists[c],
                                        unit * (set->list[c].loop == 0 ? -right : right + static_cast<double>(shift)),
                                        12 * unit);
                }
                expect_twists(set);
            }
}

// By its mirror image a torus of revolution has no twist.
TEST(Twists, OfATorusOfRevolution) {
    const Hierarchy hierarchy(torus(24, 16, 3, 1));
    const auto set = cylinders_of(hierarchy, meridian(hierarchy, 0));
    ASSERT_TRUE(set);
    ASSERT_EQ(set->count, 1u);
    expect_equal_places(set->twists[0], 0, set->list[0].circumference);
}

namespace {

// Vertices of `mesh` in a random order; to[v]: the new number.
TriMesh renumbered(const TriMesh& mesh, std::vector<uint32_t>& to) {
    Random random(7);
    to.resize(mesh.vertex_count());
    for (uint32_t v = 0; v < to.size(); ++v) to[v] = v;
    for (size_t v = to.size(); v-- > 1;) std::swap(to[v], to[random.below(v + 1)]);
    TriMesh made = mesh;
    for (size_t v = 0; v < to.size(); ++v) std::copy_n(&mesh.positions[3 * v], 3, &made.positions[size_t{3} * to[v]]);
    for (uint32_t& v : made.triangles) v = to[v];
    return made;
}

TriMesh mirrored(TriMesh mesh) {
    for (size_t v = 0; v < mesh.vertex_count(); ++v) mesh.positions[3 * v] *= -1;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) std::swap(mesh.triangles[3 * t + 1], mesh.triangles[3 * t + 2]);
    return mesh;
}

// From cylinder c of `set` to cylinder d of `found`: the same corners, up to the choice of the base and of the first
// side.  to: the numbers of the vertices there.  mirror: -1 for the mirror image.
void expect_same_corners(const Cylinders& set, size_t c, const Cylinders& found, size_t d,
                         const std::vector<uint32_t>& to, double mirror) {
    const double whole = set->list[c].circumference;
    Side sides[2] = {side_of(set, c, 0), side_of(set, c, 1)};
    for (Side& side : sides)
        for (uint32_t& v : side.vertices) v = to[v];
    const Side there[2] = {side_of(found, d, 0), side_of(found, d, 1)};
    double best = whole;
    for (const size_t swapped : {0, 1})
        for (size_t base = 0; base < sides[swapped].places.size(); ++base) {
            double worst = 0;
            for (size_t k = 0; k < 2; ++k) {
                const Side& here = sides[k ^ swapped];
                const size_t n = here.places.size();
                // In the order of the leaf, the other way around in the mirror image.
                size_t shift = k == 0 ? base : n;
                if (k == 1)
                    for (size_t l = 0; l < n; ++l) {
                        const double place =
                            mirror * (swapped ? -1 : 1) * (here.places[l] - sides[swapped].places[base]);
                        if (std::fabs(std::remainder(place - there[1].places[0], whole)) < 1e-6 * whole) shift = l;
                    }
                if (shift == n || there[k].places.size() != n) {
                    worst = whole;
                    break;
                }
                for (size_t i = 0; i < n; ++i) {
                    const size_t l = (shift + (mirror * (swapped ? -1 : 1) > 0 ? i : n - i)) % n;
                    const double place = mirror * (swapped ? -1 : 1) * (here.places[l] - sides[swapped].places[base]);
                    const bool same = here.vertices[l] == there[k].vertices[i];
                    worst =
                        std::max(worst, same ? std::fabs(std::remainder(place - there[k].places[i], whole)) : whole);
                }
            }
            best = std::min(best, worst);
        }
    EXPECT_LT(best, 1e-6 * whole) << c;
}

} // namespace

// Other levels, other numbers of vertices, the mirror image.
TEST(Twists, OfEveryHierarchy) {
    size_t odd_cases = 0, in_triangles = 0, most_corners = 0;
    for (const size_t genus : {2, 3})
        for (const int32_t kind : {HMF_LOOPS_PANTS, HMF_LOOPS_CUT})
            for (const bool all : {true, false}) {
                SCOPED_TRACE(testing::Message() << genus << " " << kind << " " << all);
                const TriMesh mesh = uneven(pretzel(genus, 2));
                std::vector<uint32_t> same(mesh.vertex_count()), to;
                for (uint32_t v = 0; v < same.size(); ++v) same[v] = v;
                const TriMesh other_mesh = renumbered(mesh, to);
                const Hierarchy hierarchy(mesh), coarse(mesh, 0.3, 130, HMF_COLLAPSE_QSLIM), other(other_mesh),
                    mirror(mirrored(mesh));
                ASSERT_TRUE(hierarchy && coarse && other && mirror);
                Loops loops = library_loops(hierarchy, 0, kind);
                if (!all) {
                    loops.offsets.resize(2);
                    loops.elements.resize(static_cast<size_t>(loops.offsets[1]));
                }
                for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.75 * static_cast<double>(c));
                const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-10));
                const auto zeros = singularities(solution.foliation);
                bool even = false;
                for (size_t z = 0; z < zeros->count; ++z) even = even || zeros->list[z].index % 2 == 0;
                for (size_t t = 0; t < zeros->triangle_count; ++t) in_triangles += zeros->triangle_index[t] != 0;
                odd_cases += !even;
                const auto set = cylinders_of(solution.foliation, loops);
                expect_twists(set, even);
                for (size_t k = 0; k < 2 * set->count; ++k)
                    most_corners = std::max(most_corners,
                                            static_cast<size_t>(set->corner_offsets[k + 1] - set->corner_offsets[k]));
                for (const Hierarchy* again : {&coarse, &other, &mirror}) {
                    SCOPED_TRACE(again == &coarse ? "coarse" : again == &other ? "renumbered" : "mirrored");
                    const auto found = cylinders_of(*again, loops);
                    expect_twists(found, even);
                    ASSERT_EQ(found->count, set->count);
                    for (size_t c = 0; c < set->count; ++c) {
                        size_t d = 0;
                        while (d < set->count && found->list[d].loop != set->list[c].loop) ++d;
                        ASSERT_LT(d, set->count);
                        expect_same_corners(set, c, found, d, again == &other ? to : same, again == &mirror ? -1 : 1);
                    }
                }
            }
    EXPECT_GE(in_triangles, 1u);
    EXPECT_GE(most_corners, 3u);
    EXPECT_GE(odd_cases, 2u);
}

namespace {

// The same loops after subdivide: along the vertex with the lowest number of each edge that they cross.
Loops refined(const Loops& loops, const TriMesh& mesh) {
    Loops fine;
    for (size_t c = 0; c < loops.count(); ++c) {
        const std::vector<uint32_t> loop(&loops.elements[loops.offsets[c]], &loops.elements[loops.offsets[c + 1]]);
        std::vector<uint32_t> shared, made; // with the next triangle
        for (size_t i = 0; i < loop.size(); ++i) {
            const uint32_t *t = &mesh.triangles[size_t{3} * loop[i]],
                           *next = &mesh.triangles[size_t{3} * loop[(i + 1) % loop.size()]];
            uint32_t lowest = UINT32_MAX, common = 0;
            for (size_t k = 0; k < 3; ++k)
                if (std::count(next, next + 3, t[k])) {
                    ++common;
                    lowest = std::min(lowest, t[k]);
                }
            EXPECT_EQ(common, 2u);
            shared.push_back(lowest);
        }
        for (size_t i = 0; i < loop.size(); ++i) {
            const uint32_t* const t = &mesh.triangles[size_t{3} * loop[i]];
            const auto child = [&](uint32_t v) {
                return static_cast<uint32_t>(4 * loop[i] + (std::find(t, t + 3, v) - t));
            };
            const uint32_t from = shared[(i + loop.size() - 1) % loop.size()], to = shared[i];
            made.push_back(child(from));
            if (from != to) made.insert(made.end(), {4 * loop[i] + 3, child(to)});
        }
        fine.add(made);
    }
    fine.weights = loops.weights;
    return fine;
}

// How far corners of cylinder c of `set` and d of `found` lie apart, as a part of the circumference: from each the
// nearest one on the same side there, with the best choice of the base and of the first side.
double corner_distance(const Cylinders& set, size_t c, const Cylinders& found, size_t d) {
    const Side here[2] = {side_of(set, c, 0), side_of(set, c, 1)},
               there[2] = {side_of(found, d, 0), side_of(found, d, 1)};
    const double whole = set->list[c].circumference, whole_there = found->list[d].circumference;
    double best = 1;
    for (const size_t swapped : {0, 1})
        for (const double base : here[swapped].places) {
            double worst = 0;
            for (size_t k = 0; k < 2; ++k) {
                std::vector<double> moved, fixed;
                for (const double place : here[k ^ swapped].places)
                    moved.push_back((swapped ? base - place : place - base) / whole);
                for (const double place : there[k].places) fixed.push_back(place / whole_there);
                for (const auto& [from, to] : {std::pair(moved, fixed), std::pair(fixed, moved)})
                    for (const double place : from) {
                        double nearest = 1;
                        for (const double other : to)
                            nearest = std::min(nearest, std::fabs(std::remainder(place - other, 1)));
                        worst = std::max(worst, nearest);
                    }
            }
            best = std::min(best, worst);
        }
    return best;
}

} // namespace

// Each triangle in four: the same surface, whose corners all come closer to where they are in the limit, of first order
// or higher.
TEST(Twists, OfRefinedMeshes) {
    for (const size_t genus : {2, 3})
        for (const int32_t kind : {HMF_LOOPS_PANTS, HMF_LOOPS_CUT}) {
            SCOPED_TRACE(testing::Message() << genus << " " << kind);
            TriMesh mesh = uneven(pretzel(genus, 2));
            Loops loops = library_loops(Hierarchy(mesh), 0, kind);
            for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.75 * static_cast<double>(c));
            std::vector<Cylinders> sets;
            for (int k = 0; k < 3; ++k) {
                if (k > 0) {
                    loops = refined(loops, mesh);
                    mesh = subdivide(mesh);
                }
                sets.push_back(cylinders_of(Hierarchy(mesh), loops));
                ASSERT_TRUE(sets.back());
                ASSERT_EQ(sets.back()->count, sets.front()->count);
            }
            double worst[2] = {0, 0};
            for (size_t k = 0; k < 2; ++k)
                for (size_t c = 0; c < sets[k]->count; ++c) {
                    size_t d = 0;
                    while (sets[k + 1]->list[d].loop != sets[k]->list[c].loop) ++d;
                    worst[k] = std::max(worst[k], corner_distance(sets[k], c, sets[k + 1], d));
                }
            EXPECT_LT(2 * worst[1], worst[0]);
            EXPECT_LT(worst[0], 0.005);
        }
}

namespace {

// plate(2) with the center of each square, refined and rounded: as symmetric as the plate.
TriMesh symmetric_surface() {
    const TriMesh plate = test::plate(2);
    TriMesh mesh;
    mesh.genus = 2;
    mesh.positions = plate.positions;
    for (size_t t = 0; t < plate.triangle_count(); t += 2) { // two for each square: a, b, c and a, c, d
        const uint32_t* a = &plate.triangles[3 * t];
        const uint32_t at[4] = {a[0], a[1], a[2], a[5]}, center = static_cast<uint32_t>(mesh.vertex_count());
        for (size_t k = 0; k < 3; ++k)
            mesh.positions.push_back((plate.positions[3 * a[0] + k] + plate.positions[3 * a[2] + k]) / 2);
        for (size_t k = 0; k < 4; ++k) add_triangle(mesh, at[k], at[(k + 1) % 4], center);
    }
    EXPECT_EQ(mesh_defect(mesh), "");
    return smooth(subdivide(subdivide(mesh)), 4);
}

} // namespace

// A surface that is its own mirror image, with loops that are mapped to themselves, has corners at mirrored places; if
// each side had one, the twist would be 0 or half of the circumference.
TEST(Twists, OfASymmetricSurface) {
    const Hierarchy hierarchy(symmetric_surface());
    ASSERT_TRUE(hierarchy);
    Loops loops = plate_loops(hierarchy, 0, 2);
    loops.weights = {1, 1};
    const auto set = cylinders_of(hierarchy, loops);
    expect_twists(set);
    for (size_t c = 0; c < set->count; ++c) {
        const double whole = set->list[c].circumference;
        const Side first = side_of(set, c, 0), second = side_of(set, c, 1);
        double best = whole;
        for (const double from : first.places) { // of the base under the mirror
            double worst = 0;
            for (const Side* side : {&first, &second})
                for (const double place : side->places) {
                    double nearest = whole;
                    for (const double other : side->places)
                        nearest = std::min(nearest, std::fabs(std::remainder(from - place - other, whole)));
                    worst = std::max(worst, nearest);
                }
            best = std::min(best, worst);
        }
        EXPECT_LT(best, 1e-6 * whole);
    }
}

// On a surface with boundary there is none.
TEST(Twists, AreNotThereWithBoundary) {
    TriMesh mesh = torus(12, 8, 3, 1);
    mesh.triangles.resize(mesh.triangles.size() - 3);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const auto set = cylinders_of(hierarchy, library_loops(hierarchy, 0));
    ASSERT_TRUE(set);
    for (size_t c = 0; c < set->count; ++c) EXPECT_TRUE(std::isnan(set->twists[c]));
    EXPECT_EQ(set->corner_offsets[2 * set->count], 0u);
}

} // namespace test_twists
