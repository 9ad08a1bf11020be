#include "dual_length.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

DualLength::DualLength(const Mesh& mesh, const double* position) : mesh_(mesh), position_(position) {
    for (size_t i = 0; i < 3 * size_t{mesh.vertex_count}; ++i) {
        const double x = position[i] < 0 ? -position[i] : position[i];
        largest_ = std::max(largest_, x);
    }
    if (!(largest_ > 0)) largest_ = 1;
}

double DualLength::operator()(uint32_t edge) const {
    // To 24 bits: what is equal by symmetry stays equal in another unit.
    return static_cast<double>(static_cast<float>(from_middle(2 * edge) + from_middle(2 * edge + 1)));
}

// From the middle of its edge to the center of its triangle: the mean of the middles of the sides, each as often as it
// is long.
double DualLength::from_middle(uint32_t half_edge) const {
    const uint32_t corner[3] = {mesh_.origin[half_edge], mesh_.target(half_edge), mesh_.origin[mesh_.prev(half_edge)]};
    double middle[3], to[3] = {0, 0, 0}, total = 0;
    for (uint32_t side = 0; side < 3; ++side) {
        double length = 0, here[3];
        for (uint32_t a = 0; a < 3; ++a) {
            const double p = position_[3 * size_t{corner[side]} + a] / largest_;
            const double q = position_[3 * size_t{corner[(side + 1) % 3]} + a] / largest_;
            length += (q - p) * (q - p);
            here[a] = (p + q) / 2;
            if (side == 0) middle[a] = here[a];
        }
        length = std::sqrt(length);
        for (uint32_t a = 0; a < 3; ++a) to[a] += length * (here[a] - middle[a]);
        total += length;
    }
    return total > 0 ? std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) / total : 0;
}

} // namespace hmf
