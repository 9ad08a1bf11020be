#include "chart_layout.hpp"

#include "../../core/base/disjoint_sets.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr int PASSES = 3;             // over triangles that may go over to a neighbor
constexpr uint32_t MOST_TRIED = 200;  // of those that overlap, in each pass
constexpr int LAYOUT_ROUNDS = 8;      // of islands that move; in the last one all become charts
constexpr uint32_t LARGE_ISLAND = 24; // triangles, or 1/200 of all

} // namespace

Done ChartLayout::run() {
    return place_faces() && smooth_edges() && gather() && scale_to_grid() && take_overlaps_out();
}

// Corners in the planes of the charts, and the part of each face as its chart.
Done ChartLayout::place_faces() {
    const size_t sides = size_t{2} * pieces_.mesh.edge_count;
    if (!grid_.x.allocate_filled(call_.memory, sides, 0) || !grid_.y.allocate_filled(call_.memory, sides, 0)
        || !grid_.chart.allocate_filled(call_.memory, pieces_.mesh.face_count, NONE))
        return false;
    for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
        if (t % 65536 == 0 && !call_.tick(0.89)) return false;
        const uint32_t p = pieces_.strips.piece[t];
        if (p == NONE) continue;
        const uint32_t c = plan_.charts.of_piece[p];
        const Motion& m = plan_.charts.motion[p];
        double u = 0, v = 0;
        uint32_t h = pieces_.side[t];
        for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h]) {
            grid_.x[h] = m.sign * pieces_.strips.u[h] + m.u;
            grid_.y[h] = m.sign * pieces_.strips.v[h] + m.v;
            u += static_cast<double>(grid_.x[h]) / 3;
            v += static_cast<double>(grid_.y[h]) / 3;
        }
        // The part it lies in or, if it sticks out of all, next to.
        double nearest = HUGE_VAL;
        for (uint32_t i = 0; i < plan_.parts.size(); ++i) {
            if (plan_.parts[i].chart != c) continue;
            const Box& b = plan_.parts[i].box;
            const double off = std::max(std::max(b.u0 - u, u - b.u1), std::max(b.v0 - v, v - b.v1));
            if (off < nearest) {
                nearest = off;
                grid_.chart[t] = i;
            }
        }
    }
    grid_.chart_count = static_cast<uint32_t>(plan_.parts.size());
    return true;
}

// From the frame of the triangle of h to that of the triangle beyond, such that both meet along h.
Motion ChartLayout::over(uint32_t h) const {
    const uint32_t g = twin(h), n_h = pieces_.mesh.next[h], n_g = pieces_.mesh.next[g];
    const bool same = grid_.x[n_h] - grid_.x[h] == grid_.x[g] - grid_.x[n_g]
                   && grid_.y[n_h] - grid_.y[h] == grid_.y[g] - grid_.y[n_g];
    const int64_t sign = same ? 1 : -1;
    return {sign, grid_.x[n_g] - sign * grid_.x[h], grid_.y[n_g] - sign * grid_.y[h]};
}

void ChartLayout::move_face(uint32_t t, const Motion& m) {
    uint32_t h = pieces_.side[t];
    for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h]) {
        grid_.x[h] = m.sign * grid_.x[h] + m.u;
        grid_.y[h] = m.sign * grid_.y[h] + m.v;
    }
}

// A triangle with two sides on seams goes over to where it has one: once each, so that the
// edge of a chart stays within a triangle of where it was.
Done ChartLayout::smooth_edges() {
    Array<double> length;
    Array<uint8_t> moved;
    if (!length.allocate(call_.memory, pieces_.mesh.edge_count)
        || !moved.allocate_filled(call_.memory, pieces_.mesh.face_count, 0))
        return false;
    for (uint32_t e = 0; e < pieces_.mesh.edge_count; ++e) {
        double square = 0;
        for (size_t a = 0; a < 3; ++a) {
            const double d = pieces_.position[3 * size_t{pieces_.mesh.origin[2 * e]} + a]
                           - pieces_.position[3 * size_t{pieces_.mesh.origin[2 * e + 1]} + a];
            square += d * d;
        }
        length[e] = std::sqrt(square);
    }
    const auto joined = [&](uint32_t t) {
        double sum = 0;
        uint32_t h = pieces_.side[t];
        for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h])
            sum += is_joined(pieces_.mesh, grid_, edge_of(h)) ? length[edge_of(h)] : 0;
        return sum;
    };
    for (int pass = 0; pass < PASSES; ++pass)
        for (uint32_t t = 0; t < pieces_.mesh.face_count; ++t) {
            if (t % 65536 == 0 && !call_.tick(0.89)) return false;
            if (moved[t] || grid_.chart[t] == NONE) continue;
            uint32_t h = pieces_.side[t];
            for (int k = 0; k < 3 && !moved[t]; ++k, h = pieces_.mesh.next[h]) {
                if (is_joined(pieces_.mesh, grid_, edge_of(h)) || grid_.chart[pieces_.mesh.face[twin(h)]] == NONE)
                    continue;
                const uint32_t chart = grid_.chart[t];
                const double before = joined(t);
                const Motion m = over(h);
                move_face(t, m);
                grid_.chart[t] = grid_.chart[pieces_.mesh.face[twin(h)]];
                if (joined(t) > before) moved[t] = 1;
                else {
                    move_face(t, m.inverse());
                    grid_.chart[t] = chart;
                }
            }
        }
    return true;
}

