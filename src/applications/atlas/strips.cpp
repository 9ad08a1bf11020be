// From the middle leaf of a cylinder its triangles are laid out, one next to the
// other, as far as the zeros at either side.  A step leads from a triangle to the
// next one only through a part of their side that lies within the strip: so the
// way between their barycenters stays in the cylinder, and each triangle has one
// place, up to the period.
#include "strips.hpp"

#include "../../core/base/heap_sort.hpp"
#include "../common/cylinder_leaves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hmf {

namespace {

constexpr uint32_t STRIPS_STRIDE = 65536;

class RollOut {
public:
    RollOut(const Foliation& f, const Cylinders& cylinders, const FlatConeMetric& flat, const Reflection* reflection,
            Strips& out, Call& call) :
        f_(f),
        mesh_(f.mesh), cylinders_(cylinders), flat_(flat), reflection_(reflection), out_(out), call_(call) {}

    hmf_status run(double to_flat) {
        Memory& memory = call_.memory;
        const size_t sides = size_t{2} * mesh_.edge_count, n = cylinders_.list.size();
        VertexCharts charts;
        if (!out_.list.allocate(memory, n + 1) || !out_.u.allocate_filled(memory, sides, 0)
            || !out_.v.allocate_filled(memory, sides, 0) || !out_.sign.allocate_filled(memory, mesh_.face_count, 0)
            || !out_.piece.allocate_filled(memory, mesh_.face_count, NONE)
            || !met_.allocate_filled(memory, mesh_.face_count, 0) || !queue_.allocate(memory, mesh_.face_count)
            || !charts.build(mesh_, flat_.bundle, call_) || !find_cones(mesh_, flat_, charts, cone_, is_cone_, call_))
            return call_.stopped();
        out_.cuts.start(memory);
        zeros_.start(memory);
        Curves middle;
        if (middle_leaves(f_, cylinders_, nullptr, middle, call_)) return call_.status();
        for (uint32_t c = 0; c < n; ++c) {
            Strip& strip = out_.list[c];
            strip = {};
            strip.first_piece = out_.piece_count();
            const double height = static_cast<double>(cylinders_.list[c].height) * to_flat;
            strip.high = static_cast<int64_t>(height / 2);
            strip.low = -strip.high;
            const Crossing* leaf = middle.crossings.data() + middle.offsets[c];
            const size_t length = static_cast<size_t>(middle.offsets[c + 1] - middle.offsets[c]);
            if (find_period(leaf, length, strip)) return call_.status();
            // Twice: at first the zeros are only nearly where the strip ends.
            for (uint32_t round = 0; round < 2; ++round) {
                if (!spread(strip, leaf, length, 2 * c + round + 1)) return call_.stopped();
                if (round == 0) find_sides(strip, static_cast<int64_t>(height));
            }
            int64_t begin = 0;
            if (!keep_front(strip, begin)) continue;
            if (!add_cuts(strip, begin)) return call_.stopped();
        }
        out_.list[n] = {};
        out_.list[n].first_piece = out_.piece_count();
        return take_the_rest() ? HMF_OK : call_.stopped();
    }

private:
    // The corners of face(h) from that at h, in the chart of sign s.
    void lay(uint32_t h, int8_t s) {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        out_.sign[mesh_.face[h]] = s;
        out_.u[n] = out_.u[h] + s * flat_.du.at(flat_.bundle, h);
        out_.v[n] = out_.v[h] + s * flat_.dv.at(flat_.bundle, h);
        out_.u[p] = out_.u[n] + s * flat_.du.at(flat_.bundle, n);
        out_.v[p] = out_.v[n] + s * flat_.dv.at(flat_.bundle, n);
    }

    // The face beyond h next to that of h.
    void lay_beyond(uint32_t h) {
        const uint32_t t = twin(h);
        out_.u[t] = out_.u[mesh_.next[h]];
        out_.v[t] = out_.v[mesh_.next[h]];
        lay(t, static_cast<int8_t>(out_.sign[mesh_.face[h]] * flat_.bundle.turn[edge_of(h)]));
    }

    // v grows by the period once along a closed leaf.
    hmf_status find_period(const Crossing* leaf, size_t length, Strip& strip) {
        constexpr double longest = 1e18; // units: the sum of v over the corners of a triangle fits 63 bits
        int64_t v = 0;
        double way = 0; // without signs
        int8_t s = 1;
        for (size_t i = 0; i < length; ++i) {
            const uint32_t to = leaf[i + 1 < length ? i + 1 : 0].half_edge;
            for (uint32_t h = twin(leaf[i].half_edge); h != mesh_.next[to]; h = mesh_.next[h]) {
                const int64_t dv = flat_.dv.at(flat_.bundle, h);
                way += std::fabs(static_cast<double>(dv));
                if (way > longest)
                    return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                                      "A cylinder is more than %.3g times as long as high. Repair triangles that are "
                                      "nearly without area.",
                                      way / static_cast<double>(strip.high - strip.low));
                v += s * dv;
            }
            s = static_cast<int8_t>(s * flat_.bundle.turn[edge_of(to)]);
        }
        strip.period = strip.length = v < 0 ? -v : v;
        return HMF_OK;
    }

