#include "canvas.hpp"

#include <cstring>

namespace cli {

namespace {

// So far outside, in barycentric coordinates, a place still counts as on the triangle: no gap opens along a side.
constexpr double SLACK = 1e-9;

constexpr float COLOR_UNIT = 32768, NORMAL_UNIT = 16384;

int clamped(double x, int low, int high) { return x <= low ? low : x >= high ? high : int(x); }

} // namespace

Canvas::Canvas(const Camera& camera, unsigned width, unsigned height, const Workers& workers) :
    width_(width), height_(height), scale_(camera.focal * height * 0.5), pixel_(1 / scale_), workers_(workers) {}

ScreenPoint Canvas::project(Vec p) const {
    const double w = p.z < 0 ? -1 / p.z : 0;
    return {width_ * 0.5 + p.x * w * scale_, height_ * 0.5 - p.y * w * scale_, w};
}

void Canvas::add(const std::vector<ScreenPoint>& points, const std::vector<uint32_t>& triangles) {
    sheets_.push_back({&points, &triangles});
}

void Canvas::begin() {
    choose_area();
    sort_into_bands();
    front_.reset(new Hit[wide_ * high_]);
    lit_.reset(new Lit[wide_ * high_]);
}

// All that is in front of the camera, and a pixel around it.
void Canvas::choose_area() {
    double left = width_, right = 0, top = height_, bottom = 0;
    for (const Sheet& sheet : sheets_)
        for (const ScreenPoint& p : *sheet.points) {
            if (!(p.w > 0)) continue;
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
        }
    left_ = size_t(clamped(left - 1, 0, int(width_)));
    top_ = size_t(clamped(top - 1, 0, int(height_)));
    wide_ = std::max(size_t(clamped(right + 2, 0, int(width_))), left_) - left_;
    high_ = std::max(size_t(clamped(bottom + 2, 0, int(height_))), top_) - top_;
}

Canvas::Corners Canvas::corners(uint32_t triangle) const {
    size_t sheet = 0, local = triangle;
    while (local >= sheets_[sheet].triangles->size() / 3) local -= sheets_[sheet++].triangles->size() / 3;
    const std::vector<ScreenPoint>& p = *sheets_[sheet].points;
    const uint32_t* const t = &(*sheets_[sheet].triangles)[3 * local];
    return {&p[t[0]], &p[t[1]], &p[t[2]]};
}

void Canvas::sort_into_bands() {
    size_t count = 0;
    for (const Sheet& sheet : sheets_) count += sheet.triangles->size() / 3;
    // First and last band of each triangle; first > last: none.
    std::vector<std::array<uint16_t, 2>> range(count);
    constexpr size_t PART = 8192;
    workers_.each((count + PART - 1) / PART, [&](size_t part) {
        for (size_t t = part * PART; t < std::min(count, (part + 1) * PART); ++t) {
            const Corners c = corners(uint32_t(t));
            range[t] = {1, 0};
            const double low = std::min({c[0]->y, c[1]->y, c[2]->y}) - double(top_),
                         high = std::max({c[0]->y, c[1]->y, c[2]->y}) - double(top_);
            if (!(c[0]->w > 0 && c[1]->w > 0 && c[2]->w > 0) || !(high >= 0) || !(low < double(high_))) continue;
            range[t] = {uint16_t(clamped(low, 0, int(high_) - 1) / int(BAND)),
                        uint16_t(clamped(high, 0, int(high_) - 1) / int(BAND))};
        }
    });
    band_start_.assign(bands() + 1, 0);
    for (const auto [first, last] : range)
        for (uint32_t band = first; band <= last; ++band) ++band_start_[band + 1];
    for (size_t band = 0; band < bands(); ++band) band_start_[band + 1] += band_start_[band];
    band_triangles_.resize(band_start_.back());
    std::vector<uint32_t> filled(band_start_.begin(), band_start_.end() - 1);
    for (uint32_t t = 0; t < count; ++t)
        for (uint32_t band = range[t][0]; band <= range[t][1]; ++band) band_triangles_[filled[band]++] = t;
}

Projected Canvas::projected(uint32_t triangle) const {
    const Corners p = corners(triangle);
    Projected s;
    const double area = (p[1]->x - p[0]->x) * (p[2]->y - p[0]->y) - (p[2]->x - p[0]->x) * (p[1]->y - p[0]->y);
    s.is_seen = std::fabs(area) > 1e-12;
    const double inverse = s.is_seen ? 1 / area : 0;
    for (size_t m = 0; m < 3; ++m) {
        const ScreenPoint &q = *p[(m + 1) % 3], &r = *p[(m + 2) % 3];
        Ramp& side = s.side[m];
        side.right = (q.y - r.y) * inverse;
        side.down = (r.x - q.x) * inverse;
        side.at0 = -(side.right * q.x + side.down * q.y);
        s.w[m] = p[m]->w;
    }
    s.inverse = s.numerator(1, 1, 1);
    return s;
}

// Row by row between the sides.
void Canvas::find_visible(size_t band) {
    std::fill(&front_[first_row(band) * wide_], &front_[end_row(band) * wide_], Hit{0, NONE});
    const int left = int(left_), right = int(left_ + wide_), top = int(top_ + first_row(band)),
              bottom = int(top_ + end_row(band));
    for (uint32_t k = band_start_[band]; k < band_start_[band + 1]; ++k) {
        const uint32_t triangle = band_triangles_[k];
        const Corners c = corners(triangle);
        const int x0 = clamped(std::min({c[0]->x, c[1]->x, c[2]->x}) + 0.5, left, right),
                  x1 = clamped(std::max({c[0]->x, c[1]->x, c[2]->x}) + 0.5, left, right),
                  y0 = clamped(std::min({c[0]->y, c[1]->y, c[2]->y}) + 0.5, top, bottom),
                  y1 = clamped(std::max({c[0]->y, c[1]->y, c[2]->y}) + 0.5, top, bottom);
        if (x0 >= x1 || y0 >= y1) continue; // no middle of a pixel
        const Projected p = projected(triangle);
        if (!p.is_seen) continue;
        double turned[3];
        for (int m = 0; m < 3; ++m) turned[m] = p.side[m].right != 0 ? 1 / p.side[m].right : 0;
        for (int y = y0; y < y1; ++y) {
            const double py = y + 0.5;
            double from = x0 + 0.5, to = x1 - 0.5;
            for (int m = 0; m < 3; ++m) {
                const double start = p.side[m].at0 + py * p.side[m].down + SLACK, zero = -start * turned[m];
                if (turned[m] > 0) from = std::max(from, zero);
                else if (turned[m] < 0) to = std::min(to, zero);
                else if (start < 0) to = -1;
            }
            if (!(from <= to)) continue;
            const int begin = int(std::ceil(from - 0.5)), end = int(to + 0.5); // to - 0.5, and the pixel after
            Hit* const row = &front_[size_t(y - int(top_)) * wide_];
            for (int x = begin; x < end; ++x) {
                const float w = float(p.inverse.at(x + 0.5, py));
                Hit& hit = row[x - left];
                if (w > hit.w) hit = {w, triangle};
            }
        }
    }
}

void Canvas::Batch::resize(size_t size) {
    count = size;
    for (std::vector<float>* const v : {&x, &y, &albedo[0], &albedo[1], &albedo[2], &normal[0], &normal[1], &normal[2]})
        v->resize(size);
}

namespace {

// A loop without branches over arrays apart from each other, which compilers turn into one over several places at once.
// x, y: on the screen, from its middle, in units at distance 1.
void light_all(size_t count, const float* __restrict x, const float* __restrict y, float* __restrict nx,
               float* __restrict ny, float* __restrict nz, float* __restrict red, float* __restrict green,
               float* __restrict blue) {
    static const Vec key = unit({-0.45, 0.75, 0.65}), fill = unit({0.85, 0.1, 0.45});
    const float kx = float(key.x), ky = float(key.y), kz = float(key.z), fx = float(fill.x), fy = float(fill.y),
                fz = float(fill.z);
    const auto positive = [](float v) { return 0.5f * (v + std::fabs(v)); };
    for (size_t k = 0; k < count; ++k) {
        // Towards the camera.
        const float uz = 1 / std::sqrt(x[k] * x[k] + y[k] * y[k] + 1), ux = -x[k] * uz, uy = -y[k] * uz;
        // A normal that points away from the camera is bent to its outline.
        const float shorter = 1 / std::sqrt(nx[k] * nx[k] + ny[k] * ny[k] + nz[k] * nz[k] + 1e-30f);
        float a = nx[k] * shorter, b = ny[k] * shorter, c = nz[k] * shorter;
        const float away = -positive(-(a * ux + b * uy + c * uz));
        const float bent = 1 / std::sqrt(1 - 0.9996f * away * away);
        a = (a - 1.02f * away * ux) * bent;
        b = (b - 1.02f * away * uy) * bent;
        c = (c - 1.02f * away * uz) * bent;
        const float diffuse =
            0.31f + 0.09f * b + 0.68f * positive(a * kx + b * ky + c * kz) + 0.17f * positive(a * fx + b * fy + c * fz);
        const float hx = kx + ux, hy = ky + uy, hz = kz + uz;
        const float shine = positive((a * hx + b * hy + c * hz) / std::sqrt(hx * hx + hy * hy + hz * hz));
        const float s2 = shine * shine, s4 = s2 * s2, s8 = s4 * s4, s16 = s8 * s8, s32 = s16 * s16;
        const float flat = 1 - (a * ux + b * uy + c * uz);
        const float white = 0.10f * s32 * s8 * s4 * shine + 0.05f * flat * flat * flat;
        red[k] = diffuse * red[k] + white;
        green[k] = diffuse * green[k] + white;
        blue[k] = diffuse * blue[k] + white;
        nx[k] = a;
        ny[k] = b;
        nz[k] = c;
    }
}

} // namespace

void Canvas::light(Batch& batch) const {
    const float pixel = float(pixel_), half_width = 0.5f * float(width_), half_height = 0.5f * float(height_);
    for (size_t k = 0; k < batch.count; ++k) {
        batch.x[k] = (batch.x[k] - half_width) * pixel;
        batch.y[k] = (half_height - batch.y[k]) * pixel;
    }
    light_all(batch.count, batch.x.data(), batch.y.data(), batch.normal[0].data(), batch.normal[1].data(),
              batch.normal[2].data(), batch.albedo[0].data(), batch.albedo[1].data(), batch.albedo[2].data());
}

void Canvas::keep_row(size_t y, const Batch& row) {
    Lit* const kept = &lit_[y * wide_];
    for (size_t x = 0; x < wide_; ++x)
        for (size_t c = 0; c < 3; ++c) {
            kept[x].color[c] = uint16_t(int(std::min(65535.0f, row.albedo[c][x] * COLOR_UNIT + 0.5f)));
            kept[x].normal[c] = int16_t(int(row.normal[c][x] * NORMAL_UNIT));
        }
}

bool Canvas::differ(size_t a, size_t b) const {
    const Hit &p = front_[a], &q = front_[b];
    const uint32_t surface = uint32_t(sheets_[0].triangles->size() / 3);
    if (p.triangle == NONE || q.triangle == NONE || (p.triangle < surface) != (q.triangle < surface)) return true;
    const int16_t *const m = lit_[a].normal, *const n = lit_[b].normal;
    // Distances that differ by more than 8 pixels, or directions by more than 20 degrees.
    return std::fabs(p.w - q.w) > float(8 * pixel_) * std::min(p.w, q.w)
        || m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < int(0.94f * NORMAL_UNIT * NORMAL_UNIT);
}

Canvas::Rough Canvas::find_rough(size_t band) const {
    const size_t first = first_row(band), end = end_row(band);
    Rough rough;
    std::vector<uint8_t> marked((end - first) * wide_, 0);
    const auto mark = [&](size_t at) {
        if (at / wide_ >= first && at / wide_ < end) marked[at - first * wide_] = 1;
    };
    const auto compare = [&](size_t a, size_t b) {
        if (front_[a].triangle == front_[b].triangle || !differ(a, b)) return;
        mark(a);
        mark(b);
    };
    for (size_t y = first > 0 ? first - 1 : 0; y < end; ++y)
        for (size_t x = 0, at = y * wide_; x < wide_; ++x, ++at) {
            if (x + 1 < wide_ && y >= first) compare(at, at + 1);
            if (y + 1 < high_) compare(at, at + wide_);
        }
    std::vector<uint32_t> slot(marked.size(), NONE);
    for (size_t k = 0; k < marked.size(); ++k) {
        if (!marked[k]) continue;
        slot[k] = uint32_t(rough.pixels.size());
        rough.pixels.push_back(uint32_t(first * wide_ + k));
    }
    rough.samples.assign(rough.pixels.size() * FINE, Hit{0, NONE});
    sample(band, slot, rough.samples);
    return rough;
}

// slot: the number of each pixel of the band among the rough ones, or NONE.
void Canvas::sample(size_t band, const std::vector<uint32_t>& slot, std::vector<Hit>& samples) const {
    // Squares of pixels with a rough one among them: most triangles lie in none.
    constexpr int SQUARE = 4;
    const size_t across = wide_ / SQUARE + 1;
    std::vector<uint8_t> has_rough(across * (BAND / SQUARE), 0);
    for (size_t k = 0; k < slot.size(); ++k)
        if (slot[k] != NONE) has_rough[k / wide_ / SQUARE * across + k % wide_ / SQUARE] = 1;
    const double left = double(left_), top = double(top_ + first_row(band));
    const int last_x = int(wide_) - 1, last_y = int(end_row(band) - first_row(band)) - 1;
    for (uint32_t k = band_start_[band]; k < band_start_[band + 1]; ++k) {
        const Corners c = corners(band_triangles_[k]);
        const int x0 = clamped(std::min({c[0]->x, c[1]->x, c[2]->x}) - left, 0, last_x),
                  x1 = clamped(std::max({c[0]->x, c[1]->x, c[2]->x}) - left, 0, last_x),
                  y0 = clamped(std::min({c[0]->y, c[1]->y, c[2]->y}) - top, 0, last_y),
                  y1 = clamped(std::max({c[0]->y, c[1]->y, c[2]->y}) - top, 0, last_y);
        bool is_rough = false;
        for (int y = y0 / SQUARE; y <= y1 / SQUARE; ++y)
            for (int x = x0 / SQUARE; x <= x1 / SQUARE; ++x)
                is_rough = is_rough || has_rough[size_t(y) * across + size_t(x)];
        if (!is_rough) continue;
        const Projected p = projected(band_triangles_[k]);
        if (!p.is_seen) continue;
        double reach[3]; // from the middle of a pixel to its outermost samples
        for (int m = 0; m < 3; ++m) reach[m] = SLACK + (std::fabs(p.side[m].right) + std::fabs(p.side[m].down)) / SIDE;
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const uint32_t r = slot[size_t(y) * wide_ + size_t(x)];
                if (r == NONE) continue;
                const double px = x + left, py = y + top;
                if (p.side[0].at(px + 0.5, py + 0.5) < -reach[0] || p.side[1].at(px + 0.5, py + 0.5) < -reach[1]
                    || p.side[2].at(px + 0.5, py + 0.5) < -reach[2])
                    continue;
                for (size_t n = 0; n < FINE; ++n) {
                    const double sx = px + (double(n % SIDE) + 0.5) / SIDE, sy = py + (double(n / SIDE) + 0.5) / SIDE;
                    if (!(p.side[0].at(sx, sy) >= -SLACK && p.side[1].at(sx, sy) >= -SLACK
                          && p.side[2].at(sx, sy) >= -SLACK))
                        continue;
                    Hit& hit = samples[r * FINE + n];
                    const float w = float(p.inverse.at(sx, sy));
                    if (w > hit.w) hit = {w, band_triangles_[k]};
                }
            }
    }
}

