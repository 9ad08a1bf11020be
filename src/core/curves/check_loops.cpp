// Are the loops simple, disjoint, essential and pairwise not freely homotopic?
// Decided in integers, in time linear in mesh and crossings.
//
// (a) Disjoint simple loops without backtracking form a normal multicurve,
//     which its crossing numbers determine.  So add the crossing numbers,
//     trace the multicurve that has them, and compare: its components must be
//     the loops.
// (b) Cut along it.  A piece of Euler characteristic 1 is a disk and its loop
//     trivial, if at most one marked vertex is inside; one of characteristic 0
//     without marked vertices is an annulus:
//
//      loop c  (   annulus   )  loop d      c and d are freely homotopic,
//                                           unless c = d (on a torus)
#include "../base/disjoint_sets.hpp"
#include "../base/heap_sort.hpp"
#include "disjoint.hpp"
#include "multicurve.hpp"

#include <algorithm>

namespace hmf {

namespace {

// The loops as the caller gave them.
struct Names {
    const hmf_loop_set* given; // or NULL
    const Array<uint32_t>* of; // as in check_loops

    const char* element() const { return given && given->element_kind == HMF_PATH_TRIANGLES ? "triangle" : "vertex"; }
    const uint32_t* begin(size_t c) const { return given->elements + given->offsets[callers(c)]; }
    const uint32_t* end(size_t c) const { return given->elements + given->offsets[callers(c) + 1]; }
    size_t callers(size_t c) const { return of && !of->empty() ? (*of)[c] : c; }
};

// An element of loop d that loop c has as well (c = d: one that it has twice);
// NONE if there is none, or no memory to find it.
uint32_t common_element(const Names& names, size_t c, size_t d, Memory& memory) {
    if (!names.given) return NONE;
    Array<uint32_t> sorted;
    const size_t n = static_cast<size_t>(names.end(c) - names.begin(c));
    if (!sorted.allocate(memory, n)) return NONE;
    std::copy(names.begin(c), names.end(c), sorted.data());
    heap_sort(sorted.data(), sorted.size(), [](uint32_t a, uint32_t b) { return a < b; });
    if (c == d) {
        const uint32_t* const twice = std::adjacent_find(sorted.begin(), sorted.end());
        return twice == sorted.end() ? NONE : *twice;
    }
    for (const uint32_t* at = names.begin(d); at < names.end(d); ++at)
        if (std::binary_search(sorted.begin(), sorted.end(), *at)) return *at;
    return NONE;
}

// Names the first loop that meets itself or, if there is none, the first one
// that crosses an earlier one.
hmf_status name_crossing(const Mesh& mesh, const Loops& loops, Multicurve& curves, const Names& names, Call& call) {
    const char* const word = names.element();
    for (size_t c = 0; c < loops.count(); ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return call.was_cancelled();
        bool is_simple = false;
        if (!disjoint(mesh, loops, c, c + 1, curves, nullptr, call, is_simple)) return call.out_of_memory();
        if (is_simple) continue;
        const uint32_t at = common_element(names, c, c, call.memory);
        if (at == NONE)
            return call.fail(HMF_ERROR_LOOP_NOT_SIMPLE, HMF_ELEMENT_LOOP, c,
                             "Loop %llu crosses itself. Give a loop that does not.", static_cast<Long>(c));
        return call.fail(HMF_ERROR_LOOP_NOT_SIMPLE, HMF_ELEMENT_LOOP, c,
                         "Loop %llu crosses itself; it passes %s %llu twice. Give a loop that does not.",
                         static_cast<Long>(c), word, static_cast<Long>(at));
    }
    // Loops 0 .. good - 1 are disjoint, loops 0 .. bad - 1 are not.
    size_t good = 1, bad = loops.count();
    while (good + 1 < bad) {
        const size_t middle = good + (bad - good) / 2;
        if (!call.tick(0, true)) return call.was_cancelled();
        bool are_disjoint = false;
        if (!disjoint(mesh, loops, 0, middle, curves, nullptr, call, are_disjoint)) return call.out_of_memory();
        if (are_disjoint) good = middle;
        else bad = middle;
    }
    // Which of them?
    const size_t d = bad - 1;
    Loops two;
    if (!two.start(call.memory)) return call.out_of_memory();
    for (size_t c = 0; c < d; ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return call.was_cancelled();
        two.keep_first(0);
        if (!two.add(loops, c) || !two.add(loops, d)) return call.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh, two, 0, 2, curves, nullptr, call, are_disjoint)) return call.out_of_memory();
        if (are_disjoint) continue;
        const uint32_t at = common_element(names, c, d, call.memory);
        if (at == NONE)
            return call.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
                             "Loop %llu crosses loop %llu. Loops must be disjoint; they may touch.",
                             static_cast<Long>(d), static_cast<Long>(c));
        return call.fail(
            HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
            "Loop %llu crosses loop %llu, which it meets at %s %llu. Loops must be disjoint; they may touch.",
            static_cast<Long>(d), static_cast<Long>(c), word, static_cast<Long>(at));
    }
    return call.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
                     "Loop %llu crosses an earlier loop. Loops must be disjoint; they may touch.",
                     static_cast<Long>(d));
}

