#include "quad_figures.hpp"

#include "nearest_quads.hpp"
#include "surface_lines.hpp"
#include "surface_search.hpp"

#include <algorithm>

namespace hmf {

namespace {

Done measure_distance(const Mesh& mesh, const double* position, const QuadMesh& quads, double& distance, Call& call) {
    NearestQuads near;
    if (!near.build(quads, call.memory)) return false;
    double square = 0;
    for (uint32_t x = 0; x < mesh.vertex_count; ++x) {
        if (side_at(mesh, x) == NONE) continue;
        const NearestQuads::Place place = near.find(point(position, x), square);
        if (!call.work(place.steps, 0, false)) return false;
        square = std::max(square, place.square);
    }
    distance = std::sqrt(square);
    return true;
}

} // namespace

Done count_inverted(const SurfaceSearch& surface, const QuadMesh& quads, uint64_t& inverted, Call& call) {
    inverted = 0;
    for (size_t q = 0; q < quads.quad_count(); ++q) {
        if (!call.work(256, 0, false)) return false; // a search of the tree of triangles
        inverted += !(worst_corner(quads, q, &surface) > 0);
    }
    return true;
}

hmf_status quad_figures(const Mesh& mesh, const double* position, const QuadMesh& quads, QuadFigures& figures,
                        Call& call) {
    SurfaceSearch surface;
    Array<uint32_t> valence;
    figures = {};
    if (!surface.build(mesh, position, call.memory) || !valence.allocate_filled(call.memory, quads.vertex_count(), 0u))
        return call.out_of_memory();
    for (const uint32_t v : quads.quads) ++valence[v];
    for (uint32_t v = 0; v < quads.vertex_count(); ++v)
        figures.irregular += valence[v] != (is_at_boundary(quads.held[v]) ? 2 : 4);
    for (size_t q = 0; q < quads.quad_count(); ++q) {
        const auto corner = [&](size_t k) { return at(quads, quads.quads[4 * q + k]); };
        const Point normal = cross(corner(2) - corner(0), corner(3) - corner(1));
        figures.area += 0.5 * length_of(normal);
    }
    if (!count_inverted(surface, quads, figures.inverted, call)
        || !measure_distance(mesh, position, quads, figures.distance, call))
        return call.stopped();
    return HMF_OK;
}

} // namespace hmf
