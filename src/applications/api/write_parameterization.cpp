// Faces and edges are read in their internal order, where what belongs together
// is near in memory, and written to the places of the caller: nothing is read
// from there.
#include "write_parameterization.hpp"

#include "../common/sort_keys.hpp"
#include "../../core/hierarchy/caller_numbers.hpp"
#include "../../core/mesh/weights.hpp"
#include "../parameterize/seams.hpp"
#include "../../core/api/result.hpp"

#include <cmath>

namespace hmf {

namespace {

// The caller's order is none in memory.
constexpr uint32_t CORNERS_AHEAD = 8;

// Of the caller's triangles: edges of a later one, half-edges of a sooner one.
HMF_INLINE void prefetch_sides(const hmf_hierarchy& h, size_t later, size_t sooner) {
    for (size_t s = 0; s < 3; ++s) prefetch(&h.edge_internal[h.triangle_edges[3 * later + s]]);
    const uint32_t side = 2 * h.edge_internal[h.triangle_edges[3 * sooner]];
    prefetch(&h.input.next[side]);
    prefetch(&h.input.face[side]);
}

} // namespace

Done CallerTriangles::build(const hmf_hierarchy& h, size_t level, Call& call) {
    const Mesh& mesh = level == 0 ? h.input : h.levels[level].mesh;
    if (!of_face.allocate(call.memory, mesh.face_count)) return false;
    if (level == 0)
        return call.pass(mesh.face_count, 0, [&](size_t begin, size_t end) {
            for (size_t t = begin; t < end; ++t) {
                if (end - t > 2 * CORNERS_AHEAD) prefetch_sides(h, t + 2 * CORNERS_AHEAD, t + CORNERS_AHEAD);
                const uint32_t side = internal_side(h, t);
                of_face[mesh.face[side]] = {side, static_cast<uint32_t>(t)};
            }
        });
    return call.pass(size_t{2} * mesh.edge_count, 0, [&](size_t begin, size_t end) {
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t side, uint32_t, uint32_t) {
                          of_face[mesh.face[side]] = {side, mesh.face[side]};
                      });
    });
}

namespace {

// Sums over triangles.
struct Sums {
    double area = 0, image = 0, visible = 0, weighted = 0; // weighted: dilatation times area of the visible ones
    uint64_t flipped = 0, degenerate = 0;

    void add(const AffineMap& map) {
        area += map.area;
        image += map.determinant * map.area;
        if (map.dilatation == HUGE_VAL) {
            ++degenerate;
            return;
        }
        flipped += map.determinant < 0;
        weighted += map.area * map.dilatation;
        visible += map.area;
    }
    void operator+=(const Sums& part) {
        area += part.area;
        image += part.image;
        visible += part.visible;
        weighted += part.weighted;
        flipped += part.flipped;
        degenerate += part.degenerate;
    }
};

// Dilatations by area.
class Quantiles {
public:
    Done allocate(size_t triangles, Memory& memory) {
        return key_.allocate(memory, triangles) && area_.allocate(memory, triangles);
    }
    void set(size_t t, double dilatation, double area) {
        key_[t] = key_of(dilatation);
        area_[t] = area;
    }
    // The dilatation exceeded on the given area, as a float: its bits are determined from the highest on, eight at a
    // time, by the areas of the triangles that share the bits found so far.
    double above(double area) const {
        uint32_t found = 0;
        for (uint32_t shift = 32; shift > 0;) {
            shift -= 8;
            double sum[256] = {};
            for (size_t t = 0; t < key_.size(); ++t)
                if (shift == 24 || key_[t] >> (shift + 8) == found >> (shift + 8))
                    sum[key_[t] >> shift & 255] += area_[t];
            uint32_t digit = 255;
            for (; digit > 0 && !(area < sum[digit]); --digit) area -= sum[digit];
            found |= digit << shift;
        }
        float x;
        std::memcpy(&x, &found, sizeof x);
        return static_cast<double>(x);
    }

private:
    Array<uint32_t> key_;
    Array<double> area_;
};

class Writer {
public:
    Writer(const Parameterization& from, const hmf_foliation& foliation, const Mesh& mesh, const FlatConeMetric& flat,
           double unit, const CallerTriangles& triangles, hmf_parameterization& to, Call& call) :
        from_(from),
        h_(*foliation.hierarchy), level_(foliation.level), mesh_(mesh), flat_(flat), unit_(unit), triangles_(triangles),
        to_(to), call_(call), shown_(static_cast<uint32_t>(to.triangle_count)) {}

