// Loops: cut systems, reading, checking, the initial foliation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>

#include "src/core/base/cyclic.hpp"
#include "src/core/base/disjoint_sets.hpp"
#include "src/applications/loops/closed_geodesic.hpp"
#include "src/core/curves/cut_surface.hpp"
#include "src/core/curves/disjoint.hpp"
#include "src/applications/loops/dual_length.hpp"
#include "src/applications/loops/find_loops.hpp"
#include "src/applications/loops/signatures.hpp"
#include "support/make_mesh.hpp"
#include "support/sample.hpp"

namespace test_loops {

namespace {

using namespace hmf;

struct Context {
    Memory memory{nullptr, nullptr, nullptr, 0};
    hmf_error error{};
    Call call{memory, &error, nullptr, nullptr};
};

uint32_t genus_of(const Mesh& m) { return (2 + m.edge_count - m.vertex_count - m.face_count) / 2; }

struct Pieces {
    size_t count = 0;
    int64_t euler = 0; // of all together
};

Pieces pieces(const Mesh& mesh, const Loops& loops) {
    Context c;
    Multicurve curves;
    CutSurface cut;
    EXPECT_TRUE(curves.allocate(mesh, c.memory) && curves.add(loops.crossings.data(), loops.crossings.size()));
    EXPECT_TRUE(curves.is_normal(mesh));
    EXPECT_TRUE(curves.trace(mesh, c.call) && cut.build(mesh, curves, false, c.call));
    EXPECT_EQ(curves.components.count(), loops.count());
    std::vector<uint32_t> parent(cut.region_count);
    for (uint32_t r = 0; r < cut.region_count; ++r) parent[r] = r;
    for (size_t s = 0; s < cut.segment_count; ++s) unite(parent.data(), cut.region[2 * s], cut.region[2 * s + 1]);
    Pieces result;
    for (uint32_t r = 0; r < cut.region_count; ++r) result.count += parent[r] == r;
    result.euler = int64_t{cut.region_count} - cut.segment_count + mesh.vertex_count;
    return result;
}

// Consecutive crossings meet in a face.
void expect_connected(const Mesh& mesh, const Loops& loops) {
    for (size_t c = 0; c < loops.count(); ++c)
        for (uint64_t i = loops.offsets[c], n = loops.offsets[c + 1]; i < n; ++i) {
            const uint32_t h = loops.crossings[i], k = loops.crossings[i + 1 < n ? i + 1 : loops.offsets[c]];
            EXPECT_EQ(mesh.face[twin(h)], mesh.face[k]);
            EXPECT_NE(twin(h), k);
        }
}

// round_trip: faces name the edges between them.
void expect_cut_system(test::MadeMesh& made, bool round_trip = true) {
    const Mesh mesh = made.mesh();
    Context c;
    Loops loops;
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, loops), HMF_OK) << c.error.message;
    const uint32_t genus = genus_of(mesh);
    ASSERT_EQ(loops.count(), genus);
    expect_connected(mesh, loops);
    EXPECT_EQ(check_loops(mesh, loops, c.call), HMF_OK) << c.error.message;
    const Pieces p = pieces(mesh, loops);
    EXPECT_EQ(p.count, 1u);
    EXPECT_EQ(p.euler, 2 - 2 * static_cast<int64_t>(genus));

    if (round_trip) {
        std::vector<uint32_t> faces;
        for (uint32_t h : loops.crossings) faces.push_back(mesh.face[h]);
        Loops again;
        ASSERT_EQ(read_loops(mesh, HMF_PATH_TRIANGLES, genus, loops.offsets.data(), faces.data(), c.call, again),
                  HMF_OK)
            << c.error.message;
        EXPECT_EQ(check_loops(mesh, again, c.call), HMF_OK) << c.error.message;
    }

    std::vector<int64_t> weight(genus), value(mesh.edge_count);
    for (uint32_t i = 0; i < genus; ++i) weight[i] = (1 << 20) + 7 * i;
    initial_foliation(mesh, loops, weight.data(), value.data());
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const int64_t a = value[edge_of(h)], b = value[edge_of(mesh.next[h])], d = value[edge_of(mesh.prev(h))];
        ASSERT_GE(a, 0);
        ASSERT_LE(a, b + d);
        ASSERT_EQ((a + b + d) % 2, 0);
    }
}

struct Read {
    Context context;
    Loops loops;
    hmf_status read, check = HMF_OK;

    Read(const Mesh& mesh, int32_t kind, const std::vector<std::vector<uint32_t>>& given) {
        std::vector<uint64_t> offsets{0};
        std::vector<uint32_t> elements;
        for (const auto& loop : given) {
            elements.insert(elements.end(), loop.begin(), loop.end());
            offsets.push_back(elements.size());
        }
        read = read_loops(mesh, kind, given.size(), offsets.data(), elements.data(), context.call, loops);
        if (read == HMF_OK) {
            expect_connected(mesh, loops);
            check = check_loops(mesh, loops, context.call);
        }
    }
    hmf_status status() const { return read ? read : check; }
};

