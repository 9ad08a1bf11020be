#include "output.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "failure.hpp"

namespace cli {

namespace {

[[noreturn]] void refuse_path(const std::string& path, const char* what) {
    throw Failure(EXIT_RESOURCES, path + ": " + what + " (" + std::strerror(errno)
                                      + "); check the folder, the rights and the free space");
}

} // namespace

Output::Output(const std::string& path) : path_(path), file_(path == "-" ? stdout : std::fopen(path.c_str(), "wb")) {
    if (!file_) refuse_path(path_, "cannot be written");
    if (file_ == stdout) return;
    std::setvbuf(file_, nullptr, _IOFBF, 1u << 18);
}

Output::~Output() {
    if (file_ && file_ != stdout) std::fclose(file_);
}

void Output::close() {
    const bool failed = std::fflush(file_) != 0 || std::ferror(file_) != 0;
    const bool unclosed = file_ != stdout && std::fclose(file_) != 0;
    file_ = nullptr;
    if (failed || unclosed) refuse_path(path_, "cannot be written to the end");
}

float single_precision(double coordinate) {
    if (!(std::fabs(coordinate) <= double(std::numeric_limits<float>::max())))
        throw Failure(EXIT_BAD_INPUT, "a coordinate is larger than 3.4e38, and this format has floats; scale the mesh, "
                                      "or write .obj");
    return static_cast<float>(coordinate);
}

void FloatFrame::add(const double* point) {
    for (size_t k = 0; k < 3; ++k) {
        low_[k] = is_empty_ ? point[k] : std::min(low_[k], point[k]);
        high_[k] = is_empty_ ? point[k] : std::max(high_[k], point[k]);
    }
    is_empty_ = false;
}

Place FloatFrame::origin() const {
    constexpr double far = 16; // sizes of the box: four of the 24 bits of a float
    double distance = 0, size = 0;
    Place middle;
    for (size_t k = 0; k < 3; ++k) {
        middle[k] = low_[k] / 2 + high_[k] / 2;
        distance = std::max(distance, std::fabs(middle[k]));
        size = std::max(size, high_[k] / 2 - low_[k] / 2);
    }
    return distance / 2 > far * size ? middle : Place{};
}

bool FloatFrame::joins(const double* a, const double* b) const {
    const Place from = origin();
    bool same = true, equal = true;
    for (size_t k = 0; k < 3; ++k) {
        same = same && a[k] == b[k];
        equal = equal && static_cast<float>(a[k] - from[k]) == static_cast<float>(b[k] - from[k]);
    }
    return equal && !same;
}

void warn_of_joined(const std::string& path, size_t edges) {
    if (edges == 0) return;
    std::fprintf(stderr, "%s: %s too short for its single precision, which loses the shape there; write .ply or .obj\n",
                 path.c_str(), edges == 1 ? "1 edge is" : (std::to_string(edges) + " edges are").c_str());
}

void check_writable(const std::string& path) {
    if (path == "-") return;
    std::error_code code;
    const bool existed = std::filesystem::exists(path, code);
    std::FILE* file = std::fopen(path.c_str(), "ab");
    if (!file) refuse_path(path, "cannot be written");
    std::fclose(file);
    if (!existed) std::remove(path.c_str());
}

} // namespace cli
