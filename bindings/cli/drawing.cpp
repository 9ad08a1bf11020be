// Letters are strokes on a grid, a point is written as its column and its row, a blank lifts the pen:
//
//     i +---+---+      i: top of capitals and digits
//     g | o---o |      g: top of small letters
//     e |  \ /  |      "0g2c4g" is a v
//     c +---o---+      c: base line
//     a |              a: foot of g, p, q, y
//       0   2   4
#include "drawing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cli {

namespace {

// The covered part of a pixel at this distance from the outline of a shape (inside: negative).
double share(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

void blend(Image& image, int x, int y, Ink ink, double opacity) {
    if (x < 0 || y < 0 || x >= int(image.width) || y >= int(image.height) || !(opacity > 0)) return;
    uint8_t* const pixel = &image.rgb[3 * (size_t(y) * image.width + size_t(x))];
    const double channel[3] = {ink.red, ink.green, ink.blue};
    for (int k = 0; k < 3; ++k) pixel[k] = uint8_t(std::lround(pixel[k] + opacity * (channel[k] - pixel[k])));
}

// Opacity of each pixel in the box by a function of its middle.
template <class Opacity>
void fill(Image& image, double x0, double y0, double x1, double y1, const Opacity& opacity) {
    const auto limit = [](double v, unsigned most) { return int(std::clamp(v, 0.0, double(most))); };
    for (int y = limit(y0 - 1, image.height); y < limit(y1 + 2, image.height); ++y)
        for (int x = limit(x0 - 1, image.width); x < limit(x1 + 2, image.width); ++x) opacity(x, y, x + 0.5, y + 0.5);
}

const char* strokes_of(char c) {
    switch (c) {
    case 'a': return "4g4c 4f3g1g0f0d1c3c4d";
    case 'b': return "0i0c 0f1g3g4f4d3c1c0d";
    case 'c': return "4f3g1g0f0d1c3c4d";
    case 'd': return "4i4c 4f3g1g0f0d1c3c4d";
    case 'e': return "0e4e4f3g1g0f0d1c3c4d";
    case 'f': return "3i2i1h1c 0g3g";
    case 'g': return "4g4b3a1a0b 4f3g1g0f0d1c3c4d";
    case 'h': return "0i0c 0f1g3g4f4c";
    case 'i': return "2g2c 2h2i";
    case 'j': return "3g3b2a1a 3h3i";
    case 'k': return "0i0c 3g0e3c";
    case 'l': return "1i1d2c3c";
    case 'm': return "0g0c 0f1g2f2c 2f3g4f4c";
    case 'n': return "0g0c 0f1g3g4f4c";
    case 'o': return "1c3c4d4f3g1g0f0d1c";
    case 'p': return "0g0a 0f1g3g4f4d3c1c0d";
    case 'q': return "4g4a 4f3g1g0f0d1c3c4d";
    case 'r': return "0g0c 0f1g3g";
    case 's': return "4f3g1g0f1e3e4d3c1c0d";
    case 't': return "1i1d2c3c 0g3g";
    case 'u': return "0g0d1c3c4d 4g4c";
    case 'v': return "0g2c4g";
    case 'w': return "0g1c2f3c4g";
    case 'x': return "0g4c 4g0c";
    case 'y': return "0g2c 4g1a";
    case 'z': return "0g4g0c4c";
    case '0': return "1c3c4d4h3i1i0h0d1c";
    case '1': return "1h2i2c 1c3c";
    case '2': return "0h1i3i4h4g0c4c";
    case '3': return "0h1i3i4h4g3f1f 3f4e4d3c1c0d";
    case '4': return "3c3i0e4e";
    case '5': return "4i0i0f3f4e4d3c1c0d";
    case '6': return "4h3i1i0h0d1c3c4d4e3f1f0e";
    case '7': return "0i4i1c";
    case '8': return "1f0g0h1i3i4h4g3f1f0e0d1c3c4d4e3f";
    case '9': return "0d1c3c4d4h3i1i0h0g1f3f4g";
    case '.': return "2c2c";
    case ',': return "2c1b";
    case '-': return "1e3e";
    case '+': return "0e4e 2g2c";
    case ':': return "2c2c 2f2f";
    case '/': return "0b4i";
    case '(': return "3i2h2c3b";
    case ')': return "1i2h2c1b";
    case '=': return "0f4f 0d4d";
    case '|': return "2i2b";
    default: return "";
    }
}

constexpr double ADVANCE = 5.6, CAPITAL = 6;

} // namespace

void draw_line(Image& image, double x0, double y0, double x1, double y1, double width, Ink ink) {
    const double dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy, r = width / 2;
    fill(image, std::min(x0, x1) - r, std::min(y0, y1) - r, std::max(x0, x1) + r, std::max(y0, y1) + r,
         [&](int x, int y, double px, double py) {
             const double t = square > 0 ? std::clamp(((px - x0) * dx + (py - y0) * dy) / square, 0.0, 1.0) : 0;
             blend(image, x, y, ink, share(std::hypot(px - x0 - t * dx, py - y0 - t * dy) - r));
         });
}

void draw_ball(Image& image, double cx, double cy, double radius, Ink ink) {
    fill(image, cx - radius, cy - radius, cx + radius, cy + radius, [&](int x, int y, double px, double py) {
        const double u = (px - cx) / radius, v = (py - cy) / radius, square = u * u + v * v;
        const double z = std::sqrt(std::max(0.0, 1 - square));
        const double light = 0.55 + 0.55 * std::max(0.0, -0.41 * u - 0.62 * v + 0.67 * z);
        const double shine = 70 * std::pow(std::max(0.0, -0.38 * u - 0.5 * v + 0.78 * z), 30.0);
        const Ink lit{std::min(255.0, light * ink.red + shine), std::min(255.0, light * ink.green + shine),
                      std::min(255.0, light * ink.blue + shine)};
        blend(image, x, y, lit, share((std::sqrt(square) - 1) * radius));
    });
}

void draw_box(Image& image, double x0, double y0, double x1, double y1, Ink ink, double opacity) {
    fill(image, x0, y0, x1, y1, [&](int x, int y, double px, double py) {
        const double wide = std::clamp(std::min(px + 0.5, x1) - std::max(px - 0.5, x0), 0.0, 1.0);
        const double high = std::clamp(std::min(py + 0.5, y1) - std::max(py - 0.5, y0), 0.0, 1.0);
        blend(image, x, y, ink, opacity * wide * high);
    });
}

double width_of(const std::string& text, double height) { return double(text.size()) * ADVANCE * height / CAPITAL; }

void draw_text(Image& image, const std::string& text, double x, double y, double height, Ink ink) {
    const double unit = height / CAPITAL;
    for (const char c : text) {
        const char* s = strokes_of(c);
        bool begins = true;
        double from_x = 0, from_y = 0;
        for (; *s; ++s) {
            if (*s == ' ') {
                begins = true;
                continue;
            }
            const double to_x = x + (*s - '0') * unit, to_y = y - (s[1] - 'c') * unit;
            ++s;
            if (!begins) draw_line(image, from_x, from_y, to_x, to_y, 0.8 * unit, ink);
            begins = false;
            from_x = to_x;
            from_y = to_y;
        }
        x += ADVANCE * unit;
    }
}

} // namespace cli
