// A z-buffer rasteriser: 3 x 3 samples per pixel, stripes filtered by their
// derivative on the screen, smooth shading up to a crease angle, and ambient
// occlusion from the depth buffer.
//
// The stripe pattern is evaluated per sample, not per piece, so that a tripod
// needs no new vertices and no cracks can open beside it:
//
//            k                The leaf through the branch point leaves the
//           / \               triangle at points p on the edges, at distance a
//          p   p              from the corners, and meets in their centroid c.
//         /  c  \             In the six triangles (corner, p, c) the distance
//        i---p---j            from the branch point is linear.
#include "render.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cli {

namespace {

constexpr unsigned WIDTH = 1400, HEIGHT = 1050, SAMPLES = 3;
constexpr double CREASE_COSINE = 0.62; // about 52 degrees
constexpr double STRIPES_ACROSS = 44;  // pairs of stripes along the size of the object, where the gradient is average

struct Vec {
    double x = 0, y = 0, z = 0;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vec unit(Vec a) {
    const double length = std::sqrt(dot(a, a));
    return length > 0 ? (1 / length) * a : Vec{0, 0, 1};
}

using Colour = Vec; // linear light
constexpr Colour RED{0.62, 0.025, 0.035}, WHITE{0.97, 0.95, 0.91}, BLUE{0.03, 0.13, 0.75}, YELLOW{0.98, 0.68, 0.02},
    VIOLET{0.45, 0.05, 0.55}, GREEN{0.01, 0.33, 0.06}, GREY{0.42, 0.42, 0.42};

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

// Camera at distance `back` from the centre, looking along -forward.
struct Camera {
    Vec right, up, forward, centre;
    double back = 1, focal = 1; // focal: half height of the picture is 1
    Vec to_camera(Vec p) const {
        const Vec d = p - centre;
        return {dot(d, right), dot(d, up), dot(d, forward) - back};
    }
};

Camera place_camera(const std::vector<Vec>& points) {
    Camera camera;
    const std::array<Vec, 3> axes = principal_axes(points);
    Vec axis = axes[0];
    // Models stand upright along y or z; take the one that lies in the picture.
    // One that stands askew to its own axes is laid along its longest.
    Vec upright = std::fabs(axis.y) < 0.75 ? Vec{0, 1, 0} : Vec{0, 0, 1};
    if (axis.x + axis.y + axis.z < 0) axis = -1.0 * axis;
    const Vec projected = unit(upright - dot(upright, axis) * axis);
    if (std::max(std::fabs(dot(projected, axes[1])), std::fabs(dot(projected, axes[2]))) < 0.9)
        upright = dot(axes[1], upright) < 0 ? -1.0 * axes[1] : axes[1];
    const Vec up = unit(upright - dot(upright, axis) * axis), side = cross(up, axis);
    camera.forward = unit(axis + 0.42 * up + 0.36 * side);
    camera.right = unit(cross(up, camera.forward));
    camera.up = cross(camera.forward, camera.right);
    camera.focal = 3.2;
    const double aspect = double(WIDTH) / HEIGHT;

    double low[3] = {}, high[3] = {};
    for (size_t i = 0; i < points.size(); ++i) {
        const double c[3] = {dot(points[i], camera.right), dot(points[i], camera.up), dot(points[i], camera.forward)};
        for (int a = 0; a < 3; ++a) {
            low[a] = i ? std::min(low[a], c[a]) : c[a];
            high[a] = i ? std::max(high[a], c[a]) : c[a];
        }
    }
    camera.centre = 0.5 * (low[0] + high[0]) * camera.right + 0.5 * (low[1] + high[1]) * camera.up
                  + 0.5 * (low[2] + high[2]) * camera.forward;
    // Perspective moves near parts outward: centre what is seen, and again.
    for (int round = 0; round < 4; ++round) {
        camera.back = 0;
        double back = 0;
        for (Vec p : points) {
            const Vec c = camera.to_camera(p);
            back = std::max({back, c.z + camera.focal * std::fabs(c.x) / aspect, c.z + camera.focal * std::fabs(c.y)});
        }
        camera.back = 1.08 * back;
        double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
        for (Vec p : points) {
            const Vec c = camera.to_camera(p);
            left = std::min(left, -c.x / c.z);
            right = std::max(right, -c.x / c.z);
            bottom = std::min(bottom, -c.y / c.z);
            top = std::max(top, -c.y / c.z);
        }
        if (round < 3)
            camera.centre =
                camera.centre + 0.5 * camera.back * ((left + right) * camera.right + (bottom + top) * camera.up);
    }
    return camera;
}

struct Corner {
    Vec position, normal; // in camera space
};

// Box-filtered share of red of the even stripe pattern.
double share_of_red(double u, double width, double period) {
    const double folded = std::fabs(u - period * std::round(u / period));
    const double sharp = std::clamp((period / 4 - folded) / std::max(width, 1e-12 * period) + 0.5, 0.0, 1.0);
    const double blur = std::clamp((width / period - 0.3) / 0.4, 0.0, 1.0);
    return sharp + blur * (0.5 - sharp);
}

// u at barycentric coordinates b, and its gradient in them.
double potential_at(Piece piece, const std::array<double, 3>& u, const double* b, double* slope) {
    if (piece != Piece::tripod) {
        for (int m = 0; m < 3; ++m) slope[m] = u[size_t(m)];
        return u[0] * b[0] + u[1] * b[1] + u[2] * b[2];
    }
    // Centroid of the three points where the singular leaf leaves.
    double centroid[3] = {};
    for (size_t i = 0; i < 3; ++i) {
        const size_t j = (i + 1) % 3;
        centroid[i] += u[j] / (u[i] + u[j]) / 3;
        centroid[j] += u[i] / (u[i] + u[j]) / 3;
    }
    // In the piece (corner i, p on edge ij, c): b = x e_i + y p + z c.
    double best = -1;
    for (size_t i = 0; i < 3; ++i)
        for (size_t step = 1; step < 3; ++step) {
            const size_t j = (i + step) % 3, k = 3 - i - j;
            const double pi = u[j] / (u[i] + u[j]), pj = u[i] / (u[i] + u[j]);
            const double z = b[k] / centroid[k], y = (b[j] - z * centroid[j]) / pj, x = b[i] - y * pi - z * centroid[i];
            const double inside = std::min({x, y, z});
            if (inside <= best) continue;
            best = inside;
            slope[i] = u[i];
            slope[j] = -u[i] * pi / pj;
            slope[k] = -u[i] * (centroid[i] - centroid[j] * pi / pj) / centroid[k];
        }
    return slope[0] * b[0] + slope[1] * b[1] + slope[2] * b[2];
}

class Canvas {
public:
    explicit Canvas(const Camera& camera) :
        focal_(camera.focal), depth_(size_t(W) * H, 0.0f), normal_(size_t(W) * H, {0, 0, 0}),
        colour_(size_t(W) * H, {0, 0, 0}) {}

