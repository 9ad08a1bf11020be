// What follows from the leaves of a result: polylines, cylinders, quads.
#pragma once

#include "library.hpp"

namespace cli {

// Level sets about `spacing` apart and the critical leaves, as OBJ with one `l`
// element each, in groups cylinder_K and critical.  conjugate: also lines across
// the cylinders, in groups across_K.  Returns the number of lines; throws Failure.
size_t write_leaves(const std::string& path, const hmf_foliation* foliation, double spacing, bool conjugate,
                    const hmf_control* control, const std::string& mesh_name);

// A quad mesh along the leaves as OBJ; size: wished length of an edge, 0 = the
// default.  Returns the number of quads; throws Failure.
size_t write_quads(const std::string& path, const hmf_foliation* foliation, double size, const hmf_control* control,
                   const std::string& mesh_name);

} // namespace cli
