// Searched on a coarse level, carried to the caller's mesh:
//
//     level 0 --collapses to end points--> coarse level = a mesh on its own
//                                               |  even_search.cpp
//     loops on level 0 <--shortened on each-- loops there
//
// Vertices of the coarse level are vertices of the caller, so marks need no
// carrying.  The levels themselves know no marks: to shorten loops there, marked
// vertices get the lowest numbers of a copy.
#include "even_design.hpp"

#include "suggest_marks.hpp"
#include "../common/caller_lists.hpp"
#include "../loops/carry_loops.hpp"
#include "../loops/library_loops.hpp"

namespace hmf {

namespace {

constexpr uint64_t DESIGN_VERTICES = 1000;               // of the coarse level
constexpr double TOO_UNEVEN = 0.45;                      // a finer level is tried as well,
constexpr double FEWEST_SOLVES = 10;                     // where the budget has as many of its loops
constexpr double LEAST_WORK = 120, EDGES_PER_WORK = 400; // EvenSearch::work; some 10 solves of level 0

// A mesh with other numbers for its vertices, marked ones first.
class MarkedView {
public:
    Done make(const Mesh& mesh, const double* position, const Array<uint32_t>& marks, Memory& memory) {
        const uint32_t n = mesh.vertex_count;
        Array<uint32_t> number; // of each vertex
        if (!number.allocate_filled(memory, n, NONE) || !origin_.allocate(memory, size_t{2} * mesh.edge_count)
            || !out_.allocate(memory, n) || !position_.allocate(memory, size_t{3} * n))
            return false;
        uint32_t next = 0;
        for (const uint32_t v : marks) number[v] = next++;
        for (uint32_t v = 0; v < n; ++v)
            if (number[v] == NONE) number[v] = next++;
        for (size_t h = 0; h < origin_.size(); ++h) origin_[h] = number[mesh.origin[h]];
        for (uint32_t v = 0; v < n; ++v) {
            out_[number[v]] = mesh.out[v];
            for (size_t c = 0; c < 3; ++c) position_[size_t{3} * number[v] + c] = position[size_t{3} * v + c];
        }
        mesh_ = mesh;
        mesh_.origin = origin_.data();
        mesh_.out = out_.data();
        mesh_.marked_count = static_cast<uint32_t>(marks.size());
        return true;
    }
    const Mesh& mesh() const { return mesh_; }
    const double* position() const { return position_.data(); }

private:
    Mesh mesh_;
    Array<uint32_t> origin_, out_;
    Array<double> position_;
};

Done copy_surface(const Mesh& mesh, const double* position, Memory& memory, TrialMesh& surface) {
    if (!surface.position.allocate(memory, size_t{3} * mesh.vertex_count)
        || !surface.triangles.allocate(memory, size_t{3} * mesh.face_count))
        return false;
    for (size_t i = 0; i < surface.position.size(); ++i) surface.position[i] = position[i];
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t a = mesh.next[h], b = mesh.next[a];
        if (h > a || h > b) continue;
        uint32_t* const corner = surface.triangles.data() + size_t{3} * mesh.face[h];
        corner[0] = mesh.origin[h];
        corner[1] = mesh.origin[a];
        corner[2] = mesh.origin[b];
    }
    return true;
}

// The loops of a trial on its finest level as loops of the mesh that the surface is a copy of.
hmf_status loops_on_surface(const MarkedTrial& made, const Mesh& mesh, Call& call, Loops& loops) {
    const hmf_hierarchy& trial = made.hierarchy();
    Array<uint32_t> vertex;
    if (!loops.copy_from(made.loops(), call.memory)) return call.out_of_memory();
    if (carry_to_finer(trial, trial.level_count - 1, 0, call, loops)) return call.status();
    if (inverse_numbers(trial.vertex_internal, mesh.vertex_count, vertex, call)) return call.status();
    for (uint32_t& x : loops.crossings) {
        const uint32_t from = vertex[trial.input.origin[x]], to = vertex[trial.input.target(x)];
        x = NONE;
        for (const uint32_t h : mesh.around(from))
            if (mesh.target(h) == to) x = h; // the only one: the mesh is simplicial
        if (x == NONE)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0, "An edge got lost. Please report this.");
    }
    return HMF_OK;
}

// The loops with a weight above 0.
Done keep_loops(const Array<double>& weights, EvenDesign& out, Memory& memory) {
    Loops kept;
    out.weights.start(memory);
    if (!kept.start(memory)) return false;
    for (size_t c = 0; c < weights.size(); ++c) {
        if (!(weights[c] > 0)) continue;
        if (!kept.add(out.loops, c) || !out.weights.push(weights[c])) return false;
    }
    out.loops = static_cast<Loops&&>(kept);
    return true;
}

