// From the exact foliation to the twisted form du: charts of the faces, the
// turn of each edge, and the zeros moved from triangles to vertices.
//
// A tripod (i, j, k), F_ij + F_ik - F_jk = 2 a_i > 0, becomes regular when i
// moves to the branch point: F -= a_i on the sector of i that holds j and k,
// F += a_i on its other edges.
//
//        k                                k
//         \                                \ .
//          +---- i        ->                i        jk = ji + ik
//         /                                /
//        j                                j
//
// No other triangle changes its kind: at a closed corner of i one side grows as the other shrinks, at an open one both
// change equally. So a regular vertex can be the place of one zero.
//
// Signs.  With a sign for each side every face has one corner between two equal
// signs, its middle one.  Zero triangles are joined to the outside one by one; a graph of zero edges remains, across
// which u continues as across a leaf:
//
//           - +                              turn = - sign(h) * sign(twin h)
//     ----*-----*----                        order of a vertex = middle corners - 2
//           - +
//
// An end of that graph with order -1 is a limb, across whose edge u turns back.
// Where the turn is even at a zero or a mark, one zero more than the turn can hold
// is there: it is dragged to a vertex nearby, like zeros that have no free corner (move_zero_to_vertex.hpp).
#include "twisted_form.hpp"

#include "../../core/mesh/weights.hpp"
#include "move_zero_to_vertex.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

Done VertexCharts::build(const Mesh& mesh, const SignBundle& bundle, Call& call) {
    if (!stars.build(mesh, call) || !chart.allocate(call.memory, size_t{2} * mesh.edge_count)
        || !odd.allocate(call.memory, mesh.vertex_count))
        return false;
    return call.pass(mesh.vertex_count, 0, [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
            int8_t c = 1;
            const Stars::Star star = stars.of(v);
            for (uint32_t t = 0; t < star.size(); ++t) {
                chart[star[t]] = c;
                c = static_cast<int8_t>(c * bundle.turn[edge_of(star.after(t))]);
            }
            odd[v] = c < 0;
        }
    });
}

namespace {

constexpr uint32_t TWISTED_STRIDE = 131072; // elements between two reports
constexpr int32_t PRUNED = INT32_MIN;       // order of a vertex of a limb: 0

class FormOfFoliation {
public:
    FormOfFoliation(const Foliation& f, const double* weight, double energy, CornerChoice choice, SignBundle& bundle,
                    TwistedForm& du, MovedZeros& moved, Call& call) :
        f_(f),
        mesh_(f.mesh), weight_(weight), energy_(energy), choice_(choice), bundle_(bundle), du_(du), moved_(moved),
        call_(call), memory_(call.memory) {}

    hmf_status run() {
        const uint32_t m = mesh_.edge_count, n = mesh_.vertex_count;
        tripod_.start(memory_);
        corner_.start(memory_);
        without_corner_.start(memory_);
        zero_triangle_.start(memory_);
        moved_.crossed.start(memory_);
        if (!sign_.allocate_filled(memory_, size_t{2} * m, 0) || !taken_.allocate_filled(memory_, n, uint8_t{0})
            || !order_.allocate(memory_, n) || !moved_.untouched.allocate(memory_, n)
            || !bundle_.turn.allocate(memory_, m) || !du_.value.allocate(memory_, m))
            return call_.out_of_memory();
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!sign_faces() || !give_zero_triangles_to_the_outside() || !assign_corners()) return call_.stopped();
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!call_.pass(m, 0, [&](size_t begin, size_t end) {
                for (size_t e = begin; e < end; ++e) {
                    bundle_.turn[e] = static_cast<int8_t>(-sign_[2 * e] * sign_[2 * e + 1]);
                    du_.value[e] = sign_[2 * e] * f_.value[e];
                }
            }))
            return call_.was_cancelled();
        for (const uint32_t h : corner_) {
            if (h == NONE) continue;
            if (!moved_.crossed.push(h)) return call_.out_of_memory();
            move_to_branch_point(h);
        }
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!count_orders()) return call_.stopped();
        if (const hmf_status status = drag_zeros()) return status;
        tripod_.swap(moved_.zeros.tripods);
        return HMF_OK;
    }

