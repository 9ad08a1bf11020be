// Zeros dragged to vertices further away: du is closed, the turns are odd where the zeros are, and the class is that of
// the foliation, so on a fine mesh the energy is nearly that of the foliation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "src/applications/api/shared_flat.hpp"
#include "src/applications/parameterize/harmonic_form.hpp"
#include "src/applications/parameterize/move_zero_to_vertex.hpp"
#include "support/check_mesh.hpp"
#include "support/meshes.hpp"
#include "support/surface.hpp"

namespace test_move_zero_to_vertex {

using namespace test;

namespace {

// Triangles by the half-edges around them, and a value per edge.
struct Glued {
    std::vector<std::array<uint32_t, 3>> faces;
    std::vector<int64_t> value;

    // A vertex inside a face, so far from its corners; the first of the three faces has the first side.
    void insert(size_t face, const std::array<int64_t, 3>& distance) {
        const auto e = static_cast<uint32_t>(value.size());
        const auto [a, b, c] = faces[face];
        faces[face] = {a, 2 * e + 2, 2 * e + 1};
        faces.push_back({b, 2 * e + 4, 2 * e + 3});
        faces.push_back({c, 2 * e, 2 * e + 5});
        value.insert(value.end(), distance.begin(), distance.end());
    }
};

// Genus 2 with one vertex, which is regular: each edge leads from it to itself.  Faces 0 and 1, on both sides of the
// longest edge, have one closed corner each, the others none.  Round face 5 lie the other three of these, of which
// each has another neighbor.
Glued one_vertex() {
    Glued g{{{7, 11, 16}, {9, 15, 17}, {1, 6, 8}, {3, 10, 12}, {5, 13, 14}, {0, 4, 2}}, std::vector<int64_t>(9, 32)};
    g.value[8] = 64;
    return g;
}

// A foliation on the finest level, or on what is glued, and du with tripods as ZeroMoves wants them.
struct Tripods {
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Call call{memory, nullptr, nullptr, nullptr};
    hmf::State state;
    const hmf::Mesh& mesh = state.foliation.mesh;
    hmf::SignBundle bundle;
    hmf::TwistedForm du;
    hmf::Array<uint32_t> tripod;
    hmf::Array<uint8_t> taken;
    Glued glued;
    std::vector<uint32_t> origin, next, face, out;
    std::vector<double> ones; // weights of what is glued

    explicit Tripods(const Solution& s) {
        EXPECT_EQ(hmf::load_solved_in_unit_of_values(*s.foliation, state, call), HMF_OK);
        look();
    }
    explicit Tripods(const Glued& g) : glued(g) {
        const size_t sides = 2 * g.value.size();
        ones.assign(g.value.size(), 1);
        origin.assign(sides, hmf::NONE);
        next.resize(sides);
        face.resize(sides);
        for (uint32_t t = 0; t < g.faces.size(); ++t)
            for (size_t i = 0; i < 3; ++i) {
                next[g.faces[t][i]] = g.faces[t][(i + 1) % 3];
                face[g.faces[t][i]] = t;
            }
        for (uint32_t h = 0; h < sides; ++h) {
            if (origin[h] != hmf::NONE) continue;
            for (uint32_t x = h; origin[x] == hmf::NONE; x = next[hmf::twin(x)])
                origin[x] = static_cast<uint32_t>(out.size());
            out.push_back(h);
        }
        hmf::Mesh& m = state.foliation.mesh;
        m.vertex_count = static_cast<uint32_t>(out.size());
        m.edge_count = static_cast<uint32_t>(g.value.size());
        m.face_count = static_cast<uint32_t>(g.faces.size());
        m.origin = origin.data();
        m.next = next.data();
        m.face = face.data();
        m.out = out.data();
        state.foliation.value = glued.value.data();
        EXPECT_EQ(hmf::check(m), nullptr);
        EXPECT_EQ(m.euler(), -2);
        look();
    }
    void look() {
        const hmf::Foliation& f = state.foliation;
        std::vector<int> sign(2 * mesh.edge_count, 0);
        tripod.start(memory);
        EXPECT_TRUE(taken.allocate_filled(memory, mesh.vertex_count, uint8_t{0}));
        EXPECT_TRUE(bundle.turn.allocate(memory, mesh.edge_count) && du.value.allocate(memory, mesh.edge_count));
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
            EXPECT_GT(f.at(h), 0);
            const uint32_t n = mesh.next[h], p = mesh.prev(h);
            if (n < h || p < h) continue;
            uint32_t longest = hmf::NONE;
            for (const uint32_t x : {h, n, p})
                if (f.at(x) == f.at(mesh.next[x]) + f.at(mesh.prev(x))) longest = x;
            if (longest == hmf::NONE) EXPECT_TRUE(tripod.push(h));
            for (const uint32_t x : {h, n, p})
                sign[x] = longest == hmf::NONE ? (x == p ? -1 : 1) : (x == longest ? 1 : -1);
        }
        for (uint32_t e = 0; e < mesh.edge_count; ++e) {
            bundle.turn[e] = static_cast<int8_t>(-sign[2 * e] * sign[2 * e + 1]);
            du.value[e] = sign[2 * e] * f.value[e];
        }
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            uint32_t closed = 0;
            for (const uint32_t h : mesh.around(v)) closed += f.corner2(h) == 0;
            taken[v] = closed != 2;
        }
    }

