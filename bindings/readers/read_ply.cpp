// PLY of Stanford, as text or binary in either byte order: a header that describes elements, then the elements.
//
//     ply
//     format binary_little_endian 1.0
//     element vertex 8
//     property double x ...                      x, y, z of any type; other properties are skipped
//     element face 12
//     property list uchar int vertex_indices     or vertex_index, of any whole types
//     end_header
//
// Instead of faces, or beside them, triangle strips, as in scans of Stanford: a row is a list of vertices, in which -1
// begins a new strip.
//
//     0---2---4          0 1 2 3 4: triangles 0 1 2, 2 1 3, 2 3 4
//      \ / \ / \         one that has a vertex twice only leads on
//       1---3---
//
// Other elements are skipped.  In a text each row is a line, and a float is rounded to a float, as other programs do.
// Format: Greg Turk, "The PLY Polygon File Format".
#include "byte_order.hpp"
#include "polygon.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

size_t size_of(Type type) {
    constexpr size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<size_t>(type)];
}

struct Property {
    std::string_view name;
    bool is_list;
    Type count_type; // of a list
    Type type;
};

struct Element {
    std::string_view name;
    uint64_t count;
    std::vector<Property> properties;
    // Bytes of a row, where no list is longer than nothing.
    uint64_t least_size() const {
        uint64_t size = 0;
        for (const Property& p : properties) size += size_of(p.is_list ? p.count_type : p.type);
        return size;
    }
    bool has_lists() const {
        for (const Property& p : properties)
            if (p.is_list) return true;
        return false;
    }
};

struct Header {
    bool is_text = false, big_endian = false;
    std::vector<Element> elements; // names lie in the bytes
    size_t size = 0, lines = 0;
    uint64_t unknown = 0; // lines that are not of PLY: old programs sign the header without "comment"
    std::string first_unknown;
};

Type read_type(TextCursor& text) {
    constexpr std::string_view names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                             {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                             {"float", "float32"}, {"double", "float64"}};
    if (!text.more()) text.fail("a property needs a type and a name");
    const std::string_view word = text.word();
    for (size_t type = 0; type < 8; ++type)
        if (word == names[type][0] || word == names[type][1]) {
            text.skip(word.size());
            return static_cast<Type>(type);
        }
    text.fail(in_quotes(word) + " is no type of PLY; write char, uchar, short, ushort, int, uint, float or double");
}

std::string_view read_word(TextCursor& text, const char* needed) {
    if (!text.more()) text.fail(std::string("the line ends where ") + needed + " is expected");
    const std::string_view word = text.word();
    text.skip(word.size());
    return word;
}

Property read_property(TextCursor& text) {
    Property property{};
    if (text.more() && text.word() == "list") {
        text.skip(4);
        property.is_list = true;
        property.count_type = read_type(text);
        if (property.count_type >= Type::float32) text.fail("the length of a list must have a whole type");
    }
    property.type = read_type(text);
    property.name = read_word(text, "the name of the property");
    return property;
}

Header read_header(std::string_view bytes) {
    // The data behind may be binary: the text ends with this line.
    const size_t mark = bytes.find("\nend_header"), stop = mark == bytes.npos ? mark : bytes.find('\n', mark + 1);
    if (bytes.substr(0, 3) != "ply") throw MeshError("the file does not begin with the word ply", 1);
    if (stop == bytes.npos) throw MeshError("the header has no line end_header; the file is cut, or is not PLY");
    Header header;
    header.size = stop + 1;
    TextCursor text(bytes.substr(0, header.size));
    bool has_format = false;
    for (; !text.at_end(); text.next_line()) {
        ++header.lines;
        if (!text.more()) continue;
        const std::string_view keyword = read_word(text, "a keyword");
        if (keyword == "format") {
            const std::string_view format = read_word(text, "a format");
            header.is_text = format == "ascii";
            header.big_endian = format == "binary_big_endian";
            if (!header.is_text && !header.big_endian && format != "binary_little_endian")
                text.fail(in_quotes(format)
                          + " is no format of PLY; write ascii, binary_little_endian or binary_big_endian");
            has_format = true;
        } else if (keyword == "element") {
            Element element{read_word(text, "the name of the element"), 0, {}};
            if (!text.more()) text.fail("the number of the element is missing");
            element.count = text.whole("a number of rows");
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty()) text.fail("a property before the first element");
            header.elements.back().properties.push_back(read_property(text));
        } else if (keyword != "ply" && keyword != "comment" && keyword != "obj_info" && keyword != "end_header"
                   && header.unknown++ == 0)
            header.first_unknown = "line " + std::to_string(text.line()) + ": " + in_quotes(keyword);
    }
    if (!has_format) throw MeshError("the header has no line format", 1);
    return header;
}

