// The C interface under arbitrary input: small arrays of vertices, triangles,
// loops, values and options.  Whatever they are, there is no crash, the status
// is one that the header lists, a failing call gives nothing, a result is a
// foliation, the memory limit holds and all memory comes back.
//
// Half of the inputs begin with a chain of grid tori, so that the later stages
// are reached; a few bytes may then spoil it.
#include <hmf/hmf.h>
#include <hmf/uses.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "owned.hpp"

namespace {

using namespace fuzz;

// The limit bounds the hierarchy with what the running call takes: not the
// foliations and results that the caller already has.
struct Meter {
    uint64_t used = 0, peak = 0, calls = 0, fail = 0, limit = 0;
    uint64_t held = 0;   // by the hierarchy
    uint64_t beside = 0; // by other objects, when the call began

    void begin_call() { beside = used - held; }

    static void* take(void* user, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        if (++meter.calls == meter.fail) return nullptr;
        meter.used += size;
        meter.peak = std::max(meter.peak, meter.used);
        FUZZ_ASSERT(meter.limit == 0 || meter.used - meter.beside <= meter.limit);
        void* block = std::malloc(size ? size : 1);
        if (block) std::memset(block, 0xa5, size);
        return block;
    }
    static void give(void* user, void* block, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        FUZZ_ASSERT(block && meter.used >= size);
        meter.used -= size;
        std::free(block);
    }
};

struct Stop {
    uint32_t at = 0, calls = 0;
    int32_t answer = 0;
    static int32_t call(void* user, double fraction) {
        Stop& stop = *static_cast<Stop*>(user);
        FUZZ_ASSERT(fraction >= 0 && fraction <= 1);
        return ++stop.calls == stop.at ? stop.answer : HMF_PROGRESS_CONTINUE;
    }
};

Meter* meter_now = nullptr;
size_t marks_now = 0;

// Of all singularities of a foliation; marked vertices take their share.
int64_t index_sum(const hmf_hierarchy* h) {
    return 4 - 4 * static_cast<int64_t>(hmf_genus(h)) - static_cast<int64_t>(marks_now);
}

// With boundary the list has what touches the caller's half of the double, and the sum may be another.
bool has_index_sum(const hmf_hierarchy* h, int64_t sum) { return hmf_boundary_count(h) > 0 || sum == index_sum(h); }

// A status that the call may return; a failure tells its story.
void expect_status(hmf_status status, const hmf_error& error, std::initializer_list<int> classes) {
    bool known = status == HMF_OK;
    for (const int c : classes) known |= status / 100 == c && status != 0;
    FUZZ_ASSERT(known);
    if (status == HMF_OK) {
        FUZZ_ASSERT(error.status == HMF_OK);
    } else {
        FUZZ_ASSERT(error.status == status);
        FUZZ_ASSERT(std::memchr(error.message, 0, sizeof error.message) && std::strlen(error.message) > 10);
    }
}

double coordinate(Bytes& bytes) {
    const uint8_t b = bytes.byte();
    if (b == 255) return static_cast<double>(NAN);
    if (b == 254) return static_cast<double>(INFINITY);
    if (b == 253) return 1e300;
    if (b == 252) return 1e-300;
    return (b - 126) / 32.0;
}

struct Surface {
    std::vector<double> positions;
    std::vector<uint32_t> triangles;
};

Surface anything(Bytes& bytes) {
    Surface s;
    const uint32_t vertices = bytes.below(16), triangles = bytes.below(40);
    for (uint32_t i = 0; i < 3 * vertices; ++i) s.positions.push_back(coordinate(bytes));
    for (uint32_t i = 0; i < 3 * triangles; ++i) s.triangles.push_back(bytes.below(vertices + 1));
    return s;
}

// Tori in a row; each is glued to the one before along a triangle.
// Large ones have several levels, and linear systems that are solved on several levels.
Surface chain_of_tori(Bytes& bytes, bool large) {
    Surface s;
    const uint32_t tori = 1 + bytes.below(large ? 2 : 3);
    for (uint32_t t = 0; t < tori; ++t) {
        const uint32_t n = (large ? 14 : 4) + bytes.below(6), m = (large ? 14 : 4) + bytes.below(4);
        std::vector<uint32_t> id(n * m, UINT32_MAX);
        if (t > 0) {
            // The last triangle goes; its corners are 0, m and m + 1 of this torus, the other way round.
            const size_t last = s.triangles.size() - 3;
            id[0] = s.triangles[last], id[m] = s.triangles[last + 2], id[m + 1] = s.triangles[last + 1];
            s.triangles.resize(last);
        }
        for (uint32_t i = 0; i < n * m; ++i) {
            if (id[i] != UINT32_MAX) continue;
            id[i] = static_cast<uint32_t>(s.positions.size() / 3);
            const double u = 6.283185307179586 * (i / m) / n, v = 6.283185307179586 * (i % m) / m;
            const double r = 2 + std::cos(v);
            const double p[3] = {6.0 * t + r * std::cos(u), r * std::sin(u), std::sin(v)};
            for (const double x : p) s.positions.push_back(x);
        }
        for (uint32_t x = 0; x < n; ++x)
            for (uint32_t y = 0; y < m; ++y) {
                const uint32_t a = id[x * m + y], b = id[(x + 1) % n * m + y], c = id[(x + 1) % n * m + (y + 1) % m],
                               d = id[x * m + (y + 1) % m];
                if (t == 0 || x + y > 0) s.triangles.insert(s.triangles.end(), {a, b, c});
                s.triangles.insert(s.triangles.end(), {a, c, d});
            }
    }
    // Stretches and dents; then, rarely, damage.
    const uint32_t vertices = static_cast<uint32_t>(s.positions.size() / 3);
    for (uint32_t i = bytes.below(24); i > 0; --i)
        s.positions[(bytes.byte() * 7u + bytes.byte()) % (3 * vertices)] += (bytes.byte() - 128) / 256.0;
    if (bytes.rarely())
        for (uint32_t i = 1 + bytes.below(4); i > 0; --i)
            s.triangles[(bytes.byte() * 7u + bytes.byte()) % s.triangles.size()] = bytes.below(vertices + 2);
    if (bytes.rarely()) s.triangles.resize(s.triangles.size() - 3);
    if (bytes.rarely()) s.positions[bytes.byte() % s.positions.size()] = coordinate(bytes);
    return s;
}

// Two pyramids over a ring, in layers.
Surface sphere(Bytes& bytes) {
    Surface s;
    const uint32_t n = 4 + bytes.below(6), layers = 2 + bytes.below(5);
    for (uint32_t k = 0; k < layers; ++k)
        for (uint32_t i = 0; i < n; ++i) {
            const double u = 6.283185307179586 * i / n, z = (k + 1.0) / (layers + 1) * 2 - 1, r = std::sqrt(1 - z * z);
            for (const double x : {r * std::cos(u), r * std::sin(u), z}) s.positions.push_back(x);
        }
    for (const double x : {0.0, 0.0, -1.0, 0.0, 0.0, 1.0}) s.positions.push_back(x);
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t j = (i + 1) % n, top = (layers - 1) * n;
        s.triangles.insert(s.triangles.end(), {layers * n, j, i, layers * n + 1, top + i, top + j});
        for (uint32_t k = 0; k + 1 < layers; ++k) {
            const uint32_t a = k * n + i, b = k * n + j;
            s.triangles.insert(s.triangles.end(), {a, b, b + n, a, b + n, a + n});
        }
    }
    for (uint32_t i = bytes.below(12); i > 0; --i)
        s.positions[(bytes.byte() * 7u + bytes.byte()) % s.positions.size()] += (bytes.byte() - 128) / 512.0;
    return s;
}

