// Watches the class during a solve.
//
// The fast way comes first, and its result is certified (class_certificate.hpp).
// Where the certificate says no, the solve starts again from the initial
// foliation and certifies each level, coarsest first.  A level that loses the
// class is repeated from the state in which it was entered, which is certified;
// then each step of all vertices at once has to pass the certificate before it
// is taken (moves of single vertices cannot leave the class).
#pragma once

#include "../leaves/class_certificate.hpp"
#include "state.hpp"

namespace hmf {

struct SolveOptions;
class Recorder;

struct ClassWatch {
    ClassReference reference;
    CurveWords words;
    ZeroList zeros;       // of the state, as long as they are known
    ClassResult result;   // of the last look
    double seconds = 0;   // for all of them
    uint32_t repeats = 0; // levels that were solved once more
    ClassResult lost;     // the last one that was refused
    double unit = 1;      // of the reference
    bool started = false;

    // At the start of a solve, on the coarsest level.  loops: on the mesh of the
    // state, or NULL; weights: theirs, in units of the state, or empty.
    [[nodiscard]] hmf_status start(State& state, double unit_of_values, const Loops* loops,
                                   const Array<int64_t>& weights, Call& call);
    // Of the state as it is.
    [[nodiscard]] hmf_status look(State& state, double unit_of_values, Call& call);
    bool holds() const { return result.state != ClassState::lost; }
    // From here on the words go along with the mesh of the state.
    void listen(State& state);

private:
    MeshListener listener_{};
};

// run_cascade, with the certificate and the guard.  HMF_LIMIT_CLASS: the result is
// in its class, but the minimum could not be reached within it.
[[nodiscard]] hmf_status solve_in_class(State& state, const SolveOptions& options, Call& call, Recorder& recorder,
                                        ClassWatch& watch);

} // namespace hmf
