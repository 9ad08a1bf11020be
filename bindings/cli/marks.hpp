// Marked vertices, which may be poles: those of a file, or those that the library suggests for a sphere.
#pragma once

#include <hmf/hmf.h>

#include <string>
#include <vector>

#include "read_mesh.hpp"

namespace cli {

// Vertex indices, with blanks, commas or ends of lines between them; # begins a comment.  Throws Failure.
std::vector<uint32_t> read_marks(const std::string& path, size_t vertex_count);

// None but on a sphere; statuses as of hmf_hierarchy_create.
hmf_status suggest_marks(const TriangleMesh& mesh, const hmf_hierarchy_options& options, const hmf_control* control,
                         std::vector<uint32_t>& marks, hmf_error& error);

// What the library has chosen on so many components, in a sentence.
std::string sentence_of(const std::vector<uint32_t>& suggested, size_t components, bool tips);

void write_marks(const std::string& path, const std::vector<uint32_t>& marks);

} // namespace cli
