// Readers of mesh files (bindings/readers): the same mesh in every format and dialect, doubles bit for bit, a sentence
// for each defect, and little time for files that ask for more than they are.
#include <point_numbers.hpp>

#include <cmath>
#include <cstring>

#include "support/mesh_files.hpp"

namespace test_readers {

using namespace test;

// --- OBJ -------------------------------------------------------------------------

TEST(ReadObj, CornersInEveryForm) {
    const Sample s = make_sample();
    const std::string vertices = obj_vertices(s), n = std::to_string(s.vertex_count());
    const auto read = [&](const char* before, const char* behind) {
        return read_mesh(vertices + obj_faces(s, [&](uint32_t v) { return before + std::to_string(v + 1) + behind; }),
                         Format::obj);
    };
    for (const char* behind : {"", "/7", "//8", "/7/8", "/-7/-8", "/", "//"}) {
        SCOPED_TRACE(behind);
        expect_same(read("", behind), s.positions, s.triangles);
    }
    const std::string backwards =
        obj_faces(s, [&](uint32_t v) { return "-" + std::to_string(s.vertex_count() - v) + "/-1"; });
    expect_same(read_mesh(vertices + backwards, Format::obj), s.positions, s.triangles);
    expect_same(read_mesh(obj_faces(s) + vertices, Format::obj), s.positions, s.triangles);
}

TEST(ReadObj, Dialects) {
    const Sample s = make_sample();
    const std::string faces = obj_faces(s), plain = obj_vertices(s) + faces;
    const auto expect = [&](const std::string& obj) {
        expect_same(read_mesh(obj, Format::obj), s.positions, s.triangles);
    };
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string obj;
        for (size_t at = 0; at < plain.size();) {
            const bool here = plain.compare(at, from.size(), from) == 0;
            obj += here ? to : plain.substr(at, 1);
            at += here ? from.size() : 1;
        }
        return obj;
    };
    expect(with("\n", "\r\n"));
    expect(with(" ", " \t  "));
    expect(with(" ", " \\\n "));
    expect(with(" ", "\\\r\n "));
    expect(with("\n", "  # comment \\\n\n"));
    expect(with("v ", "\tv "));
    expect("\xef\xbb\xbf" + plain);
    expect(plain.substr(0, plain.size() - 1)); // no line end
    expect(plain.substr(0, plain.size() - 1) + "\\\n");
    expect(plain.substr(0, plain.size() - 1) + "\\");
    expect(obj_vertices(s, " 0.5") + faces);
    expect(obj_vertices(s, " 0.1 0.2 0.3") + faces);
    expect("# f 1 2\nmtllib a.mtl\no torus\ng a b\nvt 0 0\nvn 0 0 1\ns off\nusemtl m\nl 1 2 \\\n 3\np 1\n" + plain
           + "vp 1\ncurv 0 1 \\\n 1 2\nend");
}

// Programs write statements of their own.
TEST(ReadObj, UnknownStatements) {
    const Sample s = make_sample();
    const std::string plain = obj_vertices(s) + obj_faces(s);
    const auto notes = [&](const std::string& obj) {
        const TriangleMesh mesh = read_mesh(obj, Format::obj);
        expect_same(mesh, s.positions, s.triangles);
        return mesh.notes;
    };
    EXPECT_EQ(notes(plain).size(), 0u);
    EXPECT_EQ(notes("$ comment\n" + plain),
              std::vector<std::string>{"skipped 1 line that is no statement of OBJ (line 1: \"$\")"});
    EXPECT_EQ(
        notes("#\n\x1b[31m\xff\n" + plain + "vw 1 0.5\nt 1 2\n"),
        std::vector<std::string>{"skipped 3 lines that are no statements of OBJ, the first (line 2: \"?[31m?\")"});
}

