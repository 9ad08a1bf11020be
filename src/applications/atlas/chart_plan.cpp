#include "chart_plan.hpp"

#include "../../core/base/heap_sort.hpp"
#include "pack.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint64_t ROUGH = 150000;  // steps of the packing that a cut is tried with
constexpr uint64_t QUICK = 1500000; // and of those that are best in it
constexpr size_t CHOSEN = 3;        // so many
constexpr uint64_t WHOLE = 500000;  // steps of the packing that a way to join pieces is tried with
constexpr size_t JOINS = 6;         // so many of these are then cut
// Ways to join: room that a chart less is worth, as a part of the whole, and how often the room along seams counts.
constexpr double EAGER[] = {0.003, 0.007, 0.01, 0.015, 0.02, 0.025, 0.03, 0.035, 0.04, 0.05, 0.06, 0.08, 0.12};
constexpr double SEAMS[] = {1, 2, 4, 8};
constexpr double COLUMNS = 96;                     // of these packings
constexpr uint64_t PLANNING = 1000000000;          // of all of them
constexpr double WISHED_USE = 0.88;                // of the square, as planned: ragged edges take some of it
constexpr double LEAST_USE = 0.8, MUCH_LONGER = 5; // below this each part counts so many times more
constexpr double COST_OF_CHART = 0.035;            // a chart less is worth this part of the square
constexpr double LONG = 1.6;                       // sides of the square: longer charts are cut in equal parts,
constexpr double MOST_PARTS = 1000;                // each
constexpr int MOST_CUTS = 12, PARTS_TRIED = 3;     // of the longest parts, for each cut
constexpr double SHORTEST = 8;                     // triangles
constexpr double LONGEST_CHART = 1000;             // sides of the square: nothing beside it could be seen
constexpr size_t FEW_PARTS = 8;
constexpr int FINE_STEPS = 32, COARSE_STEPS = 12; // places tried: with few parts, with more

} // namespace

// How large a square the parts need, roughly.
hmf_status ChartPlan::try_packing(uint64_t effort, double& side) {
    const double size = std::sqrt(pieces_.whole), rim = 0.35 * pieces_.triangle;
    Packer packer;
    double widest = 2 * size; // square that is reckoned with: it holds the longest part
    for (const ChartPart& part : parts) {
        const double length = length_of(part);
        if (!(length < LONGEST_CHART * size))
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, part.chart,
                              "A chart is %.3g times as long as a square of the area of the surface. Repair triangles "
                              "that are nearly without area.",
                              length / size);
        widest = std::max(widest, length);
    }
    packer.start(call_.memory, widest / (2 * COLUMNS), pieces_.margin * size * 1.15);
    for (const ChartPart& part : parts) {
        const double k = part.scale;
        if (!packer.begin_shape(part.box.u0 * k - rim, part.box.v0 * k - rim, part.box.u1 * k + rim,
                                part.box.v1 * k + rim))
            return call_.out_of_memory();
        for (uint32_t p = 0; p < pieces_.area.size(); ++p) {
            if (charts.of_piece[p] != part.chart) continue;
            Box b = charts.box_in_chart(p);
            b = {std::max(b.u0, part.box.u0), std::max(b.v0, part.box.v0), std::min(b.u1, part.box.u1),
                 std::min(b.v1, part.box.v1)};
            if (b.u0 >= b.u1 || b.v0 >= b.v1) continue;
            const double x0 = b.u0 * k - rim, y0 = b.v0 * k - rim, x1 = b.u1 * k + rim, y1 = b.v1 * k + rim;
            const double xy[8] = {x0, y0, x1, y0, x1, y1, x0, y1};
            packer.add_part(xy, 4);
        }
    }
    if (packer.search(effort, nullptr, call_)) return call_.status();
    side = packer.side();
    planned_ += packer.steps();
    return HMF_OK;
}

