// The options of a command as one table, which parsing, help, checks and the report read.
//
// An option is named in its row only; what it sets is the target of the row.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../readers/json.hpp"

namespace cli {

struct Choice {
    int32_t* target;
    std::vector<std::pair<const char*, int32_t>> names;
};

struct Option {
    enum Role { SETTING, INPUT, OUTPUT };
    // A bool is a flag.  A list of strings may be given several times, a list of numbers has commas.  A number that is
    // optional may be left out behind the name of its option, which means 0.
    using Target = std::variant<bool*, uint64_t*, double*, std::optional<double>*, std::string*,
                                std::vector<std::string>*, std::vector<double>*, Choice>;

    const char* name; // with its dashes; without them it goes by its place
    Target target;
    const char* value; // in the help
    const char* help;
    Role role = SETTING;
    const char* range = "";      // of a number, such as "(0, 0.5]"
    const char* extensions = ""; // that a file may have, such as ".csv .npy"; "-" stands for standard input or output
    const char* beside = "";     // extensions of files that are written beside an .obj; then "-" is refused
    const char* needs = "";      // has no effect unless one of these is given
    const char* excludes = "";   // these must not be given
    bool optional = false;       // goes by its place, but has a default
    std::vector<std::string> given{};

    bool is_flag() const { return std::holds_alternative<bool*>(target); }
    bool by_place() const { return name[0] != '-'; }

    Option in(const char* r) const { return changed(&Option::range, r); }
    Option requires_one_of(const char* n) const { return changed(&Option::needs, n); }
    Option without(const char* n) const { return changed(&Option::excludes, n); }
    Option or_default() const { return changed(&Option::optional, true); }
    Option reads(const char* e) const { return changed(&Option::role, INPUT).changed(&Option::extensions, e); }
    Option writes(const char* e, const char* b = "") const {
        return changed(&Option::role, OUTPUT).changed(&Option::extensions, e).changed(&Option::beside, b);
    }

private:
    template <class T, class V>
    Option changed(T Option::*field, V v) const {
        Option copy = *this;
        copy.*field = v;
        return copy;
    }
};
using Options = std::vector<Option>;

// Sets the targets, and checks everything that can be checked without reading a file.  Throws Failure(EXIT_USAGE).
void parse(Options& options, const std::vector<std::string>& words, const std::string& command);
// What the help says of an option, with its range and its default.
std::string description_of(const Option& o);
void print_help(const Options& options, const std::string& command, const std::string& about);

// What is done with the table of a command; print_help is one.
using Describe = std::function<void(const Options& options, const std::string& command, const std::string& about)>;

// Every option with its value as it is now; null: none.  Outputs only where they were given.
readers::Json values_of(const Options& options);

// Files that will be written, those beside others as well.
std::vector<std::string> outputs_of(const Options& options);

// FILE.obj -> FILE.mtl
std::string with_extension(const std::string& path, const std::string& extension);

} // namespace cli
