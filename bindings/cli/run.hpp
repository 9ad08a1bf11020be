// One run of hmf solve, from the files it reads to the files it writes.
//
//     run_input.cpp    the mesh, its components, marks, loops, values to start from
//     run.cpp          the order of all, the solve, the result in the numbers of the whole mesh
//     run_outputs.cpp  files, pictures
//     run_report.cpp   the report and what is printed
#pragma once

#include <algorithm>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "component.hpp"
#include "leaves.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "read_loops.hpp"
#include "render.hpp"
#include "solve.hpp"
#include "write_quads.hpp"

namespace cli {

class Run {
public:
    Run(SolveRequest& request, const Options& options);
    // The foliation and the quads; no file is written.
    void make();
    // The files and the report.
    Outcome finish();
    // Between both: whether even loops carry no good quads of the wished size, so that cut loops are worth a try; and
    // whether those are better.
    bool wants_cut_loops() const;
    bool has_quads() const { return !quad_meshes_.empty(); }
    bool has_better_quads_than(const Run& other) const;

private:
    // Input.
    void read();
    void refine();
    void split();
    void build();
    // Gives each marked vertex of the caller to its component.
    void take_marks();
    // Gives each loop of the caller to its component.
    void take_loops();
    void refuse_if_none() const;
    void choose_loops();
    // Those of the file or the design, else all 1; without loops one, for the pictures.
    std::vector<double> own_weights(size_t count) const;
    // The loops on the input mesh.
    hmf_loop_set fine_loops();
    // The values to start from, for each component; one without values has no foliation.
    std::vector<std::vector<double>> start_values();

    // The run.
    void choose_style();
    // The part of the bar from `from` to `to` that belongs to the next triangles.
    const hmf_control* share(const char* label, double from, double to, size_t& done, const Component& c);
    void solve();
    // Everything that the files need, in the numbering of the whole mesh.
    void describe();

    // Outputs.
    void write();
    // Values, history, marks, loops.
    void write_numbers();
    void make_quad_meshes();
    // How many quads the loops need at least; says so, before these are made, if that is far more than are wished.
    void count_fewest();
    bool is_far_above(size_t quads) const; // the wished number
    void write_quad_meshes();
    void write_leaf_lines();
    // (u, v) of each corner of the whole mesh, for all outputs that need it; NULL: of none, or not needed.
    const double* unfold(bool wants_uv);
    void make_atlas();
    // Each component has a square of its own in a grid.
    void write_atlas(const std::vector<std::pair<const Component*, Owned<hmf_chart_set>>>& made);
    void draw(const double* uv, double period);
    // The weights of the classes of the values, where they can be found; elsewhere stripes may not match.
    void find_weights();
    // (u, v) of each corner of the whole mesh; NULL: of none.
    const double* corner_uv();
    const double* dilatation();
    // As corner_uv, for a checkerboard.
    std::vector<double> checkerboard_uv(double period) const;
    // A period for stripes and squares, and where the weights have none in common, values that have.
    double choose_period();
    // Of several components each gets quads by its area.
    hmf_quad_options quad_wish(const Component& c) const;
    // log |grad u| of each triangle of the whole mesh.
    std::vector<double> log_scale() const;
    bool shows_uv() const { return style_.pattern == Pattern::checkerboard || style_.pattern == Pattern::dilatation; }
    // An output that fails does not take the others with it.  unfit: takes the sentence where the mesh is the reason.
    template <class Work>
    void attempt(const char* option, bool wanted, const Work& work, std::vector<std::string>* unfit = nullptr) {
        if (!wanted) return;
        ExitStatus status = EXIT_RESOURCES;
        try {
            work();
            return;
        } catch (const Failure& failure) {
            // The command was right: only this mesh shows that it cannot be.
            status = failure.exit_status == EXIT_USAGE ? EXIT_BAD_INPUT : failure.exit_status;
            const std::string sentence = std::string(option) + ": " + failure.what();
            if (unfit && status == EXIT_BAD_INPUT) return unfit->push_back(sentence);
            outcome_.errors.push_back(sentence);
            if (was_interrupted()) progress_.finish_quietly(); // only the output that was being made is given up
        } catch (const std::bad_alloc&) { outcome_.errors.push_back(std::string(option) + ": out of memory"); }
        if (outcome_.exit_status == EXIT_SOLVED || outcome_.exit_status == EXIT_LIMIT) outcome_.exit_status = status;
    }
    // For each component with a foliation.  Where some cannot have the output, the others get it, and it is a note.
    template <class Work>
    void attempt_each(const char* option, bool wanted, const Work& work) {
        std::vector<std::string> unfit;
        size_t tried = 0;
        for (Component& c : components_) {
            if (c.is_refused()) continue;
            ++tried;
            attempt(
                option, wanted, [&] { work(c); }, &unfit);
        }
        if (unfit.empty()) return;
        const bool none = unfit.size() == tried;
        std::vector<std::string>& said = none ? outcome_.errors : outcome_.notes;
        said.insert(said.end(), unfit.begin(), unfit.end());
        if (!none) return;
        if (outcome_.exit_status == EXIT_SOLVED || outcome_.exit_status == EXIT_LIMIT)
            outcome_.exit_status = EXIT_BAD_INPUT;
    }
    template <class Of>
    const double* of_triangles(std::vector<double>& all, size_t width, const Of& of) {
        if (is_alone()) {
            const hmf_parameterization* const p = components_[0].parameterization();
            return p ? of(*p) : nullptr;
        }
        for (const Component& c : components_) {
            if (!c.parameterization()) continue;
            all.resize(width * f_.triangle_count());
            for (uint32_t t = 0; t < c.parameterization()->triangle_count; ++t)
                std::copy_n(of(*c.parameterization()) + width * t, width, &all[width * c.whole_triangle(t)]);
        }
        return all.empty() ? nullptr : all.data();
    }

