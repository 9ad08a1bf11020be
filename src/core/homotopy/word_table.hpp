// Words by their contents: equal words have one number.
#pragma once

#include "../mesh/mesh.hpp"

namespace hmf {

using Walk = Array<uint32_t>; // letters of a word; a part of a closed one, or all of it

class WordTable {
public:
    void start(Memory& memory) {
        letter_.start(memory);
        offset_.start(memory);
        table_.start(memory);
    }
    size_t count() const { return offset_.empty() ? 0 : offset_.size() - 1; }
    const uint32_t* word(uint32_t number) const { return letter_.data() + offset_[number]; }
    size_t length(uint32_t number) const { return static_cast<size_t>(offset_[number + size_t{1}] - offset_[number]); }

    // NONE: it is not in the table.
    uint32_t find(const uint32_t* word, size_t n) const { return table_.empty() ? NONE : table_[place(word, n)]; }
    // Its number is count() if it is new.
    Done add(const Walk& word, uint32_t& number);

private:
    size_t place(const uint32_t* word, size_t n) const; // in table_, where it is or could be
    Done grow();

    Array<uint64_t> offset_; // of the words
    Array<uint32_t> letter_;
    Array<uint32_t> table_; // numbers of the words by their contents, NONE where free
};

} // namespace hmf
