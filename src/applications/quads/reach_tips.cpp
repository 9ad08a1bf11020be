// Quads with all vertices on a surface cut its tips and corners off:
//
//          x                 x         x: the vertex of the surface farthest from the
//        /   \             / | \          quads around it
//      o-------o    ->    o  |  o      the corner of its nearest quad goes there whose
//     /         \        /   |   \        quads stay best
#include "../../core/base/heap_sort.hpp"
#include "fit_quads.hpp"
#include "nearest_quads.hpp"
#include "quad_numbers.hpp"
#include "surface_lines.hpp"
#include "surface_walk.hpp"

#include <algorithm>

namespace hmf {

namespace {

struct FarVertex {
    uint32_t vertex, quad; // of the surface, and the quad nearest to it
    double distance;
};

class TipReach {
public:
    TipReach(const Mesh& mesh, const double* position, const SurfaceSearch& surface, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), surface_(surface), quads_(quads), call_(call) {}

    hmf_status run(size_t& moved) {
        moved = 0;
        tips_.start(call_.memory);
        if (!stars_.build(quads_, call_.memory) || !near_.build(quads_, call_.memory) || !find_tips())
            return call_.stopped();
        return reach(moved) ? HMF_OK : call_.stopped();
    }

private:
    // Of the vertices nearest to each quad the farthest, if it is far.
    Done find_tips() {
        double sides = 0;
        for (size_t i = 0; i < quads_.quads.size(); ++i)
            sides += length_of(at(quads_, quads_.quads[i]) - at(quads_, quads_.quads[i / 4 * 4 + (i + 1) % 4]));
        least_ = TAKEN_FROM * sides / static_cast<double>(quads_.quads.size());
        Array<FarVertex> farthest;
        if (!farthest.allocate_filled(call_.memory, quads_.quad_count(), FarVertex{NONE, NONE, 0})) return false;
        for (uint32_t x = 0; x < mesh_.vertex_count; ++x) {
            if (side_at(mesh_, x) == NONE) continue;
            const double least = is_sharp_corner(mesh_, position_, x) ? 0 : least_ * least_;
            const NearestQuads::Place place = near_.find(point(position_, x), least);
            if (!call_.work(place.steps, 0, false)) return false;
            if (place.square > std::max(least, farthest[place.quad].distance))
                farthest[place.quad] = {x, place.quad, place.square};
        }
        for (const FarVertex& tip : farthest)
            if (tip.quad != NONE && !tips_.push(tip)) return false;
        heap_sort(tips_.data(), tips_.size(), [](const FarVertex& a, const FarVertex& b) {
            return a.distance != b.distance ? a.distance > b.distance : a.vertex < b.vertex;
        });
        return true;
    }

    // Farthest first; of two neighbors only the first one moves.
    Done reach(size_t& moved) {
        Array<uint8_t> near;
        if (!near.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0})) return false;
        for (const FarVertex& tip : tips_) {
            if (!call_.work(8192, 0, false)) return false; // up to eight walks on the surface, and quads around them
            Place to;
            uint32_t best = mover(tip, false, near, to);
            const bool there = best != NONE;
            if (!there) best = mover(tip, true, near, to);
            if (best == NONE) continue;
            quads_.put(best, to.p, to.side);
            quads_.held[best] = there ? AT_TIP : ON_WAY_TO_TIP;
            ++moved;
            for (const uint32_t* q = stars_.begin(best); q != stars_.end(best); ++q)
                for (size_t k = 0; k < 4; ++k) near[quads_.quads[4 * size_t{*q} + k]] = 1;
        }
        return true;
    }

    struct Place {
        Point p;
        uint32_t side;
    };

    // The corner of the quad that best goes to the tip, or half of the way; NONE: none can.
    uint32_t mover(const FarVertex& tip, bool half, const Array<uint8_t>& near, Place& to) {
        const Point p = point(position_, tip.vertex);
        uint32_t best = NONE;
        double best_corner = LEAST_TAKEN;
        for (size_t k = 0; k < 4; ++k) {
            const uint32_t v = quads_.quads[4 * size_t{tip.quad} + k];
            const uint8_t held = quads_.held[v];
            if ((held && held != ON_CREASE && held != ON_WAY_TO_TIP) || near[v]) continue;
            Place place;
            place.side = walk_to_nearest(mesh_, position_, quads_.sides[v], p, place.p);
            if (square_of(place.p - p) > 0) continue; // it is on another part of the surface nearby
            if (half)
                place.side = walk_to_nearest(mesh_, position_, quads_.sides[v], 0.5 * (at(quads_, v) + p), place.p);
            const double worst = stars_.worst_corner(surface_, quads_, v, place.p);
            if (!(worst > best_corner)) continue;
            best_corner = worst;
            best = v;
            to = place;
        }
        return best;
    }

    const Mesh& mesh_;
    const double* position_;
    const SurfaceSearch& surface_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    NearestQuads near_;
    Array<FarVertex> tips_;
    double least_ = 0; // distance of what is far
};

} // namespace

hmf_status reach_tips(const Mesh& mesh, const double* position, const SurfaceSearch& surface, QuadMesh& quads,
                      size_t& moved, Call& call) {
    return TipReach(mesh, position, surface, quads, call).run(moved);
}

} // namespace hmf