hmf_status ChartPlan::whole_charts() {
    Array<double> area, image;
    parts.start(call_.memory);
    if (!area.allocate_filled(call_.memory, charts.count, 0) || !image.allocate_filled(call_.memory, charts.count, 0))
        return call_.out_of_memory();
    for (uint32_t c = 0; c < charts.count; ++c)
        if (!parts.push({c, {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, 1})) return call_.out_of_memory();
    for (uint32_t p = 0; p < pieces_.area.size(); ++p) {
        const uint32_t c = charts.of_piece[p];
        parts[c].box.add(charts.box_in_chart(p));
        area[c] += pieces_.area[p];
        image[c] += pieces_.image[p];
    }
    for (uint32_t c = 0; c < charts.count; ++c) parts[c].scale = scale_of(area[c], image[c]);
    return HMF_OK;
}

double ChartPlan::scale_of(double area, double image) const {
    return image > 0 ? std::sqrt(area / pieces_.whole_area * 2 * pieces_.whole / image) : 1;
}

// The value of a packing: the covered part of the square, and few charts.
double ChartPlan::cost_of(double side, size_t charts) const {
    const double use = pieces_.whole / (side * side);
    return std::max(0.0, WISHED_USE - use) + MUCH_LONGER * std::max(0.0, LEAST_USE - use)
         + COST_OF_CHART * static_cast<double>(charts);
}

double ChartPlan::length_of(const ChartPart& part) const {
    return std::max(part.box.u1 - part.box.u0, part.box.v1 - part.box.v0) * part.scale;
}

// The second part becomes the last part.
Done ChartPlan::cut_part(uint32_t i, bool in_u, double where) {
    ChartPart& first = parts[i];
    ChartPart rest = first;
    (in_u ? first.box.u1 : first.box.v1) = where;
    (in_u ? rest.box.u0 : rest.box.v0) = where;
    double area[2] = {0, 0}, image[2] = {0, 0};
    if (!call_.work(8 * uint64_t{of_chart_[first.chart + 1] - of_chart_[first.chart]}, 0.88, false)) return false;
    for (uint32_t k = of_chart_[first.chart]; k < of_chart_[first.chart + 1]; ++k) {
        const FaceInChart& f = faces_[k];
        const Box& b = parts[i].box;
        const bool other = in_u ? f.u >= where : f.v >= where;
        const Box& box = other ? rest.box : b;
        if (f.u < box.u0 || f.u > box.u1 || f.v < box.v0 || f.v > box.v1) continue;
        area[other] += f.area;
        image[other] += f.image;
    }
    first.scale = scale_of(area[0], image[0]);
    rest.scale = scale_of(area[1], image[1]);
    return parts.push(rest);
}

// Middles and areas of the triangles, chart by chart.
Done ChartPlan::list_faces() {
    if (!of_chart_.allocate_filled(call_.memory, size_t{charts.count} + 1, 0)
        || !faces_.allocate(call_.memory, pieces_.side.size()))
        return false;
    for (const uint32_t p : pieces_.strips.piece)
        if (p != NONE) ++of_chart_[charts.of_piece[p]];
    for (uint32_t c = 0, sum = 0; c <= charts.count; ++c) sum = of_chart_[c] += sum;
    for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
        if (t % 65536 == 0 && !call_.tick(0.88)) return false;
        const uint32_t p = pieces_.strips.piece[t], h = pieces_.side[t], n = pieces_.mesh.next[h],
                       q = pieces_.mesh.next[n];
        if (p == NONE) continue;
        const Motion& m = charts.motion[p];
        const auto middle = [&](const Array<int64_t>& x, int64_t off) {
            return (static_cast<double>(m.sign * x[h] + off) + static_cast<double>(m.sign * x[n] + off)
                    + static_cast<double>(m.sign * x[q] + off))
                 / 3;
        };
        faces_[--of_chart_[charts.of_piece[p]]] = {middle(pieces_.strips.u, m.u), middle(pieces_.strips.v, m.v),
                                                   pieces_.twice_area(h),
                                                   pieces_.image_area(h) * static_cast<double>(pieces_.mirror)};
    }
    return true;
}

// What is much longer than the square in equal parts.
Done ChartPlan::cut_long_parts() {
    const double size = std::sqrt(pieces_.whole);
    for (uint32_t i = 0, n = static_cast<uint32_t>(parts.size()); i < n; ++i) {
        const Box box = parts[i].box;
        const double length = length_of(parts[i]);
        const bool in_u = box.u1 - box.u0 > box.v1 - box.v0;
        if (!(length > LONG * size)) continue;
        const double count = std::min(std::ceil(length / size), MOST_PARTS);
        for (int k = static_cast<int>(count) - 1; k > 0; --k) {
            const double at = static_cast<double>(k) / count;
            if (!cut_part(i, in_u, (in_u ? box.u0 : box.v0) + at * (in_u ? box.u1 - box.u0 : box.v1 - box.v0)))
                return false;
        }
    }
    return true;
}

// Of the parts that are shorter than that one (NONE: of all) the longest, the lower number first.
uint32_t ChartPlan::next_shorter(uint32_t last) const {
    const double limit = last == NONE ? HUGE_VAL : length_of(parts[last]);
    uint32_t longest = NONE;
    double length = -1;
    for (uint32_t i = 0; i < parts.size(); ++i) {
        const double l = length_of(parts[i]);
        if ((l < limit || (l == limit && i > last)) && l > length) length = l, longest = i;
    }
    return longest;
}

