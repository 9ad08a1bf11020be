// From fine to coarse: a collapse on mesh and foliation together.
#pragma once

#include "whitehead.hpp"

namespace hmf {

// Room that restriction needs for one vertex after the other.
struct RestrictionScratch {
    Star star;
    Array<Rings::Side> side;
    Memory* memory = nullptr;
    Done allocate(Memory& memory);
    Done room_for(uint32_t degree); // grows star and side
};

// Moves the origin of h to its end, so that F becomes 0, with all that has to
// move along.  Exact: the class is kept, no pole before: no pole after.
Done move_to_end(Foliation& foliation, uint32_t h, RestrictionScratch& scratch);

// Moves the end of h to its origin (F becomes 0) and collapses h as recorded.
// Exact: the class is kept, no pole before: no pole after.
Done collapse_foliation(Foliation& foliation, const Collapse& c, RestrictionScratch& scratch);

} // namespace hmf
