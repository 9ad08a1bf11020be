// The cut graph by tree and cotree, and the layout along the cotree.
//
// 1. A forest of shortest paths from the cones to all vertices.
// 2. A spanning tree of the faces that crosses no edge of the forest and
//    prefers edges that are far from the cones.
// 3. 2 * genus + cones - 1 edges are in neither.  Each of them, with its two
//    paths back to the cones, is a seam.
//
// So few edges are left that step 2 has little to choose: a face with one free
// side takes that, and so on.  What remains are chains of faces around the
// handles and the cones, and to the root; only there edges are sorted.  The others
// hang on these in the order in which they were taken:
//
//      trunk   ===+========+=======+===     laid out breadth first,
//                 |        |       |
//      hanging    +-+--+   +-+     +        then what hangs on it, that taken last first
#include "seams.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../common/nearest_first_rounded.hpp"
#include "../../core/mesh/weights.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t SEAMS_AHEAD = 8;      // what is met in no order is asked for ahead
constexpr uint32_t SEAMS_STRIDE = 16384; // steps between two calls of the progress function

// Dijkstra from all cones at once; parent[v]: half-edge out of v to its parent.
class Forest {
public:
    Array<double> distance;
    Array<uint32_t> parent;
    bool has_cones = false; // else the root is vertex 0

    Done build(const Mesh& mesh, const Stars& stars, const double* length, const uint8_t* is_cone, Call& call) {
        Memory& memory = call.memory;
        heap_.start(memory);
        const uint32_t n = mesh.vertex_count;
        if (!distance.allocate_filled(memory, n, HUGE_VAL) || !parent.allocate_filled(memory, n, NONE)
            || !heap_.reserve(n))
            return false;
        has_cones = false;
        for (uint32_t v = 0; v < n; ++v)
            if (is_cone[v]) {
                has_cones = true;
                distance[v] = 0;
                if (!heap_.push(0, v)) return false;
            }
        if (!has_cones) {
            distance[0] = 0;
            if (!heap_.push(0, 0)) return false;
        }
        while (!heap_.empty()) {
            if (!call.work(64)) return false;
            const NearestFirstRounded::Entry entry = heap_.pop_entry();
            if (!heap_.empty())
                for (const uint32_t h : stars.of(heap_.top())) {
                    prefetch(&length[edge_of(h)]);
                    prefetch(&mesh.origin[twin(h)]);
                }
            // Keys are rounded, so an item may be taken before it is as near as it gets, and is put in again then.
            const double here = distance[entry.item];
            if (key_of(here) < entry.key) continue;
            for (const uint32_t h : stars.of(entry.item)) {
                const uint32_t w = mesh.target(h);
                const double d = here + length[edge_of(h)];
                if (d < distance[w]) {
                    distance[w] = d;
                    parent[w] = twin(h);
                    prefetch(stars.of(w).begin());
                    if (!heap_.push(d, w)) return false;
                }
            }
        }
        return true;
    }

private:
    NearestFirstRounded heap_;
};

// What an edge is to the cut graph: crossed by the trunk of the tree of the faces or where one hangs on another, or on
// a path of the forest.
enum Role : uint8_t { FREE, TRUNK, HANGING, PATH };

// The tree of the faces.
class Cotree {
public:
    Cotree(const Mesh& mesh, uint8_t* role, Call& call) : mesh_(mesh), role_(role), call_(call) {}

    // Takes the edges that there is no choice about: of each face, but the root, that hangs on another one.
    Done prune(uint32_t root, Array<uint32_t>& hanging) {
        const uint32_t faces = mesh_.face_count, sides = 2 * mesh_.edge_count;
        hanging.start(call_.memory);
        if (!free_sides_.allocate(call_.memory, faces) || !hanging.reserve(faces)) return false;
        const auto count = [&](size_t begin, size_t end) {
            for_each_face(mesh_, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                          [&](uint32_t h, uint32_t n, uint32_t p) {
                              free_sides_[mesh_.face[h]] = static_cast<uint8_t>(is_free(h) + is_free(n) + is_free(p));
                          });
        };
        if (!call_.pass(sides, 0, count)) return false;
        ++free_sides_[root];
        // The last sides are those that only the finest level has: neighbors in memory are neighbors on the surface.
        for (uint32_t start = sides; start-- > 0;) {
            // Along a chain: the faces behind the branches of it come later.
            uint32_t h = start;
            for (uint32_t face = mesh_.face[h]; free_sides_[face] == 1; face = mesh_.face[h]) {
                if (hanging.size() % SEAMS_STRIDE == 0 && !call_.tick(0)) return false;
                h = free_side(h);
                role_[edge_of(h)] = HANGING;
                hanging.add(h);
                free_sides_[face] = 0;
                h = twin(h);
                --free_sides_[mesh_.face[h]];
            }
        }
        return true;
    }

