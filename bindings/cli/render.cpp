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

#include "drawing.hpp"

namespace cli {

namespace {

constexpr double CREASE_COSINE = 0.62; // about 52 degrees
constexpr Colour RED{0.62, 0.025, 0.035}, WHITE{0.97, 0.95, 0.91}, GREEN{0.01, 0.33, 0.06}, GREY{0.42, 0.42, 0.42},
    DARK{0.09, 0.11, 0.16};
constexpr Ink BLUE_INK{48, 90, 222}, YELLOW_INK{250, 200, 40}, VIOLET_INK{170, 60, 180}, GREEN_INK{30, 150, 60},
    RED_INK{205, 44, 52}, WHITE_INK{250, 248, 243}, BLACK_INK{25, 28, 36};

// Box-filtered share of red of the even stripe pattern.
double share_of_red(double u, double width, double period) {
    const double turns = u / period + 0.5, folded = period * std::fabs(turns - std::floor(turns) - 0.5);
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

// Light where a triangle keeps its shape, over orange to dark where it is stretched twofold.
Colour colour_of_dilatation(double dilatation) {
    const double t = std::clamp(std::log2(std::max(1.0, dilatation)), 0.0, 1.0);
    static const Colour ramp[4] = {{0.95, 0.94, 0.90}, {0.92, 0.62, 0.16}, {0.72, 0.09, 0.06}, {0.10, 0.01, 0.06}};
    const int k = std::min(2, int(3 * t));
    return (1 - (3 * t - k)) * ramp[k] + (3 * t - k) * ramp[k + 1];
}

// White at the mean, blue where the scale is a quarter of it and less, red where it is four times as large.
Colour colour_of_scale(double x) {
    const double strength = std::min(1.0, std::fabs(x));
    return strength * (x < 0 ? Colour{0.03, 0.13, 0.75} : RED) + (1 - strength) * WHITE;
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

// Normals of the corners of the triangles that are seen: the mean over the triangles around a vertex that do not lie
// beyond a crease, weighted as on a sphere (Max 1999).  Outward, in the frame of the camera.
class Normals {
public:
    Normals(const std::vector<Vec>& points, const std::vector<uint32_t>& triangles, const Foliation& foliation) :
        p_(points), t_(triangles), face_(triangles.size() / 3), start_(points.size() + 1, 0), around_(triangles.size()),
        slot_(triangles.size() / 3, NONE), foliation_(foliation),
        is_whole_(triangles.size() != foliation.triangles.size() || foliation.component.empty()) {
        volume_.assign(std::max<size_t>(1, foliation.is_bare.size()), 0.0);
        for (size_t t = 0; t < face_.size(); ++t) {
            const Vec a = p_[t_[3 * t]], n = cross(p_[t_[3 * t + 1]] - a, p_[t_[3 * t + 2]] - a);
            volume_[component(t)] += dot(a - p_[0], n);
            face_[t] = unit(n);
            for (size_t c = 0; c < 3; ++c) ++start_[t_[3 * t + c] + 1];
        }
        for (size_t v = 0; v < p_.size(); ++v) start_[v + 1] += start_[v];
        std::vector<uint32_t> filled(start_.begin(), start_.end() - 1);
        for (uint32_t k = 0; k < t_.size(); ++k) around_[filled[t_[k]]++] = k;
    }

    const std::array<Vec, 3>& of(size_t t) {
        if (slot_[t] == NONE) {
            slot_[t] = uint32_t(made_.size());
            made_.push_back({corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)});
        }
        return made_[slot_[t]];
    }

private:
    static constexpr uint32_t NONE = 0xffffffffu;
    size_t component(size_t t) const { return is_whole_ ? 0 : foliation_.component[t]; }

    Vec corner(size_t k) const {
        Vec sum;
        for (size_t r = start_[t_[k]]; r < start_[t_[k] + 1]; ++r) {
            const size_t j = around_[r], t = j / 3;
            if (!(dot(face_[t], face_[k / 3]) > CREASE_COSINE)) continue;
            const Vec p = p_[t_[j]], a = p_[t_[3 * t + (j + 1) % 3]] - p, b = p_[t_[3 * t + (j + 2) % 3]] - p;
            const double squares = dot(a, a) * dot(b, b);
            if (squares > 0) sum = sum + (1 / squares) * cross(a, b);
        }
        const Vec n = dot(sum, sum) > 0 ? unit(sum) : face_[k / 3];
        return volume_[component(k / 3)] < 0 ? -1.0 * n : n;
    }

    const std::vector<Vec>& p_;
    const std::vector<uint32_t>& t_;
    std::vector<Vec> face_;
    std::vector<uint32_t> start_, around_, slot_;
    std::vector<std::array<Vec, 3>> made_;
    std::vector<double> volume_; // of each component
    const Foliation& foliation_;
    bool is_whole_;
};

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
                const Colour c = colour_of_dilatation(std::exp2((k + 0.5) / 24));
                const auto ink = [](double v) { return 255 * std::pow(v, 1 / 2.2); };
                draw_box(image, x + unit * (k / 12.0 - 1), y - 0.5 * unit, x + unit * ((k + 1) / 12.0 - 1),
                         y + 0.5 * unit, {ink(c.x), ink(c.y), ink(c.z)});
            }
        draw_text(image, row.text, x + 1.9 * unit, y + 0.4 * unit, 0.8 * unit, BLACK_INK);
    }
}

