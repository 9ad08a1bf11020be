// hmf.h: version, status texts, build, levels.
#include "../hierarchy/hierarchy.hpp"
#include "../hierarchy/suggest_marks.hpp"
#include "../mesh/weights.hpp"
#include "values.hpp"

#include <cmath>
#include <new>

using namespace hmf;

extern "C" {

uint32_t hmf_version(void) { return HMF_VERSION_MAJOR * 10000 + HMF_VERSION_MINOR * 100 + HMF_VERSION_PATCH; }

const char* hmf_status_string(hmf_status status) {
    switch (status) {
    case HMF_OK: return "success";
    case HMF_LIMIT_ITERATIONS: return "the iteration limit was reached before convergence";
    case HMF_LIMIT_TIME: return "the time limit was reached before convergence";
    case HMF_LIMIT_STALLED: return "no further progress is possible above the tolerance";
    case HMF_CANCELLED: return "cancelled by the progress callback";
    case HMF_ERROR_NULL: return "a required pointer is NULL";
    case HMF_ERROR_OPTIONS: return "an option is out of range";
    case HMF_ERROR_CAPACITY: return "an array has the wrong size";
    case HMF_ERROR_LEVEL: return "no such level";
    case HMF_ERROR_UNSUPPORTED: return "not available in this version";
    case HMF_ERROR_MEMORY: return "out of memory";
    case HMF_ERROR_MEMORY_LIMIT: return "the memory limit was reached";
    case HMF_ERROR_MESH_COUNTS: return "unusable number of vertices or triangles";
    case HMF_ERROR_MESH_INDEX: return "a vertex index is out of range";
    case HMF_ERROR_MESH_NOT_FINITE: return "a coordinate is not finite";
    case HMF_ERROR_MESH_REPEATED_VERTEX: return "a triangle repeats a vertex";
    case HMF_ERROR_MESH_DEGENERATE: return "a triangle has no area";
    case HMF_ERROR_MESH_BOUNDARY: return "the mesh has a boundary";
    case HMF_ERROR_MESH_NON_MANIFOLD_EDGE: return "an edge has three or more triangles";
    case HMF_ERROR_MESH_ORIENTATION: return "triangles are not consistently oriented";
    case HMF_ERROR_MESH_NON_MANIFOLD_VERTEX: return "a vertex has several fans of triangles";
    case HMF_ERROR_MESH_UNUSED_VERTEX: return "a vertex belongs to no triangle";
    case HMF_ERROR_MESH_COMPONENTS: return "the mesh has several components";
    case HMF_ERROR_MESH_GENUS: return "the mesh has genus 0";
    case HMF_ERROR_MESH_NOT_EMBEDDED: return "the surface meets itself";
    case HMF_ERROR_LOOP_COUNT: return "no loops, or unusable offsets";
    case HMF_ERROR_LOOP_INDEX: return "a loop names an element that does not exist";
    case HMF_ERROR_LOOP_NOT_CLOSED: return "a loop is not a closed chain of neighbours";
    case HMF_ERROR_LOOP_NOT_SIMPLE: return "a loop meets itself";
    case HMF_ERROR_LOOP_CROSSING: return "two loops cross";
    case HMF_ERROR_LOOP_TRIVIAL: return "a loop bounds a disk";
    case HMF_ERROR_LOOP_PARALLEL: return "two loops are freely homotopic";
    case HMF_ERROR_LOOP_WEIGHT: return "a loop weight is unusable";
    case HMF_ERROR_VALUE_NOT_FINITE: return "a value is negative or not finite";
    case HMF_ERROR_VALUE_NOT_CLOSED: return "the values are not closed";
    case HMF_ERROR_VALUE_POLE: return "the values have a pole";
    case HMF_ERROR_VALUE_NOT_HARMONIC: return "the values are too far from the minimum";
    case HMF_ERROR_VALUE_CLASS: return "the values do not belong to the loops";
    case HMF_ERROR_INTERNAL: return "internal error; please report it";
    default: return "unknown status";
    }
}

void hmf_build_options_init(hmf_build_options* options) {
    if (!options) return;
    std::memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
    options->collapse = HMF_COLLAPSE_MIDPOINT;
    options->ratio = 0.5;
    options->coarsest = 1000;
}

} // extern "C"

