#include "tubes.hpp"

#include <algorithm>
#include <cmath>

namespace test {

namespace {

uint32_t add_point(TriMesh& mesh, double x, double y, double z) {
    mesh.positions.insert(mesh.positions.end(), {x, y, z});
    return static_cast<uint32_t>(mesh.vertex_count() - 1);
}

// Two triangles between the sides (a, b) of one ring and (c, d) of the next.
void add_cell(TriMesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d, bool diagonal) {
    if (diagonal) {
        add_triangle(mesh, a, c, d);
        add_triangle(mesh, a, d, b);
    } else {
        add_triangle(mesh, a, c, b);
        add_triangle(mesh, b, c, d);
    }
}

// Rings of vertices along a circle, and `bands` bands between them.
TriMesh tube(const TubeOptions& o, size_t bands) {
    Random random(o.seed);
    TriMesh mesh;
    const double waves = static_cast<double>(1 + random.below(3)), phase = random.unit(), twist = random.unit();
    for (size_t i = 0; i < o.rings; ++i) {
        const double along = 2 * PI * (static_cast<double>(i) / static_cast<double>(o.rings));
        const double own = random.unit();
        const double depth = o.smooth ? 0.5 - 0.5 * std::cos(waves * along + 2 * PI * phase) : own;
        const double r = o.radius * std::exp(-o.variation * depth);
        for (size_t j = 0; j < o.corners; ++j) {
            const double jitter = 0.2 * random.unit();
            const double a = 2 * PI * ((static_cast<double>(j) + jitter + twist) / static_cast<double>(o.corners));
            const double ring = 3 + r * std::cos(a);
            add_point(mesh, ring * std::cos(along), ring * std::sin(along), r * std::sin(a));
        }
    }
    const auto at = [&](size_t i, size_t j) {
        return static_cast<uint32_t>((i % o.rings) * o.corners + j % o.corners);
    };
    for (size_t i = 0; i < bands; ++i)
        for (size_t j = 0; j < o.corners; ++j)
            add_cell(mesh, at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1), random.below(2) == 0);
    return mesh;
}

} // namespace

TubeOptions random_tube(Random& random) {
    TubeOptions o;
    o.rings = 3 + random.below(22);
    o.corners = 3 + random.below(6);
    o.radius = 0.1 + 0.9 * random.unit();
    o.variation = 6 * random.unit();
    o.smooth = random.below(2) == 0;
    o.seed = random.bits();
    return o;
}

TriMesh closed_tube(const TubeOptions& o) {
    TriMesh mesh = tube(o, o.rings);
    mesh.genus = 1;
    return mesh;
}

TriMesh open_tube(const TubeOptions& o) { return tube(o, o.rings - 1); }

TriMesh capped_tube(const TubeOptions& o) {
    TriMesh mesh = tube(o, o.rings - 1);
    const auto cap = [&](size_t ring, bool first) {
        double middle[3] = {0, 0, 0};
        for (size_t j = 0; j < o.corners; ++j)
            for (size_t x = 0; x < 3; ++x)
                middle[x] += mesh.positions[3 * (ring * o.corners + j) + x] / static_cast<double>(o.corners);
        const uint32_t tip = add_point(mesh, middle[0], middle[1], middle[2]);
        for (size_t j = 0; j < o.corners; ++j) {
            const auto a = static_cast<uint32_t>(ring * o.corners + j);
            const auto b = static_cast<uint32_t>(ring * o.corners + (j + 1) % o.corners);
            if (first) add_triangle(mesh, tip, a, b);
            else add_triangle(mesh, tip, b, a);
        }
    };
    cap(0, true);
    cap(o.rings - 1, false);
    return mesh;
}

bool add_handle(TriMesh& mesh, size_t rings, double waist, Random& random) {
    const auto corners = [&](size_t t) { return &mesh.triangles[3 * t]; };
    for (size_t tries = 0; tries < 100; ++tries) {
        const size_t s = random.below(mesh.triangle_count()), t = random.below(mesh.triangle_count());
        bool apart = true;
        for (size_t i = 0; i < 9; ++i) apart = apart && corners(s)[i / 3] != corners(t)[i % 3];
        if (!apart) continue;
        const uint32_t first[3] = {corners(s)[0], corners(s)[1], corners(s)[2]};
        const uint32_t last[3] = {corners(t)[0], corners(t)[2], corners(t)[1]};
        for (const size_t gone : {std::max(s, t), std::min(s, t)})
            mesh.triangles.erase(mesh.triangles.begin() + static_cast<ptrdiff_t>(3 * gone),
                                 mesh.triangles.begin() + static_cast<ptrdiff_t>(3 * gone + 3));
        uint32_t lower[3] = {first[0], first[1], first[2]};
        for (size_t k = 1; k <= rings + 1; ++k) {
            uint32_t upper[3] = {last[0], last[1], last[2]};
            if (k <= rings) {
                const double q = static_cast<double>(k) / static_cast<double>(rings + 1);
                double middle[3] = {0, 0, 0}, p[3][3];
                for (size_t j = 0; j < 3; ++j)
                    for (size_t x = 0; x < 3; ++x) {
                        p[j][x] = (1 - q) * mesh.positions[3 * first[j] + x] + q * mesh.positions[3 * last[j] + x];
                        middle[x] += p[j][x] / 3;
                    }
                const double shrink = 1 - (1 - waist) * std::sin(PI * q);
                for (size_t j = 0; j < 3; ++j) {
                    double at[3];
                    for (size_t x = 0; x < 3; ++x) at[x] = middle[x] + shrink * (p[j][x] - middle[x]);
                    upper[j] = add_point(mesh, at[0], at[1], at[2]);
                }
            }
            for (size_t j = 0; j < 3; ++j) {
                const uint32_t a = lower[j], b = lower[(j + 1) % 3], c = upper[j], d = upper[(j + 1) % 3];
                add_triangle(mesh, a, b, c);
                add_triangle(mesh, b, d, c);
            }
            std::copy(upper, upper + 3, lower);
        }
        ++mesh.genus;
        return true;
    }
    return false;
}

} // namespace test
