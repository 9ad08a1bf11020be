#include "surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

namespace test {

namespace {

hmf_hierarchy_options build_options(double ratio, uint64_t coarsest, int32_t collapse) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.ratio = ratio;
    options.coarsest = coarsest;
    options.collapse = collapse;
    return options;
}

// The two (triangle, side) of each edge, as 3 * triangle + side.
std::vector<uint32_t> edge_sides(const LevelMesh& mesh) {
    std::vector<uint32_t> sides(2 * mesh.edge_count, UINT32_MAX);
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; ++c) {
        const uint32_t e = mesh.triangle_edges[c];
        sides[2 * e + (sides[2 * e] != UINT32_MAX)] = c;
    }
    return sides;
}

uint32_t next_side(uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }
uint32_t previous_side(uint32_t c) { return c % 3 == 0 ? c + 2 : c - 1; }

// Twice the corner coordinate of corner c: between side c and the one before.
double corner2(const LevelMesh& mesh, const std::vector<double>& values, uint32_t c) {
    return values[mesh.triangle_edges[c]] + values[mesh.triangle_edges[previous_side(c)]]
         - values[mesh.triangle_edges[next_side(c)]];
}

} // namespace

Hierarchy::Hierarchy(const TriMesh& mesh, double ratio, uint64_t coarsest, int32_t collapse) :
    Hierarchy(mesh, build_options(ratio, coarsest, collapse)) {}

Hierarchy::Hierarchy(const TriMesh& mesh, const hmf_hierarchy_options& options) {
    hmf_error error{};
    const hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                   mesh.triangle_count(), &options, nullptr, &handle_, &error);
    EXPECT_EQ(status, HMF_OK) << error.message;
    if (handle_) { EXPECT_EQ(hmf_hierarchy_describe(handle_)->genus, mesh.genus); }
}

size_t Hierarchy::edges(size_t level) const { return hmf_hierarchy_describe(handle_)->levels[level].edge_count; }

LevelMesh read_level(const Hierarchy& hierarchy, size_t level) {
    LevelMesh mesh;
    const auto made = make<hmf_level_mesh>(
        [&](hmf_level_mesh** out, hmf_error* error) { return hmf_level(hierarchy.get(), level, nullptr, out, error); });
    mesh.level = level;
    mesh.vertex_count = made->vertex_count;
    mesh.edge_count = made->edge_count;
    mesh.triangle_count = made->triangle_count;
    mesh.raised_count = hmf_hierarchy_describe(hierarchy.get())->levels[level].raised_count;
    mesh.edge_vertices.assign(made->edge_vertices, made->edge_vertices + 2 * mesh.edge_count);
    mesh.triangle_edges.assign(made->triangle_edges, made->triangle_edges + 3 * mesh.triangle_count);
    mesh.triangle_vertices.assign(made->triangle_vertices, made->triangle_vertices + 3 * mesh.triangle_count);
    mesh.weights.assign(made->weights, made->weights + mesh.edge_count);
    mesh.positions.assign(made->positions, made->positions + 3 * mesh.vertex_count);
    return mesh;
}

void Loops::add(const std::vector<uint32_t>& loop) {
    elements.insert(elements.end(), loop.begin(), loop.end());
    offsets.push_back(elements.size());
}

hmf_loop_set Loops::view() const {
    hmf_loop_set set{};
    set.struct_size = sizeof set;
    set.element_kind = kind;
    set.level = level;
    set.count = count();
    set.offsets = offsets.data();
    set.elements = elements.data();
    set.weights = weights.empty() ? nullptr : weights.data();
    return set;
}

hmf_status expect_ok(hmf_status status, const hmf_error& error) {
    EXPECT_EQ(status, HMF_OK) << error.message;
    return status;
}

