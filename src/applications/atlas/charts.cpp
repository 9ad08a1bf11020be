#include "charts.hpp"

#include "../../core/base/heap_sort.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

void Box::add(const Box& other) {
    u0 = std::min(u0, other.u0);
    v0 = std::min(v0, other.v0);
    u1 = std::max(u1, other.u1);
    v1 = std::max(v1, other.v1);
}

namespace {

// Adds up neighbors in a sorted list that differ only in the summed value.
template <class T, class Same, class Add>
void merge_same(Array<T>& list, Same same, Add add) {
    size_t kept = 0;
    for (const T& x : list) {
        if (kept > 0 && same(list[kept - 1], x)) add(list[kept - 1], x);
        else list[kept++] = x;
    }
    while (list.size() > kept) list.pop();
}

} // namespace

hmf_status Charts::start(const Mesh& mesh, const SignBundle& bundle, const Strips& strips, double triangle,
                         Call& call) {
    triangle_ = triangle;
    const uint32_t n = strips.piece_count();
    if (!box.allocate(call.memory, n) || !of_piece.allocate(call.memory, n) || !motion.allocate(call.memory, n)
        || !first_.allocate(call.memory, n) || !next_.allocate(call.memory, n) || !chart_box_.allocate(call.memory, n))
        return call.out_of_memory();
    contacts_.start(call.memory);
    candidates_.start(call.memory);
    find_boxes(strips);
    return find_contacts(mesh, bundle, strips, call);
}

void Charts::find_boxes(const Strips& strips) {
    for (size_t c = 0; c + 1 < strips.list.size(); ++c) {
        const Strip& strip = strips.list[c];
        const uint32_t begin = strip.first_piece, end = strips.list[c + 1].first_piece;
        for (uint32_t p = begin; p < end; ++p) {
            const int64_t to = p + 1 < end ? strips.cuts[p + 1] : strips.cuts[begin] + strip.length;
            box[p] = {static_cast<double>(strip.low), static_cast<double>(strips.cuts[p]),
                      static_cast<double>(strip.high), static_cast<double>(to)};
        }
    }
}

hmf_status Charts::find_contacts(const Mesh& mesh, const SignBundle& bundle, const Strips& strips, Call& call) {
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % 65536 == 0 && !call.tick(0.87)) return call.was_cancelled();
        uint32_t h = 2 * e, t = 2 * e + 1;
        uint32_t p = strips.piece[mesh.face[h]], q = strips.piece[mesh.face[t]];
        if (p == q || p == NONE || q == NONE) continue;
        if (p > q) std::swap(p, q), std::swap(h, t);
        const int64_t sign = strips.sign[mesh.face[h]] * strips.sign[mesh.face[t]] * bundle.turn[e];
        const uint32_t n_h = mesh.next[h], n_t = mesh.next[t];
        const Motion m{sign, strips.u[h] - sign * strips.u[n_t], strips.v[h] - sign * strips.v[n_t]};
        if (!contacts_.push({p, q, m, strips.u[n_h] - strips.u[h], strips.v[n_h] - strips.v[h]}))
            return call.out_of_memory();
    }
    if (!call.tick(0.87)) return call.was_cancelled();
    heap_sort(contacts_.data(), contacts_.size(), [](const Contact& a, const Contact& b) {
        return a.p != b.p ? a.p < b.p : a.q != b.q ? a.q < b.q : a.motion < b.motion;
    });
    merge_same(
        contacts_, [](const Contact& a, const Contact& b) { return a.p == b.p && a.q == b.q && a.motion == b.motion; },
        [](Contact& sum, const Contact& c) {
            sum.u += c.u;
            sum.v += c.v;
        });
    return HMF_OK;
}

Box Charts::moved(const Box& b, const Motion& m) {
    const double s = static_cast<double>(m.sign), u = static_cast<double>(m.u), v = static_cast<double>(m.v);
    return m.sign > 0 ? Box{b.u0 + u, b.v0 + v, b.u1 + u, b.v1 + v}
                      : Box{s * b.u1 + u, s * b.v1 + v, s * b.u0 + u, s * b.v0 + v};
}

