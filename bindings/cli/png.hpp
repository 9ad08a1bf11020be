// Pictures as PNG (ISO/IEC 15948).
#pragma once

#include <string>

#include "render.hpp"

namespace cli {

std::string png_of(const Image& image);

} // namespace cli
