#include "write_quads.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "../readers/json.hpp"
#include "failure.hpp"
#include "output.hpp"
#include "read_mesh.hpp"

namespace cli {

namespace {

using readers::Json;
using Components = std::vector<Owned<hmf_quad_mesh>>;

void put32(std::string& bytes, uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xffu);
}

void put_float(std::string& bytes, float f) {
    uint32_t word;
    std::memcpy(&word, &f, sizeof word);
    put32(bytes, word);
}

void put_double(std::string& bytes, double value) {
    uint64_t word;
    std::memcpy(&word, &value, sizeof word);
    put32(bytes, static_cast<uint32_t>(word));
    put32(bytes, static_cast<uint32_t>(word >> 32));
}

template <class Use>
void each_quad(const Components& components, const Use& use) {
    uint64_t before = 0;
    for (const Owned<hmf_quad_mesh>& mesh : components) {
        for (uint64_t q = 0; q < mesh->quad_count; ++q) {
            uint64_t corners[4];
            for (size_t c = 0; c < 4; ++c) corners[c] = before + mesh->quads[4 * q + c];
            use(corners, *mesh, mesh->quads + 4 * q);
        }
        before += mesh->vertex_count;
    }
}

void print_vertices(std::FILE* file, const Components& components, const char* format) {
    for (const Owned<hmf_quad_mesh>& mesh : components)
        for (const double* p = mesh->positions; p < mesh->positions + 3 * mesh->vertex_count; p += 3)
            std::fprintf(file, format, p[0], p[1], p[2]); // NOLINT: one of two formats of three numbers
}

std::string ply_of(const Components& components, uint64_t vertices, uint64_t quads) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices)
                      + "\nproperty double x\nproperty double y\nproperty double z\nelement face "
                      + std::to_string(quads) + "\nproperty list uchar uint vertex_indices\nend_header\n";
    for (const Owned<hmf_quad_mesh>& mesh : components)
        for (uint64_t i = 0; i < 3 * mesh->vertex_count; ++i) put_double(bytes, mesh->positions[i]);
    each_quad(components, [&](const uint64_t* corners, const hmf_quad_mesh&, const uint32_t*) {
        bytes += '\4';
        for (size_t c = 0; c < 4; ++c) put32(bytes, static_cast<uint32_t>(corners[c]));
    });
    return bytes;
}

