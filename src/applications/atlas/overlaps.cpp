// Two triangles with positive area have common inner points unless one of their
// six sides has all corners of the other triangle on its right or on its line.
// Pairs to look at come from a vertical line that sweeps over a chart from left
// to right (Shamos and Hoey): it meets triangles without overlap in an order
// from below to above.  If no two neighbors in this order overlap, none do.
#include "overlaps.hpp"

#include "../../core/base/heap_sort.hpp"

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

// Whether all of b is right of a side of a, or on it; `turn` becomes the x of the direction of that side.
bool is_apart(const GridCorners& a, const GridCorners& b, int64_t& turn) {
    for (int i = 0; i < 3; ++i) {
        bool apart = true;
        for (int k = 0; k < 3 && apart; ++k) apart = grid_turn(a, i, b.x[k], b.y[k]) <= 0;
        turn = a.x[(i + 1) % 3] - a.x[i];
        if (apart) return true;
    }
    return false;
}

// 0 if they overlap; else, where an upright line meets the inside of both, 1 with b above a, -1 below.
int order(const GridCorners& a, const GridCorners& b) {
    int64_t turn;
    if (is_apart(a, b, turn)) return turn > 0 ? -1 : 1;
    return is_apart(b, a, turn) ? (turn > 0 ? 1 : -1) : 0;
}

// The triangles that the sweep line meets just right of its place: a treap and a list, both in their order.
class Sweep {
public:
    Sweep(const Mesh& mesh, const Array<uint32_t>& side, const GridLayout& layout, Array<uint8_t>& bad, Call& call) :
        mesh_(mesh), side_(side), layout_(layout), bad_(bad), call_(call) {}

    Done start() {
        return node_.allocate(call_.memory, mesh_.face_count) && ends_.allocate(call_.memory, mesh_.face_count);
    }