Loops library_loops(const Hierarchy& hierarchy, size_t level, int32_t kind) {
    Loops loops;
    loops.level = level;
    const auto set = make<hmf_loop_set>([&](hmf_loop_set** out, hmf_error* error) {
        return hmf_loops(hierarchy.get(), level, kind, nullptr, out, error);
    });
    if (!set) return loops;
    EXPECT_GE(set->struct_size, sizeof(hmf_loop_set));
    EXPECT_EQ(set->element_kind, HMF_PATH_TRIANGLES);
    EXPECT_EQ(set->level, level);
    EXPECT_EQ(set->weights, nullptr);
    loops.offsets.assign(set->offsets, set->offsets + set->count + 1);
    loops.elements.assign(set->elements, set->elements + loops.offsets.back());
    return loops;
}

Owned<hmf_loop_set> loops_of(const Hierarchy& hierarchy, int32_t kind) {
    return make<hmf_loop_set>(
        [&](hmf_loop_set** out, hmf_error* e) { return hmf_loops(hierarchy.get(), 0, kind, nullptr, out, e); });
}

hmf_hierarchy_options with_marks(const std::vector<uint32_t>& marks, double ratio, uint64_t coarsest) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.ratio = ratio;
    options.coarsest = coarsest;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    return options;
}

std::vector<uint32_t> suggested_marks(const TriMesh& mesh) {
    const auto set = make<hmf_mark_set>([&](hmf_mark_set** out, hmf_error* e) {
        return hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), nullptr, nullptr, out, e);
    });
    return set ? std::vector<uint32_t>(set->marked_vertices, set->marked_vertices + set->marked_count)
               : std::vector<uint32_t>();
}

std::vector<double> values_of(const Foliation& foliation) {
    size_t count = 0;
    const double* values = hmf_foliation_values(foliation.get(), &count);
    return std::vector<double>(values, values + count);
}

Foliation create(const Hierarchy& hierarchy, size_t level, const std::vector<double>& values) {
    return make<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
        return hmf_foliation_from_values(hierarchy.get(), level, values.data(), values.size(), nullptr, out, error);
    });
}

Foliation initialize(const Hierarchy& hierarchy, const Loops& loops) {
    const hmf_loop_set set = loops.view();
    return make<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
        return hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, out, error);
    });
}

Foliation interpolate(const Foliation& foliation, size_t level) {
    return make<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
        return hmf_interpolate(foliation.get(), level, nullptr, out, error);
    });
}

double energy(const Foliation& foliation) {
    double result = -1;
    hmf_error error{};
    expect_ok(hmf_energy(foliation.get(), nullptr, &result, &error), error);
    return result;
}

std::vector<double> residuals(const Foliation& foliation, size_t vertex_count) {
    const auto made = make<hmf_residual_set>(
        [&](hmf_residual_set** out, hmf_error* error) { return hmf_residuals(foliation.get(), nullptr, out, error); });
    EXPECT_EQ(made->vertex_count, vertex_count);
    return {made->values, made->values + made->vertex_count};
}

Owned<hmf_singularity_set> singularities(const Foliation& foliation) {
    return make<hmf_singularity_set>([&](hmf_singularity_set** out, hmf_error* error) {
        return hmf_singularities(foliation.get(), nullptr, out, error);
    });
}

std::vector<uint32_t> section(const LevelMesh& mesh, const Field& field, const Field& region) {
    std::vector<bool> positive(mesh.vertex_count);
    for (size_t v = 0; v < mesh.vertex_count; ++v) positive[v] = field(&mesh.positions[3 * v]) > 0;
    const auto crossed = [&](uint32_t e) {
        return positive[mesh.edge_vertices[2 * e]] != positive[mesh.edge_vertices[2 * e + 1]];
    };
    const std::vector<uint32_t> sides = edge_sides(mesh);
    std::vector<bool> seen(mesh.triangle_count, false);
    std::vector<std::vector<uint32_t>> found;
    for (uint32_t start = 0; start < mesh.triangle_count; ++start) {
        if (seen[start]) continue;
        std::vector<uint32_t> loop;
        double middle[3] = {0, 0, 0};
        uint32_t t = start, entry = UINT32_MAX; // the edge through which t was entered
        while (!seen[t]) {
            uint32_t exit = UINT32_MAX;
            for (uint32_t c = 3 * t; c < 3 * t + 3 && exit == UINT32_MAX; ++c)
                if (crossed(mesh.triangle_edges[c]) && mesh.triangle_edges[c] != entry) exit = c;
            if (exit == UINT32_MAX) break;
            seen[t] = true;
            loop.push_back(t);
            for (size_t x = 0; x < 3; ++x) middle[x] += mesh.positions[3 * mesh.triangle_vertices[3 * t] + x];
            entry = mesh.triangle_edges[exit];
            t = (sides[2 * entry] == exit ? sides[2 * entry + 1] : sides[2 * entry]) / 3;
        }
        if (loop.empty()) continue;
        for (double& x : middle) x /= static_cast<double>(loop.size());
        if (region(middle) > 0) found.push_back(loop);
    }
    EXPECT_EQ(found.size(), 1u) << "the section is not one curve on level " << mesh.level;
    return found.empty() ? std::vector<uint32_t>() : found[0];
}

