// The best view is found by trial: samples of the surface fall into a coarse depth grid for each direction, and a
// target is seen where no sample lies clearly before it.
#include "camera.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>

#include "failure.hpp"

namespace cli {

namespace {

// Principal axes of the points, the smallest first, by Jacobi rotations.
std::array<Vec, 3> principal_axes(const std::vector<Vec>& points) {
    Vec mean;
    for (Vec p : points) mean = mean + (1.0 / double(points.size())) * p;
    double m[3][3] = {}, v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (Vec p : points) {
        const double d[3] = {p.x - mean.x, p.y - mean.y, p.z - mean.z};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m[i][j] += d[i] * d[j];
    }
    for (int sweep = 0; sweep < 30; ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (std::fabs(m[p][q]) < 1e-300) continue;
                const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b;
                    m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b;
                    m[q][k] = s * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const double a = v[k][p], b = v[k][q];
                    v[k][p] = c * a - s * b;
                    v[k][q] = s * a + c * b;
                }
            }
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] < m[b][b]; });
    std::array<Vec, 3> axes;
    for (size_t i = 0; i < 3; ++i) axes[i] = unit({v[0][order[i]], v[1][order[i]], v[2][order[i]]});
    return axes;
}

Vec part_across(Vec v, Vec axis) { return v - dot(v, axis) * axis; }

// Samples in a coarse grid as seen from one direction.
class DepthGrid {
public:
    DepthGrid(const Samples& samples, const View& view) :
        size_(samples.size), per_size_(N / samples.size), forward_(unit(view.from)) {
        right_ = unit(cross(view.up, forward_));
        up_ = cross(forward_, right_);
        depth_.fill(-1e300);
        for (const Vec p : samples.points) {
            double& depth = depth_[cell(p)];
            depth = std::max(depth, dot(p, forward_));
        }
    }
    double covered() const {
        return double(std::count_if(depth_.begin(), depth_.end(), [](double d) { return d > -1e300; }));
    }
    bool sees(Vec p) const { return dot(p, forward_) > depth_[cell(p)] - 0.035 * size_; }

private:
    static constexpr int N = 48;
    // Coordinates of the samples are at most half the size, from the middle of the object.
    size_t cell(Vec p) const {
        const auto place = [&](double x) { return size_t(std::clamp(int(x * per_size_ + 0.5 * N), 0, N - 1)); };
        return place(dot(p, up_)) * N + place(dot(p, right_));
    }
    double size_, per_size_;
    Vec forward_, right_, up_;
    std::array<double, size_t{N} * N> depth_;
};

} // namespace

bool read_view(const std::string& text, View& view) {
    if (text == "auto") return false;
    static const struct {
        const char* name;
        View view;
    } named[] = {{"front", {{0, 0, 1}, {0, 1, 0}}},     {"back", {{0, 0, -1}, {0, 1, 0}}},
                 {"left", {{-1, 0, 0}, {0, 1, 0}}},     {"right", {{1, 0, 0}, {0, 1, 0}}},
                 {"top", {{0, 1, 0}, {0, 0, -1}}},      {"bottom", {{0, -1, 0}, {0, 0, 1}}},
                 {"corner", {{1, 0.8, 1.2}, {0, 1, 0}}}};
    for (const auto& n : named)
        if (text == n.name) {
            view = n.view;
            return true;
        }
    std::vector<double> numbers;
    std::istringstream stream(text + ",");
    for (std::string part; std::getline(stream, part, ',');) {
        char* end = nullptr;
        numbers.push_back(std::strtod(part.c_str(), &end));
        if (part.empty() || *end || !std::isfinite(numbers.back()))
            throw Failure(EXIT_USAGE,
                          "--camera: \"" + text
                              + "\" is no view; give auto, front, back, left, right, top, bottom, corner, a direction "
                                "X,Y,Z or with what is above X,Y,Z,UX,UY,UZ");
    }
    if (numbers.size() != 3 && numbers.size() != 6)
        throw Failure(EXIT_USAGE, "--camera: " + std::to_string(numbers.size())
                                      + " numbers; give three for the direction, or six with what is above");
    view.from = {numbers[0], numbers[1], numbers[2]};
    if (numbers.size() == 6) view.up = {numbers[3], numbers[4], numbers[5]};
    else view.up = std::hypot(view.from.x, view.from.z) > 1e-3 * length(view.from) ? Vec{0, 1, 0} : Vec{0, 0, -1};
    if (!(length(cross(view.from, view.up)) > 1e-9 * length(view.from) * length(view.up)))
        throw Failure(EXIT_USAGE, "--camera: the direction is 0 or parallel to what is above; give two that differ");
    return true;
}

