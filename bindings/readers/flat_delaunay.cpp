#include "flat_delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace readers {

namespace {

constexpr double FLAT = 1e-9;     // of the size of the mesh: how far a flip may move the surface
constexpr double ROUNDING = 1e-9; // of a sum of two cotangents, per unit of their size
constexpr size_t FLIPS_EACH = 64; // for each triangle, so that the time is bounded

using Vector = std::array<double, 3>;
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

class FlatFlips {
public:
    explicit FlatFlips(TriangleMesh& mesh) : mesh_(mesh), tolerance_(FLAT * size_of(mesh)) {
        for (uint32_t side = 0; side < mesh.triangles.size(); ++side) {
            const auto [place, is_new] = sides_.try_emplace(key(side), side);
            if (!is_new) place->second = NONE; // two triangles pass it in one direction
        }
    }

    size_t run() {
        std::vector<uint32_t> waiting;
        for (uint32_t side = 0; side < mesh_.triangles.size(); ++side) waiting.push_back(side);
        size_t flips = 0;
        const size_t most = FLIPS_EACH * mesh_.triangle_count();
        while (!waiting.empty() && flips < most) {
            const uint32_t side = waiting.back();
            waiting.pop_back();
            const uint32_t other = opposite(side);
            if (other == NONE || !should_flip(side, other)) continue;
            flip(side, other);
            ++flips;
            for (const uint32_t t : {side / 3, other / 3})
                for (uint32_t s = 0; s < 3; ++s) waiting.push_back(3 * t + s);
        }
        return flips;
    }

private:
    static double size_of(const TriangleMesh& mesh) {
        double square = 0;
        for (size_t k = 0; k < 3 && !mesh.positions.empty(); ++k) {
            double low = mesh.positions[k], high = low;
            for (size_t i = k; i < mesh.positions.size(); i += 3) {
                low = std::min(low, mesh.positions[i]);
                high = std::max(high, mesh.positions[i]);
            }
            square += (high - low) * (high - low);
        }
        return std::sqrt(square);
    }
    static uint64_t key(uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; }
    uint32_t start(uint32_t side) const { return mesh_.triangles[side]; }
    uint32_t end(uint32_t side) const { return mesh_.triangles[next(side)]; }
    uint32_t apex(uint32_t side) const { return mesh_.triangles[next(next(side))]; }
    static uint32_t next(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
    uint64_t key(uint32_t side) const { return key(start(side), end(side)); }
    bool has(uint32_t from, uint32_t to) const { return sides_.count(key(from, to)) > 0; }
    Vector at(uint32_t v) const {
        return {mesh_.positions[3 * size_t{v}], mesh_.positions[3 * size_t{v} + 1], mesh_.positions[3 * size_t{v} + 2]};
    }

    // The side of the one triangle beyond; NONE at a boundary and where more than two triangles meet.
    uint32_t opposite(uint32_t side) const {
        const auto own = sides_.find(key(side)), beyond = sides_.find(key(end(side), start(side)));
        if (own == sides_.end() || own->second != side || beyond == sides_.end()) return NONE;
        return beyond->second;
    }

    bool should_flip(uint32_t side, uint32_t other) const {
        const uint32_t c = apex(side), d = apex(other);
        if (c == d || has(c, d) || has(d, c)) return false;
        const Vector a = at(start(side)), ab = at(end(side)) - a, ac = at(c) - a, ad = at(d) - a, cd = at(d) - at(c);
        const Vector across = cross(ab, cd);
        const double width = std::sqrt(dot(across, across));
        // The surface moves by the distance of the two diagonals.
        if (!(std::abs(dot(across, ac)) <= tolerance_ * width)) return false;
        const Vector up = cross(ab, ac), down = cross(ad, ab);
        if (dot(up, down) <= 0) return false; // folded, or a triangle without area
        const Vector bc = ac - ab, bd = ad - ab;
        // Both new triangles look the same way as the old ones: the quadrilateral is convex.
        if (dot(cross(cd, bd), up) >= 0 || dot(cross(ac, cd), up) >= 0) return false;
        const double at_c = dot(ac, bc) / std::sqrt(dot(up, up)), at_d = dot(ad, bd) / std::sqrt(dot(down, down));
        return at_c + at_d < -ROUNDING * (1 + std::abs(at_c) + std::abs(at_d));
    }

    // a b c and b a d become c a d and d b c.
    void flip(uint32_t side, uint32_t other) {
        const uint32_t a = start(side), b = end(side), c = apex(side), d = apex(other);
        for (const uint32_t t : {side / 3, other / 3})
            for (uint32_t s = 3 * t; s < 3 * t + 3; ++s) {
                const auto place = sides_.find(key(s));
                if (place->second == s) sides_.erase(place);
            }
        write(side / 3, {c, a, d});
        write(other / 3, {d, b, c});
    }
    void write(uint32_t t, const std::array<uint32_t, 3>& corners) {
        std::copy(corners.begin(), corners.end(), mesh_.triangles.begin() + 3 * std::ptrdiff_t{t});
        for (uint32_t s = 3 * t; s < 3 * t + 3; ++s) sides_.try_emplace(key(s), s);
    }

    TriangleMesh& mesh_;
    const double tolerance_;
    std::unordered_map<uint64_t, uint32_t> sides_; // by start and end; NONE where several triangles have it
};

} // namespace

size_t make_flat_parts_delaunay(TriangleMesh& mesh) { return mesh.triangles.empty() ? 0 : FlatFlips(mesh).run(); }

} // namespace readers
