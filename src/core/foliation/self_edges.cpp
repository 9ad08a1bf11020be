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
// cluster that lies in S alone bound an annulus: the boundary of S in the
// universal cover is one path in the leaf through phi(v), which is a tree, and g
// moves along it.  So cut the cluster along the edge:
//
//       S   S   S           Both ends of the edge at v keep S on one side, for
//     .-----------.         the lifts of the edge form a path that separates the
//     | annulus   |         directions on its two sides.  What hangs together
//     v --- 0 --- v         with v there is an annulus exactly if it does not
//     |  cluster  |         come to the other side of the cut, holds no marked
//                           vertex, and its Euler characteristic is 0; if there
// is no closed corner, its other boundary lies in one direction, which is S.
#include "whitehead.hpp"

#include <cassert>

namespace hmf {

namespace {

class ZeroSelfEdges {
public:
    ZeroSelfEdges(Foliation& f, const Rings::Side* side, Star& star) :
        f_(f), side_(side), star_(star), degree_(star.degree), v_(f.mesh.origin[side[0].half_edge]) {}

    bool decide() {
        uint32_t in_s = 0;
        while (star_.group[in_s] != star_.best) ++in_s;
        for (uint32_t t = 0; t < degree_; ++t) {
            if (!is_one(t)) continue;
            uint32_t u = side_after(t, degree_);
            while (side_[u].half_edge != twin(side_[t].half_edge)) u = side_after(u, degree_);
            star_.end[t] = u;
        }
        bool known = true;
        for (uint32_t t = 0; t < degree_; ++t) {
            const uint32_t u = star_.end[t];
            if (!is_one(t) || u < t) continue;
            const bool between = t < in_s && in_s < u;
            bool fixed = false;
            known &= cut_along(between ? t : u, between ? u : t, fixed);
            star_.step[t] = star_.step[u] = !fixed;
        }
        return known;
    }

private:
    bool is_one(uint32_t t) const { return star_.F[t] == 0 && f_.mesh.target(side_[t].half_edge) == v_; }

    // Is what hangs together with v between sides `first` and `last`, the two ends of an edge, an annulus without
    // closed corners and marked vertices?  false: not known, as it is too large.
    bool cut_along(uint32_t first, uint32_t last, bool& annulus) {
        assert(!f_.inside); // where there are such edges, sweeps have no blocks, so the search cannot leave one
        const Mesh& mesh = f_.mesh;
        f_.members.clear();
        f_.members.add(v_);
        const uint32_t mark = ++f_.epoch, allowance = star_.allowance();
        f_.stamp[v_] = mark;
        // Zero edges are met from both ends, zero triangles from three sides; from and to v: those to others.
        uint64_t half_edges = 0, sides = 0, from_v = 0, to_v = 0;
        bool fits = true;
        const auto look = [&](uint32_t h, bool with_corner) {
            const uint32_t w = mesh.target(h);
            const bool zero = f_.at(h) == 0;
            if (with_corner) {
                sides += zero && f_.at(mesh.next[h]) == 0;
                if (!zero && f_.at(mesh.rotate_ccw(h)) != 0 && f_.corner2(h) == 0) fits = false;
            }
            if (!zero) return;
            ++half_edges;
            from_v += mesh.origin[h] == v_ && w != v_;
            to_v += mesh.origin[h] != v_ && w == v_;
            if (f_.stamp[w] == mark) return;
            f_.stamp[w] = mark;
            f_.members.add(w);
            fits &= !mesh.is_marked(w);
        };
        for (uint32_t s = first; fits && s != last; s = side_after(s, degree_))
            if (is_one(s)) fits = position(first, star_.end[s]) <= position(first, last);
        const uint32_t end = side_[last].half_edge;
        for (uint32_t h = side_[first].half_edge; fits && h != end; h = mesh.rotate_ccw(h)) look(h, true);
        if (fits) look(end, false);
        size_t at = 1;
        for (; fits && at < f_.members.size() && at <= allowance; ++at)
            for (const uint32_t h : mesh.around(f_.members[at])) look(h, true);
        star_.spend(at);
        if (fits && at < f_.members.size()) return false;
        // One that comes to v from the other side is met from its other end alone.
        annulus = fits && from_v == to_v && f_.members.size() + sides / 3 == half_edges / 2;
        return true;
    }
    uint32_t position(uint32_t first, uint32_t t) const { return t >= first ? t - first : t + degree_ - first; }

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
