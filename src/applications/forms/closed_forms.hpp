// A basis of the integer cohomology of a closed surface: closed forms with integers on the half-edges.
//
// A tree of edges and a tree of crossed edges leave 2 * genus edges (tree_cotree.hpp).  Across each of them a closed
// curve goes through triangles, and back through the tree of crossed edges.  Its form counts the crossings:
//
//          \  |  /            form(h) = +1 where the curve crosses h from its left to its right,
//     curve --|h-->--                  -1 from its right to its left: the sum over the sides of a
//          /  |  \                     triangle is 0, since the curve leaves what it enters
//
// In integers these forms become a canonical basis: the integral of a[i] ^ b[i] over the surface is 1, those of all
// other pairs are 0.
#pragma once

#include "../../core/mesh/mesh.hpp"

namespace hmf {

class ClosedForms {
public:
    [[nodiscard]] hmf_status build(const Mesh& mesh, Call& call);

    uint32_t count() const { return count_; } // 2 * genus
    // Adds form i of the canonical basis, times `unit`: a[0], a[1], ..., then b[0], b[1], ...
    void add(uint32_t i, int64_t unit, int64_t* value) const;
    // For each form i of the basis the sum of weight * form i * other over all edges.
    Done products(const double* weight, const int64_t* other, double* sum, Memory& memory) const;
    // For each form i the integral of other ^ form i over the surface, exact for closed forms.
    Done intersections(const int64_t* other, uint64_t* sum, Memory& memory) const;

private:
    Done find_curves(Call& call);
    hmf_status make_canonical(Call& call);
    int64_t intersection_with_curve(const int64_t* value, uint32_t curve) const;
    template <class T, class OfCurve>
    Done sum_rows(T* sum, Memory& memory, OfCurve of_curve) const;

    const Mesh* mesh_ = nullptr;
    uint32_t count_ = 0;
    Array<uint64_t> offset_;  // of each curve
    Array<uint32_t> crossed_; // the half-edges that it crosses from left to right, in order
    Array<int64_t> row_;      // count_ x count_: canonical forms as sums of those of the curves
};

} // namespace hmf
