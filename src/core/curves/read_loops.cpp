// Loops of the caller -> cyclic sequences of crossed half-edges ([W] 3.3).
//
// A triangle loop crosses the edges that its triangles share.  A closed
// vertex path is first pulled straight:
//
//        b
//       / \        a-b-c with a triangle a, b, c
//      a---c       becomes a-c, and a-b-a becomes a
//
// Then it is pushed off the vertices: along an edge to the left of half-edge
// 2e, and around a vertex on the side where the fan from its first half-edge
// does not begin.  That side does not depend on the path:
//
//        \ b /                 the way from a to b crosses the edges between
//      ---*-----  first        them, and a or b where it changes the side
//        a| \ (fan begins here)
//
// so paths that touch at vertices or share edges without crossing are pushed
// apart, and those that cross still do.  A path through a marked vertex is
// refused: on which side of it the loop goes makes a difference.
//
// At last an edge that is crossed back and forth at once is not crossed.
#include "loops.hpp"

#include <algorithm>

namespace hmf {

void remove_backtracking(Array<uint32_t>& sequence, size_t& begin, size_t& end) {
    size_t n = 0;
    for (size_t i = 0; i < sequence.size(); ++i) {
        if (n && sequence[n - 1] == twin(sequence[i])) --n;
        else sequence[n++] = sequence[i];
    }
    begin = 0;
    end = n;
    while (end - begin >= 2 && sequence[begin] == twin(sequence[end - 1])) {
        ++begin;
        --end;
    }
}

namespace {

// Two consecutive path edges as fewer: 0, 1 (in `one`), or 2 if nothing is to gain.
int shorten(const Mesh& mesh, uint32_t g, uint32_t h, uint32_t& one) {
    if (h == twin(g)) return 0;
    if (h == mesh.next[g]) {
        one = twin(mesh.prev(g));
        return 1;
    }
    if (twin(h) == mesh.prev(twin(g))) {
        one = mesh.next[twin(g)];
        return 1;
    }
    return 2;
}

// Path edges in sequence[begin, end), without detours.
void pull_straight(const Mesh& mesh, Array<uint32_t>& sequence, size_t& begin, size_t& end) {
    size_t n = 0;
    for (size_t i = 0; i < sequence.size(); ++i) {
        uint32_t h = sequence[i];
        bool left = true; // h is still to be put down
        while (left && n) {
            uint32_t one = NONE;
            const int edges = shorten(mesh, sequence[n - 1], h, one);
            if (edges == 2) break;
            --n;
            if (edges == 0) left = false;
            else h = one;
        }
        if (left) sequence[n++] = h;
    }
    begin = 0;
    end = n;
    // Across the ends; each step removes an edge.
    while (end - begin >= 2) {
        uint32_t one = NONE;
        const int edges = shorten(mesh, sequence[end - 1], sequence[begin], one);
        if (edges == 2) break;
        ++begin;
        --end;
        if (edges == 0) continue;
        // The new edge takes the last place, where it may shorten with the one before.
        bool left = true;
        while (left && end > begin) {
            uint32_t other = NONE;
            const int more = shorten(mesh, sequence[end - 1], one, other);
            if (more == 2) break;
            --end;
            if (more == 0) left = false;
            else one = other;
        }
        if (left) sequence[end++] = one;
    }
}

// The first half-edge of a face that borders face g; if there are several, not
// the one through which the loop came in.
uint32_t shared_side(const Mesh& mesh, uint32_t side, uint32_t g, uint32_t came_in) {
    uint32_t h = side, back = NONE;
    for (int i = 0; i < 3; ++i, h = mesh.next[h]) {
        if (mesh.face[twin(h)] != g) continue;
        if (h != came_in) return h;
        back = h;
    }
    return back;
}

// From edge a, where a path comes in, to edge b, where it goes on; both as
// half-edges out of the vertex.
Done push_off(const Mesh& mesh, uint32_t a, uint32_t b, Array<uint32_t>& strip) {
    // Which of the two comes first in the fan?
    uint32_t low = a, high = b;
    for (uint32_t h = mesh.out[mesh.origin[a]];; h = mesh.rotate_ccw(h)) {
        if (h == a) break;
        if (h == b) {
            low = b;
            high = a;
            break;
        }
    }
    const auto crossed = [&](uint32_t h) { return h == low ? (h & 1u) != 0 : h != high || (h & 1u) == 0; };
    const size_t begin = strip.size();
    for (uint32_t h = low;; h = mesh.rotate_ccw(h)) {
        if (crossed(h) && !strip.push(low == a ? twin(h) : h)) return false;
        if (h == high) break;
    }
    if (low == a) return true;
    std::reverse(strip.begin() + begin, strip.end()); // clockwise
    return true;
}

// The half-edge of smallest number from vertex i to vertex j.
uint32_t shared_edge(const Mesh& mesh, uint32_t i, uint32_t j) {
    uint32_t found = NONE;
    for (const uint32_t h : mesh.around(i))
        if (mesh.target(h) == j && h < found) found = h;
    return found;
}

// Paths become loops one after the other.
class PushedPaths {
public:
    PushedPaths(const Mesh& mesh, Call& call, Loops& out) : mesh_(mesh), out_(out) { strip_.start(call.memory); }

