// Every function of the interface on one mesh, and the bits of what it gives.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "surface.hpp"

namespace test {

// The bytes of a result, to compare: everything but pointers and seconds.
using Bits = std::vector<double>;

template <class T>
void append(Bits& bits, const T* from, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) bits.push_back(static_cast<double>(from[i]));
}

inline Bits bits_of(const hmf_level_mesh& m) {
    Bits bits;
    append(bits, m.positions, 3 * m.vertex_count);
    append(bits, m.edge_vertices, 2 * m.edge_count);
    append(bits, m.triangle_vertices, 3 * m.triangle_count);
    append(bits, m.triangle_edges, 3 * m.triangle_count);
    append(bits, m.weights, m.edge_count);
    return bits;
}

inline Bits bits_of(const hmf_residual_set& r) {
    Bits bits;
    append(bits, r.values, r.vertex_count);
    return bits;
}

inline Bits bits_of(const hmf_scale& s) {
    Bits bits{s.unevenness};
    append(bits, s.log_scale, s.triangle_count);
    return bits;
}

inline Bits bits_of(const hmf_form_set& s) {
    const uint64_t n = s.form_count;
    Bits bits{s.residual, s.conjugation_error};
    append(bits, s.values, n * s.edge_count);
    append(bits, s.intersections, n * n);
    append(bits, s.inner_products, n * n);
    append(bits, s.conjugation, n * n);
    append(bits, s.period_real, s.genus * s.genus);
    append(bits, s.period_imaginary, s.genus * s.genus);
    return bits;
}

inline Bits bits_of(const hmf_loop_set& s) {
    Bits bits{static_cast<double>(s.element_kind), static_cast<double>(s.level)};
    append(bits, s.offsets, s.count + 1);
    append(bits, s.elements, s.offsets[s.count]);
    if (s.weights) append(bits, s.weights, s.count);
    return bits;
}

inline Bits bits_of(const hmf_foliation& f) {
    size_t count = 0;
    const double* values = hmf_foliation_values(&f, &count);
    Bits bits{static_cast<double>(hmf_foliation_level(&f)), hmf_foliation_unit(&f)};
    append(bits, values, count);
    if (const hmf_report* r = hmf_foliation_report(&f)) {
        bits.insert(bits.end(), {r->energy, r->residual_max, r->residual_mean, static_cast<double>(r->zeros)});
        for (uint64_t i = 0; i < r->level_count; ++i)
            bits.push_back(static_cast<double>(r->levels[i].sweep_count + r->levels[i].linear_solve_count));
        for (uint64_t i = 0; i < r->history_count; ++i) bits.push_back(r->history[i].energy);
    }
    return bits;
}

inline Bits bits_of(const hmf_singularity_set& s) {
    Bits bits;
    for (uint64_t i = 0; i < s.count; ++i) {
        const hmf_singularity& at = s.list[i];
        bits.insert(bits.end(), {double(at.kind), double(at.index), double(at.element), double(at.size)});
        append(bits, at.position, 3);
    }
    append(bits, s.vertex_index, s.vertex_count);
    append(bits, s.vertex_cluster, s.vertex_count);
    append(bits, s.triangle_index, s.triangle_count);
    return bits;
}

inline Bits bits_of(const hmf_parameterization& p) {
    Bits bits{p.dilatation_mean, p.dilatation_median, p.dilatation_p99, p.seam_length, p.area};
    append(bits, p.corner_uv, 6 * p.triangle_count);
    append(bits, p.transition, 3 * p.edge_count);
    append(bits, p.seam, p.edge_count);
    append(bits, p.cone, p.vertex_count);
    append(bits, p.dilatation, p.triangle_count);
    append(bits, p.differential, 2 * p.triangle_count);
    return bits;
}

inline Bits bits_of(const hmf_lines& l) {
    Bits bits;
    for (uint64_t i = 0; i < l.line_count; ++i) {
        const hmf_line& line = l.lines[i];
        bits.insert(bits.end(), {double(line.kind), double(line.closed), double(line.begin), double(line.end),
                                 double(line.begin_zero), double(line.end_zero), double(line.cylinder),
                                 double(line.source), line.height, line.length});
    }
    append(bits, l.offsets, l.line_count + 1);
    append(bits, l.points, 3 * l.point_count);
    append(bits, l.point_edges, l.point_count);
    return bits;
}

inline Bits bits_of(const hmf_cylinder_set& c) {
    Bits bits = bits_of(*c.leaves);
    for (uint64_t i = 0; i < c.count; ++i) {
        const hmf_cylinder& at = c.list[i];
        bits.insert(bits.end(), {double(at.loop), at.height, at.circumference, at.modulus, at.area});
    }
    append(bits, c.twists, c.count);
    append(bits, c.corner_offsets, 2 * c.count + 1);
    append(bits, c.corner_vertices, c.corner_offsets[2 * c.count]);
    append(bits, c.corner_places, c.corner_offsets[2 * c.count]);
    return bits;
}