double square_distance(const double* a, const double* b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

std::string glb_of(const std::string& path, const Components& components, uint64_t vertices, uint64_t quads) {
    std::string binary;
    FloatFrame frame;
    for (const Owned<hmf_quad_mesh>& mesh : components)
        for (uint64_t v = 0; v < mesh->vertex_count; ++v) frame.add(mesh->positions + 3 * v);
    const Place origin = frame.origin();
    size_t joined = 0;
    each_quad(components, [&](const uint64_t*, const hmf_quad_mesh& mesh, const uint32_t* own) {
        for (size_t c = 0; c < 4; ++c) {
            const uint32_t a = own[c], b = own[(c + 1) % 4];
            // Each side lies at two quads.
            joined += a < b && frame.joins(mesh.positions + size_t{3} * a, mesh.positions + size_t{3} * b);
        }
    });
    warn_of_joined(path, joined);
    float low[3], high[3];
    bool first = true;
    for (const Owned<hmf_quad_mesh>& mesh : components)
        for (uint64_t i = 0; i < 3 * mesh->vertex_count; ++i) {
            const size_t axis = i % 3;
            const float x = single_precision(mesh->positions[i] - origin[axis]);
            if (first || x < low[axis]) low[axis] = x;
            if (first || x > high[axis]) high[axis] = x;
            if (axis == 2) first = false;
            put_float(binary, x);
        }
    const size_t index_offset = binary.size();
    each_quad(components, [&](const uint64_t* corners, const hmf_quad_mesh& mesh, const uint32_t* own) {
        const auto at = [&](size_t c) { return mesh.positions + size_t{3} * own[c]; };
        const size_t turn = square_distance(at(0), at(2)) <= square_distance(at(1), at(3)) ? 0 : 1;
        for (const size_t c : {0, 1, 2, 0, 2, 3}) put32(binary, static_cast<uint32_t>(corners[(c + turn) % 4]));
    });
    const auto list = [](const float* p) { return Json::Array{double(p[0]), double(p[1]), double(p[2])}; };
    Json asset = {{"version", "2.0"}, {"generator", "hmf"}};
    Json primitive = {{"attributes", Json{{"POSITION", 0}}}, {"indices", 1}, {"mode", 4}};
    Json position = {{"bufferView", 0}, {"componentType", 5126}, {"count", vertices},
                     {"type", "VEC3"},  {"min", list(low)},      {"max", list(high)}};
    Json index = {{"bufferView", 1}, {"componentType", 5125}, {"count", 6 * quads}, {"type", "SCALAR"}};
    Json node = {{"mesh", 0}};
    if (origin != Place{}) node.set("translation", std::vector<double>(origin.begin(), origin.end()));
    Json document = {
        {"asset", asset},
        {"scene", 0},
        {"scenes", Json::Array{Json{{"nodes", Json::Array{Json(0)}}}}},
        {"nodes", Json::Array{node}},
        {"meshes", Json::Array{Json{{"primitives", Json::Array{primitive}}}}},
        {"accessors", Json::Array{position, index}},
        {"bufferViews",
         Json::Array{Json{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", index_offset}, {"target", 34962}},
                     Json{{"buffer", 0},
                          {"byteOffset", index_offset},
                          {"byteLength", binary.size() - index_offset},
                          {"target", 34963}}}},
        {"buffers", Json::Array{Json{{"byteLength", binary.size()}}}}};
    std::string text = document.dump(0);
    while (text.size() % 4) text += ' ';
    while (binary.size() % 4) binary += '\0';
    std::string bytes = "glTF";
    put32(bytes, 2);
    put32(bytes, static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
    put32(bytes, static_cast<uint32_t>(text.size()));
    bytes += "JSON" + text;
    put32(bytes, static_cast<uint32_t>(binary.size()));
    bytes += "BIN";
    bytes += '\0';
    return bytes + binary;
}

} // namespace

void write_quads(const std::string& path, const Components& components) {
    uint64_t vertices = 0, quads = 0;
    for (const Owned<hmf_quad_mesh>& mesh : components) {
        vertices += mesh->vertex_count;
        quads += mesh->quad_count;
    }
    const std::string extension = extension_of(path);
    const bool too_large = 12 * vertices + 24 * quads > 0xfffff000u;
    if (extension == ".glb" && too_large)
        throw Failure(EXIT_RESOURCES, path + ": the quads do not fit into a .glb file; write .ply");
    Output output(path);
    std::FILE* const file = output.file();
    if (extension == ".ply" || extension == ".glb") {
        const std::string bytes =
            extension == ".ply" ? ply_of(components, vertices, quads) : glb_of(path, components, vertices, quads);
        std::fwrite(bytes.data(), 1, bytes.size(), file);
    } else if (extension == ".off") {
        std::fprintf(file, "OFF\n%llu %llu 0\n", static_cast<unsigned long long>(vertices),
                     static_cast<unsigned long long>(quads));
        print_vertices(file, components, "%.17g %.17g %.17g\n");
        each_quad(components, [&](const uint64_t* c, const hmf_quad_mesh&, const uint32_t*) {
            std::fprintf(file, "4 %llu %llu %llu %llu\n", static_cast<unsigned long long>(c[0]),
                         static_cast<unsigned long long>(c[1]), static_cast<unsigned long long>(c[2]),
                         static_cast<unsigned long long>(c[3]));
        });
    } else {
        print_vertices(file, components, "v %.17g %.17g %.17g\n");
        each_quad(components, [&](const uint64_t* c, const hmf_quad_mesh&, const uint32_t*) {
            std::fprintf(file, "f %llu %llu %llu %llu\n", static_cast<unsigned long long>(c[0] + 1),
                         static_cast<unsigned long long>(c[1] + 1), static_cast<unsigned long long>(c[2] + 1),
                         static_cast<unsigned long long>(c[3] + 1));
        });
    }
    output.close();
}

} // namespace cli
