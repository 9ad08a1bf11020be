#include "marks.hpp"

#include <charconv>
#include <unordered_map>

#include "../readers/components.hpp"
#include "library.hpp"
#include "output.hpp"

namespace cli {

std::vector<uint32_t> read_marks(const std::string& path, size_t vertex_count) {
    std::string text;
    try {
        text = read_file(path);
    } catch (const Failure&) {
        throw Failure(EXIT_RESOURCES, "--marks: \"" + path + "\" is neither auto nor none nor a file that can be read");
    }
    std::vector<uint32_t> marks;
    std::unordered_map<uint32_t, size_t> line_of;
    size_t line = 0;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.size(), text.find('\n', begin));
        std::string row = text.substr(begin, end - begin);
        begin = end + 1;
        ++line;
        const std::string where = path + ":" + std::to_string(line) + ": ";
        row.erase(std::min(row.size(), row.find('#')));
        const char* const blanks = " \t\r,";
        for (size_t at = 0; (at = row.find_first_not_of(blanks, at)) != std::string::npos;) {
            const std::string word = row.substr(at, row.find_first_of(blanks, at) - at);
            at += word.size();
            uint32_t vertex = 0;
            const std::from_chars_result parsed = std::from_chars(word.data(), word.data() + word.size(), vertex);
            if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size())
                throw Failure(EXIT_BAD_INPUT, where + "\"" + word + "\" is not a vertex; write whole numbers from 0");
            if (vertex >= vertex_count)
                throw Failure(EXIT_BAD_INPUT, where + "vertex " + word + " does not exist; the mesh has "
                                                  + std::to_string(vertex_count) + ", counted from 0");
            const auto [first, is_new] = line_of.emplace(vertex, line);
            if (!is_new)
                throw Failure(EXIT_BAD_INPUT, where + "vertex " + word + " is marked twice, first in line "
                                                  + std::to_string(first->second) + "; name each marked vertex once");
            marks.push_back(vertex);
        }
    }
    return marks;
}

hmf_status suggest_marks(const TriangleMesh& mesh, const hmf_hierarchy_options& options, const hmf_control* control,
                         std::vector<uint32_t>& marks, hmf_error& error) {
    // Checks the numbers of vertices, edges and triangles only; the library reports other defects of a mesh.
    const size_t vertices = mesh.vertex_count(), triangles = mesh.triangle_count();
    const bool may_be_sphere = triangles + 4 == 2 * vertices;
    // Closed surfaces with handles have too few vertices.
    const bool may_be_disk =
        !may_be_sphere && 2 * vertices >= triangles + 2 && vertices + triangles == readers::edges_of(mesh).count() + 1;
    // Two triangles back to back are a sphere as well, but have no four vertices to mark.
    if ((!may_be_sphere && !may_be_disk) || vertices < 4) return HMF_OK;
    hmf_mark_set* raw = nullptr;
    const hmf_status status = hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                mesh.triangle_count(), &options, control, &raw, &error);
    const Owned<hmf_mark_set> set(raw);
    if (set) marks.assign(set->marked_vertices, set->marked_vertices + set->marked_count);
    return status;
}

std::string sentence_of(const std::vector<uint32_t>& suggested, size_t components, bool tips) {
    const size_t count = suggested.size();
    std::string text = "marked " + std::to_string(count) + " vertices";
    if (tips) text += ", two at each of " + std::to_string(count / 2) + " tips";
    if (components > 1)
        return text + " of " + std::to_string(components)
             + " components (--save-marks FILE for all, --marks FILE for others)";
    text += ":";
    for (const uint32_t v : suggested) text += " " + std::to_string(v);
    return text + " (--marks FILE for others)";
}

void write_marks(const std::string& path, const std::vector<uint32_t>& marks) {
    Output output(path);
    std::fprintf(output.file(), "# %zu marked vertices\n", marks.size());
    for (const uint32_t v : marks) std::fprintf(output.file(), "%u\n", v);
    output.close();
}

} // namespace cli
