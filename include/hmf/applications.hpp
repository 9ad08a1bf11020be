/*
 * applications.hpp - applications.h as C++17 functions: what one does with a foliation
 *
 *     const hmf::Parameterization map = hmf::parameterize(foliation);
 *     map.corner_uv();                       // an array, as long as map lives
 *     map->dilatation_mean;                  // a number
 *
 * The rules are those of hmf.hpp; applications.h is the manual.
 */
#ifndef HMF_APPLICATIONS_HPP
#define HMF_APPLICATIONS_HPP

#include <hmf/hmf.hpp>
#include <hmf/applications.h>

namespace hmf {
inline namespace cpp {

/* ------------------------------------------------------------------------
 * Parameterization
 * --------------------------------------------------------------------- */

/* hmf_parameterize_options; zero means the default. */
struct ParameterizeOptions {
    double tolerance = 0;
    std::vector<uint32_t> seam_edges; /* where seams cost nothing */
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
    hmf_parameterize_options all = {};
    all.struct_size = sizeof all;
    all.tolerance = options.tolerance;
    all.seam_edges = options.seam_edges.data();
    all.seam_edge_count = options.seam_edges.size();
    return Parameterization(
        detail::make<hmf_parameterization>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
            return hmf_parameterize(foliation.get(), &all, control, out, error);
        }));
}

/* ------------------------------------------------------------------------
 * Leaves
 * --------------------------------------------------------------------- */

using Line = hmf_line;

enum class LeavesKind : int32_t {
    automatic = HMF_LEAVES_DEFAULT,
    foliation = HMF_LEAVES_FOLIATION,
    conjugate = HMF_LEAVES_CONJUGATE,
};

/* hmf_trace_options; zero means the default. */
struct TraceOptions {
    bool critical = false;
    double spacing = 0;
    double length_limit = 0;
    std::vector<uint32_t> point_triangles;  /* point_count */
    std::vector<double> point_barycentrics; /* point_count x 3 */
    LeavesKind leaves = LeavesKind::automatic;
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
    hmf_trace_options all = {};
    all.struct_size = sizeof all;
    all.critical = options.critical;
    all.spacing = options.spacing;
    all.length_limit = options.length_limit;
    all.point_count = options.point_triangles.size();
    all.point_triangles = options.point_triangles.data();
    all.point_barycentrics = options.point_barycentrics.data();
    all.leaves = static_cast<int32_t>(options.leaves);
    return Leaves(detail::make<hmf_lines>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
        return hmf_trace(foliation.get(), &all, control, out, error);
    }));
}

/* ------------------------------------------------------------------------
 * Cylinders
 * --------------------------------------------------------------------- */

using Cylinder = hmf_cylinder;

class Cylinders : public Result<hmf_cylinder_set> {
public:
    using Result::Result;
    Span<Cylinder> list() const noexcept { return span(get()->list, get()->count); }
    /* The leaf in the middle of each as a triangle loop, weights: the heights. */
    Loops leaves() const { return detail::own(*get()->leaves); }
};

namespace detail {

inline Cylinders cylinders(const Foliation& foliation, const hmf_loop_set* loops, const ProgressFunction& progress) {
    return Cylinders(make<hmf_cylinder_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
        return hmf_cylinders(foliation.get(), loops, control, out, error);
    }));
}

} // namespace detail

/* hmf_cylinders, without their loops. */
inline Cylinders cylinders(const Foliation& foliation, const ProgressFunction& progress = nullptr) {
    return detail::cylinders(foliation, nullptr, progress);
}

/* hmf_cylinders; loops: those that the foliation belongs to. */
inline Cylinders cylinders(const Foliation& foliation, const Loops& loops, const ProgressFunction& progress = nullptr) {
    const hmf_loop_set set = detail::raw(loops);
    return detail::cylinders(foliation, &set, progress);
}

/* ------------------------------------------------------------------------
 * Quads
 * --------------------------------------------------------------------- */

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
    return QuadMesh(detail::make<hmf_quad_mesh>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
        return hmf_quads(foliation.get(), &options, control, out, error);
    }));
}

/* edge_length 0: about as many quads as triangles / 2 */
inline QuadMesh quads(const Foliation& foliation, double edge_length = 0, const ProgressFunction& progress = nullptr) {
    hmf_quad_options options = {};
    options.edge_length = edge_length;
    return quads(foliation, options, progress);
}

/* ------------------------------------------------------------------------
 * Atlas
 * --------------------------------------------------------------------- */

class Atlas : public Result<hmf_chart_set> {
public:
    using Result::Result;
    Span<double> corner_uv() const noexcept { return span(get()->corner_uv, 6 * get()->triangle_count); }
    Span<uint32_t> triangle_chart() const noexcept { return span(get()->triangle_chart, get()->triangle_count); }
};

/* hmf_atlas; margin 0: 1/512 of the side of the square */
inline Atlas atlas(const Foliation& foliation, double margin = 0, const ProgressFunction& progress = nullptr) {
    hmf_atlas_options options = {};
    options.struct_size = sizeof options;
    options.margin = margin;
    return Atlas(detail::make<hmf_chart_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
        return hmf_atlas(foliation.get(), &options, control, out, error);
    }));
}

} // namespace cpp
} // namespace hmf

#endif /* HMF_APPLICATIONS_HPP */
