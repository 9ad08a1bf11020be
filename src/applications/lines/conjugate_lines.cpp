// Conjugate leaves.  |dv| is a foliation as exact as F, all of whose triangles
// are flat, and its leaves are followed in the same way; but they need not
// close.  The progress of a leaf across a cylinder is u, which is linear in each triangle and monotone along the leaf.
#include "conjugate_lines.hpp"

#include <cmath>

namespace hmf {

namespace {

double absolute_value(double x) { return x < 0 ? -x : x; }

// Change of a function with flat triangles between two points of a triangle:
// on h at fraction s, and on the half-edge `next` by which a leaf leaves it at
// fraction t.  form: absolute_value of its changes along the edges.
double change(const Mesh& mesh, const int64_t* form, uint32_t h, double s, uint32_t next, double t) {
    const uint32_t k = twin(h);
    const bool left = next == mesh.prev(k);
    const uint32_t opposite = edge_of(left ? mesh.next[k] : mesh.prev(k));
    if (left) {
        s = 1 - s;
        t = 1 - t;
    }
    const int64_t a = form[edge_of(h)], b = form[edge_of(next)];
    const double x = s * static_cast<double>(a), y = t * static_cast<double>(b);
    return form[opposite] == a + b ? x + y : absolute_value(x - y);
}

double fraction(const Foliation& g, const Crossing& c) {
    return static_cast<double>(c.at) / static_cast<double>(width(g, c.half_edge));
}

// The function at the corners of the triangle of which h is side 0, up to sign.
void corners(const Mesh& mesh, const int64_t* form, uint32_t h, double* u) {
    const int64_t a = form[edge_of(h)], b = form[edge_of(mesh.next[h])], c = form[edge_of(mesh.prev(h))];
    u[0] = 0;
    u[1] = static_cast<double>(a);
    u[2] = b == a + c ? -static_cast<double>(c) : static_cast<double>(c);
}

class Tracer {
public:
    Tracer(Lines& lines, const Foliation& g, const int64_t* du, const double* position, Call& call) :
        lines_(lines), g_(g), du_(du), position_(position),
        crossing_limit_(64 * uint64_t{g.mesh.edge_count} + (uint64_t{1} << 20)), call_(call) {}

