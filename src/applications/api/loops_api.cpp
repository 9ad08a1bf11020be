// applications.h: the loops that the library makes.
#include "../common/caller_lists.hpp"
#include "../loops/library_loops.hpp"
#include "../loops/surface_loops.hpp"
#include "../../core/api/solve_call.hpp"

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
    hmf_loop_set made = found.set();
    ResultBlock block;
    block.array(made, made.offsets, found.offsets.size(), found.offsets.data());
    block.array(made, made.elements, found.triangles.size(), found.triangles.data());
    block.array(made, made.arcs, found.arcs.size(), found.arcs.data());
    block.array(made, made.arc_sides, found.arc_sides.size(), found.arc_sides.data());
    *out = block.make(made, h, call);
    return call.status();
}

// On a closed surface on the given level, with boundary on level 0; weights 1.
hmf_status weighted_cut_system(const hmf_hierarchy& h, size_t level, WeightedLoops& out, Call& call) {
    if (h.is_double()) {
        FoundLoops found;
        if (surface_loops(h, HMF_LOOPS_CUT, call, found)) return call.status();
        const hmf_loop_set made = found.set();
        return read_loop_set(h, &made, found.is_round.data(), out, call);
    }
    out.level = level;
    return reference_loops(h, level, HMF_LOOPS_CUT, call, out.loops) ? call.status() : set_unit_weights(out, call);
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
    hmf_loop_set made{};
    made.struct_size = sizeof made;
    made.element_kind = HMF_PATH_TRIANGLES;
    made.level = level;
    made.count = loops.count();
    ResultBlock block;
    block.array(made, made.offsets, loops.offsets.size(), loops.offsets.data());
    block.array(made, made.elements, faces.size(), faces.data());
    *out = block.make(made, *hierarchy, call);
    return entry.end();
}

hmf_status hmf_solve_cut_system(const hmf_hierarchy* hierarchy, const hmf_solve_options* options,
                                const hmf_control* control, hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error, true);
    Call& call = entry.call;
    SolveOptions solve;
    if (entry.check(hierarchy, out) || read_solve_options(options, *hierarchy, solve, call)) return call.status();
    if (solve.start)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "There is a start, which gives the class. Use hmf_solve, or set start to NULL.");
    call.range(0, 0); // the levels share the whole range
    WeightedLoops cut;
    if (weighted_cut_system(*hierarchy, first_level(*hierarchy, solve), cut, call)) return call.status();
    return solve_loops(*hierarchy, cut, solve, call, out);
}

} // extern "C"
