// The exact foliation: one 64-bit integer per edge, the distance that the
// images of its end points have in the metric tree of the class.
//
// Integers decide all questions of topology.  In triangle (i, j, k) the corner
// coordinate of i is how far i is from the branch point of the three images:
//
//     a_i = (F_ij + F_ik - F_jk) / 2 >= 0          closed corner: a_i = 0
//
// Positions in the tree are integers, hence a_i is one, too; an odd sum or a
// negative coordinate is a defect of the program.
//
// Zero edges are part of the solution (on limbs that no loop goes around, and between vertices that share a
// singularity). So the basic element is the cluster:
// vertices joined by zero edges, with the all-zero triangles between them.
// A vertex without zero edges is a cluster of its own.  The boundary of a
// cluster is walked like the link of a vertex; its directions in the tree are
// the runs between closed corners:
//
//     index = 2 * (vertices - zero edges + zero triangles) - marked vertices - closed corners
//
// where a closed corner has two non-zero sides.  Regular: 0, zero: < 0,
// pole: > 0.  Summed with -1 for each tripod (triangle without closed corner)
// this gives 2 * chi - marked vertices of the surface ([W] Eq. 1 and 3 in this
// form).
//
// A marked vertex p may carry a pole: a prong alone, with cone angle pi.  It is
// a cone of order 2: in the universal cover of this orbifold the half turn about
// p acts on the tree.  No loop goes around p alone, so that the half turn fixes
// one point of the tree and no direction at it.  Hence
//   - the image of p never moves, and its pulls are balanced whatever they are;
//   - with one closed corner p is regular; it cannot be without any;
//   - a cluster with a marked vertex is no plain disk.  Directions that the way
//     around it joins are different ones: the half turn exchanges them.
#pragma once

#include "../base/nearest_first.hpp"
#include "../mesh/mesh.hpp"

namespace hmf {

struct Foliation {
    Mesh mesh;                // connectivity that the values belong to
    int64_t* value = nullptr; // edge_count
    // Scratch of cluster searches and moves, so large that they cannot fail.
    uint32_t* stamp = nullptr; // per vertex: the epoch in which it was met last
    uint32_t epoch = 0;
    Array<uint32_t> members; // vertices of the cluster found last
    uint64_t walked = 0;     // half-edges that were looked at for clusters, for Call::work
    uint64_t take_walked() {
        const uint64_t steps = walked;
        walked = 0;
        return steps;
    }
    Array<uint32_t> pushed;       // vertices that move along with the one of the move planned last
    SmallestFirst<int64_t> queue; // half-edges that remove_extremum waits for; grows
    Done allocate_scratch(uint32_t vertex_count, Memory& memory); // for all meshes up to this size
    // Of a task of a sweep (sweep.hpp): it goes no further than the inside of its block,
    // and outside says that it would have had to.
    const uint32_t* inside = nullptr; // per vertex: the block that it is inside of
    uint32_t mask = ~uint32_t{0};     // of that number: blocks that are joined differ in the other bits
    uint32_t block = 0;
    bool outside = false;
    static constexpr uint32_t MOST_INSIDE = 64;                                 // members, and as many pushed
    Done share(const Foliation& whole, const uint32_t* blocks, Memory& memory); // the same foliation for a task
    // Whether the task may read the star of a vertex, one more within its budget.
    bool may_look(uint32_t vertex, size_t members_now) {
        if (!inside || ((inside[vertex] & mask) == block && members_now < MOST_INSIDE)) return true;
        outside = true;
        return false;
    }

