// One mesh as bytes of every format and dialect, and what the readers make of it.
#pragma once

#include <mesh_formats.hpp>
#include <point_numbers.hpp>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "meshes.hpp"

namespace test {

using namespace readers;

// --- The mesh ------------------------------------------------------------------

struct Sample {
    std::vector<double> positions;
    std::vector<std::vector<uint32_t>> faces; // triangles, a quad, a pentagon
    std::vector<uint32_t> triangles;          // the fans
    size_t vertex_count() const { return positions.size() / 3; }
};

inline Sample make_sample() {
    const test::TriMesh torus = test::torus(7, 5, 2, 0.8);
    Sample s;
    s.positions = torus.positions;
    for (size_t c = 0; c < torus.triangles.size(); c += 3)
        s.faces.emplace_back(&torus.triangles[c], &torus.triangles[c] + 3);
    s.faces.push_back({0, 1, 2, 3});
    s.faces.push_back({4, 3, 2, 1, 0});
    s.triangles = torus.triangles;
    s.triangles.insert(s.triangles.end(), {0, 1, 2, 0, 2, 3, 4, 3, 2, 4, 2, 1, 4, 1, 0});
    return s;
}

// Coordinates as a format with floats keeps them.
inline std::vector<double> as_floats(const std::vector<double>& positions) {
    std::vector<double> result;
    for (const double x : positions) result.push_back(static_cast<double>(static_cast<float>(x)));
    return result;
}

inline void expect_same(const TriangleMesh& mesh, const std::vector<double>& positions,
                        const std::vector<uint32_t>& triangles) {
    EXPECT_EQ(mesh.triangles, triangles);
    ASSERT_EQ(mesh.positions.size(), positions.size());
    EXPECT_EQ(std::memcmp(mesh.positions.data(), positions.data(), 8 * positions.size()), 0);
}

// --- Writers -------------------------------------------------------------------

inline std::string digits17(double x) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", x);
    return buffer;
}

inline std::string point_text(const double* p) { return digits17(p[0]) + " " + digits17(p[1]) + " " + digits17(p[2]); }

template <typename Number>
inline std::string bytes_of(Number number, bool big_endian = false) {
    uint64_t bits = 0;
    if constexpr (std::is_same_v<Number, double>) std::memcpy(&bits, &number, 8);
    else if constexpr (std::is_same_v<Number, float>) {
        uint32_t word;
        std::memcpy(&word, &number, 4);
        bits = word;
    } else bits = static_cast<uint64_t>(number);
    std::string bytes(sizeof number, '\0');
    for (size_t i = 0; i < sizeof number; ++i)
        bytes[big_endian ? sizeof number - 1 - i : i] = static_cast<char>(bits >> 8 * i & 0xff);
    return bytes;
}

inline std::string obj_vertices(const Sample& s, const std::string& behind = "") {
    std::string obj;
    for (size_t v = 0; v < s.vertex_count(); ++v) obj += "v " + point_text(&s.positions[3 * v]) + behind + "\n";
    return obj;
}

// corner(v): how a face names vertex v.
template <typename Corner>
inline std::string obj_faces(const Sample& s, const Corner& corner) {
    std::string obj;
    for (const auto& face : s.faces) {
        obj += "f";
        for (const uint32_t v : face) obj += " " + corner(v);
        obj += "\n";
    }
    return obj;
}

inline std::string obj_faces(const Sample& s) {
    return obj_faces(s, [](uint32_t v) { return std::to_string(v + 1); });
}

inline std::string off_rows(const Sample& s, const std::string& behind_vertex, const std::string& behind_face) {
    std::string off;
    for (size_t v = 0; v < s.vertex_count(); ++v) off += point_text(&s.positions[3 * v]) + behind_vertex + "\n";
    for (const auto& face : s.faces) {
        off += std::to_string(face.size());
        for (const uint32_t v : face) off += " " + std::to_string(v);
        off += behind_face + "\n";
    }
    return off;
}

inline std::string off_counts(const Sample& s) {
    return std::to_string(s.vertex_count()) + " " + std::to_string(s.faces.size()) + " 0\n";
}

enum PlyKind { ascii, little, big };

