// Loops of the caller, from a text file.
#pragma once

#include <hmf/hmf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

struct LoopList {
    int32_t element_kind = HMF_PATH_TRIANGLES;
    std::vector<uint64_t> offsets{0};
    std::vector<uint32_t> elements;
    std::vector<uint8_t> arcs;       // one per loop: it is one
    std::vector<uint32_t> arc_sides; // two per loop, as in hmf_loop_set
    std::vector<size_t> lines;       // of the file, one per loop
    std::vector<double> weights;     // of the file; empty: none
    size_t count() const { return offsets.size() - 1; }
    hmf_loop_set view() const {
        return {sizeof(hmf_loop_set), element_kind, 0,           count(),         offsets.data(),
                elements.data(),      nullptr,      arcs.data(), arc_sides.data()};
    }
};

// One loop a line, indices from 0 separated by blanks or commas: vertices of a
// closed path of edges, or "t:" and triangles that follow each other across
// edges, counted as in the file (a polygon counts as the triangles of its fan);
// "a:" and vertices, or "at:" and triangles, of an arc from boundary to boundary;
// "at02:" begins at side 0 of its first triangle and ends at side 2 of the last.
// "#" begins a comment, empty lines are skipped; "# --weights W,W,.." gives
// weights, as written with the loops.  Throws Failure.
LoopList read_loops(const std::string& path, size_t vertex_count, size_t triangle_count);

} // namespace cli