Samples sample_surface(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles) {
    constexpr double COUNT = 12000;
    Samples samples;
    Vec low = points[0], high = points[0];
    for (Vec p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    samples.size = length(high - low);
    const Vec middle = 0.5 * (low + high);
    double area = 0, volume = 0;
    const auto normal = [&](size_t t) {
        const Vec a = points[triangles[t]] - middle, b = points[triangles[t + 1]] - middle,
                  c = points[triangles[t + 2]] - middle;
        const Vec n = cross(b - a, c - a);
        volume += dot(a, n);
        return n;
    };
    for (size_t t = 0; t < triangles.size(); t += 3) area += length(normal(t));
    const double outward = volume < 0 ? -1 : 1, step = area / COUNT;
    double saved = step / 2;
    // The points of one triangle spread out: fractions of two irrational numbers.
    double x = 0.5, y = 0.5;
    for (size_t t = 0; t < triangles.size(); t += 3) {
        const Vec n = normal(t);
        for (saved += length(n); saved >= step && step > 0; saved -= step) {
            x += 0.7548776662466927;
            y += 0.5698402909980532;
            x -= std::floor(x);
            y -= std::floor(y);
            const double b = x + y > 1 ? 1 - x : x, c = x + y > 1 ? 1 - y : y;
            samples.points.push_back((1 - b - c) * points[triangles[t]] + b * points[triangles[t + 1]]
                                     + c * points[triangles[t + 2]]);
            samples.normals.push_back(outward * unit(n));
        }
    }
    if (samples.points.empty()) {
        samples.points = points;
        samples.normals.assign(points.size(), {0, 0, 1});
    }
    return samples;
}

View best_view(const Samples& samples, const std::vector<Target>& targets, const Workers& workers) {
    // Models stand upright along y or z; take the one that lies in the picture.
    // One that stands askew to its own axes is laid along its longest.
    const std::array<Vec, 3> axes = principal_axes(samples.points);
    Vec axis = axes[0];
    if (axis.x + axis.y + axis.z < 0) axis = -1.0 * axis;
    Vec upright = std::fabs(axis.y) < 0.75 ? Vec{0, 1, 0} : Vec{0, 0, 1};
    const Vec projected = unit(part_across(upright, axis));
    if (std::max(std::fabs(dot(projected, axes[1])), std::fabs(dot(projected, axes[2]))) < 0.9)
        upright = dot(axes[1], upright) < 0 ? -1.0 * axes[1] : axes[1];
    const Vec up = unit(part_across(upright, axis)), side = cross(up, axis);

    Vec middle;
    for (const Vec p : samples.points) middle = middle + (1.0 / double(samples.points.size())) * p;
    // The grid is centered at the origin.
    Samples centered = samples;
    double reach = 0;
    for (Vec& p : centered.points) {
        p = p - middle;
        reach = std::max(reach, length(p));
    }
    centered.size = 2 * reach;

    constexpr size_t TURNS = 16;
    // Height above the horizon, and how much it is liked.
    constexpr struct { double height, liking; } heights[] = {{0.42, 0.1}, {0.95, 0.04}, {0, 0}, {-0.45, -0.1}};
    struct Trial {
        View view;
        double covered, score; // score: without what is covered
    };
    std::vector<Trial> trials(std::size(heights) * TURNS);
    workers.each(trials.size(), [&](size_t k) {
        const auto [height, liking] = heights[k / TURNS];
        const double angle = 6.283185307179586 * double(k % TURNS) / TURNS + 0.346;
        const View view{unit(std::cos(angle) * axis + std::sin(angle) * side + height * up), up};
        const DepthGrid grid(centered, view);
        double seen = 0, all = 0;
        for (const Target& target : targets) {
            size_t count = 0;
            for (const Vec p : target.points) count += grid.sees(p - middle);
            // Half of a curve is as much as one sees of it.
            seen +=
                target.worth
                * std::min(1.0, (target.points.size() > 1 ? 2.0 : 1.0) * double(count) / double(target.points.size()));
            all += target.worth;
        }
        trials[k] = {view, grid.covered(), liking + (all > 0 ? seen / all : 0) + 0.02 * dot(view.from, axis)};
    });
    double largest = 1;
    for (const Trial& t : trials) largest = std::max(largest, t.covered);
    const auto score = [&](const Trial& t) { return t.score + 0.6 * t.covered / largest; };
    const Trial* best = &trials[0];
    for (const Trial& t : trials)
        if (score(t) > score(*best)) best = &t;
    return best->view;
}

Camera place_camera(const std::vector<Vec>& points, const Samples& samples, const View& view, double aspect) {
    Camera camera;
    camera.forward = unit(view.from);
    camera.right = unit(cross(view.up, camera.forward));
    camera.up = cross(camera.forward, camera.right);
    const auto distance = [&](const std::vector<Vec>& all) {
        camera.back = 0;
        double back = 0;
        for (Vec p : all) {
            const Vec c = camera.to_camera(p);
            back = std::max({back, c.z + camera.focal * std::fabs(c.x) / aspect, c.z + camera.focal * std::fabs(c.y)});
        }
        return 1.08 * back;
    };
    double low[3] = {}, high[3] = {};
    for (size_t i = 0; i < samples.points.size(); ++i) {
        const Vec p = samples.points[i];
        const double c[3] = {dot(p, camera.right), dot(p, camera.up), dot(p, camera.forward)};
        for (int a = 0; a < 3; ++a) {
            low[a] = i ? std::min(low[a], c[a]) : c[a];
            high[a] = i ? std::max(high[a], c[a]) : c[a];
        }
    }
    camera.center = 0.5 * (low[0] + high[0]) * camera.right + 0.5 * (low[1] + high[1]) * camera.up
                  + 0.5 * (low[2] + high[2]) * camera.forward;
    // Perspective moves near parts outward: center what is seen, and again.
    for (int round = 0; round < 3; ++round) {
        camera.back = distance(samples.points);
        double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
        for (Vec p : samples.points) {
            const Vec c = camera.to_camera(p);
            left = std::min(left, -c.x / c.z);
            right = std::max(right, -c.x / c.z);
            bottom = std::min(bottom, -c.y / c.z);
            top = std::max(top, -c.y / c.z);
        }
        camera.center =
            camera.center + 0.5 * camera.back * ((left + right) * camera.right + (bottom + top) * camera.up);
    }
    camera.back = distance(points);
    return camera;
}

} // namespace cli