namespace {

bool read_build_options(const hmf_build_options* from, hmf_build_options& all, BuildOptions& options) {
    if (!copy_options(from, all)) return false;
    if (all.collapse) options.collapse = all.collapse;
    if (all.ratio != 0) options.ratio = all.ratio;
    if (all.coarsest) options.coarsest = all.coarsest;
    options.mollify = all.mollify;
    options.marked_vertices = all.marked_vertices;
    options.marked_count = all.marked_count;
    return options.collapse >= HMF_COLLAPSE_MIDPOINT && options.collapse <= HMF_COLLAPSE_QSLIM && options.ratio >= 0.05
        && options.ratio <= 0.95 && options.mollify >= 0 && options.mollify <= 0.1 && !all.allocate == !all.release;
}

} // namespace

extern "C" {

hmf_status hmf_build(const double* positions, size_t vertex_count, size_t position_stride, const uint32_t* triangles,
                     size_t triangle_count, const hmf_build_options* options, hmf_hierarchy** out, hmf_error* error) {
    if (out) *out = nullptr;
    hmf_build_options all;
    BuildOptions build;
    const bool readable = read_build_options(options, all, build);
    if (!readable) all.allocate = nullptr, all.release = nullptr, all.progress = nullptr;
    Memory own(all.allocate, all.release, all.allocator_user, all.memory_limit);
    {
        Call call(own, error, nullptr, nullptr);
        if (!out)
            return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                             "out is NULL. Give the address of a hierarchy pointer.");
        if (!readable)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                             "A build option is out of range. Start from hmf_build_options_init; ratio is in [0.05, "
                             "0.95], mollify in [0, 0.1], "
                             "allocate and release come together.");
        void* block = own.take(sizeof(hmf_hierarchy));
        if (!block) return call.out_of_memory();
        *out = new (block) hmf_hierarchy(all.allocate, all.release, all.allocator_user, all.memory_limit);
    }
    hmf_hierarchy* h = *out;
    Call call(h->memory, error, all.progress, all.progress_user);
    const hmf_status status =
        build_hierarchy(*h, positions, vertex_count, position_stride, triangles, triangle_count, build, call);
    if (status != HMF_OK) {
        hmf_destroy(h);
        *out = nullptr;
    } else {
        call.tick(1);
    }
    return status;
}

hmf_status hmf_suggest_marks(const double* positions, size_t vertex_count, size_t position_stride,
                             const uint32_t* triangles, size_t triangle_count, const hmf_build_options* options,
                             uint32_t* marks, size_t capacity, size_t* count, hmf_error* error) {
    hmf_build_options all;
    BuildOptions build;
    const bool readable = read_build_options(options, all, build);
    if (!readable) all.allocate = nullptr, all.release = nullptr, all.progress = nullptr;
    hmf_hierarchy h(all.allocate, all.release, all.allocator_user, all.memory_limit);
    Call call(h.memory, error, all.progress, all.progress_user);
    if (!readable)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "A build option is out of range. Start from hmf_build_options_init.");
    if (!count) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "count must not be NULL.");
    Array<uint32_t> found;
    if (suggest_marks(h, positions, vertex_count, position_stride, triangles, triangle_count, build, call, found))
        return call.status();
    if (marks && check_capacity(capacity, found.size(), "marks", call)) return call.status();
    for (size_t n = 0; marks && n < found.size(); ++n) marks[n] = found[n];
    *count = found.size();
    return HMF_OK;
}

void hmf_destroy(hmf_hierarchy* hierarchy) {
    if (!hierarchy) return;
    Memory own(hierarchy->allocate, hierarchy->release, hierarchy->allocator_user, 0, sizeof *hierarchy);
    hierarchy->~hmf_hierarchy();
    own.give(hierarchy, sizeof *hierarchy);
}

uint64_t hmf_memory_estimate(size_t vertex_count, size_t triangle_count, const hmf_build_options* options) {
    hmf_build_options all;
    BuildOptions build;
    if (!read_build_options(options, all, build)) return 0;
    if (vertex_count == 0 || triangle_count == 0 || vertex_count > 0x7fffffff / 3 || triangle_count > 0x7fffffff / 3)
        return 0;
    return build_memory_bound(vertex_count, triangle_count, build) + sizeof(hmf_hierarchy);
}

uint64_t hmf_hierarchy_memory(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->memory.used() : 0; }

size_t hmf_level_count(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->level_count : 0; }

size_t hmf_genus(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->genus : 0; }

} // extern "C"

extern "C" {

hmf_status hmf_level_counts(const hmf_hierarchy* hierarchy, size_t level, hmf_level_info* out, hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, out)) return query.call.status();
    const Level& from = hierarchy->levels[level];
    out->vertex_count = from.mesh.vertex_count;
    out->edge_count = from.mesh.edge_count;
    out->triangle_count = from.mesh.face_count;
    out->non_delaunay_count = from.raised_count;
    return HMF_OK;
}

