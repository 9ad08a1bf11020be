// Atlases: each triangle once in the unit square, none over another one, charts
// apart from each other, conformal as (u, v) is.
#include "src/applications/atlas/pack.hpp"
#include "support/boundary.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>

namespace test_atlas {

using namespace test;

namespace {

using Made = Owned<hmf_chart_set>;

Made atlas_of(const Foliation& foliation, double margin = 0) {
    hmf_atlas_options options{};
    options.struct_size = sizeof options;
    options.margin = margin;
    return make<hmf_chart_set>([&](hmf_chart_set** out, hmf_error* error) {
        return hmf_atlas(foliation.get(), &options, nullptr, out, error);
    });
}

double area_in_square(const double* uv) {
    return ((uv[2] - uv[0]) * (uv[5] - uv[1]) - (uv[4] - uv[0]) * (uv[3] - uv[1])) / 2;
}

// Lengths of the sides, then the area, in space.
struct Shape {
    double side[3], area;
};
Shape shape_of(const TriMesh& mesh, size_t t) {
    Shape s{};
    double e[3][3], square = 0;
    for (size_t i = 0; i < 3; ++i)
        for (size_t a = 0; a < 3; ++a) {
            e[i][a] = mesh.positions[3 * size_t{mesh.triangles[3 * t + (i + 1) % 3]} + a]
                    - mesh.positions[3 * size_t{mesh.triangles[3 * t + i]} + a];
            s.side[i] += e[i][a] * e[i][a];
        }
    for (double& x : s.side) x = std::sqrt(x);
    for (size_t a = 0; a < 3; ++a) {
        const size_t b = (a + 1) % 3, c = (a + 2) % 3;
        square += std::pow(e[0][b] * e[1][c] - e[0][c] * e[1][b], 2);
    }
    s.area = std::sqrt(square) / 2;
    return s;
}

// The ratio of the singular values of the map to the square, from the sides alone: with the cotangents of the
// triangle in space, sum cot * side^2 / (2 area) = (s1 / s2 + s2 / s1) for the image.
double dilatation_in_square(const TriMesh& mesh, size_t t, const double* uv) {
    const Shape s = shape_of(mesh, t);
    double energy = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double a = s.side[i], b = s.side[(i + 1) % 3], c = s.side[(i + 2) % 3];
        const double cot = (b * b + c * c - a * a) / (4 * s.area);
        const size_t j = (i + 1) % 3;
        energy += cot * (std::pow(uv[2 * j] - uv[2 * i], 2) + std::pow(uv[2 * j + 1] - uv[2 * i + 1], 2)) / 2;
    }
    const double sum = energy / area_in_square(uv); // s1 / s2 + s2 / s1
    return sum > 2 ? (sum + std::sqrt(sum * sum - 4)) / 2 : 1;
}

constexpr int R = 1024; // pixels along the square

// Who covers the middle of each pixel; a middle within two triangles counts in `twice`.
std::vector<uint32_t> pixels_of(const hmf_chart_set& atlas, size_t& twice) {
    std::vector<uint32_t> owner(size_t{R} * R, HMF_NONE);
    twice = 0;
    for (size_t t = 0; t < atlas.triangle_count; ++t) {
        const double* uv = atlas.corner_uv + 6 * t;
        if (!(area_in_square(uv) > 0)) continue;
        const auto [x0, x1] = std::minmax({uv[0], uv[2], uv[4]});
        const auto [y0, y1] = std::minmax({uv[1], uv[3], uv[5]});
        for (int y = static_cast<int>(y0 * R); y <= std::min(R - 1, static_cast<int>(y1 * R)); ++y)
            for (int x = static_cast<int>(x0 * R); x <= std::min(R - 1, static_cast<int>(x1 * R)); ++x) {
                const double px = (x + 0.5) / R, py = (y + 0.5) / R;
                bool inside = true;
                for (size_t i = 0; i < 3 && inside; ++i) {
                    const size_t j = (i + 1) % 3;
                    inside = (uv[2 * j] - uv[2 * i]) * (py - uv[2 * i + 1])
                               - (uv[2 * j + 1] - uv[2 * i + 1]) * (px - uv[2 * i])
                           > 1e-12;
                }
                if (!inside) continue;
                uint32_t& here = owner[size_t(y) * R + size_t(x)];
                twice += here != HMF_NONE;
                here = static_cast<uint32_t>(t);
            }
    }
    return owner;
}

// Least distance, in pixels and along one direction, of pixels of different charts, up to `most`.
int least_gap(const hmf_chart_set& atlas, const std::vector<uint32_t>& owner, int most) {
    int least = most;
    const auto chart = [&](int x, int y) {
        const uint32_t t = owner[size_t(y) * R + size_t(x)];
        return t == HMF_NONE ? HMF_NONE : atlas.triangle_chart[t];
    };
    for (int y = 0; y < R; ++y)
        for (int x = 0; x < R; ++x) {
            const uint32_t c = chart(x, y);
            if (c == HMF_NONE || (x + 1 < R && chart(x + 1, y) == c && y + 1 < R && chart(x, y + 1) == c)) continue;
            for (int dy = 0; dy < least; ++dy)
                for (int dx = -least + 1; dx < least; ++dx) {
                    if (x + dx < 0 || x + dx >= R || y + dy >= R) continue;
                    const uint32_t d = chart(x + dx, y + dy);
                    if (d != HMF_NONE && d != c) least = std::max(std::abs(dx), dy);
                }
        }
    return least;
}

constexpr size_t NO_SIDE = ~size_t{0};

// The two sides (3 * triangle + side) that each edge has, one of them none on a boundary.
std::map<std::pair<uint32_t, uint32_t>, std::array<size_t, 2>> sides_of_edges(const TriMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, std::array<size_t, 2>> sides;
    for (size_t k = 0; k < mesh.triangles.size(); ++k) {
        const uint32_t a = mesh.triangles[k], b = mesh.triangles[k / 3 * 3 + (k + 1) % 3];
        auto& both = sides.try_emplace(std::minmax(a, b), std::array<size_t, 2>{NO_SIDE, NO_SIDE}).first->second;
        both[a > b] = k;
    }
    return sides;
}

size_t root_of(std::vector<size_t>& parent, size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

void expect_atlas(const TriMesh& mesh, const Foliation& foliation, const hmf_chart_set& atlas, double margin) {
    ASSERT_EQ(atlas.triangle_count, mesh.triangle_count());
    // In the square, oriented, of the area that is told.
    double used = 0, area = 0;
    uint64_t collapsed = 0;
    for (size_t i = 0; i < 6 * atlas.triangle_count; ++i)
        ASSERT_TRUE(atlas.corner_uv[i] >= 0 && atlas.corner_uv[i] <= 1) << i;
    for (size_t t = 0; t < atlas.triangle_count; ++t) {
        const double here = area_in_square(atlas.corner_uv + 6 * t);
        used += here;
        area += shape_of(mesh, t).area;
        collapsed += !(here > 0);
        ASSERT_LT(atlas.triangle_chart[t], atlas.chart_count);
    }
    EXPECT_EQ(collapsed, atlas.collapsed_count);
    EXPECT_NEAR(used, atlas.used_area, 1e-9);
    double mean = 0, sum = 0, weight = 0;
    for (int pass = 0; pass < 2; ++pass, mean = pass == 1 ? sum / weight : mean, sum = pass == 1 ? 0 : sum)
        for (size_t t = 0; t < atlas.triangle_count; ++t) {
            const double here = area_in_square(atlas.corner_uv + 6 * t), there = shape_of(mesh, t).area;
            if (!(here > 0) || !(there > 0)) continue;
            const double log_scale = std::log(here / there) / 2;
            weight += pass == 0 ? there : 0;
            sum += there * (pass == 0 ? log_scale : (log_scale - mean) * (log_scale - mean));
        }
    EXPECT_NEAR(std::sqrt(sum / weight), atlas.unevenness, 1e-6);
    // Nothing lies over anything else: by pixels, where the library compares sides.
    size_t twice = 0;
    const std::vector<uint32_t> owner = pixels_of(atlas, twice);
    EXPECT_EQ(twice, 0u);
    const double covered =
        static_cast<double>(std::count_if(owner.begin(), owner.end(), [](uint32_t t) { return t != HMF_NONE; }));
    EXPECT_NEAR(covered / (double(R) * R), used, 2e-3);
    EXPECT_GE(least_gap(atlas, owner, static_cast<int>(margin * R) + 1), static_cast<int>(margin * R) - 1);
    // Seams are where corners differ; without them each chart is in one piece.
    std::vector<size_t> parent(mesh.triangle_count());
    std::iota(parent.begin(), parent.end(), size_t{0});
    std::vector<double> chart_area(atlas.chart_count, 0), chart_image(atlas.chart_count, 0);
    double seams = 0;
    uint64_t seam_count = 0;
    for (const auto& [e, sides] : sides_of_edges(mesh)) {
        if (sides[0] == NO_SIDE || sides[1] == NO_SIDE) continue;
        bool joined = atlas.triangle_chart[sides[0] / 3] == atlas.triangle_chart[sides[1] / 3];
        for (size_t end = 0; end < 2; ++end)
            for (size_t k = 0; k < 2; ++k) {
                const size_t a = sides[0] / 3 * 3 + (sides[0] + end) % 3,
                             b = sides[1] / 3 * 3 + (sides[1] + 1 - end) % 3;
                joined = joined && atlas.corner_uv[2 * a + k] == atlas.corner_uv[2 * b + k];
            }
        if (joined) parent[root_of(parent, sides[0] / 3)] = root_of(parent, sides[1] / 3);
        else ++seam_count, seams += shape_of(mesh, sides[0] / 3).side[sides[0] % 3];
    }
    EXPECT_EQ(seam_count, atlas.seam_edge_count);
    EXPECT_NEAR(seams, atlas.seam_length, 1e-9 * seams);
    uint64_t pieces = 0;
    for (size_t t = 0; t < parent.size(); ++t) {
        pieces += parent[t] == t;
        EXPECT_EQ(atlas.triangle_chart[t], atlas.triangle_chart[root_of(parent, t)]);
        chart_area[atlas.triangle_chart[t]] += shape_of(mesh, t).area;
        chart_image[atlas.triangle_chart[t]] += area_in_square(atlas.corner_uv + 6 * t);
    }
    EXPECT_EQ(pieces, atlas.chart_count);
    // Areas are in proportion, but for the few triangles that went over to another chart.
    for (size_t c = 0; c < atlas.chart_count; ++c)
        EXPECT_NEAR(chart_image[c] / used, chart_area[c] / area, 0.01) << "chart " << c;
    // Angles are those of (u, v), but around triangles that it turns over.
    const auto flat = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(foliation.get(), nullptr, nullptr, out, error);
    });
    size_t differ = 0, turned = 0;
    for (size_t t = 0; t < atlas.triangle_count; ++t) {
        turned += flat->dilatation[t] < 0;
        const double here = dilatation_in_square(mesh, t, atlas.corner_uv + 6 * t),
                     there = std::fabs(flat->dilatation[t]);
        if (area_in_square(atlas.corner_uv + 6 * t) > 1e-7 && there < 100) differ += std::fabs(here / there - 1) > 0.01;
    }
    EXPECT_LE(differ, 12 * turned + atlas.triangle_count / 100);
}

} // namespace

