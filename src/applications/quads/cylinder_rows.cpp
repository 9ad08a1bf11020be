#include "cylinder_rows.hpp"

#include "../lines/polyline.hpp"
#include "quad_numbers.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr double MOST_SHIFT = 1e15; // of the columns of two boundaries: what doubles tell apart

// The place of a column on a row that begins at `here`.
double on_row(double place, double here) {
    place -= here;
    return place - std::floor(place);
}

} // namespace

CylinderRows::CylinderRows(const QuadInput& in, const GridSizes& sizes, const GraphPoints& points, QuadMesh& out,
                           Call& call) :
    in_(in),
    sizes_(sizes), points_(points), out_(out), call_(call) {
    ruler_.start(call.memory);
    leaf_.start(call.memory);
    height_.start(call.memory);
    lower_.start(call.memory);
    upper_.start(call.memory);
    all_.start(call.memory);
}

hmf_status CylinderRows::fill(uint32_t cylinder) {
    const Part part = in_.part_of(cylinder);
    if (part == Part::back) return HMF_OK;
    if (part == Part::strip) return fill_strip(cylinder);
    if (part == Part::ring) return fill_ring(cylinder);
    return in_.is_annulus() ? fill_annulus(cylinder) : fill_closed(cylinder);
}

hmf_status CylinderRows::torn(uint32_t cylinder) {
    return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                      "The half of a cylinder in front has gaps. Please report it.");
}

// Half units of row k above the lower side.
int64_t CylinderRows::height_of_row(uint32_t cylinder, int64_t k) const {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const int64_t height = static_cast<int64_t>(2 * static_cast<double>(c.height) * static_cast<double>(k)
                                                / static_cast<double>(sizes_.rows[cylinder]))
                         | 1;
    return std::min(height, 2 * c.height - 1);
}

// The leaves of this many rows above the lower boundary.
Done CylinderRows::set_heights(uint32_t cylinder, int64_t rows) {
    height_.clear();
    ends_at_boundary_ = false;
    for (int64_t k = 1; k <= rows; ++k)
        if (!height_.push(height_of_row(cylinder, k))) return false;
    return here_.allocate(call_.memory, height_.size());
}

// The leaf at a height into leaf_.
hmf_status CylinderRows::find_leaf(uint32_t cylinder, int64_t height) {
    const Crossing start = leaf_at(in_.f, in_.cylinders, cylinder, height);
    if (!call_.tick(0)) return call_.was_cancelled();
    if (!closed_leaf(in_.f, start, in_.graph.crossing_limit(), leaf_))
        return call_.memory.failure()
                 ? call_.out_of_memory()
                 : call_.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0, "A leaf crosses too many edges.");
    return HMF_OK;
}

// The leaf at a height into ruler_.  shift: it runs beside the boundary, which is taken instead: 1 on its left, -1 on
// its right.
hmf_status CylinderRows::read_leaf_at(uint32_t cylinder, int64_t height, int64_t shift) {
    if (find_leaf(cylinder, height)) return call_.status();
    ruler_.clear();
    double v = 0;
    for (size_t i = 0; i <= leaf_.size(); ++i) {
        const Crossing& at = leaf_[i < leaf_.size() ? i : 0];
        const uint32_t end = shift > 0 ? in_.f.mesh.target(at.half_edge) : in_.f.mesh.origin[at.half_edge];
        if (!(shift != 0 ? ruler_.push_on_boundary(in_, v, end, shift < 0)
                         : ruler_.push(v, in_.place_of(at), twin(at.half_edge))))
            return call_.out_of_memory();
        v += in_.conjugate.step(at);
    }
    return ruler_.v.empty() ? torn(cylinder) : HMF_OK;
}

hmf_status CylinderRows::read_row(uint32_t cylinder, size_t k) {
    return read_leaf_at(cylinder, height_[k], ends_at_boundary_ && k + 1 == height_.size() ? -1 : 0);
}

// The upper boundary into ruler_, in the direction of the rows: its leaf runs the other way.
Done CylinderRows::read_upper(uint32_t boundary) {
    const Boundary& b = in_.graph.boundaries[boundary];
    ruler_.clear();
    for (uint64_t i = b.end; i-- > b.begin;) {
        const Crossing& c = in_.graph.crossings[i];
        if (!ruler_.push(points_.length(boundary) - points_.v(i), in_.place_of({c.half_edge, c.at + 1}), c.half_edge))
            return false;
    }
    return true;
}

