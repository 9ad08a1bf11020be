#include "read_loops.hpp"

#include <algorithm>
#include <charconv>

#include "failure.hpp"
#include "read_mesh.hpp"

namespace cli {

namespace {

// Of a comment "# --weights W,W,..", else none.
void read_weights(const std::string& comment, std::vector<double>& weights) {
    const std::string begin = "# --weights ";
    if (comment.compare(0, begin.size(), begin) != 0) return;
    const char* at = comment.data() + begin.size();
    const char* const stop = comment.data() + comment.size();
    std::vector<double> found;
    while (at != stop) {
        double weight = 0;
        const std::from_chars_result parsed = std::from_chars(at, stop, weight);
        if (parsed.ec != std::errc() || !(weight > 0) || !(weight <= 1e100)) return;
        found.push_back(weight);
        at = parsed.ptr;
        if (at != stop && *at++ != ',') break;
    }
    weights = found;
}

} // namespace

LoopList read_loops(const std::string& path, size_t vertex_count, size_t triangle_count) {
    const std::string text = read_file(path);
    LoopList loops;
    size_t line = 0;
    for (size_t begin = 0; begin < text.size();) {
        size_t end = text.find('\n', begin);
        if (end == std::string::npos) end = text.size();
        std::string row = text.substr(begin, end - begin);
        begin = end + 1;
        ++line;
        const std::string where = path + ":" + std::to_string(line) + ": ";
        const size_t comment = std::min(row.size(), row.find('#'));
        read_weights(row.substr(comment), loops.weights);
        row.erase(comment);
        for (char& c : row)
            if (c == ',' || c == '\t' || c == '\r') c = ' ';

        const char* at = row.data();
        const char* const stop = at + row.size();
        const auto skip_blanks = [&] {
            while (at != stop && *at == ' ') ++at;
        };
        skip_blanks();
        if (at == stop) continue;
        int32_t kind = HMF_PATH_VERTICES;
        const char* const colon = std::find(at, stop, ':');
        const std::string prefix(at, colon);
        const auto is_side = [](char c) { return c >= '0' && c <= '2'; };
        const bool has_sides =
            prefix.size() == 4 && prefix.compare(0, 2, "at") == 0 && is_side(prefix[2]) && is_side(prefix[3]);
        const bool is_arc = prefix == "a" || prefix == "at" || has_sides;
        const bool is_named = colon != stop && (is_arc || prefix == "t" || prefix == "v");
        const bool arc = is_named && is_arc;
        if (is_named) {
            kind = prefix == "a" || prefix == "v" ? HMF_PATH_VERTICES : HMF_PATH_TRIANGLES;
            at = colon + 1;
        }
        if (loops.count() > 0 && kind != loops.element_kind)
            throw Failure(EXIT_BAD_INPUT,
                          where + "loops of vertices and loops of triangles in one file; write all of them in one way");
        loops.element_kind = kind;
        const bool triangles = kind == HMF_PATH_TRIANGLES;
        const size_t limit = triangles ? triangle_count : vertex_count;
        for (skip_blanks(); at != stop; skip_blanks()) {
            uint32_t index = 0;
            const std::from_chars_result parsed = std::from_chars(at, stop, index);
            if (parsed.ec != std::errc() || (parsed.ptr != stop && *parsed.ptr != ' ')) {
                const char* word = at;
                while (at != stop && *at != ' ') ++at;
                throw Failure(EXIT_BAD_INPUT,
                              where + "\"" + std::string(word, at)
                                  + "\" is not an index; write whole numbers from 0, or t: and whole numbers");
            }
            at = parsed.ptr;
            if (index >= limit)
                throw Failure(EXIT_BAD_INPUT, where + (triangles ? "triangle " : "vertex ") + std::to_string(index)
                                                  + " does not exist; the mesh has " + std::to_string(limit)
                                                  + ", counted from 0");
            loops.elements.push_back(index);
        }
        if (loops.elements.size() == loops.offsets.back())
            throw Failure(EXIT_BAD_INPUT, where + "a loop without elements");
        // A path that repeats its first element at the end means the same loop.
        if (!arc && loops.elements.size() > loops.offsets.back() + 1
            && loops.elements.back() == loops.elements[loops.offsets.back()])
            loops.elements.pop_back();
        loops.offsets.push_back(loops.elements.size());
        loops.arcs.push_back(arc);
        for (const size_t end : {2, 3})
            loops.arc_sides.push_back(arc && has_sides ? static_cast<uint32_t>(prefix[end] - '0') : HMF_NONE);
        loops.lines.push_back(line);
    }
    if (loops.weights.size() != loops.count()) loops.weights.clear(); // of other loops
    if (loops.count() == 0) throw Failure(EXIT_BAD_INPUT, path + ": no loops; write one loop a line");
    return loops;
}

} // namespace cli
