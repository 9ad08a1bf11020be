// applications.h: even design, conformal scale.
#include "../design/boundary_design.hpp"
#include "../design/conformal_scale.hpp"
#include "../common/caller_lists.hpp"
#include "../../core/api/foliation_object.hpp"
#include "mesh_entry.hpp"
#include "../../core/api/result.hpp"

using namespace hmf;

namespace {

// What a design consists of, by the caller's numbers.
struct Found {
    EvenDesign design; // its loops are not set
    FoundLoops loops;
};

// On a closed surface.
hmf_status take_closed(const hmf_hierarchy& h, Call& call, Found& out) {
    out.loops.offsets.swap(out.design.loops.offsets);
    return caller_triangles(h, out.design.loops.crossings, out.loops.triangles, call);
}

} // namespace

extern "C" void hmf_design_options_init(hmf_design_options* options, uint32_t struct_size) {
    init_options(options, struct_size, {});
}

extern "C" hmf_status hmf_even_design(const double* positions, size_t vertex_count, const uint32_t* triangles,
                                      size_t triangle_count, const hmf_design_options* options,
                                      const hmf_control* control, hmf_design** out, hmf_error* error) {
    hmf_design_options all;
    const bool readable = copy_options(options, all) && all.no_poles >= 0 && all.no_poles <= 1;
    MeshEntry entry(readable ? all.build : nullptr, control, error);
    Call& call = entry.call;
    if (entry.check(out)) return call.status();
    if (!readable) return unusable_options("hmf_design_options", call);
    if (entry.check_options()) return call.status();
    hmf_hierarchy& h = entry.hierarchy;
    const BuildOptions& build = entry.options;
    DesignOptions design;
    design.poles = !all.no_poles;
    design.solves = all.solve_limit;
    Found found;
    EvenDesign& made = found.design;
    if (even_design(h, positions, vertex_count, triangles, triangle_count, build, design, call, made)
        || (h.is_double() ? boundary_design(h, {positions, vertex_count, triangles, triangle_count}, build, design,
                                            call, made, found.loops)
                          : take_closed(h, call, found)))
        return call.status();
    struct Made {
        hmf_design design;
        hmf_loop_set loops;
    } result{{sizeof(hmf_design), 0, made.marks.size(), nullptr, nullptr, made.unevenness, made.unevenness_before,
              made.solves},
             {sizeof(hmf_loop_set), HMF_PATH_TRIANGLES, 0, found.loops.offsets.size() - 1, nullptr, nullptr, nullptr,
              nullptr, nullptr}};
    ResultBlock block;
    block.array(result, result.design.marked_vertices, made.marks.size(), made.marks.data());
    block.array(result, result.loops.offsets, found.loops.offsets.size(), found.loops.offsets.data());
    block.array(result, result.loops.elements, found.loops.triangles.size(), found.loops.triangles.data());
    if (h.is_double()) {
        block.array(result, result.loops.arcs, found.loops.arcs.size(), found.loops.arcs.data());
        block.array(result, result.loops.arc_sides, found.loops.arc_sides.size(), found.loops.arc_sides.data());
    }
    block.array(result, result.loops.weights, made.weights.size(), made.weights.data());
    Made* const copied = block.make(result, h, call);
    if (!copied) return call.status();
    copied->design.loops = &copied->loops;
    *out = &copied->design;
    call.finished();
    return HMF_OK;
}

extern "C" hmf_status hmf_conformal_scale(const hmf_foliation* foliation, const hmf_control* control, hmf_scale** out,
                                          hmf_error* error) {
    const hmf_hierarchy* const hierarchy = foliation ? foliation->hierarchy : nullptr;
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out)) return call.status();
    const size_t shown = hierarchy->shown_triangles(foliation->level); // NOLINT: check refuses NULL
    State state;
    ConformalScale scale;
    Array<uint32_t> side;
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    const Mesh& mesh = state.foliation.mesh;
    if (!call.tick(0.3)) return call.was_cancelled();
    if (!scale.measure(mesh, hierarchy->levels[foliation->level].position, state.foliation.value, foliation->unit,
                       call.memory, &call)
        || !side_of_triangles(*hierarchy, foliation->level, side, call))
        return call.stopped();
    if (!call.tick(0.8)) return call.was_cancelled();
    const double offset = scale.offset + natural_log(hierarchy->scale);
    hmf_scale result{sizeof(hmf_scale), 0, shown, nullptr, scale.unevenness()};
    ResultBlock block;
    block.room(result, result.log_scale, shown);
    hmf_scale* const made = block.make(result, *hierarchy, call);
    if (!made) return call.status();
    for (size_t t = 0; t < shown; ++t) fill(made->log_scale)[t] = scale.log_scale[mesh.face[side[t]]] + offset;
    *out = made;
    return entry.end();
}
