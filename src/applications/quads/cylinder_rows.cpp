// What all cylinders need, and cylinders that lie in front as a whole; the others: front_rows.cpp.
#include "cylinder_rows.hpp"

#include "../lines/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmf {

constexpr double MOST_SHIFT = 1e15; // of the columns of two boundaries: what doubles tell apart

CylinderRows::CylinderRows(const QuadInput& in, const GridSizes& sizes, const GraphPoints& points, QuadMesh& out,
                           Call& call) :
    in_(in),
    sizes_(sizes), points_(points), out_(out), call_(call), leaves_(in, call) {
    ruler_.start(call.memory);
    leaf_.start(call.memory);
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

// v along the path across a cylinder up to each piece, and at its end.
Done CylinderRows::read_path(const Cylinder& c) {
    twist_.start(call_.memory);
    double v = 0;
    for (uint64_t i = c.path_begin; i < c.path_end; ++i) {
        const PathPiece& p = in_.cylinders.pieces[i];
        if (!twist_.push(v)) return false;
        v += in_.conjugate.along(p.half_edge) * static_cast<double>(p.to - p.from)
           / static_cast<double>(width(in_.f, p.half_edge));
    }
    return twist_.push(v);
}

double CylinderRows::twist_at(const Cylinder& c, uint64_t piece, int64_t height) const {
    const PathPiece& p = in_.cylinders.pieces[piece];
    const double t = p.to > p.from ? static_cast<double>(height - p.height) / static_cast<double>(p.to - p.from) : 0;
    const size_t i = static_cast<size_t>(piece - c.path_begin);
    return twist_[i] + t * (twist_[i + 1] - twist_[i]);
}

// The place where the path arrives on the upper boundary leaf.
double CylinderRows::arrival(const Cylinder& c) const {
    const PathPiece& p = in_.cylinders.pieces[c.path_end - 1];
    const Boundary& b = in_.graph.boundaries[c.upper];
    // The upper leaf crosses the last half-edge from its left to its right.
    for (uint64_t i = b.begin; i + 1 < b.end; ++i)
        if (in_.graph.crossings[i] == Crossing{p.half_edge, p.to}) return points_.v(i);
    return 0;
}

// Half units of row k above the lower side.
int64_t CylinderRows::height_of_row(uint32_t cylinder, int64_t k) const {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const int64_t height = static_cast<int64_t>(2 * static_cast<double>(c.height) * static_cast<double>(k)
                                                / static_cast<double>(sizes_.rows[cylinder]))
                         | 1;
    return std::min(height, 2 * c.height - 1);
}

// The leaf at a height into leaf_, with the piece of the path that it crosses.
hmf_status CylinderRows::find_leaf(uint32_t cylinder, int64_t height, uint64_t& piece) {
    const Crossing start = in_.cylinders.leaf_at(in_.f, cylinder, height, &piece);
    if (!call_.tick(0)) return call_.was_cancelled();
    if (!closed_leaf(in_.f, start, in_.graph.crossing_limit(), leaf_))
        return call_.memory.failure()
                 ? call_.out_of_memory()
                 : call_.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0, "A leaf crosses too many edges.");
    return HMF_OK;
}

// The leaf at a height into ruler_, and v along the path up to it.  shift: it runs beside the boundary, which is
// taken instead: 1 on its left, -1 on its right.
hmf_status CylinderRows::read_leaf_at(uint32_t cylinder, int64_t height, int64_t shift, double& twist) {
    uint64_t piece = 0;
    if (find_leaf(cylinder, height, piece)) return call_.status();
    ruler_.clear();
    double v = 0, p[3];
    for (size_t i = 0; i <= leaf_.size(); ++i) {
        const Crossing& at = leaf_[i < leaf_.size() ? i : 0];
        point_at(in_.f, in_.position, at, p);
        const uint32_t end = shift > 0 ? in_.f.mesh.target(at.half_edge) : in_.f.mesh.origin[at.half_edge];
        if (!(shift != 0 ? ruler_.push_on_boundary(in_, v, end, shift < 0) : ruler_.push(v, p, twin(at.half_edge))))
            return call_.out_of_memory();
        v += in_.conjugate.step(at);
    }
    if (ruler_.v.empty()) return torn(cylinder);
    twist = twist_at(in_.cylinders.list[cylinder], piece, height);
    return HMF_OK;
}

// Of the points of the lower row, as parts of its length.
Done CylinderRows::set_places(double length) {
    if (!place_.allocate(call_.memory, lower_.v.size())) return false;
    for (size_t j = 0; j < place_.size(); ++j) place_[j] = lower_.v[j] / length;
    return true;
}

// The lower row is the previous one. Reserves space for the given number of rows.
Done CylinderRows::start_rows(uint32_t rows) {
    const size_t n = lower_.vertex.size();
    if (!before_.allocate(call_.memory, 3 * n * rows)) return false;
    for (size_t j = 0; j < n; ++j)
        for (size_t k = 0; k < 3; ++k) before_[3 * j + k] = out_.positions[size_t{3} * lower_.vertex[j] + k];
    return true;
}

