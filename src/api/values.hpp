// Values of the interface (double, the caller's numbering) to and from the
// integers of a state.  The unit is a power of two, so both ways are exact.
#pragma once

#include "../solve/state.hpp"

namespace hmf {

// Options of the caller, read with their struct_size: missing fields become
// zero, a longer structure must end in zeros.
template <class Options>
bool copy_options(const Options* from, Options& to) {
    std::memset(static_cast<void*>(&to), 0, sizeof to);
    if (!from) return true;
    uint32_t size = 0;
    std::memcpy(&size, from, sizeof size);
    if (size < sizeof size || size > 4096) return false;
    const unsigned char* bytes = reinterpret_cast<const unsigned char*>(from);
    for (size_t i = sizeof to; i < size; ++i)
        if (bytes[i] != 0) return false;
    std::memcpy(static_cast<void*>(&to), from, size < sizeof to ? size : sizeof to);
    return true;
}

constexpr int weight_bits = 48; // the largest weight is below 2^48 units, so values up to 32 weights are exact doubles

// Unit for weights whose largest is `largest`.
double unit_of_weights(double largest);

// The caller's values of a level -> state.foliation.value; state is loaded on
// the level (level 0: input side).  Finds the unit.  Validates: finite,
// exact, triangle inequalities, parity, and no poles unless they are allowed.
hmf_status import_values(State& state, const double* values, size_t count, double& unit, bool poles_allowed,
                         Call& call);

// state.foliation.value -> the caller's values (level 0: from the input side).
// Fails, with nothing written, if a value has more bits than a double.
hmf_status export_values(const State& state, double unit, double* values, Call& call);

// Internal half-edge of side 0 of a triangle of the caller: the side of its
// first edge that is followed by its second one; and its face.
uint32_t internal_side(const hmf_hierarchy& h, size_t triangle);
uint32_t internal_face(const hmf_hierarchy& h, size_t triangle);

// Half-edge of side 0 of each triangle of the interface, on the level of the
// state (level 0: input side).
bool first_sides(const State& state, Array<uint32_t>& side, Memory& memory);

// Checks of the arguments that most calls share.
hmf_status check_level(const hmf_hierarchy* hierarchy, size_t level, Call& call);
hmf_status check_count(size_t count, size_t needed, const char* what, Call& call);
hmf_status check_capacity(size_t capacity, size_t needed, const char* what, Call& call);

// Call object of a query: no progress, allocations counted on top of the hierarchy.
struct Query {
    Memory memory;
    Call call;
    Query(const hmf_hierarchy* h, hmf_error* error) :
        memory(h ? h->allocate : nullptr, h ? h->release : nullptr, h ? h->allocator_user : nullptr,
               h ? h->memory_limit : 0, h ? h->memory.used() : 0),
        call(memory, error, nullptr, nullptr) {}
    hmf_status check(const hmf_hierarchy* h, size_t level, const void* out) {
        if (check_level(h, level, call)) return call.status();
        if (!out)
            return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                             "The output is NULL. Give an array of the size that hmf_level_counts tells.");
        return HMF_OK;
    }
};

} // namespace hmf
