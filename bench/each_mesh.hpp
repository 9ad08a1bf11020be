// The meshes that a benchmark is given, one after the other.
#pragma once

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../bindings/readers/mesh_formats.hpp"

// use(mesh, name of the file).  False: one could not be read, and standard error says why.
template <class Use>
bool for_each_mesh(const std::vector<std::string>& paths, Use use) {
    for (const std::string& path : paths) {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        try {
            use(readers::read_mesh(bytes, readers::Format::obj), path.substr(path.find_last_of('/') + 1));
        } catch (const readers::MeshError& error) {
            std::fprintf(stderr, "%s: %s\n", path.c_str(), error.what());
            return false;
        }
    }
    return true;
}
