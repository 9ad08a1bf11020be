#include "origin.hpp"

#include <algorithm>

namespace readers {

void Lines::add(size_t line) {
    const size_t item = count_++;
    if (!runs_.empty()) {
        Run& run = runs_.back();
        if (item == run.item + 1 && line >= run.line) run.step = line - run.line;
        if (line == run.line + run.step * (item - run.item)) return;
    }
    runs_.push_back({item, line, 0});
}

size_t Lines::of(size_t item) const {
    if (item >= count_) return 0;
    const auto after =
        std::upper_bound(runs_.begin(), runs_.end(), item, [](size_t i, const Run& run) { return i < run.item; });
    const Run& run = *(after - 1);
    return run.line + run.step * (item - run.item);
}

void Origin::add_face(size_t triangles, size_t line) {
    const size_t faces = face_lines_.count();
    if (starts_.empty() && triangles != faces + 1)
        for (size_t face = 0; face <= faces; ++face) starts_.push_back(static_cast<uint32_t>(face));
    face_lines_.add(line);
    if (!starts_.empty()) starts_.push_back(static_cast<uint32_t>(triangles));
}

size_t Origin::face_of(size_t triangle) const {
    if (starts_.empty()) return triangle;
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), triangle);
    return static_cast<size_t>(after - starts_.begin()) - 1;
}

static std::string name_of(const char* kind, size_t number, size_t line) {
    return kind + std::to_string(number) + (line > 0 ? ", line " + std::to_string(line) : "");
}

std::string Origin::name_of_triangle(size_t triangle) const {
    const size_t face = face_of(triangle);
    return name_of(has_polygons() ? "face " : "triangle ", face, face_lines_.of(face));
}

std::string Origin::name_of_vertex(size_t vertex) const { return name_of("vertex ", vertex, vertex_lines_.of(vertex)); }

} // namespace readers
