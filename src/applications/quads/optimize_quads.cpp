// Vertex by vertex goes down in the sum of the energies of the corners of its quads (corner_energy.hpp), each by a step
// of Newton's method in the plane that touches the surface, put back on the surface and shortened until the sum is less
// and no corner that was not folded is.  Lengths are those in space and only areas are seen along the normal of the
// surface, so that a quad across a ridge stays a square.  To the sum belongs
//
//     - growth |area| / mean area         quads cover as much as they can: vertices go to ridges, not beside them
#include "optimize_quads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corner_energy.hpp"
#include "quad_figures.hpp"
#include "quad_numbers.hpp"
#include "surface_lines.hpp"
#include "surface_walk.hpp"

namespace hmf {

namespace {

constexpr uint32_t SLICE = 256; // vertices between ticks
constexpr uint8_t UNKNOWN = 2;  // whether a quad is folded

// The corners of a quad from v on.
struct Around {
    uint32_t corner[4];
    Point p[4];

    Around(const QuadMesh& quads, uint32_t q, uint32_t v) {
        const uint32_t* const c = &quads.quads[4 * size_t{q}];
        size_t k = 0;
        while (k < 3 && c[k] != v) ++k;
        for (size_t i = 0; i < 4; ++i) {
            corner[i] = c[(k + i) % 4];
            p[i] = at(quads, corner[i]);
        }
    }
    Point diagonals() const { return cross(p[2] - p[0], p[3] - p[1]); } // twice the area
};

} // namespace

hmf_status QuadOptimizer::start() {
    const uint32_t n = quads_.vertex_count();
    Memory& memory = call_.memory;
    if (!stars_.build(quads_, memory) || !normals_.build(mesh_, position_, memory) || !normal_.allocate(memory, n)
        || !awake_.allocate(memory, n) || !target_.allocate(memory, quads_.quad_count())
        || !weight_.allocate(memory, n))
        return call_.out_of_memory();
    size_t most = 0;
    for (uint32_t v = 0; v < n; ++v) most = std::max(most, static_cast<size_t>(stars_.end(v) - stars_.begin(v)));
    if (!before_.allocate(memory, 4 * most) || !after_.allocate(memory, 4 * most) || !around_.allocate(memory, most)
        || !folded_.allocate(memory, quads_.quad_count()))
        return call_.out_of_memory();
    look_again();
    return set_targets() ? HMF_OK : call_.stopped();
}

void QuadOptimizer::look_again() {
    for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
        normal_[v] = normals_.at(quads_.sides[v], at(quads_, v));
        awake_[v] = 1;
    }
    for (uint8_t& f : folded_) f = UNKNOWN;
}

// The target areas: the areas of the quads, smoothed over neighbors, to the power 3/4 relative to the mean of all.
Done QuadOptimizer::set_targets() {
    const uint32_t n = quads_.vertex_count();
    const size_t count = quads_.quad_count();
    Array<double> of_vertex;
    if (!of_vertex.allocate(call_.memory, n)) return false;
    double whole = 0, sum = 0;
    for (size_t q = 0; q < count; ++q) {
        const Point d = Around(quads_, static_cast<uint32_t>(q), quads_.quads[4 * q]).diagonals();
        target_[q] = 0.5 * length_of(d);
        whole += target_[q];
    }
    mean_ = whole / static_cast<double>(count);
    for (int round = 0; round < EVEN; ++round) {
        if (!call_.tick(0)) return false;
        for (uint32_t v = 0; v < n; ++v) {
            double mean = 0;
            for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) mean += target_[*q];
            of_vertex[v] = mean / static_cast<double>(stars_.end(v) - stars_.begin(v));
        }
        for (size_t q = 0; q < count; ++q) {
            target_[q] = 0;
            for (size_t k = 0; k < 4; ++k) target_[q] += 0.25 * of_vertex[quads_.quads[4 * q + k]];
        }
    }
    for (uint32_t v = 0; v < n; ++v) {
        double most = 0, bend = 0;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) {
            normal_of(&quads_.quads[size_t{4} * *q], &bend);
            most = std::max(most, bend);
        }
        weight_[v] = 1 + RIDGE * most;
    }
    for (double& t : target_) {
        const double root = std::sqrt(t / mean_);
        t = root * std::sqrt(root);
        sum += t;
    }
    for (double& t : target_) t *= whole / sum;
    return true;
}

