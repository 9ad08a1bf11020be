// Any triangles divided into components.
#pragma once

#include "host.hpp"
#include "surfaces.hpp"

namespace fuzz {

// Divides any triangles.  The status that hmf_hierarchy_create has to have, if they are one component; else negative.
inline hmf_status expect_components(const Surface& surface, size_t vertices, const hmf_hierarchy_options& build,
                                    bool memory_is_short) {
    const size_t triangles = surface.triangles.size() / 3;
    hmf_component_set* made = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_components(surface.positions.data(), vertices, surface.triangles.data(), triangles,
                                             &build, nullptr, &made, &error);
    const Owned<hmf_component_set> set(made);
    expect_status(status, error, {1, 2, 3});
    FUZZ_ASSERT(memory_is_short || status / 100 != 2);
    FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
    if (!set) return -1;
    size_t used = 0, first_edge = 0, first_triangle = 0;
    for (uint64_t k = 0; k < set->count; ++k) {
        const hmf_component& c = set->list[k];
        FUZZ_ASSERT(c.first_vertex == used && c.first_edge == first_edge && c.first_triangle == first_triangle);
        for (uint64_t v = used; v < used + c.vertex_count; ++v)
            FUZZ_ASSERT(set->vertex_component[set->whole_vertices[v]] == k
                        && set->vertex_part[set->whole_vertices[v]] == v - used);
        for (uint64_t t = first_triangle; t < first_triangle + c.triangle_count; ++t)
            for (size_t s = 0; s < 3; ++s)
                FUZZ_ASSERT(set->whole_vertices[used + set->part_triangles[3 * t + s]]
                            == surface.triangles[3 * size_t{set->whole_triangles[t]} + s]);
        used += static_cast<size_t>(c.vertex_count);
        first_edge += static_cast<size_t>(c.edge_count);
        first_triangle += static_cast<size_t>(c.triangle_count);
        FUZZ_ASSERT(c.status == HMF_OK || c.status / 100 == 3);
    }
    FUZZ_ASSERT(used == set->used_vertex_count && first_edge == set->edge_count && first_triangle == triangles);
    return set->count == 1 && used == vertices ? set->list[0].status : -1;
}

} // namespace fuzz
