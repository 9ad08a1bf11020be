// Quads by cylinders.  Every cylinder is a grid of rows (leaves at equal
// distances) and columns; along the critical graph the grids share the points
// that divide its arcs.  So the mesh is closed, oriented and manifold whatever
// the numbers are, and a zero with k prongs has 2k edges, all others 4 (a marked
// vertex with one prong: quad_poles.hpp).
//
//     Z---+---+---Z---+--       lower boundary leaf ->   (arcs, columns)
//     |   |   |   |   |
//     +---+---+---+---+--       row 1
//     |   |   |   |   |
//     +---Z---+---+---+--       <- upper boundary leaf
//
// Columns follow the conjugate direction.  Within a triangle u is linear, and
// along a leaf the conjugate v grows by |grad u| times the length.  On a leaf it
// is measured from where the path across the cylinder meets it; along the path
// the conjugate of u is integrated as well, which gives the twist between both
// boundaries; each row then corrects it, so that columns meet it at right angles
// in the mean.  The rows between take the mean of both boundaries, weighted by height.
#include "quad_mesh.hpp"

#include "../base/disjoint_sets.hpp"
#include "polyline.hpp"
#include "quad_poles.hpp"
#include "quad_rulers.hpp"
#include "quad_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class QuadBuilder {
public:
    QuadBuilder(Foliation& f, const double* position, const Cylinders& cylinders, const FrontParts* front,
                QuadMesh& out, Call& call) :
        f_(f),
        position_(position), cylinders_(cylinders), graph_(cylinders.graph), front_(front), conjugate_(f, position),
        out_(out), call_(call) {}

    hmf_status run(const QuadWish& wish) {
        Memory& memory = call_.memory;
        const size_t arcs = graph_.arcs.size(), boundaries = graph_.boundaries.size();
        ruler_.start(memory);
        leaf_.start(memory);
        lower_.vertex.start(memory);
        lower_.v.start(memory);
        upper_.vertex.start(memory);
        upper_.v.start(memory);
        all_.vertex.start(memory);
        all_.v.start(memory);
        Array<double> length;
        if (!v_.allocate(memory, graph_.crossings.size()) || !arc_from_.allocate(memory, arcs)
            || !arc_to_.allocate(memory, arcs) || !arc_vertex_.allocate(memory, arcs) || !length.allocate(memory, arcs)
            || !along_.allocate_filled(memory, arcs, uint8_t{0}) || !columns_.allocate(memory, arcs)
            || !rows_.allocate(memory, cylinders_.list.size()))
            return call_.out_of_memory();
        if (refuse_wide_zeros()) return call_.status();
        for (uint32_t b = 0; b < boundaries; ++b) measure(graph_.boundaries[b]);
        for (size_t a = 0; a < arcs; ++a) length[a] = arc_to_[a] - arc_from_[a];
        if (!call_.tick(0)) return call_.was_cancelled();
        const double round = graph_.zeros.empty() ? v_[graph_.boundaries[0].end - 1] : 0;
        if (sizes_.start(cylinders_, length, round, wish.merge, call_)) return call_.status();
        // Of a double with twice the step: the sum of both halves is symmetric, and even where the boundary crosses.
        const double step = front_ ? 2 * wish.step : wish.step;
        const int64_t count = front_ && wish.count > 0 ? wish.count / 2 + 1 : wish.count;
        if (count > 0 ? sizes_.of_count(step, count, call_) : sizes_.of_step(step, call_)) return call_.status();
        take_sizes(wish);
        if (build()) return call_.status();
        if (f_.mesh.marked_count == 0 || wish.keep_poles) return HMF_OK;
        size_t left = 0;
        if (!quads_over_poles(out_, left, call_)) return call_.stopped();
        if (left == 0 || !wish.merge) return HMF_OK;
        // Two poles too near to each other, or to a boundary.
        if (sizes_.widen_at_poles(call_)) return call_.status();
        take_sizes(wish);
        if (build()) return call_.status();
        return quads_over_poles(out_, left, call_) ? HMF_OK : call_.stopped();
    }

