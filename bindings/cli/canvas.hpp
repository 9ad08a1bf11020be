// A rasteriser for triangles with smooth edges and ambient occlusion.
//
// First each pixel finds the triangle at its middle, and each visible one is shaded once: patterns filter themselves by
// their derivative on the screen.  Only the pixels on outlines and creases, a few in a hundred, get 3 x 3 samples.
//
// The work is cut into bands of rows, which threads take; a picture has the same bytes for every number of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "ambient_light.hpp"
#include "camera.hpp"
#include "vec.hpp"
#include "workers.hpp"

namespace cli {

using Color = Vec; // linear light

struct Image {
    unsigned width = 0, height = 0;
    std::vector<uint8_t> rgb; // 3 per pixel, rows from the top
};

struct ScreenPoint {
    double x, y, w; // w: 1 / distance; not positive: behind the camera
};

// A linear function on the screen.
struct Ramp {
    double at0 = 0, right = 0, down = 0;
    double at(double x, double y) const { return at0 + x * right + y * down; }
};

// A triangle on the screen.  What is linear on it is there a quotient of two linear functions, numerator / inverse.
struct Projected {
    Ramp side[3]; // 1 at a corner, 0 on the side across
    double w[3];
    Ramp inverse; // 1 / distance
    bool is_seen;

    // Of the function with these values at the corners.
    Ramp numerator(double a, double b, double c) const {
        const double s[3] = {a * w[0], b * w[1], c * w[2]};
        return {s[0] * side[0].at0 + s[1] * side[1].at0 + s[2] * side[2].at0,
                s[0] * side[0].right + s[1] * side[1].right + s[2] * side[2].right,
                s[0] * side[0].down + s[1] * side[1].down + s[2] * side[2].down};
    }
};

// A place on it.
struct Spot {
    const Projected& on;
    double x, y, distance;

    double value(const Ramp& numerator) const { return numerator.at(x, y) * distance; }
    // By how much a function of this value changes from a pixel to the next.
    double change(const Ramp& numerator, double value) const {
        const double by_x = numerator.right - value * on.inverse.right, by_y = numerator.down - value * on.inverse.down;
        return std::sqrt(by_x * by_x + by_y * by_y) * distance;
    }
    double barycentric(int m) const { return std::max(0.0, on.side[m].at(x, y)) * on.w[m] * distance; }
};

struct Shaded {
    Color albedo;
    Vec normal; // in the camera's frame, of any length but 0
};

class Canvas {
public:
    Canvas(const Camera& camera, unsigned width, unsigned height, const Workers& workers);

    ScreenPoint project(Vec camera_point) const;

    // Triangles as triples of points.  They get the numbers after those of the sheets before; nothing is copied.
    void add(const std::vector<ScreenPoint>& points, const std::vector<uint32_t>& triangles);

    // Material: a type Face; face(number of the triangle, Projected) -> Face; shade(Face, Spot) -> Shaded.
    // occlusion_radius: in space.
    template <class Material>
    Image paint(double occlusion_radius, const Material& material) {
        begin();
        workers_.each(bands(), [&](size_t band) {
            find_visible(band);
            Batch row;
            for (size_t y = first_row(band); y < end_row(band); ++y) {
                shade_row(y, material, row);
                keep_row(y, row);
            }
        });
        AmbientLight open = ambient_light(occlusion_radius);
        Image image = background_image();
        workers_.each(bands(), [&](size_t band) {
            const Rough rough = find_rough(band);
            std::vector<Color> sums(rough.pixels.size());
            shade_rough(rough, material, open, sums);
            resolve(band, open, rough, sums, image);
        });
        return image;
    }

    // 0: background, else 1 / distance of what is seen there.
    double depth_at(double x, double y) const;

private:
    static constexpr uint32_t NONE = 0xffffffffu;
    static constexpr size_t SIDE = 3, FINE = SIDE * SIDE, BAND = 32;
    struct Hit { // not filled where it is made
        float w; // 0: background
        uint32_t triangle;
    };
    struct Sheet {
        const std::vector<ScreenPoint>* points;
        const std::vector<uint32_t>* triangles;
    };
    // What is seen at a pixel.
    struct Lit {
        uint16_t color[3]; // in 1 / 32768
        int16_t normal[3]; // in 1 / 16384
    };
    // Pixels of a band that get more samples.
    struct Rough {
        std::vector<uint32_t> pixels; // indices in front_
        std::vector<Hit> samples;     // 9 of each
    };
    // Places to be lit together.
    struct Batch {
        std::vector<float> x, y, albedo[3], normal[3];
        size_t count = 0;
        void resize(size_t size);
        void put(size_t k, double px, double py, const Shaded& s) {
            x[k] = float(px);
            y[k] = float(py);
            const Vec a = s.albedo, n = s.normal;
            albedo[0][k] = float(a.x), albedo[1][k] = float(a.y), albedo[2][k] = float(a.z);
            normal[0][k] = float(n.x), normal[1][k] = float(n.y), normal[2][k] = float(n.z);
        }
        Color color(size_t k) const { return {double(albedo[0][k]), double(albedo[1][k]), double(albedo[2][k])}; }
    };