// bend: 0 where the normals at the corners agree, up to 1 where they have no side in common.
Point QuadOptimizer::normal_of(const uint32_t* corner, double* bend) const {
    const Point sum = (normal_[corner[0]] + normal_[corner[1]]) + (normal_[corner[2]] + normal_[corner[3]]);
    if (bend) *bend = 1 - 0.25 * length_of(sum);
    return of_length_one(sum);
}

// Without axes only the energy.  areas: of each corner around v, relative to the target area.
QuadOptimizer::Slopes QuadOptimizer::slopes(uint32_t v, const Axes* axes, double* areas) const {
    Slopes sum;
    const auto add = [&](const CornerEnergy& c, const Point& by_s, const Point& by_a, const Point& by_c,
                         double per_area, double moving) {
        double f[2], t[2], sx[2], ax[2];
        for (int k = 0; k < 2; ++k) {
            const Point& axis = k == 0 ? axes->first : axes->second;
            sx[k] = per_area * dot(by_s, axis);
            ax[k] = per_area * dot(by_a, axis);
            t[k] = c.cot_c * per_area * dot(by_c, axis) + c.cot_a * ax[k];
            f[k] = c.by_s * sx[k] + c.by_a * ax[k] + c.by_c * t[k];
        }
        for (int k = 0; k < 2; ++k) sum.g[k] += f[k];
        for (int k = 0; k < 3; ++k) {
            const int i = k == 2, j = k > 0;
            sum.h[k] += c.sa * (sx[i] * ax[j] + sx[j] * ax[i]) + c.aa * ax[i] * ax[j] + 2 * ANGLE * t[i] * t[j]
                      + (k == 1 ? 0 : c.by_s * moving * per_area);
        }
    };
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) {
        const Around quad(quads_, *q, v);
        const Point n = normal_of(quad.corner);
        const double per_area = 1 / target_[*q];
        for (size_t k = 0; k < 4; ++k, ++areas) {
            const Point e = quad.p[(k + 1) % 4] - quad.p[k], b = quad.p[(k + 3) % 4] - quad.p[k];
            *areas = per_area * dot(cross(e, b), n);
            const CornerEnergy c =
                corner_energy(0.5 * per_area * (dot(e, e) + dot(b, b)), *areas, per_area * dot(e, b), eps_);
            sum.energy += c.value;
            if (!axes || k == 2) continue;
            if (k == 0) add(c, -1 * (e + b), cross(n, b - e), -1 * (e + b), per_area, 2);
            else if (k == 1) add(c, b, cross(n, e), e, per_area, 1);
            else add(c, e, cross(b, n), b, per_area, 1);
        }
        if (!(growth_ > 0)) continue;
        const Point d = quad.diagonals();
        const double length = length_of(d), weight = growth_ * weight_[v] / mean_ * (dot(d, n) > 0 ? 0.5 : -0.5);
        sum.energy -= weight * length;
        if (!axes || !(length > 0)) continue;
        const Point slope = (weight / length) * cross(quad.p[3] - quad.p[1], d);
        sum.g[0] += dot(slope, axes->first);
        sum.g[1] += dot(slope, axes->second);
    }
    return sum;
}

// On a line the first axis lies along it; else any two.
QuadOptimizer::Axes QuadOptimizer::axes_at(uint32_t v) const {
    if (can_slide(quads_.held[v])) {
        const uint32_t h = quads_.sides[v];
        return {of_length_one(point(position_, mesh_.target(h)) - point(position_, mesh_.origin[h])), {}};
    }
    const Point n = normal_[v];
    const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
    const Point other = x <= y && x <= z ? Point{1, 0, 0} : y <= z ? Point{0, 1, 0} : Point{0, 0, 1};
    const Point first = of_length_one(cross(n, other));
    return {first, cross(n, first)};
}

void QuadOptimizer::wake(uint32_t v) {
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q)
        for (size_t k = 0; k < 4; ++k) awake_[quads_.quads[4 * size_t{*q} + k]] = 1;
}

double QuadOptimizer::side_of(uint32_t v) const {
    double sum = 0;
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) sum += target_[*q];
    return std::sqrt(sum / static_cast<double>(stars_.end(v) - stars_.begin(v)));
}

