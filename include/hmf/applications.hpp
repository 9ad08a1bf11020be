/*
 * applications.hpp - applications.h as C++17 functions: loops, and what follows from a foliation
 *
 *     const hmf::Solution solution = hmf::solve_cut_system(hierarchy);
 *     const hmf::Parameterization map = hmf::parameterize(solution.foliation);
 *     map.corner_uv();                       // an array, valid as long as map
 *     map->dilatation_mean;                  // a number
 *
 * The rules are those of hmf.hpp; applications.h is the manual.
 */
#ifndef HMF_APPLICATIONS_HPP
#define HMF_APPLICATIONS_HPP

#include <hmf/applications.h>
#include <hmf/hmf.hpp>

#include <optional>

namespace hmf {
inline namespace cpp {

/* hmf_loops, with weights 1; kind: HMF_LOOPS_* */
inline Loops loops(const Hierarchy& hierarchy, std::size_t level, hmf_loops_kind kind = HMF_LOOPS_CUT,
                   const ProgressFunction& progress = nullptr) {
    return detail::own(*detail::make<hmf_loop_set>(progress, hmf_loops, hierarchy.get(), level, kind));
}

/* hmf_solve_cut_system */
inline Solution solve_cut_system(const Hierarchy& hierarchy, const SolveOptions& options = {},
                                 const ProgressFunction& progress = nullptr) {
    return detail::solve(options, progress, hmf_solve_cut_system, hierarchy.get());
}

/* hmf_suggest_marks */
inline std::vector<uint32_t> suggest_marks(Span<double> positions, Span<uint32_t> triangles,
                                           const BuildOptions& options = {},
                                           const ProgressFunction& progress = nullptr) {
    const auto set = detail::make_of_mesh<hmf_mark_set>(progress, hmf_suggest_marks, positions, triangles,
                                                        detail::raw(options));
    return {set->marked_vertices, set->marked_vertices + set->marked_count};
}

struct DesignOptions {
    BuildOptions build; /* its marked vertices become part of the design */
    bool no_poles = false;
    uint64_t solve_limit = 0;
};

class Design : public Result<hmf_design> {
public:
    using Result::Result;
    Span<uint32_t> marked_vertices() const noexcept { return span(get()->marked_vertices, get()->marked_count); }
    Loops loops() const { return detail::own(*get()->loops); } /* of level 0 */
};

/* hmf_even_design: marked vertices for the options of a hierarchy, and loops to solve for on it. */
inline Design even_design(Span<double> positions, Span<uint32_t> triangles, const DesignOptions& options = {},
                          const ProgressFunction& progress = nullptr) {
    const hmf_hierarchy_options build = detail::raw(options.build);
    Options<hmf_design_options, hmf_design_options_init> all;
    all.no_poles = options.no_poles;
    all.build = &build;
    all.solve_limit = options.solve_limit;
    return Design(detail::make_of_mesh<hmf_design>(progress, hmf_even_design, positions, triangles, all));
}

class ConformalScale : public Result<hmf_scale> {
public:
    using Result::Result;
    Span<double> log_scale() const noexcept { return span(get()->log_scale, get()->triangle_count); }
};

/* hmf_conformal_scale */
inline ConformalScale conformal_scale(const Foliation& foliation, const ProgressFunction& progress = nullptr) {
    return ConformalScale(detail::make<hmf_scale>(progress, hmf_conformal_scale, foliation.get()));
}

class HarmonicForms : public Result<hmf_form_set> {
public:
    using Result::Result;
    Span<double> form(std::size_t i) const noexcept { /* edge_count */
        return span(get()->values + i * get()->edge_count, get()->edge_count);
    }
    Span<int32_t> intersections() const noexcept { return matrix(get()->intersections, get()->form_count); }
    Span<double> inner_products() const noexcept { return matrix(get()->inner_products, get()->form_count); }
    Span<double> conjugation() const noexcept { return matrix(get()->conjugation, get()->form_count); }
    Span<double> period_real() const noexcept { return matrix(get()->period_real, get()->genus); }
    Span<double> period_imaginary() const noexcept { return matrix(get()->period_imaginary, get()->genus); }

private:
    template <class E>
    static Span<E> matrix(const E* data, uint64_t n) noexcept {
        return span(data, n * n);
    }
};

/* hmf_harmonic_forms */
inline HarmonicForms harmonic_forms(const Hierarchy& hierarchy, std::size_t level = 0,
                                    const ProgressFunction& progress = nullptr) {
    return HarmonicForms(detail::make<hmf_form_set>(progress, hmf_harmonic_forms, hierarchy.get(), level));
}

/* hmf_parameterize_options; zero means the default. */
struct ParameterizeOptions {
    double tolerance = 0;
    std::vector<uint32_t> seam_edges; /* edges where seams cost nothing */
};

class Parameterization : public Result<hmf_parameterization> {
public:
    using Result::Result;
    Span<double> corner_uv() const noexcept { return span(get()->corner_uv, 6 * get()->triangle_count); }
    Span<double> transition() const noexcept { return span(get()->transition, 3 * get()->edge_count); }
    Span<uint8_t> seam() const noexcept { return span(get()->seam, get()->edge_count); }
    Span<int32_t> cone() const noexcept { return span(get()->cone, get()->vertex_count); }
    Span<double> dilatation() const noexcept { return span(get()->dilatation, get()->triangle_count); }
    Span<double> differential() const noexcept { return span(get()->differential, 2 * get()->triangle_count); }
};

/* hmf_parameterize */
inline Parameterization parameterize(const Foliation& foliation, const ParameterizeOptions& options = {},
                                     const ProgressFunction& progress = nullptr) {
    Options<hmf_parameterize_options, hmf_parameterize_options_init> all;
    all.tolerance = options.tolerance;
    all.seam_edges = options.seam_edges.data();
    all.seam_edge_count = options.seam_edges.size();
    return Parameterization(detail::make<hmf_parameterization>(progress, hmf_parameterize, foliation.get(), &all));
}

using Line = hmf_line;

/* hmf_trace_options; zero means the default. */
struct TraceOptions {
    bool critical = false;
    double spacing = 0;
    double length_limit = 0;
    std::vector<uint32_t> point_triangles;  /* point_count */
    std::vector<double> point_barycentrics; /* point_count x 3 */
    hmf_leaves_kind leaves = HMF_LEAVES_DEFAULT;
};

class Leaves : public Result<hmf_lines> {
public:
    using Result::Result;
    Span<Line> lines() const noexcept { return span(get()->lines, get()->line_count); }
    Span<uint64_t> offsets() const noexcept { return span(get()->offsets, get()->line_count + 1); }
    Span<double> points() const noexcept { return span(get()->points, 3 * get()->point_count); }
    Span<uint32_t> point_edges() const noexcept { return span(get()->point_edges, get()->point_count); }
};

/* hmf_trace */
inline Leaves trace(const Foliation& foliation, const TraceOptions& options = {},
                    const ProgressFunction& progress = nullptr) {
    if (options.point_barycentrics.size() != 3 * options.point_triangles.size())
        throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                    "There are " + std::to_string(options.point_barycentrics.size()) + " barycentric coordinates for "
                        + std::to_string(options.point_triangles.size()) + " points. Give three for each.");
    Options<hmf_trace_options, hmf_trace_options_init> all;
    all.critical = options.critical;
    all.spacing = options.spacing;
    all.length_limit = options.length_limit;
    all.point_count = options.point_triangles.size();
    all.point_triangles = options.point_triangles.data();
    all.point_barycentrics = options.point_barycentrics.data();
    all.leaves = options.leaves;
    return Leaves(detail::make<hmf_lines>(progress, hmf_trace, foliation.get(), &all));
}

using Cylinder = hmf_cylinder;

class Cylinders : public Result<hmf_cylinder_set> {
public:
    using Result::Result;
    Span<Cylinder> list() const noexcept { return span(get()->list, get()->count); }
    /* The leaf in the middle of each cylinder as a triangle loop, with the heights as weights. */
    Loops leaves() const { return detail::own(*get()->leaves); }
    Span<double> twists() const noexcept { return span(get()->twists, get()->count); }
    Span<uint64_t> corner_offsets() const noexcept { return span(get()->corner_offsets, 2 * get()->count + 1); }
    Span<uint32_t> corner_vertices() const noexcept { return span(get()->corner_vertices, corner_count()); }
    Span<double> corner_places() const noexcept { return span(get()->corner_places, corner_count()); }

private:
    uint64_t corner_count() const noexcept { return get()->corner_offsets[2 * get()->count]; }
};

/* hmf_cylinders, without their loops. */
inline Cylinders cylinders(const Foliation& foliation, const ProgressFunction& progress = nullptr) {
    const hmf_loop_set* const none = nullptr;
    return Cylinders(detail::make<hmf_cylinder_set>(progress, hmf_cylinders, foliation.get(), none));
}

/* hmf_cylinders; loops: the loops of the foliation. */
inline Cylinders cylinders(const Foliation& foliation, const Loops& loops, const ProgressFunction& progress = nullptr) {
    const hmf_loop_set set = detail::raw(loops);
    return Cylinders(detail::make<hmf_cylinder_set>(progress, hmf_cylinders, foliation.get(), &set));
}

class QuadMesh : public Result<hmf_quad_mesh> {
public:
    using Result::Result;
    Span<double> positions() const noexcept { return span(get()->positions, 3 * get()->vertex_count); }
    Span<uint32_t> quads() const noexcept { return span(get()->quads, 4 * get()->quad_count); }
};

/* hmf_quads; struct_size is set here */
inline QuadMesh quads(const Foliation& foliation, hmf_quad_options options,
                      const ProgressFunction& progress = nullptr) {
    options.struct_size = sizeof options;
    return QuadMesh(detail::make<hmf_quad_mesh>(progress, hmf_quads, foliation.get(), &options));
}

/* edge_length 0: half as many quads as triangles */
inline QuadMesh quads(const Foliation& foliation, double edge_length = 0, const ProgressFunction& progress = nullptr) {
    Options<hmf_quad_options, hmf_quad_options_init> options;
    options.edge_length = edge_length;
    return quads(foliation, options, progress);
}

class Atlas : public Result<hmf_chart_set> {
public:
    using Result::Result;
    Span<double> corner_uv() const noexcept { return span(get()->corner_uv, 6 * get()->triangle_count); }
    Span<uint32_t> triangle_chart() const noexcept { return span(get()->triangle_chart, get()->triangle_count); }
};

/* hmf_atlas; margin 0: 1/512 of the side of the square */
inline Atlas atlas(const Foliation& foliation, double margin = 0, const ProgressFunction& progress = nullptr) {
    Options<hmf_atlas_options, hmf_atlas_options_init> options;
    options.margin = margin;
    return Atlas(detail::make<hmf_chart_set>(progress, hmf_atlas, foliation.get(), &options));
}

/* ------------------------------------------------------------------------
 * Several components
 * --------------------------------------------------------------------- */

/* One component of ComponentSolutions. */
struct ComponentSolution {
    hmf_status status;                /* status of the solution, or why there is none */
    std::string message;              /* likewise; empty with HMF_OK */
    std::optional<Solution> solution; /* of this component alone */
};

/* One foliation over all components. */
struct ComponentSolutions {
    std::vector<double> values; /* one for each edge of the whole mesh; 0 where a component has none */
    std::vector<ComponentSolution> components;
};

/* Result of hmf_components. */
class Components : public Result<hmf_component_set> {
public:
    /* The options: mollify, marked vertices (of the whole mesh), memory. */
    Components(Span<double> positions, Span<uint32_t> triangles, const BuildOptions& options = {},
               const ProgressFunction& progress = nullptr) :
        Result(detail::make_of_mesh<hmf_component_set>(progress, hmf_components, positions, triangles,
                                                       detail::raw(options))) {}

