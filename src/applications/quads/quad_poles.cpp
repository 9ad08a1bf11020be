// Vertices with two quads; see quad_poles.hpp.
#include "quad_poles.hpp"

#include "quad_shape.hpp"

#include <algorithm>

namespace hmf {

namespace {

class PoleQuads {
public:
    PoleQuads(QuadMesh& mesh, Call& call) : mesh_(mesh), call_(call) {}

    // left: poles that stay.
    Done run(size_t& left) {
        // Once for the poles, once for what they leave.
        for (const bool moves_tip : {true, false}) {
            const uint32_t n = mesh_.vertex_count();
            if (!call_.tick(0) || !stars_.build(mesh_, call_.memory) || !uses_.allocate_filled(call_.memory, n, 0u)
                || !number_.allocate(call_.memory, n))
                return false;
            for (const uint32_t v : mesh_.quads) ++uses_[v];
            for (uint32_t v = 0; v < n; ++v)
                if (stars_.end(v) - stars_.begin(v) == 2 && !is_at_boundary(mesh_.held[v])) join_pair(v, moves_tip);
            left = 0;
            for (uint32_t v = 0; v < n; ++v) left += uses_[v] == 2 && !is_at_boundary(mesh_.held[v]);
            drop_unused();
        }
        return true;
    }

private:
    size_t place_in(const uint32_t* quad, uint32_t v) const {
        size_t k = 0;
        while (k < 4 && quad[k] != v) ++k;
        return k;
    }

    // One quad in place of two, unless one of these has gone or a vertex beside the pole had too few left.
    void join_pair(uint32_t v, bool moves_tip) {
        uint32_t *const other = &mesh_.quads[4 * size_t{stars_.begin(v)[0]}],
                        *const quad = &mesh_.quads[4 * size_t{stars_.begin(v)[1]}];
        const size_t at = place_in(other, v), k = place_in(quad, v);
        if (at == 4 || k == 4) return;
        // From v: b, x, a in the other one, a, y, b here.
        const uint32_t b = other[(at + 1) % 4], a = quad[(k + 1) % 4], y = quad[(k + 2) % 4];
        if (quad[(k + 3) % 4] != b || other[(at + 3) % 4] != a || other[(at + 2) % 4] == y) return;
        if (uses_[a] < 3 || uses_[b] < 3 || is_at_boundary(mesh_.held[a]) || is_at_boundary(mesh_.held[b])) return;
        --uses_[a];
        --uses_[b];
        uses_[v] = 0;
        other[at] = y;
        for (size_t c = 0; c < 4; ++c) quad[c] = NONE;
        if (!moves_tip) return;
        const uint32_t on_arc = std::min(a, b); // made before those of the rows
        copy_vertex(v, on_arc);
        mesh_.held[on_arc] = AT_TIP;
    }

    void copy_vertex(uint32_t from, uint32_t to) { mesh_.put(to, hmf::at(mesh_, from), mesh_.sides[from]); }

    // Vertices and quads that are left, numbered without gaps.
    void drop_unused() {
        uint32_t kept = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
            if (uses_[v] == 0) continue;
            copy_vertex(v, kept);
            mesh_.held[kept] = mesh_.held[v];
            number_[v] = kept++;
        }
        while (mesh_.sides.size() > kept) {
            for (int c = 0; c < 3; ++c) mesh_.positions.pop();
            mesh_.sides.pop();
            mesh_.held.pop();
        }
        size_t to = 0;
        for (const uint32_t v : mesh_.quads)
            if (v != NONE) mesh_.quads[to++] = number_[v];
        while (mesh_.quads.size() > to) mesh_.quads.pop();
    }

    QuadMesh& mesh_;
    Call& call_;
    QuadStars stars_;
    Array<uint32_t> uses_;   // per vertex: how many quads have it
    Array<uint32_t> number_; // per vertex: its number among those kept
};

} // namespace

Done quads_over_poles(QuadMesh& mesh, size_t& left, Call& call) { return PoleQuads(mesh, call).run(left); }

} // namespace hmf