TEST(ReadObj, Refusals) {
    const auto refused = [](const std::string& obj, const std::vector<std::string>& says) {
        expect_refused(obj, Format::obj, says);
    };
    const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    refused("", {"empty"});
    refused("# only a comment\n", {"no vertices", "OBJ"});
    refused(good, {"no faces"});
    refused("hello\n" + good, {"no faces", "OBJ"});
    refused(good + "v 1 2\n", {":4:", "three coordinates"});
    refused("v 1 \\\n 2\n", {":2:", "three coordinates"});
    refused(good + "v 1 x 2\n", {":4:", "\"x\" is not a number"});
    refused(good + "v 1 2 3x\n", {":4:", "\"3x\" is not a number"});
    refused(good + "v 1,5 2 3\n", {":4:", "\"1,5\" is not a number"});
    refused(good + "v 1 2 +-3\n", {":4:", "\"+-3\" is not a number"});
    refused(good + "v 1 nan 3\n", {":4:", "\"nan\" is not finite"});
    refused(good + "v 1 2 -inf\n", {":4:", "\"-inf\" is not finite"});
    refused(good + "v 1 2 1e999\n", {":4:", "\"1e999\" is too large"});
    refused(good + "f 1 2\n", {":4:", "face 0", "three corners"});
    refused(good + "f 1 2 3\nf\n", {":5:", "face 1", "three corners"});
    refused(good + "f 1 2 4\nf 1 2 3\n", {":4:", "face 0 names vertex 4", "does not exist", "has 3 vertices"});
    refused(good + "f 1 2 3\nf 1 2 4294967297\n", {":5:", "face 1 names vertex 4294967297", "has 3 vertices"});
    refused(good + "f 1 2 99999999999999999999999999\n", {":4:", "vertex 999999999999999999999999", "has 3 vertices"});
    refused(good + "f -1 -2 -4\n" + good, {":4:", "vertex -4", "there are 3 vertices before it"});
    refused(good + "f 1 2 -99999999999999999999\n", {":4:", "does not exist"});
    refused(good + "f 0 1 2\n", {":4:", "vertex 0", "counted from 1"});
    refused(good + "f 1 2 x\n", {":4:", "\"x\" is not a corner"});
    refused(good + "f 1 2 3.5\n", {":4:", "\"3.5\" is not a corner"});
    refused(good + "f 1 2 3/a\n", {":4:", "\"3/a\" is not a corner"});
    refused(good + "f 1 2 - 3\n", {":4:", "\"-\" is not a corner"});
    refused(good + "f 1 2 " + std::string(100, 'x'), {":4:", "xxx...\""});
}

// --- OFF -------------------------------------------------------------------------

TEST(ReadOff, Dialects) {
    const Sample s = make_sample();
    const std::string counts = off_counts(s), plain = off_rows(s, "", "");
    const auto expect = [&](const std::string& off) {
        expect_same(read_mesh(off, Format::off), s.positions, s.triangles);
    };
    expect("OFF\n" + counts + plain);
    expect("OFF " + counts + plain);
    expect("OFF" + counts + plain);
    expect(counts + plain);
    expect("# comment\n\n  OFF # comment\n#\n" + counts + "\n# comment\n" + plain);
    expect("OFF\r\n" + counts + off_rows(s, "\r", "\r"));
    expect("COFF\n" + counts + off_rows(s, " 255 128 0 255", ""));
    expect("NOFF\n" + counts + off_rows(s, " 0 0 1", " 3 255 0 0"));
    expect("STOFF\n" + counts + off_rows(s, " 0.5 0.5", " # face"));
    expect("NCOFF\n" + counts + off_rows(s, " 0 0 1 255 0 0 255", ""));
    expect("NCSTOFF\n" + counts + off_rows(s, " 0 0 1 1 1 1 1 0 0", ""));
    expect("STCNOFF\n" + counts + off_rows(s, " 0 0 1 1 1 1 1 0 0", " 0.1 0.2 0.3"));
    expect("OFF\n" + counts + plain.substr(0, plain.size() - 1));
    // "4 0 1 2 3" as some programs write it: two numbers on the first line, each further one on its own.
    const std::string rows = off_rows(s, "", "");
    size_t at = 0;
    for (size_t v = 0; v < s.vertex_count(); ++v) at = rows.find('\n', at) + 1;
    std::string spread = rows.substr(0, at);
    for (int numbers = 0; at < rows.size(); ++at) {
        spread += rows[at];
        numbers = rows[at] == '\n' ? 0 : numbers + (rows[at] == ' ');
        if (rows[at] == ' ' && numbers > 1) spread += '\n';
    }
    expect("OFF\n" + counts + spread);
}