// The pieces that the curves leave.  Vertices are in one piece with those at the other ends of
// edges that no curve crosses; so only where a curve runs there is more to look at:
//
//     o---|---|---o      a segment at the end of an edge is in the piece of the vertex
//                        there, one between two crossings has a number of its own
class Pieces {
public:
    Pieces(const Mesh& mesh, const Multicurve& curves) : mesh_(mesh), curves_(curves) {}

    struct Piece {
        int64_t six_euler = 0;  // six times its Euler characteristic, without its boundary
        uint32_t marks = 0;     // marked vertices inside
        uint32_t border = NONE; // a loop that it lies at
    };
    Done build(Call& call) {
        if (!join(call) || !call.tick(0, true)) return false;
        uint32_t count = 0;
        for (uint32_t i = 0; i < piece_.size(); ++i) {
            if (!call.work(4)) return false;
            piece_[i] = piece_[i] == i ? count++ : piece_[piece_[i]];
        }
        if (!pieces_.allocate_filled(call.memory, count, Piece{})) return false;
        return count_cells(call);
    }
    // Of segment q of edge e, counted from the origin of half-edge 2e.
    Piece& beside(uint32_t e, uint32_t q) { return pieces_[piece_[segment(e, q)]]; }

private:
    uint32_t segment(uint32_t e, uint32_t q) const {
        return q == 0                ? mesh_.origin[2 * e]
             : q == curves_.count[e] ? mesh_.origin[2 * e + 1]
                                     : mesh_.vertex_count + curves_.first[e] + q - 1;
    }
    // The same, counted from the origin of half-edge h.
    uint32_t segment_from(uint32_t h, uint32_t q) const {
        return segment(edge_of(h), h & 1u ? curves_.count[edge_of(h)] - q : q);
    }

    // face(h) for the sides h of each triangle that a curve runs through.
    template <class Face>
    void for_cut_faces(Face face) const {
        for (const uint32_t e : curves_.edges)
            for (uint32_t first = 2 * e; first < 2 * e + 2; ++first) {
                const uint32_t h[3] = {first, mesh_.next[first], mesh_.prev(first)};
                const auto earlier = [&](uint32_t g) { return g < first && curves_.count[edge_of(g)] > 0; };
                if (!earlier(h[1]) && !earlier(h[2])) face(h);
            }
    }

    // region(a, b, c) for the parts of these triangles, with a segment on each of their sides: around the
    // corners, where c is a, and in the middle.
    template <class Region>
    void for_regions(Region region) const {
        for_cut_faces([&](const uint32_t* h) {
            uint32_t middle[3];
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t before = h[(i + 2) % 3], after = h[(i + 1) % 3], n = curves_.count[edge_of(before)];
                const uint64_t twice = uint64_t{n} + curves_.count[edge_of(h[i])] - curves_.count[edge_of(after)];
                const uint32_t arcs = static_cast<uint32_t>(twice / 2);
                for (uint32_t q = 0; q < arcs; ++q) {
                    const uint32_t a = segment_from(h[i], q);
                    region(a, segment_from(before, n - q), a);
                }
                middle[i] = segment_from(h[i], arcs);
            }
            region(middle[0], middle[1], middle[2]);
        });
    }

    Done join(Call& call) {
        constexpr uint32_t stride = 1u << 16; // edges between two reports
        if (!piece_.allocate(call.memory, mesh_.vertex_count + curves_.total)) return false;
        uint32_t* const parent = piece_.data();
        for (uint32_t i = 0; i < piece_.size(); ++i) parent[i] = i;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            if (e % stride == 0 && !call.tick(0, true)) return false;
            if (curves_.count[e] == 0) unite(parent, mesh_.origin[2 * e], mesh_.origin[2 * e + 1]);
        }
        Done going_on = true;
        for_regions([&](uint32_t a, uint32_t b, uint32_t c) {
            if (!going_on) return;
            unite(parent, a, b);
            unite(parent, b, c);
            going_on = call.work(8);
        });
        return going_on;
    }

    // Without curves half an edge at each of its ends, and a third of a triangle at each of its corners;
    // then what is cut.
    Done count_cells(Call& call) {
        const auto add = [this](uint32_t i, int64_t six) { pieces_[piece_[i]].six_euler += six; };
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            add(v, 6);
            pieces_[piece_[v]].marks += mesh_.is_marked(v);
        }
        for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h) add(mesh_.origin[h], 2 - 3);
        for (const uint32_t e : curves_.edges) {
            for (uint32_t h = 2 * e; h < 2 * e + 2; ++h) add(mesh_.origin[h], 3);
            for (uint32_t q = 0; q <= curves_.count[e]; ++q) add(segment(e, q), -6);
        }
        for_regions([&](uint32_t a, uint32_t, uint32_t) {
            add(a, 6);
            (void)call.work(8);
        });
        for_cut_faces([&](const uint32_t* h) {
            for (uint32_t i = 0; i < 3; ++i) add(mesh_.origin[h[i]], -2);
        });
        return !call.cancelled();
    }

    const Mesh& mesh_;
    const Multicurve& curves_;
    Array<uint32_t> piece_; // of each vertex, then of the segments between two crossings
    Array<Piece> pieces_;
};

