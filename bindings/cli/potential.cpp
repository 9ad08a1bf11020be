// Transports signs and constants of the potential over the dual graph.
//
//        k             F_ij, F_jk, F_ki are distances in a tree.  Regular: one
//       / \            of them is the sum of the others, the corners lie on a
//      /   \           segment, u is linear.  Tripod: none is; all corners lie
//     i-----j          a_i = (F_ij + F_ik - F_jk) / 2 from the branch point.
//
// Branch points are vertices of the tree, so u = 0 there, and all vertices of
// the tree are multiples of the weights apart.  An even function of u with a
// period that divides the weights therefore needs neither the sign nor the
// constant that the transport happened to choose.
#include "potential.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

namespace cli {

namespace {

constexpr uint32_t NO_TRIANGLE = 0xffffffffu;

class Transport {
public:
    Transport(const Foliation& foliation, Potential& potential) :
        f_(foliation), p_(potential), u_(foliation.stripe_values.empty() ? foliation.values : foliation.stripe_values) {
        const size_t count = f_.triangle_count();
        p_.u.assign(count, {0, 0, 0});
        p_.piece.assign(count, Piece::zero);
        direction_.assign(count, 1);
        seen_.assign(count, 0);
        edge_triangles_.assign(f_.values.size(), {NO_TRIANGLE, NO_TRIANGLE});
        for (uint32_t t = 0; t < count; ++t) {
            for (unsigned s = 0; s < 3; ++s) {
                auto& pair = edge_triangles_[f_.triangle_edges[3 * t + s]];
                (pair[0] == NO_TRIANGLE ? pair[0] : pair[1]) = t;
            }
            classify(t);
        }
    }

    void run() {
        for (uint32_t t = 0; t < p_.u.size(); ++t)
            if (p_.piece[t] == Piece::tripod) visit(t);
        std::vector<uint8_t> is_zero(f_.positions.size() / 3, 0);
        for (const hmf_singularity& s : f_.singular)
            if (s.index <= 0 && s.kind != HMF_SINGULAR_TRIANGLE) is_zero[s.element] = 1;
        for (uint32_t t = 0; t < p_.u.size(); ++t)
            for (unsigned c = 0; c < 3; ++c)
                if (is_zero[f_.triangles[3 * t + c]] && !seen_[t]) seed(t, c);
        flood();
        // Genus 1 without zeros and marked vertices: any base will do.
        for (uint32_t t = 0; t < p_.u.size(); ++t)
            if (!seen_[t] && p_.piece[t] == Piece::linear) {
                seed(t, 0);
                flood();
            }
    }

private:
    // The foliation decides what lies where, the values that the stripes follow how far.
    double side(uint32_t t, unsigned s) const { return f_.values[f_.triangle_edges[3 * t + s % 3]]; }
    double step(uint32_t t, unsigned s) const { return u_[f_.triangle_edges[3 * t + s % 3]]; }

    void classify(uint32_t t) {
        const double ab = side(t, 0), bc = side(t, 1), ca = side(t, 2);
        const double longest = std::max({ab, bc, ca});
        if (longest == 0) return;
        const double excess = ab + bc + ca - 2 * longest;
        p_.piece[t] = Piece::linear;
        if (excess > 1e-12 * longest) {
            p_.piece[t] = Piece::tripod;
            const double x = step(t, 0), y = step(t, 1), z = step(t, 2);
            p_.u[t] = {std::max(0.0, x + z - y) / 2, std::max(0.0, x + y - z) / 2, std::max(0.0, y + z - x) / 2};
        }
    }

    // Fills the linear triangle t from its value at corner c.  sign: of the
    // step from c to the far corners, or to corner c + 1 if c is the middle.
    void fill(uint32_t t, unsigned c, double value, double sign) {
        auto& u = p_.u[t];
        u[c] = value;
        u[(c + 1) % 3] = value + sign * step(t, c);
        const bool between = side(t, c + 1) > side(t, c) && side(t, c + 1) > side(t, c + 2);
        u[(c + 2) % 3] = value + (between ? -sign : sign) * step(t, c + 2);
    }

    void visit(uint32_t t) {
        seen_[t] = 1;
        ready_.push_back(t);
    }

    void seed(uint32_t t, unsigned c) {
        fill(t, c, 0, 1);
        visit(t);
    }

    // Crossings of edges with F > 0 carry the sign; those of zero edges only
    // assume that the leaf separates two opposite directions, so they wait.
    void flood() {
        while (!ready_.empty() || !waiting_.empty()) {
            const bool certain = !ready_.empty();
            std::deque<uint32_t>& queue = certain ? ready_ : waiting_;
            const uint32_t t = queue.front();
            queue.pop_front();
            bool zero_edges = false;
            for (unsigned s = 0; s < 3; ++s) {
                const auto& pair = edge_triangles_[f_.triangle_edges[3 * t + s]];
                const uint32_t n = pair[0] == t ? pair[1] : pair[0];
                if (n == NO_TRIANGLE || seen_[n]) continue;
                const bool zero = side(t, s) == 0;
                if (zero == certain) {
                    zero_edges = zero_edges || zero;
                    continue;
                }
                cross(t, s, n);
            }
            if (zero_edges) waiting_.push_back(t);
        }
    }

