// Quads by cylinders.  Every cylinder is a grid of rows (leaves at equal
// distances) and columns; along the critical graph the grids share the points
// that divide its arcs.  So the mesh is closed, oriented and manifold whatever
// the numbers are, and a zero with k prongs has 2k edges, all others 4 (a marked
// vertex with one prong: quad_poles.hpp).
//
//     Z---+---+---Z---+--       lower boundary leaf ->   (arcs, columns)
//     |   |   |   |   |
//     +---+---+---+---+--       row 1
//     |   |   |   |   |
//     +---Z---+---+---+--       <- upper boundary leaf
//
//     sizes    how many columns and rows                          quad_sizes, grid_sizes
//     points   the vertices on the critical graph                 graph_points
//     rows     those inside the cylinders, and the quads          cylinder_rows
//     poles    one quad over each                                 quad_poles
#include "quad_mesh.hpp"

#include "../lines/polyline.hpp"
#include "cylinder_rows.hpp"
#include "quad_poles.hpp"

#include <cmath>

namespace hmf {

namespace {

// For a double, with twice the step: the sum of both halves has the requested size.
hmf_status find_sizes(const QuadInput& in, const GraphPoints& points, const Array<double>& length, const QuadWish& wish,
                      double step, QuadSizes& sizes, Call& call) {
    const double ring_length = in.graph.zeros.empty() ? points.length(0) : 0;
    if (!(step > 0) || !std::isfinite(step))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length is out of proportion to the surface.");
    if (sizes.start(in.cylinders, length, ring_length, wish.merge, call)) return call.status();
    if (in.front) step *= 2;
    if (!wish.exact) return sizes.of_step(step, call);
    const int64_t count = static_cast<int64_t>(std::floor(wish.number + 0.5));
    return sizes.of_count(step, in.front ? count / 2 + 1 : count, call);
}

} // namespace

hmf_status refuse_wide_zeros(const CriticalGraph& graph, Call& call) {
    for (uint32_t z = 0; z < graph.zeros.size(); ++z)
        if (graph.zeros[z].euler != 1)
            return call.fail(
                HMF_ERROR_QUADS, HMF_ELEMENT_NONE, z,
                "Zero %u goes around a part of the surface that no leaf crosses, with a handle, boundaries or "
                "marked vertices. Give loops that cross it.",
                static_cast<unsigned>(z));
    for (const Boundary& b : graph.boundaries)
        if (b.arcs_begin == b.arcs_end && !graph.zeros.empty())
            return call.fail(HMF_ERROR_QUADS, HMF_ELEMENT_NONE, 0,
                             "A leaf goes around several marked vertices at one place, which no leaf tells apart. "
                             "Give loops between them.");
    return HMF_OK;
}

hmf_status flat_area(const QuadInput& in, double& area, Call& call) {
    Curves middle;
    area = 0;
    if (middle_leaves(in.f, in.cylinders, nullptr, middle, call)) return call.status();
    for (size_t c = 0; c < in.cylinders.list.size(); ++c) {
        double v = 0;
        for (uint64_t i = middle.offsets[c]; i < middle.offsets[c + 1]; ++i)
            v += in.conjugate.step(middle.crossings[i]);
        area += v * static_cast<double>(in.cylinders.list[c].height);
    }
    return HMF_OK;
}

hmf_status make_quads(Foliation& f, const Conjugate& conjugate, const double* position, const Cylinders& cylinders,
                      const FrontParts* front, const QuadWish& wish, QuadMesh& out, Call& call) {
    const QuadInput in{f, position, cylinders, cylinders.graph, front, conjugate};
    QuadSizes sizes;
    GridSizes grid;
    GraphPoints points(in, grid, out, call);
    CylinderRows rows(in, grid, points, out, call);
    Array<double> length; // of each side of an arc
    if (!grid.allocate(in, call.memory) || !points.measure(length)) return call.out_of_memory();
    if (!call.tick(0)) return call.was_cancelled();
    double area = 0;
    if (flat_area(in, area, call)) return call.status();
    const double step = std::sqrt(area * (front ? 0.5 : 1) / wish.number);
    if (find_sizes(in, points, length, wish, step, sizes, call)) return call.status();
    const bool has_poles = f.mesh.marked_count > 0 && !wish.keep_poles;
    size_t left = 1; // poles that keep their vertex: two too near to each other, or to a boundary
    for (int tries = 0; tries < (has_poles && wish.merge ? 2 : 1) && left > 0; ++tries) {
        if (tries > 0 && sizes.widen_at_poles(call)) return call.status();
        grid.take(in, sizes, step, wish.exact ? wish.number : 0);
        out.start(call.memory);
        if (!points.place()) return call.out_of_memory();
        for (uint32_t c = 0; c < cylinders.list.size(); ++c)
            if (rows.fill(c)) return call.status();
        if (has_poles && !quads_over_poles(out, left, call)) return call.stopped();
    }
    return HMF_OK;
}

} // namespace hmf
