#include "curve_classes.hpp"

namespace hmf {

namespace {

constexpr size_t CLASSES_STRIDE = 4096; // flips or splits between two reports

} // namespace

hmf_status CurveClasses::start(const hmf_hierarchy& hierarchy, size_t level, size_t finest, Call& call) {
    hierarchy_ = &hierarchy;
    level_ = level;
    const Mesh& largest = hierarchy.levels[finest].mesh;
    if (!arrays_.allocate(largest, call.memory)) return call.out_of_memory();
    mesh_ = arrays_.of(level == 0 ? hierarchy.input : hierarchy.levels[level].mesh);
    return words_.start(mesh_, largest.edge_count, call) ? HMF_OK : call.stopped();
}

hmf_status CurveClasses::refine(Call& call) {
    const Level& finer = hierarchy_->levels[--level_];
    for (size_t i = finer.flip_end; i-- > finer.flip_begin;) {
        if (i % CLASSES_STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        unflip(mesh_, hierarchy_->flips[i]);
        if (!words_.flipped(mesh_, hierarchy_->flips[i], true)) return call.out_of_memory();
    }
    // The hierarchy keeps what the splits make.
    mesh_ = arrays_.of(level_ == 0 ? hierarchy_->input : finer.mesh);
    const size_t count = finer.collapse_end - finer.collapse_begin;
    return words_.were_split(mesh_, hierarchy_->collapses + finer.collapse_begin, count, call) ? HMF_OK
                                                                                               : call.stopped();
}

hmf_status CurveClasses::to_intrinsic(Call& call) {
    for (size_t i = 0; i < hierarchy_->intrinsic_flip_count; ++i) {
        if (!call.work(128, 0, false)) return call.was_cancelled();
        flip(mesh_, hierarchy_->intrinsic_flips[i]);
        if (!words_.flipped(mesh_, hierarchy_->intrinsic_flips[i], false)) return call.out_of_memory();
    }
    return HMF_OK;
}

hmf_status CurveClasses::name(const Loops& loops, ClassTable& names, Call& call) const {
    names.start(call.memory);
    const auto half_edge = [&](uint64_t i) { return loops.crossings[i]; };
    for (size_t c = 0; c < loops.count(); ++c) {
        if (!call.tick(0)) return call.was_cancelled();
        if (!names.add(mesh_, words_, loops.offsets[c], loops.offsets[c + 1], half_edge)) return call.out_of_memory();
    }
    return HMF_OK;
}

hmf_status CurveClasses::name(const Cylinders& cylinders, ClassTable& names, Call& call) const {
    names.start(call.memory);
    for (const Cylinder& c : cylinders.list) {
        if (!call.tick(0)) return call.was_cancelled();
        if (!add_boundary(mesh_, words_, cylinders.graph, c.lower, names)) return call.out_of_memory();
    }
    return HMF_OK;
}

} // namespace hmf