struct LoopArrays {
    hmf_loop_set set{};
    std::vector<uint64_t> offsets;
    std::vector<uint32_t> elements;
    std::vector<double> weights;

    void view(size_t count) {
        set.struct_size = sizeof set;
        set.count = count;
        set.offsets = offsets.data();
        set.elements = elements.data();
        set.weights = weights.empty() ? nullptr : weights.data();
    }
};

// Closed walks over neighbours: some steps out, and back on a shortest way.
void walks(Bytes& bytes, const hmf_hierarchy* h, LoopArrays& loops, uint64_t count) {
    const size_t level = static_cast<size_t>(loops.set.level);
    const bool vertices = loops.set.element_kind == HMF_LOOP_VERTICES;
    hmf_level_info info{};
    FUZZ_ASSERT(hmf_level_counts(h, level, &info, nullptr) == HMF_OK);
    std::vector<uint32_t> ends(2 * info.edge_count), sides(3 * info.triangle_count);
    FUZZ_ASSERT(hmf_level_edge_vertices(h, level, ends.data(), ends.size(), nullptr) == HMF_OK);
    FUZZ_ASSERT(hmf_level_triangle_edges(h, level, sides.data(), sides.size(), nullptr) == HMF_OK);
    if (!vertices) {
        std::fill(ends.begin(), ends.end(), HMF_NONE);
        for (uint32_t c = 0; c < sides.size(); ++c) ends[2 * sides[c] + (ends[2 * sides[c]] != HMF_NONE)] = c / 3;
    }
    std::vector<std::vector<uint32_t>> next(vertices ? info.vertex_count : info.triangle_count);
    for (size_t e = 0; e < ends.size(); e += 2) {
        if (ends[e + 1] == HMF_NONE) continue; // on the boundary
        next[ends[e]].push_back(ends[e + 1]);
        next[ends[e + 1]].push_back(ends[e]);
    }
    for (uint64_t c = 0; c < count; ++c) {
        const uint32_t start = (bytes.byte() * 7u + bytes.byte()) % static_cast<uint32_t>(next.size());
        std::vector<uint32_t> before(next.size(), HMF_NONE), queue{start};
        before[start] = start;
        for (size_t i = 0; i < queue.size(); ++i)
            for (const uint32_t to : next[queue[i]])
                if (before[to] == HMF_NONE) before[to] = queue[i], queue.push_back(to);
        uint32_t at = start;
        if (next[start].empty()) return; // a triangle on its own
        const uint32_t straight = bytes.byte();
        for (uint32_t step = 1 + bytes.below(20); step > 0; --step) {
            loops.elements.push_back(at);
            at = next[at][(straight + (bytes.rarely() ? 1 : 0)) % next[at].size()];
        }
        for (; at != start; at = before[at]) loops.elements.push_back(at);
        loops.offsets.push_back(loops.elements.size());
    }
}

