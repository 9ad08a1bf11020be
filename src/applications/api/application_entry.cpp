#include "application_entry.hpp"

#include "../common/boundary_zeros.hpp"

namespace hmf {

hmf_status refuse_level_of_double(const hmf_foliation& foliation, Call& call) {
    if (!foliation.hierarchy->is_double() || foliation.level == 0) return HMF_OK;
    return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LEVEL, foliation.level,
                     "Level %llu is one of the closed double of the surface. Carry the foliation to level 0 with "
                     "hmf_interpolate.",
                     static_cast<unsigned long long>(foliation.level));
}

hmf_status Leaves::load(const hmf_foliation& f, Call& call, Reflection* reflection) {
    if (load_values(f, f.level, state, call)) return call.status();
    const bool is_double = reflection && f.level == 0 && f.hierarchy->is_double();
    if (is_double && read_reflection(*f.hierarchy, *reflection, call)) return call.status();
    if (is_double) {
        const Foliation& at = state.foliation;
        cylinders.graph.division = division_at_boundary(*reflection);
        for (uint32_t e = 0; e < at.mesh.edge_count; ++e) {
            const bool behind = !reflection->is_front[2 * e] && !reflection->is_front[2 * e + 1];
            uint32_t& widest = cylinders.graph.closed_leaf;
            if (behind && (widest == NONE || at.value[e] > at.value[widest])) widest = e;
        }
    }
    if (f.level == 0) {
        if (caller_faces(*f.hierarchy, face_order, call)) return call.status();
        vertices = f.hierarchy->vertex_internal;
        faces = face_order.data();
    }
    if (!call.tick(0.05)) return call.was_cancelled();
    return cylinders.build(state.foliation, vertices, faces, call);
}

} // namespace hmf