TEST(Atlas, NothingOverlapsOnRandomSurfaces) {
    for (size_t genus = 0; genus < 4; genus += sample(1, 2)) {
        const TriMesh mesh = genus == 1 ? torus(36, 18, 2, 0.8) : pretzel(genus, 2);
        for (size_t n = genus == 0 ? 4 : 0; n <= 8; n += sample<size_t>(4, 8)) {
            SCOPED_TRACE("genus " + std::to_string(genus) + ", marks " + std::to_string(n));
            Random random(31 * genus + n);
            std::vector<uint32_t> marks;
            while (marks.size() < n) {
                const uint32_t v = static_cast<uint32_t>(random.below(mesh.vertex_count()));
                if (std::find(marks.begin(), marks.end(), v) == marks.end()) marks.push_back(v);
            }
            const SolvedSurface surface(mesh, marks);
            ASSERT_TRUE(surface.solution.foliation);
            const double margin = n == 4 ? 1.0 / 64 : 1.0 / 512;
            const Made atlas = atlas_of(surface.solution.foliation, margin);
            ASSERT_TRUE(atlas);
            expect_atlas(mesh, surface.solution.foliation, *atlas, margin);
        }
    }
}

// Strips from boundary to boundary, rings round boundaries, both and neither.
TEST(Atlas, NothingOverlapsOnSurfacesWithHoles) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const size_t m = 48;
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 3) : torus(2 * m, m, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 2 + seed % 3, seed);
        if (!is_sound(mesh)) continue; // bad luck
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            const auto set = loops_of(hierarchy, kind);
            ASSERT_TRUE(set);
            const Solution s = solve(hierarchy, *set);
            ASSERT_TRUE(s.foliation) << s.error.message;
            const Made atlas = atlas_of(s.foliation);
            ASSERT_TRUE(atlas);
            expect_atlas(mesh, s.foliation, *atlas, 1.0 / 512);
        }
    }
}