TEST(ReadOff, Refusals) {
    const auto refused = [](const std::string& off, const std::vector<std::string>& says) {
        expect_refused(off, Format::off, says);
    };
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
    refused("# nothing\n", {"nothing but comments"});
    refused("OFFX\n", {":1:", "not a number of vertices"});
    refused("PLY\n", {":1:", "\"PLY\" is no header of OFF"});
    refused("4OFF\n1 1 1\n", {":1:", "\"4OFF\"", "three dimensions"});
    refused("CnOFF\n1 1 1\n", {":1:", "\"CnOFF\"", "three dimensions"});
    refused("OFF BINARY\n", {":1:", "binary OFF is not read"});
    refused("OFF\n", {"ends before the number of vertices"});
    refused("OFF\n3", {"ends before the number of faces"});
    refused("OFF\n-3 1 0\n", {":2:", "\"-3\" is not a number of vertices"});
    refused("OFF\n3 1 0\n0 0 0\n1 0\n", {":4:", "vertex 1 needs three coordinates"});
    refused("OFF\n3 1 0\n0 0 0\n1 inf 0\n", {":4:", "not finite"});
    refused("OFF\n3 1 0\n0 0 0\n1 0 0\n", {"ends after 2 of 3 vertices", "cut"});
    refused("OFF\n3 2 0\n" + points + "3 0 1 2\n", {"ends after 1 of 2 faces", "cut"});
    refused("OFF\n3 1 0\n" + points + "3 0 1\n", {":6:", "face 0 has 2 of 3 corners"});
    refused("OFF\n3 2 0\n" + points + "3 0 1\n3 0 1 2\n", {"face 0 has 2 of 3 corners"});
    refused("OFF\n3 1 0\n" + points + "2 0 1\n", {":6:", "face 0", "three corners"});
    refused("OFF\n3 1 0\n" + points + "3 0 1 3\n", {":6:", "face 0 names vertex 3", "has 3 vertices, counted from 0"});
    refused("OFF\n3 1 0\n" + points + "3 0 1 -1\n", {":6:", "\"-1\" is not a vertex"});
    refused("OFF\n3 1 0\n" + points + "3 0 1 99999999999999999999\n", {":6:", "does not exist"});
    refused("OFF\n0 0 0\n", {"no vertices"});
}

// --- PLY -------------------------------------------------------------------------

TEST(ReadPly, EveryTypeAndOrder) {
    const Sample s = make_sample();
    const std::string reals = "property double x\nproperty float64 y\nproperty double z\n";
    for (const PlyKind kind : {ascii, little, big}) {
        SCOPED_TRACE(kind);
        const auto expect = [&](const std::string& rows, const std::string& face) {
            SCOPED_TRACE(face);
            expect_same(read_mesh(ply_header(kind, s, reals, face) + rows, Format::ply), s.positions, s.triangles);
        };
        expect(ply_rows<double, uint8_t, int32_t>(kind, s), "property list uchar int vertex_indices\n");
        expect(ply_rows<double, int8_t, uint32_t>(kind, s), "property list char uint vertex_index\n");
        expect(ply_rows<double, uint16_t, uint8_t>(kind, s), "property list ushort uchar vertex_indices\n");
        expect(ply_rows<double, int16_t, int8_t>(kind, s), "property list int16 int8 vertex_indices\n");
        expect(ply_rows<double, uint32_t, uint16_t>(kind, s), "property list uint32 uint16 vertex_indices\n");
        expect(ply_rows<double, int32_t, int16_t>(kind, s), "property list int short vertex_indices\n");
        const std::string floats = "property float x\nproperty float32 y\nproperty float z\n";
        expect_same(read_mesh(ply_header(kind, s, floats, "property list uchar int vertex_indices\n")
                                  + ply_rows<float, uint8_t, int32_t>(kind, s),
                              Format::ply),
                    as_floats(s.positions), s.triangles);
    }
}

TEST(ReadPly, SkipsWhatIsNotTheMesh) {
    const Sample s = make_sample();
    for (const PlyKind kind : {ascii, little, big}) {
        SCOPED_TRACE(kind);
        std::string rows;
        for (int i = 0; i < 3; ++i) rows += (PlyRow(kind) << uint8_t{2} << 0.5f << -1.0f << int16_t{-3}).end();
        for (int i = 0; i < 2; ++i) rows += (PlyRow(kind) << 0.25).end();
        for (size_t v = 0; v < s.vertex_count(); ++v) {
            const double* const p = &s.positions[3 * v];
            rows += (PlyRow(kind) << p[2] << uint8_t{255} << p[0] << uint16_t{1} << 7.5 << p[1]).end();
        }
        for (const auto& face : s.faces) {
            PlyRow row(kind);
            row << int16_t{-1} << uint8_t{0} << static_cast<uint8_t>(face.size());
            for (const uint32_t v : face) row << static_cast<int32_t>(v);
            rows += (row << uint8_t{1} << 1.5f).end();
        }
        rows += (PlyRow(kind) << 3.0).end();
        const std::string before = "element nothing 1000000000\nelement strip 3\nproperty list uchar float a\n"
                                   "property short b\nelement camera 2\nproperty double c\n";
        const std::string vertex = "property double z\nproperty uchar red\nproperty double x\n"
                                   "property list ushort double more\nproperty double y\n";
        const std::string face = "property short flags\nproperty list uchar int empty\n"
                                 "property list uchar int vertex_indices\nproperty list uchar float texcoord\n";
        std::string header = ply_header(kind, s, vertex, face, before);
        header = replaced(header, "end_header", "element last 1\nproperty double d\nend_header");
        expect_same(read_mesh(header + rows, Format::ply), s.positions, s.triangles);
    }
}

