// uses.h: parameterise, trace, cylinders, quads.
#include "../../include/hmf/uses.h"

#include "../atlas/atlas.hpp"
#include "../design/conformal_scale.hpp"
#include "../leaves/cylinder_measures.hpp"
#include "../leaves/quad_mesh.hpp"
#include "../leaves/relax_quads.hpp"
#include "../leaves/snap_quads.hpp"
#include "../leaves/trace.hpp"
#include "../parameterize/parameterization.hpp"
#include "../solve/to_minimum.hpp"
#include "caller_numbers.hpp"
#include "front_lines.hpp"
#include "read_loop_set.hpp"
#include "shared_flat.hpp"

#include <cmath>

using namespace hmf;

namespace {

// A call on a foliation without poles.
class UseEntry : public Entry {
public:
    UseEntry(const hmf_foliation* foliation, const hmf_control* control, hmf_error* error) :
        Entry(foliation ? foliation->hierarchy : nullptr, control, error), foliation_(foliation) {}
    template <class Result>
    hmf_status check(Result** out) {
        if (Entry::check(foliation_ ? foliation_->hierarchy : nullptr, out)) return call.status();
        return check_foliation(foliation_, call);
    }

private:
    const hmf_foliation* foliation_;
};

// The foliation on the caller's side of its level, with the order in which the
// caller numbers vertices and faces, and its cylinders.
struct Leaves {
    State state;
    Array<uint32_t> face_order;
    const uint32_t* vertices = nullptr;
    const uint32_t* faces = nullptr;
    Cylinders cylinders;

    // reflection: filled on level 0 of a double, whose clusters on the boundary are then taken apart; NULL: not wanted.
    hmf_status load(const hmf_foliation& f, Call& call, Reflection* reflection = nullptr) {
        if (load_values(f, f.level, state, call)) return call.status();
        if (reflection && f.level == 0 && f.hierarchy->is_double()) {
            if (read_reflection(*f.hierarchy, *reflection, call)) return call.status();
            const Foliation& at = state.foliation;
            cylinders.graph.on_boundary = reflection->is_boundary.data();
            for (uint32_t e = 0; e < at.mesh.edge_count; ++e) {
                const bool behind = !reflection->is_front[2 * e] && !reflection->is_front[2 * e + 1];
                uint32_t& widest = cylinders.graph.closed_leaf;
                if (behind && (widest == NONE || at.value[e] > at.value[widest])) widest = e;
            }
        }
        if (f.level == 0) {
            if (caller_faces(*f.hierarchy, face_order, call)) return call.status();
            vertices = f.hierarchy->vertex_internal;
            faces = face_order.data();
        }
        if (!call.tick(0.05)) return call.was_cancelled();
        return cylinders.build(state.foliation, vertices, faces, call);
    }
};

constexpr double FEWEST_TO_REFINE = 8000; // quads
constexpr int STEPS_ON_FINER = 4;         // of relaxation

hmf_status check_points(const hmf_trace_options& options, uint32_t triangle_count, Call& call) {
    if (options.point_count > 0 && (!options.point_triangles || !options.point_barycentrics))
        return call.fail(
            HMF_ERROR_NULL, HMF_ELEMENT_OPTION, 0,
            "point_triangles or point_barycentrics is NULL. Give one triangle and three coordinates for each point.");
    if (options.point_count > UINT32_MAX / 2)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are too many points.");
    for (uint64_t i = 0; i < options.point_count; ++i) {
        if (options.point_triangles[i] >= triangle_count)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i,
                             "Point %llu lies in triangle %u, which does not exist.",
                             static_cast<unsigned long long>(i), static_cast<unsigned>(options.point_triangles[i]));
        const double* b = options.point_barycentrics + 3 * i;
        const double sum = b[0] + b[1] + b[2];
        if (!(b[0] >= 0 && b[1] >= 0 && b[2] >= 0) || !(sum > 1 - 1e-6 && sum < 1 + 1e-6))
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i,
                             "The barycentric coordinates of point %llu are negative, or their sum is not 1.",
                             static_cast<unsigned long long>(i));
    }
    return HMF_OK;
}