    void cross(uint32_t t, unsigned s, uint32_t n) {
        const uint32_t edge = f_.triangle_edges[3 * t + s];
        unsigned r = 0;
        while (r < 2 && f_.triangle_edges[3 * n + r] != edge) ++r;
        // Neighbors run through their edge in opposite senses.
        double start = p_.u[t][(s + 1) % 3], end = p_.u[t][s];
        if (p_.piece[t] == Piece::tripod) start = -start;
        if (side(t, s) == 0) {
            double inside = direction_[t];
            if (p_.piece[t] == Piece::linear) inside = p_.u[t][(s + 2) % 3] > end ? 1 : -1;
            if (p_.piece[n] == Piece::zero) {
                p_.u[n] = {start, start, start};
                direction_[n] = inside;
            } else {
                const unsigned k = (r + 2) % 3;
                p_.u[n][r] = p_.u[n][(r + 1) % 3] = start;
                p_.u[n][k] = start - inside * step(n, k);
            }
        } else {
            fill(n, r, start, end > start ? 1 : -1);
            p_.u[n][(r + 1) % 3] = end;
        }
        // Keeps the numbers small.
        const double shift = p_.period * std::floor(p_.u[n][0] / p_.period);
        if (std::fabs(shift) > 64 * p_.period)
            for (double& value : p_.u[n]) value -= shift;
        visit(n);
    }

    const Foliation& f_;
    Potential& p_;
    const std::vector<double>& u_;
    std::vector<std::array<uint32_t, 2>> edge_triangles_;
    std::vector<double> direction_; // of zero triangles: where the transport came from
    std::vector<uint8_t> seen_;
    std::deque<uint32_t> ready_, waiting_;
};

// A triangle laid out in the plane, corner 0 at the origin, corner 1 on the x-axis.
struct Flat {
    double x1, x2, y2;
};

Flat lay_out(const Foliation& f, uint32_t t) {
    double d1[3], d2[3], d11 = 0, d12 = 0, d22 = 0;
    for (unsigned a = 0; a < 3; ++a) {
        const double origin = f.positions[3 * size_t(f.triangles[3 * t]) + a];
        d1[a] = f.positions[3 * size_t(f.triangles[3 * t + 1]) + a] - origin;
        d2[a] = f.positions[3 * size_t(f.triangles[3 * t + 2]) + a] - origin;
        d11 += d1[a] * d1[a];
        d12 += d1[a] * d2[a];
        d22 += d2[a] * d2[a];
    }
    const double x1 = std::sqrt(d11), x2 = x1 > 0 ? d12 / x1 : 0;
    return {x1, x2, std::sqrt(std::max(0.0, d22 - x2 * x2))};
}

} // namespace

Potential local_potential(const Foliation& foliation, double period) {
    Potential potential;
    potential.period = period;
    Transport(foliation, potential).run();
    return potential;
}

double wanted_period(const Foliation& f) {
    constexpr double STRIPES_ACROSS = 44; // pairs of light and dark, where the gradient is average
    double low[3] = {}, high[3] = {};
    for (size_t i = 0; i < f.positions.size(); ++i) {
        const double x = f.positions[i];
        low[i % 3] = i < 3 ? x : std::min(low[i % 3], x);
        high[i % 3] = i < 3 ? x : std::max(high[i % 3], x);
    }
    double size = 0;
    for (int a = 0; a < 3; ++a) size += (high[a] - low[a]) * (high[a] - low[a]);
    double sum = 0, area_sum = 0;
    for (uint32_t t = 0; t < f.triangle_count(); ++t) {
        const Flat flat = lay_out(f, t);
        const double area = flat.x1 * flat.y2 / 2;
        area_sum += area;
        const double ab = f.values[f.triangle_edges[3 * t]], bc = f.values[f.triangle_edges[3 * t + 1]],
                     ca = f.values[f.triangle_edges[3 * t + 2]];
        if (!(flat.x1 > 0) || !(flat.y2 > 0)) continue;
        // u at the corners 1 and 2, if it is 0 at corner 0.
        const double u1 = ab, u2 = bc >= ab && bc >= ca ? -ca : ca;
        const double x = u1 / flat.x1, y = (u2 - x * flat.x2) / flat.y2;
        sum += area * (x * x + y * y);
    }
    const double period = area_sum > 0 ? std::sqrt(size * sum / area_sum) / STRIPES_ACROSS : 0;
    return period > 0 ? period : 1;
}

double common_period(const std::vector<double>& weights, double wanted) {
    const double smallest = *std::min_element(weights.begin(), weights.end());
    // Common divisor of the weights, from fractions with small denominators.
    long long denominator = 1;
    for (double weight : weights) {
        const double ratio = weight / smallest;
        long long q = 1;
        while (q <= 24 && std::fabs(ratio * double(q) - std::round(ratio * double(q))) > 1e-9 * ratio * double(q)) ++q;
        if (q > 24) return 0;
        denominator = std::lcm(denominator, q);
        if (denominator > 120) return 0;
    }
    const double step = smallest / double(denominator), period = step / std::max(1.0, std::round(step / wanted));
    return period > 0.6 * wanted && period < 1.6 * wanted ? period : 0;
}

} // namespace cli
