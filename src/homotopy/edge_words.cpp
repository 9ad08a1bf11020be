// Cutting the mesh into a polygon, and products of walks; see edge_words.hpp.
#include "edge_words.hpp"

#include <algorithm>

namespace hmf {

namespace {

enum : uint8_t { SIDE, IN_TREE, ACROSS }; // an edge: side of the polygon, contracted, or inside the polygon

// A tree through all vertices, and one through all triangles that crosses none of its edges.
Done find_trees(const Mesh& mesh, Array<uint8_t>& kind, Memory& memory) {
    Array<uint32_t> queue;
    Array<uint8_t> seen;
    queue.start(memory);
    if (!kind.allocate_filled(memory, mesh.edge_count, uint8_t{SIDE})
        || !seen.allocate_filled(memory, std::max(mesh.face_count, mesh.vertex_count), uint8_t{0})
        || !queue.reserve(seen.size()))
        return false;
    seen[0] = 1;
    queue.add(0);
    for (size_t i = 0; i < queue.size(); ++i) {
        for (const uint32_t h : mesh.around(queue[i])) {
            const uint32_t v = mesh.target(h);
            if (!seen[v]) {
                seen[v] = 1;
                queue.add(v);
                kind[edge_of(h)] = IN_TREE;
            }
        }
    }
    for (uint8_t& s : seen) s = 0;
    queue.clear();
    seen[mesh.face[0]] = 1;
    queue.add(0); // a half-edge of each triangle
    for (size_t i = 0; i < queue.size(); ++i) {
        uint32_t h = queue[i];
        for (uint32_t side = 0; side < 3; ++side, h = mesh.next[h]) {
            if (kind[edge_of(h)] != SIDE || seen[mesh.face[twin(h)]]) continue;
            seen[mesh.face[twin(h)]] = 1;
            kind[edge_of(h)] = ACROSS;
            queue.add(twin(h));
        }
    }
    return true;
}

uint64_t hash_of(const uint32_t* items, size_t n) {
    uint64_t x = n;
    for (size_t i = 0; i < n; ++i) {
        x = (x ^ items[i]) * 0x9e3779b97f4a7c15u;
        x ^= x >> 29;
    }
    return x;
}

} // namespace

Done EdgeWords::start(const Mesh& mesh, uint32_t edge_capacity, Memory& memory) {
    Array<uint8_t> kind;
    Array<uint32_t> corner, twin_side;
    memory_ = &memory;
    scratch_.start(memory);
    spoke_.start(memory);
    offset_.start(memory);
    twin_side.start(memory);
    if (!find_trees(mesh, kind, memory) || !corner.allocate_filled(memory, size_t{2} * mesh.edge_count, NONE)
        || !bits_.allocate_filled(memory, edge_capacity / 64 + size_t{1}, uint64_t{0})
        || !word_.allocate(memory, edge_capacity) || !offset_.push(0) || !table_.allocate_filled(memory, 1024, NONE))
        return false;
    // Once round the polygon, which lies on the left: the corner at which each half-edge starts.
    uint32_t first = 0;
    while (first < 2 * mesh.edge_count && kind[edge_of(first)] != SIDE) ++first;
    if (first == 2 * mesh.edge_count) return false; // a sphere
    uint32_t h = first;
    do {
        if (kind[edge_of(h)] == SIDE) {
            corner[h] = static_cast<uint32_t>(twin_side.size());
            if (!twin_side.push(h)) return false;
        }
        h = mesh.next[h];
        for (; kind[edge_of(h)] == ACROSS; h = mesh.next[twin(h)]) corner[h] = static_cast<uint32_t>(twin_side.size());
    } while (h != first);
    const uint32_t n = static_cast<uint32_t>(twin_side.size());
    for (uint32_t& side : twin_side) side = corner[twin(side)];
    if (!quads_.start(twin_side, memory)) return false;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (kind[e] == IN_TREE) continue;
        const uint32_t from = corner[2 * e] % n;
        const uint32_t to = kind[e] == SIDE ? (corner[2 * e] + 1) % n : corner[2 * e + 1] % n;
        if (from == to) continue;
        scratch_.clear();
        uint32_t word = 0;
        if (!scratch_.push(from) || !scratch_.push(to) || !number_of(scratch_, word)) return false;
        set(2 * e, word, false);
    }
    return true;
}

void EdgeWords::set(uint32_t half_edge, uint32_t word, bool reversed) {
    const uint32_t e = edge_of(half_edge);
    bits_[e / 64] |= uint64_t{1} << e % 64;
    word_[e] = 2 * word + ((half_edge & 1) != static_cast<uint32_t>(reversed));
}

Done EdgeWords::append(uint32_t half_edge, Walk& walk) const {
    const uint32_t e = edge_of(half_edge);
    if (!has(e)) return true;
    const uint64_t begin = offset_[word_[e] >> 1], end = offset_[(word_[e] >> 1) + 1];
    if (((word_[e] ^ half_edge) & 1) == 0) {
        for (uint64_t i = begin; i < end; ++i)
            if (!quads_.append(walk, spoke_[i])) return false;
    } else {
        for (uint64_t i = end; i-- > begin;)
            if (!quads_.append(walk, spoke_[i])) return false;
    }
    return true;
}

// Half-edge 2e is the way back along the two others of its triangle.
Done EdgeWords::join(uint32_t edge, uint32_t ahead, uint32_t back) {
    scratch_.clear();
    uint32_t word = 0;
    if (!append(twin(back), scratch_) || !append(twin(ahead), scratch_)) return false;
    if (scratch_.empty()) {
        clear(edge);
        return true;
    }
    if (!number_of(scratch_, word)) return false;
    set(2 * edge, word, false);
    return true;
}

Done EdgeWords::number_of(const Walk& walk, uint32_t& word) {
    const size_t count = offset_.size() - 1;
    if (2 * (count + 1) > table_.size()) {
        Array<uint32_t> old;
        old.swap(table_);
        Memory& memory = *memory_;
        if (!table_.allocate_filled(memory, 4 * old.size(), NONE)) return false;
        for (uint32_t w = 0; w < count; ++w) {
            size_t i = hash_of(&spoke_[offset_[w]], offset_[w + 1] - offset_[w]) & (table_.size() - 1);
            while (table_[i] != NONE) i = (i + 1) & (table_.size() - 1);
            table_[i] = w;
        }
    }
    const size_t n = walk.size();
    size_t i = hash_of(walk.data(), n) & (table_.size() - 1);
    for (; table_[i] != NONE; i = (i + 1) & (table_.size() - 1)) {
        const uint64_t begin = offset_[table_[i]];
        if (offset_[table_[i] + 1] - begin == n
            && std::memcmp(&spoke_[begin], walk.data(), n * sizeof(uint32_t)) == 0) {
            word = table_[i];
            return true;
        }
    }
    word = static_cast<uint32_t>(count);
    for (const uint32_t s : walk)
        if (!spoke_.push(s)) return false;
    if (!offset_.push(spoke_.size())) return false;
    table_[i] = word;
    return true;
}

} // namespace hmf
