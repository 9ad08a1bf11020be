// Calls on a hierarchy and on a foliation, chosen by bytes.
#pragma once

#include "applications.hpp"

namespace fuzz {

// Numbers as values: refused with a reason, or a foliation, perhaps with poles.
inline void any_values(Bytes& bytes, const hmf_hierarchy* h, bool memory_is_short) {
    const size_t level = bytes.below(static_cast<uint32_t>(hmf_hierarchy_describe(h)->level_count));
    const auto mesh = level_of(h, level, memory_is_short);
    if (!mesh) return;
    const uint32_t* const ends = mesh->edge_vertices;
    std::vector<double> values(mesh->edge_count, 0);
    // Differences of heights of the vertices are closed.
    const uint32_t period = 1 + bytes.below(8);
    for (size_t e = 0; e < values.size(); ++e)
        values[e] = std::abs(static_cast<double>(ends[2 * e] % period) - static_cast<double>(ends[2 * e + 1] % period));
    if (bytes.rarely()) values[bytes.byte() % values.size()] = coordinate(bytes);
    hmf_foliation* made = nullptr;
    hmf_error error{};
    meter_now->begin_call();
    const hmf_status status = hmf_foliation_from_values(h, level, values.data(), values.size(), nullptr, &made, &error);
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

inline hmf_solve_options any_solve_options(Bytes& bytes) {
    hmf_solve_options options = sized<hmf_solve_options>();
    options.method = static_cast<int32_t>(bytes.below(3));
    options.iteration_limit = 1 + bytes.below(30);
    if (bytes.rarely()) options.time_limit = 1e-6 * bytes.byte();
    return options;
}

// A few more calls on a foliation, which the next ones may go on from.
inline void any_calls(Bytes& bytes, const hmf_hierarchy* h, const hmf_foliation* first, const LoopArrays& loops,
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
            const size_t level = bytes.below(static_cast<uint32_t>(hmf_hierarchy_describe(h)->level_count));
            auto moved = result_of<hmf_foliation>(
                {}, memory_is_short, [&](auto out) { return hmf_interpolate(f, level, nullptr, out, nullptr); });
            if (!moved) break;
            FUZZ_ASSERT(hmf_foliation_level(moved.get()) == level && !hmf_foliation_report(moved.get()));
            FUZZ_ASSERT(hmf_foliation_unit(moved.get()) == hmf_foliation_unit(f));
            expect_closed(h, moved.get(), memory_is_short);
            expect_singularities(h, moved.get(), memory_is_short);
            last = std::move(moved);
            break;
        }
        case 2: expect_measures(h, f, memory_is_short); break;
        case 3:
            expect_level(h, bytes.below(static_cast<uint32_t>(hmf_hierarchy_describe(h)->level_count) + 1),
                         memory_is_short);
            break;
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

} // namespace fuzz
