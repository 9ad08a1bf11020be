#include "normals.hpp"

#include <algorithm>

namespace cli {

namespace {

constexpr double CREASE_COSINE = 0.62; // about 52 degrees
constexpr double HALF_CREASE = 0.9001; // its half: what is no farther from one direction has no crease

} // namespace

Normals::Normals(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles,
                 const std::vector<uint32_t>& component, const Workers& workers) :
    p_(points),
    t_(triangles), component_(component), face_(triangles.size() / 3), vertex_(points.size()),
    has_crease_(points.size(), 0), start_(points.size() + 1, 0), around_(triangles.size()) {
    constexpr size_t PART = 4096;
    const auto parts = [&](size_t count, const auto& work) {
        workers.each((count + PART - 1) / PART, [&](size_t part) {
            for (size_t k = part * PART; k < std::min(count, (part + 1) * PART); ++k) work(k);
        });
    };
    parts(face_.size(), [&](size_t t) {
        const Vec a = p_[t_[3 * t]];
        face_[t] = unit(cross(p_[t_[3 * t + 1]] - a, p_[t_[3 * t + 2]] - a));
    });
    orient();
    find_rings();
    parts(p_.size(), [&](size_t v) { find_vertex(uint32_t(v)); });
}

// By the sign of the volume.
void Normals::orient() {
    size_t count = 1;
    for (const uint32_t c : component_) count = std::max(count, size_t{c} + 1);
    std::vector<double> volume(count, 0);
    for (size_t t = 0; t < face_.size(); ++t) {
        const Vec a = p_[t_[3 * t]] - p_[0], b = p_[t_[3 * t + 1]] - p_[0], c = p_[t_[3 * t + 2]] - p_[0];
        volume[component(t)] += dot(a, cross(b, c));
    }
    for (const double v : volume) outward_.push_back(v < 0 ? -1 : 1);
}

void Normals::find_rings() {
    for (const uint32_t v : t_) ++start_[v + 1];
    for (size_t v = 0; v < p_.size(); ++v) start_[v + 1] += start_[v];
    std::vector<uint32_t> filled(start_.begin(), start_.end() - 1);
    for (uint32_t k = 0; k < t_.size(); ++k) around_[filled[t_[k]]++] = k;
}

void Normals::find_vertex(uint32_t v) {
    const Vec n = vertex_[v] = mean(v, nullptr);
    for (size_t r = start_[v]; r < start_[v + 1]; ++r)
        if (!(dot(n, face_[around_[r] / 3]) > HALF_CREASE)) has_crease_[v] = 1;
}

// face: only triangles that are on its side of a crease.
Vec Normals::mean(uint32_t v, const Vec* face) const {
    Vec sum;
    for (size_t r = start_[v]; r < start_[v + 1]; ++r) {
        const size_t j = around_[r], t = j / 3;
        if (face && !(dot(face_[t], *face) > CREASE_COSINE)) continue;
        const Vec p = p_[v], a = p_[t_[3 * t + (j + 1) % 3]] - p, b = p_[t_[3 * t + (j + 2) % 3]] - p;
        const double squares = dot(a, a) * dot(b, b);
        if (squares > 0) sum = sum + (1 / squares) * cross(a, b);
    }
    return dot(sum, sum) > 0 ? unit(sum) : face ? *face : Vec{0, 0, 1};
}

} // namespace cli