inline Bits bits_of(const hmf_design& d) {
    Bits bits = bits_of(*d.loops);
    append(bits, d.marked_vertices, d.marked_count);
    bits.insert(bits.end(), {d.unevenness, d.unevenness_before, double(d.solves)});
    return bits;
}

inline Bits bits_of(const hmf_mark_set& m) {
    Bits bits{double(m.marked_count)};
    append(bits, m.marked_vertices, m.marked_count);
    return bits;
}

inline Bits bits_of(const hmf_component_set& s) {
    Bits bits;
    for (uint64_t i = 0; i < s.count; ++i) bits.push_back(double(s.list[i].status));
    append(bits, s.part_triangles, 3 * s.triangle_count);
    append(bits, s.whole_edges, s.edge_count);
    return bits;
}

inline Bits bits_of(const hmf_quad_mesh& q) {
    Bits bits;
    append(bits, q.positions, 3 * q.vertex_count);
    append(bits, q.quads, 4 * q.quad_count);
    return bits;
}

// One call of the interface.  Fills `bits` if it succeeds; checks that a
// failing one gives nothing.
struct Function {
    const char* name;
    bool keeps; // makes something that stays with the foliation
    std::function<hmf_status(const hmf_control*, Bits*)> call;
};

template <class T, class Call>
hmf_status one_call(Bits* bits, Call&& call) {
    hmf_error error{};
    T* out = reinterpret_cast<T*>(&error); // must be overwritten
    const hmf_status status = call(&out, &error);
    const Owned<T> owner(out);
    EXPECT_EQ(error.status, status);
    EXPECT_TRUE(status == HMF_OK || std::strlen(error.message) > 10);
    EXPECT_EQ(out == nullptr, status != HMF_OK);
    if (out && bits) *bits = bits_of(*out);
    return status;
}

template <class Call>
hmf_status one_array(Bits* bits, size_t count, Call&& call) {
    hmf_error error{};
    Bits values(count, -7);
    const hmf_status status = call(values.data(), &error);
    EXPECT_EQ(error.status, status);
    for (const double x : values) EXPECT_TRUE(status == HMF_OK || x == -7);
    if (bits) *bits = values;
    return status;
}

// A hierarchy of several levels, foliations on it, and every function that
// takes them.
struct AllCalls {
    AllCalls(const TriMesh& mesh, const hmf_hierarchy_options& build) :
        hierarchy(mesh, build), h(hierarchy.get()), loops(library_loops(hierarchy, hierarchy.coarsest())),
        set(loops.view()), rough(interpolate(initialize(hierarchy, loops), 0)), vertices(mesh.vertex_count()) {
        refresh();
        coarse = interpolate(harmonic, hierarchy.coarsest());
        values = values_of(harmonic);
        read = create(hierarchy, 0, values);
        add_core();
        add_mesh(mesh, build);
        add_design(mesh, build);
        for (Foliation* f : {&harmonic, &read}) add_uses(*f, f == &harmonic);
    }
    AllCalls(const AllCalls&) = delete;

    // The minimum, as it comes from the solver: nothing has been kept with it.
    void refresh() {
        harmonic.reset();
        harmonic = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0)).foliation;
    }

    Hierarchy hierarchy;
    const hmf_hierarchy* h;
    Loops loops;
    hmf_loop_set set;
    Foliation rough, harmonic, coarse, read; // read: from the values
    std::vector<double> values;
    size_t vertices;
    std::vector<Function> functions;

