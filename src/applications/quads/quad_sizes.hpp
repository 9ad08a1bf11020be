// How many columns each critical leaf gets and how many rows each cylinder, for
// quads of a given size or a given number of quads.
#pragma once

#include "../../core/base/nearest_first.hpp"
#include "../../core/leaves/cylinders.hpp"

namespace hmf {

constexpr uint64_t MOST_QUADS = uint64_t{1} << 28;

template <class T>
Done copy_array(const Array<T>& from, Array<T>& to, Memory& memory) {
    if (!to.allocate(memory, from.size())) return false;
    for (size_t i = 0; i < from.size(); ++i) to[i] = from[i];
    return true;
}

// Around a cylinder.  columns: per side of an arc; ring: of the closed leaf, if there is no zero.
int64_t columns_across(const Cylinders& cylinders, const Array<int64_t>& columns, int64_t ring, uint32_t cylinder);

class QuadSizes {
public:
    Array<int64_t> columns; // per side of an arc, both sides the same; 0: its ends become one
    Array<int64_t> rows;    // per cylinder
    int64_t ring = 0;       // columns of the closed leaf that counts as critical (genus 1 without poles)

    // length: of each side of an arc along the conjugate; ring_length: of the
    // closed leaf, if there is no zero.  merge: a critical leaf shorter than half
    // an edge may get no column, and one column is enough for the others.
    [[nodiscard]] hmf_status start(const Cylinders& cylinders, const Array<double>& length, double ring_length,
                                   bool merge, Call& call);

    // For edges of this length.
    [[nodiscard]] hmf_status of_step(double step, Call& call);
    // For a number of quads; step: where to begin the search.
    [[nodiscard]] hmf_status of_count(double step, int64_t count, Call& call);

    // At least three rows in each cylinder, two columns on each arc to a pole.
    [[nodiscard]] hmf_status widen_at_poles(Call& call);

    int64_t quad_count() const; // with one quad over each pole
    int64_t across(uint32_t c) const { return columns_across(*cylinders_, columns, ring, c); }

private:
    int64_t rows_needed(uint32_t cylinder);
    struct Step {
        uint32_t state, arc;
    };
    struct Ends {
        uint32_t low, high, arc;
    };

    uint32_t cylinder(uint32_t a) const {
        return cylinders_->of_boundary[graph().sectors[graph().arcs[a].from].boundary];
    }
    int64_t sign(uint32_t a) const {
        return cylinders_->list[cylinder(a)].lower == graph().sectors[graph().arcs[a].from].boundary ? 1 : -1;
    }
    const CriticalGraph& graph() const { return cylinders_->graph; }
    uint32_t zero(uint32_t sector) const { return graph().sectors[sector].zero; }
    bool is_pole(uint32_t sector) const { return prongs_[zero(sector)] == 1; }

    [[nodiscard]] hmf_status round_all(double step, bool& matched, Call& call);
    [[nodiscard]] hmf_status balance(bool& matched, Call& call);
    double cost(uint32_t a, int64_t change) const;
    Done search(uint32_t start, uint32_t& last, uint32_t& last_state, Call& call);
    bool apply(uint32_t last, uint32_t last_state);
    void change(uint32_t a, int64_t by);
    bool raise(uint32_t a, int64_t to);
    [[nodiscard]] hmf_status mend(bool& mended, Call& call);
    double deviation(uint32_t a, int64_t n) const;

    const Cylinders* cylinders_ = nullptr;
    bool merge_ = false;
    double ring_length_ = 0;
    Array<double> length_, wish_;   // per side of an arc
    Array<int64_t> floor_, soft_;   // fewest columns: always, and where there is another way
    Array<int64_t> off_;            // columns of the lower boundary minus those of the upper one
    Array<uint8_t> held_;           // per side: gives nothing away in this search
    Array<int32_t> prongs_, order_; // per zero; of all zeros with this root
    Array<uint32_t> met_;
    Array<uint32_t> root_; // per zero: that it becomes one with
    Array<Step> from_;
    Array<double> reached_;
    Array<Ends> ends_;
    NearestFirst queue_;
};

} // namespace hmf
