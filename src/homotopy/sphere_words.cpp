#include "sphere_words.hpp"

#include "../base/cyclic.hpp"

namespace hmf {

namespace {

// Letters: 2 * gap, + 1 for its inverse.
Done append(uint32_t letter, Array<uint32_t>& word) {
    if (letter < 2) return true; // gap 0
    if (!word.empty() && word.back() == (letter ^ 1u)) {
        word.pop();
        return true;
    }
    return word.push(letter);
}

} // namespace

Done SphereWords::start(const Mesh& mesh, Memory& memory) {
    Array<uint8_t> in_tree; // per edge
    Array<uint8_t> reached; // per vertex
    Array<uint32_t> queue;
    if (!gap_.allocate_filled(memory, 2 * size_t{mesh.edge_count}, 0u)
        || !in_tree.allocate_filled(memory, mesh.edge_count, uint8_t{0})
        || !reached.allocate_filled(memory, mesh.vertex_count, uint8_t{0})
        || !queue.allocate(memory, mesh.vertex_count))
        return false;
    size_t begin = 0, end = 0;
    queue[end++] = 0;
    reached[0] = 1;
    while (begin < end)
        for (const uint32_t h : mesh.around(queue[begin++])) {
            const uint32_t v = mesh.target(h);
            if (reached[v]) continue;
            reached[v] = in_tree[edge_of(h)] = 1;
            queue[end++] = v;
        }
    if (end < 2) return true;
    const auto next_in_tree = [&](uint32_t h) { // clockwise from h round its origin, h itself last
        do h = mesh.next[twin(h)];
        while (!in_tree[edge_of(h)]);
        return h;
    };
    uint32_t gap = 0, h = next_in_tree(mesh.out[0]);
    for (size_t side = 0; side < 2 * (end - 1); ++side) {
        gap_[h] = gap;
        gap += mesh.is_marked(mesh.target(h));
        h = next_in_tree(twin(h));
    }
    return true;
}

Done SphereWords::canonical(const uint32_t* crossings, size_t n, Array<uint32_t>& word) const {
    word.clear();
    for (size_t i = 0; i < n; ++i) {
        const uint32_t from = gap_[crossings[i]], to = gap_[twin(crossings[i])];
        if (from != to && (!append(2 * from + 1, word) || !append(2 * to, word))) return false;
    }
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
    if (!both.allocate(word.memory(), 2 * size)) return false;
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