// The flat surface of a foliation on the caller's side: the one that is kept with
// it, or one of its own after improve(state, unit).
struct FlatOf {
    const FlatSurface* flat = nullptr;
    double unit = 1;

    template <class Improve>
    hmf_status find(const hmf_foliation& foliation, Entry& entry, Improve improve) {
        Call& call = entry.call;
        unit = foliation.unit;
        if (const hmf_status status = shared_flat(foliation, entry, flat)) return status;
        if (flat) return HMF_OK;
        flat = &own_;
        State state;
        if (load_solved_in_unit_of_values(foliation, state, call) || improve(state, unit)
            || flat_surface(state, own_, call))
            return call.status();
        return flat_surface_to_input(state, own_, call) ? HMF_OK : call.stopped();
    }

private:
    FlatSurface own_;
};

hmf_status read_trace_options(const hmf_trace_options* options, const Level& level, uint32_t shown_triangles,
                              hmf_trace_options& all, Call& call) {
    if (read_options(options, all, "hmf_trace_options", call)) return call.status();
    if (!(all.spacing >= 0) || !(all.length_limit >= 0) || !std::isfinite(all.spacing)
        || !std::isfinite(all.length_limit))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "spacing and length_limit must be finite and not negative; 0 means none.");
    if (all.leaves < HMF_LEAVES_DEFAULT || all.leaves > HMF_LEAVES_CONJUGATE)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are no leaves %d. Use HMF_LEAVES_*.",
                         static_cast<int>(all.leaves));
    if (check_points(all, shown_triangles, call)) return call.status();
    if (all.spacing == 0 && all.point_count == 0) all.critical = 1;
    if (all.leaves == HMF_LEAVES_CONJUGATE && all.length_limit == 0)
        all.length_limit = 10 * std::sqrt(surface_area(level.mesh, level.position));
    return HMF_OK;
}

// Lines that are made, as the caller gets them.
hmf_status hand_over(const hmf_foliation& foliation, Lines& made, Call& call, hmf_lines** out) {
    const hmf_hierarchy& h = *foliation.hierarchy;
    if (foliation.level == 0) {
        Array<uint32_t> caller;
        if (inverse_numbers(h.edge_internal, h.input.edge_count, caller, call)) return call.status();
        for (uint32_t& e : made.edges) e = e == NONE ? HMF_NONE : caller[e];
        if (h.is_double() && keep_front(h, made, call)) return call.status();
    }
    hmf_lines lines{sizeof(hmf_lines), 0, made.list.size(), made.edges.size(), nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.array(lines, lines.lines, made.list.size(), made.list.data());
    block.array(lines, lines.offsets, made.offsets.size(), made.offsets.data());
    block.array(lines, lines.points, made.points.size(), made.points.data());
    block.array(lines, lines.point_edges, made.edges.size(), made.edges.data());
    *out = block.make(lines, h, call);
    return call.status();
}

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

// Triangles of a leaf of the double as ones of the surface: its way in front, for an
// arc, or all of it, what is behind seen through the mirror.
Done add_front_leaf(const uint32_t* leaf, size_t n, bool is_arc, uint32_t m, Array<uint32_t>& triangles) {
    const size_t first = triangles.size();
    size_t start = 0;
    // An arc begins where the leaf comes to the front.
    while (is_arc && start < n && (leaf[start] >= m || leaf[(start + n - 1) % n] < m)) ++start;
    for (size_t i = 0; i < n; ++i) {
        const uint32_t t = leaf[(start + i) % n];
        if (is_arc && t >= m) break;
        const uint32_t front = t < m ? t : t - m;
        if (triangles.size() > first && triangles.back() == front) continue;
        if (!triangles.push(front)) return false;
    }
    while (!is_arc && triangles.size() > first + 1 && triangles.back() == triangles[first]) triangles.pop();
    return true;
}

// From the cylinders of a double, matched with its loops, to those of the caller's
// loops on the surface.
hmf_status keep_front_cylinders(const hmf_hierarchy& h, const hmf_loop_set& loops, const WeightedLoops& given,
                                Array<hmf_cylinder>& list, Array<double>& heights, Curves& curves,
                                Array<uint32_t>& triangles, Array<uint8_t>& arcs, Call& call) {
    const uint32_t m = h.surface_triangles;
    hmf_loop_set all;
    if (read_options(&loops, all, "hmf_loop_set", call)) return call.status();
    Array<uint64_t> offsets;
    Array<uint32_t> front;
    offsets.start(call.memory);
    front.start(call.memory);
    arcs.start(call.memory);
    if (!offsets.push(0)) return call.out_of_memory();
    size_t kept = 0;
    for (size_t c = 0; c < list.size(); ++c) {
        hmf_cylinder cylinder = list[c];
        if (cylinder.loop >= all.count) continue; // behind
        const bool is_arc = all.arcs && all.arcs[cylinder.loop] != 0, is_round = given.factor[cylinder.loop] == 2;
        if (is_round) cylinder.height *= 0.5;
        if (is_arc) cylinder.circumference *= 0.5;
        if (is_arc || is_round) cylinder.area *= 0.5;
        cylinder.modulus = cylinder.height / cylinder.circumference;
        heights[kept] = cylinder.height;
        list[kept++] = cylinder;
        const uint64_t begin = curves.offsets[c], end = curves.offsets[c + 1];
        if (!add_front_leaf(triangles.data() + begin, static_cast<size_t>(end - begin), is_arc, m, front)
            || !offsets.push(front.size()) || !arcs.push(is_arc))
            return call.out_of_memory();
    }
    while (list.size() > kept) list.pop();
    curves.offsets.swap(offsets);
    triangles.swap(front);
    return HMF_OK;
}

// The seam edges of the caller by internal numbers.
hmf_status read_seam_edges(const hmf_foliation& foliation, const hmf_parameterize_options& all,
                           Array<uint32_t>& internal, Call& call) {
    if (!internal.allocate(call.memory, static_cast<size_t>(all.seam_edge_count))) return call.out_of_memory();
    for (size_t i = 0; i < internal.size(); ++i) {
        assert(all.seam_edges); // there is a count only with an array
        const uint32_t e = all.seam_edges[i];
        const uint32_t edges = foliation.hierarchy->shown_edges(foliation.level);
        if (e >= edges)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_EDGE, e,
                             "seam_edges names edge %u; the level has %u edges.", static_cast<unsigned>(e),
                             static_cast<unsigned>(edges));
        internal[i] = internal_edge(*foliation.hierarchy, foliation.level, e);
    }
    return HMF_OK;
}

