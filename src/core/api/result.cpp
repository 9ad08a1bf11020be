#include "result.hpp"

namespace hmf {

namespace {

struct BlockHeader {
    hmf_allocate_fn allocate; // both NULL: the default
    hmf_release_fn release;
    void* user;
    size_t bytes; // of the whole block
};

constexpr size_t block_bytes(size_t bytes) { return (bytes + 15) / 16 * 16; }

} // namespace

void ResultBlock::add(ptrdiff_t field, size_t count, size_t size, const void* source) {
    assert(part_count_ < MOST_ARRAYS);
    if (count > SIZE_MAX / 16 / size) too_large_ = true, count = 0;
    parts_[part_count_++] = {field, count * size, source};
}

void* ResultBlock::make_bytes(const void* structure, size_t size, const hmf_hierarchy& h, Call& call) {
    size_t bytes = block_bytes(sizeof(BlockHeader)) + block_bytes(size);
    for (int i = 0; i < part_count_; ++i) bytes += block_bytes(parts_[i].bytes);
    // No result is returned after a failed allocation, wherever it happened.
    void* block = call.memory.failure() ? nullptr : call.memory.take(too_large_ ? SIZE_MAX : bytes);
    if (!block) {
        call.out_of_memory();
        return nullptr;
    }
    const BlockHeader header{h.allocate, h.release, h.allocator_user, bytes};
    std::memcpy(block, &header, sizeof header);
    char* const made = static_cast<char*>(block) + block_bytes(sizeof(BlockHeader));
    std::memcpy(made, structure, size);
    char* at = made + block_bytes(size);
    for (int i = 0; i < part_count_; ++i) {
        const Part& part = parts_[i];
        if (part.source) call.parallel.copy(at, static_cast<const char*>(part.source), part.bytes);
        void* const pointer = at;
        std::memcpy(made + part.field, &pointer, sizeof pointer);
        at += block_bytes(part.bytes);
    }
    return made;
}

void free_block(const void* structure) {
    if (!structure) return;
    char* const block = const_cast<char*>(static_cast<const char*>(structure)) - block_bytes(sizeof(BlockHeader));
    BlockHeader header;
    std::memcpy(&header, block, sizeof header);
    Memory memory(header.allocate, header.release, header.user, 0, header.bytes);
    memory.give(block, header.bytes);
}

} // namespace hmf

extern "C" void hmf_free(const void* result) { hmf::free_block(result); }
