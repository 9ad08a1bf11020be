// The sheet of a part of a line follows from its ends: from an edge that lies only in front, or only behind.
//
//      front  \   /         Between two edges of the boundary (a triangle that has
//     ---------o-o------    two) it is told by the part before or behind it, since
//      back     v           the line changes sides at each of them.
#include "front_lines.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double SLIVER = 1e-6; // of the whole line

enum class Sheet : int8_t { back = -1, unknown = 0, front = 1 };
Sheet other(Sheet sheet) { return static_cast<Sheet>(-static_cast<int>(sheet)); }

class Cutter {
public:
    Cutter(const hmf_hierarchy& h, Lines& lines, Call& call) : h_(h), lines_(lines), call_(call) {}

    hmf_status run() {
        sheet_.start(call_.memory);
        list_.start(call_.memory);
        offsets_.start(call_.memory);
        points_.start(call_.memory);
        edges_.start(call_.memory);
        if (!offsets_.push(0) || !find_boundary()) return call_.out_of_memory();
        for (size_t k = 0; k < lines_.list.size(); ++k) {
            if (k % 256 == 0 && !call_.tick(0.95)) return call_.was_cancelled();
            const size_t first = static_cast<size_t>(lines_.offsets[k]);
            const size_t points = static_cast<size_t>(lines_.offsets[k + 1]) - first;
            if (points >= 2) {
                if (!add_pieces(lines_.list[k], first, points)) return call_.out_of_memory();
            } else if (points == 0) { // nowhere
                if (!list_.push(lines_.list[k]) || !offsets_.push(edges_.size())) return call_.out_of_memory();
            }
        }
        lines_.list.swap(list_);
        lines_.offsets.swap(offsets_);
        lines_.points.swap(points_);
        lines_.edges.swap(edges_);
        return HMF_OK;
    }

private:
    Done find_boundary() {
        if (!on_boundary_.allocate_filled(call_.memory, h_.surface_edges, uint8_t{0})
            || !end_.allocate_filled(call_.memory, size_t{2} * h_.input.edge_count, NONE))
            return false;
        for (size_t t = 0; t < h_.input.face_count; ++t)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t e = h_.triangle_edges[3 * t + s];
                if (t < h_.surface_triangles) on_boundary_[e] ^= 1;
                end_[size_t{2} * e] = h_.triangle_vertices[3 * t + s];
                end_[size_t{2} * e + 1] = h_.triangle_vertices[3 * t + (s + 1) % 3];
            }
        return true;
    }

    // Then its edge does not determine the side.
    bool is_at_boundary_vertex(size_t point) const {
        const uint32_t e = lines_.edges[point];
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = end_[size_t{2} * e + k];
            if (v >= h_.surface_vertices || !h_.mirror.is_boundary(v)) continue;
            const double* x = h_.levels[0].position + size_t{3} * h_.vertex_internal[v];
            const double* p = &lines_.points[3 * point];
            if (p[0] == x[0] && p[1] == x[1] && p[2] == x[2]) return true;
        }
        return false;
    }

    Sheet sheet_at(size_t point) const {
        const uint32_t e = lines_.edges[point];
        if (e == NONE || is_at_boundary_vertex(point)) return Sheet::unknown;
        if (e >= h_.surface_edges) return Sheet::back;
        return on_boundary_[e] ? Sheet::unknown : Sheet::front;
    }

    bool changes_sides(size_t point) const {
        const uint32_t e = lines_.edges[point];
        return e < h_.surface_edges && on_boundary_[e] && !is_at_boundary_vertex(point);
    }

    // Undetermined parts count as front: they are parts of the boundary itself.
    Done find_sheets(size_t first, size_t points, bool closed) {
        const size_t segments = closed ? points : points - 1;
        for (size_t i = 0; i < segments; ++i) {
            if (!call_.work(64, 0.95, false)) return false;
            const Sheet a = sheet_at(first + i), b = sheet_at(first + (i + 1) % points);
            sheet_[i] = a != Sheet::unknown ? a : b;
        }
        const auto spread = [&](size_t from, size_t to, size_t point) {
            if (sheet_[to] == Sheet::unknown && sheet_[from] != Sheet::unknown)
                sheet_[to] = changes_sides(first + point) ? other(sheet_[from]) : sheet_[from];
        };
        for (int round = 0; round < 2; ++round) { // twice: around the end of a closed line
            for (size_t i = 1; i < segments; ++i) {
                if (!call_.work(16, 0.95, false)) return false;
                spread(i - 1, i, i);
            }
            if (closed) spread(segments - 1, 0, 0);
        }
        for (size_t i = segments; i-- > 1;) spread(i, i - 1, i);
        for (size_t i = 0; i < segments; ++i)
            if (sheet_[i] == Sheet::unknown) sheet_[i] = Sheet::front;
        return call_.work(32 * segments, 0.95, false);
    }

    Done add_pieces(const hmf_line& line, size_t first, size_t points) {
        const size_t segments = line.closed ? points : points - 1;
        sheet_.clear();
        for (size_t i = 0; i < segments; ++i)
            if (!sheet_.push(Sheet::unknown)) return false;
        if (!find_sheets(first, points, line.closed)) return false;
        // A closed line begins where it comes to the front.
        size_t start = 0;
        while (line.closed && start < segments
               && (sheet_[start] == Sheet::back || sheet_[(start + segments - 1) % segments] == Sheet::front))
            ++start;
        if (start == segments && sheet_[0] == Sheet::front) return add_piece(line, first, points, 0, segments);
        for (size_t i = 0; i < segments;) {
            const auto at = [&](size_t k) { return sheet_[(start + k) % segments]; };
            if (at(i) == Sheet::back) {
                ++i;
                continue;
            }
            size_t n = 0;
            while (i + n < segments && at(i + n) == Sheet::front) ++n;
            if (!add_piece(line, first, points, (start + i) % segments, n)) return false;
            i += n;
        }
        return true;
    }

    Done add_piece(hmf_line line, size_t first, size_t points, size_t from, size_t segments) {
        const bool whole = line.closed && segments == points;
        const double all = line.length;
        line.length = 0;
        for (size_t k = 0; k < segments; ++k) {
            const size_t here = first + (from + k) % points, next = first + (from + k + 1) % points;
            line.length += distance(&lines_.points[3 * here], &lines_.points[3 * next]);
        }
        // To and fro across a boundary that it runs along, or ends at.
        if (!whole && line.length < SLIVER * all) return true;
        if (!whole && (line.closed || from > 0)) line.begin = HMF_END_BOUNDARY;
        if (!whole && (line.closed || from + segments + 1 < points)) line.end = HMF_END_BOUNDARY;
        line.closed = whole;
        line.begin_zero = line.end_zero = line.cylinder = HMF_NONE;
        for (size_t k = 0; k < segments + !whole; ++k) {
            if (!call_.work(64, 0.95, false)) return false;
            const size_t here = first + (from + k) % points;
            const double* p = &lines_.points[3 * here];
            for (size_t c = 0; c < 3; ++c)
                if (!points_.push(p[c])) return false;
            // A vertex of the boundary may have come with an edge behind it.
            const uint32_t e = lines_.edges[here];
            if (!edges_.push(e < h_.surface_edges ? e : NONE)) return false;
        }
        if (!list_.push(line)) return false;
        return offsets_.push(edges_.size());
    }

    const hmf_hierarchy& h_;
    Lines& lines_;
    Call& call_;
    Array<uint8_t> on_boundary_; // per edge in front
    Array<uint32_t> end_;        // per edge of the double: its two vertices
    Array<Sheet> sheet_;         // of the parts of a line, each from a point to the next
    Array<hmf_line> list_;
    Array<uint64_t> offsets_;
    Array<double> points_;
    Array<uint32_t> edges_;
};

} // namespace

hmf_status keep_front(const hmf_hierarchy& hierarchy, Lines& lines, Call& call) {
    Cutter cutter(hierarchy, lines, call);
    return cutter.run();
}

} // namespace hmf
