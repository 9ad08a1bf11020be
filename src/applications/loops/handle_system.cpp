// Handle and tunnel loops: cut systems whose loops bound inside the surface, or
// outside of it (Dey, Li, Sun: On computing handle and tunnel loops, 2007).
//
//  1. A cut system and its dual loops are a basis x of the homology.
//  2. They are carried to the mesh of the caller, the only one that is known to be embedded in space, and their Seifert
//  matrix V is
//     computed there (linking.hpp).
//  3. A loop c = sum c_i x_i bounds inside just if c V = 0.  Its intersection
//     numbers y = c J with the basis are sums over the edges that it crosses,
//     of the coefficients of paths of edges homologous to the x_i.  So
//     y J^-1 V = 0 is one condition on a sum of labels of edges once its
//     columns are combined with random factors, in numbers modulo 2^64.
//  4. The cut system with these labels (cut_system.cpp); each loop that it
//     finds is checked without the random factors.  It is searched from half of
//     the basis, which all loops of the kind cross.
#include "handle_system.hpp"

#include "../../core/base/random_word.hpp"
#include "carry_loops.hpp"
#include "class_lengths.hpp"
#include "library_loops.hpp"
#include "linking.hpp"

namespace hmf {

namespace {

// Adds factor times the path of edges on the left of a loop.  It runs from the
// left end of each crossed edge to that of the next:
//
//        left --> left            The third edge of a triangle is passed where
//         |\      /|              the loop turns right.
//         | \    / |    ->
//         |  right |
template <class Number>
void add_left_path(const Mesh& mesh, const uint32_t* crossings, size_t n, Number factor, Number* chain) {
    for (size_t i = 0; i < n; ++i) {
        const uint32_t in = twin(crossings[i]), go = crossings[i + 1 < n ? i + 1 : 0];
        if (go != mesh.next[in]) continue;
        const uint32_t passed = twin(mesh.prev(in));
        chain[edge_of(passed)] += passed & 1u ? Number{0} - factor : factor;
    }
}

// Intersection number of a loop with a closed path of edges.
template <class Number>
Number crossing_sum(const uint32_t* crossings, size_t n, const Number* chain) {
    Number sum = 0;
    for (size_t i = 0; i < n; ++i)
        sum += crossings[i] & 1u ? Number{0} - chain[edge_of(crossings[i])] : chain[edge_of(crossings[i])];
    return sum;
}

// Six times the volume, in any unit: its sign gives the direction of the normals.
double signed_volume(const Mesh& mesh, const double* position) {
    double sum = 0;
    const double* const o = position;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        if (h > mesh.next[h] || h > mesh.prev(h)) continue;
        double u[3][3];
        for (uint32_t i = 0, k = h; i < 3; ++i, k = mesh.next[k])
            for (uint32_t c = 0; c < 3; ++c) u[i][c] = position[3 * size_t{mesh.origin[k]} + c] / 2 - o[c] / 2;
        sum += u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) + u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2])
             + u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
    }
    return sum;
}

// Independent rows of integers, modulo a prime.
class Echelon {
public:
    Done allocate(size_t columns, Memory& memory) {
        columns_ = columns;
        return rows_.allocate(memory, (columns + 1) * columns) && pivot_.allocate(memory, columns);
    }
    size_t rank() const { return rank_; }

    // entry(j): in two's complement.  False: it depends on the rows before, and is left out.
    template <class Entry>
    bool add(const Entry& entry) {
        uint64_t* const row = rows_.data() + columns_ * rank_;
        for (size_t j = 0; j < columns_; ++j) {
            const int64_t x = static_cast<int64_t>(entry(j)) % static_cast<int64_t>(PRIME);
            row[j] = static_cast<uint64_t>(x < 0 ? x + static_cast<int64_t>(PRIME) : x);
        }
        for (size_t k = 0; k < rank_; ++k) {
            const uint64_t* const other = rows_.data() + columns_ * k;
            const uint64_t factor = PRIME - row[pivot_[k]];
            if (factor == PRIME) continue;
            for (size_t j = pivot_[k]; j < columns_; ++j) row[j] = (row[j] + factor * other[j]) % PRIME;
        }
        size_t pivot = 0;
        while (pivot < columns_ && row[pivot] == 0) ++pivot;
        if (pivot == columns_) return false;
        uint64_t inverse = 1, base = row[pivot]; // base^(PRIME - 2)
        for (uint64_t e = PRIME - 2; e; e >>= 1) {
            if (e & 1u) inverse = inverse * base % PRIME;
            base = base * base % PRIME;
        }
        for (size_t j = pivot; j < columns_; ++j) row[j] = row[j] * inverse % PRIME;
        pivot_[rank_++] = pivot;
        return true;
    }

private:
    static constexpr uint64_t PRIME = 0x7fffffff;
    size_t columns_ = 0, rank_ = 0;
    Array<uint64_t> rows_; // one more than there can be; first a 1, at the pivot
    Array<size_t> pivot_;
};

