// The search of the even design: which vertices to mark, and the weights.
#pragma once

#include "../../../include/hmf/applications.h"
#include "edge_distances.hpp"
#include "marked_trial.hpp"

namespace hmf {

// Where the scale decays: the end of a limb, or of what sticks out.
struct Tip {
    uint32_t vertex;
    double depth;     // of the log scale there below its mean, when it was found
    uint32_t poles;   // 0, 1 or 2
    bool stays;       // marked by the caller
    uint32_t ends[2]; // where two of them lie; NONE if there is no room
};

struct EvenChoice {
    Array<Tip> tips;
    Array<uint32_t> marks; // vertices of the surface
    Array<double> weights; // of the pants loops with these marks
    Array<double> scale;   // log |grad u| at the vertices
    int32_t kind = HMF_LOOPS_PANTS;
    Loops loops; // on the coarsest level of a trial with these marks; empty: not found yet
    double unevenness = HUGE_VAL;
};

class EvenSearch {
public:
    // mesh and position: of the surface, in its numbers.
    EvenSearch(const hmf_hierarchy& like, const Mesh& mesh, const double* position, const TrialMesh& surface,
               Call& call) :
        like_(like),
        mesh_(mesh), surface_(surface), call_(call), memory_(call.memory), distances_(mesh, position, call.memory) {}

    // Starts from marked vertices that stay and from tips of limbs with two poles
    // each, then adds and removes poles as long as that makes the scale more even.
    hmf_status run(const Array<uint32_t>& given, const Array<uint32_t>& tips, const Array<uint32_t>& ends,
                   EvenChoice& best);

    double budget = 0;      // work
    bool may_repeat = true; // with as large a budget, where that may be better
    bool poles = true;      // else the weights alone, where that can be
    double fraction = 0;    // of the work done

    // Weights for the marks of a choice, from those of the loops that its surface suggests.  Gives up where
    // it falls behind a rival.
    hmf_status evaluate(EvenChoice& choice, uint32_t rounds, double rival = HUGE_VAL);

    // whole_weights.hpp
    hmf_status round_weights(EvenChoice& best);

    double unevenness_before = 0; // of the default loops with weights 1
    uint64_t solves = 0;          // a derivative counts as one
    double work = 0;              // in solves without loops
    static double work_of(size_t loops) { return 1 + static_cast<double>(loops) / 8; } // of a solve

private:
    Done smooth_scale(const Array<double>& scale, Array<double>& smooth, double& mean);
    Done find_taken(const Array<Tip>& tips, Array<uint8_t>& taken);
    template <class Visit>
    Done for_persistent_minima(const Array<double>& height, Visit visit);
    Done find_tips(const EvenChoice& choice, double least, Array<Tip>& found);
    Done list_marks(EvenChoice& choice);
    Done copy(const EvenChoice& from, EvenChoice& to);
    double gain(const EvenChoice& before, const EvenChoice& after) const;
    void count(const MarkedTrial& trial);
    Done mark_four(EvenChoice& choice);
    Done add_tips(const Array<Tip>& found, size_t with_poles, size_t room, EvenChoice& choice);
    hmf_status improve(double persistence, EvenChoice& best);
    hmf_status measure_before(EvenChoice& plain);
    hmf_status first_choice(const Array<uint32_t>& given, const Array<uint32_t>& tips, const Array<uint32_t>* ends,
                            EvenChoice& choice);

    const hmf_hierarchy& like_;
    const Mesh& mesh_;
    const TrialMesh& surface_;
    Call& call_;
    Memory& memory_;
    EdgeDistances distances_;
};

} // namespace hmf