// Parts of charts in one piece, the largest of each chart, and the way out of each of the others.
Done ChartLayout::find_islands() {
    const uint32_t n = pieces_.mesh.face_count;
    const Mesh& mesh = pieces_.mesh;
    for (uint32_t t = 0; t < n; ++t) {
        island_[t] = t;
        size_[t] = 0;
    }
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        if (grid_.chart[mesh.face[2 * e]] != NONE && is_joined(mesh, grid_, e))
            unite(island_.data(), mesh.face[2 * e], mesh.face[2 * e + 1]);
    for (uint32_t t = 0; t < n; ++t) ++size_[island_[t] = find_root(island_.data(), t)];
    if (!largest_.allocate_filled(call_.memory, grid_.chart_count, NONE)) return false;
    for (uint32_t t = 0; t < n; ++t) {
        if (grid_.chart[t] == NONE || island_[t] != t) continue;
        uint32_t& best = largest_[grid_.chart[t]];
        if (best == NONE || size_[t] > size_[best]) best = t;
    }
    return true;
}

// Islands of at least this many triangles become charts.
Done ChartLayout::found_charts(uint32_t enough) {
    const uint32_t n = pieces_.mesh.face_count;
    for (uint32_t t = 0; t < n; ++t)
        if (grid_.chart[t] != NONE && island_[t] == t && largest_[grid_.chart[t]] != t && size_[t] >= enough) {
            if (!largest_.push(t)) return false;
            grid_.chart[t] = grid_.chart_count++;
        }
    for (uint32_t t = 0; t < n; ++t)
        if (grid_.chart[t] != NONE && largest_[grid_.chart[island_[t]]] == island_[t])
            grid_.chart[t] = grid_.chart[island_[t]];
    return true;
}

// way: of each island, by its first triangle, the longest side to a part that stays, or NONE.
Done ChartLayout::find_ways(Array<uint32_t>& way) const {
    const Mesh& mesh = pieces_.mesh;
    Array<double> longest;
    if (!longest.allocate_filled(call_.memory, mesh.face_count, -1.0)
        || !way.allocate_filled(call_.memory, mesh.face_count, NONE))
        return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t from = mesh.face[h], to = mesh.face[twin(h)];
        if (grid_.chart[from] == NONE || grid_.chart[to] == NONE || stays(from) || !stays(to)) continue;
        const uint32_t next = mesh.next[h];
        const double x = static_cast<double>(grid_.x[next] - grid_.x[h]),
                     y = static_cast<double>(grid_.y[next] - grid_.y[h]);
        if (x * x + y * y > longest[island_[from]]) {
            longest[island_[from]] = x * x + y * y;
            way[island_[from]] = h;
        }
    }
    return true;
}

// Islands apart from the largest one of their chart go to a neighbor or, if they are large, become charts.
Done ChartLayout::gather() {
    const uint32_t n = pieces_.mesh.face_count;
    Array<uint32_t> way;
    if (!island_.allocate(call_.memory, n) || !size_.allocate(call_.memory, n)) return false;
    for (int round = 0; round < LAYOUT_ROUNDS; ++round) {
        if (!call_.tick(0.89)) return false;
        const uint32_t large = std::max(LARGE_ISLAND, n / 200);
        if (!find_islands() || !found_charts(round + 1 == LAYOUT_ROUNDS ? 0 : large)) return false;
        bool any = false;
        for (uint32_t t = 0; t < n && !any; ++t) any = grid_.chart[t] != NONE && !stays(t);
        if (!any) break;
        if (!find_ways(way) || !move_islands(way)) return false;
    }
    return number_charts();
}

