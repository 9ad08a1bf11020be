#include "quad_input.hpp"

#include "../lines/polyline.hpp"

namespace hmf {

Point QuadInput::place_of(const Crossing& c) const {
    double p[3];
    point_at(f, position, c, p);
    return point(p, 0);
}

Done BoundaryRuler::push_on_boundary(const QuadInput& in, double value, uint32_t vertex, bool ahead, bool round) {
    const Mesh& mesh = in.f.mesh;
    const Reflection& mirror = *in.front->reflection;
    if (!mirror.is_boundary[vertex]) return true;
    // The half-edge along the boundary, in front, that begins at w, or the one that ends there.
    const auto side_at = [&](uint32_t w, bool begins) {
        uint32_t h = mesh.out[w];
        while (!mirror.on_boundary(h) || mirror.is_front[h] != begins) h = mesh.rotate_ccw(h);
        return begins ? h : twin(h);
    };
    const double before = v.empty() ? value : v.back();
    const auto walk = [&](double whole, double& length) -> Done {
        length = 0;
        bool first = round;
        for (uint32_t w = last_; w != vertex || first;) {
            first = false;
            const uint32_t h = side_at(w, ahead), next = ahead ? mesh.target(h) : mesh.origin[h];
            length += length_of(hmf::point(in.position, next) - hmf::point(in.position, w));
            w = next;
            if (whole > 0 && w != vertex
                && !push(before + (value - before) * (length / whole), hmf::point(in.position, w), side_at(w, true)))
                return false;
        }
        return true;
    };
    double whole = 0, length = 0;
    if (!v.empty() && (!walk(0, whole) || !walk(whole, length))) return false;
    last_ = vertex;
    return push(value, hmf::point(in.position, vertex), side_at(vertex, true));
}

} // namespace hmf
