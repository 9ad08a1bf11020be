// hmf.h: loops, initialize.
#include "../cylinders/reference_loops.hpp"
#include "../hierarchy/caller_numbers.hpp"
#include "../loops/library_loops.hpp"
#include "../loops/surface_loops.hpp"
#include "../solve/double_reflection.hpp"
#include "foliation_object.hpp"
#include "read_loop_set.hpp"

using namespace hmf;

namespace {

// hmf_loops on a surface with boundary.
hmf_status loops_of_surface(const hmf_hierarchy& h, size_t level, int32_t kind, Call& call, hmf_loop_set** out) {
    if (level > 0)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                         "Level %llu is one of the closed double of the surface. Ask for loops of a surface with "
                         "boundary on level 0.",
                         static_cast<unsigned long long>(level));
    FoundLoops found;
    if (surface_loops(h, kind, call, found)) return call.status();
    hmf_loop_set made{sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, 0, found.count(), nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.array(made, made.offsets, found.offsets.size(), found.offsets.data());
    block.array(made, made.elements, found.triangles.size(), found.triangles.data());
    block.array(made, made.arcs, found.arcs.size(), found.arcs.data());
    *out = block.make(made, h, call);
    return call.status();
}

} // namespace

extern "C" {

hmf_status hmf_loops(const hmf_hierarchy* hierarchy, size_t level, int32_t kind, const hmf_control* control,
                     hmf_loop_set** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    if (hierarchy->is_double())
        return loops_of_surface(*hierarchy, level, kind, call, out) ? call.status() : entry.end();
    Loops loops;
    Array<uint32_t> faces;
    if (reference_loops(*hierarchy, level, kind, call, loops)
        || name_by_triangles(*hierarchy, level, call, loops, faces))
        return call.status();
    if (level == 0 && caller_triangles(*hierarchy, loops.crossings, faces, call)) return call.status();
    hmf_loop_set made{
        sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, level, loops.count(), nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.array(made, made.offsets, loops.offsets.size(), loops.offsets.data());
    block.array(made, made.elements, faces.size(), faces.data());
    *out = block.make(made, *hierarchy, call);
    return entry.end();
}

hmf_status hmf_initialize(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, const hmf_control* control,
                          hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out)) return call.status();
    WeightedLoops given;
    if (read_loop_set(*hierarchy, loops, hierarchy->level_count - 1, given, call)) return call.status();
    State state;
    if (!state.allocate(*hierarchy, given.level, call.memory)) return call.out_of_memory();
    state.load(given.level, Triangulation::input);
    initial_foliation(state.foliation.mesh, given.loops, given.weights.data(), state.foliation.value);
    Symmetrised made;
    if (make_symmetric(state, call, made)) return call.status();
    Making making;
    making.unit = given.unit;
    return make_foliation(state, making, call, out) ? call.status() : entry.end();
}

} // extern "C"
