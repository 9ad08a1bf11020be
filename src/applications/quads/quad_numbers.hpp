// The numbers that were chosen, not derived.  Lengths are in sides of quads, areas in quads, sines those of corners.
#pragma once

#include <cstddef>

namespace hmf {

// How a row is turned against the row before (cylinder_rows.cpp).
constexpr size_t SAMPLES = 16; // columns by which they are compared, and turns tried at first, four for each

// The energy of a corner (corner_energy.hpp) and of a quad (optimize_quads.cpp).
constexpr double SIZE = 0.1, ANGLE = 0.75; // weights of the area, and of the angle, beside the shape
constexpr double GROWTH = 2;               // weight of what quads cover
constexpr double RIDGE = 10;               // more growth where the normals at the corners of a quad differ
constexpr double EPS = 1e-3;               // of the barrier: an area
constexpr int EVEN = 20;                   // rounds in which the areas wished are evened out

// Steps of the optimizer.
constexpr double LONGEST_STEP = 0.5;   // of a vertex in one sweep
constexpr double STILL = 4e-3;         // a shorter one is none
constexpr double STEPS[] = {1.6, 0.4}; // parts of a step of Newton's method, longest first
constexpr int UNTANGLE_ROUNDS = 4;
constexpr int SWEEPS = 25;     // in each of them
constexpr int RINGS = 4;       // around folded quads, twice as many in each further round
constexpr double SOFT = 0.2;   // eps, in the area of the worst corner, while all vertices move
constexpr double HARDER = 0.6; // eps, in that of the sweep before, in the other rounds

// Tips, sharp edges and corners.
// Cosine of 40 degrees, between the faces of a sharp edge, between two edges of the boundary at a corner, and between a
// sharp edge and a side that runs along it.
constexpr double SHARP = 0.766;
constexpr double TAKEN_FROM =
    0.5; // how far from a sharp edge a vertex goes to it, and from how far on tips are reached
constexpr double LEAST_TAKEN = 0.3; // sine around a vertex that goes to one of them, and that stays at a tip
constexpr int ROUNDS = 5;           // of reaching for them

// Corners of the boundary (boundary_places.cpp).
constexpr int REACH = 3;        // how far a vertex of one quad goes to a corner; others go one side
constexpr double SPREAD = 0.05; // part of even places in all places, that no two are the same

// What is folded and what is refused (quad_shape.cpp, sized_quads.cpp).
constexpr double LEEWAY = 0.02;        // in diagonals: on a sheet thinner than this a quad may lie on either side
constexpr double MOST_INVERTED = 0.05; // of the quads
constexpr double LEAST_AREA = 0.75;    // of the quads in that of the surface, or the other way around
constexpr double MOST_TIMES = 8;       // as many quads as the fewest possible, where more are tried

} // namespace hmf
