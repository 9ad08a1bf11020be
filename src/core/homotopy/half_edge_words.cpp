// Words by their contents; see half_edge_words.hpp.
#include "half_edge_words.hpp"

namespace hmf {

namespace {

uint64_t hash_of(const uint32_t* items, size_t n) {
    uint64_t x = n;
    for (size_t i = 0; i < n; ++i) {
        x = (x ^ items[i]) * 0x9e3779b97f4a7c15u;
        x ^= x >> 29;
    }
    return x;
}

} // namespace

Done HalfEdgeWords::start(uint32_t edge_capacity, Memory& memory) {
    memory_ = &memory;
    letter_.start(memory);
    offset_.start(memory);
    return bits_.allocate_filled(memory, edge_capacity / 64 + size_t{1}, uint64_t{0})
        && word_.allocate(memory, edge_capacity) && offset_.push(0) && table_.allocate_filled(memory, 1024, NONE);
}

Done HalfEdgeWords::set(uint32_t half_edge, const Walk& word) {
    uint32_t number = 0;
    if (word.empty()) {
        clear(edge_of(half_edge));
        return true;
    }
    if (!number_of(word, number)) return false;
    refer(half_edge, number, false);
    return true;
}

Done HalfEdgeWords::number_of(const Walk& word, uint32_t& number) {
    const size_t count = offset_.size() - 1;
    if (2 * (count + 1) > table_.size()) {
        Array<uint32_t> old;
        old.swap(table_);
        Memory& memory = *memory_;
        if (!table_.allocate_filled(memory, 4 * old.size(), NONE)) return false;
        for (uint32_t w = 0; w < count; ++w) {
            size_t i = hash_of(&letter_[offset_[w]], offset_[w + 1] - offset_[w]) & (table_.size() - 1);
            while (table_[i] != NONE) i = (i + 1) & (table_.size() - 1);
            table_[i] = w;
        }
    }
    const size_t n = word.size();
    size_t i = hash_of(word.data(), n) & (table_.size() - 1);
    for (; table_[i] != NONE; i = (i + 1) & (table_.size() - 1)) {
        const uint64_t begin = offset_[table_[i]];
        if (offset_[table_[i] + 1] - begin == n
            && std::memcmp(&letter_[begin], word.data(), n * sizeof(uint32_t)) == 0) {
            number = table_[i];
            return true;
        }
    }
    number = static_cast<uint32_t>(count);
    for (const uint32_t s : word)
        if (!letter_.push(s)) return false;
    if (!offset_.push(letter_.size())) return false;
    table_[i] = number;
    return true;
}

} // namespace hmf