    // A multiple of the period that brings the barycenter (times 3) to [3 from, 3 (from + period)).
    void bring_back(uint32_t h, int64_t period, int64_t from) {
        if (period <= 0) return;
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        const int64_t sum = out_.v[h] + out_.v[n] + out_.v[p] - 3 * from;
        const int64_t turns = sum >= 0 ? sum / (3 * period) : -((3 * period - 1 - sum) / (3 * period));
        for (const uint32_t corner : {h, n, p}) out_.v[corner] -= turns * period;
    }

    bool is_inside(uint32_t h, const Strip& strip) const {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        const int64_t sum = out_.u[h] + out_.u[n] + out_.u[p];
        return sum > 3 * strip.low && sum < 3 * strip.high;
    }

    // The triangles of a strip into queue_; round: a number of its own.
    Done spread(const Strip& strip, const Crossing* leaf, size_t length, uint32_t round) {
        reached_ = 0;
        zeros_.clear();
        const uint32_t first = leaf[0].half_edge;
        const double part = static_cast<double>(leaf[0].at) / static_cast<double>(width(f_, first));
        // The side at which the leaf comes to a triangle: its origin, and the sign of the triangle.
        int64_t u = -static_cast<int64_t>((1 - part) * static_cast<double>(flat_.du.at(flat_.bundle, twin(first)))),
                v = 0;
        int8_t s = 1;
        for (size_t i = 0; i < length; ++i) {
            const uint32_t from = twin(leaf[i].half_edge), to = leaf[i + 1 < length ? i + 1 : 0].half_edge;
            if (is_free(from, round)) {
                out_.u[from] = u;
                out_.v[from] = v;
                lay(from, s);
                take(from, strip, round);
            }
            for (uint32_t h = from; h != mesh_.next[to]; h = mesh_.next[h]) {
                u += s * flat_.du.at(flat_.bundle, h);
                v += s * flat_.dv.at(flat_.bundle, h);
            }
            s = static_cast<int8_t>(s * flat_.bundle.turn[edge_of(to)]);
        }
        for (uint32_t i = 0; i < reached_; ++i) {
            if (i % STRIPS_STRIDE == 0 && !call_.tick(0.85)) return false;
            uint32_t h = queue_[i];
            for (uint32_t side = 0; side < 3; ++side, h = mesh_.next[h]) {
                if (is_cone_[mesh_.origin[h]] && cone_[mesh_.origin[h]] != 1 && !zeros_.push(h)) return false;
                const int64_t a = out_.u[h], b = out_.u[mesh_.next[h]];
                if (!is_free(twin(h), round) || std::max(a, b) <= strip.low || std::min(a, b) >= strip.high) continue;
                lay_beyond(h);
                take(twin(h), strip, round);
            }
        }
        return true;
    }
    bool is_free(uint32_t h, uint32_t round) const {
        return out_.piece[mesh_.face[h]] == NONE && met_[mesh_.face[h]] != round;
    }
    void take(uint32_t h, const Strip& strip, uint32_t round) {
        if (!is_inside(h, strip)) return;
        bring_back(h, strip.period, 0);
        met_[mesh_.face[h]] = round;
        queue_[reached_++] = h;
    }

    // Moves the sides of the strip to the zeros next to them.
    void find_sides(Strip& strip, int64_t height) const {
        const int64_t near = height / 8;
        int64_t up = near, down = near; // how far beyond
        bool above = false, below = false;
        for (const uint32_t h : zeros_) {
            const int64_t over = out_.u[h] - strip.high, under = strip.low - out_.u[h];
            if (over < near && over > -near && (!above || over < up)) above = true, up = over;
            if (under < near && under > -near && (!below || under < down)) below = true, down = under;
        }
        if (above) strip.high += up;
        if (below) strip.low -= down;
        if (above && !below) strip.low = strip.high - height;
        if (below && !above) strip.high = strip.low + height;
    }

    bool is_front(uint32_t h) const { return !reflection_ || reflection_->is_front[h]; }

    // Where the boundary runs across a strip.
    struct Across {
        int64_t length = 0; // in u
        int64_t begin = 0;  // v, with the front at larger v
        bool found = false;
    };
    void add_boundary(uint32_t h, int64_t period, Across& a) const {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        const int64_t du = std::abs(out_.u[n] - out_.u[h]), dv = std::abs(out_.v[n] - out_.v[h]);
        if (du <= dv) return;
        a.length += du;
        if (a.found || out_.v[p] <= out_.v[h]) return;
        a.found = true;
        a.begin = period > 0 ? out_.v[h] % period : 0;
    }

