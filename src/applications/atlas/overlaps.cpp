// Two triangles with positive area have common inner points unless one of their
// six sides has all corners of the other triangle on its right or on its line.
// Pairs to look at come from a grid of cells, one for about every triangle.
#include "overlaps.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

struct GridCorners {
    int64_t x[3], y[3];
    int64_t low(bool vertical) const { return vertical ? std::min({y[0], y[1], y[2]}) : std::min({x[0], x[1], x[2]}); }
    int64_t high(bool vertical) const { return vertical ? std::max({y[0], y[1], y[2]}) : std::max({x[0], x[1], x[2]}); }
};

GridCorners corners_of(const Mesh& mesh, const GridLayout& layout, uint32_t h) {
    const uint32_t n = mesh.next[h], p = mesh.next[n];
    return {{layout.x[h], layout.x[n], layout.x[p]}, {layout.y[h], layout.y[n], layout.y[p]}};
}

int64_t grid_turn(const GridCorners& a, int i, int64_t x, int64_t y) {
    const int j = (i + 1) % 3;
    return (a.x[j] - a.x[i]) * (y - a.y[i]) - (a.y[j] - a.y[i]) * (x - a.x[i]);
}

// All of b right of a side of a, or on it.
bool is_apart(const GridCorners& a, const GridCorners& b) {
    for (int i = 0; i < 3; ++i) {
        bool apart = true;
        for (int k = 0; k < 3 && apart; ++k) apart = grid_turn(a, i, b.x[k], b.y[k]) <= 0;
        if (apart) return true;
    }
    return false;
}

// The cells of one chart.
class Cells {
public:
    Cells(const Mesh& mesh, const Array<uint32_t>& side, const GridLayout& layout, Call& call) :
        mesh_(mesh), side_(side), layout_(layout), call_(call) {}

    // visit(f, g) for each two of the faces that overlap.
    template <class Visit>
    Done run(const uint32_t* faces, uint32_t n, Visit visit) {
        if (n < 2) return true;
        int64_t low[2], high[2];
        for (uint32_t i = 0; i < n; ++i) {
            const GridCorners c = at(faces[i]);
            for (int a = 0; a < 2; ++a) {
                low[a] = i ? std::min(low[a], c.low(a)) : c.low(a);
                high[a] = i ? std::max(high[a], c.high(a)) : c.high(a);
            }
        }
        const double w = static_cast<double>(high[0] - low[0]) + 1, h = static_cast<double>(high[1] - low[1]) + 1;
        for (double size = std::sqrt(w * h / n);; size *= 2) {
            cell_ = static_cast<int64_t>(size) + 1;
            for (int a = 0; a < 2; ++a) {
                low_[a] = low[a];
                cells_[a] = static_cast<uint64_t>((high[a] - low[a]) / cell_) + 1;
            }
            if (!call_.work(32 * uint64_t{n}, 0.89, false)) return false;
            if (cells_[0] * cells_[1] <= 4 * uint64_t{n} + 64 && count(faces, n) <= 32 * uint64_t{n}) break;
        }
        return fill(faces, n) && look(visit);
    }

private:
    GridCorners at(uint32_t face) const { return corners_of(mesh_, layout_, side_[face]); }
    struct Range {
        uint64_t from[2], to[2];
    };
    Range cells_of(const GridCorners& c) const {
        Range r;
        for (int a = 0; a < 2; ++a) {
            r.from[a] = static_cast<uint64_t>((c.low(a) - low_[a]) / cell_);
            r.to[a] = static_cast<uint64_t>((c.high(a) - low_[a]) / cell_);
        }
        return r;
    }
    uint64_t count(const uint32_t* faces, uint32_t n) const {
        uint64_t sum = 0;
        for (uint32_t i = 0; i < n; ++i) {
            const Range r = cells_of(at(faces[i]));
            sum += (r.to[0] - r.from[0] + 1) * (r.to[1] - r.from[1] + 1);
        }
        return cells_[0] * cells_[1] == 1 ? 0 : sum;
    }
    Done fill(const uint32_t* faces, uint32_t n) {
        const size_t cells = static_cast<size_t>(cells_[0] * cells_[1]);
        if (!begin_.allocate_filled(call_.memory, cells + 1, 0)) return false;
        for (int pass = 0; pass < 2; ++pass) {
            for (uint32_t i = 0; i < n; ++i) {
                const Range r = cells_of(at(faces[i]));
                if (!call_.work(32 + (r.to[0] - r.from[0] + 1) * (r.to[1] - r.from[1] + 1), 0.89, false)) return false;
                for (uint64_t y = r.from[1]; y <= r.to[1]; ++y)
                    for (uint64_t x = r.from[0]; x <= r.to[0]; ++x) {
                        const size_t k = static_cast<size_t>(y * cells_[0] + x);
                        if (pass == 0) ++begin_[k];
                        else content_[--begin_[k]] = faces[i];
                    }
            }
            if (pass == 1) break;
            for (size_t k = 1; k <= cells; ++k) begin_[k] += begin_[k - 1];
            if (!content_.allocate(call_.memory, static_cast<size_t>(begin_[cells]))) return false;
        }
        return true;
    }
    template <class Visit>
    Done look(Visit visit) const {
        for (size_t k = 0; k + 1 < begin_.size(); ++k)
            for (uint64_t i = begin_[k]; i < begin_[k + 1]; ++i) {
                const GridCorners a = at(content_[static_cast<size_t>(i)]);
                if (!call_.work(32, 0.89, false)) return false;
                for (uint64_t j = i + 1; j < begin_[k + 1]; ++j) {
                    if (!call_.work(32, 0.89, false)) return false;
                    const GridCorners b = at(content_[static_cast<size_t>(j)]);
                    // Only in the cell with the lower left corner of what both boxes share.
                    const int64_t x = std::max(a.low(false), b.low(false)), y = std::max(a.low(true), b.low(true));
                    if (static_cast<uint64_t>((y - low_[1]) / cell_) * cells_[0]
                            + static_cast<uint64_t>((x - low_[0]) / cell_)
                        != k)
                        continue;
                    if (x >= std::min(a.high(false), b.high(false)) || y >= std::min(a.high(true), b.high(true)))
                        continue;
                    if (!is_apart(a, b) && !is_apart(b, a))
                        visit(content_[static_cast<size_t>(i)], content_[static_cast<size_t>(j)]);
                }
            }
        return true;
    }