// Three triangles in a strip, a strip whose triangles all have a vertex twice, and one of one triangle.
TEST(ReadPly, Strips) {
    const std::vector<double> points = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0};
    // 0 1 2 | 2 1 3 | 2 3 4 | a new strip | 4 3 3 5: two that have a vertex twice | a new strip: 5 4 3
    const int32_t strip[] = {0, 1, 2, 3, 4, -1, 4, 3, 3, 5, -1, 5, 4, 3};
    const std::vector<uint32_t> triangles = {0, 1, 2, 2, 1, 3, 2, 3, 4, 5, 4, 3};
    for (const PlyKind kind : {ascii, little, big}) {
        SCOPED_TRACE(kind);
        const char* const format = kind == ascii  ? "ascii"
                                 : kind == little ? "binary_little_endian"
                                                  : "binary_big_endian";
        std::string file = std::string("ply\nformat ") + format
                         + " 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
                           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
        for (size_t v = 0; v < 6; ++v)
            file += (PlyRow(kind) << points[3 * v] << points[3 * v + 1] << points[3 * v + 2]).end();
        PlyRow row(kind);
        row << static_cast<int32_t>(std::size(strip));
        for (const int32_t v : strip) row << v;
        file += row.end();
        expect_same(read_mesh(file, Format::ply), points, triangles);
    }
}

TEST(ReadPly, Dialects) {
    const Sample s = make_sample();
    const std::string list = "property list uchar int vertex_indices\n";
    const std::string xyz = "property double x\nproperty double y\nproperty double z\n";
    std::string crlf;
    for (const char c : ply_header(little, s, xyz, list)) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    expect_same(read_mesh(crlf + ply_rows<double, uint8_t, int32_t>(little, s), Format::ply), s.positions, s.triangles);
    // Faces may come first.
    const std::string faces_first =
        "ply\nformat ascii 1.0\nelement face 1\n" + list + "element vertex 3\n" + xyz + "end_header\n";
    EXPECT_EQ(read_mesh(faces_first + "\n3 0 1 2\n\n0 0 0\n1 0 0\n0 1 0", Format::ply).triangles.size(), 3u);
    EXPECT_EQ(refusal(faces_first + "3 0 1 3\n0 0 0\n1 0 0\n0 1 0", Format::ply).substr(0, 21),
              ":10: face 0 names ver");
    // A float of a text is a float, also where a double was written.
    const std::string floats = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property int z\nelement face 1\n"
                             + list + "end_header\n";
    const TriangleMesh mesh = read_mesh(floats + "0.1 1e-60 7\n-1e-60 1e-40 0\n0 1 0\n3 0 1 2\n", Format::ply);
    const std::vector<double> expected = {double{0.1f}, 0, 7, -0.0, double{1e-40f}, 0, 0, 1, 0};
    expect_same(mesh, expected, {0, 1, 2});
}

