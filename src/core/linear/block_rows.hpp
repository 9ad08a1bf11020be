// Sparse matrices that are written row by row, on several threads.
//
// Blocks of rows are written in parallel, each into an area of its own, and then joined. An area has space for an
// expected number of entries per row; if that does not suffice, all blocks are written again with more space:
//
//     | block 0  used      | block 1  used   | block 2 ...
//     | block 0 | block 1 | block 2 ...
#pragma once

#include "../base/memory.hpp"

namespace hmf {

template <class Entry>
struct SparseRows {
    Array<uint32_t> offset, column; // rows + 1; offset[rows]
    Array<Entry> entry;
};

// Blocks that are worked on between two reports; also the slots that need room.
constexpr uint32_t BLOCKS_AT_ONCE = 16;

// A sum of sparse rows, its columns in the order in which they came.
template <class Entry>
struct RowSum {
    uint32_t* place; // per column, begin + where it is; less in earlier sums
    uint32_t* column;
    Entry* entry;
    uint32_t begin, count;

    // Branch-free: whether a column was met before is mispredicted half the time.
    void add(uint32_t c, Entry value) {
        const uint32_t p = place[c] - begin;
        const bool is_new = p >= count;
        const uint32_t slot = is_new ? count : p;
        place[c] = begin + slot;
        column[slot] = c;
        entry[slot] += value;
        count += is_new;
        entry[count] = 0;
    }
};

// One sum after the other.
class RowSums {
public:
    Done allocate(uint32_t columns, Memory& memory) { return place_.allocate_filled(memory, columns, NOWHERE); }
    // column, entry: where it is written; room for all columns that will come, and one more.
    template <class Entry>
    RowSum<Entry> begin(uint32_t* column, Entry* entry) {
        if (begin_ > NOWHERE / 2) {
            for (uint32_t& p : place_) p = NOWHERE;
            begin_ = 0;
        }
        entry[0] = 0;
        return {place_.data(), column, entry, begin_, 0};
    }
    template <class Entry>
    void end(const RowSum<Entry>& sum) {
        begin_ += sum.count;
    }

private:
    static constexpr uint32_t NOWHERE = 0xffffffffu;
    Array<uint32_t> place_;
    uint32_t begin_ = 0;
};

template <class Entry>
class BlockRows {
public:
    // In blocks of at least the given number of rows; the rows are the same for any block size. write_block(b, slot):
    // writes the rows of block b into the slot; false if it does not have enough space.
    template <class Write>
    Done write(uint32_t rows, uint32_t rows_of_block, size_t expected, Call& call, Write write_block) {
        rows_ = rows;
        size_ = rows / MOST_BLOCKS < rows_of_block ? rows_of_block : rows / MOST_BLOCKS + 1;
        bool fits = false;
        for (size_t room = expected; !fits; room *= 4) {
            if (!begin(room, call.memory)) return false;
            fits = true;
            for (uint32_t first = 0; first < block_count() && fits; first += BLOCKS_AT_ONCE) {
                if (!call.tick(0, true) || call.finishing()) return false;
                const uint32_t left = block_count() - first, count = left < BLOCKS_AT_ONCE ? left : BLOCKS_AT_ONCE;
                bool done[BLOCKS_AT_ONCE] = {};
                call.parallel.for_each(count,
                                       [&](uint32_t k, uint32_t slot) { done[k] = write_block(first + k, slot); });
                for (uint32_t k = 0; k < count; ++k) fits &= done[k];
            }
        }
        return true;
    }
    uint32_t first_row(uint32_t b) const { return b < block_count() ? b * size_ : rows_; }
    bool has_room(uint32_t b, size_t more) const { return block_[b].room - block_[b].used > more; }
    uint32_t* column(uint32_t b) { return column_.data() + block_[b].begin + block_[b].used; }
    Entry* entry(uint32_t b) { return entry_.data() + block_[b].begin + block_[b].used; }
    void begin_row(uint32_t b, uint32_t row) { offset_[row] = block_[b].used; }
    void end_row(uint32_t b, uint32_t count) { block_[b].used += count; }

    // The rows in order; what was here is gone.  copy: into arrays of just the size.
    Done join(SparseRows<Entry>& out, bool copy, Memory& memory) {
        size_t total = 0;
        for (const Block& b : block_) total += b.used;
        if (total > 0xf0000000u) {
            memory.take(SIZE_MAX);
            return false;
        }
        if (!copy) {
            out.column = static_cast<Array<uint32_t>&&>(column_);
            out.entry = static_cast<Array<Entry>&&>(entry_);
        } else if (!out.column.allocate(memory, total) || !out.entry.allocate(memory, total)) return false;
        const uint32_t* const column = copy ? column_.data() : out.column.data();
        const Entry* const entry = copy ? entry_.data() : out.entry.data();
        uint32_t at = 0;
        for (uint32_t b = 0; b < block_count(); ++b) {
            const Block& block = block_[b];
            for (uint32_t row = first_row(b); row < first_row(b + 1); ++row) offset_[row] += at;
            if (block.used == 0) continue;
            std::memmove(out.column.data() + at, column + block.begin, block.used * sizeof(uint32_t));
            std::memmove(out.entry.data() + at, entry + block.begin, block.used * sizeof(Entry));
            at += block.used;
        }
        offset_[rows_] = at;
        out.offset = static_cast<Array<uint32_t>&&>(offset_);
        column_.release();
        entry_.release();
        return true;
    }

private:
    static constexpr uint32_t MOST_BLOCKS = 1024;
    struct Block {
        size_t begin = 0, room = 0; // in column_ and entry_
        uint32_t used = 0;
    };
    uint32_t block_count() const { return static_cast<uint32_t>(block_.size()); }
    Done begin(size_t room, Memory& memory) {
        if (!offset_.allocate(memory, rows_ + size_t{1}) || !block_.allocate(memory, (rows_ + size_ - 1) / size_))
            return false;
        size_t at = 0;
        for (uint32_t b = 0; b < block_count(); ++b) {
            block_[b] = Block{at, room * (first_row(b + 1) - first_row(b)) + 1, 0};
            at += block_[b].room;
        }
        return column_.allocate(memory, at) && entry_.allocate(memory, at);
    }

    uint32_t rows_ = 0, size_ = 1;
    Array<uint32_t> offset_; // of a row, from the begin of its block
    Array<uint32_t> column_;
    Array<Entry> entry_;
    Array<Block> block_;
};

} // namespace hmf