inline std::string ply_header(PlyKind kind, const Sample& s, const std::string& vertex_properties,
                              const std::string& face_properties, const std::string& other = "") {
    const char* const format[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    return std::string("ply\nformat ") + format[kind] + " 1.0\ncomment element face 3\nobj_info x\n" + other
         + "element vertex " + std::to_string(s.vertex_count()) + "\n" + vertex_properties + "element face "
         + std::to_string(s.faces.size()) + "\n" + face_properties + "end_header\n";
}

// Numbers of a PLY, as text or bytes.
class PlyRow {
public:
    explicit PlyRow(PlyKind kind) : kind_(kind) {}
    template <typename Number>
    PlyRow& operator<<(Number number) {
        if (kind_ == ascii) row_ += (row_.empty() ? "" : " ") + digits17(static_cast<double>(number));
        else row_ += bytes_of(number, kind_ == big);
        return *this;
    }
    std::string end() const { return kind_ == ascii ? row_ + "\n" : row_; }

private:
    PlyKind kind_;
    std::string row_;
};

template <typename Real, typename Count, typename Index>
inline std::string ply_rows(PlyKind kind, const Sample& s) {
    std::string rows;
    for (size_t v = 0; v < s.vertex_count(); ++v) {
        PlyRow row(kind);
        for (size_t k = 0; k < 3; ++k) row << static_cast<Real>(s.positions[3 * v + k]);
        rows += row.end();
    }
    for (const auto& face : s.faces) {
        PlyRow row(kind);
        row << static_cast<Count>(face.size());
        for (const uint32_t v : face) row << static_cast<Index>(v);
        rows += row.end();
    }
    return rows;
}

inline std::string stl_text(const std::vector<double>& positions, const std::vector<uint32_t>& triangles) {
    std::string stl = "solid a name\n";
    for (size_t c = 0; c < triangles.size(); c += 3) {
        stl += "facet normal 0 nan 1\n outer loop\n";
        for (size_t k = 0; k < 3; ++k) stl += "  vertex " + point_text(&positions[size_t{3} * triangles[c + k]]) + "\n";
        stl += " endloop\nendfacet\n";
    }
    return stl + "endsolid a name\n";
}

inline std::string stl_bytes(const std::vector<double>& positions, const std::vector<uint32_t>& triangles,
                             const std::string& header = "") {
    std::string stl = header + std::string(80 - header.size(), header.empty() ? '\0' : ' ');
    stl += bytes_of(static_cast<uint32_t>(triangles.size() / 3));
    for (size_t c = 0; c < triangles.size(); c += 3) {
        stl += std::string(12, '\xff'); // a normal that is not a number
        for (size_t k = 0; k < 3; ++k)
            for (size_t x = 0; x < 3; ++x)
                stl += bytes_of(static_cast<float>(positions[size_t{3} * triangles[c + k] + x]));
        stl += "ab";
    }
    return stl;
}

// Points in the order in which the triangles meet them first, as STL has them.
inline void number_by_triangles(std::vector<double>& positions, std::vector<uint32_t>& triangles) {
    std::vector<double> met;
    std::vector<uint32_t> number(positions.size() / 3, UINT32_MAX);
    for (uint32_t& v : triangles) {
        if (number[v] == UINT32_MAX) {
            number[v] = static_cast<uint32_t>(met.size() / 3);
            met.insert(met.end(), &positions[size_t{3} * v], &positions[size_t{3} * v] + 3);
        }
        v = number[v];
    }
    positions = met;
}

inline std::string base64(const std::string& bytes) {
    const char* const digit = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digit[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

// A glTF in the making: numbers go into one buffer, the rest is JSON that a test writes itself.
struct Gltf {
    std::string buffer, views, accessors, scene = "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],";
    std::string nodes = "{\"mesh\":0}", primitives, more;
    int count = 0;

    // Number of the new accessor.  stride: of the bytes, 0 for none.
    int add(const std::string& bytes, size_t elements, int type, const char* kind, size_t stride = 0,
            const std::string& rest = "") {
        const std::string comma = count ? "," : "";
        views += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(buffer.size()) + ",\"byteLength\":"
               + std::to_string(bytes.size()) + (stride ? ",\"byteStride\":" + std::to_string(stride) : "") + "}";
        accessors += comma + "{\"bufferView\":" + std::to_string(count) + ",\"componentType\":" + std::to_string(type)
                   + ",\"count\":" + std::to_string(elements) + ",\"type\":\"" + kind + "\"" + rest + "}";
        buffer += bytes + std::string((4 - bytes.size() % 4) % 4, '\0');
        return count++;
    }
    int add_points(const std::vector<double>& positions) {
        std::string bytes;
        for (const double x : positions) bytes += bytes_of(static_cast<float>(x));
        return add(bytes, positions.size() / 3, 5126, "VEC3");
    }
    template <typename Index>
    int add_indices(const std::vector<uint32_t>& triangles) {
        std::string bytes;
        for (const uint32_t v : triangles) bytes += bytes_of(static_cast<Index>(v));
        return add(bytes, triangles.size(), sizeof(Index) == 1 ? 5121 : sizeof(Index) == 2 ? 5123 : 5125, "SCALAR");
    }
    void add_primitive(int points, int indices, const std::string& rest = "") {
        primitives += std::string(primitives.empty() ? "" : ",")
                    + "{\"attributes\":{\"POSITION\":" + std::to_string(points) + "}"
                    + (indices < 0 ? "" : ",\"indices\":" + std::to_string(indices)) + rest + "}";
    }
    std::string json(const std::string& uri) const {
        return "{\"asset\":{\"version\":\"2.0\"}," + more + scene + "\"nodes\":[" + nodes
             + "],\n\"meshes\":[{\"primitives\":[" + primitives + "]}],\"buffers\":[{\"byteLength\":"
             + std::to_string(buffer.size()) + (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}],\"bufferViews\":["
             + views + "],\"accessors\":[" + accessors + "]}";
    }
    std::string embedded() const { return json("data:application/octet-stream;base64," + base64(buffer)); }
    std::string glb() const {
        std::string text = json("");
        text += std::string((4 - text.size() % 4) % 4, ' ');
        const auto word = [](size_t n) { return bytes_of(static_cast<uint32_t>(n)); };
        return "glTF" + word(2) + word(28 + text.size() + buffer.size()) + word(text.size()) + "JSON" + text
             + word(buffer.size()) + std::string("BIN\0", 4) + buffer;
    }
};

inline Gltf gltf_of(const std::vector<double>& positions, const std::vector<uint32_t>& triangles) {
    Gltf gltf;
    const int points = gltf.add_points(positions);
    gltf.add_primitive(points, gltf.add_indices<uint32_t>(triangles));
    return gltf;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return text.replace(at, from.size(), to);
}

// --- Hard inputs ---------------------------------------------------------------

// Points whose hashes in PointNumbers are the same.
inline std::vector<double> colliding_points(size_t n) {
    // The third coordinate makes the hash of all these points the same.
    std::vector<double> crafted;
    for (uint64_t i = 1; crafted.size() < 3 * n; ++i) {
        const double x = static_cast<double>(i);
        uint64_t word;
        std::memcpy(&word, &x, 8);
        word = PointNumbers::mix(PointNumbers::mix(0, word), word) ^ 0x123456789abcdefu;
        double z;
        std::memcpy(&z, &word, 8);
        if (std::isfinite(z)) crafted.insert(crafted.end(), {x, x, z});
    }
    return crafted;
}

// Of n nodes, all but the first are `node`.
inline Gltf with_nodes(const TriMesh& mesh, size_t n, const char* node) {
    Gltf gltf = gltf_of(mesh.positions, mesh.triangles);
    for (size_t i = 1; i < n; ++i) gltf.nodes += node;
    return gltf;
}

// --- Defects -------------------------------------------------------------------

// The sentence of the refusal, with the line in front as the tool has it.
inline std::string refusal(const std::string& bytes, Format format) {
    try {
        read_mesh(bytes, format);
    } catch (const MeshError& error) {
        return (error.line > 0 ? ":" + std::to_string(error.line) + ": " : "") + error.what();
    }
    return "not refused";
}

inline void expect_refused(const std::string& bytes, Format format, const std::vector<std::string>& says) {
    const std::string sentence = refusal(bytes, format);
    for (const std::string& part : says)
        EXPECT_NE(sentence.find(part), sentence.npos) << sentence << "\nhas no " << part;
    for (const char c : sentence) EXPECT_TRUE(c >= ' ' && c <= '~') << sentence;
}

} // namespace test
