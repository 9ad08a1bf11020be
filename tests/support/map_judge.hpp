// What a parameterization says about itself, read from its arrays alone.
#pragma once

#include <cmath>

#include "surface.hpp"

namespace test {

struct MapJudgment {
    std::string defect;                               // empty, or an array that contradicts another
    double area = 0;                                  // of the image, signed
    double absolute_area = 0;                         // without signs
    long turns = 0;                                   // sum of 2 - cone
    size_t odd = 0;                                   // vertices where u changes its sign
    double off_lattice = 0;                           // see judge_map
    double least_share = HUGE_VAL, largest_share = 0; // see judge_map
};

// All weights are 1.  Then the zeros of u where its sign changes lie at heights that differ by whole numbers, and so do
// both sides of every edge: off_lattice is how far they are from that.  The layout is moved by 2^52 units where it is
// too far from 0, so if that is less than 1, it takes the place of 1.
// The shares are those of each loop: the sum of |du| over the edges that it crosses, by that of the values.
MapJudgment judge_map(const LevelMesh& mesh, const Foliation& foliation, const Loops& loops,
                      const hmf_parameterization& map);

} // namespace test
