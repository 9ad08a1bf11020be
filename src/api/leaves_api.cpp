// hmf.h: trace, cylinders, quads.
#include "../foliation/whitehead.hpp"
#include "../leaves/conjugate_lines.hpp"
#include "../leaves/cylinder_classes.hpp"
#include "../leaves/polyline.hpp"
#include "../leaves/quad_mesh.hpp"
#include "../parameterize/flat_surface.hpp"
#include "../solve/solve.hpp"
#include "values.hpp"

#include <cmath>

using namespace hmf;

namespace {

// Values of a level, loaded and validated, with the caller's order of vertices and faces.
struct Leaves {
    State state;
    double unit = 1;
    Array<uint32_t> face_order;
    const uint32_t* vertices = nullptr;
    const uint32_t* faces = nullptr;

    hmf_status load(const hmf_hierarchy& h, size_t level, const double* values, size_t count, Call& call) {
        if (!state.allocate(h, level, call.memory)) return call.out_of_memory();
        state.load(level, Side::input);
        if (import_values(state, values, count, unit, false, call)) return call.status();
        if (level > 0) return HMF_OK;
        if (!face_order.allocate(call.memory, h.input.face_count)) return call.out_of_memory();
        for (uint32_t t = 0; t < h.input.face_count; ++t) face_order[t] = internal_face(h, t);
        vertices = h.vertex_internal;
        faces = face_order.data();
        return HMF_OK;
    }
};

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

// Nothing to do but where the way between the triangulations of level 0 moved a vertex.
hmf_status to_minimum(State& state, Call& call) {
    const double* weight = state.hierarchy->levels[state.level].weight;
    const double before = energy(state.foliation, weight);
    Recorder recorder(nullptr, call, 1);
    SolveOptions options;
    options.tolerance = 1e-8;
    options.stop_level = state.level;
    const hmf_status status = run_cascade(state, options, call, recorder);
    if (status >= HMF_ERROR_NULL) return status;
    const double excess = before / energy(state.foliation, weight) - 1;
    if (excess > 1e-2)
        return call.fail(HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ELEMENT_NONE, 0,
                         "The energy of the values is %.2g times that of the minimum. Improve them with hmf_relax.",
                         excess + 1);
    return HMF_OK;
}

hmf_status trace_leaves(Leaves& leaves, const hmf_trace_options& all, const Array<uint32_t>& side, Lines& made,
                        Call& call) {
    Cylinders cylinders;
    if (cylinders.build(leaves.state.foliation, leaves.vertices, leaves.faces, call)) return call.status();
    if (all.spacing > 0 && made.add_levels(cylinders, all.spacing)) return call.status();
    if (all.critical && made.add_arcs(cylinders.graph)) return call.status();
    for (uint64_t i = 0; i < all.point_count; ++i)
        if (made.add_point(&cylinders, side[all.point_triangles[i]], all.point_barycentrics + 3 * i,
                           static_cast<uint32_t>(i)))
            return call.status();
    return HMF_OK;
}

// The values of the state become |dv|.
hmf_status trace_conjugate(Leaves& leaves, const hmf_trace_options& all, const Array<uint32_t>& side, Lines& made,
                           Call& call) {
    State& state = leaves.state;
    Foliation& f = state.foliation;
    ConjugateLevels levels;
    if (all.spacing > 0) {
        Cylinders cylinders;
        if (cylinders.build(f, leaves.vertices, leaves.faces, call) || read_levels(f, cylinders, levels, call))
            return call.status();
    }
    FlatSurface flat;
    Array<int64_t> du;
    if (state.level == 0 && !state.to_intrinsic(call)) return call.out_of_memory();
    if (to_minimum(state, call) || flat_surface(state, flat, call)) return call.status();
    if (!flat_surface_to_input(state, flat, call) || !du.allocate(call.memory, f.mesh.edge_count))
        return call.out_of_memory();
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
        du[e] = flat.du.value[e] < 0 ? -flat.du.value[e] : flat.du.value[e];
        f.value[e] = flat.dv.value[e] < 0 ? -flat.dv.value[e] : flat.dv.value[e];
    }
    const double* position = state.hierarchy->levels[state.level].position;
    if (all.spacing > 0 && add_conjugate_levels(made, f, du.data(), levels, all.spacing, leaves.unit, position, call))
        return call.status();
    if (all.critical && add_conjugate_prongs(made, f, position, call)) return call.status();
    for (uint64_t i = 0; i < all.point_count; ++i)
        if (made.add_point(nullptr, side[all.point_triangles[i]], all.point_barycentrics + 3 * i,
                           static_cast<uint32_t>(i)))
            return call.status();
    return HMF_OK;
}

