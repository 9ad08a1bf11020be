// The conformal scale of a foliation, |grad u|, and how uneven it is.
#pragma once

#include "../../core/base/memory.hpp"
#include "../../core/mesh/mesh.hpp"

namespace hmf {

// Natural logarithm of a positive number, the same bits everywhere.
double natural_log(double x);

struct ConformalScale {
    Array<double> log_scale; // per face: log |grad u| - offset
    double offset = 0;       // of the units of positions and values: nothing else depends on them
    Array<double> area;      // per face, shares of the whole: their sum is 1
    double mean = 0;         // of log_scale over the surface

    // position: of a level, whose largest coordinate is from 1e-30 to 1e30: fourth powers neither overflow nor
    // underflow.  value: per
    // edge.  Reports to the call, if there is one.  |grad u| is at least 1e-7 of the largest. A tripod has the gradient
    // that corresponds to its energy.
    Done measure(const Mesh& mesh, const double* position, const int64_t* value, double unit, Memory& memory,
                 Call* call = nullptr);

    // Standard deviation of log_scale over the surface: 0 for a flat metric that
    // is the surface's own.
    double unevenness() const;
    // How much u changes along the diagonal of the box of these points at the root mean square of |grad u|.
    double across(const double* position, size_t vertex_count) const;

private:
    double variance_ = 0;     // of log_scale over the surface
    double mean_density_ = 0; // of the energy: the mean square of |grad u|
};

} // namespace hmf
