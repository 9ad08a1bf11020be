// Linking numbers of loops on a surface in space, and with them the classes
// that bound inside and outside.
//
// For a basis x_1 .. x_2g of the homology of the surface the Seifert matrix is
//
//     V_ij = lk(x_i, x_j pushed off to the side of the normals).
//
// A loop c = sum c_i x_i bounds on the other side just if c V = 0, and on the
// side of the normals if c V^T = 0 (Rolfsen, Knots and Links, 5.D; Dey, Fan,
// Wang: An efficient computation of handle and tunnel loops via Reeb graphs,
// 2013, use the same fact).
#pragma once

#include "../../core/curves/loops.hpp"

namespace hmf {

// lk and intersection numbers of 2g loops: row i, column j at [2g * i + j].
struct SeifertForm {
    size_t size = 0;             // 2g
    Array<int64_t> linking;      // V
    Array<int64_t> intersection; // J_ij = <x_i, x_j>, V - V^T = -J
};

// a and b: two sets of g disjoint simple loops each, x = (a, b).  The mesh is
// one without self-intersections; position: 3 per vertex.
// HMF_ERROR_MESH_NOT_EMBEDDED if the numbers contradict that.
[[nodiscard]] hmf_status seifert_form(const Mesh& mesh, const double* position, const Loops& a, const Loops& b,
                                      Call& call, SeifertForm& out);

} // namespace hmf
