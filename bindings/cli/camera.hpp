// Where a picture is taken from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vec.hpp"
#include "workers.hpp"

namespace cli {

// Camera at distance `back` from the center, looking along -forward.
struct Camera {
    Vec right, up, forward, center;
    double back = 1, focal = 3.2; // focal: half height of the picture is 1
    Vec to_camera(Vec p) const {
        const Vec d = p - center;
        return {dot(d, right), dot(d, up), dot(d, forward) - back};
    }
    Vec turn(Vec n) const { return {dot(n, right), dot(n, up), dot(n, forward)}; }
};

// From where, and what is above: not parallel.
struct View {
    Vec from, up;
};

// auto, a name such as front, or X,Y,Z or X,Y,Z,UX,UY,UZ.  False: auto.  Throws Failure(EXIT_USAGE).
bool read_view(const std::string& text, View& view);

// Evenly spread over a surface, with its outward normals; a few thousand.
struct Samples {
    std::vector<Vec> points, normals;
    double size = 1; // of the object
};
Samples sample_surface(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles);

// What should be seen: points on the surface that count together as one.
struct Target {
    std::vector<Vec> points;
    double worth = 1;
};

// The view, out of some dozens, from which most of the targets and much of the surface are seen.
View best_view(const Samples& samples, const std::vector<Target>& targets, const Workers& workers = Workers());

// A camera that shows all points.
Camera place_camera(const std::vector<Vec>& points, const Samples& samples, const View& view, double aspect);

} // namespace cli