std::string plural(size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

} // namespace

Image render(const Foliation& foliation, const Potential& potential, const PictureData& data,
             const std::vector<Line>& loops, const PictureStyle& style) {
    const bool shows_quads = style.pattern == Pattern::quads;
    // The surface, or the quads in halves: a, b, c and a, c, d.
    std::vector<Vec> points;
    std::vector<uint32_t> halves;
    const auto add_points = [&](const double* p, size_t count) {
        for (size_t v = 0; v < count; ++v) points.push_back({p[3 * v], p[3 * v + 1], p[3 * v + 2]});
    };
    size_t quad_count = 0;
    if (shows_quads)
        for (const hmf_quad_mesh* mesh : data.quads) {
            const uint32_t first = uint32_t(points.size());
            add_points(mesh->positions, mesh->vertex_count);
            for (uint64_t q = 0; q < 4 * mesh->quad_count; q += 4)
                for (const uint64_t c : {q, q + 1, q + 2, q, q + 2, q + 3}) halves.push_back(first + mesh->quads[c]);
            quad_count += mesh->quad_count;
        }
    else add_points(foliation.positions.data(), foliation.positions.size() / 3);
    const std::vector<uint32_t>& triangles = shows_quads ? halves : foliation.triangles;
    const Samples samples = sample_surface(points, triangles);
    const double size = samples.size;

    std::vector<Target> targets;
    double orders = 0;
    for (const hmf_singularity& s : foliation.singular) orders += std::max(1, std::abs(s.index));
    for (const hmf_singularity& s : foliation.singular)
        targets.push_back({{{s.position[0], s.position[1], s.position[2]}}, std::max(1, std::abs(s.index)) / orders});
    std::vector<std::vector<Vec>> rods;
    for (const Line& loop : loops) {
        rods.push_back(resampled(loop, 0.004 * size));
        if (!rods.back().empty()) targets.push_back({rods.back(), 0.8 / double(loops.size())});
    }
    const View view = style.has_view ? style.view : best_view(samples, targets);
    const Camera camera = place_camera(points, samples, view, double(style.width) / style.height);

    Canvas canvas(camera, style.width, style.height);
    std::vector<ScreenPoint> screen(points.size()), rod_screen;
    for (size_t v = 0; v < points.size(); ++v) screen[v] = canvas.project(camera.to_camera(points[v]));
    Rods rod;
    for (std::vector<Vec>& line : rods) {
        for (Vec& p : line) p = camera.to_camera(p);
        rod.add(line, 0.0035 * size);
    }
    for (const Vec p : rod.points) rod_screen.push_back(canvas.project(p));
    canvas.add(screen, triangles);
    canvas.add(rod_screen, rod.triangles);

    Normals normals(points, triangles, foliation);
    std::vector<double> vertex_dilatation;
    if (style.pattern == Pattern::dilatation) {
        // Smooth: the mean of the logarithms around each vertex.
        std::vector<double> sum(points.size(), 0), count(points.size(), 0);
        for (size_t k = 0; k < triangles.size(); ++k) {
            const double d = std::fabs(data.dilatation[k / 3]);
            sum[triangles[k]] += std::log2(d >= 1 && d < 16 ? d : 16);
            count[triangles[k]] += 1;
        }
        for (size_t v = 0; v < sum.size(); ++v) vertex_dilatation.push_back(sum[v] / std::max(1.0, count[v]));
    }
    std::vector<double> vertex_scale; // from the mean, in factors of 4
    if (style.pattern == Pattern::scale) vertex_scale = scale_of_vertices(points, triangles, foliation, data.log_scale);
    const double period = potential.period;
    // Share of red of the stripes of one linear function with these values at the corners.
    const auto stripes = [&](double value, const double* slope, const Spot& spot) {
        const double by_x = slope[0] * spot.right[0] + slope[1] * spot.right[1] + slope[2] * spot.right[2];
        const double by_y = slope[0] * spot.down[0] + slope[1] * spot.down[1] + slope[2] * spot.down[2];
        return share_of_red(value, 0.8 * std::sqrt(by_x * by_x + by_y * by_y), period);
    };
    const auto albedo = [&](size_t t, const Spot& spot) -> Colour {
        const double* const b = spot.b;
        if (shows_quads) {
            // Along the grid lines, which are sides of the quad: where one of its coordinates is 0 or 1.
            // Corners 00, 10, 11 of the first half, 00, 11, 01 of the second.
            const double slope[2][3] = {{0, 1, t % 2 ? 0.0 : 1.0}, {0, t % 2 ? 1.0 : 0.0, 1}};
            double nearest = 1e9;
            for (const double* s : {slope[0], slope[1]}) {
                const double x = s[0] * b[0] + s[1] * b[1] + s[2] * b[2];
                const double by_x = s[0] * spot.right[0] + s[1] * spot.right[1] + s[2] * spot.right[2];
                const double by_y = s[0] * spot.down[0] + s[1] * spot.down[1] + s[2] * spot.down[2];
                const double pixel = std::sqrt(by_x * by_x + by_y * by_y);
                if (pixel > 0) nearest = std::min(nearest, std::min(x, 1 - x) / pixel);
            }
            const double ink = std::clamp(1.2 - nearest, 0.0, 1.0) * 0.85;
            return ink * DARK + (1 - ink) * WHITE;
        }
        if (foliation.is_bare_at(t)) return GREY;
        if (style.pattern == Pattern::dilatation) {
            const uint32_t* const v = &triangles[3 * t];
            return colour_of_dilatation(std::exp2(b[0] * vertex_dilatation[v[0]] + b[1] * vertex_dilatation[v[1]]
                                                  + b[2] * vertex_dilatation[v[2]]));
        }
        if (style.pattern == Pattern::scale) {
            const uint32_t* const v = &triangles[3 * t];
            return colour_of_scale(b[0] * vertex_scale[v[0]] + b[1] * vertex_scale[v[1]] + b[2] * vertex_scale[v[2]]);
        }
        double red;
        if (style.pattern == Pattern::checkerboard) {
            const double* uv = &data.corner_uv[6 * t];
            const double u[3] = {uv[0], uv[2], uv[4]}, v[3] = {uv[1], uv[3], uv[5]};
            const double over = stripes(b[0] * u[0] + b[1] * u[1] + b[2] * u[2], u, spot);
            const double along = stripes(b[0] * v[0] + b[1] * v[1] + b[2] * v[2], v, spot);
            red = over * (1 - along) + along * (1 - over);
        } else {
            double slope[3] = {};
            const double u = potential_at(potential.piece[t], potential.u[t], b, slope);
            red = stripes(u, slope, spot);
        }
        return red * RED + (1 - red) * WHITE;
    };
    const size_t surface = triangles.size() / 3;
    Image image = canvas.paint(0.05 * size, [&](size_t t, const Spot& spot) -> Shaded {
        const double* const b = spot.b;
        if (t >= surface) {
            const uint32_t* const v = &rod.triangles[3 * (t - surface)];
            return {GREEN, unit(b[0] * rod.normals[v[0]] + b[1] * rod.normals[v[1]] + b[2] * rod.normals[v[2]])};
        }
        const std::array<Vec, 3>& n = normals.of(t);
        return {albedo(t, spot), unit(camera.turn(b[0] * n[0] + b[1] * n[1] + b[2] * n[2]))};
    });

    // What lies on the surface and is not behind another part of it.
    std::vector<Ball> balls;
    std::map<int, std::array<size_t, 2>> zeros; // of each order: all, seen
    size_t poles = 0, marks = 0;
    for (const hmf_singularity& s : foliation.singular) {
        const Vec place = camera.to_camera({s.position[0], s.position[1], s.position[2]});
        const ScreenPoint p = canvas.project(place);
        const double front = canvas.depth_at(p.x, p.y);
        const bool is_seen = p.w > 0 && (front == 0 || 1 / front > 1 / p.w - 0.012 * size);
        if (s.index < 0) {
            ++zeros[-s.index][0];
            zeros[-s.index][1] += is_seen;
        } else ++(s.index > 0 ? poles : marks);
        if (!is_seen) continue;
        const double radius = std::clamp(0.0095 * size * p.w * camera.focal * style.height * 0.5, 0.005 * style.height,
                                         0.0125 * style.height);
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

    if (!style.legend) return image;
    std::vector<LegendRow> rows;
    char number[40];
    std::snprintf(number, sizeof number, "%.3g", period);
    if (style.pattern == Pattern::stripes)
        rows.push_back({LegendRow::stripes, {}, std::string("stripes along the leaves, one pair is ") + number});
    if (style.pattern == Pattern::checkerboard)
        rows.push_back({LegendRow::stripes, {}, std::string("squares of (u, v), two are ") + number});
    if (style.pattern == Pattern::dilatation) rows.push_back({LegendRow::ramp, {}, "dilatation 1 to 2 and more"});
    if (style.pattern == Pattern::scale)
        rows.push_back({LegendRow::none, {}, "|grad u|: white the mean, blue a quarter, red four times"});
    if (shows_quads) rows.push_back({LegendRow::none, {}, plural(quad_count, "quad")});
    for (const auto& [order, count] : zeros)
        rows.push_back({LegendRow::ball, BLUE_INK,
                        plural(count[0], "zero") + " of order " + std::to_string(order) + ", "
                            + std::to_string(count[1]) + " seen"});
    if (poles > 0) rows.push_back({LegendRow::ball, YELLOW_INK, plural(poles, "pole")});
    if (marks > 0)
        rows.push_back({LegendRow::ball, VIOLET_INK,
                        std::to_string(marks) + (marks == 1 ? " marked vertex" : " marked vertices")});
    if (!loops.empty()) rows.push_back({LegendRow::bar, GREEN_INK, plural(loops.size(), "loop")});
    draw_legend(image, rows, canvas);
    return image;
}

} // namespace cli
