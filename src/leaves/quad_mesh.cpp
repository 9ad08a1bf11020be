// Quads by cylinders.  Every cylinder is a grid of rows (leaves at equal
// distances) and columns; along the critical graph the grids share the points
// that divide its arcs.  So the mesh is closed, oriented and manifold whatever
// the numbers are, and a zero with k prongs has 2k edges, all others 4.  A marked
// vertex with one prong is left out, since two edges make poor quads:
//
//     x---b---y        x---b---y
//     |   |   |        |       |       one quad over the tip, with a and b, which
//     |   P   |   ->   |       |       lie on both sides of it, as corners; these
//     |  / \  |         \     /        have three edges then
//     a     a              a           (both sides of the arc are one)
//
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

#include "polyline.hpp"
#include "quad_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

struct Vector {
    double x, y, z;
};
Vector between(const double* a, const double* b) { return {b[0] - a[0], b[1] - a[1], b[2] - a[2]}; }
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double cross_length(const Vector& a, const Vector& b) {
    const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
    return std::sqrt(x * x + y * y + z * z);
}

class Conjugate {
public:
    Conjugate(const Foliation& f, const double* position) : f_(f), position_(position) {}

    // Growth of v along a leaf from crossing c to the next one.  With t the
    // distance from the corner i that it turns round:
    //   |grad u| * length = t |F_ij ik - F_ik ij|^2 / (F_ij F_ik |ij x ik|)
    double step(const Crossing& c) const {
        const uint32_t k = twin(c.half_edge);
        const bool left = turns_left(f_, c);
        const uint32_t r = left ? k : f_.mesh.next[k];
        const double t = 0.5 * static_cast<double>(left ? width(f_, k) - c.at : c.at);
        const double F = static_cast<double>(f_.at(r)), G = static_cast<double>(f_.at(f_.mesh.prev(r)));
        const Vector a = between(at(f_.mesh.origin[r]), at(f_.mesh.target(r)));
        const Vector b = between(at(f_.mesh.origin[r]), at(f_.mesh.origin[f_.mesh.prev(r)]));
        const double area = cross_length(a, b);
        const Vector d = {b.x / G - a.x / F, b.y / G - a.y / F, b.z / G - a.z / F};
        return area > 0 ? t * dot(d, d) * F * G / area : 0;
    }

    // Growth of v along a half-edge on which u grows: the mean of both triangles.
    double along(uint32_t h) const { return (in_face(h) + in_face(twin(h))) / 2; }

private:
    const double* at(uint32_t v) const { return position_ + size_t{3} * v; }

    // In the triangle left of h, where u is 0 at the origin, F at the target.
    double in_face(uint32_t h) const {
        const uint32_t p = f_.mesh.prev(h);
        const double F = static_cast<double>(f_.at(h));
        const bool behind = branch(f_, h) == 0;
        const bool tripod = !behind && branch(f_, f_.mesh.next[h]) > 0 && branch(f_, p) > 0;
        // Of a third corner off the segment, the branch point.
        const double u = behind ? -static_cast<double>(f_.at(p))
                       : tripod ? 0.5 * static_cast<double>(branch(f_, h))
                                : static_cast<double>(f_.at(p));
        const Vector a = between(at(f_.mesh.origin[h]), at(f_.mesh.target(h)));
        const Vector b = between(at(f_.mesh.origin[h]), at(f_.mesh.origin[p]));
        const double area = cross_length(a, b);
        return area > 0 ? (F * dot(a, b) - u * dot(a, a)) / area : 0;
    }

    const Foliation& f_;
    const double* position_;
};