Loops bar_loops(const Hierarchy& hierarchy, size_t level, size_t holes, const std::function<double(size_t)>& hole_x) {
    const LevelMesh mesh = read_level(hierarchy, level);
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t v = 0; v < mesh.vertex_count; ++v) {
        low = std::min(low, mesh.positions[3 * v + 1]);
        high = std::max(high, mesh.positions[3 * v + 1]);
    }
    Loops loops;
    loops.level = level;
    for (size_t k = 0; k < holes; ++k) {
        const double x = hole_x(k), y = 0.5 * (low + high);
        loops.add(section(
            mesh, [x](const double* p) { return p[0] - x; }, [y](const double* p) { return p[1] - y; }));
    }
    return loops;
}

Loops plate_loops(const Hierarchy& hierarchy, size_t level, size_t holes) {
    return bar_loops(hierarchy, level, holes, [](size_t k) { return 2.0 * static_cast<double>(k) + 1.50137; });
}

Loops meridian(const Hierarchy& hierarchy, size_t level) {
    Loops loops;
    loops.level = level;
    loops.add(section(
        read_level(hierarchy, level), [](const double* p) { return p[1] - 0.00137; },
        [](const double* p) { return p[0]; }));
    return loops;
}

Indices count_indices(const LevelMesh& mesh, const std::vector<double>& values) {
    std::vector<uint32_t> root(mesh.vertex_count);
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (size_t e = 0; e < mesh.edge_count; ++e)
        if (values[e] == 0) root[find(mesh.edge_vertices[2 * e])] = find(mesh.edge_vertices[2 * e + 1]);
    std::vector<long> index(mesh.vertex_count, 0);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) index[find(v)] += 2;
    for (size_t e = 0; e < mesh.edge_count; ++e)
        if (values[e] == 0) index[find(mesh.edge_vertices[2 * e])] -= 2;
    Indices result;
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
        int zero_edges = 0, closed = 0;
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c) zero_edges += values[mesh.triangle_edges[c]] == 0;
        if (zero_edges == 3) index[find(mesh.triangle_vertices[3 * t])] += 2;
        if (zero_edges > 0) continue;
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            if (corner2(mesh, values, c) == 0) {
                ++closed;
                --index[find(mesh.triangle_vertices[c])];
            }
        if (closed == 0) {
            ++result.zeros;
            --result.sum;
        }
    }
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (root[v] != v) continue;
        result.sum += index[v];
        if (index[v] > 0) ++result.poles;
        if (index[v] < 0) result.zeros += static_cast<size_t>(-index[v]);
    }
    return result;
}

std::string closedness_defect(const LevelMesh& mesh, const std::vector<double>& values) {
    if (values.size() != mesh.edge_count) return "wrong number of values";
    double largest = 0, unit = HUGE_VAL;
    for (double x : values) {
        if (!(x >= 0) || !std::isfinite(x)) return "a value is negative or not finite";
        largest = std::max(largest, x);
        if (x == 0) continue;
        int exponent = 0;
        const double mantissa = std::frexp(x, &exponent);
        uint64_t bits = static_cast<uint64_t>(std::ldexp(mantissa, 53));
        while (!(bits & 1)) bits >>= 1, ++exponent;
        unit = std::min(unit, std::ldexp(1.0, exponent - 53));
    }
    if (largest == 0) return "all values are zero";
    if (largest / unit > 4503599627370496.0) return "the values do not fit 52 bits of a common unit";
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; ++c)
        if (corner2(mesh, values, c) < 0) return "triangle inequality broken in triangle " + std::to_string(c / 3);
    return "";
}

