// The flat surface of a foliation: the dearest thing that several uses need
// (two linear solves), so it is made once and kept.
#pragma once

#include "../parameterize/flat_surface.hpp"
#include "foliation_object.hpp"

namespace hmf {

struct SharedFlat {
    Memory memory;
    FlatSurface flat; // on the caller's side of the level
    const uint64_t before;
    // used: what counts towards the limit beside it.
    SharedFlat(const hmf_hierarchy& h, uint64_t used) :
        memory(h.allocate, h.release, h.allocator_user, h.memory_limit, used), before(used) {}
    uint64_t bytes() const { return sizeof *this + memory.used() - before; }
};

// What is kept with a foliation that is a minimum to 1e-8; out is NULL for
// others, whose flat surface depends on how they are improved first.  Any
// number of threads may ask: one result is kept, the others are freed.
[[nodiscard]] hmf_status shared_flat(const hmf_foliation& foliation, Entry& entry, const FlatSurface*& out);

void free_shared_flat(hmf_foliation& foliation);

} // namespace hmf
