// hmf.h: even design.
#include "../design/boundary_design.hpp"
#include "../design/even_design.hpp"
#include "../hierarchy/suggest_marks.hpp"
#include "build_options.hpp"
#include "caller_numbers.hpp"
#include "read_loop_set.hpp"
#include "result.hpp"
#include "surface_loops.hpp"

using namespace hmf;

namespace {

// What a design consists of, by the caller's numbers.
struct Found {
    EvenDesign design; // its loops are not set
    FoundLoops loops;
};

struct MeshArrays {
    const double* positions;
    size_t vertex_count;
    const uint32_t* triangles;
    size_t triangle_count;
};

hmf_status read_pants(const hmf_hierarchy& h, int32_t kind, FoundLoops& found, WeightedLoops& loops, Call& call) {
    if (surface_loops(h, kind, call, found)) return call.status();
    const hmf_loop_set set = {sizeof set,           HMF_LOOP_TRIANGLES,     0,       found.count(),
                              found.offsets.data(), found.triangles.data(), nullptr, found.arcs.data()};
    return read_loop_set(h, &set, 0, loops, call);
}

// With boundary: marked vertices as suggested, pants loops of the surface, and weights for these.
hmf_status design_with_boundary(const hmf_hierarchy& like, const MeshArrays& mesh, BuildOptions build,
                                const DesignOptions& design, Call& call, Found& out) {
    Array<uint32_t>& marks = out.design.marks;
    marks.start(call.memory);
    for (uint64_t k = 0; k < build.marked_count; ++k)
        if (!marks.push(build.marked_vertices[k])) return call.out_of_memory();
    const size_t stride = static_cast<size_t>(build.position_stride);
    if (marks.empty()) {
        hmf_hierarchy scratch(like, call.memory);
        call.range(0.15, 0.25);
        if (suggest_marks(scratch, mesh.positions, mesh.vertex_count, stride, mesh.triangles, mesh.triangle_count,
                          build, call, marks))
            return call.status();
    }
    BuildOptions options;
    options.coarsest = 250;
    options.mollify = build.mollify;
    options.position_stride = build.position_stride;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    hmf_hierarchy h(like, call.memory);
    call.range(0.25, 0.4);
    if (build_hierarchy(h, mesh.positions, mesh.vertex_count, stride, mesh.triangles, mesh.triangle_count, options,
                        call))
        return call.status();
    call.range(0.4, 1);
    WeightSearch search(h, call);
    Array<double> weights;
    if (search.start()) return call.status();
    {
        FoundLoops plain;
        WeightedLoops loops;
        if (read_pants(h, HMF_LOOPS_CUT, plain, loops, call)) return call.status();
        if (!weights.allocate_filled(call.memory, plain.count(), 1.0)) return call.out_of_memory();
        if (search.measure({loops.loops, loops.of, loops.factor, plain.count()}, weights, out.design.unevenness_before))
            return call.status();
    }
    FoundLoops found;
    WeightedLoops loops;
    if (read_pants(h, HMF_LOOPS_PANTS, found, loops, call)
        || search.run({loops.loops, loops.of, loops.factor, found.count()}, design.solves, weights,
                      out.design.unevenness))
        return call.status();
    out.design.solves = search.solves;
    if (!(out.design.unevenness < HUGE_VAL))
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "No loops were found for an even design of this surface. Use hmf_loops, or another mesh.");
    out.loops.offsets.start(call.memory);
    out.loops.triangles.start(call.memory);
    out.loops.arcs.start(call.memory);
    out.design.weights.start(call.memory);
    if (!out.loops.offsets.push(0)) return call.out_of_memory();
    for (size_t c = 0; c < found.count(); ++c) {
        if (!(weights[c] > 0)) continue;
        for (uint64_t i = found.offsets[c]; i < found.offsets[c + 1]; ++i)
            if (!out.loops.triangles.push(found.triangles[i])) return call.out_of_memory();
        if (!out.loops.offsets.push(out.loops.triangles.size()) || !out.loops.arcs.push(found.arcs[c])
            || !out.design.weights.push(weights[c]))
            return call.out_of_memory();
    }
    return HMF_OK;
}

// On a closed surface.
hmf_status take_closed(const hmf_hierarchy& h, Call& call, Found& out) {
    Array<uint32_t> internal, triangle;
    if (caller_faces(h, internal, call) || inverse_numbers(internal.data(), internal.size(), triangle, call))
        return call.status();
    out.loops.offsets.swap(out.design.loops.offsets);
    out.loops.triangles.swap(out.design.loops.crossings);
    for (uint32_t& x : out.loops.triangles) x = triangle[h.input.face[x]];
    return HMF_OK;
}

} // namespace

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
    Found found;
    EvenDesign& made = found.design;
    if (even_design(h, positions, vertex_count, triangles, triangle_count, build, design, call, made)
        || (h.is_double() ? design_with_boundary(h, {positions, vertex_count, triangles, triangle_count}, build, design,
                                                 call, found)
                          : take_closed(h, call, found)))
        return call.status();
    struct Made {
        hmf_design design;
        hmf_loop_set loops;
    } result{{sizeof(hmf_design), 0, made.marks.size(), nullptr, nullptr, made.unevenness, made.unevenness_before,
              made.solves},
             {sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, 0, found.loops.offsets.size() - 1, nullptr, nullptr, nullptr,
              nullptr}};
    ResultBlock block;
    block.array(result, result.design.marked_vertices, made.marks.size(), made.marks.data());
    block.array(result, result.loops.offsets, found.loops.offsets.size(), found.loops.offsets.data());
    block.array(result, result.loops.elements, found.loops.triangles.size(), found.loops.triangles.data());
    if (h.is_double()) block.array(result, result.loops.arcs, found.loops.arcs.size(), found.loops.arcs.data());
    block.array(result, result.loops.weights, made.weights.size(), made.weights.data());
    Made* const copied = block.make(result, h, call);
    if (!copied) return call.status();
    copied->design.loops = &copied->loops;
    *out = &copied->design;
    call.finished();
    return HMF_OK;
}