void expect_foliation(const LevelMesh& mesh, const Foliation& foliation) {
    ASSERT_TRUE(foliation);
    const std::vector<double> values = values_of(foliation);
    EXPECT_EQ(hmf_foliation_level(foliation.get()), mesh.level);
    ASSERT_EQ(closedness_defect(mesh, values), "");
    const double unit = hmf_foliation_unit(foliation.get());
    ASSERT_GT(unit, 0);
    for (const double x : values) ASSERT_EQ(x / unit, std::floor(x / unit)) << "not a multiple of the unit";
    const long genus =
        (2 - static_cast<long>(mesh.vertex_count + mesh.triangle_count) + static_cast<long>(mesh.edge_count)) / 2;
    const Indices own = count_indices(mesh, values);
    EXPECT_EQ(own.poles, 0u);
    EXPECT_EQ(own.sum, 4 - 4 * genus);
    EXPECT_EQ(static_cast<long>(own.zeros), 4 * genus - 4);

    const auto set = singularities(foliation);
    ASSERT_TRUE(set);
    EXPECT_GE(set->struct_size, sizeof(hmf_singularity_set));
    ASSERT_EQ(set->vertex_count, mesh.vertex_count);
    ASSERT_EQ(set->triangle_count, mesh.triangle_count);
    long listed = 0, arrays = 0;
    bool triangles = false;
    uint32_t before = 0;
    for (size_t i = 0; i < set->count; ++i) {
        const hmf_singularity& s = set->list[i];
        EXPECT_LT(s.index, 0);
        listed += s.index;
        // Vertices and clusters, then triangles, each by number.
        const bool in_triangle = s.kind == HMF_SINGULAR_TRIANGLE;
        if (i > 0 && in_triangle == triangles) { EXPECT_GT(s.element, before); }
        EXPECT_GE(in_triangle, triangles);
        triangles = in_triangle;
        before = s.element;
        double place[3] = {0, 0, 0};
        const auto add = [&](size_t v, double share) {
            for (size_t x = 0; x < 3; ++x) place[x] += share * mesh.positions[3 * v + x];
        };
        if (in_triangle) {
            ASSERT_LT(s.element, mesh.triangle_count);
            EXPECT_EQ(set->triangle_index[s.element], s.index);
            for (size_t c = 0; c < 3; ++c) add(mesh.triangle_vertices[3 * s.element + c], 1.0 / 3);
        } else {
            ASSERT_LT(s.element, mesh.vertex_count);
            EXPECT_EQ(set->vertex_index[s.element], s.index);
            size_t size = 0;
            for (size_t v = 0; v < mesh.vertex_count; ++v) {
                if (set->vertex_cluster[v] != s.element) continue;
                ++size;
                add(v, 1.0 / s.size);
            }
            EXPECT_EQ(size, s.size);
            EXPECT_EQ(s.kind == HMF_SINGULAR_CLUSTER, s.size > 1);
        }
        for (size_t x = 0; x < 3; ++x) EXPECT_NEAR(s.position[x], place[x], 1e-9 * (1 + std::abs(place[x])));
    }
    for (size_t v = 0; v < mesh.vertex_count; ++v) arrays += set->vertex_index[v];
    for (size_t t = 0; t < mesh.triangle_count; ++t) arrays += set->triangle_index[t];
    EXPECT_EQ(listed, 4 - 4 * genus);
    EXPECT_EQ(arrays, 4 - 4 * genus);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        if (values[e] == 0) {
            ASSERT_EQ(set->vertex_cluster[mesh.edge_vertices[2 * e]],
                      set->vertex_cluster[mesh.edge_vertices[2 * e + 1]])
                << "edge " << e;
        }
}

double energy(const LevelMesh& mesh, const std::vector<double>& values) {
    double sum = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) sum += mesh.weights[e] * values[e] * values[e];
    return sum;
}

