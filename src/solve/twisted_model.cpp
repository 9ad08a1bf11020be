#include "twisted_model.hpp"

namespace hmf {

bool TwistedModel::allocate(const Mesh& mesh, Memory& memory) {
    const size_t n = mesh.vertex_count, m = mesh.edge_count;
    tripod.start(memory);
    return tripod.reserve(64) && index.allocate(memory, n) && sign.allocate(memory, 2 * m) && product.allocate_filled(memory, m, 0)
        && gauge.allocate(memory, n) && queue.allocate(memory, n) && rests.allocate(memory, n) && offset.allocate(memory, n + 1)
        && column.allocate(memory, 2 * m) && entry.allocate(memory, 2 * m) && diagonal.allocate(memory, n) && right.allocate(memory, n)
        && lower.allocate(memory, n) && upper.allocate(memory, n) && d.allocate(memory, n);
}

namespace {

// Signs of a regular vertex without zero edges.
bool sign_regular_vertex(const Foliation& f, const Rings& rings, uint32_t v, int8_t* sign, bool& has_zero, uint32_t& closed) {
    const Rings::Side* side = &rings.side[rings.offset[v]];
    const uint32_t degree = rings.offset[v + 1] - rings.offset[v];
    has_zero = rings.is(v, Monogons::HOST);
    closed = 0;
    if (has_zero) return false;
    int8_t s = 1;
    int64_t here = f.value[edge_of(side[0].half_edge)];
    const int64_t first = here;
    for (uint32_t t = 0; t < degree; ++t) {
        if (here == 0) { has_zero = true; return false; }
        const int64_t ahead = t + 1 < degree ? f.value[edge_of(side[t + 1].half_edge)] : first;
        sign[side[t].half_edge] = s;
        if (here + ahead == f.value[side[t].opposite]) { s = static_cast<int8_t>(-s); ++closed; }
        here = ahead;
    }
    return closed == 2;
}

// Signs round the cluster in f.members, which is regular: a disk with two
// closed corners, or an annulus with none, whose two boundaries are the two
// directions.
void sign_regular_cluster(const Foliation& f, int8_t* sign) {
    const Mesh& mesh = f.mesh;
    uint32_t closed_start = NONE;
    size_t sides = 0;
    for (uint32_t v : f.members) {
        const uint32_t first = mesh.out[v];
        uint32_t h = first;
        do {
            const uint32_t ahead = mesh.rotate_ccw(h);
            ++sides;
            sign[h] = f.at(h) != 0 ? 0 : h & 1 ? -1 : 1;
            if (f.at(h) != 0 && f.at(ahead) != 0 && f.corner2(h) == 0) closed_start = ahead;
            h = ahead;
        } while (h != first);
    }
    // One turn round the boundary meets each side at most once per zero edge beside it.
    const auto sign_boundary = [&](uint32_t start, int8_t s) {
        uint32_t g = start;
        for (size_t step = 0; step < 4 * sides; ++step) {
            sign[g] = s;
            const uint32_t ahead = mesh.rotate_ccw(g);
            if (f.at(ahead) == 0) {
                g = twin(mesh.next[g]);
            } else {
                if (f.corner2(g) == 0) s = static_cast<int8_t>(-s);
                g = ahead;
            }
            if (g == start) return;
        }
    };
    if (closed_start != NONE) {
        sign_boundary(closed_start, 1);
        return;
    }
    int8_t s = 1;
    for (uint32_t v : f.members) {
        const uint32_t first = mesh.out[v];
        uint32_t h = first;
        do {
            if (f.at(h) != 0 && sign[h] == 0) {
                sign_boundary(h, s);
                s = -1;
            }
            h = mesh.rotate_ccw(h);
        } while (h != first);
    }
}

} // namespace

// Which of its two directions a vertex calls + is free.  The choice that gives
// most entries the sign that they had in the model before is found breadth
// first: between the zeros the bundle of signs has not changed.
void TwistedModel::align_signs(const Mesh& mesh, const Rings& rings) {
    const uint32_t n = mesh.vertex_count;
    for (uint32_t v = 0; v < n; ++v) gauge[v] = 0;
    for (uint32_t seed = 0; seed < n; ++seed) {
        if (gauge[seed] != 0 || rests[seed]) continue;
        gauge[seed] = 1;
        uint32_t size = 0;
        queue[size++] = seed;
        for (uint32_t i = 0; i < size; ++i) {
            const uint32_t v = queue[i];
            for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
                const uint32_t h = rings.side[t].half_edge, w = mesh.target(h);
                if (gauge[w] != 0 || rests[w] || product[edge_of(h)] == 0) continue;
                gauge[w] = static_cast<int8_t>(gauge[v] * product[edge_of(h)] * sign[h] * sign[twin(h)]);
                queue[size++] = w;
            }
        }
    }
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (gauge[mesh.origin[h]] < 0) sign[h] = static_cast<int8_t>(-sign[h]);
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const int8_t now = static_cast<int8_t>(sign[2 * e] * sign[2 * e + 1]);
        if (now != 0) product[e] = now;
    }
}