    const Mesh& mesh_;
    const Array<uint32_t>& side_;
    const GridLayout& layout_;
    Call& call_;
    int64_t low_[2] = {}, cell_ = 1;
    uint64_t cells_[2] = {};
    Array<uint64_t> begin_;
    Array<uint32_t> content_;
};

} // namespace

int64_t grid_area(const Mesh& mesh, const GridLayout& layout, uint32_t h) {
    const GridCorners c = corners_of(mesh, layout, h);
    return grid_turn(c, 0, c.x[2], c.y[2]);
}

bool is_joined(const Mesh& mesh, const GridLayout& layout, uint32_t e) {
    const uint32_t h = 2 * e, t = h + 1, n_h = mesh.next[h], n_t = mesh.next[t];
    return layout.chart[mesh.face[h]] == layout.chart[mesh.face[t]] && layout.x[h] == layout.x[n_t]
        && layout.y[h] == layout.y[n_t] && layout.x[t] == layout.x[n_h] && layout.y[t] == layout.y[n_h];
}

Done turn_back(const Mesh& mesh, const Array<uint32_t>& side, GridLayout& layout, Call& call) {
    const auto least_around = [&](uint32_t v) {
        int64_t least = INT64_MAX;
        for (const uint32_t h : mesh.around(v)) least = std::min(least, grid_area(mesh, layout, h));
        return least;
    };
    for (int pass = 0; pass < 10; ++pass) {
        bool any = false;
        for (uint32_t t = 0; t < mesh.face_count; ++t) {
            if (t % 65536 == 0 && !call.tick(0.89)) return false;
            if (layout.chart[t] == NONE || grid_area(mesh, layout, side[t]) >= 0) continue;
            uint32_t corner = side[t];
            for (int k = 0; k < 3; ++k, corner = mesh.next[corner]) {
                const uint32_t v = mesh.origin[corner];
                int64_t n = 0, x = 0, y = 0;
                bool inside = true;
                for (const uint32_t h : mesh.around(v)) {
                    inside = inside && is_joined(mesh, layout, edge_of(h));
                    ++n;
                    x += layout.x[mesh.next[h]];
                    y += layout.y[mesh.next[h]];
                }
                if (!call.work(64 * static_cast<uint64_t>(n), 0.89, false)) return false;
                if (!inside) continue;
                const int64_t before = least_around(v), old_x = layout.x[corner], old_y = layout.y[corner];
                const auto move = [&](int64_t to_x, int64_t to_y) {
                    for (const uint32_t h : mesh.around(v)) layout.x[h] = to_x, layout.y[h] = to_y;
                };
                move(x / n, y / n); // NOLINT(clang-analyzer-core*): every vertex has an edge
                if (least_around(v) > before) any = true;
                else move(old_x, old_y);
            }
        }
        if (!any) break;
    }
    return true;
}

