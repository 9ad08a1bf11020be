// The C interface as the tests use it: objects that clean up, levels as
// vectors, loops by construction, and checks of foliations that share no code
// with the library.
#pragma once

#include <hmf/hmf.h>
#include <hmf/applications.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "meshes.hpp"

namespace test {

// Owns a hierarchy; fails the running test if it cannot be built.
class Hierarchy {
public:
    explicit Hierarchy(const TriMesh& mesh, double ratio = 0, uint64_t coarsest = 0, int32_t collapse = 0);
    Hierarchy(const TriMesh& mesh, const hmf_hierarchy_options& options);
    ~Hierarchy() { hmf_hierarchy_destroy(handle_); }
    Hierarchy(const Hierarchy&) = delete;
    Hierarchy& operator=(const Hierarchy&) = delete;

    const hmf_hierarchy* get() const { return handle_; }
    explicit operator bool() const { return handle_ != nullptr; }
    size_t levels() const { return hmf_hierarchy_describe(handle_)->level_count; }
    size_t coarsest() const { return levels() - 1; }
    size_t edges(size_t level) const;

private:
    hmf_hierarchy* handle_ = nullptr;
};

struct LevelMesh {
    size_t level = 0, vertex_count = 0, edge_count = 0, triangle_count = 0, raised_count = 0;
    std::vector<uint32_t> edge_vertices, triangle_edges, triangle_vertices;
    std::vector<double> weights, positions;
};
LevelMesh read_level(const Hierarchy& hierarchy, size_t level);

struct Delete {
    void operator()(const hmf_foliation* foliation) const {
        hmf_foliation_destroy(const_cast<hmf_foliation*>(foliation));
    }
    void operator()(const void* result) const { hmf_free(result); }
};
// A foliation or a result.
template <class T>
using Owned = std::unique_ptr<const T, Delete>;
using Foliation = Owned<hmf_foliation>;

// Makes call(&object, error); fails the running test unless it succeeds.
hmf_status expect_ok(hmf_status status, const hmf_error& error);
template <class T, class Call>
Owned<T> make(Call&& call) {
    T* out = nullptr;
    hmf_error error{};
    expect_ok(call(&out, &error), error);
    return Owned<T>(out);
}

// Loops that own their arrays.
struct Loops {
    int32_t kind = HMF_PATH_TRIANGLES;
    uint64_t level = 0;
    std::vector<uint64_t> offsets{0};
    std::vector<uint32_t> elements;
    std::vector<double> weights; // empty: all 1

    size_t count() const { return offsets.size() - 1; }
    void add(const std::vector<uint32_t>& loop);
    hmf_loop_set view() const;
};
Loops library_loops(const Hierarchy& hierarchy, size_t level, int32_t kind = HMF_LOOPS_CUT);
Owned<hmf_loop_set> loops_of(const Hierarchy& hierarchy, int32_t kind); // on level 0, as they come

// --- Marked vertices ---------------------------------------------------------

// 0: the default.  The marks must live as long as the options.
hmf_hierarchy_options with_marks(const std::vector<uint32_t>& marks, double ratio = 0, uint64_t coarsest = 0);
std::vector<uint32_t> suggested_marks(const TriMesh& mesh);

// --- Foliations --------------------------------------------------------------

std::vector<double> values_of(const Foliation& foliation);

// These fail the running test unless the call succeeds.
Foliation create(const Hierarchy& hierarchy, size_t level, const std::vector<double>& values);
Foliation initialize(const Hierarchy& hierarchy, const Loops& loops);
Foliation interpolate(const Foliation& foliation, size_t level);
double energy(const Foliation& foliation);
std::vector<double> residuals(const Foliation& foliation, size_t vertex_count);
Owned<hmf_singularity_set> singularities(const Foliation& foliation);

// --- Loops by construction ---------------------------------------------------

using Field = std::function<double(const double*)>; // of a position

// The closed curve {field = 0} that meets the region {region > 0} with its
// center, as a loop of triangles.  The class is that of the curve on the
// smooth shape, whatever the level.  Fails the test unless there is exactly one.
std::vector<uint32_t> section(const LevelMesh& mesh, const Field& field, const Field& region);

// The loops around the upper bars (y large) of the holes of plate(g) and of what is
// made from it: a cut system.  hole_x: the middle of hole k.
Loops bar_loops(const Hierarchy& hierarchy, size_t level, size_t holes, const std::function<double(size_t)>& hole_x);
Loops plate_loops(const Hierarchy& hierarchy, size_t level, size_t holes);

// Around the tube of torus(): the values of a foliation have a period along the axis angle.
Loops meridian(const Hierarchy& hierarchy, size_t level);

// --- Checks ------------------------------------------------------------------

// Counted from the definition ([W] Eq. 1 and 3, clusters of zero edges).
struct Indices {
    size_t zeros = 0, poles = 0; // orders added up, number of poles
    long sum = 0;
};
Indices count_indices(const LevelMesh& mesh, const std::vector<double>& values);

// Empty, or what is wrong: negative or not finite, not multiples of a common power of two that keeps
// the sums of a triangle exact, a triangle inequality broken.
std::string closedness_defect(const LevelMesh& mesh, const std::vector<double>& values);

// Everything that holds for every result: closed multiples of its unit, no
// poles, indices, and that hmf_singularities says the same.
void expect_foliation(const LevelMesh& mesh, const Foliation& foliation);

double energy(const LevelMesh& mesh, const std::vector<double>& values);

// Violation of [W] Eq. 4 where no edge at the vertex is zero, else -1.  The
// level must have positive weights only.
std::vector<double> residuals(const LevelMesh& mesh, const std::vector<double>& values);

// Edges that loop c crosses (triangle loops), in the order of the loop.
std::vector<uint32_t> crossed_edges(const LevelMesh& mesh, const Loops& loops, size_t c);

// Least length of a closed edge path that crosses triangle loop c exactly once.
double shortest_crossing(const LevelMesh& mesh, const Loops& loops, size_t c, const std::vector<double>& values);

// Necessary for the class of loops that all have weight w, exact: the dual tree
// has only edges of length w, so that heights above a singularity are defined up
// to sign and multiples of w.  Integrates the values over the regular vertices
// and compares all the ways to each edge and each other singularity.  Empty, or
// what does not fit.
std::string class_defect(const LevelMesh& mesh, const std::vector<double>& values, double w);

// --- Solving -----------------------------------------------------------------

struct Solution {
    hmf_status status = HMF_ERROR_INTERNAL;
    Foliation foliation;
    std::vector<double> values; // of the foliation
    hmf_report report{};        // its arrays live as long as the foliation
    hmf_error error{};
};

// tolerance: of the residual for newton, else of the energy.
hmf_solve_options solve_options(int32_t method, double tolerance, uint64_t iterations = 0);
Solution solve(const Hierarchy& hierarchy, const Loops* loops, const hmf_solve_options& options,
               const hmf_control* control = nullptr);
Solution solve(const Hierarchy& hierarchy, const hmf_loop_set& loops); // with the default options
Solution relax(const Foliation& foliation, const hmf_solve_options& options, const hmf_control* control = nullptr);

// A surface, with marked vertices if there are some, and the solution for the loops of the library.
struct SolvedSurface {
    Hierarchy hierarchy;
    Solution solution;
    explicit SolvedSurface(const TriMesh& mesh, const std::vector<uint32_t>& marks = {});
};

} // namespace test
