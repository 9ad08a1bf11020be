// Signed crossings in a projection, decided exactly.
//
//  - Vertices are rounded to integers of 33 bits (1e-10 of the size of the
//    object), points on edges are integer combinations with factors that add
//    up to 2^12: all loops are polygons with integer corners.
//  - The view is along a direction with two random factors of 12 bits.  What
//    is degenerate in it (three points on a line, a triangle seen from its
//    side) makes another direction necessary, in which vertices are moved
//    by up to 4 units: on a lattice with many loops some points lie on
//    lines in each direction.
//  - Orientation tests are evaluated in double with an error bound, and in
//    256 bits where that does not decide.
//  - lk is the sum of the signs of the crossings where the first loop is on
//    top, and as well of those where the second one is: both are computed and
//    compared.
//
// Loops of different sets meet in triangles only, and cross there as the ends
// of their arcs alternate; the one that is pushed off is on top if the
// triangle is seen from the side of its normal.  The linking number of a loop
// with itself pushed off is that with its parallel on its left.
#include "linking.hpp"

#include "../../core/curves/disjoint.hpp"
#include "../../core/base/cyclic.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../../core/base/random_word.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr int POSITION_BITS = 32, EDGE_BITS = 12, VIEW_BITS = 12, VIEWS = 12;

// Sum of products of integers, in two's complement.
class Wide {
public:
    void add_product(int64_t a, int64_t b, int64_t c, bool negative) {
        negative ^= (a < 0) ^ (b < 0) ^ (c < 0);
        uint64_t low, high, p[3];
        multiply(absolute(a), absolute(b), p[0], low);
        multiply(low, absolute(c), p[1], high);
        multiply(p[0], absolute(c), p[0], low);
        p[1] += low;
        p[2] = high + (p[1] < low);
        uint64_t carry = negative;
        for (int i = 0; i < 4; ++i) {
            const uint64_t x = i < 3 ? p[i] : 0, term = negative ? ~x : x, sum = word_[i] + term;
            const uint64_t over = sum < term;
            word_[i] = sum + carry;
            carry = over | (word_[i] < carry);
        }
    }
    int sign() const {
        if (word_[3] >> 63) return -1;
        return (word_[0] | word_[1] | word_[2] | word_[3]) != 0;
    }

private:
    static uint64_t absolute(int64_t x) {
        return x < 0 ? uint64_t{0} - static_cast<uint64_t>(x) : static_cast<uint64_t>(x);
    }
    static void multiply(uint64_t a, uint64_t b, uint64_t& low, uint64_t& high) {
        const uint64_t mask = 0xffffffffu, a0 = a & mask, a1 = a >> 32, b0 = b & mask, b1 = b >> 32;
        const uint64_t middle = a1 * b0 + (a0 * b0 >> 32), other = a0 * b1 + (middle & mask);
        low = a * b;
        high = a1 * b1 + (middle >> 32) + (other >> 32);
    }
    uint64_t word_[4] = {0, 0, 0, 0};
};

struct LinkingPoint {
    int64_t x, y, z;
}; // z towards the eye