// Disks and annuli among the pieces.
hmf_status check_pieces(const Mesh& mesh, const Multicurve& curves, const Array<uint32_t>& loop_of, Call& call) {
    Pieces pieces(mesh, curves);
    Array<uint32_t> component_of;
    const size_t n = loop_of.size();
    if (!component_of.allocate(call.memory, n) || !pieces.build(call)) return call.stopped();
    if (!call.tick(0, true)) return call.was_cancelled();
    for (size_t k = 0; k < n; ++k) component_of[loop_of[k]] = static_cast<uint32_t>(k);
    for (int round = 0; round < 2; ++round) // disks first
        for (size_t c = 0; c < n; ++c) {
            const uint32_t crossed = curves.components.crossings[curves.components.offsets[component_of[c]]];
            const uint32_t e = edge_of(crossed);
            const uint32_t j = curves.begin[component_of[c]] - curves.first[e];
            for (uint32_t side = 0; side < 2; ++side) {
                Pieces::Piece& piece = pieces.beside(e, j + side);
                if (round == 0 && piece.six_euler == 6 && piece.marks == 0)
                    return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                                     mesh.marked_count == 0
                                         ? "Loop %llu bounds a disk. Give one that goes around a handle."
                                         : "Loop %llu bounds a disk without marked vertices. Give one that goes around "
                                           "a handle or at least two marked vertices.",
                                     static_cast<Long>(c));
                if (round == 0 && piece.six_euler == 6 && piece.marks == 1)
                    return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                                     "Loop %llu goes around a single marked vertex. Give one that goes around a handle "
                                     "or at least two marked vertices.",
                                     static_cast<Long>(c));
                if (round == 0 || piece.six_euler != 0 || piece.marks != 0) continue;
                if (piece.border == NONE) piece.border = static_cast<uint32_t>(c);
                else if (piece.border != c)
                    return call.fail(
                        HMF_ERROR_LOOP_PARALLEL, HMF_ELEMENT_LOOP, c,
                        "Loops %llu and %llu are freely homotopic. Give one of them, with the sum of their weights.",
                        static_cast<Long>(piece.border), static_cast<Long>(c));
            }
        }
    return HMF_OK;
}

} // namespace

hmf_status check_loops(const Mesh& mesh, const Loops& loops, Call& call, const hmf_loop_set* given,
                       const Array<uint32_t>* of) {
    const size_t count = loops.count();
    if (count == 0)
        return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, 0, "There are no loops. Give at least one.");
    for (size_t c = 0; c < count; ++c)
        if (loops.offsets[c] == loops.offsets[c + 1])
            return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                             "Loop %llu goes back the way it came. Give one that goes around a handle.",
                             static_cast<Long>(c));
    if (loops.offsets[count] >= MULTICURVE_LIMIT)
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, 0,
                         "The loops cross more than 2^29 edges. Give shorter ones.");
    Multicurve curves;
    Array<uint32_t> loop_of;
    if (!curves.allocate(mesh, call.memory)) return call.out_of_memory();
    if (!call.tick(0, true)) return call.was_cancelled();
    bool are_disjoint = false;
    if (!disjoint(mesh, loops, 0, count, curves, &loop_of, call, are_disjoint)) return call.out_of_memory();
    if (!are_disjoint) return name_crossing(mesh, loops, curves, {given, of}, call);
    if (!call.tick(0, true)) return call.was_cancelled();
    return check_pieces(mesh, curves, loop_of, call);
}

} // namespace hmf
