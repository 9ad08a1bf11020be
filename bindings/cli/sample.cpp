// Three rings, melted together and bent along a monkey saddle, as the zero set
// of a function.  Dual contouring gives one vertex in each cell of a grid that
// the surface passes, and a quadrilateral around each grid edge that it cuts:
//
//        o-------o          o  vertices of cells
//        |   |   |          |  grid edge, end-on, with a change of sign
//        o-------o
//
// Vertices then move to the mean of their neighbors and back to the surface,
// which evens the triangles out.
#include "sample.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cli {

namespace {

using GridPoint = std::array<double, 3>;

constexpr double CELL = 0.0425, LOW_XY = -2.15, LOW_Z = -1.3;
constexpr size_t COUNT_XY = 102, COUNT_Z = 62;

double smooth_minimum(double a, double b, double width) {
    const double h = std::max(0.0, width - std::fabs(a - b)) / width;
    return std::min(a, b) - h * h * width / 4;
}

double sample_function(const GridPoint& p) {
    const double x = p[0], y = p[1], z = p[2] - 0.11 * (x * x * x - 3 * x * y * y) / (1 + 0.2 * (x * x + y * y));
    static constexpr double SIN[3] = {0, 0.86602540378443865, -0.86602540378443865}, COS[3] = {1, -0.5, -0.5};
    // Unequal rings keep the zeros apart; equal ones would draw four of them into one point.
    static constexpr double RADIUS[3] = {0.80, 0.68, 0.74};
    double value = 1e9;
    for (size_t i = 0; i < 3; ++i) {
        const double dx = x - (RADIUS[i] + 0.18) * COS[i], dy = y - (RADIUS[i] + 0.18) * SIN[i];
        const double ring = std::sqrt(dx * dx + dy * dy) - RADIUS[i];
        const double tube = std::sqrt(ring * ring + z * z) - 0.30;
        value = i == 0 ? tube : smooth_minimum(value, tube, 0.30);
    }
    return value;
}

GridPoint gradient(const GridPoint& p) {
    GridPoint g{};
    for (size_t a = 0; a < 3; ++a) {
        GridPoint low = p, high = p;
        low[a] -= 1e-4;
        high[a] += 1e-4;
        g[a] = (sample_function(high) - sample_function(low)) / 2e-4;
    }
    return g;
}

void move_to_surface(GridPoint& p) {
    for (int step = 0; step < 4; ++step) {
        const GridPoint g = gradient(p);
        const double square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        if (square < 1e-12) return;
        const double scale = std::clamp(sample_function(p) / square, -CELL, CELL);
        for (size_t a = 0; a < 3; ++a) p[a] -= scale * g[a];
    }
}

double distance_square(const GridPoint& a, const GridPoint& b) {
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

// Whether each cell is passed by at most one sheet.  Two would share its
// vertex: they do where a face has its signs crosswise, or a cell has one sign
// at two opposite corners only.
bool single_sheets(const std::vector<double>& value, const size_t (&n)[3], const size_t (&stride)[3]) {
    for (size_t k = 0; k + 1 < n[2]; ++k)
        for (size_t j = 0; j + 1 < n[1]; ++j)
            for (size_t i = 0; i + 1 < n[0]; ++i) {
                const size_t cell = i + j * stride[1] + k * stride[2];
                for (size_t a = 0; a < 3; ++a) {
                    const size_t b = stride[(a + 1) % 3], c = stride[(a + 2) % 3];
                    const bool here = value[cell] < 0, there = value[cell + b + c] < 0;
                    if (here == there && (value[cell + b] < 0) != here && (value[cell + c] < 0) != here) return false;
                }
                unsigned inside = 0;
                for (unsigned corner = 0; corner < 8; ++corner)
                    inside |=
                        unsigned(
                            value[cell + (corner & 1u) + (corner >> 1 & 1u) * stride[1] + (corner >> 2) * stride[2]]
                            < 0)
                        << corner;
                for (unsigned corner = 0; corner < 4; ++corner) {
                    const unsigned opposite = 1u << corner | 1u << (7 - corner);
                    if (inside == opposite || inside == (0xffu ^ opposite)) return false;
                }
            }
    return true;
}

} // namespace

TriangleMesh make_sample() {
    const size_t n[3] = {COUNT_XY, COUNT_XY, COUNT_Z};
    const size_t stride[3] = {1, n[0], n[0] * n[1]};
    std::vector<double> value(n[0] * n[1] * n[2]);
    double shift = 0;
    const auto grid_point = [&](size_t i, size_t j, size_t k) {
        return GridPoint{LOW_XY - shift + CELL * double(i), LOW_XY - shift + CELL * double(j),
                         LOW_Z - shift / 2 + CELL * double(k)};
    };
    // Moves the grid until no plane of it touches the surface at a saddle.
    for (int attempt = 0; attempt < 20; ++attempt) {
        shift = 0.003 * attempt;
        for (size_t k = 0; k < n[2]; ++k)
            for (size_t j = 0; j < n[1]; ++j)
                for (size_t i = 0; i < n[0]; ++i)
                    value[i + j * stride[1] + k * stride[2]] = sample_function(grid_point(i, j, k));
        if (single_sheets(value, n, stride)) break;
    }

    // A vertex in each cell with both signs, at the mean of its cut edges.
    constexpr uint32_t NO_VERTEX = 0xffffffffu;
    std::vector<uint32_t> vertex(value.size(), NO_VERTEX);
    std::vector<GridPoint> points;
    for (size_t k = 0; k + 1 < n[2]; ++k)
        for (size_t j = 0; j + 1 < n[1]; ++j)
            for (size_t i = 0; i + 1 < n[0]; ++i) {
                const size_t cell = i + j * stride[1] + k * stride[2];
                GridPoint sum{};
                double cuts = 0;
                for (size_t a = 0; a < 3; ++a)
                    for (size_t side = 0; side < 4; ++side) {
                        const size_t b = (a + 1) % 3, c = (a + 2) % 3;
                        size_t at[3] = {i, j, k};
                        at[b] += side & 1u;
                        at[c] += side >> 1;
                        const size_t start = at[0] + at[1] * stride[1] + at[2] * stride[2];
                        const double low = value[start], high = value[start + stride[a]];
                        if ((low < 0) == (high < 0)) continue;
                        GridPoint p = grid_point(at[0], at[1], at[2]);
                        p[a] += CELL * low / (low - high);
                        for (size_t d = 0; d < 3; ++d) sum[d] += p[d];
                        cuts += 1;
                    }
                if (cuts == 0) continue;
                vertex[cell] = static_cast<uint32_t>(points.size());
                points.push_back({sum[0] / cuts, sum[1] / cuts, sum[2] / cuts});
            }

    std::vector<std::array<uint32_t, 4>> quads;
    for (size_t k = 1; k + 1 < n[2]; ++k)
        for (size_t j = 1; j + 1 < n[1]; ++j)
            for (size_t i = 1; i + 1 < n[0]; ++i)
                for (size_t a = 0; a < 3; ++a) {
                    const size_t start = i + j * stride[1] + k * stride[2], b = stride[(a + 1) % 3],
                                 c = stride[(a + 2) % 3];
                    const bool low = value[start] < 0, high = value[start + stride[a]] < 0;
                    if (low == high) continue;
                    std::array<uint32_t, 4> quad{vertex[start], vertex[start - b], vertex[start - b - c],
                                                 vertex[start - c]};
                    if (high) std::swap(quad[1], quad[3]);
                    quads.push_back(quad);
                }

    std::vector<std::vector<uint32_t>> neighbors(points.size());
    for (const auto& quad : quads)
        for (size_t c = 0; c < 4; ++c) {
            neighbors[quad[c]].push_back(quad[(c + 1) % 4]);
            neighbors[quad[c]].push_back(quad[(c + 3) % 4]);
        }
    for (int pass = 0; pass < 12; ++pass) {
        std::vector<GridPoint> next = points;
        for (size_t v = 0; v < points.size(); ++v) {
            GridPoint mean{};
            for (uint32_t w : neighbors[v])
                for (size_t a = 0; a < 3; ++a) mean[a] += points[w][a] / double(neighbors[v].size());
            for (size_t a = 0; a < 3; ++a) next[v][a] = 0.3 * points[v][a] + 0.7 * mean[a];
            move_to_surface(next[v]);
        }
        points.swap(next);
    }

    TriangleMesh mesh;
    for (const GridPoint& p : points) mesh.positions.insert(mesh.positions.end(), p.begin(), p.end());
    for (const auto& q : quads) {
        const bool other = distance_square(points[q[1]], points[q[3]]) < distance_square(points[q[0]], points[q[2]]);
        if (other) mesh.triangles.insert(mesh.triangles.end(), {q[0], q[1], q[3], q[1], q[2], q[3]});
        else mesh.triangles.insert(mesh.triangles.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    }
    return mesh;
}

} // namespace cli
