// OBJ of Wavefront: one statement a line, vertices counted from 1.
//
//     v x y z                 a weight or a color behind is skipped
//     f 1 2 3, 1/2/3, 1//3    a polygon; texture and normal are skipped, -1 is the last vertex so far
//
// Groups, materials, lines and curves are skipped, and with a note what is no statement of OBJ: programs add their own.
// Format: Advanced Visualizer manual, appendix B1.
#include "polygon.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

constexpr std::string_view skipped_statements[] = {
    "vt",       "vn",       "g",      "o",      "s",   "usemtl", "mtllib", "l",          "p",        "vp",    "mg",
    "lod",      "usemap",   "maplib", "cstype", "deg", "step",   "bmat",   "con",        "curv",     "curv2", "surf",
    "parm",     "trim",     "hole",   "scrv",   "sp",  "end",    "bevel",  "ctech",      "stech",    "call",  "csh",
    "c_interp", "d_interp", "bsp",    "bzp",    "cdc", "cdp",    "res",    "shadow_obj", "trace_obj"};

bool is_skipped(std::string_view statement) {
    for (const std::string_view known : skipped_statements)
        if (statement == known) return true;
    return false;
}

class ObjReader {
public:
    explicit ObjReader(std::string_view text) : text_(text, 1, true) {
        // In a closed mesh some 70 bytes are a vertex and its two triangles: mostly no array has to be moved.
        const size_t vertices = text.size() / 64;
        mesh_.positions.reserve(3 * vertices);
        mesh_.triangles.reserve(6 * vertices);
    }

    TriangleMesh read() {
        for (; !text_.at_end(); text_.next_line()) {
            if (!text_.more()) continue;
            const char first = text_.peek();
            if ((first == 'v' || first == 'f') && text_.word_ends(1)) {
                text_.skip(1);
                if (first == 'v') read_vertex();
                else read_face();
            } else if (!is_skipped(text_.word())) skip_unknown();
        }
        // A face may come before its vertices.
        if (largest_.number > mesh_.vertex_count())
            throw MeshError(no_such_vertex(largest_.face, largest_.word), largest_.line);
        if (unknown_ > 0)
            mesh_.notes.push_back("skipped " + std::to_string(unknown_)
                                  + (unknown_ == 1 ? " line that is no statement of OBJ"
                                                   : " lines that are no statements of OBJ, the first")
                                  + " (line " + std::to_string(first_unknown_.line) + ": "
                                  + in_quotes(first_unknown_.word) + ")");
        return std::move(mesh_);
    }

private:
    // Where a face names the vertex with the largest number.
    struct Reference {
        uint64_t number; // from 1
        std::string_view word;
        size_t face, line;
    };

    void skip_unknown() {
        if (unknown_++ == 0) first_unknown_ = {0, text_.word(), 0, text_.line()};
    }

    void read_vertex() {
        mesh_.origin.add_vertex(text_.line());
        for (int k = 0; k < 3; ++k) {
            if (!text_.more()) text_.fail("a vertex needs three coordinates");
            mesh_.positions.push_back(text_.number<double>());
        }
    }

    void read_face() {
        Polygon polygon(mesh_);
        const size_t line = text_.line();
        while (text_.more()) polygon.add(read_corner());
        if (polygon.corners() < 3)
            text_.fail("face " + std::to_string(faces_) + " has fewer than three corners; remove it");
        polygon.end(line);
        ++faces_;
    }

    uint32_t read_corner() {
        const char* const first = text_.place();
        const bool backwards = *first == '-';
        if (backwards) text_.skip(1);
        uint64_t number = 0, skipped = 0;
        const bool good = text_.digits(number);
        const std::string_view vertex(first, static_cast<size_t>(text_.place() - first));
        while (text_.peek() == '/') {
            text_.skip(text_.peek(1) == '-' ? 2 : 1);
            text_.digits(skipped);
        }
        if (!good || !text_.word_ends())
            text_.fail(in_quotes(text_.word_at(first))
                       + " is not a corner of a face; write numbers of vertices, or vertex/texture/normal");
        if (number == 0) text_.fail("a face names vertex 0; vertices are counted from 1");
        if (!backwards) {
            if (number > largest_.number) largest_ = {number, vertex, faces_, text_.line()};
            return static_cast<uint32_t>(number - 1);
        }
        const size_t count = mesh_.vertex_count();
        if (number > count) text_.fail(no_such_vertex(faces_, vertex));
        return static_cast<uint32_t>(count - number);
    }

    std::string no_such_vertex(size_t face, std::string_view word) const {
        return "face " + std::to_string(face) + " names vertex " + std::string(word.substr(0, 24))
             + (word[0] == '-' ? ", which does not exist; there are " : ", which does not exist; the file has ")
             + std::to_string(mesh_.vertex_count()) + (word[0] == '-' ? " vertices before it" : " vertices");
    }

    TextCursor text_;
    TriangleMesh mesh_;
    size_t faces_ = 0, unknown_ = 0; // unknown: lines
    Reference largest_{}, first_unknown_{};
};

} // namespace

TriangleMesh read_obj(std::string_view text) { return ObjReader(text).read(); }

} // namespace readers
