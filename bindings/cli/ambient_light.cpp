#include "ambient_light.hpp"

#include <array>
#include <cmath>

namespace cli {

AmbientLight::AmbientLight(size_t pixels_across, size_t pixels_down) :
    wide_((pixels_across + GRID - 1) / GRID), high_((pixels_down + GRID - 1) / GRID), places_(wide_ * high_ + 1),
    normals_(wide_ * high_), raw_(wide_ * high_, 1.0f), light_(wide_ * high_, 1.0f) {
    for (size_t k = 0; k < GRID * GRID; ++k) {
        const float over = float(k % GRID) / GRID, down = float(k / GRID) / GRID;
        weights_[k] = {(1 - over) * (1 - down), over * (1 - down), (1 - over) * down, over * down};
    }
}

void AmbientLight::find(float radius, float scale, const Workers& workers) {
    constexpr size_t ROWS = 8;
    jump_ = 0.5f * radius;
    const auto rows = [&](const auto& work) {
        workers.each((high_ + ROWS - 1) / ROWS, [&](size_t part) {
            for (size_t j = part * ROWS; j < std::min(high_, (part + 1) * ROWS); ++j) work(j);
        });
    };
    rows([&](size_t j) { take_row(j, radius, scale); });
    rows([&](size_t j) { blur_row(j); });
}

// The directions alternate from node to node, and no branch depends on what a sample sees.
void AmbientLight::take_row(size_t j, float radius, float scale) {
    static const auto turns = [] {
        std::array<std::array<float, 2>, DIRECTIONS * PATTERNS> table{};
        for (size_t k = 0; k < table.size(); ++k) {
            const double angle = 6.283185307179586 * double(k) / double(table.size());
            table[k] = {float(std::cos(angle)), float(std::sin(angle))};
        }
        return table;
    }();
    const float spread = 2 / (radius * radius);
    const uint32_t wide = uint32_t(wide_), high = uint32_t(high_);
    const size_t background = wide_ * high_;
    for (size_t i = 0; i < wide_; ++i) {
        const Place here = places_[j * wide_ + i];
        if (here.z == BACKGROUND) continue;
        const Normal n = normals_[j * wide_ + i];
        const size_t pattern = (i & 3u) + 4 * (j & 3u);
        const float reach = std::min(float(MARGIN) / STEPS, radius * scale / (-here.z * float(GRID * STEPS))),
                    inset = 0.5f * float(pattern * 7 % 16) / 16;
        const float middle_x = float(i + MARGIN) + 0.5f, middle_y = float(j + MARGIN) + 0.5f;
        float x[SAMPLES], y[SAMPLES], z[SAMPLES];
        for (size_t d = 0; d < DIRECTIONS; ++d) {
            const auto [ux, uy] = turns[d * PATTERNS + pattern];
            for (size_t s = 0; s < STEPS; ++s) {
                const float r = reach * (float(s + 1) - inset);
                // Numbers below 0 become large ones.
                const auto qx = uint32_t(int(middle_x + r * ux)) - MARGIN,
                           qy = uint32_t(int(middle_y + r * uy)) - MARGIN;
                const Place there = places_[qx < wide && qy < high ? size_t{qy} * wide + qx : background];
                x[d * STEPS + s] = there.x - here.x;
                y[d * STEPS + s] = there.y - here.y;
                z[d * STEPS + s] = there.z - here.z;
            }
        }
        for (size_t s = 0; s < SAMPLES; ++s) {
            const float square = x[s] * x[s] + y[s] * y[s] + z[s] * z[s] + 1e-30f, root = std::sqrt(square);
            // Lower than 7 degrees: nothing.
            const float above = n.x * x[s] + n.y * y[s] + n.z * z[s] - 0.12f * root;
            x[s] = (above + std::fabs(above)) / (2 * root + 2 * spread * square * root);
        }
        float taken = 0;
        for (const float t : x) taken += t;
        raw_[j * wide_ + i] = std::max(0.25f, 1 - 1.5f * taken / SAMPLES);
    }
}

void AmbientLight::blur_row(size_t j) {
    for (size_t i = 0; i < wide_; ++i) {
        if (!is_seen(j * wide_ + i)) continue;
        const float z = places_[j * wide_ + i].z;
        float sum = 0, count = 0;
        for (size_t b = j > 1 ? j - 2 : 0; b < std::min(high_, j + 2); ++b)
            for (size_t a = i > 1 ? i - 2 : 0; a < std::min(wide_, i + 2); ++a) {
                const size_t other = b * wide_ + a;
                const float counts = std::fabs(places_[other].z - z) <= jump_ ? 1.0f : 0.0f;
                sum += counts * raw_[other];
                count += counts;
            }
        light_[j * wide_ + i] = sum / count; // its own is among them
    }
}

float AmbientLight::at(size_t x, size_t y, float z) const {
    const size_t i = x / GRID, j = y / GRID, node = j * wide_ + i;
    const std::array<float, 4>& weight = weights_[y % GRID * GRID + x % GRID];
    const Place* const place = &places_[node];
    const float* const light = &light_[node];
    const auto is_near = [&](float other) { return std::fabs(other - z) <= jump_; };
    if (i + 1 < wide_ && j + 1 < high_ && is_near(place[0].z) && is_near(place[1].z) && is_near(place[wide_].z)
        && is_near(place[wide_ + 1].z))
        return weight[0] * light[0] + weight[1] * light[1] + weight[2] * light[wide_] + weight[3] * light[wide_ + 1];
    float sum = 0, all = 0;
    for (size_t k = 0; k < 4; ++k) {
        const size_t other = (k & 1) + (k >> 1) * wide_;
        if (i + (k & 1) >= wide_ || j + (k >> 1) >= high_ || weight[k] == 0 || !is_seen(node + other)) continue;
        if (z != 0 && !is_near(place[other].z)) continue;
        sum += weight[k] * light[other];
        all += weight[k];
    }
    return all > 0 ? sum / all : 1;
}

} // namespace cli
