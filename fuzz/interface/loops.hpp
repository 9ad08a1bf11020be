// Loops made of bytes: the library's, walks, anything.
#pragma once

#include <vector>

#include "host.hpp"
#include "surfaces.hpp"

namespace fuzz {

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

// Closed walks over neighbors: some steps out, and back on a shortest way.
inline void walks(Bytes& bytes, const hmf_hierarchy* h, LoopArrays& loops, uint64_t count) {
    const size_t level = static_cast<size_t>(loops.set.level);
    const bool vertices = loops.set.element_kind == HMF_PATH_VERTICES;
    const auto mesh = level_of(h, level, true);
    if (!mesh) return;
    std::vector<uint32_t> ends(mesh->edge_vertices, mesh->edge_vertices + 2 * mesh->edge_count);
    if (!vertices) {
        std::fill(ends.begin(), ends.end(), HMF_NONE);
        for (uint32_t c = 0; c < 3 * mesh->triangle_count; ++c) {
            const size_t e = mesh->triangle_edges[c];
            ends[2 * e + (ends[2 * e] != HMF_NONE)] = c / 3;
        }
    }
    std::vector<std::vector<uint32_t>> next(vertices ? mesh->vertex_count : mesh->triangle_count);
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

inline void any_loops(Bytes& bytes, const hmf_hierarchy* h, LoopArrays& loops) {
    const uint32_t levels = static_cast<uint32_t>(hmf_hierarchy_describe(h)->level_count);
    loops.set.level = bytes.rarely() ? levels + bytes.byte() : bytes.below(levels);
    loops.set.element_kind = bytes.rarely() ? bytes.byte() : 1 + static_cast<int32_t>(bytes.below(2));
    uint64_t count = 0, total = 0;
    hmf_error error{};
    const uint8_t choice = bytes.byte();
    if (choice % 2 && loops.set.level < levels) {
        // The library's own, perhaps spoiled.
        loops.set.element_kind = HMF_PATH_TRIANGLES;
        const int32_t kind = HMF_LOOPS_CUT + static_cast<int32_t>(bytes.below(4));
        const bool in_space = kind == HMF_LOOPS_HANDLE || kind == HMF_LOOPS_TUNNEL; // which a dented surface may not be
        hmf_loop_set* made = nullptr;
        const hmf_status status = hmf_loops(h, loops.set.level, kind, nullptr, &made, &error);
        const Owned<hmf_loop_set> owner(made);
        // With boundary: on level 0 only.
        const bool on_part = hmf_hierarchy_describe(h)->boundary_count > 0;
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

} // namespace fuzz
