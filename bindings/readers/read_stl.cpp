// STL of 3D Systems, as text or binary.  It has triangles only: equal points become one vertex.
//
//     solid NAME                                       80 bytes of anything
//     facet normal x y z                               uint32 triangles, little endian
//       outer loop                                     for each: 12 float32 (normal, three points), 2 bytes
//         vertex x y z, three times
//       endloop
//     endfacet
//     endsolid
//
// Normals and colors are skipped.  Words of the end may be divided ("end loop"), "facet", its end and the last endsolid
// may be missing, and a binary file may have 0 or FFFFFFFF for its count.
// Format: StereoLithography Interface Specification, 1989.
#include "byte_order.hpp"
#include "point_numbers.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

constexpr size_t header_size = 84, triangle_size = 50;

bool equal_words(std::string_view word, std::string_view lower_case) {
    if (word.size() != lower_case.size()) return false;
    for (size_t i = 0; i < word.size(); ++i)
        if ((word[i] >= 'A' && word[i] <= 'Z' ? word[i] - 'A' + 'a' : word[i]) != lower_case[i]) return false;
    return true;
}

// Binary files may begin with "solid" as well; their count of triangles has bytes that no text has.
bool is_text_of_stl(std::string_view bytes) {
    size_t begin = bytes.substr(0, 3) == "\xef\xbb\xbf" ? 3 : 0;
    while (begin < bytes.size() && (bytes[begin] == ' ' || (bytes[begin] >= '\t' && bytes[begin] <= '\r'))) ++begin;
    if (!equal_words(bytes.substr(begin, 5), "solid")) return false;
    if (bytes.size() < header_size) return true;
    const uint64_t count = load<uint32_t>(bytes.data() + 80);
    if (header_size + count * triangle_size == bytes.size()) return false;
    return bytes.substr(0, header_size).find('\0') == bytes.npos;
}

TriangleMesh read_binary(std::string_view bytes) {
    if (bytes.size() < header_size)
        throw MeshError("the file has " + std::to_string(bytes.size())
                        + " bytes, but the header of a binary STL has 84; it is cut, or is not STL");
    const uint64_t left = bytes.size() - header_size;
    uint64_t count = load<uint32_t>(bytes.data() + 80);
    TriangleMesh mesh;
    if ((count == 0 || count == UINT32_MAX) && left > 0 && left % triangle_size == 0) { // written before it was known
        mesh.notes.push_back("the header declares " + std::to_string(count) + " triangles; read the "
                             + std::to_string(left / triangle_size) + " that follow");
        count = left / triangle_size;
    }
    if (count > left / triangle_size)
        throw MeshError("the header declares " + std::to_string(count) + " triangles, but behind it are bytes for "
                        + std::to_string(left / triangle_size) + " only; the file is cut, or is not STL");
    PointNumbers points(mesh.positions);
    for (uint64_t t = 0; t < count; ++t)
        for (size_t corner = 0; corner < 3; ++corner) {
            const size_t place = header_size + t * triangle_size + 12 * (corner + 1);
            float p[3];
            for (size_t k = 0; k < 3; ++k) {
                p[k] = load<float>(bytes.data() + place + 4 * k);
                if (!std::isfinite(p[k]))
                    throw MeshError("triangle " + std::to_string(t) + " (byte " + std::to_string(place + 4 * k)
                                    + ") has a coordinate that is not finite; repair it");
            }
            mesh.triangles.push_back(points.number_of(p[0], p[1], p[2]));
        }
    return mesh;
}

class TextReader {
public:
    explicit TextReader(std::string_view text) : text_(text), points_(mesh_.positions) {}

    TriangleMesh read() {
        bool in_solid = false;
        while (text_.more_lines()) {
            if (in_solid && (at_word("facet") || at_word("outer"))) {
                read_facet();
                continue;
            }
            const bool is_color = at_word("color");
            if (!is_color && !(in_solid ? takes_end("solid") : at_word("solid")))
                text_.fail(in_quotes(text_.word()) + " where " + (in_solid ? "facet or endsolid" : "solid")
                           + " is expected");
            if (!is_color) in_solid = !in_solid;
            text_.next_line(); // a name follows
        }
        if (in_solid) mesh_.notes.push_back("the file ends before endsolid; the facets before it were read");
        return std::move(mesh_);
    }

private:
    std::string facet() const { return "facet " + std::to_string(mesh_.triangle_count()); }

    std::string_view next_word() {
        if (!text_.more_lines()) text_.fail("the file ends in " + facet() + "; it is cut");
        return text_.word();
    }

    bool at_word(std::string_view word) const { return equal_words(text_.word(), word); }

    void expect(std::string_view expected) {
        const std::string_view word = next_word();
        if (!equal_words(word, expected))
            text_.fail(facet() + " has " + in_quotes(word) + " where " + std::string(expected) + " is expected");
        text_.skip(word.size());
    }

    // "endloop" or "end loop"
    bool takes_end(std::string_view of) {
        const std::string_view word = next_word();
        if (equal_words(word.substr(0, 3), "end") && equal_words(word.substr(3), of)) {
            text_.skip(word.size());
            return true;
        }
        if (!equal_words(word, "end")) return false;
        const char* const behind = word.data() + word.size();
        if (*behind != ' ' || !equal_words(text_.word_at(behind + 1), of)) return false;
        text_.skip(4 + of.size());
        return true;
    }

    void expect_end(std::string_view of) {
        if (!takes_end(of))
            text_.fail(facet() + " has " + in_quotes(text_.word()) + " where end" + std::string(of) + " is expected");
    }

    void read_facet() {
        const size_t line = text_.line();
        if (at_word("facet")) {
            expect("facet");
            expect("normal");
            for (int k = 0; k < 3; ++k) text_.skip(next_word().size());
        }
        expect("outer");
        expect("loop");
        uint32_t corner[3];
        for (uint32_t& number : corner) {
            expect("vertex");
            double p[3];
            for (double& x : p) {
                next_word();
                x = text_.number<double>();
            }
            number = points_.number_of(p[0], p[1], p[2]);
        }
        if (equal_words(next_word(), "vertex"))
            text_.fail(facet() + " has more than three corners; divide it into triangles");
        expect_end("loop");
        if (text_.more_lines() && !at_word("outer") && !at_word("facet")) expect_end_of_facet();
        mesh_.triangles.insert(mesh_.triangles.end(), corner, corner + 3);
        mesh_.origin.add_face(mesh_.triangle_count(), line);
    }

    // Missing ones are no defect before the next facet and before the end.
    void expect_end_of_facet() {
        if (takes_end("facet")) return;
        const std::string_view word = text_.word();
        if (!equal_words(word, "end") && !equal_words(word, "endsolid")) expect_end("facet");
    }

    TextCursor text_;
    TriangleMesh mesh_;
    PointNumbers points_;
};

} // namespace

bool is_stl_text(std::string_view bytes) { return is_text_of_stl(bytes); }

TriangleMesh read_stl(std::string_view bytes) {
    return is_stl_text(bytes) ? TextReader(bytes).read() : read_binary(bytes);
}

} // namespace readers