// Of the points of the lower row, as parts of its length; they are the row before.
Done CylinderRows::set_places(double length) {
    const size_t n = lower_.v.size();
    if (!place_.allocate(call_.memory, n) || !before_.allocate(call_.memory, n)) return false;
    for (size_t j = 0; j < n; ++j) {
        place_[j] = lower_.v[j] / length;
        before_[j] = at(out_, lower_.vertex[j]);
    }
    return true;
}

// Where the columns of the lower row meet the row of ruler_.
void CylinderRows::points_of_row(double here) {
    for (size_t j = 0; j < place_.size(); ++j) ruler_.point(on_row(place_[j], here) * ruler_.length(), before_[j]);
}

// Where a row begins, as a part of its length: it is turned so that straight columns from the row before are short, and
// meet it at right angles in the mean.
double CylinderRows::align_row() const {
    const size_t n = place_.size();
    const double round = ruler_.length(), h = 0.25 / static_cast<double>(n);
    const auto misfit = [&](double here) {
        double sum = 0;
        for (size_t i = 0; i < SAMPLES; ++i) {
            const size_t j = i * n / SAMPLES;
            Point p;
            ruler_.point(on_row(place_[j], here) * round, p);
            sum += square_of(p - before_[j]);
        }
        return sum;
    };
    double here = 0, least = HUGE_VAL;
    const auto try_at = [&](double turn) {
        const double there = misfit(turn);
        if (!(there < least)) return;
        least = there;
        here = turn;
    };
    const double coarse = 0.25 / SAMPLES;
    for (size_t t = 0; t < 4 * SAMPLES; ++t) try_at(static_cast<double>(t) * coarse);
    for (double step = coarse / 2; step > h; step /= 2) {
        const double middle = here;
        try_at(middle - step);
        try_at(middle + step);
    }
    for (int tries = 0; tries < 3; ++tries) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) {
            Point p, q, r;
            ruler_.point(on_row(place_[j] - h, here) * round, q);
            ruler_.point(on_row(place_[j], here) * round, p);
            ruler_.point(on_row(place_[j] + h, here) * round, r);
            // At most a column.
            const double square = square_of(r - q), off = square > 0 ? 2 * h * dot(before_[j] - p, r - q) / square : 0;
            sum += std::min(std::max(off, -4 * h), 4 * h);
        }
        here -= sum / static_cast<double>(n);
    }
    return here;
}

// Where each row inside begins.
hmf_status CylinderRows::align_rows(uint32_t cylinder) {
    for (size_t k = 0; k < height_.size(); ++k) {
        if (read_row(cylinder, k)) return call_.status();
        here_[k] = align_row();
        points_of_row(here_[k]);
    }
    return HMF_OK;
}

// The vertices of the rows inside.  slant(j): of column j from the lower boundary to the upper one.
template <class Slant>
hmf_status CylinderRows::place_rows(uint32_t cylinder, const Slant& slant) {
    const double rows = static_cast<double>(sizes_.rows[cylinder]);
    for (size_t k = 0; k < height_.size(); ++k) {
        if (read_row(cylinder, k)) return call_.status();
        const uint8_t held = ends_at_boundary_ && k + 1 == height_.size() ? AT_BOUNDARY : 0;
        for (size_t j = 0; j < place_.size(); ++j) {
            const double place = place_[j] + static_cast<double>(k + 1) / rows * slant(static_cast<int64_t>(j));
            Point p;
            const uint32_t side = ruler_.point(on_row(place, here_[k]) * ruler_.length(), p);
            if (!out_.add_vertex(p, side, held)) return call_.out_of_memory();
        }
    }
    return HMF_OK;
}

// vertex(k, j): of row k from below, column j.  The cylinder lies right of its lower leaf.
template <class Vertex>
hmf_status CylinderRows::add_grid(int64_t rows, int64_t columns, const Vertex& vertex) {
    for (int64_t k = 0; k < rows; ++k)
        for (int64_t j = 0; j < columns; ++j)
            if (!out_.add_quad(vertex(k, j), vertex(k + 1, j), vertex(k + 1, j + 1), vertex(k, j + 1)))
                return call_.out_of_memory();
    return HMF_OK;
}

