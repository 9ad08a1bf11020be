#include "write_textured.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "../readers/json.hpp"
#include "options.hpp"
#include "output.hpp"
#include "png.hpp"

namespace cli {

namespace {

// Squares with thin lines; even in both directions, as the transitions ask.  Several tiles are drawn smaller.
Image checkerboard(unsigned tiles) {
    const unsigned step = tiles > 1 ? 4 : 1; // pixels of the large tile in one
    Image tile;
    tile.width = tile.height = tiles * 256 / step;
    for (unsigned row = 0; row < tile.height; ++row)
        for (unsigned column = 0; column < tile.width; ++column) {
            const unsigned x = column * step % 256, y = row * step % 256;
            const bool dark = (x < 64 || x >= 192) != (y < 64 || y >= 192);
            const bool line = x % 64 == 0 || y % 64 == 0 || x % 64 == 64 - step || y % 64 == 64 - step;
            for (const unsigned c :
                 dark ? std::array<unsigned, 3>{190, 40, 48} : std::array<unsigned, 3>{246, 243, 236})
                tile.rgb.push_back(static_cast<uint8_t>(line ? c * 3 / 4 : c));
        }
    return tile;
}

// Each different pair of a vertex and its (u, v) once.
struct Points {
    std::vector<uint32_t> corner; // one that has it
    std::vector<uint32_t> number; // of each corner
};

Points different_points(const Foliation& f, const double* uv) {
    constexpr uint32_t none = 0xffffffffu;
    // A list for each vertex.
    std::vector<uint32_t> head(f.positions.size() / 3, none), next;
    Points points;
    points.number.resize(f.triangles.size());
    for (size_t k = 0; k < f.triangles.size(); ++k) {
        uint32_t& first = head[f.triangles[k]];
        uint32_t at = first;
        while (at != none && (uv[2 * points.corner[at]] != uv[2 * k] || uv[2 * points.corner[at] + 1] != uv[2 * k + 1]))
            at = next[at];
        if (at == none) {
            at = static_cast<uint32_t>(points.corner.size());
            points.corner.push_back(static_cast<uint32_t>(k));
            next.push_back(first);
            first = at;
        }
        points.number[k] = at;
    }
    return points;
}

// Little-endian.
void put(std::string& bytes, uint32_t n) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(n >> shift & 0xff);
}
void put(std::string& bytes, float x) {
    uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    put(bytes, bits);
}
void put(std::string& bytes, double x) {
    uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    put(bytes, static_cast<uint32_t>(bits & 0xffffffffu));
    put(bytes, static_cast<uint32_t>(bits >> 32));
}

void write_bytes(const std::string& path, const std::string& bytes) {
    Output output(path);
    std::fwrite(bytes.data(), 1, bytes.size(), output.file());
    output.close();
}

} // namespace

void write_textured_obj(const std::string& path, const Foliation& f, const double* uv, double period, unsigned tiles) {
    const std::string material = with_extension(path, ".mtl"), texture = with_extension(path, ".png");
    write_bytes(texture, png_of(checkerboard(tiles)));
    write_bytes(material,
                "newmtl checkerboard\nKd 1 1 1\nmap_Kd " + std::filesystem::path(texture).filename().string() + "\n");
    Output output(path);
    std::FILE* file = output.file();
    std::fprintf(file, "# vt = (u, v) / %.17g\nmtllib %s\n", period,
                 std::filesystem::path(material).filename().string().c_str());
    for (size_t v = 0; v < f.positions.size() / 3; ++v)
        std::fprintf(file, "v %.17g %.17g %.17g\n", f.positions[3 * v], f.positions[3 * v + 1], f.positions[3 * v + 2]);
    const Points points = different_points(f, uv);
    for (const size_t k : points.corner)
        std::fprintf(file, "vt %.9g %.9g\n", uv[2 * k] / period, uv[2 * k + 1] / period);
    std::fprintf(file, "usemtl checkerboard\n");
    for (size_t t = 0; t < f.triangle_count(); ++t) {
        std::fputc('f', file);
        for (size_t k = 3 * t; k < 3 * t + 3; ++k)
            std::fprintf(file, " %u/%u", f.triangles[k] + 1, points.number[k] + 1);
        std::fputc('\n', file);
    }
    output.close();
}

void write_textured_ply(const std::string& path, const Foliation& f, const double* uv, double period) {
    const Points points = different_points(f, uv);
    char head[400];
    std::snprintf(head, sizeof head,
                  "ply\nformat binary_little_endian 1.0\ncomment (s, t) = (u, v) / %.17g\nelement vertex %zu\n"
                  "property double x\nproperty double y\nproperty double z\nproperty double s\nproperty double t\n"
                  "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
                  period, points.corner.size(), f.triangle_count());
    std::string bytes = head;
    for (const size_t k : points.corner) {
        for (size_t i = 0; i < 3; ++i) put(bytes, f.positions[3 * size_t{f.triangles[k]} + i]);
        for (size_t i = 0; i < 2; ++i) put(bytes, uv[2 * k + i] / period);
    }
    for (size_t k = 0; k < points.number.size(); ++k) {
        if (k % 3 == 0) bytes += '\3';
        put(bytes, points.number[k]);
    }
    write_bytes(path, bytes);
}