// The cylinders where the energy is measured: on the triangulation that is
// solved on, at the minimum.
struct Measured {
    Cylinders cylinders;
    Array<uint32_t> found; // by the numbers of the level's own cylinders

    // leaves: as loaded, goes to the intrinsic side.  stretched: the values
    // stretched by labels on the same side; goes there as well.
    hmf_status measure(Leaves& leaves, State& stretched, const Labels& labels, Call& call) {
        State& state = leaves.state;
        const bool first = state.level == 0;
        if (first && (!state.to_intrinsic(call) || !stretched.to_intrinsic(call))) return call.out_of_memory();
        if (to_minimum(state, call)) return call.status();
        Cylinders labelled;
        Array<uint32_t> of_label, on_edges;
        if (cylinders.build(state.foliation, nullptr, nullptr, call)
            || labelled.build(stretched.foliation, nullptr, nullptr, call) || labels.find(labelled, of_label, call))
            return call.status();
        if (!cylinders.find_vertices(state.foliation, call.memory)
            || !labelled.find_vertices(stretched.foliation, call.memory)
            || !found.allocate(call.memory, of_label.size()))
            return call.out_of_memory();
        if (match_on_edges(state.foliation.mesh, stretched.foliation.value, labelled, state.foliation.value, cylinders,
                           on_edges, call))
            return call.status();
        for (size_t c = 0; c < found.size(); ++c) found[c] = on_edges[of_label[c]];
        return HMF_OK;
    }
};

// Middle leaves of the loops' own cylinders on the coarsest level, and the keys:
// the weights in the unit of the values.
hmf_status loops_on_coarsest(const hmf_hierarchy& h, const hmf_loop_set& loops, double unit, Curves& curves,
                             Array<int64_t>& keys, Call& call, hmf_error* error) {
    const size_t level = static_cast<size_t>(loops.level), coarsest = h.level_count - 1;
    if (check_level(&h, level, call)) return call.status();
    Array<double> values, weights;
    // With the weights of the caller they are checked; then each loop gets one of its own.
    if (!values.allocate(call.memory, h.levels[level].mesh.edge_count)) return call.out_of_memory();
    if (const hmf_status status = hmf_initialize(&h, &loops, values.data(), values.size(), error)) return status;
    const size_t n = static_cast<size_t>(loops.count);
    if (!weights.allocate(call.memory, n) || !keys.allocate(call.memory, n)) return call.out_of_memory();
    double largest = loops.weights ? 0 : 1;
    for (size_t c = 0; loops.weights && c < n; ++c) largest = loops.weights[c] > largest ? loops.weights[c] : largest;
    for (size_t c = 0; c < n; ++c) {
        const double step = unit_of_weights(largest);
        keys[c] = static_cast<int64_t>(std::floor((loops.weights ? loops.weights[c] : 1.0) / step) * step / unit);
        weights[c] = static_cast<double>(c + 1);
    }
    hmf_loop_set numbered = loops;
    numbered.weights = weights.data();
    if (const hmf_status status = hmf_initialize(&h, &numbered, values.data(), values.size(), error)) return status;
    State state;
    double numbered_unit = 1;
    if (!state.allocate(h, level < coarsest ? level : coarsest, call.memory)) return call.out_of_memory();
    state.load(level, Side::input);
    if (import_values(state, values.data(), values.size(), numbered_unit, false, call)) return call.status();
    if (!state.go_to(coarsest, call) || (coarsest == 0 && !state.to_intrinsic(call))) return call.out_of_memory();
    Cylinders cylinders;
    Array<uint32_t> order;
    if (cylinders.build(state.foliation, nullptr, nullptr, call)) return call.status();
    if (!order.allocate_filled(call.memory, n, 0u)) return call.out_of_memory();
    if (cylinders.list.size() != n)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "The loops have other cylinders than expected. Please report it.");
    for (uint32_t d = 0; d < n; ++d) {
        const double number = static_cast<double>(cylinders.list[d].height) * numbered_unit;
        if (number >= 1 && number <= static_cast<double>(n)) order[static_cast<size_t>(number) - 1] = d;
    }
    return middle_leaves(state.foliation, cylinders, &order, curves, call);
}

} // namespace