// Where a row is, for sentences; counted from 0.
struct Row {
    std::string_view element;
    uint64_t number, count;
    std::string name() const { return shown(element) + " " + std::to_string(number); }
};

// Rows of a text: one a line.
class TextRows {
public:
    TextRows(std::string_view bytes, const Header& header) : text_(bytes, header.lines + 1) {}

    size_t line() const { return text_.line(); }
    void begin(const Element&, uint64_t) {}
    void begin_row(const Row& row) {
        row_ = row;
        if (!text_.more_lines())
            text_.fail("the file ends after " + std::to_string(row.number) + " of " + std::to_string(row.count)
                       + " rows of " + in_quotes(row.element) + "; it is cut, or its header is wrong");
    }
    void end_row() {
        if (text_.more()) fail("has more numbers on its line than the header declares");
        text_.next_line();
    }
    void skip_rows(const Element& element) {
        if (element.properties.empty()) return;
        for (uint64_t row = 0; row < element.count; ++row) {
            begin_row({element.name, row, element.count});
            text_.next_line();
        }
    }
    double real(Type type) {
        expect_word();
        return type == Type::float32 ? static_cast<double>(text_.number<float>()) : text_.number<double>();
    }
    uint64_t whole(Type, const char* what) {
        expect_word();
        return text_.whole(what);
    }
    bool takes_break(Type) {
        expect_word();
        if (text_.word() != "-1") return false;
        text_.skip(2);
        return true;
    }
    void skip(Type, uint64_t count) {
        for (uint64_t k = 0; k < count; ++k) {
            expect_word();
            text_.skip(text_.word().size());
        }
    }
    [[noreturn]] void fail(const std::string& sentence) const { text_.fail(row_.name() + " " + sentence); }

private:
    void expect_word() {
        if (!text_.more()) fail("has fewer numbers on its line than the header and its lists declare");
    }

    TextCursor text_;
    Row row_{};
};

// Rows of bytes.
class BinaryRows {
public:
    BinaryRows(std::string_view bytes, const Header& header) :
        begin_(bytes.data() - header.size), at_(bytes.data()), end_(bytes.data() + bytes.size()),
        big_endian_(header.big_endian) {}

