// The tuned numbers of the search for loops. Lengths of strips are dual lengths (dual_length.hpp), lengths of classes
// those of closed geodesics. Measured on 17 meshes of genus 0 to 30: with CHOICE_ROUNDS from 3 to 8 all loops are the
// same.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmf {

// ---- levels ----
// A coarser level does not represent the surface: handles are shorter or longer there by a half. Many handles have
// different sizes, and the small ones get few of the vertices.
constexpr uint64_t VERTICES_OF_HANDLE = 420; // of the search level
constexpr uint64_t MANY_HANDLES = 10;        // with so many the search level has MEASURED_VERTICES
constexpr uint32_t MEASURED_VERTICES = 10000, FINEST_VERTICES = 100000; // of the levels where classes are measured

// ---- candidates: searches in a cut surface ----
constexpr double SLACK = 1.7;      // strips longer than the best one by this factor are no candidates
constexpr double ROOTS = 1.15;     // no search if all its loops are longer than the best one by this factor
constexpr double WIDE_ROOTS = 1.5; // the same for the cut system of pants of many handles
// Of many handles some are so narrow that strips around them are half as long again as they should be, or one twice as
// long.  That one comes last, and its search reaches further, and leaves out less.
constexpr double LAST_SLACK = 2.6, LAST_ROOTS = 2;
// On a sphere a class has many closed geodesics, some of which hang on marked vertices: more searches.
constexpr double ROOTS_OF_SPHERE = 1.4, APART_ON_SPHERE = 0.05;
// Least distance of a search from another one, in lengths of the best strip.
constexpr double CUT_APART = 0.15, PANTS_APART = 0.1, MOVE_APART = 0.2;
// Joins of holes with a longer estimate than the least one by this factor are no candidates.
constexpr double PANTS_FURTHER = 2.5, MOVE_FURTHER = 1.8;
constexpr size_t CUT_CANDIDATES = 48, PANTS_CANDIDATES = 64, MOVE_CANDIDATES = 24; // for one choice
constexpr size_t MOST_LOOPS = 16;                                                  // of one search
constexpr size_t FIRST_OF_TWO = 5;       // candidates for the first of two curves
constexpr size_t MOST_PAIRED_MARKS = 64; // with more there are no cycles for loops around pairs of them
constexpr size_t STATES_BY_LENGTH = 16;  // of a search with labels, per region, before edges are counted instead
constexpr size_t MOST_STATES = 256;      // per region, where edges are counted
constexpr double MOST_BUDGET = 32;       // so many times the work of the other loops without a loop: the search ends

// Regions that all searches for one set of loops may settle: linear in the faces on large meshes. Then the best loops
// found so far are taken.
inline double search_budget(uint32_t faces) { return 5e6 + 12.0 * faces; }

// ---- choice ----
// Of measuring and choosing again, of one set or batch, and of shortening all of its loops.
constexpr int CHOICE_ROUNDS = 8;
constexpr uint64_t CHOICE_STEPS = 100; // loops that are chosen again; of large sets half of the loops
constexpr uint32_t MOST_OF_BATCH = 64; // loops of a cut system from one search: a bit for each
// Pants from one search: one of so many that are left. Quick ones are not corrected by moves.
constexpr size_t PART_OF_BATCH = 16, PART_OF_QUICK_BATCH = 64;
constexpr size_t DUAL_PASSES = 8;    // of the surface, by the searches for dual loops in one cut
constexpr double MARGIN = 0.05;      // relative, by which two curves may be longer where they are found
constexpr double MOVE_GAIN = 1e-6;   // relative, of a move
constexpr double MOVE_LITTLE = 1e-3; // relative, of another strip in the class
constexpr size_t MOST_TOGETHER = 8;  // curves that are pulled at once
constexpr int MOST_PASSES = 64;      // of moves

// ---- lengths of classes ----
constexpr size_t MOST_STARTS = 4, MOST_MARKED_STARTS = 64; // strips that are pulled for one class
constexpr double OTHER_CLASS = 0.01; // relative: another strip, or another length where it was found
// Relative errors of lengths, by stage; and that of a loop of n crossings, which may be a
// circle with n / 2 corners and then is too short, as DOUBT_ROUND / n^2.
constexpr double DOUBT[3] = {0.05, 0.005, 0}, DOUBT_ROUND = 24;
constexpr double TILT[3] = {0.005, 0.003, 0.002}; // growth of the metric from end to end, per axis

// ---- closed geodesics ----
constexpr size_t STRAIGHTENINGS = 100;       // rounds for one curve
constexpr double STRAIGHT = 1e-9;            // a detour that gains less is none
constexpr double GEODESIC_LITTLE = 1e-7;     // relative, what is not worth another round
constexpr double LITTLE_HELD = 1e-3;         // likewise until it is known whether the curve is of interest
constexpr double BENT = 0.005;               // relative, longer by more then: it does not get shorter than another
constexpr double SAME = 1e-4;                // relative, shorter by less: the same curve
constexpr size_t MIDWAY = 2, MOST_ASIDE = 8; // strips that a curve is pushed aside
constexpr size_t MOST_MORE = 64;             // crossings of a detour, beyond those of the loop

} // namespace hmf
