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

// Common divisor of the weights, from fractions with small denominators.
double common_step(const std::vector<double>& weights, bool& exact) {
    exact = true;
    const double smallest = *std::min_element(weights.begin(), weights.end());
    long long denominator = 1;
    for (double weight : weights) {
        const double ratio = weight / smallest;
        long long q = 1;
        while (q <= 24 && std::fabs(ratio * double(q) - std::round(ratio * double(q))) > 1e-9 * ratio * double(q)) ++q;
        if (q > 24) {
            exact = false;
            return smallest;
        }
        denominator = std::lcm(denominator, q);
        if (denominator > 120) {
            exact = false;
            return smallest;
        }
    }
    return smallest / double(denominator);
}

class Transport {
public:
    Transport(const Foliation& foliation, Potential& potential) : f_(foliation), p_(potential) {
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
    double side(uint32_t t, unsigned s) const { return f_.values[f_.triangle_edges[3 * t + s % 3]]; }

    void classify(uint32_t t) {
        const double ab = side(t, 0), bc = side(t, 1), ca = side(t, 2);
        const double longest = std::max({ab, bc, ca});
        if (longest == 0) return;
        const double excess = ab + bc + ca - 2 * longest;
        p_.piece[t] = Piece::linear;
        if (excess > 1e-12 * longest) {
            p_.piece[t] = Piece::tripod;
            p_.u[t] = {(ab + ca - bc) / 2, (ab + bc - ca) / 2, (bc + ca - ab) / 2};
        }
    }

    // Fills the linear triangle t from its value at corner c.  sign: of the
    // step from c to the far corners, or to corner c + 1 if c is the middle.
    void fill(uint32_t t, unsigned c, double value, double sign) {
        const double to_next = side(t, c), to_last = side(t, c + 2), opposite = side(t, c + 1);
        auto& u = p_.u[t];
        u[c] = value;
        u[(c + 1) % 3] = value + sign * to_next;
        const bool between = opposite > to_next && opposite > to_last;
        u[(c + 2) % 3] = value + (between ? -sign : sign) * to_last;
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
        // Neighbours run through their edge in opposite senses.
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
                p_.u[n][k] = start - inside * side(n, k);
            }
        } else {
            fill(n, r, start, end > start ? 1 : -1);
            p_.u[n][(r + 1) % 3] = end;
        }
        // Keeps the numbers small; exact, as is everything else for equal weights.
        const double shift = p_.step * std::round(p_.u[n][0] / p_.step);
        if (p_.exact && std::fabs(shift) > 8 * p_.step)
            for (double& value : p_.u[n]) value -= shift;
        visit(n);
    }

    const Foliation& f_;
    Potential& p_;
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

std::array<double, 2> gradient(const Flat& flat, const std::array<double, 3>& u) {
    if (!(flat.x1 > 0) || !(flat.y2 > 0)) return {0, 0};
    const double gx = (u[1] - u[0]) / flat.x1;
    return {gx, (u[2] - u[0] - gx * flat.x2) / flat.y2};
}

} // namespace

Potential local_potential(const Foliation& foliation) {
    Potential potential;
    potential.step = common_step(foliation.loop_weights, potential.exact);
    Transport(foliation, potential).run();
    return potential;
}

double root_mean_square_gradient(const Foliation& foliation, const Potential& potential) {
    double sum = 0, area_sum = 0;
    for (uint32_t t = 0; t < foliation.triangle_count(); ++t) {
        const Flat flat = lay_out(foliation, t);
        const double area = flat.x1 * flat.y2 / 2;
        area_sum += area;
        if (potential.piece[t] != Piece::linear) continue;
        const auto g = gradient(flat, potential.u[t]);
        sum += area * (g[0] * g[0] + g[1] * g[1]);
    }
    return area_sum > 0 ? std::sqrt(sum / area_sum) : 0;
}

double choose_period(const Foliation& foliation, const Potential& potential, double wanted) {
    if (!(wanted > 0)) return potential.step;
    const double exact = potential.step / std::max(1.0, std::round(potential.step / wanted));
    if (potential.exact && exact > 0.6 * wanted) return exact;
    double best = wanted, least = 1;
    for (int i = 0; i <= 2000; ++i) {
        const double period = wanted * (0.7 + 0.7 * i / 2000);
        double worst = 0;
        for (double weight : foliation.loop_weights)
            worst = std::max(worst, std::fabs(weight / period - std::round(weight / period)));
        if (worst < least) {
            least = worst;
            best = period;
        }
    }
    return best;
}

} // namespace cli