constexpr uint32_t N = 12, M = 9;
uint32_t at(uint32_t x, uint32_t y) { return x % N * M + y % M; }
std::vector<uint32_t> meridian(uint32_t x) {
    std::vector<uint32_t> path;
    for (uint32_t y = 0; y < M; ++y) path.push_back(at(x, y));
    return path;
}
std::vector<uint32_t> longitude(uint32_t y) {
    std::vector<uint32_t> path;
    for (uint32_t x = 0; x < N; ++x) path.push_back(at(x, y));
    return path;
}

// How often the loop crosses the edges of a closed vertex path, modulo 2.
uint32_t parity(const Mesh& mesh, const Loops& loops, size_t loop, const std::vector<uint32_t>& path) {
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (size_t i = 0; i < path.size(); ++i) edges.insert({path[i], path[(i + 1) % path.size()]});
    uint32_t n = 0;
    for (uint64_t i = loops.offsets[loop]; i < loops.offsets[loop + 1]; ++i) {
        const uint32_t a = mesh.origin[loops.crossings[i]], b = mesh.target(loops.crossings[i]);
        n += static_cast<uint32_t>(edges.count({a, b}) + edges.count({b, a}));
    }
    return n % 2;
}

TEST(CutSystem, Torus) {
    for (uint32_t n = 3; n < 12; n += 2)
        for (uint32_t m = 3; m < 12; m += 3) {
            test::MadeMesh made(test::torus_triangles(n, m));
            expect_cut_system(made);
        }
}

TEST(CutSystem, ShortOnATorus) {
    test::MadeMesh made(test::torus_triangles(40, 8, 3, 0.5));
    const Mesh mesh = made.mesh();
    Context c;
    Loops loops;
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, loops), HMF_OK);
    EXPECT_EQ(loops.crossings.size(), 16u); // once around the tube
}

TEST(CutSystem, PlatesOfGenus1To20) {
    for (int genus = 1; genus <= 20; ++genus)
        for (int fine = 1; fine <= test::sample(3, 1); ++fine) {
            test::MadeMesh made(test::plate(genus % 4 == 0 ? genus / 4 : genus, genus % 4 == 0 ? 4 : 1, fine));
            ASSERT_EQ(genus_of(made.mesh()), static_cast<uint32_t>(genus));
            expect_cut_system(made);
        }
}

TEST(CutSystem, Deterministic) {
    test::MadeMesh made(test::plate(3, 3, 2));
    const Mesh mesh = made.mesh();
    Context c;
    Loops a, b;
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, a), HMF_OK);
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, b), HMF_OK);
    ASSERT_EQ(a.crossings.size(), b.crossings.size());
    EXPECT_EQ(std::memcmp(a.crossings.data(), b.crossings.data(), a.crossings.size() * sizeof(uint32_t)), 0);
}

TEST(CutSystem, EveryAllocationMayFail) {
    test::MadeMesh made(test::plate(2, 1));
    const Mesh mesh = made.mesh();
    struct State {
        int left;
        int64_t live;
    };
    const auto allocate = [](void* user, size_t size) -> void* {
        State* s = static_cast<State*>(user);
        if (s->left-- <= 0) return nullptr;
        ++s->live;
        return std::malloc(size);
    };
    const auto release = [](void* user, void* block, size_t) {
        --static_cast<State*>(user)->live;
        std::free(block);
    };
    bool done = false;
    for (int n = 0; n < 2000 && !done; ++n) {
        State state{n, 0};
        {
            Memory memory(allocate, release, &state, 0);
            hmf_error error{};
            Call call(memory, &error, nullptr, nullptr);
            Loops loops, again;
            std::vector<uint32_t> faces;
            hmf_status status = cut_system(mesh, made.positions.data(), call, loops);
            if (status == HMF_OK) {
                for (uint32_t h : loops.crossings) faces.push_back(mesh.face[h]);
                status = read_loops(mesh, HMF_PATH_TRIANGLES, loops.count(), loops.offsets.data(), faces.data(), call,
                                    again);
            }
            if (status == HMF_OK) status = check_loops(mesh, again, call);
            done = status == HMF_OK;
            if (!done) { EXPECT_EQ(status, HMF_ERROR_MEMORY); }
        }
        EXPECT_EQ(state.live, 0);
    }
    EXPECT_TRUE(done);
}

TEST(CutSystem, CancelsAtEveryTick) {
    test::MadeMesh made(test::plate(2, 1));
    const Mesh mesh = made.mesh();
    int left = 0;
    const auto progress = [](void* user, double) -> int32_t {
        return --*static_cast<int*>(user) < 0 ? HMF_PROGRESS_CANCEL : HMF_PROGRESS_CONTINUE;
    };
    bool done = false;
    for (int n = 0; n < 1000 && !done; ++n) {
        left = n;
        Memory memory(nullptr, nullptr, nullptr, 0);
        Call call(memory, nullptr, progress, &left);
        Loops loops;
        hmf_status status = cut_system(mesh, made.positions.data(), call, loops);
        if (status == HMF_OK) status = check_loops(mesh, loops, call);
        done = status == HMF_OK;
        if (!done) { EXPECT_EQ(status, HMF_CANCELLED); }
    }
    EXPECT_TRUE(done);
}