    size_t line() const { return 0; }
    // The count of the header is trusted only as far as there are bytes.
    void begin(const Element& element, uint64_t size) {
        if (size > 0 && element.count > left() / size)
            throw MeshError("the header declares " + std::to_string(element.count) + " rows of "
                            + in_quotes(element.name) + " of at least " + std::to_string(size) + " bytes, but only "
                            + std::to_string(left()) + " bytes are left; the file is cut, or its header is wrong");
    }
    void begin_row(const Row& row) { row_ = row; }
    void end_row() {}
    void skip_rows(const Element& element) {
        if (!element.has_lists()) {
            at_ += element.count * element.least_size();
            return;
        }
        for (uint64_t row = 0; row < element.count; ++row) {
            begin_row({element.name, row, element.count});
            for (const Property& p : element.properties) skip(p.type, p.is_list ? whole(p.count_type, "a length") : 1);
        }
    }
    double real(Type type) {
        const char* const place = take(size_of(type));
        switch (type) {
        case Type::float32: return finite(load<float>(place, big_endian_));
        case Type::float64: return finite(load<double>(place, big_endian_));
        default: return static_cast<double>(integer(place, type));
        }
    }
    uint64_t whole(Type type, const char* what) {
        const int64_t value = integer(take(size_of(type)), type);
        if (value < 0) fail("has " + std::to_string(value) + " where " + what + " is expected");
        return static_cast<uint64_t>(value);
    }
    bool takes_break(Type type) {
        if (integer(take(size_of(type)), type) == -1) return true;
        at_ -= size_of(type);
        return false;
    }
    void skip(Type type, uint64_t count) {
        if (count > left() / size_of(type)) ends_early();
        at_ += count * size_of(type);
    }
    [[noreturn]] void fail(const std::string& sentence) const {
        throw MeshError(row_.name() + " (before byte " + std::to_string(at_ - begin_) + ") " + sentence);
    }

private:
    uint64_t left() const { return static_cast<uint64_t>(end_ - at_); }
    [[noreturn]] void ends_early() const {
        throw MeshError("the file ends in " + row_.name() + " of " + std::to_string(row_.count) + " (byte "
                        + std::to_string(at_ - begin_) + "); it is cut, or its header is wrong");
    }
    const char* take(size_t size) {
        if (size > left()) ends_early();
        const char* const place = at_;
        at_ += size;
        return place;
    }
    int64_t integer(const char* place, Type type) const {
        switch (type) {
        case Type::int8: return load<int8_t>(place);
        case Type::uint8: return load<uint8_t>(place);
        case Type::int16: return load<int16_t>(place, big_endian_);
        case Type::uint16: return load<uint16_t>(place, big_endian_);
        case Type::int32: return load<int32_t>(place, big_endian_);
        default: return load<uint32_t>(place, big_endian_);
        }
    }
    double finite(double value) const {
        if (!std::isfinite(value)) fail("has a coordinate that is not finite; repair the vertex");
        return value;
    }

    const char *begin_, *at_, *end_;
    bool big_endian_;
    Row row_{};
};

// What makes up the mesh.
struct Layout {
    const Element *vertices = nullptr, *faces = nullptr, *strips = nullptr;
    size_t axis[3];                // property of the vertices
    size_t corners, strip_corners; // property of the faces, of the strips
};

size_t property_named(const Element& element, std::string_view name, bool is_list) {
    size_t k = 0;
    while (k < element.properties.size()
           && !(element.properties[k].name == name && element.properties[k].is_list == is_list))
        ++k;
    return k;
}

size_t list_of_corners(const Element& element, const std::string& name) {
    size_t corners = property_named(element, "vertex_indices", true);
    if (corners == element.properties.size()) corners = property_named(element, "vertex_index", true);
    if (corners == element.properties.size()) throw MeshError("the " + name + "s have no list vertex_indices");
    if (element.properties[corners].type >= Type::float32)
        throw MeshError("the list of vertices of a " + name + " must have a whole type, as int");
    return corners;
}

Layout find_mesh(const Header& header) {
    Layout layout{};
    for (const Element& element : header.elements) {
        const bool vertices = element.name == "vertex" || element.name == "vertices";
        const bool faces = element.name == "face" || element.name == "faces";
        const bool strips = element.name == "tristrips" && element.count > 0;
        if ((vertices && layout.vertices) || (faces && layout.faces) || (strips && layout.strips))
            throw MeshError("the header declares the element " + in_quotes(element.name) + " twice");
        if (vertices) layout.vertices = &element;
        if (faces) layout.faces = &element;
        if (strips) layout.strips = &element;
    }
    if (!layout.vertices || !(layout.faces || layout.strips))
        throw MeshError(std::string("the header declares no element ") + (layout.vertices ? "face" : "vertex")
                        + "; a mesh needs vertices and faces");
    constexpr std::string_view axes[] = {"x", "y", "z"};
    for (size_t k = 0; k < 3; ++k) {
        layout.axis[k] = property_named(*layout.vertices, axes[k], false);
        if (layout.axis[k] == layout.vertices->properties.size())
            throw MeshError("the vertices have no property " + std::string(axes[k]));
    }
    if (layout.faces) layout.corners = list_of_corners(*layout.faces, "face");
    if (layout.strips) layout.strip_corners = list_of_corners(*layout.strips, "strip");
    return layout;
}

template <typename Rows>
class PlyReader {
public:
    PlyReader(const Header& header, std::string_view body) :
        header_(header), layout_(find_mesh(header)), rows_(body, header) {}