void any_loops(Bytes& bytes, const hmf_hierarchy* h, LoopArrays& loops) {
    const uint32_t levels = static_cast<uint32_t>(hmf_level_count(h));
    loops.set.level = bytes.rarely() ? levels + bytes.byte() : bytes.below(levels);
    loops.set.element_kind = bytes.rarely() ? bytes.byte() : 1 + static_cast<int32_t>(bytes.below(2));
    uint64_t count = 0, total = 0;
    hmf_error error{};
    const uint8_t choice = bytes.byte();
    if (choice % 2 && loops.set.level < levels) {
        // The library's own, perhaps spoiled.
        loops.set.element_kind = HMF_LOOP_TRIANGLES;
        const int32_t kind = HMF_LOOPS_CUT + static_cast<int32_t>(bytes.below(4));
        const bool in_space = kind == HMF_LOOPS_HANDLE || kind == HMF_LOOPS_TUNNEL; // which a dented surface may not be
        hmf_loop_set* made = nullptr;
        const hmf_status status = hmf_loops(h, loops.set.level, kind, nullptr, &made, &error);
        const Owned<hmf_loop_set> owner(made);
        // With boundary: on level 0 only.
        const bool on_part = hmf_boundary_count(h) > 0;
        expect_status(status, error, {2, in_space || on_part ? 3 : 2, in_space || on_part ? 1 : 2});
        FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
        if (made) count = made->count, total = made->offsets[count];
        loops.offsets.assign(count + 1, 0);
        if (made) std::copy(made->offsets, made->offsets + count + 1, loops.offsets.begin());
        if (made) loops.elements.assign(made->elements, made->elements + total);
        if (bytes.byte() % 4 == 3 && total > 0) loops.elements[bytes.byte() % total] = bytes.byte();
    } else {
        count = bytes.below(4);
        loops.offsets.push_back(0);
        if (choice % 4 == 2 && loops.set.level < levels) walks(bytes, h, loops, count);
        else
            for (size_t c = 0; c < count; ++c) loops.offsets.push_back(loops.offsets.back() + bytes.below(12));
        if (bytes.rarely()) std::reverse(loops.offsets.begin(), loops.offsets.end());
        for (uint64_t i = loops.elements.size(); i < loops.offsets.back(); ++i) loops.elements.push_back(bytes.byte());
    }
    if (bytes.byte() % 2)
        for (size_t c = 0; c < count; ++c)
            loops.weights.push_back(bytes.rarely() ? coordinate(bytes) : 0.25 * (1 + bytes.below(40)));
    loops.view(count);
}

// Of a call that makes a result: given if and only if it succeeds.
template <class T, class Call>
Owned<T> result_of(std::initializer_list<hmf_status> others, bool memory_is_short, Call&& call) {
    T* out = reinterpret_cast<T*>(&others); // must be overwritten
    meter_now->begin_call();
    const hmf_status status = call(&out);
    FUZZ_ASSERT((out != nullptr) == (status == HMF_OK));
    FUZZ_ASSERT(status == HMF_OK || std::find(others.begin(), others.end(), status) != others.end()
                || (memory_is_short && status / 100 == 2));
    return Owned<T>(out);
}

// Refused with a reason, or cone angles that add up.
void expect_parameterization(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const auto map =
        result_of<hmf_parameterization>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
                                        [&](auto out) { return hmf_parameterize(f, nullptr, nullptr, out, nullptr); });
    if (!map) return;
    for (size_t i = 0; i < 6 * map->triangle_count; ++i) FUZZ_ASSERT(std::isfinite(map->corner_uv[i]));
    int64_t sum = 0;
    for (size_t v = 0; v < map->vertex_count; ++v) sum += 2 - map->cone[v];
    // A marked pole has an angle of pi.  With boundary half of the double is counted.
    FUZZ_ASSERT(hmf_boundary_count(h) > 0 || sum == 4 - 4 * static_cast<int64_t>(hmf_genus(h)));
}

// Leaves close or join zeros, a quad mesh is closed and has the right genus.
void expect_leaves(const hmf_hierarchy* h, const hmf_foliation* f, double largest, bool memory_is_short) {
    hmf_trace_options options = sized<hmf_trace_options>();
    options.critical = 1;
    options.spacing = largest;
    const auto traced = [&](auto out) { return hmf_trace(f, &options, nullptr, out, nullptr); };
    if (const auto leaves = result_of<hmf_lines>({}, memory_is_short, traced))
        for (size_t i = 0; i < leaves->line_count; ++i) {
            const hmf_line& line = leaves->lines[i];
            if (hmf_boundary_count(h) > 0) continue; // leaves end there
            FUZZ_ASSERT(line.kind == HMF_LINE_CRITICAL ? line.begin == HMF_END_ZERO && line.end == HMF_END_ZERO
                                                       : line.closed == 1);
        }
    options.leaves = HMF_LEAVES_CONJUGATE;
    result_of<hmf_lines>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS}, memory_is_short,
                         traced);
    // With boundary cylinders are told apart by their loops, which are not given here.
    result_of<hmf_cylinder_set>({HMF_ERROR_VALUE_NOT_HARMONIC,
                                 hmf_boundary_count(h) > 0 ? HMF_ERROR_UNSUPPORTED : HMF_ERROR_VALUE_NOT_HARMONIC},
                                memory_is_short,
                                [&](auto out) { return hmf_cylinders(f, nullptr, nullptr, out, nullptr); });

    const auto atlas = result_of<hmf_chart_set>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
                                                [&](auto out) { return hmf_atlas(f, nullptr, nullptr, out, nullptr); });
    for (size_t t = 0; atlas && t < atlas->triangle_count; ++t) {
        FUZZ_ASSERT(atlas->triangle_chart[t] < atlas->chart_count);
        for (size_t i = 6 * t; i < 6 * t + 6; ++i) FUZZ_ASSERT(atlas->corner_uv[i] >= 0 && atlas->corner_uv[i] <= 1);
    }
    const auto mesh = result_of<hmf_quad_mesh>({HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS}, memory_is_short,
                                               [&](auto out) { return hmf_quads(f, nullptr, nullptr, out, nullptr); });
    if (!mesh) return;
    for (size_t i = 0; i < 3 * mesh->vertex_count; ++i) FUZZ_ASSERT(std::isfinite(mesh->positions[i]));
    std::vector<std::pair<uint32_t, uint32_t>> sides;
    for (size_t q = 0; q < mesh->quad_count; ++q)
        for (size_t s = 0; s < 4; ++s) sides.push_back({mesh->quads[4 * q + s], mesh->quads[4 * q + (s + 1) % 4]});
    std::sort(sides.begin(), sides.end());
    int64_t outer = 0; // sides on the boundary
    for (size_t i = 0; i < sides.size(); ++i) {
        FUZZ_ASSERT(sides[i].first < mesh->vertex_count && (i == 0 || sides[i] != sides[i - 1]));
        outer += !std::binary_search(sides.begin(), sides.end(), std::make_pair(sides[i].second, sides[i].first));
    }
    FUZZ_ASSERT(outer == 0 || hmf_boundary_count(h) > 0);
    const int64_t edges = (static_cast<int64_t>(sides.size()) + outer) / 2;
    FUZZ_ASSERT(static_cast<int64_t>(mesh->vertex_count) - edges + static_cast<int64_t>(mesh->quad_count)
                == 2 - 2 * static_cast<int64_t>(hmf_genus(h)) - static_cast<int64_t>(hmf_boundary_count(h)));
}

