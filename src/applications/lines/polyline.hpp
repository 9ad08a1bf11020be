// Leaves as polylines on the surface in space.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../common/cylinder_leaves.hpp"

namespace hmf {

// A point of an edge, at its fraction; the same bits from both half-edges.
void point_at(const Foliation& f, const double* position, const Crossing& c, double* point);

// Where the prongs of a tripod meet: the mean of the branch points on the sides.
void middle_of_tripod(const Foliation& f, const double* position, uint32_t h, double* point);

double distance(const double* a, const double* b);

double surface_area(const Mesh& mesh, const double* position, const Parallel& parallel);

// The places of an arc, without the middle of a tripod: half a unit left of
// its side.  A place of full width is the vertex that the half-edge ends at;
// each comes once.  False: out of memory.
Done arc_places(const Foliation& f, const CriticalGraph& graph, uint32_t arc, Array<Crossing>& places);

class Lines {
public:
    Lines(Foliation& f, const double* position, double unit, double length_limit, Call& call);

    Array<hmf_line> list;
    Array<uint64_t> offsets; // list.size() + 1
    Array<double> points;    // 3 per point
    Array<uint32_t> edges;   // per point, NONE in the middle of a tripod

    Done start();
    [[nodiscard]] hmf_status add_levels(Cylinders& cylinders, double spacing);
    [[nodiscard]] hmf_status add_arcs(const CriticalGraph& graph);
    // The leaf through the point with these barycentric coordinates for the
    // corners of a triangle, of which h is side 0.  cylinders: NULL if there are none.
    [[nodiscard]] hmf_status add_point(Cylinders* cylinders, uint32_t h, const double* barycentric, uint32_t number);

    // A leaf through a place, until it closes or is too long.
    [[nodiscard]] hmf_status add_leaf(const Crossing& c, hmf_line line);
    // The place of a point, on the nearest leaf; NONE where the foliation is 0.
    Crossing place_of_point(uint32_t h, const double* barycentric) const;
    bool limited(double length) const { return length_limit_ > 0 && length > length_limit_; }
    Done add(const double* point, uint32_t edge);
    Done end_line(const hmf_line& line);
    void reverse(size_t first); // the points from first on

private:
    Foliation& f_;
    const double* position_;
    double unit_, length_limit_;
    Call& call_;
};

} // namespace hmf
