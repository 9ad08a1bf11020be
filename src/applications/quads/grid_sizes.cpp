#include "grid_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

void GridSizes::take(const QuadInput& in, const QuadSizes& sizes, double step, double number) {
    ring = in.front ? 2 * sizes.ring : sizes.ring;
    for (size_t a = 0; a < columns.size(); ++a)
        columns[a] = sizes.columns[a] + (in.front ? sizes.columns[in.front->arc_mirror[a]] : 0);
    for (uint32_t c = 0; c < rows.size(); ++c)
        rows[c] = sizes.rows[c] + (in.front ? sizes.rows[in.front->cylinder_mirror[c]] : 0);
    if (in.front) tune_rows(in, sizes, step, number);
}

// As many rows in front as requested, and at least those of the sizes.
void GridSizes::tune_rows(const QuadInput& in, const QuadSizes& sizes, double step, double number) {
    const auto part = [&](uint32_t c) {
        return in.is_annulus() && in.part_of(c) == Part::front ? Part::ring : in.part_of(c);
    };
    const auto quads = [&](uint32_t c) -> int64_t { // for two rows of the double
        const int64_t n = columns_across(in.cylinders, columns, ring, c);
        return part(c) == Part::back ? 0 : part(c) == Part::front ? 2 * n : n;
    };
    for (int round = 0; round < 8; ++round) {
        double sum = 0;
        for (uint32_t c = 0; c < rows.size(); ++c) {
            const double by = part(c) == Part::ring ? 2 : 1;
            const double n = by * std::floor(static_cast<double>(in.cylinders.list[c].height) / (step * by) + 0.5);
            rows[c] = std::max(sizes.rows[c] * (by > 1 ? 2 : 1), static_cast<int64_t>(n));
            sum += 0.5 * static_cast<double>(quads(c)) * static_cast<double>(rows[c]);
        }
        if (!(number > 0)) return;
        const double off = sum / number;
        if (off > 0.995 && off < 1.005) return;
        step *= off > 4 ? 4 : off < 0.25 ? 0.25 : off;
    }
}

} // namespace hmf
