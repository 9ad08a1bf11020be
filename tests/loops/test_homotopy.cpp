// Names of free homotopy classes: the same for all curves of a class, and for no
// other.  Walks in the system of quads, and words where vertices are marked.
#include "src/core/hierarchy/hierarchy.hpp"
#include "src/applications/cylinders/curve_classes.hpp"
#include "support/make_mesh.hpp"
#include "support/meshes.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

namespace test_homotopy {

using namespace test;

namespace {

// The polygon a b a^-1 b^-1 c d c^-1 d^-1 ..
std::vector<uint32_t> commutators(uint32_t genus) {
    std::vector<uint32_t> twin(4 * genus);
    for (uint32_t s = 0; s < 4 * genus; ++s) twin[s] = s % 4 < 2 ? s + 2 : s - 2;
    return twin;
}

// Opposite sides.
std::vector<uint32_t> opposite(uint32_t genus) {
    std::vector<uint32_t> twin(4 * genus);
    for (uint32_t s = 0; s < 4 * genus; ++s) twin[s] = (s + 2 * genus) % (4 * genus);
    return twin;
}

struct Quads {
    explicit Quads(const std::vector<uint32_t>& side) : twin(side), memory(nullptr, nullptr, nullptr, 0) {
        hmf::Array<uint32_t> sides;
        sides.start(memory);
        for (const uint32_t s : side) EXPECT_TRUE(sides.push(s));
        EXPECT_TRUE(quads.start(sides, memory));
    }
    std::vector<uint32_t> canonical(const std::vector<uint32_t>& walk) {
        hmf::Walk w;
        w.start(memory);
        for (const uint32_t s : walk) EXPECT_TRUE(w.push(s));
        EXPECT_TRUE(quads.canonical(w, memory));
        return std::vector<uint32_t>(w.begin(), w.end());
    }
    std::vector<uint32_t> twin;
    hmf::Memory memory;
    hmf::QuadSystem quads;
};

using Path = std::vector<uint32_t>;

// Somewhere on the closed walk: a spur comes or goes, or two sides of a quad become the two others.
// The quad of side s has the corners s, s + 1, t + 1, t in turn, where t is its twin.
void deform(Path& walk, const std::vector<uint32_t>& twin, Random& random) {
    const uint32_t n = static_cast<uint32_t>(twin.size());
    const size_t i = random.below(walk.size()), j = (i + 1) % walk.size();
    const bool at_b = i % 2 == 0; // between i and j
    switch (random.below(3)) {
    case 0: {
        const uint32_t spoke = static_cast<uint32_t>(random.below(n));
        walk.insert(walk.begin() + static_cast<long>(i), 2, spoke);
        break;
    }
    case 1:
        if (walk[i] == walk[j] && j > i && walk.size() > 2)
            walk.erase(walk.begin() + static_cast<long>(i), walk.begin() + static_cast<long>(j) + 1);
        break;
    default:
        for (uint32_t s = 0; s < n; ++s) {
            const uint32_t t = twin[s], corner[4] = {s, (s + 1) % n, t, (t + 1) % n};
            // Around the quad: s (b) s+1 (a) t (b) t+1 (a).
            for (uint32_t k = at_b ? 0 : 1; k < 4; k += 2) {
                const uint32_t x = corner[k], y = corner[(k + 1) % 4];
                if (walk[i] == x && walk[j] == y) {
                    walk[i] = corner[(k + 3) % 4];
                    walk[j] = corner[(k + 2) % 4];
                    return;
                }
                if (walk[i] == y && walk[j] == x) {
                    walk[i] = corner[(k + 2) % 4];
                    walk[j] = corner[(k + 3) % 4];
                    return;
                }
            }
        }
    }
}

Path random_walk(uint32_t n, size_t length, Random& random) {
    Path walk(2 * length);
    for (uint32_t& s : walk) s = static_cast<uint32_t>(random.below(n));
    return walk;
}

Path turned(const Path& walk, Random& random) {
    Path out = walk;
    std::rotate(out.begin(), out.begin() + static_cast<long>(2 * random.below(walk.size() / 2)), out.end());
    // Backwards, as it starts at a again.
    if (random.below(2)) std::reverse(out.begin(), out.end());
    return out;
}

// Up to sign.
std::vector<int> homology(const Path& walk, const std::vector<uint32_t>& twin) {
    const size_t n = twin.size();
    std::vector<std::vector<int>> corner(n, std::vector<int>(n, 0));
    for (size_t c = 0; c + 1 < n; ++c) {
        corner[c + 1] = corner[c];
        corner[c + 1][std::min<size_t>(c, twin[c])] += twin[c] > c ? 1 : -1;
    }
    std::vector<int> sum(n, 0);
    for (size_t i = 0; i < walk.size(); i += 2)
        for (size_t k = 0; k < n; ++k) sum[k] += corner[walk[i + 1]][k] - corner[walk[i]][k];
    std::vector<int> negative = sum;
    for (int& x : negative) x = -x;
    return std::max(sum, negative);
}

std::vector<uint32_t> permutation(uint32_t n, Random& random) {
    std::vector<uint32_t> out(n);
    for (uint32_t v = 0; v < n; ++v) out[v] = v;
    for (size_t v = n - 1; v > 0; --v) std::swap(out[v], out[random.below(v + 1)]);
    return out;
}

// Around a vertex, from one of its faces.
Path round(const hmf::Mesh& m, uint32_t half_edge) {
    Path path;
    for (const uint32_t h : m.clockwise_from(half_edge)) path.push_back(h);
    return path;
}

// Closed, through about so many faces at random.
Path random_loop(const hmf::Mesh& m, size_t length, Random& random) {
    const uint32_t start = static_cast<uint32_t>(random.below(m.face_count));
    Path path, side(m.face_count, hmf::NONE), queue(1, start);
    std::vector<uint32_t> of_face(m.face_count);
    for (uint32_t h = 0; h < 2 * m.edge_count; ++h) of_face[m.face[h]] = h;
    uint32_t f = start;
    const auto turn = [&](uint32_t face, size_t k) {
        uint32_t h = of_face[face];
        for (; k > 0; --k) h = m.next[h];
        return h;
    };
    for (size_t k = 0; k < length; ++k) {
        path.push_back(turn(f, random.below(3)));
        f = m.face[hmf::twin(path.back())];
    }
    for (size_t i = 0; i < queue.size(); ++i) // the shortest way back
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t h = turn(queue[i], k), to = m.face[hmf::twin(h)];
            if (to == start || side[to] != hmf::NONE) continue;
            side[to] = hmf::twin(h);
            queue.push_back(to);
        }
    for (; f != start; f = m.face[hmf::twin(path.back())]) path.push_back(side[f]);
    return path;
}

// Nowhere there and back again.
Path without_spurs(const Path& loop) {
    std::deque<uint32_t> path;
    for (const uint32_t h : loop) {
        if (!path.empty() && path.back() == hmf::twin(h)) path.pop_back();
        else path.push_back(h);
    }
    for (; path.size() > 1 && path.front() == hmf::twin(path.back()); path.pop_front()) path.pop_back();
    return Path(path.begin(), path.end());
}

// Its first vertices are marked.
struct MarkedSurface {
    // number: of each vertex of the mesh here.
    MarkedSurface(const Triangles& mesh, const std::vector<uint32_t>& number, uint32_t marks) :
        memory(nullptr, nullptr, nullptr, 0), call(memory, &error, nullptr, nullptr) {
        Triangles t;
        t.positions.resize(mesh.positions.size());
        for (const uint32_t v : mesh.triangles) t.triangles.push_back(number[v]);
        made = MadeMesh(t);
        m = made.mesh();
        m.marked_count = marks;
        EXPECT_TRUE(words.start(m, m.edge_count, call));
    }
    uint32_t half_edge(uint32_t a, uint32_t b) const {
        for (const uint32_t h : m.around(a))
            if (m.target(h) == b) return h;
        return hmf::NONE;
    }
    Path canonical(const Path& crossings) {
        hmf::Array<uint32_t> word;
        word.start(memory);
        EXPECT_TRUE(words.name(
            m, 0, crossings.size(), [&](uint64_t i) { return crossings[i]; }, word));
        return Path(word.begin(), word.end());
    }
    MadeMesh made;
    hmf::Mesh m;
    hmf::Memory memory;
    hmf_error error{};
    hmf::Call call;
    hmf::CurveWords words;
};

// Somewhere on the way there and back again, or once around a vertex that is not marked.
void deform(const hmf::Mesh& m, Path& loop, Random& random) {
    const size_t at = random.below(loop.size());
    uint32_t h = loop[at]; // of the face before it
    if (random.below(2)) h = m.next[h];
    if (random.below(3) == 0) {
        const Path there = {h, hmf::twin(h)};
        loop.insert(loop.begin() + static_cast<long>(at), there.begin(), there.end());
    } else if (!m.is_marked(m.origin[h])) {
        const Path path = round(m, h);
        loop.insert(loop.begin() + static_cast<long>(at), path.begin(), path.end());
    }
}

// A short walk, and the same one pushed about by deformations that keep it short.
void push_about(Path& walk, const std::vector<uint32_t>& twin, Random& random) {
    for (size_t k = 0; k < 60; ++k) deform(walk, twin, random);
}

// Genus 0, 1 and 2.
std::vector<Triangles> few_genera() {
    return {voxels(2, 2, 2, std::vector<char>(8, 1), 2), plate(1, 1, 2), plate(2, 1)};
}

} // namespace

