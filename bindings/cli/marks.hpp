// Marked vertices, which may carry poles: those of a file, or those that the library suggests for a sphere.
#pragma once

#include <hmf/hmf.h>

#include <string>
#include <vector>

#include "read_mesh.hpp"

namespace cli {

// By its numbers of vertices and triangles; what else is wrong with a mesh the library tells.
inline bool may_be_sphere(const TriangleMesh& mesh) { return mesh.triangle_count() + 4 == 2 * mesh.vertex_count(); }

// Vertex indices, with blanks, commas or ends of lines between them; # begins a comment.  Throws Failure.
std::vector<uint32_t> read_marks(const std::string& path, size_t vertex_count);

// None but on a sphere.  subject: in sentences.  Throws Failure.
std::vector<uint32_t> suggested_marks(const TriangleMesh& mesh, const hmf_build_options& options,
                                      const hmf_control* control, const std::string& subject);

// What the library has chosen, in a sentence.
std::string sentence_of(const std::vector<uint32_t>& suggested);

void write_marks(const std::string& path, const std::vector<uint32_t>& marks);

} // namespace cli