    std::size_t size() const noexcept { return static_cast<std::size_t>(get()->count); }
    const hmf_component& operator[](std::size_t k) const noexcept { return get()->list[k]; }

    /* Component k in its own numbering, for a Hierarchy. */
    Span<double> positions(std::size_t k) const noexcept {
        return span(get()->part_positions + 3 * (*this)[k].first_vertex, 3 * (*this)[k].vertex_count);
    }
    Span<uint32_t> triangles(std::size_t k) const noexcept {
        return span(get()->part_triangles + 3 * (*this)[k].first_triangle, 3 * (*this)[k].triangle_count);
    }
    Span<uint32_t> marked_vertices(std::size_t k) const noexcept {
        return span(get()->part_marks + (*this)[k].first_mark, (*this)[k].marked_count);
    }
    /* Its numbers in the whole mesh. */
    Span<uint32_t> whole_vertices(std::size_t k) const noexcept {
        return span(get()->whole_vertices + (*this)[k].first_vertex, (*this)[k].vertex_count);
    }
    Span<uint32_t> whole_edges(std::size_t k) const noexcept {
        return span(get()->whole_edges + (*this)[k].first_edge, (*this)[k].edge_count);
    }
    Span<uint32_t> whole_triangles(std::size_t k) const noexcept {
        return span(get()->whole_triangles + (*this)[k].first_triangle, (*this)[k].triangle_count);
    }

