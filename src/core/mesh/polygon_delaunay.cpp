#include "polygon_delaunay.hpp"

#include "../base/random_word.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Of the sum of two cotangents: rounding decides for neither diagonal.
constexpr double POLYGON_TOLERANCE = -1e-12;

} // namespace

Done PolygonDelaunay::triangulate(Memory& memory, const PlanePoint* corner, uint32_t count) {
    valid_ = false;
    point_ = corner;
    corner_.start(memory);
    across_.start(memory);
    waiting_.start(memory);
    const size_t sides = 3 * (size_t{count} - 2);
    if (!corner_.reserve(sides) || !across_.reserve(sides) || !waiting_.reserve(sides) || !hull_.allocate(memory, count)
        || !next_.allocate(memory, count) || !previous_.allocate(memory, count) || !order_.allocate(memory, count))
        return false;
    if (!choose_first(corner, count)) return true;
    uint32_t rest = 0;
    for (uint32_t c = 0; c < count; ++c) {
        next_[c] = c + 1 < count ? c + 1 : 0;
        previous_[c] = c > 0 ? c - 1 : count - 1;
        if (c != first_[0] && c != first_[1] && c != first_[2]) order_[rest++] = c;
    }
    uint64_t seed = count;
    for (uint32_t i = rest; i-- > 1;) std::swap(order_[i], order_[random_word(seed) % (i + 1)]);
    // A removed corner keeps its neighbors of that moment.
    for (uint32_t i = 0; i < rest; ++i) {
        const uint32_t c = order_[i];
        next_[previous_[c]] = next_[c];
        previous_[next_[c]] = previous_[c];
    }
    add_triangle(first_[0], first_[1], first_[2]);
    for (uint32_t s = 0; s < 3; ++s) set_across(s, OUTSIDE);
    for (uint32_t i = rest; i-- > 0;) insert(order_[i]);
    valid_ = true;
    for (uint32_t side = 0; side < corner_.size(); side += 3) {
        const PlanePoint& a = point_[corner_[side]];
        valid_ &= cross(point_[corner_[side + 1]] - a, point_[corner_[side + 2]] - a).high > 0;
    }
    return true;
}

// The corner farthest from the first one, and the corner farthest from the line through both.
bool PolygonDelaunay::choose_first(const PlanePoint* corner, uint32_t count) {
    uint32_t far = 0, third = 0;
    double most = 0, widest = 0;
    for (uint32_t c = 1; c < count; ++c) {
        const PlanePoint u = corner[c] - corner[0];
        const double square = dot(u, u).high;
        if (square > most) {
            most = square;
            far = c;
        }
    }
    const PlanePoint axis = corner[far] - corner[0];
    for (uint32_t c = 1; c < count; ++c) {
        const double area = cross(axis, corner[c] - corner[0]).high, width = area < 0 ? -area : area;
        if (width > widest) {
            widest = width;
            third = c;
        }
    }
    first_[0] = 0;
    first_[1] = std::min(far, third);
    first_[2] = std::max(far, third);
    return widest > 0 && cross(corner[first_[1]] - corner[0], corner[first_[2]] - corner[0]).high > 0;
}

void PolygonDelaunay::add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    for (const uint32_t x : {a, b, c}) {
        corner_.add(x);
        across_.add(OUTSIDE);
    }
}

void PolygonDelaunay::set_across(uint32_t side, uint32_t other) {
    across_[side] = other;
    if (other == OUTSIDE) hull_[corner_[side]] = side;
    else across_[other] = side;
}

void PolygonDelaunay::insert(uint32_t q) {
    const uint32_t a = previous_[q], b = next_[q], inner = hull_[a], t = static_cast<uint32_t>(corner_.size());
    next_[a] = q;
    previous_[b] = q;
    add_triangle(a, q, b);
    set_across(t, OUTSIDE);
    set_across(t + 1, OUTSIDE);
    set_across(t + 2, inner);
    waiting_.clear();
    waiting_.add(t + 2);
    while (!waiting_.empty()) {
        const uint32_t side = waiting_.back();
        waiting_.pop();
        if (across_[side] == OUTSIDE || !should_flip(side)) continue;
        const uint32_t other = across_[side];
        flip(side);
        // The sides opposite to q in both triangles.
        waiting_.add(side / 3 * 3 + 1);
        waiting_.add(other / 3 * 3 + 1);
    }
}

bool PolygonDelaunay::should_flip(uint32_t side) const {
    const PlanePoint &v = point_[begin(side)], &w = point_[begin(after(side))];
    const PlanePoint &q = point_[apex(side)], &x = point_[apex(across_[side])];
    const PlanePoint qv = v - q, qw = w - q, xv = v - x, xw = w - x;
    const double area_q = cross(qv, qw).high, area_x = cross(xw, xv).high;
    if (!(area_q > 0 && area_x > 0)) return true;
    return dot(qv, qw).high / area_q + dot(xw, xv).high / area_x < POLYGON_TOLERANCE;
}

//        w                    w
//       /|\                  / \              side: v -> w, its triangle is that of q
//      q | x       ->       q---x
//       \|/                  \ /
//        v                    v
void PolygonDelaunay::flip(uint32_t side) {
    const uint32_t other = across_[side], t = side / 3 * 3, u = other / 3 * 3;
    const uint32_t v = begin(side), w = begin(other), q = apex(side), x = apex(other);
    const uint32_t wq = across_[after(side)], qv = across_[after(after(side))];
    const uint32_t vx = across_[after(other)], xw = across_[after(after(other))];
    const uint32_t triangle[6] = {q, v, x, q, x, w};
    for (uint32_t s = 0; s < 3; ++s) {
        corner_[t + s] = triangle[s];
        corner_[u + s] = triangle[3 + s];
    }
    set_across(t, qv);
    set_across(t + 1, vx);
    set_across(t + 2, u);
    set_across(u + 1, xw);
    set_across(u + 2, wq);
}

} // namespace hmf
