// Rows are filtered (each byte minus what the rule of Paeth expects), then deflated: RFC 1951 with the fixed Huffman
// codes, and matches found by hashes of four bytes.
#include "png.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

namespace cli {

namespace {

class Deflate {
public:
    explicit Deflate(const std::string& bytes) :
        in_(reinterpret_cast<const unsigned char*>(bytes.data())), size_(bytes.size()) {
        out_.reserve(size_ / 4);
        put(1, 1); // the last block
        put(1, 2); // fixed codes
        head_.assign(size_t{1} << HASH_BITS, 0);
        before_.assign(WINDOW, 0);
        for (size_t at = 0; at < size_;) {
            size_t distance = 0;
            const size_t length = longest_match(at, distance);
            if (length < SHORTEST) {
                put_symbol(in_[at]);
                insert(at++);
                continue;
            }
            put_match(static_cast<unsigned>(length), static_cast<unsigned>(distance));
            // Of a long match only the beginning is found again.
            const size_t end = at + length, known = std::min(end, at + 16);
            while (at < known) insert(at++);
            at = end;
        }
        put_symbol(256);
        put(0, 7); // whole bytes
    }
    const std::string& bytes() const { return out_; }

private:
    static constexpr size_t SHORTEST = 4, LONGEST = 258, WINDOW = 32768;
    static constexpr int HASH_BITS = 15, TRIES = 4;

    uint32_t first_four(size_t at) const {
        uint32_t four;
        std::memcpy(&four, in_ + at, 4);
        return four;
    }
    uint32_t hash(size_t at) const { return first_four(at) * 2654435761u >> (32 - HASH_BITS); }

    // Positions plus 1; 0: none.  Those below 2^32 bytes are found again.
    void insert(size_t at) {
        if (at + 4 > size_) return;
        uint32_t& head = head_[hash(at)];
        before_[at % WINDOW] = head;
        head = static_cast<uint32_t>(at + 1);
    }

    size_t longest_match(size_t at, size_t& distance) const {
        if (at + SHORTEST > size_) return 0;
        const size_t limit = std::min(LONGEST, size_ - at);
        const uint32_t four = first_four(at);
        size_t best = 0;
        uint32_t candidate = head_[hash(at)];
        for (int t = 0; t < TRIES && candidate > 0 && at - (candidate - 1) < WINDOW; ++t) {
            const size_t from = candidate - 1;
            if (from >= at) break; // beyond 2^32 bytes
            if (first_four(from) == four && (best == 0 || in_[from + best] == in_[at + best])) {
                size_t length = SHORTEST;
                while (length < limit && in_[from + length] == in_[at + length]) ++length;
                if (length > best) {
                    best = length;
                    distance = at - from;
                    if (length == limit) break;
                }
            }
            const uint32_t older = before_[from % WINDOW];
            if (older >= candidate) break; // overwritten
            candidate = older;
        }
        return best;
    }

    // Lowest bit first.
    void put(uint32_t bits, int count) {
        pending_ |= uint64_t{bits} << pending_count_;
        for (pending_count_ += count; pending_count_ >= 8; pending_count_ -= 8, pending_ >>= 8)
            out_ += static_cast<char>(pending_ & 0xff);
    }

    // Huffman codes begin with their highest bit.
    void put_code(uint32_t code, int count) {
        uint32_t turned = 0;
        for (int k = 0; k < count; ++k) turned |= (code >> k & 1) << (count - 1 - k);
        put(turned, count);
    }

    void put_symbol(unsigned symbol) {
        // The codes of bytes, turned once.
        static const std::array<std::array<uint16_t, 2>, 288> codes = [] {
            std::array<std::array<uint16_t, 2>, 288> table{};
            for (unsigned n = 0; n < table.size(); ++n) {
                const unsigned count = n < 144 ? 8 : n < 256 ? 9 : n < 280 ? 7 : 8;
                const unsigned code = n < 144 ? 0x30 + n
                                    : n < 256 ? 0x190 + n - 144
                                    : n < 280 ? n - 256
                                              : 0xc0 + n - 280;
                unsigned turned = 0;
                for (unsigned k = 0; k < count; ++k) turned |= (code >> k & 1) << (count - 1 - k);
                table[n] = {static_cast<uint16_t>(turned), static_cast<uint16_t>(count)};
            }
            return table;
        }();
        put(codes[symbol][0], codes[symbol][1]);
    }