// Whether v, and what is near it, has something to do after this.
bool QuadOptimizer::move(uint32_t v) {
    const Axes axes = axes_at(v);
    const Slopes s = slopes(v, &axes, before_.data());
    double step[2] = {0, 0};
    const double trace = s.h[0] + s.h[2];
    const bool slides = can_slide(quads_.held[v]);
    if (!(trace > 0) || !std::isfinite(s.energy)) return false;
    const double xx = s.h[0] + 1e-9 * trace, yy = s.h[2] + 1e-9 * trace, det = xx * yy - s.h[1] * s.h[1];
    if (slides) step[0] = -s.g[0] / xx;
    else if (det > 0) {
        step[0] = -(yy * s.g[0] - s.h[1] * s.g[1]) / det;
        step[1] = -(xx * s.g[1] - s.h[1] * s.g[0]) / det;
    } else
        for (int k = 0; k < 2; ++k) step[k] = -s.g[k] / trace;
    const double side = side_of(v), length = std::sqrt(step[0] * step[0] + step[1] * step[1]);
    if (!(length > STILL * side)) return false;
    const double most = LONGEST_STEP * side / STEPS[0];
    if (length > most)
        for (double& x : step) x *= most / length;
    const Point from = at(quads_, v), normal = normal_[v];
    const uint32_t h = quads_.sides[v];
    for (const uint32_t* q = stars_.begin(v); barrier_ && q != stars_.end(v); ++q) is_folded(*q);
    for (const double t : STEPS) {
        const double part[2] = {t * step[0], t * step[1]};
        if (!try_step(v, axes, part, s.energy)) {
            quads_.put(v, from, h);
            normal_[v] = normal;
            continue;
        }
        const Point way = at(quads_, v) - from;
        return dot(way, way) > STILL * STILL * side * side;
    }
    return false;
}

// After a step of v: whether no more of the quads around it are folded than before.
bool QuadOptimizer::folds_no_more(uint32_t v) {
    size_t before = 0, now = 0, k = 0;
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q, ++k) {
        around_[k] = find_folded(*q);
        now += around_[k];
        before += folded_[*q];
    }
    if (now > before) return false;
    k = 0;
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q, ++k) folded_[*q] = around_[k];
    return true;
}

bool QuadOptimizer::try_step(uint32_t v, const Axes& axes, const double* step, double before) {
    const Point off = step[0] * axes.first + step[1] * axes.second, to = at(quads_, v) + off;
    Point there;
    uint32_t side = quads_.sides[v];
    if (quads_.held[v] == AT_BOUNDARY) side = slide_along_rim(mesh_, position_, side, at(quads_, v), step[0], there);
    else if (quads_.held[v] == ON_CREASE)
        side = slide_along_sharp_edges(mesh_, position_, side, at(quads_, v), step[0], there);
    else side = walk_to_nearest(mesh_, position_, side, to, there);
    const Point jump = there - to;
    if (quads_.held[v] == 0 && dot(jump, jump) > dot(off, off)) return false;
    quads_.put(v, there, side);
    normal_[v] = normals_.at(side, there);
    if (!(slopes(v, nullptr, after_.data()).energy < before)) return false;
    const size_t count = 4 * static_cast<size_t>(stars_.end(v) - stars_.begin(v));
    for (size_t k = 0; barrier_ && k < count; ++k)
        if (!(after_[k] > 0) && !(after_[k] >= before_[k])) return false;
    if (barrier_) return folds_no_more(v);
    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) folded_[*q] = UNKNOWN;
    return true;
}

Done QuadOptimizer::sweep(bool forward, double& moved) {
    const uint32_t n = quads_.vertex_count();
    size_t steps = 0;
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t v = forward ? i : n - 1 - i;
        if (i % SLICE == 0 && !call_.tick(0)) return false;
        if (!awake_[v] || is_fixed(v) || (!region_.empty() && !region_[v])) continue;
        awake_[v] = 0;
        if (!move(v)) continue;
        wake(v);
        ++steps;
    }
    moved = static_cast<double>(steps);
    return true;
}

hmf_status QuadOptimizer::shape(int sweeps) {
    eps_ = EPS;
    growth_ = GROWTH;
    barrier_ = true;
    region_.clear();
    if (!set_targets()) return call_.stopped();
    double moved = 1;
    for (int k = 0; k < sweeps && moved > 0; ++k)
        if (!sweep(k % 2 == 0, moved)) return call_.was_cancelled();
    return HMF_OK;
}

