// Loops of a surface with boundary, found on a closed one: each boundary gets a
// cap of triangles around a marked vertex, and no loop goes over that.
//
//        \  S  /
//     ----a---b----     boundary      a loop that cuts through the cap goes
//     \    \ / c  /                   along the boundary instead, on the side
//      \    *    /      cap           of the marked vertex where it was: round
//                                     a and b, in the fans of S there
//
// To these come one loop around each boundary and arcs around marked vertices of the
// boundary, all along the boundary as well:
//
//     1---2---3---4     arcs round 1 2, round 1 2 3, ..: between two of the
//    (_______)   |      stretches that marked vertices leave
//    (___________)
#include "surface_loops.hpp"

#include "../common/caller_lists.hpp"
#include "../../core/curves/double_loops.hpp"
#include "library_loops.hpp"

namespace hmf {

namespace {

class SurfaceLoopsFinder {
public:
    SurfaceLoopsFinder(const hmf_hierarchy& h, Call& call) : h_(h), mesh_(h.input), call_(call) {}

    hmf_status run(int32_t kind, FoundLoops& out);

private:
    bool is_front(uint32_t face) const { return triangle_[face] < h_.surface_triangles; }
    [[nodiscard]] Done find_boundaries();
    Done push(uint32_t triangle);
    Done walk(uint32_t side, bool forward);
    Done finish(bool is_arc, bool is_round = false);
    hmf_status add_closed(int32_t kind);
    Done add_capped(const uint32_t* triangles, size_t n);
    Done add_round(uint32_t boundary, bool is_round);
    bool has_marks(uint32_t boundary) const;
    hmf_status add_arcs(uint32_t boundary, int32_t kind, size_t marks_inside);
    uint8_t number_in_triangle(uint32_t side) const;
    hmf_status add_arc(uint32_t boundary, const Array<uint32_t>& marks, size_t first, size_t last);

