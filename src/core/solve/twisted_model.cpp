#include "twisted_model.hpp"

#include "parameters.hpp"

#include <algorithm>

namespace hmf {

Done TwistedModel::allocate(const Mesh& mesh, Memory& memory, const Parallel& parallel) {
    const size_t n = mesh.vertex_count, m = mesh.edge_count;
    tripod.start(memory);
    fixed_zeros.start(memory);
    bounded.start(memory);
    special_.start(memory);
    at_bounds.start(memory);
    return tripod.reserve(64) && fixed_zeros.reserve(n) && bounded.reserve(n) && special_.reserve(n)
        && at_bounds.reserve(n) && index.allocate(memory, n) && sign.allocate_filled(memory, 2 * m, 0, parallel)
        && is_fixed.allocate(memory, n) && entry.allocate_filled(memory, 2 * m, 0, parallel)
        && changed.allocate_filled(memory, n, 0, parallel) && diagonal.allocate(memory, n) && right.allocate(memory, n)
        && row_scale.allocate(memory, n) && lower.allocate_filled(memory, n, INT64_MIN, parallel)
        && upper.allocate_filled(memory, n, INT64_MAX, parallel) && d.allocate(memory, n);
}

Done TwistedModel::find_tripods(Foliation& f, const Rings& rings, uint32_t v) {
    const Mesh& mesh = f.mesh;
    for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
        const uint32_t h = rings.side[t].half_edge, n = mesh.next[h], p = mesh.next[n];
        if (h > n || h > p) continue; // each from its lowest half-edge
        if (f.corner2(h) > 0 && f.corner2(n) > 0 && f.corner2(p) > 0 && !tripod.push(h)) return false;
    }
    return true;
}

// A vertex without zero edges; false: it has one or is not of the kind, and nothing was done.
// floor: the least pull that residuals are measured against.
bool TwistedModel::look_at_plain_vertex(const Foliation& f, const Rings& rings, const double* weight, uint32_t v,
                                        double floor, Kind kind, Residuals& residuals) {
    const Rings::Side* side = &rings.side[rings.offset[v]];
    const uint32_t degree = rings.offset[v + 1] - rings.offset[v];
    double pull_of[2] = {0, 0};
    int64_t tripods = 0; // 0: none
    uint64_t second = 0; // of the last 64 sides, the last one lowest
    const uint32_t closed = walk_plain_star(
        f.value, side, degree, [&](uint32_t t, uint32_t direction, int64_t here, int64_t ahead, int64_t opposite) {
            pull_of[direction] += weight[edge_of(side[t].half_edge)] * static_cast<double>(here);
            second = 2 * second + direction;
            const int64_t longest = std::max(std::max(here, ahead), opposite);
            tripods |= here + ahead + opposite - 2 * longest;
        });
    if (closed == NONE) return false;
    const bool marked = f.mesh.is_marked(v);
    if (kind == Kind::regular && (marked || closed != 2 || tripods)) return false;
    index[v] = 2 - marked - static_cast<int32_t>(closed);
    if (marked && closed == 1) {
        fix(rings, v);
    } else if (closed == 2 && !marked) {
        const bool turned = set_signs(f, side, degree, weight, second);
        // To the bit the residual that read_star gives.
        const bool to_second = pull_of[1] > pull_of[0];
        const double pull = pull_of[0] + pull_of[1], scale = pull > floor ? pull : floor;
        const double size = 2 * pull_of[to_second] - pull;
        const double excess = to_second ? -size : size;
        residuals.add(size > 0 ? size / scale : 0);
        is_fixed[v] = 0;
        right[v] = turned ? -excess : excess;
        row_scale[v] = static_cast<float>(1 / scale);
    } else {
        fix_zero(rings, v);
        special_.add(v);
    }
    return true;
}

// Of a regular star: as they were, as far as its pulls agree.  second: its sides in the second direction, of
// the last 64, the last one lowest.  True: the first direction is -.
bool TwistedModel::set_signs(const Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight,
                             uint64_t second) {
    uint64_t minus = 0;
    int8_t any = 0, all = 1;
    for (uint32_t t = 0; t < degree; ++t) {
        const int8_t s = sign[side[t].half_edge];
        minus = 2 * minus + (s < 0);
        any |= s;
        all &= s;
    }
    const bool none = any == 0, each = all != 0;
    bool turned = false;
    if (degree <= 64 && each) { // mostly all are as they were
        const uint64_t others = second ^ minus;
        turned = others != 0;
        if (!turned || others == ~uint64_t{0} >> (64 - degree)) return turned;
    }
    if (!none) {
        double agreement = 0;
        walk_plain_star(f.value, side, degree, [&](uint32_t t, uint32_t direction, int64_t here, int64_t, int64_t) {
            const uint32_t h = side[t].half_edge;
            const double p = weight[edge_of(h)] * static_cast<double>(here);
            agreement += sign[h] * (direction ? -p : p);
        });
        turned = agreement < 0;
    }
    const auto sign_of = [=](bool in_second) { return static_cast<int8_t>(in_second == turned ? 1 : -1); };
    if (degree <= 64) {
        for (uint32_t t = degree; t-- > 0; second >>= 1) sign[side[t].half_edge] = sign_of(second & 1);
    } else {
        walk_plain_star(f.value, side, degree, [&](uint32_t t, uint32_t direction, int64_t, int64_t, int64_t) {
            sign[side[t].half_edge] = sign_of(direction);
        });
    }
    return turned;
}

