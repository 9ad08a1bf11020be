// Closed curves on one mesh or on several that words were carried to, each with
// the name of its class (curve_words.hpp).
#pragma once

#include "curve_words.hpp"

namespace hmf {

class CurveNames {
public:
    void start(Memory& memory) {
        memory_ = &memory;
        offset_.start(memory);
        letter_.start(memory);
    }
    size_t count() const { return offset_.empty() ? 0 : offset_.size() - 1; }
    // Are curve i and curve j of the others freely homotopic, in one of the two directions?
    bool same(size_t i, const CurveNames& others, size_t j) const {
        const uint64_t n = offset_[i + 1] - offset_[i];
        if (n != others.offset_[j + 1] - others.offset_[j]) return false;
        return n == 0
            || std::memcmp(&letter_[offset_[i]], &others.letter_[others.offset_[j]], n * sizeof(uint32_t)) == 0;
    }
    // The first of the others in the class of curve i, NONE if there is none.
    uint32_t find(size_t i, const CurveNames& others) const {
        for (uint32_t j = 0; j < others.count(); ++j)
            if (same(i, others, j)) return j;
        return NONE;
    }

    // One more curve: it crosses half_edge(i) for i in [begin, end), closed behind the last.
    template <class HalfEdge>
    Done add(const Mesh& mesh, const CurveWords& words, uint64_t begin, uint64_t end, HalfEdge half_edge) {
        name_.start(*memory_);
        if (!words.name(mesh, begin, end, half_edge, name_)) return false;
        if (offset_.empty() && !offset_.push(0)) return false;
        for (const uint32_t letter : name_)
            if (!letter_.push(letter)) return false;
        return offset_.push(letter_.size());
    }

private:
    Memory* memory_ = nullptr;
    Array<uint64_t> offset_;
    Array<uint32_t> letter_;
    Walk name_;
};

} // namespace hmf
