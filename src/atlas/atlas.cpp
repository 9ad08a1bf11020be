#include "atlas.hpp"

#include "../base/disjoint_sets.hpp"
#include "charts.hpp"
#include "overlaps.hpp"
#include "pack.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint64_t QUICK = 1000000, THOROUGH = 600000000; // steps of a packing, planned and final
constexpr uint64_t PLANNING = 1000000000;                 // of all planned ones
constexpr double WISHED_USE = 0.88;                       // of the square, as planned: ragged edges take some of it
constexpr double LEAST_USE = 0.79;                        // below this each part counts three times
constexpr double COST_OF_CHART = 0.009;                   // a chart less is worth this part of the square
constexpr int64_t SPECK = 256;   // grid units: triangles below a millionth of the square are not looked at
constexpr double GRID = 1 << 28; // units of the grid along a square as large as all charts

// Twice the area of a triangle in space.
double twice_area(const Mesh& mesh, const double* position, uint32_t h) {
    const double* a = position + size_t{3} * mesh.origin[h];
    const double* b = position + size_t{3} * mesh.origin[mesh.next[h]];
    const double* c = position + size_t{3} * mesh.origin[mesh.prev(h)];
    double n[3];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
    return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

class Maker {
public:
    Maker(const Mesh& mesh, const double* position, const SignBundle& bundle, const Strips& strips, double margin,
          Atlas& out, Call& call) :
        mesh_(mesh),
        position_(position), bundle_(bundle), strips_(strips), margin_(margin), out_(out), call_(call) {}

    hmf_status run() {
        if (!find_sides() || measure() || charts_.start(mesh_, position_, bundle_, strips_, triangle_, call_)
            || join_and_cut() || !place_faces() || !smooth_edges() || !gather() || !scale_to_grid()
            || !take_overlaps_out() || pack())
            return call_.status() ? call_.status() : call_.stopped();
        return HMF_OK;
    }

private:
    // Part of a chart: what lies in a box of its plane.
    struct Leaf {
        uint32_t chart;
        Box box;
        double scale; // with which areas are as in space, the whole being the same
    };

    struct FaceInChart {
        double u, v, area, image;
    };

    double image_area(uint32_t h) const {
        const uint32_t n = mesh_.next[h], p = mesh_.next[n];
        const double ax = static_cast<double>(strips_.u[n] - strips_.u[h]),
                     ay = static_cast<double>(strips_.v[n] - strips_.v[h]),
                     bx = static_cast<double>(strips_.u[p] - strips_.u[h]),
                     by = static_cast<double>(strips_.v[p] - strips_.v[h]);
        return ax * by - ay * bx;
    }

    // A half-edge of each face.
    Done find_sides() {
        if (!side_.allocate(call_.memory, mesh_.face_count)) return false;
        for (uint32_t h = 2 * mesh_.edge_count; h-- > 0;) side_[mesh_.face[h]] = h;
        return true;
    }

    // Areas of the pieces, the size of a triangle, which way round the plane is.
    hmf_status measure() {
        const uint32_t n = strips_.piece_count();
        if (!area_.allocate_filled(call_.memory, n, 0) || !image_.allocate_filled(call_.memory, n, 0))
            return call_.out_of_memory();
        for (uint32_t t = 0; t < side_.size(); ++t) {
            const uint32_t p = strips_.piece[t];
            area_[p] += twice_area(mesh_, position_, side_[t]);
            image_[p] += image_area(side_[t]);
        }
        double sum = 0;
        for (uint32_t p = 0; p < n; ++p) {
            sum += image_[p];
            whole_area_ += area_[p];
        }
        mirror_ = sum < 0 ? -1 : 1;
        for (double& x : image_) x *= static_cast<double>(mirror_);
        whole_ = std::fabs(sum) / 2;
        triangle_ = 1.5 * std::sqrt(2 * whole_ / static_cast<double>(side_.size()));
        return call_.tick(0.86) ? HMF_OK : call_.was_cancelled();
    }

    Box piece_in_chart(uint32_t p) const {
        const Motion& m = charts_.motion[p];
        const Box& b = charts_.box[p];
        const double u = static_cast<double>(m.u), v = static_cast<double>(m.v);
        return m.sign > 0 ? Box{b.u0 + u, b.v0 + v, b.u1 + u, b.v1 + v} : Box{u - b.u1, v - b.v1, u - b.u0, v - b.v0};
    }

    // How large a square the leaves need, roughly.
    hmf_status try_packing(const Array<Leaf>& leaves, double& side) {
        const double size = std::sqrt(whole_), rim = 0.35 * triangle_;
        Packer packer;
        packer.start(call_.memory, size / 128, margin_ * size * 1.15);
        for (const Leaf& leaf : leaves) {
            const double k = leaf.scale;
            if (!packer.begin_shape(leaf.box.u0 * k - rim, leaf.box.v0 * k - rim, leaf.box.u1 * k + rim,
                                    leaf.box.v1 * k + rim))
                return call_.out_of_memory();
            for (uint32_t p = 0; p < area_.size(); ++p) {
                if (charts_.of_piece[p] != leaf.chart) continue;
                Box b = piece_in_chart(p);
                b = {std::max(b.u0, leaf.box.u0), std::max(b.v0, leaf.box.v0), std::min(b.u1, leaf.box.u1),
                     std::min(b.v1, leaf.box.v1)};
                if (b.u0 >= b.u1 || b.v0 >= b.v1) continue;
                const double x0 = b.u0 * k - rim, y0 = b.v0 * k - rim, x1 = b.u1 * k + rim, y1 = b.v1 * k + rim;
                const double xy[8] = {x0, y0, x1, y0, x1, y1, x0, y1};
                packer.add_part(xy, 4);
                packer.add_area(b.area() * k * k);
            }
        }
        if (packer.search(QUICK, call_)) return call_.status();
        side = packer.side();
        planned_ += packer.steps();
        return HMF_OK;
    }

    hmf_status leaves_of_charts() {
        Array<double> area, image;
        leaves_.start(call_.memory);
        if (!area.allocate_filled(call_.memory, charts_.count, 0)
            || !image.allocate_filled(call_.memory, charts_.count, 0))
            return call_.out_of_memory();
        for (uint32_t c = 0; c < charts_.count; ++c)
            if (!leaves_.push({c, {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, 1})) return call_.out_of_memory();
        for (uint32_t p = 0; p < area_.size(); ++p) {
            const uint32_t c = charts_.of_piece[p];
            leaves_[c].box.add(piece_in_chart(p));
            area[c] += area_[p];
            image[c] += image_[p];
        }
        for (uint32_t c = 0; c < charts_.count; ++c) leaves_[c].scale = scale_of(area[c], image[c]);
        return HMF_OK;
    }
    double scale_of(double area, double image) const {
        return image > 0 ? std::sqrt(area / whole_area_ * 2 * whole_ / image) : 1;
    }

    // Joins pieces to charts, more or less eagerly, and cuts charts where the square then becomes smaller.
    hmf_status join_and_cut() {
        const double size = std::sqrt(whole_);
        constexpr double eager[] = {0.003, 0.01, 0.015, 0.02, 0.03, 0.04, 0.08};
        double best = 0, best_cost = HUGE_VAL;
        Array<Leaf> best_leaves;
        JoinWish wish{0, triangle_ / 2 + margin_ * size, 1.02 * size};
        uint32_t count = 0;
        for (const double bonus : eager) {
            wish.bonus = bonus;
            if (charts_.join(wish, call_)) return call_.status();
            if (charts_.count == count || (count > 0 && planned_ > PLANNING)) continue;
            count = charts_.count;
            double cost = 0;
            if (leaves_of_charts() || cut_charts(cost)) return call_.status();
            if (cost < best_cost) {
                best_cost = cost;
                best = bonus;
                best_leaves.swap(leaves_);
            }
        }
        wish.bonus = best;
        leaves_.swap(best_leaves);
        return charts_.join(wish, call_);
    }

    // What a packing is worth: room in the square, and few charts.
    double cost_of(double side, size_t charts) const {
        const double use = whole_ / (side * side);
        return std::max(0.0, WISHED_USE - use) + 2 * std::max(0.0, LEAST_USE - use)
             + COST_OF_CHART * static_cast<double>(charts);
    }

    hmf_status cut_charts(double& cost) {
        double side = 0;
        if (!list_faces()) return call_.stopped();
        // What is much longer than the square in equal parts.
        const double size = std::sqrt(whole_);
        for (uint32_t i = 0, n = static_cast<uint32_t>(leaves_.size()); i < n; ++i) {
            const Box box = leaves_[i].box;
            const double length = length_of(leaves_[i]);
            const bool in_u = box.u1 - box.u0 > box.v1 - box.v0;
            if (!(length > 1.6 * size)) continue;
            const double parts = std::min(std::ceil(length / size), 1000.0);
            for (double k = parts - 1; k > 0; --k)
                if (!cut_leaf(i, in_u,
                              (in_u ? box.u0 : box.v0) + k / parts * (in_u ? box.u1 - box.u0 : box.v1 - box.v0)))
                    return call_.out_of_memory();
        }
        if (try_packing(leaves_, side)) return call_.status();
        cost = cost_of(side, leaves_.size());
        for (int cut = 0; cut < 12 && whole_ < WISHED_USE * side * side && planned_ < PLANNING; ++cut) {
            // One of the three longest leaves, across.
            uint32_t best_leaf = NONE;
            bool best_in_u = false;
            double best_where = 0, best_cost = cost;
            const size_t charts = leaves_.size();
            for (uint32_t tried = 0, last = NONE; tried < 3; ++tried) {
                uint32_t longest = NONE;
                double length = -1;
                const double limit = last == NONE ? HUGE_VAL : length_of(leaves_[last]);
                for (uint32_t i = 0; i < charts; ++i) {
                    const double l = length_of(leaves_[i]);
                    if ((l < limit || (l == limit && i > last)) && l > length) length = l, longest = i;
                }
                if (longest == NONE) break;
                last = longest;
                const Leaf whole = leaves_[longest];
                const bool in_u = whole.box.u1 - whole.box.u0 > whole.box.v1 - whole.box.v0;
                const int steps = charts <= 8 ? 32 : 12;
                for (int k = 1; k < steps; ++k) {
                    const double part = static_cast<double>(k) / steps;
                    if (length * std::min(part, 1 - part) < 8 * triangle_) continue;
                    const double where = in_u ? whole.box.u0 + part * (whole.box.u1 - whole.box.u0)
                                              : whole.box.v0 + part * (whole.box.v1 - whole.box.v0);
                    double with = 0;
                    if (!cut_leaf(longest, in_u, where)) return call_.out_of_memory();
                    if (try_packing(leaves_, with)) return call_.status();
                    leaves_.pop();
                    leaves_[longest] = whole;
                    if (cost_of(with, charts + 1) < best_cost) {
                        best_cost = cost_of(with, charts + 1);
                        best_leaf = longest;
                        best_in_u = in_u;
                        best_where = where;
                        side = with;
                    }
                }
            }
            if (best_leaf == NONE) break;
            if (!cut_leaf(best_leaf, best_in_u, best_where)) return call_.out_of_memory();
            cost = best_cost;
        }
        return HMF_OK;
    }
    double length_of(const Leaf& leaf) const {
        return std::max(leaf.box.u1 - leaf.box.u0, leaf.box.v1 - leaf.box.v0) * leaf.scale;
    }
    // The second part becomes the last leaf.
    Done cut_leaf(uint32_t i, bool in_u, double where) {
        Leaf& first = leaves_[i];
        Leaf rest = first;
        (in_u ? first.box.u1 : first.box.v1) = where;
        (in_u ? rest.box.u0 : rest.box.v0) = where;
        double area[2] = {0, 0}, image[2] = {0, 0};
        for (uint32_t k = of_chart_[first.chart]; k < of_chart_[first.chart + 1]; ++k) {
            const FaceInChart& f = faces_[k];
            const Box& b = leaves_[i].box;
            const bool other = in_u ? f.u >= where : f.v >= where;
            const Box& box = other ? rest.box : b;
            if (f.u < box.u0 || f.u > box.u1 || f.v < box.v0 || f.v > box.v1) continue;
            area[other] += f.area;
            image[other] += f.image;
        }
        first.scale = scale_of(area[0], image[0]);
        rest.scale = scale_of(area[1], image[1]);
        return leaves_.push(rest);
    }

    // Middles and areas of the triangles, chart by chart.
    Done list_faces() {
        if (!of_chart_.allocate_filled(call_.memory, size_t{charts_.count} + 1, 0)
            || !faces_.allocate(call_.memory, side_.size()))
            return false;
        for (const uint32_t p : strips_.piece) ++of_chart_[charts_.of_piece[p]];
        for (uint32_t c = 0, sum = 0; c <= charts_.count; ++c) sum = of_chart_[c] += sum;
        for (uint32_t t = 0; t < side_.size(); ++t) {
            if (t % 65536 == 0 && !call_.tick(0.88)) return false;
            const uint32_t p = strips_.piece[t], h = side_[t], n = mesh_.next[h], q = mesh_.next[n];
            const Motion& m = charts_.motion[p];
            const auto middle = [&](const Array<int64_t>& x, int64_t off) {
                return (static_cast<double>(m.sign * x[h] + off) + static_cast<double>(m.sign * x[n] + off)
                        + static_cast<double>(m.sign * x[q] + off))
                     / 3;
            };
            faces_[--of_chart_[charts_.of_piece[p]]] = {middle(strips_.u, m.u), middle(strips_.v, m.v),
                                                        twice_area(mesh_, position_, h),
                                                        image_area(h) * static_cast<double>(mirror_)};
        }
        return true;
    }

    // Corners in the planes of the charts, and the leaf of each face as its chart.
    Done place_faces() {
        const size_t sides = size_t{2} * mesh_.edge_count;
        if (!grid_.x.allocate_filled(call_.memory, sides, 0) || !grid_.y.allocate_filled(call_.memory, sides, 0)
            || !grid_.chart.allocate_filled(call_.memory, mesh_.face_count, NONE))
            return false;
        for (uint32_t t = 0; t < side_.size(); ++t) {
            if (t % 65536 == 0 && !call_.tick(0.89)) return false;
            const uint32_t p = strips_.piece[t], c = charts_.of_piece[p];
            const Motion& m = charts_.motion[p];
            double u = 0, v = 0;
            uint32_t h = side_[t];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                grid_.x[h] = m.sign * strips_.u[h] + m.u;
                grid_.y[h] = m.sign * strips_.v[h] + m.v;
                u += static_cast<double>(grid_.x[h]) / 3;
                v += static_cast<double>(grid_.y[h]) / 3;
            }
            // The leaf it lies in or, if it sticks out of all, next to.
            double nearest = HUGE_VAL;
            for (uint32_t i = 0; i < leaves_.size(); ++i) {
                if (leaves_[i].chart != c) continue;
                const Box& b = leaves_[i].box;
                const double off = std::max(std::max(b.u0 - u, u - b.u1), std::max(b.v0 - v, v - b.v1));
                if (off < nearest) {
                    nearest = off;
                    grid_.chart[t] = i;
                }
            }
        }
        grid_.chart_count = static_cast<uint32_t>(leaves_.size());
        return true;
    }

    // From the frame of the triangle of h to that of the one beyond, such that both meet along h.
    Motion over(uint32_t h) const {
        const uint32_t g = twin(h), n_h = mesh_.next[h], n_g = mesh_.next[g];
        const bool same = grid_.x[n_h] - grid_.x[h] == grid_.x[g] - grid_.x[n_g]
                       && grid_.y[n_h] - grid_.y[h] == grid_.y[g] - grid_.y[n_g];
        const int64_t sign = same ? 1 : -1;
        return {sign, grid_.x[n_g] - sign * grid_.x[h], grid_.y[n_g] - sign * grid_.y[h]};
    }

    void move_face(uint32_t t, const Motion& m) {
        uint32_t h = side_[t];
        for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
            grid_.x[h] = m.sign * grid_.x[h] + m.u;
            grid_.y[h] = m.sign * grid_.y[h] + m.v;
        }
    }

    // A triangle with two sides on seams goes over to where it has one: once each, so that the
    // edge of a chart stays within a triangle of where it was.
    Done smooth_edges() {
        Array<double> length;
        Array<uint8_t> moved;
        if (!length.allocate(call_.memory, mesh_.edge_count)
            || !moved.allocate_filled(call_.memory, mesh_.face_count, 0))
            return false;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            double square = 0;
            for (size_t a = 0; a < 3; ++a) {
                const double d =
                    position_[3 * size_t{mesh_.origin[2 * e]} + a] - position_[3 * size_t{mesh_.origin[2 * e + 1]} + a];
                square += d * d;
            }
            length[e] = std::sqrt(square);
        }
        const auto joined = [&](uint32_t t) {
            double sum = 0;
            uint32_t h = side_[t];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h])
                sum += is_joined(mesh_, grid_, edge_of(h)) ? length[edge_of(h)] : 0;
            return sum;
        };
        for (int pass = 0; pass < 3; ++pass)
            for (uint32_t t = 0; t < mesh_.face_count; ++t) {
                if (t % 65536 == 0 && !call_.tick(0.89)) return false;
                if (moved[t]) continue;
                uint32_t h = side_[t];
                for (int k = 0; k < 3 && !moved[t]; ++k, h = mesh_.next[h]) {
                    if (is_joined(mesh_, grid_, edge_of(h))) continue;
                    const uint32_t chart = grid_.chart[t];
                    const double before = joined(t);
                    const Motion m = over(h);
                    move_face(t, m);
                    grid_.chart[t] = grid_.chart[mesh_.face[twin(h)]];
                    if (joined(t) > before) moved[t] = 1;
                    else {
                        move_face(t, m.inverse());
                        grid_.chart[t] = chart;
                    }
                }
            }
        return true;
    }

    // What is not joined to the largest part of its chart goes to a neighbour or, if it is large, becomes a chart.
    Done gather() {
        const uint32_t n = mesh_.face_count;
        Array<uint32_t> part, size, largest, way;
        Array<double> longest;
        if (!part.allocate(call_.memory, n) || !size.allocate(call_.memory, n) || !way.allocate(call_.memory, n)
            || !longest.allocate(call_.memory, n))
            return false;
        for (int round = 0; round < 8; ++round) {
            if (!call_.tick(0.89)) return false;
            for (uint32_t t = 0; t < n; ++t) {
                part[t] = t;
                size[t] = 0;
                way[t] = NONE;
                longest[t] = -1;
            }
            for (uint32_t e = 0; e < mesh_.edge_count; ++e)
                if (grid_.chart[mesh_.face[2 * e]] != NONE && is_joined(mesh_, grid_, e))
                    unite(part.data(), mesh_.face[2 * e], mesh_.face[2 * e + 1]);
            for (uint32_t t = 0; t < n; ++t) ++size[part[t] = find_root(part.data(), t)];
            if (!largest.allocate_filled(call_.memory, grid_.chart_count, NONE)) return false;
            for (uint32_t t = 0; t < n; ++t) {
                if (grid_.chart[t] == NONE || part[t] != t) continue;
                uint32_t& best = largest[grid_.chart[t]];
                if (best == NONE || size[t] > size[best]) best = t;
            }
            // Large islands become charts.
            const uint32_t enough = std::max(24u, n / 200);
            bool any = false;
            for (uint32_t t = 0; t < n; ++t)
                if (grid_.chart[t] != NONE && part[t] == t && largest[grid_.chart[t]] != t
                    && (size[t] >= enough || round == 7)) {
                    if (!largest.push(t)) return false;
                    grid_.chart[t] = grid_.chart_count++;
                }
            for (uint32_t t = 0; t < n; ++t)
                if (grid_.chart[t] != NONE && largest[grid_.chart[part[t]]] == part[t])
                    grid_.chart[t] = grid_.chart[part[t]];
            // Others go over their longest side to one that stays.
            const auto stays = [&](uint32_t t) { return largest[grid_.chart[t]] == part[t]; };
            for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h) {
                const uint32_t from = mesh_.face[h], to = mesh_.face[twin(h)];
                if (grid_.chart[from] == NONE || grid_.chart[to] == NONE || stays(from) || !stays(to)) continue;
                const uint32_t next = mesh_.next[h];
                const double x = static_cast<double>(grid_.x[next] - grid_.x[h]),
                             y = static_cast<double>(grid_.y[next] - grid_.y[h]);
                if (x * x + y * y > longest[part[from]]) {
                    longest[part[from]] = x * x + y * y;
                    way[part[from]] = h;
                }
            }
            for (uint32_t t = 0; t < n; ++t) {
                if (grid_.chart[t] == NONE || stays(t)) continue;
                any = true;
            }
            if (!any) break;
            if (!move_islands(part, way)) return false;
        }
        return number_charts();
    }

    Done move_islands(const Array<uint32_t>& part, const Array<uint32_t>& way) {
        Array<Motion> motion;
        Array<uint32_t> to;
        if (!motion.allocate(call_.memory, mesh_.face_count)
            || !to.allocate_filled(call_.memory, mesh_.face_count, NONE))
            return false;
        for (uint32_t t = 0; t < mesh_.face_count; ++t) {
            const uint32_t h = way[t];
            if (part[t] != t || h == NONE) continue;
            motion[t] = over(h);
            to[t] = grid_.chart[mesh_.face[twin(h)]];
        }
        for (uint32_t t = 0; t < mesh_.face_count; ++t) {
            const uint32_t root = part[t];
            if (to[root] == NONE) continue;
            grid_.chart[t] = to[root];
            move_face(t, motion[root]);
        }
        return true;
    }

    // Charts with triangles, by the number of their first one.
    Done number_charts() {
        Array<uint32_t> number;
        if (!number.allocate_filled(call_.memory, grid_.chart_count, NONE)) return false;
        uint32_t count = 0;
        for (uint32_t& c : grid_.chart) {
            if (c == NONE) continue;
            if (number[c] == NONE) number[c] = count++;
            c = number[c];
        }
        grid_.chart_count = count;
        return true;
    }

    // To a grid, each chart with the scale that areas in space ask for.
    Done scale_to_grid() {
        const uint32_t n = grid_.chart_count;
        Array<double> area, image, to_grid;
        Array<int64_t> low_x, low_y;
        if (!area.allocate_filled(call_.memory, n, 0) || !image.allocate_filled(call_.memory, n, 0)
            || !to_grid.allocate(call_.memory, n) || !low_x.allocate_filled(call_.memory, n, INT64_MAX)
            || !low_y.allocate_filled(call_.memory, n, INT64_MAX))
            return false;
        for (uint32_t t = 0; t < side_.size(); ++t) {
            const uint32_t c = grid_.chart[t];
            area[c] += twice_area(mesh_, position_, side_[t]);
            image[c] += image_area(side_[t]) * static_cast<double>(mirror_);
            uint32_t h = side_[t];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                low_x[c] = std::min(low_x[c], grid_.x[h]);
                low_y[c] = std::min(low_y[c], mirror_ * grid_.y[h]);
            }
        }
        for (uint32_t c = 0; c < n; ++c)
            to_grid[c] = GRID * (image[c] > 0 ? std::sqrt(2 * area[c] / (whole_area_ * image[c])) : 0);
        for (uint32_t t = 0; t < side_.size(); ++t) {
            const uint32_t c = grid_.chart[t];
            const auto put = [&](int64_t x) {
                return static_cast<int64_t>(std::floor(std::min(static_cast<double>(x) * to_grid[c] + 0.5, 4 * GRID)));
            };
            uint32_t h = side_[t];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                grid_.x[h] = put(grid_.x[h] - low_x[c]);
                grid_.y[h] = put(mirror_ * grid_.y[h] - low_y[c]);
            }
        }
        return call_.tick(0.89);
    }

    // Triangles that overlap go over to a neighbour where they do not or, if there is none, become charts of their
    // own, as they are in space.
    Done take_overlaps_out() {
        Array<uint8_t> bad;
        if (!turn_back(mesh_, side_, grid_, call_) || !find_overlaps(mesh_, side_, grid_, SPECK, bad, call_))
            return false;
        for (int pass = 0; pass < 3; ++pass)
            for (uint32_t t = 0, tried = 0; t < side_.size() && tried < 200; ++t) {
                if (!bad[t]) continue;
                ++tried;
                if (!call_.tick(0.89)) return false;
                if (go_over(mesh_, side_, bad, t, grid_)) bad[t] = 0;
            }
        const double unit = GRID / std::sqrt(whole_area_ / 2);
        for (uint32_t t = 0; t < side_.size(); ++t) {
            if (!bad[t]) continue;
            const uint32_t h = side_[t], n = mesh_.next[h], p = mesh_.next[n];
            const double *a = position_ + size_t{3} * mesh_.origin[h], *b = position_ + size_t{3} * mesh_.origin[n],
                         *c = position_ + size_t{3} * mesh_.origin[p];
            double bb = 0, bc = 0;
            for (int i = 0; i < 3; ++i) {
                bb += (b[i] - a[i]) * (b[i] - a[i]);
                bc += (b[i] - a[i]) * (c[i] - a[i]);
            }
            const double base = std::sqrt(bb), height = base > 0 ? twice_area(mesh_, position_, h) / base : 0;
            const double foot = base > 0 ? bc / base : 0, left = foot < 0 ? -foot : 0;
            const auto put = [&](double x) { return static_cast<int64_t>(std::min(x * unit, 4 * GRID)); };
            grid_.x[h] = put(left);
            grid_.x[n] = put(left + base);
            grid_.x[p] = put(left + foot);
            grid_.y[h] = grid_.y[n] = 0;
            grid_.y[p] = put(height);
            grid_.chart[t] = grid_.chart_count++;
        }
        return separate();
    }

    // A chart for each part in one piece.
    Done separate() {
        Array<uint32_t> part;
        if (!part.allocate(call_.memory, mesh_.face_count)) return false;
        for (uint32_t t = 0; t < mesh_.face_count; ++t) part[t] = t;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e)
            if (is_joined(mesh_, grid_, e)) unite(part.data(), mesh_.face[2 * e], mesh_.face[2 * e + 1]);
        for (uint32_t t = 0; t < mesh_.face_count; ++t) grid_.chart[t] = find_root(part.data(), t);
        grid_.chart_count = mesh_.face_count;
        return number_charts();
    }

    hmf_status pack() {
        const uint32_t n = grid_.chart_count;
        Array<uint32_t> offset, faces;
        Array<Box> box;
        if (!offset.allocate_filled(call_.memory, size_t{n} + 1, 0) || !faces.allocate(call_.memory, side_.size())
            || !box.allocate_filled(call_.memory, n, Box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}))
            return call_.out_of_memory();
        double area = 0;
        out_.collapsed = 0;
        for (uint32_t t = 0; t < side_.size(); ++t) {
            const uint32_t c = grid_.chart[t];
            ++offset[c];
            uint32_t h = side_[t];
            int64_t size = 0;
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                const double x = static_cast<double>(grid_.x[h]), y = static_cast<double>(grid_.y[h]);
                box[c].add({x, y, x, y});
                for (const int64_t d : {grid_.x[mesh_.next[h]] - grid_.x[h], grid_.y[mesh_.next[h]] - grid_.y[h]})
                    size = std::max(size, d < 0 ? -d : d);
            }
            const int64_t twice = grid_area(mesh_, grid_, side_[t]);
            out_.collapsed += twice <= 0;
            area += static_cast<double>(twice) / 2;
        }
        for (uint32_t c = 0, sum = 0; c <= n; ++c) sum = offset[c] += sum;
        for (uint32_t t = 0; t < side_.size(); ++t) faces[--offset[grid_.chart[t]]] = t;
        Packer packer;
        double margin = margin_ * GRID * 1.12;
        for (int round = 0;; ++round) {
            if (round == 20 || margin > 64 * GRID)
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                                  "The margin is too large for %u charts. Choose a smaller one.",
                                  static_cast<unsigned>(n));
            packer.start(call_.memory, GRID / 320, margin);
            packer.add_area(area);
            for (uint32_t c = 0; c < n; ++c) {
                if (c % 256 == 0 && !call_.tick(0.9)) return call_.was_cancelled();
                if (!packer.begin_shape(box[c].u0, box[c].v0, box[c].u1, box[c].v1)) return call_.out_of_memory();
                for (uint32_t i = offset[c]; i < offset[c + 1]; ++i) {
                    double xy[6];
                    uint32_t h = side_[faces[i]];
                    for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                        xy[2 * k] = static_cast<double>(grid_.x[h]);
                        xy[2 * k + 1] = static_cast<double>(grid_.y[h]);
                    }
                    packer.add_part(xy, 3);
                }
            }
            // At first roughly: the side tells the margin in units.
            if (packer.search(0, call_)) return call_.status();
            if (margin >= margin_ * packer.side()) break;
            margin = margin_ * packer.side() * 1.02;
        }
        if (packer.search(THOROUGH, call_)) return call_.status();
        if (!out_.uv.allocate_filled(call_.memory, size_t{4} * mesh_.edge_count, 0)) return call_.out_of_memory();
        const double side = packer.side();
        for (uint32_t t = 0; t < side_.size(); ++t) {
            const Packer::Place& place = packer.place(grid_.chart[t]);
            uint32_t h = side_[t];
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                const double x = static_cast<double>(grid_.x[h]), y = static_cast<double>(grid_.y[h]);
                const double turned[2] = {place.turns == 0   ? x
                                          : place.turns == 1 ? -y
                                          : place.turns == 2 ? -x
                                                             : y,
                                          place.turns == 0   ? y
                                          : place.turns == 1 ? x
                                          : place.turns == 2 ? -y
                                                             : -x};
                // To whole units of the grid: what is joined stays joined.
                out_.uv[2 * size_t{h}] = (turned[0] + std::floor(place.x)) / side;
                out_.uv[2 * size_t{h} + 1] = (turned[1] + std::floor(place.y)) / side;
            }
        }
        out_.used_area = area / (side * side);
        out_.chart_count = n;
        out_.chart.swap(grid_.chart);
        return HMF_OK;
    }

    const Mesh& mesh_;
    const double* position_;
    const SignBundle& bundle_;
    const Strips& strips_;
    const double margin_;
    Atlas& out_;
    Call& call_;
    Array<uint32_t> side_;
    Charts charts_;
    Array<Leaf> leaves_;
    Array<double> area_, image_; // per piece, twice: in space, in the plane
    Array<uint32_t> of_chart_;   // first in faces_
    Array<FaceInChart> faces_;
    double whole_ = 0, whole_area_ = 0; // image of all; twice the surface
    double triangle_ = 0;               // length of a side in the plane
    int64_t mirror_ = 1;
    uint64_t planned_ = 0; // steps of packing
    GridLayout grid_;      // at first in units of the flat surface
};

} // namespace

bool Atlas::is_joined(const Mesh& mesh, uint32_t edge) const {
    const uint32_t h = 2 * edge, t = h + 1;
    if (chart[mesh.face[h]] != chart[mesh.face[t]]) return false;
    for (size_t i = 0; i < 2; ++i)
        if (uv[2 * size_t{h} + i] != uv[2 * size_t{mesh.next[t]} + i]
            || uv[2 * size_t{t} + i] != uv[2 * size_t{mesh.next[h]} + i])
            return false;
    return true;
}

hmf_status Atlas::build(const Mesh& mesh, const double* position, const SignBundle& bundle, const Strips& strips,
                        double margin, Call& call) {
    return Maker(mesh, position, bundle, strips, margin, *this, call).run();
}

} // namespace hmf
