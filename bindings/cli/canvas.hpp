// A rasteriser for triangles with smooth edges and ambient occlusion.
//
// First each pixel finds the triangle at its middle, and each visible one is shaded once: patterns filter themselves by
// their derivative on the screen.  Only the pixels on outlines and creases, a few in a hundred, get 3 x 3 samples.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera.hpp"
#include "vec.hpp"

namespace cli {

using Colour = Vec; // linear light

struct Image {
    unsigned width = 0, height = 0;
    std::vector<uint8_t> rgb; // 3 per pixel, rows from the top
};

struct ScreenPoint {
    double x, y, w; // w: 1 / distance; not positive: behind the camera
};

// A point of a triangle, for shading.
struct Spot {
    double b[3];              // barycentric
    double right[3], down[3]; // change of them per pixel
    Vec view;                 // towards the camera, in its frame
};

struct Shaded {
    Colour albedo;
    Vec normal; // in the camera's frame
};

class Canvas {
public:
    Canvas(const Camera& camera, unsigned width, unsigned height);

    ScreenPoint project(Vec camera_point) const;

    // Triangles as triples of points.  They get the numbers after those of the sheets before; nothing is copied.
    void add(const std::vector<ScreenPoint>& points, const std::vector<uint32_t>& triangles);

    // shade(number of the triangle, Spot) -> Shaded.  occlusion_radius: in space.
    template <class Shade>
    Image paint(double occlusion_radius, const Shade& shade) {
        find_visible();
        shaded_.reset(new Lit[front_.size()]); // not filled: memory of the background is never touched
        Current current;
        for (size_t y = 0, at = 0; y < height_; ++y)
            for (size_t x = 0; x < width_; ++x, ++at)
                if (front_[at].triangle != NONE)
                    shaded_[at] = shade_at(front_[at].triangle, double(x) + 0.5, double(y) + 0.5, shade, current);
        find_rough();
        const std::vector<float> open = ambient_light(occlusion_radius);
        std::vector<Colour> sum(rough_.size());
        for (size_t r = 0; r < rough_.size(); ++r) {
            const Hit* const hits = &fine_[r * FINE];
            // Samples on one triangle are shaded together.
            std::array<bool, FINE> done{};
            for (size_t s = 0; s < FINE; ++s) {
                if (done[s]) continue;
                double x = 0, y = 0, count = 0;
                for (size_t k = s; k < FINE; ++k)
                    if (hits[k].triangle == hits[s].triangle) {
                        done[k] = true;
                        x += double(k % SIDE);
                        y += double(k / SIDE);
                        ++count;
                    }
                Colour c = background(rough_[r] / width_);
                if (hits[s].triangle != NONE)
                    c = double(open[rough_[r]])
                      * shade_at(hits[s].triangle, double(rough_[r] % width_) + (x / count + 0.5) / SIDE,
                                 double(rough_[r] / width_) + (y / count + 0.5) / SIDE, shade, current)
                            .colour();
                sum[r] = sum[r] + (count / FINE) * c;
            }
        }
        return resolve(open, sum);
    }

    // 0: background, else 1 / distance of what is seen there.
    double depth_at(double x, double y) const;

private:
    static constexpr uint32_t NONE = 0xffffffffu;
    static constexpr size_t SIDE = 3, FINE = SIDE * SIDE;
    struct Hit {
        float w = 0;
        uint32_t triangle = NONE;
    };
    struct Sheet {
        const std::vector<ScreenPoint>* points;
        const std::vector<uint32_t>* triangles;
    };
    struct Lit {
        float c[3], n[3];
        Colour colour() const { return {double(c[0]), double(c[1]), double(c[2])}; }
        Vec normal() const { return {double(n[0]), double(n[1]), double(n[2])}; }
    };

    // The lines along which the barycentric coordinates are 0, and 1 / distance.
    struct Setup {
        double ex[3], ey[3], e[3], w[3];
        bool is_seen;
    };
    static Setup set_up(const ScreenPoint* a, const ScreenPoint* b, const ScreenPoint* c);

    // The triangle that was shaded last: the next pixel often lies on it too.
    struct Current {
        uint32_t triangle = NONE;
        Setup setup;
    };

    template <class Shade>
    Lit shade_at(uint32_t triangle, double x, double y, const Shade& shade, Current& current) const {
        if (current.triangle != triangle) {
            size_t sheet = 0, local = triangle;
            while (local >= sheets_[sheet].triangles->size() / 3) local -= sheets_[sheet++].triangles->size() / 3;
            const std::vector<ScreenPoint>& p = *sheets_[sheet].points;
            const uint32_t* const corner = &(*sheets_[sheet].triangles)[3 * local];
            current = {triangle, set_up(&p[corner[0]], &p[corner[1]], &p[corner[2]])};
        }
        const Setup& s = current.setup;
        double screen[3], inverse = 0, inverse_x = 0, inverse_y = 0;
        for (int m = 0; m < 3; ++m) {
            screen[m] = std::max(0.0, s.e[m] + x * s.ex[m] + y * s.ey[m]);
            inverse += screen[m] * s.w[m];
            inverse_x += s.ex[m] * s.w[m];
            inverse_y += s.ey[m] * s.w[m];
        }
        Spot spot;
        const double distance = 1 / inverse;
        for (int m = 0; m < 3; ++m) {
            spot.b[m] = screen[m] * s.w[m] * distance;
            spot.right[m] = (s.ex[m] * s.w[m] - spot.b[m] * inverse_x) * distance;
            spot.down[m] = (s.ey[m] * s.w[m] - spot.b[m] * inverse_y) * distance;
        }
        spot.view = unit({-(x - 0.5 * width_) * pixel_, (y - 0.5 * height_) * pixel_, 1});
        const Shaded found = shade(triangle, spot);
        // A normal that points away from the camera is bent to its outline.
        Vec n = found.normal;
        if (dot(n, spot.view) < 0) n = unit(n - 1.02 * dot(n, spot.view) * spot.view);
        const Colour lit = light(found.albedo, n, spot.view);
        return {{float(lit.x), float(lit.y), float(lit.z)}, {float(n.x), float(n.y), float(n.z)}};
    }

    static Colour light(Colour albedo, Vec normal, Vec view);
    Colour background(size_t row) const;
    Vec position_at(size_t x, size_t y) const;
    void find_visible();
    void find_rough();
    std::vector<float> ambient_light(double radius) const;
    Image resolve(const std::vector<float>& open, const std::vector<Colour>& rough_sum) const;

    unsigned width_, height_;
    double scale_, pixel_; // pixels per unit at distance 1, and its inverse
    std::vector<Sheet> sheets_;
    std::vector<Hit> front_;
    std::unique_ptr<Lit[]> shaded_; // where there is a triangle
    std::vector<uint32_t> rough_;   // pixels
    std::vector<Hit> fine_;         // 9 samples of each
};

} // namespace cli
