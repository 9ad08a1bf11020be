#include "read_loop_set.hpp"

#include "../loops/double_loops.hpp"
#include "caller_numbers.hpp"
#include "canonical_loops.hpp"
#include "surface_loops.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

hmf_status read_loop_set(const hmf_hierarchy& h, const hmf_loop_set* set, size_t own, WeightedLoops& out, Call& call) {
    Loops& loops = out.loops;
    const double* given_weights = nullptr;
    GivenLoops given{};
    DoubledLoops doubled;
    if (!set && h.is_double()) {
        FoundLoops found;
        if (surface_loops(h, HMF_LOOPS_CUT, call, found)) return call.status();
        const hmf_loop_set made = {sizeof made,          HMF_LOOP_TRIANGLES,     0,       found.count(),
                                   found.offsets.data(), found.triangles.data(), nullptr, found.arcs.data()};
        return read_loop_set(h, &made, own, out, call);
    }
    if (!set) {
        out.level = own;
        if (canonical_loops(h, own, HMF_LOOPS_CUT, call, loops)) return call.status();
    } else {
        hmf_loop_set all;
        if (read_options(set, all, "hmf_loop_set", call)) return call.status();
        if (all.level >= h.level_count) return check_level(h, static_cast<size_t>(all.level), call);
        const size_t level = out.level = static_cast<size_t>(all.level);
        if (all.element_kind != HMF_LOOP_TRIANGLES && all.element_kind != HMF_LOOP_VERTICES)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                             "element_kind is %d. Use HMF_LOOP_TRIANGLES or HMF_LOOP_VERTICES.",
                             static_cast<int>(all.element_kind));
        if (all.count == 0 || !all.offsets || !all.elements)
            return call.fail(all.count == 0 ? HMF_ERROR_LOOP_COUNT : HMF_ERROR_NULL, HMF_ELEMENT_LOOP, 0,
                             "There are no loops. Give at least one, or NULL for the loops that the library makes.");
        for (uint64_t c = 0; c < all.count; ++c)
            if (all.offsets[c + 1] < all.offsets[c] || all.offsets[0] != 0)
                return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c,
                                 "The offsets of loop %llu decrease, or do not start at 0.",
                                 static_cast<unsigned long long>(c));
        const uint64_t elements = all.offsets[all.count];
        const Mesh& mesh = loop_mesh(h, level);
        if (h.is_double()) {
            if (level > 0)
                return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                                 "The loops lie on level %llu, which is one of the closed double of the surface. Give "
                                 "loops of a surface with boundary on level 0.",
                                 static_cast<unsigned long long>(level));
            for (uint64_t c = 0; c < all.count; ++c)
                if (all.offsets[c + 1] == all.offsets[c])
                    return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c, "Loop %llu has no elements.",
                                     static_cast<unsigned long long>(c));
            const SurfaceLoops surface = {all.element_kind, static_cast<size_t>(all.count), all.offsets, all.elements,
                                          all.arcs};
            if (double_loops(h, surface, call, doubled)) return call.status();
            loops.swap(doubled.loops);
            out.of.swap(doubled.of);
        }
        for (uint64_t c = 0; all.arcs && !h.is_double() && c < all.count; ++c)
            if (all.arcs[c])
                return call.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                                 "Loop %llu is an arc from boundary to boundary, but the surface has no boundary.",
                                 static_cast<unsigned long long>(c));
        Array<uint32_t> internal;
        const uint32_t* used = all.elements;
        if (level == 0 && !h.is_double()) {
            if (!internal.allocate(call.memory, elements)) return call.out_of_memory();
            const bool triangles = all.element_kind == HMF_LOOP_TRIANGLES;
            const uint32_t limit = triangles ? mesh.face_count : mesh.vertex_count;
            for (uint64_t i = 0; i < elements; ++i)
                internal[i] = all.elements[i] >= limit ? NONE
                            : triangles                ? internal_face(h, all.elements[i])
                                                       : h.vertex_internal[all.elements[i]];
            used = internal.data();
        }
        if (!h.is_double() && read_loops(mesh, all.element_kind, all.count, all.offsets, used, call, loops))
            return call.status();
        given_weights = all.weights;
        given = h.is_double() ? GivenLoops{all.element_kind, doubled.offsets.data(), doubled.elements.data()}
                              : GivenLoops{all.element_kind, all.offsets, all.elements};
    }
    const size_t count = loops.count();
    double largest = given_weights ? 0 : 1;
    double smallest = given_weights ? HUGE_VAL : 1;
    for (size_t k = 0; given_weights && k < count; ++k) {
        const size_t c = out.callers(static_cast<uint32_t>(k));
        const double w = given_weights[c];
        if (!(w > 0) || !(w < 1e100) || w < 1e-100)
            return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, c,
                             "The weight of loop %llu is %g. Weights are positive and finite.",
                             static_cast<unsigned long long>(c), w);
        largest = std::max(largest, w);
        smallest = std::min(smallest, w);
    }
    if (largest / smallest > 1048576.0)
        return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, 0,
                         "The weights span a factor of %g. Keep them within 2^20.", largest / smallest);
    // A loop round a boundary has twice its weight.
    out.unit = unit_of_weights(h.is_double() ? 2 * largest : largest);
    if (!out.weights.allocate(call.memory, count)) return call.out_of_memory();
    for (size_t c = 0; c < count; ++c) {
        out.weights[c] = static_cast<int64_t>(
            (given_weights ? given_weights[out.callers(static_cast<uint32_t>(c))] : 1.0) / out.unit);
        if (c < doubled.factor.size()) out.weights[c] *= doubled.factor[c];
    }
    out.factor.swap(doubled.factor);
    if (!set) return HMF_OK;
    const Mesh& mesh = loop_mesh(h, out.level);
    const hmf_status status = check_loops(mesh, loops, call, &given);
    return status ? status : pull_tight(mesh, call, loops);
}

} // namespace hmf
