#include "canvas.hpp"

#include <cmath>

namespace cli {

namespace {

int clamped(double x, int low, int high) { return x <= low ? low : x >= high ? high : int(x); }

} // namespace

Canvas::Canvas(const Camera& camera, unsigned width, unsigned height) :
    width_(width), height_(height), scale_(camera.focal * height * 0.5), pixel_(1 / scale_),
    front_(size_t{width} * height) {}

ScreenPoint Canvas::project(Vec p) const {
    const double w = p.z < 0 ? -1 / p.z : 0;
    return {width_ * 0.5 + p.x * w * scale_, height_ * 0.5 - p.y * w * scale_, w};
}

void Canvas::add(const std::vector<ScreenPoint>& points, const std::vector<uint32_t>& triangles) {
    sheets_.push_back({&points, &triangles});
}

Canvas::Setup Canvas::set_up(const ScreenPoint* a, const ScreenPoint* b, const ScreenPoint* c) {
    const ScreenPoint* const p[3] = {a, b, c};
    Setup s;
    const double area = (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y);
    s.is_seen = area != 0 && a->w > 0 && b->w > 0 && c->w > 0;
    const double inverse = area != 0 ? 1 / area : 0;
    for (int m = 0; m < 3; ++m) {
        const ScreenPoint &q = *p[(m + 1) % 3], &r = *p[(m + 2) % 3];
        s.ex[m] = (q.y - r.y) * inverse;
        s.ey[m] = (r.x - q.x) * inverse;
        s.e[m] = -(s.ex[m] * q.x + s.ey[m] * q.y);
        s.w[m] = p[m]->w;
    }
    return s;
}

void Canvas::find_visible() {
    uint32_t first = 0;
    for (const Sheet& sheet : sheets_) {
        const std::vector<uint32_t>& t = *sheet.triangles;
        const uint32_t count = uint32_t(t.size() / 3);
        for (uint32_t k = 0; k < count; ++k) {
            const ScreenPoint *a = &(*sheet.points)[t[3 * k]], *b = &(*sheet.points)[t[3 * k + 1]],
                              *c = &(*sheet.points)[t[3 * k + 2]];
            const int x0 = clamped(std::min({a->x, b->x, c->x}) + 0.5, 0, int(width_)),
                      x1 = clamped(std::max({a->x, b->x, c->x}) + 0.5, 0, int(width_));
            const int y0 = clamped(std::min({a->y, b->y, c->y}) + 0.5, 0, int(height_)),
                      y1 = clamped(std::max({a->y, b->y, c->y}) + 0.5, 0, int(height_));
            if (x0 >= x1 || y0 >= y1) continue; // no middle of a pixel
            const Setup s = set_up(a, b, c);
            if (!s.is_seen) continue;
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) {
                    const double px = x + 0.5, py = y + 0.5;
                    const double u = s.e[0] + px * s.ex[0] + py * s.ey[0], v = s.e[1] + px * s.ex[1] + py * s.ey[1],
                                 q = s.e[2] + px * s.ex[2] + py * s.ey[2];
                    if (!(u >= -1e-9 && v >= -1e-9 && q >= -1e-9)) continue;
                    Hit& hit = front_[size_t(y) * width_ + size_t(x)];
                    const float w = float(u * s.w[0] + v * s.w[1] + q * s.w[2]);
                    if (w > hit.w) hit = {w, first + k};
                }
        }
        first += count;
    }
}