// Both boundaries are critical leaves.
hmf_status CylinderRows::fill_closed(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const int64_t m = sizes_.rows[cylinder];
    if (!points_.read_row(c.lower, lower_) || !points_.read_row(c.upper, upper_) || !set_heights(cylinder, m - 1))
        return call_.out_of_memory();
    const int64_t n = static_cast<int64_t>(lower_.vertex.size());
    if (static_cast<int64_t>(upper_.vertex.size()) != n)
        return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                          "The boundaries of a cylinder have different numbers of columns. Please report it.");
    const double lower_length = points_.length(c.lower), upper_length = points_.length(c.upper);
    if (!set_places(lower_length)) return call_.out_of_memory();
    if (align_rows(cylinder)) return call_.status();
    if (!read_upper(c.upper)) return call_.out_of_memory();
    const double turn = align_row();
    const auto high = [&](int64_t j) { // the upper leaf runs the other way; j of any size
        const int64_t wraps = j >= 0 ? j / n : -((n - 1 - j) / n);
        return turn - upper_.v[static_cast<size_t>(j - wraps * n)] / upper_length - static_cast<double>(wraps);
    };
    double shift = 0;
    for (int64_t j = 0; j < n; ++j) shift += high(-j) - place_[static_cast<size_t>(j)];
    // The column of the upper boundary that column 0 leads to: one on is a part 1 / n less.  Any whole number makes a
    // closed mesh.
    const int64_t offset = std::fabs(shift) < MOST_SHIFT ? static_cast<int64_t>(std::floor(shift + 0.5)) : 0;
    const uint32_t base = out_.vertex_count();
    if (place_rows(cylinder, [&](int64_t j) { return high(offset - j) - place_[static_cast<size_t>(j)]; }))
        return call_.status();
    return add_grid(m, n, [&](int64_t k, int64_t j) {
        if (k == 0) return lower_.vertex[static_cast<size_t>(j % n)];
        if (k == m) return upper_.vertex[static_cast<size_t>(((offset - j) % n + n) % n)];
        return base + static_cast<uint32_t>((k - 1) * n + j % n);
    });
}

// Rows from the lower one to the boundary.
hmf_status CylinderRows::add_rings(uint32_t cylinder) {
    const int64_t n = static_cast<int64_t>(place_.size());
    const uint32_t base = out_.vertex_count();
    ends_at_boundary_ = true;
    if (align_rows(cylinder) || place_rows(cylinder, [](int64_t) { return 0.0; })) return call_.status();
    return add_grid(static_cast<int64_t>(height_.size()), n, [&](int64_t k, int64_t j) {
        return k == 0 ? lower_.vertex[static_cast<size_t>(j % n)] : base + static_cast<uint32_t>((k - 1) * n + j % n);
    });
}

// Up to the boundary curve in the middle, which is the last row.
hmf_status CylinderRows::fill_ring(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const double length = points_.length(c.lower);
    if (!points_.read_row(c.lower, lower_) || !set_heights(cylinder, sizes_.rows[cylinder] / 2))
        return call_.out_of_memory();
    for (const uint32_t v : lower_.vertex)
        if (v == NONE) return torn(cylinder);
    if (!set_places(length)) return call_.out_of_memory();
    height_[height_.size() - 1] = c.height - 1;
    return add_rings(cylinder);
}

// Between its two boundary curves, both leaves.
hmf_status CylinderRows::fill_annulus(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const int64_t n = sizes_.ring, rows = sizes_.rows[cylinder] / 2;
    if (!set_heights(cylinder, rows)) return call_.out_of_memory();
    int64_t from = -1, to = -1;
    for (uint64_t i = c.path_begin; i < c.path_end; ++i) {
        const PathPiece& p = in_.cylinders.pieces[i];
        if (p.from != 0 || !in_.front->reflection->is_boundary[in_.f.mesh.origin[p.half_edge]]) continue;
        const bool to_front =
            in_.front->reflection->is_front[p.half_edge] || in_.front->reflection->is_front[twin(p.half_edge)];
        if (to_front && from < 0) from = p.height;
        if (!to_front && from >= 0 && to < 0) to = p.height;
    }
    if (from < 0 || to < 0) return torn(cylinder);
    for (size_t k = 0; k < height_.size(); ++k) {
        const double t = static_cast<double>(k + 1) / static_cast<double>(rows);
        height_[k] = static_cast<int64_t>(static_cast<double>(from) + t * static_cast<double>(to - from)) | 1;
    }
    height_[height_.size() - 1] = to - 1;
    if (read_leaf_at(cylinder, from + 1, 1)) return call_.status();
    lower_.clear();
    for (int64_t j = 0; j < n; ++j) {
        const double place = static_cast<double>(j) / static_cast<double>(n);
        Point p;
        const uint32_t side = ruler_.point(place * ruler_.length(), p);
        if (!lower_.push(out_.vertex_count(), place) || !out_.add_vertex(p, side, AT_BOUNDARY))
            return call_.out_of_memory();
    }
    if (!set_places(1)) return call_.out_of_memory();
    return add_rings(cylinder);
}

