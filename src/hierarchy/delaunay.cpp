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

// Is the angle at apex between a and b greater than 90 degrees?
bool obtuse(const double* apex, const double* a, const double* b) {
    double dot = 0;
    for (int c = 0; c < 3; ++c) dot += (a[c] - apex[c]) * (b[c] - apex[c]);
    return dot < 0;
}

bool neighbours(const WorkMesh& work, uint32_t k_out, uint32_t l) {
    for (const uint32_t g : work.mesh.clockwise_from(k_out))
        if (work.mesh.target(g) == l) return true;
    return false;
}

// Do the two triangles at edge ij lie on each other, as on the boundary of a surface that was doubled?  After a
// flip there the positions would say nothing of the lengths.
bool is_folded(const double* i, const double* j, const double* k, const double* l) {
    double e[3], u[3], v[3];
    for (int c = 0; c < 3; ++c) {
        e[c] = j[c] - i[c];
        u[c] = k[c] - i[c];
        v[c] = l[c] - i[c];
    }
    // Scalar product of e x u and v x e.
    const auto dot = [](const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    return dot(e, v) * dot(u, e) < dot(e, e) * dot(u, v);
}

bool flip_if_needed(WorkMesh& work, uint32_t edge) {
    Mesh& mesh = work.mesh;
    const uint32_t h = 2 * edge, t = twin(h), ki = mesh.prev(h), lj = mesh.prev(t);
    const uint32_t i = mesh.origin[h], j = mesh.origin[t], k = mesh.origin[ki], l = mesh.origin[lj];
    const double *x_i = work.at(i), *x_j = work.at(j), *x_k = work.at(k), *x_l = work.at(l);
    if (!obtuse(x_k, x_i, x_j) && !obtuse(x_l, x_i, x_j)) return false; // most edges
    if (!(cotangent(x_k, x_i, x_j) + cotangent(x_l, x_j, x_i) < TOLERANCE)) return false;
    if (k == l || work.degree[i] <= 3 || work.degree[j] <= 3) return false;
    if (work.has_double_edges && is_folded(x_i, x_j, x_k, x_l)) return false;
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
    for (uint32_t e = 0; e < mesh.edge_count; ++e) work.link[e] = NOT_WAITING;
    uint64_t budget = COARSE_FLIPS_PER_EDGE * mesh.edge_count;
    uint32_t top = NONE, steps = 0;
    for (uint32_t first = 0; first < mesh.edge_count; ++first) {
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
