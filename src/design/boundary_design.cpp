#include "boundary_design.hpp"

#include "../hierarchy/suggest_marks.hpp"
#include "../loops/double_loops.hpp"
#include "weight_search.hpp"

namespace hmf {

namespace {

constexpr uint64_t VERTICES = 250; // of the coarsest level

// Loops that the library makes, and as loops of the double.
struct SurfaceClass {
    FoundLoops found;
    DoubledLoops doubled;
    LoopsOfDouble of_double() const { return {doubled.loops, doubled.of, doubled.factor, found.count()}; }

    hmf_status find(const hmf_hierarchy& h, int32_t kind, Call& call) {
        if (surface_loops(h, kind, call, found)) return call.status();
        const SurfaceLoops loops = {HMF_LOOP_TRIANGLES,     found.count(),     found.offsets.data(),
                                    found.triangles.data(), found.arcs.data(), found.is_round.data()};
        if (double_loops(h, loops, call, doubled)) return call.status();
        const GivenLoops named{HMF_LOOP_TRIANGLES, doubled.offsets.data(), doubled.elements.data()};
        if (check_loops(h.input, doubled.loops, call, &named)) return call.status();
        return pull_tight(h.input, call, doubled.loops);
    }
};

hmf_status find_marks(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build, Call& call,
                      Array<uint32_t>& marks) {
    marks.start(call.memory);
    for (uint64_t k = 0; k < build.marked_count; ++k)
        if (!marks.push(build.marked_vertices[k])) return call.out_of_memory();
    if (!marks.empty()) return HMF_OK;
    hmf_hierarchy scratch(like, call.memory);
    return suggest_marks(scratch, mesh.positions, mesh.vertex_count, static_cast<size_t>(build.position_stride),
                         mesh.triangles, mesh.triangle_count, build, call, marks);
}

// Those with a weight.
Done keep_loops(const FoundLoops& found, const Array<double>& weights, Memory& memory, Array<double>& kept,
                FoundLoops& loops) {
    loops.offsets.start(memory);
    loops.triangles.start(memory);
    loops.arcs.start(memory);
    kept.start(memory);
    if (!loops.offsets.push(0)) return false;
    for (size_t c = 0; c < found.count(); ++c) {
        if (!(weights[c] > 0)) continue;
        for (uint64_t i = found.offsets[c]; i < found.offsets[c + 1]; ++i)
            if (!loops.triangles.push(found.triangles[i])) return false;
        if (!loops.offsets.push(loops.triangles.size()) || !loops.arcs.push(found.arcs[c]) || !kept.push(weights[c]))
            return false;
    }
    return true;
}

} // namespace

hmf_status boundary_design(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build,
                           const DesignOptions& design, Call& call, EvenDesign& out, FoundLoops& loops) {
    call.range(0.15, 0.25);
    if (find_marks(like, mesh, build, call, out.marks)) return call.status();
    BuildOptions options;
    options.coarsest = VERTICES;
    options.mollify = build.mollify;
    options.position_stride = build.position_stride;
    options.marked_vertices = out.marks.data();
    options.marked_count = out.marks.size();
    hmf_hierarchy h(like, call.memory);
    call.range(0.25, 0.4);
    if (build_hierarchy(h, mesh.positions, mesh.vertex_count, static_cast<size_t>(build.position_stride),
                        mesh.triangles, mesh.triangle_count, options, call))
        return call.status();
    call.range(0.4, 1);
    WeightSearch search(h, call);
    Array<double> weights;
    if (search.start()) return call.status();
    {
        SurfaceClass plain;
        if (plain.find(h, HMF_LOOPS_CUT, call)) return call.status();
        if (!weights.allocate_filled(call.memory, plain.found.count(), 1.0)) return call.out_of_memory();
        if (search.measure(plain.of_double(), weights, out.unevenness_before)) return call.status();
    }
    SurfaceClass pants;
    if (pants.find(h, HMF_LOOPS_PANTS, call) || search.run(pants.of_double(), design.solves, weights, out.unevenness)
        || (out.unevenness < HUGE_VAL && search.keep_all_if_bare(pants.of_double(), weights, out.unevenness)))
        return call.status();
    out.solves = search.solves;
    if (!(out.unevenness < HUGE_VAL))
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "No loops were found for an even design of this surface. Use hmf_loops, or another mesh.");
    return keep_loops(pants.found, weights, call.memory, out.weights, loops) ? HMF_OK : call.out_of_memory();
}

} // namespace hmf