// A polyline with v along it, for points at given v.
struct Ruler {
    Array<double> v, points;
    void start(Memory& memory) {
        v.start(memory);
        points.start(memory);
    }
    void clear() {
        v.clear();
        points.clear();
    }
    Done push(double value, const double* p) {
        return v.push(value) && points.push(p[0]) && points.push(p[1]) && points.push(p[2]);
    }
    void point(double value, double* p) const {
        size_t low = 0, high = v.size() - 1; // between the last one not above and the next
        while (high - low > 1) {
            const size_t middle = low + (high - low) / 2;
            if (v[middle] <= value) low = middle;
            else high = middle;
        }
        const double length = v[high] - v[low];
        double t = length > 0 ? (value - v[low]) / length : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        for (size_t k = 0; k < 3; ++k) p[k] = points[3 * low + k] + t * (points[3 * high + k] - points[3 * low + k]);
    }
};

class QuadBuilder {
public:
    QuadBuilder(Foliation& f, const double* position, const Cylinders& cylinders, QuadMesh& out, Call& call) :
        f_(f), position_(position), cylinders_(cylinders), graph_(cylinders.graph), conjugate_(f, position), out_(out),
        call_(call) {}

    hmf_status run(double step) {
        Memory& memory = call_.memory;
        const size_t arcs = graph_.arcs.size(), boundaries = graph_.boundaries.size();
        out_.positions.start(memory);
        out_.quads.start(memory);
        ruler_.start(memory);
        leaf_.start(memory);
        leads_.start(memory);
        lower_.vertex.start(memory);
        lower_.v.start(memory);
        upper_.vertex.start(memory);
        upper_.v.start(memory);
        if (!v_.allocate(memory, graph_.crossings.size()) || !arc_from_.allocate(memory, arcs)
            || !arc_to_.allocate(memory, arcs) || !arc_vertex_.allocate(memory, arcs)
            || !length_.allocate(memory, arcs))
            return call_.out_of_memory();
        if (refuse_wide_zeros()) return call_.status();
        for (uint32_t b = 0; b < boundaries; ++b) measure(graph_.boundaries[b]);
        for (size_t a = 0; a < arcs; ++a) length_[a] = arc_to_[a] - arc_from_[a];
        if (!call_.tick(0)) return call_.was_cancelled();
        if (quad_sizes(cylinders_, length_, step, columns_, rows_, call_)) return call_.status();
        if (join_zeros()) return call_.status();
        if (!place_zeros()) return call_.out_of_memory();
        if (graph_.zeros.empty()) {
            const double wanted = std::floor(v_[graph_.boundaries[0].end - 1] / step + 0.5);
            ring_ = wanted < 3 ? 3 : wanted < (1 << 24) ? static_cast<int64_t>(wanted) : 0;
            if (ring_ == 0)
                return call_.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                                  "edge_length is too small for the surface. Choose a larger one.");
            if (!place_ring()) return call_.out_of_memory();
        } else
            for (uint32_t a = 0; a < arcs; ++a)
                if (a < graph_.arcs[a].twin && !place_arc(a)) return call_.out_of_memory();
        for (uint32_t c = 0; c < cylinders_.list.size(); ++c)
            if (fill(c)) return call_.status();
        return f_.mesh.marked_count == 0 || leave_tips_out() ? HMF_OK : call_.out_of_memory();
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
                                  "Zero %u goes round a part of the surface with a handle that no leaf crosses. Give "
                                  "loops for all handles.",
                                  static_cast<unsigned>(z));
        for (const Boundary& b : graph_.boundaries)
            if (b.arcs_begin == b.arcs_end && !graph_.zeros.empty())
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                                  "A leaf goes round several marked vertices at one place, which no leaf tells apart. "
                                  "Give loops between them.");
        return HMF_OK;
    }

    // Vertices with two quads.
    bool leave_tips_out() {
        const uint32_t n = vertex_count();
        const size_t quads = out_.quads.size() / 4;
        Array<uint32_t> uses, first, number;
        if (!uses.allocate_filled(call_.memory, n, 0u) || !first.allocate_filled(call_.memory, n, NONE)
            || !number.allocate(call_.memory, n))
            return false;
        for (const uint32_t v : out_.quads) ++uses[v];
        for (uint32_t v = 0; v < n; ++v) number[v] = uses[v] == 2 ? NONE : v;
        for (size_t q = 0; q < quads; ++q)
            for (size_t k = 0; k < 4; ++k) {
                uint32_t* const quad = &out_.quads[4 * q];
                const uint32_t v = quad[k];
                if (v == NONE || number[v] != NONE) continue;
                if (first[v] == NONE) {
                    first[v] = static_cast<uint32_t>(q);
                    continue;
                }
                uint32_t* const other = &out_.quads[4 * size_t{first[v]}];
                size_t at = 0;
                while (other[at] != v) ++at;
                // From v: b, x, a in the other one, a, y, b here.
                const uint32_t b = other[(at + 1) % 4], a = quad[(k + 1) % 4], y = quad[(k + 2) % 4];
                const bool fits = quad[(k + 3) % 4] == b && other[(at + 3) % 4] == a && other[(at + 2) % 4] != y
                               && uses[a] > 3 && uses[b] > 3;
                if (!fits) {
                    number[v] = v;
                    continue;
                }
                --uses[a];
                --uses[b];
                other[at] = y;
                for (size_t i = 0; i < 4; ++i) quad[i] = NONE;
                break;
            }
        uint32_t kept = 0;
        for (uint32_t v = 0; v < n; ++v) {
            if (number[v] == NONE) continue;
            for (size_t c = 0; c < 3; ++c) out_.positions[size_t{3} * kept + c] = out_.positions[size_t{3} * v + c];
            number[v] = kept++;
        }
        while (out_.positions.size() > size_t{3} * kept) out_.positions.pop();
        size_t to = 0;
        for (size_t i = 0; i < 4 * quads; ++i)
            if (out_.quads[i] != NONE) out_.quads[to++] = number[out_.quads[i]];
        while (out_.quads.size() > to) out_.quads.pop();
        return true;
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
    uint32_t vertex_count() const { return static_cast<uint32_t>(out_.positions.size() / 3); }
    Done add_vertex(const double* p) {
        return out_.positions.push(p[0]) && out_.positions.push(p[1]) && out_.positions.push(p[2]);
    }

    void zero_point(uint32_t zero, double* p) const {
        const Zero& z = graph_.zeros[zero];
        if (z.tripod) middle_of_tripod(f_, position_, z.element, p);
        else
            for (size_t k = 0; k < 3; ++k) p[k] = position_[size_t{3} * z.element + k];
    }

    // Zeros at the ends of an arc without columns get the same vertex.
    hmf_status join_zeros() {
        const uint32_t n = static_cast<uint32_t>(graph_.zeros.size());
        if (!zero_vertex_.allocate(call_.memory, n)) return call_.out_of_memory();
        for (uint32_t z = 0; z < n; ++z) zero_vertex_[z] = z;
        const auto lead = [&](uint32_t z) {
            while (zero_vertex_[z] != z) z = zero_vertex_[z];
            return z;
        };
        const auto refuse = [&] {
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_OPTION, 0,
                              "The cylinders cannot be matched with quads of this size. Choose a smaller edge_length.");
        };
        for (uint32_t a = 0; a < graph_.arcs.size(); ++a) {
            if (columns_[a] != 0 || a > graph_.arcs[a].twin) continue;
            const uint32_t x = lead(graph_.sectors[graph_.arcs[a].from].zero),
                           y = lead(graph_.sectors[graph_.arcs[a].to].zero);
            if (x == y) return refuse(); // a circle would vanish
            zero_vertex_[x > y ? x : y] = x > y ? y : x;
        }
        // No two edges with the same ends.
        for (uint32_t a = 0; a < graph_.arcs.size(); ++a) {
            const uint32_t x = lead(graph_.sectors[graph_.arcs[a].from].zero),
                           y = lead(graph_.sectors[graph_.arcs[a].to].zero);
            if (columns_[a] > 0 && columns_[a] < 3 && x == y) return refuse();
            for (uint32_t b = 0; columns_[a] == 1 && b < a; ++b) {
                if (columns_[b] != 1 || b == graph_.arcs[a].twin) continue;
                const uint32_t u = lead(graph_.sectors[graph_.arcs[b].from].zero),
                               v = lead(graph_.sectors[graph_.arcs[b].to].zero);
                if ((u == x && v == y) || (u == y && v == x)) return refuse();
            }
        }
        uint32_t next = 0;
        for (uint32_t z = 0; z < n; ++z) {
            if (zero_vertex_[z] != z) {
                zero_vertex_[z] = zero_vertex_[zero_vertex_[z]]; // which lies before it
            } else {
                if (!leads_.push(z)) return call_.out_of_memory();
                zero_vertex_[z] = next++;
            }
        }
        return HMF_OK;
    }

    Done place_zeros() {
        for (uint32_t z : leads_) {
            double p[3];
            zero_point(z, p);
            if (!add_vertex(p)) return false;
        }
        return true;
    }

    Done push_crossing(uint64_t i) {
        double p[3];
        point_at(f_, position_, {graph_.crossings[i].half_edge, graph_.crossings[i].at + 1}, p);
        return ruler_.push(v_[i], p);
    }

    // Points that divide an arc, seen from its first side.
    Done place_arc(uint32_t a) {
        const ArcSide& arc = graph_.arcs[a];
        double p[3];
        ruler_.clear();
        zero_point(graph_.sectors[arc.from].zero, p);
        if (tripod(arc.from) && !ruler_.push(arc_from_[a], p)) return false;
        const uint64_t last = arc.last - tripod(arc.to);
        for (uint64_t i = arc.first; i <= last; ++i)
            if (!push_crossing(i)) return false;
        zero_point(graph_.sectors[arc.to].zero, p);
        if (tripod(arc.to) && !ruler_.push(arc_to_[a], p)) return false;
        arc_vertex_[a] = arc_vertex_[arc.twin] = vertex_count();
        const int64_t n = columns_[a];
        for (int64_t i = 1; i < n; ++i) {
            ruler_.point(arc_from_[a] + length_[a] * static_cast<double>(i) / static_cast<double>(n), p);
            if (!add_vertex(p)) return false;
        }
        return true;
    }

    // Without a zero: the closed leaf that counts as critical.
    Done place_ring() {
        const Boundary& b = graph_.boundaries[0];
        ruler_.clear();
        for (uint64_t i = b.begin; i < b.end; ++i)
            if (!push_crossing(i)) return false;
        for (int64_t i = 0; i < ring_; ++i) {
            double p[3];
            ruler_.point(v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(ring_), p);
            if (!add_vertex(p)) return false;
        }
        return true;
    }

    Done read_row(uint32_t boundary, Row& row) {
        row.vertex.clear();
        row.v.clear();
        const Boundary& b = graph_.boundaries[boundary];
        if (graph_.zeros.empty()) {
            // The other side runs backwards from the same point.
            for (int64_t i = 0; i < ring_; ++i)
                if (!row.vertex.push(static_cast<uint32_t>(boundary == 0 || i == 0 ? i : ring_ - i))
                    || !row.v.push(v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(ring_)))
                    return false;
            return true;
        }
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
            const int64_t n = columns_[a];
            const bool first = a < graph_.arcs[a].twin;
            for (int64_t i = 0; i < n; ++i) {
                const uint32_t vertex = i == 0 ? zero_vertex_[graph_.sectors[graph_.arcs[a].from].zero]
                                               : arc_vertex_[a] + static_cast<uint32_t>((first ? i : n - i) - 1);
                if (!row.vertex.push(vertex)
                    || !row.v.push(arc_from_[a] + length_[a] * static_cast<double>(i) / static_cast<double>(n)))
                    return false;
            }
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

    // The leaf of row k into ruler_, and v along the path up to it.
    hmf_status read_leaf(uint32_t cylinder, int64_t k, double& twist) {
        const Cylinder& c = cylinders_.list[cylinder];
        const int64_t most = 2 * c.height - 1;
        int64_t height = static_cast<int64_t>(2 * static_cast<double>(c.height) * static_cast<double>(k)
                                              / static_cast<double>(rows_[cylinder]))
                       | 1;
        height = std::min(height, most);
        uint64_t piece = 0;
        const Crossing start = cylinders_.leaf_at(f_, cylinder, height, &piece);
        if (!call_.tick(0)) return call_.was_cancelled();
        if (!closed_leaf(f_, start, graph_.crossing_limit(), leaf_))
            return call_.memory.failure()
                     ? call_.out_of_memory()
                     : call_.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0, "A leaf crosses too many edges.");
        ruler_.clear();
        double v = 0, p[3];
        for (size_t i = 0; i <= leaf_.size(); ++i) {
            const Crossing& at = leaf_[i < leaf_.size() ? i : 0];
            point_at(f_, position_, at, p);
            if (!ruler_.push(v, p)) return call_.out_of_memory();
            v += conjugate_.step(at);
        }
        twist = twist_at(c, piece, height);
        return HMF_OK;
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
        for (int64_t j = 0; j < n; ++j)
            for (size_t k = 0; k < 3; ++k)
                before_[static_cast<size_t>(3 * j) + k] =
                    out_.positions[size_t{3} * lower_.vertex[static_cast<size_t>(j)] + k];
        for (int64_t k = 1; k < m; ++k) {
            double path = 0;
            if (read_leaf(cylinder, k, path)) return call_.status();
            const double round = ruler_.v.back();
            here += (path - path_before) / whole;
            path_before = path;
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
            here_[static_cast<size_t>(k)] = here;
            for (int64_t j = 0; j < n; ++j) at(j, 0, &before_[static_cast<size_t>(3 * j)]);
        }
        turn = here + (twist_[twist_.size() - 1] - path_before) / whole;
        return HMF_OK;
    }

    hmf_status fill(uint32_t cylinder) {
        const Cylinder& c = cylinders_.list[cylinder];
        if (!read_row(c.lower, lower_) || !read_row(c.upper, upper_) || !read_path(c)) return call_.out_of_memory();
        const int64_t n = static_cast<int64_t>(lower_.vertex.size()), m = rows_[cylinder];
        if (n < 3)
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_OPTION, 0,
                              "A cylinder would have less than 3 columns. Choose a smaller edge_length.");
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

        const uint32_t base = vertex_count();
        for (int64_t k = 1; k < m; ++k) {
            const double y = static_cast<double>(k) / static_cast<double>(m);
            double twist = 0, p[3];
            if (read_leaf(cylinder, k, twist)) return call_.status();
            const double round = ruler_.v.back(), here = here_[static_cast<size_t>(k)];
            for (int64_t j = 0; j < n; ++j) {
                double place = (1 - y) * low(j) + y * high(offset - j) - here;
                place -= std::floor(place);
                ruler_.point(place * round, p);
                if (!add_vertex(p)) return call_.out_of_memory();
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

    Foliation& f_;
    const double* position_;
    const Cylinders& cylinders_;
    const CriticalGraph& graph_;
    Conjugate conjugate_;
    QuadMesh& out_;
    Call& call_;
    Array<double> v_;                 // per crossing of the boundary leaves
    Array<double> arc_from_, arc_to_; // v of the ends of an arc on its boundary leaf
    Array<double> length_;
    Array<uint32_t> zero_vertex_; // per zero
    Array<uint32_t> leads_;       // zeros that have a vertex of their own
    Array<uint32_t> arc_vertex_;  // first vertex within an arc
    Array<int64_t> columns_, rows_;
    int64_t ring_ = 0;
    Ruler ruler_;
    Array<Crossing> leaf_;
    Array<double> twist_;         // v along the path across a cylinder, per piece
    Array<double> here_, before_; // per row: where the path meets it; points of the row before
    Row lower_, upper_;
};

} // namespace

hmf_status make_quads(Foliation& f, const double* position, const Cylinders& cylinders, double step, QuadMesh& out,
                      Call& call) {
    return QuadBuilder(f, position, cylinders, out, call).run(step);
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
    out.area = surface_area(f.mesh, position);
    return HMF_OK;
}

} // namespace hmf