    // The triangle that was shaded last: the next pixel often lies on it too.
    template <class Material>
    struct Current {
        uint32_t triangle = NONE;
        Projected projected;
        typename Material::Face face;
    };

    template <class Material>
    Shaded shade_at(uint32_t triangle, double x, double y, const Material& material, Current<Material>& current) const {
        if (current.triangle != triangle) {
            current.triangle = triangle;
            current.projected = projected(triangle);
            current.face = material.face(triangle, current.projected);
        }
        return material.shade(current.face, Spot{current.projected, x, y, 1 / current.projected.inverse.at(x, y)});
    }

    template <class Material>
    void shade_row(size_t y, const Material& material, Batch& row) const {
        row.resize(wide_);
        Current<Material> current;
        const Hit* const hits = &front_[y * wide_];
        const double py = double(y + top_) + 0.5;
        for (size_t x = 0; x < wide_; ++x) {
            const double px = double(x + left_) + 0.5;
            row.put(x, px, py,
                    hits[x].triangle == NONE ? Shaded{{}, {0, 0, 1}}
                                             : shade_at(hits[x].triangle, px, py, material, current));
        }
        light(row);
    }

    // Samples on one triangle are shaded together, at their middle.
    template <class Material>
    void shade_rough(const Rough& rough, const Material& material, const AmbientLight& open,
                     std::vector<Color>& sums) const {
        struct Part {
            uint32_t pixel;
            uint32_t samples;
        };
        std::vector<Part> parts;
        Batch batch;
        batch.resize(rough.samples.size());
        batch.count = 0;
        Current<Material> current;
        for (uint32_t r = 0; r < rough.pixels.size(); ++r) {
            const size_t left = rough.pixels[r] % wide_ + left_, top = rough.pixels[r] / wide_ + top_;
            const Hit* const hits = &rough.samples[r * FINE];
            bool done[FINE] = {};
            for (size_t s = 0; s < FINE; ++s) {
                if (done[s]) continue;
                double x = 0, y = 0;
                uint32_t count = 0;
                for (size_t k = s; k < FINE; ++k)
                    if (hits[k].triangle == hits[s].triangle) {
                        done[k] = true;
                        x += double(k % SIDE);
                        y += double(k / SIDE);
                        ++count;
                    }
                if (hits[s].triangle == NONE) {
                    sums[r] = sums[r] + (double(count) / FINE) * background(top);
                    continue;
                }
                const double px = double(left) + (x / count + 0.5) / SIDE, py = double(top) + (y / count + 0.5) / SIDE;
                batch.put(batch.count++, px, py, shade_at(hits[s].triangle, px, py, material, current));
                parts.push_back({r, count});
            }
        }
        light(batch);
        for (size_t k = 0; k < parts.size(); ++k) {
            Color& sum = sums[parts[k].pixel];
            sum = sum
                + double(parts[k].samples) / FINE * double(open_at(open, rough.pixels[parts[k].pixel]))
                      * batch.color(k);
        }
    }

    size_t bands() const { return (high_ + BAND - 1) / BAND; }
    size_t first_row(size_t band) const { return band * BAND; }
    size_t end_row(size_t band) const { return std::min(high_, (band + 1) * BAND); }

    // What a picture begins with.
    void begin();
    void choose_area();
    void sort_into_bands();
    using Corners = std::array<const ScreenPoint*, 3>;
    Corners corners(uint32_t triangle) const;
    Projected projected(uint32_t triangle) const;
    void find_visible(size_t band);
    void keep_row(size_t y, const Batch& row);
    void light(Batch& batch) const;        // albedo becomes light, normals unit and bent towards the camera
    bool differ(size_t a, size_t b) const; // pixels of two triangles
    Rough find_rough(size_t band) const;
    void sample(size_t band, const std::vector<uint32_t>& slot, std::vector<Hit>& samples) const;
    AmbientLight ambient_light(double radius) const;
    float open_at(const AmbientLight& open, size_t at) const {
        return open.at(at % wide_, at / wide_, front_[at].triangle == NONE ? 0 : -1 / front_[at].w);
    }
    Color background(size_t row) const;
    Image background_image() const;
    void resolve(size_t band, const AmbientLight& open, const Rough& rough, const std::vector<Color>& sums,
                 Image& image) const;

    unsigned width_, height_;
    double scale_, pixel_; // pixels per unit at distance 1, and its inverse
    const Workers& workers_;
    std::vector<Sheet> sheets_;
    // The part of the picture where something is seen.
    size_t left_ = 0, top_ = 0, wide_ = 0, high_ = 0;
    std::vector<uint32_t> band_start_, band_triangles_; // those that may be seen in each band
    std::unique_ptr<Hit[]> front_;                      // not filled before its band is
    std::unique_ptr<Lit[]> lit_;
};

} // namespace cli
