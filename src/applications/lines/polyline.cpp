// Polylines of leaves.  Between two edges of a triangle a leaf is straight:
// at distance t from corner i it joins the points at fractions t / F_ij and
// t / F_ik of the sides.  In a tripod this leaves a middle triangle between the
// branch points, which the tree does not see; prongs run from its centroid.
#include "polyline.hpp"

#include "../../core/mesh/weights.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

void point_at(const Foliation& f, const double* position, const Crossing& c, double* point) {
    const uint32_t h = c.half_edge & ~1u;
    const int64_t whole = width(f, h), at = c.half_edge & 1u ? whole - c.at : c.at;
    const double t = static_cast<double>(at) / static_cast<double>(whole);
    const double* a = position + size_t{3} * f.mesh.origin[h];
    const double* b = position + size_t{3} * f.mesh.origin[h + 1];
    for (int k = 0; k < 3; ++k) point[k] = at == whole ? b[k] : a[k] + (b[k] - a[k]) * t;
}

void middle_of_tripod(const Foliation& f, const double* position, uint32_t h, double* point) {
    for (int k = 0; k < 3; ++k) point[k] = 0;
    for (int s = 0; s < 3; ++s, h = f.mesh.next[h]) {
        double p[3];
        point_at(f, position, {h, branch(f, h)}, p);
        for (int k = 0; k < 3; ++k) point[k] += p[k] / 3;
    }
}

double distance(const double* a, const double* b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return std::sqrt(x * x + y * y + z * z);
}

double surface_area(const Mesh& mesh, const double* position, const Parallel& parallel) {
    return parallel.sum_blocks<double>(size_t{2} * mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t h, uint32_t g, uint32_t k) {
                          const double* o = position + size_t{3} * mesh.origin[h];
                          const double* p = position + size_t{3} * mesh.origin[g];
                          const double* q = position + size_t{3} * mesh.origin[k];
                          double a[3], b[3];
                          for (int c = 0; c < 3; ++c) {
                              a[c] = p[c] - o[c];
                              b[c] = q[c] - o[c];
                          }
                          const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
                                       z = a[0] * b[1] - a[1] * b[0];
                          sum += std::sqrt(x * x + y * y + z * z) / 2;
                      });
        return sum;
    });
}

namespace {

// Half a unit to the left; a vertex that is there already is not repeated.
Done add_place(const Foliation& f, const Crossing& c, size_t first, Array<Crossing>& places) {
    const Crossing place{c.half_edge, c.at + 1};
    const bool vertex = place.at == width(f, place.half_edge);
    if (vertex && places.size() > first) {
        const Crossing& before = places.back();
        if (before.at == width(f, before.half_edge)
            && f.mesh.target(before.half_edge) == f.mesh.target(place.half_edge))
            return true;
    }
    return places.push(place);
}

} // namespace

Done arc_places(const Foliation& f, const CriticalGraph& graph, uint32_t arc, Array<Crossing>& places) {
    const ArcSide& a = graph.arcs[arc];
    const size_t first = places.size();
    // The leaf passes the middle of a tripod before it comes to the crossing of its sector.
    const uint64_t last = a.last - graph.zeros[graph.sectors[a.to].zero].tripod;
    for (uint64_t i = a.first; i <= last; ++i)
        if (!add_place(f, graph.crossings[i], first, places)) return false;
    return true;
}

Lines::Lines(Foliation& f, const double* position, double unit, double length_limit, Call& call) :
    f_(f), position_(position), unit_(unit), length_limit_(length_limit), call_(call) {}

Done Lines::start() {
    list.start(call_.memory);
    offsets.start(call_.memory);
    points.start(call_.memory);
    edges.start(call_.memory);
    return offsets.push(0);
}

Done Lines::add(const double* point, uint32_t edge) {
    return points.push(point[0]) && points.push(point[1]) && points.push(point[2]) && edges.push(edge);
}

Done Lines::end_line(const hmf_line& line) { return list.push(line) && offsets.push(edges.size()); }

void Lines::reverse(size_t first) {
    for (size_t a = first, z = edges.size(); a + 1 < z; ++a) {
        --z;
        for (size_t k = 0; k < 3; ++k) std::swap(points[3 * a + k], points[3 * z + k]);
        std::swap(edges[a], edges[z]);
    }
}

hmf_status Lines::add_leaf(const Crossing& start, hmf_line line) {
    const uint64_t crossing_limit = 64 * uint64_t{f_.mesh.edge_count} + (uint64_t{1} << 20);
    const size_t first = edges.size();
    double point[3];
    line.begin_zero = line.end_zero = HMF_NONE;
    // Forwards, and if it does not close, backwards as well.
    for (int way = 0; way < 2; ++way) {
        double length = 0;
        Crossing c = way == 0 ? start : reversed(f_, start);
        double before[3];
        point_at(f_, position_, c, before);
        if (way == 0 && !add(before, edge_of(c.half_edge))) return call_.out_of_memory();
        for (uint64_t n = 0;; ++n) {
            c = follow(f_, c);
            point_at(f_, position_, c, point);
            const double step = distance(before, point);
            if (way == 0 && c == start) {
                line.closed = 1;
                line.begin = line.end = HMF_END_CLOSED;
                line.length = length + step;
                return end_line(line) ? HMF_OK : call_.out_of_memory();
            }
            if (n > crossing_limit || limited(length + step)) break;
            if (!call_.work(64, 0, false)) return call_.was_cancelled();
            length += step;
            if (!add(point, edge_of(c.half_edge))) return call_.out_of_memory();
            for (int k = 0; k < 3; ++k) before[k] = point[k];
        }
        line.length += length;
        if (way == 0) reverse(first); // so that the others can follow
    }
    line.begin = line.end = HMF_END_LIMIT;
    return end_line(line) ? HMF_OK : call_.out_of_memory();
}

