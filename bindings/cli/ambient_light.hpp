// Share of light that reaches what a picture shows: neighbors above the tangent plane take some away.  Found at every
// third pixel of every third row, blurred there, and interpolated; never across a step in depth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "workers.hpp"

namespace cli {

class AmbientLight {
public:
    static constexpr size_t GRID = 3;
    struct Place {
        float x = 0, y = 0, z = BACKGROUND; // in the camera's frame
    };
    struct Normal {
        float x = 0, y = 0, z = 1;
    };

    // Of so many pixels.
    AmbientLight(size_t pixels_across, size_t pixels_down);

    size_t wide() const { return wide_; }
    size_t high() const { return high_; }
    // What is seen at pixel (GRID i, GRID j).
    void set(size_t i, size_t j, Place place, Normal normal) {
        places_[j * wide_ + i] = place;
        normals_[j * wide_ + i] = normal;
    }

    // radius: in space, from where light is taken; scale: pixels per unit at distance 1.
    void find(float radius, float scale, const Workers& workers);

    // At a pixel whose place is at z; 0: background, where all that is seen beside it counts.
    float at(size_t x, size_t y, float z) const;

private:
    static constexpr float BACKGROUND = -1e12f; // far behind: it takes no light
    static constexpr size_t DIRECTIONS = 8, STEPS = 4, SAMPLES = DIRECTIONS * STEPS, PATTERNS = 16,
                            MARGIN = 4096; // nodes; no sample is farther away
    void take_row(size_t j, float radius, float scale);
    void blur_row(size_t j);
    bool is_seen(size_t node) const { return places_[node].z != BACKGROUND; }

    size_t wide_, high_;
    float jump_ = 0;            // in depth, that light does not cross
    std::vector<Place> places_; // the last one: background
    std::vector<Normal> normals_;
    std::vector<float> raw_, light_;
    std::array<std::array<float, 4>, GRID * GRID> weights_; // of the nodes around each pixel
};

} // namespace cli
