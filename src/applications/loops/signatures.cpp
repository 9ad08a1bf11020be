#include "signatures.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../../core/base/random_word.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t SIGNATURE_STRIDE = 65536; // regions and segments between two reports

// The tree of the points, while words are given to the segments that are in none of both trees.
struct PointTree {
    const Array<uint32_t>* as = nullptr; // of each point, the one that it counts as; NULL: itself
    uint32_t point(uint32_t p) const { return as ? (*as)[p] : p; }
    Array<uint32_t> degree; // of each point, in the part that is left
    Array<uint32_t> last;   // its segments, by exclusive or: once the degree is one, the segment that is left
    Array<uint64_t> value;  // the cycles that end at the point, or behind it
};

// reached and rank.  in_tree: per segment.
Done search_regions(const CutSurface& cut, Signatures& found, Array<uint32_t>& queue, Array<uint8_t>& in_tree,
                    Call& call) {
    size_t begin = 0, end = 0;
    for (uint32_t root = 0; root < cut.region_count; ++root) { // of each piece
        if (found.rank[root] != NONE) continue;
        found.reached[root] = NONE;
        found.rank[root] = static_cast<uint32_t>(end);
        queue[end++] = root;
        while (begin < end) {
            if (begin % SIGNATURE_STRIDE == 0 && !call.tick(0, true)) return false;
            const uint32_t r = queue[begin++];
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut.link[3 * size_t{r} + i];
                if (link == NONE) break;
                const uint32_t to = cut.region[link ^ 1u];
                if (found.rank[to] != NONE) continue;
                found.reached[to] = link;
                found.rank[to] = static_cast<uint32_t>(end);
                in_tree[link >> 1] = 1;
                queue[end++] = to;
            }
        }
    }
    return true;
}

// A spanning tree of the points from segments that are not in the other tree; the remaining segments get words.
Done span_points(const CutSurface& cut, const Array<uint8_t>& in_tree, PointTree& tree, Array<uint64_t>& of,
                 Call& call) {
    Array<uint32_t> parent;
    if (!parent.allocate(call.memory, cut.point_count)) return false;
    for (uint32_t p = 0; p < cut.point_count; ++p) parent[p] = p;
    uint64_t seed = 0;
    for (uint32_t s = 0; s < cut.segment_count; ++s) {
        if (s % SIGNATURE_STRIDE == 0 && !call.tick(0, true)) return false;
        if (in_tree[s]) continue;
        const uint32_t p = tree.point(cut.point[2 * size_t{s}]), q = tree.point(cut.point[2 * size_t{s} + 1]);
        if (unite(parent.data(), p, q)) {
            ++tree.degree[p];
            ++tree.degree[q];
            tree.last[p] ^= s;
            tree.last[q] ^= s;
        } else {
            of[s] = random_word(seed) | 1u;
            tree.value[p] ^= of[s];
            tree.value[q] ^= of[s];
        }
    }
    return true;
}

// Strips leaves of the tree: a segment lies on the cycles that end behind it.
Done sum_behind(const CutSurface& cut, PointTree& tree, Array<uint32_t>& queue, Array<uint64_t>& of, Call& call) {
    size_t begin = 0, end = 0;
    for (uint32_t p = 0; p < cut.point_count; ++p)
        if (tree.degree[p] == 1) queue[end++] = p;
    while (begin < end) {
        if (begin % SIGNATURE_STRIDE == 0 && !call.tick(0, true)) return false;
        const uint32_t p = queue[begin++];
        if (tree.degree[p] != 1) continue;
        const uint32_t s = tree.last[p];
        const uint32_t a = tree.point(cut.point[2 * size_t{s}]), b = tree.point(cut.point[2 * size_t{s} + 1]);
        const uint32_t q = a == p ? b : a;
        of[s] = tree.value[p];
        tree.value[q] ^= tree.value[p];
        tree.last[q] ^= s;
        tree.degree[p] = 0;
        if (--tree.degree[q] == 1) queue[end++] = q;
    }
    return true;
}

} // namespace

// A cut system of the surface with these points, as words; all points of one number are one.
static Done build_words(const CutSurface& cut, const Array<uint32_t>* as, Signatures& found, Call& call) {
    Memory& memory = call.memory;
    const uint32_t regions = cut.region_count, segments = cut.segment_count, points = cut.point_count;
    Array<uint32_t> queue;
    Array<uint8_t> in_tree; // of the regions
    PointTree tree;
    tree.as = as;
    return found.of.allocate_filled(memory, segments, uint64_t{0}) && found.reached.allocate(memory, regions)
        && found.rank.allocate_filled(memory, regions, NONE) && queue.allocate(memory, std::max(regions, points))
        && tree.degree.allocate_filled(memory, points, 0u) && tree.last.allocate_filled(memory, points, 0u)
        && in_tree.allocate_filled(memory, segments, uint8_t{0})
        && tree.value.allocate_filled(memory, points, uint64_t{0}) && search_regions(cut, found, queue, in_tree, call)
        && span_points(cut, in_tree, tree, found.of, call) && sum_behind(cut, tree, queue, found.of, call);
}

