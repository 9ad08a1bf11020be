// The manual page and the completions of shells, from the tables of options.
#pragma once

#include <functional>
#include <string>

#include "options.hpp"

namespace cli {

// Calls what it is given with the table of each command.
using DescribeAll = std::function<void(const Describe&)>;

enum class Shell { bash, zsh, fish };
std::string completion(Shell shell, const DescribeAll& all);
std::string manual_page(const std::string& version, const DescribeAll& all); // roff

} // namespace cli
