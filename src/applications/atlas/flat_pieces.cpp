#include "flat_pieces.hpp"

#include <cmath>

namespace hmf {

double FlatPieces::twice_area(uint32_t h) const {
    const double* a = position + size_t{3} * mesh.origin[h];
    const double* b = position + size_t{3} * mesh.origin[mesh.next[h]];
    const double* c = position + size_t{3} * mesh.origin[mesh.prev(h)];
    double n[3];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
    return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

double FlatPieces::image_area(uint32_t h) const {
    const uint32_t n = mesh.next[h], p = mesh.next[n];
    const double ax = static_cast<double>(strips.u[n] - strips.u[h]),
                 ay = static_cast<double>(strips.v[n] - strips.v[h]),
                 bx = static_cast<double>(strips.u[p] - strips.u[h]),
                 by = static_cast<double>(strips.v[p] - strips.v[h]);
    return ax * by - ay * bx;
}

hmf_status FlatPieces::measure(Call& call) {
    if (!side.allocate(call.memory, mesh.face_count)) return call.out_of_memory();
    for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    const uint32_t n = strips.piece_count();
    if (!area.allocate_filled(call.memory, n, 0) || !image.allocate_filled(call.memory, n, 0))
        return call.out_of_memory();
    size_t count = 0;
    for (uint32_t t = 0; t < side.size(); ++t) {
        const uint32_t p = strips.piece[t];
        if (p == NONE) continue;
        ++count;
        area[p] += twice_area(side[t]);
        image[p] += image_area(side[t]);
    }
    double sum = 0;
    for (uint32_t p = 0; p < n; ++p) {
        sum += image[p];
        whole_area += area[p];
    }
    mirror = sum < 0 ? -1 : 1;
    for (double& x : image) x *= static_cast<double>(mirror);
    whole = std::fabs(sum) / 2;
    triangle = 1.5 * std::sqrt(2 * whole / static_cast<double>(count));
    return call.tick(0.86) ? HMF_OK : call.was_cancelled();
}

} // namespace hmf
