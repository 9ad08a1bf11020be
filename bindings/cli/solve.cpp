#include "solve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <new>

#include "component.hpp"
#include "draw_loops.hpp"
#include "leaves.hpp"
#include "loop_lines.hpp"
#include "marks.hpp"
#include "output.hpp"
#include "read_mesh.hpp"
#include "read_values.hpp"
#include "render.hpp"
#include "split_mesh.hpp"
#include "whole_stripes.hpp"
#include "write_quads.hpp"
#include "write_results.hpp"
#include "write_textured.hpp"

namespace cli {

namespace {

using readers::Json;

// HMF_LOOPS_* of a name, 0 for the name of a file.
int32_t loop_kind(const std::string& name) {
    if (name == "cut") return HMF_LOOPS_CUT;
    if (name == "handle") return HMF_LOOPS_HANDLE;
    if (name == "tunnel") return HMF_LOOPS_TUNNEL;
    if (name == "pants") return HMF_LOOPS_PANTS;
    if (name == "even") return LOOPS_EVEN;
    return 0;
}

// The sum of a number in the reports of components; null: none has it.
Json sum(const Json::Array& reports, const char* key) {
    Json total;
    for (const Json& report : reports) {
        const Json* const number = report.find(key);
        if (number && !number->is_null()) total = Json(total.number() + number->number());
    }
    // Counts stay whole numbers in the file.
    const double value = total.number();
    const bool is_whole = !total.is_null() && value == std::floor(value) && std::fabs(value) < 1e15;
    return is_whole ? Json(static_cast<int64_t>(value)) : total;
}

// Levels of several reports as those of one, the finest first.
Json::Array sum_of_levels(const Json::Array& reports) {
    std::vector<Json::Array> rows;
    for (const Json& report : reports)
        if (const Json* const levels = report.find("levels"))
            for (size_t k = 0; k < levels->elements().size(); ++k) {
                if (k == rows.size()) rows.emplace_back();
                rows[k].push_back(levels->elements()[k]);
            }
    Json::Array all;
    for (const Json::Array& row : rows) {
        Json level;
        for (const char* key : {"vertices", "edges", "nld", "raised_count", "iterations", "linear_solves",
                                "optimize_seconds", "interpolate_seconds"})
            level.set(key, sum(row, key));
        all.push_back(level);
    }
    return all;
}

double area_of(const Foliation& f, size_t triangle) {
    const double* p[3];
    for (size_t c = 0; c < 3; ++c) p[c] = &f.positions[size_t{3} * f.triangles[3 * triangle + c]];
    double square = 0;
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const double x = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
        square += x * x;
    }
    return std::sqrt(square) / 2;
}

// One run, from the files it reads to the files it writes.
class Run {
public:
    Run(SolveRequest& request, const Options& options) : r_(request), options_(options) {}

    Outcome go() {
        choose_style();
        read();
        r_.threads = progress_.use_threads(r_.threads);
        build();
        choose_loops();
        solve();
        describe();
        write();
        report();
        return std::move(outcome_);
    }

private:
    void choose_style() {
        style_.pattern = static_cast<Pattern>(r_.pattern);
        style_.legend = r_.legend;
        style_.has_view = read_view(r_.camera, style_.view);
        char rest = 0;
        if (std::sscanf(r_.image_size.c_str(), "%5ux%5u%c", &style_.width, &style_.height, &rest) != 2
            || std::min(style_.width, style_.height) < 16 || std::max(style_.width, style_.height) > 16384)
            throw Failure(EXIT_USAGE,
                          "--image-size: \"" + r_.image_size
                              + "\" is no size; give width and height such as 1400x1050, each from 16 to 16384");
        if (r_.size > 0 && r_.quads.empty() && style_.pattern != Pattern::quads)
            throw Failure(EXIT_USAGE, "--size: has no effect without --quads or --pattern quads; give one of them");
        if (r_.period > 0 && r_.obj.empty() && r_.textured.empty()
            && (style_.pattern == Pattern::quads || style_.pattern == Pattern::dilatation
                || style_.pattern == Pattern::scale))
            throw Failure(EXIT_USAGE, "--period: has no effect with this --pattern; leave it out");
    }

