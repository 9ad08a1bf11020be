// Formats of simulation programs, as text: Medit .mesh, Gmsh .msh (2 and 4.1), legacy VTK .vtk.  Of their cells the
// triangles, quadrilaterals and polygons are read; vertices, edges and volumes are skipped, and so are the vertices in
// the middle of edges and faces.
//
//     Medit   Vertices, its number, x y z reference ...; Triangles, its number, three vertices from 1 and a reference
//     Gmsh    $Nodes and $Elements, each with its numbers; elements of types 2, 3 and their higher orders
//     VTK     POINTS and POLYGONS, TRIANGLE_STRIPS or CELLS with CELL_TYPES; with counts (3.0) or OFFSETS (5.1)
#include <map>

#include "polygon.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

// Of a variant that meshio knows.
std::string in_python(const char* variant) {
    return std::string(variant)
         + " is not read here; save it as text, or convert it: the Python package reads it if "
           "meshio is installed";
}

class SimulationReader {
public:
    explicit SimulationReader(std::string_view text) : text_(text) {}

protected:
    bool next() { return text_.more_lines(); }
    std::string_view take_word(const char* what) {
        if (!next()) text_.fail(std::string("the file ends before ") + what + "; it is cut");
        const std::string_view word = text_.word();
        text_.skip(word.size());
        return word;
    }
    double take_real(const char* what) {
        if (!next()) text_.fail(std::string("the file ends before ") + what + "; it is cut");
        return text_.number<double>();
    }
    uint64_t take_whole(const char* what) {
        if (!next()) text_.fail(std::string("the file ends before ") + what + "; it is cut");
        return text_.whole(what);
    }
    void skip_words(uint64_t count) {
        while (count-- > 0) take_word("a number");
    }
    void add_point(int dimension) {
        next();
        mesh_.origin.add_vertex(text_.line());
        for (int k = 0; k < 3; ++k) mesh_.positions.push_back(k < dimension ? take_real("a coordinate") : 0);
    }
    uint32_t vertex(uint64_t number, uint64_t first, size_t line) const {
        if (number < first || number - first >= mesh_.vertex_count())
            throw MeshError("a cell names vertex " + std::to_string(number) + ", which does not exist; there are "
                                + std::to_string(mesh_.vertex_count()) + ", counted from " + std::to_string(first),
                            line);
        return static_cast<uint32_t>(number - first);
    }

    TextCursor text_;
    TriangleMesh mesh_;
};

class MeditReader : SimulationReader {
public:
    using SimulationReader::SimulationReader;

    TriangleMesh read() {
        uint64_t dimension = 3;
        while (next()) {
            const std::string_view word = take_word("a keyword");
            if (word == "Dimension") {
                dimension = take_whole("a dimension");
                if (dimension != 2 && dimension != 3) text_.fail("the dimension must be 2 or 3");
            } else if (word == "Vertices") {
                for (uint64_t left = take_whole("a number of vertices"); left > 0; --left) {
                    add_point(static_cast<int>(dimension));
                    skip_words(1);
                }
            } else if (word == "Triangles") read_faces(3);
            else if (word == "Quadrilaterals") read_faces(4);
            else if (word == "End") break;
        }
        return std::move(mesh_);
    }

private:
    // They may come before the vertices only in files that nothing writes.
    void read_faces(int corners) {
        for (uint64_t left = take_whole("a number of faces"); left > 0; --left) {
            next();
            const size_t line = text_.line();
            Polygon polygon(mesh_);
            for (int c = 0; c < corners; ++c) polygon.add(vertex(take_whole("a vertex"), 1, line));
            polygon.end(line);
            skip_words(1);
        }
    }
};

class GmshReader : SimulationReader {
public:
    using SimulationReader::SimulationReader;

    TriangleMesh read() {
        while (next()) {
            const std::string_view word = take_word("a section");
            if (word == "$MeshFormat") {
                version_ = take_real("a version");
                if (take_whole("a kind of file") != 0) text_.fail(in_python("binary .msh"));
                if (version_ >= 4 && version_ < 4.1)
                    text_.fail("version 4.0 is not read; save it as version 4.1 or 2.2");
            } else if (word == "$Nodes") read_nodes();
            else if (word == "$Elements") read_elements();
        }
        return std::move(mesh_);
    }

private:
    void read_nodes() {
        const uint64_t blocks = take_whole("a number of nodes");
        if (version_ < 4) {
            for (uint64_t n = 0; n < blocks; ++n) add_node(take_whole("a node"));
            return;
        }
        skip_words(3);
        std::vector<uint64_t> tags;
        for (uint64_t b = 0; b < blocks; ++b) {
            skip_words(2);
            if (take_whole("0 or 1") != 0)
                text_.fail("parametric coordinates are not read; save the mesh without them");
            tags.clear();
            for (uint64_t left = take_whole("a number of nodes"); left > 0; --left)
                tags.push_back(take_whole("a node"));
            for (const uint64_t tag : tags) add_node(tag);
        }
    }
    void add_node(uint64_t tag) {
        if (!number_.emplace(tag, static_cast<uint32_t>(mesh_.vertex_count())).second)
            text_.fail("node " + std::to_string(tag) + " is there twice");
        add_point(3);
    }
    void read_elements() {
        const uint64_t blocks = take_whole("a number of elements");
        if (version_ >= 4) skip_words(3);
        for (uint64_t b = 0; b < blocks; ++b) {
            uint64_t type = 0, count = 1;
            if (version_ >= 4) {
                skip_words(2);
                type = take_whole("a type");
                count = take_whole("a number of elements");
            }
            for (; count > 0; --count) {
                skip_words(1); // its tag
                next();
                const size_t line = text_.line();
                if (version_ < 4) {
                    type = take_whole("a type");
                    skip_words(take_whole("a number of tags"));
                }
                read_element(type, line);
            }
        }
    }
    void read_element(uint64_t type, size_t line) {
        const bool triangle = type == 2 || type == 9 || type == 20 || type == 21;
        if (triangle || type == 3 || type == 10 || type == 16) {
            Polygon polygon(mesh_);
            for (int c = 0; c < (triangle ? 3 : 4); ++c) {
                const uint64_t tag = take_whole("a node");
                const auto found = number_.find(tag);
                if (found == number_.end())
                    text_.fail("an element names node " + std::to_string(tag) + ", which does not exist");
                polygon.add(found->second);
            }
            polygon.end(line);
        }
        text_.next_line(); // higher nodes, and cells of other kinds
    }

