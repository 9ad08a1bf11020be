// Coarse surfaces for maps: tubes whose radius varies by up to e^6, closed, open and as spheres, with marked vertices,
// with small handles, with loops twisted around them, and thin cylinders.
#pragma once

#include <hmf/applications.h>

#include "tubes.hpp"

namespace test::map_problems {

struct Problem {
    TriMesh mesh;
    std::vector<uint32_t> marks;
    bool is_sphere = false;     // its marked vertices are those of hmf_suggest_marks
    std::vector<uint32_t> path; // of vertices: the loop; empty: those of the library
    int32_t kind = HMF_LOOPS_CUT;
    bool has_boundary = false;
    std::vector<double> weights; // of the loops; empty: all 1
};

Problem closed(Random& random);
Problem open(Random& random);
Problem sphere(Random& random);
Problem marked(Random& random); // one to four vertices of a torus
// Once along the tube and up to twice around it: the loop along it after Dehn twists around a section.
Problem twisted(Random& random);
// With small handles.
Problem genus_two(Random& random);
Problem genus_two_pants(Random& random);
Problem genus_three_pants(Random& random);
// Some cylinders are thinner than a triangle: on its way to a vertex a zero crosses all of their leaves.
Problem thin_cylinders(Random& random);

} // namespace test::map_problems
