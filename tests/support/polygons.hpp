// Polygons in a plane, and files with one of them as a face.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "mesh_files.hpp"

namespace test {

using Plane = std::vector<std::array<double, 2>>;

// One face with these corners: turns it in space by a rotation with exact small numbers, or leaves it in a plane.
inline TriangleMesh read_face(const Plane& p, int turned) {
    std::string obj, face = "f";
    for (size_t i = 0; i < p.size(); ++i) {
        const double x = p[i][0], y = p[i][1];
        const double places[4][3] = {
            {x, y, 0}, {y, x, 5}, {(2 * x - y) / 3, (2 * x + 2 * y) / 3, (2 * y - x) / 3}, {-7, x, y}};
        obj += "v " + point_text(places[turned]) + "\n";
        face += " " + std::to_string(i + 1);
    }
    return read_mesh(obj + face + "\n", Format::obj);
}

inline Plane regular(size_t n, double radius = 1) {
    Plane p;
    for (size_t i = 0; i < n; ++i) {
        const double a = 2 * 3.141592653589793 * double(i) / double(n);
        p.push_back({radius * std::cos(a), radius * std::sin(a)});
    }
    return p;
}

inline Plane star(size_t n, test::Random& random) {
    Plane p = regular(n);
    for (auto& [x, y] : p) {
        const double r = 0.05 + double(random.bits() % 1000) / 1000;
        x *= r;
        y *= r;
    }
    return p;
}

inline Plane comb(size_t teeth) {
    Plane p = {{double(teeth), 0}};
    for (size_t i = teeth; i-- > 0;) {
        p.push_back({double(i) + 0.75, 10});
        p.push_back({double(i) + 0.25, 1});
    }
    p.push_back({0, 0});
    return p;
}

// A band that winds inwards.
inline Plane spiral(size_t n) {
    Plane outside, p;
    for (size_t i = 0; i < n; ++i) {
        const double a = 0.3 * double(i), r = 2 + 0.1 * a;
        outside.push_back({r * std::cos(a), r * std::sin(a)});
        p.push_back({(r - 0.3) * std::cos(a), (r - 0.3) * std::sin(a)});
    }
    std::reverse(p.begin(), p.end());
    p.insert(p.begin(), outside.begin(), outside.end());
    return p;
}

// Corners between, exactly on the sides: their halves, quarters, ... are exact on a grid.
inline Plane with_flat_corners(const Plane& p, int halvings) {
    Plane all = p;
    for (; halvings > 0; --halvings) {
        Plane finer;
        for (size_t i = 0; i < all.size(); ++i) {
            const auto &a = all[i], &b = all[(i + 1) % all.size()];
            finer.push_back(a);
            finer.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2});
        }
        all = finer;
    }
    return all;
}

} // namespace test
