// Discs, lines and letters on a picture, with smooth edges.
#pragma once

#include <string>

#include "canvas.hpp"

namespace cli {

struct Ink {
    double red, green, blue; // 0 to 255
};

void draw_line(Image& image, double x0, double y0, double x1, double y1, double width, Ink ink);
// A ball that the light comes on from above left; sector: from 0 to 1, how much of it (a whole one).
void draw_ball(Image& image, double x, double y, double radius, Ink ink);
void draw_box(Image& image, double x0, double y0, double x1, double y1, Ink ink, double opacity = 1);

// Letters of strokes: capitals are `height` high.  x is the left side, y the base line.
void draw_text(Image& image, const std::string& text, double x, double y, double height, Ink ink);
double width_of(const std::string& text, double height);

} // namespace cli