    int64_t at(uint32_t h) const { return value[edge_of(h)]; }
    // Twice the corner coordinate of origin(h) in the triangle left of h.
    int64_t corner2(uint32_t h) const { return at(h) + at(mesh.prev(h)) - at(mesh.next[h]); }

private:
    Array<uint32_t> stamps_;
};

inline int64_t largest_value(const Foliation& f, const Parallel& parallel) {
    struct Largest {
        int64_t value = 0;
        void operator+=(const Largest& other) { value = other.value > value ? other.value : value; }
    };
    return parallel
        .sum_blocks<Largest>(f.mesh.edge_count,
                             [&f](size_t begin, size_t end) {
                                 Largest here;
                                 for (size_t e = begin; e < end; ++e) here += {f.value[e]};
                                 return here;
                             })
        .value;
}

// The next half-edge that is not zero around the boundary of a cluster,
// counter-clockwise; closed: a closed corner lies between.
inline uint32_t next_round(const Foliation& f, uint32_t g, bool& closed) {
    const uint32_t ahead = f.mesh.rotate_ccw(g);
    if (f.at(ahead) > 0) {
        closed = f.corner2(g) == 0;
        return ahead;
    }
    closed = false;
    return twin(f.mesh.next[g]); // the same neighbor, seen from the other end of the zero edge
}

// Result of the search around a cluster. The search may stop early, as soon as the closed corners reach a limit or the
// vertices exceed a budget.
struct Cluster {
    int64_t euler = 0; // vertices - zero edges + zero triangles; valid if complete
    uint32_t closed_corners = 0;
    uint32_t marked = 0;   // marked vertices
    bool complete = false; // false: stopped at a limit
    bool reached = false;  // the vertex `target` belongs to the cluster
    // Valid if complete.
    bool is_disk() const { return euler == 1 && marked == 0; }
    int64_t index() const { return 2 * euler - marked - closed_corners; }
    bool is_pole() const { return complete && index() > 0; }
};

// How to search: ClusterSearch().without_vertex(v).up_to_corners(2).
struct ClusterSearch {
    uint32_t removed_edge = NONE;   // counts as removed
    uint32_t removed_vertex = NONE; // its zero edges count as removed
    uint32_t target = NONE;         // a vertex to look for
    uint32_t corner_limit = 0;      // closed corners to stop at; 0 = no limit
    uint32_t budget = 0;            // vertices to stop at; 0 = no limit

    ClusterSearch& without_edge(uint32_t edge) { return removed_edge = edge, *this; }
    ClusterSearch& without_vertex(uint32_t vertex) { return removed_vertex = vertex, *this; }
    ClusterSearch& looking_for(uint32_t vertex) { return target = vertex, *this; }
    ClusterSearch& up_to_corners(uint32_t limit) { return corner_limit = limit, *this; }
    ClusterSearch& up_to_vertices(uint32_t limit) { return budget = limit, *this; }
};

// Collects the cluster of a vertex into foliation.members.
Cluster explore_cluster(Foliation& foliation, uint32_t vertex, const ClusterSearch& search = ClusterSearch());

// Signs of the half-edges out of the cluster in f.members, which is regular: a
// disk with two closed corners, or an annulus with none, whose two boundaries
// are the two directions.  +1 leaves in the one, -1 in the other; zero edges
// inside get +1 at one end and -1 at the other.  Returns how far the pulls agree with the previous signs.
double sign_regular_cluster(const Foliation& f, const double* weight, int8_t* sign);

struct SingularityCount {
    uint64_t poles = 0, zeros = 0; // counted with multiplicity: sum of index, sum of -index
    int64_t index_sum = 0;
    uint64_t broken_triangles = 0; // triangle inequality or parity violated

    void operator+=(const SingularityCount& part) {
        poles += part.poles;
        zeros += part.zeros;
        index_sum += part.index_sum;
        broken_triangles += part.broken_triangles;
    }
};

// Their positions; NULL = not requested.
struct SingularityMaps {
    int32_t* vertex_index = nullptr;    // clusters at their lowest vertex
    uint32_t* vertex_cluster = nullptr; // lowest vertex of the cluster of each vertex
    uint32_t* cluster_size = nullptr;   // at the lowest vertex
    int32_t* face_index = nullptr;
};

// Counts over the whole mesh.  Stops early if the call (NULL: none) is cancelled.
SingularityCount count_singularities(Foliation& foliation, const SingularityMaps& maps = SingularityMaps(),
                                     Call* call = nullptr);

// ---- transport between levels (transport.cpp) -----------------

struct TransportStatistics {
    uint64_t bad_flips = 0; // flips that needed the end point to be moved first ("case 4")
    uint64_t bad_flips_left =
        0; // flips that left a pole, counted by a check: 0 by construction if they are moved first
};

// What to do where the formula of a flip would make a pole ("case 4").
enum class BadFlip : uint8_t {
    moved_first, // the end point is moved to the next branch: no pole before, no pole after
    as_printed,  // nothing, as in [W]: a pole and a zero come
};

// Flips an edge of mesh and foliation together, counter-clockwise or back.
void flip_foliation(Foliation& foliation, uint32_t edge, bool reverse, TransportStatistics& statistics,
                    BadFlip bad_flip = BadFlip::moved_first);

// If the cluster of a vertex is an extremum (a disk with all else in one
// direction), moves it there until it has a second one.  false: the values
// are no distances in a tree (one closed corner separates a direction from
// itself, or a marked vertex has none), which a step that went too far can
// cause; or the call (NULL: none) is cancelled or out of memory.
bool remove_extremum(Foliation& foliation, uint32_t vertex, Call* call = nullptr);

// Values of the edges that come where a collapse is undone: the new vertex starts where the old one is.
void split_values(int64_t* value, const Collapse& c);

} // namespace hmf
