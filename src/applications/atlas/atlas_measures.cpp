#include "atlas_measures.hpp"

#include "../design/conformal_scale.hpp"
#include "../parameterize/dilatation.hpp"

#include <cmath>

namespace hmf {

namespace {
constexpr uint32_t MEASURES_STRIDE = 65536; // elements between two reports

double edge_length(const Mesh& mesh, const double* position, uint32_t edge) {
    const double* const p = position + size_t{3} * mesh.origin[2 * edge];
    const double* const q = position + size_t{3} * mesh.origin[2 * edge + 1];
    double square = 0;
    for (size_t a = 0; a < 3; ++a) square += (p[a] - q[a]) * (p[a] - q[a]);
    return std::sqrt(square);
}

} // namespace

hmf_status measure_atlas(const Atlas& atlas, const Mesh& mesh, const double* position, const Array<uint32_t>& sides,
                         AtlasMeasures& out, Call& call) {
    double area = 0, sum = 0, squares = 0;
    for (size_t t = 0; t < sides.size(); ++t) {
        if (t % MEASURES_STRIDE == 0 && !call.tick(0.98)) return call.was_cancelled();
        double u[3], v[3];
        const double* p[3];
        uint32_t h = sides[t];
        for (size_t s = 0; s < 3; ++s, h = mesh.next[h]) {
            u[s] = atlas.uv[2 * size_t{h}];
            v[s] = atlas.uv[2 * size_t{h} + 1];
            p[s] = position + size_t{3} * mesh.origin[h];
        }
        const double image = ((u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0])) / 2;
        const AffineMap map = affine_map(p[0], p[1], p[2], u, v);
        if (!(image > 0) || !(map.area > 0)) continue;
        const double log_scale = natural_log(image / map.area) / 2;
        area += map.area;
        sum += map.area * log_scale;
        squares += map.area * log_scale * log_scale;
    }
    const double variance = area > 0 ? squares / area - (sum / area) * (sum / area) : 0;
    out.unevenness = variance > 0 ? std::sqrt(variance) : 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % MEASURES_STRIDE == 0 && !call.tick(0.99)) return call.was_cancelled();
        if (atlas.chart[mesh.face[2 * e]] == NONE || atlas.chart[mesh.face[2 * e + 1]] == NONE
            || atlas.is_joined(mesh, e))
            continue;
        ++out.seam_edges;
        out.seam_length += edge_length(mesh, position, e);
    }
    return HMF_OK;
}

} // namespace hmf
