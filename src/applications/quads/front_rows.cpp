// Cylinders of an exactly symmetric double that lie in front in part: rows around a boundary curve,
// and strips from boundary to boundary.
#include "cylinder_rows.hpp"

#include "../lines/polyline.hpp"

#include <cmath>

namespace hmf {

hmf_status CylinderRows::torn(uint32_t cylinder) {
    return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                      "The half of a cylinder in front has gaps. Please report it.");
}

// Rows around a cylinder above the lower one, each aligned to the one before.  height: of row k.  The last one
// lies on the boundary.
template <class Height>
hmf_status CylinderRows::stack_rows(uint32_t cylinder, int64_t rows, double whole, const Height& height) {
    const size_t n = lower_.vertex.size();
    if (!start_rows(1) || !row_.allocate(call_.memory, 2 * n)) return call_.out_of_memory();
    for (size_t j = 0; j < n; ++j) row_[j] = lower_.vertex[j];
    double path_before = 0, path = 0, here = 0, p[3];
    for (int64_t k = 1; k <= rows; ++k) {
        const bool is_last = k == rows;
        if (read_leaf_at(cylinder, height(k), is_last ? -1 : 0, path)) return call_.status();
        if (k > 1 || !in_.is_annulus()) here += (path - path_before) / whole;
        path_before = path;
        here = align_row(ruler_, before_.data(), here);
        points_of_row(ruler_, here, before_.data());
        for (size_t j = 0; j < n; ++j) {
            double place = place_[j] - here;
            place -= std::floor(place);
            row_[n + j] = out_.vertex_count();
            const uint32_t side = ruler_.point(place * ruler_.v.back(), p);
            if (!out_.add_vertex(p, side, is_last ? AT_BOUNDARY : uint8_t{0})) return call_.out_of_memory();
        }
        for (size_t j = 0; j < n; ++j) {
            const size_t next = (j + 1) % n;
            if (!out_.add_quad(row_[j], row_[n + j], row_[n + next], row_[next])) return call_.out_of_memory();
        }
        for (size_t j = 0; j < n; ++j) row_[j] = row_[n + j];
    }
    return HMF_OK;
}

// Up to the boundary curve in the middle, which is the last row.
hmf_status CylinderRows::fill_ring(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const double length = points_.length(c.lower);
    const int64_t half = sizes_.rows[cylinder] / 2;
    if (!points_.read_row(c.lower, lower_) || !read_path(c) || !set_places(length)) return call_.out_of_memory();
    for (const uint32_t v : lower_.vertex)
        if (v == NONE) return torn(cylinder);
    return stack_rows(cylinder, half, length,
                      [&](int64_t k) { return k == half ? c.height - 1 : height_of_row(cylinder, k); });
}

// Between its two boundary curves, both leaves.
hmf_status CylinderRows::fill_annulus(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    if (!read_path(c)) return call_.out_of_memory();
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
    const int64_t n = sizes_.ring, rows = sizes_.rows[cylinder] / 2;
    double path = 0, p[3];
    if (read_leaf_at(cylinder, from + 1, 1, path)) return call_.status();
    lower_.clear();
    for (int64_t j = 0; j < n; ++j) {
        const double place = static_cast<double>(j) / static_cast<double>(n);
        const uint32_t side = ruler_.point(ruler_.v.back() * static_cast<double>(j) / static_cast<double>(n), p);
        if (!lower_.push(out_.vertex_count(), place) || !out_.add_vertex(p, side, AT_BOUNDARY))
            return call_.out_of_memory();
    }
    if (!set_places(1)) return call_.out_of_memory();
    return stack_rows(cylinder, rows, ruler_.v.back(), [&](int64_t k) {
        const double t = static_cast<double>(k) / static_cast<double>(rows);
        return k == rows ? to - 1
                         : static_cast<int64_t>(static_cast<double>(from) + t * static_cast<double>(to - from)) | 1;
    });
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
    double v = 0, p[3];
    for (size_t k = 0; k < n; ++k, ++i) {
        const Crossing& at = leaf_[i % n];
        point_at(in_.f, in_.position, at, p);
        const bool ends = in_.front->crosses_to_back(at);
        if (!ruler_.push(v, p, ends ? at.half_edge : twin(at.half_edge))) return call_.out_of_memory();
        if (ends) return HMF_OK;
        v += in_.conjugate.step(at);
    }
    return torn(cylinder);
}

