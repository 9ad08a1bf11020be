// Coarsening by edge collapses ([W] 4.1).
#pragma once

#include <algorithm>

#include "../base/memory.hpp"
#include "../mesh/mesh.hpp"
#include "hierarchy.hpp"

namespace hmf {

// Shortest edges first, roughly: one list per half octave of the cost.  An edge
// is in one list at most; its cost is checked again when it is taken. Lists of this size keep consecutive collapses
// close in space; with finer lists a collapse is far from the previous one and takes twice as long.
class BucketQueue {
public:
    static constexpr uint32_t BUCKETS = 1u << 12;
    Done allocate(Memory& memory);
    static uint32_t bucket(double cost); // cost >= 0, finite
    void clear();
    bool empty(); // moves on to the lowest list in use
    uint32_t lowest() const { return low_; }
    uint32_t first(uint32_t list) const { return head_[list]; }
    void put(uint32_t edge, uint32_t at, Array<uint32_t>& link) {
        link[edge] = head_[at];
        head_[at] = edge;
        low_ = std::min(low_, at);
        high_ = std::max(high_, at);
    }
    uint32_t take(const Array<uint32_t>& link) { // after empty() was false
        const uint32_t edge = head_[low_];
        head_[low_] = link[edge];
        return edge;
    }

    // Edges that another queue is to have, the latest first.
    void set_aside(uint32_t edge, Array<uint32_t>& link) {
        link[edge] = aside_;
        aside_ = edge;
    }
    uint32_t take_aside(const Array<uint32_t>& link) {
        const uint32_t edge = aside_;
        if (edge != NONE) aside_ = link[edge];
        return edge;
    }

private:
    Array<uint32_t> head_;
    uint32_t aside_ = NONE;
    uint32_t low_ = BUCKETS, high_ = 0;
};

// Squared distance from a set of weighted planes and points, as a quadratic
// polynomial about WorkMesh::center: x^T A x - 2 b^T x + c.
struct Quadric {
    double a[6]; // xx xy xz yy yz zz
    double b[3];
    double c;
};

// The mesh while it is coarsened.  Inside a level, removed elements stay in
// place: an edge has face NONE then, a vertex has out NONE.
// NOLINTNEXTLINE(bugprone-reserved-identifier): of the compiler, where it moves the queues
struct WorkMesh {
    Mesh mesh;                                           // counts: of what is left; arrays owned elsewhere
    double* position = nullptr;                          // owned elsewhere
    uint32_t vertex_end = 0, edge_end = 0, face_end = 0; // numbers in use, with those of removed elements
    Array<uint32_t> degree;
    Array<uint32_t> link;         // per edge: lists of the queue, stack of the flips; before, scratch of the validation
    Array<uint8_t> marks;         // per vertex, zeros
    Array<Quadric> quadrics;      // per vertex, with HMF_COLLAPSE_QSLIM only
    double center[3] = {0, 0, 0}; // that the quadrics are about
    // Vertices v with the same v >> block_shift make a block, near in space; those at
    // a border have a neighbor in another one.  Edges that touch no border are in
    // the queue of their block, the others in the last queue.
    static constexpr uint32_t MOST_BLOCKS = 32;
    static constexpr uint32_t LEAST_GROUP = 256; // collapses in blocks that become runs of their own
    uint32_t block_count = 0, block_shift = 31;
    Array<uint8_t> at_border;
    Array<uint16_t> bucket; // per edge: where it begins
    BucketQueue queue[MOST_BLOCKS + 1];
    bool has_double_edges = false; // two vertices may have several edges

    // For a mesh with room for all its elements.  Its degrees are to be set.
    static constexpr uint32_t SMALLEST_BLOCK_SHIFT = 12;
    void find_blocks(); // of the mesh as it is
    Done allocate(Memory& memory, const Mesh& all, bool with_quadrics);
    const double* at(uint32_t v) const { return position + size_t{3} * v; }
    double* at(uint32_t v) { return position + size_t{3} * v; }
    bool removed(uint32_t edge) const { return mesh.face[2 * edge] == NONE; }
};

// Quadrics of the input mesh [Garland and Heckbert 1997].
void initial_quadrics(WorkMesh& work);

// Collapses until at most edge_target edges are left or nothing more can be
// collapsed.  Writes the records to log and counts them; log has room for all
// vertices but vertex_minimum.  runs: of the log, for undo_collapses.  scratch:
// a word for each edge.
[[nodiscard]] hmf_status collapse_level(WorkMesh& work, int32_t strategy, uint32_t edge_target, uint32_t vertex_minimum,
                                        Collapse* log, size_t& log_count, Array<CollapseRun>& runs, uint32_t* scratch,
                                        Call& call, double from, double to);

} // namespace hmf
