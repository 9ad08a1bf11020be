// Greedy edge flips of one level, as in [W] 4.1: the mesh stays simplicial, so
// an edge is left alone if the vertices opposite to it are neighbors.
//
//          k
//        / ^ \         flip ij to lk if angle(k) + angle(l) > 180 degrees,
//       i  |  j        i.e. cot(k) + cot(l) < 0, and k, l are not neighbors
//        \ | /
//          l
#include "delaunay.hpp"

#include "../mesh/weights.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Rounding must not make an edge turn for ever between two equal states.
constexpr double DELAUNAY_TOLERANCE = -1e-9;
// An edge between two vertices of higher degree is not flipped: whether they are neighbors takes a walk.
constexpr uint32_t MAX_WALKED_DEGREE = 256;
// Of an edge that is not on the stack of edges to test.
constexpr uint32_t NOT_WANTED = NONE - 1, WANTED = NONE - 2;

// Is the angle at apex between a and b greater than 90 degrees?
bool obtuse(const double* apex, const double* a, const double* b) {
    double dot = 0;
    for (int c = 0; c < 3; ++c) dot += (a[c] - apex[c]) * (b[c] - apex[c]);
    return dot < 0;
}

bool neighbors(const WorkMesh& work, uint32_t k_out, uint32_t l) {
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

// Would the other diagonal be Delaunay?
bool is_wanted(const WorkMesh& work, uint32_t edge) {
    const Mesh& mesh = work.mesh;
    const uint32_t h = 2 * edge, t = twin(h);
    const double *i = work.at(mesh.origin[h]), *j = work.at(mesh.origin[t]);
    const double *k = work.at(mesh.origin[mesh.prev(h)]), *l = work.at(mesh.origin[mesh.prev(t)]);
    if (!obtuse(k, i, j) && !obtuse(l, i, j)) return false; // most edges
    return cotangent(k, i, j) + cotangent(l, j, i) < DELAUNAY_TOLERANCE;
}

// An edge that has to be flipped.
bool flip_if_possible(WorkMesh& work, uint32_t edge) {
    Mesh& mesh = work.mesh;
    const uint32_t h = 2 * edge, t = twin(h), ki = mesh.prev(h), lj = mesh.prev(t);
    const uint32_t i = mesh.origin[h], j = mesh.origin[t], k = mesh.origin[ki], l = mesh.origin[lj];
    if (k == l || work.degree[i] <= 3 || work.degree[j] <= 3) return false;
    if (std::min(work.degree[k], work.degree[l]) > MAX_WALKED_DEGREE) return false;
    if (work.has_double_edges && is_folded(work.at(i), work.at(j), work.at(k), work.at(l))) return false;
    if (work.degree[k] < work.degree[l] ? neighbors(work, ki, l) : neighbors(work, lj, k)) return false;
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
    // Nearly no edge has to be flipped, so all edges are tested first. A later flip nearby tests its neighbors again.
    const auto ask = [&](size_t begin, size_t end) {
        for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e)
            work.link[e] = is_wanted(work, e) ? WANTED : NOT_WANTED;
    };
    if (!call.pass(mesh.edge_count, fraction, ask)) return HMF_CANCELLED;
    uint64_t budget = COARSE_FLIPS_PER_EDGE * mesh.edge_count;
    uint32_t top = NONE, steps = 0;
    for (uint32_t first = 0; first < mesh.edge_count; ++first) {
        if (first % 65536 == 0 && !call.tick(fraction)) return HMF_CANCELLED;
        if (work.link[first] != WANTED) continue;
        // The edges around a flipped one are tested again at once.
        uint32_t e = first;
        for (;;) {
            if (++steps % 8192 == 0 && !call.tick(fraction)) return HMF_CANCELLED;
            const bool wanted = is_wanted(work, e);
            work.link[e] = wanted ? WANTED : NOT_WANTED; // if it is not possible now it may be later
            if (wanted && budget > 0 && flip_if_possible(work, e)) {
                --budget;
                if (!flips.push(e)) return call.out_of_memory();
                const uint32_t h = 2 * e, t = twin(h);
                const uint32_t round[4] = {mesh.next[h], mesh.prev(h), mesh.next[t], mesh.prev(t)};
                for (const uint32_t side : round) {
                    const uint32_t other = edge_of(side);
                    if (work.link[other] != WANTED && work.link[other] != NOT_WANTED) continue;
                    work.link[other] = top;
                    top = other;
                }
            }
            if (top == NONE) break;
            e = top;
            top = work.link[e];
        }
    }
    return HMF_OK;
}

} // namespace hmf
