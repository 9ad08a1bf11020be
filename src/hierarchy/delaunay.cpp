// Greedy edge flips of one level, as in [W] 4.1: the mesh stays simplicial, so
// an edge is left alone if the vertices opposite to it are neighbours.
//
//          k
//        / ^ \         flip ij to lk if angle(k) + angle(l) > 180 degrees,
//       i  |  j        i.e. cot(k) + cot(l) < 0, and k, l are not neighbours
//        \ | /
//          l
#include "delaunay.hpp"

#include "../mesh/weights.hpp"

namespace hmf {

namespace {

// Rounding must not make an edge turn for ever between two equal states.
constexpr double TOLERANCE = -1e-9;
constexpr uint32_t NOT_WAITING = NONE - 1;

bool neighbours(const WorkMesh& work, uint32_t k_out, uint32_t l) {
    uint32_t g = k_out;
    do {
        if (work.mesh.target(g) == l) return true;
        g = work.mesh.rotate_cw(g);
    } while (g != k_out);
    return false;
}

bool flip_if_needed(WorkMesh& work, uint32_t edge) {
    Mesh& mesh = work.mesh;
    const uint32_t h = 2 * edge, t = twin(h), ki = mesh.prev(h), lj = mesh.prev(t);
    const uint32_t i = mesh.origin[h], j = mesh.origin[t], k = mesh.origin[ki], l = mesh.origin[lj];
    const double *x_i = work.at(i), *x_j = work.at(j);
    if (!(cotangent(work.at(k), x_i, x_j) + cotangent(work.at(l), x_j, x_i) < TOLERANCE)) return false;
    if (k == l || work.degree[i] <= 3 || work.degree[j] <= 3) return false;
    if (work.degree[k] < work.degree[l] ? neighbours(work, ki, l) : neighbours(work, lj, k)) return false;
    flip(mesh, edge);
    --work.degree[i];
    --work.degree[j];
    ++work.degree[k];
    ++work.degree[l];
    return true;
}

} // namespace

hmf_status delaunay_flips(WorkMesh& work, Array<uint32_t>& flips, Call& call, double fraction) {
    Mesh& mesh = work.mesh;
    for (const uint32_t e : work.edges) work.link[e] = NOT_WAITING;
    uint64_t budget = COARSE_FLIPS_PER_EDGE * mesh.edge_count;
    uint32_t top = NONE, steps = 0;
    for (const uint32_t first : work.edges) {
        // Edges round a flipped one are looked at again, at once.
        uint32_t e = first;
        for (;;) {
            if (++steps % 8192 == 0 && !call.tick(fraction)) return HMF_CANCELLED;
            if (budget > 0 && flip_if_needed(work, e)) {
                --budget;
                if (!flips.push(e)) return call.out_of_memory();
                const uint32_t h = 2 * e, t = twin(h);
                const uint32_t round[4] = {mesh.next[h], mesh.prev(h), mesh.next[t], mesh.prev(t)};
                for (const uint32_t side : round) {
                    const uint32_t other = edge_of(side);
                    if (work.link[other] != NOT_WAITING) continue;
                    work.link[other] = top;
                    top = other;
                }
            }
            if (top == NONE) break;
            e = top;
            top = work.link[e];
            work.link[e] = NOT_WAITING;
        }
    }
    return HMF_OK;
}

} // namespace hmf