// A rectangle with marked corners is one chart, and stays one; its sides are straight.
TEST(Atlas, ARectangleIsARectangle) {
    const size_t n = 24, m = 24;
    const TriMesh mesh = rectangle(n, m, 1.5, 1.5, 0.5, 7);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    Curves curves;
    Path along;
    for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
    curves.add(along, true);
    const Solution s = solve_curves(hierarchy, curves);
    const Made atlas = atlas_of(s.foliation);
    ASSERT_TRUE(atlas);
    expect_atlas(mesh, s.foliation, *atlas, 1.0 / 512);
    EXPECT_EQ(atlas->chart_count, 1u);
    EXPECT_EQ(atlas->seam_edge_count, 0u);
    EXPECT_GT(atlas->used_area, 0.97);
    EXPECT_LT(atlas->unevenness, 1e-3);
}

// An annulus whose leaves go around, and one whose leaves go across: cut open once.
TEST(Atlas, AnAnnulusIsCutOpen) {
    const size_t n = 96, m = 12;
    const TriMesh mesh = annulus(n, m, 2, 0.3, 3);
    const Hierarchy hierarchy(mesh);
    for (const bool arc : {false, true}) {
        Curves curves;
        Path path;
        for (size_t i = 0; i < (arc ? m + 1 : n); ++i) path.push_back(uint32_t(arc ? i : i * (m + 1) + m / 2));
        curves.add(path, arc);
        const Solution s = solve_curves(hierarchy, curves);
        const Made atlas = atlas_of(s.foliation);
        ASSERT_TRUE(atlas) << arc;
        expect_atlas(mesh, s.foliation, *atlas, 1.0 / 512);
        EXPECT_LE(atlas->chart_count, 5u);
        EXPECT_GT(atlas->used_area, 0.7);
    }
}