extern "C" {

void hmf_trace_options_init(hmf_trace_options* options) {
    if (!options) return;
    std::memset(static_cast<void*>(options), 0, sizeof *options);
    options->struct_size = sizeof *options;
}

hmf_status hmf_trace(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                     const hmf_trace_options* options, hmf_line* lines, size_t line_capacity, uint64_t* offsets,
                     size_t offset_capacity, double* points, uint32_t* point_edges, size_t point_capacity,
                     size_t* line_count, size_t* point_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, level, call)) return call.status();
    if (!line_count || !point_count)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "line_count and point_count must not be NULL.");
    hmf_trace_options all;
    if (!copy_options(options, all))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "hmf_trace_options has an unusable struct_size. Start from hmf_trace_options_init.");
    if (!(all.spacing >= 0) || !(all.length_limit >= 0) || !std::isfinite(all.spacing)
        || !std::isfinite(all.length_limit))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "spacing and length_limit must be finite and not negative; 0 means none.");
    if (all.leaves < HMF_LEAVES_DEFAULT || all.leaves > HMF_LEAVES_CONJUGATE)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are no leaves %d. Use HMF_LEAVES_*.",
                         static_cast<int>(all.leaves));
    if (check_points(all, hierarchy->levels[level].mesh.face_count, call)) return call.status();
    if (all.spacing == 0 && all.point_count == 0) all.critical = 1;

    Leaves leaves;
    if (leaves.load(*hierarchy, level, values, count, call)) return call.status();
    Foliation& f = leaves.state.foliation;
    const bool conjugate = all.leaves == HMF_LEAVES_CONJUGATE;
    if (conjugate && all.length_limit == 0)
        all.length_limit = 10 * std::sqrt(surface_area(f.mesh, hierarchy->levels[level].position));
    Lines made(f, hierarchy->levels[level].position, leaves.unit, all.length_limit, call);
    Array<uint32_t> side;
    if (!made.start() || (all.point_count > 0 && !first_sides(leaves.state, side, call.memory)))
        return call.out_of_memory();
    if (conjugate ? trace_conjugate(leaves, all, side, made, call) : trace_leaves(leaves, all, side, made, call))
        return call.status();
    const size_t n = made.list.size(), m = made.edges.size();
    if ((lines && check_capacity(line_capacity, n, "lines", call))
        || (offsets && check_capacity(offset_capacity, n + 1, "offsets", call))
        || ((points || point_edges) && check_capacity(point_capacity, m, "points", call)))
        return call.status();
    if (point_edges) {
        Array<uint32_t> caller; // edge numbers of the caller
        if (level == 0) {
            if (!caller.allocate(call.memory, f.mesh.edge_count)) return call.out_of_memory();
            for (uint32_t e = 0; e < f.mesh.edge_count; ++e) caller[hierarchy->edge_internal[e]] = e;
        }
        for (size_t i = 0; i < m; ++i)
            point_edges[i] = made.edges[i] == NONE ? HMF_NONE : level == 0 ? caller[made.edges[i]] : made.edges[i];
    }
    if (lines && n) std::memcpy(static_cast<void*>(lines), made.list.data(), n * sizeof(hmf_line));
    if (offsets) std::memcpy(offsets, made.offsets.data(), (n + 1) * sizeof(uint64_t));
    if (points && m) std::memcpy(points, made.points.data(), 3 * m * sizeof(double));
    *line_count = n;
    *point_count = m;
    return HMF_OK;
}

