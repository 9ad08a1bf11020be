// Where the vertices and triangles of a mesh are in its file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace readers {

// The lines of items that are numbered from 0.  Items at equal distances, as in most files, take no memory.
class Lines {
public:
    // Of the next item; 0: the file has no lines.
    void add(size_t line);
    // 0: not known.
    size_t of(size_t item) const;
    size_t count() const { return count_; }

private:
    struct Run {
        size_t item, line, step;
    };
    std::vector<Run> runs_;
    size_t count_ = 0;
};

class Origin {
public:
    // triangles: of the mesh, with this face.
    void add_face(size_t triangles, size_t line);
    void add_vertex(size_t line) { vertex_lines_.add(line); }

    // The mesh has other vertices and triangles: of each the number before, NONE where there was none.
    void renumber(const std::vector<uint32_t>& vertices, const std::vector<uint32_t>& triangles);
    // New ones came last.
    void extend(size_t old_vertices, size_t vertices, size_t old_triangles, size_t triangles);
    static constexpr uint32_t NONE = UINT32_MAX;

    bool has_polygons() const { return !starts_.empty(); }
    size_t face_count() const { return face_lines_.count(); }
    // The first triangle of a face of a mesh with polygons, as it was read; face_count() gives the number of triangles.
    uint32_t start_of(size_t face) const { return starts_[face]; }
    // Of the file.
    size_t face_of(size_t triangle) const;
    uint32_t vertex_of(size_t vertex) const;

    // "face 3, line 17"; "triangle 3" where all faces of the file are triangles, and no line where it has none.
    std::string name_of_triangle(size_t triangle, bool with_line = true) const;
    std::string name_of_vertex(size_t vertex, bool with_line = true) const;

private:
    std::vector<uint32_t> starts_; // empty as long as all faces are triangles
    Lines face_lines_, vertex_lines_;
    std::vector<uint32_t> vertices_, triangles_; // of each its number in the file; empty: the same
};

} // namespace readers
