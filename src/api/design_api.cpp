// hmf.h: even design.
#include "../design/even_design.hpp"
#include "build_options.hpp"
#include "caller_numbers.hpp"
#include "result.hpp"

using namespace hmf;

extern "C" hmf_status hmf_even_design(const double* positions, size_t vertex_count, const uint32_t* triangles,
                                      size_t triangle_count, const hmf_design_options* options,
                                      const hmf_control* control, hmf_design** out, hmf_error* error) {
    if (out) *out = nullptr;
    const Control given(control);
    hmf_design_options all;
    hmf_build_options all_build;
    BuildOptions build;
    const bool readable = copy_options(options, all);
    const bool buildable = read_build_options(readable ? all.build : nullptr, all_build, build);
    if (!buildable) all_build.allocate = nullptr, all_build.release = nullptr;
    hmf_hierarchy h(all_build.allocate, all_build.release, all_build.allocator_user, all_build.memory_limit);
    Call call(h.memory, error, given.given);
    call.never_finish();
    if (!out) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "out is NULL. Give the address of a pointer.");
    if (!given.usable) return unusable_options("hmf_control", call);
    if (!readable || all.no_poles < 0 || all.no_poles > 1) return unusable_options("hmf_design_options", call);
    if (!buildable) return refuse_build_options(call);
    DesignOptions design;
    design.poles = !all.no_poles;
    design.solves = all.solve_limit;
    EvenDesign made;
    if (even_design(h, positions, vertex_count, triangles, triangle_count, build, design, call, made))
        return call.status();

    Array<uint32_t> internal, triangle;
    if (caller_faces(h, internal, call) || inverse_numbers(internal.data(), internal.size(), triangle, call))
        return call.status();
    for (uint32_t& x : made.loops.crossings) x = triangle[h.input.face[x]];
    struct Made {
        hmf_design design;
        hmf_loop_set loops;
    } result{{sizeof(hmf_design), 0, made.marks.size(), nullptr, nullptr, made.unevenness, made.unevenness_before,
              made.solves},
             {sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, 0, made.loops.count(), nullptr, nullptr, nullptr, nullptr}};
    ResultBlock block;
    block.array(result, result.design.marked_vertices, made.marks.size(), made.marks.data());
    block.array(result, result.loops.offsets, made.loops.offsets.size(), made.loops.offsets.data());
    block.array(result, result.loops.elements, made.loops.crossings.size(), made.loops.crossings.data());
    block.array(result, result.loops.weights, made.weights.size(), made.weights.data());
    Made* const copied = block.make(result, h, call);
    if (!copied) return call.status();
    copied->design.loops = &copied->loops;
    *out = &copied->design;
    call.finished();
    return HMF_OK;
}