    void read() {
        mesh_ = read_mesh(r_.mesh);
        if (r_.repairs) repairs_ = repair_mesh(mesh_, r_.joins, name_);
        if (repairs_.count() > 0 && r_.save_mesh.empty() && !outputs_of(options_).empty())
            std::fprintf(stderr, "%s: the outputs refer to the repaired mesh; --save-mesh FILE.obj writes it\n",
                         name_.c_str());
        if (r_.marks != "auto" && r_.marks != "none") marks_ = read_marks(r_.marks, mesh_.vertex_count());
        if (kind_ != 0 || has_start_) return;
        if (!r_.through.empty()) {
            read_ = draw_loops(r_.through, mesh_);
            return;
        }
        try {
            read_ = read_loops(r_.loops, mesh_.vertex_count(), mesh_.triangle_count());
        } catch (const Failure& failure) {
            if (failure.exit_status != EXIT_RESOURCES) throw;
            throw Failure(EXIT_RESOURCES, "--loops: neither a kind of loops nor a file that can be read has the name \""
                                              + r_.loops + "\"; the kinds are cut, handle, tunnel, pants and even");
        }
    }

    void split() {
        std::vector<readers::Component> parts = split_mesh(mesh_, name_);
        const bool alone = parts.size() == 1;
        for (readers::Component& part : parts) {
            const std::string subject = alone ? name_ : name_ + ", " + name_of_component(part, components_.size());
            components_.emplace_back(std::move(part), subject, alone);
        }
        loop_numbers_.resize(components_.size());
    }

    // The part of the bar from `from` to `to` that belongs to the next triangles.
    const hmf_control* share(const char* label, double from, double to, size_t& done, const Component& c) {
        const double all = static_cast<double>(is_alone() ? c.mesh().triangle_count() : mesh_.triangle_count());
        const double begin = static_cast<double>(done) / all;
        done += c.mesh().triangle_count();
        const double end = static_cast<double>(done) / all;
        return progress_.part(label, from + (to - from) * begin, from + (to - from) * end);
    }

    void build() {
        for (const std::string& path : outputs_of(options_)) {
            check_writable(path);
            outcome_.uses_stdout = outcome_.uses_stdout || path == "-";
        }
        attempt("--save-mesh", !r_.save_mesh.empty(), [&] { write_mesh_obj(r_.save_mesh, mesh_, 17); });
        split();
        take_marks();
        take_loops();
        std::vector<uint32_t> designed;
        uint64_t coarsest = r_.coarsest;
        size_t done = 0;
        for (Component& c : components_) {
            const hmf_control* const control = share("build", 0, 0.35, done, c);
            if (c.is_refused()) continue;
            c.build(r_, meter_, control);
            if (c.is_refused()) continue;
            coarsest = std::max<uint64_t>(coarsest, 40 * c.genus() + 10 * c.marks().size());
            if (kind_ == LOOPS_EVEN)
                for (const uint32_t v : c.marks()) designed.push_back(c.whole_vertex(v));
            if (r_.marks != "auto" || kind_ == LOOPS_EVEN) continue;
            for (const uint32_t v : c.marks()) marks_.push_back(c.whole_vertex(v));
            tipped_ += !c.marks().empty();
            has_tips_ = has_tips_ || (!c.marks().empty() && c.boundaries() == 0);
        }
        r_.coarsest = coarsest;
        if (kind_ == LOOPS_EVEN) marks_ = designed;
        refuse_if_none();
    }

    // Gives each marked vertex of the caller to its component.
    void take_marks() {
        if (marks_.empty()) return;
        if (is_alone()) return components_[0].take_marks(marks_);
        std::vector<uint8_t> is_marked(mesh_.vertex_count(), 0);
        for (const uint32_t v : marks_) is_marked[v] = 1;
        for (Component& c : components_) {
            std::vector<uint32_t> own;
            for (uint32_t v = 0; v < c.mesh().vertex_count(); ++v)
                if (is_marked[c.whole_vertex(v)]) own.push_back(v);
            c.take_marks(std::move(own));
        }
    }

