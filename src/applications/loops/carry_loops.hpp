// Loops of a coarse level on the finer ones, each in its isotopy class.
//
// For each loop an edge has the number of its crossings and their sum with
// signs.  A split puts the new vertex beside the old one, away from all loops:
//
//          k                     k
//          |                   / | \        both numbers of jk are those of ik,
//       .. i ..     ->     .. i--+--j ..    those of lj are those of il,
//          |                   \ | /        those of ij are 0
//          l                     l
//
// The flip of a diagonal of a quadrilateral with sides a, b, c, d (in turn)
// gives crossings max(a + c, b + d) - diagonal, since the loops are tight.  What
// follows what in its triangle is all that flips need; a level has it after its
// splits, so only that of the coarser one is copied, to be changed.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/curves/multicurve.hpp"

namespace hmf {

class LoopCarrier {
public:
    // Loops on `level`, each of them simple; they may cross each other.
    // Room for the levels down to `finest`.
    Done load(const hmf_hierarchy& hierarchy, size_t level, size_t finest, const Loops& loops, Memory& memory);
    // To the next finer level; level 0 is reached on the mesh of the caller.
    Done refine(Call& call);
    // Loops first .. last - 1, which must be disjoint, with their directions.
    Done read(size_t first, size_t last, Loops& out, Call& call);
    // Other loops in their place: same number, same level.
    Done replace(const Loops& loops);

    const Mesh& mesh() const { return mesh_of(level_); }
    size_t level() const { return level_; }

private:
    struct Entry {
        uint32_t edge; // e
        uint32_t loop; // NONE: the entry is free
        uint32_t count;
        int32_t signed_count; // positive: from the left of half-edge 2e to its right
        uint32_t next;        // of the edge
    };

    const Mesh& mesh_of(size_t level) const { return level == 0 ? hierarchy_->input : hierarchy_->levels[level].mesh; }
    Done add(uint32_t edge, uint32_t loop, uint32_t count, int32_t signed_count);
    const Entry* find(uint32_t edge, uint32_t loop) const;
    Done copy_edge(uint32_t from, uint32_t to, bool reversed);
    Done unflip_edge(uint32_t edge);
    void drop_edge(uint32_t edge);

    const hmf_hierarchy* hierarchy_ = nullptr;
    size_t level_ = 0, loop_count_ = 0;
    Array<uint32_t> next_; // of the half-edges of a level, while its flips are reversed
    Array<uint32_t> head_; // first entry of each edge, or NONE
    Multicurve curve_;     // one loop
    Array<Entry> entries_;
    Array<Entry> scratch_;
    uint32_t free_ = NONE;
};

} // namespace hmf
