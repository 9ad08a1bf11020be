#include "holes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mesh_sides.hpp"
#include "point_numbers.hpp"
#include "polygon.hpp"

namespace readers {

namespace {

// Sides with no other triangle.
std::vector<uint32_t> boundary_sides(const TriangleMesh& mesh) {
    const Groups sides = group_sides(mesh.triangles, mesh.vertex_count());
    std::vector<uint32_t> found;
    for (size_t g = 0; g < sides.count(); ++g)
        if (sides.size_of(g) == 1) found.push_back(*sides.begin_of(g));
    std::sort(found.begin(), found.end());
    return found;
}

double distance(const TriangleMesh& mesh, uint32_t a, uint32_t b) {
    double square = 0;
    for (size_t k = 0; k < 3; ++k) {
        const double d = mesh.positions[size_t{3} * a + k] - mesh.positions[size_t{3} * b + k];
        square += d * d;
    }
    return std::sqrt(square);
}

} // namespace

std::vector<Hole> holes_of(const TriangleMesh& mesh) {
    // From each vertex back along a side: a hole runs against its triangles.
    std::map<uint32_t, std::vector<uint32_t>> next;
    const std::vector<uint32_t> sides = boundary_sides(mesh);
    for (auto side = sides.rbegin(); side != sides.rend(); ++side)
        next[mesh.triangles[next_corner(*side)]].push_back(mesh.triangles[*side]);
    std::vector<Hole> holes;
    for (const uint32_t side : sides) {
        std::vector<uint32_t> path = {mesh.triangles[next_corner(side)]};
        std::map<uint32_t, size_t> place = {{path[0], 0}};
        for (;;) {
            auto& ways = next[path.back()];
            if (ways.empty()) break;
            const uint32_t v = ways.back();
            ways.pop_back();
            const auto [met, is_new] = place.emplace(v, path.size());
            if (is_new) {
                path.push_back(v);
                continue;
            }
            // A loop of the path is a hole; the rest goes on.
            Hole hole;
            hole.vertices.assign(path.begin() + static_cast<std::ptrdiff_t>(met->second), path.end());
            for (size_t i = 0; i < hole.vertices.size(); ++i)
                hole.length += distance(mesh, hole.vertices[i], hole.vertices[(i + 1) % hole.vertices.size()]);
            const size_t kept = met->second + 1;
            holes.push_back(std::move(hole));
            while (path.size() > kept) {
                place.erase(path.back());
                path.pop_back();
            }
        }
    }
    return holes;
}

size_t doubled_boundary_vertices(const TriangleMesh& mesh) {
    std::set<uint32_t> vertices;
    for (const uint32_t side : boundary_sides(mesh))
        vertices.insert({mesh.triangles[side], mesh.triangles[next_corner(side)]});
    std::vector<double> points;
    PointNumbers numbers(points);
    std::vector<size_t> at_point;
    for (const uint32_t v : vertices) {
        const double* const p = &mesh.positions[size_t{3} * v];
        const uint32_t n = numbers.number_of(p[0], p[1], p[2]);
        if (n == at_point.size()) at_point.push_back(0);
        ++at_point[n];
    }
    size_t doubled = 0;
    for (const size_t count : at_point) doubled += count - 1;
    return doubled;
}

namespace {

// Corners by their places in the path.
std::vector<uint32_t> triangles_in(const TriangleMesh& mesh, const Hole& hole) {
    TriangleMesh patch;
    Polygon polygon(patch);
    for (uint32_t i = 0; i < hole.vertices.size(); ++i) {
        const double* const p = &mesh.positions[size_t{3} * hole.vertices[i]];
        patch.positions.insert(patch.positions.end(), p, p + 3);
        polygon.add(i);
    }
    polygon.end(0);
    triangulate_polygons(patch);
    return std::move(patch.triangles);
}

// With a new vertex.
std::vector<uint32_t> cone_over(TriangleMesh& mesh, const Hole& hole) {
    const size_t n = hole.vertices.size();
    const uint32_t middle = static_cast<uint32_t>(mesh.vertex_count());
    double sum[3] = {0, 0, 0};
    for (const uint32_t v : hole.vertices)
        for (size_t k = 0; k < 3; ++k) sum[k] += mesh.positions[size_t{3} * v + k] / static_cast<double>(n);
    mesh.positions.insert(mesh.positions.end(), sum, sum + 3);
    std::vector<uint32_t> triangles;
    for (size_t i = 0; i < n; ++i)
        triangles.insert(triangles.end(), {hole.vertices[i], hole.vertices[(i + 1) % n], middle});
    return triangles;
}

} // namespace

size_t fill_holes(TriangleMesh& mesh, size_t most_edges) {
    const std::vector<Hole> holes = holes_of(mesh);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> apex; // behind each directed side
    const auto add_sides = [&](const std::vector<uint32_t>& triangles) {
        for (uint32_t side = 0; side < triangles.size(); ++side) {
            const uint32_t to = next_corner(side);
            apex[{triangles[side], triangles[to]}] = triangles[next_corner(to)];
        }
    };
    const size_t vertices = mesh.vertex_count(), triangle_count = mesh.triangle_count();
    size_t filled = 0;
    for (const Hole& hole : holes) {
        const size_t n = hole.vertices.size();
        if (n < 3 || n > most_edges) continue;
        if (filled == 0) add_sides(mesh.triangles);
        if (n == 3 && apex[{hole.vertices[1], hole.vertices[0]}] == hole.vertices[2]) continue; // one triangle alone
        std::vector<uint32_t> triangles = triangles_in(mesh, hole);
        for (uint32_t& v : triangles) v = hole.vertices[v];
        // A diagonal that is an edge already would have more than two triangles.
        size_t met = 0;
        for (uint32_t side = 0; side < triangles.size(); ++side) {
            const uint32_t a = triangles[side], b = triangles[next_corner(side)];
            met += apex.count({a, b}) + apex.count({b, a});
        }
        if (met > n) triangles = cone_over(mesh, hole);
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
        add_sides(triangles);
        ++filled;
    }
    mesh.origin.extend(vertices, mesh.vertex_count(), triangle_count, mesh.triangle_count());
    return filled;
}

} // namespace readers