// Walks along rows of quads, where most special cases lie.
TEST(Homotopy, CanonicalWalkOfShortLoops) {
    Random random(11);
    for (const uint32_t genus : {2u, 3u, 7u})
        for (const bool other : {false, true}) {
            Quads quads(other ? opposite(genus) : commutators(genus));
            for (uint32_t a = 0; a < 4 * genus; ++a)
                for (uint32_t b = 0; b < 4 * genus; ++b)
                    for (size_t power = 1; power <= 3; ++power) {
                        Path walk;
                        for (size_t k = 0; k < power; ++k) walk.insert(walk.end(), {a, b});
                        const Path expected = quads.canonical(walk);
                        for (size_t problem = 0; problem < 6; ++problem) {
                            push_about(walk, quads.twin, random);
                            ASSERT_EQ(quads.canonical(turned(walk, random)), expected) << genus << " " << other;
                        }
                    }
        }
}

TEST(Homotopy, WordIsTheSameInAClass) {
    Random random(5);
    size_t genus = 0;
    for (const Triangles& mesh : few_genera()) {
        const std::vector<uint32_t> number = permutation(mesh.vertex_count(), random);
        for (const uint32_t marks : {1u, 2u, 3u, 4u, 9u}) {
            MarkedSurface surface(mesh, number, marks);
            size_t letters = 0;
            for (size_t problem = 0; problem < 200; ++problem) {
                Path loop = random_loop(surface.m, 1 + random.below(60), random);
                const Path expected = surface.canonical(loop);
                letters += expected.size();
                for (size_t k = 0; k < 100; ++k) deform(surface.m, loop, random);
                std::rotate(loop.begin(), loop.begin() + static_cast<long>(random.below(loop.size())), loop.end());
                if (random.below(2)) {
                    std::reverse(loop.begin(), loop.end());
                    for (uint32_t& h : loop) h = hmf::twin(h);
                }
                ASSERT_EQ(surface.canonical(loop), expected)
                    << "genus " << genus << ", " << marks << " marks, problem " << problem;
            }
            EXPECT_EQ(letters > 0, genus > 0 || marks > 1);
        }
        ++genus;
    }
}