// The length along which two pieces are joined in this way.
double Charts::glued(uint32_t p, uint32_t q, const Motion& q_to_p, bool along_v) const {
    if (p > q) return glued(q, p, q_to_p.inverse(), along_v);
    const Contact* at = std::partition_point(contacts_.begin(), contacts_.end(),
                                             [=](const Contact& c) { return c.p < p || (c.p == p && c.q < q); });
    for (; at != contacts_.end() && at->p == p && at->q == q; ++at)
        if (at->motion == q_to_p) return std::fabs(static_cast<double>(along_v ? at->v : at->u));
    return 0;
}

// The area of a box in the chart a that pieces of both charts cover.
double Charts::covered(const Candidate& c, const Box& slot) const {
    double sum = 0;
    for (int which = 0; which < 2; ++which)
        for (uint32_t p = first_[which ? c.b : c.a]; p != NONE; p = next_[p]) {
            const Box b = box_in_chart(p, which ? c.motion.after(motion[p]) : motion[p]);
            const double u = std::min(b.u1, slot.u1) - std::max(b.u0, slot.u0),
                         v = std::min(b.v1, slot.v1) - std::max(b.v0, slot.v0);
            if (u > 0 && v > 0) sum += u * v;
        }
    return sum;
}

// No two pieces overlap, and where they touch they are joined.
bool Charts::fits(const Candidate& c) const {
    const double near = triangle_ / 4;
    for (uint32_t p = first_[c.a]; p != NONE; p = next_[p]) {
        const Box a = box_in_chart(p, motion[p]);
        for (uint32_t q = first_[c.b]; q != NONE; q = next_[q]) {
            const Motion to_a = c.motion.after(motion[q]);
            const Box b = box_in_chart(q, to_a);
            const double gap_u = std::max(a.u0, b.u0) - std::min(a.u1, b.u1),
                         gap_v = std::max(a.v0, b.v0) - std::min(a.v1, b.v1);
            const double wide = 2.5 * triangle_;
            if (gap_u > wide || gap_v > wide || (gap_u > -near && gap_v > -near)) continue;
            if (gap_u > near || gap_v > near) {
                // Between them a third one, or a slot that is too narrow.
                const bool in_u = gap_u > near;
                const Box slot =
                    in_u ? Box{std::min(a.u1, b.u1), std::max(a.v0, b.v0), std::max(a.u0, b.u0), std::min(a.v1, b.v1)}
                         : Box{std::max(a.u0, b.u0), std::min(a.v1, b.v1), std::min(a.u1, b.u1), std::max(a.v0, b.v0)};
                if ((in_u ? -gap_v : -gap_u) > 3 * triangle_ && covered(c, slot) < 0.5 * slot.area()) return false;
                continue;
            }
            if (gap_u < -near && gap_v < -near) return false;
            const bool along_v = gap_u >= -near;
            const double touch = along_v ? -gap_v : -gap_u;
            if (touch - glued(p, q, motion[p].inverse().after(to_a), along_v) > 2 * triangle_) return false;
        }
    }
    return true;
}

// Each piece is a chart.  The area of all boxes.
double Charts::start_with_pieces() {
    double whole = 0;
    for (uint32_t p = 0; p < box.size(); ++p) {
        of_piece[p] = first_[p] = p;
        next_[p] = NONE;
        motion[p] = {};
        chart_box_[p] = box[p];
        whole += box[p].area();
    }
    return whole;
}