TEST(ReadPly, Refusals) {
    const auto refused = [](const std::string& ply, const std::vector<std::string>& says) {
        expect_refused(ply, Format::ply, says);
    };
    const std::string start = "ply\nformat ascii 1.0\n", xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n", end = "end_header\n";
    const std::string head = start + "element vertex 3\n" + xyz + faces + end; // 9 lines, then the rows
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
    refused("hello", {":1:", "word ply"});
    refused("ply\nformat ascii 1.0\nelement vertex 3\n", {"no line end_header", "cut"});
    refused("ply\nelement vertex 3\n" + xyz + faces + end, {"no line format"});
    refused("ply\nformat ebcdic 1.0\n" + end, {":2:", "\"ebcdic\" is no format"});
    EXPECT_EQ(
        read_mesh(start + "Created by a program\n" + head.substr(start.size()) + points + "3 0 1 2\n", Format::ply)
            .notes,
        std::vector<std::string>{"skipped 1 line of the header that is not of PLY (line 3: \"Created\")"});
    refused(start + "element vertex\n" + end, {":3:", "number of the element"});
    refused(start + "element vertex -3\n" + end, {":3:", "\"-3\" is not a number of rows"});
    refused(start + xyz + end, {":3:", "property before the first element"});
    refused(start + "element vertex 3\nproperty quad x\n" + end, {":4:", "\"quad\" is no type"});
    refused(start + "element vertex 3\nproperty float\n" + end, {":4:", "name of the property"});
    refused(start + "element vertex 3\nproperty list float int x\n" + end, {":4:", "whole type"});
    refused(start + faces + end, {"no element vertex"});
    refused(start + "element vertex 3\n" + xyz + end, {"no element face"});
    refused(start + "element vertex 3\nproperty float x\nproperty float z\n" + faces + end, {"no property y"});
    refused(start + "element vertex 3\n" + xyz + "element face 1\nproperty int vertex_indices\n" + end,
            {"no list vertex_indices"});
    refused(start + "element vertex 3\n" + xyz + "element face 1\nproperty list uchar float vertex_indices\n" + end,
            {"whole type"});
    refused(start + "element vertex 3\n" + xyz + "element vertex 3\n" + xyz + faces + end, {"\"vertex\" twice"});
    refused(replaced(head, "element face", "element \x1b 1\nproperty int i\nelement face") + points + "\n",
            {"0 of 1 rows of \"?\""});
    refused(replaced(replaced(head, "ascii", "binary_big_endian"), "element vertex",
                     "element \x1b 1\nproperty list int int i\nelement vertex")
                + std::string(5, '\1'),
            {"ends in ? 0 of 1"});
    const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    refused(start + "element vertex 3\n" + xyz + strips + strips + end, {"\"tristrips\" twice"});
    refused(start + "element vertex 3\n" + xyz + strips + end + points + "3 0 1 3\n", {"names vertex 3"});
    refused(start + "element vertex 3\n" + xyz + strips + end + points + "3 0 1 -2\n", {"\"-2\""});
    refused(start + "element vertex 3\n" + xyz + "element tristrips 1\nproperty list int float vertex_indices\n" + end,
            {"of a strip", "whole type"});
    refused(head + "0 0 0\n1 0\n", {":11:", "vertex 1 has fewer numbers"});
    refused(head + "0 0 0 0\n", {":10:", "vertex 0 has more numbers"});
    refused(head + "0 0 0\n1 nan 0\n", {":11:", "\"nan\" is not finite"});
    refused(head + "0 0 0\n1 1e60 0\n", {":11:", "\"1e60\" is too large", "32 bits"});
    refused(head + "0 0 0\n1 0 0\n", {"ends after 2 of 3 rows of \"vertex\"", "cut"});
    refused(head + points, {"ends after 0 of 1 rows of \"face\""});
    refused(head + points + "3 0 1\n", {":13:", "face 0 has fewer numbers"});
    refused(head + points + "2 0 1\n", {":13:", "face 0", "three corners"});
    refused(head + points + "3 0 1 3\n", {":13:", "face 0 names vertex 3", "3 vertices, counted from 0"});
    refused(head + points + "3 0 1 -1\n", {":13:", "\"-1\" is not a vertex"});

    const Sample s = make_sample();
    const std::string doubles = "property double x\nproperty double y\nproperty double z\n";
    const std::string header = ply_header(little, s, doubles, "property list uchar int vertex_indices\n");
    const std::string rows = ply_rows<double, uint8_t, int32_t>(little, s);
    const size_t first_face = 24 * s.vertex_count();
    const auto at_byte = [&](size_t row_byte) { return "byte " + std::to_string(header.size() + row_byte); };
    refused(header + rows.substr(0, 100),
            {"declares 35 rows of \"vertex\" of at least 24 bytes", "only 100 bytes", "cut"});
    refused(header + rows.substr(0, first_face + 72 * 13 - 1), {"72 rows of \"face\" of at least 13 bytes", "cut"});
    refused(header + rows.substr(0, rows.size() - 1), {"the file ends in face 71 of 72 (byte", "cut"});
    const double nan = std::nan("");
    refused(header + rows.substr(0, 24) + bytes_of(nan) + rows.substr(32), {"vertex 1", at_byte(32), "not finite"});
    refused(header + rows.substr(0, first_face + 1) + bytes_of(35) + rows.substr(first_face + 5),
            {"face 0", at_byte(first_face + 5), "names vertex 35", "has 35 vertices"});
    refused(header + rows.substr(0, first_face + 1) + bytes_of(-2) + rows.substr(first_face + 5),
            {"face 0", "has -2 where a vertex is expected"});
    refused(header + rows.substr(0, first_face) + "\x02" + rows.substr(first_face + 1), {"face 0", "three corners"});
    refused(header + rows.substr(0, first_face) + "\xff" + rows.substr(first_face + 1), {"face 0", "names vertex"});
}

