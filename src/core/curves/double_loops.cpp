#include "double_loops.hpp"

#include "../base/disjoint_sets.hpp"
#include "cut_surface.hpp"
#include "disjoint.hpp"

namespace hmf {

namespace {

class Doubler {
public:
    Doubler(const hmf_hierarchy& h, const hmf_loop_set& given, Call& call) :
        h_(h), mesh_(h.input), given_(given), call_(call) {}

    hmf_status run(const uint8_t* known_round, WeightedLoops& out);

private:
    bool is_arc(size_t c) const { return given_.arcs && given_.arcs[c] != 0; }
    bool is_triangles() const { return given_.element_kind == HMF_PATH_TRIANGLES; }
    Done find_sheets();
    hmf_status check_elements(size_t c);
    hmf_status check_ends(size_t c);
    // An edge from one vertex to another with a triangle on the sheet; NONE if there is none.
    uint32_t edge_between(uint32_t from, uint32_t to, uint8_t sheet) const;
    uint32_t side_between(uint32_t from, uint32_t to, uint32_t came_in) const;
    uint32_t boundary_side(size_t c, bool at_end) const;
    hmf_status add_path(size_t c, bool is_image, Array<uint32_t>& path);
    hmf_status add_vertex_path(size_t c, bool is_image, Array<uint32_t>& path);
    hmf_status add_triangle_path(size_t c, bool is_image, Array<uint32_t>& path);
    hmf_status not_neighbors(size_t c, uint64_t a, uint64_t b);
    hmf_status find_round_boundary(const Loops& all, Array<uint8_t>& is_round);

    const hmf_hierarchy& h_;
    const Mesh& mesh_;
    const hmf_loop_set& given_;
    Call& call_;
    Array<uint32_t> face_;  // internal face of each triangle of the double
    Array<uint32_t> side_;  // a half-edge of each internal face
    Array<uint8_t> sheet_;  // per internal face: 0 in front, 1 behind
    Array<uint32_t> image_; // per internal face
};

Done Doubler::find_sheets() {
    const uint32_t m = h_.mirror.triangle_count;
    if (!sheet_.allocate(call_.memory, mesh_.face_count) || !face_.allocate(call_.memory, mesh_.face_count)
        || !side_.allocate(call_.memory, mesh_.face_count) || !image_.allocate(call_.memory, mesh_.face_count))
        return false;
    // A triangle of the caller is the face at its first edge where the second one follows.
    for (uint32_t t = 0; t < 2 * m; ++t) {
        const uint32_t* edges = h_.triangle_edges + size_t{3} * t;
        const uint32_t second = h_.edge_internal[edges[1]], third = h_.edge_internal[edges[2]];
        uint32_t side = 2 * h_.edge_internal[edges[0]];
        if (edge_of(mesh_.next[side]) != second || edge_of(mesh_.prev(side)) != third) side = twin(side);
        face_[t] = mesh_.face[side];
        side_[face_[t]] = side;
        sheet_[face_[t]] = t >= m;
    }
    for (uint32_t t = 0; t < m; ++t) {
        image_[face_[t]] = face_[m + t];
        image_[face_[m + t]] = face_[t];
    }
    return true;
}

hmf_status Doubler::check_elements(size_t c) {
    const char* const word = is_triangles() ? "triangle" : "vertex";
    const uint32_t limit = is_triangles() ? h_.surface_triangles : h_.surface_vertices;
    for (uint64_t i = given_.offsets[c]; i < given_.offsets[c + 1]; ++i) {
        const Long place = i - given_.offsets[c];
        if (given_.elements[i] >= limit)
            return call_.fail(HMF_ERROR_LOOP_INDEX, HMF_ELEMENT_LOOP, c,
                              "Element %llu of loop %llu is no %s of the level, which has %llu.", place,
                              static_cast<Long>(c), word, static_cast<Long>(limit));
        if (!is_triangles() && mesh_.is_marked(h_.vertex_internal[given_.elements[i]]))
            return call_.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, c,
                              "Element %llu of loop %llu is a marked vertex, which loops go around. Give a path that "
                              "passes it on one side.",
                              place, static_cast<Long>(c));
    }
    return HMF_OK;
}

hmf_status Doubler::check_ends(size_t c) {
    if (!is_arc(c)) return HMF_OK;
    const uint64_t ends[2] = {given_.offsets[c], given_.offsets[c + 1] - 1};
    if (!is_triangles() && ends[0] == ends[1])
        return call_.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                          "Arc %llu is a single vertex. Give a path from boundary to boundary.", static_cast<Long>(c));
    for (const uint64_t i : ends) {
        const uint32_t element = given_.elements[i];
        const bool at_end = i != ends[0];
        if (is_triangles() ? boundary_side(c, at_end) != NONE : h_.mirror.is_boundary(element)) continue;
        return call_.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                          "Arc %llu does not %s at the boundary: %s %llu is not there. Arcs lead from boundary to "
                          "boundary.",
                          static_cast<Long>(c), at_end ? "end" : "begin", is_triangles() ? "triangle" : "vertex",
                          static_cast<Long>(element));
    }
    return HMF_OK;
}

