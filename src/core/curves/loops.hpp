// Loops on a level and the foliation that they start (theory: [W] 3.3).
//
// A loop is kept as the cyclic sequence of the half-edges that it crosses:
// half-edge h is crossed from face(h) to face(twin(h)), and face(twin(h)) is
// the face of the next half-edge in the sequence.
#pragma once

#include "../../../include/hmf/hmf.h"
#include "../base/memory.hpp"
#include "../mesh/mesh.hpp"

namespace hmf {

using Long = unsigned long long; // of numbers in messages

struct Loops {
    Array<uint64_t> offsets;   // count + 1
    Array<uint32_t> crossings; // half-edges
    size_t count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
    const uint32_t* loop(size_t c) const { return crossings.data() + offsets[c]; }
    size_t length(size_t c) const { return static_cast<size_t>(offsets[c + 1] - offsets[c]); }

    // No loops yet.
    Done start(Memory& memory) {
        offsets.start(memory);
        crossings.start(memory);
        return offsets.push(0);
    }
    Done add(const uint32_t* loop, size_t n) {
        for (size_t i = 0; i < n; ++i)
            if (!crossings.push(loop[i])) return false;
        return offsets.push(crossings.size());
    }
    Done add(const Array<uint32_t>& loop) { return add(loop.data(), loop.size()); }
    Done add(const Loops& from, size_t c) { return add(from.loop(c), from.length(c)); }
    Done copy_from(const Loops& from, Memory& memory) {
        if (!start(memory)) return false;
        for (size_t c = 0; c < from.count(); ++c)
            if (!add(from, c)) return false;
        return true;
    }
    void keep_first(size_t n) {
        while (offsets.size() > n + 1) offsets.pop();
        while (crossings.size() > offsets.back()) crossings.pop();
    }
    void swap(Loops& other) {
        offsets.swap(other.offsets);
        crossings.swap(other.crossings);
    }
};

// Loops with weights.  The loops of a surface with boundary are given as loops of its double (double_loops.hpp).
struct WeightedLoops {
    size_t level = 0;
    Loops loops;            // on loop_mesh(level)
    Array<int64_t> weights; // per loop, in units
    double unit = 1;
    Array<uint32_t> of;    // of a double: the caller's loop of each; else empty
    Array<int64_t> factor; // likewise: 2 for a loop around a boundary, else 1

    uint32_t callers(uint32_t loop) const { return loop < of.size() ? of[loop] : loop; }
    size_t callers_count() const { // they come first
        size_t n = 0;
        while (n < of.size() && of[n] == n) ++n;
        return of.empty() ? loops.count() : n;
    }
};

// Removes the bigons of essential disjoint loops, so that their initial
// foliation has no poles.  Classes, order and directions stay.
[[nodiscard]] hmf_status pull_tight(const Mesh& mesh, Call& call, Loops& loops);

// Loops of the caller: elements are faces (element_kind HMF_PATH_TRIANGLES)
// or vertices (HMF_PATH_VERTICES) of mesh.  Removes backtracking.  Checks
// indices and closedness only; error indices are loop numbers.
[[nodiscard]] hmf_status read_loops(const Mesh& mesh, int32_t element_kind, size_t count, const uint64_t* offsets,
                                    const uint32_t* elements, Call& call, Loops& out);

// The second half of it: paths are closed sequences of half-edges, along edges
// (along_edges) or crossed already.
[[nodiscard]] hmf_status push_paths_off(const Mesh& mesh, const Loops& paths, bool along_edges, Call& call, Loops& out);

// Cancels inverse neighbors of a cyclic sequence; the remaining ones are sequence[begin], .., sequence[end - 1].
void remove_backtracking(Array<uint32_t>& sequence, size_t& begin, size_t& end);

// Simple, disjoint, essential, pairwise not freely homotopic (as on the surface
// without its marked vertices, and none goes around one of them only); each defect
// with its status and the number of the loop.  given: the caller's, so that a message can
// name an element where the loops meet, or NULL; of: the caller's loop of each loop, or NULL: the same.
[[nodiscard]] hmf_status check_loops(const Mesh& mesh, const Loops& loops, Call& call,
                                     const hmf_loop_set* given = nullptr, const Array<uint32_t>* of = nullptr);

// value[e] = sum over loops of weight * number of crossings of e.
void initial_foliation(const Mesh& mesh, const Loops& loops, const int64_t* weights, int64_t* value);

} // namespace hmf
