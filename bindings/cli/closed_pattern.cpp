// Seams form a graph.  Along a chain of it between two nodes the transition (u, v) -> s (u, v) + d is the same; d is
// rounded.  Around a node that is no zero of odd order the transitions must compose to the identity:
//
//            2                   off = d3 + s3 (d2 + s2 d1) = 0: each chain has coefficient +1 or -1, so the chain
//        ____|____               on the way to the root of a spanning tree can mend what rounding did, leaves first.
//       1    o    3              A zero of odd order needs nothing: with s = -1 its own place moves.
//
// What rounding added to d is spread over the surface: a function w with these jumps whose sum of squared differences
// along edges is made small by conjugate gradients; a few dozen steps reach as many edges far.
#include "closed_pattern.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace cli {

namespace {

constexpr uint32_t NONE = 0xffffffffu;
using Pair = std::array<double, 2>;

// x -> sign * x + shift
struct Step {
    double sign = 1;
    Pair shift{0, 0};
};
Step inverse(const Step& a) { return {a.sign, {-a.sign * a.shift[0], -a.sign * a.shift[1]}}; }
Step then(const Step& first, const Step& second) {
    return {second.sign * first.sign,
            {second.sign * first.shift[0] + second.shift[0], second.sign * first.shift[1] + second.shift[1]}};
}

class Closing {
public:
    Closing(const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& edges, const hmf_parameterization& p,
            double period) :
        t_(triangles),
        e_(edges), p_(p), period_(period), sides_(p.edge_count, {NONE, NONE}), around_(p.vertex_count, NONE),
        delta_(p.edge_count) {
        for (uint32_t k = 0; k < e_.size(); ++k) {
            auto& pair = sides_[e_[k]];
            (pair[0] == NONE ? pair[0] : pair[1]) = k;
            around_[t_[k]] = k;
        }
        // On the boundary the walk around a vertex begins at the side with nothing on its right.
        for (uint32_t k = 0; k < e_.size(); ++k)
            if (sides_[e_[k]][1] == NONE) around_[t_[k]] = k;
    }

    std::vector<double> run() {
        if (!find_chains() || !round()) return {};
        spread();
        std::vector<double> uv(p_.corner_uv, p_.corner_uv + 2 * t_.size());
        for (size_t k = 0; k < t_.size(); ++k)
            for (size_t i = 0; i < 2; ++i) uv[2 * k + i] += corner_[k].sign * w_[t_[k]][i] + corner_[k].shift[i];
        return uv;
    }

private:
    // The transition of edge e out of the triangle with side k.
    Step out_of(uint32_t k) const {
        const double* const d = p_.transition + 3 * size_t{e_[k]};
        const Step step{d[0], {d[1], d[2]}};
        return sides_[e_[k]][0] == k ? step : inverse(step);
    }
    uint32_t twin(uint32_t k) const { return sides_[e_[k]][0] == k ? sides_[e_[k]][1] : sides_[e_[k]][0]; }
    static uint32_t next(uint32_t k) { return k % 3 == 2 ? k - 2 : k + 1; }
    static uint32_t last(uint32_t k) { return k % 3 == 0 ? k + 2 : k - 1; }
    bool on_boundary(uint32_t v) const { return around_[v] != NONE && twin(around_[v]) == NONE; }
    // Sides that leave a vertex, counterclockwise: the next one lies behind the third side of the triangle.  NONE: that
    // is on the boundary.
    uint32_t turned(uint32_t k) const { return twin(last(k)); }

    bool is_node(uint32_t v) const { return degree_[v] != 2 || p_.cone[v] != 2 || on_boundary(v); }
    // No condition: a turn around it changes the sign, or there is none.
    bool is_free(uint32_t v) const { return p_.cone[v] % 2 != 0 || on_boundary(v); }

    struct Chain {
        uint32_t begin, end;          // vertices
        Step step;                    // from left to right
        std::array<int64_t, 2> turns; // multiples of the period that replace its shift
    };

