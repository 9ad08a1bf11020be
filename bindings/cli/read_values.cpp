#include "read_values.hpp"

#include <charconv>
#include <cstring>

#include "failure.hpp"
#include "read_mesh.hpp"

namespace cli {

namespace {

// What write_values_npy writes: one row of doubles.
std::vector<double> read_npy(const std::string& path, const std::string& bytes, size_t edges) {
    const auto number = [&](size_t at, size_t count) {
        uint64_t bits = 0;
        for (size_t k = count; k-- > 0;) bits = bits << 8 | static_cast<unsigned char>(bytes[at + k]);
        return bits;
    };
    const size_t length_bytes = bytes.size() > 6 && bytes[6] == 1 ? 2 : 4, start = 8 + length_bytes;
    if (bytes.size() < start || number(8, length_bytes) > bytes.size() - start)
        throw Failure(EXIT_BAD_INPUT, path + ": ends in its header; give a file that --values has written");
    const size_t data = start + number(8, length_bytes);
    const std::string header = bytes.substr(start, data - start);
    const auto has = [&](const std::string& text) { return header.find(text) != std::string::npos; };
    if (!has("'<f8'") || !has("'shape': (" + std::to_string(edges) + ",)") || bytes.size() - data != 8 * edges)
        throw Failure(EXIT_BAD_INPUT, path + ": not one row of " + std::to_string(edges)
                                          + " doubles, a value for each edge; give a file that --values has written");
    std::vector<double> values(edges);
    for (size_t e = 0; e < edges; ++e) {
        const uint64_t bits = number(data + 8 * e, 8);
        std::memcpy(&values[e], &bits, sizeof bits);
    }
    return values;
}

} // namespace

std::vector<double> read_values(const std::string& path, const std::vector<uint32_t>& edge_vertices) {
    const std::string text = read_file(path);
    const size_t edges = edge_vertices.size() / 2;
    if (text.rfind("\x93NUMPY", 0) == 0) return read_npy(path, text, edges);
    std::vector<double> values;
    values.reserve(edges);
    size_t line = 0;
    for (size_t begin = 0; begin < text.size();) {
        size_t end = text.find('\n', begin);
        if (end == std::string::npos) end = text.size();
        const char *at = text.data() + begin, *const stop = text.data() + end;
        begin = end + 1;
        ++line;
        const auto is_blank = [&] { return *at == ' ' || *at == '\t' || *at == '\r'; };
        while (at != stop && is_blank()) ++at;
        if (at == stop) continue;
        const std::string where = path + ":" + std::to_string(line) + ": ";
        if (values.size() == edges)
            throw Failure(EXIT_BAD_INPUT, where + "more lines than the mesh has edges (" + std::to_string(edges) + ")");
        uint32_t vertex[2] = {0, 0};
        double value = 0;
        bool good = true;
        const auto comma = [&] { good = good && at != stop && *at++ == ','; };
        const auto number = [&](auto& x) {
            const std::from_chars_result parsed = std::from_chars(at, stop, x);
            good = good && parsed.ec == std::errc();
            at = parsed.ptr;
        };
        number(vertex[0]);
        comma();
        number(vertex[1]);
        comma();
        number(value);
        while (good && at != stop && is_blank()) ++at;
        if (!good || at != stop)
            throw Failure(EXIT_BAD_INPUT,
                          where + "not a line vertex,vertex,value; give a file that --values has written");
        const size_t e = values.size();
        if (vertex[0] != edge_vertices[2 * e] || vertex[1] != edge_vertices[2 * e + 1])
            throw Failure(EXIT_BAD_INPUT, where + "edge " + std::to_string(e) + " of the mesh joins the vertices "
                                              + std::to_string(edge_vertices[2 * e]) + " and "
                                              + std::to_string(edge_vertices[2 * e + 1])
                                              + "; the file belongs to other triangles");
        values.push_back(value);
    }
    if (values.size() != edges)
        throw Failure(EXIT_BAD_INPUT,
                      path + ": " + std::to_string(values.size()) + " values for " + std::to_string(edges) + " edges");
    return values;
}

} // namespace cli
