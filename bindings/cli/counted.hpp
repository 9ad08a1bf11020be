// A number with its noun: "1 loop", "2 loops".
#pragma once

#include <string>

namespace cli {

inline std::string counted(size_t number, const std::string& noun) {
    return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

} // namespace cli