class OnTorus : public ::testing::Test {
protected:
    test::MadeMesh made{test::torus_triangles(N, M)};
    Mesh mesh = made.mesh();
    Read vertices(const std::vector<std::vector<uint32_t>>& loops) { return Read(mesh, HMF_PATH_VERTICES, loops); }
    Read triangles(const std::vector<std::vector<uint32_t>>& loops) { return Read(mesh, HMF_PATH_TRIANGLES, loops); }
};

TEST_F(OnTorus, MeridianAndLongitude) {
    for (const auto& path : {meridian(2), longitude(4)}) {
        Read r(mesh, HMF_PATH_VERTICES, {path});
        EXPECT_EQ(r.status(), HMF_OK) << r.context.error.message;
    }
    Read m(mesh, HMF_PATH_VERTICES, {meridian(2)});
    EXPECT_EQ(parity(mesh, m.loops, 0, longitude(0)), 1u);
    EXPECT_EQ(parity(mesh, m.loops, 0, meridian(7)), 0u);
}

TEST_F(OnTorus, DetoursDoNotMatter) {
    // Back and forth, over two sides of a triangle, and both at the seam.
    std::vector<uint32_t> wiggly = {at(3, 0), at(2, 0), at(2, 1), at(3, 1), at(2, 1), at(3, 2), at(2, 2),
                                    at(2, 3), at(2, 4), at(1, 4), at(0, 4), at(1, 4), at(2, 4), at(3, 5),
                                    at(2, 5), at(2, 6), at(2, 7), at(2, 8), at(2, 0)};
    Read straight(mesh, HMF_PATH_VERTICES, {meridian(2)});
    for (size_t turn = 0; turn < wiggly.size(); ++turn) {
        std::vector<uint32_t> path(wiggly.begin() + static_cast<long>(turn), wiggly.end());
        path.insert(path.end(), wiggly.begin(), wiggly.begin() + static_cast<long>(turn));
        for (int way = 0; way < 2; ++way) {
            Read r(mesh, HMF_PATH_VERTICES, {path});
            ASSERT_EQ(r.status(), HMF_OK) << r.context.error.message;
            for (uint32_t i = 0; i < M; ++i) EXPECT_EQ(parity(mesh, r.loops, 0, longitude(i)), 1u);
            for (uint32_t i = 0; i < N; ++i) EXPECT_EQ(parity(mesh, r.loops, 0, meridian(i)), 0u);
            std::reverse(path.begin(), path.end());
        }
    }
}

TEST_F(OnTorus, RandomDetoursDoNotMatter) {
    uint64_t seed = 7;
    const auto random = [&seed](uint32_t n) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        return static_cast<uint32_t>((seed >> 33) % n);
    };
    const auto edge = [this](uint32_t i, uint32_t j) {
        uint32_t h = mesh.out[i];
        while (mesh.target(h) != j) h = mesh.rotate_cw(h);
        return h;
    };
    for (int round = 0; round < 500; ++round) {
        const std::vector<uint32_t> straight = round % 2 ? meridian(3) : longitude(5);
        std::vector<uint32_t> path;
        for (size_t i = 0; i < straight.size(); ++i) {
            const uint32_t here = straight[i], h = edge(here, straight[(i + 1) % straight.size()]);
            path.push_back(here);
            switch (random(6)) {
            case 0: path.push_back(mesh.origin[mesh.prev(h)]); break;       // over the triangle on the left
            case 1: path.push_back(mesh.origin[mesh.prev(twin(h))]); break; // or on the right
            case 2:                                                         // there and back
                path.push_back(mesh.target(mesh.rotate_cw(h)));
                path.push_back(here);
                break;
            default: break;
            }
        }
        std::rotate(path.begin(), path.begin() + random(static_cast<uint32_t>(path.size())), path.end());
        if (random(2)) std::reverse(path.begin(), path.end());
        Read r(mesh, HMF_PATH_VERTICES, {path});
        ASSERT_EQ(r.status(), HMF_OK) << round << ": " << r.context.error.message;
        EXPECT_EQ(parity(mesh, r.loops, 0, longitude(1)), static_cast<uint32_t>(round % 2));
        EXPECT_EQ(parity(mesh, r.loops, 0, meridian(1)), static_cast<uint32_t>(1 - round % 2));
    }
}

