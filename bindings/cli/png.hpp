// Pictures as PNG (ISO/IEC 15948).
#pragma once

#include <string>

#include "canvas.hpp"

namespace cli {

// The same bytes with every number of threads.
std::string png_of(const Image& image, const Workers& workers = Workers());

} // namespace cli
