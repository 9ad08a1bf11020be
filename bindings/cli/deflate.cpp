#include "deflate.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <utility>

namespace cli {

namespace {

constexpr unsigned END = 256, SYMBOLS = 286, SHORTEST = 4, LONGEST = 258;

// Symbol of a length, bits that follow it, and their value.
struct Length {
    uint16_t symbol;
    uint8_t extra, bits;
};

// Groups of four lengths, each with one bit more than the one before.
Length length_of(unsigned length) {
    if (length == LONGEST) return {285, 0, 0};
    unsigned extra = 0;
    while (length - 3 >= 8u << extra) ++extra;
    const unsigned base = extra ? 4u << extra : 0;
    return {static_cast<uint16_t>(257 + 4 * extra + (extra ? 4 : 0) + ((length - 3 - base) >> extra)),
            static_cast<uint8_t>(extra), static_cast<uint8_t>((length - 3) & ((1u << extra) - 1))};
}

// Calls literal(byte) and run(length): a run repeats the previous byte.
template <class Literal, class Run>
void for_tokens(const uint8_t* bytes, size_t size, const Literal& literal, const Run& run) {
    for (size_t at = 0; at < size;) {
        const uint8_t byte = bytes[at];
        literal(byte);
        size_t end = ++at;
        const uint64_t eight = byte * uint64_t{0x0101010101010101u};
        while (end + 8 <= size && std::memcmp(bytes + end, &eight, 8) == 0) end += 8;
        while (end < size && bytes[end] == byte) ++end;
        while (end - at >= SHORTEST) {
            const size_t length = std::min<size_t>(LONGEST, end - at);
            run(static_cast<unsigned>(length));
            at += length;
        }
        for (; at < end; ++at) literal(byte);
    }
}

// Lowest bit first.
class BitWriter {
public:
    explicit BitWriter(size_t bytes) : out_(bytes + 16, '\0') {}
    void put(uint32_t bits, unsigned count) { // at most 32
        pending_ |= uint64_t{bits} << count_;
        count_ += count;
        if (count_ < 32) return;
        if (size_ + 8 > out_.size()) out_.resize(2 * out_.size());
        for (unsigned k = 0; k < 4; ++k) out_[size_ + k] = static_cast<char>(pending_ >> (8 * k) & 0xff);
        size_ += 4;
        pending_ >>= 32;
        count_ -= 32;
    }
    unsigned odd() const { return count_ % 8; }
    std::string take() {
        while (count_ > 0) {
            const unsigned count = std::min(8u, count_);
            out_[size_++] = static_cast<char>(pending_ & 0xff);
            pending_ >>= count;
            count_ -= count;
        }
        out_.resize(size_);
        return std::move(out_);
    }

private:
    std::string out_;
    size_t size_ = 0;
    uint64_t pending_ = 0;
    unsigned count_ = 0;
};

// The codes of given lengths: shorter before longer, then by symbol.  Turned round, for they begin with their highest
// bit.
std::vector<uint16_t> codes_of(const std::vector<uint8_t>& lengths) {
    std::array<unsigned, 17> next{};
    for (const uint8_t length : lengths) next[length + 1u] += length > 0;
    for (unsigned l = 1; l < 16; ++l) next[l + 1] = (next[l + 1] + next[l]) << 1; // of length l: in next[l]
    std::vector<uint16_t> codes(lengths.size(), 0);
    for (size_t s = 0; s < lengths.size(); ++s) {
        const unsigned length = lengths[s], code = length ? next[length]++ : 0;
        for (unsigned k = 0; k < length; ++k)
            codes[s] = static_cast<uint16_t>(codes[s] | (code >> k & 1) << (length - 1 - k));
    }
    return codes;
}

// The lengths of the codes, themselves coded.
void put_codes(BitWriter& out, const std::vector<uint8_t>& lengths) {
    static constexpr unsigned order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    // One distance: 1, a code of one bit.
    std::vector<uint8_t> all = lengths;
    all.push_back(1);
    std::vector<std::pair<uint8_t, uint8_t>> told; // symbol, how many zeros
    for (size_t s = 0; s < all.size();) {
        size_t end = s;
        while (end < all.size() && all[end] == 0 && end - s < 138) ++end;
        if (end - s >= 11) told.emplace_back(uint8_t{18}, static_cast<uint8_t>(end - s - 11));
        else if (end - s >= 3) told.emplace_back(uint8_t{17}, static_cast<uint8_t>(end - s - 3));
        else end = s + 1, told.emplace_back(all[s], uint8_t{0});
        s = end;
    }
    std::vector<uint32_t> counts(19, 0);
    for (const auto& t : told) ++counts[t.first];
    const std::vector<uint8_t> of_lengths = code_lengths(counts, 7);
    const std::vector<uint16_t> codes = codes_of(of_lengths);
    out.put(static_cast<uint32_t>(lengths.size() - 257), 5);
    out.put(0, 5);
    out.put(19 - 4, 4);
    for (const unsigned s : order) out.put(of_lengths[s], 3);
    for (const auto& [symbol, zeros] : told) {
        out.put(codes[symbol], of_lengths[symbol]);
        if (symbol >= 17) out.put(zeros, symbol == 17 ? 3 : 7);
    }
}

} // namespace

// Package-merge (Larmore, Hirschberg 1990): at each length the leaves and the pairs of what is at the length before, in
// order of weight; of the last the first 2n - 2 are chosen, of each before the two of each chosen pair.  A code is as
// long as the number of lengths at which its leaf is chosen.
std::vector<uint8_t> code_lengths(const std::vector<uint32_t>& counts, unsigned longest) {
    struct Item {
        uint64_t weight;
        bool is_leaf;
    };
    std::vector<uint8_t> lengths(counts.size(), 0);
    std::vector<size_t> symbols;
    for (size_t s = 0; s < counts.size(); ++s)
        if (counts[s] > 0) symbols.push_back(s);
    if (symbols.size() == 1) lengths[symbols[0]] = 1;
    if (symbols.size() < 2) return lengths;
    std::stable_sort(symbols.begin(), symbols.end(), [&](size_t a, size_t b) { return counts[a] < counts[b]; });
    std::vector<Item> leaves;
    for (const size_t s : symbols) leaves.push_back({counts[s], true});
    std::vector<std::vector<Item>> rounds{leaves};
    while (rounds.size() < longest) {
        const std::vector<Item>& last = rounds.back();
        std::vector<Item> pairs, merged;
        for (size_t k = 0; k + 1 < last.size(); k += 2) pairs.push_back({last[k].weight + last[k + 1].weight, false});
        std::merge(leaves.begin(), leaves.end(), pairs.begin(), pairs.end(), std::back_inserter(merged),
                   [](const Item& a, const Item& b) { return a.weight < b.weight; });
        rounds.push_back(std::move(merged));
    }
    size_t chosen = 2 * symbols.size() - 2;
    for (size_t round = rounds.size(); round-- > 0;) {
        size_t chosen_leaves = 0;
        for (size_t k = 0; k < chosen; ++k) chosen_leaves += rounds[round][k].is_leaf;
        for (size_t k = 0; k < chosen_leaves; ++k) ++lengths[symbols[k]];
        chosen = 2 * (chosen - chosen_leaves);
    }
    return lengths;
}

std::string deflated_block(const uint8_t* bytes, size_t size, bool is_last) {
    std::array<Length, LONGEST + 1> lengths_of{};
    for (unsigned l = 3; l <= LONGEST; ++l) lengths_of[l] = length_of(l);
    std::vector<uint32_t> counts(SYMBOLS, 0);
    for_tokens(
        bytes, size, [&](uint8_t byte) { ++counts[byte]; },
        [&](unsigned length) { ++counts[lengths_of[length].symbol]; });
    counts[END] = 1;
    const std::vector<uint8_t> lengths = code_lengths(counts, 15);
    const std::vector<uint16_t> codes = codes_of(lengths);
    BitWriter out(size / 4);
    out.put(is_last, 1);
    out.put(2, 2); // codes are told
    put_codes(out, lengths);
    for_tokens(
        bytes, size, [&](uint8_t byte) { out.put(codes[byte], lengths[byte]); },
        [&](unsigned length) {
            const Length l = lengths_of[length];
            // Behind it the distance: 1, a bit 0.
            out.put(codes[l.symbol] | uint32_t{l.bits} << lengths[l.symbol], lengths[l.symbol] + l.extra + 1u);
        });
    out.put(codes[END], lengths[END]);
    if (!is_last) {
        // An empty block of plain bytes begins on a whole byte.
        out.put(0, 3);
        if (out.odd()) out.put(0, 8 - out.odd());
        out.put(0xffff0000u, 32);
    }
    return out.take();
}

} // namespace cli