    void put_match(unsigned length, unsigned distance) {
        if (length == LONGEST) put_symbol(285);
        else {
            // Groups of four, each with one extra bit more than the one before.
            unsigned extra = 0;
            while (length - 3 >= 8u << extra) ++extra;
            const unsigned base = extra ? 4u << extra : 0;
            put_symbol(257 + 4 * extra + (extra ? 4 : 0) + ((length - 3 - base) >> extra));
            put((length - 3) & ((1u << extra) - 1), static_cast<int>(extra));
        }
        unsigned extra = 0;
        while (distance - 1 >= 4u << extra) ++extra;
        const unsigned base = extra ? 2u << extra : 0;
        put_code(2 * extra + (extra ? 2 : 0) + ((distance - 1 - base) >> extra), 5);
        put((distance - 1) & ((1u << extra) - 1), static_cast<int>(extra));
    }

    const unsigned char* in_;
    size_t size_;
    std::string out_;
    uint64_t pending_ = 0;
    int pending_count_ = 0;
    std::vector<uint32_t> head_, before_;
};

std::string big_endian(uint32_t n) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift & 0xff);
    return bytes;
}

uint32_t crc(const std::string& bytes) {
    static const std::array<uint32_t, 256> table = [] {
        std::array<uint32_t, 256> made{};
        for (uint32_t n = 0; n < made.size(); ++n) {
            made[n] = n;
            for (int k = 0; k < 8; ++k) made[n] = (made[n] & 1) ? made[n] >> 1 ^ 0xedb88320u : made[n] >> 1;
        }
        return made;
    }();
    uint32_t c = 0xffffffffu;
    for (const char b : bytes) c = c >> 8 ^ table[(c ^ static_cast<unsigned char>(b)) & 0xff];
    return ~c;
}

uint32_t adler(const std::string& bytes) {
    uint32_t a = 1, b = 0;
    // The sums of so many bytes fit into 32 bits.
    constexpr size_t RUN = 5000;
    for (size_t from = 0; from < bytes.size(); from += RUN) {
        for (size_t k = from; k < std::min(bytes.size(), from + RUN); ++k) {
            a += static_cast<unsigned char>(bytes[k]);
            b += a;
        }
        a %= 65521;
        b %= 65521;
    }
    return b << 16 | a;
}

std::string chunk(const std::string& name, const std::string& data) {
    return big_endian(static_cast<uint32_t>(data.size())) + name + data + big_endian(crc(name + data));
}

std::string filtered(const Image& image) {
    const size_t row = 3 * size_t{image.width};
    std::string bytes((row + 1) * image.height, '\4'); // Paeth
    const std::vector<uint8_t> nothing(row, 0);
    for (size_t y = 0; y < image.height; ++y) {
        const uint8_t *const here = image.rgb.data() + y * row, *const above = y ? here - row : nothing.data();
        char* const out = &bytes[y * (row + 1) + 1];
        const auto filter = [&](size_t x, int left, int corner) {
            const int up = above[x];
            const int a = std::abs(up - corner), b = std::abs(left - corner), c = std::abs(left + up - 2 * corner);
            out[x] = static_cast<char>(here[x] - (a <= b && a <= c ? left : b <= c ? up : corner));
        };
        for (size_t x = 0; x < std::min<size_t>(3, row); ++x) filter(x, 0, 0);
        for (size_t x = 3; x < row; ++x) filter(x, here[x - 3], above[x - 3]);
    }
    return bytes;
}

} // namespace

std::string png_of(const Image& image) {
    const std::string pixels = filtered(image);
    // 8 bits, red green blue, no interlace.
    return "\x89PNG\r\n\x1a\n"
         + chunk("IHDR", big_endian(image.width) + big_endian(image.height) + std::string("\x08\x02\0\0\0", 5))
         + chunk("IDAT", "\x78\x01" + Deflate(pixels).bytes() + big_endian(adler(pixels))) + chunk("IEND", "");
}

} // namespace cli
