// hmf.h: version, status texts.
#include "../../../include/hmf/hmf.h"

extern "C" {

uint32_t hmf_version(void) { return HMF_VERSION_MAJOR * 10000 + HMF_VERSION_MINOR * 100 + HMF_VERSION_PATCH; }

const char* hmf_status_string(hmf_status status) {
    switch (status) {
    case HMF_OK: return "success";
    case HMF_LIMIT_ITERATIONS: return "the iteration limit was reached before convergence";
    case HMF_LIMIT_TIME: return "the time limit was reached before convergence";
    case HMF_LIMIT_CLASS: return "the minimum was not reached by steps that stay in the class of the loops";
    case HMF_LIMIT_STALLED: return "no further progress is possible above the tolerance";
    case HMF_CANCELLED: return "cancelled by the progress callback";
    case HMF_ERROR_NULL: return "a required pointer is NULL";
    case HMF_ERROR_OPTIONS: return "an option is out of range";
    case HMF_ERROR_COUNT: return "an array has the wrong size";
    case HMF_ERROR_LEVEL: return "no such level";
    case HMF_ERROR_UNSUPPORTED: return "not available in this version";
    case HMF_ERROR_QUADS: return "these leaves carry no good quads of this size";
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
    case HMF_ERROR_MESH_NOT_EMBEDDED: return "the surface intersects itself";
    case HMF_ERROR_MESH_NOT_DELAUNAY: return "the intrinsic Delaunay triangulation was not reached";
    case HMF_ERROR_LOOP_COUNT: return "no loops, or unusable offsets";
    case HMF_ERROR_LOOP_INDEX: return "a loop names an element that does not exist";
    case HMF_ERROR_LOOP_NOT_CLOSED: return "a loop is not a closed chain of neighbors";
    case HMF_ERROR_LOOP_NOT_SIMPLE: return "a loop crosses itself";
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

} // extern "C"
