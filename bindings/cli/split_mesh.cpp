#include "split_mesh.hpp"

#include <algorithm>
#include <cstdio>

#include "../readers/components.hpp"
#include "library.hpp"

namespace cli {

readers::Repairs repair_mesh(TriangleMesh& mesh, bool join_points, const std::string& mesh_name) {
    try {
        readers::Repairs repairs = readers::repair(mesh, join_points);
        for (const std::string& sentence : repairs.sentences())
            std::fprintf(stderr, "%s: %s\n", mesh_name.c_str(), sentence.c_str());
        if (repairs.count() == 0) std::fprintf(stderr, "%s: nothing to repair\n", mesh_name.c_str());
        if (mesh.triangles.empty()) throw Failure(EXIT_BAD_INPUT, mesh_name + ": no triangle is left");
        return repairs;
    } catch (const readers::MeshError& error) { throw Failure(EXIT_BAD_INPUT, mesh_name + ": " + error.what()); }
}

std::vector<MeshPart> split_mesh(TriangleMesh& mesh, const std::string& mesh_name) {
    const std::vector<uint32_t> component = readers::component_of_triangles(mesh.triangles, mesh.vertex_count());
    std::vector<MeshPart> parts;
    if (component.empty() || *std::max_element(component.begin(), component.end()) == 0) {
        parts.emplace_back();
        parts[0].mesh = std::move(mesh);
        return parts;
    }
    const auto set = make<hmf_component_set>(mesh_name, [&](hmf_component_set** out, hmf_error* error) {
        return hmf_components(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                              nullptr, nullptr, out, error);
    });
    const uint32_t* const in = set->vertex_component;
    const size_t unused = static_cast<size_t>(std::find(in, in + set->vertex_count, HMF_NONE) - in);
    if (unused < set->vertex_count)
        throw Failure(EXIT_BAD_INPUT, mesh_name + ": " + hmf_status_string(HMF_ERROR_MESH_UNUSED_VERTEX) + " (vertex "
                                          + std::to_string(unused) + ")"
                                          + repair_advice(HMF_ERROR_MESH_UNUSED_VERTEX, false, false));
    for (const hmf_component* c = set->list; c != set->list + set->count; ++c) {
        const auto copy = [](auto& to, const auto* array, uint64_t first, uint64_t count) {
            to.assign(array + first, array + first + count);
        };
        parts.emplace_back();
        copy(parts.back().mesh.positions, set->part_positions, 3 * c->first_vertex, 3 * c->vertex_count);
        copy(parts.back().mesh.triangles, set->part_triangles, 3 * c->first_triangle, 3 * c->triangle_count);
        copy(parts.back().vertices, set->whole_vertices, c->first_vertex, c->vertex_count);
        copy(parts.back().triangles, set->whole_triangles, c->first_triangle, c->triangle_count);
    }
    return parts;
}

std::string name_of_component(const MeshPart& part, size_t number) {
    return "component " + std::to_string(number) + " (" + std::to_string(part.mesh.triangle_count())
         + " triangles, first " + std::to_string(part.triangles[0]) + ")";
}

} // namespace cli
