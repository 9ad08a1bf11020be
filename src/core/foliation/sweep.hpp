// Sweeps of Whitehead moves over all vertices of a level, in blocks.
//
// A move of v reads and writes what is between v and its neighbors and, if v
// belongs to a cluster, that of the whole cluster.  Vertices that are near in
// space make a block.  What lies inside, with all its neighbors and its cluster
// in the same block, moves with that block, independently of the others.  Then neighboring blocks
// are joined, some times, and what lies inside of one now moves in the same way:
//
//     | o o o 1 | 1 o o o 2 | 2 o o o |       o inside of a block, 1 of two joined
//     | o o o 1 | 1 o o o 2 | 2 o o o |       ones, 2 at a border: one or two in a hundred
//
// The remaining vertices are moved one by one afterwards.
//
// Blocks depend on the mesh alone.  A small mesh is one block.
#pragma once

#include "whitehead.hpp"

namespace hmf {

class Sweeps {
public:
    // coarser_count: vertices of the next coarser level, which have the lowest
    // numbers; the others are in spatial order.
    Done prepare(const Foliation& f, const Rings& rings, uint32_t coarser_count, Call& call);

    // Moves each vertex once to the best point that is legal and reachable in its
    // star.  backward reverses the order.  Stops between two moves if the call is
    // cancelled; fraction is what it reports.
    void sweep(Foliation& f, const Rings& rings, const double* weight, bool backward, Star& star, SweepResult& result,
               Call& call, double fraction);

private:
    // Some vertices, in one order or the other.
    struct List {
        const uint32_t* vertex;
        uint32_t size;
        bool backward;
        uint32_t operator[](uint32_t i) const { return vertex[backward ? size - 1 - i : i]; }
    };
    // Room for the moves in a block.
    struct Task {
        Foliation foliation;
        Star star;
        uint32_t next = 0; // of the list of its block: how many were moved
    };
    // Blocks with the same number >> shift are joined.
    struct Round {
        uint32_t shift;
        uint32_t count; // of joined blocks
        uint32_t list;  // of the first one
    };
    void plan_rounds();
    void find_blocks(const Rings& rings, uint32_t coarser_count, uint32_t* block, const Parallel& parallel);
    uint32_t list_of(uint32_t vertex) const;
    bool sweep_block(uint32_t round, uint32_t block, Task& task, const Rings& rings, const double* weight,
                     bool backward, SweepResult& result);
    Done sweep_round(uint32_t round, Foliation& f, const Rings& rings, const double* weight, bool backward,
                     const Star& star, SweepResult& result, Call& call, double fraction);
    static Done sweep_list(List list, Foliation& f, const Rings& rings, const double* weight, Star& star,
                           SweepResult& result, Call& call, double fraction);

    // Values and weights of the smallest blocks fit into the cache of a core.
    static constexpr uint32_t SMALLEST_BLOCK = 4096, MOST_BLOCKS = 64, BLOCKS_AT_ONCE = 16;
    static constexpr uint64_t MOST_WALKED = 65536; // half-edges around clusters, by a block between two reports
    static constexpr uint32_t MOST_ROUNDS = 4, MOST_LISTS = 2 * MOST_BLOCKS;

    uint32_t block_count_ = 1, round_count_ = 0, list_count_ = 0;
    Round round_[MOST_ROUNDS];
    Array<uint32_t> inside_;  // per vertex: its block, and a bit for each round that it is inside of none in
    Array<uint32_t> order_;   // lists of what is inside, round by round, then the others
    Array<uint32_t> waiting_; // at the beginning of each list: what waits for the others
    uint32_t begin_[MOST_LISTS + 2] = {}; // in order_: of each list, of the others, and the end
    uint32_t waits_[MOST_LISTS] = {};     // how many wait
    Task task_[BLOCKS_AT_ONCE];
};

} // namespace hmf
