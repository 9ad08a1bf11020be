// Bytes -> a closed surface of any small genus: the boundary of a plate of cells, some of which are holes, its
// vertices shifted by less than a quarter of an edge and the whole stretched.
//
//     +--+--+--+--+--+
//     |  |  |  |  |  |     holes only where both numbers are odd: no two of them
//     +--+--+--+--+--+     touch, so the boundary is a manifold; its genus is
//     |  |##|  |##|  |     their number
//     +--+--+--+--+--+
//     |  |  |  |  |  |
//     +--+--+--+--+--+
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "bytes.hpp"
#include "owned.hpp"

namespace fuzz {

struct Plate {
    std::vector<double> positions;
    std::vector<uint32_t> triangles;
    size_t genus = 0;

    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return triangles.size() / 3; }

    explicit Plate(Bytes& bytes) {
        const int columns = 1 + static_cast<int>(bytes.below(3)), rows = 1 + static_cast<int>(bytes.below(2));
        const int fine = 1 + static_cast<int>(bytes.below(3)); // cells of the mesh in a cell of the plate
        size_x_ = (2 * columns + 1) * fine, size_y_ = (2 * rows + 1) * fine, size_z_ = fine;
        fine_ = fine;
        for (int i = 0; i < columns * rows; ++i) {
            hole_.push_back(i == 0 || bytes.byte() % 2 == 0);
            genus += hole_.back();
        }
        columns_ = columns;
        uint64_t state = bytes.byte();
        const double shift = bytes.below(128) / 256.0; // of both signs together
        std::map<int, uint32_t> number;
        for (int x = 0; x <= size_x_; ++x)
            for (int y = 0; y <= size_y_; ++y)
                for (int z = 0; z <= size_z_; ++z) {
                    const bool here = full(x, y, z);
                    const int sides[3][4][3] = {{{x, y, z}, {x, y + 1, z}, {x, y + 1, z + 1}, {x, y, z + 1}},
                                                {{x, y, z}, {x, y, z + 1}, {x + 1, y, z + 1}, {x + 1, y, z}},
                                                {{x, y, z}, {x + 1, y, z}, {x + 1, y + 1, z}, {x, y + 1, z}}};
                    const bool beside[3] = {full(x - 1, y, z), full(x, y - 1, z), full(x, y, z - 1)};
                    for (int k = 0; k < 3; ++k) {
                        if (here == beside[k]) continue;
                        uint32_t v[4];
                        for (int c = 0; c < 4; ++c) {
                            const int* const p = sides[k][c];
                            const auto made =
                                number.insert({(p[0] * 64 + p[1]) * 64 + p[2], static_cast<uint32_t>(number.size())});
                            v[c] = made.first->second;
                            for (int i = 0; made.second && i < 3; ++i)
                                positions.push_back(
                                    p[i] + shift * (static_cast<double>(next_random(state) % 1024) / 1024 - 0.5));
                        }
                        const size_t turn = here ? 2 : 0; // the other way round
                        triangles.insert(triangles.end(), {v[0], v[1 + turn], v[2], v[0], v[2], v[3 - turn]});
                    }
                }
        const double stretch[3] = {1 + bytes.byte() / 16.0, 1 + bytes.byte() / 64.0, 1};
        for (size_t i = 0; i < positions.size(); ++i) positions[i] *= stretch[i % 3];
    }

private:
    bool full(int x, int y, int z) const {
        if (x < 0 || y < 0 || z < 0 || x >= size_x_ || y >= size_y_ || z >= size_z_) return false;
        const int i = x / fine_, j = y / fine_;
        return !(i % 2 == 1 && j % 2 == 1 && hole_[static_cast<size_t>(j / 2 * columns_ + i / 2)]);
    }
    int size_x_, size_y_, size_z_, fine_, columns_;
    std::vector<bool> hole_;
};

} // namespace fuzz
