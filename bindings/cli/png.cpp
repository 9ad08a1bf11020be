// Bands of rows are filtered (each byte minus what the rule of Paeth expects) and deflated on their own; each is a
// chunk of the file.
#include "png.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "deflate.hpp"

namespace cli {

namespace {

constexpr size_t BAND = 64; // rows

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

std::string chunk(const std::string& name, const std::string& data) {
    const std::string body = name + data;
    return big_endian(static_cast<uint32_t>(data.size())) + body + big_endian(crc(body));
}

// The checksum of RFC 1950.
struct Adler {
    static constexpr uint32_t BASE = 65521;
    uint32_t a = 1, b = 0;

    void add(const std::vector<uint8_t>& bytes) {
        // The sums of so many bytes fit into 32 bits.
        constexpr size_t RUN = 4096;
        for (size_t from = 0; from < bytes.size(); from += RUN) {
            const size_t count = std::min(RUN, bytes.size() - from);
            uint32_t sum = 0, weighted = 0;
            for (size_t k = 0; k < count; ++k) {
                sum += bytes[from + k];
                weighted += static_cast<uint32_t>(count - k) * bytes[from + k];
            }
            b = static_cast<uint32_t>((b + uint64_t{a} * count + weighted) % BASE);
            a = (a + sum) % BASE;
        }
    }
    // What follows, that was added to a new one.
    void join(const Adler& next, size_t count) {
        b = static_cast<uint32_t>((b + uint64_t{a + BASE - 1} * (count % BASE) + next.b) % BASE);
        a = (a + next.a + BASE - 1) % BASE;
    }
};

// out = here - the one of left, above and corner that is nearest to left + above - corner.
void paeth(uint8_t* __restrict out, const uint8_t* __restrict here, const uint8_t* __restrict above, size_t row) {
    for (size_t x = 0; x < std::min<size_t>(3, row); ++x) out[x] = static_cast<uint8_t>(here[x] - above[x]);
    for (size_t x = 3; x < row; ++x) {
        const int16_t left = here[x - 3], up = above[x], corner = above[x - 3];
        const int16_t to_left = static_cast<int16_t>(std::abs(up - corner)),
                      to_up = static_cast<int16_t>(std::abs(left - corner)),
                      to_corner = static_cast<int16_t>(std::abs(left + up - 2 * corner));
        const int16_t side = to_left <= to_up ? left : up, to_side = std::min(to_left, to_up);
        out[x] = static_cast<uint8_t>(here[x] - (to_side <= to_corner ? side : corner));
    }
}

std::vector<uint8_t> filtered(const Image& image, size_t first, size_t end) {
    const size_t row = 3 * size_t{image.width};
    const std::vector<uint8_t> nothing(row, 0);
    std::vector<uint8_t> bytes((row + 1) * (end - first));
    for (size_t y = first; y < end; ++y) {
        const uint8_t* const here = image.rgb.data() + y * row;
        uint8_t* const out = &bytes[(y - first) * (row + 1)];
        *out = 4; // Paeth
        paeth(out + 1, here, y ? here - row : nothing.data(), row);
    }
    return bytes;
}

} // namespace

std::string png_of(const Image& image, const Workers& workers) {
    struct Part {
        std::string chunk;
        Adler adler;
        size_t count = 0;
    };
    std::vector<Part> parts((image.height + BAND - 1) / BAND);
    workers.each(parts.size(), [&](size_t k) {
        const std::vector<uint8_t> bytes = filtered(image, k * BAND, std::min<size_t>(image.height, (k + 1) * BAND));
        parts[k].count = bytes.size();
        parts[k].adler.add(bytes);
        parts[k].chunk =
            chunk("IDAT", (k ? "" : "\x78\x01") + deflated_block(bytes.data(), bytes.size(), k + 1 == parts.size()));
    });
    // 8 bits, red green blue, no interlace.
    std::string png =
        "\x89PNG\r\n\x1a\n"
        + chunk("IHDR", big_endian(image.width) + big_endian(image.height) + std::string("\x08\x02\0\0\0", 5));
    Adler all;
    for (const Part& part : parts) {
        png += part.chunk;
        all.join(part.adler, part.count);
    }
    return png + chunk("IDAT", big_endian(all.b << 16 | all.a)) + chunk("IEND", "");
}

} // namespace cli
