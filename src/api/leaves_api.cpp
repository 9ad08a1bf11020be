// hmf.h: trace.
#include "../leaves/polyline.hpp"
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

// Half-edge of side 0 of each triangle of the caller.
bool first_sides(const Leaves& leaves, Array<uint32_t>& side, Memory& memory) {
    const hmf_hierarchy& h = *leaves.state.hierarchy;
    const Mesh& mesh = leaves.state.foliation.mesh;
    if (!side.allocate(memory, mesh.face_count)) return false;
    if (leaves.state.level > 0) {
        for (uint32_t k = 2 * mesh.edge_count; k-- > 0;) side[mesh.face[k]] = k;
        return true;
    }
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        const uint32_t k = 2 * h.edge_internal[h.triangle_edges[size_t{3} * t]];
        side[t] = mesh.face[k] == leaves.faces[t] ? k : twin(k);
    }
    return true;
}

hmf_status check_points(const hmf_trace_options& options, uint32_t triangle_count, Call& call) {
    if (options.point_count > 0 && (!options.point_triangles || !options.point_barycentrics))
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_OPTION, 0, "point_triangles or point_barycentrics is NULL. Give one triangle and three coordinates for each point.");
    if (options.point_count > UINT32_MAX / 2) return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are too many points.");
    for (uint64_t i = 0; i < options.point_count; ++i) {
        if (options.point_triangles[i] >= triangle_count)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i, "Point %llu lies in triangle %u, which does not exist.",
                             static_cast<unsigned long long>(i), static_cast<unsigned>(options.point_triangles[i]));
        const double* b = options.point_barycentrics + 3 * i;
        const double sum = b[0] + b[1] + b[2];
        if (!(b[0] >= 0 && b[1] >= 0 && b[2] >= 0) || !(sum > 1 - 1e-6 && sum < 1 + 1e-6))
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i, "The barycentric coordinates of point %llu are negative, or their sum is not 1.",
                             static_cast<unsigned long long>(i));
    }
    return HMF_OK;
}

} // namespace

extern "C" {

void hmf_trace_options_init(hmf_trace_options* options) {
    if (!options) return;
    std::memset(static_cast<void*>(options), 0, sizeof *options);
    options->struct_size = sizeof *options;
}

hmf_status hmf_trace(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count, const hmf_trace_options* options,
                     hmf_line* lines, size_t line_capacity, uint64_t* offsets, size_t offset_capacity, double* points,
                     uint32_t* point_edges, size_t point_capacity, size_t* line_count, size_t* point_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, level, call)) return call.status();
    if (!line_count || !point_count) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "line_count and point_count must not be NULL.");
    hmf_trace_options all;
    if (!copy_options(options, all))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "hmf_trace_options has an unusable struct_size. Start from hmf_trace_options_init.");
    if (!(all.spacing >= 0) || !(all.length_limit >= 0) || !std::isfinite(all.spacing) || !std::isfinite(all.length_limit))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "spacing and length_limit must be finite and not negative; 0 means none.");
    if (check_points(all, hierarchy->levels[level].mesh.face_count, call)) return call.status();
    if (all.spacing == 0 && all.point_count == 0) all.critical = 1;

    Leaves leaves;
    if (leaves.load(*hierarchy, level, values, count, call)) return call.status();
    Foliation& f = leaves.state.foliation;
    Cylinders cylinders;
    if (cylinders.build(f, leaves.vertices, leaves.faces, call)) return call.status();
    Lines made(f, hierarchy->levels[level].position, leaves.unit, all.length_limit, call);
    if (!made.start()) return call.out_of_memory();
    if (all.spacing > 0 && made.add_levels(cylinders, all.spacing)) return call.status();
    if (all.critical && made.add_arcs(cylinders.graph)) return call.status();
    if (all.point_count > 0) {
        Array<uint32_t> side;
        if (!first_sides(leaves, side, call.memory)) return call.out_of_memory();
        for (uint64_t i = 0; i < all.point_count; ++i)
            if (made.add_point(cylinders, side[all.point_triangles[i]], all.point_barycentrics + 3 * i, static_cast<uint32_t>(i))) return call.status();
    }
    const size_t n = made.list.size(), m = made.edges.size();
    if ((lines && check_capacity(line_capacity, n, "lines", call)) || (offsets && check_capacity(offset_capacity, n + 1, "offsets", call))
        || ((points || point_edges) && check_capacity(point_capacity, m, "points", call)))
        return call.status();
    if (point_edges) {
        Array<uint32_t> caller; // edge numbers of the caller
        if (level == 0) {
            if (!caller.allocate(call.memory, f.mesh.edge_count)) return call.out_of_memory();
            for (uint32_t e = 0; e < f.mesh.edge_count; ++e) caller[hierarchy->edge_internal[e]] = e;
        }
        for (size_t i = 0; i < m; ++i) point_edges[i] = made.edges[i] == NONE ? HMF_NONE : level == 0 ? caller[made.edges[i]] : made.edges[i];
    }
    if (lines && n) std::memcpy(static_cast<void*>(lines), made.list.data(), n * sizeof(hmf_line));
    if (offsets) std::memcpy(offsets, made.offsets.data(), (n + 1) * sizeof(uint64_t));
    if (points && m) std::memcpy(points, made.points.data(), 3 * m * sizeof(double));
    *line_count = n;
    *point_count = m;
    return HMF_OK;
}

} // extern "C"