// The place of a column on a row that the path meets at `here`.
static double on_row(double place, double here) {
    place -= here;
    return place - std::floor(place);
}

// Where the columns of the lower row meet a row.
void CylinderRows::points_of_row(const Ruler& row, double here, double* points) const {
    const double round = row.v.back();
    size_t piece = 0;
    for (size_t j = 0; j < place_.size(); ++j) row.point(on_row(place_[j], here) * round, points + 3 * j, piece);
}

// The turn of a row, as a part of its length, that brings it nearest to the row before; 0 where it is
// within a few columns as it is.  Sizes are squared, of some columns.
double CylinderRows::coarse_turn(const Ruler& row, const double* before, double here) const {
    constexpr int64_t samples = 16, most_turns = 64;
    constexpr double near_enough = 9, better_by = 0.25; // squares of columns; of what there is without a turn
    const int64_t n = static_cast<int64_t>(place_.size());
    const double round = row.v.back();
    const auto column = [&](int64_t i) { return static_cast<size_t>(i % samples * n / samples); };
    const auto square_to = [](const double* a, const double* b) {
        double square = 0;
        for (int x = 0; x < 3; ++x) square += (a[x] - b[x]) * (a[x] - b[x]);
        return square;
    };
    const auto misfit = [&](double turn) {
        double sum = 0;
        for (int64_t i = 0; i < samples; ++i) {
            double p[3];
            row.point(on_row(place_[column(i)], here - turn) * round, p);
            sum += square_to(p, &before[3 * column(i)]);
        }
        return sum;
    };
    double columns = 0;
    for (int64_t i = 0; i < samples; ++i)
        columns += square_to(&before[3 * column(i)], &before[3 * ((column(i) + 1) % place_.size())]);
    const double now = misfit(0);
    double least = better_by * now, best = 0;
    for (int64_t t = 1; t < most_turns && now > near_enough * columns; ++t) {
        const double turn = static_cast<double>(t) / static_cast<double>(most_turns), there = misfit(turn);
        if (there >= least) continue;
        least = there;
        best = turn;
    }
    return best;
}

// Where the path meets a row that is turned so that straight columns from the row before meet it at right
// angles in the mean.
double CylinderRows::align_row(const Ruler& row, const double* before, double here) const {
    const size_t n = place_.size();
    const double round = row.v.back(), h = 0.25 / static_cast<double>(n);
    here -= coarse_turn(row, before, here); // where the path runs along thin triangles, v along it may be far off
    for (int tries = 0; tries < 3; ++tries) {
        double sum = 0;
        size_t piece = 0;
        for (size_t j = 0; j < n; ++j) {
            const double* from = before + 3 * j;
            double p[3], q[3], r[3], along = 0, square = 0;
            row.point(on_row(place_[j] - h, here) * round, q, piece);
            row.point(on_row(place_[j], here) * round, p, piece);
            row.point(on_row(place_[j] + h, here) * round, r, piece);
            for (int x = 0; x < 3; ++x) {
                along += (from[x] - p[x]) * (r[x] - q[x]);
                square += (r[x] - q[x]) * (r[x] - q[x]);
            }
            // At most a column.
            const double off = square > 0 ? 2 * h * along / square : 0;
            sum += off > 4 * h ? 4 * h : off < -4 * h ? -4 * h : off;
        }
        here -= sum / static_cast<double>(n);
    }
    return here;
}

hmf_status CylinderRows::read_rows(uint32_t cylinder, int64_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) leaves_[i + 1].height = height_of_row(cylinder, first + i);
    return leaves_.read(cylinder, 1, count + 1);
}

// Where the path meets each row, as a part of its length: at first by v along
// the path; then each row is turned so that straight columns from the row
// before meet it at right angles in the mean.  One path alone is as wrong
// as the thin triangles on it make it.
hmf_status CylinderRows::align_rows(uint32_t cylinder, double whole, double& turn) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    const int64_t m = sizes_.rows[cylinder];
    const uint32_t at_a_time = leaves_.at_a_time(cylinder);
    const size_t size = 3 * place_.size();
    if (!here_.allocate(call_.memory, static_cast<size_t>(m)) || !start_rows(at_a_time)) return call_.out_of_memory();
    const auto by_path = [&](uint32_t i) { return twist_at(c, leaves_[i].piece, leaves_[i].height) / whole; };
    double turned[LeafRows::MOST], path_before = 0, here = 0;
    for (int64_t first = 1; first < m; first += at_a_time) {
        const uint32_t count = static_cast<uint32_t>(std::min(int64_t{at_a_time}, m - first));
        if (read_rows(cylinder, first, count)) return call_.status();
        call_.parallel.for_each(count, [&](uint32_t i, uint32_t) {
            double* const before = &before_[i * size];
            if (first + i > 1) points_of_row(leaves_[i].ruler, by_path(i), before);
            turned[i] = align_row(leaves_[i + 1].ruler, before, by_path(i + 1)) - by_path(i + 1);
        });
        for (uint32_t i = 0; i < count; ++i) {
            here += by_path(i + 1) - path_before + turned[i];
            path_before = by_path(i + 1);
            here_[static_cast<size_t>(first + i)] = here;
        }
        std::swap(leaves_[0], leaves_[count]);
    }
    turn = here + twist_[twist_.size() - 1] / whole - path_before;
    return HMF_OK;
}