hmf_status hmf_cylinders(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                         const hmf_loop_set* loops, hmf_cylinder* list, size_t capacity, uint64_t* leaf_offsets,
                         size_t offset_capacity, uint32_t* leaf_triangles, size_t triangle_capacity,
                         size_t* cylinder_count, size_t* triangle_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, level, call)) return call.status();
    if (!cylinder_count || !triangle_count)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "cylinder_count and triangle_count must not be NULL.");
    hmf_loop_set given;
    if (!copy_options(loops, given))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "hmf_loop_set has an unusable struct_size. Set it to sizeof(hmf_loop_set).");
    Leaves leaves;
    if (leaves.load(*hierarchy, level, values, count, call)) return call.status();
    State& state = leaves.state;
    Cylinders cylinders;
    if (cylinders.build(state.foliation, leaves.vertices, leaves.faces, call)) return call.status();
    const size_t n = cylinders.list.size();
    Curves curves;
    if (middle_leaves(state.foliation, cylinders, nullptr, curves, call)) return call.status();
    const size_t triangles = curves.crossings.size();
    if ((list && check_capacity(capacity, n, "list", call))
        || (leaf_offsets && check_capacity(offset_capacity, n + 1, "leaf_offsets", call))
        || (leaf_triangles && check_capacity(triangle_capacity, triangles, "leaf_triangles", call)))
        return call.status();
    Array<hmf_cylinder> made;
    Array<uint32_t> triangle_of_face;
    if (!made.allocate(call.memory, n)) return call.out_of_memory();
    if (leaf_triangles) {
        // The triangle that each crossing leads into.
        if (!triangle_of_face.allocate(call.memory, state.foliation.mesh.face_count)) return call.out_of_memory();
        for (uint32_t t = 0; t < triangle_of_face.size(); ++t) triangle_of_face[leaves.faces ? leaves.faces[t] : t] = t;
        for (Crossing& c : curves.crossings) c.at = triangle_of_face[state.foliation.mesh.face[twin(c.half_edge)]];
    }
    for (size_t c = 0; c < n; ++c)
        made[c] = {HMF_NONE, 0, static_cast<double>(cylinders.list[c].height) * leaves.unit, 0, 0, 0};
    if (list) {
        Labels labels;
        State stretched;
        const size_t coarsest = hierarchy->level_count - 1;
        if (!cylinders.find_vertices(state.foliation, call.memory) || !labels.choose(cylinders, call.memory)
            || !stretched.allocate(*hierarchy, level, call.memory))
            return call.out_of_memory();
        stretched.load(level, Side::input);
        labels.stretch(state.foliation, cylinders, stretched.foliation.value);
        Measured measured;
        if (measured.measure(leaves, stretched, labels, call)) return call.status();
        const double* weight = hierarchy->levels[level].weight;
        Array<double> area;
        Curves middle;
        if (!area.allocate(call.memory, n)) return call.out_of_memory();
        cylinder_areas(state.foliation, measured.cylinders, weight, area.data());
        if (middle_leaves(state.foliation, measured.cylinders, &measured.found, middle, call)) return call.status();
        for (size_t c = 0; c < n; ++c) {
            double flux = 0;
            for (uint64_t i = middle.offsets[c]; i < middle.offsets[c + 1]; ++i) {
                const uint32_t h = middle.crossings[i].half_edge;
                flux += weight[edge_of(h)] * static_cast<double>(state.foliation.at(h));
            }
            made[c].circumference = flux * leaves.unit;
            made[c].modulus = made[c].height / made[c].circumference;
            made[c].area = area[measured.found[c]] * leaves.unit * leaves.unit;
        }
        if (loops) {
            Curves of_loops, own;
            Array<int64_t> loop_keys, keys;
            Array<uint32_t> order, loop_of;
            if (const hmf_status status =
                    loops_on_coarsest(*hierarchy, given, leaves.unit, of_loops, loop_keys, call, error))
                return status;
            Cylinders on_coarsest;
            if (!stretched.go_to(coarsest, call) || (coarsest == 0 && !stretched.to_intrinsic(call))
                || !keys.allocate(call.memory, n))
                return call.out_of_memory();
            if (on_coarsest.build(stretched.foliation, nullptr, nullptr, call) || labels.find(on_coarsest, order, call)
                || middle_leaves(stretched.foliation, on_coarsest, &order, own, call))
                return call.status();
            for (size_t c = 0; c < n; ++c) keys[c] = cylinders.list[c].height;
            if (match_classes(stretched, own, keys, of_loops, loop_keys, loop_of, call)) return call.status();
            for (size_t c = 0; c < n; ++c) made[c].loop = loop_of[c];
        }
        std::memcpy(static_cast<void*>(list), made.data(), n * sizeof(hmf_cylinder));
    }
    if (leaf_offsets) std::memcpy(leaf_offsets, curves.offsets.data(), (n + 1) * sizeof(uint64_t));
    for (size_t i = 0; leaf_triangles && i < triangles; ++i)
        leaf_triangles[i] = static_cast<uint32_t>(curves.crossings[i].at);
    *cylinder_count = n;
    *triangle_count = triangles;
    return HMF_OK;
}