private:
    // Signs in a face whose longest side is h: h is the sum of the two others.  A zero side gets the sign of u of the
    // corner opposite to it.
    void sign_face(uint32_t h) {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        sign_[h] = 1;
        sign_[n] = -1;
        sign_[p] = static_cast<int8_t>(f_.at(p) ? -1 : 1);
    }

    // False: a tripod, or a zero triangle.
    bool sign_regular_face(uint32_t h, uint32_t n, uint32_t p) {
        const uint32_t side[3] = {h, n, p};
        for (const uint32_t x : side) {
            // The corner opposite to x is closed.
            if (f_.at(x) == 0 || f_.corner2(mesh_.prev(x)) != 0) continue;
            sign_face(x);
            return true;
        }
        return false;
    }

    Done sign_faces() {
        const size_t sides = size_t{2} * mesh_.edge_count, block = Parallel::pass_block(sides);
        uint32_t others[Parallel::MOST_PARTS] = {};
        const auto sign = [&](size_t begin, size_t end) {
            uint32_t found = 0;
            for_each_face(mesh_, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                          [&](uint32_t h, uint32_t n, uint32_t p) { found += !sign_regular_face(h, n, p); });
            others[begin / block] = found;
        };
        if (!call_.pass(sides, 0, sign)) return false;
        // They are few: the blocks that have some are read again.
        for (size_t begin = 0; begin < sides; begin += block) {
            if (others[begin / block] == 0) continue;
            bool listed = true;
            for_each_face(mesh_, static_cast<uint32_t>(begin), static_cast<uint32_t>(std::min(begin + block, sides)),
                          [&](uint32_t h, uint32_t n, uint32_t p) {
                              if (!listed || sign_regular_face(h, n, p)) return;
                              if (f_.at(h) != 0) listed = static_cast<bool>(tripod_.push(h) && corner_.push(NONE));
                              else listed = static_cast<bool>(zero_triangle_.push(h));
                          });
            if (!listed) return false;
        }
        return true;
    }

    // As long as a zero triangle has a side where its neighbor has signs, it joins this neighbor, in the
    // same chart.  u leaves its two other sides as it left that one.
    Done give_zero_triangles_to_the_outside() {
        Array<uint32_t> entered; // sides of zero triangles, with a neighbor that has its signs
        entered.start(memory_);
        for (const uint32_t h : zero_triangle_)
            for (const uint32_t x : {h, mesh_.next[h], mesh_.prev(h)})
                if (sign_[twin(x)] != 0 && !entered.push(x)) return false;
        for (size_t i = 0; i < entered.size(); ++i) {
            const uint32_t h = entered[i], n = mesh_.next[h], p = mesh_.next[n];
            if (sign_[h] != 0) continue;
            sign_[n] = sign_[p] = sign_[twin(h)];
            sign_[h] = static_cast<int8_t>(-sign_[twin(h)]);
            for (const uint32_t x : {twin(n), twin(p)})
                if (sign_[x] == 0 && !entered.push(x)) return false;
        }
        return true;
    }

    // A vertex without zero edges and with two directions.
    bool is_regular(uint32_t v) const {
        uint32_t closed = 0;
        for (const uint32_t h : mesh_.around(v)) {
            if (f_.at(h) == 0 || mesh_.target(h) == v) return false;
            closed += f_.corner2(h) == 0 && f_.at(mesh_.prev(h)) != 0;
        }
        return closed == 2 && !mesh_.is_marked(v);
    }

    // The nearest of the corners of a tripod that are regular and serve no other one. Corners that are too far away are
    // left out: a zero next to a narrow part of the surface may have corners at its other end.
    Done assign_corners() {
        if (tripod_.empty()) return true;
        constexpr double share = 0.01, ratio = 4;
        for (uint32_t t = 0; t < tripod_.size(); ++t) {
            uint32_t h = tripod_[t], best = NONE;
            double least = 0, cheapest = HUGE_VAL;
            for (uint32_t k = 0; k < 3; ++k, h = mesh_.next[h]) cheapest = std::min(cheapest, cost(h));
            for (uint32_t k = 0; k < 3; ++k, h = mesh_.next[h]) {
                const uint32_t v = mesh_.origin[h];
                if (taken_[v] || !is_regular(v) || cost(h) > std::max(share * energy_, ratio * cheapest)) continue;
                if (choice_ == CornerChoice::keeps_class && !keeps_class(h)) continue;
                const double distance = distance_to_zero(h);
                if (best != NONE && distance >= least) continue;
                best = h;
                least = distance;
            }
            corner_[t] = best;
            if (best != NONE) {
                taken_[mesh_.origin[best]] = 1;
                sign_face(mesh_.next[best]);
                continue;
            }
            h = tripod_[t];
            sign_[h] = sign_[mesh_.next[h]] = 1; // in the form of ZeroMoves
            sign_[mesh_.prev(h)] = -1;
            if (!without_corner_.push(h)) return false;
        }
        return true;
    }

    // The origin of a corner can move to the branch point and keep the class: it passes no other image on the way.
    bool keeps_class(uint32_t corner) const {
        const int64_t twice = f_.corner2(corner);
        bool inside = true; // of the sector of the tripod
        for (const uint32_t h : mesh_.around_from(corner)) {
            const int64_t ahead = f_.corner2(h);
            if (inside && (2 * f_.at(h) < twice || (h != corner && ahead != 0 && ahead < twice))) return false;
            if (ahead == 0) inside = !inside;
        }
        return true;
    }

    // What the energy changes by, at most, if the origin of a half-edge moves to the branch point.
    double cost(uint32_t corner) const {
        const double a = 0.5 * static_cast<double>(f_.corner2(corner));
        double sum = 0;
        for (const uint32_t h : mesh_.around_from(corner)) sum += weight_[edge_of(h)];
        return sum * a * a;
    }

    // Where there is a zero or a mark the turn has to be odd, for u is held there, unless du is coclosed.  Where it is
    // even one zero goes to a vertex of order 0, as those do that found no corner.
    hmf_status drag_zeros() {
        Array<uint32_t> even;
        even.start(memory_);
        moved_.zeros.vertices.start(memory_);
        size_t places = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            if (v % TWISTED_STRIDE == 0 && !call_.tick(0)) return call_.was_cancelled();
            taken_[v] = mesh_.is_marked(v) || (order_[v] != 0 && order_[v] != PRUNED);
            places += !taken_[v];
            if (order_[v] != 0 && !moved_.zeros.vertices.push(v)) return call_.stopped();
            if (taken_[v] && order_[v] % 2 == 0 && !is_coclosed(v) && !even.push(v)) return call_.stopped();
        }
        const size_t zeros = without_corner_.size() + even.size();
        size_t left = zeros;
        if (zeros <= places
            && !ZeroMoves(mesh_, weight_, bundle_, du_, taken_, &moved_).move(without_corner_, even, call_, left))
            return call_.stopped();
        if (left == 0) return HMF_OK;
        return call_.fail(
            HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
            "The mesh is too coarse: the number of zeros that find no vertex of their own is %llu. Subdivide it.",
            static_cast<unsigned long long>(left));
    }

    // Distance of the zero of a tripod from the regular vertex at its corner, from the fluxes: in u, and in v from the
    // center of the tripod to the mean of the centers around the vertex.
    double distance_to_zero(uint32_t corner) const {
        const double a = 0.5 * static_cast<double>(f_.corner2(corner));
        double V = 0, sum = 0;
        uint32_t degree = 0;
        int8_t s = 1;
        for (const uint32_t h : mesh_.around_from(corner)) {
            sum += V;
            ++degree;
            if (f_.corner2(h) == 0) s = static_cast<int8_t>(-s);
            const uint32_t ahead = mesh_.rotate_ccw(h);
            V += s * weight_[edge_of(ahead)] * static_cast<double>(f_.at(ahead));
        }
        const double b = sum / degree;
        // Its star gets an angle of 3 pi: with fewer than six triangles they would be stretched.
        constexpr uint32_t enough = 6;
        return std::sqrt(a * a + b * b) * (degree < enough ? 1 << (enough - degree) : 1);
    }

    // corner: its origin is the regular vertex that moves.
    void move_to_branch_point(uint32_t corner) {
        const int64_t a = f_.corner2(corner) / 2;
        int8_t s = 1;
        for (const uint32_t h : mesh_.around_from(corner)) {
            // F of h falls by s * a.
            du_.value[edge_of(h)] -= sign_[2 * edge_of(h)] * s * a;
            if (f_.corner2(h) == 0) s = static_cast<int8_t>(-s);
        }
    }

    // The fluxes at a vertex with an even turn cancel: u is harmonic there without being held.
    bool is_coclosed(uint32_t v) const {
        constexpr double rounding = 1e-6;
        double divergence = 0, pull = 0;
        int8_t chart = 1;
        for (const uint32_t h : mesh_.around(v)) {
            const double flux = weight_[edge_of(h)] * static_cast<double>(chart * du_.at(bundle_, h));
            divergence += flux;
            pull += std::fabs(flux);
            chart = static_cast<int8_t>(chart * bundle_.turn[edge_of(mesh_.prev(h))]);
        }
        return std::fabs(divergence) <= rounding * pull;
    }

    bool is_middle(uint32_t h) const { return sign_[h] == sign_[mesh_.prev(h)]; }

    // Middle corners at each vertex, without those of tripods whose zero is to be dragged; then the limbs.
    Done count_orders() {
        if (!call_.pass(mesh_.vertex_count, 0, [&](size_t begin, size_t end) {
                for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
                    int32_t middle = 0;
                    for (const uint32_t h : mesh_.around(v)) middle += is_middle(h);
                    order_[v] = middle - 2;
                    moved_.untouched[v] = middle == 2 && !mesh_.is_marked(v);
                }
            }))
            return false;
        for (const uint32_t h : without_corner_) --order_[mesh_.target(h)];
        for (const uint32_t h : corner_)
            for (uint32_t out = h; out != NONE; out = mesh_.rotate_ccw(out) == h ? NONE : mesh_.rotate_ccw(out))
                moved_.untouched[mesh_.target(out)] = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            if (v % TWISTED_STRIDE == 0 && !call_.tick(0)) return false;
            prune(v);
        }
        return true;
    }

    // A zero triangle has another sign at the side by which it joined a neighbor.
    bool is_entry(uint32_t h) const {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        return f_.at(n) == 0 && f_.at(p) == 0 && f_.at(h) == 0 && sign_[n] == sign_[p];
    }

    // From the end of a limb on: u turns back across its edge, and the next vertex has one prong less.
    void prune(uint32_t v) {
        while (order_[v] == -1 && !mesh_.is_marked(v)) {
            uint32_t limb = NONE;
            for (const uint32_t h : mesh_.around(v))
                if (f_.at(h) == 0 && !is_entry(h) && !is_entry(twin(h)) && order_[mesh_.target(h)] != PRUNED) limb = h;
            if (limb == NONE) return; // a pole: the foliation has none
            order_[v] = PRUNED;
            bundle_.turn[edge_of(limb)] = static_cast<int8_t>(-bundle_.turn[edge_of(limb)]);
            v = mesh_.target(limb);
            --order_[v];
        }
    }

    const Foliation& f_;
    const Mesh& mesh_;
    const double* weight_;
    const double energy_;
    const CornerChoice choice_;
    SignBundle& bundle_;
    TwistedForm& du_;
    MovedZeros& moved_;
    Call& call_;
    Memory& memory_;
    Array<int8_t> sign_;             // per half-edge: of du in the chart of its face
    Array<uint32_t> tripod_;         // a half-edge of each
    Array<uint32_t> corner_;         // per tripod: the half-edge out of the vertex that takes its zero
    Array<uint32_t> without_corner_; // a half-edge of each tripod that has none
    Array<uint32_t> zero_triangle_;  // a half-edge of each
    Array<uint8_t> taken_;           // per vertex: a zero has come, or none may
    Array<int32_t> order_;           // per vertex
};

} // namespace