    // Calls paint(barycentric, change of it per sample to the right and down)
    // for each visible sample.
    template <typename Paint>
    void triangle(const Corner& a, const Corner& b, const Corner& c, Paint paint) {
        const Corner* corner[3] = {&a, &b, &c};
        double sx[3], sy[3], w[3];
        for (int m = 0; m < 3; ++m) {
            const Vec p = corner[m]->position;
            if (!(p.z < 0)) return;
            w[m] = -1 / p.z;
            sx[m] = W * 0.5 + p.x * w[m] * focal_ * H * 0.5;
            sy[m] = H * 0.5 - p.y * w[m] * focal_ * H * 0.5;
        }
        const double area = (sx[1] - sx[0]) * (sy[2] - sy[0]) - (sx[2] - sx[0]) * (sy[1] - sy[0]);
        if (area == 0) return;
        const int x0 = std::max(0, int(std::ceil(std::min({sx[0], sx[1], sx[2]}) - 0.5)));
        const int x1 = std::min(int(W) - 1, int(std::floor(std::max({sx[0], sx[1], sx[2]}) - 0.5)));
        const int y0 = std::max(0, int(std::ceil(std::min({sy[0], sy[1], sy[2]}) - 0.5)));
        const int y1 = std::min(int(H) - 1, int(std::floor(std::max({sy[0], sy[1], sy[2]}) - 0.5)));
        // Edge functions: screen barycentrics are e + x ex + y ey.
        double ex[3], ey[3], e[3];
        for (int m = 0; m < 3; ++m) {
            const int p = (m + 1) % 3, q = (m + 2) % 3;
            ex[m] = (sy[p] - sy[q]) / area;
            ey[m] = (sx[q] - sx[p]) / area;
            e[m] = (sx[p] * sy[q] - sx[q] * sy[p]) / area;
        }
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                double screen[3];
                bool inside = true;
                for (int m = 0; m < 3; ++m) {
                    screen[m] = e[m] + px * ex[m] + py * ey[m];
                    inside = inside && screen[m] >= -1e-9;
                }
                if (!inside) continue;
                const double inverse = screen[0] * w[0] + screen[1] * w[1] + screen[2] * w[2];
                const size_t at = size_t(y) * W + size_t(x);
                if (!(inverse > depth_[at])) continue;
                // Perspective-correct barycentrics and their derivatives.
                double bary[3], right[3], down[3];
                const double inverse_x = ex[0] * w[0] + ex[1] * w[1] + ex[2] * w[2];
                const double inverse_y = ey[0] * w[0] + ey[1] * w[1] + ey[2] * w[2];
                for (int m = 0; m < 3; ++m) {
                    bary[m] = screen[m] * w[m] / inverse;
                    right[m] = (ex[m] * w[m] - bary[m] * inverse_x) / inverse;
                    down[m] = (ey[m] * w[m] - bary[m] * inverse_y) / inverse;
                }
                const Vec position = bary[0] * a.position + bary[1] * b.position + bary[2] * c.position;
                Vec normal = unit(bary[0] * a.normal + bary[1] * b.normal + bary[2] * c.normal);
                const Vec view = unit(-1.0 * position);
                if (dot(normal, view) < 0) normal = unit(normal - 1.02 * dot(normal, view) * view);
                depth_[at] = float(inverse);
                normal_[at] = {float(normal.x), float(normal.y), float(normal.z)};
                colour_[at] = quantise(shade(paint(bary, right, down), normal, view));
            }
    }

