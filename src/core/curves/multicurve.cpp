// Tracing the components of a normal multicurve from its crossing numbers.
#include "multicurve.hpp"

namespace hmf {

Done Multicurve::allocate(const Mesh& mesh, Memory& memory) {
    edges.start(memory);
    total = 0;
    return count.allocate_filled(memory, mesh.edge_count, 0u) && first.allocate(memory, mesh.edge_count);
}

Done Multicurve::add(const uint32_t* half_edges, size_t n) {
    for (size_t i = 0; i < n; ++i) {
        const uint32_t e = edge_of(half_edges[i]);
        if (count[e] == 0 && !edges.push(e)) return false;
        ++count[e];
    }
    total += n;
    return true;
}

void Multicurve::clear() {
    for (uint32_t e : edges) count[e] = 0;
    edges.clear();
    total = 0;
}

bool Multicurve::is_normal(const Mesh& mesh) const {
    for (uint32_t e : edges)
        for (uint32_t h = 2 * e; h < 2 * e + 2; ++h) {
            const uint64_t a = count[e], b = count[edge_of(mesh.next[h])], c = count[edge_of(mesh.prev(h))];
            if ((a + b + c) % 2 || a > b + c || b > c + a || c > a + b) return false;
        }
    return true;
}

void Multicurve::step(const Mesh& mesh, uint32_t& h, uint32_t& p) const {
    const uint32_t n = count[edge_of(h)], k = twin(h), at = n - 1 - p;
    const uint32_t right = mesh.next[k], left = mesh.prev(k);
    const uint32_t n_right = count[edge_of(right)], n_left = count[edge_of(left)];
    const uint32_t round_origin = static_cast<uint32_t>((uint64_t{n} + n_left - n_right) / 2);
    h = at < round_origin ? left : right;
    p = at < round_origin ? n_left - 1 - at : n - 1 - at;
}

Done Multicurve::trace(const Mesh& mesh, Call& call) {
    uint32_t next_first = 0;
    for (uint32_t e : edges) {
        first[e] = next_first;
        next_first += count[e];
    }
    components.offsets.start(call.memory);
    components.crossings.start(call.memory);
    begin.start(call.memory);
    if (!strand.allocate_filled(call.memory, total, NONE) || !components.crossings.reserve(total)
        || !components.offsets.push(0))
        return false;
    uint32_t component = 0;
    for (uint32_t start : edges)
        for (uint32_t j = 0; j < count[start]; ++j) {
            if (strand[first[start] + j] != NONE) continue;
            if (!begin.push(first[start] + j)) return false;
            // Position p counts from the origin of h; each step marks one crossing.
            uint32_t h = 2 * start, p = j;
            for (;;) {
                const uint32_t e = edge_of(h), n = count[e];
                uint32_t& mark = strand[first[e] + (h & 1u ? n - 1 - p : p)];
                if (mark != NONE) break;
                mark = 2 * component + (h & 1u);
                components.crossings.add(h);
                if (!call.work(4)) return false;
                step(mesh, h, p);
            }
            if (!components.offsets.push(components.crossings.size())) return false;
            ++component;
        }
    return true;
}

} // namespace hmf