TEST(AtlasContract, LevelsOfADoubleAreRefused) {
    const Hierarchy hierarchy(annulus(60, 12, 2, 0.3, 3));
    ASSERT_GT(hierarchy.levels(), 1u);
    const auto set = loops_of(hierarchy, HMF_LOOPS_CUT);
    const Solution s = solve(hierarchy, *set);
    hmf_foliation* coarse = nullptr;
    ASSERT_EQ(hmf_interpolate(s.foliation.get(), 1, nullptr, &coarse, nullptr), HMF_OK);
    const Foliation owned(coarse);
    hmf_chart_set* out = nullptr;
    EXPECT_EQ(hmf_atlas(coarse, nullptr, nullptr, &out, nullptr), HMF_ERROR_UNSUPPORTED);
}

// Two triangles are a square, if the second is let down onto the slope of the first, and none lies in the other.
TEST(Packer, LetsShapesDownOntoEachOther) {
    constexpr double leg = 1000, column = 40;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    hmf::Call call(memory, &error, nullptr, nullptr);
    for (const size_t pairs : {size_t{1}, size_t{4}}) {
        hmf::Packer packer;
        packer.start(memory, column, 0);
        for (size_t k = 0; k < 2 * pairs; ++k) {
            const double xy[6] = {0, 0, leg, 0, 0, leg};
            ASSERT_TRUE(packer.begin_shape(0, 0, leg, leg));
            packer.add_part(xy, 3);
        }
        ASSERT_EQ(packer.search(1000000, nullptr, call), HMF_OK);
        EXPECT_GE(packer.side(), leg * std::sqrt(static_cast<double>(pairs)));
        EXPECT_LE(packer.side(), 1.3 * leg * std::sqrt(static_cast<double>(pairs)));
    }
}