    // Chooses among the others, longest paths to the cones first.
    Done choose(const Array<double>& distance, const double* length) {
        KeyedItems edges;
        Array<uint32_t> component;
        uint32_t left = 0;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) left += role_[e] == FREE;
        if (!edges.allocate(call_.memory, left) || !component.allocate(call_.memory, mesh_.face_count)
            || !call_.pass(mesh_.face_count, 0, [&](size_t begin, size_t end) {
                   for (size_t f = begin; f < end; ++f) component[f] = static_cast<uint32_t>(f);
               }))
            return false;
        uint32_t at = 0;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            if (role_[e] != FREE) continue;
            edges.item[at] = e;
            edges.key[at++] = key_of(distance[mesh_.origin[2 * e]] + distance[mesh_.origin[2 * e + 1]] + length[e]);
        }
        edges.sort_falling();
        if (!call_.tick(0)) return false;
        uint32_t steps = 0;
        for (const uint32_t e : edges.item) {
            if (++steps % SEAMS_STRIDE == 0 && !call_.tick(0)) return false;
            if (unite(component.data(), mesh_.face[2 * e], mesh_.face[2 * e + 1])) role_[e] = TRUNK;
        }
        return true;
    }

private:
    bool is_free(uint32_t h) const { return role_[edge_of(h)] == FREE; }
    // The edge of the face of h; without branches, because the processor cannot predict them.
    uint32_t free_side(uint32_t h) const {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        const uint32_t other = is_free(n) ? n : p;
        return is_free(h) ? h : other;
    }

    const Mesh& mesh_;
    uint8_t* role_;
    Call& call_;
    Array<uint8_t> free_sides_; // per face
};

// The seams: free edges with the paths from their ends.
class CutGraph {
public:
    CutGraph(const Mesh& mesh, const Stars& stars, const Array<uint32_t>& parent, uint8_t* on) :
        mesh_(mesh), stars_(stars), parent_(parent), on_(on) {}

    void add(uint32_t edge) {
        on_[edge] = 1;
        mark_path(mesh_.origin[2 * edge]);
        mark_path(mesh_.origin[2 * edge + 1]);
    }
    // A root that is no cone heals, and the path to it.
    void heal(uint32_t root) {
        for (;;) {
            uint32_t degree = 0, last = NONE;
            for (const uint32_t h : stars_.of(root)) {
                if (!on_[edge_of(h)]) continue;
                ++degree;
                last = h;
            }
            if (degree != 1) return;
            on_[edge_of(last)] = 0;
            root = mesh_.target(last);
        }
    }

private:
    void mark_path(uint32_t v) {
        for (uint32_t h = parent_[v]; h != NONE && !on_[edge_of(h)]; h = parent_[mesh_.target(h)]) on_[edge_of(h)] = 1;
    }

    const Mesh& mesh_;
    const Stars& stars_;
    const Array<uint32_t>& parent_; // half-edges
    uint8_t* on_;
};

} // namespace