// Whether two curves are in one class depends on no tree, and not on the order of the marked vertices.
TEST(Homotopy, ClassesDependOnNoTree) {
    Random random(6);
    const uint32_t marks = 5;
    size_t genus = 0;
    for (const Triangles& mesh : few_genera()) {
        const std::vector<uint32_t> number = permutation(mesh.vertex_count(), random);
        // In b the marked vertices are those of a, and all have other numbers.
        std::vector<uint32_t> other = permutation(mesh.vertex_count(), random);
        for (uint32_t v = 0; v < marks; ++v) std::swap(other[v], *std::find(other.begin(), other.end(), marks - 1 - v));
        std::vector<uint32_t> in_other(number.size());
        for (size_t v = 0; v < number.size(); ++v) in_other[v] = other[number[v]];
        MarkedSurface a(mesh, number, marks), b(mesh, in_other, marks);
        const auto seen_in_b = [&](const Path& loop) {
            Path path;
            for (const uint32_t h : loop) path.push_back(b.half_edge(other[a.m.origin[h]], other[a.m.target(h)]));
            return path;
        };
        std::vector<Path> in_a, in_b;
        // Around one marked vertex, around a vertex, and short loops, of which many are in one class.
        for (uint32_t v = 0; v < 2 * marks; ++v) {
            const Path path = round(a.m, a.m.out[v]);
            in_a.push_back(a.canonical(path));
            in_b.push_back(b.canonical(seen_in_b(path)));
            EXPECT_EQ(in_a.back().empty(), v >= marks);
        }
        for (size_t k = 0; k < 400; ++k) {
            const Path loop = random_loop(a.m, 100 + random.below(200), random);
            in_a.push_back(a.canonical(loop));
            in_b.push_back(b.canonical(seen_in_b(loop)));
        }
        size_t same = 0;
        for (size_t i = 0; i < in_a.size(); ++i)
            for (size_t k = 0; k < i; ++k) {
                ASSERT_EQ(in_a[i] == in_a[k], in_b[i] == in_b[k]) << "genus " << genus << ": " << i << " " << k;
                same += in_a[i] == in_a[k];
            }
        EXPECT_GT(same, 100u);
        EXPECT_LT(same, in_a.size() * (in_a.size() - 1) / 4);
        ++genus;
    }
}