AmbientLight Canvas::ambient_light(double radius) const {
    AmbientLight open(wide_, high_);
    for (size_t j = 0; j < open.high(); ++j)
        for (size_t i = 0; i < open.wide(); ++i) {
            const size_t x = AmbientLight::GRID * i, y = AmbientLight::GRID * j, at = y * wide_ + x;
            if (front_[at].triangle == NONE) continue;
            const double distance = 1.0 / double(front_[at].w), scale = distance * pixel_;
            const int16_t* const n = lit_[at].normal;
            open.set(i, j,
                     {float((double(x + left_) + 0.5 - width_ * 0.5) * scale),
                      float((height_ * 0.5 - double(y + top_) - 0.5) * scale), float(-distance)},
                     {n[0] / NORMAL_UNIT, n[1] / NORMAL_UNIT, n[2] / NORMAL_UNIT});
        }
    open.find(float(radius), float(scale_), workers_);
    return open;
}

// The same along each row, which compresses well.
Color Canvas::background(size_t row) const {
    const double fall = double(row) / height_;
    return {0.95 - 0.16 * fall, 0.955 - 0.15 * fall, 0.97 - 0.13 * fall};
}

double Canvas::depth_at(double x, double y) const {
    x -= double(left_);
    y -= double(top_);
    if (!(x >= 0 && y >= 0 && x < double(wide_) && y < double(high_))) return 0;
    return double(front_[size_t(y) * wide_ + size_t(x)].w);
}