// Writes corners, dilatations and differentials, triangle by triangle.
hmf_status write_triangles(const Parameterization& from, const Mesh& mesh, const Array<uint32_t>& side, double unit,
                           hmf_parameterization& to, Call& call) {
    double* uv = fill(to.corner_uv);
    for (size_t t = 0; t < to.triangle_count; ++t) {
        if (t % 16384 == 0 && !call.tick(0.98)) return call.was_cancelled();
        const AffineMap& map = from.map[t];
        const bool flipped = map.dilatation != HUGE_VAL && map.determinant < 0;
        fill(to.dilatation)[t] = flipped ? -map.dilatation : map.dilatation;
        for (size_t a = 0; a < 2; ++a) fill(to.differential)[2 * t + a] = map.differential[a];
        uint32_t h = side[t];
        for (size_t s = 0; s < 3; ++s, h = mesh.next[h]) {
            *uv++ = static_cast<double>(from.layout.u[h]) * unit;
            *uv++ = static_cast<double>(from.layout.v[h]) * unit;
        }
    }
    return HMF_OK;
}

// Writes transitions and seams, each edge from the first triangle of the caller that has it.
hmf_status write_edges(const Parameterization& from, const hmf_foliation& foliation, const FlatOf& flat,
                       const Array<uint32_t>& side, hmf_parameterization& to, Call& call) {
    const hmf_hierarchy& h = *foliation.hierarchy;
    const Mesh& mesh = loop_mesh(h, foliation.level);
    Array<uint8_t> met, outer; // outer: on the boundary of the surface, beyond which nothing lies
    if (!met.allocate_filled(call.memory, mesh.edge_count, 0)
        || !outer.allocate_filled(call.memory, to.edge_count, uint8_t{0}))
        return call.out_of_memory();
    const bool has_boundary = foliation.level == 0 && h.is_double();
    if (!call.tick(0.99)) return call.was_cancelled();
    for (size_t c = 0; has_boundary && c < 3 * to.triangle_count; ++c) outer[h.triangle_edges[c]] ^= 1;
    for (size_t t = 0; t < to.triangle_count; ++t) {
        if (t % 16384 == 0 && !call.tick(0.99)) return call.was_cancelled();
        uint32_t g = side[t];
        for (size_t s = 0; s < 3; ++s, g = mesh.next[g]) {
            const uint32_t internal = edge_of(g);
            if (met[internal]) continue;
            met[internal] = 1;
            const size_t e = foliation.level == 0 ? h.triangle_edges[3 * t + s] : internal;
            const Transition map = from.transition(mesh, flat.flat->bundle, g);
            const bool seam = from.is_seam(internal, map) && !outer[e];
            to.seam_edge_count += seam;
            if (seam) to.seam_length += from.length[internal];
            fill(to.seam)[e] = seam;
            fill(to.transition)[3 * e] = outer[e] ? 1 : map.sign;
            fill(to.transition)[3 * e + 1] = outer[e] ? 0 : static_cast<double>(map.u) * flat.unit;
            fill(to.transition)[3 * e + 2] = outer[e] ? 0 : static_cast<double>(map.v) * flat.unit;
        }
    }
    return HMF_OK;
}