// A search that begins with an arrangement needs no larger square, and a smaller one than without it.
TEST(Packer, GoesOnWithAnArrangement) {
    constexpr double column = 20;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    hmf::Call call(memory, &error, nullptr, nullptr);
    const auto fill = [&](hmf::Packer& packer) {
        std::mt19937 random(1);
        packer.start(memory, column, 0);
        for (int k = 0; k < 16; ++k) {
            const double x = 100 + random() % 900, y = 100 + random() % 900, xy[8] = {0, 0, x, 0, x, y, 0, y};
            ASSERT_TRUE(packer.begin_shape(0, 0, x, y));
            packer.add_part(xy, 4);
        }
    };
    hmf::Packer searched, rough, further;
    fill(searched);
    fill(rough);
    fill(further);
    ASSERT_EQ(searched.search(20000000, nullptr, call), HMF_OK);
    ASSERT_EQ(rough.search(0, nullptr, call), HMF_OK);
    ASSERT_EQ(further.search(0, &searched, call), HMF_OK);
    EXPECT_EQ(further.side(), searched.side());
    EXPECT_LT(further.side(), rough.side());
}

// Squares that fill a square: the first width that is tried is that of their area, not that of one of them, so hardly
// more than one packing is needed.
TEST(Packer, BeginsWithTheWidthOfItsArea) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    hmf::Call call(memory, &error, nullptr, nullptr);
    constexpr int rows = 12;
    const auto fill = [&](hmf::Packer& packer) {
        packer.start(memory, 10, 0);
        for (int k = 0; k < rows * rows; ++k) {
            const double xy[8] = {0, 0, 95, 0, 95, 95, 0, 95};
            ASSERT_TRUE(packer.begin_shape(0, 0, 95, 95));
            packer.add_part(xy, 4);
        }
    };
    hmf::Packer first, again;
    fill(first);
    fill(again);
    ASSERT_EQ(first.search(0, nullptr, call), HMF_OK);
    EXPECT_GE(first.side(), 100 * rows - 10);
    ASSERT_EQ(again.search(0, &first, call), HMF_OK); // one packing
    EXPECT_EQ(again.side(), first.side());
    EXPECT_LT(first.steps(), 2 * again.steps());
}

// Of many shapes one packing takes long: it reports in between, and whenever the answer is to cancel, it ends.
TEST(Packer, ReportsWithinAPacking) {
    struct Reports {
        hmf::Packer packer;
        uint64_t count = 0, last = 0, most = 0, end = UINT64_MAX; // most: steps between two
    };
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    const auto search = [&](Reports& reports) {
        const auto report = [](void* user, double) -> int32_t {
            Reports& r = *static_cast<Reports*>(user);
            r.most = std::max(r.most, r.packer.steps() - r.last);
            r.last = r.packer.steps();
            return ++r.count < r.end ? HMF_PROGRESS_CONTINUE : HMF_PROGRESS_CANCEL;
        };
        hmf::Call call(memory, &error, report, &reports);
        reports.packer.start(memory, 10, 0);
        for (int k = 0; k < 1500; ++k) {
            const double side = 20 + k % 70, xy[8] = {0, 0, side, 0, side, side, 0, side};
            EXPECT_TRUE(reports.packer.begin_shape(0, 0, side, side));
            reports.packer.add_part(xy, 4);
        }
        return reports.packer.search(0, nullptr, call);
    };
    Reports all;
    ASSERT_EQ(search(all), HMF_OK);
    EXPECT_LT(all.most, 5000u);
    for (const uint64_t end : {uint64_t{1}, all.count / 3, all.count - 1, all.count}) {
        Reports some;
        some.end = end;
        EXPECT_EQ(search(some), HMF_CANCELLED) << end;
        EXPECT_EQ(some.count, end);
    }
}

// Parts of a chart that are cut off go to the charts beside them. Were it these that go to such parts, charts would
// hang together by them, and less than .42 of the square would be used.
TEST(Atlas, IslandsGoToTheirNeighbors) {
    const TriMesh mesh = torus(36, 18, 2, 0.8);
    for (const uint64_t seed : {9, 16}) {
        Random random(seed);
        std::vector<uint32_t> marks;
        while (marks.size() < 8) {
            const uint32_t v = static_cast<uint32_t>(random.below(mesh.vertex_count()));
            if (std::find(marks.begin(), marks.end(), v) == marks.end()) marks.push_back(v);
        }
        const SolvedSurface surface(mesh, marks);
        const Made atlas = atlas_of(surface.solution.foliation);
        ASSERT_TRUE(atlas);
        EXPECT_GT(atlas->used_area, 0.5) << seed;
    }
}