TEST_F(OnTorus, TrianglesBackAndForth) {
    // A strip with a dead end of two triangles, begun anywhere.
    Read plain(mesh, HMF_PATH_VERTICES, {meridian(3)});
    std::vector<uint32_t> strip;
    for (uint32_t h : plain.loops.crossings) strip.push_back(mesh.face[h]);
    uint32_t side = plain.loops.crossings[1];
    while (mesh.face[twin(side)] == strip[2] || mesh.face[twin(side)] == strip[0]) side = mesh.next[side];
    const uint32_t dead = mesh.face[twin(side)], end = mesh.face[twin(mesh.next[twin(side)])];
    std::vector<uint32_t> longer = strip;
    longer.insert(longer.begin() + 2, {dead, end, dead, strip[1]});
    for (size_t turn = 0; turn < longer.size(); ++turn) {
        std::rotate(longer.begin(), longer.begin() + 1, longer.end());
        Read r(mesh, HMF_PATH_TRIANGLES, {longer});
        ASSERT_EQ(r.status(), HMF_OK) << r.context.error.message;
        EXPECT_EQ(r.loops.crossings.size(), strip.size());
    }
}

TEST_F(OnTorus, Count) {
    Context c;
    Loops loops;
    const uint64_t offsets[] = {0, 0};
    const uint32_t none[] = {0};
    EXPECT_EQ(read_loops(mesh, HMF_PATH_VERTICES, 0, offsets, none, c.call, loops), HMF_ERROR_LOOP_COUNT);
    Context d;
    EXPECT_EQ(read_loops(mesh, HMF_PATH_VERTICES, 1, offsets, none, d.call, loops), HMF_ERROR_LOOP_COUNT);
    EXPECT_EQ(d.error.index, 0u);
}

TEST_F(OnTorus, Index) {
    auto bad = meridian(4);
    bad[3] = mesh.vertex_count;
    Read r(mesh, HMF_PATH_VERTICES, {meridian(1), bad});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_INDEX);
    EXPECT_EQ(r.context.error.index, 1u);
    EXPECT_EQ(triangles({{mesh.face_count}}).status(), HMF_ERROR_LOOP_INDEX);
}

TEST_F(OnTorus, NotClosed) {
    auto bad = meridian(4);
    bad.pop_back();
    Read r(mesh, HMF_PATH_VERTICES, {meridian(1), bad});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_NOT_CLOSED);
    EXPECT_EQ(r.context.error.index, 1u);
    EXPECT_NE(std::strstr(r.context.error.message, "Elements 7 and 0 of loop 1"), nullptr) << r.context.error.message;
    EXPECT_EQ(triangles({{0, 1, 100}}).status(), HMF_ERROR_LOOP_NOT_CLOSED);
    EXPECT_EQ(triangles({{0}}).status(), HMF_ERROR_LOOP_NOT_CLOSED);
}

TEST_F(OnTorus, NotSimple) {
    // A meridian twice over, and one that ends in a longitude.
    auto twice = meridian(2);
    const auto once = twice;
    twice.insert(twice.end(), once.begin(), once.end());
    EXPECT_EQ(vertices({twice}).status(), HMF_ERROR_LOOP_NOT_SIMPLE);
    // Both directions one after the other, with a figure of eight at the crossing.
    auto eight = meridian(0);
    for (uint32_t x = 0; x < N; ++x) eight.push_back(at(x, 0));
    auto commutator = eight;
    const auto m = meridian(0);
    for (uint32_t i = 0; i < M; ++i) commutator.push_back(m[(M - i) % M]);
    for (uint32_t x = 0; x < N; ++x) commutator.push_back(at(N - x, 0));
    // It only touches itself: pushed apart it is the boundary of what is left of the torus.
    Read r(mesh, HMF_PATH_VERTICES, {commutator});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_TRIVIAL) << r.context.error.message;
    EXPECT_EQ(r.context.error.index, 0u);
    // Once each way at a common vertex is simple: pushed off it does not meet itself.
    EXPECT_EQ(vertices({eight}).status(), HMF_OK);
}

TEST_F(OnTorus, TouchingLoopsArePushedApart) {
    // Beside the meridian at 2, with a vertex or an edge in common, on either side.
    const std::vector<uint32_t> right = {at(3, 0), at(3, 1), at(3, 2), at(3, 3), at(2, 3),
                                         at(2, 4), at(3, 5), at(3, 6), at(3, 7), at(3, 8)};
    const std::vector<uint32_t> left = {at(1, 0), at(1, 1), at(1, 2), at(1, 3), at(2, 4),
                                        at(1, 4), at(1, 5), at(1, 6), at(1, 7), at(1, 8)};
    for (std::vector<uint32_t> other : {right, left})
        for (int way = 0; way < 4; ++way) {
            std::vector<uint32_t> straight = meridian(2);
            if (way & 1) std::reverse(straight.begin(), straight.end());
            if (way & 2) std::reverse(other.begin(), other.end());
            for (size_t turn = 0; turn < other.size(); ++turn) {
                std::rotate(other.begin(), other.begin() + 1, other.end());
                EXPECT_EQ(vertices({straight, other}).status(), HMF_ERROR_LOOP_PARALLEL);
            }
        }
    // On both sides of it: they cross.
    const std::vector<uint32_t> through = {at(1, 3),  at(2, 4),  at(3, 5), at(4, 6), at(4, 5),
                                           at(5, 5),  at(6, 5),  at(7, 5), at(8, 5), at(9, 5),
                                           at(10, 5), at(11, 5), at(0, 5), at(0, 4), at(0, 3)};
    EXPECT_EQ(vertices({meridian(2), through}).status(), HMF_ERROR_LOOP_CROSSING);
}