void hmf_quad_options_init(hmf_quad_options* options) {
    if (!options) return;
    std::memset(static_cast<void*>(options), 0, sizeof *options);
    options->struct_size = sizeof *options;
}

hmf_status hmf_quads(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                     const hmf_quad_options* options, double* positions, size_t position_capacity, uint32_t* quads,
                     size_t quad_capacity, size_t* vertex_count, size_t* quad_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, level, call)) return call.status();
    if (!vertex_count || !quad_count)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "vertex_count and quad_count must not be NULL.");
    hmf_quad_options all;
    if (!copy_options(options, all))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "hmf_quad_options has an unusable struct_size. Start from hmf_quad_options_init.");
    if (!(all.edge_length >= 0) || !std::isfinite(all.edge_length))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "edge_length must be finite and not negative; 0 means the default.");
    Leaves leaves;
    if (leaves.load(*hierarchy, level, values, count, call)) return call.status();
    Foliation& f = leaves.state.foliation;
    const double* position = hierarchy->levels[level].position;
    Cylinders cylinders;
    FlatMetric metric;
    QuadMesh made;
    if (cylinders.build(f, leaves.vertices, leaves.faces, call) || flat_metric(f, position, cylinders, metric, call))
        return call.status();
    const double step = all.edge_length > 0
                          ? all.edge_length * std::sqrt(metric.flat_area / metric.area)
                          : std::sqrt(metric.flat_area / (0.5 * static_cast<double>(f.mesh.face_count)));
    if (!(step > 0) || !std::isfinite(step))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length is out of proportion to the surface.");
    if (make_quads(f, position, cylinders, step, made, call)) return call.status();
    const size_t n = made.positions.size() / 3, m = made.quads.size() / 4;
    if ((positions && check_capacity(position_capacity, n, "positions", call))
        || (quads && check_capacity(quad_capacity, m, "quads", call)))
        return call.status();
    if (positions) std::memcpy(positions, made.positions.data(), 3 * n * sizeof(double));
    if (quads) std::memcpy(quads, made.quads.data(), 4 * m * sizeof(uint32_t));
    *vertex_count = n;
    *quad_count = m;
    return HMF_OK;
}

} // extern "C"