void expect_closed(const hmf_hierarchy* h, const hmf_foliation* f) {
    const size_t level = hmf_foliation_level(f);
    hmf_level_info info{};
    FUZZ_ASSERT(hmf_level_counts(h, level, &info, nullptr) == HMF_OK);
    size_t count = 0;
    const double* const values = hmf_foliation_values(f, &count);
    FUZZ_ASSERT(count == info.edge_count);
    std::vector<uint32_t> side(3 * info.triangle_count);
    FUZZ_ASSERT(hmf_level_triangle_edges(h, level, side.data(), side.size(), nullptr) == HMF_OK);
    for (size_t t = 0; t < info.triangle_count; ++t)
        for (size_t s = 0; s < 3; ++s)
            FUZZ_ASSERT(values[side[3 * t + s]] >= 0
                        && values[side[3 * t + s]]
                               <= values[side[3 * t + (s + 1) % 3]] + values[side[3 * t + (s + 2) % 3]]);
}

// No pole but at marked vertices.
void expect_singularities(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const auto set = result_of<hmf_singularity_set>(
        {}, memory_is_short, [&](auto out) { return hmf_singularities(f, nullptr, out, nullptr); });
    if (!set) return;
    int64_t sum = 0;
    for (size_t i = 0; i < set->count; ++i) {
        FUZZ_ASSERT(set->list[i].index < 0 || (set->list[i].index == 0 && marks_now > 0));
        for (const double x : set->list[i].position) FUZZ_ASSERT(std::isfinite(x));
        sum += set->list[i].index;
    }
    FUZZ_ASSERT(has_index_sum(h, sum));
}

// Exact triangle inequalities, no pole, 4 - 4 g; the values, read again, are
// the same foliation.
void expect_foliation(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    expect_closed(h, f);
    expect_singularities(h, f, memory_is_short);
    const size_t level = hmf_foliation_level(f);
    size_t count = 0;
    const double* const values = hmf_foliation_values(f, &count);
    if (const auto read = result_of<hmf_foliation>({}, memory_is_short, [&](auto out) {
            return hmf_foliation_create(h, level, values, count, nullptr, out, nullptr);
        }))
        FUZZ_ASSERT(std::equal(values, values + count, hmf_foliation_values(read.get(), nullptr)));
    expect_parameterization(h, f, memory_is_short);
    expect_leaves(h, f, *std::max_element(values, values + count), memory_is_short);
}

// Numbers as values: refused with a reason, or a foliation, perhaps with poles.
void any_values(Bytes& bytes, const hmf_hierarchy* h, bool memory_is_short) {
    const size_t level = bytes.below(static_cast<uint32_t>(hmf_level_count(h)));
    hmf_level_info info{};
    FUZZ_ASSERT(hmf_level_counts(h, level, &info, nullptr) == HMF_OK);
    std::vector<uint32_t> ends(2 * info.edge_count);
    FUZZ_ASSERT(hmf_level_edge_vertices(h, level, ends.data(), ends.size(), nullptr) == HMF_OK);
    std::vector<double> values(info.edge_count, 0);
    // Differences of heights of the vertices are closed.
    const uint32_t period = 1 + bytes.below(8);
    for (size_t e = 0; e < values.size(); ++e)
        values[e] = std::abs(static_cast<double>(ends[2 * e] % period) - static_cast<double>(ends[2 * e + 1] % period));
    if (bytes.rarely()) values[bytes.byte() % values.size()] = coordinate(bytes);
    hmf_foliation* made = nullptr;
    hmf_error error{};
    meter_now->begin_call();
    const hmf_status status = hmf_foliation_create(h, level, values.data(), values.size(), nullptr, &made, &error);
    const Owned<hmf_foliation> f(made);
    expect_status(status, error, {5, memory_is_short ? 2 : 5});
    FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
    if (!f) return;
    double energy = -1;
    meter_now->begin_call();
    FUZZ_ASSERT(hmf_energy(f.get(), nullptr, &energy, nullptr) == HMF_OK ? energy >= 0 : memory_is_short);
    if (const auto set = result_of<hmf_singularity_set>(
            {}, memory_is_short, [&](auto out) { return hmf_singularities(f.get(), nullptr, out, nullptr); })) {
        int64_t sum = 0;
        for (size_t i = 0; i < set->count; ++i) sum += set->list[i].index;
        FUZZ_ASSERT(has_index_sum(h, sum));
    }
    result_of<hmf_foliation>({HMF_ERROR_VALUE_POLE}, memory_is_short,
                             [&](auto out) { return hmf_interpolate(f.get(), 0, nullptr, out, nullptr); });
}