void TwistedModel::assemble(Foliation& f, const Rings& rings, const double* weight, Call* call) {
    constexpr uint32_t stride = 65536; // vertices between two calls of the progress function
    const Mesh& mesh = f.mesh;
    const uint32_t n = mesh.vertex_count;
    const uint32_t before = f.epoch;
    count = n;
    for (uint32_t v = 0; v < n; ++v) {
        if (v % stride == 0 && call && !call->tick(0, true)) return;
        if (f.stamp[v] > before) continue;
        bool has_zero = false;
        uint32_t closed = 0;
        index[v] = 0;
        if (sign_regular_vertex(f, rings, v, sign.data(), has_zero, closed)) {
            rests[v] = 0;
            continue;
        }
        if (!has_zero) {
            rests[v] = 1;
            index[v] = 2 - static_cast<int32_t>(closed);
            for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) sign[rings.side[t].half_edge] = 0;
            continue;
        }
        const Cluster cluster = explore_cluster(f, v, NONE, NONE, NONE, 0, 0);
        const bool regular = cluster.complete && cluster.closed_corners == 2 * cluster.euler && (cluster.euler == 0 || cluster.euler == 1);
        if (regular) sign_regular_cluster(f, sign.data());
        for (uint32_t u : f.members) {
            index[u] = 0;
            rests[u] = !regular;
            if (!regular)
                for (uint32_t t = rings.offset[u]; t < rings.offset[u + 1]; ++t) sign[rings.side[t].half_edge] = 0;
        }
        index[v] = static_cast<int32_t>(2 * cluster.euler) - static_cast<int32_t>(cluster.closed_corners);
    }
    // A monogon moves with the vertex on which it hangs.
    for (const uint32_t e : rings.monogons.edges) sign[2 * e] = sign[2 * e + 1] = 0;
    for (uint32_t v = 0; v < n && !rings.monogons.edges.empty(); ++v)
        if (rings.is(v, Monogons::INSIDE)) rests[v] = 1;
    align_signs(mesh, rings);
    if (call && !call->tick(0, true)) return;

    tripod.clear();
    resting = 0;
    uint32_t at = 0;
    for (uint32_t v = 0; v < n; ++v) {
        if (v % stride == 0 && call && !call->tick(0, true)) return;
        offset[v] = at;
        double sum = 0, b = 0;
        int64_t low = INT64_MIN, high = INT64_MAX;
        const uint32_t begin = rings.offset[v], end = rings.offset[v + 1];
        for (uint32_t t = begin; t < end; ++t) {
            const Rings::Side side = rings.side[t];
            const uint32_t h = side.half_edge;
            const int64_t F = f.value[edge_of(h)];
            const double alpha = weight[edge_of(h)];
            const int8_t s = sign[h], back = sign[twin(h)];
            const uint32_t w = mesh.target(h);
            b += alpha * s * static_cast<double>(F);
            int64_t bound = INT64_MAX;
            if (w == v) {
                sum += rests[v] ? alpha : alpha * (s + back) * s;
                if (!rests[v] && s == back) bound = F / 2;
            } else {
                sum += alpha;
                if (rests[v]) {
                } else if (!rests[w]) {
                    column[at] = w;
                    entry[at++] = alpha * s * back;
                } else {
                    bound = F;
                }
            }
            // A tripod on this side of h?
            const uint32_t ahead = rings.side[t + 1 < end ? t + 1 : begin].half_edge;
            const int64_t G = f.value[edge_of(ahead)], opposite = f.value[side.opposite];
            if (F + G > opposite && F + opposite > G && G + opposite > F) {
                if ((F + G - opposite) / 2 < bound) bound = (F + G - opposite) / 2;
                if (h < mesh.next[h] && h < mesh.prev(h)) tripod.push(h);
            }
            if (bound != INT64_MAX) {
                if (s > 0 && bound < high) high = bound;
                if (s < 0 && -bound > low) low = -bound;
            }
        }
        // A vertex that rests keeps its place in the preconditioner: it may move in the next model.
        resting += rests[v];
        diagonal[v] = sum;
        right[v] = rests[v] ? 0 : b;
        lower[v] = rests[v] ? 0 : low;
        upper[v] = rests[v] ? 0 : high;
        d[v] = 0;
    }
    offset[count] = at;
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