uint32_t Doubler::edge_between(uint32_t from, uint32_t to, uint8_t sheet) const {
    uint32_t found = NONE;
    for (const uint32_t h : mesh_.around(from)) {
        const bool on_sheet = sheet_[mesh_.face[h]] == sheet || sheet_[mesh_.face[twin(h)]] == sheet;
        if (mesh_.target(h) == to && on_sheet && h < found) found = h;
    }
    return found;
}

// As shared_side of read_loops.cpp.
uint32_t Doubler::side_between(uint32_t from, uint32_t to, uint32_t came_in) const {
    uint32_t h = side_[from], back = NONE;
    for (int i = 0; i < 3; ++i, h = mesh_.next[h]) {
        if (mesh_.face[twin(h)] != to) continue;
        if (h != came_in) return h;
        back = h;
    }
    return back;
}

// Where an arc of triangles begins or ends, as a half-edge in front: at the side
// that is named or else at the first side on the boundary (at the end of an arc in
// one triangle: the last).  NONE if that is not on the boundary.
uint32_t Doubler::boundary_side(size_t c, bool at_end) const {
    const uint64_t first = given_.offsets[c], last = given_.offsets[c + 1] - 1;
    const uint32_t face = face_[given_.elements[at_end ? last : first]];
    const uint32_t named = given_.arc_sides ? given_.arc_sides[2 * c + at_end] : NONE;
    uint32_t h = side_[face], found = NONE;
    for (uint32_t s = 0; s < 3; ++s, h = mesh_.next[h]) {
        if (mesh_.face[twin(h)] != image_[face] || (named != NONE && named != s)) continue;
        if (found == NONE || (at_end && first == last)) found = h;
    }
    return found;
}

hmf_status Doubler::not_neighbors(size_t c, uint64_t a, uint64_t b) {
    const uint64_t first = given_.offsets[c];
    return call_.fail(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                      "Elements %llu and %llu of loop %llu share no edge. Each %s must neighbor the next%s.",
                      static_cast<Long>(a - first), static_cast<Long>(b - first), static_cast<Long>(c),
                      is_triangles() ? "triangle" : "vertex", is_arc(c) ? "" : ", and the last the first");
}