    // Gives each loop of the caller to its component.
    void take_loops() {
        if (read_.count() == 0) return;
        if (is_alone()) {
            for (size_t c = 0; c < read_.count(); ++c) loop_numbers_[0].push_back(c);
            components_[0].take_loops(read_);
            return;
        }
        const bool triangles = read_.element_kind == HMF_LOOP_TRIANGLES;
        std::vector<std::array<uint32_t, 2>> place(triangles ? mesh_.triangle_count() : mesh_.vertex_count());
        std::vector<LoopList> lists(components_.size());
        for (uint32_t k = 0; k < components_.size(); ++k) {
            lists[k].element_kind = read_.element_kind;
            const TriangleMesh& mesh = components_[k].mesh();
            const size_t count = triangles ? mesh.triangle_count() : mesh.vertex_count();
            for (uint32_t i = 0; i < count; ++i)
                place[triangles ? components_[k].whole_triangle(i) : components_[k].whole_vertex(i)] = {k, i};
        }
        for (size_t loop = 0; loop < read_.count(); ++loop) {
            const uint32_t component = place[read_.elements[read_.offsets[loop]]][0];
            LoopList& list = lists[component];
            for (uint64_t i = read_.offsets[loop]; i < read_.offsets[loop + 1]; ++i) {
                const auto [other, number] = place[read_.elements[i]];
                if (other != component)
                    throw Failure(EXIT_BAD_INPUT, r_.name_of_loop(read_.lines[loop])
                                                      + ": the loop lies on several components of the mesh");
                list.elements.push_back(number);
            }
            list.offsets.push_back(list.elements.size());
            list.arcs.push_back(read_.arcs[loop]);
            list.lines.push_back(read_.lines[loop]);
            loop_numbers_[component].push_back(loop);
        }
        for (size_t k = 0; k < components_.size(); ++k) {
            if (lists[k].count() == 0) components_[k].refuse(HMF_ERROR_LOOP_COUNT, "no loop lies on it");
            else components_[k].take_loops(std::move(lists[k]));
        }
    }

    void refuse_if_none() const {
        size_t named = 0;
        std::string reasons;
        for (const Component& c : components_) {
            if (!c.is_refused()) return;
            if (named++ < most_named) reasons += (named == 1 ? "" : "; ") + c.refusal().substr(name_.size() + 2);
        }
        if (named > most_named) reasons += "; and so on";
        throw Failure(EXIT_BAD_INPUT, name_ + ": none of " + std::to_string(components_.size())
                                          + " components carries a foliation: " + reasons);
    }

    void choose_loops() {
        const bool fine = r_.method == HMF_METHOD_SINGLE_LEVEL;
        size_t count = read_.count();
        for (size_t k = 0; kind_ != 0 && !has_start_ && k < components_.size(); ++k) {
            Component& c = components_[k];
            if (!c.is_refused()) c.make_loops(kind_, fine, nullptr);
            for (uint64_t n = 0; !c.is_refused() && n < c.loops().count; ++n) loop_numbers_[k].push_back(count++);
        }
        refuse_if_none();
        loop_count_ = count;
        weights_given_ = !r_.weights.empty();
        // Without loops the weights are for the pictures only.
        if (!weights_given_) r_.weights = own_weights(count);
        if (r_.weights.size() != count && !has_start_)
            throw Failure(EXIT_USAGE, "--weights: " + std::to_string(r_.weights.size()) + " weights for "
                                          + std::to_string(count) + " loops; give one weight per loop");
    }

    // Those of the file or the design, else all 1; without loops one, for the pictures.
    std::vector<double> own_weights(size_t count) const {
        if (!read_.weights.empty()) return read_.weights;
        std::vector<double> weights(has_start_ ? 1 : count, 1.0);
        for (size_t k = 0; kind_ == LOOPS_EVEN && k < components_.size(); ++k)
            for (size_t n = 0; n < loop_numbers_[k].size(); ++n)
                weights[loop_numbers_[k][n]] = components_[k].loops().weights[n];
        return weights;
    }

    // The loops on the input mesh.
    hmf_loop_set fine_loops() {
        if (is_alone()) return components_[0].fine_loops(control_);
        if (read_.count() == 0)
            for (Component& c : components_) {
                if (c.is_refused()) continue;
                const hmf_loop_set& own = c.fine_loops(control_);
                read_.element_kind = own.element_kind;
                for (uint64_t n = 0; n < own.count; ++n) {
                    for (uint64_t i = own.offsets[n]; i < own.offsets[n + 1]; ++i)
                        read_.elements.push_back(c.whole_triangle(own.elements[i]));
                    read_.offsets.push_back(read_.elements.size());
                    read_.arcs.push_back(own.arcs ? own.arcs[n] : 0);
                }
            }
        return read_.view();
    }

    // The values to start from, for each component; one without values has no foliation.
    std::vector<std::vector<double>> start_values() {
        if (!has_start_) return {};
        const readers::Edges edges = readers::edges_of(is_alone() ? components_[0].mesh() : mesh_);
        std::vector<double> all = read_values(r_.start, edges.vertices);
        if (is_alone()) return {std::move(all)};
        std::vector<std::vector<double>> values;
        std::vector<uint8_t> seen(edges.count(), 0);
        for (Component& c : components_) {
            values.emplace_back();
            for (uint32_t t = 0; t < c.mesh().triangle_count(); ++t)
                for (size_t s = 0; s < 3; ++s) {
                    const uint32_t e = edges.triangles[size_t{3} * c.whole_triangle(t) + s];
                    if (seen[e]) continue;
                    seen[e] = 1;
                    values.back().push_back(all[e]);
                }
            const bool is_zero = std::count(values.back().begin(), values.back().end(), 0.0)
                              == static_cast<std::ptrdiff_t>(values.back().size());
            if (is_zero && !c.is_refused())
                c.refuse(HMF_ERROR_LOOP_COUNT, "the values of " + shown(r_.start) + " are 0 there");
        }
        refuse_if_none();
        return values;
    }

