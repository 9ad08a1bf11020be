// A trial of the even design: a coarse surface with marked vertices, its pants
// loops, and the solution for weights of these with its derivatives.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "../loops/dual_length.hpp"
#include "../../core/curves/loops.hpp"
#include "../../core/solve/solve.hpp"
#include "conformal_scale.hpp"
#include "whole_weights.hpp"

#include <cmath>

namespace hmf {

// A mesh on its own.
struct TrialMesh {
    Array<double> position;    // 3 per vertex
    Array<uint32_t> triangles; // 3 per face
    uint32_t vertex_count() const { return static_cast<uint32_t>(position.size() / 3); }
};

class MarkedTrial {
public:
    // Memory comes from the allocator of `like`.  fraction: of the progress of the
    // call, reported while the trial runs.
    MarkedTrial(const hmf_hierarchy& like, Call& call, const double& fraction);

    // The hierarchy, its loops, and weights that suit the surface.  usable() is
    // false where there is no solution to be had.
    // loops: on its coarsest level, as found for the same marks and kind before; empty: they are found.
    hmf_status start(const TrialMesh& surface, const Array<uint32_t>& marks, int32_t kind, Loops& loops);
    // The minimum for the weights; usable() as above.
    hmf_status solve();
    // After solve(): the derivatives of the log scale by the logarithms of the weights.
    // known: false where they could not be had.
    hmf_status derive(bool& known);
    // The step of the logarithms of the weights that is best for the derivatives, damped.
    hmf_status best_step(double damping, Array<double>& step);

    bool usable() const { return usable_; }
    double unevenness() const { return scale_.unevenness(); }
    double across() const { return scale_.across(h_.levels[0].position, h_.input.vertex_count); }
    const ConformalScale& scale() const { return scale_; } // by internal faces of level 0
    const hmf_hierarchy& hierarchy() const { return h_; }
    const Loops& loops() const { return loops_; } // on the coarsest level
    Array<double> weights;                        // 0: left out; then there are no derivatives
    // log |grad u| at the vertices of the surface.
    Done vertex_scale(Array<double>& out, Memory& memory) const;
    double derivative(size_t loop, size_t face) const { return derivative_[loop * scale_.area.size() + face]; }
    bool has_derivative(size_t face) const { return smooth_[face]; }

private:
    // A failure inside: memory and cancellation end the search, others this trial.
    hmf_status failed(Call& inner);
    Done find_nearest_loops(const DualLength& dual, const Array<uint32_t>& side, Array<uint32_t>& nearest);
    Done guess_weights();
    hmf_status count_crossings(Array<uint32_t>& offsets, Array<uint32_t>& edges, bool& known);

    struct Linearized;
    struct SmoothTriangle;
    Done linearize(Linearized& at);
    Done list_smooth_triangles(Array<SmoothTriangle>& out);
    Done change_values(const uint32_t* crossed, size_t count, Linearized& at);
    void set_derivative(size_t loop, const Array<double>& change, const Array<SmoothTriangle>& triangles);

    static int32_t pass_on(void* user, double fraction);
    // The progress of the search, seen from a trial.
    struct Progress {
        Call& call;
        const double& fraction;
    };

    Call& outer_;
    Progress progress_;
    hmf_error error_{};
    hmf_hierarchy h_;
    Call call_; // of the trial
    bool usable_ = false;
    Loops loops_;
    State state_;
    double factor_ = 1; // units per unit of the weights in integers
    Array<int64_t> integer_weights_;
    ConformalScale scale_;
    Array<int64_t> solved_;       // values on the intrinsic side of level 0
    Array<int64_t> input_values_; // and on the other one
    Array<double> derivative_;    // loops x faces
    Array<uint8_t> smooth_;       // per face
};

} // namespace hmf
