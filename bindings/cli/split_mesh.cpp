#include "split_mesh.hpp"

#include <algorithm>

#include "../readers/components.hpp"
#include "counted.hpp"
#include "library.hpp"

namespace cli {

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
    return "component " + std::to_string(number) + " (" + counted(part.mesh.triangle_count(), "triangle") + ", first "
         + std::to_string(part.triangles[0]) + ")";
}

} // namespace cli