    void solve() {
        const std::vector<std::vector<double>> start = start_values();
        const Clock::time_point begin = Clock::now();
        size_t done = 0;
        int32_t method = r_.method;
        for (size_t k = 0; k < components_.size(); ++k) {
            Component& c = components_[k];
            const hmf_control* const control = share("solve", 0.35, 1, done, c);
            if (c.is_refused()) continue;
            std::vector<double> weights;
            for (const size_t n : loop_numbers_[k]) weights.push_back(r_.weights[n]);
            // What one component takes the next one has not.
            const double limit =
                r_.time_limit > 0 && k > 0 ? std::max(1e-9, r_.time_limit - seconds_since(begin)) : r_.time_limit;
            c.solve(r_, limit, std::move(weights), has_start_ ? &start[k] : nullptr, control);
            if (c.is_refused()) continue;
            method = c.report().method;
            if (c.status() == HMF_OK) continue;
            progress_.clear();
            outcome_.exit_status = EXIT_LIMIT;
            const bool written = !outputs_of(options_).empty();
            outcome_.errors.push_back(c.limit()
                                      + (written ? "; the best foliation so far was written"
                                                 : "; the numbers are those of the best foliation so far"));
        }
        progress_.clear();
        refuse_if_none();
        if (outcome_.exit_status == EXIT_LIMIT) progress_.finish_quietly();
        r_.method = method;
        if (r_.tolerance == 0) r_.tolerance = r_.method == HMF_METHOD_NEWTON ? 1e-8 : 1e-6;
        for (const Component& c : components_)
            if (c.is_refused()) outcome_.notes.push_back(c.refusal() + "; its values are 0");
    }

    // Everything that the files need, in the numbering of the whole mesh.
    void describe() {
        if (is_alone()) {
            f_ = components_[0].describe();
            singular_.push_back(f_.singular);
            return;
        }
        readers::Edges edges = readers::edges_of(mesh_);
        f_.values.assign(edges.count(), 0);
        f_.component.resize(mesh_.triangle_count());
        for (uint32_t k = 0; k < components_.size(); ++k) {
            Component& c = components_[k];
            const size_t count = c.mesh().triangle_count();
            for (uint32_t t = 0; t < count; ++t) f_.component[c.whole_triangle(t)] = k;
            f_.is_bare.push_back(c.is_refused());
            singular_.emplace_back();
            if (c.is_refused()) continue;
            const Foliation own = c.describe();
            whole_edges_.resize(components_.size());
            whole_edges_[k].resize(own.values.size());
            for (uint32_t t = 0; t < count; ++t)
                for (size_t s = 0; s < 3; ++s) {
                    const uint32_t whole = edges.triangles[size_t{3} * c.whole_triangle(t) + s];
                    whole_edges_[k][own.triangle_edges[size_t{3} * t + s]] = whole;
                    f_.values[whole] = own.values[own.triangle_edges[size_t{3} * t + s]];
                }
            f_.singular.insert(f_.singular.end(), own.singular.begin(), own.singular.end());
            singular_.back() = own.singular;
        }
        f_.positions = std::move(mesh_.positions);
        f_.triangles = std::move(mesh_.triangles);
        f_.triangle_edges = std::move(edges.triangles);
        f_.edge_vertices = std::move(edges.vertices);
    }

    // An output that fails does not take the others with it.
    template <class Work>
    void attempt(const char* option, bool wanted, const Work& work) {
        if (!wanted) return;
        ExitStatus status = EXIT_RESOURCES;
        try {
            work();
            return;
        } catch (const Failure& failure) {
            // The command was right: only this mesh shows that it cannot be.
            status = failure.exit_status == EXIT_USAGE ? EXIT_BAD_INPUT : failure.exit_status;
            outcome_.errors.push_back(std::string(option) + ": " + failure.what());
            if (was_interrupted()) progress_.finish_quietly(); // only the output that was being made is given up
        } catch (const std::bad_alloc&) { outcome_.errors.push_back(std::string(option) + ": out of memory"); }
        if (outcome_.exit_status == EXIT_SOLVED || outcome_.exit_status == EXIT_LIMIT) outcome_.exit_status = status;
    }