hmf_status form_of_foliation(const Foliation& f, const double* weight, double energy, CornerChoice choice,
                             SignBundle& bundle, TwistedForm& du, MovedZeros& moved, Call& call) {
    return FormOfFoliation(f, weight, energy, choice, bundle, du, moved, call).run();
}

ImageSum sum_image(const Mesh& mesh, const SignBundle& bundle, const TwistedForm& du, const TwistedForm& dv,
                   const Parallel& parallel) {
    return parallel.sum_blocks<ImageSum>(size_t{2} * mesh.edge_count, [&](size_t begin, size_t end) {
        ImageSum sum;
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t h, uint32_t n, uint32_t p) {
                          const int64_t u[2] = {du.at(bundle, h), du.at(bundle, n)};
                          const int64_t v[2] = {dv.at(bundle, h), dv.at(bundle, n)};
                          sum.open += u[0] + u[1] + du.at(bundle, p) != 0 || v[0] + v[1] + dv.at(bundle, p) != 0;
                          const double area = 0.5
                                            * (static_cast<double>(u[0]) * static_cast<double>(v[1])
                                               - static_cast<double>(u[1]) * static_cast<double>(v[0]));
                          sum.area += area;
                          sum.absolute_area += std::fabs(area);
                      });
        return sum;
    });
}

//          k                     k          Half-edges jk and il change their
//        / ^ \                 / A \        face, A = face(h), B = face(twin h):
//       i A|B j       ->      i--h->j       their values go to the chart of the
//        \ h /                 \ B /        new one.  The flipped edge is the
//          l                     l          sum of two others, the form is closed.
void unflip_forms(uint32_t* next, uint32_t edge, SignBundle& bundle, TwistedForm& du, TwistedForm& dv) {
    const uint32_t h = 2 * edge, il = next[next[h]], jk = next[next[twin(h)]];
    unflip_sides(next, edge);
    if (bundle.turn[edge] < 0) {
        const uint32_t changed[2] = {jk, il};
        for (const uint32_t moved : changed) {
            const uint32_t e = edge_of(moved);
            bundle.turn[e] = static_cast<int8_t>(-bundle.turn[e]);
            if (moved & 1) continue; // stored in the chart of the other face
            du.value[e] = -du.value[e];
            dv.value[e] = -dv.value[e];
        }
    }
    const uint32_t ki = next[next[h]];
    du.value[edge] = -(du.at(bundle, jk) + du.at(bundle, ki));
    dv.value[edge] = -(dv.at(bundle, jk) + dv.at(bundle, ki));
}

} // namespace hmf