Done Signatures::build(const CutSurface& cut, Call& call) { return build_words(cut, nullptr, *this, call); }

Done Signatures::build_punctured(const CutSurface& cut, const Array<uint8_t>& is_hole, Call& call) {
    Array<uint32_t> as;
    Array<uint64_t> round;
    trivial.start(call.memory);
    if (!as.allocate(call.memory, cut.point_count) || !round.allocate_filled(call.memory, cut.point_count, uint64_t{0}))
        return false;
    uint32_t hole = NONE; // the first one
    for (uint32_t p = 0; p < cut.point_count; ++p) {
        if (is_hole[p] && hole == NONE) hole = p;
        as[p] = is_hole[p] ? hole : p;
    }
    if (!build_words(cut, &as, *this, call)) return false;
    for (size_t k = 0; k < 2 * size_t{cut.segment_count}; ++k) round[cut.point[k]] ^= of[k >> 1];
    for (uint32_t p = 0; p < cut.point_count; ++p)
        if (is_hole[p] && !trivial.push(round[p])) return false;
    heap_sort(trivial.data(), trivial.size(), [](uint64_t a, uint64_t b) { return a < b; });
    return true;
}

Done Signatures::build_holes(const CutSurface& cut, const Array<uint8_t>& is_hole, Call& call) {
    Memory& memory = call.memory;
    const uint32_t segments = cut.segment_count, points = cut.point_count;
    Array<uint32_t> first, at, tree, queue;
    Array<uint64_t> behind;
    trivial.start(memory);
    if (!of.allocate_filled(memory, segments, uint64_t{0}) || !first.allocate_filled(memory, points + size_t{2}, 0u)
        || !at.allocate(memory, 2 * size_t{segments}) || !tree.allocate_filled(memory, points, NONE)
        || !queue.allocate(memory, points) || !behind.allocate_filled(memory, points, uint64_t{0}))
        return false;
    for (size_t k = 0; k < 2 * size_t{segments}; ++k) ++first[cut.point[k] + 2];
    for (size_t p = 0; p < points; ++p) first[p + 2] += first[p + 1];
    for (uint32_t k = 0; k < 2 * segments; ++k) at[first[cut.point[k] + 1]++] = k;
    // A tree of points in each piece, breadth first from a hole; the way to each
    // other hole carries its word.
    uint64_t seed = 2;
    for (uint32_t root = 0; root < points; ++root) {
        if (!is_hole[root] || tree[root] != NONE || first[root] == first[root + 1]) continue;
        size_t begin = 0, end = 0;
        queue[end++] = root;
        tree[root] = root; // no segment; never read
        while (begin < end) {
            if (begin % SIGNATURE_STRIDE == 0 && !call.tick(0, true)) return false;
            const uint32_t p = queue[begin++];
            for (uint32_t i = first[p]; i < first[p + 1]; ++i) {
                const uint32_t q = cut.point[at[i] ^ 1u];
                if (tree[q] != NONE) continue;
                tree[q] = at[i];
                queue[end++] = q;
            }
        }
        uint64_t all = 0;
        for (size_t i = 1; i < end; ++i) {
            if (!is_hole[queue[i]]) continue;
            const uint64_t word = random_word(seed) | 1u;
            behind[queue[i]] = word;
            all ^= word;
            if (!trivial.push(word)) return false;
        }
        if (!trivial.push(all)) return false;
        while (end-- > 1) {
            const uint32_t p = queue[end], k = tree[p];
            of[k >> 1] = behind[p];
            behind[cut.point[k]] ^= behind[p];
        }
    }
    heap_sort(trivial.data(), trivial.size(), [](uint64_t a, uint64_t b) { return a < b; });
    return true;
}

double Signatures::cycle(const CutSurface& cut, uint32_t segment, const Array<double>& edge_length,
                         double enough) const {
    double sum = edge_length[cut.segment_edge[segment]];
    for (uint32_t r = cut.region[2 * size_t{segment}], q = cut.region[2 * size_t{segment} + 1];
         r != q && sum <= enough;) {
        uint32_t& behind = rank[r] > rank[q] ? r : q;
        sum += edge_length[cut.segment_edge[reached[behind] >> 1]];
        behind = cut.region[reached[behind]];
    }
    return sum;
}

} // namespace hmf