    // For each component with a foliation; the others get what they can where it fails for one.
    template <class Work>
    void attempt_each(const char* option, bool wanted, const Work& work) {
        for (Component& c : components_)
            if (!c.is_refused()) attempt(option, wanted, [&] { work(c); });
    }

    // The weights of the classes of the values, where they can be found; elsewhere stripes may not match.
    void find_weights() {
        std::vector<double> weights;
        for (Component& c : components_) {
            if (c.is_refused() || c.status() != HMF_OK) continue;
            try {
                const hmf_cylinder_set* const cylinders = c.find_cylinders(control_);
                for (uint64_t k = 0; k < cylinders->count; ++k) weights.push_back(cylinders->list[k].height);
            } catch (const Failure&) {}
        }
        if (!weights.empty()) r_.weights = weights;
    }

    // (u, v) of each corner of the whole mesh; NULL: of none.
    const double* corner_uv() {
        return of_triangles(uv_, 6, [](const hmf_parameterization& p) { return p.corner_uv; });
    }
    const double* dilatation() {
        return of_triangles(dilatation_, 1, [](const hmf_parameterization& p) { return p.dilatation; });
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

    // As corner_uv, for a checkerboard.
    std::vector<double> checkerboard_uv(double period) const {
        if (is_alone()) return components_[0].checkerboard_uv(period);
        std::vector<double> all(2 * f_.triangles.size());
        for (const Component& c : components_) {
            if (!c.parameterization()) continue;
            const std::vector<double> own = c.checkerboard_uv(period);
            for (uint32_t t = 0; t < own.size() / 6; ++t)
                std::copy_n(&own[size_t{6} * t], 6, &all[size_t{6} * c.whole_triangle(t)]);
        }
        return all;
    }

    // A period for stripes and squares, and where the weights have none in common, values that have.
    double choose_period() {
        const double wanted = r_.period > 0 ? r_.period : wanted_period(f_);
        if (const double common = common_period(r_.weights, wanted); common > 0) return common;
        if (style_.pattern != Pattern::stripes || r_.image.empty()) return wanted;
        std::vector<Crossing> crossings;
        std::vector<double> heights;
        for (size_t k = 0; k < components_.size(); ++k) {
            const Component& c = components_[k];
            if (c.is_refused()) continue;
            add_crossings(f_, *c.trace_cylinders(control_), is_alone() ? nullptr : whole_edges_[k].data(), crossings,
                          heights);
        }
        f_.stripe_values = whole_stripes(f_, std::move(crossings), heights, wanted);
        return wanted;
    }

    // Of several components each gets quads by its area.
    hmf_quad_options quad_wish(const Component& c) const {
        hmf_quad_options wish = {};
        wish.struct_size = sizeof wish;
        wish.edge_length = r_.size;
        wish.merge = r_.merges;
        wish.relax = static_cast<uint32_t>(r_.relax);
        wish.count = r_.count;
        if (r_.count > 0 && !is_alone()) {
            double all = 0, own = 0;
            for (size_t t = 0; t < f_.triangle_count(); ++t) {
                const Component& of = components_[f_.component[t]];
                if (of.is_refused()) continue;
                const double area = area_of(f_, t);
                all += area;
                if (&of == &c) own += area;
            }
            wish.count = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(double(r_.count) * own / all)));
        }
        return wish;
    }

    // log |grad u| of each triangle of the whole mesh.
    std::vector<double> log_scale() const {
        std::vector<double> scale(f_.triangle_count(), 0);
        for (const Component& c : components_) {
            if (c.is_refused()) continue;
            const std::vector<double> own = c.log_scale(control_);
            for (uint32_t t = 0; t < own.size(); ++t) scale[c.whole_triangle(t)] = own[t];
        }
        return scale;
    }