void Canvas::find_rough() {
    const uint32_t surface = uint32_t(sheets_[0].triangles->size() / 3);
    std::vector<uint32_t> slot(front_.size(), NONE);
    const float step = float(8 * pixel_);
    const auto differ = [&](size_t a, size_t b) {
        const Hit &p = front_[a], &q = front_[b];
        if (p.triangle == q.triangle) return false;
        if (p.triangle == NONE || q.triangle == NONE || (p.triangle < surface) != (q.triangle < surface)) return true;
        const float *const m = shaded_[a].n, *const n = shaded_[b].n;
        // Distances that differ by more than 8 pixels.
        return std::fabs(p.w - q.w) > step * std::min(p.w, q.w) || m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < 0.94f;
    };
    const auto mark = [&](size_t at) {
        if (slot[at] != NONE) return;
        slot[at] = uint32_t(rough_.size());
        rough_.push_back(uint32_t(at));
    };
    for (unsigned y = 0; y < height_; ++y)
        for (unsigned x = 0; x < width_; ++x) {
            const size_t at = size_t{y} * width_ + x;
            if (x + 1 < width_ && differ(at, at + 1)) {
                mark(at);
                mark(at + 1);
            }
            if (y + 1 < height_ && differ(at, at + width_)) {
                mark(at);
                mark(at + width_);
            }
        }
    fine_.assign(rough_.size() * FINE, {});
    uint32_t first = 0;
    for (const Sheet& sheet : sheets_) {
        const std::vector<uint32_t>& t = *sheet.triangles;
        const uint32_t count = uint32_t(t.size() / 3);
        for (uint32_t k = 0; k < count; ++k) {
            const ScreenPoint *a = &(*sheet.points)[t[3 * k]], *b = &(*sheet.points)[t[3 * k + 1]],
                              *c = &(*sheet.points)[t[3 * k + 2]];
            const int x0 = clamped(std::min({a->x, b->x, c->x}), 0, int(width_) - 1),
                      x1 = clamped(std::max({a->x, b->x, c->x}), 0, int(width_) - 1);
            const int y0 = clamped(std::min({a->y, b->y, c->y}), 0, int(height_) - 1),
                      y1 = clamped(std::max({a->y, b->y, c->y}), 0, int(height_) - 1);
            Setup s;
            bool is_set_up = false;
            for (int y = y0; y <= y1; ++y)
                for (int x = x0; x <= x1; ++x) {
                    const uint32_t r = slot[size_t(y) * width_ + size_t(x)];
                    if (r == NONE) continue;
                    if (!is_set_up) {
                        s = set_up(a, b, c);
                        is_set_up = true;
                    }
                    if (!s.is_seen) continue;
                    for (size_t n = 0; n < FINE; ++n) {
                        const double px = x + (double(n % SIDE) + 0.5) / SIDE, py = y + (double(n / SIDE) + 0.5) / SIDE;
                        const double u = s.e[0] + px * s.ex[0] + py * s.ey[0], v = s.e[1] + px * s.ex[1] + py * s.ey[1],
                                     q = s.e[2] + px * s.ex[2] + py * s.ey[2];
                        if (!(u >= -1e-9 && v >= -1e-9 && q >= -1e-9)) continue;
                        Hit& hit = fine_[r * FINE + n];
                        const float w = float(u * s.w[0] + v * s.w[1] + q * s.w[2]);
                        if (w > hit.w) hit = {w, first + k};
                    }
                }
        }
        first += count;
    }
}

Colour Canvas::light(Colour albedo, Vec n, Vec view) {
    static const Vec key = unit({-0.45, 0.75, 0.65}), fill = unit({0.85, 0.1, 0.45});
    const double sky = 0.5 + 0.5 * n.y;
    const double diffuse = 0.22 + 0.18 * sky + 0.68 * std::max(0.0, dot(n, key)) + 0.17 * std::max(0.0, dot(n, fill));
    const double c = std::max(0.0, dot(n, unit(key + view))), c4 = c * c * c * c, c8 = c4 * c4, c32 = c8 * c8 * c8 * c8;
    const double flat = 1 - std::clamp(dot(n, view), 0.0, 1.0);
    const double white = 0.10 * c32 * c8 * c4 * c + 0.05 * flat * flat * flat;
    return diffuse * albedo + Vec{white, white, white};
}

// The same along each row, which compresses well.
Colour Canvas::background(size_t row) const {
    const double fall = double(row) / height_;
    return {0.95 - 0.16 * fall, 0.955 - 0.15 * fall, 0.97 - 0.13 * fall};
}

Vec Canvas::position_at(size_t x, size_t y) const {
    const double distance = 1.0 / double(front_[y * width_ + x].w), scale = distance * pixel_;
    return {(double(x) + 0.5 - width_ * 0.5) * scale, (height_ * 0.5 - double(y) - 0.5) * scale, -distance};
}

double Canvas::depth_at(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < width_ && y < height_)) return 0;
    return double(front_[size_t(y) * width_ + size_t(x)].w);
}