// Vertex k stops at its bound; its neighbours get theirs: F - s_k d_k - s d >= 0.
void TwistedModel::rest(const Foliation& f, const Rings& rings, uint32_t k) {
    const int64_t at = static_cast<int64_t>(d[k]);
    for (uint32_t t = rings.offset[k]; t < rings.offset[k + 1]; ++t) {
        const uint32_t h = rings.side[t].half_edge, other = f.mesh.target(h);
        if (rests[other] || other == k) continue;
        const int64_t room = f.at(h) - sign[h] * at;
        if (room < 0) continue; // another branch point is in between
        if (sign[twin(h)] > 0 && room < upper[other]) upper[other] = room;
        if (sign[twin(h)] < 0 && -room > lower[other]) lower[other] = -room;
    }
}

// Projected Gauss-Seidel in the neighbourhood of the patch, whose unknowns rest.
void TwistedModel::relax_around(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance) {
    constexpr uint32_t rings_around = 8, sweeps = 24;
    for (size_t i = 0; i < patch.size(); ++i) {
        const uint32_t k = patch[i];
        if (distance[k] == rings_around) continue;
        for (uint32_t j = offset[k]; j < offset[k + 1]; ++j) {
            const uint32_t other = column[j];
            if (distance[other] != NONE) continue;
            distance[other] = distance[k] + 1;
            patch.push(other);
        }
    }
    for (uint32_t s = 0; s < sweeps; ++s)
        for (size_t i = 0; i < patch.size(); ++i) {
            const uint32_t k = patch[s % 2 ? patch.size() - 1 - i : i];
            d[k] = relaxed(k);
            if (at_bound(k) && distance[k] != 0) {
                distance[k] = 0; // rests from now on
                rest(f, rings, k);
            }
        }
}

void TwistedModel::fix_active(Array<double>& fixed_entry, Array<double>& fixed_right) const {
    for (uint32_t k = 0; k < count; ++k) {
        const bool fixed = at_bound(k);
        double b = fixed ? diagonal[k] * d[k] : right[k];
        for (uint32_t i = offset[k]; i < offset[k + 1]; ++i) {
            const uint32_t other = column[i];
            const bool drop = fixed || at_bound(other);
            if (drop && !fixed) b -= entry[i] * d[other];
            fixed_entry[i] = drop ? 0 : entry[i];
        }
        fixed_right[k] = b;
    }
}

uint64_t TwistedModel::project(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance) {
    patch.clear();
    for (uint32_t k = 0; k < count; ++k) distance[k] = NONE;
    for (uint32_t k = 0; k < count; ++k)
        if (clip(k)) { distance[k] = 0; patch.push(k); }
    const uint64_t active = patch.size();
    for (size_t i = 0; i < active; ++i) rest(f, rings, patch[i]);
    if (active > 0) relax_around(f, rings, patch, distance);
    return active;
}

void TwistedModel::freeze(const Foliation& f, const Rings& rings, uint32_t v, uint32_t radius, Array<uint32_t>& patch,
                          Array<uint32_t>& distance) {
    patch.clear();
    for (uint32_t k = 0; k < count; ++k) distance[k] = NONE;
    // Rings of unknowns round v; distance counts up and is set back below.
    const auto add = [&](uint32_t k, uint32_t ring) {
        if (rests[k] || distance[k] != NONE) return;
        distance[k] = ring;
        patch.push(k);
    };
    add(v, 0);
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
        lower[k] = upper[k] = 0;
    }
    const size_t frozen = patch.size();
    for (size_t i = 0; i < frozen; ++i) rest(f, rings, patch[i]);
    relax_around(f, rings, patch, distance);
}

} // namespace hmf
