// Normals of a surface with creases.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vec.hpp"
#include "workers.hpp"

namespace cli {

// Of the corners of triangles: the mean over those around the vertex that do not lie beyond a crease, weighted as on a
// sphere (Max 1999).  Outward.
class Normals {
public:
    // component: of each triangle, empty: one; orientation is that of each component.
    Normals(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles,
            const std::vector<uint32_t>& component, const Workers& workers);

    std::array<Vec, 3> of(size_t t) const {
        const uint32_t* const v = &t_[3 * t];
        const double out = outward_[component(t)];
        return {out * corner(v[0], t), out * corner(v[1], t), out * corner(v[2], t)};
    }

private:
    size_t component(size_t t) const { return component_.empty() ? 0 : component_[t]; }
    // Without a crease at the vertex all its corners have one normal.
    Vec corner(uint32_t v, size_t t) const { return has_crease_[v] ? mean(v, &face_[t]) : vertex_[v]; }
    Vec mean(uint32_t v, const Vec* face) const;
    void orient();
    void find_rings();
    void find_vertex(uint32_t v);

    const std::vector<Vec>& p_;
    const std::vector<uint32_t>&t_, &component_;
    std::vector<double> outward_; // of each component: 1 or -1
    std::vector<Vec> face_, vertex_;
    std::vector<uint8_t> has_crease_;
    std::vector<uint32_t> start_, around_; // the corners at each vertex
};

} // namespace cli
