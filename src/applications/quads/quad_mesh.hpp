// A quad mesh along the leaves.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "../lines/front_parts.hpp"
#include "point.hpp"
#include "quad_rulers.hpp"
#include "quad_sizes.hpp"

namespace hmf {

// A vertex at the tip of a limb, or on the way to it, where it stays; one of the boundary of the surface, which slides
// along it; one that slides along a sharp edge; and one at a corner of the boundary, which stays.
constexpr uint8_t AT_TIP = 1, AT_BOUNDARY = 2, ON_CREASE = 3, AT_CORNER = 4, ON_WAY_TO_TIP = 5;
inline bool is_at_boundary(uint8_t held) { return held == AT_BOUNDARY || held == AT_CORNER; }
inline bool can_slide(uint8_t held) { return held == AT_BOUNDARY || held == ON_CREASE; }

struct QuadMesh {
    Array<double> positions; // 3 per vertex; the zeros first, in their order
    Array<uint32_t> quads;   // 4 per quad, in the orientation of the triangles
    Array<uint32_t> sides;   // per vertex: a half-edge of the mesh, left of which it lies
    Array<uint8_t> held;     // per vertex: 0, or one of the above

    void start(Memory& memory) {
        positions.start(memory);
        quads.start(memory);
        sides.start(memory);
        held.start(memory);
    }
    // side: a half-edge of the mesh, left of which p lies.
    Done add_vertex(const Point& p, uint32_t side, uint8_t is_held = 0) {
        return positions.push(p.x) && positions.push(p.y) && positions.push(p.z) && sides.push(side)
            && held.push(is_held);
    }
    Done add_quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        return quads.push(a) && quads.push(b) && quads.push(c) && quads.push(d);
    }
    Done copy(const QuadMesh& from, Memory& memory) {
        return copy_array(from.positions, positions, memory) && copy_array(from.quads, quads, memory)
            && copy_array(from.sides, sides, memory) && copy_array(from.held, held, memory);
    }
    uint32_t vertex_count() const { return static_cast<uint32_t>(sides.size()); }
    size_t quad_count() const { return quads.size() / 4; }
    void put(uint32_t v, const Point& p, uint32_t side) {
        double* const place = &positions[size_t{3} * v];
        place[0] = p.x;
        place[1] = p.y;
        place[2] = p.z;
        sides[v] = side;
    }
};

struct QuadWish {
    double number = 0;       // how many quads
    bool exact = false;      // that many; else edges have the length in the flat metric that would make them
    bool merge = false;      // critical leaves shorter than half an edge get no column
    bool keep_poles = false; // poles stay vertices with two edges
};

// Refuses a foliation with a part that no leaf crosses and that is not a disk: it makes no quads there.
[[nodiscard]] hmf_status refuse_wide_zeros(const CriticalGraph& graph, Call& call);

// position: of the vertices of f.mesh.  Cylinders of the same f.  front: of a double, only
// what lies in front; NULL: the surface is closed.
[[nodiscard]] hmf_status make_quads(Foliation& f, const Conjugate& conjugate, const double* position,
                                    const Cylinders& cylinders, const FrontParts* front, const QuadWish& wish,
                                    QuadMesh& out, Call& call);

inline Point at(const QuadMesh& quads, uint32_t v) { return point(quads.positions.data(), v); }

} // namespace hmf
