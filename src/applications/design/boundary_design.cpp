#include "boundary_design.hpp"

#include "suggest_marks.hpp"
#include "../../core/curves/double_loops.hpp"
#include "weight_search.hpp"

namespace hmf {

namespace {

constexpr uint64_t BOUNDARY_VERTICES = 250; // of the coarsest level
constexpr double POLES_GAIN = 0.9;          // poles at limbs have to make the unevenness so much smaller

// Loops that the library makes, and as loops of the double.
struct SurfaceClass {
    FoundLoops found;
    WeightedLoops doubled;

    hmf_status find(const hmf_hierarchy& h, int32_t kind, Call& call) {
        if (surface_loops(h, kind, call, found)) return call.status();
        const hmf_loop_set set = found.set();
        if (double_loops(h, set, found.is_round.data(), call, doubled)
            || check_loops(h.input, doubled.loops, call, &set, &doubled.of))
            return call.status();
        return pull_tight(h.input, call, doubled.loops);
    }
};

// Loops with a weight above 0.
Done keep_boundary_loops(const FoundLoops& found, const Array<double>& weights, Memory& memory, Array<double>& kept,
                         FoundLoops& loops) {
    loops.offsets.start(memory);
    loops.triangles.start(memory);
    loops.arcs.start(memory);
    loops.arc_sides.start(memory);
    kept.start(memory);
    if (!loops.offsets.push(0)) return false;
    for (size_t c = 0; c < found.count(); ++c) {
        if (!(weights[c] > 0)) continue;
        for (uint64_t i = found.offsets[c]; i < found.offsets[c + 1]; ++i)
            if (!loops.triangles.push(found.triangles[i])) return false;
        if (!loops.offsets.push(loops.triangles.size()) || !loops.arcs.push(found.arcs[c])
            || !loops.arc_sides.push(found.arc_sides[2 * c]) || !loops.arc_sides.push(found.arc_sides[2 * c + 1])
            || !kept.push(weights[c]))
            return false;
    }
    return true;
}

// The most even one with these marked vertices; HUGE_VAL: there is none.  bare: it carries no quads in a part.
hmf_status design_with(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build, uint64_t solves,
                       Call& call, EvenDesign& out, FoundLoops& loops, bool& bare) {
    BuildOptions options;
    options.coarsest = BOUNDARY_VERTICES;
    options.mollify = build.mollify;
    options.position_stride = build.position_stride;
    options.marked_vertices = out.marks.data();
    options.marked_count = out.marks.size();
    hmf_hierarchy h(like, call.memory);
    if (build_hierarchy(h, mesh.positions, mesh.vertex_count, static_cast<size_t>(build.position_stride),
                        mesh.triangles, mesh.triangle_count, options, call))
        return call.status();
    WeightSearch search(h, call);
    Array<double> weights;
    if (search.start()) return call.status();
    {
        SurfaceClass plain;
        if (plain.find(h, HMF_LOOPS_CUT, call)) return call.status();
        if (!weights.allocate_filled(call.memory, plain.found.count(), 1.0)) return call.out_of_memory();
        if (search.measure(plain.doubled, weights, out.unevenness_before)) return call.status();
    }
    SurfaceClass pants;
    if (pants.find(h, HMF_LOOPS_PANTS, call) || search.run(pants.doubled, solves, weights, out.unevenness)
        || (out.unevenness < HUGE_VAL && search.keep_all_if_bare(pants.doubled, weights, out.unevenness, bare)))
        return call.status();
    out.solves = search.solves;
    return keep_boundary_loops(pants.found, weights, call.memory, out.weights, loops) ? HMF_OK : call.out_of_memory();
}

// Tests whether poles at corners of the boundary or at the ends of limbs, of the surface or of a flat piece, reduce the
// distortion. Limbs also without those on the boundary, because a boundary curve with one marked vertex is a part that
// carries no quads. bare: the design in out has such a part.
class PoleTrial {
public:
    PoleTrial(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build, uint64_t solves,
              Call& call) :
        like_(like),
        mesh_(mesh), build_(build), solves_(solves), call_(call) {}

    hmf_status run(MarksAt where, EvenDesign& out, FoundLoops& loops, bool& bare) {
        EvenDesign with;
        FoundLoops loops_with;
        Call inner(&call_); // what cannot be had is no error
        bool bare_with = false;
        taken = false;
        if (find_marks(where, inner, with.marks) || (where == MarksAt::corners && with.marks.empty())
            || design_with(like_, mesh_, build_, solves_, inner, with, loops_with, bare_with)) {
            if (inner.cancelled() || call_.cancelled()) return call_.was_cancelled();
            return call_.memory.failure() ? call_.out_of_memory() : HMF_OK;
        }
        out.solves += with.solves;
        if (bare_with || !(bare || with.unevenness < POLES_GAIN * out.unevenness)) return HMF_OK;
        with.solves = out.solves;
        with.unevenness_before = out.unevenness_before;
        out = static_cast<EvenDesign&&>(with);
        loops = static_cast<FoundLoops&&>(loops_with);
        bare = false;
        taken = true;
        return HMF_OK;
    }

    bool taken = false;       // the last one was better
    bool on_boundary = false; // some of its marked vertices were there

private:
    hmf_status find_marks(MarksAt where, Call& call, Array<uint32_t>& marks) {
        hmf_hierarchy scratch(like_, call_.memory);
        if (marks_at(where, scratch, mesh_.positions, mesh_.vertex_count, static_cast<size_t>(build_.position_stride),
                     mesh_.triangles, mesh_.triangle_count, build_, call, marks))
            return call.status();
        on_boundary = false;
        for (const uint32_t v : marks)
            on_boundary = on_boundary || (scratch.is_double() && scratch.mirror.is_boundary(v));
        return HMF_OK;
    }

    const hmf_hierarchy& like_;
    const MeshArrays& mesh_;
    const BuildOptions& build_;
    const uint64_t solves_;
    Call& call_;
};

} // namespace

hmf_status boundary_design(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build,
                           const DesignOptions& design, Call& call, EvenDesign& out, FoundLoops& loops) {
    call.range(0.15, 0.25);
    out.marks.start(call.memory);
    for (uint64_t k = 0; k < build.marked_count; ++k)
        if (!out.marks.push(build.marked_vertices[k])) return call.out_of_memory();
    if (out.marks.empty()) {
        hmf_hierarchy scratch(like, call.memory);
        if (suggest_marks(scratch, mesh.positions, mesh.vertex_count, static_cast<size_t>(build.position_stride),
                          mesh.triangles, mesh.triangle_count, build, call, out.marks))
            return call.status();
    }
    const bool free = build.marked_count == 0 && design.poles;
    bool bare = false;
    const uint64_t solves = free ? (design.solves + 1) / 2 : design.solves;
    call.range(0.25, free ? 0.6 : 1);
    if (design_with(like, mesh, build, solves, call, out, loops, bare)) return call.status();
    call.range(0.6, 1);
    PoleTrial poles(like, mesh, build, solves, call);
    if (free && poles.run(MarksAt::corners, out, loops, bare)) return call.status();
    if (free && !poles.taken && poles.run(MarksAt::limbs, out, loops, bare)) return call.status();
    if (free && !poles.taken && poles.on_boundary && poles.run(MarksAt::limbs_inside, out, loops, bare))
        return call.status();
    if (!(out.unevenness < HUGE_VAL))
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "No loops were found for an even design of this surface. Use hmf_loops, or another mesh.");
    return HMF_OK;
}

} // namespace hmf
