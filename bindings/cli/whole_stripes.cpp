// Critical leaves cut each edge into pieces, each in one cylinder; every piece is scaled as its cylinder is.
//
//        |  cylinder 3   |           A piece between two critical leaves has the middle leaf of its cylinder in it.
//    a---|-------:-------|----b      The ends of edges (germs) at a vertex lie in one cylinder if the vertex is on no
//        |       :       |           critical leaf, or if they leave it to the same side; so do both germs of an edge
//     critical  middle  critical     without critical leaf.
#include "whole_stripes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cli {

namespace {

class Sets {
public:
    explicit Sets(size_t count) : up_(count) { std::iota(up_.begin(), up_.end(), 0u); }
    uint32_t root(uint32_t x) {
        while (up_[x] != x) x = up_[x] = up_[up_[x]];
        return x;
    }
    void unite(uint32_t a, uint32_t b) { up_[root(a)] = root(b); }

private:
    std::vector<uint32_t> up_;
};

} // namespace

void add_crossings(const Foliation& f, const hmf_lines& lines, const uint32_t* whole_edges,
                   std::vector<Crossing>& crossings, std::vector<double>& heights) {
    const uint32_t before = static_cast<uint32_t>(heights.size());
    for (uint64_t l = 0; l < lines.line_count; ++l) {
        const hmf_line& line = lines.lines[l];
        const bool is_critical = line.kind == HMF_LINE_CRITICAL;
        // Of a double whose halves are not exactly symmetric: stripes keep their width there.
        if (!is_critical && line.cylinder == HMF_NONE) continue;
        if (!is_critical) {
            heights.resize(std::max(heights.size(), size_t{before} + line.cylinder + 1), 1);
            heights[before + line.cylinder] = 2 * line.height;
        }
        for (uint64_t p = lines.offsets[l]; p < lines.offsets[l + 1]; ++p) {
            if (lines.point_edges[p] == HMF_NONE) continue;
            const uint32_t edge = whole_edges ? whole_edges[lines.point_edges[p]] : lines.point_edges[p];
            const double* const a = &f.positions[size_t{3} * f.edge_vertices[size_t{2} * edge]];
            const double* const b = &f.positions[size_t{3} * f.edge_vertices[size_t{2} * edge + 1]];
            double along = 0, square = 0;
            for (size_t i = 0; i < 3; ++i) {
                along += (lines.points[3 * p + i] - a[i]) * (b[i] - a[i]);
                square += (b[i] - a[i]) * (b[i] - a[i]);
            }
            crossings.push_back({edge, square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.5,
                                 is_critical ? CRITICAL : before + line.cylinder});
        }
    }
}

std::vector<double> whole_stripes(const Foliation& f, std::vector<Crossing> crossings,
                                  const std::vector<double>& heights, double period) {
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.edge != b.edge ? a.edge < b.edge : a.at < b.at; });
    std::vector<double> scale;
    for (const double height : heights) scale.push_back(std::max(1.0, std::round(height / period)) * period / height);

    const size_t edges = f.values.size(), vertices = f.positions.size() / 3;
    // Vertices that a critical leaf goes through, with all that lies on one point of the tree with them.
    Sets clusters(vertices);
    for (size_t e = 0; e < edges; ++e)
        if (f.values[e] == 0) clusters.unite(f.edge_vertices[2 * e], f.edge_vertices[2 * e + 1]);
    std::vector<uint8_t> is_critical(vertices, 0);
    for (const hmf_singularity& s : f.singular)
        if (s.kind != HMF_SINGULAR_TRIANGLE && s.index != 0) is_critical[clusters.root(s.element)] = 1;
    for (const Crossing& c : crossings)
        if (c.cylinder == CRITICAL && (c.at < 1e-9 || c.at > 1 - 1e-9))
            is_critical[clusters.root(f.edge_vertices[2 * size_t{c.edge} + (c.at > 0.5)])] = 1;

    std::vector<uint8_t> is_cut(edges, 0);
    for (const Crossing& c : crossings)
        if (c.cylinder == CRITICAL) is_cut[c.edge] = 1;
    Sets germs(2 * edges);
    for (uint32_t e = 0; e < edges; ++e)
        if (!is_cut[e]) germs.unite(2 * e, 2 * e + 1);
    for (size_t t = 0; t < f.triangle_count(); ++t)
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t v = f.triangles[3 * t + c];
            const uint32_t next = f.triangle_edges[3 * t + c], last = f.triangle_edges[3 * t + (c + 2) % 3],
                           far = f.triangle_edges[3 * t + (c + 1) % 3];
            const auto germ = [&](uint32_t e, uint32_t at) { return 2 * e + (f.edge_vertices[2 * size_t{e}] != at); };
            if (f.values[next] == 0 && f.values[last] > 0)
                germs.unite(germ(last, v), germ(far, f.triangles[3 * t + (c + 1) % 3]));
            if (!(f.values[next] > 0) || !(f.values[last] > 0)) continue;
            const bool same_side = f.values[far] < (1 - 1e-12) * (f.values[next] + f.values[last]);
            if (same_side || !is_critical[clusters.root(v)]) germs.unite(germ(next, v), germ(last, v));
        }

    std::vector<uint32_t> cylinder(2 * edges, CRITICAL); // of roots
    const auto each_edge = [&](auto work) {
        for (size_t i = 0; i < crossings.size();) {
            size_t end = i;
            while (end < crossings.size() && crossings[end].edge == crossings[i].edge) ++end;
            work(crossings[i].edge, i, end);
            i = end;
        }
    };
    each_edge([&](uint32_t e, size_t begin, size_t end) {
        if (crossings[begin].cylinder != CRITICAL) cylinder[germs.root(2 * e)] = crossings[begin].cylinder;
        if (crossings[end - 1].cylinder != CRITICAL) cylinder[germs.root(2 * e + 1)] = crossings[end - 1].cylinder;
    });
    const auto scaled = [&](uint32_t k) { return k < scale.size() ? scale[k] : 1.0; };
    std::vector<double> values(edges);
    for (uint32_t e = 0; e < edges; ++e) values[e] = f.values[e] * scaled(cylinder[germs.root(2 * e)]);
    each_edge([&](uint32_t e, size_t begin, size_t end) {
        if (!is_cut[e]) return;
        double sum = 0, from = 0;
        uint32_t here = cylinder[germs.root(2 * e)];
        for (size_t i = begin; i < end; ++i) {
            if (crossings[i].cylinder != CRITICAL) {
                here = crossings[i].cylinder;
                continue;
            }
            sum += (crossings[i].at - from) * scaled(here);
            from = crossings[i].at;
            here = cylinder[germs.root(2 * e + 1)];
        }
        values[e] = f.values[e] * (sum + (1 - from) * scaled(here));
    });
    return values;
}

} // namespace cli
