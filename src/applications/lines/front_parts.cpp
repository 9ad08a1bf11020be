// A boundary leaf, mirrored and run through backwards, is one again: its cylinder
// lies on its right. Crossing (h, at) becomes (mirror image of h, at).
#include "front_parts.hpp"

#include "../../core/base/heap_sort.hpp"

#include <algorithm>

namespace hmf {

namespace {

class FrontPartsFinder {
public:
    FrontPartsFinder(Foliation& f, const Reflection& mirror, Cylinders& cylinders, FrontParts& out, Call& call) :
        f_(f), mirror_(mirror), cylinders_(cylinders), graph_(cylinders.graph), out_(out), call_(call) {}

    hmf_status run() {
        Memory& memory = call_.memory;
        const size_t arcs = graph_.arcs.size(), n = cylinders_.list.size();
        out_.reflection = &mirror_;
        if (!out_.zero.allocate_filled(memory, graph_.zeros.size(), Part::front)
            || !out_.arc.allocate_filled(memory, arcs, Part::front) || !out_.arc_mirror.allocate(memory, arcs)
            || !out_.arc_middle.allocate_filled(memory, arcs, uint64_t{0})
            || !out_.cylinder.allocate_filled(memory, n, Part::front) || !out_.cylinder_mirror.allocate(memory, n)
            || !sort_crossings())
            return call_.out_of_memory();
        for (uint32_t z = 0; z < graph_.zeros.size(); ++z) out_.zero[z] = part_of_zero(graph_.zeros[z]);
        if (!call_.tick(0)) return call_.was_cancelled();
        for (uint32_t a = 0; a < arcs; ++a)
            if (!find_arc(a)) return not_symmetric();
        for (uint32_t c = 0; c < n; ++c)
            if (!find_cylinder(c)) return not_symmetric();
        return HMF_OK;
    }

private:
    struct Entry {
        uint64_t index;
        uint32_t boundary;
    };

    hmf_status not_symmetric() {
        return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                          "The halves of the double are not exactly symmetric, as a part that no leaf crosses holds a "
                          "boundary together with a handle or marked vertices. Give loops between them.");
    }

    bool before(const Crossing& a, const Crossing& b) const {
        return a.half_edge != b.half_edge ? a.half_edge < b.half_edge : a.at < b.at;
    }
    Done sort_crossings() {
        sorted_.start(call_.memory);
        for (uint32_t b = 0; b < graph_.boundaries.size(); ++b)
            for (uint64_t i = graph_.boundaries[b].begin; i + 1 < graph_.boundaries[b].end; ++i)
                if (!sorted_.push({i, b})) return false;
        heap_sort(sorted_.data(), sorted_.size(), [&](const Entry& a, const Entry& b) {
            return before(graph_.crossings[a.index], graph_.crossings[b.index]);
        });
        return true;
    }
    // The crossing that the mirror image of one is.
    const Entry* find_mirror(uint64_t index) const {
        const Crossing& c = graph_.crossings[index];
        const Crossing wanted{mirror_.half_edge[c.half_edge], c.at};
        const Entry* const found = std::partition_point(sorted_.begin(), sorted_.end(), [&](const Entry& entry) {
            return before(graph_.crossings[entry.index], wanted);
        });
        return found != sorted_.end() && graph_.crossings[found->index] == wanted ? found : nullptr;
    }

    Part part_of_zero(const Zero& z) {
        if (z.tripod) return mirror_.is_front[z.element] ? Part::front : Part::back;
        if (mirror_.is_boundary[z.element]) return Part::on_boundary;
        const Part part = mirror_.is_front[f_.mesh.out[z.element]] ? Part::front : Part::back;
        if (z.index == 0) return part; // a marked vertex
        explore_cluster(f_, z.element);
        for (const uint32_t v : f_.members)
            if (mirror_.is_boundary[v]) return Part::on_boundary;
        return part;
    }

    // Of a zero that the end of an arc comes to.
    bool is_tripod(uint32_t sector) const { return graph_.zeros[graph_.sectors[sector].zero].tripod; }

    bool find_arc(uint32_t a) {
        const ArcSide& arc = graph_.arcs[a];
        // The mirror image begins where this one ends; that of a tripod's sector before its middle.
        const Entry* const end = find_mirror(arc.last - is_tripod(arc.to));
        if (!end) return false;
        const Boundary& b = graph_.boundaries[end->boundary];
        uint32_t m = b.arcs_begin;
        while (m < b.arcs_end && graph_.arcs[m].first != end->index) ++m;
        if (m == b.arcs_end) return false;
        out_.arc_mirror[a] = m;
        const bool front = out_.goes_on_in_front(graph_.crossings[arc.first]);
        out_.arc[a] = front ? Part::front : Part::back;
        if (m != a) return true;
        // At a vertex the first and the last crossing belong to its sectors.
        uint64_t i = arc.first + !is_tripod(arc.from);
        while (i < arc.last && !mirror_.on_boundary(graph_.crossings[i].half_edge)) ++i;
        if (i >= arc.last) return false;
        out_.arc_middle[a] = i;
        out_.arc[a] = out_.crosses_to_back(graph_.crossings[i]) ? Part::first_half : Part::second_half;
        return true;
    }

    bool find_cylinder(uint32_t c) {
        Cylinder& cylinder = cylinders_.list[c];
        const Entry* const lower = find_mirror(graph_.boundaries[cylinder.lower].begin);
        // Around both boundary curves of an annulus, a torus without zeros: its one closed leaf is no mirror image.
        if (!lower && graph_.zeros.empty()) {
            out_.cylinder_mirror[c] = c;
            out_.cylinder[c] = Part::front;
            return true;
        }
        if (!lower) return false;
        out_.cylinder_mirror[c] = cylinders_.of_boundary[lower->boundary];
        const bool front = out_.goes_on_in_front(graph_.crossings[graph_.boundaries[cylinder.lower].begin]);
        if (lower->boundary == cylinder.lower) out_.cylinder[c] = Part::strip;
        else if (lower->boundary == cylinder.upper) {
            out_.cylinder[c] = Part::ring;
            if (!front) turn_over(cylinder);
        } else out_.cylinder[c] = front ? Part::front : Part::back;
        return true;
    }

    void turn_over(Cylinder& c) {
        const auto turned = [&](const PathPiece& p) {
            const int64_t whole = width(f_, p.half_edge);
            return PathPiece{twin(p.half_edge), whole - p.to, whole - p.from,
                             2 * c.height - (p.height + p.to - p.from)};
        };
        const uint64_t n = c.path_end - c.path_begin;
        for (uint64_t i = 0; i < (n + 1) / 2; ++i) {
            PathPiece &a = cylinders_.pieces[c.path_begin + i], &b = cylinders_.pieces[c.path_end - 1 - i];
            const PathPiece first = turned(a);
            a = turned(b);
            b = first;
        }
        std::swap(c.lower, c.upper);
    }

    Foliation& f_;
    const Reflection& mirror_;
    Cylinders& cylinders_;
    const CriticalGraph& graph_;
    FrontParts& out_;
    Call& call_;
    Array<Entry> sorted_; // crossings of the boundary leaves
};

} // namespace

hmf_status FrontParts::build(Foliation& f, const Reflection& mirror, Cylinders& cylinders, Call& call) {
    return FrontPartsFinder(f, mirror, cylinders, *this, call).run();
}

} // namespace hmf