// --- STL -------------------------------------------------------------------------

TEST(ReadStl, TextAndBytes) {
    Sample s = make_sample();
    number_by_triangles(s.positions, s.triangles);
    const std::vector<double> floats = as_floats(s.positions);
    expect_same(read_mesh(stl_text(s.positions, s.triangles), Format::stl), s.positions, s.triangles);
    expect_same(read_mesh(stl_bytes(s.positions, s.triangles), Format::stl), floats, s.triangles);
    expect_same(read_mesh(stl_bytes(s.positions, s.triangles, "solid of a careless program"), Format::stl), floats,
                s.triangles);
    expect_same(read_mesh(stl_bytes(s.positions, s.triangles) + "and more", Format::stl), floats, s.triangles);
    std::string capitals = stl_text(s.positions, s.triangles), two;
    for (char& c : capitals) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    expect_same(read_mesh(capitals, Format::stl), s.positions, s.triangles);
    const std::vector<uint32_t> head(s.triangles.begin(), s.triangles.begin() + 30),
        tail(s.triangles.begin() + 30, s.triangles.end());
    two = stl_text(s.positions, head) + stl_text(s.positions, tail);
    expect_same(read_mesh(two, Format::stl), s.positions, s.triangles);
}

// As exporters write them.
TEST(ReadStl, Dialects) {
    Sample s = make_sample();
    number_by_triangles(s.positions, s.triangles);
    const std::string text = stl_text(s.positions, s.triangles), bytes = stl_bytes(s.positions, s.triangles);
    const auto everywhere = [](std::string in, const std::string& from, const std::string& to) {
        for (size_t at = 0; (at = in.find(from, at)) != in.npos; at += to.size()) in.replace(at, from.size(), to);
        return in;
    };
    const auto notes = [&](const std::string& stl) {
        const TriangleMesh mesh = read_mesh(stl, Format::stl);
        EXPECT_EQ(mesh.triangles, s.triangles);
        EXPECT_EQ(mesh.vertex_count(), s.vertex_count());
        return mesh.notes.size();
    };
    EXPECT_EQ(notes(everywhere(everywhere(everywhere(text, "endloop", "end loop"), "endfacet", "END FACET"), "endsolid",
                               "end solid")),
              0u);
    EXPECT_EQ(notes(everywhere(text, "endfacet", "")), 0u);
    std::string no_facet = everywhere(text, "endfacet", "");
    for (size_t at; (at = no_facet.find("facet")) != no_facet.npos;) no_facet.erase(at, no_facet.find('\n', at) - at);
    EXPECT_EQ(notes(no_facet), 0u);
    EXPECT_EQ(notes("\xef\xbb\xbf" + text), 0u);
    EXPECT_EQ(notes(everywhere(text, "\n", "\r")), 0u);
    EXPECT_EQ(notes(replaced(text, "facet", "color 0.5 0.5 0.5\nfacet")), 0u);
    EXPECT_EQ(notes(replaced(text, "endsolid", "# ")), 1u);
    for (const uint32_t count : {0u, 0xffffffffu})
        EXPECT_EQ(notes(bytes.substr(0, 80) + bytes_of(count) + bytes.substr(84)), 1u);
}

TEST(ReadStl, EqualPointsAreOne) {
    const std::vector<double> positions = {0, 1, 2, -0.0, 1, 2, 1e-300, 1, 2, 0, 1, 2};
    const TriangleMesh mesh = read_mesh(stl_text(positions, {0, 1, 2, 3, 2, 1}), Format::stl);
    expect_same(mesh, {0, 1, 2, 1e-300, 1, 2}, {0, 0, 1, 0, 1, 0});
}

