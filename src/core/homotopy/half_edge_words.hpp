// A word for each half-edge, that of its twin read backwards.  Words are kept once, and edges have their numbers;
// nearly all are empty, and a bit says which are not, so that the others cost a look at a small table.
#pragma once

#include "../mesh/mesh.hpp"
#include "word_table.hpp"

namespace hmf {

class HalfEdgeWords {
public:
    // All empty.
    Done start(uint32_t edge_capacity, Memory& memory) {
        words_.start(memory);
        return bits_.allocate_filled(memory, edge_capacity / 64 + size_t{1}, uint64_t{0})
            && word_.allocate(memory, edge_capacity);
    }

    bool has(uint32_t edge) const { return bits_[edge / 64] >> edge % 64 & 1; }
    void clear(uint32_t edge) { bits_[edge / 64] &= ~(uint64_t{1} << edge % 64); }
    Done set(uint32_t half_edge, const Walk& word) {
        uint32_t number = 0;
        if (word.empty()) clear(edge_of(half_edge));
        else if (!words_.add(word, number)) return false;
        else refer(half_edge, number, false);
        return true;
    }
    // to gets the word of from.
    void copy(uint32_t from, uint32_t to) {
        if (!has(edge_of(from))) clear(edge_of(to));
        else refer(to, word_[edge_of(from)] >> 1, (word_[edge_of(from)] ^ from) & 1);
    }

    size_t length(uint32_t half_edge) const {
        const uint32_t e = edge_of(half_edge);
        return has(e) ? words_.length(word_[e] >> 1) : 0;
    }
    // visit(letter, backwards), in the order of the half-edge.
    template <class Visit>
    Done for_letters(uint32_t half_edge, Visit visit) const {
        const uint32_t e = edge_of(half_edge);
        if (!has(e)) return true;
        const uint32_t* const letters = words_.word(word_[e] >> 1);
        const size_t n = words_.length(word_[e] >> 1);
        const bool backwards = ((word_[e] ^ half_edge) & 1) != 0;
        for (size_t i = 0; i < n; ++i)
            if (!visit(letters[backwards ? n - 1 - i : i], backwards)) return false;
        return true;
    }

private:
    void refer(uint32_t half_edge, uint32_t number, bool backwards) {
        const uint32_t e = edge_of(half_edge);
        bits_[e / 64] |= uint64_t{1} << e % 64;
        word_[e] = 2 * number + ((half_edge & 1) != static_cast<uint32_t>(backwards));
    }

    Array<uint64_t> bits_; // per edge: the word is not empty
    Array<uint32_t> word_; // per edge: 2 * its number, + 1 if it is that of half-edge 2e + 1
    WordTable words_;
};

} // namespace hmf