    size_t open_faces() const {
        size_t sides = 0;
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
            sides += du.at(bundle, h) + du.at(bundle, mesh.next[h]) + du.at(bundle, mesh.prev(h)) != 0;
        return sides / 3;
    }
    bool is_odd(uint32_t v) const {
        int turn = 1;
        for (const uint32_t h : mesh.around(v)) turn *= bundle.turn[hmf::edge_of(h)];
        return turn < 0;
    }
    // The corners of the tripods, and what is up to so many edges away.
    void take_corners(int rings) {
        std::vector<uint32_t> near;
        for (const uint32_t h : tripod)
            for (const uint32_t x : {h, mesh.next[h], mesh.prev(h)}) near.push_back(mesh.origin[x]);
        for (; rings > 0; --rings)
            for (size_t i = 0, n = near.size(); i < n; ++i)
                for (const uint32_t h : mesh.around(near[i])) near.push_back(mesh.target(h));
        for (const uint32_t v : near) taken[v] = 1;
    }
    // How many are left.
    size_t move(size_t genus) {
        const std::vector<uint8_t> before(taken.begin(), taken.end());
        size_t left = tripod.size();
        EXPECT_TRUE(hmf::ZeroMoves(mesh, weight(), bundle, du, taken).move(tripod, {}, call, left));
        size_t odd = 0, came = 0;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            odd += is_odd(v);
            if (!taken[v] || before[v]) continue;
            ++came;
            EXPECT_TRUE(left > 0 || is_odd(v)) << v;
        }
        EXPECT_EQ(open_faces(), left);
        EXPECT_EQ(came + left, tripod.size());
        if (left == 0) { EXPECT_EQ(odd, 4 * genus - 4); }
        return left;
    }
    void make_harmonic() {
        hmf::VertexCharts charts;
        hmf::TwistedLaplacian laplacian;
        ASSERT_TRUE(charts.build(mesh, bundle, call));
        ASSERT_EQ(laplacian.build(mesh, bundle, charts, weight(), call), HMF_OK);
        ASSERT_EQ(laplacian.make_harmonic(du, 1e-9, call, {}), HMF_OK);
        EXPECT_LT(divergence(), 1e-8);
    }
    // Of du at the vertices where it need not be 0, by what there would be if no two fluxes cancelled.
    double divergence() const {
        double left = 0, all = 0;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            if (is_odd(v)) continue;
            double sum = 0, pull = 0, weights = 0;
            int chart = 1;
            for (const uint32_t h : mesh.around(v)) {
                const double w = weight()[hmf::edge_of(h)], flux = w * chart * static_cast<double>(du.at(bundle, h));
                sum += flux;
                pull += std::fabs(flux);
                weights += w;
                chart *= bundle.turn[hmf::edge_of(mesh.prev(h))];
            }
            left += sum * sum / weights;
            all += pull * pull / weights;
        }
        return std::sqrt(left / all);
    }
    double energy() const { // in units
        double sum = 0;
        for (uint32_t e = 0; e < mesh.edge_count; ++e)
            sum += weight()[e] * static_cast<double>(du.value[e]) * static_cast<double>(du.value[e]);
        return sum;
    }
    const double* weight() const { return glued.value.empty() ? state.hierarchy->levels[0].weight : ones.data(); }
};

} // namespace