    const hmf_hierarchy& h_;
    const Mesh& mesh_;
    Call& call_;
    Array<uint32_t> triangle_;   // the caller's, of each internal face of the double
    Array<uint32_t> side_;       // half-edges of the boundaries, each with its front face, curve by curve
    Array<uint32_t> first_side_; // boundary_count + 1
    Array<uint32_t> curve_;      // per side
    Array<uint32_t> loop_;       // triangles of the one that is being made
    FoundLoops* out_ = nullptr;
};

uint32_t next_in(const Array<uint32_t>& first, uint32_t curve, uint32_t side) {
    return side + 1 < first[curve + 1] ? side + 1 : first[curve];
}

Done SurfaceLoopsFinder::find_boundaries() {
    Array<uint32_t> face;
    Array<uint8_t> seen;
    if (caller_faces(h_, face, call_) || inverse_numbers(face.data(), face.size(), triangle_, call_)) return false;
    if (!seen.allocate_filled(call_.memory, mesh_.vertex_count, uint8_t{0})) return false;
    side_.start(call_.memory);
    first_side_.start(call_.memory);
    curve_.start(call_.memory);
    for (uint32_t t = 0; t < h_.surface_triangles; ++t) {
        uint32_t h = internal_side(h_, t);
        for (int s = 0; s < 3; ++s, h = mesh_.next[h]) {
            if (is_front(mesh_.face[twin(h)]) || seen[mesh_.origin[h]]) continue;
            const uint32_t curve = static_cast<uint32_t>(first_side_.size());
            if (!first_side_.push(static_cast<uint32_t>(side_.size()))) return false;
            for (uint32_t g = h; !seen[mesh_.origin[g]];) {
                seen[mesh_.origin[g]] = 1;
                if (!side_.push(g) || !curve_.push(curve)) return false;
                g = mesh_.next[g];
                while (is_front(mesh_.face[twin(g)])) g = mesh_.next[twin(g)];
            }
        }
    }
    return first_side_.push(static_cast<uint32_t>(side_.size()));
}

Done SurfaceLoopsFinder::push(uint32_t triangle) {
    if (!loop_.empty() && loop_.back() == triangle) return true;
    return loop_.push(triangle);
}

// The triangles around the vertex between two sides, from one side to the other;
// backward: from the next side to this one.
Done SurfaceLoopsFinder::walk(uint32_t side, bool forward) {
    const uint32_t h = side_[side], end = side_[next_in(first_side_, curve_[side], side)];
    if (forward) {
        for (uint32_t g = mesh_.next[h];; g = mesh_.next[twin(g)]) {
            if (!push(triangle_[mesh_.face[g]])) return false;
            if (g == end) return true;
        }
    }
    for (uint32_t g = end;; g = twin(mesh_.prev(g))) {
        if (!push(triangle_[mesh_.face[g]])) return false;
        if (mesh_.prev(g) == h) return true;
    }
}

Done SurfaceLoopsFinder::finish(bool is_arc, bool is_round) {
    size_t begin = 0, end = loop_.size();
    while (!is_arc && end - begin > 1 && loop_[begin] == loop_[end - 1]) --end;
    for (size_t i = begin; i < end; ++i)
        if (!out_->triangles.push(loop_[i])) return false;
    loop_.clear();
    return out_->offsets.push(out_->triangles.size()) && out_->is_round.push(is_round) && out_->arcs.push(is_arc)
        && out_->arc_sides.push(NONE) && out_->arc_sides.push(NONE);
}

// A loop of the capped surface; triangle m + q is the cap beyond side q.
Done SurfaceLoopsFinder::add_capped(const uint32_t* triangles, size_t n) {
    const uint32_t m = h_.surface_triangles;
    size_t start = 0;
    while (start + 1 < n && triangles[start] >= m) ++start;
    for (size_t i = 0; i < n; ++i) {
        const uint32_t here = triangles[(start + i) % n], there = triangles[(start + i + 1) % n];
        if (here < m) {
            if (!push(here)) return false;
            continue;
        }
        const uint32_t q = here - m;
        if (!push(triangle_[mesh_.face[side_[q]]])) return false;
        if (there < m) continue;
        const bool forward = next_in(first_side_, curve_[q], q) == there - m;
        if (!walk(forward ? q : there - m, forward)) return false;
    }
    return finish(false);
}

hmf_status SurfaceLoopsFinder::add_closed(int32_t kind) {
    const uint32_t n = h_.surface_vertices, m = h_.surface_triangles, boundaries = h_.boundary_count;
    Array<double> position;
    Array<uint32_t> triangles, marked;
    marked.start(call_.memory);
    if (!position.allocate_filled(call_.memory, size_t{3} * (n + boundaries), 0.0)
        || !triangles.allocate(call_.memory, 3 * (m + side_.size())))
        return call_.out_of_memory();
    const double* from = h_.levels[0].position;
    for (uint32_t v = 0; v < n; ++v) {
        const bool is_marked = mesh_.is_marked(h_.vertex_internal[v]) && !h_.mirror.is_boundary(v);
        if (is_marked && !marked.push(v)) return call_.out_of_memory();
        for (size_t c = 0; c < 3; ++c) position[size_t{3} * v + c] = from[size_t{3} * h_.vertex_internal[v] + c];
    }
    std::memcpy(triangles.data(), h_.triangle_vertices, size_t{3} * m * sizeof(uint32_t));
    Array<uint32_t> number; // the caller's, of internal vertices
    if (inverse_numbers(h_.vertex_internal, mesh_.vertex_count, number, call_)) return call_.status();
    for (uint32_t b = 0; b < boundaries; ++b) {
        const double share = 1.0 / (first_side_[b + 1] - first_side_[b]);
        if (!marked.push(n + b)) return call_.out_of_memory();
        for (uint32_t q = first_side_[b]; q < first_side_[b + 1]; ++q) {
            const uint32_t v = number[mesh_.origin[side_[q]]], w = number[mesh_.target(side_[q])];
            const uint32_t corners[3] = {w, v, n + b};
            for (size_t s = 0; s < 3; ++s) triangles[3 * (size_t{m} + q) + s] = corners[s];
            for (size_t c = 0; c < 3; ++c) position[size_t{3} * (n + b) + c] += share * position[size_t{3} * v + c];
        }
    }
    number.release();
    hmf_hierarchy closed(h_, call_.memory);
    BuildOptions options;
    options.mollify = 1e-6;
    options.sphere_allowed = true;
    options.ratio = 0.1; // few steps, as nothing is solved on the levels
    options.has_weights = false;
    options.marked_vertices = marked.data();
    options.marked_count = marked.size();
    if (build_hierarchy(closed, position.data(), size_t{n} + boundaries, 0, triangles.data(), m + side_.size(), options,
                        call_))
        return call_.status();
    Loops loops;
    Array<uint32_t> faces, internal, of;
    if (library_loops(closed, 0, kind, call_, loops) || name_by_triangles(closed, 0, call_, loops, faces)
        || caller_faces(closed, internal, call_) || inverse_numbers(internal.data(), internal.size(), of, call_))
        return call_.status();
    for (uint32_t& f : faces) f = of[f];
    for (size_t c = 0; c < loops.count(); ++c)
        if (!add_capped(faces.data() + loops.offsets[c], static_cast<size_t>(loops.offsets[c + 1] - loops.offsets[c])))
            return call_.out_of_memory();
    return HMF_OK;
}

Done SurfaceLoopsFinder::add_round(uint32_t boundary, bool is_round) {
    for (uint32_t q = first_side_[boundary]; q < first_side_[boundary + 1]; ++q)
        if (!walk(q, true)) return false;
    return finish(false, is_round);
}

bool SurfaceLoopsFinder::has_marks(uint32_t boundary) const {
    for (uint32_t q = first_side_[boundary]; q < first_side_[boundary + 1]; ++q)
        if (mesh_.is_marked(mesh_.origin[side_[q]])) return true;
    return false;
}

// 0, 1 or 2: which side of its triangle a side of the boundary is.
uint8_t SurfaceLoopsFinder::number_in_triangle(uint32_t side) const {
    uint32_t h = internal_side(h_, triangle_[mesh_.face[side_[side]]]);
    uint8_t s = 0;
    for (; h != side_[side]; h = mesh_.next[h]) ++s;
    return s;
}

// Around the marked vertices first .. last of the boundary; marks: the sides that
// begin at them.  From the first side of one stretch to the first one of another.
hmf_status SurfaceLoopsFinder::add_arc(uint32_t boundary, const Array<uint32_t>& marks, size_t first, size_t last) {
    const uint32_t from = marks[(first + marks.size() - 1) % marks.size()], to = marks[last];
    uint32_t q = from;
    do {
        if (!walk(q, true)) return call_.out_of_memory();
        q = next_in(first_side_, boundary, q);
    } while (q != to);
    if (!finish(true)) return call_.out_of_memory();
    const size_t sides = out_->arc_sides.size();
    out_->arc_sides[sides - 2] = number_in_triangle(from);
    out_->arc_sides[sides - 1] = number_in_triangle(to);
    return HMF_OK;
}

hmf_status SurfaceLoopsFinder::add_arcs(uint32_t boundary, int32_t kind, size_t marks_inside) {
    Array<uint32_t> marks;
    marks.start(call_.memory);
    for (uint32_t q = first_side_[boundary]; q < first_side_[boundary + 1]; ++q)
        if (mesh_.is_marked(mesh_.origin[side_[q]]) && !marks.push(q)) return call_.out_of_memory();
    const size_t k = marks.size();
    const bool is_disk = h_.genus == 0;
    if (kind == HMF_LOOPS_CUT) {
        const size_t pairs = k == 4 && marks_inside == 0 ? 1 : k / 2;
        for (size_t p = 0; p < pairs; ++p)
            if (add_arc(boundary, marks, 2 * p, 2 * p + 1)) return call_.status();
        return HMF_OK;
    }
    const size_t most = is_disk && marks_inside == 0 ? k - 2 : k;
    for (size_t last = 1; last < most; ++last)
        if (add_arc(boundary, marks, 0, last)) return call_.status();
    return HMF_OK;
}

hmf_status SurfaceLoopsFinder::run(int32_t kind, FoundLoops& out) {
    out_ = &out;
    out.offsets.start(call_.memory);
    out.triangles.start(call_.memory);
    out.arcs.start(call_.memory);
    out.arc_sides.start(call_.memory);
    out.is_round.start(call_.memory);
    loop_.start(call_.memory);
    if (kind == HMF_LOOPS_HANDLE || kind == HMF_LOOPS_TUNNEL)
        return call_.fail(HMF_ERROR_MESH_BOUNDARY, HMF_ELEMENT_NONE, 0,
                          "A surface with boundary has no inside, so that handles and tunnels have no meaning. Use "
                          "HMF_LOOPS_CUT or HMF_LOOPS_PANTS, or give loops.");
    if (kind != HMF_LOOPS_CUT && kind != HMF_LOOPS_PANTS)
        return call_.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There is no loop kind %d. Use HMF_LOOPS_*.",
                          static_cast<int>(kind));
    if (!out.offsets.push(0) || !find_boundaries()) return call_.out_of_memory();
    if (!call_.tick(0, true)) return call_.was_cancelled();
    const uint32_t genus = h_.surface_genus, boundaries = h_.boundary_count;
    size_t inside = 0;
    for (uint32_t v = 0; v < h_.surface_vertices; ++v)
        inside += mesh_.is_marked(h_.vertex_internal[v]) && !h_.mirror.is_boundary(v);
    // Without handles a cut system is around pairs of marked vertices.
    const bool has_pairs = genus == 0 && inside >= 2 && boundaries + inside >= 4;
    const bool has_closed =
        kind == HMF_LOOPS_CUT ? genus > 0 || has_pairs : 3 * size_t{genus} + boundaries + inside > 3;
    if (has_closed && add_closed(kind)) return call_.status();
    const bool is_disk = h_.genus == 0, is_annulus = genus == 0 && boundaries == 2 && inside == 0;
    if (!is_disk || inside >= 2)
        for (uint32_t b = 0; b < (is_annulus ? 1 : boundaries); ++b) // the one of an annulus goes around both
            if (!add_round(b, !has_marks(b) || (is_annulus && !has_marks(1)))) return call_.out_of_memory();
    if (kind == HMF_LOOPS_PANTS || (is_disk && inside < 2))
        for (uint32_t b = 0; b < boundaries; ++b)
            if (add_arcs(b, kind, inside)) return call_.status();
    return HMF_OK;
}

} // namespace

hmf_status surface_loops(const hmf_hierarchy& hierarchy, int32_t kind, Call& call, FoundLoops& out) {
    SurfaceLoopsFinder finder(hierarchy, call);
    return finder.run(kind, out);
}

} // namespace hmf