void write_textured_glb(const std::string& path, const Foliation& f, const double* uv, double period, unsigned tiles) {
    using readers::Json;
    const Points points = different_points(f, uv);
    std::string binary;
    Json::Array views;
    const auto end_view = [&](size_t begin, int target) {
        Json view = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", binary.size() - begin}};
        if (target) view.set("target", target);
        views.push_back(view);
        while (binary.size() % 4) binary += '\0';
    };
    FloatFrame frame;
    for (size_t v = 0; v < f.positions.size(); v += 3) frame.add(&f.positions[v]);
    const Place origin = frame.origin();
    size_t joined = 0;
    for (size_t e = 0; e < f.edge_vertices.size(); e += 2)
        joined +=
            frame.joins(&f.positions[size_t{3} * f.edge_vertices[e]], &f.positions[size_t{3} * f.edge_vertices[e + 1]]);
    warn_of_joined(path, joined);
    size_t begin = binary.size();
    float low[3] = {}, high[3] = {};
    for (size_t n = 0; n < points.corner.size(); ++n)
        for (size_t i = 0; i < 3; ++i) {
            const float x = single_precision(f.positions[3 * size_t{f.triangles[points.corner[n]]} + i] - origin[i]);
            low[i] = n ? std::min(low[i], x) : x;
            high[i] = n ? std::max(high[i], x) : x;
            put(binary, x);
        }
    end_view(begin, 34962);
    begin = binary.size();
    // glTF has (0, 0) in the upper left corner of the picture.
    for (const size_t k : points.corner) {
        put(binary, static_cast<float>(uv[2 * k] / period));
        put(binary, static_cast<float>(1 - uv[2 * k + 1] / period));
    }
    end_view(begin, 34962);
    begin = binary.size();
    for (const uint32_t n : points.number) put(binary, n);
    end_view(begin, 34963);
    begin = binary.size();
    binary += png_of(checkerboard(tiles));
    end_view(begin, 0);

    const size_t count = points.corner.size();
    const auto accessor = [](size_t view, int type, size_t n, const char* shape) {
        return Json{{"bufferView", view}, {"componentType", type}, {"count", n}, {"type", shape}};
    };
    Json places = accessor(0, 5126, count, "VEC3");
    places.set("min", std::vector<double>(low, low + 3));
    places.set("max", std::vector<double>(high, high + 3));
    const auto one = [](Json element) { return Json::Array{std::move(element)}; };
    const Json attributes = {{"POSITION", 0}, {"TEXCOORD_0", 1}};
    const Json primitive = {{"attributes", attributes}, {"indices", 2}, {"material", 0}};
    const Json color = {{"baseColorTexture", Json{{"index", 0}}}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}};
    Json node = {{"mesh", 0}};
    if (origin != Place{}) node.set("translation", std::vector<double>(origin.begin(), origin.end()));
    const Json gltf = {
        {"asset", Json{{"version", "2.0"}, {"generator", "hmf"}}},
        {"scene", 0},
        {"scenes", one(Json{{"nodes", std::vector<int>{0}}})},
        {"nodes", one(node)},
        {"meshes", one(Json{{"primitives", one(primitive)}})},
        {"materials", one(Json{{"pbrMetallicRoughness", color}})},
        {"textures", one(Json{{"source", 0}, {"sampler", 0}})},
        {"samplers", one(Json{{"wrapS", 10497}, {"wrapT", 10497}, {"minFilter", 9987}, {"magFilter", 9729}})},
        {"images", one(Json{{"bufferView", 3}, {"mimeType", "image/png"}})},
        {"accessors",
         Json::Array{places, accessor(1, 5126, count, "VEC2"), accessor(2, 5125, points.number.size(), "SCALAR")}},
        {"bufferViews", views},
        {"buffers", one(Json{{"byteLength", binary.size()}})}};
    std::string text = gltf.dump();
    while (text.size() % 4) text += ' ';
    std::string bytes = "glTF";
    put(bytes, uint32_t{2});
    put(bytes, static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
    put(bytes, static_cast<uint32_t>(text.size()));
    bytes += "JSON" + text;
    put(bytes, static_cast<uint32_t>(binary.size()));
    bytes += std::string("BIN\0", 4) + binary;
    write_bytes(path, bytes);
}

} // namespace cli
