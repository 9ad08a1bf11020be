#include "dual_length.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

DualLength::DualLength(const Mesh& mesh, const double* position, double ambiguous) :
    mesh_(mesh), position_(position), ambiguous_(ambiguous) {
    for (size_t i = 0; i < 3 * size_t{mesh.vertex_count}; ++i) {
        const double x = position[i] < 0 ? -position[i] : position[i];
        largest_ = std::max(largest_, x);
    }
    if (!(largest_ > 0)) largest_ = 1;
}

double DualLength::operator()(uint32_t edge) const {
    const uint32_t h = 2 * edge;
    double middle[3], sum = 0;
    for (uint32_t a = 0; a < 3; ++a)
        middle[a] = (position_[3 * size_t{mesh_.origin[h]} + a] / largest_
                     + position_[3 * size_t{mesh_.origin[h + 1]} + a] / largest_)
                  / 2;
    for (uint32_t side = h; side < h + 2; ++side) {
        const uint32_t corner = mesh_.origin[mesh_.prev(side)];
        double square = 0;
        for (uint32_t a = 0; a < 3; ++a) {
            // The centre lies a third of the way from the middle to the corner.
            const double d = (position_[3 * size_t{corner} + a] / largest_ - middle[a]) / 3;
            square += d * d;
        }
        sum += std::sqrt(square);
    }
    return ambiguous_ != 1 && is_ambiguous(edge) ? ambiguous_ * sum : sum;
}

bool DualLength::is_ambiguous(uint32_t edge) const {
    const uint32_t h = 2 * edge, g = mesh_.face[h + 1];
    const auto borders = [&](uint32_t k) { return k != h && k != h + 1 && mesh_.face[twin(k)] == g; };
    return mesh_.face[h] == g || borders(mesh_.next[h]) || borders(mesh_.prev(h));
}

} // namespace hmf