Done ChartLayout::move_islands(const Array<uint32_t>& way) {
    Array<Motion> motion;
    Array<uint32_t> to;
    if (!motion.allocate(call_.memory, pieces_.mesh.face_count)
        || !to.allocate_filled(call_.memory, pieces_.mesh.face_count, NONE))
        return false;
    for (uint32_t t = 0; t < pieces_.mesh.face_count; ++t) {
        const uint32_t h = way[t];
        if (island_[t] != t || h == NONE) continue;
        motion[t] = over(h);
        to[t] = grid_.chart[pieces_.mesh.face[twin(h)]];
    }
    for (uint32_t t = 0; t < pieces_.mesh.face_count; ++t) {
        const uint32_t root = island_[t];
        if (to[root] == NONE) continue;
        grid_.chart[t] = to[root];
        move_face(t, motion[root]);
    }
    return true;
}

// Charts with triangles, by the number of their first one.
Done ChartLayout::number_charts() {
    Array<uint32_t> number;
    if (!number.allocate_filled(call_.memory, grid_.chart_count, NONE)) return false;
    uint32_t count = 0;
    for (uint32_t& c : grid_.chart) {
        if (c == NONE) continue;
        if (number[c] == NONE) number[c] = count++;
        c = number[c];
    }
    grid_.chart_count = count;
    return true;
}

// To a grid, each chart with the scale that makes its area proportional to that in space.
Done ChartLayout::scale_to_grid() {
    const uint32_t n = grid_.chart_count;
    Array<double> area, image, to_grid;
    Array<int64_t> low_x, low_y;
    if (!area.allocate_filled(call_.memory, n, 0) || !image.allocate_filled(call_.memory, n, 0)
        || !to_grid.allocate(call_.memory, n) || !low_x.allocate_filled(call_.memory, n, INT64_MAX)
        || !low_y.allocate_filled(call_.memory, n, INT64_MAX))
        return false;
    for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
        const uint32_t c = grid_.chart[t];
        if (c == NONE) continue;
        area[c] += pieces_.twice_area(pieces_.side[t]);
        image[c] += pieces_.image_area(pieces_.side[t]) * static_cast<double>(pieces_.mirror);
        uint32_t h = pieces_.side[t];
        for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h]) {
            low_x[c] = std::min(low_x[c], grid_.x[h]);
            low_y[c] = std::min(low_y[c], pieces_.mirror * grid_.y[h]);
        }
    }
    for (uint32_t c = 0; c < n; ++c)
        to_grid[c] = GRID * (image[c] > 0 ? std::sqrt(2 * area[c] / (pieces_.whole_area * image[c])) : 0);
    for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
        const uint32_t c = grid_.chart[t];
        if (c == NONE) continue;
        const auto put = [&](int64_t x) {
            return static_cast<int64_t>(std::floor(std::min(static_cast<double>(x) * to_grid[c] + 0.5, 4 * GRID)));
        };
        uint32_t h = pieces_.side[t];
        for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h]) {
            grid_.x[h] = put(grid_.x[h] - low_x[c]);
            grid_.y[h] = put(pieces_.mirror * grid_.y[h] - low_y[c]);
        }
    }
    return call_.tick(0.89);
}

// A triangle as it is in space.
void ChartLayout::lay_as_in_space(uint32_t t) {
    const double unit = GRID / std::sqrt(pieces_.whole_area / 2);
    const Mesh& mesh = pieces_.mesh;
    const uint32_t h = pieces_.side[t], n = mesh.next[h], p = mesh.next[n];
    const double *a = pieces_.position + size_t{3} * mesh.origin[h], *b = pieces_.position + size_t{3} * mesh.origin[n],
                 *c = pieces_.position + size_t{3} * mesh.origin[p];
    double bb = 0, bc = 0;
    for (int i = 0; i < 3; ++i) {
        bb += (b[i] - a[i]) * (b[i] - a[i]);
        bc += (b[i] - a[i]) * (c[i] - a[i]);
    }
    const double base = std::sqrt(bb), height = base > 0 ? pieces_.twice_area(h) / base : 0;
    const double foot = base > 0 ? bc / base : 0, left = foot < 0 ? -foot : 0;
    const auto put = [&](double x) { return static_cast<int64_t>(std::min(x * unit, 4 * GRID)); };
    grid_.x[h] = put(left);
    grid_.x[n] = put(left + base);
    grid_.x[p] = put(left + foot);
    grid_.y[h] = grid_.y[n] = 0;
    grid_.y[p] = put(height);
}

