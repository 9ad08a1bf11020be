// A file that is written completely or throws Failure(EXIT_RESOURCES); "-" is standard output.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace cli {

class Output {
public:
    explicit Output(const std::string& path);
    ~Output();
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
    std::FILE* file() { return file_; }
    void close();

private:
    std::string path_;
    std::FILE* file_;
};

// A coordinate in a file that has floats; throws Failure(EXIT_BAD_INPUT) where it is larger than all of them.
float single_precision(double coordinate);

// What to take away from the coordinates of a file that has floats: the middle of the points where they lie so far from
// the origin that floats would lose digits of their shape, else 0.
using Place = std::array<double, 3>;
class FloatFrame {
public:
    void add(const double* point);
    Place origin() const;
    // Whether floats, relative to the origin, have one place for two different points.
    bool joins(const double* a, const double* b) const;

private:
    Place low_{}, high_{};
    bool is_empty_ = true;
};

// A sentence on standard error, where edges have no length in a file that has floats.
void warn_of_joined(const std::string& path, size_t edges);

// Throws unless a file of this name can be created: checked before the work, not after.
void check_writable(const std::string& path);

} // namespace cli
