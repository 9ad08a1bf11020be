#include "read_loop_set.hpp"

#include "../hierarchy/caller_numbers.hpp"
#include "../curves/double_loops.hpp"
#include "read_values.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// Kind, count and offsets.
hmf_status check_shape(const hmf_hierarchy& h, const hmf_loop_set& all, Call& call) {
    if (all.level >= h.level_count) return check_level(h, static_cast<size_t>(all.level), call);
    if (all.element_kind != HMF_PATH_TRIANGLES && all.element_kind != HMF_PATH_VERTICES)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "element_kind is %d. Use HMF_PATH_TRIANGLES or HMF_PATH_VERTICES.",
                         static_cast<int>(all.element_kind));
    if (all.count == 0 || !all.offsets || !all.elements)
        return call.fail(all.count == 0 ? HMF_ERROR_LOOP_COUNT : HMF_ERROR_NULL, HMF_ELEMENT_LOOP, 0,
                         "There are no loops. Give at least one.");
    for (uint64_t c = 0; c < all.count; ++c)
        if (all.offsets[c + 1] < all.offsets[c] || all.offsets[0] != 0)
            return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c,
                             "The offsets of loop %llu decrease, or do not start at 0.",
                             static_cast<unsigned long long>(c));
    return HMF_OK;
}

// Loops and arcs on a surface with boundary, as loops of its double.
hmf_status read_on_double(const hmf_hierarchy& h, const hmf_loop_set& all, const uint8_t* is_round, WeightedLoops& out,
                          Call& call) {
    if (all.level > 0)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, all.level,
                         "The loops lie on level %llu, which is one of the closed double of the surface. Give "
                         "loops of a surface with boundary on level 0.",
                         static_cast<unsigned long long>(all.level));
    for (uint64_t c = 0; c < all.count; ++c)
        if (all.offsets[c + 1] == all.offsets[c])
            return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c, "Loop %llu has no elements.",
                             static_cast<unsigned long long>(c));
    return double_loops(h, all, is_round, call, out);
}

// Loops on a closed surface.
hmf_status read_on_closed(const hmf_hierarchy& h, const hmf_loop_set& all, WeightedLoops& out, Call& call) {
    for (uint64_t c = 0; all.arcs && c < all.count; ++c)
        if (all.arcs[c])
            return call.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                             "Loop %llu is an arc from boundary to boundary, but the surface has no boundary.",
                             static_cast<unsigned long long>(c));
    const Mesh& mesh = loop_mesh(h, out.level);
    const uint32_t* used = all.elements;
    Array<uint32_t> internal;
    if (out.level == 0) {
        const uint64_t elements = all.offsets[all.count];
        if (!internal.allocate(call.memory, elements)) return call.out_of_memory();
        const bool triangles = all.element_kind == HMF_PATH_TRIANGLES;
        const uint32_t limit = triangles ? mesh.face_count : mesh.vertex_count;
        for (uint64_t i = 0; i < elements; ++i)
            internal[i] = all.elements[i] >= limit ? NONE
                        : triangles                ? internal_face(h, all.elements[i])
                                                   : h.vertex_internal[all.elements[i]];
        used = internal.data();
    }
    return read_loops(mesh, all.element_kind, all.count, all.offsets, used, call, out.loops);
}

// Weights in units; NULL: all 1.
hmf_status read_weights(bool is_double, const double* weights, WeightedLoops& out, Call& call) {
    const size_t count = out.loops.count();
    double largest = weights ? 0 : 1;
    double smallest = weights ? HUGE_VAL : 1;
    for (size_t k = 0; weights && k < count; ++k) {
        const size_t c = out.callers(static_cast<uint32_t>(k));
        const double w = weights[c];
        if (!(w > 0) || !(w < 1e100) || w < 1e-100)
            return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, c,
                             "The weight of loop %llu is %g. Weights are at least 1e-100 and below 1e100.",
                             static_cast<unsigned long long>(c), w);
        largest = std::max(largest, w);
        smallest = std::min(smallest, w);
    }
    if (largest / smallest > 1048576.0)
        return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, 0,
                         "The weights span a factor of %g. Keep them within 2^20.", largest / smallest);
    // A loop around a boundary has twice its weight.
    out.unit = unit_of_weights(is_double ? 2 * largest : largest);
    if (!out.weights.allocate(call.memory, count)) return call.out_of_memory();
    for (size_t c = 0; c < count; ++c) {
        out.weights[c] =
            static_cast<int64_t>((weights ? weights[out.callers(static_cast<uint32_t>(c))] : 1.0) / out.unit);
        if (c < out.factor.size()) out.weights[c] *= out.factor[c];
    }
    return HMF_OK;
}

} // namespace

hmf_status set_unit_weights(WeightedLoops& out, Call& call) { return read_weights(false, nullptr, out, call); }

hmf_status read_loop_set(const hmf_hierarchy& h, const hmf_loop_set* set, const uint8_t* is_round, WeightedLoops& out,
                         Call& call) {
    if (!set)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "The loops are NULL. Give loops, or take those of hmf_loops.");
    hmf_loop_set all;
    if (read_options(set, all, "hmf_loop_set", call) || check_shape(h, all, call)) return call.status();
    out.level = static_cast<size_t>(all.level);
    if ((h.is_double() ? read_on_double(h, all, is_round, out, call) : read_on_closed(h, all, out, call))
        || read_weights(h.is_double(), all.weights, out, call))
        return call.status();
    const Mesh& mesh = loop_mesh(h, out.level);
    const hmf_status status = check_loops(mesh, out.loops, call, &all, &out.of);
    return status ? status : pull_tight(mesh, call, out.loops);
}

} // namespace hmf