// Overlapping triangles move to a neighbor where they overlap nothing. Inverted ones get the shape that they have in
// space, flattened if there is no space for it. If there is none at all, they become charts of their own.
Done ChartLayout::take_overlaps_out() {
    Array<uint8_t> bad;
    if (!turn_back(pieces_.mesh, pieces_.side, grid_, call_)
        || !find_overlaps(pieces_.mesh, pieces_.side, grid_, SPECK, bad, call_))
        return false;
    for (uint32_t t = 0; t < pieces_.side.size(); ++t)
        if (bad[t] && grid_area(pieces_.mesh, grid_, pieces_.side[t]) <= 0) lay_as_in_space(t);
    for (int pass = 0; pass < PASSES; ++pass)
        for (uint32_t t = 0, tried = 0; t < pieces_.side.size() && tried < MOST_TRIED; ++t) {
            if (!bad[t]) continue;
            ++tried;
            if (!call_.tick(0.89)) return false;
            const double flatter = pass == 0 ? 1 : pass == 1 ? 0.5 : 0.125;
            if (go_over(pieces_.mesh, pieces_.side, bad, t, flatter, grid_)) bad[t] = 0;
        }
    for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
        if (!bad[t]) continue;
        lay_as_in_space(t);
        grid_.chart[t] = grid_.chart_count++;
    }
    return separate() && dissolve_small();
}

// Charts of a few triangles, all of whose other neighbors have left, are merged into neighboring charts.
Done ChartLayout::dissolve_small() {
    const uint32_t n = static_cast<uint32_t>(pieces_.side.size());
    Array<uint32_t> count;
    Array<uint8_t> moves;
    if (!count.allocate_filled(call_.memory, grid_.chart_count, 0) || !moves.allocate_filled(call_.memory, n, 0))
        return false;
    for (const uint32_t c : grid_.chart)
        if (c != NONE) ++count[c];
    struct Corner {
        uint32_t half_edge, chart;
        int64_t x, y;
    };
    Array<Corner> before;
    before.start(call_.memory);
    uint32_t tried = 0;
    for (uint32_t c = 0; c < grid_.chart_count && tried < MOST_TRIED; ++c) {
        if (count[c] > n / 1000) continue;
        before.clear();
        uint32_t left = 0;
        for (uint32_t t = 0; t < n; ++t) {
            if (grid_.chart[t] != c) continue;
            moves[t] = 1;
            ++left;
            uint32_t h = pieces_.side[t];
            for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h])
                if (!before.push({h, c, grid_.x[h], grid_.y[h]})) return false;
        }
        for (uint32_t last = left + 1; left > 0 && left < last;) {
            last = left;
            for (size_t i = 0; i < before.size(); i += 3) {
                const uint32_t t = pieces_.mesh.face[before[i].half_edge];
                if (!moves[t]) continue;
                ++tried;
                if (!call_.tick(0.89)) return false;
                for (const double flatter : {1.0, 0.5, 0.125})
                    if (moves[t] && go_over(pieces_.mesh, pieces_.side, moves, t, flatter, grid_)) moves[t] = 0, --left;
            }
        }
        for (size_t i = 0; i < before.size(); ++i) {
            const uint32_t t = pieces_.mesh.face[before[i].half_edge];
            moves[t] = 0;
            if (left == 0) continue;
            grid_.chart[t] = c;
            grid_.x[before[i].half_edge] = before[i].x;
            grid_.y[before[i].half_edge] = before[i].y;
        }
    }
    return number_charts();
}

// A chart for each part in one piece.
Done ChartLayout::separate() {
    Array<uint32_t> part;
    if (!part.allocate(call_.memory, pieces_.mesh.face_count)) return false;
    for (uint32_t t = 0; t < pieces_.mesh.face_count; ++t) part[t] = t;
    for (uint32_t e = 0; e < pieces_.mesh.edge_count; ++e)
        if (is_joined(pieces_.mesh, grid_, e))
            unite(part.data(), pieces_.mesh.face[2 * e], pieces_.mesh.face[2 * e + 1]);
    for (uint32_t t = 0; t < pieces_.mesh.face_count; ++t)
        if (grid_.chart[t] != NONE) grid_.chart[t] = find_root(part.data(), t);
    grid_.chart_count = pieces_.mesh.face_count;
    return number_charts();
}

} // namespace hmf