    /* Divides loops of the whole mesh (level 0) among the components, in their numbering.  Throws
   HMF_ERROR_LOOP_INDEX if an element does not exist, HMF_ERROR_LOOP_NOT_CLOSED if a loop lies on
   several components. */
    std::vector<Loops> split(const Loops& whole) const {
        const bool triangles = whole.kind == HMF_PATH_TRIANGLES;
        const uint32_t* const component = triangles ? get()->triangle_component : get()->vertex_component;
        const uint32_t* const number = triangles ? get()->triangle_part : get()->vertex_part;
        const uint64_t count = triangles ? get()->triangle_count : get()->vertex_count;
        std::vector<Loops> parts(size());
        for (Loops& own : parts) own.kind = whole.kind;
        for (std::size_t c = 0; c < whole.size(); ++c) {
            std::vector<uint32_t> elements;
            uint32_t on = HMF_NONE;
            for (const uint32_t element : whole[c]) {
                const uint32_t k = element < count ? component[element] : HMF_NONE;
                const std::string loop = "Loop " + std::to_string(c);
                if (k == HMF_NONE)
                    throw Error(HMF_ERROR_LOOP_INDEX, HMF_ELEMENT_LOOP, c,
                                loop + " names element " + std::to_string(element) + ", which no component has.");
                if (on != HMF_NONE && k != on)
                    throw Error(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                                loop + " lies on the components " + std::to_string(on) + " and " + std::to_string(k)
                                    + ". Give a loop on one of them.");
                on = k;
                elements.push_back(number[element]);
            }
            if (on == HMF_NONE) continue;
            Loops& own = parts[on];
            own.add(elements, whole.weights[c], !whole.arcs.empty() && whole.arcs[c]);
            if (whole.arc_sides.empty()) continue;
            own.arc_sides.resize(2 * own.size() - 2, HMF_NONE);
            own.arc_sides.insert(own.arc_sides.end(), &whole.arc_sides[2 * c], &whole.arc_sides[2 * c] + 2);
        }
        return parts;
    }

