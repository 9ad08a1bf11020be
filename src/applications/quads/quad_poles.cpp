// Vertices with two quads; see quad_poles.hpp.
#include "quad_poles.hpp"

#include <algorithm>

namespace hmf {

namespace {

class PoleQuads {
public:
    PoleQuads(QuadMesh& mesh, Call& call) : mesh_(mesh), call_(call) {}

    // left: poles that stay.
    Done run(size_t& left) {
        const uint32_t n = mesh_.vertex_count();
        left = 0;
        poles_.start(call_.memory);
        if (!uses_.allocate_filled(call_.memory, n, 0u) || !number_.allocate_filled(call_.memory, n, NONE))
            return false;
        for (const uint32_t v : mesh_.quads) ++uses_[v];
        if (!list_poles()) return false;
        if (poles_.empty()) return true;
        // Once for the poles, once for what they leave.
        for (int round = 0; round < 2; ++round) {
            if (!call_.tick(0) || !find_pairs()) return false;
            for (size_t i = 0; i < poles_.size(); ++i) join_pair(poles_[i], pairs_[i], round == 0);
            if (!list_poles()) return false;
        }
        left = poles_.size();
        drop_unused();
        return true;
    }

private:
    // The two quads of a pole, and its place in them.
    struct Pair {
        uint32_t quad[2] = {NONE, NONE};
        size_t at[2] = {0, 0};
    };

    Done list_poles() {
        poles_.clear();
        for (uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
            number_[v] = NONE;
            if (uses_[v] != 2 || is_at_boundary(mesh_.held[v])) continue;
            number_[v] = static_cast<uint32_t>(poles_.size());
            if (!poles_.push(v)) return false;
        }
        return true;
    }

    // By a search through all quads.
    Done find_pairs() {
        if (!pairs_.allocate_filled(call_.memory, poles_.size(), Pair{})) return false;
        for (uint32_t q = 0; q < mesh_.quad_count(); ++q)
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t v = mesh_.quads[4 * size_t{q} + k];
                if (v == NONE || number_[v] == NONE) continue;
                Pair& pair = pairs_[number_[v]];
                const size_t i = pair.quad[0] == NONE ? 0 : 1;
                pair.quad[i] = q;
                pair.at[i] = k;
            }
        return true;
    }

    // One quad in place of two, unless one of these has gone or a vertex beside the pole had too few left.
    void join_pair(uint32_t v, const Pair& pair, bool moves_tip) {
        if (pair.quad[1] == NONE) return;
        uint32_t *const other = &mesh_.quads[4 * size_t{pair.quad[0]}], *const quad =
                                                                            &mesh_.quads[4 * size_t{pair.quad[1]}];
        const size_t at = pair.at[0], k = pair.at[1];
        if (other[at] != v || quad[k] != v) return;
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

    void copy_vertex(uint32_t from, uint32_t to) { mesh_.put(to, at(mesh_, from), mesh_.sides[from]); }

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
    Array<uint32_t> uses_;   // per vertex: how many quads have it
    Array<uint32_t> number_; // per vertex: its number among the poles; at the end, among those kept
    Array<uint32_t> poles_;
    Array<Pair> pairs_; // per pole
};

} // namespace

Done quads_over_poles(QuadMesh& mesh, size_t& left, Call& call) { return PoleQuads(mesh, call).run(left); }

} // namespace hmf