// What the caller gets of an atlas: corners, charts, seams, scale.  side: of each triangle of the caller.
hmf_status write_atlas(const Atlas& made, const Mesh& mesh, const double* position, const Array<uint32_t>& side,
                       hmf_chart_set& to, Call& call) {
    double area = 0, sum = 0, squares = 0;
    for (size_t t = 0; t < to.triangle_count; ++t) {
        if (t % 65536 == 0 && !call.tick(0.98)) return call.was_cancelled();
        fill(to.triangle_chart)[t] = made.chart[mesh.face[side[t]]];
        uint32_t h = side[t];
        double u[3], v[3];
        const double* p[3];
        for (size_t s = 0; s < 3; ++s, h = mesh.next[h]) {
            u[s] = fill(to.corner_uv)[6 * t + 2 * s] = made.uv[2 * size_t{h}];
            v[s] = fill(to.corner_uv)[6 * t + 2 * s + 1] = made.uv[2 * size_t{h} + 1];
            p[s] = position + size_t{3} * mesh.origin[h];
        }
        const double image = ((u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0])) / 2;
        const AffineMap map = affine_map(p[0], p[1], p[2], u, v);
        if (!(image > 0) || !(map.area > 0)) continue;
        const double log_scale = natural_log(image / map.area) / 2;
        area += map.area;
        sum += map.area * log_scale;
        squares += map.area * log_scale * log_scale;
    }
    const double variance = area > 0 ? squares / area - (sum / area) * (sum / area) : 0;
    to.unevenness = variance > 0 ? std::sqrt(variance) : 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % 65536 == 0 && !call.tick(0.99)) return call.was_cancelled();
        if (made.is_joined(mesh, e)) continue;
        ++to.seam_edge_count;
        double square = 0;
        for (size_t a = 0; a < 3; ++a) {
            const double d =
                position[3 * size_t{mesh.origin[2 * e]} + a] - position[3 * size_t{mesh.origin[2 * e + 1]} + a];
            square += d * d;
        }
        to.seam_length += std::sqrt(square);
    }
    return HMF_OK;
}

} // namespace

