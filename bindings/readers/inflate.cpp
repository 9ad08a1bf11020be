#include "inflate.hpp"

#include <array>
#include <cstdint>

#include "byte_order.hpp"
#include "mesh_formats.hpp"

namespace readers {

namespace {

[[noreturn]] void damaged() { throw MeshError("the compressed data is damaged or cut; unpack the file and look"); }

class Bits {
public:
    explicit Bits(std::string_view bytes) : bytes_(bytes) {}

    uint32_t take(int count) {
        while (count_ < count) {
            if (at_ == bytes_.size()) damaged();
            bits_ |= uint64_t{static_cast<unsigned char>(bytes_[at_++])} << count_;
            count_ += 8;
        }
        const uint32_t value = static_cast<uint32_t>(bits_ & ((uint64_t{1} << count) - 1));
        bits_ >>= count;
        count_ -= count;
        return value;
    }
    // The rest of the byte is skipped.
    std::string_view take_bytes(size_t count) {
        if (count > bytes_.size() - at_) damaged();
        at_ += count;
        return bytes_.substr(at_ - count, count);
    }
    void to_byte() {
        at_ -= static_cast<size_t>(count_ / 8);
        bits_ = 0;
        count_ = 0;
    }
    size_t place() const { return at_ - static_cast<size_t>(count_ / 8); }

private:
    std::string_view bytes_;
    size_t at_ = 0;
    uint64_t bits_ = 0;
    int count_ = 0;
};

// Canonical codes by their lengths.
class Huffman {
public:
    Huffman(const uint8_t* lengths, size_t count) {
        for (size_t s = 0; s < count; ++s) ++counts_[lengths[s]];
        counts_[0] = 0;
        std::array<uint16_t, 16> next{};
        int left = 1;
        for (size_t length = 1; length < 16; ++length) {
            left = 2 * left - counts_[length];
            if (left < 0) damaged(); // more codes than there are
            next[length] = static_cast<uint16_t>(next[length - 1] + counts_[length - 1]);
        }
        for (size_t s = 0; s < count; ++s)
            if (lengths[s]) symbols_[next[lengths[s]]++] = static_cast<uint16_t>(s);
    }
    uint32_t take(Bits& bits) const {
        int code = 0, first = 0, index = 0;
        for (size_t length = 1; length < 16; ++length) {
            code |= static_cast<int>(bits.take(1));
            if (code - counts_[length] < first) return symbols_[static_cast<size_t>(index + code - first)];
            index += counts_[length];
            first = 2 * (first + counts_[length]);
            code *= 2;
        }
        damaged();
    }

private:
    std::array<uint16_t, 16> counts_{};
    std::array<uint16_t, 320> symbols_{};
};

class Inflate {
public:
    Inflate(std::string_view bytes, size_t most) : bits_(bytes), most_(most) {}

