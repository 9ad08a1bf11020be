// The surface with its pattern, loops as rods, and zeros as balls on top.
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
#include <cstdio>
#include <map>

#include "counted.hpp"
#include "drawing.hpp"
#include "normals.hpp"

namespace cli {

namespace {

constexpr Color RED{0.62, 0.025, 0.035}, WHITE{0.97, 0.95, 0.91}, GREEN{0.01, 0.33, 0.06}, GRAY{0.42, 0.42, 0.42},
    DARK{0.09, 0.11, 0.16};
constexpr Ink BLUE_INK{48, 90, 222}, YELLOW_INK{250, 200, 40}, VIOLET_INK{170, 60, 180}, GREEN_INK{30, 150, 60},
    RED_INK{205, 44, 52}, WHITE_INK{250, 248, 243}, BLACK_INK{25, 28, 36};

// Box-filtered share of red of the even stripe pattern; u and the width of the box in periods.
double share_of_red(double u, double width) {
    // The part behind the point of a number that is not negative.
    const double turns = std::fabs(u) + 0.5, folded = std::fabs(turns - double(int64_t(turns)) - 0.5);
    const double sharp = std::clamp((0.25 - folded) / std::max(width, 1e-12) + 0.5, 0.0, 1.0);
    const double blur = std::clamp((width - 0.3) * 2.5, 0.0, 1.0);
    return sharp + blur * (0.5 - sharp);
}

// Gradient in barycentric coordinates, at b, of the distance from the branch point.
void tripod_slope(const std::array<double, 3>& u, const double* b, double* slope) {
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
}

// Light where a triangle keeps its shape, over orange to dark where it is stretched twofold.
Color color_of_dilatation(double dilatation) {
    const double t = std::clamp(std::log2(std::max(1.0, dilatation)), 0.0, 1.0);
    static const Color ramp[4] = {{0.95, 0.94, 0.90}, {0.92, 0.62, 0.16}, {0.72, 0.09, 0.06}, {0.10, 0.01, 0.06}};
    const int k = std::min(2, int(3 * t));
    return (1 - (3 * t - k)) * ramp[k] + (3 * t - k) * ramp[k + 1];
}

// White at the mean, blue where the scale is a quarter of it and less, red where it is four times as large.
Color color_of_scale(double x) {
    const double strength = std::min(1.0, std::fabs(x));
    return strength * (x < 0 ? Color{0.03, 0.13, 0.75} : RED) + (1 - strength) * WHITE;
}

std::vector<double> scale_of_vertices(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles,
                                      const Foliation& foliation, const std::vector<double>& log_scale) {
    std::vector<double> sum(points.size(), 0), area(points.size(), 0);
    double mean = 0, whole = 0;
    for (size_t t = 0; t < log_scale.size(); ++t) {
        const uint32_t* const v = &triangles[3 * t];
        const Vec n = cross(points[v[1]] - points[v[0]], points[v[2]] - points[v[0]]);
        const double a = foliation.is_bare_at(t) ? 0 : std::sqrt(dot(n, n));
        mean += a * log_scale[t];
        whole += a;
        for (size_t c = 0; c < 3; ++c) {
            sum[v[c]] += a * log_scale[t];
            area[v[c]] += a;
        }
    }
    mean /= whole > 0 ? whole : 1;
    for (size_t v = 0; v < sum.size(); ++v) sum[v] = area[v] > 0 ? (sum[v] / area[v] - mean) / std::log(4.0) : 0;
    return sum;
}

// Round rods along closed lines, in the frame of the camera.
struct Rods {
    std::vector<Vec> points, normals;
    std::vector<uint32_t> triangles;

