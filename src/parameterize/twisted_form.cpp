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
// No other triangle notices: at a closed corner of i one side grows as the
// other shrinks, at an open one both change alike.  So a regular vertex serves
// as the place of one zero; which tripod takes which corner is a matching.
// Where zeros are so dense that corners run out, one is dragged to a vertex
// further away (zero_drag.hpp).
//
// Clusters.  Zero triangles are given to the outside one by one; a graph of zero
// edges is left, across which u goes on as across a leaf.  The zeros of the cluster
// lie where this graph branches, and move along it to the vertices that take them.
//
// At a marked vertex the chart comes back with the opposite sign, as round a
// pole.  A zero that shares its place with one gets a vertex of its own: the
// nearest neighbour moves there, so that both are one cluster, with as many
// vertices as are wanted.
#include "twisted_form.hpp"

#include "../foliation/restriction.hpp"
#include "../mesh/weights.hpp"
#include "zero_drag.hpp"

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

constexpr uint32_t TWISTED_STRIDE = 131072;           // elements between two reports
constexpr uint32_t unseen = NONE, without = NONE - 1; // clusters: not yet; no zero edge

class FormOfFoliation {
public:
    FormOfFoliation(Foliation& f, const double* weight, SignBundle& bundle, TwistedForm& du, Call& call) :
        f_(f), mesh_(f.mesh), weight_(weight), bundle_(bundle), du_(du), call_(call), memory_(call.memory) {}

