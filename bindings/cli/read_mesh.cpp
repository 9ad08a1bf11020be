#include "read_mesh.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <vector>

#include "failure.hpp"
#include "../readers/inflate.hpp"
#include "file_bytes.hpp"

namespace cli {

std::string read_file(const std::string& path) {
    const auto close = [](std::FILE* f) {
        if (f != stdin) std::fclose(f);
    };
    std::unique_ptr<std::FILE, decltype(close)> file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"), close);
    if (!file)
        throw Failure(EXIT_RESOURCES,
                      path + ": cannot be opened (" + std::strerror(errno) + "); check the name and the rights");
    std::string text;
    std::vector<char> block(1u << 20);
    while (size_t count = std::fread(block.data(), 1, block.size(), file.get())) text.append(block.data(), count);
    if (std::ferror(file.get()))
        throw Failure(EXIT_RESOURCES, path + ": cannot be read (" + std::strerror(errno) + ")");
    return text;
}

std::string extension_of(const std::string& path) {
    const size_t dot = path.find_last_of("./\\");
    if (dot == std::string::npos || path[dot] != '.' || dot + 1 == path.size()) return "";
    std::string extension = path.substr(dot);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
    return extension;
}

std::string mesh_extension(const std::string& path) {
    const std::string extension = extension_of(path);
    return extension == ".gz" ? extension_of(path.substr(0, path.size() - 3)) : extension;
}

std::string shown(const std::string& path) { return path == "-" ? "standard input" : path; }

TriangleMesh read_mesh(const std::string& path) {
    const std::string known = std::string(readers::KNOWN_EXTENSIONS) + ", also with .gz",
                      extension = mesh_extension(path);
    std::optional<readers::Format> format = readers::format_of_extension(extension);
    if (!format && !extension.empty())
        throw Failure(EXIT_USAGE,
                      path + ": the tool does not read \"" + extension + "\" files; give " + known
                          + ", or convert it: the Python package reads what trimesh, meshio and pyvista read");
    const FileBytes file(path);
    std::string unpacked;
    std::string_view bytes = file.view();
    try {
        if (readers::is_gzip(bytes)) bytes = unpacked = readers::gunzip(bytes);
    } catch (const readers::MeshError& error) { throw Failure(EXIT_BAD_INPUT, shown(path) + ": " + error.what()); }
    const std::optional<readers::Format> content = readers::format_of_content(bytes);
    if (!format) format = content;
    if (!format)
        throw Failure(EXIT_BAD_INPUT,
                      shown(path) + ": neither its name nor its content says what it is; give " + known);
    std::map<std::string, FileBytes> beside;
    const auto neighbor = [&](const std::string& name) {
        const std::string folder = path.substr(0, path.find_last_of("/\\") + 1);
        return beside.try_emplace(name, folder + name).first->second.view();
    };
    try {
        return readers::read_mesh(bytes, *format, neighbor);
    } catch (const readers::MeshError& error) {
        std::string sentence =
            shown(path) + (error.line > 0 ? ":" + std::to_string(error.line) : "") + ": " + error.what();
        if (content && content != format)
            sentence += "; the content looks like " + std::string(readers::name_of(*content)) + ", rename the file";
        throw Failure(EXIT_BAD_INPUT, sentence);
    }
}

} // namespace cli
