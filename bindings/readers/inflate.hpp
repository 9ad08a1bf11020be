// Deflate streams (RFC 1951) and gzip files (RFC 1952), unpacked.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace readers {

bool is_gzip(std::string_view bytes);

// All members of a gzip file, with their checksums.  Throws MeshError where it is damaged, cut, or larger than `most`.
std::string gunzip(std::string_view bytes, size_t most = size_t{1} << 33);

// One deflate stream at the begin of the bytes; `used` gets its length.  Throws MeshError.
std::string inflate(std::string_view bytes, size_t& used, size_t most);

} // namespace readers