// Everything that a level tells; corners and edges fit together.
void expect_level(const hmf_hierarchy* h, size_t level) {
    hmf_level_info info{};
    if (hmf_level_counts(h, level, &info, nullptr) == HMF_ERROR_LEVEL) {
        FUZZ_ASSERT(level >= hmf_level_count(h));
        return;
    }
    std::vector<uint32_t> ends(2 * info.edge_count), edges(3 * info.triangle_count), corners(3 * info.triangle_count);
    std::vector<double> weights(info.edge_count), positions(3 * info.vertex_count);
    hmf_error error{};
    FUZZ_ASSERT(hmf_level_edge_vertices(h, level, ends.data(), ends.size() - 1, &error) == HMF_ERROR_CAPACITY);
    FUZZ_ASSERT(hmf_level_triangle_edges(h, level, edges.data(), 0, &error) == HMF_ERROR_CAPACITY);
    FUZZ_ASSERT(hmf_level_triangle_vertices(h, level, corners.data(), 1, &error) == HMF_ERROR_CAPACITY);
    FUZZ_ASSERT(hmf_level_weights(h, level, weights.data(), weights.size() - 1, &error) == HMF_ERROR_CAPACITY);
    FUZZ_ASSERT(hmf_level_positions(h, level, positions.data(), 2, &error) == HMF_ERROR_CAPACITY);
    FUZZ_ASSERT(hmf_level_edge_vertices(h, level, ends.data(), ends.size(), nullptr) == HMF_OK);
    FUZZ_ASSERT(hmf_level_triangle_edges(h, level, edges.data(), edges.size(), nullptr) == HMF_OK);
    FUZZ_ASSERT(hmf_level_triangle_vertices(h, level, corners.data(), corners.size(), nullptr) == HMF_OK);
    FUZZ_ASSERT(hmf_level_weights(h, level, weights.data(), weights.size(), nullptr) == HMF_OK);
    FUZZ_ASSERT(hmf_level_positions(h, level, positions.data(), positions.size(), nullptr) == HMF_OK);
    for (size_t c = 0; c < corners.size(); ++c) {
        const uint32_t a = corners[c], b = corners[c - c % 3 + (c + 1) % 3], e = edges[c];
        FUZZ_ASSERT(a < info.vertex_count && e < info.edge_count);
        FUZZ_ASSERT((ends[2 * e] == a && ends[2 * e + 1] == b) || (ends[2 * e] == b && ends[2 * e + 1] == a));
    }
    for (const double w : weights) FUZZ_ASSERT(std::isfinite(w) && (level == 0 || w > 0));
    for (const double x : positions) FUZZ_ASSERT(std::isfinite(x));
}

// On a coarse level the energy is the sum of weight * value^2; residuals are shares.
void expect_measures(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    double energy = -1;
    meter_now->begin_call();
    if (hmf_energy(f, nullptr, &energy, nullptr) != HMF_OK) {
        FUZZ_ASSERT(memory_is_short && energy == -1);
        return;
    }
    const size_t level = hmf_foliation_level(f);
    hmf_level_info info{};
    FUZZ_ASSERT(hmf_level_counts(h, level, &info, nullptr) == HMF_OK);
    if (level > 0) {
        std::vector<double> weights(info.edge_count);
        FUZZ_ASSERT(hmf_level_weights(h, level, weights.data(), weights.size(), nullptr) == HMF_OK);
        const double* const values = hmf_foliation_values(f, nullptr);
        const double share = hmf_boundary_count(h) > 0 ? 0.5 : 1; // of the double
        double sum = 0;
        for (size_t e = 0; e < weights.size(); ++e) sum += share * weights[e] * values[e] * values[e];
        FUZZ_ASSERT(std::abs(sum - energy) <= 1e-9 * sum);
    }
    std::vector<double> residuals(info.vertex_count, -1);
    meter_now->begin_call();
    const hmf_status status = hmf_residuals(f, nullptr, residuals.data(), residuals.size(), nullptr);
    FUZZ_ASSERT(status == HMF_OK || (memory_is_short && status / 100 == 2));
    for (const double r : residuals) FUZZ_ASSERT(status == HMF_OK ? r >= 0 && r <= 1 + 1e-9 : r == -1);
}

// A call that gives a foliation even where it stops early.
template <class Call>
Owned<hmf_foliation> foliation_of(const hmf_hierarchy* h, const Stop& stop, bool memory_is_short, Call&& call) {
    hmf_foliation* made = nullptr;
    hmf_error error{};
    meter_now->begin_call();
    const hmf_status status = call(&made, &error);
    Owned<hmf_foliation> f(made);
    expect_status(status, error, {0, 1, memory_is_short ? 2 : 1});
    FUZZ_ASSERT(status != HMF_CANCELLED || stop.at > 0);
    FUZZ_ASSERT(status == HMF_CANCELLED || (made != nullptr) == (status < HMF_CANCELLED || status == HMF_LIMIT_CLASS));
    if (!f) return f;
    const hmf_report* report = hmf_foliation_report(made);
    FUZZ_ASSERT(report && report->poles == 0 && report->bad_flips_left == 0);
    // Sweeps may end by the energy; a stopped call may have arrived all the same.
    const bool has_arrived = status == HMF_OK && report->method == HMF_METHOD_NEWTON;
    FUZZ_ASSERT(report->converged ? report->residual_max >= 0 : !has_arrived);
    FUZZ_ASSERT(report->class_state != HMF_CLASS_LOST);
    expect_closed(h, made);
    expect_singularities(h, made, memory_is_short);
    return f;
}