TEST_F(OnTorus, Crossing) {
    Read r(mesh, HMF_PATH_VERTICES, {meridian(2), longitude(5)});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_CROSSING);
    EXPECT_EQ(r.context.error.index, 1u);
}

TEST_F(OnTorus, CrossingNamesTheLater) {
    Read r(mesh, HMF_PATH_VERTICES, {meridian(2), meridian(5), meridian(8), longitude(5), meridian(10)});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_CROSSING);
    EXPECT_EQ(r.context.error.index, 3u);
    EXPECT_NE(std::strstr(r.context.error.message, "Loop 3 crosses loop 0"), nullptr) << r.context.error.message;
}

TEST_F(OnTorus, Trivial) {
    // Around a vertex, and there and back.
    std::vector<uint32_t> ring;
    uint32_t h = mesh.out[at(4, 4)];
    do {
        ring.push_back(mesh.face[h]);
        h = mesh.rotate_ccw(h);
    } while (h != mesh.out[at(4, 4)]);
    EXPECT_EQ(triangles({ring}).status(), HMF_ERROR_LOOP_TRIVIAL);
    Read r(mesh, HMF_PATH_VERTICES, {meridian(2), {at(4, 4), at(5, 4), at(5, 5), at(5, 4)}});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_TRIVIAL);
    EXPECT_EQ(r.context.error.index, 1u);
    EXPECT_EQ(vertices({{at(4, 4), at(5, 4), at(6, 4), at(6, 5), at(6, 6), at(5, 6), at(4, 6), at(4, 5)}}).status(),
              HMF_ERROR_LOOP_TRIVIAL);
}

TEST_F(OnTorus, Parallel) {
    Read r(mesh, HMF_PATH_VERTICES, {meridian(2), meridian(6)});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_PARALLEL);
    EXPECT_EQ(r.context.error.index, 1u);
    // The same loop twice, and reversed.
    EXPECT_EQ(vertices({meridian(2), meridian(2)}).status(), HMF_ERROR_LOOP_PARALLEL);
    auto reversed = meridian(2);
    std::reverse(reversed.begin(), reversed.end());
    EXPECT_EQ(vertices({meridian(2), reversed}).status(), HMF_ERROR_LOOP_PARALLEL);
}

TEST(CheckLoops, ParallelOnAPlate) {
    // The loops around two neighboring bars differ, two on one bar do not.
    test::MadeMesh made(test::plate(2, 1, 3));
    const Mesh mesh = made.mesh();
    Context c;
    Loops loops;
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, loops), HMF_OK);
    std::vector<std::vector<uint32_t>> faces(2);
    for (size_t l = 0; l < 2; ++l)
        for (uint64_t i = loops.offsets[l]; i < loops.offsets[l + 1]; ++i)
            faces[l].push_back(mesh.face[loops.crossings[i]]);
    EXPECT_EQ(Read(mesh, HMF_PATH_TRIANGLES, {faces[0], faces[1]}).status(), HMF_OK);
    Read r(mesh, HMF_PATH_TRIANGLES, {faces[0], faces[1], faces[0]});
    EXPECT_EQ(r.status(), HMF_ERROR_LOOP_PARALLEL);
    EXPECT_EQ(r.context.error.index, 2u);
}

// The faces along a straight line that goes p times round in x and q times in y.
std::vector<uint32_t> straight_line(uint32_t n, uint32_t m, int p, int q, double x0, double y0) {
    const double dx = p * double(n), dy = q * double(m);
    std::vector<double> times;
    const auto cross = [&](double start, double way) { // start + t * way is an integer
        if (way == 0) return;
        const double low = way > 0 ? start : start + way, high = way > 0 ? start + way : start;
        for (double k = std::ceil(low); k < high; ++k) times.push_back((k - start) / way);
    };
    cross(x0, dx);
    cross(y0, dy);
    cross(x0 - y0, dx - dy);
    std::sort(times.begin(), times.end());
    std::vector<uint32_t> faces;
    for (size_t i = 0; i < times.size(); ++i) {
        const double t = (times[i] + (i + 1 < times.size() ? times[i + 1] : times[0] + 1)) / 2;
        const double x = x0 + t * dx, y = y0 + t * dy, cx = std::floor(x), cy = std::floor(y);
        const auto wrap = [](double c, uint32_t k) {
            return static_cast<uint32_t>(((static_cast<int>(c) % int(k)) + int(k)) % int(k));
        };
        faces.push_back(2 * (wrap(cx, n) * m + wrap(cy, m)) + (x - cx > y - cy ? 0 : 1));
    }
    return faces;
}