    // Of a strip of a double: what of it lies in front, and where that begins in v.  False: nothing.
    bool keep_front(Strip& strip, int64_t& begin) {
        if (!reflection_) return true;
        Across across;
        uint32_t kept = 0;
        const uint32_t all = reached_;
        int64_t low = INT64_MAX, high = INT64_MIN;
        for (uint32_t i = 0; i < all; ++i) {
            uint32_t h = queue_[i];
            if (!is_front(h)) continue;
            queue_[kept++] = h;
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                low = std::min(low, out_.u[h]);
                high = std::max(high, out_.u[h]);
                if (reflection_->on_boundary(h)) add_boundary(h, strip.period, across);
            }
        }
        reached_ = kept;
        // A few triangles over its edge do not make it one of the other side.
        if (kept < all / 8 || kept == 0) return false;
        if (kept > all - all / 8) return true;
        if (across.found && across.length > (strip.high - strip.low) / 2) {
            strip.length = strip.period / 2;
            begin = across.begin;
            return true;
        }
        strip.low = std::max(strip.low, low);
        strip.high = std::min(strip.high, high);
        return strip.low < strip.high;
    }

    // Cuts at the zeros on the sides, but not closer to each other than a few triangles; at least one.
    Done add_cuts(const Strip& strip, int64_t begin) {
        const int64_t height = strip.high - strip.low, period = strip.period;
        places_.start(call_.memory);
        for (const uint32_t h : zeros_) {
            const int64_t over = out_.u[h] - strip.high, under = strip.low - out_.u[h];
            const int64_t off = std::min(over < 0 ? -over : over, under < 0 ? -under : under);
            if (off > height / 64) continue;
            int64_t v = period > 0 ? out_.v[h] % period : 0;
            if (v < 0) v += period;
            if (strip.length < period) {
                v = v < begin ? v + period : v;
                if (v - begin > strip.length) continue;
            }
            if (!places_.push(v)) return false;
        }
        if ((strip.length < period || places_.empty()) && !places_.push(begin)) return false;
        heap_sort(places_.data(), places_.size(), [](int64_t a, int64_t b) { return a < b; });
        const int64_t apart = period / 64;
        const size_t first = out_.cuts.size();
        for (const int64_t v : places_)
            if (out_.cuts.size() == first
                || (v - out_.cuts.back() > apart && out_.cuts[first] + strip.length - v > apart))
                if (!out_.cuts.push(v)) return false;
        for (uint32_t i = 0; i < reached_; ++i) {
            const uint32_t h = queue_[i];
            bring_back(h, period, out_.cuts[first] - (period - strip.length) / 2);
            const int64_t sum = out_.v[h] + out_.v[mesh_.next[h]] + out_.v[mesh_.prev(h)];
            size_t k = first;
            while (k + 1 < out_.cuts.size() && sum >= 3 * out_.cuts[k + 1]) ++k;
            out_.piece[mesh_.face[h]] = static_cast<uint32_t>(k);
        }
        return true;
    }

    // A triangle that no strip has reached goes with a neighbor.
    Done take_the_rest() {
        uint32_t size = 0;
        for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h)
            if (out_.piece[mesh_.face[h]] != NONE) add_beyond(h, size);
        for (uint32_t i = 0; i < size; ++i) {
            if (i % STRIPS_STRIDE == 0 && !call_.tick(0.86)) return false;
            uint32_t h = queue_[i];
            for (uint32_t side = 0; side < 3; ++side, h = mesh_.next[h]) add_beyond(h, size);
        }
        return true;
    }
    void add_beyond(uint32_t h, uint32_t& size) {
        const uint32_t t = twin(h);
        if (out_.piece[mesh_.face[t]] != NONE || !is_front(t)) return;
        lay_beyond(h);
        out_.piece[mesh_.face[t]] = out_.piece[mesh_.face[h]];
        queue_[size++] = t;
    }

    const Foliation& f_;
    const Mesh& mesh_;
    const Cylinders& cylinders_;
    const FlatConeMetric& flat_;
    const Reflection* reflection_;
    Strips& out_;
    Call& call_;
    Array<int32_t> cone_;
    Array<uint8_t> is_cone_;
    Array<uint32_t> met_, queue_; // per face; faces by a half-edge of each
    uint32_t reached_ = 0;        // how many are in the queue
    Array<uint32_t> zeros_;       // corners at zeros in this strip
    Array<int64_t> places_;
};

} // namespace

hmf_status Strips::build(const Foliation& f, const Cylinders& cylinders, const FlatConeMetric& flat,
                         const Reflection* reflection, double to_flat, Call& call) {
    return RollOut(f, cylinders, flat, reflection, *this, call).run(to_flat);
}

} // namespace hmf