    void write() {
        for (const std::string& path : r_.values)
            attempt("--values", true, [&] {
                if (extension_of(path) == ".npy") write_values_npy(path, f_.values);
                else write_values_csv(path, f_);
            });
        attempt("--history", !r_.history.empty(), [&] {
            std::vector<const hmf_report*> reports;
            for (const Component& c : components_) reports.push_back(c.is_refused() ? nullptr : &c.report());
            write_history(r_.history, reports);
        });
        attempt("--save-marks", !r_.save_marks.empty(), [&] { write_marks(r_.save_marks, marks_); });
        attempt("--save-loops", !r_.save_loops.empty(), [&] { write_loops(r_.save_loops, fine_loops(), r_.weights); });
        control_ = progress_.part("leaves", 0, 1);
        const bool wants_uv = !r_.obj.empty() || !r_.textured.empty();
        const bool pictured = !r_.image.empty() || wants_uv;
        attempt_each("--leaves", !r_.leaves.empty(), [&](Component& c) {
            if (c.status() == HMF_OK) c.find_cylinders(control_);
        });
        if (has_start_ && !weights_given_ && (pictured || !r_.leaves.empty())) find_weights();
        f_.loop_weights = r_.weights;
        if (r_.spacing == 0 && !r_.leaves.empty())
            r_.spacing = 0.1 * *std::min_element(r_.weights.begin(), r_.weights.end());
        std::vector<Owned<hmf_quad_mesh>> quads;
        const bool shows_quads = style_.pattern == Pattern::quads;
        attempt_each(r_.quads.empty() ? "--pattern" : "--quads", !r_.quads.empty() || shows_quads, [&](Component& c) {
            quads.push_back(make_quads(c.foliation(), quad_wish(c), control_, c.subject()));
        });
        attempt("--quads", !quads.empty() && !r_.quads.empty(), [&] {
            write_quads(r_.quads, quads);
            for (const Owned<hmf_quad_mesh>& mesh : quads) {
                quads_ += mesh->quad_count;
                irregular_ += mesh->irregular_count;
                inverted_ += mesh->inverted_count;
            }
        });
        std::vector<Leaves> leaves;
        attempt_each("--leaves", !r_.leaves.empty(), [&](Component& c) {
            leaves.push_back(trace_leaves(c.foliation(), r_.spacing, r_.conjugate, control_, c.subject()));
        });
        attempt("--leaves", !leaves.empty(), [&] { leaves_ = write_leaves(r_.leaves, leaves); });
        const bool unfolded = style_.pattern == Pattern::checkerboard || style_.pattern == Pattern::dilatation;
        const char* const asking = !r_.obj.empty()      ? "--obj"
                                 : !r_.textured.empty() ? "--textured"
                                 : unfolded             ? "--pattern"
                                                        : "--conformality";
        const bool unfolds = unfolded || wants_uv || r_.conformality;
        attempt_each(asking, unfolds, [&](Component& c) {
            control_ = progress_.part("unfold", 0, 1);
            c.parameterize(control_);
        });
        const double* const uv = unfolds ? corner_uv() : nullptr;
        double period = 1;
        if (pictured) {
            control_ = progress_.part("picture", 0, 1);
            attempt("--period", true, [&] { r_.period = period = choose_period(); });
        }
        attempt("--obj", !r_.obj.empty() && uv, [&] { write_textured_obj(r_.obj, f_, uv, period); });
        attempt("--textured", !r_.textured.empty() && uv, [&] {
            if (extension_of(r_.textured) == ".glb") write_textured_glb(r_.textured, f_, uv, period);
            else write_textured_ply(r_.textured, f_, uv, period);
        });
        std::vector<std::pair<const Component*, Owned<hmf_chart_set>>> atlas;
        attempt_each("--atlas", !r_.atlas.empty(), [&](Component& c) {
            control_ = progress_.part("atlas", 0, 1);
            atlas.emplace_back(&c, c.make_atlas(control_));
        });
        attempt("--atlas", !atlas.empty(), [&] { write_atlas(atlas); });
        const bool has_data = shows_quads ? !quads.empty() : !unfolded || uv;
        attempt("--image", !r_.image.empty() && has_data, [&] {
            std::vector<Line> lines;
            if (!has_start_) lines = loop_lines(f_, fine_loops());
            PictureData data;
            std::vector<double> squares;
            if (style_.pattern == Pattern::checkerboard) squares = checkerboard_uv(period);
            data.corner_uv = squares.data();
            if (unfolded) data.dilatation = dilatation();
            if (style_.pattern == Pattern::scale) data.log_scale = log_scale();
            for (const Owned<hmf_quad_mesh>& mesh : quads) data.quads.push_back(mesh.get());
            const Potential potential =
                style_.pattern == Pattern::stripes ? local_potential(f_, period) : Potential{{}, {}, period};
            write_png(r_.image, render(f_, potential, data, lines, style_));
        });
        progress_.clear();
    }