    bool find_chains() {
        degree_.assign(p_.vertex_count, 0);
        chain_.assign(p_.edge_count, NONE);
        along_.assign(p_.edge_count, NONE);
        for (uint32_t e = 0; e < p_.edge_count; ++e)
            if (p_.seam[e]) {
                if (sides_[e][1] == NONE) return false;
                ++degree_[t_[sides_[e][0]]];
                ++degree_[t_[next(sides_[e][0])]];
            }
        for (const bool closed : {false, true}) // those without a node last
            for (uint32_t k = 0; k < e_.size(); ++k)
                if (p_.seam[e_[k]] && chain_[e_[k]] == NONE && (closed || is_node(t_[k])) && !follow(k)) return false;
        return true;
    }

    bool follow(uint32_t k) {
        Chain chain{t_[k], 0, out_of(k), {}};
        const uint32_t number = static_cast<uint32_t>(chains_.size());
        for (;;) {
            const Step step = out_of(k);
            if (step.sign != chain.step.sign || step.shift != chain.step.shift) return false;
            chain_[e_[k]] = number;
            along_[e_[k]] = k;
            chain.end = t_[next(k)];
            if (is_node(chain.end) || chain.end == chain.begin) break;
            // The other seam edge there, with the left triangle of it.
            uint32_t out = twin(k);
            do out = turned(out);
            while (!p_.seam[e_[out]]);
            k = out;
        }
        for (size_t i = 0; i < 2; ++i)
            chain.turns[i] = static_cast<int64_t>(std::floor(chain.step.shift[i] / period_ + 0.5));
        chains_.push_back(chain);
        return true;
    }

    // What the rounded transitions around v compose to, in periods, and the coefficient of one chain in it.
    std::array<int64_t, 2> excess(uint32_t v, uint32_t of, int64_t& coefficient) const {
        std::array<int64_t, 2> off{};
        coefficient = 0;
        uint32_t out = around_[v];
        const uint32_t begin = out;
        do {
            // From the triangle right of `out`, which is that of its twin, to the one left of it.
            if (p_.seam[e_[out]]) {
                const Chain& chain = chains_[chain_[e_[out]]];
                const int64_t s = chain.step.sign < 0 ? -1 : 1;
                const bool along = is_along(out);
                // Left to right adds turns; the other way round -s of them.
                const int64_t c = along ? -s : 1;
                for (size_t i = 0; i < 2; ++i) off[i] = s * off[i] + c * chain.turns[i];
                coefficient = s * coefficient + (chain_[e_[out]] == of ? c : 0);
            }
            out = turned(out);
        } while (out != begin); // free vertices are not listed, so none of the boundary is
        return off;
    }

    // Whether side k, on a chain, runs the way of the chain.
    bool is_along(uint32_t k) const { return along_[e_[k]] == k; }