extern "C" {

hmf_status hmf_parameterize(const hmf_foliation* foliation, const hmf_parameterize_options* options,
                            const hmf_control* control, hmf_parameterization** out, hmf_error* error) {
    UseEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_parameterize_options all;
    if (entry.check(out) || read_options(options, all, "hmf_parameterize_options", call)) return call.status();
    if (!(all.tolerance >= 0) || (all.seam_edge_count && !all.seam_edges))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "tolerance must not be negative, and seam_edges not NULL where there are some.");
    const hmf_hierarchy& h = *foliation->hierarchy;
    const size_t level = foliation->level;
    const Mesh& mesh = loop_mesh(h, level);
    Array<uint32_t> side, seam_edges;
    FlatOf flat;
    Parameterization made;
    if (read_seam_edges(*foliation, all, seam_edges, call)) return call.status();
    const auto improve = [&](State& state, double&) {
        return check_harmonic(state, all.tolerance > 0 ? all.tolerance : 1e-2, call);
    };
    if (const hmf_status status = flat.find(*foliation, entry, improve)) return status;
    if (!side_of_triangles(h, level, side, call)) return call.stopped();
    if (made.build(mesh, h.levels[level].position, *flat.flat, flat.unit, side, seam_edges, call)) return call.status();

    hmf_parameterization counts{};
    counts.struct_size = sizeof counts;
    counts.linear_iterations = flat.flat->iterations;
    if (made.measure(h.shown_triangles(level), counts, call)) return call.status();
    counts.vertex_count = h.shown_vertices(level);
    counts.edge_count = h.shown_edges(level);
    counts.triangle_count = h.shown_triangles(level);
    ResultBlock block;
    block.room(counts, counts.corner_uv, 6 * counts.triangle_count);
    block.room(counts, counts.transition, 3 * counts.edge_count);
    block.room(counts, counts.seam, counts.edge_count);
    block.room(counts, counts.cone, counts.vertex_count);
    block.room(counts, counts.dilatation, counts.triangle_count);
    block.room(counts, counts.differential, 2 * counts.triangle_count);
    hmf_parameterization* result = block.make(counts, h, call);
    if (!result) return call.status();
    if (write_triangles(made, mesh, side, flat.unit, *result, call)
        || write_edges(made, *foliation, flat, side, *result, call)) {
        free_block(result);
        return call.status();
    }
    for (uint32_t v = 0; v < counts.vertex_count; ++v)
        fill(result->cone)[v] = made.cone[level == 0 ? h.vertex_internal[v] : v];
    result->seconds = call.seconds();
    *out = result;
    return entry.end();
}

hmf_status hmf_trace(const hmf_foliation* foliation, const hmf_trace_options* options, const hmf_control* control,
                     hmf_lines** out, hmf_error* error) {
    UseEntry entry(foliation, control, error);
    Call& call = entry.call;
    if (entry.check(out)) return call.status();
    const Level& level = foliation->hierarchy->levels[foliation->level];
    hmf_trace_options all;
    if (read_trace_options(options, level, foliation->hierarchy->shown_triangles(foliation->level), all, call))
        return call.status();
    Array<uint32_t> side;
    if (all.point_count > 0 && !side_of_triangles(*foliation->hierarchy, foliation->level, side, call))
        return call.stopped();
    if (all.leaves != HMF_LEAVES_CONJUGATE) {
        Leaves leaves;
        if (leaves.load(*foliation, call)) return call.status();
        Lines made(leaves.state.foliation, level.position, foliation->unit, all.length_limit, call);
        if (!made.start()) return call.out_of_memory();
        if (trace_leaves(all, side, leaves.cylinders, made, call)) return call.status();
        return hand_over(*foliation, made, call, out) ? call.status() : entry.end();
    }
    ConjugateLevels levels;
    if (all.spacing > 0) {
        Leaves leaves;
        if (leaves.load(*foliation, call) || read_levels(leaves.state.foliation, leaves.cylinders, levels, call))
            return call.status();
    }
    FlatOf flat;
    State state; // becomes |dv|
    const auto improve = [&](State& solved, double& unit) { return to_minimum(solved, unit, call); };
    if (const hmf_status status = flat.find(*foliation, entry, improve)) return status;
    for (double& height : levels.height) height *= foliation->unit / flat.unit;
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    Lines made(state.foliation, level.position, foliation->unit, all.length_limit, call);
    if (!made.start()) return call.out_of_memory();
    if (trace_conjugate(state.foliation, level.position, *flat.flat, flat.unit, all, side, levels, made, call))
        return call.status();
    return hand_over(*foliation, made, call, out) ? call.status() : entry.end();
}