    void add(const std::vector<Vec>& line, double radius) {
        constexpr uint32_t SECTORS = 10;
        const size_t n = line.size();
        if (n < 3) return;
        const uint32_t first = uint32_t(points.size());
        Vec across{1, 0, 0};
        for (size_t i = 0; i < n; ++i) {
            const Vec axis = unit(line[(i + 1) % n] - line[(i + n - 1) % n]);
            // Carried along the line, so that the rings do not twist.
            if (i == 0 && std::fabs(axis.x) > 0.7) across = {0, 1, 0};
            across = unit(across - dot(across, axis) * axis);
            const Vec along = cross(axis, across);
            for (uint32_t s = 0; s < SECTORS; ++s) {
                const double turn = 6.283185307179586 * s / SECTORS;
                normals.push_back(std::cos(turn) * across + std::sin(turn) * along);
                points.push_back(line[i] + radius * normals.back());
            }
        }
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t here = first + i * SECTORS, next = first + (i + 1 < n ? i + 1 : 0) * SECTORS;
            // The last ring meets the first with another turn.
            uint32_t shift = 0;
            if (i + 1 == n)
                for (uint32_t s = 1; s < SECTORS; ++s)
                    if (dot(normals[next + s], normals[here]) > dot(normals[next + shift], normals[here])) shift = s;
            for (uint32_t s = 0; s < SECTORS; ++s) {
                const uint32_t r = (s + 1) % SECTORS, a = here + s, b = here + r, c = next + (r + shift) % SECTORS,
                               d = next + (s + shift) % SECTORS;
                triangles.insert(triangles.end(), {a, b, c, a, c, d});
            }
        }
    }
};

// Points of a closed line, at most so far apart or so close that a rod along them is round.
std::vector<Vec> resampled(const Line& line, double step) {
    double all = 0;
    const size_t n = line.size();
    const auto at = [&](size_t i) { return Vec{line[i % n][0], line[i % n][1], line[i % n][2]}; };
    for (size_t i = 0; i < n; ++i) all += length(at(i + 1) - at(i));
    std::vector<Vec> points;
    if (!(all > 0)) return points;
    const double even = all / std::max(12.0, std::ceil(all / step));
    double left = 0;
    for (size_t i = 0; i < n; ++i) {
        const Vec from = at(i), way = at(i + 1) - from;
        const double l = length(way);
        for (; left < l; left += even) points.push_back(from + (left / l) * way);
        left -= l;
    }
    return points;
}

// What is drawn: the pattern on the surface, and the rods.
class Paint {
public:
    enum class Kind { rod, bare, stripes, tripod, squares, quad, dilatation, scale };
    struct Face {
        Kind kind;
        uint32_t triangle;
        Ramp normal[3], over, along; // numerators; the pattern's one or two functions
    };

    Face face(uint32_t t, const Projected& p) const {
        Face face{kind_of(t), t, {}, {}, {}};
        std::array<Vec, 3> n;
        if (face.kind == Kind::rod)
            for (size_t c = 0; c < 3; ++c) n[c] = rod.normals[rod.triangles[3 * (t - surface()) + c]];
        else n = normals.of(t);
        face.normal[0] = p.numerator(n[0].x, n[1].x, n[2].x);
        face.normal[1] = p.numerator(n[0].y, n[1].y, n[2].y);
        face.normal[2] = p.numerator(n[0].z, n[1].z, n[2].z);
        const uint32_t* const v = face.kind == Kind::rod ? nullptr : &triangles[3 * size_t{t}];
        if (face.kind == Kind::stripes) {
            const std::array<double, 3>& u = potential.u[t];
            face.over = p.numerator(u[0], u[1], u[2]);
        } else if (face.kind == Kind::squares) {
            const double* const uv = &data.corner_uv[6 * size_t{t}];
            face.over = p.numerator(uv[0], uv[2], uv[4]);
            face.along = p.numerator(uv[1], uv[3], uv[5]);
        } else if (face.kind == Kind::quad) {
            // Corners 00, 10, 11 of the first half, 00, 11, 01 of the second.
            face.over = p.numerator(0, 1, t % 2 ? 0 : 1);
            face.along = p.numerator(0, t % 2 ? 1 : 0, 1);
        } else if (face.kind == Kind::dilatation || face.kind == Kind::scale)
            face.over = p.numerator(vertex_number[v[0]], vertex_number[v[1]], vertex_number[v[2]]);
        return face;
    }