TEST(CheckLoops, StraightLinesOnATorus) {
    const uint32_t n = 4, m = 3;
    test::MadeMesh made(test::torus_triangles(n, m));
    const Mesh mesh = made.mesh();
    for (int p = -6; p <= 6; ++p)
        for (int q = 0; q <= 6; ++q) {
            if (p == 0 && q == 0) continue;
            int a = p < 0 ? -p : p, b = q;
            while (b) {
                const int c = a % b;
                a = b;
                b = c;
            }
            const auto line = straight_line(n, m, p, q, 0.3141, 0.2718);
            Read r(mesh, HMF_PATH_TRIANGLES, {line});
            EXPECT_EQ(r.status(), a == 1 ? HMF_OK : HMF_ERROR_LOOP_NOT_SIMPLE)
                << p << " " << q << " " << r.context.error.message;
            if (a != 1) continue;
            Read two(mesh, HMF_PATH_TRIANGLES, {line, straight_line(n, m, p, q, 0.7391, 0.0917)});
            EXPECT_EQ(two.status(), HMF_ERROR_LOOP_PARALLEL) << p << " " << q;
            const int crossings = p * 3 - q * 2;
            Read other(mesh, HMF_PATH_TRIANGLES, {straight_line(n, m, 2, 3, 0.1234, 0.4321), line});
            EXPECT_EQ(other.status(), crossings ? HMF_ERROR_LOOP_CROSSING : HMF_ERROR_LOOP_PARALLEL) << p << " " << q;
        }
}

TEST(CheckLoops, SeparatingLoop) {
    // Around the middle of a plate with two holes: essential, though it bounds.
    const test::Triangles plate = test::plate(2, 1, 2);
    test::MadeMesh made(plate);
    const Mesh mesh = made.mesh();
    std::vector<uint32_t> path;
    const auto find = [&](double y, double z) {
        for (uint32_t v = 0; v < plate.vertex_count(); ++v)
            if (plate.positions[3 * v] == 2.5 && plate.positions[3 * v + 1] == y && plate.positions[3 * v + 2] == z)
                path.push_back(v);
    };
    for (int i = 0; i < 6; ++i) find(i / 2.0, 0);
    for (int i = 0; i < 2; ++i) find(3, i / 2.0);
    for (int i = 6; i > 0; --i) find(i / 2.0, 1);
    for (int i = 2; i > 0; --i) find(0, i / 2.0);
    ASSERT_EQ(path.size(), 16u);
    Read r(mesh, HMF_PATH_VERTICES, {path});
    EXPECT_EQ(r.status(), HMF_OK) << r.context.error.message;
    EXPECT_EQ(pieces(mesh, r.loops).count, 2u);
    EXPECT_EQ(Read(mesh, HMF_PATH_VERTICES, {path, path}).status(), HMF_ERROR_LOOP_PARALLEL);
}

// Flips that nothing restrains: several edges between two vertices, edges from
// a vertex to itself, triangles glued to themselves.
void flip_at_random(test::MadeMesh& made, uint32_t count, uint64_t seed) {
    const Mesh mesh = made.mesh();
    for (uint32_t i = 0; i < count; ++i) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const uint32_t h = 2 * static_cast<uint32_t>((seed >> 33) % mesh.edge_count), t = twin(h);
        const uint32_t f = mesh.face[h], g = mesh.face[t];
        if (f == g) continue;
        const uint32_t jk = mesh.next[h], ki = mesh.next[jk], il = mesh.next[t], lj = mesh.next[il];
        const uint32_t a = mesh.origin[h], b = mesh.origin[t];
        if (mesh.rotate_cw(h) == h || mesh.rotate_cw(t) == t) continue; // the only edge of a vertex
        mesh.out[a] = il;
        mesh.out[b] = jk;
        mesh.origin[h] = mesh.origin[lj];
        mesh.origin[t] = mesh.origin[ki];
        const uint32_t left[3] = {h, ki, il}, right[3] = {t, lj, jk};
        for (int k = 0; k < 3; ++k) {
            mesh.next[left[k]] = left[(k + 1) % 3];
            mesh.face[left[k]] = f;
            mesh.next[right[k]] = right[(k + 1) % 3];
            mesh.face[right[k]] = g;
        }
    }
}

TEST(CutSystem, AfterRandomFlips) {
    for (uint64_t seed = 1; seed <= 60; ++seed) {
        test::MadeMesh made(seed % 3 == 0
                                ? test::torus_triangles(3 + seed % 4, 3)
                                : test::plate(1 + static_cast<int>(seed % 4), 1 + static_cast<int>(seed % 2)));
        flip_at_random(made, static_cast<uint32_t>(40 * seed), seed);
        expect_cut_system(made, false);
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

// Does a set of segments (odd[s]) cut the points into two classes?
bool separates(const CutSurface& cut, const std::vector<char>& odd) {
    std::vector<char> side(cut.point_count, -1);
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t s = 0; s < cut.segment_count; ++s) {
            const uint32_t p = cut.point[2 * size_t{s}], q = cut.point[2 * size_t{s} + 1];
            if (s == 0 && side[p] < 0) side[p] = 0;
            if (side[p] < 0 && side[q] < 0) continue;
            if (side[p] >= 0 && side[q] >= 0) {
                if ((side[p] ^ side[q]) != odd[s]) return false;
                continue;
            }
            (side[p] < 0 ? side[p] : side[q]) = static_cast<char>((side[p] < 0 ? side[q] : side[p]) ^ odd[s]);
            changed = true;
        }
    }
    return true;
}