TEST(ReadStl, Refusals) {
    const auto refused = [](const std::string& stl, const std::vector<std::string>& says) {
        expect_refused(stl, Format::stl, says);
    };
    const Sample s = make_sample();
    const std::string bytes = stl_bytes(s.positions, s.triangles), text = stl_text(s.positions, s.triangles);
    refused("hello", {"5 bytes", "84"});
    refused(bytes.substr(0, bytes.size() - 1), {"declares 75 triangles", "for 74 only", "cut"});
    refused(bytes.substr(0, 96) + bytes_of(std::nanf("")) + bytes.substr(100), {"triangle 0", "byte 96", "not finite"});
    refused(std::string(84, '\0'), {"no vertices"});
    refused("solid\nendsolid\n", {"no vertices"});
    refused("solid\nhello\n", {":2:", "\"hello\" where facet or endsolid is expected"});
    refused(text.substr(0, text.find("endloop", text.find("endloop") + 1)), {"ends in facet 1", "cut"});
    refused(replaced(text, "outer", "inner"), {":3:", "facet 0 has \"inner\" where outer"});
    refused(replaced(text, " endloop", " vertex 0 0 0\n endloop"), {":7:", "facet 0 has more than three corners"});
    refused(replaced(text, "  vertex", "vertex inf"), {":4:", "not finite"});
}

// --- All formats -------------------------------------------------------------------

TEST(ReadMesh, EveryDoubleComesBack) {
    test::Random random(7);
    Sample s;
    while (s.positions.size() < 3000) {
        const uint64_t bits = random.bits();
        double x;
        std::memcpy(&x, &bits, 8);
        if (std::isfinite(x)) s.positions.push_back(x);
    }
    for (const double x : {4.9e-324, -2.2250738585072011e-308, 1.7976931348623157e308, -0.0, 0.1, 1e23})
        s.positions.push_back(x);
    for (uint32_t v = 0; v < s.vertex_count(); v += 3) s.faces.push_back({v, (v + 1) % 1002, (v + 2) % 1002});
    for (const auto& face : s.faces) s.triangles.insert(s.triangles.end(), face.begin(), face.end());
    const std::string xyz = "property double x\nproperty double y\nproperty double z\n";
    const std::string list = "property list uchar int vertex_indices\n";
    expect_same(read_mesh(obj_vertices(s) + obj_faces(s), Format::obj), s.positions, s.triangles);
    expect_same(read_mesh("OFF\n" + off_counts(s) + off_rows(s, "", ""), Format::off), s.positions, s.triangles);
    for (const PlyKind kind : {ascii, little, big})
        expect_same(
            read_mesh(ply_header(kind, s, xyz, list) + ply_rows<double, uint8_t, int32_t>(kind, s), Format::ply),
            s.positions, s.triangles);
    expect_same(read_mesh(stl_text(s.positions, s.triangles), Format::stl), s.positions, s.triangles);
}

TEST(ReadMesh, FormatOfTheContent) {
    const Sample s = make_sample();
    const Gltf gltf = gltf_of(s.positions, s.triangles);
    const std::string xyz = "property double x\nproperty double y\nproperty double z\n";
    EXPECT_EQ(format_of_content(obj_vertices(s)), Format::obj);
    EXPECT_EQ(format_of_content("# comment\n\nmtllib a.mtl\n"), Format::obj);
    EXPECT_EQ(format_of_content("#\nSTCNOFF\n"), Format::off);
    EXPECT_EQ(format_of_content(ply_header(big, s, xyz, "")), Format::ply);
    EXPECT_EQ(format_of_content("ply\r\n"), Format::ply);
    EXPECT_EQ(format_of_content(stl_text(s.positions, s.triangles)), Format::stl);
    EXPECT_EQ(format_of_content(stl_bytes(s.positions, s.triangles)), Format::stl);
    EXPECT_EQ(format_of_content(gltf.embedded()), Format::gltf);
    EXPECT_EQ(format_of_content(gltf.glb()), Format::gltf);
    EXPECT_FALSE(format_of_content(""));
    EXPECT_FALSE(format_of_content("0 0 0\n"));
    EXPECT_FALSE(format_of_content(std::string("\x7f"
                                               "ELF\0\0",
                                               6)));
}

