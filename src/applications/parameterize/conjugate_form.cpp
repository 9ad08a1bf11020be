// The conjugate of a harmonic form.
//
// The flux weight * du across an edge is the change of v between the centers
// of its two triangles: v grows to the left of the gradient of u, so across
// half-edge h, from its left face to its right one, v falls by weight * du(h).
// At a vertex the fluxes add up to 0 (du is coclosed), so v is known at the
// centers around it, up to a constant, and v at the vertex is their mean:
//
//              . V2 .
//           .    |    .              v(vertex) - V  in each face left of h, so
//         V3 --- * --- V1            dv(h) = q[next h] - q[h],  q = v(corner) - V(face)
//           '    |    '
//              ' V4 '                around an odd zero: v -> K - v, so v = K / 2 there
//
// Fluxes are rounded to multiples of 4; what then is missing to 0 at a vertex
// is carried along a forest to the zeros.  All after that is exact: dv is
// closed, the same from both sides of an edge, and has the periods of the flux.
#include "harmonic_form.hpp"

namespace hmf {

namespace {

constexpr uint32_t CONJUGATE_STRIDE = 65536; // vertices between two reports

class Fluxes {
public:
    Fluxes(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts, TwistedForm& flux) :
        mesh_(mesh), bundle_(bundle), charts_(charts), flux_(flux) {}

    // Multiples of 4, so that halves of what is missing are even.
    bool round(const double* weight, const TwistedForm& du, const Parallel& parallel) {
        return parallel.sum_blocks<uint32_t>(mesh_.edge_count, [&](size_t begin, size_t end) {
            uint32_t too_large = 0;
            for (size_t e = begin; e < end; ++e) {
                double x = 0.25 * weight[e] * static_cast<double>(du.value[e]);
                if (!(x > -1e18 && x < 1e18)) {
                    too_large = 1;
                    x = 0;
                }
                flux_.value[e] = 4 * static_cast<int64_t>(x < 0 ? x - 0.5 : x + 0.5);
            }
            return too_large;
        }) == 0;
    }

    Done balance(Call& call) {
        Memory& memory = call.memory;
        const uint32_t n = mesh_.vertex_count;
        constexpr uint32_t unseen = NONE - 1;
        if (!parent_.allocate_filled(memory, n, unseen) || !order_.allocate(memory, n)) return false;
        uint32_t size = 0;
        for (uint32_t v = 0; v < n; ++v)
            if (charts_.odd[v]) {
                parent_[v] = NONE;
                order_[size++] = v;
            }
        const bool has_odd = size > 0;
        if (!has_odd) {
            parent_[0] = NONE;
            order_[size++] = 0;
        }
        const uint32_t roots = size;
        for (uint32_t i = 0; i < size; ++i) {
            if (i % CONJUGATE_STRIDE == 0 && !call.tick(0)) return false;
            if (size - i > 3 * Stars::AHEAD) {
                prefetch(&charts_.stars.offset[order_[i + 3 * Stars::AHEAD]]);
                prefetch(charts_.stars.of(order_[i + 2 * Stars::AHEAD]).begin());
                for (const uint32_t h : charts_.stars.of(order_[i + Stars::AHEAD])) prefetch(&mesh_.origin[twin(h)]);
            }
            for (const uint32_t h : charts_.stars.of(order_[i])) {
                const uint32_t w = mesh_.target(h);
                if (parent_[w] == unseen) {
                    parent_[w] = twin(h);
                    order_[size++] = w;
                }
            }
        }
        // What is missing is read in the order of memory, and kept up to date on the way to the roots.  At odd zeros
        // nothing is read: it would not be small.
        Array<int64_t> rest;
        if (!rest.allocate(memory, n) || !call.pass(n, 0, [&](size_t begin, size_t end) {
                for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
                    if (end - v > Stars::AHEAD)
                        for (const uint32_t h : charts_.stars.of(v + Stars::AHEAD)) prefetch(&flux_.value[edge_of(h)]);
                    rest[v] = charts_.odd[v] ? 0 : missing(v);
                }
            }))
            return false;
        for (uint32_t i = size; i-- > roots;) {
            if (i % CONJUGATE_STRIDE == 0 && !call.tick(0)) return false;
            if (i >= roots + 2 * Stars::AHEAD) {
                prefetch(&parent_[order_[i - 2 * Stars::AHEAD]]);
                const uint32_t soon = order_[i - Stars::AHEAD], h = parent_[soon];
                prefetch(&rest[soon]);
                prefetch(&charts_.chart[h]);
                prefetch(&flux_.value[edge_of(h)]);
                prefetch(&mesh_.origin[twin(h)]);
            }
            const uint32_t v = order_[i], h = parent_[v];
            carry(v, rest[v]);
            // The same from the other side.
            const int chart = charts_.chart[h] * charts_.chart[twin(h)] * bundle_.turn[edge_of(h)];
            rest[mesh_.target(h)] += chart * rest[v];
        }
        assert(has_odd || rest[0] == missing(0));
        return has_odd || rest[0] == 0 || turn_round(size, memory);
    }

private:
    int64_t missing(uint32_t v) const {
        int64_t sum = 0;
        for (const uint32_t h : charts_.stars.of(v)) sum += charts_.chart[h] * flux_.at(bundle_, h);
        return sum;
    }