// Two charts leave nearly half of the square free: the margin, a part of its side, is found in rounds.
TEST(Atlas, LargeMarginsAreKept) {
    const TriMesh mesh = pretzel(2, 1);
    const SolvedSurface surface(mesh, {});
    const double margin = 1.0 / 24;
    const Made atlas = atlas_of(surface.solution.foliation, margin);
    ASSERT_TRUE(atlas);
    EXPECT_GT(atlas->chart_count, 1u);
    expect_atlas(mesh, surface.solution.foliation, *atlas, margin);
}

// A torus of revolution is one rectangle, which is cut to fit.
// Cuts around such a torus are equally good, and the last bits choose among them: two or three of 24 tori of about this
// size have five charts, others with other bits.
TEST(Atlas, ATorusNeedsFewCharts) {
    std::vector<uint64_t> charts;
    std::vector<size_t> tori = {100, 106, 112, 102, 104, 108, 110, 116, 120};
    tori.resize(sample<size_t>(9, 3));
    for (const size_t around : tori) {
        const TriMesh mesh = torus(around, 48, 2, 0.8);
        const Hierarchy hierarchy(mesh);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8));
        const Made atlas = atlas_of(solution.foliation);
        ASSERT_TRUE(atlas);
        expect_atlas(mesh, solution.foliation, *atlas, 1.0 / 512);
        EXPECT_LE(atlas->chart_count, 5u);
        EXPECT_GT(atlas->used_area, 0.8);
        charts.push_back(atlas->chart_count);
    }
    std::sort(charts.begin(), charts.end());
    EXPECT_LE(charts[charts.size() / 2], 4u);
}

TEST(Atlas, IsTheSameInAnyUnit) {
    const TriMesh mesh = torus(120, 48, 2, 0.8), larger = scaled(mesh, 4);
    const Hierarchy hierarchy(mesh), other(larger);
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8));
    const Solution again = solve(other, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8));
    const Made atlas = atlas_of(solution.foliation), same = atlas_of(again.foliation);
    ASSERT_TRUE(atlas && same);
    EXPECT_EQ(same->chart_count, atlas->chart_count);
    EXPECT_NEAR(same->used_area, atlas->used_area, 1e-6);
    EXPECT_NEAR(same->seam_length, 4 * atlas->seam_length, 1e-6 * atlas->seam_length);
}

TEST(Atlas, OfACoarseLevel) {
    const TriMesh mesh = pretzel(2, 3);
    const Hierarchy hierarchy(mesh, 0, 200);
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8));
    ASSERT_GT(hierarchy.levels(), 2u);
    hmf_foliation* coarse = nullptr;
    ASSERT_EQ(hmf_interpolate(solution.foliation.get(), 1, nullptr, &coarse, nullptr), HMF_OK);
    hmf_foliation* best = nullptr;
    ASSERT_EQ(hmf_relax(coarse, nullptr, nullptr, &best, nullptr), HMF_OK);
    const Foliation first(coarse), relaxed(best);
    const Made atlas = atlas_of(relaxed);
    ASSERT_TRUE(atlas);
    size_t twice = 0;
    pixels_of(*atlas, twice);
    EXPECT_EQ(twice, 0u);
}

TEST(AtlasContract, MarginsThatDoNotFit) {
    const TriMesh mesh = pretzel(2, 1);
    const SolvedSurface surface(mesh, {});
    for (const double bad : {-1.0, 0.07, double(NAN), double(INFINITY)}) {
        hmf_atlas_options options{};
        options.struct_size = sizeof options;
        options.margin = bad;
        hmf_chart_set* out = nullptr;
        hmf_error error{};
        EXPECT_EQ(hmf_atlas(surface.solution.foliation.get(), &options, nullptr, &out, &error), HMF_ERROR_OPTIONS);
        EXPECT_EQ(out, nullptr);
    }
}

} // namespace test_atlas