    // occlusion_radius: in camera space.
    Image resolve(double occlusion_radius) const {
        const std::vector<float> light = ambient_light(occlusion_radius);
        Image image;
        image.width = WIDTH;
        image.height = HEIGHT;
        image.rgb.resize(size_t(WIDTH) * HEIGHT * 3);
        for (unsigned y = 0; y < HEIGHT; ++y)
            for (unsigned x = 0; x < WIDTH; ++x) {
                const Colour back = background(x, y);
                Colour sum;
                for (unsigned j = 0; j < SAMPLES; ++j)
                    for (unsigned i = 0; i < SAMPLES; ++i) {
                        const size_t at = size_t(y * SAMPLES + j) * W + x * SAMPLES + i;
                        Colour c = back;
                        if (depth_[at] > 0) {
                            const auto& q = colour_[at];
                            const double open = light[size_t(y) * WIDTH + x];
                            c = {open * q[0] * q[0] / 65025.0, open * q[1] * q[1] / 65025.0,
                                 open * q[2] * q[2] / 65025.0};
                        }
                        sum = sum + c;
                    }
                const Colour mean = (1.0 / (SAMPLES * SAMPLES)) * sum;
                const double channel[3] = {mean.x, mean.y, mean.z};
                for (unsigned k = 0; k < 3; ++k)
                    image.rgb[(size_t(y) * WIDTH + x) * 3 + k] =
                        uint8_t(std::lround(255 * std::pow(std::clamp(channel[k], 0.0, 1.0), 1 / 2.2)));
            }
        return image;
    }

private:
    static constexpr unsigned W = WIDTH * SAMPLES, H = HEIGHT * SAMPLES;

