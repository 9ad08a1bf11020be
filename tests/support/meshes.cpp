#include "meshes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace test {

namespace {

struct Vec {
    double x, y, z;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Vec a) { return std::sqrt(dot(a, a)); }
Vec unit(Vec a) { return (1 / length(a)) * a; }

Vec at(const TriMesh& mesh, uint32_t v) {
    return {mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
}

uint32_t add_vertex(TriMesh& mesh, Vec p) {
    mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
    return static_cast<uint32_t>(mesh.vertex_count() - 1);
}

uint64_t key(uint32_t a, uint32_t b) { return static_cast<uint64_t>(a) << 32 | b; }

// Directed edge -> triangle.
using EdgeMap = std::unordered_map<uint64_t, uint32_t>;

EdgeMap edge_map(const TriMesh& mesh) {
    EdgeMap map;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        for (uint32_t s = 0; s < 3; ++s) map[key(mesh.triangles[3 * t + s], mesh.triangles[3 * t + (s + 1) % 3])] = t;
    return map;
}

// The link of v, counter-clockwise from outside.
std::vector<uint32_t> link(const TriMesh& mesh, uint32_t v) {
    std::map<uint32_t, uint32_t> after;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        for (uint32_t s = 0; s < 3; ++s)
            if (mesh.triangles[3 * t + s] == v)
                after[mesh.triangles[3 * t + (s + 1) % 3]] = mesh.triangles[3 * t + (s + 2) % 3];
    std::vector<uint32_t> cycle;
    uint32_t u = after.begin()->first;
    do {
        cycle.push_back(u);
        u = after[u];
    } while (u != cycle.front());
    return cycle;
}

void remove_star(TriMesh& mesh, uint32_t v) {
    std::vector<uint32_t> kept;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* c = &mesh.triangles[3 * t];
        if (c[0] != v && c[1] != v && c[2] != v) kept.insert(kept.end(), c, c + 3);
    }
    mesh.triangles = kept;
}

void remove_unused_vertices(TriMesh& mesh) {
    std::vector<uint32_t> number(mesh.vertex_count(), UINT32_MAX);
    for (uint32_t v : mesh.triangles) number[v] = 0;
    std::vector<double> positions;
    uint32_t n = 0;
    for (uint32_t v = 0; v < mesh.vertex_count(); ++v)
        if (number[v] == 0) {
            number[v] = n++;
            positions.insert(positions.end(), &mesh.positions[3 * v], &mesh.positions[3 * v] + 3);
        }
    for (uint32_t& v : mesh.triangles) v = number[v];
    mesh.positions = positions;
}

// A band between two rings; lower runs as the boundary of the hole that it fills.
void add_band(TriMesh& mesh, const std::vector<uint32_t>& lower, const std::vector<uint32_t>& upper) {
    const size_t k = lower.size();
    for (size_t i = 0; i < k; ++i) {
        const size_t j = (i + 1) % k;
        add_triangle(mesh, lower[i], lower[j], upper[j]);
        add_triangle(mesh, lower[i], upper[j], upper[i]);
    }
}

Vec center(const TriMesh& mesh, const std::vector<uint32_t>& ring) {
    Vec c{0, 0, 0};
    for (uint32_t v : ring) c = c + at(mesh, v);
    return (1 / static_cast<double>(ring.size())) * c;
}

TriMesh grid_torus(size_t n, size_t m, const TorusOptions& options, const std::function<Vec(double, double)>& point) {
    TriMesh mesh;
    mesh.genus = 1;
    Random random(options.seed);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const double du = options.jitter * (random.unit() - 0.5), dv = options.jitter * (random.unit() - 0.5);
            Vec p = point((static_cast<double>(i) + du) / static_cast<double>(n),
                          (static_cast<double>(j) + dv) / static_cast<double>(m));
            p.x *= options.stretch;
            add_vertex(mesh, p);
        }
    const auto id = [&](size_t i, size_t j) { return static_cast<uint32_t>((i % n) * m + j % m); };
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const uint32_t a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
            if (options.random_diagonals && random.below(2)) {
                add_triangle(mesh, a, b, d);
                add_triangle(mesh, b, c, d);
            } else {
                add_triangle(mesh, a, b, c);
                add_triangle(mesh, a, c, d);
            }
        }
    return mesh;
}

} // namespace