    bool round() {
        // Breadth first from the nodes without condition, then from any.
        std::vector<uint32_t> order, parent(p_.vertex_count, NONE);
        std::vector<uint8_t> seen(p_.vertex_count, 0);
        std::vector<std::vector<uint32_t>> chains_of;
        std::vector<uint32_t> slot(p_.vertex_count, NONE);
        const auto list = [&](uint32_t v) -> std::vector<uint32_t>& {
            if (slot[v] == NONE) {
                slot[v] = static_cast<uint32_t>(chains_of.size());
                chains_of.emplace_back();
            }
            return chains_of[slot[v]];
        };
        for (uint32_t c = 0; c < chains_.size(); ++c) {
            list(chains_[c].begin).push_back(c);
            list(chains_[c].end).push_back(c);
        }
        size_t at = 0;
        const auto search = [&](uint32_t root) {
            if (seen[root]) return;
            seen[root] = 1;
            order.push_back(root);
        };
        const auto grow = [&] {
            for (; at < order.size(); ++at)
                for (const uint32_t c : list(order[at])) {
                    const uint32_t other = chains_[c].begin == order[at] ? chains_[c].end : chains_[c].begin;
                    if (seen[other]) continue;
                    seen[other] = 1;
                    parent[other] = c;
                    order.push_back(other);
                }
        };
        for (const Chain& chain : chains_)
            for (const uint32_t v : {chain.begin, chain.end})
                if (is_free(v)) search(v);
        grow();
        for (const Chain& chain : chains_) {
            search(chain.begin);
            grow();
        }
        int64_t coefficient = 0;
        for (size_t i = order.size(); i-- > 0;) {
            const uint32_t v = order[i];
            if (is_free(v) || parent[v] == NONE) continue;
            const std::array<int64_t, 2> off = excess(v, parent[v], coefficient);
            for (size_t k = 0; k < 2; ++k) chains_[parent[v]].turns[k] -= coefficient * off[k];
        }
        for (const uint32_t v : order)
            if (!is_free(v) && excess(v, NONE, coefficient) != std::array<int64_t, 2>{0, 0}) return false;
        for (uint32_t e = 0; e < p_.edge_count; ++e) {
            delta_[e] = {p_.transition[3 * size_t{e}], {0, 0}};
            if (!p_.seam[e]) continue;
            const Chain& chain = chains_[chain_[e]];
            Step more{chain.step.sign, {}};
            for (size_t i = 0; i < 2; ++i)
                more.shift[i] = static_cast<double>(chain.turns[i]) * period_ - chain.step.shift[i];
            // Of the first triangle of the edge.
            delta_[e] = is_along(sides_[e][0]) ? more : inverse(more);
        }
        return true;
    }

    Step delta_out_of(uint32_t k) const { return sides_[e_[k]][0] == k ? delta_[e_[k]] : inverse(delta_[e_[k]]); }

