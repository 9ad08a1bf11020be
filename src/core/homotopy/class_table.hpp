// Closed curves on one mesh or on several that words were carried to, each with
// its free homotopy class (curve_words.hpp).
#pragma once

#include "curve_words.hpp"

namespace hmf {

class ClassTable {
public:
    void start(Memory& memory) {
        words_.start(memory);
        class_.start(memory);
        first_.start(memory);
        word_.start(memory);
    }
    size_t count() const { return class_.size(); } // curves
    // Are curve i and curve j of the others freely homotopic, in one of the two directions?
    bool same(size_t i, const ClassTable& others, size_t j) const { return class_in(others, i) == others.class_[j]; }
    // The first of the others in the class of curve i, NONE if there is none.
    uint32_t find(size_t i, const ClassTable& others) const {
        const uint32_t there = class_in(others, i);
        return there == NONE ? NONE : others.first_[there];
    }

    // One more curve: it crosses half_edge(i) for i in [begin, end), closed behind the last.
    template <class HalfEdge>
    Done add(const Mesh& mesh, const CurveWords& words, uint64_t begin, uint64_t end, HalfEdge half_edge) {
        uint32_t number = 0;
        word_.clear();
        if (!words.name(mesh, begin, end, half_edge, word_) || !words_.add(word_, number)) return false;
        if (number == first_.size() && !first_.push(static_cast<uint32_t>(count()))) return false;
        return class_.push(number);
    }

private:
    uint32_t class_in(const ClassTable& others, size_t i) const {
        return others.words_.find(words_.word(class_[i]), words_.length(class_[i]));
    }

    WordTable words_;       // one for each class
    Array<uint32_t> class_; // per curve
    Array<uint32_t> first_; // per class: its first curve
    Walk word_;
};

} // namespace hmf
