// The quadratic model of the direct method: the energy for fixed signs of the local potentials.
//
// At a regular cluster (two directions, index 0) one direction is called +
// and the other -; half-edge h has the sign s_h of the direction it leaves in.
// Moving vertex i by d_i into its + direction changes the value of an edge to
//
//     F'_ij = | F_ij - s_ij d_i - s_ji d_j |
//
// and the energy sum alpha F'^2 is quadratic in d.  Zero edges inside a
// regular cluster get opposite signs at their two ends: F' = |d_i - d_j|.
// Vertices of other clusters (zeros) are fixed.  Marked vertices never move, and
// vertices that share a regular cluster with one are fixed for this step, as the signs
// change when one goes around a marked vertex.  Their neighbors may pass them:
// the value is the distance before and after.  The model is exact while
//
//     s d_v <= a_v        at every corner of a tripod: stop at its branch point
//     s d_v <= F_vm       at every v beside a zero m, which is fixed: stop there
//
// and no vertex becomes an extremum of the local potential.  A vertex that
// stops at a branch point is fixed there: its neighbors must not pass it,
// either.
#pragma once

#include "../foliation/whitehead.hpp"
#include "../linear/linear_solver.hpp"

namespace hmf {

struct TwistedModel {
    uint32_t count = 0;          // unknowns: one per vertex; the entries of fixed ones are 0
    Array<int8_t> sign;          // per half-edge; 0 where the origin is fixed
    Array<uint8_t> is_fixed;     // per vertex
    Array<uint32_t> fixed_zeros; // the fixed vertices that no neighbor may pass: zeros
    Array<uint32_t> tripod;      // a half-edge of each, before the step
    Array<int32_t> index;        // per vertex, before the step; a cluster's at one of its vertices
    double energy = 0;           // before the step, in squared units
    double residual_max = 0;     // before the step, over all vertices ([W] Eq. 4),
    double residual_sum = 0;     // and their sum
    // The matrix has the sides of the rings as entries, 0 for edges from a
    // vertex to itself.
    const uint32_t* offset = nullptr; // count + 1
    const uint32_t* column = nullptr;
    Array<double> entry;
    Array<uint8_t> changed;        // count, rows with other entries since they were last solved for
    Array<double> diagonal, right; // count
    Array<int64_t> lower, upper;   // count, bounds of d; INT64_MIN and INT64_MAX where there is none
    Array<uint32_t> bounded;       // unknowns that have a bound, in any order
    Array<double> d;               // count, the solution
    Array<float> row_scale;        // count, makes a row of the residual of the equations that of [W] Eq. 4
    Array<uint32_t> at_bounds;     // unknowns that the equations leave out, by fix_active()

    Done allocate(const Mesh& mesh, Memory& memory, const Parallel& parallel = Parallel());
    // Signs, right side, zeros, energy and residual of the current foliation.
    // The choice of the + direction is free. The previous one is kept if the pulls agree with it, so that the matrix
    // hardly changes away from the zeros.
    Done linearize(Foliation& f, const Rings& rings, const double* weight, Star& star, Call& call);
    // Matrix and bounds, after linearize().  Stops half-way if the call is cancelled.
    void assemble(const Foliation& f, const Rings& rings, const double* weight, Call& call);
    LinearSystem system() { return {matrix(), right.data(), d.data(), is_fixed.data(), row_scale.data(), is_exact()}; }
    SignedMatrix matrix() const { return {count, offset, column, entry.data(), diagonal.data()}; }
    // No zeros, hence no bounds: one step reaches the minimum.
    bool is_exact() const { return tripod.empty() && fixed_zeros.empty(); }
    // Brings d into the bounds and improves it near the bounds that are
    // active by projected Gauss-Seidel; returns the number of active bounds.
    uint64_t project(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance);
    // Fixes the unknowns at a bound while the others are solved for.
    void fix_active();
    // Releases those of them whose gradient points away from the bound; true: there were any.
    bool release();
    // Fixes the vertices within some rings of the given ones, and adapts the bounds of the others.
    void fix_around(const Foliation& f, const Rings& rings, const Array<uint32_t>& from, uint32_t radius,
                    Array<uint32_t>& patch, Array<uint32_t>& distance);
    // New value of d_v from its neighbors, within the bounds.
    double relaxed(uint32_t unknown_index) const;
    // d_k has come to a bound, and which one, exactly.
    bool at_bound(uint32_t k) const {
        return d[k] == static_cast<double>(lower[k]) || d[k] == static_cast<double>(upper[k]);
    }
    int64_t bound_at(uint32_t k) const { return d[k] == static_cast<double>(lower[k]) ? lower[k] : upper[k]; }

private:
    // Sum and largest of some residuals.
    struct Residuals {
        double sum = 0, max = 0;
        void add(double r) {
            sum += r;
            if (r > max) max = r;
        }
    };
    // Which vertices a pass visits: regular ones without a tripod add nothing to the lists, so blocks can process them.
    enum class Kind : uint8_t { regular, any };
    bool look_at_plain_vertex(const Foliation& f, const Rings& rings, const double* weight, uint32_t v, double floor,
                              Kind kind, Residuals& residuals);
    bool set_signs(const Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight, uint64_t second);
    Done look_at_cluster(Foliation& f, const Rings& rings, const double* weight, uint32_t v, double floor);
    Done find_tripods(Foliation& f, const Rings& rings, uint32_t v);
    void fix(const Rings& rings, uint32_t v);
    void fix_zero(const Rings& rings, uint32_t v);
    void fill_row_with_self_edges(const Foliation& f, const Rings& rings, const double* weight, uint32_t v);
    void bound(uint32_t k, int64_t low, int64_t high);
    void bound_along(uint32_t k, uint32_t half_edge, int64_t room);
    bool clip(uint32_t k);
    void fix_at_bound(const Foliation& f, const Rings& rings, uint32_t k);
    void relax_around(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance);

    Array<uint32_t> special_; // vertices whose residual needs the whole star
};

} // namespace hmf