    double version_ = 2;
    std::map<uint64_t, uint32_t> number_;
};

class VtkReader : SimulationReader {
public:
    using SimulationReader::SimulationReader;

    TriangleMesh read() {
        // A comment with the version, and a title.
        for (int line = 0; line < 2 && !text_.at_end(); ++line) text_.next_line();
        const std::string_view kind = take_word("ASCII or BINARY");
        if (kind != "ASCII")
            text_.fail(kind == "BINARY" ? in_python("binary .vtk")
                                        : in_quotes(kind) + " is no kind of legacy VTK; save it as ASCII");
        std::vector<Cell> polygons, cells;
        while (next()) {
            const std::string_view word = take_word("a keyword");
            if (word == "DATASET") {
                const std::string_view set = take_word("a kind of data");
                if (set != "POLYDATA" && set != "UNSTRUCTURED_GRID")
                    text_.fail(in_quotes(set) + " is no surface; POLYDATA and UNSTRUCTURED_GRID are read");
            } else if (word == "POINTS") {
                const uint64_t count = take_whole("a number of points");
                take_word("a type");
                for (uint64_t p = 0; p < count; ++p) add_point(3);
            } else if (word == "POLYGONS") polygons = read_cells();
            else if (word == "TRIANGLE_STRIPS") add_strips(read_cells());
            else if (word == "CELLS") cells = read_cells();
            else if (word == "CELL_TYPES") add_types(cells);
            else if (word == "LINES" || word == "VERTICES") read_cells();
            else if (word == "POINT_DATA" || word == "CELL_DATA") break;
        }
        for (const Cell& cell : polygons) add_polygon(cell);
        return std::move(mesh_);
    }

private:
    struct Cell {
        std::vector<uint64_t> points;
        size_t line;
    };

    std::vector<Cell> read_cells() {
        const uint64_t count = take_whole("a number of cells");
        take_whole("a number of values");
        std::vector<Cell> cells;
        if (next() && text_.word() == "OFFSETS") return read_by_offsets(count);
        for (uint64_t c = 0; c < count; ++c) {
            next();
            Cell cell{{}, text_.line()};
            for (uint64_t left = take_whole("a number of corners"); left > 0; --left)
                cell.points.push_back(take_whole("a point"));
            cells.push_back(std::move(cell));
        }
        return cells;
    }
    // count is one more than there are cells.
    std::vector<Cell> read_by_offsets(uint64_t count) {
        take_word("OFFSETS");
        take_word("a type");
        std::vector<uint64_t> offsets;
        for (uint64_t c = 0; c < count; ++c) offsets.push_back(take_whole("an offset"));
        if (take_word("CONNECTIVITY") != "CONNECTIVITY") text_.fail("CONNECTIVITY is expected behind the offsets");
        take_word("a type");
        std::vector<Cell> cells;
        for (size_t c = 0; c + 1 < offsets.size(); ++c) {
            next();
            Cell cell{{}, text_.line()};
            if (offsets[c + 1] < offsets[c]) text_.fail("the offsets of the cells must not decrease");
            for (uint64_t left = offsets[c + 1] - offsets[c]; left > 0; --left)
                cell.points.push_back(take_whole("a point"));
            cells.push_back(std::move(cell));
        }
        return cells;
    }
    void add_polygon(const Cell& cell, size_t corners = SIZE_MAX) {
        corners = std::min(corners, cell.points.size());
        if (corners < 3) throw MeshError("a polygon has fewer than three corners; remove it", cell.line);
        Polygon polygon(mesh_);
        for (size_t c = 0; c < corners; ++c) polygon.add(vertex(cell.points[c], 0, cell.line));
        polygon.end(cell.line);
    }
    void add_strips(const std::vector<Cell>& strips) {
        for (const Cell& strip : strips)
            for (size_t c = 2; c < strip.points.size(); ++c) {
                const std::vector<uint64_t>& p = strip.points;
                const bool turned = c % 2 == 1;
                add_polygon({{p[c - (turned ? 1 : 2)], p[c - (turned ? 2 : 1)], p[c]}, strip.line});
            }
    }
    void add_types(const std::vector<Cell>& cells) {
        const uint64_t count = take_whole("a number of cells");
        for (uint64_t c = 0; c < count; ++c) {
            const uint64_t type = take_whole("a type of cell");
            if (c >= cells.size()) continue;
            if (type == 6) add_strips({cells[c]});
            else if (type == 7) add_polygon(cells[c]);
            else if (type == 5 || type == 22) add_polygon(cells[c], 3);
            else if (type == 9 || type == 23) add_polygon(cells[c], 4);
            else if (type == 8) text_.fail("cells of type 8 (pixels) are not read; triangulate the surface");
        }
    }
};

} // namespace

TriangleMesh read_medit(std::string_view text) { return MeditReader(text).read(); }
TriangleMesh read_gmsh(std::string_view text) { return GmshReader(text).read(); }
TriangleMesh read_vtk(std::string_view text) { return VtkReader(text).read(); }

} // namespace readers