class HandleSystem {
public:
    HandleSystem(const hmf_hierarchy& h, size_t found, bool inside, Call& call) :
        h_(h), found_(found), mesh_(loop_mesh(h, found)), position_(h.levels[found].position), call_(call),
        inside_(inside) {}

    hmf_status run(Loops& out) {
        Loops free, a, b;
        ClassLengths lengths(h_, found_, call_);
        hmf_status status = cut_system(mesh_, position_, nullptr, lengths, call_, free);
        if (!status && !a.copy_from(free, call_.memory)) return call_.out_of_memory();
        if (!status) status = dual_loops(mesh_, a, call_, b);
        if (!status) status = measure(a, b);
        if (!status) status = make_conditions();
        if (!status) status = make_labels(a, b);
        if (!status) status = choose_gates(a, b);
        const LoopCondition only = {label_.data(), &free, &gates_};
        if (!status) status = cut_system(mesh_, position_, &only, lengths, call_, out);
        if (!status) status = verify(a, b, out);
        return status;
    }

private:
    hmf_status not_embedded() {
        return call_.fail(HMF_ERROR_MESH_NOT_EMBEDDED, HMF_ELEMENT_NONE, 0,
                          "The surface intersects itself, so it has no inside. Repair the mesh, or use HMF_LOOPS_CUT "
                          "or HMF_LOOPS_PANTS.");
    }

    // Step 2.
    hmf_status measure(const Loops& a, const Loops& b) {
        const size_t g = a.count();
        Loops both, fine_a, fine_b;
        if (!both.start(call_.memory)) return call_.out_of_memory();
        for (size_t k = 0; k < 2 * g; ++k)
            if (!both.add(k < g ? a : b, k < g ? k : k - g)) return call_.out_of_memory();
        LoopCarrier carrier;
        if (!carrier.load(h_, found_, 0, both, call_.memory)) return call_.out_of_memory();
        while (carrier.level() > 0)
            if (!carrier.refine(call_)) return call_.stopped();
        if (!carrier.read(0, g, fine_a, call_) || !carrier.read(g, 2 * g, fine_b, call_)) return call_.out_of_memory();
        return seifert_form(h_.input, h_.levels[0].position, fine_a, fine_b, call_, form_);
    }