// Pulled straight, every loop is the shortest that does not separate what the
// loops before it leave, up to the tilt: no segment closes one in the tree of
// shortest ways from any region that is a shorter strip and a shorter curve.
// Signatures tell which separate; on small meshes they are checked.
TEST(CutSystem, EachIsTheShortest) {
    for (uint64_t seed = test::sample<uint64_t>(1, 4); seed <= 9; ++seed) {
        const bool small = seed > 3;
        test::MadeMesh made(seed % 3 == 0 ? test::torus_triangles(small ? 7 : 16, small ? 4 : 10)
                                          : test::plate(1 + static_cast<int>(seed % 3), 1, small ? 1 : 2));
        if (seed % 2) flip_at_random(made, static_cast<uint32_t>(5 * seed), seed);
        uint64_t random = seed;
        for (double& x : made.positions) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            x += 0.3 * static_cast<double>(random >> 40) / 16777216.0;
        }
        const Mesh mesh = made.mesh();
        // An edge from a vertex to itself would have length 0, and curves no length at all.
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) ASSERT_NE(mesh.origin[h], mesh.target(h)) << "seed " << seed;
        Context c;
        Loops loops;
        Multicurve curves;
        std::vector<double> length;
        const DualLength plain(mesh, made.positions.data());
        for (uint32_t e = 0; e < mesh.edge_count; ++e) length.push_back(plain(e));
        ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, loops), HMF_OK);
        ASSERT_TRUE(curves.allocate(mesh, c.memory));
        for (size_t k = 0; k < loops.count(); ++k) {
            const uint32_t* const loop = loops.crossings.data() + loops.offsets[k];
            const size_t n = loops.offsets[k + 1] - loops.offsets[k];
            double found = 0;
            for (size_t i = 0; i < n; ++i) found += length[edge_of(loop[i])];
            ClosedGeodesic geodesic(mesh, made.positions.data(), 0, c.call);
            const auto curve = [&](const std::vector<uint32_t>& crossings) {
                Array<uint32_t> strip;
                strip.start(c.memory);
                for (const uint32_t h : crossings) EXPECT_TRUE(strip.push(h));
                size_t begin = 0, end = 0;
                remove_backtracking(strip, begin, end);
                Array<uint32_t> rest;
                rest.start(c.memory);
                for (size_t i = begin; i < end; ++i) EXPECT_TRUE(rest.push(strip[i]));
                double straight = 0;
                EXPECT_TRUE(geodesic.straighten_widely(rest, 100, straight));
                return straight;
            };
            const double straight = curve({loop, loop + n});
            CutSurface cut;
            Signatures signatures;
            ASSERT_TRUE(curves.trace(mesh, c.call) && cut.build(mesh, curves, true, c.call)
                        && signatures.build(cut, c.call));
            for (uint32_t root = 0; root < cut.region_count; ++root) {
                std::vector<double> distance(cut.region_count, HUGE_VAL);
                std::vector<uint32_t> through(cut.region_count, NONE);
                distance[root] = 0;
                std::set<std::pair<double, uint32_t>> queue{{0, root}};
                while (!queue.empty()) {
                    const auto [d, r] = *queue.begin();
                    queue.erase(queue.begin());
                    for (uint32_t i = 0; i < 3 && cut.link[3 * size_t{r} + i] != NONE; ++i) {
                        const uint32_t link = cut.link[3 * size_t{r} + i], to = cut.region[link ^ 1u];
                        if (!(d + length[cut.segment_edge[link >> 1]] < distance[to])) continue;
                        queue.erase({distance[to], to});
                        distance[to] = d + length[cut.segment_edge[link >> 1]];
                        through[to] = link;
                        queue.insert({distance[to], to});
                    }
                }
                for (uint32_t s = 0; s < cut.segment_count; ++s) {
                    const uint32_t ends[2] = {cut.region[2 * size_t{s}], cut.region[2 * size_t{s} + 1]};
                    if (distance[ends[0]] + length[cut.segment_edge[s]] + distance[ends[1]] > found * (1 - 1e-9))
                        continue;
                    std::vector<char> odd(small ? cut.segment_count : 0, 0);
                    uint64_t signature = signatures.of[s];
                    if (small) odd[s] = 1;
                    for (uint32_t r : ends)
                        for (; r != root; r = cut.region[through[r]]) {
                            signature ^= signatures.of[through[r] >> 1];
                            if (small) odd[through[r] >> 1] ^= 1;
                        }
                    if (small) { EXPECT_EQ(separates(cut, odd), signature == 0); }
                    if (signature == 0) continue;
                    std::vector<uint32_t> crossings;
                    for (uint32_t r = ends[0]; r != root; r = cut.region[through[r]])
                        crossings.insert(crossings.begin(), cut.half_edge(through[r]));
                    crossings.push_back(cut.half_edge(2 * s));
                    for (uint32_t r = ends[1]; r != root; r = cut.region[through[r]])
                        crossings.push_back(cut.half_edge(through[r] ^ 1u));
                    EXPECT_GE(1.0101 * curve(crossings), straight)
                        << "seed " << seed << " loop " << k << " root " << root << " segment " << s;
                }
            }
            ASSERT_TRUE(curves.add(loop, n));
        }
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

} // namespace

