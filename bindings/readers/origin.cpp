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

static void compose(std::vector<uint32_t>& numbers, const std::vector<uint32_t>& before) {
    if (numbers.empty()) {
        numbers = before;
        return;
    }
    std::vector<uint32_t> all;
    all.reserve(before.size());
    for (const uint32_t n : before) all.push_back(n < numbers.size() ? numbers[n] : Origin::NONE);
    numbers = std::move(all);
}

void Origin::renumber(const std::vector<uint32_t>& vertices, const std::vector<uint32_t>& triangles) {
    compose(vertices_, vertices);
    compose(triangles_, triangles);
}

void Origin::extend(size_t old_vertices, size_t vertices, size_t old_triangles, size_t triangles) {
    const auto numbers = [](size_t old_count, size_t count) {
        std::vector<uint32_t> all(count, NONE);
        for (uint32_t n = 0; n < old_count; ++n) all[n] = n;
        return all;
    };
    renumber(numbers(old_vertices, vertices), numbers(old_triangles, triangles));
}

size_t Origin::face_of(size_t triangle) const {
    if (!triangles_.empty()) triangle = triangle < triangles_.size() ? triangles_[triangle] : NONE;
    if (starts_.empty() || triangle >= starts_.back()) return triangle;
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), triangle);
    return static_cast<size_t>(after - starts_.begin()) - 1;
}

static std::string name_of(const std::string& kind, size_t number, size_t line) {
    if (number == Origin::NONE) return "a " + kind + " that is not in the file";
    return kind + " " + std::to_string(number) + (line > 0 ? ", line " + std::to_string(line) : "");
}

std::string Origin::name_of_triangle(size_t triangle, bool with_line) const {
    const size_t face = face_of(triangle);
    return name_of(has_polygons() ? "face" : "triangle", face, with_line ? face_lines_.of(face) : 0);
}

uint32_t Origin::vertex_of(size_t vertex) const {
    if (vertices_.empty()) return static_cast<uint32_t>(vertex);
    return vertex < vertices_.size() ? vertices_[vertex] : NONE;
}

std::string Origin::name_of_vertex(size_t number, bool with_line) const {
    const size_t vertex = vertex_of(number);
    return name_of("vertex", vertex, with_line ? vertex_lines_.of(vertex) : 0);
}

} // namespace readers
