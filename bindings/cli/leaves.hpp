// What follows from the leaves of a result: polylines, cylinders, quads.
#pragma once

#include <string>
#include <vector>

#include "../../include/hmf/hmf.h"
#include "potential.hpp"

namespace cli {

// Level sets about `spacing` apart (0: a tenth of the least weight) and the
// critical leaves, as OBJ with one `l` element each, in groups cylinder_K and
// critical.  conjugate: also lines across the cylinders, in groups across_K.
// Returns the number of lines; throws Failure.
size_t write_leaves(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double spacing,
                    bool conjugate, const std::string& mesh_name);

// The cylinders of a converged result, each with its loop.
std::vector<hmf_cylinder> find_cylinders(const hmf_hierarchy* hierarchy, const Foliation& foliation,
                                         const hmf_loop_set& loops, const std::string& mesh_name);

// A quad mesh along the leaves as OBJ; size: wished length of an edge, 0 = the
// default.  Returns the number of quads; throws Failure.
size_t write_quads(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double size,
                   const std::string& mesh_name);

} // namespace cli
