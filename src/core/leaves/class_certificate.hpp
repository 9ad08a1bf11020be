// The certificate of the class: tests whether a foliation belongs to the weighted loops that it started from.
//
// A foliation whose leaves are all closed is determined by its cylinders: their heights, and the closed curves around
// them.  (Whitehead moves change
// neither, and a class has one harmonic foliation.)  Both are read off in integers and do not rely on any step of the
// solve:
//
//   heights   the critical leaves are followed out of the zeros until they
//             close; they bound the cylinders, and the way straight across each,
//             from critical leaf to critical leaf, is its height.  The heights are
//             the weights of the loops, each exactly once, without any tolerance
//   classes   a leaf that bounds a cylinder has a word, from those of the half-edges that it
//             crosses or of the edges on its left, carried from the coarsest level
//             exactly (curve_words.hpp).  Made canonical it is the same for all curves that
//             are freely homotopic, on the surface without its marked vertices, and for no
//             other.  It is the word of the loop of that height
//
// The cost is that of the critical leaves: some thousand of a million edges.
#pragma once

#include "../homotopy/class_table.hpp"
#include "../curves/loops.hpp"
#include "cylinders.hpp"

namespace hmf {

enum class ClassState : uint8_t { // as HMF_CLASS_*
    unknown,                      // not looked at, or there is nothing to compare with
    proven,                       // heights and classes of all cylinders are those of the loops
    lost,                         // they are not
};

enum class ClassLoss : uint8_t {
    none,
    leaves, // the leaves do not close, or bound no cylinders
    height, // a loop has a cylinder of another height, or none
    core,   // the heights are right, but a cylinder goes around another curve
};

struct ClassCheck {
    ClassState state = ClassState::unknown;
    ClassLoss loss = ClassLoss::none;
    uint32_t loop = NONE;   // that is lost
    double wanted = 0;      // height of its cylinder, in the unit of the reference
    double found = 0;       // and what it is; 0: there is no cylinder around this loop
    uint64_t crossings = 0; // of all the boundary leaves
};

// Names a boundary leaf.
Done add_boundary(const Mesh& mesh, const CurveWords& words, const CriticalGraph& graph, uint32_t boundary,
                  ClassTable& names);

class ClassCertificate {
public:
    // From a foliation that is known to belong to the loops, as the initial one
    // is, with the words of its mesh.  HMF_OK and known() false:
    // its leaves do not bound cylinders, as of values that come from no loops.
    [[nodiscard]] hmf_status take(Foliation& f, const CurveWords& words, Call& call);
    bool known() const { return !height_.empty(); }
    int64_t largest_height() const; // 0 if it is not known

    // Numbers of the loops in messages: those of `loops` on the same mesh, by
    // their classes; or by their weights, in the unit of the foliation.
    [[nodiscard]] hmf_status number_by_class(const Mesh& mesh, const CurveWords& words, const Loops& loops, Call& call);
    void number_by_weight(const Array<int64_t>& weights);
    // After one of them: one cylinder for each loop, as high as its weight.
    bool agrees(const Array<int64_t>& weights) const;

    // A foliation on a mesh with its words, in a unit that is
    // `finer` times as fine.
    [[nodiscard]] hmf_status compare(Foliation& f, const CurveWords& words, const ZeroList& zeros, int64_t finer,
                                     Call& call, ClassCheck& result) const;

private:
    [[nodiscard]] hmf_status find_cylinders(Foliation& f, const ZeroList& zeros, Cylinders& cylinders, bool& complete,
                                            Call& call) const;

    Array<int64_t> height_;
    Array<uint32_t> loop_;
    ClassTable names_;
};

} // namespace hmf
