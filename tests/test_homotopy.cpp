// Walks in the system of quads: the canonical walk is the same for all walks
// of a free homotopy class, and for no other.
#include "../src/homotopy/edge_words.hpp"
#include "support/make_mesh.hpp"
#include "support/meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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
            // Round the quad: s (b) s+1 (a) t (b) t+1 (a).
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

// A short walk, and the same one pushed about by deformations that keep it short.
void push_about(Path& walk, const std::vector<uint32_t>& twin, Random& random) {
    for (size_t k = 0; k < 60; ++k) deform(walk, twin, random);
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