private:
    template <class T, class Call>
    void add(const char* name, Call call, bool keeps = false) {
        functions.push_back({name, keeps, [call](const hmf_control* control, Bits* bits) {
                                 return one_call<T>(bits, [&](T** out, hmf_error* e) { return call(control, out, e); });
                             }});
    }

    void add_core() {
        for (const size_t level : {size_t{0}, size_t{1}})
            add<hmf_level_mesh>("hmf_level",
                                [this, level](auto c, auto out, auto e) { return hmf_level(h, level, c, out, e); });
        add<hmf_form_set>("hmf_harmonic_forms",
                          [this](auto c, auto out, auto e) { return hmf_harmonic_forms(h, 0, c, out, e); });
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS})
            add<hmf_loop_set>("hmf_loops",
                              [this, kind](auto c, auto out, auto e) { return hmf_loops(h, 0, kind, c, out, e); });
        add<hmf_foliation>("hmf_foliation_from_loops",
                           [this](auto c, auto out, auto e) { return hmf_foliation_from_loops(h, &set, c, out, e); });
        add<hmf_foliation>("hmf_solve_cut_system",
                           [this](auto c, auto out, auto e) { return hmf_solve_cut_system(h, nullptr, c, out, e); });
        add<hmf_foliation>("hmf_foliation_from_values", [this](auto c, auto out, auto e) {
            return hmf_foliation_from_values(h, 0, values.data(), values.size(), c, out, e);
        });
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            const hmf_solve_options options = solve_options(method, method == HMF_METHOD_NEWTON ? 0 : 1e-2);
            add<hmf_foliation>("hmf_solve", [this, options](auto c, auto out, auto e) {
                return hmf_solve(h, &set, &options, c, out, e);
            });
            add<hmf_foliation>("hmf_relax", [this, options](auto c, auto out, auto e) {
                return hmf_relax(rough.get(), &options, c, out, e);
            });
        }
        add<hmf_foliation>("hmf_solve, start", [this](auto c, auto out, auto e) {
            hmf_solve_options from = solve_options(HMF_METHOD_NEWTON, 0);
            from.start = rough.get();
            return hmf_solve(h, nullptr, &from, c, out, e);
        });
        add<hmf_foliation>("hmf_interpolate, coarser", [this](auto c, auto out, auto e) {
            return hmf_interpolate(harmonic.get(), hierarchy.coarsest(), c, out, e);
        });
        add<hmf_foliation>("hmf_interpolate, finer",
                           [this](auto c, auto out, auto e) { return hmf_interpolate(coarse.get(), 0, c, out, e); });
    }

    void add_mesh(const TriMesh& mesh, const hmf_hierarchy_options& build) {
        add<hmf_component_set>("hmf_components", [&mesh, build](auto c, auto out, auto e) {
            return hmf_components(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                  mesh.triangle_count(), &build, c, out, e);
        });
        add<hmf_mark_set>("hmf_suggest_marks", [&mesh, build](auto c, auto out, auto e) {
            return hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                     mesh.triangle_count(), &build, c, out, e);
        });
    }

    void add_design(const TriMesh& mesh, const hmf_hierarchy_options& build) {
        add<hmf_design>("hmf_even_design", [&mesh, build](auto c, auto out, auto e) {
            hmf_design_options options{};
            options.struct_size = sizeof options;
            options.build = &build;
            options.solve_limit = 5;
            return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                   mesh.triangle_count(), &options, c, out, e);
        });
    }

    void add_uses(const Foliation& f, bool minimum) {
        functions.push_back(
            {"hmf_energy", false, [&f](const hmf_control* c, Bits* bits) {
                 return one_array(bits, 1, [&](double* out, hmf_error* e) { return hmf_energy(f.get(), c, out, e); });
             }});
        add<hmf_residual_set>("hmf_residuals",
                              [&f](auto c, auto out, auto e) { return hmf_residuals(f.get(), c, out, e); });
        add<hmf_scale>("hmf_conformal_scale",
                       [&f](auto c, auto out, auto e) { return hmf_conformal_scale(f.get(), c, out, e); });
        add<hmf_singularity_set>("hmf_singularities",
                                 [&f](auto c, auto out, auto e) { return hmf_singularities(f.get(), c, out, e); });
        add<hmf_parameterization>(
            "hmf_parameterize",
            [&f](auto c, auto out, auto e) { return hmf_parameterize(f.get(), nullptr, c, out, e); }, minimum);
        for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE})
            add<hmf_lines>(
                "hmf_trace",
                [&f, leaves](auto c, auto out, auto e) {
                    hmf_trace_options options{};
                    options.struct_size = sizeof options;
                    options.critical = 1;
                    options.spacing = 0.3;
                    options.length_limit = 3;
                    options.leaves = leaves;
                    const uint32_t triangle = 7;
                    const double middle[3] = {0.3, 0.3, 0.4};
                    options.point_count = 1;
                    options.point_triangles = &triangle;
                    options.point_barycentrics = middle;
                    return hmf_trace(f.get(), &options, c, out, e);
                },
                minimum && leaves == HMF_LEAVES_CONJUGATE);
        add<hmf_cylinder_set>("hmf_cylinders",
                              [&f, this](auto c, auto out, auto e) { return hmf_cylinders(f.get(), &set, c, out, e); });
        add<hmf_cylinder_set>("hmf_cylinders, no loops",
                              [&f](auto c, auto out, auto e) { return hmf_cylinders(f.get(), nullptr, c, out, e); });
        add<hmf_quad_mesh>(
            "hmf_quads", [&f](auto c, auto out, auto e) { return hmf_quads(f.get(), nullptr, c, out, e); }, minimum);
    }
};

} // namespace test
