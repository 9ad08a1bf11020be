// Which loop each cylinder belongs to, and cylinders found again on another
// triangulation, where free homotopy on the surface does not tell: with marked
// vertices.
#pragma once

#include "../solve/state.hpp"
#include "../leaves/cylinders.hpp"

namespace hmf {

// The values do not belong to the loops.
hmf_status wrong_class(Call& call);

// Heights that tell cylinders apart: each is stretched by a factor of its own.
// A stretched foliation is as exact as the first, and the heights go with it
// through all flips, splits and collapses.
struct Labels {
    Array<int64_t> factor, height; // per cylinder
    Done choose(const Cylinders& cylinders, Memory& memory);
    // The stretched values; after find_vertices.
    void stretch(const Foliation& f, const Cylinders& cylinders, int64_t* value) const;
    // found[c]: the cylinder of another decomposition that has the height of c.
    [[nodiscard]] hmf_status find(const Cylinders& others, Array<uint32_t>& found, Call& call) const;
};

// Matches the decompositions of two values on one mesh that are nearly the
// same, by the sequences of cylinders along the edges: found[c] is the one of
// `there` that meets most of the edges of c.  Fails if that does not give each its
// own, with the height that it has to have.
//   wanted   the height of found[c] in `there`, or NULL
[[nodiscard]] hmf_status match_cylinders(const Mesh& mesh, const int64_t* value, const Cylinders& here,
                                         const int64_t* other_value, const Cylinders& there,
                                         const Array<double>* wanted, Array<uint32_t>& found, Call& call);

// Assigns to each of the disjoint curves a the one of b that is freely homotopic
// to it and has the same key.  The harmonic foliation of a class is unique, so
// both sets, weighted with their keys, have the same, and their cylinders lie
// at the same place.  The state lies on the coarsest level, its values are
// overwritten.
[[nodiscard]] hmf_status match_classes(State& state, const Curves& a, const Array<int64_t>& key_a, const Curves& b,
                                       const Array<int64_t>& key_b, Array<uint32_t>& found, Call& call);

} // namespace hmf