    // The path is used up.
    Done add(Array<uint32_t>& path, bool along_edges) {
        size_t from = 0, to = 0;
        if (along_edges) {
            pull_straight(mesh_, path, from, to);
            strip_.clear();
            for (size_t i = from; i < to; ++i)
                if (!push_off(mesh_, twin(path[i]), path[i + 1 < to ? i + 1 : from], strip_)) return false;
            path.swap(strip_);
        }
        remove_backtracking(path, from, to);
        return out_.add(path.data() + from, to - from);
    }

private:
    const Mesh& mesh_;
    Loops& out_;
    Array<uint32_t> strip_;
};

} // namespace

hmf_status push_paths_off(const Mesh& mesh, const Loops& paths, bool along_edges, Call& call, Loops& out) {
    Array<uint32_t> path;
    PushedPaths pushed(mesh, call, out);
    path.start(call.memory);
    if (!out.start(call.memory)) return call.out_of_memory();
    for (size_t c = 0; c < paths.count(); ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return call.was_cancelled();
        path.clear();
        for (uint64_t i = paths.offsets[c]; i < paths.offsets[c + 1]; ++i)
            if (!path.push(paths.crossings[i])) return call.out_of_memory();
        if (!pushed.add(path, along_edges)) return call.out_of_memory();
    }
    return HMF_OK;
}

hmf_status read_loops(const Mesh& mesh, int32_t element_kind, size_t count, const uint64_t* offsets,
                      const uint32_t* elements, Call& call, Loops& out) {
    if (count == 0)
        return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, 0, "There are no loops. Give at least one.");
    for (size_t c = 0; c < count; ++c)
        if (offsets[c + 1] <= offsets[c])
            return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c,
                             "Loop %llu has no elements. Give at least one for each loop.", static_cast<Long>(c));
    const bool triangles = element_kind == HMF_PATH_TRIANGLES;
    // Elements are named by their place: the caller may number them otherwise.
    const char* const word = triangles ? "triangle" : "vertex";
    const uint32_t limit = triangles ? mesh.face_count : mesh.vertex_count;
    Array<uint32_t> side, path;
    PushedPaths pushed(mesh, call, out);
    path.start(call.memory);
    if (!out.start(call.memory)) return call.out_of_memory();
    if (triangles) {
        if (!side.allocate_filled(call.memory, mesh.face_count, NONE)) return call.out_of_memory();
        for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    }
    for (size_t c = 0; c < count; ++c) {
        const uint64_t first = offsets[c], end = offsets[c + 1];
        path.clear();
        for (uint64_t i = first; i < end; ++i)
            if (elements[i] >= limit)
                return call.fail(HMF_ERROR_LOOP_INDEX, HMF_ELEMENT_LOOP, c,
                                 "Element %llu of loop %llu is no %s of the level, which has %llu.",
                                 static_cast<Long>(i - first), static_cast<Long>(c), word, static_cast<Long>(limit));
        for (uint64_t i = first; i < end && !triangles; ++i)
            if (mesh.is_marked(elements[i]))
                return call.fail(
                    HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, c,
                    "Element %llu of loop %llu is a marked vertex, which loops go around. Give a path that "
                    "passes it on one side.",
                    static_cast<Long>(i - first), static_cast<Long>(c));
        for (uint64_t i = first; i < end; ++i) {
            if (i % 8192 == 0 && !call.tick(0, true)) return call.was_cancelled();
            const uint32_t here = elements[i], there = elements[i + 1 < end ? i + 1 : first];
            const uint32_t h = triangles ? shared_side(mesh, side[here], there, path.empty() ? NONE : twin(path.back()))
                                         : shared_edge(mesh, here, there);
            if (h == NONE)
                return call.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                                 "Elements %llu and %llu of loop %llu share no edge. Each %s must neighbor the next, "
                                 "and the last the first.",
                                 static_cast<Long>(i - first), static_cast<Long>(i + 1 < end ? i + 1 - first : 0),
                                 static_cast<Long>(c), word);
            if (!path.push(h)) return call.out_of_memory();
        }
        if (!pushed.add(path, !triangles)) return call.out_of_memory();
    }
    return HMF_OK;
}

} // namespace hmf