// Also where the vertices near the zeros are taken.
TEST(ZeroMoves, EnergyOfTheClass) {
    for (const size_t genus : {2, 3}) {
        const SolvedSurface surface(pretzel(genus, 4));
        for (const int rings : {-1, 0, 1, 3}) {
            SCOPED_TRACE("genus " + std::to_string(genus) + ", rings " + std::to_string(rings));
            Tripods t(surface.solution);
            ASSERT_GT(t.tripod.size(), 0u);
            const double energy = t.energy();
            if (rings >= 0) t.take_corners(rings);
            EXPECT_EQ(t.move(genus), 0u);
            t.make_harmonic();
            EXPECT_NEAR(t.energy(), energy, 1e-3 * energy);
        }
    }
}

// Long ways, across each other.
TEST(ZeroMoves, ToAFewVerticesAnywhere) {
    const size_t genus = 4;
    const SolvedSurface surface(pretzel(genus, 2));
    for (size_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        Tripods t(surface.solution);
        ASSERT_GT(t.tripod.size(), 2u);
        Random random(seed);
        std::vector<uint32_t> free;
        for (uint32_t v = 0; v < t.mesh.vertex_count; ++v)
            if (!t.taken[v]) free.push_back(v);
        const size_t kept = t.tripod.size() - seed % 3; // one or two too few, or enough
        while (free.size() > kept) {
            const size_t i = random.below(free.size());
            t.taken[free[i]] = 1;
            free[i] = free.back();
            free.pop_back();
        }
        EXPECT_EQ(t.move(genus), seed % 3);
    }
}

// Face 5 is shut in by triangles whose zeros find their ways: it waits for them, and its way leads through one of them.
TEST(ZeroMoves, ThroughTrianglesWhoseZerosHaveLeft) {
    Glued g = one_vertex();
    // Four vertices in face 0, whose corners lie at -32, 0 and 32: at 5, -3, -7 and -9.
    g.insert(0, {37, 5, 27});
    g.insert(0, {29, 3, 8});
    g.insert(0, {25, 7, 4});
    g.insert(0, {23, 9, 2});
    Tripods t(g);
    ASSERT_EQ(t.tripod.size(), 4u);
    EXPECT_EQ(t.mesh.face[t.tripod[0]], 5u);
    for (const uint32_t h : g.faces[5]) t.taken[t.mesh.origin[h]] = 1;
    EXPECT_EQ(t.move(2), 0u);
}

// Where all corners of four tripods lie at one vertex, the turn around it is even with a zero and odd without: no zero
// may come.
TEST(ZeroMoves, NotWhereTheTurnIsNotEven) {
    Tripods t(one_vertex());
    ASSERT_EQ(t.tripod.size(), 4u);
    ASSERT_FALSE(t.taken[0]);
    size_t left = 0;
    EXPECT_TRUE(hmf::ZeroMoves(t.mesh, t.weight(), t.bundle, t.du, t.taken).move(t.tripod, {}, t.call, left));
    EXPECT_EQ(left, 4u);
    EXPECT_EQ(t.open_faces(), 4u);
}

// Of three such tripods one may stay there; a fourth has a vertex of its own.
TEST(ZeroMoves, ToAVertexWithAllCorners) {
    Glued g = one_vertex();
    g.insert(2, {12, 20, 20});
    Tripods t(g);
    ASSERT_EQ(t.tripod.size(), 4u);
    EXPECT_EQ(t.move(2), 2u);
}

// In a finer unit the same ways and heights, until the sides need more bits than there are: then all zeros are left.
TEST(ZeroMoves, HeightsHaveRoom) {
    Glued g = one_vertex();
    g.insert(2, {12, 20, 20});
    Tripods t(g);
    EXPECT_EQ(t.move(2), 2u);
    for (const int bits : {1, 40, 55}) {
        SCOPED_TRACE(bits);
        Glued finer = g;
        for (int64_t& x : finer.value) x <<= bits;
        Tripods f(finer);
        size_t left = 0;
        EXPECT_TRUE(hmf::ZeroMoves(f.mesh, f.weight(), f.bundle, f.du, f.taken).move(f.tripod, {}, f.call, left));
        EXPECT_EQ(left, bits < 55 ? 2u : 4u);
        if (bits == 55) continue; // sides of 2^61
        for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
            EXPECT_EQ(f.du.value[e], t.du.value[e] * (int64_t{1} << bits));
            EXPECT_EQ(f.bundle.turn[e], t.bundle.turn[e]);
        }
    }
}

} // namespace test_move_zero_to_vertex
