// One component of the mesh of hmf solve, from its triangles to its foliation.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "../readers/json.hpp"
#include "library.hpp"
#include "potential.hpp"
#include "progress.hpp"
#include "read_loops.hpp"
#include "read_mesh.hpp"
#include "solve.hpp"
#include "split_mesh.hpp"

namespace cli {

// Counts the bytes that the library holds.
struct Meter {
    uint64_t held = 0, peak = 0;
    static void* allocate(void* user, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        void* block = std::malloc(size);
        if (block) {
            meter.held += size;
            meter.peak = meter.held > meter.peak ? meter.held : meter.peak;
        }
        return block;
    }
    static void release(void* user, void* block, size_t size) {
        static_cast<Meter*>(user)->held -= size;
        std::free(block);
    }
};

// Of a report: proven, unknown or lost; none: there is no foliation.  Of several the one least sure.
const char* class_name(int32_t state);
int32_t less_sure(int32_t a, int32_t b);

class Component {
public:
    // subject: in sentences.  alone: the whole mesh, vertices and triangles by the same numbers; then it throws Failure
    // where others are refused.
    // origin: of the whole mesh; lives longer.
    Component(MeshPart part, std::string subject, bool alone, const readers::Origin& origin) :
        part_(std::move(part)), subject_(std::move(subject)), alone_(alone), origin_(&origin) {}

    // --- In this order; throw Failure ---

    // The loops of a file, if there is one; otherwise those of the library are computed on demand.
    void take_marks(std::vector<uint32_t> marks) { marks_ = std::move(marks); }
    void build(const SolveRequest& request, Meter& meter, const hmf_control* control);
    // kind: HMF_LOOPS_*, LOOPS_EVEN.
    void make_loops(int32_t kind, bool fine, const hmf_control* control);
    // Loops of the caller instead, by the numbers of this component.
    void take_loops(LoopList loops) { read_ = std::move(loops); }
    // weights: one for each of its loops.  start: values to start from instead of loops, else NULL.
    void solve(const SolveRequest& request, double time_limit, std::vector<double> weights,
               const std::vector<double>* start, const hmf_control* control);

    // --- What came out ---

    // It has no foliation: status and sentence say why.
    void refuse(hmf_status status, const std::string& reason);
    // It has triangles without area, which --repair accepts.
    bool is_mollified() const { return is_mollified_; }
    bool is_refused() const { return !refusal_.empty(); }
    const std::string& refusal() const { return refusal_; }

    const std::string& subject() const { return subject_; }
    const TriangleMesh& mesh() const { return part_.mesh; }
    TriangleMesh& mesh() { return part_.mesh; }
    uint32_t whole_vertex(uint32_t v) const { return alone_ ? v : part_.vertices[v]; }
    uint32_t whole_triangle(uint32_t t) const { return alone_ ? t : part_.triangles[t]; }
    size_t genus() const;
    size_t boundaries() const;
    const std::vector<uint32_t>& marks() const { return marks_; }
    const hmf_design* design() const { return design_.get(); } // of --loops even
    uint64_t edge_count() const { return finest_.edge_count; }
    // log |grad u| of each triangle.
    std::vector<double> log_scale(const hmf_control* control) const;
    // Standard deviation of log_scale over the surface.
    double unevenness() const;

    const hmf_loop_set& loops() const { return loops_; }
    // The loops on the input mesh.
    const hmf_loop_set& fine_loops(const hmf_control* control);
    const hmf_foliation* foliation() const { return foliation_.get(); }
    hmf_status status() const { return status_; }
    const hmf_report& report() const { return *report_; }
    // Why it ended early, with what it is about.
    const std::string& limit() const { return limit_; }
    // Whether the result is as close to the minimum as it says, whatever the method measures on the way.
    bool is_converged() const;
    double build_seconds() const { return build_seconds_; }
    double loops_seconds() const { return loops_seconds_; }
    // In the numbering of level 0, singularities in that of the whole mesh; without the loop weights.  Takes the
    // positions of the mesh.
    Foliation describe();

    const hmf_cylinder_set* find_cylinders(const hmf_control* control);
    const hmf_parameterization* parameterize(const hmf_control* control);
    Owned<hmf_chart_set> make_atlas(const hmf_control* control) const;
    // Where critical leaves and the middle leaves of the cylinders cross the edges of this component.
    Owned<hmf_lines> trace_cylinders(const hmf_control* control) const;
    // (u, v) of each corner for a checkerboard: without seams if that can be.  Needs parameterize.
    std::vector<double> checkerboard_uv(double period) const;
    const hmf_cylinder_set* cylinders() const { return cylinders_.get(); }
    const hmf_parameterization* parameterization() const { return parameterization_.get(); }

    // The fields of the report for a component with these singularities.
    readers::Json json(const std::vector<hmf_singularity>& singular) const;

private:
    Owned<hmf_scale> scale(const hmf_control* control) const;
    Owned<hmf_level_mesh> finest_mesh() const;
    hmf_status try_build(const SolveRequest& request, double mollify, Meter& meter, const hmf_control* control,
                         hmf_error& error);
    hmf_status make_design(bool no_poles, hmf_hierarchy_options options, const hmf_control* control, hmf_error& error);
    // In the words of the file.
    std::string name_of(int32_t element, uint64_t index, bool with_line) const;
    Owned<hmf_loop_set> library_loops(size_t level, const hmf_control* control) const;

    MeshPart part_;
    std::string subject_, refusal_, limit_;
    bool alone_;
    const readers::Origin* origin_;
    int32_t kind_ = 0;
    hmf_status status_ = HMF_OK;
    Owned<hmf_hierarchy> hierarchy_;
    hmf_level_info finest_{};
    std::vector<uint32_t> marks_;
    Owned<hmf_design> design_;
    LoopList read_; // loops of the caller
    Owned<hmf_loop_set> made_, fine_loops_;
    hmf_loop_set loops_{}; // those that were used
    std::vector<double> weights_;
    double tolerance_ = 0; // that was asked for
    bool has_start_ = false, is_mollified_ = false;
    double build_seconds_ = 0, loops_seconds_ = 0;
    Owned<hmf_foliation> foliation_;
    const hmf_report* report_ = nullptr;
    Owned<hmf_cylinder_set> cylinders_;
    Owned<hmf_parameterization> parameterization_;
};

} // namespace cli