    void spread() {
        const size_t n = p_.vertex_count;
        corner_.assign(t_.size(), {});
        w_.assign(n, {0, 0});
        std::vector<uint8_t> is_fixed(n, 0);
        for (uint32_t v = 0; v < n; ++v) {
            if (degree_[v] == 0 || around_[v] == NONE) continue;
            Step step;
            uint32_t out = around_[v];
            do {
                corner_[out] = step;
                // Across the third side, into the next triangle.
                if (twin(last(out)) != NONE) step = then(step, delta_out_of(last(out)));
                out = turned(out);
            } while (out != around_[v] && out != NONE);
            if (step.sign > 0 || on_boundary(v)) continue;
            is_fixed[v] = 1;
            w_[v] = {step.shift[0] / 2, step.shift[1] / 2};
        }
        // Steps reach one edge further each: only the vertices so near to a seam.
        constexpr uint32_t STEPS = 60;
        std::vector<uint32_t> near, number(n, NONE);
        const auto take = [&](uint32_t v) {
            if (number[v] != NONE) return;
            number[v] = static_cast<uint32_t>(near.size());
            near.push_back(v);
        };
        for (uint32_t v = 0; v < n; ++v)
            if (degree_[v] > 0 && around_[v] != NONE) take(v);
        for (size_t ring = 0, at = 0; ring < STEPS && at < near.size(); ++ring)
            for (const size_t end = near.size(); at < end; ++at) {
                uint32_t out = around_[near[at]];
                do {
                    take(t_[next(out)]);
                    if (twin(last(out)) == NONE) take(t_[last(out)]);
                    out = turned(out);
                } while (out != around_[near[at]] && out != NONE);
            }
        const size_t m = near.size();
        // Along each edge: w_i - s w_j - b.
        struct Link {
            uint32_t i, j;
            float sign;
            Pair b;
        };
        std::vector<Link> links;
        std::vector<double> count(m, 0);
        for (uint32_t e = 0; e < p_.edge_count; ++e) {
            const uint32_t k = sides_[e][0], l = next(k), i = number[t_[k]], j = number[t_[l]];
            if (i == NONE || j == NONE) continue;
            const Step &a = corner_[k], &b = corner_[l];
            links.push_back({i,
                             j,
                             static_cast<float>(a.sign * b.sign),
                             {a.sign * (b.shift[0] - a.shift[0]), a.sign * (b.shift[1] - a.shift[1])}});
            ++count[i];
            ++count[j];
        }
        std::vector<Pair> w(m), r(m, {0, 0}), d(m, {0, 0}), q(m);
        for (size_t v = 0; v < m; ++v) w[v] = w_[near[v]];
        for (const Link& l : links)
            for (size_t i = 0; i < 2; ++i) {
                const double miss = w[l.i][i] - double(l.sign) * w[l.j][i] - l.b[i];
                r[l.i][i] -= miss;
                r[l.j][i] += double(l.sign) * miss;
            }
        Pair rho{0, 0};
        for (size_t v = 0; v < m; ++v)
            for (size_t i = 0; i < 2; ++i) {
                if (is_fixed[near[v]]) r[v][i] = 0;
                d[v][i] = r[v][i] / std::max(1.0, count[v]);
                rho[i] += r[v][i] * d[v][i];
            }
        const Pair enough{1e-8 * rho[0], 1e-8 * rho[1]};
        for (uint32_t step = 0; step < STEPS && (rho[0] > enough[0] || rho[1] > enough[1]); ++step) {
            q.assign(m, {0, 0});
            for (const Link& l : links)
                for (size_t i = 0; i < 2; ++i) {
                    const double miss = d[l.i][i] - double(l.sign) * d[l.j][i];
                    q[l.i][i] += miss;
                    q[l.j][i] -= double(l.sign) * miss;
                }
            Pair curvature{0, 0}, alpha{0, 0}, beta{0, 0}, fresh{0, 0};
            for (size_t v = 0; v < m; ++v)
                for (size_t i = 0; i < 2; ++i) {
                    if (is_fixed[near[v]]) q[v][i] = 0;
                    curvature[i] += d[v][i] * q[v][i];
                }
            for (size_t i = 0; i < 2; ++i)
                alpha[i] = rho[i] > enough[i] && curvature[i] > 0 ? rho[i] / curvature[i] : 0;
            for (size_t v = 0; v < m; ++v)
                for (size_t i = 0; i < 2; ++i) {
                    w[v][i] += alpha[i] * d[v][i];
                    r[v][i] -= alpha[i] * q[v][i];
                    fresh[i] += r[v][i] * r[v][i] / std::max(1.0, count[v]);
                }
            for (size_t i = 0; i < 2; ++i) beta[i] = rho[i] > 0 ? fresh[i] / rho[i] : 0;
            for (size_t v = 0; v < m; ++v)
                for (size_t i = 0; i < 2; ++i) d[v][i] = r[v][i] / std::max(1.0, count[v]) + beta[i] * d[v][i];
            rho = fresh;
        }
        for (size_t v = 0; v < m; ++v) w_[near[v]] = w[v];
    }

    const std::vector<uint32_t>&t_, &e_;
    const hmf_parameterization& p_;
    double period_;
    std::vector<std::array<uint32_t, 2>> sides_; // of each edge, the triangle with the lower number first
    std::vector<uint32_t> around_;               // a side that leaves each vertex
    std::vector<uint32_t> degree_;               // seam edges at a vertex
    std::vector<uint32_t> chain_, along_;        // of a seam edge: its chain, the side on the left of the chain
    std::vector<Chain> chains_;
    std::vector<Step> delta_;  // what w does across an edge, out of its first triangle
    std::vector<Step> corner_; // w of a corner from w of its vertex
    std::vector<Pair> w_;
};

} // namespace

std::vector<double> closed_pattern(const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& triangle_edges,
                                   const hmf_parameterization& p, double period) {
    return Closing(triangles, triangle_edges, p, period).run();
}

} // namespace cli