    static std::array<uint8_t, 3> quantise(Colour c) {
        const auto channel = [](double v) { return uint8_t(std::lround(255 * std::sqrt(std::clamp(v, 0.0, 1.0)))); };
        return {channel(c.x), channel(c.y), channel(c.z)};
    }

    static Colour shade(Colour albedo, Vec n, Vec view) {
        static const Vec key = unit({-0.45, 0.75, 0.65}), fill = unit({0.85, 0.1, 0.45});
        const double sky = 0.5 + 0.5 * n.y;
        const double diffuse =
            0.22 + 0.18 * sky + 0.68 * std::max(0.0, dot(n, key)) + 0.17 * std::max(0.0, dot(n, fill));
        const Vec half = unit(key + view);
        const double shine = 0.10 * std::pow(std::max(0.0, dot(n, half)), 45.0);
        const double rim = 0.05 * std::pow(1 - std::clamp(dot(n, view), 0.0, 1.0), 3.0);
        return diffuse * albedo + Vec{shine + rim, shine + rim, shine + rim};
    }

    static Colour background(unsigned x, unsigned y) {
        const double dx = (double(x) / WIDTH - 0.5) * 1.1, dy = double(y) / HEIGHT - 0.42;
        const double fall = std::min(1.0, 1.5 * (dx * dx + dy * dy));
        return {0.94 - 0.28 * fall, 0.95 - 0.26 * fall, 0.97 - 0.23 * fall};
    }

    Vec position_at(size_t x, size_t y) const {
        const double z = -1.0 / depth_[y * W + x], scale = -z / (focal_ * H * 0.5);
        return {(double(x) + 0.5 - W * 0.5) * scale, (H * 0.5 - double(y) - 0.5) * scale, z};
    }

    // Share of light that reaches the middle of each pixel: neighbours above
    // the tangent plane take some away.  Blurred, as the directions alternate.
    std::vector<float> ambient_light(double radius) const {
        std::vector<float> raw(size_t(WIDTH) * HEIGHT, 1.0f), light(raw);
        constexpr unsigned mid = SAMPLES / 2, DIRECTIONS = 8, STEPS = 4;
        for (unsigned y = 0; y < HEIGHT; ++y)
            for (unsigned x = 0; x < WIDTH; ++x) {
                const size_t cx = size_t(x) * SAMPLES + mid, cy = size_t(y) * SAMPLES + mid;
                const size_t at = cy * W + cx;
                if (!(depth_[at] > 0)) continue;
                const Vec here = position_at(cx, cy), n{normal_[at][0], normal_[at][1], normal_[at][2]};
                const double reach = radius * focal_ * H * 0.5 * depth_[at];
                const unsigned pattern = (x & 3u) + 4 * (y & 3u);
                double taken = 0;
                for (unsigned d = 0; d < DIRECTIONS; ++d) {
                    const double angle = 6.283185307179586 * (d + pattern / 16.0) / DIRECTIONS;
                    const double ux = std::cos(angle), uy = std::sin(angle);
                    for (unsigned s = 1; s <= STEPS; ++s) {
                        const double r = reach * (s - 0.5 * ((pattern * 7 % 16) / 16.0)) / STEPS;
                        const double qx = double(cx) + r * ux, qy = double(cy) + r * uy;
                        if (qx < 0 || qy < 0 || qx >= W || qy >= H) continue;
                        const size_t ix = size_t(qx), iy = size_t(qy);
                        if (!(depth_[iy * W + ix] > 0)) continue;
                        const Vec to = position_at(ix, iy) - here;
                        const double length = std::sqrt(dot(to, to));
                        if (!(length > 0)) continue;
                        const double above = dot(n, to) / length - 0.12;
                        if (above > 0) taken += above / (1 + 2 * length * length / (radius * radius));
                    }
                }
                raw[size_t(y) * WIDTH + x] = float(std::max(0.25, 1 - 1.5 * taken / (DIRECTIONS * STEPS)));
            }
        for (unsigned y = 0; y < HEIGHT; ++y)
            for (unsigned x = 0; x < WIDTH; ++x) {
                const size_t at = (size_t(y) * SAMPLES + mid) * W + size_t(x) * SAMPLES + mid;
                const double z = depth_[at] > 0 ? 1.0 / depth_[at] : 0;
                double sum = 0, count = 0;
                for (int j = -2; j < 2; ++j)
                    for (int i = -2; i < 2; ++i) {
                        const int qx = int(x) + i, qy = int(y) + j;
                        if (qx < 0 || qy < 0 || qx >= int(WIDTH) || qy >= int(HEIGHT)) continue;
                        const float other = depth_[(size_t(qy) * SAMPLES + mid) * W + size_t(qx) * SAMPLES + mid];
                        if (!(other > 0) || (z > 0 && std::fabs(1.0 / other - z) > 0.5 * radius)) continue;
                        sum += raw[size_t(qy) * WIDTH + size_t(qx)];
                        count += 1;
                    }
                if (count > 0) light[size_t(y) * WIDTH + x] = float(sum / count);
            }
        return light;
    }

