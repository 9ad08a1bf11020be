#include "sparse_factor.hpp"

#include <cmath>
#include <cstring>

namespace hmf {

namespace {

constexpr uint32_t NOWHERE = UINT32_MAX;
constexpr uint32_t SMALL = 24;        // unknowns that are numbered as they come
constexpr uint64_t WIDE = 64;         // a layer of more than 8 times the root of the unknowns is wide
constexpr double LEAST_PIVOT = 1e-15; // of the diagonal; less is a kernel, rounding, or a row left out

// Nested dissection.
class Dissection {
public:
    Dissection(const SignedMatrix& matrix, uint32_t* order) : matrix_(matrix), order_(order) {}

    Done run(Call& call) {
        const uint32_t n = matrix_.n;
        if (!part_.allocate_filled(call.memory, n, 0u) || !layer_.allocate(call.memory, n)
            || !queue_.allocate(call.memory, n))
            return false;
        waiting_.start(call.memory);
        for (uint32_t i = 0; i < n; ++i) order_[i] = i;
        if (!waiting_.push({0, n})) return false;
        for (uint32_t part = 0; !waiting_.empty();) {
            const Range range = waiting_.back();
            waiting_.pop();
            if (range.end - range.begin <= SMALL) continue;
            ++part;
            for (uint32_t k = range.begin; k < range.end; ++k) part_[order_[k]] = part;
            if (!call.tick(0, true) || !cut(range, part)) return false;
        }
        return true;
    }

private:
    struct Range {
        uint32_t begin, end; // of order_
    };

    // Those of the part that are reached from one of them to queue_, nearest first, with their layers.
    uint32_t search(uint32_t from, uint32_t part) {
        uint32_t found = 0;
        layer_[from] = 0;
        part_[from] = NOWHERE;
        queue_[found++] = from;
        for (uint32_t k = 0; k < found; ++k) {
            const uint32_t i = queue_[k];
            for (uint32_t t = matrix_.offset[i]; t < matrix_.offset[i + 1]; ++t) {
                const uint32_t j = matrix_.column[t];
                if (part_[j] != part || matrix_.entry[t] == 0) continue;
                part_[j] = NOWHERE;
                layer_[j] = layer_[i] + 1;
                queue_[found++] = j;
            }
        }
        for (uint32_t k = 0; k < found; ++k) part_[queue_[k]] = part;
        return found;
    }

    // What is not reached comes first, then what is before the layer, then what is after it, then the layer.
    Done cut(Range range, uint32_t part) {
        uint32_t found = search(order_[range.begin], part);
        found = search(queue_[found - 1], part);
        const uint32_t half = layer_[queue_[found / 2]], last = layer_[queue_[found - 1]];
        const uint32_t size = range.end - range.begin, unreached = size - found;
        if (unreached > 0) {
            for (uint32_t k = 0; k < found; ++k) part_[queue_[k]] = NOWHERE;
            uint32_t used = range.begin;
            for (uint32_t k = range.begin; k < range.end; ++k)
                if (part_[order_[k]] == part) order_[used++] = order_[k];
            std::memcpy(order_ + used, queue_.data(), found * sizeof(uint32_t));
            return waiting_.push({range.begin, used}) && waiting_.push({used, range.end});
        }
        if (last < 2) return true; // all are neighbors of one
        uint32_t layer = half == last ? last - 1 : half, before = 0, after = 0;
        // A layer much wider than those of a surface lies around an unknown with many neighbors, which cuts better.
        for (;; --layer) {
            for (before = 0; layer_[queue_[before]] < layer;) ++before;
            for (after = before; after < found && layer_[queue_[after]] == layer;) ++after;
            const uint64_t width = after - before;
            if (layer == 1 || width * width <= WIDE * found) break;
        }
        uint32_t* to = order_ + range.begin;
        std::memcpy(to, queue_.data(), before * sizeof(uint32_t));
        std::memcpy(to + before, queue_.data() + after, (found - after) * sizeof(uint32_t));
        std::memcpy(to + before + (found - after), queue_.data() + before, (after - before) * sizeof(uint32_t));
        return waiting_.push({range.begin, range.begin + before})
            && waiting_.push({range.begin + before, range.end - (after - before)});
    }