hmf_status hmf_cylinders(const hmf_foliation* foliation, const hmf_loop_set* loops, const hmf_control* control,
                         hmf_cylinder_set** out, hmf_error* error) {
    UseEntry entry(foliation, control, error);
    Call& call = entry.call;
    if (entry.check(out)) return call.status();
    const hmf_hierarchy& h = *foliation->hierarchy;
    if (h.is_double() && (!loops || foliation->level > 0))
        return call.fail(
            HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
            "Cylinders of a surface with boundary are told apart by their loops, on level 0. Give the loops "
            "of the foliation, and carry it to level 0.");
    WeightedLoops given;
    if (loops && read_loop_set(h, loops, 0, given, call)) return call.status();
    const GivenWeights of_loops{given.level, given.loops, given.weights, given.unit};
    Leaves leaves;
    State solved;
    Curves curves;
    Array<uint32_t> triangles;
    Array<hmf_cylinder> list;
    Array<double> heights;
    if (leaves.load(*foliation, call) || name_middle_leaves(leaves, curves, triangles, call)) return call.status();
    const size_t n = leaves.cylinders.list.size();
    if (!list.allocate(call.memory, n) || !heights.allocate(call.memory, n)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) {
        heights[c] = static_cast<double>(leaves.cylinders.list[c].height) * foliation->unit;
        list[c] = {HMF_NONE, 0, heights[c], 0, 0, 0};
    }
    double unit = foliation->unit;
    if (load_solved_in_unit_of_values(*foliation, solved, call)
        || (!is_minimum(*foliation) && to_minimum(solved, unit, call))
        || measure_cylinders({leaves.state, leaves.cylinders, foliation->unit}, loops ? &of_loops : nullptr, solved,
                             unit, list, call))
        return call.status();

    Array<uint8_t> arcs;
    if (h.is_double() && loops && keep_front_cylinders(h, *loops, given, list, heights, curves, triangles, arcs, call))
        return call.status();
    const size_t count = list.size();
    struct Made {
        hmf_cylinder_set set;
        hmf_loop_set leaves;
    } made{{sizeof(hmf_cylinder_set), 0, count, nullptr, nullptr},
           {sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, foliation->level, count, nullptr, nullptr, nullptr, nullptr}};
    ResultBlock block;
    block.array(made, made.set.list, count, list.data());
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

hmf_status hmf_atlas(const hmf_foliation* foliation, const hmf_atlas_options* options, const hmf_control* control,
                     hmf_chart_set** out, hmf_error* error) {
    UseEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_atlas_options all;
    if (entry.check(out) || read_options(options, all, "hmf_atlas_options", call)) return call.status();
    if (!(all.margin >= 0 && all.margin <= 1.0 / 16))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "margin must lie in [0, 1/16]; 0 means 1/512.");
    if (foliation->hierarchy->is_double())
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "Atlases are not available on surfaces with boundary in this version.");
    const hmf_hierarchy& h = *foliation->hierarchy;
    const size_t level = foliation->level;
    const double* position = h.levels[level].position;
    FlatOf flat;
    const auto improve = [&](State& state, double&) { return check_harmonic(state, 1e-2, call); };
    if (const hmf_status status = flat.find(*foliation, entry, improve)) return status;
    Leaves leaves;
    Strips strips;
    Atlas made;
    Array<uint32_t> side;
    if (leaves.load(*foliation, call)) return call.status();
    const Foliation& f = leaves.state.foliation;
    if (strips.build(f, leaves.cylinders, *flat.flat, foliation->unit / flat.unit, call)
        || made.build(f.mesh, position, flat.flat->bundle, strips, all.margin > 0 ? all.margin : 1.0 / 512, call))
        return call.status();
    if (!side_of_triangles(h, level, side, call)) return call.stopped();
    hmf_chart_set counts{};
    counts.struct_size = sizeof counts;
    counts.triangle_count = side.size();
    counts.chart_count = made.chart_count;
    counts.used_area = made.used_area;
    counts.collapsed_triangles = made.collapsed;
    ResultBlock block;
    block.room(counts, counts.corner_uv, 6 * side.size());
    block.room(counts, counts.triangle_chart, side.size());
    hmf_chart_set* result = block.make(counts, h, call);
    if (!result) return call.status();
    if (write_atlas(made, f.mesh, position, side, *result, call)) {
        free_block(result);
        return call.status();
    }
    *out = result;
    return entry.end();
}