// Words that were carried from the coarsest level to the finest, and through the flips there, tell the same curves
// apart as words that are read on the finest one.
TEST(Homotopy, WordsGoFromLevelToLevel) {
    Random random(8);
    const std::vector<Triangles> meshes = {voxels(2, 2, 2, std::vector<char>(8, 1), 5), plate(1, 1, 5), plate(2, 1, 3)};
    for (size_t genus = 0; genus < meshes.size(); ++genus)
        for (const uint32_t marks : {0u, 1u, 4u, 9u}) {
            if (genus == 0 && marks < 4) continue; // carries no foliation
            TriMesh mesh{meshes[genus].positions, meshes[genus].triangles, genus};
            for (double& x : mesh.positions) x += 0.01 * random.unit();
            for (size_t v = 0; v < mesh.vertex_count(); ++v) mesh.positions[3 * v] *= 4; // so that edges flip
            std::vector<uint32_t> marked = permutation(static_cast<uint32_t>(mesh.vertex_count()), random);
            marked.resize(marks);
            hmf_hierarchy_options options{};
            options.struct_size = sizeof options;
            options.coarsest = 8;
            options.marked_vertices = marked.data();
            options.marked_count = marks;
            const Hierarchy hierarchy(mesh, options);
            ASSERT_TRUE(hierarchy);
            ASSERT_GT(hierarchy.get()->intrinsic_flip_count, 0u);
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf_error error{};
            hmf::Call call(memory, &error, nullptr, nullptr);
            hmf::CurveClasses carried;
            ASSERT_FALSE(carried.start(*hierarchy.get(), hierarchy.coarsest(), 0, call));
            while (carried.level() > 0) ASSERT_FALSE(carried.refine(call));
            const auto compare = [&](const hmf::Mesh& m) {
                hmf::Loops loops;
                hmf::CurveWords words;
                hmf::ClassTable fresh, names;
                ASSERT_TRUE(loops.start(memory) && words.start(m, m.edge_count, call));
                for (size_t k = 0; k < 300; ++k) {
                    Path loop = without_spurs(random_loop(m, 30 + random.below(2000), random));
                    if (k < 10 || loop.empty()) loop = round(m, m.out[k]);
                    ASSERT_TRUE(loops.add(loop.data(), loop.size()));
                }
                fresh.start(memory);
                for (size_t k = 0; k < loops.count(); ++k)
                    ASSERT_TRUE(fresh.add(m, words, loops.offsets[k], loops.offsets[k + 1],
                                          [&](uint64_t i) { return loops.crossings[i]; }));
                ASSERT_FALSE(carried.name(loops, names, call));
                size_t same = 0, classes = 0;
                for (size_t i = 0; i < loops.count(); ++i) {
                    size_t before = 0;
                    for (size_t k = 0; k < i; ++k) {
                        ASSERT_EQ(names.same(i, names, k), fresh.same(i, fresh, k))
                            << "genus " << genus << ", " << marks << " marks: " << i << " " << k;
                        before += names.same(i, names, k);
                    }
                    same += before;
                    classes += before == 0;
                }
                EXPECT_GT(same, 20u);
                EXPECT_GT(classes, 5u) << "genus " << genus << ", " << marks << " marks";
            };
            compare(hierarchy.get()->input);
            ASSERT_FALSE(carried.to_intrinsic(call));
            compare(hierarchy.get()->levels[0].mesh);
        }
}

TEST(Homotopy, CanonicalWalkIsTheSameInAClass) {
    Random random(7);
    for (const uint32_t genus : {1u, 2u, 3u, 5u})
        for (const bool other : {false, true}) {
            Quads quads(other ? opposite(genus) : commutators(genus));
            for (size_t problem = 0; problem < 400; ++problem) {
                Path walk = random_walk(4 * genus, 1 + random.below(12), random);
                const Path expected = quads.canonical(walk);
                if (genus > 1)
                    ASSERT_EQ(homology(expected, quads.twin), homology(walk, quads.twin))
                        << testing::PrintToString(walk) << testing::PrintToString(expected);
                for (size_t k = 0; k < 200; ++k) deform(walk, quads.twin, random);
                ASSERT_EQ(quads.canonical(turned(walk, random)), expected)
                    << "genus " << genus << " other " << other << " problem " << problem;
            }
        }
}

} // namespace test_homotopy
