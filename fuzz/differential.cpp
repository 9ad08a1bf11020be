// Two routes to one minimum.  The same surface and loops, with vertices and triangles in another order, another
// hierarchy and another method to start with: the minimum is unique, so both have the same energy; no pole on either
// way.  Scaled by a power of two: the same bits.
#include <cmath>
#include <cstring>
#include <numeric>

#include "random_plate.hpp"

namespace {

using namespace fuzz;

struct Route {
    Owned<hmf_hierarchy> hierarchy;
    Owned<hmf_foliation> foliation;
    hmf_status status = HMF_OK;
    double energy() const { return hmf_foliation_report(foliation.get())->energy; }
};

hmf_hierarchy_options any_build(Bytes& bytes) {
    hmf_hierarchy_options build = sized<hmf_hierarchy_options>();
    build.coarsest = 20 + bytes.byte();
    build.ratio = 0.05 + 0.9 * bytes.byte() / 256;
    build.collapse = static_cast<int32_t>(bytes.below(4));
    return build;
}

Owned<hmf_hierarchy> build(const Plate& plate, const hmf_hierarchy_options& options) {
    hmf_hierarchy* made = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_hierarchy_create(plate.positions.data(), plate.vertex_count(), plate.triangles.data(),
                                                   plate.triangle_count(), &options, nullptr, &made, &error);
    if (status) std::fprintf(stderr, "%s\n", error.message);
    FUZZ_ASSERT(status == HMF_OK && hmf_hierarchy_describe(made)->genus == plate.genus);
    return Owned<hmf_hierarchy>(made);
}

Route solve(const Plate& plate, const hmf_hierarchy_options& options, const hmf_loop_set& loops, bool sweeps_first) {
    Route route;
    route.hierarchy = build(plate, options);
    hmf_solve_options wish = sized<hmf_solve_options>();
    hmf_foliation* made = nullptr;
    hmf_error error{};
    if (sweeps_first) {
        wish.method = HMF_METHOD_WHITEHEAD;
        wish.iteration_limit = 3;
        const hmf_status status = hmf_solve(route.hierarchy.get(), &loops, &wish, nullptr, &made, &error);
        FUZZ_ASSERT(made && (status == HMF_OK || status == HMF_LIMIT_ITERATIONS));
        FUZZ_ASSERT(hmf_foliation_report(made)->poles == 0);
        const Owned<hmf_foliation> first(made);
        wish = sized<hmf_solve_options>();
        made = nullptr;
        route.status = hmf_relax(first.get(), &wish, nullptr, &made, &error);
    } else {
        route.status = hmf_solve(route.hierarchy.get(), &loops, &wish, nullptr, &made, &error);
    }
    route.foliation.reset(made);
    if (!made) std::fprintf(stderr, "%s\n", error.message);
    FUZZ_ASSERT(made);
    FUZZ_ASSERT(hmf_foliation_report(made)->poles == 0 && hmf_foliation_report(made)->bad_flips_left == 0);
    FUZZ_ASSERT(hmf_foliation_report(made)->class_state != HMF_CLASS_LOST);
    return route;
}

std::vector<uint32_t> any_order(size_t n, uint64_t& state) {
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    for (size_t i = n; i > 1; --i) std::swap(order[i - 1], order[next_random(state) % i]);
    return order;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    const Plate plate(bytes);
    const hmf_hierarchy_options first_build = any_build(bytes), second_build = any_build(bytes);
    const Owned<hmf_hierarchy> hierarchy = build(plate, first_build);
    hmf_loop_set* made = nullptr;
    const int32_t kind = bytes.byte() % 2 ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT;
    FUZZ_ASSERT(hmf_loops(hierarchy.get(), 0, kind, nullptr, &made, nullptr) == HMF_OK);
    const Owned<hmf_loop_set> owner(made);
    std::vector<double> weights;
    for (size_t c = 0; c < made->count; ++c) weights.push_back(0.25 * (1 + bytes.below(40)));
    hmf_loop_set loops = *made;
    loops.weights = weights.data();
    const Route first = solve(plate, first_build, loops, false);

    // The other order: new numbers of vertices and triangles, each triangle from another corner on.
    uint64_t state = bytes.byte();
    const std::vector<uint32_t> vertex = any_order(plate.vertex_count(), state),
                                triangle = any_order(plate.triangle_count(), state);
    Plate other = plate;
    for (size_t v = 0; v < vertex.size(); ++v)
        for (size_t c = 0; c < 3; ++c) other.positions[3 * vertex[v] + c] = plate.positions[3 * v + c];
    for (size_t t = 0; t < triangle.size(); ++t) {
        const size_t turn = next_random(state) % 3;
        for (size_t c = 0; c < 3; ++c)
            other.triangles[3 * triangle[t] + (c + turn) % 3] = vertex[plate.triangles[3 * t + c]];
    }
    std::vector<uint32_t> elements(made->elements, made->elements + made->offsets[made->count]);
    for (uint32_t& t : elements) t = triangle[t];
    hmf_loop_set moved = loops;
    moved.elements = elements.data();
    const Route second = solve(other, second_build, moved, bytes.byte() % 4 == 0);
    if (first.status == HMF_OK && second.status == HMF_OK)
        FUZZ_ASSERT(std::fabs(first.energy() - second.energy()) <= 1e-6 * first.energy());

    // Another unit of length.
    Plate scaled = plate;
    const double unit = std::ldexp(1.0, static_cast<int>(bytes.below(60)) - 30);
    for (double& x : scaled.positions) x *= unit;
    const Route third = solve(scaled, first_build, loops, false);
    size_t count = 0, count_scaled = 0;
    const double* const values = hmf_foliation_values(first.foliation.get(), &count);
    const double* const values_scaled = hmf_foliation_values(third.foliation.get(), &count_scaled);
    FUZZ_ASSERT(count == count_scaled && first.energy() == third.energy());
    FUZZ_ASSERT(std::memcmp(values, values_scaled, count * sizeof *values) == 0);
    return 0;
}