// Of a boundary leaf that the boundary crosses twice the points in front, in the order of the leaf, with
// places from 0 to 1.
hmf_status CylinderRows::read_front_row(uint32_t cylinder, uint32_t boundary, PointRow& row) {
    const PointRow& all = all_;
    if (!points_.read_row(boundary, all_)) return call_.out_of_memory();
    const size_t n = all.vertex.size(), half = n / 2;
    const double round = points_.length(boundary);
    // Behind only zeros of the boundary have a vertex, and none of two in a row.
    size_t start = 0, found = 0;
    while (start < n && found <= half) {
        for (found = 0; found <= half && all.vertex[(start + found) % n] != NONE; ++found) {}
        start += found <= half;
    }
    if (found <= half || n % 2 != 0) return torn(cylinder);
    row.clear();
    for (size_t j = 0; j <= half; ++j) {
        const size_t k = (start + j) % n;
        if (!row.push(all.vertex[k], all.v[k] + (start + j >= n ? round : 0))) return call_.out_of_memory();
    }
    const double from = row.v[0], length = row.v[half] - from;
    for (double& v : row.v) v = length > 0 ? (v - from) / length : 0;
    return HMF_OK;
}

// The part of leaf_ in front into ruler_.
hmf_status CylinderRows::rule_front(uint32_t cylinder) {
    const size_t n = leaf_.size();
    size_t i = 0;
    while (i < n && !in_.front->crosses_to_front(leaf_[i])) ++i;
    if (i == n) return torn(cylinder);
    ruler_.clear();
    double v = 0;
    for (size_t k = 0; k < n; ++k, ++i) {
        const Crossing& at = leaf_[i % n];
        const bool ends = in_.front->crosses_to_back(at);
        if (!ruler_.push(v, in_.place_of(at), ends ? at.half_edge : twin(at.half_edge))) return call_.out_of_memory();
        if (ends) return HMF_OK;
        v += in_.conjugate.step(at);
    }
    return torn(cylinder);
}

// A point of the line of ruler_, which begins and ends on the boundary.
uint32_t CylinderRows::place_on_strip(double place, bool begins, bool ends, Point& p) const {
    return begins ? ruler_.begin(p) : ends ? ruler_.end(p) : ruler_.point(place * ruler_.length(), p);
}

// The first leaf of an annulus from boundary to boundary: both ends of the strip.
hmf_status CylinderRows::start_strip_of_annulus(uint32_t cylinder) {
    if (find_leaf(cylinder, 1) || rule_front(cylinder)) return call_.status();
    lower_.clear();
    upper_.clear();
    const uint32_t first = out_.vertex_count(), n = static_cast<uint32_t>(sizes_.ring / 2);
    for (uint32_t j = 0; j <= n; ++j) {
        const double t = static_cast<double>(j) / static_cast<double>(n);
        Point p;
        const uint32_t side = place_on_strip(t, j == 0, j == n, p);
        if (!out_.add_vertex(p, side, j == 0 || j == n ? AT_BOUNDARY : uint8_t{0}) || !lower_.push(first + j, t)
            || !upper_.push(first + (n - j), t))
            return call_.out_of_memory();
    }
    return HMF_OK;
}

// From the boundary to the boundary: a rectangle.
hmf_status CylinderRows::fill_strip(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    if (in_.is_annulus() ? start_strip_of_annulus(cylinder)
                         : read_front_row(cylinder, c.lower, lower_) || read_front_row(cylinder, c.upper, upper_))
        return call_.status();
    const int64_t n = static_cast<int64_t>(lower_.vertex.size()) - 1, m = sizes_.rows[cylinder];
    if (static_cast<int64_t>(upper_.vertex.size()) != n + 1) return torn(cylinder);
    const uint32_t base = out_.vertex_count();
    for (int64_t k = 1; k < m; ++k) {
        const double y = static_cast<double>(k) / static_cast<double>(m);
        if (find_leaf(cylinder, height_of_row(cylinder, k)) || rule_front(cylinder)) return call_.status();
        for (int64_t j = 0; j <= n; ++j) {
            const double place =
                (1 - y) * lower_.v[static_cast<size_t>(j)] + y * (1 - upper_.v[static_cast<size_t>(n - j)]);
            Point p;
            const uint32_t side = place_on_strip(place, j == 0, j == n, p);
            if (!out_.add_vertex(p, side, j == 0 || j == n ? AT_BOUNDARY : uint8_t{0})) return call_.out_of_memory();
        }
    }
    return add_grid(m, n, [&](int64_t k, int64_t j) {
        if (k == 0) return lower_.vertex[static_cast<size_t>(j)];
        if (k == m) return upper_.vertex[static_cast<size_t>(n - j)];
        return base + static_cast<uint32_t>((k - 1) * (n + 1) + j);
    });
}

} // namespace hmf
