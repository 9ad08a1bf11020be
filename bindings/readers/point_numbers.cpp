#include "point_numbers.hpp"

#include <algorithm>
#include <cstring>

#include "mesh_formats.hpp"

namespace readers {

PointNumbers::PointNumbers(std::vector<double>& positions) :
    positions_(positions), table_(64, none), tree_(Before{&positions}) {}

// A bijection in each argument, from splitmix64.
uint64_t PointNumbers::mix(uint64_t hash, uint64_t word) {
    uint64_t z = (hash ^ word) + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

bool PointNumbers::Before::operator()(uint32_t a, uint32_t b) const {
    const double *p = positions->data() + size_t{3} * a, *q = positions->data() + size_t{3} * b;
    return std::lexicographical_compare(p, p + 3, q, q + 3);
}

// The place of an equal point, or the free one for this point.
uint32_t& PointNumbers::place_of(const double* point) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
        const double x = point[k] + 0.0; // -0 becomes 0
        uint64_t word;
        std::memcpy(&word, &x, sizeof word);
        hash = mix(hash, word);
    }
    for (size_t place = static_cast<size_t>(hash);; ++place) {
        uint32_t& number = table_[place & (table_.size() - 1)];
        ++looks_;
        if (number == none) return number;
        const double* const other = positions_.data() + size_t{3} * number;
        if (other[0] == point[0] && other[1] == point[1] && other[2] == point[2]) return number;
    }
}

uint32_t PointNumbers::number_of(double x, double y, double z) {
    const double point[3] = {x, y, z};
    const size_t count = positions_.size() / 3;
    if (count >= largest_count) throw MeshError("the mesh has more than 2^31 points; divide it");
    const uint32_t fresh = static_cast<uint32_t>(count);
    ++calls_;
    if (!has_tree_ && is_slow()) change_to_tree();
    if (has_tree_) {
        positions_.insert(positions_.end(), point, point + 3);
        const uint32_t number = *tree_.insert(fresh).first;
        if (number != fresh) positions_.resize(positions_.size() - 3);
        return number;
    }
    uint32_t& number = place_of(point);
    if (number != none) return number;
    number = fresh;
    positions_.insert(positions_.end(), point, point + 3);
    if (2 * count >= table_.size()) grow();
    return fresh;
}

void PointNumbers::grow() {
    table_.assign(2 * table_.size(), none);
    const size_t count = positions_.size() / 3;
    for (size_t i = 0; i < count && !is_slow(); ++i) place_of(positions_.data() + 3 * i) = static_cast<uint32_t>(i);
}

void PointNumbers::change_to_tree() {
    has_tree_ = true;
    std::vector<uint32_t>().swap(table_);
    const size_t count = positions_.size() / 3;
    for (size_t i = 0; i < count; ++i) tree_.insert(static_cast<uint32_t>(i));
}

} // namespace readers
