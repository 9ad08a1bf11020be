// Compression of filtered rows of pictures: RFC 1951 with runs of one byte and the best codes for each part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cli {

// One block that ends on a whole byte, so that blocks of several parts follow each other.
std::string deflated_block(const uint8_t* bytes, size_t size, bool is_last);

// Lengths of the codes of a prefix code, at most so long, that is best for symbols that occur so often; 0: never.
std::vector<uint8_t> code_lengths(const std::vector<uint32_t>& counts, unsigned longest);

} // namespace cli