hmf_status hmf_level_edge_vertices(const hmf_hierarchy* hierarchy, size_t level, uint32_t* edge_vertices,
                                   size_t capacity, hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, edge_vertices)) return query.call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{2} * mesh.edge_count, "edge_vertices", query.call)) return query.call.status();
    if (level > 0) {
        std::memcpy(edge_vertices, mesh.origin, size_t{2} * mesh.edge_count * sizeof(uint32_t));
        return HMF_OK;
    }
    for (size_t t = mesh.face_count; t-- > 0;) // the first triangle decides the order
        for (size_t s = 3; s-- > 0;) {
            const size_t e = hierarchy->triangle_edges[3 * t + s];
            edge_vertices[2 * e] = hierarchy->triangle_vertices[3 * t + s];
            edge_vertices[2 * e + 1] = hierarchy->triangle_vertices[3 * t + (s + 1) % 3];
        }
    return HMF_OK;
}

} // extern "C"

namespace {

// Half-edge of side 0 of each face of a level above 0: the lowest.
template <class Visit>
void for_each_face(const Mesh& mesh, Visit visit) {
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (h < mesh.next[h] && h < mesh.prev(h)) visit(mesh.face[h], h);
}

} // namespace

extern "C" {

hmf_status hmf_level_triangle_edges(const hmf_hierarchy* hierarchy, size_t level, uint32_t* triangle_edges,
                                    size_t capacity, hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, triangle_edges)) return query.call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{3} * mesh.face_count, "triangle_edges", query.call)) return query.call.status();
    if (level == 0) {
        std::memcpy(triangle_edges, hierarchy->triangle_edges, size_t{3} * mesh.face_count * sizeof(uint32_t));
        return HMF_OK;
    }
    for_each_face(mesh, [&](uint32_t face, uint32_t h) {
        triangle_edges[size_t{3} * face] = edge_of(h);
        triangle_edges[size_t{3} * face + 1] = edge_of(mesh.next[h]);
        triangle_edges[size_t{3} * face + 2] = edge_of(mesh.prev(h));
    });
    return HMF_OK;
}

hmf_status hmf_level_triangle_vertices(const hmf_hierarchy* hierarchy, size_t level, uint32_t* triangle_vertices,
                                       size_t capacity, hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, triangle_vertices)) return query.call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{3} * mesh.face_count, "triangle_vertices", query.call))
        return query.call.status();
    if (level == 0) {
        std::memcpy(triangle_vertices, hierarchy->triangle_vertices, size_t{3} * mesh.face_count * sizeof(uint32_t));
        return HMF_OK;
    }
    for_each_face(mesh, [&](uint32_t face, uint32_t h) {
        triangle_vertices[size_t{3} * face] = mesh.origin[h];
        triangle_vertices[size_t{3} * face + 1] = mesh.origin[mesh.next[h]];
        triangle_vertices[size_t{3} * face + 2] = mesh.origin[mesh.prev(h)];
    });
    return HMF_OK;
}

hmf_status hmf_level_weights(const hmf_hierarchy* hierarchy, size_t level, double* weights, size_t capacity,
                             hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, weights)) return query.call.status();
    const Level& from = hierarchy->levels[level];
    const uint32_t n = from.mesh.edge_count;
    if (check_capacity(capacity, n, "weights", query.call)) return query.call.status();
    if (level > 0) {
        std::memcpy(weights, from.weight, n * sizeof(double));
        return HMF_OK;
    }
    const Mesh& mesh = hierarchy->input;
    const double* x = from.position;
    for (uint32_t e = 0; e < n; ++e) {
        const uint32_t h = 2 * hierarchy->edge_internal[e], t = twin(h);
        const double* i = x + size_t{3} * mesh.origin[h];
        const double* j = x + size_t{3} * mesh.origin[t];
        weights[e] = 0.5
                   * (cotangent(x + size_t{3} * mesh.origin[mesh.prev(h)], i, j)
                      + cotangent(x + size_t{3} * mesh.origin[mesh.prev(t)], j, i));
    }
    return HMF_OK;
}

hmf_status hmf_level_positions(const hmf_hierarchy* hierarchy, size_t level, double* positions, size_t capacity,
                               hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, positions)) return query.call.status();
    const Level& from = hierarchy->levels[level];
    const size_t n = from.mesh.vertex_count;
    if (check_capacity(capacity, 3 * n, "positions", query.call)) return query.call.status();
    for (size_t v = 0; v < n; ++v)
        std::memcpy(positions + 3 * v, from.position + 3 * (level == 0 ? size_t{hierarchy->vertex_internal[v]} : v),
                    3 * sizeof(double));
    return HMF_OK;
}

} // extern "C"