    double focal_;
    std::vector<float> depth_; // 1 / distance, 0 = background
    std::vector<std::array<float, 3>> normal_;
    std::vector<std::array<uint8_t, 3>> colour_; // square root of linear light
};

// Normal of each corner: mean over the triangles around its vertex that do not
// lie beyond a crease, weighted by their angles.  Outward.
std::vector<Vec> corner_normals(const std::vector<Vec>& points, const Foliation& foliation) {
    const std::vector<uint32_t>& triangles = foliation.triangles;
    const size_t count = triangles.size() / 3;
    std::vector<Vec> face(count), normal(3 * count);
    std::vector<double> angle(3 * count);
    std::vector<size_t> start(points.size() + 1, 0);
    std::vector<double> volume(std::max<size_t>(1, foliation.is_bare.size()), 0.0); // of each component
    const auto component = [&](size_t t) { return foliation.component.empty() ? 0 : foliation.component[t]; };
    for (size_t t = 0; t < count; ++t) {
        Vec p[3];
        for (size_t c = 0; c < 3; ++c) p[c] = points[triangles[3 * t + c]] - points[0];
        const Vec n = cross(p[1] - p[0], p[2] - p[0]);
        volume[component(t)] += dot(p[0], n);
        face[t] = unit(n);
        for (size_t c = 0; c < 3; ++c) {
            const Vec a = unit(p[(c + 1) % 3] - p[c]), b = unit(p[(c + 2) % 3] - p[c]);
            angle[3 * t + c] = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
            ++start[triangles[3 * t + c] + 1];
        }
    }
    for (size_t v = 0; v < points.size(); ++v) start[v + 1] += start[v];
    std::vector<size_t> around(3 * count), filled(start.begin(), start.end() - 1);
    for (size_t k = 0; k < 3 * count; ++k) around[filled[triangles[k]]++] = k;
    for (size_t k = 0; k < 3 * count; ++k) {
        const size_t v = triangles[k];
        Vec sum;
        for (size_t r = start[v]; r < start[v + 1]; ++r)
            if (dot(face[around[r] / 3], face[k / 3]) > CREASE_COSINE)
                sum = sum + angle[around[r]] * face[around[r] / 3];
        normal[k] = (volume[component(k / 3)] < 0 ? -1.0 : 1.0) * unit(sum);
    }
    return normal;
}

// Only the part above the tangent plane: the rest of it would come out on the
// other side of a thin sheet.
void draw_button(Canvas& canvas, Vec centre, Vec outward, double radius, Colour colour) {
    const Vec across = unit(cross(outward, std::fabs(outward.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0})),
              along = cross(outward, across);
    constexpr int RINGS = 16, SECTORS = 48;
    constexpr double POLAR = 1.75; // a little more than a half
    const auto corner = [&](int ring, int sector) {
        const double polar = POLAR * ring / RINGS, turn = 6.283185307179586 * sector / SECTORS;
        const Vec n = std::sin(polar) * std::cos(turn) * across + std::sin(polar) * std::sin(turn) * along
                    + std::cos(polar) * outward;
        return Corner{centre + radius * n, n};
    };
    const auto paint = [&](const double*, const double*, const double*) { return colour; };
    for (int ring = 0; ring < RINGS; ++ring)
        for (int sector = 0; sector < SECTORS; ++sector) {
            const Corner a = corner(ring, sector), b = corner(ring, sector + 1), c = corner(ring + 1, sector + 1),
                         d = corner(ring + 1, sector);
            canvas.triangle(a, b, c, paint);
            canvas.triangle(a, c, d, paint);
        }
}

// A straight piece of a line, with a round end.
void draw_rod(Canvas& canvas, Vec from, Vec to, double radius, Colour colour) {
    const Vec axis = unit(to - from), across = unit(cross(axis, std::fabs(axis.x) < 0.7 ? Vec{1, 0, 0} : Vec{0, 1, 0})),
              along = cross(axis, across);
    constexpr int SECTORS = 12, RINGS = 3;
    const auto paint = [&](const double*, const double*, const double*) { return colour; };
    const auto direction = [&](int sector) {
        const double turn = 6.283185307179586 * sector / SECTORS;
        return std::cos(turn) * across + std::sin(turn) * along;
    };
    const auto ball = [&](int ring, int sector) {
        const double polar = 1.5707963267948966 * ring / RINGS;
        const Vec n = std::sin(polar) * direction(sector) + std::cos(polar) * axis;
        return Corner{to + radius * n, n};
    };
    for (int sector = 0; sector < SECTORS; ++sector) {
        const Vec n = direction(sector), m = direction(sector + 1);
        canvas.triangle({from + radius * n, n}, {to + radius * n, n}, {to + radius * m, m}, paint);
        canvas.triangle({from + radius * n, n}, {to + radius * m, m}, {from + radius * m, m}, paint);
        for (int ring = 0; ring < RINGS; ++ring) {
            canvas.triangle(ball(ring, sector), ball(ring, sector + 1), ball(ring + 1, sector + 1), paint);
            canvas.triangle(ball(ring, sector), ball(ring + 1, sector + 1), ball(ring + 1, sector), paint);
        }
    }
}

} // namespace