// Its lower and its upper row.
hmf_status CylinderRows::start_strip(uint32_t cylinder) {
    if (in_.is_annulus()) return start_strip_of_annulus(cylinder);
    const Cylinder& c = in_.cylinders.list[cylinder];
    if (read_front_row(cylinder, c.lower, lower_)) return call_.status();
    return read_front_row(cylinder, c.upper, upper_);
}

// The first leaf of an annulus from boundary to boundary: both ends of the strip.
hmf_status CylinderRows::start_strip_of_annulus(uint32_t cylinder) {
    uint64_t piece = 0;
    if (find_leaf(cylinder, 1, piece) || rule_front(cylinder)) return call_.status();
    lower_.clear();
    upper_.clear();
    const uint32_t first = out_.vertex_count();
    const uint32_t n = static_cast<uint32_t>(sizes_.ring / 2);
    for (uint32_t j = 0; j <= n; ++j) {
        const double t = static_cast<double>(j) / static_cast<double>(n);
        double p[3];
        const uint32_t side = ruler_.point(t * ruler_.v.back(), p);
        const bool held = j == 0 || j == n;
        if (!out_.add_vertex(p, side, held ? AT_BOUNDARY : uint8_t{0}) || !lower_.push(first + j, t)
            || !upper_.push(first + (n - j), t))
            return call_.out_of_memory();
    }
    return HMF_OK;
}

// Between the lower and the upper row.
hmf_status CylinderRows::add_strip_rows(uint32_t cylinder, int64_t n) {
    for (int64_t k = 1; k < sizes_.rows[cylinder]; ++k) {
        const double y = static_cast<double>(k) / static_cast<double>(sizes_.rows[cylinder]);
        uint64_t piece = 0;
        if (find_leaf(cylinder, height_of_row(cylinder, k), piece) || rule_front(cylinder)) return call_.status();
        for (int64_t j = 0; j <= n; ++j) {
            const double place =
                (1 - y) * lower_.v[static_cast<size_t>(j)] + y * (1 - upper_.v[static_cast<size_t>(n - j)]);
            double p[3];
            const uint32_t side = ruler_.point(place * ruler_.v.back(), p);
            const bool held = j == 0 || j == n;
            if (!out_.add_vertex(p, side, held ? AT_BOUNDARY : uint8_t{0})) return call_.out_of_memory();
        }
    }
    return HMF_OK;
}

// From the boundary to the boundary: a rectangle.
hmf_status CylinderRows::fill_strip(uint32_t cylinder) {
    if (start_strip(cylinder)) return call_.status();
    const int64_t n = static_cast<int64_t>(lower_.vertex.size()) - 1, m = sizes_.rows[cylinder];
    if (static_cast<int64_t>(upper_.vertex.size()) != n + 1) return torn(cylinder);
    const uint32_t base = out_.vertex_count();
    if (add_strip_rows(cylinder, n)) return call_.status();
    const auto vertex = [&](int64_t k, int64_t j) {
        if (k == 0) return lower_.vertex[static_cast<size_t>(j)];
        if (k == m) return upper_.vertex[static_cast<size_t>(n - j)];
        return base + static_cast<uint32_t>((k - 1) * (n + 1) + j);
    };
    for (int64_t k = 0; k < m; ++k)
        for (int64_t j = 0; j < n; ++j)
            if (!out_.add_quad(vertex(k, j), vertex(k + 1, j), vertex(k + 1, j + 1), vertex(k, j + 1)))
                return call_.out_of_memory();
    return HMF_OK;
}

} // namespace hmf