hmf_status Lines::add_levels(Cylinders& cylinders, double spacing) {
    for (uint32_t c = 0; c < cylinders.list.size(); ++c) {
        const double height = static_cast<double>(cylinders.list[c].height);
        const double wanted = std::floor(height * unit_ / spacing + 0.5);
        constexpr double most = 1 << 20;
        if (wanted > most)
            return call_.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                              "spacing asks for %g leaves in a cylinder. Stay below 2^20.", wanted);
        const uint32_t n = wanted < 1 ? 1 : static_cast<uint32_t>(wanted);
        for (uint32_t k = 0; k < n; ++k) {
            int64_t at = static_cast<int64_t>((2 * k + 1) * height / n) | 1;
            if (at >= 2 * cylinders.list[c].height) at = 2 * cylinders.list[c].height - 1;
            hmf_line line{};
            line.kind = HMF_LINE_LEVEL;
            line.cylinder = c;
            line.source = k;
            line.height = static_cast<double>(at) / 2 * unit_;
            if (add_leaf(leaf_at(f_, cylinders, c, at), line)) return call_.status();
        }
    }
    return HMF_OK;
}

hmf_status Lines::add_arcs(const CriticalGraph& graph) {
    Array<Crossing> places;
    places.start(call_.memory);
    uint32_t number = 0;
    for (uint32_t a = 0; a < graph.arcs.size(); ++a) {
        if (a > graph.arcs[a].twin) continue;
        places.clear();
        if (!arc_places(f_, graph, a, places)) return call_.out_of_memory();
        hmf_line line{};
        line.kind = HMF_LINE_CRITICAL;
        line.begin = line.end = HMF_END_ZERO;
        line.begin_zero = graph.sectors[graph.arcs[a].from].zero;
        line.end_zero = graph.sectors[graph.arcs[a].to].zero;
        line.cylinder = HMF_NONE;
        line.source = number++;
        double before[3], point[3];
        const Zero &from = graph.zeros[line.begin_zero], &to = graph.zeros[line.end_zero];
        bool any = false;
        const auto append = [&](uint32_t edge) -> Done {
            if (any) line.length += distance(before, point);
            if (length_limit_ > 0 && line.length > length_limit_) return true;
            any = true;
            for (int k = 0; k < 3; ++k) before[k] = point[k];
            return add(point, edge);
        };
        Done room = true;
        if (from.tripod) {
            middle_of_tripod(f_, position_, from.element, point);
            room = append(NONE);
        }
        for (size_t i = 0; room && i < places.size(); ++i) {
            point_at(f_, position_, places[i], point);
            room = append(edge_of(places[i].half_edge));
        }
        if (room && to.tripod) {
            middle_of_tripod(f_, position_, to.element, point);
            room = append(NONE);
        }
        if (length_limit_ > 0 && line.length > length_limit_) {
            line.length = length_limit_;
            line.end = HMF_END_LIMIT;
            line.end_zero = HMF_NONE;
        }
        if (!room || !end_line(line)) return call_.out_of_memory();
    }
    return HMF_OK;
}

Crossing Lines::place_of_point(uint32_t h, const double* barycentric) const {
    // Distance from each corner in half units at which the leaf turns around it; the corner that the point is deepest
    // in.
    double best = HUGE_VAL, best_at = 0;
    uint32_t corner = NONE;
    for (uint32_t s = 0; s < 3; ++s, h = f_.mesh.next[h]) {
        if (f_.at(h) == 0 || f_.at(f_.mesh.prev(h)) == 0 || branch(f_, h) == 0) continue;
        const double at = barycentric[(s + 1) % 3] * static_cast<double>(width(f_, h))
                        + barycentric[(s + 2) % 3] * static_cast<double>(width(f_, f_.mesh.prev(h)));
        const double beyond = at - static_cast<double>(branch(f_, h));
        if (beyond < best) {
            best = beyond;
            best_at = at;
            corner = h;
        }
    }
    if (corner == NONE) return {};
    const int64_t most = branch(f_, corner) - 1; // odd
    const int64_t at = best_at > 1 ? static_cast<int64_t>(best_at) | 1 : 1;
    return {corner, std::min(at, most)};
}

hmf_status Lines::add_point(Cylinders* cylinders, uint32_t h, const double* barycentric, uint32_t number) {
    hmf_line line{};
    line.kind = HMF_LINE_POINT;
    line.source = number;
    line.cylinder = HMF_NONE;
    const Crossing c = place_of_point(h, barycentric);
    if (c.half_edge == NONE) {
        line.begin = line.end = HMF_END_NOWHERE;
        line.begin_zero = line.end_zero = HMF_NONE;
        return end_line(line) ? HMF_OK : call_.out_of_memory();
    }
    int64_t height = 0;
    if (cylinders && locate(f_, *cylinders, c, line.cylinder, height, call_)) return call_.status();
    line.height = static_cast<double>(height) / 2 * unit_;
    return add_leaf(c, line);
}

} // namespace hmf