    hmf_status run() {
        const uint32_t m = mesh_.edge_count, n = mesh_.vertex_count;
        tripod_.start(memory_);
        corner_.start(memory_);
        without_corner_.start(memory_);
        queue_.start(memory_);
        if (mesh_.marked_count > 0 && !part_zeros_from_marks()) return call_.stopped();
        if (!sign_.allocate_filled(memory_, size_t{2} * m, 0) || !owner_.allocate_filled(memory_, n, NONE)
            || !seen_.allocate_filled(memory_, n, NONE) || !bundle_.turn.allocate(memory_, m)
            || !du_.value.allocate(memory_, m))
            return call_.out_of_memory();
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!sign_faces() || !match()) return call_.stopped();
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!call_.pass(m, 0, [&](size_t begin, size_t end) {
                for (size_t e = begin; e < end; ++e) {
                    bundle_.turn[e] = static_cast<int8_t>(-sign_[2 * e] * sign_[2 * e + 1]);
                    du_.value[e] = sign_[2 * e] * f_.value[e];
                }
            }))
            return call_.was_cancelled();
        for (const uint32_t h : corner_)
            if (h != NONE) move_to_branch_point(h);
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!place_zeros_of_clusters() || !turn_zero_edges()) return call_.stopped();
        return without_corner_.empty() ? HMF_OK : drag_zeros();
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
        uint32_t others[Parallel::most_parts] = {};
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
                              else listed = static_cast<bool>(queue_.push(h));
                          });
            if (!listed) return false;
        }
        return give_zero_triangles_to_the_outside();
    }

    // Zero triangles, listed in queue_: as long as one has a side where a neighbor has its signs, it joins that
    // neighbor, in the same chart.  u leaves its other sides as it left that one.
    Done give_zero_triangles_to_the_outside() {
        Array<uint32_t> entered; // sides of zero triangles, with a neighbor that has its signs
        entered.start(memory_);
        for (const uint32_t h : queue_)
            for (const uint32_t x : {h, mesh_.next[h], mesh_.prev(h)})
                if (sign_[twin(x)] != 0 && !entered.push(x)) return false;
        queue_.clear();
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

    // A corner for as many tripods as possible, no vertex twice: the nearest that
    // is free, else along an augmenting path.  The star of the vertex gets an
    // angle of 3 pi: with fewer than six triangles they would be stretched.
    Done match() {
        for (uint32_t t = 0; t < tripod_.size(); ++t) {
            uint32_t h = tripod_[t], best = NONE;
            double least = 0;
            for (uint32_t turn = 0; turn < 3; ++turn, h = mesh_.next[h]) {
                const uint32_t v = mesh_.origin[h];
                if (owner_[v] != NONE || !is_regular(v)) continue;
                const double distance = distance_to_zero(h);
                if (best != NONE && distance >= least) continue;
                best = h;
                least = distance;
            }
            if (best != NONE) take(t, best);
        }
        for (uint32_t t = 0; t < tripod_.size(); ++t)
            if (corner_[t] == NONE && !augment(t)) return false;
        for (size_t t = 0; t < tripod_.size(); ++t) {
            if (corner_[t] != NONE) {
                sign_face(mesh_.next[corner_[t]]);
                continue;
            }
            const uint32_t h = tripod_[t];
            sign_[h] = sign_[mesh_.next[h]] = 1; // as ZeroDrags wants it
            sign_[mesh_.prev(h)] = -1;
            if (!without_corner_.push(h)) return false;
        }
        return true;
    }

    hmf_status drag_zeros() {
        size_t left = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v)
            if (seen_[v] == without) taken_[v] = owner_[v] != NONE || mesh_.is_marked(v) || closed_corners(v) != 2;
        if (!ZeroDrags(mesh_, bundle_, du_, taken_).drag(without_corner_, call_, left)) return call_.stopped();
        if (left == 0) return HMF_OK;
        return call_.fail(
            HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
            "The mesh is too coarse: the number of zeros that find no vertex of their own is %llu. Subdivide it.",
            static_cast<unsigned long long>(left));
    }

    // How far the zero of a tripod is from the regular vertex at its corner, as far as
    // the fluxes tell: in u, and in v from the centre of the tripod to the mean of
    // the centres round the vertex.
    double distance_to_zero(uint32_t corner) const {
        constexpr uint32_t enough = 6;
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
        return std::sqrt(a * a + b * b) * (degree < enough ? 1 << (enough - degree) : 1);
    }

    void take(uint32_t t, uint32_t h) {
        corner_[t] = h;
        owner_[mesh_.origin[h]] = t;
    }

    // A corner for one more tripod, if others can give way.  seen_ holds the tripod that a vertex was reached from.
    Done augment(uint32_t start) {
        queue_.clear();
        Array<uint32_t> reached;
        reached.start(memory_);
        if (!queue_.push(start)) return false;
        uint32_t end = NONE;
        for (size_t i = 0; i < queue_.size() && end == NONE; ++i) {
            uint32_t h = tripod_[queue_[i]];
            for (uint32_t turn = 0; turn < 3 && end == NONE; ++turn, h = mesh_.next[h]) {
                const uint32_t v = mesh_.origin[h];
                if (seen_[v] != NONE || (owner_[v] == NONE && !is_regular(v))) continue;
                seen_[v] = queue_[i];
                if (!reached.push(v)) return false;
                if (owner_[v] == NONE) end = v;
                else if (!queue_.push(owner_[v])) return false;
            }
        }
        // Back along the path: each tripod gives its vertex to the one before.
        while (end != NONE) {
            const uint32_t t = seen_[end], given_up = corner_[t];
            uint32_t h = tripod_[t];
            while (mesh_.origin[h] != end) h = mesh_.next[h];
            const uint32_t before = given_up == NONE ? NONE : mesh_.origin[given_up];
            take(t, h);
            if (t == start) break;
            end = before;
        }
        for (const uint32_t v : reached) seen_[v] = NONE;
        return true;
    }

    // Vertices without mark for all zeros of a cluster with marks.
    Done part_zeros_from_marks() {
        RestrictionScratch scratch;
        if (!scratch.allocate(memory_)) return false;
        for (uint32_t v = 0; v < mesh_.marked_count; ++v)
            for (;;) {
                const Cluster cluster = explore_cluster(f_, v);
                const int64_t plain = static_cast<int64_t>(f_.members.size()) - cluster.marked;
                if (plain + cluster.index() >= 0) break;
                uint32_t nearest = NONE; // half-edge into the cluster
                for (const uint32_t u : f_.members)
                    for (const uint32_t h : mesh_.around(u))
                        if (f_.at(h) > 0 && (nearest == NONE || f_.at(h) < f_.at(nearest))
                            && is_regular(mesh_.target(h)))
                            nearest = twin(h);
                if (nearest == NONE) break;
                if (!move_to_end(f_, nearest, scratch)) return false;
            }
        return true;
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

    // The zeros of a cluster go one by one to the vertices with most closed corners.  Sets odd_ and taken_.
    Done place_zeros_of_clusters() {
        Array<uint8_t> closed;
        if (!closed.allocate(memory_, mesh_.vertex_count) || !odd_.allocate_filled(memory_, mesh_.vertex_count, 0)
            || !taken_.allocate(memory_, mesh_.vertex_count))
            return false;
        const auto look = [&](size_t begin, size_t end) {
            for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
                seen_[v] = has_zero_edge(v) ? unseen : without;
                taken_[v] = mesh_.is_marked(v);
            }
        };
        if (!call_.pass(mesh_.vertex_count, 0, look)) return false;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            if (v % TWISTED_STRIDE == 0 && !call_.tick(0)) return false;
            if (seen_[v] != unseen) continue;
            const int64_t index = explore_cluster(f_, v).index();
            for (const uint32_t u : f_.members) {
                seen_[u] = v;
                closed[u] = closed_corners(u);
                odd_[u] = mesh_.is_marked(u);
            }
            // Where vertices run out two zeros lie on one, which is even then, or one on a marked vertex.
            size_t zeros = index < 0 ? static_cast<size_t>(-index) : 0;
            uint32_t last = v;
            for (; zeros > 0; --zeros) {
                uint32_t best = NONE;
                for (const uint32_t u : f_.members)
                    if (!taken_[u] && (best == NONE || closed[u] > closed[best])) best = u;
                if (best == NONE) break;
                odd_[best] = taken_[best] = 1;
                last = best;
            }
            if (zeros % 2) odd_[last] ^= 1;
        }
        return true;
    }

    // All vertices of a cluster but its zeros shall be even: the turns along a spanning tree of its zero edges see to
    // that.  A change of the turns along a path moves one zero from end to end, which is an isotopy (mathematics, 10).
    Done turn_zero_edges() {
        Array<uint32_t> parent; // half-edge to the parent
        if (!parent.allocate(memory_, mesh_.vertex_count)) return false;
        for (const uint32_t h : without_corner_) odd_[mesh_.target(h)] ^= 1; // until its zero is dragged away
        constexpr uint32_t done = NONE - 2;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            if (v % TWISTED_STRIDE == 0 && !call_.tick(0)) return false;
            if (seen_[v] == without || seen_[v] == done) continue;
            // Breadth first from v; its own parity follows from the others.
            queue_.clear();
            if (!queue_.push(v)) return false;
            seen_[v] = done;
            parent[v] = NONE;
            for (size_t i = 0; i < queue_.size(); ++i) {
                for (const uint32_t h : mesh_.around(queue_[i])) {
                    const uint32_t w = mesh_.target(h);
                    if (f_.at(h) == 0 && seen_[w] != done) {
                        seen_[w] = done;
                        parent[w] = twin(h);
                        if (!queue_.push(w)) return false;
                    }
                }
            }
            for (size_t i = queue_.size(); i-- > 1;) {
                const uint32_t u = queue_[i];
                int8_t turn = 1;
                for (const uint32_t h : mesh_.around(u)) turn = static_cast<int8_t>(turn * bundle_.turn[edge_of(h)]);
                int8_t& of_parent = bundle_.turn[edge_of(parent[u])];
                if ((turn < 0) != (odd_[u] != 0)) of_parent = static_cast<int8_t>(-of_parent);
            }
        }
        return true;
    }

    bool has_zero_edge(uint32_t v) const {
        for (const uint32_t h : mesh_.around(v))
            if (f_.at(h) == 0) return true;
        return false;
    }

    uint8_t closed_corners(uint32_t v) const {
        uint32_t closed = 0;
        for (const uint32_t h : mesh_.around(v))
            closed += f_.at(h) != 0 && f_.at(mesh_.prev(h)) != 0 && f_.corner2(h) == 0;
        return static_cast<uint8_t>(std::min(closed, 255u));
    }

    Foliation& f_;
    const Mesh& mesh_;
    const double* weight_;
    SignBundle& bundle_;
    TwistedForm& du_;
    Call& call_;
    Memory& memory_;
    Array<int8_t> sign_;             // per half-edge: of du in the chart of its face; 0: zero edge
    Array<uint32_t> tripod_;         // a half-edge of each
    Array<uint32_t> corner_;         // per tripod: the half-edge out of the vertex that takes its zero
    Array<uint32_t> owner_;          // per vertex: the tripod whose zero it takes
    Array<uint32_t> without_corner_; // a half-edge of each tripod that has none
    Array<uint8_t> odd_, taken_;     // per vertex of a cluster: the turn round it shall be odd; it has a zero or a mark
    Array<uint32_t> seen_, queue_;
};

} // namespace

hmf_status form_of_foliation(Foliation& f, const double* weight, SignBundle& bundle, TwistedForm& du, Call& call) {
    return FormOfFoliation(f, weight, bundle, du, call).run();
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