uint64_t Random::bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double Random::unit() { return static_cast<double>(bits() >> 11) / 9007199254740992.0; }

std::string mesh_defect(const TriMesh& mesh) {
    const size_t n = mesh.vertex_count(), m = mesh.triangle_count();
    std::map<uint64_t, uint32_t> next; // (vertex, neighbor) -> next neighbor counter-clockwise
    std::vector<uint32_t> degree(n, 0), any(n, UINT32_MAX);
    for (size_t t = 0; t < m; ++t)
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t a = mesh.triangles[3 * t + s], b = mesh.triangles[3 * t + (s + 1) % 3],
                           c = mesh.triangles[3 * t + (s + 2) % 3];
            if (a >= n || a == b) return "bad index in triangle " + std::to_string(t);
            if (!next.emplace(key(a, b), c).second) return "directed edge used twice in triangle " + std::to_string(t);
            ++degree[a];
            any[a] = b;
        }
    for (const auto& entry : next)
        if (!next.count(entry.first << 32 | entry.first >> 32)) return "boundary edge";
    for (uint32_t v = 0; v < n; ++v) {
        if (any[v] == UINT32_MAX) return "unused vertex " + std::to_string(v);
        size_t turn = 0;
        uint32_t u = any[v];
        do {
            u = next[key(v, u)];
            ++turn;
        } while (u != any[v] && turn <= degree[v]);
        if (turn != degree[v]) return "several fans at vertex " + std::to_string(v);
    }
    std::vector<bool> seen(n, false);
    std::vector<uint32_t> stack{0};
    seen[0] = true;
    size_t reached = 0;
    while (!stack.empty()) {
        const uint32_t v = stack.back();
        stack.pop_back();
        ++reached;
        uint32_t u = any[v];
        do {
            if (!seen[u]) {
                seen[u] = true;
                stack.push_back(u);
            }
            u = next[key(v, u)];
        } while (u != any[v]);
    }
    if (reached != n) return "several components";
    const long chi = static_cast<long>(n) - static_cast<long>(next.size() / 2) + static_cast<long>(m);
    if (chi != 2 - 2 * static_cast<long>(mesh.genus)) return "Euler characteristic " + std::to_string(chi);
    return "";
}

TriMesh torus(size_t n, size_t m, double R, double r, const TorusOptions& options) {
    return grid_torus(n, m, options, [&](double u, double v) {
        const double ring = R + r * std::cos(2 * PI * v);
        return Vec{ring * std::cos(2 * PI * u), ring * std::sin(2 * PI * u), r * std::sin(2 * PI * v)};
    });
}

TriMesh trefoil(size_t n, size_t m, double radius) {
    // The (2, 3) torus knot; the normal of its torus closes up after one turn
    // and serves as frame.
    const auto curve = [](double u) {
        const double p = 4 * PI * u, q = 6 * PI * u, ring = 2 + std::cos(q);
        return Vec{ring * std::cos(p), ring * std::sin(p), std::sin(q)};
    };
    return grid_torus(n, m, {}, [&](double u, double v) {
        const double p = 4 * PI * u, q = 6 * PI * u;
        const Vec normal{std::cos(q) * std::cos(p), std::cos(q) * std::sin(p), std::sin(q)};
        const Vec tangent = unit(curve(u + 1e-5) - curve(u - 1e-5));
        const Vec side = unit(cross(tangent, normal));
        return curve(u) + (radius * std::cos(2 * PI * v)) * unit(cross(side, tangent))
             + (-radius * std::sin(2 * PI * v)) * side;
    });
}