void TwistedModel::fix_zero(const Rings& rings, uint32_t v) {
    fixed_zeros.add(v);
    fix(rings, v);
}

// Fixes v; its neighbors may pass it.
void TwistedModel::fix(const Rings& rings, uint32_t v) {
    is_fixed[v] = 1;
    right[v] = row_scale[v] = 0;
    for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) sign[rings.side[t].half_edge] = 0;
}

// The cluster of v, which has zero edges.
Done TwistedModel::look_at_cluster(Foliation& f, const Rings& rings, const double* weight, uint32_t v, double floor) {
    const Cluster cluster = explore_cluster(f, v);
    const bool balanced = cluster.complete && cluster.index() == 0;
    const bool regular = balanced && cluster.marked == 0;
    const bool turned = regular && sign_regular_cluster(f, weight, sign.data()) < 0;
    for (uint32_t u : f.members) {
        special_.add(u);
        if (!find_tripods(f, rings, u)) return false;
        index[u] = 0;
        if (!regular) {
            if (balanced && f.mesh.is_marked(u)) fix(rings, u);
            else fix_zero(rings, u);
            continue;
        }
        is_fixed[u] = 0;
        double b = 0, pull = 0;
        for (uint32_t t = rings.offset[u]; t < rings.offset[u + 1]; ++t) {
            const uint32_t h = rings.side[t].half_edge;
            if (turned) sign[h] = static_cast<int8_t>(-sign[h]);
            const double p = weight[edge_of(h)] * static_cast<double>(f.at(h));
            b += sign[h] * p;
            pull += p;
        }
        right[u] = b;
        row_scale[u] = static_cast<float>(1 / (pull > floor ? pull : floor));
    }
    index[v] = static_cast<int32_t>(cluster.index());
    return true;
}

Done TwistedModel::linearize(Foliation& f, const Rings& rings, const double* weight, Star& star, Call& call) {
    const uint32_t n = count = f.mesh.vertex_count;
    offset = rings.offset.data();
    column = rings.neighbor.data();
    struct Sums {
        double pull = 0, energy = 0; // of all edges, at one of their ends
        void operator+=(const Sums& other) {
            pull += other.pull;
            energy += other.energy;
        }
    };
    const Sums sums = call.parallel.sum_blocks<Sums>(f.mesh.edge_count, [&](size_t begin, size_t end) {
        Sums here;
        for (size_t e = begin; e < end; ++e) {
            const double x = static_cast<double>(f.value[e]);
            here.pull += weight[e] * x;
            here.energy += weight[e] * x * x;
        }
        return here;
    });
    energy = sums.energy;
    const double floor = pull_floor(sums.pull, n);
    tripod.clear();
    fixed_zeros.clear();
    special_.clear();
    if (!call.tick(0, true)) return false;
    // Nearly all are regular.  The others are listed by each block where it lies, and follow in order.
    const size_t size = Parallel::pass_block(n);
    uint32_t listed[Parallel::MOST_PARTS];
    uint32_t* const list = at_bounds.data(); // room for all, not in use now
    Residuals part[Parallel::MOST_PARTS], residuals;
    call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        Residuals here;
        uint32_t others = 0;
        for (size_t i = begin; i < end; ++i) {
            const uint32_t v = static_cast<uint32_t>(i);
            if (n - v > Rings::AHEAD) rings.prefetch_star(f.value, weight, v + Rings::AHEAD);
            if (rings.is(v, Monogons::HOST) || !look_at_plain_vertex(f, rings, weight, v, floor, Kind::regular, here))
                list[begin + others++] = v;
        }
        part[begin / size] = here;
        listed[begin / size] = others;
    });
    const uint32_t before = f.epoch;
    // Each block has set its part and its number, which the analyzer of clang does not see.
    for (size_t k = 0; k * size < n; ++k) {
        residuals.sum += part[k].sum;                                 // NOLINT(clang-analyzer-core*)
        if (part[k].max > residuals.max) residuals.max = part[k].max; // NOLINT(clang-analyzer-core*)
        for (uint32_t i = 0; i < listed[k]; ++i) {                    // NOLINT(clang-analyzer-core*)
            const uint32_t v = list[k * size + i];
            if (!call.work(64 + 8 * f.take_walked())) return false;
            if (!rings.is(v, Monogons::HOST)
                && look_at_plain_vertex(f, rings, weight, v, floor, Kind::any, residuals)) {
                if (!find_tripods(f, rings, v)) return false;
            } else if (f.stamp[v] <= before && !look_at_cluster(f, rings, weight, v, floor)) return false;
        }
    }
    // A monogon moves with the vertex on which it hangs.
    for (uint32_t e : rings.monogons.edges) sign[2 * e] = sign[2 * e + 1] = 0;
    for (uint32_t v = 0; v < n && !rings.monogons.edges.empty(); ++v)
        if (rings.is(v, Monogons::INSIDE)) is_fixed[v] = 1;
    for (uint32_t v : special_) {
        residuals.add(residual_at(f, rings, weight, v, floor, star));
        if (!call.work(64 + 8 * f.take_walked())) return false;
    }
    residual_max = residuals.max;
    residual_sum = residuals.sum;
    return true;
}

