// Working state of a solve: the mesh of a level, and the foliation on it, which goes from level to level by
// the log of the hierarchy.
#pragma once

#include "../foliation/restriction.hpp"
#include "../hierarchy/hierarchy.hpp"
#include "../mesh/mesh_copy.hpp"

namespace hmf {

// Which triangulation of a level: level 0 has two.
enum class Triangulation : uint8_t { input, intrinsic };

// Notified of the changes that State::refine and State::to_intrinsic make to the mesh, after each change.
struct MeshListener {
    void* user;
    // The edge was flipped, or a flip of it reversed.
    Done (*flipped)(void* user, const Mesh& mesh, uint32_t edge, bool reversed);
    // These collapses were undone, the last one first.
    Done (*were_split)(void* user, const Mesh& mesh, const Collapse* collapses, size_t count, Call& call);
};

// Its half-edges are the read-only ones of the hierarchy, except between a flip or a collapse and the next level that
// is solved: so no copy of them exists during a solve.
//
//     load:  hierarchy   own():  a copy   refine, to_intrinsic:  hierarchy   own():  a copy
//
// `out` is always a copy: it determines the tree of walks, and differs from the hierarchy between a restriction and
// refine.
struct State {
    const hmf_hierarchy* hierarchy = nullptr;
    Foliation foliation;
    size_t level = 0;
    Triangulation triangulation = Triangulation::intrinsic; // meaningful on level 0
    TransportStatistics statistics;
    BadFlip bad_flip = BadFlip::moved_first; // between levels
    const MeshListener* listener = nullptr;  // until to_input; NULL: none
    int64_t largest_input_value = 0;         // on the caller's edges, when they were left for the intrinsic ones

    // Room for every level down to `finest`.
    Done allocate(const hmf_hierarchy& h, size_t finest, Memory& memory);
    // Takes over the connectivity of a level; the values are the caller's to fill.
    void load(size_t at, Triangulation which);
    // Before the half-edges change: they are copied.
    Done own(Call& call);
    bool is_own() const { return copy_.has_sides(); }
    // One level finer: reverses flips, then collapses ([W] 4.2).  Level 0 is
    // reached on the input side.  Not done: cancelled half-way, state unusable.
    Done refine(Call& call);
    // One level coarser, from the input side on level 0: exact restriction.
    Done coarsen(Call& call, RestrictionScratch& scratch);
    // To any level; level 0: input side.
    Done go_to(size_t target, Call& call);
    // Between the two triangulations of level 0.
    Done to_intrinsic(Call& call);
    Done to_input(Call& call); // without the listener

private:
    void share(const Mesh& same);
    MeshCopy copy_; // empty: those of the hierarchy
    Array<uint32_t> out_;
    Array<int64_t> value_;
};

} // namespace hmf