    std::string go(size_t& used) {
        bool is_last = false;
        while (!is_last) {
            is_last = bits_.take(1) != 0;
            switch (bits_.take(2)) {
            case 0: copy_stored(); break;
            case 1: read_fixed(); break;
            case 2: read_dynamic(); break;
            default: damaged();
            }
        }
        used = bits_.place();
        return std::move(out_);
    }

private:
    void check_size(size_t more) const {
        if (more > most_ - out_.size())
            throw MeshError("the compressed file has more than " + std::to_string(most_) + " bytes; unpack it first");
    }
    void copy_stored() {
        bits_.to_byte();
        const std::string_view head = bits_.take_bytes(4);
        const uint16_t length = load<uint16_t>(head.data()), inverse = load<uint16_t>(head.data() + 2);
        if ((length ^ inverse) != 0xffff) damaged();
        check_size(length);
        out_ += bits_.take_bytes(length);
    }
    void read_fixed() {
        std::array<uint8_t, 288> lengths;
        for (size_t s = 0; s < 288; ++s) lengths[s] = s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8;
        std::array<uint8_t, 30> distances;
        distances.fill(5);
        read_block(Huffman(lengths.data(), 288), Huffman(distances.data(), 30));
    }
    void read_dynamic() {
        const size_t literals = 257 + bits_.take(5), distances = 1 + bits_.take(5), codes = 4 + bits_.take(4);
        if (literals > 286 || distances > 30) damaged();
        constexpr uint8_t order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
        std::array<uint8_t, 320> lengths{};
        for (size_t c = 0; c < codes; ++c) lengths[order[c]] = static_cast<uint8_t>(bits_.take(3));
        const Huffman of_lengths(lengths.data(), 19);
        lengths.fill(0);
        for (size_t at = 0; at < literals + distances;) {
            const uint32_t symbol = of_lengths.take(bits_);
            if (symbol < 16) {
                lengths[at++] = static_cast<uint8_t>(symbol);
                continue;
            }
            if (symbol == 16 && at == 0) damaged();
            const uint8_t value = symbol == 16 ? lengths[at - 1] : uint8_t{0};
            const size_t times = symbol == 16 ? 3 + bits_.take(2)
                               : symbol == 17 ? 3 + bits_.take(3)
                                              : 11 + bits_.take(7);
            if (times > literals + distances - at) damaged();
            for (size_t k = 0; k < times; ++k) lengths[at++] = value;
        }
        read_block(Huffman(lengths.data(), literals), Huffman(lengths.data() + literals, distances));
    }
    void read_block(const Huffman& literals, const Huffman& distances) {
        constexpr uint16_t length_base[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                              31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
        constexpr uint8_t length_bits[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                             2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
        constexpr uint16_t distance_base[30] = {1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                                33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                                1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
        for (;;) {
            const uint32_t symbol = literals.take(bits_);
            if (symbol == 256) return;
            if (symbol < 256) {
                check_size(1);
                out_ += static_cast<char>(symbol);
                continue;
            }
            if (symbol > 285) damaged();
            const size_t length = length_base[symbol - 257] + bits_.take(length_bits[symbol - 257]);
            const uint32_t code = distances.take(bits_);
            if (code > 29) damaged();
            const size_t distance = distance_base[code] + bits_.take(code < 4 ? 0 : static_cast<int>(code / 2) - 1);
            if (distance > out_.size()) damaged();
            check_size(length);
            for (size_t k = 0; k < length; ++k) out_ += out_[out_.size() - distance];
        }
    }

    Bits bits_;
    size_t most_;
    std::string out_;
};

uint32_t crc32(std::string_view bytes) {
    static const std::array<uint32_t, 256> table = [] {
        std::array<uint32_t, 256> t{};
        for (uint32_t n = 0; n < 256; ++n) {
            t[n] = n;
            for (int k = 0; k < 8; ++k) t[n] = t[n] & 1 ? 0xedb88320u ^ t[n] >> 1 : t[n] >> 1;
        }
        return t;
    }();
    uint32_t crc = 0xffffffffu;
    for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xff] ^ crc >> 8;
    return ~crc;
}

// The length of the header of a member.
size_t gzip_header(std::string_view bytes) {
    constexpr size_t fixed = 10;
    if (bytes.size() < fixed || !is_gzip(bytes)) damaged();
    const unsigned flags = static_cast<unsigned char>(bytes[3]);
    size_t at = fixed;
    if (flags & 4) {
        if (bytes.size() < at + 2) damaged();
        at += 2 + load<uint16_t>(bytes.data() + at);
    }
    for (const unsigned text : {8u, 16u}) // name, comment
        if (flags & text) {
            const size_t end = at < bytes.size() ? bytes.find('\0', at) : bytes.npos;
            if (end == bytes.npos) damaged();
            at = end + 1;
        }
    if (flags & 2) at += 2;
    if (at > bytes.size()) damaged();
    return at;
}

} // namespace

bool is_gzip(std::string_view bytes) { return bytes.substr(0, 3) == "\x1f\x8b\x08"; }

std::string inflate(std::string_view bytes, size_t& used, size_t most) { return Inflate(bytes, most).go(used); }

std::string gunzip(std::string_view bytes, size_t most) {
    std::string all;
    while (is_gzip(bytes)) {
        bytes.remove_prefix(gzip_header(bytes));
        size_t used = 0;
        const std::string part = inflate(bytes, used, most - all.size());
        if (bytes.size() < used + 8) damaged();
        if (load<uint32_t>(bytes.data() + used) != crc32(part)
            || load<uint32_t>(bytes.data() + used + 4) != static_cast<uint32_t>(part.size()))
            damaged();
        bytes.remove_prefix(used + 8);
        if (all.empty()) all = part;
        else all += part;
    }
    return all;
}

} // namespace readers