    // Each component has a square of its own in a grid.
    void write_atlas(const std::vector<std::pair<const Component*, Owned<hmf_chart_set>>>& made) {
        std::vector<double> uv(2 * f_.triangles.size(), 0);
        size_t across = 1;
        while (across * across < made.size()) ++across;
        const double side = 1 / static_cast<double>(across);
        atlas_ = {};
        for (size_t k = 0; k < made.size(); ++k) {
            const auto& [c, charts] = made[k];
            const double at[2] = {static_cast<double>(k % across), static_cast<double>(k / across)};
            for (uint32_t t = 0; t < charts->triangle_count; ++t)
                for (size_t i = 0; i < 6; ++i)
                    uv[size_t{6} * c->whole_triangle(t) + i] =
                        (charts->corner_uv[6 * size_t{t} + i] + at[i % 2]) * side;
            atlas_.charts += charts->chart_count;
            atlas_.used += charts->used_area * side * side;
            atlas_.seams += charts->seam_length;
            atlas_.collapsed += charts->collapsed_triangles;
        }
        constexpr unsigned tiles = 16;
        if (extension_of(r_.atlas) == ".glb") write_textured_glb(r_.atlas, f_, uv.data(), 1, tiles);
        else write_textured_obj(r_.atlas, f_, uv.data(), 1, tiles);
    }

    void report() {
        const double seconds = seconds_since(begin_);
        const Json json = report_json(seconds);
        if (!r_.report.empty()) attempt("--report", true, [&] { write_report(r_.report, json); });
        const auto number = [&](const Json& object, const char* key) {
            const Json* const found = object.find(key);
            return found ? found->number() : 0;
        };
        std::string summary = name_ + ": ";
        if (!is_alone())
            summary += std::to_string(components_.size()) + " components, "
                     + std::to_string(components_.size() - outcome_.notes.size()) + " solved, ";
        char line[300];
        std::snprintf(line, sizeof line,
                      "genus %.0f, %zu edges, %zu loops, energy %.10g, residual %.2g, class %s, %.0f zeros, %.0f "
                      "poles, %.2f s",
                      number(*json.find("mesh"), "genus"), f_.values.size(), loop_count_, number(json, "energy"),
                      number(json, "residual_max"), json.find("class")->text()->c_str(), number(json, "zeros"),
                      number(json, "poles"), seconds);
        outcome_.summary = summary + line;
        if (r_.count > 0 && quads_ > 0)
            outcome_.summary += "\n" + r_.quads + ": " + std::to_string(quads_) + " quads, "
                              + std::to_string(irregular_) + " irregular vertices, " + std::to_string(inverted_)
                              + " inverted quads";
        if (atlas_.charts > 0) {
            std::snprintf(line, sizeof line, ": %zu charts, %.0f %% of the square used", atlas_.charts,
                          100 * atlas_.used);
            outcome_.summary += "\n" + r_.atlas + line;
        }
        if (kind_ == LOOPS_EVEN) outcome_.summary += "\n" + design_sentence();
        else if (tipped_ > 0) outcome_.summary += "\n" + sentence_of(marks_, tipped_, has_tips_);
    }

    std::string design_sentence() const {
        std::string text = "even: " + std::to_string(marks_.size()) + " marked vertices, " + std::to_string(loop_count_)
                         + " loops with weights";
        if (is_alone()) {
            char numbers[100];
            std::snprintf(numbers, sizeof numbers, "; unevenness %.2f, with --loops cut %.2f",
                          components_[0].report().unevenness, components_[0].design()->unevenness_before);
            text += numbers;
        }
        return text + " (--save-marks and --save-loops keep them)";
    }

    Json report_json(double seconds) const {
        Json report = {{"version", version_text()},
                       {"input", r_.mesh},
                       {"options", values_of(options_)},
                       {"exit_status", static_cast<int>(outcome_.exit_status)},
                       {"errors", outcome_.errors}};
        if (r_.repairs) report.set("repairs", repairs_.sentences());
        if (is_alone()) {
            const Json own = components_[0].json(singular_[0]);
            for (const auto& [key, value] : own.members()) report.set(key, value);
            Json mesh = *own.find("mesh");
            mesh.set("components", 1);
            report.set("mesh", mesh);
        } else add_totals(report);
        report.set("total_seconds", seconds);
        report.set("cpu_seconds", double(std::clock()) / CLOCKS_PER_SEC);
        report.set("threads", r_.threads);
        report.set("weights", r_.weights);
        report.set("peak_memory_bytes", meter_.peak);
        if (leaves_ > 0) report.set("leaves", leaves_);
        if (atlas_.charts > 0) {
            report.set("atlas_charts", atlas_.charts);
            report.set("atlas_used_area", atlas_.used);
            report.set("atlas_seam_length", atlas_.seams);
            report.set("atlas_collapsed_triangles", atlas_.collapsed);
        }
        if (quads_ > 0) {
            report.set("quads", quads_);
            report.set("quads_irregular", irregular_);
            report.set("quads_inverted", inverted_);
        }
        return report;
    }