// Edges along a path of vertices; an arc comes back on the other sheet.
hmf_status Doubler::add_vertex_path(size_t c, bool is_image, Array<uint32_t>& path) {
    const uint64_t first = given_.offsets[c], end = given_.offsets[c + 1];
    const auto vertex = [&](uint64_t i, bool behind) {
        const uint32_t v = given_.elements[i];
        return h_.vertex_internal[behind ? h_.mirror.vertex[v] : v];
    };
    const auto step = [&](uint64_t i, uint64_t j, bool behind) {
        const uint32_t h = edge_between(vertex(i, behind), vertex(j, behind), behind);
        if (h == NONE) return not_neighbors(c, i, j);
        return path.push(h) ? HMF_OK : call_.out_of_memory();
    };
    for (uint64_t i = first; i + 1 < end; ++i)
        if (step(i, i + 1, is_image)) return call_.status();
    if (!is_arc(c)) return step(end - 1, first, is_image);
    for (uint64_t i = end - 1; i > first; --i)
        if (step(i, i - 1, true)) return call_.status();
    return HMF_OK;
}

// Sides that a path of triangles crosses.
hmf_status Doubler::add_triangle_path(size_t c, bool is_image, Array<uint32_t>& path) {
    const uint64_t first = given_.offsets[c], end = given_.offsets[c + 1];
    uint32_t came_in = NONE;
    const auto cross = [&](uint32_t h) {
        came_in = twin(h);
        return path.push(h) ? HMF_OK : call_.out_of_memory();
    };
    const auto face = [&](uint64_t i, bool behind) {
        const uint32_t f = face_[given_.elements[i]];
        return behind ? image_[f] : f;
    };
    const auto step = [&](uint64_t i, uint64_t j, bool behind) {
        const uint32_t h = side_between(face(i, behind), face(j, behind), came_in);
        return h == NONE ? not_neighbors(c, i, j) : cross(h);
    };
    for (uint64_t i = first; i + 1 < end; ++i)
        if (step(i, i + 1, is_image)) return call_.status();
    if (!is_arc(c)) return step(end - 1, first, is_image);
    if (cross(boundary_side(c, true))) return call_.status();
    for (uint64_t i = end - 1; i > first; --i)
        if (step(i, i - 1, true)) return call_.status();
    return cross(twin(boundary_side(c, false)));
}

hmf_status Doubler::add_path(size_t c, bool is_image, Array<uint32_t>& path) {
    path.clear();
    return is_triangles() ? add_triangle_path(c, is_image, path) : add_vertex_path(c, is_image, path);
}

// Loops 0 .. count - 1 with their images behind them: which ones bound an annulus
// with theirs?  Where loops cross nothing is found: check_loops says so.
hmf_status Doubler::find_round_boundary(const Loops& all, Array<uint8_t>& is_round) {
    const size_t count = static_cast<size_t>(given_.count);
    if (!is_round.allocate_filled(call_.memory, count, uint8_t{0})) return call_.out_of_memory();
    const size_t images = all.count() - count;
    if (images == 0 || all.crossings.size() >= MULTICURVE_LIMIT) return HMF_OK;
    for (size_t c = 0; c < all.count(); ++c)
        if (all.offsets[c] == all.offsets[c + 1]) return HMF_OK;
    Multicurve curves;
    Array<uint32_t> loop_of;
    if (!curves.allocate(mesh_, call_.memory)) return call_.out_of_memory();
    bool are_disjoint = false;
    if (!disjoint(mesh_, all, 0, all.count(), curves, &loop_of, call_, are_disjoint)) return call_.out_of_memory();
    if (!are_disjoint) return HMF_OK;
    if (!call_.tick(0, true)) return call_.was_cancelled();
    CutSurface cut;
    Array<uint32_t> parent;
    Array<int64_t> euler; // of each piece, less one for each marked vertex
    if (!cut.build(mesh_, curves, false, call_) || !parent.allocate(call_.memory, cut.region_count)
        || !euler.allocate_filled(call_.memory, cut.region_count, int64_t{0}))
        return call_.stopped();
    for (uint32_t r = 0; r < cut.region_count; ++r) parent[r] = r;
    for (size_t s = 0; s < cut.segment_count; ++s) unite(parent.data(), cut.region[2 * s], cut.region[2 * s + 1]);
    for (uint32_t r = 0; r < cut.region_count; ++r) ++euler[find_root(parent.data(), r)];
    for (size_t s = 0; s < cut.segment_count; ++s) --euler[find_root(parent.data(), cut.region[2 * s])];
    const auto piece_at = [&](uint32_t e, size_t segment) {
        return find_root(parent.data(), cut.region[2 * (cut.segment_first[e] + segment)]);
    };
    for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
        const uint32_t h = mesh_.out[v], e = edge_of(h);
        euler[piece_at(e, h & 1u ? curves.count[e] : 0)] += mesh_.is_marked(v) ? 0 : 1;
    }
    if (!call_.tick(0, true)) return call_.was_cancelled();
    // The pieces at both sides of each loop.
    Array<uint32_t> piece, image_of;
    if (!piece.allocate_filled(call_.memory, 2 * all.count(), NONE) || !image_of.allocate(call_.memory, count))
        return call_.out_of_memory();
    for (size_t k = 0; k < loop_of.size(); ++k) {
        const uint32_t e = edge_of(curves.components.crossings[curves.components.offsets[k]]);
        const size_t place = curves.begin[k] - curves.first[e];
        for (size_t side = 0; side < 2; ++side) piece[2 * size_t{loop_of[k]} + side] = piece_at(e, place + side);
    }
    size_t image = count;
    for (size_t c = 0; c < count; ++c) {
        if (is_arc(c)) continue;
        for (size_t a = 0; a < 2; ++a)
            for (size_t b = 0; b < 2; ++b) {
                const uint32_t shared = piece[2 * c + a];
                if (shared == piece[2 * image + b] && euler[shared] == 0) is_round[c] = 1;
            }
        ++image;
    }
    return HMF_OK;
}