Done find_overlaps(const Mesh& mesh, const Array<uint32_t>& side, const GridLayout& layout, int64_t speck,
                   Array<uint8_t>& bad, Call& call) {
    Array<uint32_t> offset, faces;
    if (!bad.allocate_filled(call.memory, mesh.face_count, 0)
        || !offset.allocate_filled(call.memory, size_t{layout.chart_count} + 1, 0)
        || !faces.allocate(call.memory, mesh.face_count))
        return false;
    const auto is_seen = [&](uint32_t t) {
        if (layout.chart[t] == NONE) return false;
        const GridCorners c = corners_of(mesh, layout, side[t]);
        return std::max(c.high(false) - c.low(false), c.high(true) - c.low(true)) >= speck
            && grid_turn(c, 0, c.x[2], c.y[2]) != 0;
    };
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        if (!is_seen(t)) continue;
        if (grid_area(mesh, layout, side[t]) < 0) bad[t] = 1;
        else ++offset[layout.chart[t]];
    }
    for (uint32_t c = 0, sum = 0; c <= layout.chart_count; ++c) sum = offset[c] += sum;
    for (uint32_t t = 0; t < mesh.face_count; ++t)
        if (!bad[t] && is_seen(t)) faces[--offset[layout.chart[t]]] = t;
    // Of two that overlap the one with more seams goes.
    const auto seams = [&](uint32_t t) {
        int count = 0;
        uint32_t h = side[t];
        for (int k = 0; k < 3; ++k, h = mesh.next[h]) count += !is_joined(mesh, layout, edge_of(h));
        return count;
    };
    Cells cells(mesh, side, layout, call);
    for (uint32_t c = 0; c < layout.chart_count; ++c)
        if (!cells.run(faces.data() + offset[c], offset[c + 1] - offset[c], [&](uint32_t f, uint32_t g) {
                if (bad[f] || bad[g]) return;
                bad[seams(f) >= seams(g) ? f : g] = 1;
            }))
            return false;
    return true;
}

bool go_over(const Mesh& mesh, const Array<uint32_t>& side, const Array<uint8_t>& bad, uint32_t face, double flatter,
             GridLayout& layout) {
    uint32_t h = side[face];
    if (grid_area(mesh, layout, h) <= 0) return false;
    for (int k = 0; k < 3; ++k, h = mesh.next[h]) {
        const uint32_t g = twin(h), n = mesh.next[h], p = mesh.next[n], beyond = mesh.face[g];
        if (bad[beyond] || layout.chart[beyond] == NONE) continue;
        // The third corner in the frame of the side: along it and to its left.
        const double ax = static_cast<double>(layout.x[n] - layout.x[h]),
                     ay = static_cast<double>(layout.y[n] - layout.y[h]);
        const double bx = static_cast<double>(layout.x[p] - layout.x[h]),
                     by = static_cast<double>(layout.y[p] - layout.y[h]);
        const double square = ax * ax + ay * ay;
        if (!(square > 0)) continue;
        const double along = (ax * bx + ay * by) / square, left = flatter * (ax * by - ay * bx) / square;
        const int64_t x0 = layout.x[mesh.next[g]], y0 = layout.y[mesh.next[g]];
        const double cx = static_cast<double>(layout.x[g] - x0), cy = static_cast<double>(layout.y[g] - y0);
        const double px = std::floor(along * cx - left * cy + 0.5), py = std::floor(along * cy + left * cx + 0.5);
        constexpr double limit = 1 << 30;
        if (!(std::fabs(px) < limit && std::fabs(py) < limit)) continue;
        const GridCorners there{{x0, layout.x[g], x0 + static_cast<int64_t>(px)},
                                {y0, layout.y[g], y0 + static_cast<int64_t>(py)}};
        bool free = grid_turn(there, 0, there.x[2], there.y[2]) > 0;
        for (uint32_t t = 0; t < mesh.face_count && free; ++t) {
            if (t == face || bad[t] || layout.chart[t] != layout.chart[beyond]) continue;
            const GridCorners c = corners_of(mesh, layout, side[t]);
            free = grid_turn(c, 0, c.x[2], c.y[2]) <= 0 || is_apart(there, c) || is_apart(c, there);
        }
        if (!free) continue;
        layout.chart[face] = layout.chart[beyond];
        layout.x[h] = there.x[0], layout.y[h] = there.y[0];
        layout.x[n] = there.x[1], layout.y[n] = there.y[1];
        layout.x[p] = there.x[2], layout.y[p] = there.y[2];
        return true;
    }
    return false;
}

} // namespace hmf