// As it is counted (quad_figures.hpp), but only a quad that looks against the surface at one of its corners is compared
// with all of it.
bool QuadOptimizer::find_folded(size_t q) const {
    const Around quad(quads_, static_cast<uint32_t>(q), quads_.quads[4 * q]);
    const Point n = quad.diagonals();
    bool agrees = true;
    for (const uint32_t v : quad.corner) agrees = agrees && dot(normal_[v], n) > 0;
    return !(worst_corner(quads_, q, agrees ? nullptr : &surface_) > 0);
}

bool QuadOptimizer::is_folded(size_t q) {
    if (folded_[q] == UNKNOWN) folded_[q] = find_folded(q);
    return folded_[q];
}

Done QuadOptimizer::count_folded(size_t& count) {
    count = 0;
    for (size_t q = 0; q < quads_.quad_count(); ++q) {
        if (!call_.work(256, 0, false)) return false;
        count += is_folded(q);
    }
    return true;
}

// The least area of a corner, relative to the target area.
double QuadOptimizer::least_area() const {
    double least = HUGE_VAL;
    for (size_t q = 0; q < quads_.quad_count(); ++q) {
        const Around quad(quads_, static_cast<uint32_t>(q), quads_.quads[4 * q]);
        const Point n = normal_of(quad.corner);
        for (size_t k = 0; k < 4; ++k) {
            const Point e = quad.p[(k + 1) % 4] - quad.p[k], b = quad.p[(k + 3) % 4] - quad.p[k];
            least = std::min(least, dot(cross(e, b), n) / target_[q]);
        }
    }
    return least;
}

Done QuadOptimizer::mark_region(int rings, bool lets_go) {
    Array<uint8_t> next;
    if (!region_.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0})
        || !next.allocate(call_.memory, quads_.vertex_count()))
        return false;
    for (size_t q = 0; q < quads_.quad_count(); ++q) {
        if (!call_.work(256, 0, false)) return false;
        if (is_folded(q))
            for (size_t k = 0; k < 4; ++k) region_[quads_.quads[4 * q + k]] = 1;
    }
    for (int ring = 0; ring < rings; ++ring) {
        if (!call_.tick(0)) return false;
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) next[v] = region_[v];
        for (size_t q = 0; q < quads_.quad_count(); ++q) {
            const uint32_t* const c = &quads_.quads[4 * q];
            if (region_[c[0]] | region_[c[1]] | region_[c[2]] | region_[c[3]])
                for (size_t k = 0; k < 4; ++k) next[c[k]] = 1;
        }
        region_.swap(next);
        if (ring > 0 || !lets_go) continue;
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            uint8_t& held = quads_.held[v];
            if (!region_[v] || !held) continue;
            if (!is_at_boundary(held)) held = 0;
            else if (is_on_rim(mesh_, quads_.sides[v])) held = AT_BOUNDARY;
        }
    }
    return true;
}

hmf_status QuadOptimizer::untangle_round(int round) {
    region_.clear();
    if (round > 0 && !mark_region(RINGS << (round - 1), round > 1)) return call_.stopped();
    for (uint8_t& a : awake_) a = 1;
    double moved = 1;
    for (int k = 0; k < SWEEPS && moved > 0; ++k) {
        const double least = std::min(least_area(), 0.0);
        size_t folded = 0;
        if (round > 0 && !count_folded(folded)) return call_.was_cancelled();
        if (round > 0 ? folded == 0 : !(least < 0)) break;
        if (round == 0) eps_ = std::sqrt(EPS * EPS + SOFT * SOFT * least * least);
        else eps_ = k == 0 ? 1 : std::max(EPS, HARDER * eps_);
        for (uint8_t& a : awake_) a = 1;
        if (!sweep(k % 2 == 0, moved)) return call_.was_cancelled();
    }
    return HMF_OK;
}

hmf_status QuadOptimizer::untangle(int first_round) {
    growth_ = 0;
    barrier_ = false;
    if (!set_targets()) return call_.stopped();
    uint64_t least = 0, now = 0;
    if (!count_inverted(surface_, quads_, least, call_)) return call_.was_cancelled();
    QuadMesh best;
    for (int k = 0; k < UNTANGLE_ROUNDS && least > 0; ++k) {
        const int round = (first_round + k) % UNTANGLE_ROUNDS;
        if (!best.copy(quads_, call_.memory)) return call_.out_of_memory();
        if (untangle_round(round)) return call_.status();
        if (!count_inverted(surface_, quads_, now, call_)) return call_.was_cancelled();
        if (now > least) {
            std::swap(quads_, best);
            look_again();
        } else least = now;
    }
    region_.clear();
    return HMF_OK;
}

} // namespace hmf