    // Corners, dilatations, differentials and their sums.
    hmf_status triangles() {
        Quantiles quantiles;
        if (!quantiles.allocate(mesh_.face_count, call_.memory)) return call_.out_of_memory();
        const size_t block = Parallel::pass_block(mesh_.face_count);
        Sums of_block[Parallel::MOST_PARTS], sums;
        const auto write = [&](size_t begin, size_t end) {
            Sums& part = of_block[begin / block];
            for (size_t f = begin; f < end; ++f) {
                if (end - f > CORNERS_AHEAD) prefetch_triangle(triangles_.of_face[f + CORNERS_AHEAD]);
                const CallerTriangles::Of of = triangles_.of_face[f];
                if (of.triangle >= shown_) {
                    quantiles.set(f, 1, 0);
                    continue;
                }
                const AffineMap map = from_.map_of(mesh_, h_.levels[level_].position, of.side, unit_);
                quantiles.set(f, map.dilatation, map.area);
                part.add(map);
                triangle(of, map);
            }
        };
        if (!call_.pass(mesh_.face_count, 0.97, write)) return call_.was_cancelled();
        for (size_t k = 0; k * block < mesh_.face_count; ++k) sums += of_block[k];
        to_.flipped_count = sums.flipped;
        to_.degenerate_count = sums.degenerate;
        to_.area = sums.image;
        to_.dilatation_mean = sums.visible > 0 ? sums.weighted / sums.visible : HUGE_VAL;
        to_.dilatation_median = quantiles.above(0.5 * sums.area);
        to_.dilatation_p99 = quantiles.above(0.01 * sums.area);
        return call_.tick(0.98) ? HMF_OK : call_.was_cancelled();
    }

    // Transitions and seams.
    hmf_status edges() {
        const Parallel& parallel = call_.parallel;
        parallel.for_blocks(static_cast<size_t>(to_.edge_count), [&](size_t begin, size_t end) {
            std::memset(fill(to_.seam) + begin, 0, end - begin);
            double* const transition = fill(to_.transition);
            for (size_t e = begin; e < end; ++e) {
                transition[3 * e] = 1;
                transition[3 * e + 1] = transition[3 * e + 2] = 0;
            }
        });
        if (!call_.tick(0.985)) return call_.was_cancelled();
        const Layout& layout = from_.layout;
        const SeamSum sum = parallel.sum_blocks<SeamSum>(mesh_.edge_count, [&](size_t begin, size_t end) {
            SeamSum part;
            for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e) {
                if (end - e > CORNERS_AHEAD) {
                    const uint32_t there = mesh_.next[2 * (e + CORNERS_AHEAD) + 1];
                    prefetch(&layout.at[there]);
                }
                // The same either way: nothing.
                if (from_.is_seam(e, from_.transition(mesh_, flat_.bundle, 2 * e))) edge(e, part);
            }
            return part;
        });
        to_.seam_edge_count = sum.count;
        to_.seam_length = sum.length / h_.scale;
        return call_.tick(0.99) ? HMF_OK : call_.was_cancelled();
    }

    hmf_status cones() {
        const auto write = [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v)
                fill(to_.cone)[v] = from_.cone[level_ == 0 ? h_.vertex_internal[v] : v];
        };
        return call_.pass(static_cast<size_t>(to_.vertex_count), 0.99, write) ? HMF_OK : call_.was_cancelled();
    }

