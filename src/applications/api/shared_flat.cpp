#include "shared_flat.hpp"

#include <new>

namespace hmf {

hmf_status load_solved_in_unit_of_values(const hmf_foliation& foliation, State& state, Call& call) {
    double unit = 1;
    if (load_solved(foliation, state, unit, call)) return call.status();
    return foliation.solved_bits > 0 ? coarsen_unit(state, static_cast<uint32_t>(foliation.solved_bits), call) : HMF_OK;
}

namespace {

void free_part(Kept* kept, const hmf_hierarchy& h) {
    SharedFlat* const part = static_cast<SharedFlat*>(kept);
    Memory own(h.allocate, h.release, h.allocator_user, 0, sizeof *part);
    part->~SharedFlat();
    own.give(part, sizeof *part);
}

hmf_status build_flat(const hmf_foliation& foliation, FlatConeMetric& flat, Call& call) {
    State state;
    const hmf_status status = load_solved_in_unit_of_values(foliation, state, call);
    return status ? status : flat_cone_metric(state, 0, flat, call);
}

} // namespace

SharedFlat::SharedFlat(const hmf_hierarchy& h, uint64_t used) :
    Kept{sizeof *this, free_part}, memory(h.allocate, h.release, h.allocator_user, h.memory_limit, used) {}

hmf_status shared_flat(const hmf_foliation& foliation, Entry& entry, const FlatConeMetric*& out) {
    out = nullptr;
    if (!is_minimum(foliation)) return HMF_OK;
    Kept* part = foliation.kept.load(std::memory_order_acquire);
    if (!part) {
        const hmf_hierarchy& h = *foliation.hierarchy;
        void* block = entry.memory.take(sizeof(SharedFlat));
        if (!block) return entry.call.out_of_memory();
        const uint64_t before = entry.memory.used();
        SharedFlat* made = new (block) SharedFlat(h, before);
        Call call = entry.part(made->memory, 0.8);
        made->memory.keep_arrays();
        const hmf_status status = build_flat(foliation, made->flat, call);
        made->memory.release_kept();
        if (status) {
            free_part(made, h);
            return call.status();
        }
        made->bytes += made->memory.used() - before;
        if (foliation.kept.compare_exchange_strong(part, made, std::memory_order_acq_rel)) part = made;
        else free_part(made, h);
    }
    out = &static_cast<const SharedFlat*>(part)->flat;
    return HMF_OK;
}

} // namespace hmf
