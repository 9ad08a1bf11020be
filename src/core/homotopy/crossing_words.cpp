// Words from a tree, and what flips and splits make of them; see crossing_words.hpp.
#include "crossing_words.hpp"

#include "../base/cyclic.hpp"
#include "tree_cotree.hpp"

namespace hmf {

namespace {

constexpr size_t CROSSINGS_STRIDE = 65536, CROSSING_SPLITS_STRIDE = 4096; // edges, and splits, between two reports

// Letters are even, their inverses one more.
Done append_letter(uint32_t letter, Walk& word) {
    if (word.empty() || word.back() != (letter ^ 1u)) return word.push(letter);
    word.pop();
    return true;
}

// The gap of each side of the tree, with the letters of the sides passed since it began.
struct Gaps {
    Array<uint32_t> of; // per half-edge
    Array<uint64_t> offset;
    Array<uint32_t> letters;

    Done start(const Mesh& mesh, Memory& memory) {
        offset.start(memory);
        letters.start(memory);
        return of.allocate(memory, size_t{2} * mesh.edge_count) && offset.push(0);
    }
    Done add(const Walk& word) {
        for (const uint32_t letter : word)
            if (!letters.push(letter)) return false;
        return offset.push(letters.size());
    }
    uint32_t last() const { return static_cast<uint32_t>(offset.size() - 2); }
    // gap(from)^-1 gap(to)
    Done between(uint32_t from, uint32_t to, Walk& word) const {
        word.clear();
        for (uint64_t i = offset[from + size_t{1}]; i-- > offset[from];)
            if (!append_letter(letters[i] ^ 1u, word)) return false;
        for (uint64_t i = offset[to]; i < offset[to + size_t{1}]; ++i)
            if (!append_letter(letters[i], word)) return false;
        return true;
    }
};

} // namespace

Done CrossingWords::start(const Mesh& mesh, uint32_t edge_capacity, Call& call) {
    Array<EdgeKind> kind;
    Gaps gaps;
    Walk gap;
    memory_ = &call.memory;
    scratch_.start(call.memory);
    gap.start(call.memory);
    if (!find_trees(mesh, kind, call) || !words_.start(edge_capacity, call.memory) || !gaps.start(mesh, call.memory))
        return false;
    const auto is = [&](uint32_t half_edge, EdgeKind which) { return kind[edge_of(half_edge)] == which; };
    uint32_t letter = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (kind[e] != EdgeKind::side) continue;
        scratch_.clear();
        if (!scratch_.push(letter) || !words_.set(2 * e, scratch_)) return false;
        letter += 2;
    }
    // Around the tree, from a marked vertex.
    uint32_t h = mesh.out[0];
    while (!is(h, EdgeKind::in_tree)) h = mesh.rotate_cw(h);
    if (!gaps.add(gap)) return false;
    for (uint32_t side = 0; side + 2 < 2 * mesh.vertex_count; ++side) {
        gaps.of[h] = gaps.last();
        bool same = true;
        const uint32_t v = mesh.target(h);
        for (h = mesh.next[h]; !is(h, EdgeKind::in_tree); h = mesh.rotate_cw(h)) {
            same = same && is(h, EdgeKind::across);
            if (!append(h, gap)) return false;
        }
        if (mesh.is_marked(v)) {
            gap.clear();
            if (!gap.push(letter)) return false;
            letter += 2;
            same = false;
        }
        if (!same && !gaps.add(gap)) return false;
    }
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % CROSSINGS_STRIDE == 0 && !call.tick(0, true)) return false;
        if (kind[e] != EdgeKind::in_tree || gaps.of[2 * e] == gaps.of[2 * e + 1]) continue;
        if (!gaps.between(gaps.of[2 * e], gaps.of[2 * e + 1], scratch_) || !words_.set(2 * e, scratch_)) return false;
    }
    return true;
}

Done CrossingWords::append(uint32_t half_edge, Walk& word) const {
    return words_.for_letters(half_edge, [&](uint32_t letter, bool backwards) {
        return append_letter(letter ^ (backwards ? 1u : 0u), word);
    });
}

Done CrossingWords::product(uint32_t first, uint32_t second, Walk& word) const {
    word.clear();
    return append(first, word) && append(second, word);
}