hmf_status Doubler::run(const uint8_t* known_round, WeightedLoops& out) {
    const size_t count = static_cast<size_t>(given_.count);
    if (!find_sheets()) return call_.out_of_memory();
    if (!call_.tick(0, true)) return call_.was_cancelled();
    Loops all; // paths of both sheets
    Array<uint32_t> path, of;
    path.start(call_.memory);
    of.start(call_.memory);
    if (!all.start(call_.memory)) return call_.out_of_memory();
    for (int image = 0; image < 2; ++image)
        for (size_t c = 0; c < count; ++c) {
            if (image == 1 && is_arc(c)) continue;
            if (c % 256 == 0 && !call_.tick(0, true)) return call_.was_cancelled();
            if (image == 0 && (check_elements(c) || check_ends(c))) return call_.status();
            if (add_path(c, image == 1, path)) return call_.status();
            if (!all.add(path) || !of.push(static_cast<uint32_t>(c))) return call_.out_of_memory();
        }
    Loops pushed; // crossings
    if (push_paths_off(mesh_, all, !is_triangles(), call_, pushed)) return call_.status();
    Array<uint8_t> is_round;
    if (!known_round && find_round_boundary(pushed, is_round)) return call_.status();
    const uint8_t* const round = known_round ? known_round : is_round.data();
    // Without the images of loops around a boundary.
    Loops& loops = out.loops;
    out.of.start(call_.memory);
    out.factor.start(call_.memory);
    if (!loops.start(call_.memory)) return call_.out_of_memory();
    for (size_t k = 0; k < pushed.count(); ++k) {
        const uint32_t c = of[k];
        if (k >= count && round[c]) continue;
        if (!loops.add(pushed, k) || !out.of.push(c) || !out.factor.push(round[c] ? 2 : 1))
            return call_.out_of_memory();
    }
    return HMF_OK;
}

} // namespace

hmf_status double_loops(const hmf_hierarchy& hierarchy, const hmf_loop_set& given, const uint8_t* is_round, Call& call,
                        WeightedLoops& out) {
    Doubler doubler(hierarchy, given, call);
    return doubler.run(is_round, out);
}

} // namespace hmf