hmf_solve_options any_solve_options(Bytes& bytes) {
    hmf_solve_options options = sized<hmf_solve_options>();
    options.method = static_cast<int32_t>(bytes.below(3));
    options.iteration_limit = 1 + bytes.below(30);
    if (bytes.rarely()) options.time_limit = 1e-6 * bytes.byte();
    return options;
}

// Leaves through points, of both kinds; cylinders with loops; quads and seams to order.
void any_use(Bytes& bytes, const hmf_hierarchy* h, const hmf_foliation* f, const LoopArrays& loops,
             bool memory_is_short) {
    hmf_level_info info{};
    FUZZ_ASSERT(hmf_level_counts(h, hmf_foliation_level(f), &info, nullptr) == HMF_OK);
    switch (bytes.below(4)) {
    case 0: {
        std::vector<uint32_t> triangles;
        std::vector<double> barycentrics;
        for (uint32_t i = 1 + bytes.below(4); i > 0; --i) {
            const uint32_t a = bytes.byte(), b = bytes.byte(), all = 256;
            triangles.push_back((bytes.byte() * 7u + bytes.byte()) % static_cast<uint32_t>(info.triangle_count));
            for (const uint32_t x : {a % 128, b % 128, all - a % 128 - b % 128}) barycentrics.push_back(x / 256.0);
        }
        if (bytes.rarely()) triangles[0] += static_cast<uint32_t>(info.triangle_count);
        if (bytes.rarely()) barycentrics[0] = coordinate(bytes);
        hmf_trace_options options = sized<hmf_trace_options>();
        options.point_count = triangles.size();
        options.point_triangles = triangles.data();
        options.point_barycentrics = barycentrics.data();
        options.leaves = static_cast<int32_t>(bytes.below(3));
        if (bytes.rarely()) options.length_limit = std::abs(coordinate(bytes));
        const auto lines = result_of<hmf_lines>(
            {HMF_ERROR_OPTIONS, HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
            [&](auto out) { return hmf_trace(f, &options, nullptr, out, nullptr); });
        if (!lines) return;
        const bool cut = hmf_boundary_count(h) > 0; // a leaf can give several lines
        FUZZ_ASSERT(cut || lines->line_count == triangles.size());
        for (size_t i = 0; i < lines->line_count; ++i) {
            const hmf_line& line = lines->lines[i];
            FUZZ_ASSERT(line.kind == HMF_LINE_POINT && (cut ? line.source < triangles.size() : line.source == i));
            FUZZ_ASSERT((line.closed == 1) == (line.begin == HMF_END_CLOSED) && line.length >= 0);
            FUZZ_ASSERT(line.begin != HMF_END_NOWHERE || lines->offsets[i] == lines->offsets[i + 1]);
        }
        for (size_t i = 0; i < 3 * lines->point_count; ++i) FUZZ_ASSERT(std::isfinite(lines->points[i]));
        break;
    }
    case 1: {
        hmf_error error{};
        hmf_cylinder_set* made = nullptr;
        meter_now->begin_call();
        const hmf_status status = hmf_cylinders(f, &loops.set, nullptr, &made, &error);
        const Owned<hmf_cylinder_set> set(made);
        expect_status(status, error, {1, 4, 5, memory_is_short ? 2 : 1});
        FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
        // Each loop has one cylinder, as high as its weight.
        std::vector<uint8_t> taken(static_cast<size_t>(loops.set.count), 0);
        for (size_t i = 0; made && i < made->count; ++i) {
            const hmf_cylinder& c = made->list[i];
            FUZZ_ASSERT(c.loop < taken.size() && !taken[c.loop]++ && c.circumference > 0);
            const double weight = loops.set.weights ? loops.set.weights[c.loop] : 1;
            FUZZ_ASSERT(std::abs(c.height - weight) <= 1e-12 * weight);
        }
        break;
    }
    case 2: {
        hmf_quad_options options = sized<hmf_quad_options>();
        options.edge_length = 0.3 + bytes.below(16) / 8.0;
        result_of<hmf_quad_mesh>({HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS}, memory_is_short,
                                 [&](auto out) { return hmf_quads(f, &options, nullptr, out, nullptr); });
        break;
    }
    default: {
        hmf_parameterize_options options = sized<hmf_parameterize_options>();
        std::vector<uint32_t> edges;
        for (uint32_t i = bytes.below(16); i > 0; --i) edges.push_back(bytes.byte());
        options.seam_edges = edges.data();
        options.seam_edge_count = edges.size();
        if (bytes.rarely()) options.tolerance = coordinate(bytes);
        result_of<hmf_parameterization>(
            {HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS, HMF_ERROR_NULL}, memory_is_short,
            [&](auto out) { return hmf_parameterize(f, &options, nullptr, out, nullptr); });
    }
    }
}

// A few more calls on a foliation, which the next ones may go on from.
void any_calls(Bytes& bytes, const hmf_hierarchy* h, const hmf_foliation* first, const LoopArrays& loops,
               bool memory_is_short) {
    Owned<hmf_foliation> last;
    for (uint32_t n = bytes.below(6); n > 0; --n) {
        const hmf_foliation* const f = last ? last.get() : first;
        const Stop never;
        switch (bytes.below(6)) {
        case 0: {
            const hmf_solve_options options = any_solve_options(bytes);
            last = foliation_of(h, never, memory_is_short, [&](auto out, hmf_error* error) {
                return hmf_relax(f, &options, nullptr, out, error);
            });
            break;
        }
        case 1: {
            const size_t level = bytes.below(static_cast<uint32_t>(hmf_level_count(h)));
            auto moved = result_of<hmf_foliation>(
                {}, memory_is_short, [&](auto out) { return hmf_interpolate(f, level, nullptr, out, nullptr); });
            if (!moved) break;
            FUZZ_ASSERT(hmf_foliation_level(moved.get()) == level && !hmf_foliation_report(moved.get()));
            FUZZ_ASSERT(hmf_foliation_unit(moved.get()) == hmf_foliation_unit(f));
            expect_closed(h, moved.get());
            expect_singularities(h, moved.get(), memory_is_short);
            last = std::move(moved);
            break;
        }
        case 2: expect_measures(h, f, memory_is_short); break;
        case 3: expect_level(h, bytes.below(static_cast<uint32_t>(hmf_level_count(h)) + 1)); break;
        case 4: {
            hmf_solve_options options = any_solve_options(bytes);
            options.start = f;
            last = foliation_of(h, never, memory_is_short, [&](auto out, hmf_error* error) {
                return hmf_solve(h, nullptr, &options, nullptr, out, error);
            });
            break;
        }
        default: any_use(bytes, h, f, loops, memory_is_short);
        }
    }
}

// Divides any triangles.  The status that hmf_build has to have, if they are one component; else negative.
hmf_status expect_components(const Surface& surface, size_t vertices, const hmf_build_options& build,
                             bool memory_is_short) {
    const size_t triangles = surface.triangles.size() / 3;
    hmf_component_set* made = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_components(surface.positions.data(), vertices, surface.triangles.data(), triangles,
                                             &build, nullptr, &made, &error);
    const Owned<hmf_component_set> set(made);
    expect_status(status, error, {1, 2, 3});
    FUZZ_ASSERT(memory_is_short || status / 100 != 2);
    FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
    if (!set) return -1;
    size_t used = 0, first_edge = 0, first_triangle = 0;
    for (uint64_t k = 0; k < set->count; ++k) {
        const hmf_component& c = set->list[k];
        FUZZ_ASSERT(c.first_vertex == used && c.first_edge == first_edge && c.first_triangle == first_triangle);
        for (uint64_t v = used; v < used + c.vertex_count; ++v)
            FUZZ_ASSERT(set->vertex_component[set->whole_vertices[v]] == k
                        && set->vertex_part[set->whole_vertices[v]] == v - used);
        for (uint64_t t = first_triangle; t < first_triangle + c.triangle_count; ++t)
            for (size_t s = 0; s < 3; ++s)
                FUZZ_ASSERT(set->whole_vertices[used + set->part_triangles[3 * t + s]]
                            == surface.triangles[3 * size_t{set->whole_triangles[t]} + s]);
        used += static_cast<size_t>(c.vertex_count);
        first_edge += static_cast<size_t>(c.edge_count);
        first_triangle += static_cast<size_t>(c.triangle_count);
        FUZZ_ASSERT(c.status == HMF_OK || c.status / 100 == 3);
    }
    FUZZ_ASSERT(used == set->used_vertex_count && first_edge == set->edge_count && first_triangle == triangles);
    return set->count == 1 && used == vertices ? set->list[0].status : -1;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Meter meter;
    meter_now = &meter;
    hmf_build_options build = sized<hmf_build_options>();
    build.allocate = Meter::take;
    build.release = Meter::give;
    build.allocator_user = &meter;
    build.coarsest = 20 + bytes.byte();
    if (bytes.rarely()) {
        // Of an older header; not one that ends between the hooks and their user.
        uint32_t end = bytes.below(sizeof build + 1);
        if (end % 16 != 1) end -= end % 8; // else a size that no structure has
        if (end > offsetof(hmf_build_options, allocate) && end < offsetof(hmf_build_options, position_stride))
            end = offsetof(hmf_build_options, allocate);
        build.struct_size = end;
    }
    if (bytes.rarely()) build.ratio = coordinate(bytes);
    if (bytes.rarely()) build.collapse = static_cast<int32_t>(bytes.below(6)) - 1;
    bool memory_is_short = false;
    if (bytes.rarely()) {
        build.memory_limit = 1 + bytes.byte() * uint64_t{2048};
        if (build.struct_size > offsetof(hmf_build_options, memory_limit)) meter.limit = build.memory_limit;
        memory_is_short = true;
    }
    if (bytes.rarely()) {
        meter.fail = 1 + bytes.byte();
        memory_is_short = true;
    }
    // What is built: bytes, tori; also with marked vertices, mollified, larger, with a stride.
    const uint8_t kind = bytes.byte();
    enum { plain = 3, marked, ball, mollified, large, strided };
    const int sort = kind % 2 ? plain : std::max<int>(plain, kind / 2 % 9);
    Surface surface = kind % 2 ? anything(bytes) : sort == ball ? sphere(bytes) : chain_of_tori(bytes, sort >= large);
    const size_t vertices = surface.positions.size() / 3, triangles = surface.triangles.size() / 3;
    std::vector<uint32_t> marks;
    if (sort == marked || sort == ball) {
        for (uint32_t i = bytes.below(9); i > 0; --i)
            marks.push_back((bytes.byte() * 7u + bytes.byte()) % static_cast<uint32_t>(vertices));
        if (!bytes.rarely()) {
            std::sort(marks.begin(), marks.end());
            marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
        }
        hmf_mark_set* proposed = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_suggest_marks(surface.positions.data(), vertices, surface.triangles.data(),
                                                    triangles, &build, nullptr, &proposed, &error);
        const Owned<hmf_mark_set> set(proposed);
        expect_status(status, error, {1, 2, 3});
        FUZZ_ASSERT((proposed != nullptr) == (status == HMF_OK));
        if (set) FUZZ_ASSERT(set->count <= 24 && (set->count >= 4 || sort == marked));
        for (size_t i = 0; set && i < set->count; ++i) FUZZ_ASSERT(set->vertices[i] < vertices);
        if (set && bytes.byte() % 2 == 0) marks.assign(set->vertices, set->vertices + set->count);
        build.marked_vertices = marks.data();
        build.marked_count = marks.size();
    } else if (sort == mollified) {
        build.mollify = (1 + bytes.below(20)) / 1000.0;
        // A vertex on top of a neighbour, or on the line between two.
        const uint32_t* const corner = &surface.triangles[(bytes.byte() * 7u + bytes.byte()) % triangles * 3];
        const double share = bytes.below(3) / 2.0;
        if (std::max({corner[0], corner[1], corner[2]}) < vertices)
            for (size_t c = 0; c < 3; ++c)
                surface.positions[3 * corner[0] + c] =
                    share * surface.positions[3 * corner[1] + c] + (1 - share) * surface.positions[3 * corner[2] + c];
    } else if (sort == strided) {
        build.position_stride = 8 * (3 + bytes.below(4));
        const size_t doubles = static_cast<size_t>(build.position_stride / 8);
        std::vector<double> spread(vertices * doubles - (doubles - 3), NAN);
        for (size_t v = 0; v < vertices; ++v)
            std::copy_n(&surface.positions[3 * v], 3, spread.begin() + static_cast<ptrdiff_t>(doubles * v));
        surface.positions = std::move(spread);
    }
    marks_now = build.struct_size > offsetof(hmf_build_options, marked_count) ? marks.size() : 0;
    const hmf_status alone = expect_components(surface, vertices, build, memory_is_short);
    meter.peak = 0;
    hmf_hierarchy* h = nullptr;
    hmf_error error{};
    hmf_status status =
        hmf_build(surface.positions.data(), vertices, surface.triangles.data(), triangles, &build, nullptr, &h, &error);
    if (h && build.struct_size == sizeof build)
        FUZZ_ASSERT(hmf_hierarchy_memory(h) == meter.used
                    && hmf_memory_estimate(vertices, triangles, &build) >= meter.peak);
    expect_status(status, error, {1, 2, 3});
    FUZZ_ASSERT((h != nullptr) == (status == HMF_OK));
    FUZZ_ASSERT(memory_is_short || status / 100 != 2);
    FUZZ_ASSERT(memory_is_short || alone < 0 || alone == status);
    if (h) {
        const uint64_t held = meter.held = meter.used;
        FUZZ_ASSERT((hmf_genus(h) >= 1 || marks_now >= 4) && hmf_level_count(h) >= 1);
        LoopArrays loops;
        any_loops(bytes, h, loops);
        {
            hmf_foliation* made = nullptr;
            error = hmf_error{};
            status = hmf_initialize(h, &loops.set, nullptr, &made, &error);
            const Owned<hmf_foliation> f(made);
            expect_status(status, error, {1, 2, 4});
            FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
            if (f) expect_foliation(h, f.get(), memory_is_short);
        }
        FUZZ_ASSERT(meter.used == held);
        Stop stop;
        hmf_solve_options solve = sized<hmf_solve_options>();
        solve.method = static_cast<int32_t>(bytes.below(4));
        solve.iteration_limit = 1 + bytes.below(30);
        if (bytes.rarely()) solve.tolerance = coordinate(bytes);
        if (bytes.rarely()) solve.stop_level = bytes.below(4);
        if (bytes.rarely()) {
            stop.at = 1 + bytes.byte();
            stop.answer = 1 + static_cast<int32_t>(bytes.below(2));
        }
        hmf_control control = sized<hmf_control>();
        control.progress = Stop::call;
        control.progress_user = &stop;
        hmf_foliation* made = nullptr;
        error = hmf_error{};
        meter.begin_call();
        status = hmf_solve(h, bytes.byte() % 4 ? nullptr : &loops.set, &solve, &control, &made, &error);
        expect_status(status, error, {0, 1, 2, 4});
        FUZZ_ASSERT(memory_is_short || status / 100 != 2);
        FUZZ_ASSERT(status != HMF_CANCELLED || stop.at > 0);
        FUZZ_ASSERT(status == HMF_CANCELLED
                    || (made != nullptr) == (status < HMF_CANCELLED || status == HMF_LIMIT_CLASS));
        if (made) {
            const hmf_report* report = hmf_foliation_report(made);
            FUZZ_ASSERT(report && report->poles == 0 && report->bad_flips_left == 0);
            FUZZ_ASSERT(hmf_foliation_level(made) == solve.stop_level);
            expect_foliation(h, made, memory_is_short);
        }
        // Each of the two may go first.
        const bool hierarchy_first = bytes.byte() % 2;
        if (bytes.byte() % 2) any_values(bytes, h, memory_is_short);
        if (made) any_calls(bytes, h, made, loops, memory_is_short);
        if (hierarchy_first) hmf_destroy(h);
        hmf_foliation_destroy(made);
        FUZZ_ASSERT(meter.used == (hierarchy_first ? 0 : held));
        if (!hierarchy_first) hmf_destroy(h);
    }
    FUZZ_ASSERT(meter.used == 0);
    FUZZ_ASSERT(hmf_version() > 0 && std::strlen(hmf_status_string(status)) > 3
                && std::strlen(hmf_status_string(static_cast<hmf_status>(size % 1000))) > 3);
    return 0;
}
