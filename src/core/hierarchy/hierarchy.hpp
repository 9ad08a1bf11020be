// The immutable multigrid hierarchy ([W] 4.1), numbered so that every level
// is a prefix: the elements of level k+1 are the first ones of level k, and
// each block that a level adds keeps the spatial order of the input.
//
//   input mesh --flips--> intrinsic Delaunay, where level 0 is solved
//       |
//       | collapses, then Delaunay flips      (Level::collapse_*, Level::flip_*)
//       v
//   level 1 -> level 2 -> ... -> coarsest
//
// Marked vertices come first in every level: no collapse removes or moves them.
//
// A surface with boundary is doubled first (double_surface.hpp): everything here
// is about the closed double, and on level 0 the caller sees its front, which has
// the lowest of the caller's numbers.
//
// Level 0 stores the intrinsic triangulation; Hierarchy::input is the mesh of
// the caller in the same (internal) numbering.  Applying intrinsic_flips to
// it in order gives levels[0].mesh; unflipping backwards returns.
#pragma once

#include <algorithm>
#include <atomic>

#include "../base/memory.hpp"
#include "../mesh/double_surface.hpp"
#include "../mesh/mesh.hpp"

namespace hmf {

// The options of the caller with their defaults, and options of the library itself.
struct BuildOptions : hmf_hierarchy_options {
    // cppcheck-suppress uninitDerivedMemberVar
    BuildOptions() : hmf_hierarchy_options() {
        collapse = HMF_COLLAPSE_MIDPOINT;
        ratio = 0.5;
    }
    bool sphere_allowed = false; // although nothing can be solved on it
    bool has_weights = true;     // on level 0; without them loops can be found, nothing can be solved
};

struct Level {
    Mesh mesh;                  // counts and connectivity; level 0: intrinsic Delaunay
    double* weight = nullptr;   // edge_count, all > 0
    double* position = nullptr; // 3 * vertex_count, times hmf_hierarchy::scale; level 0: internal vertex order
    uint64_t raised_count = 0;  // weights below the floor ("NLD")
    // From this level to the next coarser one: collapses first, then flips
    // (on level 0 they start from the input mesh, not the intrinsic one).
    size_t collapse_begin = 0, collapse_end = 0;
    size_t flip_begin = 0, flip_end = 0;
    size_t run_begin = 0, run_end = 0; // of the collapses
};

// Collapses of one block, one after the other.  Runs of the same group commute.
struct CollapseRun {
    uint32_t end; // in the log
    uint32_t group;
};

} // namespace hmf

struct hmf_hierarchy {
    hmf_hierarchy(hmf_allocate_fn a, hmf_release_fn r, void* user, uint64_t limit)
        // Its own bytes count from the start.
        :
        memory(a, r, user, limit, sizeof(hmf_hierarchy)),
        arena(memory), allocate(a), release(r), allocator_user(user), memory_limit(limit) {}

    // One that a call makes for itself, in the account of the call; not for callers.
    hmf_hierarchy(const hmf_hierarchy& like, hmf::Memory& whole) :
        memory(whole), arena(memory), allocate(like.allocate), release(like.release),
        allocator_user(like.allocator_user), memory_limit(like.memory_limit) {}

    hmf::Memory memory;
    hmf::Arena arena;
    hmf_allocate_fn allocate;
    hmf_release_fn release;
    void* allocator_user;
    uint64_t memory_limit;
    mutable std::atomic<uint64_t> references{1}; // the caller's and those of foliations

    hmf::BuildOptions made_with; // without the pointer
    double scale = 1;            // positions inside are those of the caller times this power of two
    uint32_t genus = 0;
    hmf::Mesh input;                     // the caller's triangulation, internal numbers; shares arrays with
                                         // levels[0].mesh when intrinsic_flip_count is 0
    uint32_t* intrinsic_flips = nullptr; // edges, in the order of flipping, from input to levels[0]
    size_t intrinsic_flip_count = 0;

    hmf::Level* levels = nullptr; // finest first
    size_t level_count = 0;
    hmf::Collapse* collapses = nullptr; // of all levels, finest first
    hmf::CollapseRun* collapse_runs = nullptr;
    uint32_t* flips = nullptr; // of all levels, finest first