// The vertices of the rows between both boundaries.  offset: of the column of the upper one that column 0 leads to.
hmf_status CylinderRows::place_rows(uint32_t cylinder, double turn, double upper_length, double arrived,
                                    int64_t& offset) {
    const int64_t n = static_cast<int64_t>(place_.size()), m = sizes_.rows[cylinder];
    const auto high = [&](int64_t j) { // the upper leaf runs the other way; j of any size
        const int64_t wraps = j >= 0 ? j / n : -((n - 1 - j) / n);
        return turn + (arrived - upper_.v[static_cast<size_t>(j - wraps * n)]) / upper_length
             - static_cast<double>(wraps);
    };
    double shift = 0;
    for (int64_t j = 0; j < n; ++j) shift += high(-j) - place_[static_cast<size_t>(j)];
    // One column on is a part 1 / n less.  Any whole number makes a closed mesh.
    offset = std::fabs(shift) < MOST_SHIFT ? static_cast<int64_t>(std::floor(shift + 0.5)) : 0;
    const uint32_t at_a_time = leaves_.at_a_time(cylinder);
    for (int64_t first = 1; first < m; first += at_a_time) {
        const uint32_t count = static_cast<uint32_t>(std::min(int64_t{at_a_time}, m - first));
        const uint32_t base = out_.vertex_count();
        if (read_rows(cylinder, first, count)) return call_.status();
        if (!out_.add_vertices(count * static_cast<size_t>(n))) return call_.out_of_memory();
        call_.parallel.for_each(count, [&](uint32_t i, uint32_t) {
            const Ruler& row = leaves_[i + 1].ruler;
            const double y = static_cast<double>(first + i) / static_cast<double>(m), round = row.v.back();
            const double here = here_[static_cast<size_t>(first + i)];
            size_t piece = 0;
            for (int64_t j = 0; j < n; ++j) {
                const double place = (1 - y) * place_[static_cast<size_t>(j)] + y * high(offset - j);
                double p[3];
                const uint32_t side = row.point(on_row(place, here) * round, p, piece);
                out_.put(base + i * static_cast<uint32_t>(n) + static_cast<uint32_t>(j), p, side);
            }
        });
    }
    return HMF_OK;
}

// Both boundaries are critical leaves.
hmf_status CylinderRows::fill_closed(uint32_t cylinder) {
    const Cylinder& c = in_.cylinders.list[cylinder];
    if (!points_.read_row(c.lower, lower_) || !points_.read_row(c.upper, upper_) || !read_path(c))
        return call_.out_of_memory();
    const int64_t n = static_cast<int64_t>(lower_.vertex.size()), m = sizes_.rows[cylinder];
    if (static_cast<int64_t>(upper_.vertex.size()) != n)
        return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                          "The boundaries of a cylinder have different numbers of columns. Please report it.");
    const double lower_length = points_.length(c.lower), upper_length = points_.length(c.upper);
    if (!set_places(lower_length)) return call_.out_of_memory();
    // The flat cylinder is as long as both are in the mean; places in parts of it.
    const double whole = (lower_length + upper_length) / 2;
    const uint32_t base = out_.vertex_count();
    double turn = 0;
    int64_t offset = 0;
    if (align_rows(cylinder, whole, turn) || place_rows(cylinder, turn, upper_length, arrival(c), offset))
        return call_.status();
    const auto vertex = [&](int64_t k, int64_t j) {
        if (k == 0) return lower_.vertex[static_cast<size_t>(j % n)];
        if (k == m) return upper_.vertex[static_cast<size_t>(((offset - j) % n + n) % n)];
        return base + static_cast<uint32_t>((k - 1) * n + j % n);
    };
    const size_t first = out_.quads.size();
    if (!out_.quads.extend(static_cast<size_t>(4 * m * n))) return call_.out_of_memory();
    // The cylinder lies right of its lower leaf.
    call_.parallel.for_blocks(static_cast<size_t>(m * n), [&](size_t begin, size_t end) {
        int64_t k = static_cast<int64_t>(begin) / n, j = static_cast<int64_t>(begin) % n;
        for (size_t i = begin; i < end; ++i) {
            uint32_t* const quad = &out_.quads[first + 4 * i];
            quad[0] = vertex(k, j);
            quad[1] = vertex(k + 1, j);
            quad[2] = vertex(k + 1, j + 1);
            quad[3] = vertex(k, j + 1);
            if (++j < n) continue;
            j = 0;
            ++k;
        }
    });
    return HMF_OK;
}

} // namespace hmf