    // What is missing at v, to its parent.
    void carry(uint32_t v, int64_t rest) {
        const uint32_t h = parent_[v];
        flux_.add(bundle_, h, -charts_.chart[h] * rest);
    }

    // No odd zero, but closed paths that come back with the opposite sign: half
    // of what is missing at the root goes around one of them.
    Done turn_round(uint32_t size, Memory& memory) {
        Array<int8_t> gauge; // of each vertex against the root, along the tree
        if (!gauge.allocate(memory, mesh_.vertex_count)) return false;
        gauge[0] = 1;
        // The chart of w in that of v, for h from v to w.
        const auto relative = [&](uint32_t h) {
            return static_cast<int8_t>(charts_.chart[h] * charts_.chart[mesh_.next[h]]);
        };
        for (uint32_t i = 1; i < size; ++i) {
            const uint32_t v = order_[i];
            gauge[v] = static_cast<int8_t>(gauge[mesh_.target(parent_[v])] * relative(parent_[v]));
        }
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            const uint32_t h = 2 * e, v = mesh_.origin[h], w = mesh_.target(h);
            if (gauge[v] * gauge[w] == relative(h)) continue;
            flux_.add(bundle_, h, -gauge[v] * charts_.chart[h] * (missing(0) / 2));
            for (uint32_t x = v; x != 0; x = mesh_.target(parent_[x])) carry(x, missing(x));
            for (uint32_t x = w; x != 0; x = mesh_.target(parent_[x])) carry(x, missing(x));
            break;
        }
        return true;
    }

    const Mesh& mesh_;
    const SignBundle& bundle_;
    const VertexCharts& charts_;
    TwistedForm& flux_;
    Array<uint32_t> parent_, order_; // half-edge to the parent; vertices, parents first
};

} // namespace

hmf_status conjugate_form(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts, const double* weight,
                          const TwistedForm& du, TwistedForm& dv, Call& call) {
    TwistedForm flux;
    Array<int64_t> q; // per half-edge: v at its origin minus V of its face, in the chart of the face
    if (!flux.value.allocate(call.memory, mesh.edge_count) || !q.allocate(call.memory, size_t{2} * mesh.edge_count)
        || !dv.value.allocate(call.memory, mesh.edge_count))
        return call.out_of_memory();
    Fluxes fluxes(mesh, bundle, charts, flux);
    if (!fluxes.round(weight, du, call.parallel))
        return call.fail(
            HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
            "The flux of the foliation is too large for 62 bits. Improve the worst triangles of the mesh.");
    if (!call.tick(0)) return HMF_CANCELLED;
    if (!fluxes.balance(call)) return call.stopped();
    const auto walk_round = [&](uint32_t v) {
        int64_t V = 0;
        double sum = 0;
        const Stars::Star star = charts.stars.of(v);
        for (uint32_t t = 0; t < star.size(); ++t) {
            const uint32_t h = star[t];
            q[h] = V;
            sum += static_cast<double>(V);
            V -= charts.chart[h] * flux.at(bundle, twin(star.after(t)));
        }
        const int64_t mean = charts.odd[v] ? V / 2 : static_cast<int64_t>(sum / star.size());
        for (const uint32_t h : star) q[h] = charts.chart[h] * (mean - q[h]);
    };
    const auto walk = [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
            if (end - v > Stars::AHEAD)
                for (const uint32_t h : charts.stars.of(v + Stars::AHEAD)) {
                    prefetch(&flux.value[edge_of(h)]);
                    prefetch(&q[h]);
                }
            walk_round(v);
        }
    };
    const auto differ = [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e) dv.value[e] = q[mesh.next[2 * e]] - q[2 * e];
    };
    if (!call.pass(mesh.vertex_count, 0, walk) || !call.pass(mesh.edge_count, 0, differ)) return HMF_CANCELLED;
#ifndef NDEBUG
    for (uint32_t h = 1; h < 2 * mesh.edge_count; h += 2) assert(dv.at(bundle, h) == q[mesh.next[h]] - q[h]);
#endif
    return HMF_OK;
}

} // namespace hmf
