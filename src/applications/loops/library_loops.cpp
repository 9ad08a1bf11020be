// Loops of the library: found on a coarse level, then carried to the requested level. A search there would take 20 s on
// a million triangles; carried loops are as short, because they are shortened on each level.
#include "library_loops.hpp"

#include "../../core/base/cyclic.hpp"
#include "carry_loops.hpp"
#include "class_lengths.hpp"
#include "handle_system.hpp"

#include <algorithm>

namespace hmf {

namespace {

// A coarser level does not represent the surface: handles are shorter or longer there by a half. Many handles have
// different sizes, and the small ones get few of the vertices.
constexpr uint64_t VERTICES_OF_HANDLE = 420, MANY_HANDLES = 10, MOST_VERTICES = 10000;

hmf_status find_loops(const hmf_hierarchy& h, size_t found, int32_t kind, LoopCare care, Call& call, Loops& out) {
    const Mesh& mesh = loop_mesh(h, found);
    const double* position = h.levels[found].position;
    ClassLengths lengths(h, found, call, care);
    if (h.genus == 0 && kind == HMF_LOOPS_CUT) return mark_loops(mesh, position, lengths, call, out);
    if (h.genus == 0 && (kind == HMF_LOOPS_HANDLE || kind == HMF_LOOPS_TUNNEL))
        return call.fail(HMF_ERROR_MESH_GENUS, HMF_ELEMENT_NONE, 0,
                         "A surface of genus 0 has no handles. Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS, which go around "
                         "marked vertices, or give loops.");
    switch (kind) {
    case HMF_LOOPS_CUT: return cut_system(mesh, position, nullptr, lengths, call, out);
    case HMF_LOOPS_HANDLE: return handle_system(h, found, true, call, out);
    case HMF_LOOPS_TUNNEL: return handle_system(h, found, false, call, out);
    case HMF_LOOPS_PANTS: return pants_decomposition(mesh, position, lengths, call, out);
    default:
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There is no loop kind %d. Use HMF_LOOPS_*.",
                         static_cast<int>(kind));
    }
}

} // namespace

hmf_status library_loops(const hmf_hierarchy& h, size_t level, int32_t kind, Call& call, Loops& out, LoopCare care) {
    const size_t found = care == LoopCare::quick ? h.level_count - 1 : std::max(level, search_level(h));
    const hmf_status status = find_loops(h, found, kind, care, call, out);
    return status ? status : carry_to_finer(h, found, level, call, out);
}

size_t search_level(const hmf_hierarchy& h) {
    const uint64_t wanted = h.genus < MANY_HANDLES ? VERTICES_OF_HANDLE * h.genus : MOST_VERTICES;
    size_t level = h.level_count - 1;
    while (level > 0 && h.levels[level].mesh.vertex_count < USUAL_COARSEST) --level;
    while (level > 1 && h.levels[level].mesh.vertex_count < wanted) --level;
    return level;
}

hmf_status carry_to_finer(const hmf_hierarchy& h, size_t from, size_t level, Call& call, Loops& out) {
    if (level == from) return pull_tight(loop_mesh(h, level), call, out);
    LoopCarrier carrier;
    if (!carrier.load(h, from, level, out, call.memory)) return call.out_of_memory();
    while (carrier.level() > level) {
        if (!carrier.refine(call) || !carrier.read(0, out.count(), out, call)) return call.stopped();
        const hmf_status status = shorten_loops(carrier.mesh(), h.levels[carrier.level()].position, call, out);
        if (status) return status;
        if (carrier.level() > level && !carrier.replace(out)) return call.out_of_memory();
    }
    return pull_tight(loop_mesh(h, level), call, out);
}

hmf_status name_by_triangles(const hmf_hierarchy& h, size_t level, Call& call, Loops& loops, Array<uint32_t>& faces) {
    const Mesh& mesh = loop_mesh(h, level);
    if (!faces.allocate(call.memory, loops.crossings.size())) return call.out_of_memory();
    for (size_t i = 0; i < faces.size(); ++i) faces[i] = mesh.face[loops.crossings[i]];
    Loops again;
    const hmf_status status =
        read_loops(mesh, HMF_PATH_TRIANGLES, loops.count(), loops.offsets.data(), faces.data(), call, again);
    if (status) return status;
    for (size_t c = 0; c < loops.count(); ++c) {
        const size_t n = loops.length(c);
        if (again.length(c) == n && same_cycle(again.loop(c), loops.loop(c), n)) continue;
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, c,
                         "Loop %llu passes triangles of level %llu that share several edges, so triangles do not name "
                         "it. Use a finer level.",
                         static_cast<unsigned long long>(c), static_cast<unsigned long long>(level));
    }
    return HMF_OK;
}

} // namespace hmf