Done CrossingWords::flipped(const Mesh& mesh, uint32_t edge, bool reversed) {
    if (!words_.has(edge)) return true;
    const uint32_t h = 2 * edge, a = mesh.next[h], b = mesh.next[a], c = mesh.next[twin(h)], d = mesh.next[c];
    // Sides of the triangle that was on the left of h, and on its right.
    const uint32_t left[2] = {reversed ? b : a, reversed ? c : d}, right[2] = {reversed ? a : b, reversed ? d : c};
    size_t as_left = 0, as_right = 0; // letters
    for (const uint32_t x : left) {
        if (!product(twin(h), x, scratch_)) return false;
        as_left += words_.length(x);
        as_right += scratch_.size();
    }
    for (const uint32_t x : right) {
        if (!product(h, x, scratch_)) return false;
        as_left += scratch_.size();
        as_right += words_.length(x);
    }
    const bool is_left = as_left <= as_right;
    for (const uint32_t x : is_left ? right : left)
        if (!product(is_left ? h : twin(h), x, scratch_) || !words_.set(x, scratch_)) return false;
    words_.clear(edge);
    return true;
}

Done CrossingWords::were_split(const Mesh& mesh, const Collapse* collapses, size_t count, Call& call) {
    struct Branches {        // of the forest, at a new vertex
        uint32_t count, sum; // sum: of their edges
    };
    const uint32_t old = mesh.vertex_count - static_cast<uint32_t>(count);
    Array<Branches> branches;
    Array<uint32_t> leaves;
    if (!branches.allocate_filled(call.memory, count, Branches{0, 0}) || !leaves.allocate(call.memory, count))
        return false;
    const auto ends = [&](uint32_t e, auto visit) {
        for (const uint32_t v : {mesh.origin[2 * e], mesh.origin[2 * e + 1]})
            if (v >= old) visit(branches[v - old], v);
    };
    for (size_t i = 0; i < count; ++i) {
        if (i % CROSSING_SPLITS_STRIDE == 0 && !call.tick(0, true)) return false;
        for (const uint32_t h : {collapses[i].h, collapses[i].jk, collapses[i].lj}) words_.clear(edge_of(h));
        const uint32_t e = edge_of(collapses[i].h);
        ends(e, [&](Branches& b, uint32_t) {
            ++b.count;
            b.sum += e;
        });
    }
    size_t begin = 0, end = 0;
    for (uint32_t v = old; v < mesh.vertex_count; ++v)
        if (branches[v - old].count == 1) leaves[end++] = v;
    for (; begin < end; ++begin) {
        if (begin % CROSSING_SPLITS_STRIDE == 0 && !call.tick(0, true)) return false;
        const uint32_t v = leaves[begin], e = branches[v - old].sum;
        if (!close_round(mesh, mesh.origin[2 * e] == v ? 2 * e : 2 * e + 1)) return false;
        ends(e, [&](Branches& b, uint32_t w) {
            b.sum -= e;
            if (--b.count == 1 && w != v) leaves[end++] = w;
        });
    }
    assert(end == count);
    return true;
}

// The product of the words around the origin of a half-edge is 1.
Done CrossingWords::close_round(const Mesh& mesh, uint32_t half_edge) {
    scratch_.clear();
    for (uint32_t g = mesh.rotate_cw(half_edge); g != half_edge; g = mesh.rotate_cw(g))
        if (!append(g, scratch_)) return false;
    return words_.set(twin(half_edge), scratch_);
}

// Cyclically reduced; of all its rotations and those of its inverse the first in the order of the letters.
Done CrossingWords::canonical(Walk& word) const {
    size_t first = 0;
    while (word.size() > first + 1 && word[first] == (word.back() ^ 1u)) {
        ++first;
        word.pop();
    }
    const size_t size = word.size() - first;
    if (size == 0) {
        word.clear();
        return true;
    }
    Array<uint32_t> both; // the word, and its inverse
    if (!both.allocate(*memory_, 2 * size)) return false;
    uint32_t* const there = both.data();
    uint32_t* const back = there + size;
    for (size_t i = 0; i < size; ++i) {
        there[i] = word[first + i];
        back[size - 1 - i] = there[i] ^ 1u;
    }
    const size_t i = least_rotation(there, size), j = least_rotation(back, size);
    size_t k = 0;
    while (k < size && there[(i + k) % size] == back[(j + k) % size]) ++k;
    const bool is_there = k == size || there[(i + k) % size] < back[(j + k) % size];
    word.clear();
    for (k = 0; k < size; ++k)
        if (!word.push(is_there ? there[(i + k) % size] : back[(j + k) % size])) return false;
    return true;
}

} // namespace hmf
