// Numbers by level, so that the arrays of a coarse level are prefixes of those
// of a finer one:
//
//     | coarsest | removed between n-1 and n | ... | removed between 0 and 1 |
//     |<-- level n -->|
//     |<---------- level n-1 -------------->| ...
#include "renumber.hpp"

namespace hmf {

namespace {

// Survivors from 0, removed ones from kept; both keep their order.  Branch-free, by
// masks: a branch would be mispredicted half the time.
uint32_t choose(uint32_t mask, uint32_t ones, uint32_t zeros) { return (ones & mask) | (zeros & ~mask); }

template <class Removed>
void number_elements(uint32_t count, uint32_t kept, uint32_t* number, Removed removed, const Parallel& parallel) {
    const auto number_block = [=](size_t begin, size_t end, uint32_t survivors) {
        for (uint32_t x = static_cast<uint32_t>(begin); x < end; ++x) {
            const uint32_t gone = removed(x);
            number[x] = choose(0 - gone, kept + x - survivors, survivors);
            survivors += 1 - gone;
        }
    };
    if (parallel.slots() == 1) return number_block(0, count, 0);
    // Survivors of each block, then of all blocks before it.
    const size_t size = Parallel::pass_block(count);
    uint32_t before[Parallel::MOST_PARTS], sum = 0;
    parallel.for_blocks(count, size, [&](size_t begin, size_t end) {
        uint32_t here = 0;
        for (size_t x = begin; x < end; ++x) here += 1 - removed(static_cast<uint32_t>(x));
        before[begin / size] = here;
    });
    for (size_t k = 0; k * size < count; ++k) {
        const uint32_t here = before[k]; // NOLINT(clang-analyzer-core*): each block set its number
        before[k] = sum;
        sum += here;
    }
    parallel.for_blocks(count, size, [&](size_t begin, size_t end) { number_block(begin, end, before[begin / size]); });
}

void compose_elements(uint32_t count, uint32_t kept, uint32_t* number, const uint32_t* coarser,
                      const Parallel& parallel) {
    parallel.for_blocks(count, [&](size_t begin, size_t end) {
        for (size_t x = begin; x < end; ++x) {
            const uint32_t here = number[x], stays = 0 - static_cast<uint32_t>(here < kept);
            number[x] = choose(stays, coarser[here & stays], here);
        }
    });
}

uint32_t renumbered_side(const uint32_t* edge, uint32_t h) { return 2 * edge[edge_of(h)] + (h & 1u); }

} // namespace

void number_level(const WorkMesh& work, const Collapse* records, size_t record_count, const Numbering& out,
                  const Parallel& parallel) {
    const Mesh& mesh = work.mesh;
    number_elements(
        work.vertex_end, mesh.vertex_count, out.vertex, [&](uint32_t v) { return mesh.out[v] == NONE; }, parallel);
    number_elements(
        work.edge_end, mesh.edge_count, out.edge, [&](uint32_t e) { return work.removed(e); }, parallel);
    parallel.for_blocks(work.face_end, [&](size_t begin, size_t end) {
        for (size_t f = begin; f < end; ++f) out.face[f] = 0;
    });
    parallel.for_blocks(record_count, [&](size_t begin, size_t end) { // each face is in one record
        for (size_t n = begin; n < end; ++n) out.face[records[n].face_left] = out.face[records[n].face_right] = NONE;
    });
    number_elements(
        work.face_end, mesh.face_count, out.face, [&](uint32_t f) { return out.face[f] == NONE; }, parallel);
}

namespace {

// In place, as no number rises.  Each block closes its own gaps first.  Then its remaining elements move down, together
// with those of later blocks whose places are free: places of blocks that have moved.
//
//     | aa  | b   | cc  | d   |
//     | aab | cc..            |     b: the place of `cc` is free now
class Compaction {
public:
    // count: of elements, of which `kept` stay, by their numbers.
    template <class Removed>
    Compaction(uint32_t count, uint32_t kept, const uint32_t* number, Removed removed, const Parallel& parallel) :
        count_(count), size_(Parallel::pass_block(count)), parallel_(parallel) {
        for (; blocks_ * size_ < count; ++blocks_) {
            const uint32_t x = static_cast<uint32_t>(blocks_ * size_);
            before_[blocks_] = removed(x) ? kept + x - number[x] : number[x];
        }
        before_[blocks_] = kept;
    }
    // close(x, to): writes element x to the place `to` of the same block.  Branch-free (mispredicted half the
    // time): each element is written to the next free place, and the next one overwrites a removed one.
    template <class Close>
    void close_gaps(Close close) const {
        parallel_.for_blocks(count_, size_, [&](size_t begin, size_t end) {
            for (size_t x = begin, to = begin; x < end; ++x)
                to += close(static_cast<uint32_t>(x), static_cast<uint32_t>(to));
        });
    }
    template <class T>
    void move(T* array, size_t width) const {
        for (size_t first = 0, last = 0; first < blocks_; first = last) {
            last = first + 1;
            while (last < blocks_ && before_[last + 1] <= first * size_) ++last;
            parallel_.for_each(static_cast<uint32_t>(last - first), [&](uint32_t n, uint32_t) {
                const size_t k = first + n;
                std::memmove(array + width * before_[k], array + width * k * size_,
                             width * (before_[k + 1] - before_[k]) * sizeof(T));
            });
        }
    }

private:
    const size_t count_, size_;
    size_t blocks_ = 0;
    uint32_t before_[Parallel::MOST_PARTS + 1]; // elements that stay
    const Parallel& parallel_;
};

} // namespace

void compact(WorkMesh& work, const Numbering& numbers, const Parallel& parallel) {
    Mesh& mesh = work.mesh;
    const Compaction edges(
        work.edge_end, mesh.edge_count, numbers.edge, [&](uint32_t e) { return work.removed(e); }, parallel);
    edges.close_gaps([&](uint32_t e, uint32_t to) {
        const uint32_t stays = !work.removed(e);
        for (uint32_t side = 0; side < 2; ++side) {
            const uint32_t h = 2 * e + side, face = mesh.face[h] & (0 - stays); // no face at all: any
            mesh.origin[2 * to + side] = numbers.vertex[mesh.origin[h]];
            mesh.next[2 * to + side] = renumbered_side(numbers.edge, mesh.next[h]);
            mesh.face[2 * to + side] = numbers.face[face];
        }
        return stays;
    });
    for (uint32_t* const array : {mesh.origin, mesh.next, mesh.face}) edges.move(array, 2);
    const Compaction vertices(
        work.vertex_end, mesh.vertex_count, numbers.vertex, [&](uint32_t v) { return mesh.out[v] == NONE; }, parallel);
    vertices.close_gaps([&](uint32_t v, uint32_t to) {
        const uint32_t stays = mesh.out[v] != NONE;
        mesh.out[to] = renumbered_side(numbers.edge, mesh.out[v] & (0 - stays));
        work.degree[to] = work.degree[v];
        for (int c = 0; c < 3; ++c) work.at(to)[c] = work.at(v)[c];
        if (!work.quadrics.empty()) work.quadrics[to] = work.quadrics[v];
        return stays;
    });
    vertices.move(mesh.out, 1);
    vertices.move(work.degree.data(), 1);
    vertices.move(work.position, 3);
    if (!work.quadrics.empty()) vertices.move(work.quadrics.data(), 1);
    work.vertex_end = mesh.vertex_count;
    work.edge_end = mesh.edge_count;
    work.face_end = mesh.face_count;
}

void compose(const Level& level, const Numbering& numbers, const Level& coarser_level, const Numbering& coarser,
             const Parallel& parallel) {
    compose_elements(level.mesh.vertex_count, coarser_level.mesh.vertex_count, numbers.vertex, coarser.vertex,
                     parallel);
    compose_elements(level.mesh.edge_count, coarser_level.mesh.edge_count, numbers.edge, coarser.edge, parallel);
    compose_elements(level.mesh.face_count, coarser_level.mesh.face_count, numbers.face, coarser.face, parallel);
}

void renumber_collapses(Collapse* collapses, size_t count, const Numbering& numbers, const Parallel& parallel) {
    parallel.for_blocks(count, [&](size_t begin, size_t end) {
        for (size_t n = begin; n < end; ++n) {
            Collapse& c = collapses[n];
            uint32_t* const half_edges[5] = {&c.h, &c.jk, &c.lj, &c.ki, &c.il};
            for (uint32_t* h : half_edges) *h = renumbered_side(numbers.edge, *h);
            c.vertex = numbers.vertex[c.vertex];
            c.face_left = numbers.face[c.face_left];
            c.face_right = numbers.face[c.face_right];
        }
    });
}

} // namespace hmf