    // A normal needs no length.
    Shaded shade(const Face& face, const Spot& spot) const {
        return {
            albedo(face, spot),
            {face.normal[0].at(spot.x, spot.y), face.normal[1].at(spot.x, spot.y), face.normal[2].at(spot.x, spot.y)}};
    }

    const Foliation& foliation;
    const Potential& potential;
    const PictureData& data;
    const std::vector<uint32_t>& triangles;
    const Rods& rod;
    const Normals& normals;
    const std::vector<double>& vertex_number; // what dilatation and scale show
    Pattern pattern;
    double per_period = 1 / potential.period;

private:
    size_t surface() const { return triangles.size() / 3; }

    Kind kind_of(uint32_t t) const {
        if (t >= surface()) return Kind::rod;
        if (pattern == Pattern::quads) return Kind::quad;
        if (foliation.is_bare_at(t)) return Kind::bare;
        if (pattern == Pattern::dilatation) return Kind::dilatation;
        if (pattern == Pattern::scale) return Kind::scale;
        if (pattern == Pattern::checkerboard) return Kind::squares;
        return potential.piece[t] == Piece::tripod ? Kind::tripod : Kind::stripes;
    }

    // Share of red of the stripes of a function.
    double stripes(const Ramp& numerator, const Spot& spot) const {
        const double value = spot.value(numerator);
        return share_of_red(value * per_period, 0.8 * spot.change(numerator, value) * per_period);
    }

