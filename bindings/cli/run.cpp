#include "run.hpp"

#include <algorithm>
#include <cstdio>

#include "../readers/components.hpp"

namespace cli {

namespace {

// HMF_LOOPS_* of a name, 0 for the name of a file.
int32_t loop_kind(const std::string& name) {
    if (name == "cut") return HMF_LOOPS_CUT;
    if (name == "handle") return HMF_LOOPS_HANDLE;
    if (name == "tunnel") return HMF_LOOPS_TUNNEL;
    if (name == "pants") return HMF_LOOPS_PANTS;
    if (name == "even") return LOOPS_EVEN;
    return 0;
}

} // namespace

Run::Run(SolveRequest& request, const Options& options) :
    r_(request), options_(options), kind_(loop_kind(request.loops)) {}

void Run::make() {
    choose_style();
    read();
    r_.threads = progress_.use_threads(r_.threads);
    build();
    choose_loops();
    solve();
    describe();
    make_quad_meshes();
}

Outcome Run::finish() {
    write();
    report();
    return std::move(outcome_);
}

void Run::choose_style() {
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

const hmf_control* Run::share(const char* label, double from, double to, size_t& done, const Component& c) {
    const double all = static_cast<double>(is_alone() ? c.mesh().triangle_count() : mesh_.triangle_count());
    const double begin = static_cast<double>(done) / all;
    done += c.mesh().triangle_count();
    const double end = static_cast<double>(done) / all;
    return progress_.part(label, from + (to - from) * begin, from + (to - from) * end);
}

void Run::solve() {
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
    if (r_.tolerance == 0) r_.tolerance = 1e-8; // what counts as converged
    for (const Component& c : components_)
        if (c.is_refused()) outcome_.notes.push_back(c.refusal() + "; its values are 0");
}

void Run::describe() {
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

} // namespace cli
