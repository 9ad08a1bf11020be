#include "part_system.hpp"

#include "steering.hpp"

namespace hmf {

Done PartSystem::list_unknowns(const TwistedModel& model, Array<uint32_t>& number, Memory& memory) {
    size_t count = 0, entries = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        if (model.rests[v]) number[v] = NONE;
        if (number[v] == NONE) continue;
        number[v] = static_cast<uint32_t>(count++);
        entries += model.offset[v + 1] - model.offset[v];
    }
    if (!unknown_.allocate(memory, count) || !offset_.allocate(memory, count + 1) || !column_.allocate(memory, entries)
        || !entry_.allocate(memory, entries) || !diagonal_.allocate(memory, count) || !right_.allocate(memory, count)
        || !d_.allocate_filled(memory, count, 0))
        return false;
    for (uint32_t v = 0; v < model.count; ++v)
        if (number[v] != NONE) unknown_[number[v]] = v;
    return true;
}

Done PartSystem::take(const TwistedModel& model, Array<uint32_t>& number, Call& call) {
    if (!list_unknowns(model, number, call.memory)) return false;
    uint32_t at = 0;
    for (size_t i = 0; i < unknown_.size(); ++i) {
        const uint32_t v = unknown_[i];
        offset_[i] = at;
        for (uint32_t t = model.offset[v]; t < model.offset[v + 1]; ++t) {
            const uint32_t other = number[model.column[t]];
            if (other == NONE) continue;
            column_[at] = other;
            entry_[at++] = model.entry[t];
        }
        diagonal_[i] = model.diagonal[v];
        right_[i] = model.right[v];
    }
    offset_[unknown_.size()] = at;
    return multigrid_.setup(matrix(), call.memory, &call);
}

Done PartSystem::solve(TwistedModel& model, double accuracy, Call& call) {
    multigrid_.solve(matrix(), right_.data(), d_.data(), accuracy, steering::iterations_with_new_setup, call);
    for (size_t i = 0; i < unknown_.size(); ++i) model.d[unknown_[i]] = d_[i];
    return !call.cancelled() && !call.finishing();
}

} // namespace hmf