    Color albedo(const Face& face, const Spot& spot) const {
        double red = 0;
        switch (face.kind) {
        case Kind::rod: return GREEN;
        case Kind::bare: return GRAY;
        case Kind::dilatation: return color_of_dilatation(std::exp2(spot.value(face.over)));
        case Kind::scale: return color_of_scale(spot.value(face.over));
        case Kind::quad: {
            // Along the grid lines, which are sides of the quad: where one of its coordinates is 0 or 1.
            double nearest = 1e9;
            for (const Ramp* const f : {&face.over, &face.along}) {
                const double x = spot.value(*f), pixel = spot.change(*f, x);
                if (pixel > 0) nearest = std::min(nearest, std::min(x, 1 - x) / pixel);
            }
            const double ink = std::clamp(1.2 - nearest, 0.0, 1.0) * 0.85;
            return ink * DARK + (1 - ink) * WHITE;
        }
        case Kind::squares: {
            const double over = stripes(face.over, spot), along = stripes(face.along, spot);
            red = over * (1 - along) + along * (1 - over);
            break;
        }
        case Kind::stripes: red = stripes(face.over, spot); break;
        case Kind::tripod: {
            const double b[3] = {spot.barycentric(0), spot.barycentric(1), spot.barycentric(2)};
            double slope[3] = {};
            tripod_slope(potential.u[face.triangle], b, slope);
            red = stripes(spot.on.numerator(slope[0], slope[1], slope[2]), spot);
            break;
        }
        }
        return red * RED + (1 - red) * WHITE;
    }
};

struct Ball {
    double home_x, home_y, x, y, radius;
    int order; // of a zero
    Ink ink;
};

// Balls that lie together move apart, and stay near their homes.
void spread(std::vector<Ball>& balls) {
    for (int round = 0; round < 80; ++round) {
        bool moved = false;
        for (size_t i = 0; i < balls.size(); ++i)
            for (size_t j = i + 1; j < balls.size(); ++j) {
                Ball &a = balls[i], &b = balls[j];
                double dx = b.x - a.x, dy = b.y - a.y;
                const double wanted = 1.05 * (a.radius + b.radius), square = dx * dx + dy * dy;
                if (square >= wanted * wanted) continue;
                const double distance = std::sqrt(square);
                if (distance < 1e-3 * wanted) {
                    // At one point: along directions that differ.
                    dx = std::cos(2.4 * double(j));
                    dy = std::sin(2.4 * double(j));
                } else {
                    dx /= distance;
                    dy /= distance;
                }
                const double push = 0.5 * (wanted - distance) + 0.02;
                a.x -= push * dx;
                a.y -= push * dy;
                b.x += push * dx;
                b.y += push * dy;
                moved = true;
            }
        if (!moved) break;
    }
}

struct LegendRow {
    enum { ball, bar, stripes, ramp, none } kind;
    Ink ink;
    std::string text;
};

// In the corner where it hides least.
void draw_legend(Image& image, const std::vector<LegendRow>& rows, const Canvas& canvas) {
    const double unit = std::max(8.0, image.height / 75.0), margin = 1.2 * unit, line = 1.75 * unit;
    double widest = 0;
    for (const LegendRow& row : rows) widest = std::max(widest, width_of(row.text, 0.8 * unit));
    const double wide = widest + 5.4 * unit, high = line * double(rows.size()) + 0.8 * unit;
    double left = margin, top = image.height - margin - high;
    int least = -1;
    for (const bool up : {false, true})
        for (const bool to_right : {false, true}) {
            const double x = to_right ? image.width - margin - wide : margin,
                         y = up ? margin : image.height - margin - high;
            int hidden = 0;
            for (int k = 0; k < 400; ++k)
                hidden += canvas.depth_at(x + wide * (k % 20) / 20, y + high * (k / 20) / 20) > 0;
            if (least >= 0 && hidden >= least) continue;
            least = hidden;
            left = x;
            top = y;
        }
    draw_box(image, left, top, left + wide, top + high, {255, 255, 255}, 0.82);
    for (size_t i = 0; i < rows.size(); ++i) {
        const LegendRow& row = rows[i];
        const double y = top + 0.4 * unit + line * (double(i) + 0.5), x = left + 2 * unit;
        if (row.kind == LegendRow::ball) draw_ball(image, x, y, 0.6 * unit, row.ink);
        if (row.kind == LegendRow::bar) draw_line(image, x - unit, y, x + unit, y, 0.5 * unit, row.ink);
        if (row.kind == LegendRow::stripes) {
            draw_box(image, x - unit, y - 0.5 * unit, x, y + 0.5 * unit, RED_INK);
            draw_box(image, x, y - 0.5 * unit, x + unit, y + 0.5 * unit, WHITE_INK);
            draw_line(image, x, y - 0.5 * unit, x + unit, y - 0.5 * unit, 1, BLACK_INK);
            draw_line(image, x, y + 0.5 * unit, x + unit, y + 0.5 * unit, 1, BLACK_INK);
            draw_line(image, x + unit, y - 0.5 * unit, x + unit, y + 0.5 * unit, 1, BLACK_INK);
        }
        if (row.kind == LegendRow::ramp)
            for (int k = 0; k < 24; ++k) {
                const Color c = color_of_dilatation(std::exp2((k + 0.5) / 24));
                const auto ink = [](double v) { return 255 * std::pow(v, 1 / 2.2); };
                draw_box(image, x + unit * (k / 12.0 - 1), y - 0.5 * unit, x + unit * ((k + 1) / 12.0 - 1),
                         y + 0.5 * unit, {ink(c.x), ink(c.y), ink(c.z)});
            }
        draw_text(image, row.text, x + 1.9 * unit, y + 0.4 * unit, 0.8 * unit, BLACK_INK);
    }
}

// The surface, or the quads in halves: a, b, c and a, c, d.
struct Shape {
    std::vector<Vec> points;
    std::vector<uint32_t> halves;
    size_t quad_count = 0;

