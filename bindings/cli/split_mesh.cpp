#include "split_mesh.hpp"

#include <algorithm>
#include <cstdio>

#include "failure.hpp"

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

std::vector<readers::Component> split_mesh(TriangleMesh& mesh, const std::string& mesh_name) {
    const std::vector<uint32_t> component = readers::component_of_triangles(mesh.triangles, mesh.vertex_count());
    std::vector<readers::Component> parts;
    if (component.empty() || *std::max_element(component.begin(), component.end()) == 0) {
        parts.emplace_back();
        parts[0].mesh = std::move(mesh);
        return parts;
    }
    std::vector<uint8_t> is_used(mesh.vertex_count(), 0);
    for (const uint32_t v : mesh.triangles) is_used[v] = 1;
    const auto unused = std::find(is_used.begin(), is_used.end(), 0);
    if (unused != is_used.end())
        throw Failure(EXIT_BAD_INPUT, mesh_name + ": " + hmf_status_string(HMF_ERROR_MESH_UNUSED_VERTEX) + " (vertex "
                                          + std::to_string(unused - is_used.begin()) + ")"
                                          + repair_advice(HMF_ERROR_MESH_UNUSED_VERTEX, false, false));
    return readers::components_of(mesh);
}

std::string name_of_component(const readers::Component& component, size_t number) {
    return "component " + std::to_string(number) + " (" + std::to_string(component.mesh.triangle_count())
         + " triangles, first " + std::to_string(component.triangles[0]) + ")";
}

} // namespace cli
