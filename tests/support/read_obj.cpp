#include "read_obj.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace test {

namespace {

bool read_file(const std::string& path, std::string& text) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return false;
    text.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    return true;
}

} // namespace

size_t count_obj_vertices(const std::string& path) {
    std::string text;
    if (!read_file(path, text)) return 0;
    size_t count = text.compare(0, 2, "v ") == 0;
    for (size_t at = text.find("\nv "); at != std::string::npos; at = text.find("\nv ", at + 1)) ++count;
    return count;
}

bool read_obj(const std::string& path, TriMesh& mesh) {
    std::string text;
    if (!read_file(path, text)) return false;
    mesh = TriMesh();
    const char* p = text.c_str();
    while (*p) {
        const char* end = p;
        while (*end && *end != '\n') ++end;
        if (p[0] == 'v' && p[1] == ' ') {
            char* rest = const_cast<char*>(p + 2);
            for (int x = 0; x < 3; ++x) mesh.positions.push_back(std::strtod(rest, &rest));
        } else if (p[0] == 'f' && p[1] == ' ') {
            std::vector<uint32_t> corners;
            const char* q = p + 2;
            while (q < end) {
                while (q < end && (*q == ' ' || *q == '\t' || *q == '\r')) ++q;
                if (q == end) break;
                const long index = std::strtol(q, nullptr, 10); // before any slash
                corners.push_back(
                    static_cast<uint32_t>(index > 0 ? index - 1 : static_cast<long>(mesh.vertex_count()) + index));
                while (q < end && *q != ' ' && *q != '\t' && *q != '\r') ++q;
            }
            for (size_t c = 2; c < corners.size(); ++c)
                mesh.triangles.insert(mesh.triangles.end(), {corners[0], corners[c - 1], corners[c]});
        }
        p = *end ? end + 1 : end;
    }
    // Closed: 2 E = 3 T, so V - E + T = V - T / 2 = 2 - 2 genus.
    const long chi = static_cast<long>(mesh.vertex_count()) - static_cast<long>(mesh.triangle_count() / 2);
    mesh.genus = static_cast<size_t>(std::max(0L, (2 - chi) / 2));
    return true;
}

} // namespace test
