// Keeps a solve in its class.
//
// The unguarded solve runs first, and its result is certified (class_certificate.hpp). If the certificate fails, the
// solve starts again from the initial foliation and certifies each level, coarsest first. A level that loses the class
// is repeated from its certified initial state, and each step of all vertices has to pass the certificate before it is
// accepted (moves of single vertices cannot leave the class).
#pragma once

#include "../leaves/class_certificate.hpp"
#include "state.hpp"

namespace hmf {

struct SolveOptions;
class SolveLog;

struct ClassGuard {
    ClassCertificate reference;
    CurveWords words;
    ZeroList zeros;       // of the state, as long as they are known
    ClassCheck result;    // of the last certification
    double seconds = 0;   // of all certifications
    uint32_t repeats = 0; // levels that were solved once more
    ClassCheck lost;      // the last one that was refused
    double unit = 1;      // of the reference
    bool started = false;
    enum class Checks : uint8_t { result, levels, steps } checks = Checks::result; // what has to pass

    // At the start of a solve, on the coarsest level.  loops: on the mesh of the
    // state, or NULL; weights: theirs, in units of the state, or empty.
    [[nodiscard]] hmf_status start(State& state, double unit_of_values, const Loops* loops,
                                   const Array<int64_t>& weights, Call& call);
    // Certifies the current state.
    [[nodiscard]] hmf_status certify(State& state, double unit_of_values, Call& call);
    bool holds() const { return result.state != ClassState::lost; }
    // Updates the words with every later change of the mesh of the state.
    void listen(State& state);

private:
    MeshListener listener_{};
};

// run_cascade, with the certificate and the guard.  HMF_LIMIT_CLASS: the minimum
// could not be reached within the class; guard.result says whether the values are in it.
[[nodiscard]] hmf_status solve_in_class(State& state, const SolveOptions& options, Call& call, SolveLog& log,
                                        ClassGuard& guard);

} // namespace hmf