    TriangleMesh read() {
        for (const Element& element : header_.elements) {
            // A face has three corners at least.
            const bool faces = &element == layout_.faces;
            const uint64_t corners = faces ? 3 * size_of(element.properties[layout_.corners].type) : 0;
            rows_.begin(element, element.least_size() + corners);
            if (&element == layout_.vertices) read_vertices();
            else if (faces) read_rows(element, layout_.corners, [&](const Property& list) { read_face(list); });
            else if (&element == layout_.strips)
                read_rows(element, layout_.strip_corners, [&](const Property& list) { read_strips(list); });
            else rows_.skip_rows(element);
        }
        return std::move(mesh_);
    }

private:
    void read_vertices() {
        const Element& element = *layout_.vertices;
        for (uint64_t row = 0; row < element.count; ++row) {
            rows_.begin_row({element.name, row, element.count});
            mesh_.origin.add_vertex(rows_.line());
            double point[3] = {0, 0, 0};
            for (size_t k = 0; k < element.properties.size(); ++k) {
                size_t axis = 0;
                while (axis < 3 && layout_.axis[axis] != k) ++axis;
                if (axis < 3) point[axis] = rows_.real(element.properties[k].type);
                else skip(element.properties[k]);
            }
            rows_.end_row();
            mesh_.positions.insert(mesh_.positions.end(), point, point + 3);
        }
    }

    // Rows with one list that is needed.
    template <typename ReadList>
    void read_rows(const Element& element, size_t wanted, const ReadList& read_list) {
        for (uint64_t row = 0; row < element.count; ++row) {
            rows_.begin_row({element.name, row, element.count});
            for (size_t k = 0; k < element.properties.size(); ++k)
                if (k == wanted) read_list(element.properties[k]);
                else skip(element.properties[k]);
            rows_.end_row();
        }
    }

    void read_face(const Property& list) {
        const uint64_t corners = rows_.whole(list.count_type, "a number of corners");
        if (corners < 3) rows_.fail("has fewer than three corners; remove it");
        Polygon polygon(mesh_);
        while (polygon.corners() < corners) polygon.add(read_vertex(list.type));
        polygon.end(rows_.line());
    }

    void read_strips(const Property& list) {
        const uint64_t length = rows_.whole(list.count_type, "the length of a list");
        uint32_t before = 0, last = 0;
        uint64_t in_strip = 0;
        for (uint64_t k = 0; k < length; ++k) {
            if (rows_.takes_break(list.type)) {
                in_strip = 0;
                continue;
            }
            const uint32_t vertex = read_vertex(list.type);
            const bool turned = in_strip % 2 == 1; // every second triangle runs against the strip
            if (in_strip >= 2 && before != last && last != vertex && vertex != before) {
                mesh_.triangles.insert(mesh_.triangles.end(), {turned ? last : before, turned ? before : last, vertex});
                mesh_.origin.add_face(mesh_.triangle_count(), rows_.line());
            }
            before = last;
            last = vertex;
            ++in_strip;
        }
    }

    uint32_t read_vertex(Type type) {
        const uint64_t vertex = rows_.whole(type, "a vertex");
        if (vertex >= layout_.vertices->count)
            rows_.fail("names vertex " + std::to_string(vertex) + ", which does not exist; the file has "
                       + std::to_string(layout_.vertices->count) + " vertices, counted from 0");
        return static_cast<uint32_t>(vertex);
    }

    void skip(const Property& property) {
        rows_.skip(property.type, property.is_list ? rows_.whole(property.count_type, "the length of a list") : 1);
    }

    const Header& header_;
    const Layout layout_;
    Rows rows_;
    TriangleMesh mesh_;
};

} // namespace

TriangleMesh read_ply(std::string_view bytes) {
    const Header header = read_header(bytes);
    const std::string_view body = bytes.substr(header.size);
    TriangleMesh mesh =
        header.is_text ? PlyReader<TextRows>(header, body).read() : PlyReader<BinaryRows>(header, body).read();
    if (header.unknown > 0)
        mesh.notes.push_back("skipped " + std::to_string(header.unknown)
                             + (header.unknown == 1 ? " line of the header that is not of PLY"
                                                    : " lines of the header that are not of PLY, the first")
                             + " (" + header.first_unknown + ")");
    return mesh;
}

} // namespace readers
