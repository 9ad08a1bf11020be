// Signed matrices for the tests of linear solvers: tori with tripods, rings of heavy edges; solved by Eigen.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "../src/core/linear/signed_matrix.hpp"

namespace linear {

struct Random {
    uint64_t state;
    explicit Random(uint64_t seed) : state(seed * 0x9e3779b97f4a7c15u + 1) {}
    uint64_t next() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        return state;
    }
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(next() % n); }
    int sign() { return next() & 1024 ? 1 : -1; }
};

struct Edge {
    uint32_t i, j;
    double weight;
    int sign;
};

struct System {
    std::vector<uint32_t> offset, column;
    std::vector<double> entry, diagonal;

    System(uint32_t n, const std::vector<Edge>& edges, const std::vector<bool>& fixed = {}) :
        offset(n + 1, 0), diagonal(n, 0) {
        const auto is_fixed = [&](uint32_t v) { return !fixed.empty() && fixed[v]; };
        for (uint32_t pass = 0; pass < 2; ++pass) {
            std::vector<uint32_t> at(offset.begin(), offset.end() - 1);
            for (const Edge& e : edges)
                for (uint32_t t = 0; t < 2; ++t) {
                    const uint32_t i = t ? e.j : e.i, j = t ? e.i : e.j;
                    if (is_fixed(i)) continue;
                    if (pass == 0) diagonal[i] += e.weight;
                    if (is_fixed(j)) continue;
                    if (pass == 0) {
                        ++offset[i + 1];
                        continue;
                    }
                    column[at[i]] = j;
                    entry[at[i]++] = e.weight * e.sign;
                }
            if (pass == 1) break;
            for (uint32_t i = 0; i < n; ++i) offset[i + 1] += offset[i];
            column.resize(offset[n]);
            entry.resize(offset[n]);
        }
    }
    uint32_t n() const { return static_cast<uint32_t>(diagonal.size()); }
    hmf::SignedMatrix matrix() const { return {n(), offset.data(), column.data(), entry.data(), diagonal.data()}; }
    std::vector<double> times(const std::vector<double>& x) const {
        std::vector<double> y(n());
        for (uint32_t i = 0; i < n(); ++i) {
            y[i] = diagonal[i] * x[i];
            for (uint32_t k = offset[i]; k < offset[i + 1]; ++k) y[i] += entry[k] * x[column[k]];
        }
        return y;
    }
    // Not the solver's own opinion.
    double residual(const std::vector<double>& x, const std::vector<double>& b) const {
        const std::vector<double> y = times(x);
        double r = 0, s = 0;
        for (uint32_t i = 0; i < n(); ++i)
            if (diagonal[i] > 0) {
                r += (b[i] - y[i]) * (b[i] - y[i]) / diagonal[i];
                s += b[i] * b[i] / diagonal[i];
            }
        return std::sqrt(r / s);
    }
    std::vector<double> eigen(const std::vector<double>& b) const {
        std::vector<Eigen::Triplet<double>> triplets;
        for (uint32_t i = 0; i < n(); ++i) {
            triplets.emplace_back(i, i, diagonal[i]);
            for (uint32_t k = offset[i]; k < offset[i + 1]; ++k) triplets.emplace_back(i, column[k], entry[k]);
        }
        Eigen::SparseMatrix<double> a(n(), n());
        a.setFromTriplets(triplets.begin(), triplets.end());
        Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(a);
        EXPECT_EQ(factor.info(), Eigen::Success);
        const Eigen::VectorXd x = factor.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), n()));
        return {x.data(), x.data() + n()};
    }
};

// Triangulated torus of w x h vertices with weights about 1; gauge: random
// signs of the unknowns that leave the matrix an ordinary Laplacian.
inline std::vector<Edge> torus(uint32_t w, uint32_t h, Random& random, bool gauge = true, uint32_t base = 0) {
    std::vector<int> sign(w * h, 1);
    if (gauge)
        for (int& s : sign) s = random.sign();
    std::vector<Edge> edges;
    for (uint32_t y = 0; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            const uint32_t v = y * w + x;
            const uint32_t others[3] = {y * w + (x + 1) % w, (y + 1) % h * w + x, (y + 1) % h * w + (x + 1) % w};
            for (uint32_t o : others) edges.push_back({base + v, base + o, 0.2 + random.uniform(), -sign[v] * sign[o]});
        }
    return edges;
}

// Flips the edges across a vertical segment of the torus: a tripod at each end.
inline void twist(std::vector<Edge>& edges, uint32_t w, uint32_t x, uint32_t from, uint32_t to) {
    for (uint32_t y = from; y < to; ++y)
        for (uint32_t k : {0u, 2u}) edges[3 * (y * w + x) + k].sign *= -1;
}

inline std::vector<Edge> twisted_torus(uint32_t w, uint32_t h, uint32_t pairs, Random& random) {
    std::vector<Edge> edges = torus(w, h, random);
    for (uint32_t p = 0; p < pairs; ++p) {
        const uint32_t x = random.below(w), from = random.below(h / 2), length = 1 + random.below(h / 2);
        twist(edges, w, x, from, from + length);
    }
    return edges;
}

// Rings of w vertices, one after the other, with heavy edges in a ring and light ones from one to the next.
inline std::vector<Edge> rings_of_heavy_edges(uint32_t w, uint32_t rings, double heavy, double light, Random& random) {
    std::vector<int> sign(w * rings);
    for (int& s : sign) s = random.sign();
    std::vector<Edge> edges;
    const auto join = [&](uint32_t u, uint32_t v, double weight) {
        edges.push_back({u, v, weight * (0.5 + random.uniform()), -sign[u] * sign[v]});
    };
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t x = 0; x < w; ++x) {
            join(r * w + x, r * w + (x + 1) % w, heavy);
            if (r + 1 < rings) join(r * w + x, (r + 1) * w + x, light);
        }
    return edges;
}

// A vertex of the first ring is held.
inline System held_rings(uint32_t w, uint32_t rings, double heavy, double light, Random& random) {
    std::vector<bool> fixed(w * rings, false);
    fixed[0] = true;
    return System(w * rings, rings_of_heavy_edges(w, rings, heavy, light, random), fixed);
}

inline std::vector<double> noise(uint32_t n, Random& random) {
    std::vector<double> b(n);
    for (double& v : b) v = 2 * random.uniform() - 1;
    return b;
}

inline void expect_near(const std::vector<double>& x, const std::vector<double>& y, double tolerance) {
    double difference = 0, size = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        difference = std::max(difference, std::abs(x[i] - y[i]));
        size = std::max(size, std::abs(y[i]));
    }
    EXPECT_LE(difference, tolerance * size);
}

// Of one host memory was short for a moment: only the allocation after `left` others fails.
inline void* allocate_but_one(void* user, size_t size) {
    size_t& left = *static_cast<size_t*>(user);
    return left-- == 0 ? nullptr : std::malloc(size);
}
inline void release_any(void*, void* block, size_t) { std::free(block); }

struct Stop {
    int left;
    int32_t answer;
};
inline int32_t stop(void* user, double) {
    Stop& s = *static_cast<Stop*>(user);
    return s.left-- > 0 ? HMF_PROGRESS_CONTINUE : s.answer;
}

} // namespace linear