    Shape(const Foliation& foliation, const PictureData& data, bool shows_quads) {
        if (!shows_quads) add_points(foliation.positions.data(), foliation.positions.size() / 3);
        if (!shows_quads) return;
        for (const hmf_quad_mesh* mesh : data.quads) {
            const uint32_t first = uint32_t(points.size());
            add_points(mesh->positions, mesh->vertex_count);
            for (uint64_t q = 0; q < 4 * mesh->quad_count; q += 4)
                for (const uint64_t c : {q, q + 1, q + 2, q, q + 2, q + 3}) halves.push_back(first + mesh->quads[c]);
            quad_count += mesh->quad_count;
        }
    }
    void add_points(const double* p, size_t count) {
        points.reserve(points.size() + count);
        for (size_t v = 0; v < count; ++v) points.push_back({p[3 * v], p[3 * v + 1], p[3 * v + 2]});
    }
};

Vec place_of(const hmf_singularity& s) { return {s.position[0], s.position[1], s.position[2]}; }

// Zeros by their orders, and as many loops.
std::vector<Target> targets_of(const std::vector<hmf_singularity>& singular,
                               const std::vector<std::vector<Vec>>& loops) {
    std::vector<Target> targets;
    double orders = 0;
    for (const hmf_singularity& s : singular) orders += std::max(1, std::abs(s.index));
    for (const hmf_singularity& s : singular)
        targets.push_back({{place_of(s)}, std::max(1, std::abs(s.index)) / orders});
    for (const std::vector<Vec>& loop : loops)
        if (!loop.empty()) targets.push_back({loop, 0.8 / double(loops.size())});
    return targets;
}

// Smooth: the mean of the logarithms around each vertex.
std::vector<double> dilatation_of_vertices(size_t vertices, const std::vector<uint32_t>& triangles,
                                           const double* dilatation) {
    std::vector<double> sum(vertices, 0), count(vertices, 0);
    for (size_t k = 0; k < triangles.size(); ++k) {
        const double d = std::fabs(dilatation[k / 3]);
        sum[triangles[k]] += std::log2(d >= 1 && d < 16 ? d : 16);
        count[triangles[k]] += 1;
    }
    for (size_t v = 0; v < vertices; ++v) sum[v] /= std::max(1.0, count[v]);
    return sum;
}

// What there is of a kind, and what of it is seen.
struct Census {
    std::map<int, std::array<size_t, 2>> zeros; // of each order: all, seen
    size_t poles = 0, marks = 0;
};

// What lies on the surface and is not behind another part of it.
Census draw_singular(Image& image, const std::vector<hmf_singularity>& singular, const Canvas& canvas,
                     const Camera& camera, double size) {
    Census census;
    std::vector<Ball> balls;
    for (const hmf_singularity& s : singular) {
        const ScreenPoint p = canvas.project(camera.to_camera(place_of(s)));
        const double front = canvas.depth_at(p.x, p.y);
        const bool is_seen = p.w > 0 && (front == 0 || 1 / front > 1 / p.w - 0.012 * size);
        if (s.index < 0) {
            ++census.zeros[-s.index][0];
            census.zeros[-s.index][1] += is_seen;
        } else ++(s.index > 0 ? census.poles : census.marks);
        if (!is_seen) continue;
        const double radius = std::clamp(0.0095 * size * p.w * camera.focal * image.height * 0.5, 0.005 * image.height,
                                         0.0125 * image.height);
        balls.push_back({p.x, p.y, p.x, p.y, radius, -s.index,
                         s.index < 0   ? BLUE_INK
                         : s.index > 0 ? YELLOW_INK
                                       : VIOLET_INK});
    }
    spread(balls);
    for (const Ball& ball : balls)
        if (std::hypot(ball.x - ball.home_x, ball.y - ball.home_y) > 0.7 * ball.radius) {
            draw_line(image, ball.home_x, ball.home_y, ball.x, ball.y, 0.3 * ball.radius, ball.ink);
            draw_ball(image, ball.home_x, ball.home_y, 0.3 * ball.radius, ball.ink);
        }
    for (const Ball& ball : balls) {
        draw_ball(image, ball.x, ball.y, ball.radius, ball.ink);
        if (ball.order < 2) continue;
        const std::string text = std::to_string(ball.order);
        const double high = ball.radius * (text.size() > 1 ? 0.8 : 1.1), unit = high / 6;
        draw_text(image, text, ball.x - 0.5 * width_of(text, high) + unit, ball.y + 0.5 * high, high, {255, 255, 255});
    }
    return census;
}

std::vector<LegendRow> legend_rows(Pattern pattern, double period, size_t quad_count, const Census& census,
                                   size_t loops) {
    std::vector<LegendRow> rows;
    char number[40];
    std::snprintf(number, sizeof number, "%.3g", period);
    switch (pattern) {
    case Pattern::stripes:
        rows.push_back({LegendRow::stripes, {}, std::string("stripes along the leaves, one pair is ") + number});
        break;
    case Pattern::checkerboard:
        rows.push_back({LegendRow::stripes, {}, std::string("squares of (u, v), two are ") + number});
        break;
    case Pattern::dilatation: rows.push_back({LegendRow::ramp, {}, "dilatation 1 to 2 and more"}); break;
    case Pattern::scale:
        rows.push_back({LegendRow::none, {}, "|grad u|: white the mean, blue a quarter, red four times"});
        break;
    case Pattern::quads: rows.push_back({LegendRow::none, {}, counted(quad_count, "quad")}); break;
    }
    for (const auto& [order, count] : census.zeros)
        rows.push_back({LegendRow::ball, BLUE_INK,
                        counted(count[0], "zero") + " of order " + std::to_string(order) + ", "
                            + std::to_string(count[1]) + " seen"});
    if (census.poles > 0) rows.push_back({LegendRow::ball, YELLOW_INK, counted(census.poles, "pole")});
    if (census.marks > 0)
        rows.push_back({LegendRow::ball, VIOLET_INK,
                        std::to_string(census.marks) + (census.marks == 1 ? " marked vertex" : " marked vertices")});
    if (loops > 0) rows.push_back({LegendRow::bar, GREEN_INK, counted(loops, "loop")});
    return rows;
}

} // namespace