TriMesh voxel_surface(const std::vector<double>& xs, const std::vector<double>& ys, const std::vector<double>& zs,
                      const std::function<bool(size_t, size_t, size_t)>& filled) {
    const size_t size[3] = {xs.size() - 1, ys.size() - 1, zs.size() - 1};
    TriMesh mesh;
    std::map<std::array<size_t, 3>, uint32_t> number;
    const auto vertex = [&](std::array<size_t, 3> p) {
        const auto found = number.find(p);
        if (found != number.end()) return found->second;
        return number[p] = add_vertex(mesh, {xs[p[0]], ys[p[1]], zs[p[2]]});
    };
    const auto is_filled = [&](std::array<size_t, 3> c, size_t axis, int step) {
        if (step < 0 && c[axis] == 0) return false;
        c[axis] = step < 0 ? c[axis] - 1 : c[axis] + 1;
        return c[axis] < size[axis] && filled(c[0], c[1], c[2]);
    };
    for (size_t i = 0; i < size[0]; ++i)
        for (size_t j = 0; j < size[1]; ++j)
            for (size_t k = 0; k < size[2]; ++k) {
                if (!filled(i, j, k)) continue;
                for (size_t axis = 0; axis < 3; ++axis)
                    for (int step = -1; step <= 1; step += 2) {
                        const std::array<size_t, 3> cell{i, j, k};
                        if (is_filled(cell, axis, step)) continue;
                        const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
                        std::array<size_t, 3> p[4] = {cell, cell, cell, cell};
                        for (auto& q : p)
                            if (step > 0) ++q[axis];
                        ++p[1][u];
                        ++p[2][u];
                        ++p[2][v];
                        ++p[3][v];
                        if (step < 0) std::swap(p[1], p[3]);
                        const uint32_t a = vertex(p[0]), b = vertex(p[1]), c = vertex(p[2]), d = vertex(p[3]);
                        add_triangle(mesh, a, b, c);
                        add_triangle(mesh, a, c, d);
                    }
            }
    return mesh;
}

namespace {

TriMesh holed_plate(size_t holes, const std::vector<double>& xs, const std::vector<double>& ys,
                    const std::vector<double>& zs) {
    TriMesh mesh = voxel_surface(xs, ys, zs, [](size_t i, size_t j, size_t) { return !(j == 1 && i % 2 == 1); });
    mesh.genus = holes;
    return mesh;
}

} // namespace

TriMesh plate(size_t holes) {
    std::vector<double> xs;
    for (size_t i = 0; i <= 2 * holes + 1; ++i) xs.push_back(static_cast<double>(i));
    return holed_plate(holes, xs, {0, 1, 2, 3}, {0, 1});
}

void flatten(TriMesh& mesh, size_t triangle, bool up_to_rounding) {
    const uint32_t* const corner = &mesh.triangles[3 * triangle];
    for (size_t c = 0; c < 3; ++c) {
        double& x = mesh.positions[3 * corner[0] + c];
        x = 0.5 * (mesh.positions[3 * corner[1] + c] + mesh.positions[3 * corner[2] + c]);
        if (up_to_rounding) x = std::nextafter(x, c == 1 ? -9 : 9);
    }
}

TriMesh thin_plate(size_t holes, double aspect) {
    std::vector<double> xs{0};
    for (size_t i = 0; i <= 2 * holes; ++i) xs.push_back(xs.back() + (i % 2 ? 1 : 1 / aspect));
    return holed_plate(holes, xs, {0, 1 / aspect, 1, 1 + 1 / aspect}, {0, 0.05});
}

TriMesh pretzel(size_t holes, size_t refinements, size_t smoothings) {
    TriMesh mesh = plate(holes);
    for (size_t i = 0; i < refinements; ++i) mesh = subdivide(mesh);
    return smooth(mesh, smoothings);
}

