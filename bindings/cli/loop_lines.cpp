#include "loop_lines.hpp"

namespace cli {

namespace {

std::array<double, 3> mean(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

std::array<double, 3> place(const Foliation& f, uint32_t vertex) {
    return {f.positions[3 * size_t(vertex)], f.positions[3 * size_t(vertex) + 1], f.positions[3 * size_t(vertex) + 2]};
}

} // namespace

std::vector<Line> loop_lines(const Foliation& f, const hmf_loop_set& loops) {
    std::vector<Line> lines;
    for (size_t c = 0; c < loops.count; ++c) {
        Line line;
        const size_t first = loops.offsets[c], count = loops.offsets[c + 1] - first;
        const bool is_arc = loops.arcs && loops.arcs[c];
        for (size_t i = 0; i < count; ++i) {
            if (is_arc && i + 1 == count && loops.element_kind != HMF_LOOP_VERTICES) break;
            const uint32_t here = loops.elements[first + i], next = loops.elements[first + (i + 1) % count];
            if (loops.element_kind == HMF_LOOP_VERTICES) {
                line.push_back(place(f, here));
                continue;
            }
            for (size_t s = 0; s < 9; ++s) {
                const uint32_t edge = f.triangle_edges[3 * size_t(here) + s / 3];
                if (edge != f.triangle_edges[3 * size_t(next) + s % 3]) continue;
                line.push_back(
                    mean(place(f, f.edge_vertices[2 * size_t(edge)]), place(f, f.edge_vertices[2 * size_t(edge) + 1])));
                break;
            }
        }
        for (int round = 0; round < 2; ++round) {
            Line smooth(line.size());
            for (size_t i = 0; i < line.size(); ++i)
                smooth[i] = mean(line[i], mean(line[(i + 1) % line.size()], line[(i + line.size() - 1) % line.size()]));
            if (is_arc && !line.empty()) { // the ends stay
                smooth.front() = line.front();
                smooth.back() = line.back();
            }
            line = smooth;
        }
        // An arc is drawn there and back.
        for (size_t i = line.size(); is_arc && i-- > 1;) line.push_back(line[i - 1]);
        lines.push_back(line);
    }
    return lines;
}

} // namespace cli