Image render(const Foliation& foliation, const Potential& potential, const PictureData& data,
             const std::vector<Line>& loops, const PictureStyle& style, const hmf_control* control) {
    const Workers workers(control);
    const bool shows_quads = style.pattern == Pattern::quads;
    const Shape shape(foliation, data, shows_quads);
    const std::vector<uint32_t>& triangles = shows_quads ? shape.halves : foliation.triangles;
    const Samples samples = sample_surface(shape.points, triangles);
    const double size = samples.size;
    std::vector<std::vector<Vec>> lines;
    for (const Line& loop : loops) lines.push_back(resampled(loop, 0.004 * size));
    const View view = style.has_view ? style.view : best_view(samples, targets_of(foliation.singular, lines), workers);
    const Camera camera = place_camera(shape.points, samples, view, double(style.width) / style.height);

    // In the frame of the camera.
    Canvas canvas(camera, style.width, style.height, workers);
    std::vector<Vec> points;
    std::vector<ScreenPoint> screen, rod_screen;
    points.reserve(shape.points.size());
    screen.reserve(shape.points.size());
    for (const Vec p : shape.points) {
        points.push_back(camera.to_camera(p));
        screen.push_back(canvas.project(points.back()));
    }
    Rods rod;
    for (std::vector<Vec>& line : lines) {
        for (Vec& p : line) p = camera.to_camera(p);
        rod.add(line, 0.0035 * size);
    }
    for (const Vec p : rod.points) rod_screen.push_back(canvas.project(p));
    canvas.add(screen, triangles);
    canvas.add(rod_screen, rod.triangles);

    static const std::vector<uint32_t> one;
    const Normals normals(points, triangles, shows_quads ? one : foliation.component, workers);
    std::vector<double> vertex_number;
    if (style.pattern == Pattern::dilatation)
        vertex_number = dilatation_of_vertices(points.size(), triangles, data.dilatation);
    if (style.pattern == Pattern::scale)
        vertex_number = scale_of_vertices(points, triangles, foliation, data.log_scale);
    Image image = canvas.paint(
        0.05 * size, Paint{foliation, potential, data, triangles, rod, normals, vertex_number, style.pattern});
    const Census census = draw_singular(image, foliation.singular, canvas, camera, size);
    if (style.legend)
        draw_legend(image, legend_rows(style.pattern, potential.period, shape.quad_count, census, loops.size()),
                    canvas);
    return image;
}

} // namespace cli