TriMesh torus_with_finger(size_t n, size_t m, size_t rings, double finger) {
    TriMesh mesh = torus(n, m, 2, 1);
    const uint32_t tip = 0; // at (3, 0, 0)
    const std::vector<uint32_t> base = link(mesh, tip);
    remove_star(mesh, tip);
    const Vec middle = center(mesh, base);
    std::vector<uint32_t> lower = base;
    for (size_t l = 1; l <= rings; ++l) {
        std::vector<uint32_t> upper;
        const Vec shift{finger * static_cast<double>(l) / static_cast<double>(rings), 0, 0};
        for (uint32_t v : base) upper.push_back(add_vertex(mesh, middle + shift + 0.8 * (at(mesh, v) - middle)));
        add_band(mesh, lower, upper);
        lower = upper;
    }
    const Vec end = center(mesh, lower);
    mesh.positions[0] = end.x + finger / static_cast<double>(rings);
    mesh.positions[1] = end.y;
    mesh.positions[2] = end.z;
    for (size_t i = 0; i < lower.size(); ++i) add_triangle(mesh, lower[i], lower[(i + 1) % lower.size()], tip);
    return mesh;
}

TriMesh joined_tori(size_t n, size_t m, double distance, size_t rings) {
    TriMesh mesh = torus(n, m, 2, 1);
    const uint32_t offset = static_cast<uint32_t>(mesh.vertex_count());
    const TriMesh other = torus(n, m, 2, 1);
    // Half a turn about the z axis, so that vertex 0 faces the first torus.
    for (uint32_t v = 0; v < other.vertex_count(); ++v) {
        const Vec p = at(other, v);
        add_vertex(mesh, {distance - p.x, -p.y, p.z});
    }
    for (uint32_t v : other.triangles) mesh.triangles.push_back(v + offset);
    const std::vector<uint32_t> first = link(mesh, 0);
    std::vector<uint32_t> last = link(mesh, offset);
    remove_star(mesh, 0);
    remove_star(mesh, offset);
    std::reverse(last.begin(), last.end());
    double best = HUGE_VAL;
    std::vector<uint32_t> aligned = last;
    for (size_t k = 0; k < last.size(); ++k) {
        std::rotate(last.begin(), last.begin() + 1, last.end());
        double sum = 0;
        for (size_t i = 0; i < last.size(); ++i) sum += length(at(mesh, first[i]) - at(mesh, last[i]));
        if (sum < best) {
            best = sum;
            aligned = last;
        }
    }
    std::vector<uint32_t> lower = first;
    for (size_t l = 1; l <= rings; ++l) {
        const double s = static_cast<double>(l) / static_cast<double>(rings + 1);
        std::vector<uint32_t> upper;
        for (size_t i = 0; i < first.size(); ++i)
            upper.push_back(add_vertex(mesh, (1 - s) * at(mesh, first[i]) + s * at(mesh, aligned[i])));
        add_band(mesh, lower, upper);
        lower = upper;
    }
    add_band(mesh, lower, aligned);
    remove_unused_vertices(mesh);
    mesh.genus = 2;
    return mesh;
}

TriMesh subdivide(const TriMesh& mesh) {
    TriMesh fine;
    fine.genus = mesh.genus;
    fine.positions = mesh.positions;
    EdgeMap middle;
    const auto between = [&](uint32_t a, uint32_t b) {
        const uint64_t name = key(std::min(a, b), std::max(a, b));
        const auto found = middle.find(name);
        if (found != middle.end()) return found->second;
        return middle[name] = add_vertex(fine, 0.5 * (at(mesh, a) + at(mesh, b)));
    };
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t a = mesh.triangles[3 * t], b = mesh.triangles[3 * t + 1], c = mesh.triangles[3 * t + 2];
        const uint32_t ab = between(a, b), bc = between(b, c), ca = between(c, a);
        add_triangle(fine, a, ab, ca);
        add_triangle(fine, ab, b, bc);
        add_triangle(fine, ca, bc, c);
        add_triangle(fine, ab, bc, ca);
    }
    return fine;
}