    // The matrix J^-1 V, or J^-1 V^T where the normals point inwards: row k
    // belongs to the intersection number with x_k.  J = (0 T; -T^T 0) with T
    // upper triangular and 1 or -1 on its diagonal.
    hmf_status make_conditions() {
        const size_t n = form_.size, g = n / 2;
        const bool transposed = inside_ != (signed_volume(h_.input, h_.levels[0].position) > 0);
        const auto V = [&](size_t i, size_t j) {
            return static_cast<uint64_t>(form_.linking[transposed ? n * j + i : n * i + j]);
        };
        const auto T = [&](size_t i, size_t j) { return static_cast<uint64_t>(form_.intersection[n * i + g + j]); };
        for (size_t j = 0; j < g; ++j)
            for (size_t i = j; i < g; ++i) {
                const int64_t t = form_.intersection[n * i + g + j];
                if (i == j ? t != 1 && t != -1 : t != 0)
                    return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, j,
                                      "Loops and dual loops do not fit. Please report this.");
            }
        if (!call_.tick(0, true)) return call_.stopped();
        // g on both sides of a surface that does not meet itself.
        Echelon rows;
        if (!rows.allocate(n, call_.memory)) return call_.out_of_memory();
        for (size_t i = 0; i < n; ++i) {
            if (!call_.work(n * (1 + rows.rank()))) return call_.stopped();
            rows.add([&](size_t j) { return V(i, j); });
        }
        if (rows.rank() != g) return not_embedded();
        // (J^-1 V) = (-T^-T V_b ; T^-1 V_a), by substitution.
        if (!condition_.allocate(call_.memory, n * n)) return call_.out_of_memory();
        const auto row = [&](size_t i) { return &condition_[n * i]; };
        const auto subtract = [&](size_t from, uint64_t factor, size_t i) { // most factors are 0
            for (size_t j = 0; factor && j < n; ++j) row(i)[j] -= factor * row(from)[j];
        };
        for (size_t i = 0; i < g; ++i) { // T^T X = -V_b
            if (!call_.work(16 * n)) return call_.stopped();
            for (size_t j = 0; j < n; ++j) row(i)[j] = uint64_t{0} - V(g + i, j);
            for (size_t k = 0; k < i; ++k) subtract(k, T(k, i), i);
            for (size_t j = 0; j < n; ++j) row(i)[j] *= T(i, i);
        }
        for (size_t i = g; i-- > 0;) { // T X = V_a
            for (size_t j = 0; j < n; ++j) row(g + i)[j] = V(i, j);
            for (size_t k = i + 1; k < g; ++k) subtract(g + k, T(i, k), g + i);
            for (size_t j = 0; j < n; ++j) row(g + i)[j] *= T(i, i);
        }
        return HMF_OK;
    }

    // The gates: loops of the basis that each loop of the kind crosses.  If it
    // crosses none, y is 0 there; then y is 0, if the rows of the condition that
    // belong to the others are independent.  Those of the dual loops, which are
    // long, come first, so that the gates are short.
    hmf_status choose_gates(const Loops& a, const Loops& b) {
        const size_t n = form_.size, g = n / 2;
        Echelon rows;
        if (!gates_.start(call_.memory) || !rows.allocate(n, call_.memory)) return call_.out_of_memory();
        for (size_t k = n; k-- > 0;) {
            if (!call_.work(n * (1 + rows.rank()))) return call_.stopped();
            if (rows.rank() < g && rows.add([&](size_t j) { return condition_[n * k + j]; })) continue;
            if (!gates_.add(k < g ? a : b, k < g ? k : k - g)) return call_.out_of_memory();
        }
        return HMF_OK;
    }

    // Step 3.
    hmf_status make_labels(const Loops& a, const Loops& b) {
        const size_t n = form_.size, g = n / 2;
        if (!label_.allocate_filled(call_.memory, mesh_.edge_count, uint64_t{0})) return call_.out_of_memory();
        Array<uint64_t> random;
        uint64_t seed = 0;
        if (!random.allocate(call_.memory, n)) return call_.out_of_memory();
        for (uint64_t& word : random) word = random_word(seed);
        for (size_t k = 0; k < n; ++k) {
            uint64_t factor = 0;
            assert(g > 0);
            if (!call_.work(n)) return call_.stopped();
            for (size_t j = 0; j < n; ++j) factor += condition_[n * k + j] * random[j];
            const Loops& loops = k < g ? a : b;
            add_left_path(mesh_, loops.loop(k % g), loops.length(k % g), factor, label_.data());
        }
        return HMF_OK;
    }

    // Step 4: y J^-1 V = 0 for every loop found, column by column.
    hmf_status verify(const Loops& a, const Loops& b, const Loops& found) {
        const size_t n = form_.size, g = n / 2;
        Array<uint64_t> chain, number; // number: n for each loop
        if (!chain.allocate_filled(call_.memory, mesh_.edge_count, uint64_t{0})
            || !number.allocate(call_.memory, n * g))
            return call_.out_of_memory();
        for (size_t k = 0; k < n; ++k) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            assert(g > 0);
            const Loops& loops = k < g ? a : b;
            const uint32_t* const path = loops.loop(k % g);
            const size_t length = loops.length(k % g);
            add_left_path(mesh_, path, length, uint64_t{1}, chain.data());
            for (size_t c = 0; c < g; ++c)
                number[n * c + k] = crossing_sum(found.loop(c), found.length(c), chain.data());
            add_left_path(mesh_, path, length, ~uint64_t{0}, chain.data());
        }
        Array<uint64_t> sum; // per column
        for (size_t c = 0; c < g; ++c) {
            if (!sum.allocate_filled(call_.memory, n, uint64_t{0}) || !call_.work(4 * n)) return call_.stopped();
            for (size_t k = 0; k < n; ++k)
                for (size_t j = 0; number[n * c + k] && j < n; ++j) sum[j] += number[n * c + k] * condition_[n * k + j];
            for (const uint64_t x : sum)
                if (x)
                    return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, c,
                                      "A loop bounds on neither side. Please report this.");
        }
        return HMF_OK;
    }

    const hmf_hierarchy& h_;
    size_t found_; // the level of the loops
    const Mesh& mesh_;
    const double* position_;
    Call& call_;
    bool inside_;
    SeifertForm form_;
    Array<uint64_t> condition_; // J^-1 V, modulo 2^64
    Array<uint64_t> label_;     // per edge
    Loops gates_;
};

} // namespace

hmf_status handle_system(const hmf_hierarchy& hierarchy, size_t found, bool inside, Call& call, Loops& out) {
    HandleSystem system(hierarchy, found, inside, call);
    return system.run(out);
}

} // namespace hmf