std::vector<double> residuals(const LevelMesh& mesh, const std::vector<double>& values) {
    const std::vector<uint32_t> sides = edge_sides(mesh);
    std::vector<double> total(mesh.vertex_count, 0), result(mesh.vertex_count, -1);
    std::vector<bool> has_zero(mesh.vertex_count, false);
    std::vector<uint32_t> start(mesh.vertex_count, UINT32_MAX);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        for (size_t s = 0; s < 2; ++s) {
            const uint32_t v = mesh.edge_vertices[2 * e + s];
            total[v] += mesh.weights[e] * values[e];
            if (values[e] == 0) has_zero[v] = true;
        }
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; ++c) start[mesh.triangle_vertices[c]] = c;
    const double mean = std::accumulate(total.begin(), total.end(), 0.0) / static_cast<double>(mesh.vertex_count);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (has_zero[v]) continue;
        // Around the vertex by corners: side c leaves v, the side before it enters v.
        std::vector<double> pull(1, 0);
        uint32_t c = start[v];
        do {
            const uint32_t e = mesh.triangle_edges[c];
            pull.back() += mesh.weights[e] * values[e];
            if (corner2(mesh, values, c) == 0) pull.push_back(0);
            const uint32_t before = previous_side(c), f = mesh.triangle_edges[before];
            c = sides[2 * f] == before ? sides[2 * f + 1] : sides[2 * f];
        } while (c != start[v]);
        // The walk began inside a sector: the last run belongs to the first.
        if (pull.size() > 1) {
            pull[0] += pull.back();
            pull.pop_back();
        }
        const double worst = *std::max_element(pull.begin(), pull.end());
        result[v] = std::max(0.0, 2 * worst - total[v]) / std::max(total[v], 0.01 * mean);
    }
    return result;
}

std::vector<uint32_t> crossed_edges(const LevelMesh& mesh, const Loops& loops, size_t c) {
    std::vector<uint32_t> edges;
    const size_t begin = loops.offsets[c], size = loops.offsets[c + 1] - begin;
    for (size_t i = 0; i < size; ++i) {
        const uint32_t t = loops.elements[begin + i], u = loops.elements[begin + (i + 1) % size];
        for (size_t x = 0; x < 9; ++x)
            if (mesh.triangle_edges[3 * t + x / 3] == mesh.triangle_edges[3 * u + x % 3]) {
                edges.push_back(mesh.triangle_edges[3 * t + x / 3]);
                break;
            }
    }
    EXPECT_EQ(edges.size(), size) << "loop " << c << " is not a chain of triangles";
    return edges;
}

double shortest_crossing(const LevelMesh& mesh, const Loops& loops, size_t c, const std::vector<double>& values) {
    const std::vector<uint32_t> crossing = crossed_edges(mesh, loops, c);
    std::vector<bool> wall(mesh.edge_count, false);
    for (uint32_t e : crossing) wall[e] = true;
    std::vector<std::vector<uint32_t>> at(mesh.vertex_count);
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        if (!wall[e])
            for (size_t s = 0; s < 2; ++s) at[mesh.edge_vertices[2 * e + s]].push_back(e);
    double best = HUGE_VAL;
    for (uint32_t gate : crossing) {
        const uint32_t from = mesh.edge_vertices[2 * gate], to = mesh.edge_vertices[2 * gate + 1];
        std::vector<double> distance(mesh.vertex_count, HUGE_VAL);
        using Entry = std::pair<double, uint32_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
        distance[from] = 0;
        queue.push({0, from});
        while (!queue.empty()) {
            const Entry top = queue.top();
            queue.pop();
            const uint32_t v = top.second;
            if (top.first > distance[v]) continue;
            if (v == to || top.first + values[gate] >= best) break;
            for (uint32_t e : at[v]) {
                const uint32_t u =
                    mesh.edge_vertices[2 * e] == v ? mesh.edge_vertices[2 * e + 1] : mesh.edge_vertices[2 * e];
                if (top.first + values[e] >= distance[u]) continue;
                distance[u] = top.first + values[e];
                queue.push({distance[u], u});
            }
        }
        best = std::min(best, distance[to] + values[gate]);
    }
    return best;
}