hmf_status hmf_quads(const hmf_foliation* foliation, const hmf_quad_options* options, const hmf_control* control,
                     hmf_quad_mesh** out, hmf_error* error) {
    UseEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_quad_options all;
    if (entry.check(out) || read_options(options, all, "hmf_quad_options", call)) return call.status();
    if (!(all.edge_length >= 0) || !std::isfinite(all.edge_length))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "edge_length must be finite and not negative; 0 means the default.");
    if (all.edge_length > 0 && all.count > 0)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length and count are both given. Choose one.");
    if (all.count > MOST_QUADS || all.relax > MOST_RELAX_STEPS)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "count must be at most %llu, relax at most %llu.",
                         static_cast<unsigned long long>(MOST_QUADS),
                         static_cast<unsigned long long>(MOST_RELAX_STEPS));
    Leaves leaves;
    FlatMetric metric;
    QuadMesh made;
    const hmf_hierarchy& h = *foliation->hierarchy;
    const bool has_boundary = h.is_double();
    if (has_boundary && foliation->level > 0)
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LEVEL, foliation->level,
                         "Level %llu is one of the closed double of the surface. Carry the foliation to level 0 with "
                         "hmf_interpolate.",
                         static_cast<unsigned long long>(foliation->level));
    Reflection reflection;
    FrontParts front;
    const FrontParts* const parts = has_boundary ? &front : nullptr;
    if (leaves.load(*foliation, call, &reflection)) return call.status();
    Foliation& f = leaves.state.foliation;
    const double* position = h.levels[foliation->level].position;
    if (flat_metric(f, position, leaves.cylinders, metric, call)
        || (parts && front.build(f, reflection, leaves.cylinders, call)))
        return call.status();
    metric.area *= h.share();
    metric.flat_area *= h.share();
    QuadWish wish;
    const double by_default = 0.5 * h.share() * static_cast<double>(f.mesh.face_count);
    const double number = all.count > 0       ? static_cast<double>(all.count)
                        : all.edge_length > 0 ? metric.area / (all.edge_length * all.edge_length)
                                              : by_default;
    if (!(number <= static_cast<double>(MOST_QUADS)))
        return call.fail(
            HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
            "There would be about %.3g quads of this size, and at most %.3g fit. Choose a larger edge_length.", number,
            static_cast<double>(MOST_QUADS));
    // Quads smaller than the triangles would show how these bend the leaves: they are made of larger ones.
    int halvings = 0;
    double fewer = number;
    for (; all.relax > 0 && !parts && fewer > by_default && fewer > FEWEST_TO_REFINE && halvings < 12; ++halvings)
        fewer /= 4;
    wish.step = std::sqrt(metric.flat_area / fewer);
    wish.count = all.count > 0 ? static_cast<int64_t>(std::floor(fewer + 0.5)) : 0;
    wish.merge = all.merge != 0;
    wish.keep_poles = all.keep_poles != 0;
    if (!(wish.step > 0) || !std::isfinite(wish.step))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length is out of proportion to the surface.");
    QuadFigures figures;
    if (make_quads(f, position, leaves.cylinders, parts, wish, made, call)) return call.status();
    const int steps = static_cast<int>(all.relax);
    if (steps > 0) {
        size_t snapped = 0;
        if (relax_quads(f.mesh, position, steps, made, call)
            || snap_to_sharp_edges(f.mesh, position, parts ? &reflection : nullptr, made, snapped, call)
            || (snapped > 0 && relax_quads(f.mesh, position, steps, made, call)))
            return call.status();
    }
    for (; halvings > 0; --halvings)
        if (refine_quads(f.mesh, position, made, call)
            || relax_quads(f.mesh, position, steps < STEPS_ON_FINER ? steps : STEPS_ON_FINER, made, call))
            return call.status();
    if (quad_figures(made, figures, call)) return call.status();
    hmf_quad_mesh mesh{sizeof(hmf_quad_mesh),
                       0,
                       made.vertex_count(),
                       made.quad_count(),
                       nullptr,
                       nullptr,
                       figures.irregular,
                       figures.inverted,
                       std::sqrt(metric.area / static_cast<double>(made.quad_count()))};
    ResultBlock block;
    block.array(mesh, mesh.positions, made.positions.size(), made.positions.data());
    block.array(mesh, mesh.quads, made.quads.size(), made.quads.data());
    *out = block.make(mesh, *foliation->hierarchy, call);
    return entry.end();
}

} // extern "C"