    // Sums over the components, then their own reports.
    void add_totals(Json& report) const {
        Json::Array parts, meshes, singular;
        double residual_max = 0, residual_mean = 0, vertices = 0;
        bool converged = true;
        int32_t class_state = HMF_CLASS_PROVEN;
        Json method;
        for (size_t k = 0; k < components_.size(); ++k) {
            parts.push_back(components_[k].json(singular_[k]));
            const Json& part = parts.back();
            meshes.push_back(*part.find("mesh"));
            if (components_[k].is_refused()) continue;
            const hmf_report& r = components_[k].report();
            const double own = meshes.back().find("vertices")->number();
            residual_max = std::max(residual_max, r.residual_max);
            residual_mean += own * r.residual_mean;
            vertices += own;
            converged = converged && components_[k].is_converged();
            class_state = less_sure(class_state, r.class_state);
            method = *part.find("method");
            const Json::Array& list = part.find("singularities")->elements();
            singular.insert(singular.end(), list.begin(), list.end());
        }
        Json mesh = {{"vertices", f_.positions.size() / 3}, {"edges", f_.values.size()}};
        for (const char* key : {"triangles", "genus", "marked", "boundaries"}) mesh.set(key, sum(meshes, key));
        mesh.set("components", components_.size());
        report.set("mesh", mesh);
        report.set("method", method);
        report.set("class", class_name(class_state));
        report.set("levels", sum_of_levels(parts));
        report.set("loops", loop_count_);
        for (const char* key :
             {"class_repeats", "class_seconds", "build_seconds", "loops_seconds", "solve_seconds", "energy"})
            report.set(key, sum(parts, key));
        report.set("residual_max", residual_max);
        report.set("residual_mean", residual_mean / vertices);
        for (const char* key : {"poles", "zeros", "index_sum"}) report.set(key, sum(parts, key));
        report.set("singularities", singular);
        for (const char* key : {"bad_flips", "bad_flips_left"}) report.set(key, sum(parts, key));
        report.set("converged", converged);
        for (const char* key :
             {"flipped_triangles", "degenerate_triangles", "seam_edges", "seam_length", "parameterize_seconds"})
            if (const Json total = sum(parts, key); !total.is_null()) report.set(key, total);
        report.set("components", parts);
    }

    bool is_alone() const { return components_.size() == 1; }

    static constexpr size_t most_named = 5;

    SolveRequest& r_;
    const Options& options_;
    const Clock::time_point begin_ = Clock::now();
    const std::string name_ = shown(r_.mesh);
    const bool has_start_ = !r_.start.empty();
    const int32_t kind_ = loop_kind(r_.loops);
    Outcome outcome_;
    Progress progress_;
    const hmf_control* control_ = nullptr;
    Meter meter_;       // lives longer than all that the library made
    TriangleMesh mesh_; // of several components, until it is described
    readers::Repairs repairs_;
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
    } atlas_;                             // written
    size_t leaves_ = 0, quads_ = 0;       // written
    size_t irregular_ = 0, inverted_ = 0; // vertices, quads
};

// Where the class comes from: --start, --through, or --loops.
void choose_source(const Options& options, SolveRequest& request) {
    for (const Option& option : options)
        if (std::string("--through") == option.name && !option.given.empty() && request.through.empty())
            throw Failure(EXIT_USAGE, "--through: nothing is picked; give vertices or places X,Y,Z");
    // An atlas is as even as the foliation.
    for (const Option& option : options)
        if (std::string("--loops") == option.name && option.given.empty() && !request.atlas.empty()
            && request.weights.empty())
            request.loops = "even";
    if (!request.start.empty() || !request.through.empty()) request.loops.clear();
}

} // namespace

std::string SolveRequest::name_of_loop(size_t line) const {
    if (!through.empty()) return "--through, loop " + std::to_string(line);
    return shown(loops) + ":" + std::to_string(line);
}

std::string version_text() {
    const uint32_t version = hmf_version();
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "."
         + std::to_string(version % 100);
}

Outcome solve(const std::vector<std::string>& words) {
    SolveRequest request;
    Options options = solve_options(request);
    parse(options, words, "solve");
    choose_source(options, request);
    if (!request.start.empty() && !request.weights.empty() && request.image.empty() && request.obj.empty()
        && request.textured.empty() && request.leaves.empty())
        throw Failure(EXIT_USAGE, "--weights: has no effect with --start, whose values have their own; leave it out");
    return Run(request, options).go();
}

Outcome quads(const std::vector<std::string>& words) {
    SolveRequest request;
    Options options = quads_options(request);
    parse(options, words, "quads");
    choose_source(options, request);
    if (request.no_poles) request.marks = "none";
    return Run(request, options).go();
}

} // namespace cli
