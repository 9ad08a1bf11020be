// Numbers points so that equal ones get one number, in the order in which they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

namespace readers {

class PointNumbers {
public:
    // positions: gets three coordinates for each number; outlives this object.
    explicit PointNumbers(std::vector<double>& positions);

    // Coordinates are equal as doubles are: 0 and -0 too.
    uint32_t number_of(double x, double y, double z);

    // Part of the hash of a point, public for a test that makes points collide.
    static uint64_t mix(uint64_t hash, uint64_t word);

private:
    // A table of numbers with open addressing. Points constructed to collide would make it slow, so after an unlikely
    // number of probes a search tree takes over.
    struct Before {
        const std::vector<double>* positions;
        bool operator()(uint32_t a, uint32_t b) const;
    };
    static constexpr uint32_t none = UINT32_MAX;
    static constexpr size_t largest_count = 0x7fffffff;

    bool is_slow() const { return looks_ > 32 * (calls_ + 1024); }
    uint32_t& place_of(const double* point);
    void grow();
    void change_to_tree();

    std::vector<double>& positions_;
    std::vector<uint32_t> table_; // a power of two, at most half full
    std::set<uint32_t, Before> tree_;
    bool has_tree_ = false;
    uint64_t calls_ = 0, looks_ = 0;
};

} // namespace readers
