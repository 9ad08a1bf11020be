#include "component.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "../readers/components.hpp"
#include "closed_pattern.hpp"
#include "marks.hpp"

namespace cli {

using readers::Json;

namespace {

const char* method_name(int32_t method) {
    switch (method) {
    case HMF_METHOD_NEWTON: return "newton";
    case HMF_METHOD_WHITEHEAD: return "whitehead";
    case HMF_METHOD_SINGLE_LEVEL: return "single-level";
    case HMF_METHOD_PAPER: return "paper";
    default: return "default";
    }
}

} // namespace

const char* class_name(int32_t state) {
    switch (state) {
    case HMF_CLASS_PROVEN: return "proven";
    case HMF_CLASS_LOST: return "lost";
    default: return "unknown";
    }
}

int32_t less_sure(int32_t a, int32_t b) {
    for (const int32_t state : {HMF_CLASS_LOST, HMF_CLASS_UNKNOWN})
        if (a == state || b == state) return state;
    return HMF_CLASS_PROVEN;
}

bool Component::is_converged() const {
    return report_->converged != 0 && report_->residual_max >= 0
        && report_->residual_max <= (tolerance_ > 0 ? tolerance_ : 1e-8);
}

void Component::refuse(hmf_status status, const std::string& reason) {
    status_ = status;
    refusal_ = subject_ + ": " + reason;
}

hmf_status Component::try_build(const SolveRequest& request, double mollify, Meter& meter, const hmf_control* control,
                                hmf_error& error) {
    hmf_hierarchy_options options;
    hmf_hierarchy_options_init(&options, sizeof options);
    options.ratio = request.ratio;
    options.mollify = mollify;
    options.coarsest = request.coarsest;
    options.collapse = request.collapse;
    options.allocate = Meter::allocate;
    options.release = Meter::release;
    options.allocator_user = &meter;
    hmf_status status = HMF_OK;
    if (request.loops == "even") status = make_design(request.marks == "none", options, control, error);
    else if (request.marks == "auto") status = suggest_marks(part_.mesh, options, control, marks_, error);
    options.marked_vertices = marks_.data();
    options.marked_count = marks_.size();
    hmf_hierarchy* raw = nullptr;
    if (status == HMF_OK)
        status =
            hmf_hierarchy_create(part_.mesh.positions.data(), part_.mesh.vertex_count(), part_.mesh.triangles.data(),
                                 part_.mesh.triangle_count(), &options, control, &raw, &error);
    hierarchy_.reset(raw);
    return status;
}

void Component::build(const SolveRequest& request, Meter& meter, const hmf_control* control) {
    const Clock::time_point start = Clock::now();
    hmf_error error{};
    hmf_status status = try_build(request, request.mollify, meter, control, error);
    is_mollified_ = status == HMF_ERROR_MESH_DEGENERATE && request.prepare.repairs && request.mollify <= 0;
    if (is_mollified_) status = try_build(request, MOLLIFY_OF_REPAIR, meter, control, error);
    // A sheet may be one of many that only have to be joined.
    const bool is_sheet = status == HMF_ERROR_MESH_GENUS && readers::boundary_count(part_.mesh) > 0;
    const std::string advice = repair_advice(is_sheet ? HMF_ERROR_MESH_BOUNDARY : status, request.prepare.repairs,
                                             request.prepare.joins.has_value());
    build_seconds_ = seconds_since(start);
    const bool concerns_component = (status >= 300 && status < 400) || status == HMF_ERROR_UNSUPPORTED;
    const auto naming = [this](int32_t element, uint64_t index, bool with_line) {
        return name_of(element, index, with_line);
    };
    if (status != HMF_OK && (alone_ || !concerns_component)) fail_with(status, error, subject_, advice, naming);
    if (status == HMF_ERROR_UNSUPPORTED) return refuse(status, "no loops were found for an even design of it");
    if (status != HMF_OK) {
        // The sentence of the library has the numbers of this component.
        std::string reason = hmf_status_string(status);
        if (error.element == HMF_ELEMENT_TRIANGLE || error.element == HMF_ELEMENT_VERTEX)
            reason += " (" + name_of(error.element, error.index, true) + ")";
        if (status == HMF_ERROR_MESH_GENUS)
            reason += request.marks == "auto" ? "; there are too few vertices to mark"
                                              : "; --marks auto marks vertices of a sphere";
        return refuse(status, reason + advice);
    }
    finest_ = hmf_hierarchy_describe(hierarchy_.get())->levels[0];
}

std::string Component::name_of(int32_t element, uint64_t index, bool with_line) const {
    const uint32_t own = static_cast<uint32_t>(index);
    return element == HMF_ELEMENT_TRIANGLE ? origin_->name_of_triangle(whole_triangle(own), with_line)
                                           : origin_->name_of_vertex(whole_vertex(own), with_line);
}

hmf_status Component::make_design(bool no_poles, hmf_hierarchy_options options, const hmf_control* control,
                                  hmf_error& error) {
    options.marked_vertices = marks_.data();
    options.marked_count = marks_.size();
    hmf_design_options of_design;
    hmf_design_options_init(&of_design, sizeof of_design);
    of_design.build = &options;
    of_design.no_poles = no_poles;
    hmf_design* raw = nullptr;
    const hmf_status status =
        hmf_even_design(part_.mesh.positions.data(), part_.mesh.vertex_count(), part_.mesh.triangles.data(),
                        part_.mesh.triangle_count(), &of_design, control, &raw, &error);
    design_.reset(raw);
    if (design_) marks_.assign(raw->marked_vertices, raw->marked_vertices + raw->marked_count);
    return status;
}

Owned<hmf_scale> Component::scale(const hmf_control* control) const {
    return make<hmf_scale>(subject_, [&](hmf_scale** out, hmf_error* error) {
        return hmf_conformal_scale(foliation_.get(), control, out, error);
    });
}

std::vector<double> Component::log_scale(const hmf_control* control) const {
    const Owned<hmf_scale> made = scale(control);
    return {made->log_scale, made->log_scale + made->triangle_count};
}

double Component::unevenness() const { return scale(nullptr)->unevenness; }

Owned<hmf_level_mesh> Component::finest_mesh() const {
    return make<hmf_level_mesh>(subject_, [&](hmf_level_mesh** out, hmf_error* error) {
        return hmf_level(hierarchy_.get(), 0, nullptr, out, error);
    });
}

size_t Component::genus() const { return hmf_hierarchy_describe(hierarchy_.get())->genus; }

size_t Component::boundaries() const { return hmf_hierarchy_describe(hierarchy_.get())->boundary_count; }

void Component::make_loops(int32_t kind, bool fine, const hmf_control* control) {
    // Loops of the caller are drawn on the input mesh, and the single-level method knows no other; the library's
    // own are cheapest where it is coarse.
    const Clock::time_point start = Clock::now();
    kind_ = kind;
    if (kind == LOOPS_EVEN) {
        loops_ = *design_->loops;
        return;
    }
    try {
        made_ = library_loops(fine || boundaries() > 0 ? 0 : hmf_hierarchy_describe(hierarchy_.get())->level_count - 1,
                              control);
        loops_ = *made_;
    } catch (const Failure& failure) {
        if (alone_ || failure.exit_status != EXIT_BAD_INPUT) throw;
        refuse(boundaries() > 0 ? HMF_ERROR_MESH_BOUNDARY
               : genus() == 0   ? HMF_ERROR_MESH_GENUS
                                : HMF_ERROR_MESH_NOT_EMBEDDED,
               std::string(failure.what()).substr(subject_.size() + 2));
    }
    loops_seconds_ = seconds_since(start);
}

Owned<hmf_loop_set> Component::library_loops(size_t level, const hmf_control* control) const {
    return make<hmf_loop_set>(subject_, [&](hmf_loop_set** out, hmf_error* error) {
        return hmf_loops(hierarchy_.get(), level, kind_, control, out, error);
    });
}

const hmf_loop_set& Component::fine_loops(const hmf_control* control) {
    if (loops_.level == 0) return loops_;
    if (!fine_loops_) fine_loops_ = library_loops(0, control);
    return *fine_loops_;
}

void Component::solve(const SolveRequest& request, double time_limit, std::vector<double> weights,
                      const std::vector<double>* start_values, const hmf_control* control) {
    hmf_solve_options options;
    hmf_solve_options_init(&options, sizeof options);
    options.method = request.method;
    options.tolerance = tolerance_ = request.tolerance;
    options.time_limit = time_limit;
    has_start_ = start_values != nullptr;
    Owned<hmf_foliation> start;
    if (has_start_)
        start = make<hmf_foliation>(shown(request.start), [&](hmf_foliation** out, hmf_error* e) {
            return hmf_foliation_from_values(hierarchy_.get(), 0, start_values->data(), start_values->size(), nullptr,
                                             out, e);
        });
    options.start = start.get();
    if (read_.count() > 0) loops_ = read_.view();
    weights_ = std::move(weights);
    loops_.weights = weights_.data();
    hmf_foliation* raw = nullptr;
    hmf_error error{};
    status_ = hmf_solve(hierarchy_.get(), has_start_ ? nullptr : &loops_, &options, control, &raw, &error);
    foliation_.reset(raw);
    const bool of_line =
        error.status == status_ && error.element == HMF_ELEMENT_LOOP && error.index < read_.lines.size();
    const std::string line = of_line ? request.name_of_loop(read_.lines[error.index]) : "";
    if (status_ >= HMF_ERROR_NULL) {
        if (of_line) fail_with(status_, error, line);
        if (!alone_ && status_ == HMF_ERROR_UNSUPPORTED) return refuse(status_, hmf_status_string(status_));
        fail_with(status_, error, has_start_ && status_ >= 500 && status_ < 600 ? shown(request.start) : subject_);
    }
    report_ = hmf_foliation_report(foliation_.get());
    if (!report_) fail_with(HMF_CANCELLED, error, subject_);
    if (status_ == HMF_OK) return;
    limit_ = (of_line ? line : subject_) + ": " + limit_sentence(status_, error);
    if (report_->class_state == HMF_CLASS_LOST) limit_ += "; it is not in the class of the loops";
}

Foliation Component::describe() {
    Foliation f;
    size_t count = 0;
    const double* const values = hmf_foliation_values(foliation_.get(), &count);
    f.values.assign(values, values + count);
    const Owned<hmf_level_mesh> mesh = finest_mesh();
    f.triangles.assign(mesh->triangle_vertices, mesh->triangle_vertices + 3 * mesh->triangle_count);
    f.triangle_edges.assign(mesh->triangle_edges, mesh->triangle_edges + 3 * mesh->triangle_count);
    f.edge_vertices.assign(mesh->edge_vertices, mesh->edge_vertices + 2 * mesh->edge_count);
    const auto singular = make<hmf_singularity_set>(subject_, [&](hmf_singularity_set** out, hmf_error* e) {
        return hmf_singularities(foliation_.get(), nullptr, out, e);
    });
    f.singular.assign(singular->list, singular->list + singular->count);
    for (hmf_singularity& s : f.singular)
        s.element = s.kind == HMF_SINGULAR_TRIANGLE ? whole_triangle(s.element) : whole_vertex(s.element);
    f.positions = std::move(part_.mesh.positions);
    return f;
}

const hmf_cylinder_set* Component::find_cylinders(const hmf_control* control) {
    if (!cylinders_)
        cylinders_ = make<hmf_cylinder_set>(subject_, [&](hmf_cylinder_set** out, hmf_error* error) {
            return hmf_cylinders(foliation_.get(), has_start_ ? nullptr : &loops_, control, out, error);
        });
    return cylinders_.get();
}

Owned<hmf_lines> Component::trace_cylinders(const hmf_control* control) const {
    hmf_trace_options options;
    hmf_trace_options_init(&options, sizeof options);
    options.critical = 1;
    options.spacing = 1e300; // one level set in each, in the middle
    return make<hmf_lines>(subject_, [&](hmf_lines** out, hmf_error* error) {
        return hmf_trace(foliation_.get(), &options, control, out, error);
    });
}

const hmf_parameterization* Component::parameterize(const hmf_control* control) {
    if (parameterization_) return parameterization_.get();
    parameterization_ = make<hmf_parameterization>(subject_, [&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(foliation_.get(), nullptr, control, out, error);
    });
    return parameterization_.get();
}

Owned<hmf_chart_set> Component::make_atlas(const hmf_control* control) const {
    return make<hmf_chart_set>(subject_, [&](hmf_chart_set** out, hmf_error* error) {
        return hmf_atlas(foliation_.get(), nullptr, control, out, error);
    });
}

std::vector<double> Component::checkerboard_uv(double period) const {
    const Owned<hmf_level_mesh> mesh = finest_mesh();
    const size_t sides = 3 * mesh->triangle_count;
    const std::vector<uint32_t> triangles(mesh->triangle_vertices, mesh->triangle_vertices + sides);
    const std::vector<uint32_t> edges(mesh->triangle_edges, mesh->triangle_edges + sides);
    std::vector<double> closed = closed_pattern(triangles, edges, *parameterization_, period);
    if (closed.empty())
        closed.assign(parameterization_->corner_uv, parameterization_->corner_uv + 2 * triangles.size());
    return closed;
}

Json Component::json(const std::vector<hmf_singularity>& singularities) const {
    if (is_refused()) {
        const readers::TriangleMesh& mesh = part_.mesh;
        const size_t edges = readers::edges_of(mesh).count(), boundaries = readers::boundary_count(mesh);
        Json counts = {{"vertices", mesh.vertex_count()},
                       {"edges", edges},
                       {"triangles", mesh.triangle_count()},
                       {"boundaries", boundaries}};
        if (status_ == HMF_ERROR_MESH_GENUS) counts.set("genus", 0);
        return {{"mesh", counts}, {"class", "none"}, {"status", status_}, {"message", refusal_}};
    }
    const hmf_report& r = *report_;
    Json::Array levels, singular;
    for (uint64_t k = 0; k < r.level_count; ++k) {
        const hmf_level_report& level = r.levels[k];
        levels.push_back(Json{{"vertices", level.vertex_count},
                              {"edges", level.edge_count},
                              {"nld", level.raised_count},
                              {"raised_count", level.raised_count},
                              {"sweeps", level.sweep_count},
                              {"linear_solves", level.linear_solve_count},
                              {"optimize_seconds", level.optimize_seconds},
                              {"interpolate_seconds", level.interpolate_seconds}});
    }
    static const char* const kinds[] = {"", "vertex", "triangle", "cluster"};
    for (const hmf_singularity& s : singularities)
        singular.push_back(Json{{"kind", kinds[s.kind & 3]},
                                {"index", s.index},
                                {"element", s.element},
                                {"size", s.size},
                                {"position", std::vector<double>(s.position, s.position + 3)}});
    // The library counts those of the double of a surface with boundary.
    uint64_t zeros = r.zeros, poles = r.poles;
    int64_t index_sum = r.index_sum;
    if (boundaries() > 0) {
        zeros = poles = 0;
        index_sum = 0;
        for (const hmf_singularity& s : singularities) {
            index_sum += s.index;
            (s.index < 0 ? zeros : poles) += static_cast<uint64_t>(std::abs(s.index));
        }
    }
    Json report = {{"mesh", Json{{"vertices", finest_.vertex_count},
                                 {"edges", finest_.edge_count},
                                 {"triangles", finest_.triangle_count},
                                 {"genus", genus()},
                                 {"marked", marks_.size()},
                                 {"boundaries", boundaries()}}},
                   {"method", method_name(r.method)},
                   {"class", class_name(r.class_state)},
                   {"class_repeats", r.class_repeats},
                   {"class_seconds", r.class_seconds},
                   {"levels", levels},
                   {"loops", loops_.count},
                   {"build_seconds", build_seconds_},
                   {"loops_seconds", loops_seconds_},
                   {"solve_seconds", r.solve_seconds},
                   {"energy", r.energy},
                   {"unevenness", unevenness()},
                   {"residual_max", r.residual_max},
                   {"residual_mean", r.residual_mean},
                   {"poles", poles},
                   {"zeros", zeros},
                   {"index_sum", index_sum},
                   {"singularities", singular},
                   {"bad_flips", r.bad_flips},
                   {"bad_flips_left", r.bad_flips_left},
                   {"converged", is_converged()}};
    if (parameterization_) {
        const hmf_parameterization& p = *parameterization_;
        report.set("dilatation_mean", p.dilatation_mean);
        report.set("dilatation_median", p.dilatation_median);
        // Not finite where more than a hundredth of the area is degenerate.
        report.set("dilatation_p99", std::isfinite(p.dilatation_p99) ? Json(p.dilatation_p99) : Json());
        report.set("flipped_count", p.flipped_count);
        report.set("degenerate_count", p.degenerate_count);
        report.set("seam_edges", p.seam_edge_count);
        report.set("seam_length", p.seam_length);
        report.set("parameterize_seconds", p.seconds);
    }
    if (cylinders_) {
        Json::Array cylinders;
        for (uint64_t k = 0; k < cylinders_->count; ++k) {
            const hmf_cylinder& c = cylinders_->list[k];
            const double twist = cylinders_->twists[k];
            cylinders.push_back(Json{{"loop", c.loop == HMF_NONE ? Json() : Json(c.loop)},
                                     {"height", c.height},
                                     {"circumference", c.circumference},
                                     {"modulus", c.modulus},
                                     {"area", c.area},
                                     {"twist", std::isnan(twist) ? Json() : Json(twist)}});
        }
        report.set("cylinders", cylinders);
    }
    return report;
}

} // namespace cli
