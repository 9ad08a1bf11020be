// A number with its noun: "1 loop", "2 loops", "2 vertices".
#pragma once

#include <string>

namespace cli {

inline std::string counted(size_t number, const std::string& noun, const std::string& plural) {
    return std::to_string(number) + " " + (number == 1 ? noun : plural);
}
inline std::string counted(size_t number, const std::string& noun) { return counted(number, noun, noun + "s"); }

} // namespace cli
