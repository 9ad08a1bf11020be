// The one optimizer that moves the vertices of quads on their surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

class QuadOptimizer {
public:
    // quads: their places change, not which they are.  What is held AT_BOUNDARY slides along the boundary, ON_CREASE
    // along sharp edges, free vertices move on the surface, and others stay.
    QuadOptimizer(const Mesh& mesh, const double* position, const SurfaceSearch& surface, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), surface_(surface), quads_(quads), call_(call) {}

    [[nodiscard]] hmf_status start();

    // Turns folded quads over, in rounds: in the first one all vertices move, in the second one those around them, in
    // the third one those farther around, of which what is held is released, in the fourth one likewise.
    [[nodiscard]] hmf_status untangle(int first_round = 0);

    // Makes at most the given number of sweeps over the vertices; no sweep folds a corner that is not folded.
    [[nodiscard]] hmf_status shape(int sweeps);

    // Vertices were moved from outside, or are held otherwise.
    void look_again();

    // As it is counted (quad_figures.hpp); remembered until a vertex of the quad moves.
    bool is_folded(size_t q);

private:
    struct Slopes { // of the energy, by two directions along the surface
        double energy = 0, g[2] = {0, 0}, h[3] = {0, 0, 0};
    };
    struct Axes {
        Point first, second;
    };

    Point normal_of(const uint32_t* corner, double* bend = nullptr) const;
    Slopes slopes(uint32_t v, const Axes* axes, double* areas) const;
    Axes axes_at(uint32_t v) const;
    double side_of(uint32_t v) const;
    bool move(uint32_t v);
    bool folds_no_more(uint32_t v);
    bool try_step(uint32_t v, const Axes& axes, const double* step, double before);
    Done sweep(bool forward, double& moved);
    Done set_targets();
    double least_area() const;
    Done count_folded(size_t& count);
    bool find_folded(size_t q) const;
    Done mark_region(int rings, bool lets_go);
    [[nodiscard]] hmf_status untangle_round(int round);
    bool is_fixed(uint32_t v) const { return quads_.held[v] && !can_slide(quads_.held[v]); }
    void wake(uint32_t v);

    const Mesh& mesh_;
    const double* position_;
    const SurfaceSearch& surface_;
    QuadMesh& quads_;
    Call& call_;
    SurfaceNormals normals_;
    QuadStars stars_;
    Array<Point> normal_;           // of the surface, at each vertex
    Array<double> target_, weight_; // of each quad: area wished, weight of its growth
    Array<uint8_t> awake_;          // per vertex: it, or what is near it, has moved since its last step
    Array<uint8_t> region_;         // per vertex: may move; empty: all may
    Array<double> before_, after_;  // areas of corners around one vertex
    Array<uint8_t> folded_;         // per quad: 0, 1, or not known since a vertex of it moved
    Array<uint8_t> around_;         // likewise, of the quads around one vertex after a step
    double mean_ = 0;               // area of the quads
    double eps_ = 0, growth_ = 0;
    bool barrier_ = true;
};

} // namespace hmf
