// A result of the interface: one structure with its arrays, in one block.
//
//     | header | structure | array | array | ...
//              ^ what the caller gets, and gives back to hmf_free
//
// The header keeps the allocator, so that the block needs no other object.
#pragma once

#include "entry.hpp"

namespace hmf {

class ResultBlock {
public:
    // An array that `field` of the structure is to point to, with the elements of source.
    template <class Structure, class T>
    void array(const Structure& structure, const T* const& field, size_t count, const T* source) {
        add(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&structure), count, sizeof(T),
            source);
    }
    // The same without elements: they are filled in after make().
    template <class Structure, class T>
    void room(const Structure& structure, const T* const& field, size_t count) {
        array<Structure, T>(structure, field, count, nullptr);
    }

    // Allocates the block and copies the structure and the sources into it.
    // nullptr: out of memory, here or earlier in the call.
    template <class Structure>
    Structure* make(const Structure& structure, const hmf_hierarchy& hierarchy, Call& call) {
        return static_cast<Structure*>(make_bytes(&structure, sizeof structure, hierarchy, call));
    }

private:
    static constexpr int MOST_ARRAYS = 11;
    struct Part {
        ptrdiff_t field;
        size_t bytes;
        const void* source;
    };
    void add(ptrdiff_t field, size_t count, size_t size, const void* source);
    void* make_bytes(const void* structure, size_t bytes, const hmf_hierarchy& hierarchy, Call& call);

    Part parts_[MOST_ARRAYS];
    int part_count_ = 0;
    bool too_large_ = false;
};

void free_block(const void* structure);

// The array of a fresh result, to be filled.
template <class T>
T* fill(const T* field) {
    return const_cast<T*>(field);
}

} // namespace hmf
