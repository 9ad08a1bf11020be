// OFF of Geomview, as text:
//
//     OFF                     also COFF, NOFF, STOFF, ...: colors, normals and textures are skipped
//     vertices faces edges    may stand behind OFF; the number of edges is not used
//     x y z ...               one line a vertex
//     3 i j k ...             one line a face: how many corners, vertices from 0, perhaps a color; or each further
//                             corner alone on the next line
//
// "#" begins a comment.  Format: Geomview manual, "OFF Files".
#include "polygon.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

class OffReader {
public:
    explicit OffReader(std::string_view text) : text_(text) {}

    TriangleMesh read() {
        read_keyword();
        vertices_ = read_count("vertices");
        faces_ = read_count("faces");
        text_.next_line();
        for (uint64_t v = 0; v < vertices_; ++v) read_vertex(v);
        for (uint64_t f = 0; f < faces_; ++f) read_face(f);
        return std::move(mesh_);
    }

private:
    void read_keyword() {
        if (!text_.more_lines()) text_.fail("the file has nothing but comments");
        const std::string_view word = text_.word();
        if (word[0] >= '0' && word[0] <= '9' && word.find("OFF") == std::string_view::npos) return; // may be left out
        size_t length = 0; // of prefixes, in any order
        for (const std::string_view prefix : {"ST", "C", "N", "ST", "C", "N", "ST"})
            if (word.substr(length, prefix.size()) == prefix) length += prefix.size();
        const std::string_view kind = word.substr(length);
        if (kind == "4OFF" || kind == "nOFF" || kind == "4nOFF")
            text_.fail(in_quotes(word) + ": only points in three dimensions are read; save the mesh as OFF");
        if (kind.substr(0, 3) != "OFF")
            text_.fail(in_quotes(word) + " is no header of OFF; the first word must be OFF, COFF, NOFF or STOFF");
        text_.skip(length + 3); // some files write the counts without a blank
        if (text_.more() && text_.word() == "BINARY")
            text_.fail("binary OFF is not read; save the mesh as text or as PLY");
    }

    uint64_t read_count(const char* what) {
        if (!text_.more_lines()) text_.fail(std::string("the file ends before the number of ") + what + "; it is cut");
        return text_.whole(what[0] == 'v' ? "a number of vertices" : "a number of faces");
    }

    void expect_line(const char* what, uint64_t number, uint64_t count) {
        if (!text_.more_lines())
            text_.fail("the file ends after " + std::to_string(number) + " of " + std::to_string(count) + " " + what
                       + "; it is cut, or its header is wrong");
    }

    void read_vertex(uint64_t v) {
        expect_line("vertices", v, vertices_);
        mesh_.origin.add_vertex(text_.line());
        for (int k = 0; k < 3; ++k) {
            if (!text_.more()) text_.fail("vertex " + std::to_string(v) + " needs three coordinates");
            mesh_.positions.push_back(text_.number<double>());
        }
        text_.next_line();
    }

    void read_face(uint64_t f) {
        expect_line("faces", f, faces_);
        const uint64_t corners = text_.whole("a number of corners");
        if (corners < 3) text_.fail("face " + std::to_string(f) + " has fewer than three corners; remove it");
        Polygon polygon(mesh_);
        const size_t line = text_.line();
        bool goes_on = false; // on lines of one corner each
        while (polygon.corners() < corners) {
            const auto too_few = [&] {
                throw MeshError("face " + std::to_string(f) + " has " + std::to_string(polygon.corners()) + " of "
                                    + std::to_string(corners) + " corners on its line",
                                line);
            };
            if (goes_on || !text_.more()) {
                text_.next_line();
                goes_on = text_.more_lines();
                if (!goes_on) too_few();
            }
            const uint64_t vertex = text_.whole("a vertex");
            if (goes_on && text_.more()) too_few();
            if (vertex >= vertices_)
                text_.fail("face " + std::to_string(f) + " names vertex " + std::to_string(vertex)
                           + ", which does not exist; the file has " + std::to_string(vertices_)
                           + " vertices, counted from 0");
            polygon.add(static_cast<uint32_t>(vertex));
        }
        polygon.end(line);
        text_.next_line();
    }

    TextCursor text_;
    TriangleMesh mesh_;
    uint64_t vertices_ = 0, faces_ = 0;
};

} // namespace

TriangleMesh read_off(std::string_view text) { return OffReader(text).read(); }

} // namespace readers