// Cuts across the chart, with the value of a rough packing.
hmf_status ChartPlan::try_cuts(uint32_t part, Array<Cut>& cuts) {
    const ChartPart whole = parts[part];
    const Box& box = whole.box;
    const double length = length_of(whole);
    const bool in_u = box.u1 - box.u0 > box.v1 - box.v0;
    const int steps = parts.size() <= FEW_PARTS ? FINE_STEPS : COARSE_STEPS;
    for (int k = 1; k < steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        if (length * std::min(share, 1 - share) < SHORTEST * pieces_.triangle) continue;
        const double where = in_u ? box.u0 + share * (box.u1 - box.u0) : box.v0 + share * (box.v1 - box.v0);
        Cut cut{part, in_u, where, 0, 0};
        if (try_cut(ROUGH, cut)) return call_.status();
        if (!cuts.push(cut)) return call_.out_of_memory();
    }
    return HMF_OK;
}

hmf_status ChartPlan::try_cut(uint64_t effort, Cut& cut) {
    const ChartPart whole = parts[cut.part];
    if (!cut_part(cut.part, cut.in_u, cut.where)) return call_.out_of_memory();
    if (try_packing(effort, cut.side)) return call_.status();
    cut.cost = cost_of(cut.side, parts.size());
    parts.pop();
    parts[cut.part] = whole;
    return HMF_OK;
}

// The best of the cuts that are best in rough packings, if it is better than `best`.
hmf_status ChartPlan::choose_cut(Array<Cut>& cuts, Cut& best) {
    heap_sort(cuts.data(), cuts.size(), [](const Cut& a, const Cut& b) {
        if (a.cost != b.cost) return a.cost < b.cost;
        return a.part != b.part ? a.part < b.part : a.where < b.where;
    });
    for (size_t i = 0; i < std::min(cuts.size(), CHOSEN); ++i) {
        if (try_cut(QUICK, cuts[i])) return call_.status();
        if (cuts[i].cost < best.cost) best = cuts[i];
    }
    return HMF_OK;
}

hmf_status ChartPlan::cut_charts(double& cost) {
    double side = 0;
    Array<Cut> cuts;
    cuts.start(call_.memory);
    if (!list_faces()) return call_.stopped();
    if (!cut_long_parts()) return call_.out_of_memory();
    if (try_packing(QUICK, side)) return call_.status();
    cost = cost_of(side, parts.size());
    for (int cut = 0; cut < MOST_CUTS && pieces_.whole < WISHED_USE * side * side && planned_ < PLANNING; ++cut) {
        Cut best{NONE, false, 0, cost, side};
        uint32_t part = NONE;
        cuts.clear();
        for (int tried = 0; tried < PARTS_TRIED; ++tried) {
            part = next_shorter(part);
            if (part == NONE) break;
            if (try_cuts(part, cuts)) return call_.status();
        }
        if (choose_cut(cuts, best)) return call_.status();
        side = best.side;
        if (best.part == NONE) break;
        if (!cut_part(best.part, best.in_u, best.where)) return call_.out_of_memory();
        cost = best.cost;
    }
    return HMF_OK;
}

// The values of the joins without cuts, best first.
hmf_status ChartPlan::try_joins(Array<Join>& joins) {
    const double size = std::sqrt(pieces_.whole), rim = pieces_.triangle / 2 + pieces_.margin * size;
    joins.start(call_.memory);
    for (const double seams : SEAMS) {
        uint32_t count = 0; // of the charts before: more eagerly joined they are often the same
        for (const double bonus : EAGER) {
            Join join{{bonus, seams * rim, 1.02 * size}, 0};
            double side = 0;
            if (charts.join(join.wish, call_)) return call_.status();
            if (charts.count == count || (!joins.empty() && planned_ > PLANNING / 4)) continue;
            count = charts.count;
            if (whole_charts()) return call_.status();
            if (!list_faces() || !cut_long_parts()) return call_.stopped();
            if (try_packing(WHOLE, side)) return call_.status();
            join.cost = cost_of(side, parts.size());
            bool is_new = true;
            for (const Join& other : joins) is_new = is_new && other.cost != join.cost;
            if (is_new && !joins.push(join)) return call_.out_of_memory();
        }
    }
    heap_sort(joins.data(), joins.size(), [](const Join& a, const Join& b) { return a.cost < b.cost; });
    return HMF_OK;
}

// Joins pieces to charts, and cuts charts where the square then becomes smaller.
hmf_status ChartPlan::run() {
    if (charts.start(pieces_.mesh, pieces_.bundle, pieces_.strips, pieces_.triangle, call_)) return call_.status();
    Array<Join> joins;
    JoinWish best;
    double best_cost = HUGE_VAL;
    Array<ChartPart> best_parts;
    if (try_joins(joins)) return call_.status();
    for (size_t i = 0; i < std::min(joins.size(), JOINS); ++i) {
        if (i > 0 && planned_ > PLANNING) break;
        double cost = 0;
        if (charts.join(joins[i].wish, call_) || whole_charts() || cut_charts(cost)) return call_.status();
        if (cost < best_cost) {
            best_cost = cost;
            best = joins[i].wish;
            best_parts.swap(parts);
        }
    }
    parts.swap(best_parts);
    return charts.join(best, call_);
}

} // namespace hmf