namespace {

// From linear light to bytes.
class Gamma {
public:
    Gamma() {
        for (size_t k = 0; k <= STEPS; ++k)
            table_[k] = uint8_t(std::lround(255 * std::pow(double(k) / STEPS, 1 / 2.2)));
    }
    void put(uint8_t* pixel, float red, float green, float blue) const {
        pixel[0] = byte_of(red);
        pixel[1] = byte_of(green);
        pixel[2] = byte_of(blue);
    }
    void put(uint8_t* pixel, Color c) const { put(pixel, float(c.x), float(c.y), float(c.z)); }

private:
    static constexpr size_t STEPS = 4096;
    uint8_t byte_of(float channel) const {
        return table_[size_t(int(std::min(1.0f, std::max(0.0f, channel)) * STEPS + 0.5f))];
    }
    std::array<uint8_t, STEPS + 1> table_;
};

const Gamma gamma_table;

} // namespace

Image Canvas::background_image() const {
    Image image;
    image.width = width_;
    image.height = height_;
    const size_t bytes = 3 * size_t{width_};
    image.rgb.resize(bytes * height_);
    workers_.each((height_ + BAND - 1) / BAND, [&](size_t part) {
        for (size_t y = part * BAND; y < std::min<size_t>(height_, (part + 1) * BAND); ++y) {
            uint8_t* const row = &image.rgb[y * bytes];
            gamma_table.put(row, background(y));
            for (size_t done = 3; done < bytes; done *= 2) std::memcpy(row + done, row, std::min(done, bytes - done));
        }
    });
    return image;
}

void Canvas::resolve(size_t band, const AmbientLight& open, const Rough& rough, const std::vector<Color>& sums,
                     Image& image) const {
    const auto pixel = [&](size_t at) { return &image.rgb[3 * ((at / wide_ + top_) * width_ + at % wide_ + left_)]; };
    for (size_t y = first_row(band); y < end_row(band); ++y) {
        uint8_t* const row = pixel(y * wide_);
        for (size_t x = 0, at = y * wide_; x < wide_; ++x, ++at) {
            if (front_[at].triangle == NONE) continue;
            const float light = open_at(open, at) / COLOR_UNIT;
            const uint16_t* const c = lit_[at].color;
            gamma_table.put(row + 3 * x, light * c[0], light * c[1], light * c[2]);
        }
    }
    for (size_t r = 0; r < rough.pixels.size(); ++r) gamma_table.put(pixel(rough.pixels[r]), sums[r]);
}

} // namespace cli