    // Sets bad for one of each two of the faces that overlap; sorts them.
    Done run(uint32_t* faces, uint32_t n) {
        const auto go_on = [this] { return call_.work(64, 0.89, false); };
        const auto sort = [&](uint32_t* list, bool by_end) {
            return heap_sort(
                list, n,
                [&](uint32_t f, uint32_t g) {
                    const int64_t x = by_end ? end(f) : begin(f), y = by_end ? end(g) : begin(g);
                    return x != y ? x < y : f < g;
                },
                go_on);
        };
        for (uint32_t i = 0; i < n; ++i) ends_[i] = faces[i];
        if (!sort(faces, false) || !sort(ends_.data(), true)) return false;
        root_ = NONE;
        for (uint32_t i = 0, k = 0; k < n;) {
            if (i < n && begin(faces[i]) < end(ends_[k])) {
                if (!insert(faces[i++])) return false;
            } else {
                const uint32_t face = ends_[k++];
                if (!bad_[face] && !remove(face)) return false;
            }
        }
        return true;
    }

private:
    struct Node {
        uint32_t parent, child[2];
        uint32_t next[2]; // below and above
    };
    GridCorners at(uint32_t face) const { return corners_of(mesh_, layout_, side_[face]); }
    int64_t begin(uint32_t face) const { return at(face).low(false); }
    int64_t end(uint32_t face) const { return at(face).high(false); }
    static uint64_t priority(uint32_t face) {
        const uint64_t mixed = (face + uint64_t{1}) * 0x9e3779b97f4a7c15u;
        return (mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u;
    }

    // Of two that overlap the one with more seams goes.
    uint32_t worse(uint32_t f, uint32_t g) const { return seams(f) > seams(g) ? f : g; }
    int seams(uint32_t t) const {
        int count = 0;
        uint32_t h = side_[t];
        for (int k = 0; k < 3; ++k, h = mesh_.next[h]) count += !is_joined(mesh_, layout_, edge_of(h));
        return count;
    }

    Done insert(uint32_t face) {
        for (;;) {
            uint32_t parent = NONE, other = root_;
            int above = 0;
            while (other != NONE) {
                if (!call_.work(32, 0.89, false)) return false;
                above = order(at(other), at(face));
                if (above == 0) break;
                parent = other;
                other = node_[other].child[above > 0];
            }
            if (other == NONE) {
                link(face, parent, above > 0);
                return true;
            }
            bad_[worse(other, face)] = 1;
            if (bad_[face]) return true;
            if (!remove(other)) return false;
        }
    }

    // As a child of `parent`, above or below it, then upward to where its priority belongs.
    void link(uint32_t face, uint32_t parent, bool above) {
        Node& node = node_[face];
        node = {parent, {NONE, NONE}, {NONE, NONE}};
        (parent == NONE ? root_ : node_[parent].child[above]) = face;
        if (parent != NONE) {
            node.next[!above] = parent;
            node.next[above] = node_[parent].next[above];
            node_[parent].next[above] = face;
            if (node.next[above] != NONE) node_[node.next[above]].next[!above] = face;
        }
        while (node.parent != NONE && priority(node.parent) < priority(face)) rotate_up(face);
    }

    void replace(uint32_t face, uint32_t by) {
        const uint32_t parent = node_[face].parent;
        (parent == NONE ? root_ : node_[parent].child[node_[parent].child[1] == face]) = by;
        if (by != NONE) node_[by].parent = parent;
    }

    void rotate_up(uint32_t face) {
        const uint32_t parent = node_[face].parent;
        const bool above = node_[parent].child[1] == face;
        const uint32_t inner = node_[face].child[!above];
        replace(parent, face);
        node_[face].child[!above] = parent;
        node_[parent].parent = face;
        node_[parent].child[above] = inner;
        if (inner != NONE) node_[inner].parent = parent;
    }

    // Its neighbors become neighbors of each other; if they overlap, one of them is removed as well.
    Done remove(uint32_t face) {
        for (;;) {
            if (!call_.work(64, 0.89, false)) return false;
            const Node& node = node_[face];
            while (node.child[0] != NONE && node.child[1] != NONE)
                rotate_up(node.child[priority(node.child[1]) > priority(node.child[0])]);
            replace(face, node.child[node.child[0] == NONE]);
            const uint32_t below = node.next[0], above = node.next[1];
            if (below != NONE) node_[below].next[1] = above;
            if (above != NONE) node_[above].next[0] = below;
            if (below == NONE || above == NONE || order(at(below), at(above)) != 0) return true;
            bad_[face = worse(below, above)] = 1;
        }
    }

    const Mesh& mesh_;
    const Array<uint32_t>& side_;
    const GridLayout& layout_;
    Array<uint8_t>& bad_;
    Call& call_;
    Array<Node> node_; // of each face
    Array<uint32_t> ends_;
    uint32_t root_ = NONE;
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
    Array<uint8_t> tried; // per vertex: the last pass
    if (!tried.allocate_filled(call.memory, mesh.vertex_count, 0)) return false;
    for (uint8_t pass = 1; pass <= 10; ++pass) {
        bool any = false;
        for (uint32_t t = 0; t < mesh.face_count; ++t) {
            if (t % 65536 == 0 && !call.tick(0.89)) return false;
            if (layout.chart[t] == NONE || grid_area(mesh, layout, side[t]) >= 0) continue;
            uint32_t corner = side[t];
            for (int k = 0; k < 3; ++k, corner = mesh.next[corner]) {
                const uint32_t v = mesh.origin[corner];
                if (tried[v] == pass) continue;
                tried[v] = pass;
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
    Sweep sweep(mesh, side, layout, bad, call);
    if (!sweep.start()) return false;
    for (uint32_t c = 0; c < layout.chart_count; ++c)
        if (!sweep.run(faces.data() + offset[c], offset[c + 1] - offset[c])) return false;
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
            free = grid_turn(c, 0, c.x[2], c.y[2]) <= 0 || order(there, c) != 0;
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