Done cut_through_cones(const Mesh& mesh, const Stars& stars, const double* length, const uint8_t* is_cone,
                       uint32_t root, Seams& seams, Call& call) {
    const uint32_t m = mesh.edge_count;
    Array<uint8_t>& role = seams.trunk; // in the end: is it TRUNK?
    if (!seams.on.allocate_filled(call.memory, m, 0) || !role.allocate_filled(call.memory, m, FREE)) return false;
    seams.root = root;
    Forest forest;
    Cotree cotree(mesh, role.data(), call);
    if (!forest.build(mesh, stars, length, is_cone, call) || !call.tick(0)) return false;
    for (const uint32_t h : forest.parent)
        if (h != NONE) role[edge_of(h)] = PATH;
    if (!cotree.prune(mesh.face[root], seams.hanging) || !cotree.choose(forest.distance, length)) return false;
    CutGraph graph(mesh, stars, forest.parent, seams.on.data());
    for (uint32_t e = 0; e < m; ++e)
        if (role[e] == FREE) graph.add(e);
    if (!forest.has_cones) graph.heal(0);
    const SeamSum sum = call.parallel.sum_blocks<SeamSum>(m, [&](size_t begin, size_t end) {
        SeamSum part;
        for (size_t e = begin; e < end; ++e) {
            role[e] = role[e] == TRUNK;
            if (!seams.on[e]) continue;
            ++part.count;
            part.length += length[e];
        }
        return part;
    });
    seams.edge_count = sum.count;
    seams.length = sum.length;
    return call.tick(0);
}

Done Layout::build(const Mesh& mesh, const SignBundle& bundle, const TwistedForm& du, const TwistedForm& dv,
                   const Seams& seams, Call& call) {
    Memory& memory = call.memory;
    const size_t sides = size_t{2} * mesh.edge_count;
    Array<uint32_t> trunk; // half-edges, whose faces are laid out
    trunk.start(memory);
    if (!at.allocate(memory, sides) || !chart.allocate_filled(memory, mesh.face_count, 0) || !call.tick(0))
        return false;
    // From the value at h around its face.
    const auto lay = [&](uint32_t h) {
        const int8_t s = chart[mesh.face[h]];
        const uint32_t n = mesh.next[h], p = mesh.next[n];
        at[n] = {at[h].u + s * du.at(bundle, h), at[h].v + s * dv.at(bundle, h)};
        at[p] = {at[n].u + s * du.at(bundle, n), at[n].v + s * dv.at(bundle, n)};
    };
    // The face of t, beside that of its twin.
    const auto lay_beside = [&](uint32_t t) {
        constexpr int64_t limit = int64_t{1} << 52;
        const uint32_t h = twin(t);
        chart[mesh.face[t]] = static_cast<int8_t>(chart[mesh.face[h]] * bundle.turn[edge_of(t)]);
        // Too far from 0 for an exact double: a seam with a translation more.
        const auto inside = [](int64_t x) { return x > limit || x < -limit ? x % limit : x; };
        const Point& beside = at[mesh.next[h]];
        at[t] = {inside(beside.u), inside(beside.v)};
        lay(t);
    };
    chart[mesh.face[seams.root]] = 1;
    at[seams.root] = {0, 0};
    lay(seams.root);
    if (!trunk.push(seams.root)) return false;
    for (size_t i = 0; i < trunk.size(); ++i) {
        if (i % SEAMS_STRIDE == 0 && !call.tick(0)) return false;
        uint32_t h = trunk[i];
        for (uint32_t turn = 0; turn < 3; ++turn, h = mesh.next[h]) {
            const uint32_t t = twin(h);
            if (!seams.trunk[edge_of(h)] || chart[mesh.face[t]] != 0) continue;
            lay_beside(t);
            if (!trunk.push(t)) return false;
        }
    }
    for (size_t i = seams.hanging.size(); i-- > 0;) {
        if (i % SEAMS_STRIDE == 0 && !call.tick(0)) return false;
        if (i >= 2 * SEAMS_AHEAD) {
            prefetch(&mesh.next[seams.hanging[i - 2 * SEAMS_AHEAD]]);
            const uint32_t h = seams.hanging[i - SEAMS_AHEAD], n = mesh.next[h];
            prefetch(&mesh.face[h]);
            prefetch(&mesh.next[n]);
            for (const uint32_t t : {h, n}) {
                prefetch(&at[t]);
                prefetch(&du.value[edge_of(t)]);
                prefetch(&dv.value[edge_of(t)]);
            }
        }
        lay_beside(seams.hanging[i]);
    }
    return true;
}

} // namespace hmf
