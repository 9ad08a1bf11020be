#include "near_zeros.hpp"

#include "parameters.hpp"

namespace hmf {

void NearZeros::pick() {
    const Mesh& mesh = f_.mesh;
    picked_.clear();
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) distance_[v] = NONE;
    const auto add = [&](uint32_t v, uint32_t ring) {
        if (distance_[v] != NONE) return;
        distance_[v] = ring;
        picked_.add(v);
    };
    // Every zero is where it was before the step, or at a vertex next to that.
    for (uint32_t v : model_.fixed_zeros) add(v, 0);
    for (uint32_t h : model_.tripod) {
        const uint32_t corners[3] = {h, mesh.next[h], mesh.prev(h)};
        for (uint32_t g : corners) add(mesh.origin[g], 0);
    }
    for (size_t i = 0; i < picked_.size(); ++i) {
        const uint32_t v = picked_[i];
        if (distance_[v] == parameters::NEAR_RINGS) continue;
        for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t)
            add(w_.rings.neighbor[t], distance_[v] + 1);
    }
}

void NearZeros::relax() {
    pick();
    const size_t n = f_.mesh.vertex_count, passes = parameters::local_passes(picked_.size(), n);
    everywhere_ = parameters::are_most(picked_.size(), n);
    // The last pass in which a vertex has a reason to move; NONE: not picked.
    Array<uint32_t>& due = distance_;
    for (uint32_t v : picked_) due[v] = 0;
    const double negligible = parameters::CLOSE * model_.residual_max;
    for (uint32_t pass = 0; pass < passes && w_.go_on(); ++pass)
        for (size_t i = 0; i < picked_.size(); ++i) {
            const uint32_t v = picked_[pass % 2 ? picked_.size() - 1 - i : i];
            if (due[v] < pass) continue;
            SweepResult result;
            if (!relax_vertex(f_, w_.rings, weight_, v, w_.star, result) || result.largest <= negligible) continue;
            due[v] = pass + 1;
            for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                uint32_t& neighbor = due[w_.rings.neighbor[t]];
                if (neighbor != NONE) neighbor = pass + 1;
            }
        }
}

bool NearZeros::move_zeros(double residual) {
    bool moved = false;
    for (const uint32_t v : model_.fixed_zeros) {
        if (residual_at(f_, w_.rings, weight_, v, 0, w_.star) <= residual) continue;
        SweepResult result;
        moved |= relax_vertex(f_, w_.rings, weight_, v, w_.star, result);
    }
    return moved;
}

Done NearZeros::list(ZeroList& zeros) const {
    zeros.vertices.clear();
    zeros.tripods.clear();
    for (uint32_t v : model_.fixed_zeros)
        if (!zeros.vertices.push(v)) return false;
    for (uint32_t h : model_.tripod)
        if (!zeros.tripods.push(h)) return false;
    return zeros.known = true;
}

} // namespace hmf