// The ways in which two charts can be joined, each with the length along which they meet.
Done Charts::list_candidates() {
    candidates_.clear();
    for (const Contact& c : contacts_) {
        Candidate found{of_piece[c.p], of_piece[c.q], motion[c.p].after(c.motion).after(motion[c.q].inverse()),
                        std::sqrt(static_cast<double>(c.u) * static_cast<double>(c.u)
                                  + static_cast<double>(c.v) * static_cast<double>(c.v)),
                        0};
        if (found.a == found.b) continue;
        if (found.a > found.b) std::swap(found.a, found.b), found.motion = found.motion.inverse();
        if (!candidates_.push(found)) return false;
    }
    heap_sort(candidates_.data(), candidates_.size(), [](const Candidate& a, const Candidate& b) {
        return a.a != b.a              ? a.a < b.a
             : a.b != b.b              ? a.b < b.b
             : !(a.motion == b.motion) ? a.motion < b.motion
                                       : a.gain < b.gain;
    });
    merge_same(
        candidates_,
        [](const Candidate& a, const Candidate& b) { return a.a == b.a && a.b == b.b && a.motion == b.motion; },
        [](Candidate& sum, const Candidate& c) { sum.gain += c.gain; });
    return true;
}

// Joins that save more seam than they waste space, best first.
void Charts::keep_worthwhile(const JoinWish& wish, double whole) {
    size_t kept = 0;
    for (Candidate c : candidates_) {
        Box both = moved(chart_box_[c.b], c.motion);
        both.add(chart_box_[c.a]);
        if (both.u1 - both.u0 > wish.longest || both.v1 - both.v0 > wish.longest) continue;
        const double waste = both.area() - chart_box_[c.a].area() - chart_box_[c.b].area();
        c.score = wish.bonus * whole + wish.rim * c.gain - waste;
        if (c.score > 0) candidates_[kept++] = c;
    }
    while (candidates_.size() > kept) candidates_.pop();
    heap_sort(candidates_.data(), candidates_.size(), [](const Candidate& a, const Candidate& b) {
        return a.score != b.score ? a.score > b.score : a.a != b.a ? a.a < b.a : a.b < b.b;
    });
}

// Chart b becomes a part of a.
void Charts::merge(const Candidate& c) {
    uint32_t last = NONE;
    for (uint32_t q = first_[c.b]; q != NONE; q = next_[q]) {
        motion[q] = c.motion.after(motion[q]);
        of_piece[q] = c.a;
        last = q;
    }
    next_[last] = first_[c.a];
    first_[c.a] = first_[c.b];
    first_[c.b] = NONE;
    chart_box_[c.a] = box_in_chart(first_[c.a], motion[first_[c.a]]);
    for (uint32_t q = first_[c.a]; q != NONE; q = next_[q]) chart_box_[c.a].add(box_in_chart(q, motion[q]));
}

// Numbers without gaps.
Done Charts::number_charts(Call& call) {
    Array<uint32_t> number;
    if (!number.allocate_filled(call.memory, of_piece.size(), NONE)) return false;
    count = 0;
    for (const uint32_t chart : of_piece)
        if (number[chart] == NONE) number[chart] = count++;
    for (uint32_t& chart : of_piece) chart = number[chart];
    return true;
}

// In rounds: the best first, each chart once a round.
hmf_status Charts::join(const JoinWish& wish, Call& call) {
    const uint32_t n = static_cast<uint32_t>(box.size());
    const double whole = start_with_pieces();
    Array<uint32_t> done; // the last round in which a chart was joined
    if (!done.allocate_filled(call.memory, n, 0)) return call.out_of_memory();
    bool any = true;
    for (uint32_t round = 1; round <= n && any; ++round) {
        if (!call.tick(0.88)) return call.was_cancelled();
        if (!list_candidates()) return call.out_of_memory();
        keep_worthwhile(wish, whole);
        any = false;
        for (const Candidate& c : candidates_) {
            if (done[c.a] == round || done[c.b] == round || !fits(c)) continue;
            done[c.a] = done[c.b] = round;
            any = true;
            merge(c);
        }
    }
    return number_charts(call) ? HMF_OK : call.out_of_memory();
}

} // namespace hmf
