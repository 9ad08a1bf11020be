#include "refine_quads.hpp"

#include <algorithm>

#include "quad_shape.hpp"
#include "sharp_edges.hpp"
#include "surface_walk.hpp"

namespace hmf {

namespace {

constexpr uint32_t REFINE_SLICE = 16384; // quads between ticks
constexpr double NEAR_CREASE = 0.25;     // of the side whose middle lies on it

// Every edge gets a vertex in its middle, every quad one in its own:
//
//     d---o---c
//     |   |   |
//     o---o---o
//     |   |   |
//     a---o---b
class Refinement {
public:
    Refinement(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), quads_(quads), call_(call) {}

    Done run() {
        const size_t count = quads_.quad_count(), vertices = quads_.vertex_count() + 3 * count + 2;
        if (!list_edges() || !fine_.allocate(call_.memory, 16 * count) || !quads_.positions.reserve(3 * vertices)
            || !quads_.sides.reserve(vertices) || !quads_.held.reserve(vertices))
            return false;
        for (size_t q = 0; q < count; ++q) {
            if (q % REFINE_SLICE == 0 && !call_.tick(0)) return false;
            if (!divide(q)) return false;
        }
        quads_.quads.swap(fine_);
        return true;
    }

private:
    struct Edge {
        uint32_t other, middle;
    };

    // Room for the edges of each vertex to those of larger numbers.
    Done list_edges() {
        const uint32_t n = quads_.vertex_count();
        if (!first_.allocate_filled(call_.memory, size_t{n} + 1, 0u) || !filled_.allocate_filled(call_.memory, n, 0u))
            return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i)
            ++first_[size_t{std::min(quads_.quads[i], quads_.quads[i / 4 * 4 + (i + 1) % 4])} + 1];
        for (uint32_t v = 0; v < n; ++v) first_[size_t{v} + 1] += first_[v];
        return edges_.allocate(call_.memory, first_[n]);
    }

    // A vertex near p, where the surface is nearest.
    Done add(const double* p, uint32_t side) {
        double nearest[3];
        const uint32_t found = walk_to_nearest(mesh_, position_, side, p, nearest);
        return quads_.add_vertex(nearest, found);
    }

    // The last vertex, if the line on which one end lies passes near the middle.
    void stay_on_crease(const double* p, uint32_t low, uint32_t high) {
        double nearest[3];
        const uint32_t found = walk_along_sharp_edges(mesh_, position_, quads_.sides[low], p, nearest);
        const Point off = point(nearest, 0) - point(p, 0), side = at(quads_, high) - at(quads_, low);
        if (dot(off, off) > NEAR_CREASE * NEAR_CREASE * dot(side, side)) return;
        const uint32_t v = quads_.vertex_count() - 1;
        quads_.put(v, nearest, found);
        quads_.held[v] = ON_CREASE;
    }

    // The vertex in the middle of an edge, made where it is met first.
    Done find_middle(uint32_t a, uint32_t b, uint32_t& middle) {
        const uint32_t low = std::min(a, b), high = std::max(a, b);
        uint32_t i = first_[low];
        while (i < first_[low] + filled_[low] && edges_[i].other != high) ++i;
        if (i == first_[low] + filled_[low]) {
            edges_[i] = {high, quads_.vertex_count()};
            ++filled_[low];
            double p[3];
            for (size_t c = 0; c < 3; ++c)
                p[c] = 0.5 * (quads_.positions[size_t{3} * low + c] + quads_.positions[size_t{3} * high + c]);
            if (!add(p, quads_.sides[low])) return false;
            if (quads_.held[low] == ON_CREASE && quads_.held[high] == ON_CREASE) stay_on_crease(p, low, high);
        }
        middle = edges_[i].middle;
        return true;
    }

    Done divide(size_t q) {
        uint32_t middle[4];
        for (size_t k = 0; k < 4; ++k)
            if (!find_middle(quads_.quads[4 * q + k], quads_.quads[4 * q + (k + 1) % 4], middle[k])) return false;
        double p[3] = {0, 0, 0};
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < 4; ++k) p[c] += 0.25 * quads_.positions[size_t{3} * middle[k] + c];
        const uint32_t center = quads_.vertex_count();
        if (!add(p, quads_.sides[middle[0]])) return false;
        for (size_t k = 0; k < 4; ++k) {
            const uint32_t quad[4] = {quads_.quads[4 * q + k], middle[k], center, middle[(k + 3) % 4]};
            // a-d and b-c still lie on leaves.
            for (size_t c = 0; c < 4; ++c) fine_[16 * q + 4 * k + c] = quad[(c + 4 - k) % 4];
        }
        return true;
    }

    const Mesh& mesh_;
    const double* position_;
    QuadMesh& quads_;
    Call& call_;
    Array<uint32_t> first_, filled_; // per vertex: of edges_, and how many there are
    Array<Edge> edges_;              // of each vertex those to vertices of larger numbers
    Array<uint32_t> fine_;           // the new quads
};

} // namespace

hmf_status refine_quads(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) {
    return Refinement(mesh, position, quads, call).run() ? HMF_OK : call.stopped();
}

} // namespace hmf
