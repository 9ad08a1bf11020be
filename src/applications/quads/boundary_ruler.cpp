#include "boundary_ruler.hpp"

#include "../lines/polyline.hpp"

namespace hmf {

Done BoundaryRuler::push_on_boundary(const QuadInput& in, double value, uint32_t vertex, bool ahead, bool round) {
    const Reflection& mirror = *in.front->reflection;
    if (!mirror.is_boundary[vertex]) return true;
    const auto side_at = [&](uint32_t w) { // the half-edge along the boundary, in front
        uint32_t h = in.f.mesh.out[w];
        while (!mirror.on_boundary(h) || !mirror.is_front[h]) h = in.f.mesh.rotate_ccw(h);
        return h;
    };
    const auto side_before = [&](uint32_t w) { // the one that ends there
        uint32_t h = in.f.mesh.out[w];
        while (!mirror.on_boundary(h) || mirror.is_front[h]) h = in.f.mesh.rotate_ccw(h);
        return twin(h);
    };
    const auto at = [&](uint32_t w) { return in.position + size_t{3} * w; };
    const double before = v.empty() ? value : v.back();
    const auto walk = [&](double whole, double& length) -> Done {
        length = 0;
        bool first = round;
        for (uint32_t w = last_; w != vertex || first;) {
            first = false;
            const uint32_t h = ahead ? side_at(w) : side_before(w);
            const uint32_t next = ahead ? in.f.mesh.target(h) : in.f.mesh.origin[h];
            length += distance(at(w), at(next));
            w = next;
            if (whole > 0 && w != vertex && !push(before + (value - before) * (length / whole), at(w), side_at(w)))
                return false;
        }
        return true;
    };
    double whole = 0, length = 0;
    if (!v.empty() && (!walk(0, whole) || !walk(whole, length))) return false;
    last_ = vertex;
    return push(value, at(vertex), side_at(vertex));
}

} // namespace hmf