private:
    // What is read and written for a triangle that comes soon.
    HMF_INLINE void prefetch_triangle(CallerTriangles::Of of) const {
        const uint32_t h = of.side, n = mesh_.next[h];
        prefetch(&from_.layout.at[h]);
        prefetch(&from_.layout.at[n]);
        prefetch(&mesh_.next[n]);
        if (of.triangle >= shown_) return;
        prefetch(&to_.corner_uv[6 * size_t{of.triangle}]);
        prefetch(&to_.differential[2 * size_t{of.triangle}]);
        prefetch(&to_.dilatation[of.triangle]);
    }

    void triangle(CallerTriangles::Of of, const AffineMap& map) {
        const size_t t = of.triangle;
        const bool flipped = map.dilatation != HUGE_VAL && map.determinant < 0;
        fill(to_.dilatation)[t] = flipped ? -map.dilatation : map.dilatation;
        for (size_t a = 0; a < 2; ++a) fill(to_.differential)[2 * t + a] = map.differential[a] * h_.scale * h_.scale;
        double* uv = fill(to_.corner_uv) + 6 * t;
        uint32_t h = of.side;
        for (size_t s = 0; s < 3; ++s, h = mesh_.next[h]) {
            const Layout::Point& at = from_.layout.at[h];
            *uv++ = static_cast<double>(at.u) * unit_;
            *uv++ = static_cast<double>(at.v) * unit_;
        }
    }

    // From the first triangle of the caller that has the edge.
    void edge(uint32_t e, SeamSum& sum) {
        const CallerTriangles::Of left = triangles_.of_face[mesh_.face[2 * e]];
        const CallerTriangles::Of right = triangles_.of_face[mesh_.face[2 * e + 1]];
        const bool from_left = left.triangle <= right.triangle;
        const CallerTriangles::Of first = from_left ? left : right, second = from_left ? right : left;
        if (first.triangle >= shown_) return;
        const uint32_t g = 2 * e + !from_left;
        const bool outer = second.triangle >= shown_; // on the boundary of the surface, beyond which nothing lies
        const Transition map = from_.transition(mesh_, flat_.bundle, g);
        const bool seam = from_.is_seam(e, map) && !outer;
        sum.count += seam;
        if (seam) sum.length += from_.length[e];
        const size_t place = caller_edge(first, g);
        double* const transition = fill(to_.transition) + 3 * place;
        fill(to_.seam)[place] = seam;
        transition[0] = outer ? 1 : map.sign;
        transition[1] = outer ? 0 : static_cast<double>(map.u) * unit_;
        transition[2] = outer ? 0 : static_cast<double>(map.v) * unit_;
    }

    uint32_t caller_edge(CallerTriangles::Of of, uint32_t side) const {
        if (level_ > 0) return edge_of(side);
        const size_t s = side == of.side ? 0 : side == mesh_.next[of.side] ? 1 : 2;
        return h_.triangle_edges[3 * size_t{of.triangle} + s];
    }

    const Parameterization& from_;
    const hmf_hierarchy& h_;
    size_t level_;
    const Mesh& mesh_;
    const FlatConeMetric& flat_;
    double unit_;
    const CallerTriangles& triangles_;
    hmf_parameterization& to_;
    Call& call_;
    uint32_t shown_; // triangles that the caller sees; those of the back of a double come after them
};

} // namespace

hmf_status write_parameterization(const Parameterization& from, const hmf_foliation& foliation, const Mesh& mesh,
                                  const FlatConeMetric& flat, double unit, const CallerTriangles& triangles,
                                  hmf_parameterization& to, Call& call) {
    Writer writer(from, foliation, mesh, flat, unit, triangles, to, call);
    if (writer.triangles() || writer.edges() || writer.cones()) return call.status();
    return HMF_OK;
}

} // namespace hmf
