// Numbers for a few keys of many: open addressing, a power of two of slots.
#pragma once

#include "memory.hpp"

namespace hmf {

class SparseMap {
public:
    static constexpr uint32_t ABSENT = 0xffffffffu; // as key and as value

    // Empty, with room for a few keys.  False: out of memory.
    Done start(Memory& memory) {
        memory_ = &memory;
        count_ = 0;
        return slots_.allocate_filled(memory, 64, Slot{ABSENT, ABSENT});
    }

    uint32_t find(uint32_t key) const {
        const size_t mask = slots_.size() - 1;
        for (size_t i = place(key) & mask;; i = (i + 1) & mask) {
            if (slots_[i].key == key) return slots_[i].value;
            if (slots_[i].key == ABSENT) return ABSENT;
        }
    }

    // False: out of memory.
    Done set(uint32_t key, uint32_t value) {
        if (2 * (count_ + 1) > slots_.size() && !grow()) return false;
        put(key, value);
        return true;
    }

private:
    struct Slot {
        uint32_t key, value;
    };

    static size_t place(uint32_t key) {
        uint64_t x = uint64_t{key} * 0x9e3779b97f4a7c15u;
        return static_cast<size_t>(x >> 32);
    }

    void put(uint32_t key, uint32_t value) {
        const size_t mask = slots_.size() - 1;
        for (size_t i = place(key) & mask;; i = (i + 1) & mask) {
            if (slots_[i].key == ABSENT) {
                slots_[i].key = key;
                ++count_;
            } else if (slots_[i].key != key) continue;
            slots_[i].value = value;
            return;
        }
    }

    Done grow() {
        Array<Slot> old;
        old.swap(slots_);
        if (!slots_.allocate_filled(*memory_, 4 * old.size(), Slot{ABSENT, ABSENT})) return false;
        count_ = 0;
        for (const Slot& s : old)
            if (s.key != ABSENT) put(s.key, s.value);
        return true;
    }

    Array<Slot> slots_;
    size_t count_ = 0;
    Memory* memory_ = nullptr;
};

} // namespace hmf
