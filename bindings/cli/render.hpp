// A picture of a foliation: a pattern on the surface, zeros blue with their order, poles yellow, marked vertices
// violet, loops green.
#pragma once

#include <cstdint>
#include <vector>

#include <hmf/applications.h>

#include "camera.hpp"
#include "canvas.hpp"
#include "loop_lines.hpp"
#include "potential.hpp"

namespace cli {

enum class Pattern : int32_t {
    stripes,      // along the leaves
    checkerboard, // squares of (u, v)
    quads,        // the grid of a quad mesh
    dilatation,   // how far from conformal the parameterization is
    scale,        // log |grad u| from its mean
};

struct PictureStyle {
    Pattern pattern = Pattern::stripes;
    unsigned width = 1400, height = 1050;
    bool has_view = false; // else the best one
    View view;
    bool legend = false;
};

// What the patterns other than stripes need.
struct PictureData {
    const double* corner_uv = nullptr;  // checkerboard: (u, v) of each corner
    const double* dilatation = nullptr; // of each triangle
    std::vector<double> log_scale;      // of each triangle
    std::vector<const hmf_quad_mesh*> quads;
};

// Components without a foliation are gray.  control lends threads; the same bytes with every number of them.
Image render(const Foliation& foliation, const Potential& potential, const PictureData& data,
             const std::vector<Line>& loops, const PictureStyle& style, const hmf_control* control = nullptr);

} // namespace cli