TriMesh smooth(const TriMesh& mesh, size_t rounds) {
    TriMesh result = mesh;
    for (size_t round = 0; round < rounds; ++round) {
        std::vector<double> sum(mesh.positions.size(), 0);
        std::vector<double> count(mesh.vertex_count(), 0);
        for (size_t t = 0; t < mesh.triangle_count(); ++t)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t a = mesh.triangles[3 * t + s], b = mesh.triangles[3 * t + (s + 1) % 3];
                for (size_t x = 0; x < 3; ++x) sum[3 * a + x] += result.positions[3 * b + x];
                ++count[a];
            }
        for (size_t v = 0; v < mesh.vertex_count(); ++v)
            for (size_t x = 0; x < 3; ++x)
                result.positions[3 * v + x] = 0.5 * result.positions[3 * v + x] + 0.5 * sum[3 * v + x] / count[v];
    }
    return result;
}

TriMesh uneven(TriMesh mesh) {
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        double* const p = &mesh.positions[3 * v];
        p[1] *= 1 + 0.05 * p[0] + 0.03 * p[1];
        p[2] *= 1 + 0.04 * p[0];
    }
    return mesh;
}

TriMesh scaled(const TriMesh& mesh, double factor) {
    TriMesh result = mesh;
    for (double& x : result.positions) x *= factor;
    return result;
}

Matrix rotation(double axis_x, double axis_y, double axis_z, double angle) {
    const Vec a = unit({axis_x, axis_y, axis_z});
    const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
    return {c + d * a.x * a.x,       d * a.x * a.y - s * a.z, d * a.x * a.z + s * a.y,
            d * a.y * a.x + s * a.z, c + d * a.y * a.y,       d * a.y * a.z - s * a.x,
            d * a.z * a.x - s * a.y, d * a.z * a.y + s * a.x, c + d * a.z * a.z};
}

Matrix random_rotation(Random& random) {
    const double angle = 6.3 * random.unit(), axis_y = random.unit();
    return rotation(random.unit(), axis_y, 1, angle);
}

TriMesh transformed(const TriMesh& mesh, const Matrix& r) {
    TriMesh result = mesh;
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        for (size_t x = 0; x < 3; ++x)
            result.positions[3 * v + x] = r[3 * x] * mesh.positions[3 * v] + r[3 * x + 1] * mesh.positions[3 * v + 1]
                                        + r[3 * x + 2] * mesh.positions[3 * v + 2];
    return result;
}

TriMesh with_bad_triangles(const TriMesh& mesh, size_t count, double degrees, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    const double slope = std::tan(degrees * PI / 180);
    std::vector<bool> used(mesh.triangle_count(), false);
    for (size_t i = 0; i < count; ++i) {
        const size_t t = random.below(mesh.triangle_count());
        if (used[t]) continue;
        used[t] = true;
        const uint32_t a = result.triangles[3 * t], b = result.triangles[3 * t + 1], c = result.triangles[3 * t + 2];
        const Vec pa = at(result, a), pb = at(result, b), pc = at(result, c);
        Vec p;
        if (i % 2 == 0) { // cap: height slope * |ab| / 2 above the middle of ab
            const Vec ab = pb - pa, ac = pc - pa;
            const Vec up = ac - (dot(ac, ab) / dot(ab, ab)) * ab;
            p = 0.5 * (pa + pb) + (0.5 * slope * length(ab) / length(up)) * up;
        } else { // needle: close to a, seen from b and c under a small angle
            p = pa + slope * (0.5 * (pb + pc) - pa);
        }
        const uint32_t v = add_vertex(result, p);
        result.triangles[3 * t + 2] = v;
        add_triangle(result, b, c, v);
        add_triangle(result, c, a, v);
    }
    return result;
}

