// Edges from a vertex v to itself that bound no disk.  Such an edge stands for a
// deck transformation g; its value is the distance of phi(v) and g phi(v).  Its
// two half-edges are the directions to g phi(v) and to the inverse of g, each in
// a sector of its own or both in one.  If v moves by mu into direction S, so
// does g v into g S:
//
//     both half-edges in S     -2 mu      the images approach each other
//     one of them                 0
//     none                     +2 mu
//
// so that every half-edge counts for itself, as those to other vertices do.
//
// A value of 0 means that g fixes phi(v).  Then the edge stays 0 if g fixes S,
// and gets 2 mu otherwise.  g fixes S exactly if the edge and a boundary of the
// cluster that lies in S alone bound an annulus of zero triangles.  So look at
// the triangles on both sides of the edge:
//
//          w          w in S from both ends of the edge: g fixes S; from one: it
//        /   \        does not.  In no S: the annulus is not on this side.
//       v--0--v
//
// If w belongs to the cluster, look at its part without v.  Only a disk without
// closed corners and marked vertices fits into an annulus.  It hangs on v in several places, between
// edges from v to itself or values of its own; each place knows whether v
// goes the same way there as in the others, from the sides next to it or from
// edges that are decided.
#include "whitehead.hpp"

namespace hmf {

namespace {

class ZeroSelfEdges {
public:
    ZeroSelfEdges(Foliation& f, const Rings::Side* side, Star& star) :
        f_(f), side_(side), star_(star), degree_(star.degree), v_(f.mesh.origin[side[0].half_edge]) {}

    bool decide() {
        for (uint32_t t = 0; t < degree_; ++t)
            way(t) = star_.F[t] != 0 ? (star_.group[t] == star_.best ? SAME : OTHER) : is_part(t) ? UNSEEN : OPEN;
        for (uint32_t t = 0; t < degree_; ++t)
            if (way(t) == UNSEEN) look_at_part(t);
        uint32_t open = 1;
        for (bool changed = true; changed && open > 0;) {
            changed = false;
            open = 0;
            for (uint32_t t = 0; t < degree_; ++t) {
                if (star_.F[t] != 0 || target(t) != v_ || (side_[t].half_edge & 1)) continue;
                changed |= decide(t);
                open += way(t) == OPEN;
            }
        }
        for (uint32_t t = 0; t < degree_; ++t)
            if (star_.F[t] == 0 && target(t) == v_) star_.step[t] = way(t) == OTHER;
        return open == 0;
    }

private:
    // Where v goes at a side: as in direction S, another way, or not decided;
    // of a part that fits into no annulus: OUTSIDE.
    enum Way : uint8_t { SAME, OTHER, OPEN, OUTSIDE, UNSEEN };

    uint8_t& way(uint32_t t) { return star_.way[t]; }
    uint32_t target(uint32_t t) const { return f_.mesh.target(side_[t].half_edge); }
    bool is_part(uint32_t t) const { return star_.F[t] == 0 && target(t) != v_; }

    // Sets the row of zero edges to one part that side t belongs to.
    void set_row(uint32_t t, uint8_t value) {
        for (uint32_t s = t; is_part(s); s = side_after(s, degree_)) way(s) = value;
        for (uint32_t s = t; is_part(s); s = side_before(s, degree_)) way(s) = value;
    }

    // The part without v behind side t, in all places where it hangs on v.
    void look_at_part(uint32_t t) {
        const Cluster part = explore_cluster(
            f_, target(t), ClusterSearch().without_vertex(v_).up_to_corners(1).up_to_vertices(star_.budget));
        bool fits = part.closed_corners == 0 && part.marked == 0 && (!part.complete || part.euler == 1),
             has_values = false;
        for (uint32_t s = 0; s < degree_; ++s)
            if (is_part(s) && f_.stamp[target(s)] == f_.epoch) way(s) = OPEN;
        for (uint32_t s = 0; s < degree_ && part.complete; ++s) {
            if (!is_part(s) || f_.stamp[target(s)] != f_.epoch) continue;
            const uint32_t ends[2] = {side_before(s, degree_), side_after(s, degree_)};
            for (const uint32_t end : ends) {
                if (star_.F[end] == 0) continue;
                has_values = true;
                fits &= way(s) == OPEN || way(s) == way(end);
                set_row(s, way(end));
            }
        }
        if (!fits) {
            for (uint32_t s = 0; s < degree_; ++s)
                if (s == t || (is_part(s) && f_.stamp[target(s)] == f_.epoch)) set_row(s, OUTSIDE);
        } else if (part.complete && !has_values) {
            set_row(t, SAME); // compared with this place
        }
    }

    // What the triangle with these two sides tells about the edge between them.
    uint8_t across(uint32_t a, uint32_t b) {
        if (way(a) == SAME && way(b) == SAME) return SAME;
        if ((way(a) == SAME && way(b) == OTHER) || (way(a) == OTHER && way(b) == SAME)) return OTHER;
        if (way(a) == OUTSIDE || way(b) == OUTSIDE || (star_.F[a] != 0 && star_.F[b] != 0)) return OUTSIDE;
        return OPEN;
    }

    // The edge that starts at side t; true if something has become known.
    bool decide(uint32_t t) {
        uint32_t u = 0;
        while (side_[u].half_edge != twin(side_[t].half_edge)) u = side_after(u, degree_);
        const uint32_t pair[2][2] = {{side_before(t, degree_), side_after(u, degree_)},
                                     {side_after(t, degree_), side_before(u, degree_)}};
        bool changed = false;
        if (way(t) == OPEN) {
            const uint8_t one = across(pair[0][0], pair[0][1]), two = across(pair[1][0], pair[1][1]);
            if (one == SAME || two == SAME) way(t) = SAME;
            else if (one == OTHER || two == OTHER || (one == OUTSIDE && two == OUTSIDE)) way(t) = OTHER;
            way(u) = way(t);
            changed = way(t) != OPEN;
        }
        if (way(t) == OPEN) return false;
        for (const auto& ends : pair)
            for (uint32_t k = 0; k < 2; ++k) {
                const uint32_t from = ends[k], to = ends[1 - k];
                if (!is_part(to) || way(to) != OPEN || (way(from) != SAME && (way(from) != OTHER || way(t) == OTHER)))
                    continue;
                set_row(to, way(t) == SAME ? way(from) : uint8_t{OTHER});
                changed = true;
            }
        return changed;
    }

    Foliation& f_;
    const Rings::Side* side_;
    Star& star_;
    const uint32_t degree_, v_;
};

} // namespace

bool open_zero_self_edges(Foliation& f, const Rings::Side* side, Star& star) {
    return ZeroSelfEdges(f, side, star).decide();
}

} // namespace hmf