std::string class_defect(const LevelMesh& mesh, const std::vector<double>& values, double w) {
    const std::vector<uint32_t> sides = edge_sides(mesh);
    const size_t n = mesh.vertex_count;
    const auto other_side = [&](uint32_t c) {
        const uint32_t e = mesh.triangle_edges[c];
        return sides[2 * e] == c ? sides[2 * e + 1] : sides[2 * e];
    };
    // An edge has two ends; end 2e is at edge_vertices[2e].  Loops (both ends at
    // one vertex) are told apart by the side that leaves.
    const auto end_of = [&](uint32_t c) { // the end of its edge that side c leaves from
        const uint32_t e = mesh.triangle_edges[c];
        return 2 * e + (sides[2 * e] != c);
    };
    const auto vertex_of = [&](uint32_t end) { return mesh.triangle_vertices[sides[end]]; };
    // Sector of each end at its vertex, and the number of sectors; 0 where an edge is zero.
    std::vector<int> sign(2 * mesh.edge_count, 0), sectors(n, 0);
    std::vector<uint32_t> leaving(n, UINT32_MAX);
    std::vector<bool> has_zero(n, false);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        if (values[e] == 0) has_zero[mesh.edge_vertices[2 * e]] = has_zero[mesh.edge_vertices[2 * e + 1]] = true;
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; ++c) leaving[mesh.triangle_vertices[c]] = c;
    for (uint32_t v = 0; v < n; ++v) {
        if (has_zero[v]) continue;
        // Start right after a closed corner.
        uint32_t first = leaving[v], turn = 0;
        while (corner2(mesh, values, first) != 0 && turn++ < 100000) first = other_side(previous_side(first));
        if (turn >= 100000) return "a pole";
        first = other_side(previous_side(first));
        uint32_t c = first;
        int sector = 0;
        do {
            sign[end_of(c)] = sector % 2 ? -1 : 1;
            if (corner2(mesh, values, c) == 0) ++sector;
            c = other_side(previous_side(c));
        } while (c != first);
        sectors[v] = sector;
    }
    const auto fold = [w](double h) { return h - w * std::floor(h / w); };
    const auto zero = [&](double h) { return fold(h) == 0; };

    std::vector<double> height(n, 0);
    std::vector<int> orientation(n, 0); // 0: not reached
    std::vector<std::vector<uint32_t>> ends(n);
    for (uint32_t end = 0; end < 2 * mesh.edge_count; ++end) ends[vertex_of(end)].push_back(end);
    const auto regular = [&](uint32_t v) { return sectors[v] == 2; };
    const auto center_height = [&](uint32_t c) { // of a tripod, from its corner c
        const uint32_t v = mesh.triangle_vertices[c];
        return height[v] + orientation[v] * sign[end_of(c)] * 0.5 * corner2(mesh, values, c);
    };
    const auto tripod = [&](uint32_t t) {
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            if (corner2(mesh, values, c) <= 0 || values[mesh.triangle_edges[c]] == 0) return false;
        return true;
    };
    // Begin around every singularity.
    std::vector<uint32_t> queue;
    const auto begin_at = [&](uint32_t v, double h) {
        if (!regular(v) || orientation[v] != 0) return;
        orientation[v] = 1;
        height[v] = fold(h);
        queue.push_back(v);
    };
    for (uint32_t t = 0; t < mesh.triangle_count; ++t)
        for (uint32_t c = 3 * t; tripod(t) && c < 3 * t + 3; ++c)
            begin_at(mesh.triangle_vertices[c], -sign[end_of(c)] * 0.5 * corner2(mesh, values, c));
    for (uint32_t v = 0; v < n; ++v)
        for (uint32_t end : ends[v])
            if (sectors[v] > 2) begin_at(vertex_of(end ^ 1u), -sign[end ^ 1u] * values[end / 2]);
    // Genus 1: no zero, no reflections; any height will do.
    const bool orientable = queue.empty();
    for (uint32_t v = 0; v < n && queue.empty(); ++v)
        if (regular(v)) {
            orientation[v] = 1;
            queue.push_back(v);
        }
    size_t reached = 0;
    while (reached < queue.size()) {
        const uint32_t v = queue[reached++];
        for (uint32_t end : ends[v]) {
            const uint32_t back = end ^ 1u, u = vertex_of(back);
            const double h = fold(height[v] + orientation[v] * sign[end] * values[end / 2]);
            if (sectors[u] > 2 && !zero(h))
                return "the singular vertex " + std::to_string(u) + " is off by " + std::to_string(h);
            if (!regular(u)) continue;
            const int o = -orientation[v] * sign[end] * sign[back];
            if (orientation[u] == 0) {
                orientation[u] = o;
                height[u] = h;
                queue.push_back(u);
            } else if (orientable && o != orientation[u]) {
                return "edge " + std::to_string(end / 2) + " turns the orientation";
            } else if (!zero(o == orientation[u] ? h - height[u] : h + height[u])) {
                return "edge " + std::to_string(end / 2) + " closes with a defect of "
                     + std::to_string(fold(o == orientation[u] ? h - height[u] : h + height[u]));
            }
        }
    }
    for (uint32_t t = 0; t < mesh.triangle_count; ++t)
        for (uint32_t c = 3 * t; tripod(t) && c < 3 * t + 3; ++c)
            if (orientation[mesh.triangle_vertices[c]] != 0 && !zero(center_height(c)))
                return "the zero in triangle " + std::to_string(t) + " is off by "
                     + std::to_string(fold(center_height(c)));
    if (2 * reached < n) return "only " + std::to_string(reached) + " vertices could be reached";
    return "";
}

