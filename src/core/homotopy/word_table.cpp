// Open addressing; see word_table.hpp.
#include "word_table.hpp"

#include <cstring>

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

size_t WordTable::place(const uint32_t* word, size_t n) const {
    const size_t mask = table_.size() - 1;
    size_t i = static_cast<size_t>(hash_of(word, n)) & mask;
    const auto is_other = [&](uint32_t number) {
        return length(number) != n || (n > 0 && std::memcmp(this->word(number), word, n * sizeof(uint32_t)) != 0);
    };
    while (table_[i] != NONE && is_other(table_[i])) i = (i + 1) & mask;
    return i;
}

Done WordTable::grow() {
    Memory& memory = offset_.memory();
    if (table_.empty() && !offset_.push(0)) return false;
    if (!table_.allocate_filled(memory, table_.empty() ? 256 : 4 * table_.size(), NONE)) return false;
    for (uint32_t w = 0; w < count(); ++w) table_[place(word(w), length(w))] = w;
    return true;
}

Done WordTable::add(const Walk& word, uint32_t& number) {
    if (2 * (count() + 1) > table_.size() && !grow()) return false;
    uint32_t& entry = table_[place(word.data(), word.size())];
    number = entry;
    if (number != NONE) return true;
    number = static_cast<uint32_t>(count());
    for (const uint32_t letter : word)
        if (!letter_.push(letter)) return false;
    if (!offset_.push(letter_.size())) return false;
    entry = number;
    return true;
}

} // namespace hmf