// From a level to level 0, shortened on each.  marks: internal numbers.
hmf_status carry_to_input(const hmf_hierarchy& h, size_t level, const Array<uint32_t>& marks, Call& call,
                          Loops& loops) {
    MarkedView view;
    LoopCarrier carrier;
    if (level > 0 && !carrier.load(h, level, 0, loops, call.memory)) return call.out_of_memory();
    for (size_t k = level; k-- > 0;) {
        if (!carrier.refine(call)) return call.stopped();
        if (!carrier.read(0, loops.count(), loops, call)
            || !view.make(carrier.mesh(), h.levels[k].position, marks, call.memory))
            return call.out_of_memory();
        if (shorten_loops(view.mesh(), view.position(), call, loops)) return call.status();
        if (k > 0 && !carrier.replace(loops)) return call.out_of_memory();
    }
    if (!view.make(h.input, h.levels[0].position, marks, call.memory)) return call.out_of_memory();
    return pull_tight(view.mesh(), call, loops);
}

// The design on one level, with its loops there.  affordable: solves with these loops in the whole budget.
hmf_status design_on_level(const hmf_hierarchy& h, size_t level, const DesignOptions& options, double from, double to,
                           Call& call, double& affordable, EvenDesign& out) {
    const Mesh& mesh = loop_mesh(h, level);
    const double* position = h.levels[level].position;
    TrialMesh surface;
    Array<uint32_t> tips, ends, given;
    EvenChoice best;
    tips.start(call.memory);
    ends.start(call.memory);
    given.start(call.memory);
    if (!copy_surface(mesh, position, call.memory, surface)) return call.out_of_memory();
    for (uint32_t v = 0; v < mesh.marked_count; ++v)
        if (!given.push(v)) return call.out_of_memory();
    call.range(from, from + 0.02);
    if (h.genus == 0 && (options.poles || given.size() < 4) && !limb_tips(mesh, position, call, tips, ends))
        return call.stopped();
    call.range(from + 0.02, to);
    EvenSearch search(h, mesh, position, surface, call);
    const double by_size = static_cast<double>(h.input.edge_count) / EDGES_PER_WORK;
    search.budget = options.solves > 0   ? static_cast<double>(options.solves)
                  : by_size > LEAST_WORK ? by_size
                                         : LEAST_WORK;
    search.may_repeat = options.solves == 0;
    search.poles = options.poles;
    if (search.run(given, tips, ends, best)) return call.status();
    if (!(best.unevenness < HUGE_VAL))
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "No loops were found for an even design of this surface. Use hmf_loops, or another mesh.");
    if (search.round_weights(best)) return call.status();
    {
        MarkedTrial trial(h, call, search.fraction);
        if (trial.start(surface, best.marks, best.kind, best.loops)) return call.status();
        if (loops_on_surface(trial, mesh, call, out.loops)) return call.status();
        if (!keep_loops(best.weights, out, call.memory)) return call.out_of_memory();
    }
    out.marks.swap(best.marks);
    out.unevenness = best.unevenness;
    out.unevenness_before = search.unevenness_before;
    out.solves += search.solves;
    affordable = search.budget / EvenSearch::work_of(best.weights.size());
    return HMF_OK;
}

} // namespace

hmf_status even_design(hmf_hierarchy& h, const double* positions, size_t vertex_count, const uint32_t* triangles,
                       size_t triangle_count, const BuildOptions& build, const DesignOptions& options, Call& call,
                       EvenDesign& out) {
    BuildOptions coarse;
    coarse.collapse = HMF_COLLAPSE_ENDPOINT;
    coarse.coarsest = DESIGN_VERTICES;
    coarse.mollify = build.mollify;
    coarse.sphere_allowed = true;
    coarse.marked_vertices = build.marked_vertices;
    coarse.marked_count = build.marked_count;
    call.range(0, 0.15);
    if (build_hierarchy(h, positions, vertex_count, static_cast<size_t>(build.position_stride), triangles,
                        triangle_count, coarse, call))
        return call.status();
    if (h.is_double()) return HMF_OK;
    // Thin limbs get lost where the mesh is too coarse for them.
    size_t level = h.level_count - 1;
    double affordable = 0;
    if (design_on_level(h, level, options, 0.15, 0.5, call, affordable, out)) return call.status();
    if (out.unevenness > TOO_UNEVEN && affordable >= FEWEST_SOLVES && level > 0
        && h.levels[level - 1].mesh.vertex_count < 4 * DESIGN_VERTICES
        && design_on_level(h, --level, options, 0.5, 0.9, call, affordable, out))
        return call.status();
    call.range(0.9, 1);
    if (carry_to_input(h, level, out.marks, call, out.loops)) return call.status();
    Array<uint32_t> caller;
    if (inverse_numbers(h.vertex_internal, vertex_count, caller, call)) return call.status();
    for (uint32_t& v : out.marks) v = caller[v];
    return HMF_OK;
}

} // namespace hmf
