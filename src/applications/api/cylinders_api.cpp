// applications.h: cylinders.
#include "../cylinders/cylinder_measures.hpp"
#include "../cylinders/front_cylinders.hpp"
#include "../cylinders/to_minimum.hpp"
#include "../../core/api/read_loop_set.hpp"
#include "../../core/api/result.hpp"
#include "application_entry.hpp"

#include <cmath>

using namespace hmf;

namespace {

// Middle leaves as triangle loops of the caller.
hmf_status name_middle_leaves(const Leaves& leaves, Curves& curves, Array<uint32_t>& triangles, Call& call) {
    const Mesh& mesh = leaves.state.foliation.mesh;
    Array<uint32_t> triangle_of_face;
    if (middle_leaves(leaves.state.foliation, leaves.cylinders, nullptr, curves, call)) return call.status();
    if (!triangles.allocate(call.memory, curves.crossings.size())) return call.out_of_memory();
    // The triangle that each crossing leads into.
    for (size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.face[twin(curves.crossings[i].half_edge)];
    if (!leaves.faces) return HMF_OK;
    if (inverse_numbers(leaves.faces, mesh.face_count, triangle_of_face, call)) return call.status();
    for (uint32_t& t : triangles) t = triangle_of_face[t];
    return HMF_OK;
}

// Those of the caller's loops on a surface with boundary.
hmf_status keep_front_of_set(const hmf_hierarchy& h, const hmf_loop_set& loops, const WeightedLoops& given,
                             CylindersWithLeaves cylinders, Array<double>& heights, Call& call) {
    hmf_loop_set all;
    if (read_options(&loops, all, "hmf_loop_set", call)
        || keep_front_cylinders(all, given.factor, h.surface_triangles, cylinders, call))
        return call.status();
    for (size_t c = 0; c < cylinders.list.size(); ++c) heights[c] = cylinders.list[c].height;
    return HMF_OK;
}

// At the minimum the cylinders fill the surface: their areas, each found from one leaf, add up to the energy.
hmf_status check_sum_of_areas(const Array<hmf_cylinder>& list, const State& solved, double unit, double& error,
                              Call& call) {
    constexpr double largest = 1e-4; // tests: 1e-6
    const double whole = energy(solved.foliation, solved.hierarchy->levels[solved.level].weight) * unit * unit;
    double sum = 0;
    for (const hmf_cylinder& cylinder : list) sum += cylinder.height * cylinder.circumference;
    error = std::fabs(sum / whole - 1);
    if (error <= largest) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "The areas of the cylinders add up to %.9g times the energy. Please report it.", sum / whole);
}

} // namespace

extern "C" hmf_status hmf_cylinders(const hmf_foliation* foliation, const hmf_loop_set* loops,
                                    const hmf_control* control, hmf_cylinder_set** out, hmf_error* error) {
    ApplicationEntry entry(foliation, control, error);
    Call& call = entry.call;
    if (entry.check(out)) return call.status();
    const hmf_hierarchy& h = *foliation->hierarchy;
    if (h.is_double() && (!loops || foliation->level > 0))
        return call.fail(
            HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
            "Cylinders of a surface with boundary are told apart by their loops, on level 0. Give the loops "
            "of the foliation, and carry it to level 0.");
    WeightedLoops given;
    if (loops && read_loop_set(h, loops, nullptr, given, call)) return call.status();
    Leaves leaves;
    State solved;
    Curves curves;
    Array<uint32_t> triangles;
    Array<hmf_cylinder> list;
    Array<double> heights;
    Twists twists;
    if (leaves.load(*foliation, call) || name_middle_leaves(leaves, curves, triangles, call)) return call.status();
    const size_t n = leaves.cylinders.list.size();
    if (!list.allocate(call.memory, n) || !heights.allocate(call.memory, n)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) {
        heights[c] = static_cast<double>(leaves.cylinders.list[c].height) * foliation->unit;
        list[c] = {HMF_NONE, 0, heights[c], 0, 0, 0};
    }
    double unit = foliation->unit, area_error = 0;
    if (load_solved_in_unit_of_values(*foliation, solved, call)
        || (!is_minimum(*foliation) && to_minimum(solved, unit, call))
        || measure_cylinders({leaves.state, leaves.cylinders, foliation->unit}, loops ? &given : nullptr, solved, unit,
                             list, h.is_double() ? nullptr : &twists, call)
        || check_sum_of_areas(list, solved, unit, area_error, call))
        return call.status();

    Array<uint8_t> arcs;
    if (h.is_double() && loops
        && keep_front_of_set(h, *loops, given, {list, curves.offsets, triangles, arcs}, heights, call))
        return call.status();
    const size_t count = list.size();
    if (h.is_double()
        && (!twists.twist.allocate_filled(call.memory, count, double{NAN})
            || !twists.offsets.allocate_filled(call.memory, 2 * count + 1, uint64_t{0})))
        return call.out_of_memory();
    struct Made {
        hmf_cylinder_set set;
        hmf_loop_set leaves;
    } made{{sizeof(hmf_cylinder_set), 0, count, nullptr, nullptr, area_error, nullptr, nullptr, nullptr, nullptr},
           {sizeof(hmf_loop_set), HMF_PATH_TRIANGLES, foliation->level, count, nullptr, nullptr, nullptr, nullptr,
            nullptr}};
    ResultBlock block;
    block.array(made, made.set.list, count, list.data());
    block.array(made, made.set.twists, count, twists.twist.data());
    block.array(made, made.set.corner_offsets, 2 * count + 1, twists.offsets.data());
    block.array(made, made.set.corner_vertices, twists.vertices.size(), twists.vertices.data());
    block.array(made, made.set.corner_places, twists.places.size(), twists.places.data());
    block.array(made, made.leaves.offsets, count + 1, curves.offsets.data());
    block.array(made, made.leaves.elements, triangles.size(), triangles.data());
    block.array(made, made.leaves.weights, count, heights.data());
    if (h.is_double()) block.array(made, made.leaves.arcs, count, arcs.data());
    Made* result = block.make(made, h, call);
    if (!result) return call.status();
    result->set.leaves = &result->leaves;
    *out = &result->set;
    return entry.end();
}