void TwistedModel::assemble(const Foliation& f, const Rings& rings, const double* weight, Call& call) {
    const Mesh& mesh = f.mesh;
    for (uint32_t k : bounded) {
        lower[k] = INT64_MIN;
        upper[k] = INT64_MAX;
    }
    bounded.clear();
    if (!call.tick(0, true)) return;
    call.parallel.for_blocks(count, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            bool same = true;
            for (uint32_t t = offset[v]; t < offset[v + 1]; ++t) {
                const uint32_t h = rings.side[t].half_edge;
                const double before = entry[t];
                entry[t] = weight[edge_of(h)] * (sign[h] * sign[twin(h)]);
                same &= entry[t] == before;
            }
            changed[v] |= !same;
            // A fixed vertex keeps its place in the preconditioner: it may move in the next model.
            diagonal[v] = rings.weight_sum[v];
            d[v] = 0;
        }
    });
    for (uint32_t v = 0; v < count && !rings.monogons.vertex.empty(); ++v)
        if (rings.is(v, Monogons::SELF_EDGE)) fill_row_with_self_edges(f, rings, weight, v);
    if (!call.tick(0, true)) return;
    for (uint32_t v : fixed_zeros) {
        bound(v, 0, is_fixed[v] ? 0 : 1);
        for (uint32_t t = offset[v]; t < offset[v + 1]; ++t) {
            const uint32_t h = rings.side[t].half_edge;
            if (!is_fixed[column[t]]) bound_along(column[t], twin(h), f.at(h));
        }
    }
    for (uint32_t h : tripod) {
        const uint32_t corners[3] = {h, mesh.next[h], mesh.prev(h)};
        for (uint32_t g : corners)
            if (!is_fixed[mesh.origin[g]]) bound_along(mesh.origin[g], g, f.corner2(g) / 2);
    }
}

// Edges from v to itself: both of their ends move.
void TwistedModel::fill_row_with_self_edges(const Foliation& f, const Rings& rings, const double* weight, uint32_t v) {
    double sum = 0;
    for (uint32_t t = offset[v]; t < offset[v + 1]; ++t) {
        const uint32_t h = rings.side[t].half_edge;
        const double alpha = weight[edge_of(h)];
        const bool self = column[t] == v;
        sum += self && !is_fixed[v] ? alpha * (sign[h] + sign[twin(h)]) * sign[h] : alpha;
        if (!self) continue;
        entry[t] = 0;
        if (!is_fixed[v] && sign[h] == sign[twin(h)]) bound_along(v, h, f.at(h) / 2);
    }
    diagonal[v] = sum;
}

// low <= d_k <= high from now on.
void TwistedModel::bound(uint32_t k, int64_t low, int64_t high) {
    if (lower[k] == INT64_MIN && upper[k] == INT64_MAX) bounded.add(k);
    if (low > lower[k]) lower[k] = low;
    if (high < upper[k]) upper[k] = high;
}

// The origin k of a half-edge moves by at most `room` in its direction.
void TwistedModel::bound_along(uint32_t k, uint32_t h, int64_t room) {
    if (sign[h] > 0) bound(k, INT64_MIN, room);
    if (sign[h] < 0) bound(k, -room, INT64_MAX);
}

double TwistedModel::relaxed(uint32_t k) const {
    double b = right[k];
    for (uint32_t i = offset[k]; i < offset[k + 1]; ++i) b -= entry[i] * d[column[i]];
    double x = diagonal[k] > 0 ? b / diagonal[k] : 0;
    if (lower[k] != INT64_MIN && x < static_cast<double>(lower[k])) x = static_cast<double>(lower[k]);
    if (upper[k] != INT64_MAX && x > static_cast<double>(upper[k])) x = static_cast<double>(upper[k]);
    return x;
}

