// What follows from the leaves of a result: polylines, cylinders, quads.
#pragma once

#include <string>
#include <vector>

#include "library.hpp"

namespace cli {

// Polylines of one foliation.
struct Leaves {
    Owned<hmf_lines> along, across; // across may be NULL
};

// Level sets about `spacing` apart and the critical leaves; conjugate: also lines across the cylinders.  Throws
// Failure.
Leaves trace_leaves(const hmf_foliation* foliation, double spacing, bool conjugate, const hmf_control* control,
                    const std::string& subject);

// As OBJ with one `l` element each, in groups cylinder_K, critical and across_K; the cylinders of one component come
// after those of another.  Returns the number of lines; throws Failure.
size_t write_leaves(const std::string& path, const std::vector<Leaves>& components);

// A quad mesh along the leaves.  Throws Failure.
Owned<hmf_quad_mesh> make_quads(const hmf_foliation* foliation, const hmf_quad_options& options,
                                const hmf_control* control, const std::string& subject);

} // namespace cli