    // The points after c, until u has changed by `room`, a zero is met or the line is too long; length is accumulated.
    // skip: the line begins in the triangle after c, where u has changed by this much.
    hmf_status trace(Crossing c, double skip, double room, const CriticalGraph* graph, double& length, int32_t& end) {
        double before[3], point[3];
        point_at(g_, position_, c, before);
        end = HMF_END_LIMIT;
        double here = 0;
        if (skip > 0) {
            const Crossing next = follow(g_, c);
            const double grown = change(g_.mesh, du_, c.half_edge, fraction(g_, c), next.half_edge, fraction(g_, next));
            point_at(g_, position_, next, point);
            for (int k = 0; k < 3; ++k) before[k] += (point[k] - before[k]) * (skip < grown ? skip / grown : 1);
            if (!lines_.add(before, NONE)) return call_.out_of_memory();
        }
        uint32_t inside = graph ? graph->sector_at(g_, c) : NONE;
        for (uint64_t n = 0; n < crossing_limit_; ++n) {
            if (!call_.work(64, 0, false)) return call_.was_cancelled();
            const Crossing next = follow(g_, c);
            point_at(g_, position_, next, point);
            double grown =
                du_ ? change(g_.mesh, du_, c.half_edge, fraction(g_, c), next.half_edge, fraction(g_, next)) : 0;
            if (n == 0 && skip > 0) {
                here = skip;
                grown = grown > skip ? grown - skip : 0;
            }
            const bool arrives = du_ && here + grown >= room;
            if (arrives)
                for (int k = 0; k < 3; ++k)
                    point[k] = before[k] + (point[k] - before[k]) * (grown > 0 ? (room - here) / grown : 1);
            const double step = distance(before, point);
            if (lines_.limited(length + step)) return HMF_OK;
            length += step;
            const uint32_t sector = graph ? graph->sector_at(g_, next) : NONE;
            const bool zero = sector != NONE && sector != inside;
            if (!lines_.add(point, arrives ? NONE : edge_of(next.half_edge))) return call_.out_of_memory();
            if (arrives || zero) {
                end = zero ? HMF_END_ZERO : HMF_END_CRITICAL;
                return HMF_OK;
            }
            inside = sector;
            here += grown;
            c = next;
            for (int k = 0; k < 3; ++k) before[k] = point[k];
        }
        return HMF_OK;
    }

private:
    Lines& lines_;
    const Foliation& g_;
    const int64_t* du_;
    const double* position_;
    uint64_t crossing_limit_;
    Call& call_;
};

} // namespace

hmf_status read_levels(const Foliation& f, const Cylinders& cylinders, ConjugateLevels& out, Call& call) {
    Curves middle;
    if (middle_leaves(f, cylinders, nullptr, middle, call)) return call.status();
    const size_t n = cylinders.list.size();
    if (!out.offsets.allocate(call.memory, n + 1) || !out.height.allocate(call.memory, n)
        || !out.middle.allocate(call.memory, middle.crossings.size()))
        return call.out_of_memory();
    for (size_t c = 0; c <= n; ++c) out.offsets[c] = middle.offsets[c];
    for (size_t c = 0; c < n; ++c) out.height[c] = static_cast<double>(cylinders.list[c].height);
    for (size_t i = 0; i < out.middle.size(); ++i)
        out.middle[i] = {middle.crossings[i].half_edge, fraction(f, middle.crossings[i])};
    return HMF_OK;
}

namespace {

// The middle leaf of a cylinder, measured by the conjugate; walked once, from its first crossing on.
class MeasuredLeaf {
public:
    MeasuredLeaf(const Foliation& g, const ConjugateLevels& levels, uint32_t cylinder) :
        g_(g), levels_(levels), begin_(levels.offsets[cylinder]), end_(levels.offsets[cylinder + 1]), at_(begin_) {
        for (uint64_t i = begin_; i < end_; ++i) whole_ += step(i);
    }
    double whole() const { return whole_; }

    // The point at a distance from the beginning, not less than that of the point before: barycentric, in the
    // triangle of half-edge side.  false: beyond the end.
    bool point(double target, uint32_t& side, double* w) {
        double part = 0;
        for (; at_ < end_; ++at_) {
            part = step(at_);
            if (passed_ + part >= target) break;
            passed_ += part;
        }
        if (at_ == end_) return false;
        // Between both crossings, in the triangle behind the first one.
        const OnEdge &a = levels_.middle[at_], &b = next(at_);
        side = twin(a.half_edge);
        const double s = part > 0 ? (target - passed_) / part : 0;
        w[0] = (1 - s) * a.fraction;
        w[1] = (1 - s) * (1 - a.fraction);
        w[2] = 0;
        if (b.half_edge == g_.mesh.next[side]) {
            w[1] += s * (1 - b.fraction);
            w[2] += s * b.fraction;
        } else {
            w[2] += s * (1 - b.fraction);
            w[0] += s * b.fraction;
        }
        return true;
    }

private:
    const OnEdge& next(uint64_t i) const { return levels_.middle[i + 1 < end_ ? i + 1 : begin_]; }
    double step(uint64_t i) const {
        const OnEdge &a = levels_.middle[i], &b = next(i);
        return change(g_.mesh, g_.value, a.half_edge, a.fraction, b.half_edge, b.fraction);
    }