double pattern_period(const Foliation& foliation, const Potential& potential) {
    double low[3] = {}, high[3] = {};
    for (size_t i = 0; i < foliation.positions.size(); ++i) {
        const double x = foliation.positions[i];
        low[i % 3] = i < 3 ? x : std::min(low[i % 3], x);
        high[i % 3] = i < 3 ? x : std::max(high[i % 3], x);
    }
    const double size = std::sqrt((high[0] - low[0]) * (high[0] - low[0]) + (high[1] - low[1]) * (high[1] - low[1])
                                  + (high[2] - low[2]) * (high[2] - low[2]));
    return choose_period(foliation, potential, size * root_mean_square_gradient(foliation, potential) / STRIPES_ACROSS);
}

Image render(const Foliation& foliation, const Potential& potential, const double* corner_uv,
             const std::vector<Line>& loops) {
    std::vector<Vec> points(foliation.positions.size() / 3);
    for (size_t v = 0; v < points.size(); ++v)
        points[v] = {foliation.positions[3 * v], foliation.positions[3 * v + 1], foliation.positions[3 * v + 2]};
    Vec low = points[0], high = points[0];
    for (Vec p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double size = std::sqrt(dot(high - low, high - low));
    const Camera camera = place_camera(points);
    const std::vector<Vec> normals = corner_normals(points, foliation);
    std::vector<Vec> seen(points.size());
    for (size_t v = 0; v < points.size(); ++v) seen[v] = camera.to_camera(points[v]);

    const double period = pattern_period(foliation, potential);
    // Share of red of the stripes of one linear function with these values at the corners.
    const auto stripes = [&](double value, const double* slope, const double* right, const double* down) {
        const double by_x = slope[0] * right[0] + slope[1] * right[1] + slope[2] * right[2];
        const double by_y = slope[0] * down[0] + slope[1] * down[1] + slope[2] * down[2];
        // A filter one and a half samples wide; the samples do the rest.
        return share_of_red(value, 1.5 * std::sqrt(by_x * by_x + by_y * by_y), period);
    };

    Canvas canvas(camera);
    for (size_t t = 0; t < foliation.triangle_count(); ++t) {
        Corner corner[3];
        for (size_t c = 0; c < 3; ++c) {
            const Vec n = normals[3 * t + c];
            corner[c].position = seen[foliation.triangles[3 * t + c]];
            corner[c].normal = {dot(n, camera.right), dot(n, camera.up), dot(n, camera.forward)};
        }
        canvas.triangle(corner[0], corner[1], corner[2], [&](const double* b, const double* right, const double* down) {
            if (foliation.is_bare_at(t)) return GREY;
            double red;
            if (corner_uv) {
                const double* uv = &corner_uv[6 * t];
                const double u[3] = {uv[0], uv[2], uv[4]}, v[3] = {uv[1], uv[3], uv[5]};
                const double over = stripes(b[0] * u[0] + b[1] * u[1] + b[2] * u[2], u, right, down);
                const double along = stripes(b[0] * v[0] + b[1] * v[1] + b[2] * v[2], v, right, down);
                red = over * (1 - along) + along * (1 - over);
            } else {
                double slope[3] = {};
                const double u = potential_at(potential.piece[t], potential.u[t], b, slope);
                red = stripes(u, slope, right, down);
            }
            return red * RED + (1 - red) * WHITE;
        });
    }
    for (const Line& loop : loops)
        for (size_t i = 0; i < loop.size(); ++i) {
            const auto& p = loop[i];
            const auto& q = loop[i + 1 < loop.size() ? i + 1 : 0];
            draw_rod(canvas, camera.to_camera({p[0], p[1], p[2]}), camera.to_camera({q[0], q[1], q[2]}), 0.0035 * size,
                     GREEN);
        }
    // One corner of each vertex, for its normal.
    std::vector<size_t> corner_of(points.size(), 0);
    for (size_t k = foliation.triangles.size(); k-- > 0;) corner_of[foliation.triangles[k]] = k;
    const auto to_view = [&](Vec n) { return Vec{dot(n, camera.right), dot(n, camera.up), dot(n, camera.forward)}; };
    for (const hmf_singularity& s : foliation.singular) {
        Vec place, outward;
        if (s.kind == HMF_SINGULAR_TRIANGLE) {
            for (size_t k = 3 * size_t(s.element); k < 3 * size_t(s.element) + 3; ++k) {
                place = place + (1.0 / 3) * seen[foliation.triangles[k]];
                outward = outward + to_view(normals[k]);
            }
        } else {
            place = seen[s.element];
            outward = to_view(normals[corner_of[s.element]]);
        }
        draw_button(canvas, place, unit(outward), 0.0105 * size, s.index < 0 ? BLUE : s.index > 0 ? YELLOW : VIOLET);
    }
    return canvas.resolve(0.05 * size);
}

} // namespace cli
