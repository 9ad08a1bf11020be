// Which of its two directions each half-edge of a regular cluster leaves in.
#include "foliation.hpp"

namespace hmf {

double sign_regular_cluster(const Foliation& f, const double* weight, int8_t* sign) {
    constexpr int8_t unvisited = 4; // is added to the sign that was there
    const Mesh& mesh = f.mesh;
    uint32_t closed_start = NONE;
    size_t sides = 0;
    for (uint32_t v : f.members) {
        for (const uint32_t h : mesh.around(v)) {
            const uint32_t ahead = mesh.rotate_ccw(h);
            ++sides;
            sign[h] = f.at(h) != 0 ? static_cast<int8_t>(sign[h] + unvisited) : h & 1 ? -1 : 1;
            if (f.at(h) != 0 && f.at(ahead) != 0 && f.corner2(h) == 0) closed_start = ahead;
        }
    }
    double agreement = 0;
    // One turn around the boundary meets each side at most once per zero edge beside it.
    const auto sign_boundary = [&](uint32_t start, int8_t s) {
        uint32_t g = start;
        for (size_t step = 0; step < 4 * sides; ++step) {
            if (sign[g] > 1) agreement += (sign[g] - unvisited) * s * weight[edge_of(g)] * static_cast<double>(f.at(g));
            sign[g] = s;
            bool closed = false;
            g = next_round(f, g, closed);
            if (closed) s = static_cast<int8_t>(-s);
            if (g == start) return;
        }
    };
    if (closed_start != NONE) {
        sign_boundary(closed_start, 1);
        return agreement;
    }
    int8_t s = 1;
    for (uint32_t v : f.members) {
        for (const uint32_t h : mesh.around(v))
            if (sign[h] > 1) {
                sign_boundary(h, s);
                s = -1;
            }
    }
    return agreement;
}

} // namespace hmf