// Share of light that reaches each pixel: neighbours above the tangent plane take some away.  Found at every third
// pixel of every third row, blurred there, as the directions alternate, and interpolated; never across a step in depth.
std::vector<float> Canvas::ambient_light(double radius) const {
    constexpr unsigned DIRECTIONS = 8, STEPS = 4, PATTERNS = 16, GRID = 3;
    static const auto turns = [] {
        std::array<std::array<float, 2>, DIRECTIONS * PATTERNS> table{};
        for (size_t k = 0; k < table.size(); ++k) {
            const double angle = 6.283185307179586 * double(k) / double(table.size());
            table[k] = {float(std::cos(angle)), float(std::sin(angle))};
        }
        return table;
    }();
    struct Node {
        float x = 0, y = 0, z = 0; // in the camera's frame; z 0: background
    };
    const unsigned wide = (width_ + GRID - 1) / GRID, high = (height_ + GRID - 1) / GRID;
    std::vector<Node> nodes(size_t{wide} * high);
    for (unsigned j = 0; j < high; ++j)
        for (unsigned i = 0; i < wide; ++i) {
            if (front_[size_t{GRID} * (size_t{j} * width_ + i)].triangle == NONE) continue;
            const Vec p = position_at(size_t{GRID} * i, size_t{GRID} * j);
            nodes[size_t{j} * wide + i] = {float(p.x), float(p.y), float(p.z)};
        }
    std::vector<float> raw(nodes.size(), 1.0f), blurred(nodes.size(), 1.0f), light(front_.size(), 1.0f);
    const float spread = float(2 / (radius * radius)), jump = float(0.5 * radius);
    for (unsigned j = 0; j < high; ++j)
        for (unsigned i = 0; i < wide; ++i) {
            const size_t at = size_t{GRID} * (size_t{j} * width_ + i);
            const Node here = nodes[size_t{j} * wide + i];
            if (here.z == 0) continue;
            const float* const n = shaded_[at].n;
            const unsigned pattern = (i & 3u) + 4 * (j & 3u);
            const float reach = float(radius * scale_ * double(front_[at].w) / (GRID * STEPS)),
                        inset = 0.5f * float(pattern * 7 % 16) / 16;
            float taken = 0;
            for (unsigned d = 0; d < DIRECTIONS; ++d) {
                const auto [ux, uy] = turns[d * PATTERNS + pattern];
                for (unsigned s = 1; s <= STEPS; ++s) {
                    const float r = reach * (float(s) - inset);
                    const float qx = float(i) + 0.5f + r * ux, qy = float(j) + 0.5f + r * uy;
                    if (!(qx >= 0 && qy >= 0 && qx < float(wide) && qy < float(high))) continue;
                    const Node there = nodes[size_t(qy) * wide + size_t(qx)];
                    if (there.z == 0) continue;
                    const float x = there.x - here.x, y = there.y - here.y, z = there.z - here.z;
                    const float above = n[0] * x + n[1] * y + n[2] * z, square = x * x + y * y + z * z;
                    // Lower than 7 degrees: nothing.
                    if (!(above > 0) || above * above <= 0.0144f * square) continue;
                    taken += (above / std::sqrt(square) - 0.12f) / (1 + spread * square);
                }
            }
            raw[size_t{j} * wide + i] = std::max(0.25f, 1 - 1.5f * taken / (DIRECTIONS * STEPS));
        }
    for (unsigned j = 0; j < high; ++j)
        for (unsigned i = 0; i < wide; ++i) {
            const float z = nodes[size_t{j} * wide + i].z;
            if (z == 0) continue;
            float sum = 0, count = 0;
            for (unsigned b = j > 1 ? j - 2 : 0; b < std::min(high, j + 2); ++b)
                for (unsigned a = i > 1 ? i - 2 : 0; a < std::min(wide, i + 2); ++a) {
                    const size_t other = size_t{b} * wide + a;
                    if (nodes[other].z == 0 || std::fabs(nodes[other].z - z) > jump) continue;
                    sum += raw[other];
                    count += 1;
                }
            blurred[size_t{j} * wide + i] = sum / count; // its own is among them
        }
    const auto interpolate = [&](size_t at, size_t x, size_t y) {
        const float z = front_[at].triangle != NONE ? -1 / front_[at].w : 0;
        const size_t i = x / GRID, j = y / GRID;
        const float over = float(x % GRID) / GRID, down = float(y % GRID) / GRID;
        float sum = 0, all = 0;
        for (size_t k = 0; k < 4; ++k) {
            const size_t a = i + (k & 1), b = j + (k >> 1);
            const float weight = ((k & 1) ? over : 1 - over) * ((k >> 1) ? down : 1 - down);
            if (a >= wide || b >= high || weight == 0) continue;
            const Node& node = nodes[b * wide + a];
            if (node.z == 0 || (z != 0 && std::fabs(node.z - z) > jump)) continue;
            sum += weight * blurred[b * wide + a];
            all += weight;
        }
        if (all > 0) light[at] = sum / all;
    };
    for (size_t y = 0, at = 0; y < height_; ++y)
        for (size_t x = 0; x < width_; ++x, ++at)
            if (front_[at].triangle != NONE) interpolate(at, x, y);
    for (const uint32_t at : rough_)
        if (front_[at].triangle == NONE) interpolate(at, at % width_, at / width_);
    return light;
}

Image Canvas::resolve(const std::vector<float>& open, const std::vector<Colour>& rough_sum) const {
    constexpr size_t STEPS = 4096;
    static const auto gamma = [] {
        std::array<uint8_t, STEPS + 1> table{};
        for (size_t k = 0; k <= STEPS; ++k) table[k] = uint8_t(std::lround(255 * std::pow(double(k) / STEPS, 1 / 2.2)));
        return table;
    }();
    Image image;
    image.width = width_;
    image.height = height_;
    image.rgb.resize(front_.size() * 3);
    const auto put = [&](size_t at, Colour c) {
        const double channel[3] = {c.x, c.y, c.z};
        for (size_t k = 0; k < 3; ++k)
            image.rgb[3 * at + k] = gamma[size_t(std::clamp(channel[k], 0.0, 1.0) * STEPS + 0.5)];
    };
    for (size_t y = 0, at = 0; y < height_; ++y) {
        const Colour back = background(y);
        for (size_t x = 0; x < width_; ++x, ++at)
            put(at, front_[at].triangle == NONE ? back : double(open[at]) * shaded_[at].colour());
    }
    for (size_t r = 0; r < rough_.size(); ++r) put(rough_[r], rough_sum[r]);
    return image;
}

} // namespace cli