TEST(ReadMesh, NoHeaderIsBelieved) {
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n", n = "1000000000";
    const std::string list = "property list uint int vertex_indices\n";
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string one_face = "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n";
    const std::string many_points = "element vertex " + n + "\n" + xyz + "element face 1\n" + list + "end_header\n";
    const std::string binary = "ply\nformat binary_little_endian 1.0\n", text = "ply\nformat ascii 1.0\n";
    expect_refused("OFF\n" + n + " 1 0\n" + points, Format::off, {"3 of " + n + " vertices"});
    expect_refused("OFF\n3 " + n + " 0\n" + points, Format::off, {"0 of " + n + " faces"});
    expect_refused("OFF\n3 1 0\n" + points + n + " 0 1 2\n", Format::off, {"3 of " + n + " corners"});
    expect_refused(text + many_points + points, Format::ply, {"3 of " + n + " rows"});
    expect_refused(text + one_face + points + n + " 0 1 2\n", Format::ply, {"face 0 has fewer numbers"});
    expect_refused(binary + many_points + std::string(60, '\0'), Format::ply, {n + " rows", "only 60 bytes"});
    expect_refused(binary + one_face + std::string(36, '\0') + bytes_of(1000000000) + std::string(20, '\0'),
                   Format::ply, {"ends in face 0 of 1"});
    expect_refused(std::string(80, '\0') + bytes_of(1000000000), Format::stl, {n + " triangles", "for 0 only"});
}

TEST(ReadMesh, OldLineEnds) {
    const std::string lines = "OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r";
    const std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    expect_same(read_mesh(lines, Format::off), points, {0, 1, 2});
    expect_same(read_mesh("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", Format::obj), points, {0, 1, 2});
    expect_refused("v 0 0 0\rv 1 0\r", Format::obj, {":2:", "three coordinates"});
    expect_refused("ply\rformat ascii 1.0\rend_header\r", Format::ply, {"carriage returns alone"});
}

// Where each triangle and vertex is in the file, also of polygons and comments between.
TEST(ReadMesh, PlacesInTheFile) {
    const Sample s = make_sample();
    const auto expect = [&](const std::string& text, Format format, const std::vector<size_t>& vertex_lines,
                            const std::vector<size_t>& face_lines) {
        const TriangleMesh mesh = read_mesh(text, format);
        for (size_t v = 0; v < s.vertex_count(); ++v)
            EXPECT_EQ(mesh.origin.name_of_vertex(v),
                      "vertex " + std::to_string(v) + ", line " + std::to_string(vertex_lines[v]));
        size_t triangle = 0;
        for (size_t f = 0; f < s.faces.size(); ++f)
            for (size_t k = 2; k < s.faces[f].size(); ++k)
                EXPECT_EQ(mesh.origin.name_of_triangle(triangle++),
                          "face " + std::to_string(f) + ", line " + std::to_string(face_lines[f]));
    };
    std::vector<size_t> vertex_lines, face_lines;
    std::string obj, off = "OFF\n" + off_counts(s);
    test::Random random(3);
    size_t line = 1;
    const auto gap = [&] {
        for (; random.bits() % 3 == 0; ++line) obj += "# \n";
    };
    for (size_t v = 0; v < s.vertex_count(); ++v) {
        gap();
        obj += "v " + point_text(&s.positions[3 * v]) + "\n";
        vertex_lines.push_back(line++);
    }
    for (const auto& face : s.faces) {
        gap();
        face_lines.push_back(line);
        obj += "f";
        for (const uint32_t v : face) {
            obj += " \\\n" + std::to_string(v + 1);
            ++line;
        }
        obj += "\n";
        ++line;
    }
    expect(obj, Format::obj, vertex_lines, face_lines);
    for (size_t v = 0; v < s.vertex_count(); ++v) vertex_lines[v] = v + 3;
    for (size_t f = 0; f < s.faces.size(); ++f) face_lines[f] = s.vertex_count() + f + 3;
    expect(off + off_rows(s, "", ""), Format::off, vertex_lines, face_lines);
}

TEST(ReadMesh, TwoBytesACharacter) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::string little = "\xff\xfe", big = "\xfe\xff";
    for (const char c : text) {
        little += {c, '\0'};
        big += {'\0', c};
    }
    for (const std::string& bytes : {little, big}) expect_refused(bytes, Format::obj, {":1:", "UTF-16", "save"});
}

// --- Numbers of points -----------------------------------------------------------

TEST(PointNumbers, PointsThatCollideOnPurpose) {
    const std::vector<double> crafted = colliding_points(10000);
    std::vector<double> positions;
    PointNumbers numbers(positions);
    for (int round = 0; round < 2; ++round)
        for (size_t i = 0; i < crafted.size(); i += 3)
            ASSERT_EQ(numbers.number_of(crafted[i], crafted[i + 1], crafted[i + 2]), i / 3);
    EXPECT_EQ(positions, crafted);
}

} // namespace test_readers
