// Meshes of the benchmarks as plain arrays: OBJ files, and tori where none is given.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

struct Soup {
    std::string name;
    std::vector<double> position;   // 3 each
    std::vector<uint32_t> triangle; // 3 each
    size_t vertices() const { return position.size() / 3; }
    size_t triangles() const { return triangle.size() / 3; }
    double edges() const { return 1.5 * static_cast<double>(triangles()); }
};

inline bool read_obj(const char* path, Soup& soup) {
    std::FILE* file = std::fopen(path, "r");
    if (!file) return false;
    const char* slash = std::strrchr(path, '/');
    soup.name = slash ? slash + 1 : path;
    if (soup.name.size() > 4) soup.name.resize(soup.name.size() - 4);
    char line[512];
    while (std::fgets(line, sizeof line, file)) {
        if (line[0] == 'v' && line[1] == ' ') {
            char* at = line + 1;
            for (int i = 0; i < 3; ++i) soup.position.push_back(std::strtod(at, &at));
        } else if (line[0] == 'f' && line[1] == ' ') {
            char* at = line + 1;
            for (int i = 0; i < 3; ++i) {
                soup.triangle.push_back(static_cast<uint32_t>(std::strtoul(at, &at, 10) - 1));
                while (*at && *at != ' ') ++at;
            }
        }
    }
    std::fclose(file);
    return !soup.triangle.empty();
}

inline Soup torus(uint32_t around, uint32_t across) {
    Soup soup;
    soup.name = "torus_" + std::to_string(around * across);
    for (uint32_t i = 0; i < around; ++i)
        for (uint32_t j = 0; j < across; ++j) {
            const double u = 6.283185307179586 * (i + 0.3 * (j % 2)) / around, v = 6.283185307179586 * j / across;
            const double r = 3 + std::cos(v);
            soup.position.insert(soup.position.end(), {r * std::cos(u), r * std::sin(u), std::sin(v)});
            const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
            const uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
            soup.triangle.insert(soup.triangle.end(), {a, b, c, a, c, d});
        }
    return soup;
}