private:
    // The columns of a boundary in the direction of its leaf, with v from its first crossing.
    struct Row {
        Array<uint32_t> vertex;
        Array<double> v;
    };

    hmf_status refuse_wide_zeros() {
        for (uint32_t z = 0; z < graph_.zeros.size(); ++z)
            if (graph_.zeros[z].euler != 1)
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, z,
                                  "Zero %u goes round a part of the surface that no leaf crosses, with a handle, "
                                  "boundaries or marked vertices. Give loops that cross it.",
                                  static_cast<unsigned>(z));
        for (const Boundary& b : graph_.boundaries)
            if (b.arcs_begin == b.arcs_end && !graph_.zeros.empty())
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                                  "A leaf goes round several marked vertices at one place, which no leaf tells apart. "
                                  "Give loops between them.");
        return HMF_OK;
    }

    // v along the boundary leaf, and of the zeros that it passes.
    void measure(const Boundary& b) {
        double v = 0;
        for (uint64_t i = b.begin; i < b.end; ++i) {
            v_[i] = v;
            if (i + 1 < b.end) v += conjugate_.step(graph_.crossings[i]);
        }
        // The middle of a tripod lies half-way before the crossing of its sector.
        const auto middle = [&](uint64_t i) {
            return i > b.begin ? (v_[i - 1] + v_[i]) / 2 : v_[i] - (v_[b.end - 1] - v_[b.end - 2]) / 2;
        };
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
            const ArcSide& arc = graph_.arcs[a];
            arc_from_[a] = tripod(arc.from) ? middle(arc.first) : v_[arc.first];
            arc_to_[a] = tripod(arc.to) ? middle(arc.last) : v_[arc.last];
        }
    }

    bool tripod(uint32_t sector) const { return graph_.zeros[graph_.sectors[sector].zero].tripod; }
    Done add_vertex(const double* p, uint32_t side) {
        return out_.positions.push(p[0]) && out_.positions.push(p[1]) && out_.positions.push(p[2])
            && out_.sides.push(side) && out_.held.push(0);
    }

    // A side of the triangle it lies in.
    uint32_t zero_point(uint32_t zero, double* p) const {
        const Zero& z = graph_.zeros[zero];
        if (z.tripod) {
            middle_of_tripod(f_, position_, z.element, p);
            return z.element;
        }
        for (size_t k = 0; k < 3; ++k) p[k] = position_[size_t{3} * z.element + k];
        return f_.mesh.out[z.element];
    }

    // Those of the double are the sums of both halves.
    void take_sizes(const QuadWish& wish) {
        ring_ = front_ ? 2 * sizes_.ring : sizes_.ring;
        for (size_t a = 0; a < columns_.size(); ++a)
            columns_[a] = sizes_.columns[a] + (front_ ? sizes_.columns[front_->arc_mirror[a]] : 0);
        for (uint32_t c = 0; c < rows_.size(); ++c)
            rows_[c] = sizes_.rows[c] + (front_ ? sizes_.rows[front_->cylinder_mirror[c]] : 0);
        if (front_) tune_rows(wish);
    }

    Part part_of_arc(uint32_t a) const { return front_ ? front_->arc[a] : Part::front; }
    Part part_of(uint32_t cylinder) const { return front_ ? front_->cylinder[cylinder] : Part::front; }
    bool is_half(uint32_t a) const { return part_of_arc(a) == Part::first_half || part_of_arc(a) == Part::second_half; }
    bool is_annulus() const { return front_ && graph_.zeros.empty(); } // then with one cylinder

    int64_t across(uint32_t c) const {
        if (graph_.zeros.empty()) return ring_;
        int64_t sum = 0;
        const Boundary& b = graph_.boundaries[cylinders_.list[c].lower];
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) sum += columns_[a];
        return sum;
    }

    // Rows in front as many as are wished, at least those of the sizes.
    void tune_rows(const QuadWish& wish) {
        const auto part = [&](uint32_t c) {
            return is_annulus() && part_of(c) == Part::front ? Part::ring : part_of(c);
        };
        const auto quads = [&](uint32_t c) -> int64_t { // for two rows of the double
            return part(c) == Part::back ? 0 : part(c) == Part::front ? 2 * across(c) : across(c);
        };
        double step = wish.step;
        for (int round = 0; round < 8; ++round) {
            double sum = 0;
            for (uint32_t c = 0; c < rows_.size(); ++c) {
                const double by = part(c) == Part::ring ? 2 : 1;
                const double n = by * std::floor(static_cast<double>(cylinders_.list[c].height) / (step * by) + 0.5);
                rows_[c] = std::max(sizes_.rows[c] * (by > 1 ? 2 : 1), static_cast<int64_t>(n));
                sum += 0.5 * static_cast<double>(quads(c)) * static_cast<double>(rows_[c]);
            }
            if (wish.count <= 0) return;
            const double off = sum / static_cast<double>(wish.count);
            if (off > 0.995 && off < 1.005) return;
            step *= off > 4 ? 4 : off < 0.25 ? 0.25 : off;
        }
    }

    // The quads of these sizes.
    hmf_status build() {
        out_.start(call_.memory);
        if (!place_zeros()) return call_.out_of_memory();
        if (graph_.zeros.empty()) {
            if (!is_annulus() && !place_ring()) return call_.out_of_memory();
        } else
            for (uint32_t a = 0; a < graph_.arcs.size(); ++a) {
                if (a > graph_.arcs[a].twin) continue;
                const uint32_t seen = part_of_arc(a) == Part::back ? graph_.arcs[a].twin : a;
                if (part_of_arc(seen) != Part::back && !place_arc(seen)) return call_.out_of_memory();
            }
        for (uint32_t c = 0; c < cylinders_.list.size(); ++c)
            if (fill(c)) return call_.status();
        return HMF_OK;
    }

    // One vertex for each zero, and one for those that an arc without columns joins.
    Done place_zeros() {
        const uint32_t n = static_cast<uint32_t>(graph_.zeros.size());
        if (!zero_vertex_.allocate(call_.memory, n)) return false;
        for (uint32_t z = 0; z < n; ++z) zero_vertex_[z] = z;
        for (uint32_t a = 0; a < graph_.arcs.size(); ++a)
            if (columns_[a] == 0)
                unite(zero_vertex_.data(), graph_.sectors[graph_.arcs[a].from].zero,
                      graph_.sectors[graph_.arcs[a].to].zero);
        for (uint32_t z = 0; z < n; ++z) zero_vertex_[z] = find_root(zero_vertex_.data(), z);
        if (front_) {
            if (!joined_.allocate(call_.memory, n)) return false;
            for (uint32_t z = 0; z < n; ++z) joined_[z] = zero_vertex_[z];
        }
        uint32_t next = 0;
        for (uint32_t z = 0; z < n; ++z) {
            if (zero_vertex_[z] != z) { // joined to one before it
                zero_vertex_[z] = zero_vertex_[zero_vertex_[z]];
                continue;
            }
            uint32_t place = z;
            bool in_front = true, at_boundary = false;
            if (front_) find_place(z, place, in_front, at_boundary);
            if (!in_front) {
                zero_vertex_[z] = NONE;
                continue;
            }
            zero_vertex_[z] = next++;
            double p[3];
            uint32_t side = zero_point(place, p);
            if (at_boundary && front_->zero[place] != Part::on_boundary) side = point_across(z, p);
            if (!add_vertex(p, side)) return false;
            if (at_boundary) out_.held.back() = AT_BOUNDARY;
        }
        return true;
    }

    // Of the zeros joined to z, which is their lowest: where they are.  Those of both halves meet on the boundary.
    void find_place(uint32_t z, uint32_t& place, bool& in_front, bool& at_boundary) {
        bool behind = false;
        in_front = at_boundary = false;
        for (uint32_t y = z; y < graph_.zeros.size(); ++y) {
            if (find_joined(y) != z) continue;
            const Part part = front_->zero[y];
            if (part == Part::back) behind = true;
            else if (!at_boundary && (!in_front || part == Part::on_boundary)) place = y;
            if (part == Part::front) in_front = true;
            if (part == Part::on_boundary) in_front = at_boundary = true;
        }
        at_boundary = at_boundary || (in_front && behind);
    }
    // The lowest zero that one is joined to by arcs without columns; as zero_vertex_ was.
    uint32_t find_joined(uint32_t y) { return joined_[y]; }

    // Where the arc without columns crosses the boundary.
    uint32_t point_across(uint32_t z, double* p) {
        for (uint32_t a = 0; a < graph_.arcs.size(); ++a)
            if (columns_[a] == 0 && is_half(a) && find_joined(graph_.sectors[graph_.arcs[a].from].zero) == z) {
                const Crossing& c = graph_.crossings[front_->arc_middle[a]];
                point_at(f_, position_, {c.half_edge, c.at + 1}, p);
                return front_->crosses_to_back(c) ? c.half_edge : twin(c.half_edge);
            }
        return zero_point(z, p);
    }

    Done push_crossing(uint64_t i) {
        double p[3];
        point_at(f_, position_, {graph_.crossings[i].half_edge, graph_.crossings[i].at + 1}, p);
        return ruler_.push(v_[i], p, twin(graph_.crossings[i].half_edge));
    }

    // A vertex of the boundary into ruler_, with those that lie between the one before and it: past parts that no
    // leaf crosses.  ahead: the line runs with the front on its left; round: once round, if it is the same vertex.
    // Other vertices are left out.
    Done push_on_boundary(double v, uint32_t vertex, bool ahead, bool round = false) {
        const Reflection& mirror = *front_->reflection;
        if (!mirror.is_boundary[vertex]) return true;
        const auto side_at = [&](uint32_t w) { // the half-edge along the boundary, in front
            uint32_t h = f_.mesh.out[w];
            while (!mirror.on_boundary(h) || !mirror.is_front[h]) h = f_.mesh.rotate_ccw(h);
            return h;
        };
        const auto side_before = [&](uint32_t w) { // the one that ends there
            uint32_t h = f_.mesh.out[w];
            while (!mirror.on_boundary(h) || mirror.is_front[h]) h = f_.mesh.rotate_ccw(h);
            return twin(h);
        };
        const auto at = [&](uint32_t w) { return position_ + size_t{3} * w; };
        const double before = ruler_.v.empty() ? v : ruler_.v.back();
        const auto walk = [&](double whole, double& length) -> Done {
            length = 0;
            bool first = round;
            for (uint32_t w = last_on_boundary_; w != vertex || first;) {
                first = false;
                const uint32_t h = ahead ? side_at(w) : side_before(w);
                const uint32_t next = ahead ? f_.mesh.target(h) : f_.mesh.origin[h];
                length += distance(at(w), at(next));
                w = next;
                if (whole > 0 && w != vertex
                    && !ruler_.push(before + (v - before) * (length / whole), at(w), side_at(w)))
                    return false;
            }
            return true;
        };
        double whole = 0, length = 0;
        if (!ruler_.v.empty() && (!walk(0, whole) || !walk(whole, length))) return false;
        last_on_boundary_ = vertex;
        return ruler_.push(v, at(vertex), side_at(vertex));
    }

    // Points that divide an arc, seen from this side.
    Done place_arc(uint32_t a) {
        const ArcSide& arc = graph_.arcs[a];
        const bool on_boundary = front_ && front_->arc_mirror[a] == arc.twin;
        double p[3];
        ruler_.clear();
        uint32_t side = zero_point(graph_.sectors[arc.from].zero, p);
        if (tripod(arc.from) && !ruler_.push(arc_from_[a], p, side)) return false;
        const uint64_t last = arc.last - tripod(arc.to);
        if (on_boundary) {
            const uint32_t from = graph_.zeros[graph_.sectors[arc.from].zero].element,
                           to = graph_.zeros[graph_.sectors[arc.to].zero].element;
            bool left = from != to; // else the arc goes round the whole curve
            if (!push_on_boundary(v_[arc.first], from, false)) return false;
            for (uint64_t i = arc.first + 1; i < last; ++i) {
                const uint32_t w = f_.mesh.target(graph_.crossings[i].half_edge);
                left = left || (front_->reflection->is_boundary[w] && w != from);
                if (!push_on_boundary(v_[i], w, false)) return false;
            }
            if (!push_on_boundary(v_[last], to, false, !left)) return false;
        }
        for (uint64_t i = arc.first; i <= last && !on_boundary; ++i)
            if (!push_crossing(i)) return false;
        side = zero_point(graph_.sectors[arc.to].zero, p);
        if (tripod(arc.to) && !ruler_.push(arc_to_[a], p, side)) return false;
        arc_vertex_[a] = arc_vertex_[arc.twin] = out_.vertex_count();
        along_[a] = 1;
        along_[arc.twin] = 0;
        const int64_t n = columns_[a];
        for (int64_t i = first_point(a); i <= last_point(a); ++i) {
            side = ruler_.point(on_arc(a, i), p);
            if (!add_vertex(p, side)) return false;
            if (on_boundary || (is_half(a) && 2 * i == n)) out_.held.back() = AT_BOUNDARY;
        }
        return true;
    }

    // The points within an arc that lie in front.
    int64_t first_point(uint32_t a) const { return part_of_arc(a) == Part::second_half ? columns_[a] / 2 : 1; }
    int64_t last_point(uint32_t a) const {
        return part_of_arc(a) == Part::first_half ? columns_[a] / 2 : columns_[a] - 1;
    }
    // The vertex at a point of an arc, NONE behind.
    uint32_t vertex_on_arc(uint32_t a, int64_t i) const {
        if (i == 0) return zero_vertex_[graph_.sectors[graph_.arcs[a].from].zero];
        const uint32_t seen = along_[a] ? a : graph_.arcs[a].twin;
        const int64_t k = seen == a ? i : columns_[a] - i;
        if (part_of_arc(a) == Part::back || k < first_point(seen) || k > last_point(seen)) return NONE;
        return arc_vertex_[a] + static_cast<uint32_t>(k - first_point(seen));
    }

    // v on its boundary leaf of the i-th point of an arc; one across the boundary is divided there.
    double on_arc(uint32_t a, int64_t i) const {
        const int64_t n = columns_[a];
        if (is_half(a) && n > 0) {
            const double middle = v_[front_->arc_middle[a]], half = static_cast<double>(n / 2);
            if (2 * i == n) return middle;
            return 2 * i < n ? arc_from_[a] + (middle - arc_from_[a]) * static_cast<double>(i) / half
                             : middle + (arc_to_[a] - middle) * static_cast<double>(i - n / 2) / half;
        }
        return arc_from_[a] + (arc_to_[a] - arc_from_[a]) * static_cast<double>(i) / static_cast<double>(n);
    }

    // Without a zero: the closed leaf that counts as critical.
    Done place_ring() {
        const Boundary& b = graph_.boundaries[0];
        ruler_.clear();
        for (uint64_t i = b.begin; i < b.end; ++i)
            if (!push_crossing(i)) return false;
        const int64_t n = ring_;
        for (int64_t i = 0; i < n; ++i) {
            double p[3];
            const uint32_t side = ruler_.point(v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(n), p);
            if (!add_vertex(p, side)) return false;
        }
        return true;
    }

    Done read_row(uint32_t boundary, Row& row) {
        row.vertex.clear();
        row.v.clear();
        const Boundary& b = graph_.boundaries[boundary];
        if (graph_.zeros.empty()) {
            // The other side runs backwards from the same point.
            const int64_t n = ring_;
            for (int64_t i = 0; i < n; ++i)
                if (!row.vertex.push(static_cast<uint32_t>(boundary == 0 || i == 0 ? i : n - i))
                    || !row.v.push(v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(n)))
                    return false;
            return true;
        }
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
            for (int64_t i = 0; i < columns_[a]; ++i)
                if (!row.vertex.push(vertex_on_arc(a, i)) || !row.v.push(on_arc(a, i))) return false;
        }
        return true;
    }

    // v along the path across a cylinder up to each piece, and at its end; the
    // place where it arrives on the upper boundary leaf.
    Done read_path(const Cylinder& c) {
        twist_.start(call_.memory);
        double v = 0;
        for (uint64_t i = c.path_begin; i < c.path_end; ++i) {
            const Piece& p = cylinders_.pieces[i];
            if (!twist_.push(v)) return false;
            v += conjugate_.along(p.half_edge) * static_cast<double>(p.to - p.from)
               / static_cast<double>(width(f_, p.half_edge));
        }
        return twist_.push(v);
    }

    double twist_at(const Cylinder& c, uint64_t piece, int64_t height) const {
        const Piece& p = cylinders_.pieces[piece];
        const double t =
            p.to > p.from ? static_cast<double>(height - p.height) / static_cast<double>(p.to - p.from) : 0;
        const size_t i = static_cast<size_t>(piece - c.path_begin);
        return twist_[i] + t * (twist_[i + 1] - twist_[i]);
    }

    double arrival(const Cylinder& c) const {
        const Piece& p = cylinders_.pieces[c.path_end - 1];
        const Boundary& b = graph_.boundaries[c.upper];
        // The upper leaf crosses the last half-edge from its left to its right.
        for (uint64_t i = b.begin; i + 1 < b.end; ++i)
            if (graph_.crossings[i] == Crossing{p.half_edge, p.to}) return v_[i];
        return 0;
    }

    // Half units of row k above the lower side.
    int64_t height_of_row(uint32_t cylinder, int64_t k) const {
        const Cylinder& c = cylinders_.list[cylinder];
        const int64_t height = static_cast<int64_t>(2 * static_cast<double>(c.height) * static_cast<double>(k)
                                                    / static_cast<double>(rows_[cylinder]))
                             | 1;
        return std::min(height, 2 * c.height - 1);
    }

    // The leaf at a height into leaf_, with the piece of the path that it crosses.
    hmf_status find_leaf(uint32_t cylinder, int64_t height, uint64_t& piece) {
        const Crossing start = cylinders_.leaf_at(f_, cylinder, height, &piece);
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!closed_leaf(f_, start, graph_.crossing_limit(), leaf_))
            return call_.memory.failure()
                     ? call_.out_of_memory()
                     : call_.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0, "A leaf crosses too many edges.");
        return HMF_OK;
    }

    // The leaf at a height into ruler_, and v along the path up to it.  shift: it runs beside the boundary, which is
    // taken instead: 1 on its left, -1 on its right.
    hmf_status read_leaf_at(uint32_t cylinder, int64_t height, int64_t shift, double& twist) {
        uint64_t piece = 0;
        if (find_leaf(cylinder, height, piece)) return call_.status();
        ruler_.clear();
        double v = 0, p[3];
        for (size_t i = 0; i <= leaf_.size(); ++i) {
            const Crossing& at = leaf_[i < leaf_.size() ? i : 0];
            point_at(f_, position_, at, p);
            const uint32_t end = shift > 0 ? f_.mesh.target(at.half_edge) : f_.mesh.origin[at.half_edge];
            if (!(shift != 0 ? push_on_boundary(v, end, shift < 0) : ruler_.push(v, p, twin(at.half_edge))))
                return call_.out_of_memory();
            v += conjugate_.step(at);
        }
        if (ruler_.v.empty()) return torn(cylinder);
        twist = twist_at(cylinders_.list[cylinder], piece, height);
        return HMF_OK;
    }
    hmf_status read_leaf(uint32_t cylinder, int64_t k, double& twist) {
        return read_leaf_at(cylinder, height_of_row(cylinder, k), 0, twist);
    }

    // Turns the row in ruler_ so that straight columns from the row before meet it at right angles in the mean.
    template <class Low>
    void align_row(int64_t n, double& here, const Low& low) {
        const double round = ruler_.v.back();
        const auto at = [&](int64_t j, double shift, double* p) {
            double place = low(j) - here + shift;
            place -= std::floor(place);
            ruler_.point(place * round, p);
        };
        const double h = 0.25 / static_cast<double>(n);
        for (int tries = 0; tries < 3; ++tries) {
            double sum = 0;
            for (int64_t j = 0; j < n; ++j) {
                const double* from = &before_[static_cast<size_t>(3 * j)];
                double p[3], q[3], r[3], along = 0, square = 0;
                at(j, 0, p);
                at(j, -h, q);
                at(j, h, r);
                for (int x = 0; x < 3; ++x) {
                    along += (from[x] - p[x]) * (r[x] - q[x]);
                    square += (r[x] - q[x]) * (r[x] - q[x]);
                }
                // At most a column.
                const double off = square > 0 ? 2 * h * along / square : 0;
                sum += off > 4 * h ? 4 * h : off < -4 * h ? -4 * h : off;
            }
            here -= sum / static_cast<double>(n);
        }
        for (int64_t j = 0; j < n; ++j) at(j, 0, &before_[static_cast<size_t>(3 * j)]);
    }
    void start_before(int64_t n, const uint32_t* vertex) {
        for (int64_t j = 0; j < n; ++j)
            for (size_t k = 0; k < 3; ++k)
                before_[static_cast<size_t>(3 * j) + k] =
                    out_.positions[size_t{3} * vertex[static_cast<size_t>(j)] + k];
    }

    // Where the path meets each row, as a part of its length: at first by v along
    // the path; then each row is turned so that straight columns from the row
    // before meet it at right angles in the mean.  One path alone is at the mercy
    // of the thin triangles on it.
    template <class Low>
    hmf_status align_rows(uint32_t cylinder, double whole, double& turn, const Low& low) {
        const int64_t n = static_cast<int64_t>(lower_.vertex.size()), m = rows_[cylinder];
        if (!here_.allocate(call_.memory, static_cast<size_t>(m))
            || !before_.allocate(call_.memory, static_cast<size_t>(3 * n)))
            return call_.out_of_memory();
        double path_before = 0, here = 0;
        start_before(n, lower_.vertex.data());
        for (int64_t k = 1; k < m; ++k) {
            double path = 0;
            if (read_leaf(cylinder, k, path)) return call_.status();
            here += (path - path_before) / whole;
            path_before = path;
            align_row(n, here, low);
            here_[static_cast<size_t>(k)] = here;
        }
        turn = here + (twist_[twist_.size() - 1] - path_before) / whole;
        return HMF_OK;
    }

    hmf_status fill(uint32_t cylinder) {
        const Part part = part_of(cylinder);
        if (part == Part::back) return HMF_OK;
        if (part == Part::strip) return fill_strip(cylinder);
        if (part == Part::ring) return fill_ring(cylinder);
        return is_annulus() ? fill_annulus(cylinder) : fill_closed(cylinder);
    }

    hmf_status fill_closed(uint32_t cylinder) {
        const Cylinder& c = cylinders_.list[cylinder];
        if (!read_row(c.lower, lower_) || !read_row(c.upper, upper_) || !read_path(c)) return call_.out_of_memory();
        const int64_t n = static_cast<int64_t>(lower_.vertex.size()), m = rows_[cylinder];
        if (static_cast<int64_t>(upper_.vertex.size()) != n)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                              "The boundaries of a cylinder have different numbers of columns. Please report it.");
        const double lower_length = v_[graph_.boundaries[c.lower].end - 1],
                     upper_length = v_[graph_.boundaries[c.upper].end - 1];
        const double arrived = arrival(c);
        // The flat cylinder is as long as both are in the mean; places in parts of it.
        const double whole = (lower_length + upper_length) / 2;
        const auto low = [&](int64_t j) { return lower_.v[static_cast<size_t>(j)] / lower_length; };
        double turn = 0;
        if (align_rows(cylinder, whole, turn, low)) return call_.status();
        const auto high = [&](int64_t j) { // the upper leaf runs the other way; j of any size
            const int64_t wraps = j >= 0 ? j / n : -((n - 1 - j) / n);
            return turn + (arrived - upper_.v[static_cast<size_t>(j - wraps * n)]) / upper_length
                 - static_cast<double>(wraps);
        };
        double shift = 0;
        for (int64_t j = 0; j < n; ++j) shift += high(-j) - low(j);
        // One column on is a part 1 / n less.
        const int64_t offset = static_cast<int64_t>(std::floor(shift + 0.5));

        const uint32_t base = out_.vertex_count();
        for (int64_t k = 1; k < m; ++k) {
            const double y = static_cast<double>(k) / static_cast<double>(m);
            double twist = 0, p[3];
            if (read_leaf(cylinder, k, twist)) return call_.status();
            const double round = ruler_.v.back(), here = here_[static_cast<size_t>(k)];
            for (int64_t j = 0; j < n; ++j) {
                double place = (1 - y) * low(j) + y * high(offset - j) - here;
                place -= std::floor(place);
                const uint32_t side = ruler_.point(place * round, p);
                if (!add_vertex(p, side)) return call_.out_of_memory();
            }
        }
        const auto vertex = [&](int64_t k, int64_t j) {
            if (k == 0) return lower_.vertex[static_cast<size_t>(j % n)];
            if (k == m) return upper_.vertex[static_cast<size_t>(((offset - j) % n + n) % n)];
            return base + static_cast<uint32_t>((k - 1) * n + j % n);
        };
        // The cylinder lies right of its lower leaf.
        for (int64_t k = 0; k < m; ++k)
            for (int64_t j = 0; j < n; ++j)
                if (!out_.quads.push(vertex(k, j)) || !out_.quads.push(vertex(k + 1, j))
                    || !out_.quads.push(vertex(k + 1, j + 1)) || !out_.quads.push(vertex(k, j + 1)))
                    return call_.out_of_memory();
        return HMF_OK;
    }

    // Rows round a cylinder above one of n vertices, each aligned to the one before.  height, shift: of row k;
    // first: of row 0, low: places on it.  The last one lies on the boundary.
    template <class Height, class Shift, class Low>
    hmf_status stack_rows(uint32_t cylinder, const uint32_t* first, int64_t n, int64_t rows, double whole,
                          const Height& height, const Shift& shift, const Low& low) {
        if (!before_.allocate(call_.memory, static_cast<size_t>(3 * n))
            || !row_.allocate(call_.memory, 2 * static_cast<size_t>(n)))
            return call_.out_of_memory();
        start_before(n, first);
        for (int64_t j = 0; j < n; ++j) row_[static_cast<size_t>(j)] = first[static_cast<size_t>(j)];
        double path_before = 0, path = 0, here = 0, p[3];
        for (int64_t k = 1; k <= rows; ++k) {
            if (read_leaf_at(cylinder, height(k), shift(k), path)) return call_.status();
            if (k > 1 || !is_annulus()) here += (path - path_before) / whole;
            path_before = path;
            align_row(n, here, low);
            for (int64_t j = 0; j < n; ++j) {
                double place = low(j) - here;
                place -= std::floor(place);
                row_[static_cast<size_t>(n + j)] = out_.vertex_count();
                const uint32_t side = ruler_.point(place * ruler_.v.back(), p);
                if (!add_vertex(p, side)) return call_.out_of_memory();
                if (k == rows) out_.held.back() = AT_BOUNDARY;
            }
            const auto vertex = [&](bool above, int64_t j) {
                return row_[static_cast<size_t>((above ? n : 0) + j % n)];
            };
            for (int64_t j = 0; j < n; ++j)
                if (!push_quad(vertex(false, j), vertex(true, j), vertex(true, j + 1), vertex(false, j + 1)))
                    return call_.out_of_memory();
            for (int64_t j = 0; j < n; ++j) row_[static_cast<size_t>(j)] = row_[static_cast<size_t>(n + j)];
        }
        return HMF_OK;
    }
    Done push_quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        return out_.quads.push(a) && out_.quads.push(b) && out_.quads.push(c) && out_.quads.push(d);
    }

    // Up to the boundary curve in the middle, which is the last row.
    hmf_status fill_ring(uint32_t cylinder) {
        const Cylinder& c = cylinders_.list[cylinder];
        if (!read_row(c.lower, lower_) || !read_path(c)) return call_.out_of_memory();
        const double length = v_[graph_.boundaries[c.lower].end - 1];
        const int64_t half = rows_[cylinder] / 2;
        for (const uint32_t v : lower_.vertex)
            if (v == NONE) return torn(cylinder);
        return stack_rows(
            cylinder, lower_.vertex.data(), static_cast<int64_t>(lower_.vertex.size()), half, length,
            [&](int64_t k) { return k == half ? c.height - 1 : height_of_row(cylinder, k); },
            [&](int64_t k) { return k == half ? -1 : 0; },
            [&](int64_t j) { return lower_.v[static_cast<size_t>(j)] / length; });
    }

    // Between its two boundary curves, both leaves.
    hmf_status fill_annulus(uint32_t cylinder) {
        const Cylinder& c = cylinders_.list[cylinder];
        if (!read_path(c)) return call_.out_of_memory();
        int64_t from = -1, to = -1;
        for (uint64_t i = c.path_begin; i < c.path_end; ++i) {
            const Piece& p = cylinders_.pieces[i];
            if (p.from != 0 || !front_->reflection->is_boundary[f_.mesh.origin[p.half_edge]]) continue;
            const bool to_front =
                front_->reflection->is_front[p.half_edge] || front_->reflection->is_front[twin(p.half_edge)];
            if (to_front && from < 0) from = p.height;
            if (!to_front && from >= 0 && to < 0) to = p.height;
        }
        if (from < 0 || to < 0) return torn(cylinder);
        const int64_t n = ring_, rows = rows_[cylinder] / 2;
        double path = 0, p[3];
        if (read_leaf_at(cylinder, from + 1, 1, path)) return call_.status();
        const uint32_t first = out_.vertex_count();
        lower_.vertex.clear();
        for (int64_t j = 0; j < n; ++j) {
            if (!lower_.vertex.push(first + static_cast<uint32_t>(j))) return call_.out_of_memory();
            const uint32_t side = ruler_.point(ruler_.v.back() * static_cast<double>(j) / static_cast<double>(n), p);
            if (!add_vertex(p, side)) return call_.out_of_memory();
            out_.held.back() = AT_BOUNDARY;
        }
        return stack_rows(
            cylinder, lower_.vertex.data(), n, rows, ruler_.v.back(),
            [&](int64_t k) {
                const double t = static_cast<double>(k) / static_cast<double>(rows);
                return k == rows
                         ? to - 1
                         : static_cast<int64_t>(static_cast<double>(from) + t * static_cast<double>(to - from)) | 1;
            },
            [&](int64_t k) { return k == rows ? -1 : 0; },
            [&](int64_t j) { return static_cast<double>(j) / static_cast<double>(n); });
    }

    hmf_status torn(uint32_t cylinder) {
        return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, cylinder,
                          "The half of a cylinder in front has gaps. Please report it.");
    }

    // Of a boundary leaf that the boundary crosses twice the points in front, in the order of the leaf, with
    // places from 0 to 1.
    hmf_status read_front_row(uint32_t cylinder, uint32_t boundary, Row& row) {
        Row& all = all_;
        if (!read_row(boundary, all)) return call_.out_of_memory();
        const size_t n = all.vertex.size(), half = n / 2;
        const double round = v_[graph_.boundaries[boundary].end - 1];
        // Behind only zeros of the boundary have a vertex, and none of two in a row.
        size_t start = 0, found = 0;
        while (start < n && found <= half) {
            for (found = 0; found <= half && all.vertex[(start + found) % n] != NONE; ++found) {}
            start += found <= half;
        }
        if (found <= half || n % 2 != 0) return torn(cylinder);
        row.vertex.clear();
        row.v.clear();
        for (size_t j = 0; j <= half; ++j) {
            const size_t k = (start + j) % n;
            if (!row.vertex.push(all.vertex[k]) || !row.v.push(all.v[k] + (start + j >= n ? round : 0)))
                return call_.out_of_memory();
        }
        const double from = row.v[0], length = row.v[half] - from;
        for (double& v : row.v) v = length > 0 ? (v - from) / length : 0;
        return HMF_OK;
    }

    // The part of leaf_ in front into ruler_.
    hmf_status rule_front(uint32_t cylinder) {
        const size_t n = leaf_.size();
        size_t i = 0;
        while (i < n && !front_->crosses_to_front(leaf_[i])) ++i;
        if (i == n) return torn(cylinder);
        ruler_.clear();
        double v = 0, p[3];
        for (size_t k = 0; k < n; ++k, ++i) {
            const Crossing& at = leaf_[i % n];
            point_at(f_, position_, at, p);
            const bool ends = front_->crosses_to_back(at);
            if (!ruler_.push(v, p, ends ? at.half_edge : twin(at.half_edge))) return call_.out_of_memory();
            if (ends) return HMF_OK;
            v += conjugate_.step(at);
        }
        return torn(cylinder);
    }

    // From the boundary to the boundary: a rectangle.
    hmf_status fill_strip(uint32_t cylinder) {
        const Cylinder& c = cylinders_.list[cylinder];
        const int64_t m = rows_[cylinder];
        double p[3];
        if (is_annulus()) {
            uint64_t piece = 0;
            const uint32_t first = out_.vertex_count();
            if (find_leaf(cylinder, 1, piece) || rule_front(cylinder)) return call_.status();
            lower_.vertex.clear();
            lower_.v.clear();
            upper_.vertex.clear();
            upper_.v.clear();
            const int64_t n = ring_ / 2;
            for (int64_t j = 0; j <= n; ++j) {
                const double t = static_cast<double>(j) / static_cast<double>(n);
                const uint32_t side = ruler_.point(t * ruler_.v.back(), p);
                if (!add_vertex(p, side) || !lower_.vertex.push(first + static_cast<uint32_t>(j)) || !lower_.v.push(t)
                    || !upper_.vertex.push(first + static_cast<uint32_t>(n - j)) || !upper_.v.push(t))
                    return call_.out_of_memory();
                if (j == 0 || j == n) out_.held.back() = AT_BOUNDARY;
            }
        } else if (read_front_row(cylinder, c.lower, lower_) || read_front_row(cylinder, c.upper, upper_))
            return call_.status();
        const int64_t n = static_cast<int64_t>(lower_.vertex.size()) - 1;
        if (static_cast<int64_t>(upper_.vertex.size()) != n + 1) return torn(cylinder);
        const uint32_t base = out_.vertex_count();
        for (int64_t k = 1; k < m; ++k) {
            const double y = static_cast<double>(k) / static_cast<double>(m);
            uint64_t piece = 0;
            if (find_leaf(cylinder, height_of_row(cylinder, k), piece) || rule_front(cylinder)) return call_.status();
            for (int64_t j = 0; j <= n; ++j) {
                const double place =
                    (1 - y) * lower_.v[static_cast<size_t>(j)] + y * (1 - upper_.v[static_cast<size_t>(n - j)]);
                const uint32_t side = ruler_.point(place * ruler_.v.back(), p);
                if (!add_vertex(p, side)) return call_.out_of_memory();
                if (j == 0 || j == n) out_.held.back() = AT_BOUNDARY;
            }
        }
        const auto vertex = [&](int64_t k, int64_t j) {
            if (k == 0) return lower_.vertex[static_cast<size_t>(j)];
            if (k == m) return upper_.vertex[static_cast<size_t>(n - j)];
            return base + static_cast<uint32_t>((k - 1) * (n + 1) + j);
        };
        for (int64_t k = 0; k < m; ++k)
            for (int64_t j = 0; j < n; ++j)
                if (!push_quad(vertex(k, j), vertex(k + 1, j), vertex(k + 1, j + 1), vertex(k, j + 1)))
                    return call_.out_of_memory();
        return HMF_OK;
    }

    Foliation& f_;
    const double* position_;
    const Cylinders& cylinders_;
    const CriticalGraph& graph_;
    const FrontParts* front_;
    Conjugate conjugate_;
    QuadMesh& out_;
    Call& call_;
    Array<double> v_;                 // per crossing of the boundary leaves
    Array<double> arc_from_, arc_to_; // v of the ends of an arc on its boundary leaf
    Array<uint32_t> zero_vertex_;     // per zero
    Array<uint32_t> arc_vertex_;      // first vertex within an arc
    Array<uint8_t> along_;            // per side of an arc: its points were placed from this side
    Array<uint32_t> joined_;          // per zero: the lowest one it is joined to
    QuadSizes sizes_;
    Array<int64_t> columns_, rows_; // of the sizes; of a double symmetric
    int64_t ring_ = 0;
    Ruler ruler_;
    Array<Crossing> leaf_;
    Array<double> twist_;         // v along the path across a cylinder, per piece
    Array<double> here_, before_; // per row: where the path meets it; points of the row before
    Row lower_, upper_, all_;
    uint32_t last_on_boundary_ = NONE;
    Array<uint32_t> row_; // two rows of vertices
};

} // namespace

hmf_status make_quads(Foliation& f, const double* position, const Cylinders& cylinders, const FrontParts* front,
                      const QuadWish& wish, QuadMesh& out, Call& call) {
    return QuadBuilder(f, position, cylinders, front, out, call).run(wish);
}

hmf_status flat_metric(const Foliation& f, const double* position, const Cylinders& cylinders, FlatMetric& out,
                       Call& call) {
    const Conjugate conjugate(f, position);
    out = {};
    Curves middle;
    if (middle_leaves(f, cylinders, nullptr, middle, call)) return call.status();
    for (size_t c = 0; c < cylinders.list.size(); ++c) {
        double v = 0;
        for (uint64_t i = middle.offsets[c]; i < middle.offsets[c + 1]; ++i) v += conjugate.step(middle.crossings[i]);
        out.flat_area += v * static_cast<double>(cylinders.list[c].height);
    }
    out.area = surface_area(f.mesh, position, call.parallel);
    return HMF_OK;
}

} // namespace hmf