// A loop around the tube that wanders along the torus and back: shortened it is no longer than a straight one, which
// lies outside of the triangles that it passed.
TEST(ShortenLoops, AWanderingLoopBecomesARing) {
    constexpr uint32_t n = 40, m = 12, far = 9;
    const test::Triangles torus = test::torus_triangles(n, m);
    test::MadeMesh made(torus);
    const Mesh mesh = made.mesh();
    const auto low = [](uint32_t x, uint32_t y) { return 2 * (x * m + y); };      // below the diagonal of a cell
    const auto high = [](uint32_t x, uint32_t y) { return 2 * (x * m + y) + 1; }; // above
    std::vector<uint32_t> straight, wandering;
    for (uint32_t y = 0; y < m; ++y) straight.insert(straight.end(), {low(3, y), high(3, y)});
    for (uint32_t y = 0; y < m / 2; ++y) wandering.insert(wandering.end(), {low(3, y), high(3, y)});
    wandering.push_back(low(3, m / 2));
    for (uint32_t x = 4; x < 3 + far; ++x) wandering.insert(wandering.end(), {high(x, m / 2), low(x, m / 2)});
    wandering.push_back(high(3 + far, m / 2));
    for (uint32_t y = m / 2 + 1; y < m; ++y) wandering.insert(wandering.end(), {low(3 + far, y), high(3 + far, y)});
    wandering.push_back(low(3 + far, 0));
    for (uint32_t x = 3 + far; x > 3; --x) {
        wandering.push_back(high(x, 0));
        if (x > 4) wandering.push_back(low(x - 1, 0));
    }
    Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    Call call(memory, &error, nullptr, nullptr);
    const DualLength length(mesh, made.positions.data());
    double measured[2];
    for (const bool wanders : {false, true}) {
        const std::vector<uint32_t>& faces = wanders ? wandering : straight;
        const uint64_t offsets[2] = {0, faces.size()};
        Loops loops;
        ASSERT_EQ(read_loops(mesh, HMF_PATH_TRIANGLES, 1, offsets, faces.data(), call, loops), HMF_OK) << error.message;
        ASSERT_EQ(loops.length(0), faces.size());
        if (wanders) { ASSERT_EQ(shorten_loops(mesh, made.positions.data(), call, loops), HMF_OK); }
        measured[wanders] = 0;
        for (size_t i = 0; i < loops.length(0); ++i) measured[wanders] += length(edge_of(loops.loop(0)[i]));
    }
    EXPECT_LE(measured[1], measured[0] * (1 + 1e-9));
}

// Against all loops at once.
TEST(Disjoint, TheLastOneAlone) {
    test::MadeMesh made(test::plate(3, 3, 2));
    const Mesh mesh = made.mesh();
    Context c;
    Loops cut, others;
    ASSERT_EQ(cut_system(mesh, made.positions.data(), c.call, cut), HMF_OK);
    ASSERT_EQ(hmf::dual_loops(mesh, cut, c.call, others), HMF_OK);            // each crosses one
    for (size_t k = 0; k < cut.count(); ++k) ASSERT_TRUE(others.add(cut, k)); // beside themselves
    Multicurve curves;
    ASSERT_TRUE(curves.allocate(mesh, c.memory));
    size_t yes = 0;
    for (size_t k = 0; k < others.count(); ++k) {
        ASSERT_TRUE(cut.add(others, k));
        bool all = false, last = false;
        ASSERT_TRUE(hmf::disjoint(mesh, cut, 0, cut.count(), curves, nullptr, c.call, all));
        ASSERT_TRUE(hmf::one_is_disjoint(mesh, cut, cut.count() - 1, curves, c.call, last));
        EXPECT_EQ(last, all) << k;
        yes += all;
        cut.keep_first(cut.count() - 1);
    }
    EXPECT_GE(yes, cut.count());
    EXPECT_LT(yes, others.count());
}

TEST(Cycles, AreTheSameFromEachStart) {
    const std::vector<uint32_t> a = {3, 1, 4, 1, 5, 9, 2, 6};
    for (size_t turn = 0; turn < a.size(); ++turn) {
        std::vector<uint32_t> b = a;
        std::rotate(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(turn), b.end());
        EXPECT_TRUE(hmf::same_cycle(a.data(), b.data(), a.size())) << turn;
        std::swap(b[2], b[5]);
        EXPECT_FALSE(hmf::same_cycle(a.data(), b.data(), a.size())) << turn;
    }
}

} // namespace test_loops