LinkingPoint operator-(const LinkingPoint& a, const LinkingPoint& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double absolute(double x) { return x < 0 ? -x : x; }

// Sign of the plane determinant of u and v.
int sign_of_turn(const LinkingPoint& u, const LinkingPoint& v) {
    const double p = static_cast<double>(u.x) * static_cast<double>(v.y),
                 q = static_cast<double>(u.y) * static_cast<double>(v.x);
    const double d = p - q, bound = 0x1p-50 * (absolute(p) + absolute(q));
    if (d > bound) return 1;
    if (d < -bound) return -1;
    Wide wide;
    wide.add_product(u.x, v.y, 1, false);
    wide.add_product(u.y, v.x, 1, true);
    return wide.sign();
}

// Sign of det(u, v, w).
int volume(const LinkingPoint& u, const LinkingPoint& v, const LinkingPoint& w) {
    const double term[6] = {static_cast<double>(u.x) * static_cast<double>(v.y) * static_cast<double>(w.z),
                            static_cast<double>(u.y) * static_cast<double>(v.z) * static_cast<double>(w.x),
                            static_cast<double>(u.z) * static_cast<double>(v.x) * static_cast<double>(w.y),
                            static_cast<double>(u.x) * static_cast<double>(v.z) * static_cast<double>(w.y),
                            static_cast<double>(u.y) * static_cast<double>(v.x) * static_cast<double>(w.z),
                            static_cast<double>(u.z) * static_cast<double>(v.y) * static_cast<double>(w.x)};
    const double d = (term[0] + term[1] + term[2]) - (term[3] + term[4] + term[5]);
    double bound = 0;
    for (const double t : term) bound += absolute(t);
    bound *= 0x1p-49;
    if (d > bound) return 1;
    if (d < -bound) return -1;
    Wide wide;
    wide.add_product(u.x, v.y, w.z, false);
    wide.add_product(u.y, v.z, w.x, false);
    wide.add_product(u.z, v.x, w.y, false);
    wide.add_product(u.x, v.z, w.y, true);
    wide.add_product(u.y, v.x, w.z, true);
    wide.add_product(u.z, v.y, w.x, true);
    return wide.sign();
}

struct Segment {
    LinkingPoint from, to;
    uint32_t loop, face;
    int64_t low, high; // range of x
};

// One of the two sets: its multicurve with the loops that the components are.
struct LoopSet {
    Multicurve curves;
    Array<uint32_t> loop_of; // per component
    Array<uint8_t> reversed; // per component: traced against the loop
};

class Linking {
public:
    Linking(const Mesh& mesh, const double* position, Call& call) : mesh_(mesh), position_(position), call_(call) {}

    hmf_status run(const Loops& a, const Loops& b, SeifertForm& out) {
        const size_t g = a.count(), n = 2 * g;
        out.size = n;
        if (!out.linking.allocate(call_.memory, n * n) || !out.intersection.allocate(call_.memory, n * n))
            return call_.out_of_memory();
        const Loops* const given[2] = {&a, &b};
        for (int s = 0; s < 2; ++s)
            if (load(*given[s], set_[s])) return call_.status();
        uint64_t seed = 1;
        for (int view = 0; view < VIEWS; ++view) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            if (!round_positions(view > 0)) return call_.out_of_memory();
            for (int64_t& factor : view_) {
                seed = seed * 6364136223846793005u + 1442695040888963407u;
                factor = static_cast<int64_t>(seed >> (64 - VIEW_BITS)) - (int64_t{1} << (VIEW_BITS - 1));
            }
            bool usable = true;
            if (!look(g, out, usable)) return call_.stopped();
            if (usable) return HMF_OK;
        }
        return call_.fail(HMF_ERROR_MESH_NOT_EMBEDDED, HMF_ELEMENT_NONE, 0,
                          "The surface intersects itself, so it has no inside. Repair the mesh, or use HMF_LOOPS_CUT "
                          "or HMF_LOOPS_PANTS.");
    }

private:
    Done round_positions(bool moved) {
        double low[3], high[3], size = 0;
        uint64_t moves = 0;
        for (size_t c = 0; c < 3; ++c) {
            low[c] = high[c] = position_[c];
            for (size_t v = 1; v < mesh_.vertex_count; ++v) {
                const double x = position_[3 * v + c];
                low[c] = std::min(low[c], x);
                high[c] = std::max(high[c], x);
            }
            size = std::max(size, high[c] / 2 - low[c] / 2);
        }
        int exponent = 0;
        std::frexp(size, &exponent);
        if (!rounded_.allocate(call_.memory, 3 * size_t{mesh_.vertex_count})) return false;
        for (size_t i = 0; i < rounded_.size(); ++i) {
            const double x = std::ldexp(position_[i] - (low[i % 3] / 2 + high[i % 3] / 2), POSITION_BITS - exponent);
            rounded_[i] = static_cast<int64_t>(x < 0 ? x - 0.5 : x + 0.5);
            if (moved) rounded_[i] += static_cast<int64_t>(random_word(moves) >> 61) - 4;
        }
        return true;
    }

    hmf_status load(const Loops& loops, LoopSet& set) {
        if (!set.curves.allocate(mesh_, call_.memory)) return call_.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh_, loops, 0, loops.count(), set.curves, &set.loop_of, call_, are_disjoint)
            || !set.reversed.allocate(call_.memory, loops.count()))
            return call_.out_of_memory();
        if (!are_disjoint)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, 0,
                              "Carried loops are not disjoint. Please report this.");
        for (size_t k = 0; k < loops.count(); ++k) {
            const uint64_t first = set.curves.components.offsets[k];
            const size_t m = static_cast<size_t>(set.curves.components.offsets[k + 1] - first);
            const uint32_t* const traced = set.curves.components.crossings.data() + first;
            set.reversed[k] = !same_cycle(traced, loops.crossings.data() + loops.offsets[set.loop_of[k]], m);
        }
        return HMF_OK;
    }

    // Where crossing j of a set (from the origin of half-edge 2e) lies on its edge.
    bool point(uint32_t e, int s, uint32_t j, bool parallel, LinkingPoint& out) const {
        const uint32_t n = set_[0].curves.count[e], m = set_[1].curves.count[e];
        const uint64_t places = 2 * (uint64_t{n} + m) + 1;
        if (places >= uint64_t{1} << EDGE_BITS) return false;
        const LoopSet& set = set_[s];
        // The loop and its parallel side by side; left of a loop that leaves through 2e is the end of 2e.
        const uint32_t strand = set.curves.strand[set.curves.first[e] + j];
        const bool left_is_end = ((strand & 1u) != 0) == (set.reversed[strand / 2] != 0);
        const uint64_t slot = (s ? 2 * uint64_t{n} : 0) + 2 * uint64_t{j} + (left_is_end == parallel);
        const int64_t whole = int64_t{1} << EDGE_BITS,
                      f = static_cast<int64_t>((slot + 1) * static_cast<uint64_t>(whole) / (places + 1));
        const int64_t* const p = rounded_.data() + 3 * size_t{mesh_.origin[2 * e]};
        const int64_t* const q = rounded_.data() + 3 * size_t{mesh_.origin[2 * e + 1]};
        const int64_t x = (whole - f) * p[0] + f * q[0], y = (whole - f) * p[1] + f * q[1],
                      z = (whole - f) * p[2] + f * q[2];
        out = {x * (int64_t{1} << VIEW_BITS) - view_[0] * z, y * (int64_t{1} << VIEW_BITS) - view_[1] * z, z};
        return true;
    }

    // The segments of a set in the present view.
    Done draw(int s, bool parallel, Array<Segment>& segments, bool& usable) {
        const LoopSet& set = set_[s];
        const Multicurve& curves = set.curves;
        segments.start(call_.memory);
        for (size_t k = 0; k + 1 < curves.components.offsets.size(); ++k) {
            const uint64_t first = curves.components.offsets[k], end = curves.components.offsets[k + 1];
            uint32_t h = curves.components.crossings[first], p = curves.begin[k] - curves.first[edge_of(h)];
            if (h & 1u) p = curves.count[edge_of(h)] - 1 - p;
            const auto here = [&](LinkingPoint& at) {
                return point(edge_of(h), s, h & 1u ? curves.count[edge_of(h)] - 1 - p : p, parallel, at);
            };
            Segment segment{};
            segment.loop = set.loop_of[k];
            usable = usable && here(segment.from);
            for (uint64_t i = first; i < end && usable; ++i) {
                segment.face = mesh_.face[twin(h)];
                curves.step(mesh_, h, p);
                usable = here(segment.to);
                Segment directed = segment;
                if (set.reversed[k]) {
                    directed.from = segment.to;
                    directed.to = segment.from;
                }
                directed.low = std::min(segment.from.x, segment.to.x);
                directed.high = std::max(segment.from.x, segment.to.x);
                if (!segments.push(directed) || !call_.work(64)) return false;
                segment.from = segment.to;
            }
        }
        heap_sort(segments.data(), segments.size(), [](const Segment& a, const Segment& b) {
            return a.low < b.low || (a.low == b.low && (a.loop < b.loop || (a.loop == b.loop && a.face < b.face)));
        });
        return true;
    }

    // Is the face seen from the side of its normal?  0: from its edge.
    int facing(uint32_t face) {
        const uint32_t h = side_[face];
        LinkingPoint corner[3];
        uint32_t k = h;
        for (LinkingPoint& c : corner) {
            const int64_t* const p = rounded_.data() + 3 * size_t{mesh_.origin[k]};
            c = {p[0] * (int64_t{1} << VIEW_BITS) - view_[0] * p[2], p[1] * (int64_t{1} << VIEW_BITS) - view_[1] * p[2],
                 p[2]};
            k = mesh_.next[k];
        }
        return sign_of_turn(corner[1] - corner[0], corner[2] - corner[0]);
    }

    // Adds what the crossings of the segments say; tables are g x g, first loop
    // of s.  Not usable: some meet in a corner, or are seen from an edge.
    struct Tables {
        Array<int64_t> top, below;              // lk by the crossings with s on top, and below
        Array<int64_t> local_front, local_back; // intersections in triangles seen from the front, and from the back
        Done allocate(Memory& memory, size_t n) {
            return top.allocate_filled(memory, n, int64_t{0}) && below.allocate_filled(memory, n, int64_t{0})
                && local_front.allocate_filled(memory, n, int64_t{0})
                && local_back.allocate_filled(memory, n, int64_t{0});
        }
    };
    Done count_crossings(const Array<Segment>& s, const Array<Segment>& t, size_t g, Tables& tables, bool& usable) {
        usable = false;
        int64_t widest = 0;
        for (const Segment& b : t) widest = std::max(widest, b.high - b.low);
        size_t begin = 0;
        for (size_t k = 0; k < s.size(); ++k) {
            const Segment& a = s[k];
            while (begin < t.size() && t[begin].low < a.low - widest) ++begin;
            for (size_t i = begin; i < t.size() && t[i].low <= a.high; ++i) {
                const Segment& b = t[i];
                if (!call_.work(4)) return false;
                if (b.high < a.low) continue;
                if (std::max(b.from.y, b.to.y) < std::min(a.from.y, a.to.y)
                    || std::max(a.from.y, a.to.y) < std::min(b.from.y, b.to.y))
                    continue;
                const LinkingPoint u = a.to - a.from, v = b.to - b.from;
                const int o1 = sign_of_turn(u, b.from - a.from), o2 = sign_of_turn(u, b.to - a.from);
                if (o1 * o2 > 0) continue;
                const int o3 = sign_of_turn(v, a.from - b.from), o4 = sign_of_turn(v, a.to - b.from);
                if (o3 * o4 > 0) continue;
                if (o1 * o2 * o3 * o4 == 0) return true;
                const size_t at = g * a.loop + b.loop;
                if (a.face == b.face) {
                    const int front = facing(a.face);
                    if (front == 0) return true;
                    (front > 0 ? tables.local_front : tables.local_back)[at] += o2;
                    continue;
                }
                const int above = o2 * volume(u, v, b.from - a.from); // of b over a
                if (above == 0) return true;
                if (above < 0) tables.top[at] += o2;
                else tables.below[at] -= o2;
            }
        }
        usable = true;
        return true;
    }

    // All numbers from one view.
    Done look(size_t g, SeifertForm& out, bool& usable) {
        const size_t n = 2 * g;
        Array<Segment> loops[2], parallels[2];
        if (side_.empty()) {
            if (!side_.allocate(call_.memory, mesh_.face_count)) return false;
            for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h) side_[mesh_.face[h]] = h;
        }
        for (int s = 0; s < 2; ++s)
            if (!draw(s, false, loops[s], usable) || !draw(s, true, parallels[s], usable)) return false;
        if (!usable) return true;
        if (!call_.tick(0, true)) return false;
        for (size_t i = 0; i < n * n; ++i) out.linking[i] = out.intersection[i] = 0;
        if (!call_.tick(0, true)) return false;
        for (size_t s = 0; s < 2; ++s) {
            Tables tables;
            if (!tables.allocate(call_.memory, g * g) || !call_.tick(0, true)) return false;
            if (!count_crossings(loops[s], parallels[s], g, tables, usable) || !call_.tick(0, true)) return false;
            for (size_t i = 0; i < g * g && usable; ++i) {
                usable = tables.top[i] == tables.below[i] && tables.local_front[i] == 0 && tables.local_back[i] == 0;
                out.linking[n * (s * g + i / g) + s * g + i % g] = tables.top[i];
            }
            if (!usable) return true;
        }
        Tables tables;
        if (!tables.allocate(call_.memory, g * g) || !call_.tick(0, true)) return false;
        if (!count_crossings(loops[0], loops[1], g, tables, usable) || !call_.tick(0, true)) return false;
        for (size_t i = 0; i < g && usable; ++i)
            for (size_t j = 0; j < g; ++j) {
                const size_t at = g * i + j;
                // From the front b pushed off is on top of a, from the back below it.
                const int64_t front = tables.local_front[at], back = tables.local_back[at];
                const int64_t ab = tables.top[at] + back, ba = tables.top[at] + front;
                usable = usable && ab == tables.below[at] - front && ba == tables.below[at] - back;
                out.linking[n * i + g + j] = ab;
                out.linking[n * (g + j) + i] = ba;
                out.intersection[n * i + g + j] = front - back;
                out.intersection[n * (g + j) + i] = back - front;
            }
        return call_.tick(0, true);
    }

    const Mesh& mesh_;
    const double* position_;
    Call& call_;
    Array<int64_t> rounded_;
    Array<uint32_t> side_; // a half-edge of each face
    LoopSet set_[2];
    int64_t view_[2] = {0, 0};
};

} // namespace

hmf_status seifert_form(const Mesh& mesh, const double* position, const Loops& a, const Loops& b, Call& call,
                        SeifertForm& out) {
    Linking linking(mesh, position, call);
    return linking.run(a, b, out);
}

} // namespace hmf