hmf_solve_options solve_options(int32_t method, double tolerance, uint64_t iterations) {
    hmf_solve_options options{};
    options.struct_size = sizeof options;
    options.method = method;
    (method == HMF_METHOD_NEWTON ? options.tolerance : options.energy_tolerance) = tolerance;
    options.iteration_limit = iterations;
    return options;
}

namespace {

template <class Call>
Solution solution_of(Call&& call) {
    Solution solution;
    hmf_foliation* out = reinterpret_cast<hmf_foliation*>(&solution); // must be overwritten
    solution.status = call(&out, &solution.error);
    solution.foliation.reset(out);
    EXPECT_TRUE(solution.status == HMF_CANCELLED || (out != nullptr) == (solution.status < HMF_ERROR_NULL));
    EXPECT_EQ(solution.error.status, solution.status);
    const hmf_report* report = hmf_foliation_report(out);
    EXPECT_EQ(report != nullptr, out != nullptr);
    if (report) {
        EXPECT_GE(report->struct_size, sizeof *report);
        solution.values = values_of(solution.foliation);
        solution.report = *report;
    }
    return solution;
}

} // namespace

Solution solve(const Hierarchy& hierarchy, const Loops* loops, const hmf_solve_options& options,
               const hmf_control* control) {
    hmf_loop_set set{};
    if (loops) set = loops->view();
    return solution_of([&](hmf_foliation** out, hmf_error* error) {
        if (!loops && !options.start) return hmf_solve_cut_system(hierarchy.get(), &options, control, out, error);
        return hmf_solve(hierarchy.get(), loops ? &set : nullptr, &options, control, out, error);
    });
}

Solution solve(const Hierarchy& hierarchy, const hmf_loop_set& loops) {
    return solution_of([&](hmf_foliation** out, hmf_error* error) {
        return hmf_solve(hierarchy.get(), &loops, nullptr, nullptr, out, error);
    });
}

Solution relax(const Foliation& foliation, const hmf_solve_options& options, const hmf_control* control) {
    return solution_of([&](hmf_foliation** out, hmf_error* error) {
        return hmf_relax(foliation.get(), &options, control, out, error);
    });
}

SolvedSurface::SolvedSurface(const TriMesh& mesh, const std::vector<uint32_t>& marks) :
    hierarchy(mesh, with_marks(marks)), solution(solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8))) {}

} // namespace test
