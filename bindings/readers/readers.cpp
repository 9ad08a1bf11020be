#include "readers.h"

#include <cstdio>
#include <map>
#include <memory>
#include <new>

#include "holes.hpp"
#include "inflate.hpp"
#include "repair.hpp"

using namespace readers;

namespace {

struct Owner {
    hmf_mesh_file file{};
    TriangleMesh mesh;
    std::vector<uint32_t> vertices, faces;
    std::string notes, error;
};

std::string bytes_of_file(const std::string& path) {
    std::string bytes;
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (!file) throw MeshError("the file " + path + " beside it cannot be opened");
    char block[4096];
    while (const size_t count = std::fread(block, 1, sizeof block, file)) bytes.append(block, count);
    std::fclose(file);
    return bytes;
}

template <class Work>
hmf_mesh_file* guarded(const Work& work) {
    Owner* const owner = new (std::nothrow) Owner;
    if (!owner) return nullptr;
    hmf_mesh_file& file = owner->file;
    file.owner = owner;
    try {
        try {
            work(*owner);
            const TriangleMesh& mesh = owner->mesh;
            for (const std::string& note : mesh.notes) owner->notes += note + "\n";
            for (size_t v = 0; v < mesh.vertex_count(); ++v) owner->vertices.push_back(mesh.origin.vertex_of(v));
            for (size_t t = 0; t < mesh.triangle_count(); ++t)
                owner->faces.push_back(static_cast<uint32_t>(mesh.origin.face_of(t)));
        } catch (const MeshError& error) {
            owner->mesh = {};
            owner->error = error.what();
            file.line = error.line;
        }
    } catch (const std::exception&) {
        delete owner;
        return nullptr;
    }
    file.vertex_count = owner->mesh.vertex_count();
    file.triangle_count = owner->mesh.triangle_count();
    file.positions = owner->mesh.positions.data();
    file.triangles = owner->mesh.triangles.data();
    file.vertices = owner->vertices.data();
    file.faces = owner->faces.data();
    file.notes = owner->notes.c_str();
    file.error = owner->error.c_str();
    return &file;
}

std::string many(size_t count, const char* one, const char* several) {
    return std::to_string(count) + " " + (count == 1 ? one : several);
}

} // namespace

hmf_mesh_file* hmf_mesh_file_read(const char* bytes, uint64_t size, const char* extension, const char* folder) {
    return guarded([&](Owner& owner) {
        std::string_view text(bytes, static_cast<size_t>(size));
        std::string unpacked;
        if (is_gzip(text)) text = unpacked = gunzip(text);
        std::optional<Format> format = format_of_extension(extension);
        const std::optional<Format> content = format_of_content(text);
        if (!format) format = content;
        if (!format)
            throw MeshError(std::string("neither its name nor its content says what it is; give ") + KNOWN_EXTENSIONS);
        std::map<std::string, std::string> beside;
        const auto neighbor = [&](const std::string& name) -> std::string_view {
            const auto [found, is_new] = beside.try_emplace(name);
            if (is_new) found->second = bytes_of_file(std::string(folder) + "/" + name);
            return found->second;
        };
        try {
            owner.mesh = read_mesh(text, *format, neighbor);
        } catch (const MeshError& error) {
            if (!content || content == format) throw;
            throw MeshError(std::string(error.what()) + "; the content looks like " + name_of(*content)
                                + ", rename the file",
                            error.line);
        }
        if (const size_t dropped = drop_unused_vertices(owner.mesh))
            owner.mesh.notes.push_back("dropped " + many(dropped, "unused vertex", "unused vertices"));
    });
}

hmf_mesh_file* hmf_mesh_file_repair(const double* positions, uint64_t vertex_count, const uint32_t* triangles,
                                    uint64_t triangle_count, int32_t repairs, double join_distance,
                                    uint64_t fill_edges) {
    return guarded([&](Owner& owner) {
        TriangleMesh& mesh = owner.mesh;
        mesh.positions.assign(positions, positions + 3 * vertex_count);
        mesh.triangles.assign(triangles, triangles + 3 * triangle_count);
        for (const uint32_t v : mesh.triangles)
            if (v >= vertex_count)
                throw MeshError("a triangle names vertex " + std::to_string(v) + ", which does not exist; there are "
                                + std::to_string(vertex_count) + ", counted from 0");
        if (repairs) {
            const std::optional<double> distance =
                join_distance >= 0 ? std::optional<double>(join_distance) : std::nullopt;
            mesh.notes = repair(mesh, distance).sentences();
        }
        if (const size_t filled = fill_holes(mesh, static_cast<size_t>(fill_edges)))
            mesh.notes.push_back("filled " + many(filled, "hole", "holes"));
    });
}

void hmf_mesh_file_free(hmf_mesh_file* file) {
    if (file) delete static_cast<Owner*>(file->owner);
}