    // Between the caller's numbers and the internal ones, on level 0.
    uint32_t* triangle_vertices = nullptr; // 3 * face_count, caller's vertex numbers (a copy of the input)
    uint32_t* triangle_edges = nullptr;    // 3 * face_count, caller's edge numbers
    uint32_t* edge_internal = nullptr;     // caller's edge -> internal edge
    uint32_t* vertex_internal = nullptr;   // caller's vertex -> internal vertex

    // What the caller sees of level 0: all, or the front of a double.
    uint32_t surface_vertices = 0, surface_edges = 0, surface_triangles = 0;
    uint32_t surface_genus = 0, boundary_count = 0;
    hmf::Mirror mirror;        // empty: the surface is closed
    hmf_hierarchy_info info{}; // what the caller sees; nothing inside reads it

    bool is_double() const { return boundary_count > 0; }
    // Energies and areas of the surface are this part of those inside.
    double share() const { return is_double() ? 0.5 : 1; }
    uint32_t shown_vertices(size_t level) const {
        return level == 0 ? surface_vertices : levels[level].mesh.vertex_count;
    }
    uint32_t shown_edges(size_t level) const { return level == 0 ? surface_edges : levels[level].mesh.edge_count; }
    uint32_t shown_triangles(size_t level) const {
        return level == 0 ? surface_triangles : levels[level].mesh.face_count;
    }
};

namespace hmf {

// Vertices of the coarsest level by default, from 16 000 vertices of the mesh on.  Smaller meshes have levels beyond
// it, on which no loops are searched (library_loops.cpp).
constexpr uint64_t USUAL_COARSEST = 1000;
// Vertices that the coarsest level is to have: ten for each zero at least.
uint64_t coarsest_vertices(const BuildOptions& options, uint64_t genus, uint64_t vertex_count);

// undo(n, begin) for the collapses of a level, the last one first; those of runs that
// commute on the threads of the host.  begin: of the run.
template <class Undo>
Done undo_collapses(const hmf_hierarchy& h, const Level& level, Call& call, double fraction, bool can_finish,
                    Undo undo) {
    const auto begin_of = [&](size_t run) {
        return run > level.run_begin ? size_t{h.collapse_runs[run - 1].end} : level.collapse_begin;
    };
    for (size_t first = level.run_end; first > level.run_begin;) {
        const size_t last = first--;
        while (first > level.run_begin && h.collapse_runs[first - 1].group == h.collapse_runs[first].group) --first;
        if (!call.tick(fraction, can_finish)) return false;
        if (last - first == 1) {
            const size_t begin = begin_of(first);
            for (size_t n = h.collapse_runs[first].end; n-- > begin;) {
                if (n % 8192 == 0 && !call.tick(fraction, can_finish)) return false;
                undo(n, begin);
            }
            continue;
        }
        call.parallel.for_each(static_cast<uint32_t>(last - first), [&](uint32_t k, uint32_t) {
            const size_t begin = begin_of(first + k);
            for (size_t n = h.collapse_runs[first + k].end; n-- > begin;) undo(n, begin);
        });
    }
    return true;
}

// arrays in -> validated mesh -> hierarchy.  Fills a freshly made hierarchy.
[[nodiscard]] hmf_status build_hierarchy(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                                         size_t position_stride, const uint32_t* triangles, size_t triangle_count,
                                         const BuildOptions& options, Call& call);

// The checks of build_hierarchy alone: fills surface_genus and boundary_count.
[[nodiscard]] hmf_status check_surface(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                                       const uint32_t* triangles, size_t triangle_count, const BuildOptions& options,
                                       Call& call);

// Upper bound of the peak memory of build_hierarchy.
uint64_t build_memory_bound(size_t vertex_count, size_t triangle_count, const BuildOptions& options);

// The mesh on which loops of a level are given: level 0 is the caller's.
inline const Mesh& loop_mesh(const hmf_hierarchy& h, size_t level) {
    return level == 0 ? h.input : h.levels[level].mesh;
}

} // namespace hmf