    const SignedMatrix& matrix_;
    uint32_t* order_;
    Array<uint32_t> part_, layer_, queue_;
    Array<Range> waiting_;
};

} // namespace

Done SparseFactor::number_unknowns(const SignedMatrix& matrix, Call& call) {
    if (!unknown_.allocate(call.memory, matrix.n) || !place_.allocate(call.memory, matrix.n)
        || !Dissection(matrix, unknown_.data()).run(call))
        return false;
    for (uint32_t k = 0; k < matrix.n; ++k) place_[unknown_[k]] = k;
    return true;
}

// Row k of L has an entry in each column on the ways up the tree, up to k, from the entries of the matrix.
Done SparseFactor::find_tree(const SignedMatrix& matrix, Call& call, uint64_t& entries) {
    const uint32_t n = matrix.n;
    Array<uint32_t> seen, count;
    if (!parent_.allocate_filled(call.memory, n, NOWHERE) || !seen.allocate_filled(call.memory, n, NOWHERE)
        || !count.allocate_filled(call.memory, n, 0u) || !first_.allocate(call.memory, size_t{n} + 1))
        return false;
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t i = unknown_[k];
        const uint64_t before = entries;
        seen[k] = k;
        for (uint32_t t = matrix.offset[i]; t < matrix.offset[i + 1]; ++t) {
            if (matrix.entry[t] == 0) continue;
            for (uint32_t j = place_[matrix.column[t]]; j < k && seen[j] != k; j = parent_[j]) {
                if (parent_[j] == NOWHERE) parent_[j] = k;
                ++count[j];
                ++entries;
                seen[j] = k;
            }
        }
        if (!call.work(entries - before + matrix.offset[i + 1] - matrix.offset[i])) return false;
        if (entries > most_entries(n)) return true;
    }
    first_[0] = 0;
    for (uint32_t k = 0; k < n; ++k) first_[k + 1] = first_[k] + count[k];
    return true;
}

Done SparseFactor::eliminate(const SignedMatrix& matrix, Call& call, double shift) {
    const uint32_t n = matrix.n;
    Array<uint32_t> seen, way, above;
    Array<uint64_t> end; // of what a column has so far
    double* const y = y_.data();
    if (!seen.allocate_filled(call.memory, n, NOWHERE) || !way.allocate(call.memory, n)
        || !above.allocate(call.memory, n) || !end.allocate(call.memory, n))
        return false;
    for (uint32_t k = 0; k < n; ++k) end[k] = first_[k];
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t i = unknown_[k];
        uint64_t steps = matrix.offset[i + 1] - matrix.offset[i];
        double pivot = matrix.diagonal[i] + shift;
        // Its columns, each before those above it in the tree: way[top], ..
        uint32_t top = n;
        seen[k] = k;
        for (uint32_t t = matrix.offset[i]; t < matrix.offset[i + 1]; ++t) {
            uint32_t j = place_[matrix.column[t]], length = 0;
            if (j >= k || matrix.entry[t] == 0) continue;
            y[j] += matrix.entry[t];
            for (; seen[j] != k; j = parent_[j]) {
                above[length++] = j;
                seen[j] = k;
            }
            while (length > 0) way[--top] = above[--length];
        }
        for (; top < n; ++top) {
            const uint32_t j = way[top];
            const double value = y[j], part = value / diagonal_[j];
            y[j] = 0;
            steps += 1 + end[j] - first_[j];
            for (uint64_t p = first_[j]; p < end[j]; ++p) y[row_[p]] -= entry_[p] * value;
            pivot -= part * value;
            row_[end[j]] = k;
            entry_[end[j]++] = part;
        }
        diagonal_[k] = pivot > LEAST_PIVOT * matrix.diagonal[i] ? pivot : HUGE_VAL;
        if (!call.work(steps)) return false;
    }
    return true;
}

Done SparseFactor::build(const SignedMatrix& matrix, Call& call, double shift) {
    n_ = 0;
    if (matrix.n > MOST_UNKNOWNS) return true;
    uint64_t entries = 0;
    if (!number_unknowns(matrix, call) || !find_tree(matrix, call, entries)) return false;
    if (entries > most_entries(matrix.n)) return true;
    if (!row_.allocate(call.memory, static_cast<size_t>(entries))
        || !entry_.allocate(call.memory, static_cast<size_t>(entries)) || !diagonal_.allocate(call.memory, matrix.n)
        || !y_.allocate_filled(call.memory, matrix.n, 0.0) || !eliminate(matrix, call, shift))
        return false;
    n_ = matrix.n;
    return true;
}

template <class Real>
void SparseFactor::solve(const Real* b, Real* x) {
    double* const y = y_.data();
    for (uint32_t i = 0; i < n_; ++i) y[place_[i]] = static_cast<double>(b[i]);
    for (uint32_t k = 0; k < n_; ++k)
        for (uint64_t p = first_[k]; p < first_[k + 1]; ++p) y[row_[p]] -= entry_[p] * y[k];
    for (uint32_t k = n_; k-- > 0;) {
        double value = y[k] / diagonal_[k];
        for (uint64_t p = first_[k]; p < first_[k + 1]; ++p) value -= entry_[p] * y[row_[p]];
        y[k] = value;
    }
    for (uint32_t i = 0; i < n_; ++i) x[i] = static_cast<Real>(y[place_[i]]);
}

template void SparseFactor::solve(const double*, double*);
template void SparseFactor::solve(const float*, float*);

} // namespace hmf
