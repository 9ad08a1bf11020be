// Distances along the edges of a mesh from a vertex (Dijkstra), and disks around it.
#pragma once

#include "../../core/base/nearest_first.hpp"
#include "../../core/mesh/mesh.hpp"

#include <cmath>

namespace hmf {

class EdgeDistances {
public:
    EdgeDistances(const Mesh& mesh, const double* position, Memory& memory) :
        mesh_(mesh), position_(position), memory_(memory) {}
    Done start();

    // From a vertex within `allowed` (NULL: everywhere).  Ends with the vertex for
    // which enough(v) holds; `last` is the last one reached.
    template <class Enough>
    Done search(uint32_t from, const uint8_t* allowed, uint32_t& last, Enough enough) {
        for (double& d : distance_) d = HUGE_VAL;
        order_.clear();
        heap_.clear();
        distance_[from] = 0;
        if (!heap_.push({0, from})) return false;
        while (!heap_.empty()) {
            const NearestFirst::Entry entry = heap_.pop();
            const uint32_t v = entry.item;
            if (entry.distance > distance_[v]) continue;
            order_.add(v); // each vertex once
            last = v;
            if (enough(v)) break;
            for (const uint32_t h : mesh_.around(v)) {
                const uint32_t w = mesh_.target(h);
                const double d = entry.distance + length_[edge_of(h)];
                if (d < distance_[w] && (!allowed || allowed[w])) {
                    distance_[w] = d;
                    if (!heap_.push({d, w})) return false;
                }
            }
        }
        return true;
    }
    Done search(uint32_t from, const uint8_t* allowed, uint32_t& last) {
        return search(from, allowed, last, [](uint32_t) { return false; });
    }

    // Of the last search: HUGE_VAL where it did not come.
    double distance(uint32_t v) const { return distance_[v]; }

    // A disk around a vertex ends when it has the given part of the area of the surface, or less than `shape` times the
    // square of its radius, as it has along a limb.
    struct DiskLimit {
        uint32_t vertices; // at least
        double area, shape;
    };
    // The ends of a diameter of the disk, found by going to the farthest vertex
    // and back; NONE if there is no room.  left_out: per vertex, or NULL.
    Done diameter(uint32_t vertex, const DiskLimit& limit, const uint8_t* left_out, uint32_t (&ends)[2]);

    double area(uint32_t v) const { return area_[v]; } // a third of its triangles
    double whole_area() const { return whole_; }

private:
    const Mesh& mesh_;
    const double* position_;
    Memory& memory_;
    Array<double> length_, area_, distance_; // per edge, per vertex twice
    Array<uint32_t> order_;                  // vertices as they were reached
    NearestFirst heap_;
    double whole_ = 0;
};

} // namespace hmf