    const Foliation& g_;
    const ConjugateLevels& levels_;
    uint64_t begin_, end_, at_;
    double whole_ = 0, passed_ = 0;
};

// How far u grows from a point of the triangle of `side` to where its leaf leaves the triangle at `start`.
double growth_to(const Foliation& g, const int64_t* du, uint32_t side, const double* w, const Crossing& start) {
    double u[3], there = 0, here = 0;
    corners(g.mesh, du, side, u);
    const double f = fraction(g, start);
    const uint32_t from = start.half_edge == side ? 0u : start.half_edge == g.mesh.next[side] ? 1u : 2u;
    there = (1 - f) * u[from] + f * u[(from + 1) % 3];
    for (int i = 0; i < 3; ++i) here += w[i] * u[i];
    return absolute_value(there - here);
}

} // namespace

hmf_status add_conjugate_levels(Lines& lines, const Foliation& g, const int64_t* du, const ConjugateLevels& levels,
                                double spacing, double unit, const double* position, Call& call) {
    Tracer tracer(lines, g, du, position, call);
    for (uint32_t c = 0; c < levels.height.size(); ++c) {
        MeasuredLeaf middle(g, levels, c);
        const double wanted = std::floor(middle.whole() * unit / spacing + 0.5);
        if (wanted > 1 << 20)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                             "spacing asks for %g leaves in a cylinder. Stay below 2^20.", wanted);
        const uint32_t n = wanted < 1 ? 1 : static_cast<uint32_t>(wanted);
        for (uint32_t k = 0; k < n; ++k) {
            uint32_t side = NONE;
            double w[3], point[3];
            if (!middle.point((k + 0.5) / n * middle.whole(), side, w)) break;
            hmf_line line{};
            line.kind = HMF_LINE_LEVEL;
            line.cylinder = c;
            line.source = k;
            line.begin_zero = line.end_zero = HMF_NONE;
            const Crossing start = lines.place_of_point(side, w);
            if (start.half_edge == NONE) continue;
            const double ahead = growth_to(g, du, side, w, start), half = levels.height[c] / 2;
            const size_t first = lines.edges.size();
            // It may end in this triangle on both sides.
            if (tracer.trace(reversed(g, start), ahead - half, half + ahead, nullptr, line.length, line.begin))
                return call.status();
            lines.reverse(first);
            double other = 0;
            if (ahead < half) {
                point_at(g, position, start, point);
                if (!lines.add(point, edge_of(start.half_edge))) return call.out_of_memory();
                if (tracer.trace(start, 0, half - ahead, nullptr, other, line.end)) return call.status();
            } else line.end = HMF_END_CRITICAL;
            line.length += other;
            if (!lines.end_line(line)) return call.out_of_memory();
        }
    }
    return HMF_OK;
}

hmf_status add_conjugate_prongs(Lines& lines, Foliation& g, const double* position, Call& call) {
    CriticalGraph graph;
    if (graph.build_sectors(g, nullptr, nullptr, call)) return call.status();
    Tracer tracer(lines, g, nullptr, position, call);
    uint32_t number = 0;
    for (const Sector& s : graph.sectors) {
        const bool prong = g.at(g.mesh.rotate_ccw(s.last)) > 0 && g.corner2(s.last) == 0;
        const Zero& zero = graph.zeros[s.zero];
        if (!prong || zero.index > 0 || (zero.index == 0 && !g.mesh.is_marked(zero.element))) continue;
        hmf_line line{};
        line.kind = HMF_LINE_CRITICAL;
        line.cylinder = line.begin_zero = line.end_zero = HMF_NONE;
        line.source = number++;
        line.begin = HMF_END_ZERO;
        double point[3];
        // Half a unit beside the vertex and its prong.
        const Crossing start{twin(s.last), width(g, s.last) - 1};
        point_at(g, position, start, point);
        if (!lines.add(point, edge_of(s.last))) return call.out_of_memory();
        if (tracer.trace(start, 0, 0, &graph, line.length, line.end)) return call.status();
        if (!lines.end_line(line)) return call.out_of_memory();
    }
    return HMF_OK;
}

} // namespace hmf