    // Report.
    void report();
    std::string area_sentence() const;
    std::string design_sentence() const;
    readers::Json report_json(double seconds) const;
    // Sums over the components, then their own reports.
    void add_totals(readers::Json& report) const;

    size_t solved_count() const;

    bool is_alone() const { return components_.size() == 1; }

    SolveRequest& r_;
    const Options& options_;
    const Clock::time_point begin_ = Clock::now();
    const std::string name_ = shown(r_.mesh);
    const bool has_start_ = !r_.start.empty();
    const int32_t kind_;
    Outcome outcome_;
    Progress progress_;
    const hmf_control* control_ = nullptr;
    Meter meter_;            // lives longer than all that the library made
    TriangleMesh mesh_;      // of several components, until it is described
    readers::Origin origin_; // of mesh_
    std::vector<std::string> repairs_, warnings_;
    LoopList read_;               // loops of the caller
    std::vector<uint32_t> marks_; // in the whole mesh
    size_t tipped_ = 0;           // components with marks that the library chose
    bool has_tips_ = false;       // some of them at tips
    std::vector<Component> components_;
    std::vector<std::vector<size_t>> loop_numbers_; // of the loops of each component, among all
    size_t loop_count_ = 0;
    bool weights_given_ = false;
    Foliation f_;
    std::vector<std::vector<hmf_singularity>> singular_; // of each component
    std::vector<std::vector<uint32_t>> whole_edges_;     // of the edges of each of several components
    std::vector<double> uv_, dilatation_;                // of several components
    PictureStyle style_;
    struct {
        size_t charts = 0;
        double used = 0, seams = 0; // part of the square; length in space
        uint64_t collapsed = 0;
    } atlas_; // written
    std::vector<Owned<hmf_quad_mesh>> quad_meshes_;
    size_t leaves_ = 0, quads_ = 0;                               // written
    size_t irregular_ = 0, inverted_ = 0;                         // vertices, quads
    double quad_area_ = 0, covered_area_ = 0, quad_distance_ = 0; // of the quads, of their surface; the greatest
    size_t fewest_ = 0;        // quads where as few as possible are wished; 0: about as many as are wished, or fewer
    bool has_doubled_ = false; // as few quads as are wished were refused
};

} // namespace cli
