// Transport between levels: prolongation ([W] 4.2) is the log of the hierarchy
// backwards, restriction the log forwards, mesh and foliation together.
#include "state.hpp"

#include "../base/prefetch.hpp"

namespace hmf {

Done State::allocate(const hmf_hierarchy& h, size_t finest, Memory& memory) {
    hierarchy = &h;
    copy_.release();
    const Mesh& mesh = h.levels[finest].mesh;
    return out_.allocate(memory, mesh.vertex_count) && value_.allocate(memory, mesh.edge_count)
        && foliation.allocate_scratch(mesh.vertex_count, memory);
}

void State::load(size_t at, Triangulation which) {
    const Mesh& from = at == 0 && which == Triangulation::input ? hierarchy->input : hierarchy->levels[at].mesh;
    copy_.release();
    foliation.mesh = from;
    foliation.mesh.out = out_.data();
    std::memcpy(out_.data(), from.out, from.vertex_count * sizeof(uint32_t));
    foliation.value = value_.data();
    level = at;
    triangulation = which;
}

Done State::own(Call& call) {
    if (is_own()) return true;
    if (!copy_.allocate_sides(foliation.mesh, call.memory)) return false;
    foliation.mesh = copy_.sides_of(foliation.mesh, call.parallel);
    return true;
}

void State::share(const Mesh& same) {
    Mesh& mesh = foliation.mesh;
    mesh.vertex_count = same.vertex_count;
    mesh.edge_count = same.edge_count;
    mesh.face_count = same.face_count;
    mesh.origin = same.origin;
    mesh.next = same.next;
    mesh.face = same.face;
    copy_.release();
}

// Flips change values using the mesh, one after the other. Splits need only edge numbers, so the mesh after them can be
// the one that the hierarchy keeps.
Done State::refine(Call& call) {
    const Level& finer = hierarchy->levels[level - 1];
    if (finer.flip_end > finer.flip_begin && !own(call)) return false;
    for (size_t i = finer.flip_end; i-- > finer.flip_begin;) {
        if (!call.work(16 + 8 * foliation.take_walked())) return false;
        flip_foliation(foliation, hierarchy->flips[i], true, statistics, bad_flip);
        if (listener && !listener->flipped(listener->user, foliation.mesh, hierarchy->flips[i], true)) return false;
    }
    const Mesh& split = level == 1 ? hierarchy->input : finer.mesh;
    share(split);
    call.parallel.copy(out_.data(), split.out, split.vertex_count);
    int64_t* const value = foliation.value;
    const Collapse* const log = hierarchy->collapses;
    const auto undo = [=](size_t i, size_t begin) {
        constexpr size_t ahead = 8;
        if (i >= begin + ahead) {
            const Collapse& soon = log[i - ahead];
            for (const uint32_t h : {soon.h, soon.jk, soon.lj, soon.ki, soon.il}) prefetch(&value[edge_of(h)]);
        }
        split_values(value, log[i]);
    };
    if (!undo_collapses(*hierarchy, finer, call, 0, true, undo)) return false;
    const size_t count = finer.collapse_end - finer.collapse_begin;
    if (listener && !listener->were_split(listener->user, foliation.mesh, log + finer.collapse_begin, count, call))
        return false;
    --level;
    triangulation = Triangulation::input;
    return true;
}

Done State::coarsen(Call& call, RestrictionScratch& scratch) {
    if (!own(call)) return false;
    const Level& level_now = hierarchy->levels[level];
    const Level& coarser = hierarchy->levels[level + 1];
    Mesh& mesh = foliation.mesh;
    for (size_t i = level_now.collapse_begin; i < level_now.collapse_end; ++i) {
        if (!call.work(16 + 8 * foliation.take_walked())) return false;
        if (!collapse_foliation(foliation, hierarchy->collapses[i], scratch)) return false;
    }
    mesh.vertex_count = coarser.mesh.vertex_count;
    mesh.edge_count = coarser.mesh.edge_count;
    mesh.face_count = coarser.mesh.face_count;
    for (size_t i = level_now.flip_begin; i < level_now.flip_end; ++i) {
        if (!call.work(16 + 8 * foliation.take_walked())) return false;
        flip_foliation(foliation, hierarchy->flips[i], false, statistics);
    }
    ++level;
    triangulation = Triangulation::intrinsic;
    return true;
}

Done State::go_to(size_t target, Call& call) {
    if (level == 0 && triangulation == Triangulation::intrinsic && !to_input(call)) return false;
    while (level > target)
        if (!refine(call)) return false;
    if (level < target) {
        RestrictionScratch scratch;
        if (!scratch.allocate(call.memory)) return false;
        while (level < target)
            if (!coarsen(call, scratch)) return false;
    }
    return true;
}

Done State::to_intrinsic(Call& call) {
    largest_input_value = largest_value(foliation, call.parallel);
    if (hierarchy->intrinsic_flip_count > 0 && !own(call)) return false;
    for (size_t i = 0; i < hierarchy->intrinsic_flip_count; ++i) {
        if (!call.work(16 + 8 * foliation.take_walked())) return false;
        flip_foliation(foliation, hierarchy->intrinsic_flips[i], false, statistics);
        const uint32_t edge = hierarchy->intrinsic_flips[i];
        if (listener && !listener->flipped(listener->user, foliation.mesh, edge, false)) return false;
    }
    triangulation = Triangulation::intrinsic;
    // The half-edges are equal, array by array: flips are exact reversals.
    const Mesh &mesh = foliation.mesh, &same = hierarchy->levels[0].mesh;
    const auto are_equal = [&](const uint32_t* a, const uint32_t* b) {
        return std::memcmp(a, b, size_t{2} * same.edge_count * sizeof(uint32_t)) == 0;
    };
    (void)are_equal;
    assert(are_equal(mesh.origin, same.origin) && are_equal(mesh.next, same.next) && are_equal(mesh.face, same.face));
    (void)mesh;
    share(same);
    return true;
}

Done State::to_input(Call& call) {
    listener = nullptr;
    if (hierarchy->intrinsic_flip_count > 0 && !own(call)) return false;
    for (size_t i = hierarchy->intrinsic_flip_count; i-- > 0;) {
        if (!call.work(16 + 8 * foliation.take_walked())) return false;
        flip_foliation(foliation, hierarchy->intrinsic_flips[i], true, statistics);
    }
    triangulation = Triangulation::input;
    return true;
}

} // namespace hmf