    /* Solves each component, with loops of the library or of the whole mesh.  options: as for a
   Hierarchy, except for marked vertices, which are those of the constructor; start and
   stop_level are ignored.  Errors of one component or its loops are in its row; other failures
   are thrown. */
    ComponentSolutions solve(const BuildOptions& build = {}, const SolveOptions& options = {},
                             const ProgressFunction& progress = nullptr) const {
        return solve_each(nullptr, build, options, progress);
    }
    ComponentSolutions solve(const Loops& loops, const BuildOptions& build = {}, const SolveOptions& options = {},
                             const ProgressFunction& progress = nullptr) const {
        const std::vector<Loops> parts = split(loops);
        return solve_each(&parts, build, options, progress);
    }

private:
    ComponentSolutions solve_each(const std::vector<Loops>* loops, BuildOptions build, SolveOptions options,
                                  const ProgressFunction& progress) const {
        options.start = nullptr;
        options.stop_level = 0;
        ComponentSolutions all;
        all.values.resize(static_cast<std::size_t>(get()->edge_count));
        double done = 0;
        for (std::size_t k = 0; k < size(); ++k) {
            const hmf_component& c = (*this)[k];
            const double share = static_cast<double>(c.triangle_count) / static_cast<double>(get()->triangle_count);
            const auto from_to = [&](double from, double to) -> ProgressFunction {
                if (!progress) return nullptr;
                return [&progress, from, to](double fraction) { return progress(from + fraction * (to - from)); };
            };
            all.components.push_back({c.status, c.status == HMF_OK ? "" : hmf_status_string(c.status), std::nullopt});
            ComponentSolution& row = all.components.back();
            if (c.status == HMF_OK && loops && (*loops)[k].size() == 0)
                row = {HMF_ERROR_LOOP_COUNT, "No loop lies on it.", std::nullopt};
            if (row.status == HMF_OK) try {
                    build.marked_vertices = marked_vertices(k);
                    // About a quarter of the time is the build.
                    const Hierarchy hierarchy(positions(k), triangles(k), build, from_to(done, done + share / 4));
                    const ProgressFunction rest = from_to(done + share / 4, done + share);
                    row.solution = loops ? hierarchy.solve((*loops)[k], options, rest)
                                         : solve_cut_system(hierarchy, options, rest);
                    row.status = row.solution->status;
                    row.message = row.solution->message;
                    const Span<double> own = row.solution->foliation.values();
                    for (std::size_t e = 0; e < own.size(); ++e) all.values[whole_edges(k)[e]] = own[e];
                } catch (const Error& error) {
                    if (error.status() < 300 && error.status() != HMF_ERROR_UNSUPPORTED) throw;
                    row.status = error.status();
                    row.message = error.what();
                }
            done += share;
        }
        return all;
    }
};

} // namespace cpp
} // namespace hmf

#endif /* HMF_APPLICATIONS_HPP */
