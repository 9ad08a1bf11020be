// Vertices with two quads; see quad_poles.hpp.
#include "quad_poles.hpp"

namespace hmf {

namespace {

// Its two quads, and the place of the vertex in them.
struct Pair {
    uint32_t quad[2] = {NONE, NONE};
    size_t at[2] = {0, 0};
};

} // namespace

Done quads_over_poles(QuadMesh& mesh, size_t& left, Call& call) {
    const uint32_t n = mesh.vertex_count();
    Array<uint32_t> uses, number, poles;
    poles.start(call.memory);
    left = 0;
    if (!uses.allocate_filled(call.memory, n, 0u) || !number.allocate_filled(call.memory, n, NONE)) return false;
    for (const uint32_t v : mesh.quads) ++uses[v];
    for (uint32_t v = 0; v < n; ++v)
        if (uses[v] == 2 && mesh.held[v] != AT_BOUNDARY) {
            number[v] = static_cast<uint32_t>(poles.size());
            if (!poles.push(v)) return false;
        }
    if (poles.empty()) return true;
    // By a search through all quads, once for the poles, once for what they leave.
    for (int round = 0; round < 2; ++round) {
        Array<Pair> pairs;
        if (!call.tick(0) || !pairs.allocate_filled(call.memory, poles.size(), Pair{})) return false;
        for (uint32_t q = 0; q < mesh.quad_count(); ++q)
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t v = mesh.quads[4 * size_t{q} + k];
                if (v == NONE || number[v] == NONE) continue;
                Pair& pair = pairs[number[v]];
                const size_t i = pair.quad[0] == NONE ? 0 : 1;
                pair.quad[i] = q;
                pair.at[i] = k;
            }
        const size_t count = poles.size();
        for (size_t i = 0; i < count; ++i) {
            const uint32_t v = poles[i];
            number[v] = NONE;
            if (v == NONE || pairs[i].quad[1] == NONE) continue;
            uint32_t *const other = &mesh.quads[4 * size_t{pairs[i].quad[0]}],
                            *const quad = &mesh.quads[4 * size_t{pairs[i].quad[1]}];
            const size_t at = pairs[i].at[0], k = pairs[i].at[1];
            if (other[at] != v || quad[k] != v) continue; // one of them has gone
            // From v: b, x, a in the other one, a, y, b here.
            const uint32_t b = other[(at + 1) % 4], a = quad[(k + 1) % 4];
            const uint32_t y = quad[(k + 2) % 4];
            if (quad[(k + 3) % 4] != b || other[(at + 3) % 4] != a || other[(at + 2) % 4] == y) continue;
            if (uses[a] < 3 || uses[b] < 3 || mesh.held[a] == AT_BOUNDARY || mesh.held[b] == AT_BOUNDARY) continue;
            --uses[a];
            --uses[b];
            uses[v] = 0;
            other[at] = y;
            for (size_t c = 0; c < 4; ++c) quad[c] = NONE;
            // The one on the arc was made before those of the rows.
            if (round == 0) {
                const uint32_t tip = a < b ? a : b;
                for (size_t c = 0; c < 3; ++c) mesh.positions[size_t{3} * tip + c] = mesh.positions[size_t{3} * v + c];
                mesh.sides[tip] = mesh.sides[v];
                mesh.held[tip] = 1;
            }
        }
        poles.clear();
        for (uint32_t v = 0; v < n; ++v) {
            number[v] = NONE;
            if (uses[v] != 2 || mesh.held[v] == AT_BOUNDARY) continue;
            number[v] = static_cast<uint32_t>(poles.size());
            if (!poles.push(v)) return false;
        }
    }
    left = poles.size();
    uint32_t kept = 0;
    for (uint32_t v = 0; v < n; ++v) {
        if (uses[v] == 0) continue;
        for (size_t c = 0; c < 3; ++c) mesh.positions[size_t{3} * kept + c] = mesh.positions[size_t{3} * v + c];
        mesh.sides[kept] = mesh.sides[v];
        mesh.held[kept] = mesh.held[v];
        number[v] = kept++;
    }
    while (mesh.sides.size() > kept) {
        for (int c = 0; c < 3; ++c) mesh.positions.pop();
        mesh.sides.pop();
        mesh.held.pop();
    }
    size_t to = 0;
    for (size_t i = 0; i < mesh.quads.size(); ++i)
        if (mesh.quads[i] != NONE) mesh.quads[to++] = number[mesh.quads[i]];
    while (mesh.quads.size() > to) mesh.quads.pop();
    return true;
}

} // namespace hmf
