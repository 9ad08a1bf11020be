// The tuned numbers of the search for loops, with their meanings.  Lengths of strips are dual lengths
// (dual_length.hpp), lengths of classes those of closed geodesics.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmf {

// ---- levels ----
// Vertices of the level that is searched, for each handle. On coarser levels handles are shorter or longer by a half.
// With many handles it has MEASURED_VERTICES: their sizes differ, and the small ones get few of the vertices.
constexpr uint64_t VERTICES_OF_HANDLE = 420, MANY_HANDLES = 10;
// Of the levels where classes are measured, at least, if there are so many: first all of interest, then those that are
// close.
constexpr uint32_t MEASURED_VERTICES = 10000, FINEST_VERTICES = 100000;

// ---- candidates: searches in a cut surface ----
// Strips and joins of holes that are longer than the best one by this factor are no candidates.
constexpr double SLACK = 1.7;
// No search from a root if all its loops are longer than the best one by this factor; on spheres, where a class has
// many closed geodesics, by SLACK.
constexpr double ROOTS = 1.15;
// Least distance of a search from another one, in lengths of the best strip.
constexpr double APART = 0.15, APART_ON_SPHERE = 0.05;
constexpr size_t CANDIDATES = 64;       // for one choice, and from one search
constexpr size_t STARTS = 4;            // strips that are pulled for one class, and first curves of two
constexpr uint32_t LOOPS_OF_BATCH = 64; // of a cut system, from one cut: a bit for each
constexpr size_t PART_OF_BATCH = 16;    // one of so many pants curves that are left is taken from one cut
constexpr size_t MOST_STATES = 256;     // of a search with labels, per region
constexpr double MOST_BUDGET = 32;      // so many times the work of the other loops without a loop: the search ends

// ---- choice ----
// Of measuring and choosing again, of shortening all loops, and of passes of a surface before it is cut anew.
constexpr int CHOICE_ROUNDS = 8;
// Of straightening one curve, and of choosing loops again beyond half of a set; both usually end earlier.
constexpr size_t MOST_REPEATS = 100;
// Regions that all searches for one set of loops may settle: linear in the faces on large meshes. Then the best loops
// found so far are taken.
inline double search_budget(uint32_t faces) { return 5e6 + 12.0 * faces; }

// ---- lengths, relative ----
constexpr double SAME = 1e-4;   // curves that differ by less are equally long
constexpr double CLOSE = 0.005; // a curve that is longer by more once it is nearly straight stays longer
// Errors on the level of the search, and on those of MEASURED_VERTICES and FINEST_VERTICES.
constexpr double DOUBT[3] = {0.05, CLOSE, 0};
// A loop of n crossings may be a circle with n / 2 corners, and narrow: it is longer than measured by at most
// ROUND_DOUBT / n^2. With a fourth of it a narrow handle of boot is missed on the mesh refined by 16.
constexpr double ROUND_DOUBT = 24;
constexpr double LITTLE = 1e-9;  // a curve that gets shorter by less is straight
constexpr size_t MOST_ASIDE = 8; // strips that a curve is pushed aside

} // namespace hmf
