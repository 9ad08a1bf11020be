#include "coarser_unit.hpp"

namespace hmf {

Done to_coarser_unit(Foliation& f, uint32_t bits, Memory& memory, bool& exact) {
    exact = false;
    const Mesh& mesh = f.mesh;
    const int64_t multiple = int64_t{1} << bits;
    const auto remainder = [&](int64_t x) { return x & (multiple - 1); }; // of negative numbers, too
    constexpr int64_t unknown = -1;
    Array<int8_t> sign; // per half-edge; 0: out of a zero or a marked vertex, which lie at 0
    Array<int64_t> place;
    Array<uint32_t> queue;
    Array<double> weight; // of no use here
    queue.start(memory);
    if (!sign.allocate_filled(memory, size_t{2} * mesh.edge_count, 0)
        || !weight.allocate_filled(memory, mesh.edge_count, 0)
        || !place.allocate_filled(memory, mesh.vertex_count, unknown) || !queue.reserve(mesh.vertex_count))
        return false;
    const uint32_t before = f.epoch;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (f.stamp[v] > before) continue;
        const Cluster cluster = explore_cluster(f, v);
        if (cluster.index() == 0 && cluster.marked == 0) {
            sign_regular_cluster(f, weight.data(), sign.data());
            continue;
        }
        for (const uint32_t u : f.members) {
            place[u] = 0;
            queue.add(u);
        }
    }
    // All zeros are in triangles: their branch points lie at 0.
    for (uint32_t h = 0; h < 2 * mesh.edge_count && queue.empty(); ++h) {
        const int64_t corner2 = f.corner2(h);
        if (corner2 == 0 || f.corner2(mesh.next[h]) == 0 || f.corner2(mesh.prev(h)) == 0) continue;
        place[mesh.origin[h]] = remainder(sign[h] > 0 ? -corner2 / 2 : corner2 / 2);
        queue.add(mesh.origin[h]);
    }
    if (queue.empty()) { // genus 1: all places are as good
        place[0] = 0;
        queue.add(0);
    }
    // Of the far end of h, seen from its origin.
    const auto arrival = [&](uint32_t h) {
        const int64_t ahead = remainder((sign[h] < 0 ? -place[mesh.origin[h]] : place[mesh.origin[h]]) + f.at(h));
        return sign[twin(h)] > 0 ? remainder(-ahead) : ahead;
    };
    for (size_t i = 0; i < queue.size(); ++i) {
        for (const uint32_t h : mesh.around(queue[i])) {
            const uint32_t w = mesh.target(h);
            if (place[w] == unknown) {
                place[w] = arrival(h);
                queue.add(w);
            }
        }
    }
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (place[mesh.target(h)] != arrival(h)) return true;
    // The way of each vertex in its + direction.
    for (int64_t& p : place) p = 2 * p < multiple ? -p : multiple - p;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t h = 2 * e;
        f.value[e] -= sign[h] * place[mesh.origin[h]] + sign[h + 1] * place[mesh.origin[h + 1]];
        f.value[e] >>= bits;
    }
    return exact = true;
}

} // namespace hmf