// Brings d_k into its bounds; true if it was outside.
bool TwistedModel::clip(uint32_t k) {
    if (lower[k] != INT64_MIN && d[k] < static_cast<double>(lower[k])) d[k] = static_cast<double>(lower[k]);
    else if (upper[k] != INT64_MAX && d[k] > static_cast<double>(upper[k])) d[k] = static_cast<double>(upper[k]);
    else return false;
    return true;
}

// Vertex k stops at its bound. The bounds of its neighbors follow: F - s_k d_k - s d >= 0.
void TwistedModel::fix_at_bound(const Foliation& f, const Rings& rings, uint32_t k) {
    const int64_t at = at_bound(k) ? bound_at(k) : static_cast<int64_t>(d[k]);
    for (uint32_t t = rings.offset[k]; t < rings.offset[k + 1]; ++t) {
        const uint32_t h = rings.side[t].half_edge, other = f.mesh.target(h);
        if (is_fixed[other] || other == k) continue;
        const int64_t room = f.at(h) - sign[h] * at;
        if (room >= 0) bound_along(other, twin(h), room); // else another branch point is in between
    }
}

// Projected Gauss-Seidel in the neighborhood of the patch, whose unknowns are fixed.
void TwistedModel::relax_around(const Foliation& f, const Rings& rings, Array<uint32_t>& patch,
                                Array<uint32_t>& distance) {
    for (size_t i = 0; i < patch.size(); ++i) {
        const uint32_t k = patch[i];
        if (distance[k] == parameters::BOUND_RINGS) continue;
        for (uint32_t j = offset[k]; j < offset[k + 1]; ++j) {
            const uint32_t other = column[j];
            if (distance[other] != NONE || is_fixed[other]) continue;
            distance[other] = distance[k] + 1;
            patch.add(other);
        }
    }
    for (size_t s = 0, sweeps = parameters::local_passes(patch.size(), count); s < sweeps; ++s)
        for (size_t i = 0; i < patch.size(); ++i) {
            const uint32_t k = patch[s % 2 ? patch.size() - 1 - i : i];
            d[k] = relaxed(k);
            if (at_bound(k) && distance[k] != 0) {
                distance[k] = 0; // fixed from here on
                fix_at_bound(f, rings, k);
            }
        }
}

void TwistedModel::fix_active() {
    at_bounds.clear();
    for (uint32_t k : bounded)
        if (!is_fixed[k] && at_bound(k)) at_bounds.add(k);
}

bool TwistedModel::release() {
    bool any = false;
    for (uint32_t k : at_bounds) {
        const double x = relaxed(k);
        any |= x != d[k];
        d[k] = x;
    }
    return any;
}

uint64_t TwistedModel::project(const Foliation& f, const Rings& rings, Array<uint32_t>& patch,
                               Array<uint32_t>& distance) {
    patch.clear();
    for (uint32_t k = 0; k < count; ++k) distance[k] = NONE;
    for (uint32_t k : bounded)
        if (clip(k) && !is_fixed[k]) { // of a fixed one it is what the solver adds to right sides
            distance[k] = 0;
            patch.add(k);
        }
    const uint64_t active = patch.size();
    for (size_t i = 0; i < active; ++i) fix_at_bound(f, rings, patch[i]);
    if (active > 0) relax_around(f, rings, patch, distance);
    return active;
}

void TwistedModel::fix_around(const Foliation& f, const Rings& rings, const Array<uint32_t>& from, uint32_t radius,
                              Array<uint32_t>& patch, Array<uint32_t>& distance) {
    patch.clear();
    for (uint32_t k = 0; k < count; ++k) distance[k] = NONE;
    // Rings of unknowns around them; distance counts up and is set back below.
    const auto add = [&](uint32_t k, uint32_t ring) {
        if (is_fixed[k] || distance[k] != NONE) return;
        distance[k] = ring;
        patch.add(k);
    };
    for (const uint32_t v : from) add(v, 0);
    for (const uint32_t v : from)
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) add(f.mesh.target(rings.side[t].half_edge), 1);
    for (size_t i = 0; i < patch.size(); ++i) {
        const uint32_t k = patch[i];
        if (distance[k] >= radius) continue;
        for (uint32_t j = offset[k]; j < offset[k + 1]; ++j) add(column[j], distance[k] + 1);
    }
    for (size_t i = 0; i < patch.size(); ++i) {
        const uint32_t k = patch[i];
        distance[k] = 0;
        d[k] = 0;
        bound(k, 0, 0);
    }
    const size_t fixed_count = patch.size();
    for (size_t i = 0; i < fixed_count; ++i) fix_at_bound(f, rings, patch[i]);
    relax_around(f, rings, patch, distance);
}

} // namespace hmf