TriMesh with_random_flips(const TriMesh& mesh, size_t attempts, double min_cosine, uint64_t seed) {
    TriMesh result = mesh;
    EdgeMap map = edge_map(result);
    Random random(seed);
    for (size_t i = 0; i < attempts; ++i) {
        const uint32_t t = static_cast<uint32_t>(random.below(result.triangle_count()));
        const size_t s = random.below(3);
        const uint32_t a = result.triangles[3 * t + s], b = result.triangles[3 * t + (s + 1) % 3],
                       c = result.triangles[3 * t + (s + 2) % 3];
        const uint32_t u = map[key(b, a)];
        uint32_t d = a;
        for (size_t x = 0; x < 3; ++x)
            if (result.triangles[3 * u + x] != a && result.triangles[3 * u + x] != b) d = result.triangles[3 * u + x];
        if (c == d || map.count(key(c, d)) || map.count(key(d, c))) continue;
        const auto normal = [&](uint32_t x, uint32_t y, uint32_t z) {
            return cross(at(result, y) - at(result, x), at(result, z) - at(result, x));
        };
        // (a b c) and (b a d) become (c d b) and (d c a).
        const Vec before[2] = {normal(a, b, c), normal(b, a, d)}, after[2] = {normal(c, d, b), normal(d, c, a)};
        const double area = length(before[0]) + length(before[1]);
        bool good = true;
        for (const Vec& n : before)
            for (const Vec& o : after) good = good && length(o) > 1e-3 * area && dot(unit(n), unit(o)) >= min_cosine;
        if (!good || dot(unit(before[0]), unit(before[1])) < min_cosine) continue;
        map.erase(key(a, b));
        map.erase(key(b, a));
        const uint32_t first[3] = {c, d, b}, second[3] = {d, c, a};
        std::copy(first, first + 3, &result.triangles[3 * t]);
        std::copy(second, second + 3, &result.triangles[3 * u]);
        for (uint32_t x : {t, u})
            for (uint32_t y = 0; y < 3; ++y)
                map[key(result.triangles[3 * x + y], result.triangles[3 * x + (y + 1) % 3])] = x;
    }
    return result;
}

TriMesh with_delaunay_flips(const TriMesh& mesh, double floor, size_t rounds) {
    TriMesh result = mesh;
    EdgeMap map = edge_map(result);
    const auto cotangent = [&](uint32_t apex, uint32_t a, uint32_t b) {
        const Vec u = at(result, a) - at(result, apex), v = at(result, b) - at(result, apex);
        return dot(u, v) / length(cross(u, v));
    };
    bool changed = true;
    for (size_t round = 0; round < rounds && changed; ++round) {
        changed = false;
        for (uint32_t t = 0; t < result.triangle_count(); ++t)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t a = result.triangles[3 * t + s], b = result.triangles[3 * t + (s + 1) % 3],
                               c = result.triangles[3 * t + (s + 2) % 3];
                const uint32_t u = map[key(b, a)];
                uint32_t d = a;
                for (size_t x = 0; x < 3; ++x)
                    if (result.triangles[3 * u + x] != a && result.triangles[3 * u + x] != b)
                        d = result.triangles[3 * u + x];
                if (0.5 * (cotangent(c, a, b) + cotangent(d, a, b)) >= floor || c == d || map.count(key(c, d)))
                    continue;
                map.erase(key(a, b));
                map.erase(key(b, a));
                const uint32_t first[3] = {c, d, b}, second[3] = {d, c, a};
                std::copy(first, first + 3, &result.triangles[3 * t]);
                std::copy(second, second + 3, &result.triangles[3 * u]);
                for (uint32_t x : {t, u})
                    for (uint32_t y = 0; y < 3; ++y)
                        map[key(result.triangles[3 * x + y], result.triangles[3 * x + (y + 1) % 3])] = x;
                changed = true;
                break;
            }
    }
    return result;
}

} // namespace test
